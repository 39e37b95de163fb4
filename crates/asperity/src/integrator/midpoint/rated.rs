//! Friction that depends on the speed, within a step.
//!
//! A factor `f` of the friction force makes the law `−P ∈ f C(P_N)`. In `P̃ = P/f` it is the law without a factor
//! again, and `G P = G F P̃` with the factors on the diagonal of `F`: the columns of the Delassus operator are
//! scaled and no solver needs to know.
//!
//! # At which speed
//!
//! `f = f₋ + f₊`, the parts that never rise and never fall with the speed. `f₋` is taken at the speed `‖γ_B‖` before
//! the step, `f₊` at that of its end, `s = ‖γ_E‖`:
//!
//! `φ = f₋(‖γ_B‖) + f₊(s(φ))`.
//!
//! For one contact in slip along a line `s(φ) = |b| − aφ` with `a = G μ P_N`, and `f₊ = κv`: the speed is damped by
//! `1/(1 + aκ)` in a step, however stiff (L-stable). Taken before the step, `f₊` would damp it by `1 − aκ`, which
//! swings with a period of two steps beyond `aκ = 2`. The falling part must not be taken at the end: `s + a f₋(s) = |b|`
//! has several solutions once `a|f₋′| > 1`, and no history would decide between them. Taken before the step it lets the
//! speed grow by `1 + a|f₋′|`, as in the motion itself. Stick keeps the whole reservoir of `φ = 1` in both ways.
//!
//! # How it is found
//!
//! By Newton's method for `r(φ) = f₋ + f₊(s(φ)) − φ = 0`, a solve of the contact problem for each `φ`. With the law's
//! force `P̃(γ)` for unit factor and its derivative `J`, normal percussions and the contacts that stick held, changes of
//! the slip velocities `w` and of the factors follow from
//!
//! `w = G (P̃ δφ + φ J w)`, `δφ_i = r_i + f₊′ e_iᵀ w_i`, `e_i = γ_i/s_i`.
//!
//! Held factors may have no solution near the one that is looked for, whose speed goes with its factor: a law that turns
//! the slip may have, at the factor held, stick and two slips, and the consistent solution is a slip in between; and
//! contacts that push each other may jump between stick and slip by turns. After some corrections consistent solutions
//! are therefore looked for contact by contact, each with its own factor free (`solver/one_contact/plane/implicit_rate.rs`, which finds all
//! of them) and the others held, in sweeps. The rule of selection decides between them by the states before the step.
//! From there Newton's method goes on, the states following the slip velocities `γ + w` that it expects.
//!
//! For one contact that goes on slipping along a line with a viscous force one correction is exact. `δφ/φ` is the
//! defect that is compared with the tolerance: it is a relative error of the friction force, as the residual
//! of a contact is, whereas `r` magnifies rounding of the speed by `κ`. It tells nothing where it vanishes though `r` does
//! not, as where a slip ceases to be a solution and `∂s/∂φ` has no bound: there Newton's method ends at factors that are not
//! those of the speed, and the changes `w` do not vanish. So while `w` is more than rounding, `r/φ` counts.

use asperity_set::Vector;

use super::linear_solve::LinearSolver;
use crate::contact::{ContactProblem, ContactRows, ContactState, Memory, Phase};
use crate::law::Stribeck;
use crate::solver::{ImplicitRate, Stop, Workspace, solve_implicit};

/// Factors below this one count as it.
const SMALLEST: f64 = 1e-12;

/// Change of a slip velocity, over what it is the sum of, up to which it may be rounding.
const ROUNDED: f64 = 1e-6;

/// Most sweeps over contacts that disturb each other, after which Newton's method goes on.
const MOST_SWEEPS: usize = 300;

/// How factors are corrected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Correction {
    /// As Newton's method says; the factor of a single contact within bounds.
    Whole,
    /// As Newton's method says, from solutions of the contacts that are consistent one by one.
    Following,
    /// Within bounds.
    Bounded,
}

/// The factors of all rows of a contact problem.
#[derive(Debug, Default)]
pub(super) struct Factors {
    rows: Vec<f64>,
    /// Whether some law depends on the speed.
    any: bool,
    /// Per contact: `f₋` before the step, `r`, `f₊′`, and what Newton's method adds to the factor.
    falling: Vec<f64>,
    defect: Vec<f64>,
    slope: Vec<f64>,
    change: Vec<f64>,
    /// Per contact: between which factors its own lies, if those of the others are right.
    bounds: Vec<(f64, f64)>,
    /// Number of contacts with a factor that rises.
    rising: usize,
    /// Whether a contact had several solutions in which its speed and factor agree, when last looked for.
    several: bool,
    /// Per contact: `J` for the percussions of the problem.
    jacobian: Vec<[[f64; 3]; 3]>,
    /// Per row: slip velocities and their directions `e`, zero where a contact does not slip, `w`, and scratch.
    slip: Vec<f64>,
    direction: Vec<f64>,
    change_of_slip: Vec<f64>,
    load: Vec<f64>,
    product: Vec<f64>,
    linear: LinearSolver,
}

impl Factors {
    /// Forgets the factors: the problem has new contacts.
    pub(super) fn reset(&mut self, problem: &ContactProblem) {
        let rates = || problem.contacts().iter().filter_map(|contact| contact.law.rate());
        self.any = rates().next().is_some();
        self.rising = rates().filter(|rate| rate.rises()).count();
        self.rows.clear();
        self.rows.resize(problem.rows(), 1.0);
        if self.any {
            let contacts = problem.contacts().len();
            for list in [&mut self.falling, &mut self.defect, &mut self.slope, &mut self.change] {
                list.clear();
                list.resize(contacts, 0.0);
            }
            self.bounds.resize(contacts, (0.0, f64::INFINITY));
            self.jacobian.resize(contacts, [[0.0; 3]; 3]);
            let Self { slip, direction, change_of_slip, load, product, .. } = self;
            for list in [slip, direction, change_of_slip, load, product] {
                list.clear();
                list.resize(problem.rows(), 0.0);
            }
            self.linear.resize(problem.rows());
        }
    }

    /// Whether some law depends on the speed.
    #[inline]
    pub(super) fn any(&self) -> bool {
        self.any
    }

    /// Whether some friction rises with the speed, so that factors depend on the end of the step.
    #[inline]
    pub(super) fn rises(&self) -> bool {
        self.rising > 0
    }

    /// Takes the factors for relative velocities `slip(row)` before the step.
    pub(super) fn update(&mut self, problem: &ContactProblem, slip: impl Fn(usize) -> f64) {
        self.forget_bounds();
        for (contact, falling) in problem.contacts().iter().zip(&mut self.falling) {
            let Some(rate) = contact.law.rate() else { continue };
            let speed = tangential(contact, &slip).norm();
            *falling = rate.falling(speed);
            // Without any friction the contact would have no operator.
            self.rows[contact.tangential_rows()]
                .fill((*falling + rate.rising(speed)).max(SMALLEST));
        }
    }

    /// Distance of the factors from those of the speeds at the end of the step, with the contact that is farthest; finds the
    /// correction on the way.
    pub(super) fn defect(
        &mut self,
        problem: &ContactProblem,
        percussion: &[f64],
        velocity: &[f64],
        states: &[ContactState],
    ) -> (f64, usize) {
        self.direction.fill(0.0);
        let mut slips = false;
        for (i, contact) in problem.contacts().iter().enumerate() {
            (self.defect[i], self.slope[i], self.jacobian[i]) = (0.0, 0.0, [[0.0; 3]; 3]);
            let rows = contact.tangential_rows();
            let slip = tangential(contact, |row| velocity[row] + problem.restitution()[row]);
            // A contact that sticks has a speed of the size of rounding.
            let speed = if states[i].phase == Phase::Slip { slip.norm() } else { 0.0 };
            if speed > 0.0 {
                slips = true;
                let force = tangential(contact, |row| percussion[row]);
                self.jacobian[i] =
                    jacobian(contact, &slip, &force, contact.normal_percussion(percussion));
                for (row, value) in rows.clone().zip(slip.iter()) {
                    (self.slip[row], self.direction[row]) = (*value, value / speed);
                }
            }
            if let Some(rate) = contact.law.rate()
                && states[i].phase != Phase::Open
            {
                let target = (self.falling[i] + rate.rising(speed)).max(SMALLEST);
                self.defect[i] = target - self.rows[rows.start];
                self.slope[i] = if speed > 0.0 { rate.rising_slope(speed) } else { 0.0 };
            }
        }
        self.change.copy_from_slice(&self.defect);
        if slips {
            self.correct(problem, percussion);
        }
        let mut worst = (0.0, 0);
        for (i, contact) in problem.contacts().iter().enumerate() {
            let mut relative = (self.change[i] / self.rows[contact.tangent()]).abs();
            if slips && self.turns(problem, i, percussion, velocity) {
                relative = relative.max((self.defect[i] / self.rows[contact.tangent()]).abs());
            }
            if !(relative <= worst.0) {
                worst = (relative, i);
            }
        }
        worst
    }

    /// Whether Newton's method expects another slip velocity of a contact, by more than rounding of what it is the sum of.
    fn turns(
        &self,
        problem: &ContactProblem,
        i: usize,
        percussion: &[f64],
        velocity: &[f64],
    ) -> bool {
        let contact = &problem.contacts()[i];
        if contact.tangential_rows().all(|row| self.direction[row] == 0.0) {
            return false;
        }
        let mut brought = [0.0; 4];
        if !problem.delassus().is_matrix_free() {
            problem.delassus().blocks().add_magnitudes(i, percussion, &mut brought);
        }
        let change = tangential(contact, |row| self.change_of_slip[row]).norm();
        let now = tangential(contact, |row| velocity[row] + problem.restitution()[row]);
        let free = tangential(contact, |row| problem.free_velocity()[row]);
        let brought = tangential(contact, |row| brought[row - contact.offset]);
        change > ROUNDED * now.norm().max(free.norm()).max(brought.norm())
    }

    /// `δφ` by way of `w − G (P̃ f₊′ eᵀw + φ J w) = G P̃ r`.
    ///
    /// The operator of the problem has the factors in its columns, `G P̃_j δφ_j = (G F)_j P̃_j δφ_j/φ_j`.
    fn correct(&mut self, problem: &ContactProblem, percussion: &[f64]) {
        let Self { rows, defect, slope, change, jacobian, direction, .. } = self;
        let Self { change_of_slip, load, product, linear, .. } = self;
        let slips =
            |contact: &ContactRows| contact.tangential_rows().any(|row| direction[row] != 0.0);
        let along = |contact: &ContactRows, w: &[f64]| {
            contact.tangential_rows().map(|row| direction[row] * w[row]).sum::<f64>()
        };
        let moves = |percussion: &[f64], velocity: &mut [f64]| {
            problem.delassus().apply(percussion, velocity);
            for contact in problem.contacts() {
                velocity[contact.offset..contact.tangent()].fill(0.0);
                if !slips(contact) {
                    velocity[contact.tangential_rows()].fill(0.0);
                }
            }
        };
        product.fill(0.0);
        for (i, contact) in problem.contacts().iter().enumerate().filter(|(_, c)| slips(c)) {
            for row in contact.tangential_rows() {
                product[row] = percussion[row] * defect[i] / rows[row];
            }
        }
        moves(product, load);
        let mut apply = |w: &[f64], out: &mut [f64]| {
            product.fill(0.0);
            for (i, contact) in problem.contacts().iter().enumerate().filter(|(_, c)| slips(c)) {
                let change = slope[i] * along(contact, w);
                for (a, row) in contact.tangential_rows().enumerate() {
                    let turned =
                        contact.tangential_rows().zip(jacobian[i][a]).map(|(row, j)| j * w[row]);
                    product[row] = percussion[row] * change / rows[row] + turned.sum::<f64>();
                }
            }
            moves(product, out);
            for (out, w) in out.iter_mut().zip(w) {
                *out = w - *out;
            }
        };
        linear.solve(&mut apply, load, change_of_slip);
        for (i, contact) in problem.contacts().iter().enumerate() {
            change[i] = defect[i] + slope[i] * along(contact, change_of_slip);
        }
    }

    fn forget_bounds(&mut self) {
        self.bounds.fill((0.0, f64::INFINITY));
    }

    /// Adds the correction to the factors; `percussion` remains the same force.
    ///
    /// Newton's method may jump to and fro between stick and a slip that ceases: the factor of a single contact
    /// is kept within bounds from the beginning, those of several, which disturb each other, if that has not ended by
    /// itself.
    pub(super) fn apply_correction(
        &mut self,
        problem: &ContactProblem,
        correction: Correction,
        percussion: &mut [f64],
    ) {
        let bounded = match correction {
            Correction::Whole => self.rising == 1,
            Correction::Following => false,
            Correction::Bounded => true,
        };
        if self.rising > 1 && !bounded {
            self.forget_bounds();
        }
        for (i, contact) in problem.contacts().iter().enumerate() {
            let Some(rate) = contact.law.rate() else { continue };
            let rows = contact.tangential_rows();
            let old = self.rows[rows.start];
            let (low, high) = &mut self.bounds[i];
            // The factor of the speed falls as the friction rises.
            if self.defect[i] > 0.0 {
                *low = low.max(old);
            } else {
                *high = high.min(old);
            }
            let mut new = old + self.change[i];
            if bounded && high.is_finite() && !(new > *low && new < *high) {
                new = 0.5 * (*low + *high);
            }
            // The rising part is not negative: no factor lies below the falling one.
            new = new.max(self.falling[i] + rate.rising(0.0)).max(SMALLEST);
            for row in rows {
                percussion[row] *= old / new;
                self.rows[row] = new;
            }
        }
    }

    /// Moves the contacts with a rising factor one by one to solutions in which their speeds and factors agree, which
    /// [`Correction::Following`] then continues. Whether it has moved any.
    pub(super) fn settle(
        &mut self,
        problem: &ContactProblem,
        before: &[ContactState],
        stop: Stop<'_>,
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> bool {
        let mut moved = false;
        for _ in 0..if self.rising > 1 { MOST_SWEEPS } else { 1 } {
            let change = self.sweep(problem, before, memory, workspace);
            moved |= change.is_some();
            let left = change.is_some_and(|change| change > 0.1 * stop.tolerance);
            if !left || stop.cancelled.is_some_and(|ask| ask()) {
                break;
            }
        }
        for (i, contact) in problem.contacts().iter().enumerate() {
            for row in contact.tangential_rows() {
                let new = self.rows[row] + self.change[i];
                memory.percussion[row] *= self.rows[row] / new;
                self.rows[row] = new;
            }
        }
        moved
    }

    /// One sweep of [`settle`](Self::settle): the largest change of a percussion, of all that its contact has; `None`
    /// if no contact has moved. The operator keeps the factors of before; `change` holds what is to be added to them.
    fn sweep(
        &mut self,
        problem: &ContactProblem,
        before: &[ContactState],
        memory: &mut Memory,
        workspace: &mut Workspace,
    ) -> Option<f64> {
        let mut largest = None;
        self.several = false;
        self.change.fill(0.0);
        let Memory { percussion, states } = memory;
        for (i, contact) in problem.contacts().iter().enumerate() {
            let Some(rate) = contact.law.rate().filter(|rate| rate.rises()) else { continue };
            let rows = contact.tangential_rows();
            let present = self.rows[rows.start];
            let rising = ImplicitRate { rate, falling: self.falling[i].max(SMALLEST), present };
            let Some(found) =
                solve_implicit(problem, i, percussion, &before[i], &rising, workspace)
            else {
                continue;
            };
            self.several |= found.ambiguous;
            self.change[i] = found.factor - present;
            states[i] = found.state;
            if contact.normal_rows() == 1 {
                percussion[contact.offset] = found.normal;
            }
            let (mut moved, mut size) = (0.0_f64, 0.0_f64);
            for (row, tangent) in rows.zip(found.tangent) {
                let new = tangent * found.factor / present;
                moved = moved.max((new - percussion[row]).abs());
                size = size.max(new.abs());
                percussion[row] = new;
            }
            let relative = if size > 0.0 { moved / size } else { 0.0 };
            largest = Some(relative.max(largest.unwrap_or(0.0)));
        }
        largest
    }

    /// Whether a contact that was moved had a choice.
    pub(super) fn several(&self) -> bool {
        self.several
    }

    /// Corrects the states, so that the next solve continues the last solution and not the state before the step.
    pub(super) fn follow(&self, problem: &ContactProblem, states: &mut [ContactState]) {
        for (contact, state) in problem.contacts().iter().zip(states) {
            let slips = contact.tangential_rows().any(|row| self.direction[row] != 0.0);
            if slips && contact.law.rate().is_some_and(Stribeck::rises) {
                let slip = tangential(contact, |row| self.slip[row] + self.change_of_slip[row]);
                *state = ContactState::new(Phase::Slip, slip.into());
            }
        }
    }

    /// The factors of all rows, one for those without.
    #[inline]
    pub(super) fn rows(&self) -> &[f64] {
        &self.rows
    }
}

/// What there is in the rows of a contact's friction.
fn tangential(contact: &ContactRows, value: impl Fn(usize) -> f64) -> Vector<3> {
    let mut vector = Vector::<3>::zeros();
    for (component, row) in vector.iter_mut().zip(contact.tangential_rows()) {
        *component = value(row);
    }
    vector
}

/// `J = ∂P̃/∂γ`, of the law without its factor, in the percussions of the problem.
fn jacobian(
    contact: &ContactRows,
    slip: &Vector<3>,
    force: &Vector<3>,
    normal: f64,
) -> [[f64; 3]; 3] {
    // The law's own derivative is that of `f P̃`: `f J + f′ P̃ eᵀ`.
    let (speed, mut out) = (slip.norm(), [[0.0; 3]; 3]);
    let Some(matrix) = contact.law.jacobian(slip.as_slice(), normal) else { return out };
    let rate = contact.law.rate();
    let (factor, slope) = rate.map_or((1.0, 0.0), |r| (r.factor(speed), r.slope(speed)));
    for i in 0..contact.law.dimension() {
        for j in 0..contact.law.dimension() {
            let entry = (matrix[i][j] - slope * force[i] * slip[j] / speed) / factor;
            out[i][j] = if entry.is_finite() { entry } else { 0.0 };
        }
    }
    out
}
