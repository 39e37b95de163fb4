//! One contact of a problem, whatever its dimension.

use asperity_set::Vector;

use super::block::Block;
use super::line;
use super::local::Local;
use super::plane::{self, ImplicitRate};
use super::single::{ROUNDING, Single};
use super::solution::LocalSolution;
pub(crate) use super::solution::Policy;
use crate::contact::{ContactProblem, ContactState, Phase};
use crate::law::{ContactVector, Law};
use crate::vectors::largest;

/// Buffers for all solutions of a contact.
#[derive(Debug, Clone, Default)]
pub(crate) struct Candidates {
    linear: Vec<LocalSolution<1>>,
    planar: Vec<LocalSolution<2>>,
}

/// What a contact does under the percussions that it takes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) phase: Phase,
    pub(crate) slip: [f64; 3],
    /// Whether there are other solutions.
    pub(crate) ambiguous: bool,
}

/// One contact with the velocities `ξ` that the percussions of the others leave it.
#[derive(Clone, Copy)]
pub(crate) struct OneContact<'a> {
    pub(crate) problem: &'a ContactProblem,
    pub(crate) contact: usize,
    pub(crate) block: &'a Block,
    pub(crate) held: [f64; 4],
}

/// Where the solution of a contact starts from.
#[derive(Clone, Copy)]
pub(crate) struct Start<'a> {
    /// The state before the step, which decides between several solutions.
    pub(crate) history: &'a ContactState,
    /// The slip velocity from which Newton's method starts, if not from that of before, extrapolated.
    pub(crate) slip: Option<[f64; 3]>,
}

/// What one of four expressions says of a contact with the data of its dimension: without friction, on a line, in the plane,
/// in space.
macro_rules! by_dimension {
    ($contact:expr, Normal($normal:pat) => $on_the_normal:expr, Line($line:pat) => $on_line:expr, Plane($plane:pat) => $in_plane:expr, Space($space:pat) => $in_space:expr) => {{
        let OneContact { problem, contact, block, held } = *$contact;
        let rows = &problem.contacts()[contact];
        match &rows.law {
            Law::Zero(_) => {
                let $normal = &LocalSolution::on_the_normal(held[0], block.g_nn);
                $on_the_normal
            }
            Law::One(law) => {
                let $line = &Local::<1>::new(law, rows, block, &held);
                $on_line
            }
            Law::Two(law) => {
                let $plane = &Local::<2>::new(law, rows, block, &held);
                $in_plane
            }
            Law::Three(law) => {
                let entry = |i, j| problem.delassus().own(contact, i, j);
                let $space = &Single::<3>::new(law, rows.normal, entry, |i| held[i]);
                $in_space
            }
        }
    }};
}

impl<'a> OneContact<'a> {
    /// Contact `contact` with the percussions of the others held.
    pub(crate) fn new(
        problem: &'a ContactProblem,
        contact: usize,
        block: &'a Block,
        percussion: &[f64],
    ) -> Self {
        let held = problem.contact_velocity(contact, percussion, false);
        Self { problem, contact, block, held }
    }

    /// The same from the velocities `γ_E` with all percussions, which are known: without those that its own bring.
    pub(crate) fn within(
        problem: &'a ContactProblem,
        contact: usize,
        block: &'a Block,
        (percussion, velocity): (&[f64], &[f64]),
    ) -> Self {
        let rows = problem.contacts()[contact].rows();
        let own = problem.delassus().blocks().diagonal(contact);
        let (percussion, velocity) = (&percussion[rows.clone()], &velocity[rows.clone()]);
        let restitution = &problem.restitution()[rows];
        let mut held = [0.0; 4];
        for (a, g) in own.chunks_exact(percussion.len()).enumerate() {
            let brought = g.iter().zip(percussion).map(|(g, p)| g * p).sum::<f64>();
            held[a] = velocity[a] + restitution[a] - brought;
        }
        Self { problem, contact, block, held }
    }

    /// Contact `contact` that no other influences.
    #[inline(always)]
    pub(crate) fn alone(problem: &'a ContactProblem, contact: usize, block: &'a Block) -> Self {
        Self { problem, contact, block, held: problem.load(contact) }
    }

    /// Solves the contact and writes its percussions; `None` if no solution is found.
    #[inline(always)]
    pub(crate) fn solve(
        &self,
        policy: Policy,
        start: Start<'_>,
        percussion: &mut [f64],
        candidates: &mut Candidates,
    ) -> Option<Found> {
        let history = start.history;
        by_dimension!(self,
            Normal(found) => Some(keep(found, percussion)),
            Line(local) => Some(keep(&line::solve(local, history)?, percussion)),
            Plane(local) => {
                let guess = || guess(local, start.slip.unwrap_or_else(|| history.ahead()));
                let buffer = &mut candidates.planar;
                Some(keep(&plane::solve(local, history, guess, policy, buffer)?, percussion))
            },
            Space(single) => Some(keep(&self.in_space(single, history, percussion, policy)?, percussion))
        )
    }

    /// The solution with sliding and drilling friction that continues `state`, as far as a search finds it, whose failure
    /// proves nothing. Several solutions are neither listed nor recognised.
    #[inline(never)]
    fn in_space(
        &self,
        single: &Single<'_, 3>,
        state: &ContactState,
        percussion: &[f64],
        policy: Policy,
    ) -> Option<LocalSolution<3>> {
        if single.opens() {
            let open = single.graded(ContactVector::zeros(), false);
            return Some(single.solution(&open, Phase::Open));
        }
        let delassus = self.problem.delassus();
        let neighbours = delassus.blocks().neighbours(self.contact);
        let alone = neighbours.iter().all(|&other| other == self.contact);
        // Sweeps that take the first solution may come back tens of thousands of times.
        let alone = alone && policy == Policy::Prove && !delassus.is_matrix_free();
        let last = Vector::<3>::from_column_slice(&state.slip);
        let ahead = (last.amax() > 0.0).then_some(last);
        single.solve(state, ahead, percussion, alone)
    }

    /// Whether the contact has more than one solution, as far as that is known.
    pub(crate) fn is_ambiguous(&self, state: &ContactState, candidates: &mut Candidates) -> bool {
        // A redundant foot that the others stop has nothing to do: to search with what rounding has left of its load
        // would find anything or nothing.
        if largest(&self.held) <= ROUNDING * largest(&self.problem.load(self.contact)) {
            return false;
        }
        by_dimension!(self,
            Normal(_) => false,
            Line(local) => line::solve(local, state).is_some_and(|s| s.ambiguous),
            Plane(local) => {
                let guess = || guess(local, state.ahead());
                plane::solve(local, state, guess, Policy::Prove, &mut candidates.planar)
                    .is_some_and(|s| s.ambiguous)
            },
            Space(_) => false
        )
    }

    /// All solutions as percussions of the contact's rows; with drilling friction none are listed.
    pub(crate) fn visit_all(&self, visit: &mut dyn FnMut(Phase, &[f64], bool)) {
        let mut percussion = [0.0; 3];
        let own = &mut percussion[..self.problem.contacts()[self.contact].rows().len().min(3)];
        by_dimension!(self,
            Normal(found) => {
                found.store(own);
                visit(found.phase, own, false);
            },
            Line(local) => line::solutions(local).iter().flatten().for_each(|found| {
                found.store(own);
                visit(found.phase, own, found.degenerate);
            }),
            Plane(local) => {
                let mut all = Vec::new();
                plane::solutions(local, &mut all);
                all.iter().for_each(|found| {
                    found.store(own);
                    visit(found.phase, own, found.degenerate);
                });
            },
            Space(_) => {}
        );
    }

    /// The solution with a factor of the speed at the end of the step that continues `state`; `None` where there is
    /// none, and with drilling friction.
    #[cold]
    pub(crate) fn solve_implicit(
        &self,
        state: &ContactState,
        factor: &ImplicitRate<'_>,
        candidates: &mut Candidates,
    ) -> Option<ImplicitSolution> {
        by_dimension!(self,
            Normal(_) => None,
            Line(local) => {
                let all = &mut candidates.linear;
                plane::solutions_on_a_line(local, factor, all);
                ImplicitSolution::new(local, all, state, factor)
            },
            Plane(local) => {
                let all = &mut candidates.planar;
                plane::implicit_solutions(local, factor, all);
                ImplicitSolution::new(local, all, state, factor)
            },
            Space(_) => None
        )
    }

    /// Whether it is proven that the contact has no solution.
    ///
    /// With `x = −P_T/P_N` the certificate consists of three parts, each with a relative margin of 10⁻⁹, so that
    /// neither rounding nor data known to nine digits can turn it round:
    ///
    /// - the contact cannot open: `b_N < 0`;
    /// - it cannot stick: the only percussions with `GP + b = 0` pull, `P_N < 0`, or are outside, `k_C(x) > 1`;
    /// - it cannot slip: all along bdry *D* the slip velocity `v(x)` is not along the normal, `F = n × v ≠ 0`, or is
    ///   against it, or the normal force would pull, `g_NN − G_NT x < 0`. For `p = 1` these are two
    ///   points, for `p = 2` the boundary is covered by pieces over each of which one of the three holds.
    ///
    /// A block whose Schur complement has lost digits proves nothing, nor does a search that finds nothing in
    /// `p = 3`: there are contacts without a solution for which this is false.
    pub(crate) fn proves_no_solution(&self) -> bool {
        by_dimension!(self,
            Normal(_) => false,
            Line(local) => line::proves_no_solution(local),
            Plane(local) => plane::proves_no_solution(local),
            Space(_) => false
        )
    }
}

/// A start of Newton's method: a slip velocity, or the free velocity if the contact has never slipped.
#[inline]
fn guess(local: &Local<'_, 2>, slip: [f64; 3]) -> Vector<2> {
    let slip = Vector::<2>::new(slip[0], slip[1]);
    if slip.amax() == 0.0 { local.b_t } else { slip }
}

/// Writes the percussions of a solution to the contact's rows.
#[inline(always)]
fn keep<const P: usize>(found: &LocalSolution<P>, percussion: &mut [f64]) -> Found {
    found.store(percussion);
    let mut slip = [0.0; 3];
    slip[..P].copy_from_slice(found.slip.as_slice());
    Found { phase: found.phase, slip, ambiguous: found.ambiguous }
}

/// A solution of one contact in which speed and factor agree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImplicitSolution {
    pub(crate) factor: f64,
    pub(crate) state: ContactState,
    /// Normal percussion.
    pub(crate) normal: f64,
    /// Tangential percussions, to be multiplied by the factor.
    pub(crate) tangent: [f64; 2],
    /// Whether there are others.
    pub(crate) ambiguous: bool,
}

impl ImplicitSolution {
    fn new<const P: usize>(
        local: &Local<'_, P>,
        all: &[LocalSolution<P>],
        state: &ContactState,
        factor: &ImplicitRate<'_>,
    ) -> Option<Self> {
        let found = local.select(all.iter(), state)?;
        let speed = if found.phase == Phase::Slip { found.slip.norm() } else { 0.0 };
        let (mut tangent, mut slip) = ([0.0; 2], [0.0; 3]);
        tangent[..P].copy_from_slice(found.tangent.as_slice());
        slip[..P].copy_from_slice(found.slip.as_slice());
        Some(Self {
            factor: factor.falling + factor.rate.rising(speed),
            state: ContactState::new(found.phase, slip),
            normal: found.normal,
            tangent,
            ambiguous: found.ambiguous,
        })
    }
}
