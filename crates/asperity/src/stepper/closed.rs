//! The contacts that are closed at the midpoint, and their contact problem.

use crate::contact::{
    ContactProblem, ContactRows, ContactState, Delassus, Memory, NormalForce, Phase,
};
use crate::system::{ContactLaw, System};

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
    /// Place of every contact in the problem.
    places: Vec<Option<usize>>,
    /// Whether there has been a problem at all.
    pub(super) ready: bool,
    /// `e_N`, `e_T` row by row, and whether any is not zero.
    restitution: Vec<f64>,
    bounces: bool,
    /// Contacts that were in the problem before its last change, and their rows there.
    before: Vec<(usize, ContactRows)>,
    /// States and percussions of all contacts at the last change; since then those of the closed ones are
    /// in the memory of the stepper.
    pub(super) states: Vec<ContactState>,
    percussions: Vec<[f64; 4]>,
}

impl Closed {
    pub(super) fn new(system: &dyn System) -> Self {
        let contacts = system.contacts().len();
        Self {
            problem: ContactProblem::blank(std::iter::empty(), |_| {
                Delassus::Blocks(Default::default())
            }),
            active: Vec::with_capacity(contacts),
            found: Vec::with_capacity(contacts),
            places: vec![None; contacts],
            ready: false,
            restitution: Vec::new(),
            bounces: false,
            before: Vec::new(),
            states: vec![ContactState::default(); contacts],
            percussions: vec![[0.0; 4]; contacts],
        }
    }

    /// Place of a contact in the problem, if it is closed.
    #[inline]
    pub(super) fn place(&self, contact: usize) -> Option<usize> {
        self.places[contact]
    }

    /// Makes the contacts found closed the active ones, with a problem of zeros to be filled in.
    pub(super) fn renew(
        &mut self,
        laws: &[ContactLaw],
        dt: f64,
        delassus: impl FnOnce(&[ContactRows]) -> Delassus,
    ) {
        std::mem::swap(&mut self.active, &mut self.found);
        let contact = |&c: &usize| {
            let normal = match laws[c].normal_force {
                Some(force) => NormalForce::Prescribed(force * dt),
                None => NormalForce::Unilateral,
            };
            (laws[c].law.clone(), normal)
        };
        let problem = ContactProblem::blank(self.active.iter().map(contact), delassus);
        let old = std::mem::replace(&mut self.problem, problem);
        self.before.clear();
        self.before.extend(self.found.iter().copied().zip(old.contacts));
        self.places.fill(None);
        self.restitution.clear();
        for (place, (contact, &c)) in self.problem.contacts.iter().zip(&self.active).enumerate() {
            self.places[c] = Some(place);
            let normal = std::iter::repeat_n(laws[c].normal_restitution, contact.normal_rows());
            let p = contact.law.dimension();
            let tangential = std::iter::repeat_n(laws[c].tangential_restitution, p);
            self.restitution.extend(normal.chain(tangential));
        }
        self.bounces = self.restitution.iter().any(|&e| e != 0.0);
        self.ready = true;
    }

    /// A memory for the new contacts: states and percussions of contacts that stay closed are kept.
    pub(super) fn carry_over(&mut self, memory: &mut Memory) {
        for ((contact, rows), state) in self.before.iter().zip(&memory.states) {
            self.states[*contact] = *state;
            let own = &memory.percussion[rows.offset..rows.offset + rows.len()];
            self.percussions[*contact][..own.len()].copy_from_slice(own);
        }
        for (contact, place) in self.places.iter().enumerate() {
            if place.is_none() {
                self.states[contact].phase = Phase::Open;
                self.percussions[contact] = [0.0; 4];
            }
        }
        memory.states.clear();
        memory.percussion.clear();
        for (&contact, rows) in self.active.iter().zip(&self.problem.contacts) {
            memory.states.push(self.states[contact]);
            memory.percussion.extend_from_slice(&self.percussions[contact][..rows.len()]);
        }
    }

    /// Whether any contact has restitution.
    #[inline]
    pub(super) fn bounces(&self) -> bool {
        self.bounces
    }

    /// Restitution terms `e γ_B`; `before(row)` is `γ_B`.
    #[inline]
    pub(super) fn bounce(&mut self, before: impl Fn(usize) -> f64) {
        let terms = self.problem.restitution.iter_mut().zip(&self.restitution);
        for (row, (term, e)) in terms.enumerate() {
            *term = e * before(row);
        }
    }
}

impl ContactProblem {
    /// A problem of zeros to be filled in.
    fn blank(
        contacts: impl Iterator<Item = (crate::law::Law, NormalForce)>,
        delassus: impl FnOnce(&[ContactRows]) -> Delassus,
    ) -> Self {
        let mut rows = 0;
        let contacts: Vec<ContactRows> = contacts
            .map(|(law, normal)| {
                let contact = ContactRows { law, normal, offset: rows };
                rows += contact.len();
                contact
            })
            .collect();
        let (delassus, count) = (delassus(&contacts), contacts.len());
        Self {
            delassus,
            free_velocity: vec![0.0; rows],
            restitution: vec![0.0; rows],
            contacts,
            rho: vec![0.0; count],
        }
    }
}
