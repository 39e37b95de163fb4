//! The contacts that are closed at the midpoint, and their contact problem.

use super::state::ContactMemory;
use crate::contact::{ContactProblem, ContactRows, ContactState, Delassus, Memory, Phase};
use crate::system::{ContactLaw, System, SystemError};

/// What has changed in the contact problem besides the velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    /// Nothing.
    None,
    /// The Delassus operator.
    Operator,
    /// The set of closed contacts, and with it everything.
    Contacts,
}

/// The contact problem of the present step, and which of the system's contacts it is about.
#[derive(Debug)]
pub(super) struct Closed {
    pub(super) problem: ContactProblem,
    /// Contacts in the problem, in its order.
    pub(super) active: Vec<usize>,
    /// Contacts found closed in the present step, before they become the active ones.
    pub(super) found: Vec<usize>,
    /// Velocities with which they close what is left of their gaps in a step.
    pub(super) gaps: Vec<f64>,
    /// Whether they were closed in the last step.
    pub(super) stay: Vec<bool>,
    /// Whether each contact is in the problem.
    is_active: Vec<bool>,
    /// Whether the contact problem is one of this run and complete.
    pub(super) ready: bool,
    /// Whether other contacts are in the problem since.
    renewed: bool,
    /// Whether the memory has yet to follow the last change of the closed contacts.
    moved: bool,
    /// `e_N`, `e_T` row by row, and whether any is not zero.
    restitution: Vec<f64>,
    bounces: bool,
    /// Contacts that were in the problem before its last change, and their rows there.
    before: Vec<(usize, ContactRows)>,
    /// What all contacts remember: whether they were closed in the last step that was made, be it of the run before, or
    /// nothing is known of what was before; states and percussions at the last change, since then those of the closed
    /// ones are in the memory of the stepper.
    pub(super) known: Vec<ContactMemory>,
}

/// Of a contact of which nothing is known.
const NOTHING: ContactMemory =
    ContactMemory { closed: true, state: ContactState::UNKNOWN, percussion: [0.0; 4] };

impl Closed {
    /// Nothing but what contacts remember, which may be nothing.
    pub(super) fn new(system: &dyn System, known: &[ContactMemory]) -> Self {
        let contacts = system.contacts().len();
        Self {
            problem: ContactProblem::assemble([], Delassus::Blocks(Default::default())),
            active: Vec::with_capacity(contacts),
            found: Vec::with_capacity(contacts),
            gaps: Vec::with_capacity(contacts),
            stay: Vec::with_capacity(contacts),
            is_active: vec![false; contacts],
            ready: false,
            renewed: false,
            moved: false,
            restitution: Vec::new(),
            bounces: false,
            before: Vec::new(),
            known: if known.is_empty() { vec![NOTHING; contacts] } else { known.to_vec() },
        }
    }

    /// The same contact problem in another run, of which contacts remember this, which may be nothing.
    pub(super) fn restart(&mut self, known: &[ContactMemory]) {
        if known.is_empty() {
            self.known.fill(NOTHING);
        } else {
            self.known.copy_from_slice(known);
        }
        (self.renewed, self.moved) = (true, false);
    }

    /// What the closed contacts remember of a run before.
    pub(super) fn recall(&self, memory: &mut Memory) {
        memory.clear();
        for (&contact, rows) in self.active.iter().zip(self.problem.contacts()) {
            memory.states.push(self.known[contact].state);
            memory.percussion.extend_from_slice(&self.known[contact].percussion[..rows.len()]);
        }
    }

    /// What all contacts remember.
    pub(super) fn memory(&self, memory: &Memory) -> Vec<ContactMemory> {
        let mut known = self.known.clone();
        remember(&mut known, self.active.iter().zip(self.problem.contacts()), memory);
        known
    }

    /// Whether a contact was closed in the last step that was made, be it of the run before.
    #[inline]
    pub(super) fn was_closed(&self, contact: usize) -> bool {
        self.known[contact].closed
    }

    /// The step is made, and its contacts are those that were closed; whether they are others than in the step before.
    #[inline]
    pub(super) fn settle(&mut self) -> bool {
        let renewed = std::mem::take(&mut self.renewed);
        if renewed {
            self.mark_closed();
        }
        renewed
    }

    #[inline(never)]
    fn mark_closed(&mut self) {
        for (known, &is_active) in self.known.iter_mut().zip(&self.is_active) {
            known.closed = is_active;
        }
    }

    /// Makes the contacts found closed the active ones, with a problem of zeros to be filled in.
    pub(super) fn renew(&mut self, laws: &[ContactLaw], dt: f64, delassus: Delassus) {
        std::mem::swap(&mut self.active, &mut self.found);
        let contact = |&c: &usize| {
            let prescribed = laws[c].normal_force().prescribed().map(|force| force * dt);
            (laws[c].law().clone(), prescribed.into())
        };
        let problem = ContactProblem::assemble(self.active.iter().map(contact), delassus);
        let old = std::mem::replace(&mut self.problem, problem);
        self.before.clear();
        self.before.extend(self.found.iter().copied().zip(old.into_contacts()));
        self.is_active.fill(false);
        self.restitution.clear();
        for (contact, &c) in self.problem.contacts().iter().zip(&self.active) {
            self.is_active[c] = true;
            let normal = std::iter::repeat_n(laws[c].normal_restitution(), contact.normal_rows());
            let p = contact.law.dimension();
            let tangential = std::iter::repeat_n(laws[c].tangential_restitution(), p);
            self.restitution.extend(normal.chain(tangential));
        }
        self.bounces = self.restitution.iter().any(|&e| e != 0.0);
        (self.ready, self.moved, self.renewed) = (true, true, true);
    }

    /// A memory for the contacts that are closed now: states and percussions of those that stay closed are kept.
    #[inline]
    pub(super) fn carry_over(&mut self, memory: &mut Memory) {
        if std::mem::take(&mut self.moved) {
            self.rearrange(memory);
        }
    }

    #[inline(never)]
    fn rearrange(&mut self, memory: &mut Memory) {
        let before = self.before.iter().map(|(contact, rows)| (contact, rows));
        remember(&mut self.known, before, memory);
        for (known, _) in self.known.iter_mut().zip(&self.is_active).filter(|(_, active)| !**active)
        {
            known.state.phase = Phase::Open;
            known.percussion = [0.0; 4];
        }
        self.recall(memory);
    }

    /// Refuses directions that move nothing: they would make the friction force meaningless. So do normals that joints
    /// or constraints hold but for their compliance, given row by row.
    pub(super) fn check_directions(
        &self,
        compliance: &[f64],
        joints: bool,
    ) -> Result<(), SystemError> {
        for (i, (contact, c)) in self.problem.contacts().iter().zip(&self.active).enumerate() {
            let diagonal = |a| self.problem.delassus().own(i, a, a);
            if (0..contact.len()).any(|a| diagonal(a) <= 0.0) {
                return Err(SystemError::direction(*c));
            }
            // What is held moves by less than its compliance, to which that was added.
            let held = 2.0 * compliance[contact.offset];
            if contact.normal_rows() > 0 && held > 0.0 && diagonal(0) <= held {
                return Err(SystemError::held(*c, joints));
            }
        }
        Ok(())
    }

    /// Whether any contact has restitution.
    #[inline]
    pub(super) fn bounces(&self) -> bool {
        self.bounces
    }

    /// Restitution terms `e γ_B`; `before(row)` is `γ_B`.
    #[inline]
    pub(super) fn bounce(&mut self, before: impl Fn(usize) -> f64) {
        let terms = self.problem.restitution_mut().iter_mut().zip(&self.restitution);
        for (row, (term, e)) in terms.enumerate() {
            *term = e * before(row);
        }
    }
}

/// Takes over what the memory of a contact problem holds of its contacts.
fn remember<'a>(
    known: &mut [ContactMemory],
    contacts: impl Iterator<Item = (&'a usize, &'a ContactRows)>,
    memory: &Memory,
) {
    for ((&contact, rows), state) in contacts.zip(&memory.states) {
        known[contact].state = *state;
        known[contact].percussion[..rows.len()].copy_from_slice(&memory.percussion[rows.rows()]);
    }
}
