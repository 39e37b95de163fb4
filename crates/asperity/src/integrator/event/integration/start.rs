//! The beginning of the motion: what is refused, and what the contacts do.

use crate::contact::Phase;
use crate::integrator::event::dynamics::{ContactVariables, ROWS};
use crate::integrator::event::integration::location::closed_gap;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::resolution::ROUNDED_INPUT;
use crate::integrator::event::state::{EvaluationError, State};
use crate::system::{Break, Smoothness};
use crate::vectors::{largest, norm};

impl Integration<'_> {
    /// A contact that overlaps at the beginning, and how deep.
    pub(crate) fn overlap(&mut self) -> Result<Option<(usize, f64)>, EvaluationError> {
        // Functions of time begin with what holds from there on.
        self.enter_piece();
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        let (t_end, duration) = (self.options.t_end, self.options.duration());
        let (start_q, start_u) = self.dynamics.chart.system_state(&self.state);
        let (start_q, start_u) = (start_q.to_vec(), start_u.to_vec());
        self.dynamics.account_for_time(&start_q, &start_u, t_end)?;
        self.step_size.account_for_parts(self.dynamics.time_parts.velocity);
        self.step_size.account_for(&mut self.dynamics, &self.state, 0.0);
        // An impact at the beginning is told from rest by the accelerations without contacts.
        self.dynamics.free_acceleration(*t, u, &mut self.a0)?;
        let acceleration = largest(&self.a0).max(self.dynamics.time_parts.load);
        self.rounded_velocity = f64::EPSILON * acceleration * duration;
        let overlaps = |c: &ContactVariables| {
            c.prescribed.is_none() && c.gap < -f64::max(closed_gap(c), ROUNDED_INPUT)
        };
        let contacts = &self.dynamics.contacts;
        let overlapping = contacts.iter().position(overlaps);
        Ok(overlapping.map(|contact| (contact, -contacts[contact].gap)))
    }

    /// Decides what the contacts do at the beginning.
    pub(crate) fn initialise(&mut self) -> Ending {
        self.dynamics.choose_stencil(&self.state, self.options.duration())?;
        let mut hit = self.touch();
        if hit.is_some() && self.step_back()? {
            hit = None;
        }
        let Some(contact) = hit else {
            return self.decide_modes(&vec![None; self.memory.len()]);
        };
        // Velocities jump at once: the state from which they do is the first sample.
        self.record();
        self.collide(contact)
    }

    /// Closes the contacts that touch and do not part, at evaluated kinematics; returns one that collides.
    fn touch(&mut self) -> Option<usize> {
        let mut hit = None;
        let still = self.zero_velocity().max(self.rounded_velocity);
        for i in 0..self.memory.len() {
            let rows =
                (1..=self.dynamics.contacts[i].p).map(|r| largest(self.dynamics.row(ROWS * i + r)));
            let size = rows.fold(0.0, f64::max);
            // Rounding must not slip.
            if norm(&self.dynamics.contacts[i].slip) <= self.rounded_velocity * size {
                self.dynamics.contacts[i].slip = [0.0; 3];
            }
            self.dynamics.contacts[i].mode = Phase::Open;
            let contact = self.dynamics.contacts[i];
            if contact.prescribed.is_none() && contact.gap <= closed_gap(&contact) {
                let approach = self.approach(i);
                if approach < -still {
                    hit = Some(i);
                } else if approach <= still {
                    self.close_contact(i);
                }
            } else if contact.prescribed.is_some_and(|force| force > 0.0) {
                self.close_contact(i);
            }
        }
        hit
    }

    /// Begins the motion before a kink of functions of time at its start, if only the kink lets surfaces strike contacts that
    /// rest; whether it does.
    fn step_back(&mut self) -> Result<bool, EvaluationError> {
        let before = self.state.t.next_down();
        let next = self.dynamics.system.next_break(before);
        let kink = |b: &Break| b.time == self.state.t && b.smoothness == Smoothness::Kink;
        let Some(kink) = next.filter(kink) else { return Ok(false) };
        let piece = std::mem::replace(&mut self.dynamics.chart.piece, before);
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        if self.touch().is_none() {
            self.next_break = Some(kink);
            return Ok(true);
        }
        self.dynamics.chart.piece = piece;
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        self.touch();
        Ok(false)
    }
}
