//! Proofs by cases that a few contacts have no solution together.
//!
//! In a case every contact has a state, and its percussion and velocity lie in cones:
//!
//! | state | percussion | velocity |
//! |---|---|---|
//! | any | `−P_T ∈ P_N C` | `ξ_N ≥ 0` |
//! | open | `P = 0` | `ξ_N ≥ 0` |
//! | closed | `−P_T ∈ P_N C` | `ξ_N = 0` |
//! | stick | `−P_T ∈ P_N C` | `ξ = 0` |
//! | slip | `−P_T = P_N x`, `x = z/k_C(z)` with `z ∈ bdry D` where a normal is in the sector | `ξ_N = 0`, `ξ_T` in the sector |
//!
//! A case holds no solution if a vector `z` of the rows has `z·ξ ≤ 0` for all its velocities and `(Gᵀz)·P ≥ 0` for all its
//! percussions, but `z·(b + e γ_B) > 0`, since `z·ξ = (Gᵀz)·P + z·(b + e γ_B)`. By Farkas' lemma there is one wherever
//! `G P − ξ = −(b + e γ_B)` has no solution in the cones, and what the nearest combination of their generators leaves of the
//! loads is one. Cases without such a vector are divided: any into open and closed, closed into stick and slip, sectors
//! into halves. Percussions in a plane are enclosed by tangents of *C*. Prescribed normal percussions make the percussions a
//! bounded set, whose combinations have the sum one.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use asperity_set::{ConvexSet, StarSet, Vector};
use nalgebra::{DMatrix, DVector};

use super::closing::HUGE;
use super::nonnegative;
use super::proof::{Case, Infeasibility, InfeasibilityKind};
use crate::contact::{ContactProblem, ContactRows, Delassus, NormalForce};
use crate::law::{FrictionLaw, Law};
use crate::linear::LeastNorm;
use crate::solver::measure::stop::Stop;

/// Most contacts and cases; two hinges and feet of `tests/test_random_systems.py` take up to some hundred cases.
const MOST_CONTACTS: usize = 6;
const MOST_CASES: usize = 400;
/// By so much sectors and friction are widened, so that a vector is not at the limit of what it has to hold for.
const SLACK: f64 = 1e-6;
/// `−(Gᵀz)·P` and `z·ξ` in scaled rows, relative to `Σ |z_i|` and `Σ |P_j|`, that rounding of the entries of `G` explains.
const EXPLAINED: f64 = 4.0 * f64::EPSILON;
/// The same which least squares may leave, and which a vector is then taken off.
const LEFT_OVER: f64 = 1e-10;

/// What a contact does in a case; a sector is that of the direction of slip, on a line one of the angles 0 and π.
#[derive(Debug, Clone, Copy, PartialEq)]
enum State {
    Any,
    Open,
    Closed,
    Stick,
    Slip(f64, f64),
}

impl State {
    /// The states that it is divided into; none if it is not.
    fn parts(self, dimension: usize) -> Vec<Self> {
        match self {
            Self::Any => vec![Self::Open, Self::Closed],
            Self::Closed if dimension == 0 => Vec::new(),
            Self::Closed if dimension == 1 => {
                vec![Self::Stick, Self::Slip(0.0, 0.0), Self::Slip(PI, PI)]
            }
            Self::Closed => {
                let quadrant = |k| Self::Slip(k * FRAC_PI_2, (k + 1.0) * FRAC_PI_2);
                std::iter::once(Self::Stick).chain([0.0, 1.0, 2.0, 3.0].map(quadrant)).collect()
            }
            Self::Slip(from, to) if to - from > SLACK => {
                let middle = 0.5 * (from + to);
                vec![Self::Slip(from, middle), Self::Slip(middle, to)]
            }
            _ => Vec::new(),
        }
    }

    /// Directions of slip at the ends of the sector, if it is one, which is widened by `SLACK`.
    fn sector(self, dimension: usize) -> Vec<Vector<2>> {
        match self {
            Self::Slip(from, _) if dimension == 1 => vec![unit(from)],
            Self::Slip(from, to) => vec![unit(from - SLACK), unit(to + SLACK)],
            _ => Vec::new(),
        }
    }

    /// Friction −λ per unit normal force whose convex hull holds that of the state.
    fn friction(self, law: &Law) -> Option<Vec<Vector<2>>> {
        match (self, law) {
            (Self::Open, _) => Some(Vec::new()),
            (_, Law::Zero(_)) => Some(vec![Vector::<2>::zeros()]),
            (_, Law::One(law)) => {
                let end = |angle: &f64| {
                    let sign = Vector::<1>::new(angle.cos().signum());
                    Vector::<2>::new(sign.x / law.reservoir().gauge(&sign), 0.0)
                };
                let angles = if let Self::Slip(at, _) = self { vec![at] } else { vec![0.0, PI] };
                Some(wider(&angles.iter().map(end).collect::<Vec<_>>()))
            }
            (_, Law::Two(law)) => enclosure(law, self),
            (_, Law::Three(_)) => None,
        }
    }
}

/// Points that tangents of *C* meet in, and the ends of the arc that a state takes of its boundary.
fn enclosure(law: &FrictionLaw<2>, state: State) -> Option<Vec<Vector<2>>> {
    let set = law.reservoir().as_convex()?;
    let (mut first, mut turn) = (0.0, TAU);
    if let [from, to] = state.sector(2)[..] {
        let angle = |y: &Vector<2>| {
            let z = law.direction().support_point(y);
            z.y.atan2(z.x)
        };
        first = angle(&from) - SLACK;
        turn = (angle(&to) + SLACK - first).rem_euclid(TAU);
    }
    let pieces = (turn * 32.0 / PI).ceil().max(1.0);
    let boundary = |k: usize| {
        let ray = unit(first + turn * k as f64 / pieces);
        let (x, normal) = (ray / set.gauge(&ray), set.normal(&ray));
        (x, normal / normal.dot(&x))
    };
    let arc: Vec<_> = (0..=pieces as usize).map(boundary).collect();
    let mut points = wider(&[arc[0].0, arc[arc.len() - 1].0]);
    for pair in arc.windows(2) {
        let [(a, m), (b, n)] = [pair[0], pair[1]];
        // Along a flat both tangents are the same line.
        let depth = |normal: &Vector<2>, x: &Vector<2>| (1.0 - normal.dot(x)).max(f64::EPSILON);
        let (of_a, of_b) = (depth(&m, &b), depth(&n, &a));
        let shared = of_a + of_b - of_a * of_b;
        if !(shared > 0.0) {
            return None;
        }
        points.push((a * of_a + b * of_b) * ((1.0 + SLACK) / shared));
    }
    Some(points)
}

fn unit(angle: f64) -> Vector<2> {
    Vector::<2>::new(angle.cos(), angle.sin())
}

fn wider(points: &[Vector<2>]) -> Vec<Vector<2>> {
    points.iter().flat_map(|x| [x * (1.0 - SLACK), x * (1.0 + SLACK)]).collect()
}

/// A proof by cases that the contacts of an island have no solution together.
pub(crate) fn prove_by_cases(problem: &ContactProblem, stop: Stop<'_>) -> Option<Infeasibility> {
    let contacts = problem.contacts();
    // The entries of `G` do not say what heavy bodies beside light ones do.
    let is_known = matches!(problem.delassus(), Delassus::Blocks(_));
    if contacts.len() > MOST_CONTACTS || !is_known {
        return None;
    }
    let mut operator = problem.delassus().to_dense();
    let scales = operator.diagonal().map(f64::sqrt);
    let load = |(i, rows): (usize, &_)| problem.load(i).into_iter().take(ContactRows::len(rows));
    let loads = contacts.iter().enumerate().flat_map(load);
    let mut loads = DVector::from_iterator(problem.rows(), loads).component_div(&scales);
    let pressed = contacts.iter().map(|rows| match rows.normal {
        NormalForce::Unilateral => 0.0,
        NormalForce::Prescribed(push) => push * scales[rows.offset],
    });
    let largest = pressed.fold(loads.amax(), f64::max);
    loads /= largest;
    for (k, scale) in scales.iter().enumerate() {
        operator.row_mut(k).unscale_mut(*scale);
        operator.column_mut(k).unscale_mut(*scale);
    }
    if !(largest > 0.0 && operator.iter().chain(loads.iter()).all(|v| v.is_finite())) {
        return None;
    }
    let (left, cases, residual) = (MOST_CASES, Vec::new(), 0.0);
    let mut search =
        Search { problem, stop, operator, loads, scales, largest, left, cases, residual };
    let start = |rows: &ContactRows| match rows.normal {
        NormalForce::Unilateral => State::Any,
        NormalForce::Prescribed(_) => State::Closed,
    };
    search.refute(&mut contacts.iter().map(start).collect())?;
    let Search { cases, residual, .. } = search;
    let closing = (0..contacts.len()).filter(|i| contacts[*i].normal == NormalForce::Unilateral);
    let closing = closing.map(|i| (i, -problem.load(i)[0]));
    let (contact, speed) = closing.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
    let mut direction = vec![0.0; problem.rows()];
    direction[contacts[contact].offset] = 1.0;
    let (kind, closing_velocity) = (InfeasibilityKind::Cases, speed.max(0.0));
    Some(Infeasibility { kind, contact, direction, closing_velocity, residual, cases })
}

struct Search<'a> {
    problem: &'a ContactProblem,
    stop: Stop<'a>,
    /// `G` and the loads in scaled rows, these relative to the largest one.
    operator: DMatrix<f64>,
    loads: DVector<f64>,
    /// `s = √diag G`.
    scales: DVector<f64>,
    largest: f64,
    left: usize,
    cases: Vec<Case>,
    residual: f64,
}

impl Search<'_> {
    /// Refutes a case, in parts if need be; `None` if that does not succeed.
    fn refute(&mut self, states: &mut Vec<State>) -> Option<()> {
        self.left = self.left.checked_sub(1)?;
        if self.stop.early() {
            return None;
        }
        let Some(divided) = self.examine(states)? else { return Some(()) };
        self.cases.push(Case::Divided(divided));
        let whole = states[divided];
        for part in whole.parts(self.problem.contacts()[divided].law.dimension()) {
            states[divided] = part;
            self.refute(states)?;
        }
        states[divided] = whole;
        Some(())
    }

    /// The contact to divide; none if the case is empty, whose vector is added then.
    #[expect(clippy::option_option, reason = "without a vector there may be no contact to divide")]
    fn examine(&mut self, states: &[State]) -> Option<Option<usize>> {
        let (problem, scales, rows) = (self.problem, &self.scales, self.loads.len());
        // Behind the rows one for every contact, whose percussions have the sum one if they are prescribed.
        let mut right = (-&self.loads).resize_vertically(rows + states.len(), 0.0);
        let (mut columns, mut owners, mut free) = (Vec::new(), Vec::new(), Vec::new());
        for (i, (contact, state)) in problem.contacts().iter().zip(states).enumerate() {
            let (law, tangent) = (&contact.law, contact.offset + contact.normal_rows());
            let tangents = tangent..tangent + law.dimension();
            let on_rows = |along: &Vector<2>, unit: &dyn Fn(usize) -> f64| {
                let mut vector = DVector::zeros(rows);
                tangents.clone().for_each(|row| vector[row] = along[row - tangent] * unit(row));
                vector
            };
            let mut add = |vector: DVector<f64>, size: f64, mean: f64| {
                let mut column = vector.resize_vertically(rows + states.len(), 0.0);
                column[rows + i] = mean;
                columns.push(column);
                owners.push((i, size));
            };
            for direction in state.sector(law.dimension()) {
                let slip = on_rows(&-direction, &|row| 1.0 / scales[row]);
                add(&slip / slip.lp_norm(1), 0.0, 0.0);
            }
            if matches!(state, State::Any | State::Open) {
                let mut opening = DVector::zeros(rows);
                opening[contact.offset] = -1.0;
                add(opening, 0.0, 0.0);
            }
            if matches!(state, State::Any | State::Open | State::Closed) {
                free.extend(tangents.clone());
            }
            let (push, along_normal) = match contact.normal {
                NormalForce::Unilateral => (1.0 / scales[contact.offset], 1.0),
                NormalForce::Prescribed(push) => (push / self.largest, 0.0),
            };
            right[rows + i] = 1.0 - along_normal;
            let own = tangent.min(contact.rows().end - 1);
            for x in state.friction(law)? {
                let mut percussion = on_rows(&-x, &|row| push * scales[row]);
                if contact.normal == NormalForce::Unilateral {
                    percussion[contact.offset] = along_normal;
                    percussion /= percussion.lp_norm(1);
                }
                add(&self.operator * percussion, push * scales[own], 1.0 - along_normal);
            }
        }
        let mut generators = DMatrix::from_columns(&columns);
        for &row in &free {
            right[row] = 0.0;
            generators.row_mut(row).fill(0.0);
        }
        let factors = nonnegative::least_squares(&generators, &right)?;
        let mut rest = &right - &generators * DVector::from_column_slice(&factors);
        let mut spanned: Vec<usize> = (0..factors.len()).filter(|k| factors[*k] > 0.0).collect();
        for _ in 0..3 {
            if !spanned.is_empty() {
                let span = LeastNorm::new(generators.select_columns(&spanned), 1e-14)?;
                for _ in 0..2 {
                    rest -= span.range() * span.range().tr_mul(&rest);
                }
            }
            free.iter().for_each(|&row| rest[row] = 0.0);
            // What rounding leaves allows for percussions and velocities beyond all bounds only, also for whoever computes
            // in another order and finds other last digits.
            let (seen, sum) = (generators.tr_mul(&rest), rest.lp_norm(1));
            let left = seen.max().max(0.0);
            if sum > 0.0
                && left <= EXPLAINED * sum
                && right.dot(&rest) >= HUGE * (left + f64::EPSILON * sum)
            {
                self.residual = self.residual.max(left / sum);
                let direction = (0..rows).map(|row| -rest[row] / (sum * scales[row]));
                self.cases.push(Case::Empty(direction.collect()));
                return Some(None);
            }
            let rounding = |k: &usize| seen[*k] > 0.0 && seen[*k] <= LEFT_OVER * sum;
            spanned.extend((0..seen.len()).filter(rounding));
        }
        let mut worth = vec![0.0; states.len()];
        factors.iter().zip(owners).for_each(|(factor, (i, size))| worth[i] += factor * size);
        for (i, (worth, state)) in worth.iter_mut().zip(states).enumerate() {
            *worth *= match state {
                State::Any => 2.0 * TAU,
                State::Closed if problem.contacts()[i].law.dimension() > 0 => TAU,
                State::Slip(from, to) if to - from > SLACK => to - from,
                _ => 0.0,
            };
        }
        let divided = (0..worth.len()).max_by(|&i, &j| worth[i].total_cmp(&worth[j]));
        divided.filter(|i| worth[*i] > 0.0).map(Some)
    }
}

#[cfg(test)]
mod tests;
