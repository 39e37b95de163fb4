//! Block Gauss–Seidel island by island: contacts that influence each other, directly or by others, are swept until they
//! are solved before the next ones are looked at.
//!
//! What an island does depends on nothing else, and its data stay in the cache of the processor while it is swept; all
//! contacts together would be fetched from memory in every sweep, until the slowest island has converged.

use super::cost::Cost;
use super::rate::{LEAST_SWEEPS, MOST_SWEEPS, Rate};
use super::swept::Swept;
use super::task::{Iterate, Task};
use super::visitor::{Visitor, untimed_visits};
use crate::contact::{ContactProblem, Members};
use crate::solver::measure::approach::Approach;
use crate::solver::measure::natural_map::map_of;
use crate::solver::measure::natural_residual::{Measured, residual_of};
use crate::solver::measure::own::Percussions;
use crate::solver::measure::phase::phase_of;
use crate::solver::measure::stop::{Measure, Stop};
use crate::solver::one_contact::solve::Policy;
use crate::solver::report::Ended;
use crate::threads::LEAF;

/// How islands are swept.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    /// What is asked of contacts that influence others; those that do not are solved once, with proof.
    pub(crate) policy: Policy,
    /// Residual that ends the sweeps over an island.
    pub(crate) goal: f64,
    /// Sweeps over an island after which it is left.
    pub(crate) max_sweeps: usize,
}

impl Plan {
    /// Sweeps that end the work.
    pub(crate) fn exact(stop: &Stop<'_>, max_sweeps: usize) -> Self {
        let goal = f64::max(0.1 * stop.tolerance, 4.0 * f64::EPSILON);
        Self { policy: Policy::Prove, goal, max_sweeps }
    }

    /// Sweeps while their rate promises an end, which other methods bring about else.
    pub(crate) fn trial(stop: &Stop<'_>) -> Self {
        let goal = 0.5 * stop.tolerance;
        Self { policy: Policy::FirstFound, goal, max_sweeps: MOST_SWEEPS }
    }

    /// Whether other methods go on with an island, which ask at their end what is asked here of one that is solved.
    fn leaves(&self, swept: &Swept, tolerance: f64) -> bool {
        self.policy == Policy::FirstFound && !(swept.residual().value <= tolerance)
    }
}

impl Visitor<'_> {
    /// Sweeps islands one after the other; `swept` receives what each has come to, the last of them where the stop has ended
    /// it early.
    pub(super) fn solve_islands(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        plan: Plan,
        islands: &Members,
        swept: &mut Vec<Swept>,
    ) {
        swept.clear();
        let mut visited = LEAF;
        for members in (0..islands.count()).map(|island| islands.of(island)) {
            let mut own = self.solve_island(task, iterate, plan, (members, &mut visited));
            let is_left = plan.leaves(&own, task.stop.tolerance);
            let is_early = own.ended == Ended::TimeLimit;
            if !is_early && !is_left && members.len() > 1 {
                for &i in members {
                    iterate.ambiguous[i] = self.is_ambiguous(task, iterate, i);
                    own.ambiguous |= iterate.ambiguous[i];
                }
            }
            if own.may_grow && !is_left {
                let Iterate { percussion, velocity, .. } = iterate;
                let measured = Measured { problem: task.problem, percussion, velocity };
                let contacts = members.iter().copied();
                let approach = Approach::of(&measured, contacts, task.stop.tolerance);
                own.may_grow = approach.has_grown() || approach.flaw().is_some();
            }
            swept.push(own);
            if is_early {
                break;
            }
        }
    }

    /// Sweeps over the contacts of one island; `visited` counts contacts since the last look at the clock.
    fn solve_island(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        plan: Plan,
        (members, visited): (&[usize], &mut usize),
    ) -> Swept {
        let alone = members.len() == 1;
        let policy = if alone { Policy::Prove } else { plan.policy };
        let goal = plan.goal * plan.goal;
        // Where percussions are those of a solution already, as in a body at rest, nothing has to be done.
        let mut swept = match policy {
            Policy::Prove if plan.max_sweeps > 0 => {
                Swept { defect: f64::INFINITY, ..Swept::NOTHING }
            }
            _ => self.measure(task, iterate, members, task.stop.measure),
        };
        // What the rate is judged by: one measure from beginning to end.
        let mut grade = f64::INFINITY;
        let (mut sweeps, mut stuck, mut visits) = (0, None, None);
        let (mut rate, mut max_sweeps) = (Rate::default(), plan.max_sweeps);
        if policy == Policy::FirstFound && !(swept.defect <= goal) {
            // Methods that follow sweeps begin with an attempt by Newton's method where that is worth it, too.
            let cost = Cost::of(task.problem, members.iter().copied());
            rate = Rate::new(cost.first_estimate());
            if cost.is_large() {
                max_sweeps = LEAST_SWEEPS;
                rate.wait(LEAST_SWEEPS);
            }
        }
        // The comparison also finds what is not a number.
        while !(swept.defect <= goal) {
            let in_vain = policy == Policy::FirstFound
                && sweeps > 0
                && rate.is_due(sweeps)
                && !rate.promises(sweeps, grade, task.stop.tolerance);
            if sweeps == max_sweeps || alone && sweeps == 1 || in_vain {
                let ended = if alone && sweeps == 1 { Ended::Done } else { Ended::MaxIterations };
                swept.ended = if swept.ended == Ended::Done { ended } else { swept.ended };
                break;
            }
            stuck = self.visit_all(task, iterate, policy, sweeps == 0, members.iter().copied());
            sweeps += 1;
            // To measure takes half as long as to sweep.
            let is_due = policy == Policy::Prove || rate.is_due(sweeps);
            let is_measured = is_due || sweeps == max_sweeps;
            if is_measured {
                (swept, grade) = match policy {
                    Policy::Prove => {
                        (self.measure(task, iterate, members, task.stop.measure), grade)
                    }
                    Policy::FirstFound => self.measure_if_near(task, iterate, members),
                };
            }
            if alone {
                swept.ambiguous = iterate.ambiguous[members[0]];
                swept.ended = stuck.map_or(Ended::Done, Ended::Stuck);
            }
            let all = || untimed_visits(task.problem, members.iter().copied());
            *visited += *visits.get_or_insert_with(all);
            if *visited >= LEAF {
                *visited = 0;
                if task.stop.early() {
                    if !is_measured {
                        swept = self.measure(task, iterate, members, task.stop.measure);
                    }
                    return Swept { sweeps, ended: Ended::TimeLimit, alone, ..swept };
                }
            }
        }
        if !plan.leaves(&swept, task.stop.tolerance) {
            swept = with_worst_contact(task, iterate, members, swept);
        }
        if policy == Policy::FirstFound {
            let Iterate { percussion, velocity, states, .. } = iterate;
            let measured = Measured { problem: task.problem, percussion, velocity };
            for &i in members {
                let (phase, slip) = phase_of(&measured, i);
                states[i] = task.history[i].after(phase, slip);
            }
        }
        Swept { sweeps, stuck: stuck.is_some(), alone, ..swept }
    }

    /// Velocities and residual by a measure of an island; the worst contact only where contacts are
    /// measured.
    fn measure(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        members: &[usize],
        measure: Measure,
    ) -> Swept {
        let (problem, residuals) = (task.problem, measure == Measure::Contact);
        let Iterate { percussion, velocity, .. } = iterate;
        let measurement = Measurement { problem, percussion, velocity, members, residuals };
        let swept = pulp::Arch::new().dispatch(measurement);
        match measure {
            Measure::Contact => swept,
            Measure::Global => {
                let (map, _) = map_of(&Measured { problem, percussion, velocity }, members);
                Swept { defect: map * map, ..swept }
            }
        }
    }

    /// What the island has come to by the measure of the stop, or by the natural map where that is far from small, and its natural
    /// map.
    fn measure_if_near(
        &mut self,
        task: &Task<'_>,
        iterate: &mut Iterate<'_>,
        members: &[usize],
    ) -> (Swept, f64) {
        let swept = self.measure(task, iterate, members, Measure::Global);
        let map = swept.residual().value;
        if task.stop.measure == Measure::Contact && task.stop.is_near(map, members.len()) {
            (self.measure(task, iterate, members, Measure::Contact), map)
        } else {
            (swept, map)
        }
    }
}

/// The same with the contact that has the largest defect also where another measure decides.
fn with_worst_contact(
    task: &Task<'_>,
    iterate: &Iterate<'_>,
    members: &[usize],
    swept: Swept,
) -> Swept {
    if task.stop.measure == Measure::Contact {
        return swept;
    }
    let Iterate { percussion, velocity, .. } = iterate;
    let measured = Measured { problem: task.problem, percussion, velocity };
    let worst_contact = residual_of(&measured, members.iter().copied()).worst_contact;
    Swept { worst_contact, ..swept }
}

/// A call that the compiler copies into every set of instructions: it multiplies all rows of an island. Multiplications and
/// additions stay apart, with the same bits in all of them.
struct Measurement<'a> {
    problem: &'a ContactProblem,
    percussion: &'a [f64],
    velocity: &'a mut [f64],
    members: &'a [usize],
    /// Whether contacts are measured, or only moved.
    residuals: bool,
}

impl pulp::NullaryFnOnce for Measurement<'_> {
    type Output = Swept;

    #[inline(always)]
    fn call(self) -> Swept {
        let Self { problem, percussion, velocity, members, residuals } = self;
        let percussions = Percussions::of(problem, members, percussion);
        // Contacts that influence each other are asked how they move at the end.
        let mut swept = Swept { may_grow: true, ..Swept::NOTHING };
        for &i in members {
            if residuals {
                let defect = percussions.measure(problem, i, velocity);
                swept = swept.and(Swept { defect, worst_contact: i, ..Swept::NOTHING });
            } else {
                percussions.move_one(problem, i, velocity);
            }
        }
        swept
    }
}
