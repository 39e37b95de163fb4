//! Contacts around the one with the largest defect, solved as a problem of their own beside others that are held.
//!
//! Newton's method and the proximal point iteration stall where a few contacts change their states in turn, whatever the
//! others do. A problem of these contacts and of those around them is small and solved by all methods from the start; with
//! its percussions in place of the old ones the iterations of the whole begin where what has stalled them is over. This is
//! nonlinear elimination (\[LanzkronRoseWilkes1996\]).

use super::measure::natural_residual::{Measured, residual_of};
use super::measure::stop::{Measure, Stop};
use super::method::{Past, Progress};
use super::report::Method;
use super::{Solver, Start, Workspace};
use crate::contact::{ContactProblem, Memory, Part, put, take};

/// Contacts of a neighbourhood.
const CONTACTS: usize = 200;
/// Fewest contacts of a problem that has neighbourhoods: of fewer contacts one would be a good part of the whole.
const FEWEST: usize = 400;
/// Neighbourhoods without success, after which another start is looked for.
const IN_VAIN: usize = 2;
/// Of a neighbourhood, the part next to the worst contact within which no other one is begun unless it has helped.
const CORE: usize = 20;
/// Accuracy, in tolerances of the whole.
const ACCURACY: f64 = 0.1;

/// Neighbourhoods of a problem, and the buffers in which they are solved.
#[derive(Debug, Clone, Default)]
pub(super) struct Neighbourhoods {
    /// Natural map of the best percussions when the first of those was begun that have not helped, and their number.
    grade: f64,
    in_vain: usize,
    /// Contacts near which they were.
    tried: Vec<bool>,
    /// Contacts of the present one, nearer ones first, and whether each contact of the whole is among them.
    contacts: Vec<usize>,
    chosen: Vec<bool>,
    percussion: Vec<f64>,
    velocity: Vec<f64>,
    memory: Memory,
    workspace: Option<Box<Workspace>>,
}

impl Neighbourhoods {
    /// Begins with another problem.
    pub(super) fn prepare(&mut self, problem: &ContactProblem) {
        (self.grade, self.in_vain) = (f64::INFINITY, 0);
        self.tried.clear();
        self.tried.resize(problem.contacts().len(), false);
    }

    /// Solves the contacts around the worst one, of the best percussions; with their own percussions these are where the
    /// iterations of the whole may begin. `None` if that has not helped before or if the problem is small.
    pub(super) fn solve(&mut self, progress: &mut Progress<'_>) -> Option<&[f64]> {
        let problem = progress.task.problem;
        if problem.contacts().len() < FEWEST {
            return None;
        }
        let grade = progress.start_from_best(&mut self.percussion);
        if grade < 0.5 * self.grade {
            self.prepare(problem);
            self.grade = grade;
        }
        if self.in_vain == IN_VAIN {
            return None;
        }
        self.in_vain += 1;
        self.velocity.resize(problem.rows(), 0.0);
        problem.velocity(&self.percussion, &mut self.velocity);
        self.choose(problem);
        let mut part = Part::new(problem, &self.contacts);
        part.copy_velocities_beside(problem, &self.percussion, &self.velocity);
        self.memory = Memory::new(part.problem().rows(), self.contacts.len());
        take(part.rows(), &self.percussion, &mut self.memory.percussion);
        let stop = Stop {
            tolerance: ACCURACY * progress.task.stop.tolerance,
            measure: Measure::Contact,
            ..progress.task.stop
        };
        let before = std::mem::take(&mut self.memory);
        let start = Start { before: &before, past: Past::Unswept, within_another: true };
        let solver = Solver::Auto { interior_point: true, threads: 1 };
        let workspace = self.workspace.get_or_insert_default();
        workspace.restart(part.problem());
        solver.solve_many(part.problem(), stop, start, &mut self.memory, workspace);
        put(part.rows(), &self.memory.percussion, &mut self.percussion);
        let factorizations = workspace.stages.iter().map(|stage| stage.factorizations).sum();
        progress.record(Method::Neighbourhood, 1, factorizations);
        Some(&self.percussion)
    }

    /// Chooses the worst contact where nothing was tried in vain, and those around it: neighbours, their neighbours, and so on.
    fn choose(&mut self, problem: &ContactProblem) {
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
        while next < contacts.len() && contacts.len() < CONTACTS {
            for &other in problem.delassus().blocks().neighbours(contacts[next]) {
                if !std::mem::replace(&mut chosen[other], true) {
                    contacts.push(other);
                }
            }
            next += 1;
        }
        contacts.truncate(CONTACTS);
        contacts.iter().take(CORE).for_each(|&i| tried[i] = true);
        contacts.sort_unstable();
    }
}
