//! Contacts around the one with the largest defect, solved as a problem of their own beside others that are held.
//!
//! Newton's method and the proximal point iteration stall where a few contacts change their states in turn, whatever the
//! others do. A problem of these contacts and of those around them is small and solved by all methods from the start; with
//! its percussions in place of the old ones the iterations of the whole begin where what has stalled them is over. This is
//! nonlinear elimination (\[LanzkronRoseWilkes1996\]).
//!
//! The problem of a neighbourhood need not have a solution: whatever its percussions are, they are only a start.

use super::measure::natural_residual::{Measured, residual_of};
use super::measure::stop::{Measure, Stop};
use super::method::{Progress, Task};
use super::report::Method;
use crate::contact::{ContactProblem, Memory, Part, put, take};

// Constants were changed on 18 random problems: `pile` of `tests/test_many_contacts.py` with numbers of 12 decimals
// (`with_decimals`), four contacts between the same two bodies and 400 (seed 3), 450 (14, 31), 480 (12), 500 (0, 19, 30),
// 520 (9, 10, 15, 27, 35), 560 (7, 23) and 600 contacts (28), hard ones among 360 of these sizes, and those of 1000 contacts of
// seeds 55, 94 and 123 of the long test there. All of them are solved to 1e-10, in 73 s; with neighbourhoods for the first start of
// the proximal point iteration only, four are not. With numbers of 9 to 12 decimals, which are 72 problems, one and ten are not, in
// 380 s and 343 s. It is chance in part which ones a value solves.

/// Contacts of the neighbourhoods that follow each other until one halves the natural map; after the last one another start is
/// looked for, which has neighbourhoods of its own.
///
/// Two of 60, 80, 120 and 200 contacts each take 93, 100, 64 and 91 s, and 1, 1, 0 and 0 of the 18 problems are not solved; one of 80
/// and one of 200 take 58 s for all. Over 9 to 11 decimals two of 120 take 259 s and leave two unsolved, these three 308 s and one.
/// Where starts after the first have one neighbourhood only, of 80 or 200 contacts, four of the 72 are not solved.
const SIZES: [usize; 3] = [80, 80, 200];
/// Fewest contacts of a problem that has neighbourhoods: 150 such random problems of 240, 300 and 360 contacts (seeds 0 to 49)
/// are solved without.
const FEWEST: usize = 400;
/// Contacts next to the worst one around which no other neighbourhood is begun, unless this one has helped: some bodies with
/// four contacts each.
const CORE: usize = 20;
/// Tolerance, relative to that of the whole, so that what is left does not come from the neighbourhood, and the smallest
/// one that rounding allows for.
const ACCURACY: f64 = 0.1;
const FINEST: f64 = 1e-13;

/// A neighbourhood to be solved from what was remembered `before`; `found` receives what is remembered next.
pub(super) struct Neighbourhood<'a> {
    pub(super) problem: &'a ContactProblem,
    pub(super) stop: Stop<'a>,
    pub(super) before: &'a Memory,
    pub(super) found: &'a mut Memory,
}

/// Neighbourhoods of a problem.
#[derive(Debug, Clone, Default)]
pub(super) struct Neighbourhoods {
    /// Natural map of the best percussions since the start when the first of those was begun that have not helped, and their
    /// number.
    grade: f64,
    in_vain: usize,
    /// Contacts near which they were.
    tried: Vec<bool>,
    /// Contacts of the present one, and whether each contact of the whole is among them.
    contacts: Vec<usize>,
    chosen: Vec<bool>,
    percussion: Vec<f64>,
    velocity: Vec<f64>,
}

impl Neighbourhoods {
    /// Whether the problem is large enough to have some, and no neighbourhood itself.
    pub(super) fn are_made(task: Task<'_>) -> bool {
        !task.within_another && task.problem.contacts().len() >= FEWEST
    }

    /// Begins with another problem or from another start, or goes on where one has helped.
    pub(super) fn prepare(&mut self, problem: &ContactProblem) {
        (self.grade, self.in_vain) = (f64::INFINITY, 0);
        self.tried.clear();
        self.tried.resize(problem.contacts().len(), false);
    }

    /// Gives the contacts around the worst one to `solve`, which tells its factorisations; the best percussions since the
    /// iteration started, with those of the neighbourhood in place of the old ones. `None` if neighbourhoods of all sizes have
    /// not helped, if the problem is small or is a neighbourhood itself.
    pub(super) fn solve(
        &mut self,
        progress: &mut Progress<'_>,
        solve: impl FnOnce(Neighbourhood<'_>) -> usize,
    ) -> Option<&[f64]> {
        let task = progress.task;
        let problem = task.problem;
        if !Self::are_made(task) {
            return None;
        }
        let grade = progress.start_from_latest(&mut self.percussion);
        if grade < 0.5 * self.grade {
            self.prepare(problem);
            self.grade = grade;
        }
        let Some(&size) = SIZES.get(self.in_vain) else {
            // The iteration starts anew, and neighbourhoods with it.
            self.prepare(problem);
            return None;
        };
        self.in_vain += 1;
        self.velocity.resize(problem.rows(), 0.0);
        problem.velocity(&self.percussion, &mut self.velocity);
        self.choose(problem, size);
        let Self { contacts, percussion, velocity, .. } = self;
        let mut part = Part::new(problem, contacts);
        part.copy_velocities_beside(problem, percussion, velocity);
        let mut before = Memory::new(part.problem().rows(), contacts.len());
        take(part.rows(), percussion, &mut before.percussion);
        take(part.contacts(), task.history, &mut before.states);
        let tolerance = (ACCURACY * task.stop.tolerance).max(FINEST);
        let stop = Stop { tolerance, measure: Measure::Contact, ..task.stop };
        let mut found = Memory::default();
        let (problem, before) = (part.problem(), &before);
        let factorizations = solve(Neighbourhood { problem, stop, before, found: &mut found });
        put(part.rows(), &found.percussion, percussion);
        progress.grade(percussion);
        progress.record(Method::Neighbourhood, 1, factorizations);
        Some(&self.percussion)
    }

    /// Chooses the worst contact where nothing was tried in vain, and those around it: neighbours, their neighbours, and so on, up
    /// to `size` contacts.
    fn choose(&mut self, problem: &ContactProblem, size: usize) {
        let Self { tried, contacts, chosen, percussion, velocity, .. } = self;
        let measured = Measured { problem, percussion, velocity };
        let untried = (0..tried.len()).filter(|&i| !tried[i]);
        let worst = residual_of(&measured, untried).worst_contact;
        chosen.clear();
        chosen.resize(tried.len(), false);
        contacts.clear();
        contacts.push(worst);
        chosen[worst] = true;
        let mut next = 0;
        while next < contacts.len() && contacts.len() < size {
            for &other in problem.delassus().blocks().neighbours(contacts[next]) {
                if !std::mem::replace(&mut chosen[other], true) {
                    contacts.push(other);
                }
            }
            next += 1;
        }
        contacts.truncate(size);
        contacts.iter().take(CORE).for_each(|&i| tried[i] = true);
        contacts.sort_unstable();
    }
}
