//! Percussions that run away.
//!
//! Residuals are relative to percussions: where these grow without bound while contacts go on approaching, as
//! they do where no percussions are admissible, every relative defect becomes small. Sums of powers tell
//! such growth from the large percussions that heavy bodies on light ones do need. Over the unilateral contacts
//! `i` of a group of contacts that influence each other, with `l_i` the velocity that the contact would have
//! without unilateral percussions,
//!
//! `Q = Σ P_Ni max(0, −ξ_Ni)`, `L = Σ P_Ni |l_i|`, `N = |Σ P_Ni l_i|`, `A = Σ P_Ni Σ_j |G_ij P_j|`.
//!
//! `Q`, and the like sum over separating contacts, vanishes at solutions. Percussions that run away leave
//! `Q ≈ N` however large they are, for `Σ P_Ni (G P)_i` falls behind. `A/L` is how far velocities that
//! percussions bring cancel: the growth. Ratios of powers do not depend on units nor on masses; `A` may change by
//! up to √2 with the choice of tangential axes.

use super::natural_residual::{Measured, SURELY};
use crate::contact::{Components, ContactProblem, ContactRows, Delassus, NormalForce};
use crate::vectors::largest;

/// Part of the loads that a residual may hide where percussions have grown, before a proof is tried that there is no
/// solution at all. Of random systems without solution proximal points end with residuals of 4e-12 at percussions
/// 1e11 times as large as the loads ask for.
const HIDDEN: f64 = 1e-6;
/// Part of `L`, and of `N`, that contacts may approach with. Where growth is below [`GROWN`], a residual of 1e-4
/// and less implies the former. Of the systems that `infeasibility/cases.rs` names one more is proven to have no solution
/// with a quarter of the former, and the same with four times as much, and with a quarter and four times of the latter, of
/// `SUSPICIOUS` and of `GROWN`.
const APPROACHING: f64 = 1e-2;
const CLOSING: f64 = 0.1;
/// Part of all loads of a single contact that it may move with along its normal, even if it separates, where growth is
/// beyond `SUSPICIOUS`: a residual of 1e-10 leaves as much where percussions are a million times as large as these loads.
const MOVING: f64 = 1e-4;
/// Rows of a contact whose velocities are those of a point: the normal one and two tangential ones.
const PLANAR: usize = 3;
/// Growth beyond which contacts that approach at all are looked at more closely, whatever the residual.
const SUSPICIOUS: f64 = 1e4;
/// Growth beyond which rounding leaves too little of velocities to say whether contacts approach. Two contacts of
/// opposite normals, which close, ended as solved with percussions that this hides.
pub(crate) const UNRESOLVED: f64 = 1e10;
/// Growth that stacks and vaults do not exceed without need, and beyond which a start is not taken where
/// contacts approach.
const GROWN: f64 = 1e2;
/// Normal loads below this part of all loads are rounding: growth is not measured by them.
const NO_LOAD: f64 = 1e-12;
/// Power relative to those that cancel in it which rounding explains: a velocity is a sum of some tens to hundreds of
/// products `G_ij P_j`.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Growth at which percussions count as boundless: rounding hides that contacts approach.
pub(crate) const BOUNDLESS: f64 = APPROACHING / ROUNDING;

/// Percussions that have grown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Growth {
    /// What the group with the largest growth does.
    pub(crate) kind: GrowthKind,
    /// The contact with the largest power there.
    pub(crate) contact: usize,
    /// `A/L` of the group.
    pub(crate) factor: f64,
}

/// What contacts do whose percussions have grown; the later, the worse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum GrowthKind {
    /// Contacts approach by no more than what a residual may leave: whether that is all depends on the residual.
    Grown,
    /// They separate with percussions: an iteration has passed the solution.
    Separating,
    /// They approach a little, or may do so within rounding: their percussions are those of a solution, or grow
    /// slowly for ever.
    Suspicious,
    /// Growth is boundless: rounding may hide that they approach. A single contact moves with percussions that cancel.
    Boundless,
    /// They go on approaching.
    Approaching,
}

impl Growth {
    /// Whether a residual, which is relative to what percussions bring, may hide more of the loads than is harmless.
    pub(crate) fn hides(&self, residual: f64) -> bool {
        self.factor * residual > HIDDEN
    }

    /// Whether percussions with a small residual may be those of a problem without solution nevertheless.
    pub(crate) fn is_suspicious(&self, residual: f64) -> bool {
        self.kind >= GrowthKind::Suspicious || self.hides(residual)
    }

    /// The contact that percussions run away from.
    pub(crate) fn running(&self) -> Option<usize> {
        (self.kind >= GrowthKind::Boundless).then_some(self.contact)
    }
}

/// The groups of contacts, and `Q`, `L`, `A` of each.
///
/// Who influences whom, and what the rows of the operator come to, is found when it is first asked for, which may take longer
/// than a sweep, and kept until [`forget`](Self::forget) is called.
#[derive(Debug, Clone, Default)]
pub(crate) struct Groups {
    members: Components,
    /// `Σ_j |G_ij|` in the normal row of every contact; where only products are known, an estimate of the norm of `G`.
    row_sums: Vec<f64>,
    /// `Σ_i |G_ij|` over the normal rows of all contacts, in every column.
    column_sums: Vec<f64>,
    known: bool,
    sums: Vec<Powers>,
    /// What either bound is beyond the limit, see [`are_bounded`](Self::are_bounded).
    excess: Vec<[f64; 2]>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Powers {
    /// Contacts of the group, and the largest load of a row of a single one, but for that of its drilling.
    contacts: usize,
    own: f64,
    approach: f64,
    separation: f64,
    load: f64,
    net: f64,
    /// `L` with the largest load of all rows of the problem.
    largest: f64,
    brought: f64,
}

impl Powers {
    /// Takes in a contact that pushes, under the loads of all; what is brought to its normal row may be known.
    #[inline(always)]
    fn add(
        &mut self,
        measured: &Measured<'_>,
        contact: usize,
        loads: &Loads,
        brought: Option<f64>,
    ) {
        let Measured { problem, percussion, .. } = *measured;
        let row = problem.contacts()[contact].offset;
        let (push, xi) = (percussion[row], measured.xi(row));
        let load = loads.of_normal_row(problem, contact, percussion);
        let brought = brought.unwrap_or_else(|| brought_to(problem, contact, percussion));
        let rows = problem.contacts()[contact].rows().take(PLANAR);
        let own = |row: usize| (problem.free_velocity()[row] + problem.restitution()[row]).abs();
        self.own = rows.map(own).fold(load.abs(), f64::max) * push;
        self.approach += push * f64::max(0.0, -xi);
        self.separation += push * f64::max(0.0, xi);
        self.load += push * load.abs();
        self.net += push * load;
        self.largest += push * loads.largest;
        self.brought += push * brought;
    }

    /// What the contacts of the group do, if their percussions have grown.
    fn kind(&self) -> Option<GrowthKind> {
        let Self { contacts, own, approach, separation, load, net, largest, brought } = *self;
        let (little, closing) = (APPROACHING * load, CLOSING * net.abs());
        // What rounding leaves is no velocity.
        let counts = |power: f64, allowed: f64| power > allowed && power > ROUNDING * brought;
        let boundless = if contacts > 1 {
            brought > BOUNDLESS * load && load > NO_LOAD * largest
        } else {
            // In Painlevé's paradox friction calls for percussions of one contact that are large beside a vanishing normal
            // load, but not beside the load along its other rows. Percussions that cancel each other may be as large as
            // they like, and leave the contact moving.
            let moves = counts(f64::max(approach, separation), MOVING * own);
            brought > UNRESOLVED * own || brought > SUSPICIOUS * own && moves
        };
        if !(brought > GROWN * load) {
            None
        } else if counts(approach, f64::min(little, closing)) {
            Some(GrowthKind::Approaching)
        } else if boundless {
            Some(GrowthKind::Boundless)
        } else if counts(separation, little) {
            Some(GrowthKind::Separating)
        } else {
            let hidden = brought > UNRESOLVED * load && load > NO_LOAD * largest;
            // What rounding explains may be an approach nevertheless.
            let approaches = counts(approach, 0.0) || approach > f64::min(little, closing);
            if brought > SUSPICIOUS * load && approaches || hidden {
                Some(GrowthKind::Suspicious)
            } else {
                approaches.then_some(GrowthKind::Grown)
            }
        }
    }
}

impl Groups {
    /// The operator has other entries.
    pub(crate) fn forget(&mut self) {
        self.known = false;
    }

    /// Joins contacts that influence each other, and sums up their rows and columns.
    fn know(&mut self, problem: &ContactProblem) {
        if std::mem::replace(&mut self.known, true) {
            return;
        }
        let contacts = problem.contacts().len();
        self.members.separate(contacts);
        self.row_sums.clear();
        self.column_sums.clear();
        self.column_sums.resize(problem.rows(), 0.0);
        for i in 0..contacts {
            if let Delassus::MatrixFree(operator) = problem.delassus() {
                self.members.join(i, 0);
                self.row_sums.push(operator.norm());
                continue;
            }
            let mut row_sum = 0.0;
            for (j, block) in problem.delassus().blocks().row(i) {
                if block.iter().any(|g| *g != 0.0) {
                    self.members.join(i, j);
                }
                // The normal row is the first one of the block.
                let columns = &mut self.column_sums[problem.contacts()[j].rows()];
                for (column_sum, g) in columns.iter_mut().zip(block) {
                    row_sum += g.abs();
                    *column_sum += g.abs();
                }
            }
            self.row_sums.push(row_sum);
        }
    }

    /// Whether no group of contacts can have grown, without products with `G`: whether a bound of `A` is no more than [`GROWN`]
    /// times `L` in every group. There are two,
    ///
    /// `A ≤ max|P| Σ_i P_Ni Σ_j |G_ij|` and, by `P_Ni |P_j| ≤ (P_Ni² + P_j²)/2`,
    /// `A ≤ ½ (Σ_i P_Ni² Σ_j |G_ij| + Σ_j P_j² Σ_i |G_ij|)`,
    ///
    /// of which the latter is nearer where percussions are of one size, and is not known without the entries of `G`.
    ///
    /// This settles most solutions in which contacts move, and what sweeps find on the way to those of stacks and walls.
    fn are_bounded(&mut self, measured: &Measured<'_>) -> bool {
        let Measured { problem, percussion, .. } = *measured;
        let Self { members, row_sums, column_sums, excess, .. } = self;
        let largest = largest(percussion);
        let with_entries = !problem.delassus().is_matrix_free();
        excess.clear();
        excess.resize(problem.contacts().len(), [0.0; 2]);
        for (i, rows) in problem.contacts().iter().enumerate() {
            if rows.normal != NormalForce::Unilateral {
                // Its percussion is a load of the others, which takes products.
                return false;
            }
            let (row, push) = (rows.offset, percussion[rows.offset]);
            let [by_largest, by_squares] = &mut excess[members.first(i)];
            if push > 0.0 {
                let load = (problem.free_velocity()[row] + problem.restitution()[row]).abs();
                let allowed = SURELY * GROWN * load;
                *by_largest += push * (largest * row_sums[i] - allowed);
                *by_squares += push * (0.5 * push * row_sums[i] - allowed);
            }
            let columns = percussion[rows.rows()].iter().zip(&column_sums[rows.rows()]);
            *by_squares += columns.map(|(p, column_sum)| 0.5 * p * p * column_sum).sum::<f64>();
        }
        // The comparisons also find NaN.
        let is_bounded = |[by_largest, by_squares]: &[f64; 2]| {
            *by_largest <= 0.0 || with_entries && *by_squares <= 0.0
        };
        excess.iter().all(is_bounded)
    }

    /// Begins new sums.
    fn begin(&mut self, contacts: usize) {
        self.sums.clear();
        self.sums.resize(contacts, Powers::default());
        for i in 0..contacts {
            self.sums[self.members.first(i)].contacts += 1;
        }
    }
}

/// How percussions have grown, with velocities `γ_E` that belong to them.
#[inline]
pub(crate) fn of(
    problem: &ContactProblem,
    percussion: &[f64],
    velocity: &[f64],
    groups: &mut Groups,
) -> Option<Growth> {
    let measured = Measured { problem, percussion, velocity };
    // Most solutions end here: they are not large, and no contact that pushes moves against its own load.
    let moves = |rows: &ContactRows| {
        let row = rows.offset;
        let load = problem.free_velocity()[row] + problem.restitution()[row];
        measured.xi(row).abs() > APPROACHING * load.abs()
    };
    let mut pushing = problem.contacts().iter().filter(|rows| pushes(rows, percussion));
    let looks_grown = match pushing.next() {
        None => false,
        Some(first) => moves(first) || pushing.any(moves) || is_large(problem, percussion),
    };
    if looks_grown { of_groups(&measured, groups) } else { None }
}

/// How the percussions of contacts have grown that influence each other and no others; `brought` holds `Σ_j |G_ij P_j|` of
/// their normal rows, or nothing where that is not known.
#[cold]
pub(crate) fn of_island(
    measured: &Measured<'_>,
    contacts: &[usize],
    brought: &[f64],
) -> Option<Growth> {
    let Measured { problem, percussion, .. } = *measured;
    let loads = Loads::of(problem, contacts.iter().map(|&i| &problem.contacts()[i]));
    let pushing = |i: &&usize| pushes(&problem.contacts()[**i], percussion);
    let sums = pulp::Arch::new().dispatch(Sum { measured, contacts, loads: &loads, brought });
    let kind = sums.kind()?;
    let sign = if kind == GrowthKind::Separating { 1.0 } else { -1.0 };
    let power = |i: usize| {
        let row = problem.contacts()[i].offset;
        sign * percussion[row] * measured.xi(row)
    };
    let mut worst = None;
    for &i in contacts.iter().filter(pushing) {
        if worst.is_none_or(|worst| power(i) > power(worst)) {
            worst = Some(i);
        }
    }
    Some(Growth { kind, contact: worst?, factor: sums.brought / sums.load })
}

/// A call that the compiler copies into every set of instructions: it multiplies the normal row of every contact.
/// Multiplications and additions stay apart, with the same bits in all of them.
struct Sum<'a> {
    measured: &'a Measured<'a>,
    contacts: &'a [usize],
    loads: &'a Loads,
    brought: &'a [f64],
}

impl pulp::NullaryFnOnce for Sum<'_> {
    type Output = Powers;

    #[inline(always)]
    fn call(self) -> Powers {
        let Self { measured, contacts, loads, brought } = self;
        let Measured { problem, percussion, .. } = *measured;
        let mut sums = Powers { contacts: contacts.len(), ..Powers::default() };
        for (k, &i) in contacts.iter().enumerate() {
            if pushes(&problem.contacts()[i], percussion) {
                sums.add(measured, i, loads, brought.get(k).copied());
            }
        }
        sums
    }
}

/// How large percussions are against loads: whether it is worth while to look at their growth with [`of`].
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Size {
    /// Whether a contact pushes, and whether one that does moves against its own load.
    pushes: bool,
    moves: bool,
    /// Sums of `P²`, of `(b + e γ_B)²`, of the diagonal of `G`, and their number of rows.
    percussions: f64,
    loads: f64,
    trace: f64,
    rows: f64,
}

impl Size {
    /// Of one contact: with `ξ_N` and its load if growth is measured by it, and both sums of squares.
    #[inline(always)]
    pub(crate) fn of(
        percussion: &[f64],
        normal: Option<(f64, f64)>,
        (percussions, loads): (f64, f64),
        rho: f64,
    ) -> Self {
        let normal = normal.filter(|_| percussion[0] > 0.0);
        let moves = normal.is_some_and(|(xi, load)| xi.abs() > APPROACHING * load.abs());
        let rows = percussion.len() as f64;
        Self { pushes: normal.is_some(), moves, percussions, loads, trace: rows / rho, rows }
    }

    /// Takes a further contact in.
    #[inline(always)]
    pub(crate) fn add(&mut self, other: &Self) {
        self.pushes |= other.pushes;
        self.moves |= other.moves;
        self.percussions += other.percussions;
        self.loads += other.loads;
        self.trace += other.trace;
        self.rows += other.rows;
    }

    /// Whether percussions may have grown.
    #[inline(always)]
    pub(crate) fn may_have_grown(&self) -> bool {
        self.pushes && (self.moves || self.is_large())
    }

    #[inline(always)]
    fn is_large(&self) -> bool {
        let rho = self.rows / self.trace;
        // The comparison also finds NaN.
        !(self.percussions <= (GROWN * rho).powi(2) * self.loads)
    }
}

/// Whether growth is measured by a contact: the normal percussion is unknown, and there is one.
#[inline]
fn pushes(rows: &ContactRows, percussion: &[f64]) -> bool {
    rows.normal == NormalForce::Unilateral && percussion[rows.offset] > 0.0
}

/// The worst growth of all groups.
#[cold]
fn of_groups(measured: &Measured<'_>, groups: &mut Groups) -> Option<Growth> {
    groups.know(measured.problem);
    if groups.are_bounded(measured) { None } else { of_unbounded(measured, groups) }
}

/// The same from all products of `G`, where their bounds have not told.
fn of_unbounded(measured: &Measured<'_>, groups: &mut Groups) -> Option<Growth> {
    let Measured { problem, percussion, .. } = *measured;
    let pushing = |rows: &&ContactRows| pushes(rows, percussion);
    groups.begin(problem.contacts().len());
    let loads = Loads::of(problem, problem.contacts().iter());
    for (i, _) in problem.contacts().iter().enumerate().filter(|(_, rows)| pushing(rows)) {
        let group = groups.members.first(i);
        groups.sums[group].add(measured, i, &loads, None);
    }
    let mut worst: Option<(GrowthKind, f64, usize)> = None;
    for (i, rows) in problem.contacts().iter().enumerate().filter(|(_, rows)| pushing(rows)) {
        let group = groups.members.first(i);
        let Some(kind) = groups.sums[group].kind() else { continue };
        let sign = if kind == GrowthKind::Separating { 1.0 } else { -1.0 };
        let power = sign * percussion[rows.offset] * measured.xi(rows.offset);
        if worst.is_none_or(|(k, largest, _)| kind > k || kind == k && power > largest) {
            worst = Some((kind, power, i));
        }
    }
    let (kind, _, contact) = worst?;
    let group = groups.members.first(contact);
    let Powers { load, brought, .. } = groups.sums[group];
    Some(Growth { kind, contact, factor: brought / load })
}

/// What percussions of contacts are compared with.
struct Loads {
    /// The largest load of a row.
    largest: f64,
    /// Whether the normal percussion of a contact is prescribed: it is a load of the others.
    prescribed: bool,
}

impl Loads {
    /// Of contacts that influence no others.
    fn of<'a>(problem: &ContactProblem, contacts: impl Iterator<Item = &'a ContactRows>) -> Self {
        let mut loads = Self { largest: 0.0, prescribed: false };
        for contact in contacts {
            let rows = contact.rows();
            for (b, e) in
                problem.free_velocity()[rows.clone()].iter().zip(&problem.restitution()[rows])
            {
                loads.largest = loads.largest.max((b + e).abs());
            }
            loads.prescribed |= contact.normal != NormalForce::Unilateral;
        }
        loads
    }

    /// `l` of the normal row of a contact, with what contacts of prescribed normal percussion bring.
    #[inline(always)]
    fn of_normal_row(&self, problem: &ContactProblem, i: usize, percussion: &[f64]) -> f64 {
        let row = problem.contacts()[i].offset;
        let mut load = problem.free_velocity()[row] + problem.restitution()[row];
        // Without entries it is not known what they bring.
        if self.prescribed && !problem.delassus().is_matrix_free() {
            for (j, block) in problem.delassus().blocks().row(i) {
                let rows = &problem.contacts()[j];
                if rows.normal != NormalForce::Unilateral {
                    // The normal row is the first one of the block.
                    let terms = block.iter().zip(&percussion[rows.rows()]);
                    terms.for_each(|(g, p)| load += g * p);
                }
            }
        }
        load
    }
}

/// `Σ_j |G_ij P_j|` in the normal row of a contact.
#[inline(always)]
fn brought_to(problem: &ContactProblem, i: usize, percussion: &[f64]) -> f64 {
    match problem.delassus() {
        // Without entries only their size is known.
        Delassus::MatrixFree(operator) => operator.norm() * largest(percussion),
        delassus => delassus.blocks().first_magnitude(i, percussion),
    }
}

/// Whether percussions are so large against the loads that they ask for a second look.
pub(crate) fn is_large(problem: &ContactProblem, percussion: &[f64]) -> bool {
    let squares = percussion.iter().map(|p| p * p).sum::<f64>();
    // The comparison also finds NaN.
    !(squares <= (GROWN * problem.global_rho() * problem.load_norm()).powi(2))
}

/// The same of contacts that influence each other and no others.
pub(crate) fn is_large_island(
    problem: &ContactProblem,
    percussion: &[f64],
    contacts: &[usize],
) -> bool {
    let (free, restitution) = (problem.free_velocity(), problem.restitution());
    let mut size = Size::default();
    for &i in contacts {
        let rows = problem.contacts()[i].rows();
        let squares = percussion[rows.clone()].iter().map(|p| p * p).sum();
        let loads = rows.clone().map(|row| (free[row] + restitution[row]).powi(2)).sum();
        size.add(&Size::of(&percussion[rows], None, (squares, loads), problem.rho(i)));
    }
    size.is_large()
}

#[cfg(test)]
mod tests;
