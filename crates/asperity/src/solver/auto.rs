//! The order in which [`Solver::Auto`](super::Solver::Auto) asks the methods, and each of them alone.
//!
//! Sweeps end many problems and give the others a start. Where hardly a contact separates, one factorisation tells whether
//! everything stands, and the interior point method begins with what it says. Where a factorisation is dear, accelerated
//! sweeps come before others, then ADMM, which needs few of them, and over-relaxed sweeps. Newton's method ends problems of full
//! rank and, with other prox parameters, those in which contacts creep; the interior point method, where the laws allow it,
//! and the proximal point iteration end the rest. Where that is lost, contacts around the worst one are solved by themselves
//! (`neighbourhood.rs`), and it goes on from there.
//!
//! Where an attempt by Newton's method costs less than the sweeps that are still to come, after three of them at the
//! earliest, it is made at once: a step costs as much as three to ten sweeps, but where bodies are wide or many some tens
//! to hundreds (`method/sweeps/cost.rs`). If it fails, sweeps go on as long as they promise an end.

use crate::contact::{ContactProblem, ContactState, Phase};
use crate::solver::infeasible::prove_one_contact;
use crate::solver::method::{
    ALONE, Accelerated, Admm, BESIDE, BodySweeps, Buffers, Cones, Cost, Course, Interior, Iterate,
    Limits, OVER_BODIES, OverRelaxed, Past, Progress, ProximalPoint, Rate, Reached, Standing,
    Sweeper, TRIAL_SWEEPS, Task, UNTIMED, untimed_visits,
};
use crate::solver::neighbourhood::{Neighbourhood, Neighbourhoods};
use crate::solver::newton_matrix::NewtonMatrix;
use crate::solver::report::{Ended, Method};

// Constants of this file and of `method/` were halved and doubled, those of a size of 1e-3 and less divided and multiplied
// by ten, on the "stored problems": those of up to 765 contacts in the folder that `ASPERITY_CONTACT_PROBLEMS` names,
// without the rock pile, 31 in all, by `asperity solve`. `Auto` solves all of them by the global measure with 2644
// iterations and 1043 factorisations. When first attempts came, it took 1448 and 1073 of them, in 0.63 of the time
// (geometric mean) of 2502 and 828 without. Numbers at constants that were there before are from then, or from before
// islands were solved one by one, when it took 1787 and 621; it solved all of them with every value that this file
// names. Numbers changed by up to 5 % where only the rounding of factorisations did: what is less says that it hardly
// matters.

/// Newton iterations of a step of the attempt where none was made before: enough where `G` has full rank, and soon over
/// where it has not.
/// Half as many save 14 factorisations on the stored problems, twice as many cost 59.
const ATTEMPT: usize = 6;
/// Iterations of the interior point method, after which the proximal point method starts: half as many cost 105
/// factorisations on the stored problems, twice as many 19.
const INTERIOR: usize = 40;
/// Outer steps of the last phase, which a limit of time ends before where there is one.
const OUTER: usize = 5000;
/// The same where there are neighbourhoods: every start is followed up to four times or more, once before them and once after each,
/// and where factorisations are cheap it takes 300 steps in vain until it is lost. 5000 steps ended an arch of 110 stones, asked
/// for 1e-17, after three of eight new starts; it takes 11173 for all.
const OUTER_BESIDE: usize = 3 * OUTER;
/// Natural map below which Newton's method finds the digits that rounding keeps from the interior point method;
/// tried earlier it fails, later it is not tried. No stored problem depends on it.
const POLISHED: f64 = 1e-4;
/// Natural map at which the interior point method, whose digits end there, hands over: a tenth of it costs 44
/// factorisations on the stored problems, ten times as much saves eight.
const INTERIOR_GOAL: f64 = 1e-7;

// The following were changed on "piles and columns": `problems.pile` of 3 to 8 layers, with friction 0.1, 0.3 and 0.5, at rest
// and with free velocities of 0.3 m/s, and `problems.columns` of 3, 6, 12, 18, 26, 36, 46 and 70 columns of ten spheres, friction 0.1 and 0.5.
// With the spheres in a box of the stored problems they are 53 (`benches/hard_problems.py --dear`), all but one or two of which
// `Auto` solves in 4 s.

/// Sweeps that a factorisation takes as long as, from which on accelerated ones are tried before it: with 2, 4, 16 and 32
/// piles and columns take 0.90, 1.00, 1.10 and 1.30 times as long (geometric mean). Of the stored problems only the spheres in
/// a box come to more than 8, and take 0.93 times as long as without.
const DEAR: f64 = 8.0;
/// Factorisations that accelerated sweeps may take as many operations as. With 15, 30 and 120 piles and columns take 1.06, 1.01
/// and 1.01 times as long, when there were no over-relaxed sweeps.
const WORTH: f64 = 60.0;
/// Natural map from which on Newton's method itself, without a proximal term, ends what accelerated sweeps have begun, and
/// its iterations: a tenth and ten times of the one, half and twice of the other change the time of piles and columns by 2 %.
const IDENTIFIED: f64 = 1e-5;
const FROM_SWEEPS: usize = 30;

// The following were changed on the 195 piles and columns of `benches/hard_problems.py --wide`, of 6 s at most each. Chance has a
// part in it: numbers of sweeps are chaotic. They take 77 s without over-relaxed sweeps and patience, and nine are not solved.

/// Factorisations that accelerated sweeps may take as many operations as until they have halved the natural map, where over-relaxed
/// ones follow. By the clock ten are 7 of piles with 225 contacts, 18 with 960, and 29 and 41 of columns with 3000 and 6120,
/// since operations on large fronts are quicker.
///
/// | factorisations | time | not solved |
/// |---|---|---|
/// | 10 | 60 s | 4 |
/// | 20 | 67 s | 5 |
/// | 40 | 69 s | 6 |
const SWEEPS_PATIENCE: f64 = 10.0;
/// Factorisations that over-relaxed sweeps may take as many operations as: a fifth of them before Newton's method is tried with
/// other parameters, the rest after the first turn of the proximal point iteration. With all of them before, a pile of nine layers,
/// which Newton's method ends, takes 9 s in place of 2 s.
const FIRST_OVER_RELAXED: f64 = 100.0;
const LAST_OVER_RELAXED: f64 = 400.0;
/// Factorisations within which that turn must halve the natural map, and the same with second sweeps that begin with the best
/// percussions, not where the first ones have led. The last columns are 48 piles of other velocities; all on a slower machine than
/// that of the table above. All but the last row lies within chance: three runs of one code took 71, 79 and 87 s and left five, six
/// and seven problems.
///
/// | factorisations | time | not solved | from the best | not solved | other piles | not solved |
/// |---|---|---|---|---|---|---|
/// | 0 | | | 85 s | 5 | | |
/// | 2 | 75 s | 5 | 78 s | 6 | 78 s | 10 |
/// | 12 | 73 s | 5 | | | 79 s | 10 |
/// | 30 | 75 s | 6 | 77 s | 6 | 82 s | 10 |
/// | 100 | | | 77 s | 7 | | |
/// | 400 | | | 84 s | 10 | | |
const FIRST_PROXIMAL: usize = 12;
/// Natural map at which over-relaxed sweeps end, and above which they are made: a tenth and five times of it changed the time of
/// 27 of these problems by 2 %.
const SETTLED_GOAL: f64 = 2e-6;

/// Factorisations that have not halved the natural map, after which the last phase is lost where accelerated sweeps came
/// before: what they end with may be a bad start. Of two random problems of 1000 contacts (seeds 7 and 19 of the long test
/// of `tests/test_many_contacts.py`) one is not solved in a minute with 700, the other with 200. Where factorisations are
/// cheap, walls of other engines go on for a thousand of them, and end.
const PATIENCE: usize = 400;
/// The same in a neighbourhood, and new starts there: what is found is only a start for the whole. The 18 problems of
/// `neighbourhood.rs` take 73 s; with half and twice of the one 109 and 79 s, with eight of the other 108 s, and one is not solved
/// with half of the one and with eight of the other.
const NEAR_PATIENCE: usize = 100;
const NEAR_STARTS: usize = 3;
/// Fewest contacts of what may stand by itself: fewer are as soon solved by Newton's method.
const MANY: usize = 64;
/// Contacts from which on it is asked after `SETTLED` sweeps whether they stand, not when sweeps promise nothing more, which
/// may take hundreds: their data do not stay in the cache of the processor, which is what sweeps wait for and factorisations
/// do not. A wall of 10⁵ contacts takes 0.56 of the time. Of the stored problems one of 376 contacts, which slips, takes 1.6
/// times as long where it is asked early. Asked after one sweep in place of three, walls of 10⁴ and 10⁵ contacts take 0.91 of
/// the time, after six 1.12; three are the fewest after which `rate.rs` judges sweeps (`LEAST_SWEEPS`).
const LARGE: usize = 1000;
const SETTLED: usize = 3;
/// Sweeps that a factorisation takes as long as at most for that: 47 in a wall of 10⁵ contacts.
const EARLY: f64 = 100.0;

/// The methods with their buffers, and the matrix that they share.
#[derive(Debug, Clone, Default)]
pub(crate) struct Methods {
    buffers: Buffers,
    matrix: NewtonMatrix,
    proximal: ProximalPoint,
    cones: Cones,
    interior: Interior,
    admm: Admm,
    standing: Standing,
    dear_sweeps: DearSweeps,
    neighbourhoods: Neighbourhoods,
}

impl Methods {
    /// Forgets what depends on `G`.
    pub(crate) fn reset(&mut self) {
        self.matrix.reset();
    }

    /// The methods in the order that the head of this file names; neighbourhoods are given to `solve`.
    pub(crate) fn automatic(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        with_interior: bool,
        mut solve: impl FnMut(Neighbourhood<'_>) -> usize,
    ) -> Reached {
        let Self { buffers, matrix, proximal, cones, interior, admm, .. } = self;
        let Self { standing, dear_sweeps, neighbourhoods, .. } = self;
        let mut progress = Progress::new(task, iterate, sweeper, buffers);
        let First { mut tried, dear, resting } =
            first_attempts(&mut progress, matrix, proximal, cones, standing, dear_sweeps);
        if !progress.is_over()
            && let Some(contact) = progress.stuck()
        {
            // A contact that sweeps could not solve may have no solution whatever the others do.
            let percussion = &*progress.iterate.percussion;
            let proof = prove_one_contact(task.problem, contact, percussion);
            *progress.iterate.infeasibility = proof;
        }
        let conic = with_interior && !progress.is_over() && cones.read(task.problem);
        if conic && let Some(expected) = resting {
            // Where hardly anything separates, the interior point method knows where to begin.
            let course = Course { max_iterations: INTERIOR, goal: 0.0, expected };
            interior.iterate(&mut progress, cones, matrix, course);
        }
        if conic && dear && !progress.is_over() {
            admm.iterate(&mut progress, cones, matrix, usize::MAX, (BESIDE, false));
        }
        if dear && !progress.is_over() {
            tried |= dear_sweeps.over_relax(&mut progress, matrix, proximal, cones, Turn::First);
        }
        if !progress.is_over() && !tried {
            proximal.attempt(&mut progress, matrix, ATTEMPT);
        }
        // Also where factorisations are dear: of the 200 random problems of 1000 contacts that `PATIENCE` names it solved three
        // that the proximal point iteration, then without neighbourhoods, did not solve in a minute.
        if !progress.is_over() {
            proximal.attempt_matched(&mut progress, matrix);
        }
        if conic && resting.is_none() && !progress.is_over() {
            let course = Course { max_iterations: INTERIOR, goal: INTERIOR_GOAL, expected: 0.0 };
            interior.iterate(&mut progress, cones, matrix, course);
        }
        if !progress.is_over() {
            let steps = if Neighbourhoods::are_made(task) { OUTER_BESIDE } else { OUTER };
            let mut over_relaxes = dear && dear_sweeps.are_over_relaxed(&task);
            let limits = match (task.within_another, dear) {
                (true, _) => Limits { steps, patience: NEAR_PATIENCE, starts: NEAR_STARTS },
                (_, true) => {
                    let patience = if over_relaxes { FIRST_PROXIMAL } else { PATIENCE };
                    Limits { patience, ..Limits::of_steps(steps) }
                }
                _ => Limits::of_steps(steps),
            };
            neighbourhoods.prepare(task.problem);
            let mut outer = proximal.begin(&mut progress, limits);
            while proximal.follow(&mut progress, matrix, &mut outer) {
                if std::mem::take(&mut over_relaxes) {
                    let turn = Turn::Last;
                    dear_sweeps.over_relax(&mut progress, matrix, proximal, cones, turn);
                    if progress.is_over() {
                        break;
                    }
                    let limits = Limits { patience: PATIENCE, ..outer.left };
                    outer = proximal.begin(&mut progress, limits);
                    continue;
                }
                let goes_on = match neighbourhoods.solve(&mut progress, &mut solve) {
                    Some(start) => proximal.start_from(&mut progress, matrix, &mut outer, start),
                    None => proximal.start_anew(&mut progress, matrix, &mut outer),
                };
                if !goes_on {
                    break;
                }
            }
        }
        let known = |state: &ContactState| state.phase != Phase::Unknown;
        if progress.is_solved() && task.history.iter().any(known) {
            progress.continue_states(TRIAL_SWEEPS);
        }
        progress.finish(false)
    }

    /// One method alone.
    pub(crate) fn single(
        &mut self,
        task: Task<'_>,
        iterate: Iterate<'_>,
        sweeper: &mut Sweeper,
        method: Method,
        max_iterations: usize,
    ) -> Reached {
        let Self { buffers, matrix, proximal, cones, interior, admm, .. } = self;
        let mut progress = Progress::new(task, iterate, sweeper, buffers);
        let conic = matches!(method, Method::InteriorPoint | Method::Admm);
        if conic && !cones.read(task.problem) {
            let ended = Ended::NotApplicable;
            return Reached { iterations: 0, ended, ..progress.finish(false) };
        }
        proximal.prepare(task.problem);
        matrix.prepare(task.problem);
        let limited = match method {
            Method::InteriorPoint => {
                let course = Course { max_iterations, goal: 0.0, expected: 0.0 };
                let limited = interior.iterate(&mut progress, cones, matrix, course);
                if !limited && !progress.is_over() && progress.best_grade() < POLISHED {
                    proximal.attempt(&mut progress, matrix, ATTEMPT);
                }
                limited
            }
            Method::Admm => {
                admm.iterate(&mut progress, cones, matrix, max_iterations, (ALONE, true))
            }
            Method::Newton => proximal.newton_alone(&mut progress, matrix, max_iterations),
            _ => proximal.iterate(&mut progress, matrix, max_iterations),
        };
        progress.finish(limited)
    }
}

/// Sweeps; the percussions with which nothing moves; accelerated sweeps where factorisations are dear, which Newton's method
/// ends where they come near to a solution; else, and where they do not, an attempt by Newton's method if that costs less
/// than to go on with sweeps, and further sweeps where it fails.
fn first_attempts(
    progress: &mut Progress<'_>,
    matrix: &mut NewtonMatrix,
    proximal: &mut ProximalPoint,
    cones: &mut Cones,
    standing: &mut Standing,
    dear_sweeps: &mut DearSweeps,
) -> First {
    let problem = progress.task.problem;
    let contacts = problem.contacts().len();
    let cost = Cost::of(problem, 0..contacts);
    let estimate = cost.first_estimate();
    let mut sweeps = Sweeps::new(estimate, problem);
    let mut first = First { tried: false, dear: false, resting: None };
    // Where sweeps were made before, as long as they were worth it, and a contact had no solution in the last of them, one more
    // tells which.
    let past = progress.task.past;
    let early = contacts >= LARGE && cost.is_sparse();
    let most = if early { SETTLED } else { usize::MAX };
    if early {
        sweeps.rate.wait(SETTLED);
    }
    let goes_on = past != Past::Swept && sweeps.run(progress, past == Past::Stuck, most);
    let mut settled = None;
    if early && !progress.is_over() && progress.may_stand() {
        matrix.prepare(problem);
        if cost.sweeps(matrix.operations(problem)) <= EARLY {
            settled = Some(sweeps.count);
            sweeps.record(progress, 0, false);
            first.resting = standing.attempt(progress, matrix);
            if progress.is_over() {
                return first;
            }
        }
    }
    if goes_on {
        sweeps.run(progress, past == Past::Stuck, usize::MAX);
    }
    let mut instead = 0.0;
    if !progress.is_over() {
        matrix.prepare(problem);
        instead = cost.attempt(matrix.operations(problem));
        sweeps.rate.instead_of(instead);
        if past == Past::Unswept || instead > estimate {
            sweeps.run(progress, false, usize::MAX);
        }
    }
    let none = settled.is_none() && past != Past::Swept;
    sweeps.record(progress, settled.unwrap_or(0), none);
    if progress.is_over() {
        return first;
    }
    proximal.prepare(problem);
    if contacts < MANY || !progress.may_stand() {
        // Further sweeps may have opened what seemed to stand.
        first.resting = None;
    } else if settled.is_none() {
        first.resting = standing.attempt(progress, matrix);
    }
    let sweeps_per_factorization = cost.sweeps(matrix.operations(problem));
    first.dear = sweeps_per_factorization > DEAR;
    if !progress.is_over() && first.dear {
        dear_sweeps.read(problem, cones, sweeps_per_factorization);
        dear_sweeps.accelerate(progress, cones);
        if !progress.is_over() && progress.best_grade() < IDENTIFIED {
            proximal.newton_alone(progress, matrix, FROM_SWEEPS);
            first.tried = true;
        }
    }
    // From what rests, the interior point method is asked first.
    let in_vain = first.tried || first.resting.is_some() || instead > Rate::WORTHWHILE;
    if progress.is_over() || in_vain {
        return first;
    }
    proximal.first_attempt(progress, matrix);
    first.tried = true;
    if !progress.is_over() {
        let before = sweeps.count;
        // What follows may take hundreds of factorisations, and many more from a worse start.
        sweeps.rate = Rate::default();
        sweeps.run(progress, false, usize::MAX);
        sweeps.record(progress, before, false);
    }
    first
}

/// Turns of over-relaxed sweeps.
#[derive(Debug, Clone, Copy)]
enum Turn {
    First,
    Last,
}

/// Sweeps in place of factorisations that are dear.
#[derive(Debug, Clone, Default)]
struct DearSweeps {
    bodies: BodySweeps,
    /// Whether sweeps may go over the velocities of bodies.
    over_bodies: bool,
    /// Sweeps over the blocks of `G` that a factorisation takes as many operations as.
    factorization: f64,
    accelerated: Accelerated,
    over_relaxed: OverRelaxed,
}

impl DearSweeps {
    /// Reads a problem of which a factorisation takes as many operations as so many sweeps over the blocks of `G`.
    fn read(&mut self, problem: &ContactProblem, cones: &mut Cones, factorization: f64) {
        self.over_bodies = cones.read(problem) && self.bodies.read(problem, cones);
        self.factorization = factorization;
    }

    /// Sweeps with as many operations as so many factorisations.
    fn worth(&self, factorizations: f64) -> usize {
        let of_blocks = (factorizations * self.factorization) as usize;
        if self.over_bodies { OVER_BODIES * of_blocks } else { of_blocks }
    }

    /// Whether over-relaxed sweeps follow accelerated ones that bring nothing. What is found in a neighbourhood is only a start for
    /// the whole, and is not worth so much time.
    fn are_over_relaxed(&self, task: &Task<'_>) -> bool {
        self.over_bodies && !task.within_another
    }

    /// Accelerated sweeps from the best percussions.
    fn accelerate(&mut self, progress: &mut Progress<'_>, cones: &Cones) {
        let patient = self.are_over_relaxed(&progress.task);
        let patience = if patient { self.worth(SWEEPS_PATIENCE) } else { usize::MAX };
        let most = self.worth(WORTH);
        let bodies = self.over_bodies.then_some(&mut self.bodies);
        self.accelerated.iterate(progress, bodies, cones, most, patience);
    }

    /// Where no percussions are near to a solution, over-relaxed sweeps over the velocities of bodies, in the second turn from
    /// where those of the first have led, until the states of contacts settle, from where accelerated sweeps and Newton's method
    /// go on; whether that was tried.
    fn over_relax(
        &mut self,
        progress: &mut Progress<'_>,
        matrix: &mut NewtonMatrix,
        proximal: &mut ProximalPoint,
        cones: &Cones,
        turn: Turn,
    ) -> bool {
        if !self.are_over_relaxed(&progress.task) {
            return false;
        }
        if matches!(turn, Turn::First) {
            self.over_relaxed.begin(progress);
        }
        if progress.best_grade() < SETTLED_GOAL {
            return false;
        }
        let most = self.worth(match turn {
            Turn::First => FIRST_OVER_RELAXED,
            Turn::Last => LAST_OVER_RELAXED,
        });
        self.over_relaxed.iterate(progress, &mut self.bodies, cones, SETTLED_GOAL, most);
        if progress.is_over() || progress.best_grade() >= SETTLED_GOAL {
            return false;
        }
        self.accelerate(progress, cones);
        if progress.is_over() {
            return false;
        }
        proximal.newton_alone(progress, matrix, FROM_SWEEPS);
        true
    }
}

/// What the first attempts have come to.
struct First {
    /// Whether Newton's method was tried.
    tried: bool,
    /// Whether factorisations cost far more than sweeps.
    dear: bool,
    /// Size of the percussions of bodies that rest upon each other, where they do.
    resting: Option<f64>,
}

/// Sweeps that go on.
struct Sweeps {
    rate: Rate,
    count: usize,
    /// What a sweep counts for between two looks at the clock, and what has been counted since the last one: at first as much as
    /// asks for one.
    visits: usize,
    untimed: usize,
}

impl Sweeps {
    /// In place of something that takes as long as so many sweeps.
    fn new(instead: f64, problem: &ContactProblem) -> Self {
        let visits = untimed_visits(problem, 0..problem.contacts().len());
        Self { rate: Rate::new(instead), count: 0, visits, untimed: UNTIMED }
    }

    /// Records what was done after the first `before` sweeps, if it was anything, or also if it was nothing.
    fn record(&self, progress: &mut Progress<'_>, before: usize, nothing_too: bool) {
        if self.count > before || nothing_too {
            progress.record(Method::GaussSeidel, self.count - before, 0);
        }
    }

    /// Sweeps while their rate promises an end, or once; whether it still does after so many in all.
    fn run(&mut self, progress: &mut Progress<'_>, once: bool, count: usize) -> bool {
        while !progress.is_solved() {
            if self.count >= count {
                return true;
            }
            progress.sweep();
            self.count += 1;
            let ends = once || self.is_late(progress.task);
            if !ends && !self.rate.is_due(self.count) {
                continue;
            }
            let grade = progress.grade_sweeps();
            if ends || !self.rate.promises(self.count, grade, progress.task.stop.tolerance) {
                break;
            }
        }
        false
    }

    /// Whether the stop says, when it is asked, that nobody waits any longer.
    fn is_late(&mut self, task: Task<'_>) -> bool {
        self.untimed += self.visits;
        if self.untimed < UNTIMED {
            return false;
        }
        self.untimed = 0;
        task.stop.early()
    }
}
