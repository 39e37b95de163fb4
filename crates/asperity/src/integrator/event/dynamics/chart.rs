//! Coordinates in which the velocities are the rates, for bodies that turn in space too.
//!
//! Collocation asks for `q̇ = u`. Attitudes of bodies in space have no such coordinates for the angular velocity, so
//! the integration uses rotation vectors: the attitude is `R₀ exp θ` with an attitude `R₀` that is kept for some steps,
//! the centre of the chart, and in place of Ω the velocity is `w = θ̇`. With
//!
//! `Ω = D(θ) θ̇`, `D = 1 − (1 − cos φ)/φ² θ× + (φ − sin φ)/φ³ θ× θ×`, `φ = ‖θ‖`,
//!
//! the equations `M u̇ = h + W λ`, `γ = Wᵀu + χ` become `ẇ = D⁻¹(M⁻¹h − Ḋ w) + D⁻¹M⁻¹W λ`, `γ = (DᵀW)ᵀw + χ`. They are
//! the same motion to rounding, and of the form that everything else here knows. At the centre `D` is one; before θ comes
//! near a full turn, where `D` is singular, the chart moves on to the present attitude.

use std::borrow::Cow;
use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};

use crate::integrator::event::state::State;
use crate::system::mass::MassFactors;
use crate::system::{
    Configuration, FrictionMap, MotionBounds, Rotation, System, SystemError, derive, full_rows,
};

/// Angle in rad beyond which the chart is recentred, and the largest turn in a step: θ stays far from a full turn.
const RECENTRED: f64 = 0.5;
const FURTHEST: f64 = 2.0;
/// Terms of the series of `D`: the next one is below rounding up to a full turn.
const TERMS: i32 = 18;

/// A system in these coordinates.
#[derive(Debug)]
pub(crate) struct Chart<'a> {
    system: &'a dyn System,
    rotations: Vec<Turn>,
    /// The attitudes `R₀`; zero for all other coordinates.
    centre: Vec<f64>,
    /// The coordinates of the system where the chart was placed last, and what is derived from them.
    q: Vec<f64>,
    derived: Vec<f64>,
    /// A time of the smooth piece of functions of time in which the motion is.
    pub(crate) piece: f64,
    /// The velocities `D w` of the system, and their part `Ḋ w` of the accelerations.
    u: Vec<f64>,
    rate: Vec<f64>,
}

/// A rotation of space where the chart was placed last.
#[derive(Debug)]
struct Turn {
    at: Rotation,
    angle: Vector3<f64>,
    /// `D`, and its inverse.
    differential: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

impl Turn {
    /// Its part of velocities, or of what is dual to them.
    fn part(&self, values: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(&values[self.at.velocity..self.at.velocity + 3])
    }

    fn set_part(&self, values: &mut [f64], part: &Vector3<f64>) {
        values[self.at.velocity..self.at.velocity + 3].copy_from_slice(part.as_slice());
    }
}

impl<'a> Chart<'a> {
    /// The chart about the attitudes of a state of the system, and this state in it.
    pub(crate) fn new(system: &'a dyn System, q0: &[f64], u0: &[f64]) -> (Self, State) {
        let one = Matrix3::identity();
        let turn = |at| Turn { at, angle: Vector3::zeros(), differential: one, inverse: one };
        let n = system.dof();
        let mut chart = Self {
            system,
            rotations: system.rotations().iter().copied().map(turn).collect(),
            centre: vec![0.0; q0.len()],
            q: q0.to_vec(),
            derived: Vec::new(),
            piece: 0.0,
            u: vec![0.0; n],
            rate: vec![0.0; n],
        };
        let mut state = State { t: 0.0, q: vec![0.0; n], u: u0.to_vec() };
        chart.centre_at(q0, &mut state.q);
        (chart, state)
    }

    /// Whether its coordinates are those of the system.
    fn is_trivial(&self) -> bool {
        self.rotations.is_empty()
    }

    /// Whether rows and mass never change.
    pub(crate) fn is_constant(&self) -> bool {
        let constancy = self.system.constancy();
        self.is_trivial() && constancy.mass && constancy.contacts
    }

    /// Moves the centre to the coordinates `q` of the system, which are left in `x`.
    fn centre_at(&mut self, q: &[f64], x: &mut [f64]) {
        if self.is_trivial() {
            x.copy_from_slice(q);
            return;
        }
        let (mut from, mut to) = (0, 0);
        for turn in &self.rotations {
            let Rotation { coordinate, velocity } = turn.at;
            x[to..velocity].copy_from_slice(&q[from..coordinate]);
            x[velocity..velocity + 3].fill(0.0);
            self.centre[coordinate..coordinate + 4].copy_from_slice(&q[coordinate..coordinate + 4]);
            (from, to) = (coordinate + 4, velocity + 3);
        }
        x[to..].copy_from_slice(&q[from..]);
    }

    /// Goes to the coordinates `x`, for all that is asked for next.
    pub(crate) fn place(&mut self, x: &[f64]) {
        if self.is_trivial() {
            self.q.copy_from_slice(x);
            derive(self.system, &self.q, &mut self.derived);
            return;
        }
        self.system.advance(&self.centre, x, 1.0, &mut self.q);
        derive(self.system, &self.q, &mut self.derived);
        for turn in &mut self.rotations {
            turn.angle = turn.part(x);
            turn.differential = differential(&turn.angle);
            // Where there is none, nothing is a number, and the step is rejected.
            let inverse = turn.differential.try_inverse();
            turn.inverse = inverse.unwrap_or_else(|| Matrix3::from_element(f64::NAN));
        }
    }

    /// Goes to where the velocities `w` lead from `x` in the time `dt`, with the velocities of the system there in `u`.
    pub(crate) fn place_along(&mut self, x: &[f64], w: &[f64], dt: f64, u: &mut [f64]) {
        if self.is_trivial() {
            self.system.advance(x, w, dt, &mut self.q);
            derive(self.system, &self.q, &mut self.derived);
            u.copy_from_slice(w);
            return;
        }
        for (along, (x, w)) in u.iter_mut().zip(x.iter().zip(w)) {
            *along = x + dt * w;
        }
        self.place(u);
        self.push_forward(w);
        u.copy_from_slice(&self.u);
    }

    fn configuration(&self, t: f64) -> Configuration<'_> {
        Configuration { t, piece: self.piece, q: &self.q, derived: &self.derived }
    }

    /// Gap of a unilateral contact.
    pub(crate) fn gap(&self, t: f64, contact: usize) -> Result<f64, SystemError> {
        self.system.gap(&self.configuration(t), contact)
    }

    /// Makes bounds on `w` those on the velocities of the system: no rotation of the chart is longer than its vector, so that
    /// `|Ω| ≤ |w|` and `|Ω̇| ≤ |ẇ| + |w|²`.
    pub(crate) fn push_bounds(&self, bounds: &mut MotionBounds) {
        for turn in &self.rotations {
            let speed = turn.part(&bounds.velocities).norm();
            let rate = turn.part(&bounds.accelerations).norm() + speed * speed;
            turn.set_part(&mut bounds.velocities, &Vector3::repeat(speed));
            turn.set_part(&mut bounds.accelerations, &Vector3::repeat(rate));
        }
    }

    /// A bound on `|g̈_N|` of a unilateral contact from where the chart has been placed, if the system has one.
    pub(crate) fn gap_acceleration(
        &self,
        t: f64,
        contact: usize,
        bounds: &MotionBounds,
    ) -> Option<f64> {
        self.system.gap_acceleration(&self.configuration(t), contact, bounds)
    }

    /// Rows of a contact for the velocities of the system, the normal one first if it is unilateral, and their χ; its gap.
    pub(crate) fn rows(
        &self,
        t: f64,
        contact: usize,
        rows: &mut [f64],
        chi: &mut [f64],
    ) -> Result<f64, SystemError> {
        full_rows(self.system, &self.configuration(t), contact, rows, chi)
    }

    /// The map of friction on which a contact is, and its place.
    pub(crate) fn friction_place(
        &self,
        t: f64,
        contact: usize,
    ) -> Option<(&FrictionMap, [f64; 2])> {
        self.system.friction_place(&self.configuration(t), contact)
    }

    /// Factors the mass matrix for the velocities of the system.
    pub(crate) fn factor_mass(&self, t: f64, factors: &mut MassFactors) -> Result<(), SystemError> {
        factors.update(self.system, t, &self.q)
    }

    /// The forces of the system at the velocities `w`.
    pub(crate) fn forces(
        &mut self,
        t: f64,
        w: &[f64],
        forces: &mut [f64],
    ) -> Result<(), SystemError> {
        if self.is_trivial() {
            return self.system.forces(&self.configuration(t), w, forces);
        }
        self.push_forward(w);
        self.system.forces(&self.configuration(t), &self.u, forces)
    }

    /// Makes rows of the system those for the velocities `w`: `Dᵀ` times each.
    pub(crate) fn pull_back(&self, rows: &mut [f64]) {
        self.transform(rows, |turn, row| turn.differential.tr_mul(&row));
    }

    /// Makes accelerations `M⁻¹W` of the system those of `w`: `D⁻¹` times each.
    pub(crate) fn pull_responses(&self, responses: &mut [f64]) {
        self.transform(responses, |turn, response| turn.inverse * response);
    }

    /// Makes the accelerations `M⁻¹h` of the system at the velocities `w`, at which its forces have been asked for,
    /// those of `w`: `D⁻¹(M⁻¹h − Ḋ w)`.
    pub(crate) fn pull_acceleration(&self, acceleration: &mut [f64]) {
        self.transform(acceleration, |turn, own| turn.inverse * (own - turn.part(&self.rate)));
    }

    fn transform(&self, rows: &mut [f64], to: impl Fn(&Turn, Vector3<f64>) -> Vector3<f64>) {
        if self.is_trivial() {
            return;
        }
        for row in rows.chunks_exact_mut(self.u.len()) {
            for turn in &self.rotations {
                turn.set_part(row, &to(turn, turn.part(row)));
            }
        }
    }

    /// The velocities `D w` of the system, and `Ḋ w`.
    fn push_forward(&mut self, w: &[f64]) {
        self.u.copy_from_slice(w);
        for turn in &self.rotations {
            let own = turn.part(w);
            turn.set_part(&mut self.u, &(turn.differential * own));
            turn.set_part(&mut self.rate, &differential_rate(&turn.angle, &own));
        }
    }

    /// Coordinates and velocities of the system at a state of the chart.
    pub(crate) fn system_state<'s>(&'s mut self, state: &'s State) -> (&'s [f64], &'s [f64]) {
        if self.is_trivial() {
            return (&state.q, &state.u);
        }
        self.place(&state.q);
        self.push_forward(&state.u);
        (&self.q, &self.u)
    }

    /// As [`system_state`](Self::system_state), wherever the chart is placed.
    pub(crate) fn to_system<'s>(
        &self,
        x: &'s [f64],
        w: &'s [f64],
    ) -> (Cow<'s, [f64]>, Cow<'s, [f64]>) {
        if self.is_trivial() {
            return (x.into(), w.into());
        }
        let (mut q, mut u) = (vec![0.0; self.q.len()], w.to_vec());
        self.system.advance(&self.centre, x, 1.0, &mut q);
        for turn in &self.rotations {
            turn.set_part(&mut u, &(differential(&turn.part(x)) * turn.part(w)));
        }
        (q.into(), u.into())
    }

    /// Moves the centre to the attitudes of a state, which becomes one of the new chart, as its accelerations do, where they
    /// have turned too far from it; whether it has.
    pub(crate) fn recentre(&mut self, state: &mut State, acceleration: &mut [f64]) -> bool {
        if !self.rotations.iter().any(|turn| turn.part(&state.q).norm() > RECENTRED) {
            return false;
        }
        self.place(&state.q);
        self.push_forward(&state.u);
        for turn in &self.rotations {
            let own = turn.differential * turn.part(acceleration) + turn.part(&self.rate);
            turn.set_part(acceleration, &own);
        }
        state.u.copy_from_slice(&self.u);
        let q = std::mem::take(&mut self.q);
        self.centre_at(&q, &mut state.q);
        self.q = q;
        true
    }

    /// Whether no attitude is more than a full turn from the centre, beyond which the series of `D` says nothing.
    pub(crate) fn reaches(&self, x: &[f64]) -> bool {
        // The comparison also turns away NaN.
        self.rotations.iter().all(|turn| turn.part(x).norm() <= TAU)
    }

    /// The longest step along which no attitude turns too far from the centre.
    pub(crate) fn turn_limit(&self, state: &State, acceleration: &[f64]) -> f64 {
        let limit = |turn: &Turn| {
            let left = FURTHEST - turn.part(&state.q).norm().min(RECENTRED);
            // Half of the turn by the present velocity, half by the present acceleration.
            let by_velocity = 0.5 * left / turn.part(&state.u).norm();
            by_velocity.min((left / turn.part(acceleration).norm()).sqrt())
        };
        self.rotations.iter().map(limit).fold(f64::INFINITY, f64::min)
    }
}

/// The coefficients of `D`, `a = (1 − cos φ)/φ²` and `b = (φ − sin φ)/φ³`, and their derivatives by φ over φ, by their
/// series in φ², which know no cancellation.
fn coefficients(square: f64) -> [f64; 4] {
    let [mut a, mut b, mut a_rate, mut b_rate] = [0.0; 4];
    // Σ (−1)ᵏ φ²ᵏ/(2k + 2)! and Σ (−1)ᵏ φ²ᵏ/(2k + 3)!.
    let (mut power, mut before, mut factorial) = (1.0, 0.0, 2.0);
    for k in 0..TERMS {
        let even = f64::from(2 * k);
        a += power / factorial;
        b += power / (factorial * (even + 3.0));
        a_rate += even * before / factorial;
        b_rate += even * before / (factorial * (even + 3.0));
        before = -power;
        power *= -square;
        factorial *= (even + 3.0) * (even + 4.0);
    }
    [a, b, a_rate, b_rate]
}

/// `D`.
fn differential(angle: &Vector3<f64>) -> Matrix3<f64> {
    let [a, b, ..] = coefficients(angle.norm_squared());
    let cross = angle.cross_matrix();
    Matrix3::identity() - cross * a + cross * cross * b
}

/// `Ḋ w` for `θ̇ = w`.
fn differential_rate(angle: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    let [_, b, a_rate, b_rate] = coefficients(angle.norm_squared());
    let along = angle.dot(rate);
    let turned = angle.cross(rate);
    turned * (-a_rate * along) + angle.cross(&turned) * (b_rate * along) + rate.cross(&turned) * b
}

#[cfg(test)]
mod tests;
