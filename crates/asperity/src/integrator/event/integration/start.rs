//! The beginning of the motion: what is refused, and what the contacts do.

use crate::argument::{ArgumentError, refuse};
use crate::integrator::event::dynamics::{ContactVariables, ROWS};
use crate::integrator::event::integration::location::closed_gap;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::state::{EvaluationError, LEAST, State};
use crate::vectors::{largest, norm};

impl Integration<'_> {
    /// Refuses contacts that overlap at the beginning.
    pub(crate) fn check_overlap(&mut self) -> Result<Result<(), ArgumentError>, EvaluationError> {
        // Functions of time begin with what holds from there on.
        self.enter_piece();
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        self.step_size.account_for(&mut self.dynamics, &self.state, 0.0);
        // An impact at the beginning is told from rest by the accelerations without contacts.
        self.dynamics.free_acceleration(*t, u, &mut self.a0)?;
        let overlaps = |c: &ContactVariables| c.prescribed.is_none() && c.gap < -closed_gap(c);
        let contacts = &self.dynamics.contacts;
        Ok(contacts.iter().position(overlaps).map_or(Ok(()), |contact| {
            let depth = -contacts[contact].gap;
            let message =
                format!("must not let contacts overlap, contact {contact} does by {depth:.3e}");
            refuse("q0", message)
        }))
    }

    /// Decides what the contacts do at the beginning.
    pub(crate) fn initialise(&mut self) -> Ending {
        self.dynamics.choose_stencil(&self.state, self.options.t_end)?;
        let mut hit = None;
        let still = self.zero_velocity().max(LEAST);
        for i in 0..self.memory.len() {
            let rows =
                (1..=self.dynamics.contacts[i].p).map(|r| largest(self.dynamics.row(ROWS * i + r)));
            let size = rows.fold(0.0, f64::max);
            // Rounding must not slip.
            if norm(&self.dynamics.contacts[i].slip) <= LEAST * size {
                self.dynamics.contacts[i].slip = [0.0; 3];
            }
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
        match hit {
            Some(contact) => self.collide(contact),
            None => self.decide_modes(&vec![None; self.memory.len()]),
        }
    }
}
