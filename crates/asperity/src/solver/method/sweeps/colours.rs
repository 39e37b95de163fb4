//! Sweeps in the order of colours: contacts of one colour do not influence each other, so that they may be visited side by
//! side, and nobody can tell from the result whether they were.

use super::visitor::first_found;
use crate::contact::{ContactProblem, ContactState, Members};
use crate::solver::one_contact::block::Block;
use crate::solver::one_contact::solve::{Candidates, Found, OneContact};
use crate::threads;

/// Contacts that one thread visits at a time, some tens of microseconds.
const GRAIN: usize = 128;

/// The contacts of every colour.
#[derive(Debug, Clone, Default)]
pub(super) struct Colours {
    contacts: Members,
    /// What the visits to the contacts of one colour have come to.
    visited: Vec<Visited>,
}

/// What a visit to a contact has come to.
#[derive(Debug, Clone, Copy, Default)]
struct Visited {
    percussion: [f64; 4],
    found: Option<Found>,
}

/// What is known before contacts are visited.
#[derive(Clone, Copy)]
pub(super) struct Before<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) history: &'a [ContactState],
    pub(super) blocks: &'a [Block],
    /// Whether this is the first sweep.
    pub(super) first: bool,
}

/// What sweeps change.
pub(super) struct Changed<'a> {
    pub(super) percussion: &'a mut [f64],
    pub(super) states: &'a mut [ContactState],
}

impl Colours {
    /// Gives every contact the first colour that none has which influences it or is influenced by it.
    pub(super) fn of(problem: &ContactProblem) -> Self {
        let count = problem.contacts().len();
        let mut colours: Vec<usize> = Vec::with_capacity(count);
        // An operator need not be symmetric: who is influenced by a contact is told when that gets its colour.
        let mut influenced: Vec<Vec<usize>> = vec![Vec::new(); count];
        let (mut taken, mut most) = (Vec::new(), 0);
        for i in 0..count {
            let neighbours = problem.delassus().blocks().neighbours(i);
            taken.clear();
            taken.append(&mut influenced[i]);
            taken.extend(neighbours.iter().filter_map(|&j| colours.get(j)));
            taken.sort_unstable();
            taken.dedup();
            let free = taken.iter().enumerate().take_while(|(place, colour)| place == *colour);
            let colour = free.count();
            for &j in neighbours.iter().filter(|&&j| j > i) {
                influenced[j].push(colour);
            }
            colours.push(colour);
            most = most.max(colour + 1);
        }
        let mut contacts = Members::default();
        contacts.group(most, colours.into_iter());
        Self { contacts, visited: Vec::new() }
    }

    /// Number of colours.
    pub(super) fn count(&self) -> usize {
        self.contacts.count()
    }

    /// The contacts of a colour, ascending.
    pub(super) fn contacts(&self, colour: usize) -> &[usize] {
        self.contacts.of(colour)
    }

    /// One sweep, contacts of a colour side by side in the pool that this is called in; the last contact that had no
    /// solution.
    pub(super) fn sweep_side_by_side(
        &mut self,
        before: Before<'_>,
        changed: Changed<'_>,
    ) -> Option<usize> {
        let Self { contacts, visited } = self;
        let Changed { percussion, states } = changed;
        let mut stuck = None;
        for colour in 0..contacts.count() {
            let contacts = contacts.of(colour);
            visited.clear();
            visited.resize(contacts.len(), Visited::default());
            visit(before, (&*percussion, &*states), contacts, visited);
            for (&i, visited) in contacts.iter().zip(&*visited) {
                let rows = before.problem.contacts()[i].rows();
                percussion[rows.clone()].copy_from_slice(&visited.percussion[..rows.len()]);
                match visited.found {
                    Some(found) => (states[i].phase, states[i].slip) = (found.phase, found.slip),
                    None => stuck = Some(i),
                }
            }
        }
        stuck
    }
}

/// Visits contacts that do not influence each other, half of them in another thread where they are many.
fn visit(
    before: Before<'_>,
    now: (&[f64], &[ContactState]),
    contacts: &[usize],
    visited: &mut [Visited],
) {
    if contacts.len() > GRAIN {
        let half = contacts.len() / 2;
        let (left, right) = contacts.split_at(half);
        let (left_visited, right_visited) = visited.split_at_mut(half);
        threads::join(
            || visit(before, now, left, left_visited),
            || visit(before, now, right, right_visited),
        );
        return;
    }
    let Before { problem, history, blocks, first } = before;
    let (percussion, states) = now;
    let mut candidates = Candidates::default();
    for (&i, visited) in contacts.iter().zip(visited) {
        let rows = problem.contacts()[i].rows();
        let held = problem.contact_velocity(i, percussion, false);
        let contact = OneContact { problem, contact: i, block: &blocks[i], held };
        let own = &mut visited.percussion[..rows.len()];
        own.copy_from_slice(&percussion[rows]);
        let state = (&history[i], &states[i], first);
        visited.found = first_found(contact, state, own, &mut candidates);
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;
    use crate::contact::NormalForce;
    use crate::law::FrictionLaw;

    /// Contacts of one colour influence each other in neither direction, and few colours do for few neighbours.
    #[test]
    fn contacts_of_one_colour_do_not_influence_each_other() {
        let count = 40;
        let mut delassus = DMatrix::identity(count, count);
        for i in 0..count {
            // The one influences the other, which does not answer.
            let j = (7 * i + 3) % count;
            if i != j {
                delassus[(i, j)] = 0.1;
            }
        }
        let law = FrictionLaw::<1>::isotropic(0.5).unwrap();
        let contacts = vec![(law.into(), NormalForce::Prescribed(1.0)); count];
        let problem = ContactProblem::new(delassus.clone(), vec![1.0; count], contacts).unwrap();
        let colours = Colours::of(&problem);
        let mut seen = vec![false; count];
        for colour in 0..colours.count() {
            let own = colours.contacts(colour);
            for (&i, &j) in own.iter().flat_map(|i| own.iter().map(move |j| (i, j))) {
                assert!(i == j || delassus[(i, j)] == 0.0, "{i} and {j} have colour {colour}");
            }
            own.iter().for_each(|&i| assert!(!std::mem::replace(&mut seen[i], true)));
        }
        assert!(seen.iter().all(|seen| *seen));
        assert!(colours.count() <= 4, "{} colours", colours.count());
    }
}
