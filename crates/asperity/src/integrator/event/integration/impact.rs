//! Impacts, and what contacts do after velocities have jumped.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::contact_problem::accelerations::{self, Blow, Decision};
use crate::integrator::event::dynamics::contact_variables::{
    FieldError, ROWS, STILL, State, TOUCHING, instant,
};
use crate::integrator::event::integration::time_loop::Runner;
use crate::integrator::event::integration::transition::Next;
use crate::integrator::event::{Cause, Kind, Outcome};

/// Height of a bounce over the reach of the contact below which it rests: the end of a sequence of impacts,
/// whose rest takes the time of about two such bounces.
const LOWEST: f64 = 1e-13;
/// `w_NᵀM⁻¹(w_N + Wf)` over `w_NᵀM⁻¹w_N` that counts as none.
const RESISTANCE: f64 = 1e-12;

impl Runner<'_> {
    /// A gap has closed.
    pub(crate) fn collide(&mut self, contact: usize) -> Next {
        let mut before = self.phases();
        let still = STILL * self.control.speed();
        let involved: Vec<usize> = (0..self.memory.len())
            .filter(|&i| {
                let touch = &self.field.touches[i];
                let closed = touch.mode != Phase::Open;
                let meets = touch.gap <= TOUCHING * touch.reach && self.approach(i) <= still;
                touch.prescribed.is_none() && (closed || meets || i == contact)
            })
            .collect();
        let (start, mut after) = (self.state.clone(), vec![0.0; involved.len()]);
        let mut ambiguous = false;
        if involved.iter().any(|&i| self.approach(i) < -still) {
            for blow in [Blow::Restitution, Blow::Dead] {
                self.state.clone_from(&start);
                let meeting = (involved.clone(), blow);
                let (field, state) = (&mut self.field, &mut self.state);
                let poll = &self.poll;
                match accelerations::strike(field, state, meeting, &self.memory, &mut after, poll)?
                {
                    Decision::Made { ambiguous: several } => ambiguous = several,
                    Decision::Ended(outcome) => return Ok(Some(outcome)),
                }
                if !self.too_low(&involved, &after) {
                    break;
                }
            }
            ambiguous |= self.drives_back(&involved)?;
        }
        let opened = |i: usize| self.field.touches[i].mode == Phase::Open;
        let meeting: Vec<usize> = involved.iter().copied().filter(|&i| opened(i)).collect();
        for i in meeting {
            self.event(Some(i), Kind::Impact, ambiguous);
            before[i] = None;
        }
        self.after_blow(&involved, &after, before)
    }

    /// Whether an impact drives a contact back that touched and was about to leave. It collides next, and so on:
    /// one impact of both at a time is another law of the corner, to which time steps may converge.
    fn drives_back(&mut self, involved: &[usize]) -> Result<bool, FieldError> {
        let State { t, q, u } = &self.state;
        self.field.kinematics(*t, q, u)?;
        let still = STILL * self.control.speed();
        let mut others = (0..self.memory.len()).filter(|i| !involved.contains(i));
        Ok(others.any(|i| {
            let touch = &self.field.touches[i];
            let touches = touch.prescribed.is_none() && touch.gap <= TOUCHING * touch.reach;
            touches && self.approach(i) < -still
        }))
    }

    /// Whether contacts bounce, all of them lower than can be followed.
    fn too_low(&self, involved: &[usize], after: &[f64]) -> bool {
        let still = STILL * self.control.speed();
        let mut bounces = involved.iter().zip(after).filter(|(_, v)| **v > still).peekable();
        bounces.peek().is_some()
            && bounces.all(|(&i, &v)| {
                let fall = -self.field.rate(ROWS * i, &self.a0);
                let low = v * v < 2.0 * fall * LOWEST * self.field.touches[i].reach;
                fall > 0.0 && (low || v < fall * instant(self.state.t))
            })
    }

    /// Modes after velocities have jumped.
    fn after_blow(
        &mut self,
        involved: &[usize],
        after: &[f64],
        before: Vec<Option<Phase>>,
    ) -> Next {
        let State { t, q, u } = &self.state;
        self.field.kinematics(*t, q, u)?;
        let still = STILL * self.control.speed();
        for i in 0..self.memory.len() {
            let place = involved.iter().position(|&k| k == i);
            let closed = self.field.touches[i].mode != Phase::Open;
            match place {
                Some(k) if after[k] > still => {
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
    pub(crate) fn singular(&self) -> Option<usize> {
        let touches = self.field.touches.iter().zip(self.control.resistances());
        let mut slipping = touches.map(|(touch, resistance)| (touch.mode, *resistance));
        slipping.position(|(mode, resistance)| mode == Phase::Slip && resistance < RESISTANCE)
    }

    /// Whether a slipping contact that no longer resists opens without its own force. With a negative resistance it
    /// could go on slipping as well, under a force that keeps itself up.
    fn opens(&mut self, contact: usize) -> Result<bool, FieldError> {
        let State { t, q, u } = &self.state;
        self.field.touches[contact].mode = Phase::Open;
        self.field.evaluate(*t, q, u, false)?;
        self.field.drift_of_all(&self.state)?;
        self.field.touches[contact].mode = Phase::Slip;
        Ok(self.field.rate(ROWS * contact, &self.field.acceleration) >= 0.0)
    }

    /// Painlevé's paradox: a contact that can open, opens; if none can, an impact without collision stops the slip.
    pub(crate) fn leave_singular(&mut self, contact: usize) -> Next {
        let mut before = self.phases();
        if self.opens(contact)? {
            self.field.touches[contact].mode = Phase::Open;
            self.memory[contact] = ContactState::new(Phase::Open, self.memory[contact].slip);
            self.event(Some(contact), Kind::Open, true);
            before[contact] = None;
            return self.settle(&before);
        }
        let closed = |&i: &usize| {
            let touch = &self.field.touches[i];
            touch.prescribed.is_none() && touch.mode != Phase::Open
        };
        let involved: Vec<usize> = (0..self.memory.len()).filter(closed).collect();
        if !accelerations::stop(&mut self.field, &mut self.state, &involved)? {
            let cause = Cause::NoImpact;
            return Ok(Some(Outcome::Stuck { cause, contact: Some(contact) }));
        }
        self.event(Some(contact), Kind::ImpactWithoutCollision, false);
        before[contact] = None;
        let after = vec![0.0; involved.len()];
        self.after_blow(&involved, &after, before)
    }
}
