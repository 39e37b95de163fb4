//! Times at which functions of time are not smooth: steps end there, and begin anew with what holds next.

use crate::contact::{ContactState, Phase};
use crate::integrator::event::dynamics::ContactVariables;
use crate::integrator::event::integration::impact::touches;
use crate::integrator::event::integration::variables::{Ending, Integration};
use crate::integrator::event::motion::EventKind;
use crate::integrator::event::resolution::UNRESOLVED_TIME;
use crate::integrator::event::state::State;
use crate::system::{Break, Smoothness};

impl Integration<'_> {
    /// Enters the smooth piece of all functions of time that begins now; the least smooth of the breaks passed with it.
    pub(crate) fn enter_piece(&mut self) -> Option<Smoothness> {
        let system = self.dynamics.system;
        let (mut start, mut passed) = (self.state.t, None);
        let together = start + UNRESOLVED_TIME * self.options.t_end;
        let mut next = system.next_break(start);
        while let Some(Break { time, smoothness }) = next.filter(|found| found.time <= together) {
            passed = Some(passed.map_or(smoothness, |worse| smoothness.min(worse)));
            start = time;
            next = system.next_break(start);
        }
        self.dynamics.chart.piece = next.map_or(start, |end| start + 0.5 * (end.time - start));
        self.next_break = next;
        self.dynamics.piece = start..next.map_or(self.options.t_end, |end| end.time);
        passed
    }

    /// The time at which steps end: of the next break or of the motion.
    pub(crate) fn end_of_piece(&self) -> f64 {
        let t_end = self.options.t_end;
        let latest = t_end - UNRESOLVED_TIME * t_end;
        self.next_break.map(|end| end.time).filter(|time| *time < latest).unwrap_or(t_end)
    }

    /// Goes on behind the break at the present time. Contacts with surfaces whose velocities jump collide, slip or open.
    pub(crate) fn pass_break(&mut self) -> Ending {
        let own = self.next_break.map(|end| end.smoothness);
        let least = [own, self.enter_piece()].into_iter().flatten().min();
        if least == Some(Smoothness::Knot) {
            return Ok(None);
        }
        self.record_event(None, EventKind::Kink, false);
        self.uncounted += 1;
        let State { t, q, u } = &self.state;
        self.dynamics.kinematics(*t, q, u)?;
        self.step_size.account_for(&mut self.dynamics, &self.state, 0.0);
        let still = self.zero_velocity();
        let touching = |c: &ContactVariables| c.is_closed_unilateral() || touches(c);
        let contacts = &self.dynamics.contacts;
        let meets = |&i: &usize| touching(&contacts[i]) && self.approach(i) < -still;
        if let Some(contact) = (0..contacts.len()).find(meets) {
            return self.collide(contact);
        }
        let before = self.modes();
        for i in 0..self.memory.len() {
            let contact = &self.dynamics.contacts[i];
            let closed = contact.is_closed_unilateral() || contact.unloaded;
            if closed && self.approach(i) > still {
                let contact = &mut self.dynamics.contacts[i];
                (contact.mode, contact.unloaded) = (Phase::Open, false);
                self.memory[i] = ContactState::new(Phase::Open, self.memory[i].slip);
            } else if contact.mode != Phase::Open {
                self.close_contact(i);
            }
        }
        self.decide_modes(&before)
    }
}
