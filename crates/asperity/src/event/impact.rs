//! Impacts, and what contacts do after velocities have jumped.

use super::decide::{self, Blow, Decision, Rebound};
use super::happen::Next;
use super::run::Runner;
use super::touch::{ROWS, STILL, State, instant};
use super::{Kind, Outcome};
use crate::contact::{ContactState, Phase};

/// Height of a bounce over the reach of the contact below which it rests: the end of a sequence of impacts,
/// whose rest takes the time of about two such bounces.
const LOWEST: f64 = 1e-13;
/// `w_NᵀM⁻¹(w_N + Wf)` over `w_NᵀM⁻¹w_N` that counts as none.
const RESISTANCE: f64 = 1e-12;

impl Runner<'_> {
    /// A gap has closed.
    pub(super) fn collide(&mut self, contact: usize) -> Next {
        let mut before = self.phases();
        let still = STILL * self.control.speed();
        let involved: Vec<usize> = (0..self.memory.len())
            .filter(|&i| {
                let touch = &self.field.touches[i];
                let closed = touch.mode != Phase::Open;
                // Also if it is about to open: the percussions of the others may prevent that.
                let touches = touch.gap <= self.touching(touch);
                touch.prescribed.is_none() && (closed || touches || i == contact)
            })
            .collect();
        let approaches: Vec<f64> = involved.iter().map(|&i| self.approach(i)).collect();
        let untouched = |&velocity: &f64| Rebound { velocity, percussion: 0.0 };
        let (start, mut after): (_, Vec<Rebound>) =
            (self.state.clone(), approaches.iter().map(untouched).collect());
        let mut ambiguous = false;
        if approaches.iter().any(|approach| *approach < -still) {
            for blow in [Blow::Restitution, Blow::Dead] {
                self.state.clone_from(&start);
                let meeting = (involved.clone(), blow);
                let (field, state) = (&mut self.field, &mut self.state);
                let poll = &self.poll;
                match decide::strike(field, state, meeting, &self.memory, &mut after, poll)? {
                    Decision::Made { ambiguous: several } => ambiguous = several,
                    Decision::Ended(outcome) => return Ok(Some(outcome)),
                }
                if !self.too_low(&involved, &after) {
                    break;
                }
            }
        }
        // Contacts that touch while they separate might also be hit one after the other.
        let drawn_in =
            |(approach, after): (&f64, &Rebound)| *approach > still && after.percussion > 0.0;
        ambiguous |= approaches.iter().zip(&after).any(drawn_in);
        for (k, &i) in involved.iter().enumerate() {
            let meets = i == contact || approaches[k] <= still || after[k].percussion > 0.0;
            if self.field.touches[i].mode != Phase::Open || !meets {
                continue;
            }
            self.event(Some(i), Kind::Impact, ambiguous);
            before[i] = None;
        }
        self.after_blow(&involved, &after, before)
    }

    /// Whether contacts bounce, all of them lower than can be followed.
    fn too_low(&self, involved: &[usize], after: &[Rebound]) -> bool {
        let still = STILL * self.control.speed();
        let velocities = involved.iter().zip(after.iter().map(|after| after.velocity));
        let mut bounces = velocities.filter(|(_, v)| *v > still).peekable();
        bounces.peek().is_some()
            && bounces.all(|(&i, v)| {
                let fall = -self.field.rate(ROWS * i, &self.a0);
                let low = v * v < 2.0 * fall * LOWEST * self.field.touches[i].reach;
                fall > 0.0 && (low || v < fall * instant(self.state.t))
            })
    }

    /// Modes after velocities have jumped.
    fn after_blow(
        &mut self,
        involved: &[usize],
        after: &[Rebound],
        before: Vec<Option<Phase>>,
    ) -> Next {
        let State { t, q, u } = &self.state;
        self.field.kinematics(*t, q, u)?;
        let still = STILL * self.control.speed();
        for i in 0..self.memory.len() {
            let place = involved.iter().position(|&k| k == i);
            let closed = self.field.touches[i].mode != Phase::Open;
            match place {
                Some(k) if after[k].velocity > still => {
                    self.field.touches[i].mode = Phase::Open;
                    self.memory[i] = ContactState::new(Phase::Open, self.memory[i].slip);
                }
                Some(_) => self.close(i),
                None if closed => self.close(i),
                None => {}
            }
        }
        self.settle(&before)
    }

    /// A slipping contact that no longer resists to normal motions.
    pub(super) fn singular(&self) -> Option<usize> {
        let touches = self.field.touches.iter().zip(self.control.resistances());
        let mut slipping = touches.map(|(touch, resistance)| (touch.mode, *resistance));
        slipping.position(|(mode, resistance)| mode == Phase::Slip && resistance < RESISTANCE)
    }

    /// Painlevé's impact without collision.
    pub(super) fn stop_without_collision(&mut self, contact: usize) -> Next {
        let mut before = self.phases();
        let closed = |&i: &usize| {
            let touch = &self.field.touches[i];
            touch.prescribed.is_none() && touch.mode != Phase::Open
        };
        let involved: Vec<usize> = (0..self.memory.len()).filter(closed).collect();
        if !decide::stop(&mut self.field, &mut self.state, &involved)? {
            return Ok(Some(Outcome::NoSolution { contact }));
        }
        self.event(Some(contact), Kind::ImpactWithoutCollision, false);
        before[contact] = None;
        let after = vec![Rebound::default(); involved.len()];
        self.after_blow(&involved, &after, before)
    }
}
