//! Proofs by cases that a few contacts have no solution.
//!
//! Every contact is open, sticks, or slips in a direction of some sector. In one such case percussions lie in cones
//! (for prescribed normal percussions in bounded sets), and velocities, too:
//!
//! | state | percussion | velocity |
//! |---|---|---|
//! | any | `−P_T ∈ P_N C`, `P_N ≥ 0` | `ξ_N ≥ 0` |
//! | open | `P = 0` | `ξ_N ≥ 0` |
//! | closed | `−P_T ∈ P_N C` | `ξ_N = 0` |
//! | stick | `−P_T ∈ P_N C` | `ξ = 0` |
//! | slip | `−P_T = P_N x`, `x = z/k_C(z)` with `z ∈ bdry D` where a normal is in the sector | `ξ_N = 0`, `ξ_T` in the sector |
//!
//! A case holds no solution if there is a vector `z` of the rows with `z·ξ ≤ 0` for all its velocities and
//! `(Gᵀz)·P ≥ 0` for all its percussions, but `z·(b + e γ_B) > 0`: then
//! `0 ≥ z·ξ = (Gᵀz)·P + z·(b + e γ_B) > 0`. By Farkas' lemma there is one wherever the convex hull of the case is empty.
//! Cases are split until each has its `z`: any into open and closed, closed into stick and slip, sectors into halves.
//! `G` may have any rank: a hinge, whose rows all see one direction of motion, can only move along one line in the
//! space of its velocities, which restitution shifts away from rest. With `ξ_N = 0` its slip is known then,
//! and friction that belongs to it may pull the contact to the surface.
//!
//! As in `closing.rs`, `(Gᵀz)·P ≥ 0` holds up to the rounding of `G`, in scaled rows.

use std::f64::consts::{FRAC_PI_2, PI};

use asperity_set::Vector;
use nalgebra::{DMatrix, DVector};

use super::closing::{HUGE, keeps_lost_bodies_at_rest};
use super::nonnegative;
use super::proof::{Case, CaseState, Infeasibility, InfeasibilityKind};
use crate::contact::{ContactProblem, Delassus, NormalForce};
use crate::law::BoundaryPiece;
use crate::linear::LeastNorm;
use crate::solver::measure::stop::Stop;

/// Most contacts that influence each other: the number of cases grows with the power of it.
const MOST_CONTACTS: usize = 6;
/// Most cases that are looked at; those of two hinges are some twenty, of a hinge and feet some hundred
/// (the random systems of `tests/test_random_systems.py`).
const MOST_CASES: usize = 600;
/// Halvings of a quadrant of slip directions. Pieces of the boundary of *D* are not cut any finer.
const HALVINGS: i32 = 10;
/// Percussions that are added to those with which a vector is sought. Of this number, of the cases and of the pieces
/// below a quarter and four times as much prove the same of 18 random systems whose motions have no solution or whose
/// percussions are not found (`tests/test_random_systems.py`).
const CUTS: usize = 16;
/// Of every so many pieces of the boundary one makes the first percussions.
const FIRST: usize = 64;
/// Part of the largest friction by which percussions are enlarged when a vector is sought, and angle by which sectors
/// are: it then holds for those that lie between. A tenth and ten times as much of either prove the same of those systems.
const SLACK: f64 = 1e-3;
const OPENING: f64 = 1e-4;
/// Distance to the percussions and velocities of a case, relative to the loads, that counts as none.
const EMPTY: f64 = 1e-8;
/// Smallest `z·(b + e γ_B)` relative to the terms of its sum.
const MARGIN: f64 = 1e-9;
/// Components of `z` below this part of the largest are none.
const SMALLEST: f64 = 1e-9;
/// `−(Gᵀz)·P` in scaled rows, relative to `Σ |z_i|` and `P`, that rounding of the entries of `G` explains.
const EXPLAINED: f64 = 4.0 * f64::EPSILON;
/// Components of `Gᵀz` against `z` that count as none, in scaled rows, before they are made none.
const VANISHING: f64 = 1e-9;
/// What is left of a column of the longest one's size by rounding.
const ROUNDING: f64 = 1e-13;
/// `(Gᵀz)·P` below this part of its terms is small enough to ask whether `G` holds the masses.
const NEARLY: f64 = 1e-10;

/// What a search by cases finds.
pub(crate) enum ByCases {
    /// The contacts have no solution together.
    NoSolution(Infeasibility),
    /// Percussions of a case that is as narrow as cases get: near a solution, if there is one.
    Candidate(Vec<f64>),
    /// Neither.
    Undecided,
}

/// Searches a proof that the contacts that influence `contact` have no solution together.
pub(crate) fn search_cases(problem: &ContactProblem, stop: Stop<'_>, contact: usize) -> ByCases {
    let Some(group) = Group::new(problem, contact) else { return ByCases::Undecided };
    let mut search = Search {
        group: &group,
        stop,
        left: MOST_CASES,
        found: Vec::new(),
        residual: 0.0,
        candidate: None,
    };
    let refuted = search.refute(&mut vec![CaseState::Any; group.members.len()]);
    let Search { found, residual, candidate, .. } = search;
    if refuted.is_none() {
        let candidate = candidate.map(|scaled| group.percussions(&scaled, problem.rows()));
        return candidate.map_or(ByCases::Undecided, ByCases::Candidate);
    }
    let cases = found.into_iter().map(|(states, z)| group.widened(problem, &states, &z)).collect();
    let mut direction = vec![0.0; problem.rows()];
    direction[problem.contacts()[contact].offset] = 1.0;
    ByCases::NoSolution(Infeasibility {
        kind: InfeasibilityKind::Cases,
        contact,
        direction,
        closing_velocity: f64::max(0.0, -problem.load(contact)[0]),
        residual,
        cases,
    })
}

/// A contact in scaled rows, `s_N P_N` and `s_T P_T`.
struct Member {
    contact: usize,
    /// Its first row in the group, and how many are normal and tangential ones.
    first: usize,
    normal: usize,
    tangential: usize,
    /// `s_T P_N` where it is prescribed.
    prescribed: Option<f64>,
    /// `s_N`, `s_T`.
    scales: [f64; 2],
    /// The boundary, points times `s_T/s_N`, or as they are if the normal percussion is prescribed.
    pieces: Vec<BoundaryPiece>,
    /// Largest radius of *C* in the same units.
    radius: f64,
}

/// Contacts that influence each other, as a small dense problem in scaled rows.
struct Group<'a> {
    members: Vec<Member>,
    matrix: DMatrix<f64>,
    load: DVector<f64>,
    /// The largest load, which is the unit of percussions.
    unit: f64,
    /// The operator, if it knows the masses.
    delassus: &'a Delassus,
    offsets: Vec<usize>,
}

impl<'a> Group<'a> {
    fn new(problem: &'a ContactProblem, contact: usize) -> Option<Self> {
        if problem.delassus().is_matrix_free() {
            return None;
        }
        // Those that appear in the rows of the group: their percussions are all that moves it.
        let mut contacts = vec![contact];
        let mut next = 0;
        while next < contacts.len() {
            let rows = &problem.contacts()[contacts[next]];
            for row in rows.rows() {
                problem.each_entry(contacts[next], row, |j, _, g| {
                    if g != 0.0 && !contacts.contains(&j) && contacts.len() <= MOST_CONTACTS {
                        contacts.push(j);
                    }
                });
            }
            next += 1;
        }
        if contacts.len() > MOST_CONTACTS {
            return None;
        }
        contacts.sort_unstable();
        let mut members = Vec::with_capacity(contacts.len());
        let mut first = 0;
        for &contact in &contacts {
            let member = Member::new(problem, contact, first)?;
            first += member.normal + member.tangential;
            members.push(member);
        }
        let mut matrix = DMatrix::zeros(first, first);
        let mut load = DVector::zeros(first);
        let mut offsets = vec![0; first];
        for member in &members {
            let offset = problem.contacts()[member.contact].offset;
            let loads = problem.load(member.contact);
            for (k, b) in loads.into_iter().enumerate().take(member.normal + member.tangential) {
                let row = member.first + k;
                offsets[row] = offset + k;
                load[row] = b / member.scale(k);
                problem.each_entry(member.contact, offset + k, |j, column, g| {
                    if let Some(other) = members.iter().find(|other| other.contact == j) {
                        let l = column - problem.contacts()[j].offset;
                        matrix[(row, other.first + l)] = g / (member.scale(k) * other.scale(l));
                    }
                });
            }
        }
        let unit = load.amax();
        let finite = matrix.iter().chain(load.iter()).all(|v| v.is_finite());
        if !(finite && unit > 0.0) {
            return None;
        }
        // Percussions that are not given are as large as the loads make them.
        load /= unit;
        for member in &mut members {
            member.prescribed = member.prescribed.map(|value| value / unit);
        }
        Some(Self { members, matrix, load, unit, delassus: problem.delassus(), offsets })
    }

    /// States and vector of the group on all contacts and rows.
    fn widened(&self, problem: &ContactProblem, states: &[CaseState], z: &DVector<f64>) -> Case {
        let mut all = vec![CaseState::Any; problem.contacts().len()];
        for (member, state) in self.members.iter().zip(states) {
            all[member.contact] = *state;
        }
        Case { states: all, direction: self.on_rows(z, problem.rows()) }
    }

    /// Percussions of the group on the rows of the problem, zero at other contacts.
    fn percussions(&self, scaled: &DVector<f64>, rows: usize) -> Vec<f64> {
        let mut percussion = vec![0.0; rows];
        for member in &self.members {
            for k in 0..member.normal + member.tangential {
                let row = member.first + k;
                percussion[self.offsets[row]] = self.unit * scaled[row] / member.scale(k);
            }
        }
        percussion
    }

    /// `z` on the rows of the problem, with magnitudes that add up to one.
    fn on_rows(&self, z: &DVector<f64>, rows: usize) -> Vec<f64> {
        let mut direction = vec![0.0; rows];
        for member in &self.members {
            for k in 0..member.normal + member.tangential {
                direction[self.offsets[member.first + k]] = z[member.first + k] / member.scale(k);
            }
        }
        let sum: f64 = direction.iter().map(|v| v.abs()).sum();
        direction.iter_mut().for_each(|v| *v /= sum);
        direction
    }
}

impl Member {
    fn new(problem: &ContactProblem, contact: usize, first: usize) -> Option<Self> {
        let rows = &problem.contacts()[contact];
        let (normal, tangential) = (rows.normal_rows(), rows.law.dimension());
        let own = |k: usize| problem.delassus().own(contact, k, k);
        // One scale for all tangential rows, so that it does not matter how they are chosen.
        let tangent: f64 = (normal..normal + tangential).map(own).sum();
        let s_t = (tangent / tangential as f64).sqrt();
        let (s_n, prescribed) = match rows.normal {
            NormalForce::Unilateral => (own(0).sqrt(), None),
            NormalForce::Prescribed(value) => (1.0, Some(s_t * value)),
        };
        let unit = if prescribed.is_some() { 1.0 } else { s_t / s_n };
        let pieces = rows.law.boundary(unit)?;
        let radius = pieces.iter().map(|p| p.ends[0].norm()).fold(0.0, f64::max);
        Some(Self {
            contact,
            first,
            normal,
            tangential,
            prescribed,
            scales: [s_n, s_t],
            pieces,
            radius,
        })
    }

    /// Scale of one of its rows.
    fn scale(&self, k: usize) -> f64 {
        self.scales[usize::from(k >= self.normal)]
    }

    /// The pieces whose friction belongs to a state.
    fn pieces(&self, state: CaseState) -> impl Iterator<Item = &BoundaryPiece> {
        self.pieces.iter().filter(move |piece| match state {
            CaseState::Open => false,
            CaseState::Any | CaseState::Closed | CaseState::Stick => true,
            CaseState::Slip { from, to } => has_normal_between(piece, from, to),
        })
    }

    /// The tangential part of a vector of the rows.
    fn tangent(&self, vector: &DVector<f64>) -> Vector<2> {
        let first = self.first + self.normal;
        Vector::<2>::from_fn(|k, _| if k < self.tangential { vector[first + k] } else { 0.0 })
    }

    /// The most of `y_T·x` that friction of a state may reach, and the point where it does.
    fn most(&self, state: CaseState, y: &Vector<2>) -> (f64, Vector<2>) {
        let rest = match state {
            // Star-shaped sets hold zero.
            CaseState::Any | CaseState::Closed | CaseState::Stick => 0.0,
            _ => f64::NEG_INFINITY,
        };
        let size = y.norm();
        let outward = if size > 0.0 { y / size } else { *y };
        let ends = self.pieces(state).flat_map(|piece| piece.ends.map(|x| (x, piece.stray)));
        ends.fold((rest, Vector::<2>::zeros()), |most, (x, stray)| {
            let reached = y.dot(&x) + size * stray;
            if reached > most.0 { (reached, x + outward * stray) } else { most }
        })
    }
}

/// Whether a piece has a normal between two angles; rounding counts it in.
fn has_normal_between(piece: &BoundaryPiece, from: f64, to: f64) -> bool {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from) + 1e-9);
    let (sine, cosine) = middle.sin_cos();
    let angle = |n: Vector<2>| (cosine * n.y - sine * n.x).atan2(cosine * n.x + sine * n.y);
    let [a, b] = piece.normals.map(angle);
    // A piece that turns through the far side begins behind its end.
    if a <= b + 1e-9 { a <= half && b >= -half } else { a <= half || b >= -half }
}

/// The search for a vector in each case.
struct Search<'a, 'b> {
    group: &'a Group<'a>,
    stop: Stop<'b>,
    left: usize,
    found: Vec<(Vec<CaseState>, DVector<f64>)>,
    /// Largest part of `(Gᵀz)·P` that is left to rounding.
    residual: f64,
    /// Percussions of a case that could neither be refuted nor be split.
    candidate: Option<DVector<f64>>,
}

/// What the search for a vector finds in a case.
enum Examined {
    /// There is no solution.
    Empty(DVector<f64>),
    /// Percussions and velocities that the hull of the case allows.
    Hull { percussion: DVector<f64>, velocity: DVector<f64> },
}

impl Search<'_, '_> {
    /// Refutes a case, in parts if need be; `None` if that does not succeed.
    fn refute(&mut self, states: &mut Vec<CaseState>) -> Option<()> {
        if self.left == 0 || self.stop.early() {
            return None;
        }
        self.left -= 1;
        let (percussion, velocity) = match self.examine(states)? {
            Examined::Empty(z) => {
                self.found.push((states.clone(), z));
                return Some(());
            }
            Examined::Hull { percussion, velocity } => (percussion, velocity),
        };
        let Some(k) = self.split(states, &percussion, &velocity) else {
            self.candidate = Some(percussion);
            return None;
        };
        let whole = states[k];
        for part in self.parts(&self.group.members[k], whole) {
            states[k] = part;
            self.refute(states)?;
        }
        states[k] = whole;
        Some(())
    }

    /// The member whose state is split: the one whose percussion and velocity violate most of what was left out.
    fn split(&self, states: &[CaseState], p: &DVector<f64>, xi: &DVector<f64>) -> Option<usize> {
        let members = &self.group.members;
        let best = (0..members.len()).map(|k| {
            let (member, state) = (&members[k], states[k]);
            let push = member.prescribed.unwrap_or(p[member.first]);
            // Ranks: contacts that separate and push, then closed ones, then sectors.
            let (rank, worth) = match state {
                CaseState::Any if member.prescribed.is_some() => (1, push),
                CaseState::Any if push.min(xi[member.first]) > EMPTY => {
                    (3, push.min(xi[member.first]))
                }
                CaseState::Any => (1, push),
                CaseState::Closed => (2, push),
                CaseState::Slip { from, to } if to - from > FRAC_PI_2 * 0.5_f64.powi(HALVINGS) => {
                    (0, push * (to - from))
                }
                _ => (0, 0.0),
            };
            (rank, worth, k)
        });
        let worth = best.filter(|(_, worth, _)| *worth > EMPTY);
        worth.max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))).map(|(_, _, k)| k)
    }

    fn parts(&self, member: &Member, state: CaseState) -> Vec<CaseState> {
        match state {
            CaseState::Any if member.prescribed.is_none() => {
                vec![CaseState::Open, CaseState::Closed]
            }
            CaseState::Any | CaseState::Closed => {
                let quadrant = |k: usize| {
                    let from = FRAC_PI_2 * k as f64 - PI;
                    CaseState::Slip { from, to: from + FRAC_PI_2 }
                };
                let line = [0.0, PI].map(|angle| CaseState::Slip { from: angle, to: angle });
                let slips = if member.tangential == 1 {
                    line.to_vec()
                } else {
                    (0..4).map(quadrant).collect()
                };
                [vec![CaseState::Stick], slips].concat()
            }
            CaseState::Slip { from, to } => {
                let middle = 0.5 * (from + to);
                vec![CaseState::Slip { from, to: middle }, CaseState::Slip { from: middle, to }]
            }
            CaseState::Open | CaseState::Stick => Vec::new(),
        }
    }

    /// Searches a vector that refutes a case: the part of the loads that no percussions and velocities of its hull
    /// explain.
    fn examine(&mut self, states: &[CaseState]) -> Option<Examined> {
        let group = self.group;
        let mut system = Combination::new(group, states);
        let mut hull = None;
        for _ in 0..CUTS {
            let (z, found) = system.solve()?;
            let Some(z) = z else { return Some(found) };
            hull = Some(found);
            match self.verdict(states, &z) {
                Verdict::Refuted(residual) => {
                    self.residual = self.residual.max(residual);
                    return Some(Examined::Empty(z));
                }
                Verdict::Missed(points) => {
                    if points.is_empty() {
                        break;
                    }
                    for (k, x) in points {
                        system.push(k, &x);
                    }
                }
            }
        }
        hull
    }

    /// Whether a vector refutes a case; if not, friction that it does not hold for.
    fn verdict(&self, states: &[CaseState], z: &DVector<f64>) -> Verdict {
        let Group { members, matrix, load, .. } = self.group;
        let (y, rounding) = (matrix.tr_mul(z), EXPLAINED * z.abs().sum());
        let largest = z.amax();
        let (mut gap, mut terms) = (z.dot(load), z.component_mul(load).abs().sum());
        let (mut residual, mut nearly, mut missed) = (0.0_f64, false, Vec::new());
        let mut left = 0.0_f64;
        let mut holds = largest > 0.0;
        for (k, (member, &state)) in members.iter().zip(states).enumerate() {
            if !member.allows(state, z) {
                holds = false;
            }
            if state == CaseState::Open {
                continue;
            }
            let along = member.tangent(&y);
            let (most, x) = member.most(state, &along);
            let size = if along.norm() > 0.0 { along / along.norm() } else { along };
            let beyond = x + size * (SLACK * member.radius);
            match member.prescribed {
                Some(push) => {
                    gap -= push * most;
                    terms += push * most.abs();
                    missed.push((k, beyond));
                }
                None => {
                    let unit = largest * (1.0 + member.radius);
                    let rest = (y[member.first] - most) / unit;
                    nearly |= rest < NEARLY;
                    residual = residual.max(-rest);
                    left = left.max(most - y[member.first]);
                    if rest * unit < -rounding * (1.0 + member.radius) {
                        holds = false;
                        missed.push((k, beyond));
                    }
                }
            }
        }
        // What rounding leaves allows percussions beyond all bounds only, also for whoever computes `Gᵀz` in another order
        // and finds other last digits.
        holds &= gap >= HUGE * (left + f64::EPSILON * largest) * load.amax();
        // The comparisons also turn away NaN.
        if holds && gap > MARGIN * terms && (!nearly || self.keeps_masses(z)) {
            Verdict::Refuted(residual)
        } else {
            Verdict::Missed(missed)
        }
    }

    /// Whether what vanishes of `Gᵀz` does so for bodies as well that `G` has lost beside lighter ones.
    fn keeps_masses(&self, z: &DVector<f64>) -> bool {
        let Delassus::Factored(factored) = &self.group.delassus else { return true };
        let rows = factored.directions().rows();
        keeps_lost_bodies_at_rest(factored, &self.group.on_rows(z, rows))
    }
}

enum Verdict {
    Refuted(f64),
    /// Members with friction for which `(Gᵀz)·P` is negative.
    Missed(Vec<(usize, Vector<2>)>),
}

impl Member {
    /// Whether `z·ξ ≤ 0` for all velocities of a state.
    fn allows(&self, state: CaseState, z: &DVector<f64>) -> bool {
        let along = self.tangent(z);
        let normal = match state {
            CaseState::Any | CaseState::Open => self.normal == 0 || z[self.first] <= 0.0,
            _ => true,
        };
        let tangential = match state {
            CaseState::Any | CaseState::Open | CaseState::Closed => along.amax() == 0.0,
            CaseState::Stick => true,
            // A sector is at most a quadrant: its ends decide.
            CaseState::Slip { from, to } => {
                [from, to].iter().all(|angle| along.dot(&direction(*angle, self.tangential)) <= 0.0)
            }
        };
        normal && tangential
    }
}

/// The direction at an angle, on a line one of two.
fn direction(angle: f64, dimension: usize) -> Vector<2> {
    let (sine, cosine) = angle.sin_cos();
    match dimension {
        1 => Vector::<2>::new(cosine.signum(), 0.0),
        _ => Vector::<2>::new(cosine, sine),
    }
}

/// `G P − ξ = −(b + e γ_B)` with nonnegative combinations of percussions and velocities of a case.
struct Combination<'a> {
    group: &'a Group<'a>,
    states: &'a [CaseState],
    /// Rows of the group that velocities of the case restrict; one more for each prescribed normal percussion,
    /// whose friction is a mean of the friction given.
    rows: Vec<usize>,
    means: Vec<usize>,
    /// Percussions of the columns, then velocities.
    percussions: Vec<DVector<f64>>,
    /// Their members.
    owners: Vec<usize>,
    columns: Vec<DVector<f64>>,
    velocities: Vec<DVector<f64>>,
    right: DVector<f64>,
}

impl<'a> Combination<'a> {
    fn new(group: &'a Group<'a>, states: &'a [CaseState]) -> Self {
        let size = group.load.len();
        let (mut rows, mut means, mut velocities) = (Vec::new(), Vec::new(), Vec::new());
        for (k, (member, &state)) in group.members.iter().zip(states).enumerate() {
            rows.extend(member.first..member.first + member.normal);
            if member.prescribed.is_some_and(|push| push > 0.0) {
                means.push(k);
            }
            let tangent = member.first + member.normal;
            if matches!(state, CaseState::Stick | CaseState::Slip { .. }) {
                rows.extend(tangent..tangent + member.tangential);
            }
            let mut velocity = DVector::zeros(size);
            match state {
                CaseState::Any | CaseState::Open if member.normal == 1 => {
                    velocity[member.first] = 1.0;
                    velocities.push(velocity);
                }
                CaseState::Slip { from, to } => {
                    for angle in [from - OPENING, to + OPENING] {
                        let along = direction(angle, member.tangential);
                        (0..member.tangential).for_each(|j| velocity[tangent + j] = along[j]);
                        velocities.push(velocity.clone());
                    }
                }
                _ => {}
            }
        }
        let below = std::iter::repeat_n(1.0, means.len());
        let right = rows.iter().map(|&row| -group.load[row]).chain(below);
        let right = DVector::from_iterator(rows.len() + means.len(), right);
        let (percussions, columns, owners) = (Vec::new(), Vec::new(), Vec::new());
        let mut system =
            Self { group, states, rows, means, percussions, owners, columns, velocities, right };
        for (k, member) in group.members.iter().enumerate() {
            let pieces: Vec<Vector<2>> =
                member.pieces(states[k]).map(|piece| piece.ends[0]).collect();
            let step = if pieces.len() > FIRST { FIRST } else { pieces.len().div_ceil(4).max(1) };
            pieces.iter().step_by(step).for_each(|x| system.push(k, x));
        }
        system
    }

    /// Adds the percussion of a member with friction `x`.
    fn push(&mut self, k: usize, x: &Vector<2>) {
        let member = &self.group.members[k];
        let mut percussion = DVector::zeros(self.group.load.len());
        let push = member.prescribed.unwrap_or(1.0);
        if push == 0.0 {
            return;
        }
        if member.prescribed.is_none() {
            percussion[member.first] = 1.0;
        }
        let tangent = member.first + member.normal;
        (0..member.tangential).for_each(|j| percussion[tangent + j] = -push * x[j]);
        let brought = &self.group.matrix * &percussion;
        let mean = |m: &usize| if *m == k { 1.0 } else { 0.0 };
        let own = self.rows.iter().map(|&row| brought[row]).chain(self.means.iter().map(mean));
        self.columns.push(DVector::from_iterator(self.right.len(), own));
        self.percussions.push(percussion);
        self.owners.push(k);
    }

    /// A vector that the percussions and velocities given do not refute, if there is one, and those that come
    /// nearest to the loads.
    fn solve(&self) -> Option<(Option<DVector<f64>>, Examined)> {
        let count = self.right.len();
        let velocity = |v: &DVector<f64>| {
            let own = self.rows.iter().map(|&row| -v[row]);
            DVector::from_iterator(count, own.chain(self.means.iter().map(|_| 0.0)))
        };
        let mut columns = self.columns.clone();
        columns.extend(self.velocities.iter().map(velocity));
        let sizes: Vec<f64> = columns.iter().map(|c| c.norm()).collect();
        columns
            .iter_mut()
            .zip(&sizes)
            .for_each(|(c, size)| *c /= if *size > 0.0 { *size } else { 1.0 });
        let factors = match columns.is_empty() {
            true => Vec::new(),
            false => nonnegative::least_squares(&DMatrix::from_columns(&columns), &self.right)?,
        };
        let mut percussion = DVector::zeros(self.group.load.len());
        let mut rest = self.right.clone();
        let mut free = Vec::new();
        for (k, factor) in factors.iter().enumerate().filter(|(_, factor)| **factor > 0.0) {
            rest -= &columns[k] * *factor;
            free.push((self.owners.get(k).copied(), columns[k].clone()));
            if let Some(own) = self.percussions.get(k) {
                percussion += own * (*factor / sizes[k]);
            }
        }
        let velocity = &self.group.matrix * &percussion + &self.group.load;
        let hull = Examined::Hull { percussion, velocity };
        if rest.norm() <= EMPTY * self.right.norm() {
            return Some((None, hull));
        }
        Some((Some(self.sharpened(&rest, free)), hull))
    }

    /// The vector of what is left over, which is small against what it is a difference of, without the parts along
    /// the columns used.
    fn sharpened(
        &self,
        rest: &DVector<f64>,
        mut free: Vec<(Option<usize>, DVector<f64>)>,
    ) -> DVector<f64> {
        let Group { members, matrix, .. } = self.group;
        let rest =
            without(rest, &free.iter().map(|(_, column)| column.clone()).collect::<Vec<_>>());
        // Friction that takes nearly all of the resistance brings a velocity that is the rounding of others. Where
        // the vector is orthogonal to all that a contact brings, it is made so for its rows one by one.
        let y = matrix.tr_mul(&self.on_rows(&rest));
        for (k, member) in members.iter().enumerate() {
            let own = member.first..member.first + member.normal + member.tangential;
            let vanishes = own.clone().all(|row| y[row].abs() <= VANISHING);
            if !vanishes || member.prescribed.is_some() || self.states[k] == CaseState::Open {
                continue;
            }
            free.retain(|(owner, _)| *owner != Some(k));
            for column in own {
                let entries = self.rows.iter().map(|&row| matrix[(row, column)]);
                let means = self.means.iter().map(|_| 0.0);
                let entries = DVector::from_iterator(self.right.len(), entries.chain(means));
                free.push((None, entries));
            }
        }
        let mut z =
            self.on_rows(&without(&rest, &free.into_iter().map(|(_, c)| c).collect::<Vec<_>>()));
        let largest = z.amax();
        z.iter_mut().filter(|v| v.abs() < SMALLEST * largest).for_each(|v| *v = 0.0);
        for (member, state) in members.iter().zip(self.states) {
            if member.normal == 1 && matches!(state, CaseState::Any | CaseState::Open) {
                z[member.first] = z[member.first].min(0.0);
            }
        }
        z
    }

    /// A vector of the equations, with its sign turned, on the rows of the group.
    fn on_rows(&self, rest: &DVector<f64>) -> DVector<f64> {
        let mut z = DVector::zeros(self.group.load.len());
        self.rows.iter().zip(rest.iter()).for_each(|(&row, part)| z[row] = -part);
        z
    }
}

/// The unit vector along what is left of a vector without its parts along columns, until nothing but rounding is left.
fn without(vector: &DVector<f64>, columns: &[DVector<f64>]) -> DVector<f64> {
    let mut rest = vector / vector.norm();
    let factors = match columns.is_empty() {
        true => None,
        false => LeastNorm::new(DMatrix::from_columns(columns), ROUNDING),
    };
    // Once more for what rounding has left over.
    for _ in 0..3 {
        if let Some(factors) = &factors {
            let along = factors.range() * factors.range().tr_mul(&rest);
            rest -= along;
        }
        rest /= rest.norm();
    }
    rest
}
