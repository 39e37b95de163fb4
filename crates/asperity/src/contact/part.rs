//! An island, contacts that influence no others, as a problem of its own.

use super::ContactProblem;
use super::delassus::Selection;

/// Some of the contacts of a problem as a problem.
#[derive(Debug, Clone)]
pub(crate) struct Part {
    problem: ContactProblem,
    members: Selection,
}

impl Part {
    /// The problem of some contacts, ascending; its velocities are still to be copied.
    pub(crate) fn new(whole: &ContactProblem, contacts: &[usize]) -> Self {
        let members = whole.delassus().select(contacts);
        let own = contacts.iter().map(|&i| &whole.contacts()[i]);
        let laws = own.map(|contact| (contact.law.clone(), contact.normal));
        let problem = ContactProblem::assemble(laws, whole.delassus().part(&members));
        Self { problem, members }
    }

    /// Copies the entries of the operator of the whole problem, where the contacts influence no others.
    pub(crate) fn copy_operator(&mut self, whole: &ContactProblem) {
        let Self { problem, members } = self;
        problem.refill(|delassus| whole.delassus().copy_part(members, delassus));
    }

    /// Copies velocities and prescribed normal percussions of the whole problem.
    pub(crate) fn copy_velocities(&mut self, whole: &ContactProblem) {
        let (free, restitution) = self.problem.velocities_mut();
        take(&self.members.rows, whole.free_velocity(), free);
        take(&self.members.rows, whole.restitution(), restitution);
        for (own, &i) in self.problem.contacts_mut().iter_mut().zip(&self.members.contacts) {
            own.normal = whole.contacts()[i].normal;
        }
    }

    /// The problem.
    pub(crate) fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// Its contacts in the whole problem.
    pub(crate) fn contacts(&self) -> &[usize] {
        &self.members.contacts
    }

    /// Its rows in the whole problem.
    pub(crate) fn rows(&self) -> &[usize] {
        &self.members.rows
    }
}

/// `part ← whole[places]`.
pub(crate) fn take<T: Copy>(places: &[usize], whole: &[T], part: &mut [T]) {
    for (value, &place) in part.iter_mut().zip(places) {
        *value = whole[place];
    }
}

/// `whole[places] ← part`.
pub(crate) fn put<T: Copy>(places: &[usize], part: &[T], whole: &mut [T]) {
    for (value, &place) in part.iter().zip(places) {
        whole[place] = *value;
    }
}

#[cfg(test)]
mod tests;
