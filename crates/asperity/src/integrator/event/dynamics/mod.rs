//! Accelerations while every contact stays open, sticks or slips.
//!
//! `M a = h + Σ (w_N λ_N + W λ)`, with `λ = λ_N f(γ)` in slip, `γ̇ = 0` in stick and `γ̇_N = 0` at closed
//! unilateral contacts: one small linear system for the forces that are not given.

pub(crate) mod contact_variables;
pub(crate) mod inverse;
pub(crate) mod jacobian;
pub(crate) mod mobility;
pub(crate) mod sliding_force;

use nalgebra::DMatrix;

use crate::contact::Phase;
use crate::integrator::event::dynamics::contact_variables::{FieldError, ROWS, Touch};
use crate::integrator::event::dynamics::inverse::Inverse;
use crate::law::Law;
use crate::stepper::mass::MassFactor;
use crate::system::System;

/// The system in a mode.
#[derive(Debug)]
pub(crate) struct Field<'a> {
    pub(crate) system: &'a dyn System,
    pub(crate) n: usize,
    pub(crate) touches: Vec<Touch>,
    pub(crate) acceleration: Vec<f64>,
    /// The largest component of the accelerations that the forces would give one by one. The acceleration may
    /// be their difference, as small as rounding makes it: what it is compared with is this.
    pub(crate) load: f64,
    /// The way that rounding may make a contact go in the present step while the forces there balance.
    pub(crate) creep: f64,
    /// The last time at which the system is asked. Its forces may jump at the end of the motion, to which only
    /// their limit from the left belongs.
    latest: f64,
    /// Contacts whose force is given by a point of *D* instead of the sliding direction, and these points.
    pub(crate) held: Vec<(usize, [f64; 3])>,
    /// `Wᵀ` and `W_Nᵀ`, [`ROWS`] per contact, χ and `Ẇᵀu + χ̇` likewise.
    pub(crate) rows: Vec<f64>,
    pub(crate) chi: Vec<f64>,
    pub(crate) drift: Vec<f64>,
    /// `M⁻¹` times the rows.
    pub(crate) response: Vec<f64>,
    pub(crate) factor: Option<MassFactor>,
    mass: DMatrix<f64>,
    /// Whether rows and mass never change.
    pub(crate) constant: bool,
    ready: bool,
    /// Time between the points of differences along the motion, and the rows' velocities there.
    pub(crate) stencil: f64,
    pub(crate) widest: f64,
    pub(crate) along: Vec<[f64; 4]>,
    /// Rows of the equations for unknown forces, their columns `M⁻¹(…)`, solutions.
    unknown: Vec<usize>,
    columns: Vec<f64>,
    inverse: Inverse,
    pub(crate) solution: Vec<f64>,
    defects: Vec<f64>,
    /// Smooth part of the Jacobian.
    pub(crate) smooth_u: Vec<f64>,
    pub(crate) smooth_q: Vec<f64>,
    /// `∂γ/∂q`, row by row.
    pub(crate) slip_gradient: Vec<f64>,
    pub(crate) scratch: Vec<f64>,
    pub(crate) scratch_q: Vec<f64>,
}

impl<'a> Field<'a> {
    /// The system up to the time `t_end`, all contacts open.
    pub(crate) fn new(system: &'a dyn System, t_end: f64) -> Self {
        let (n, contacts) = (system.dof(), system.contacts().len());
        let touch = |contact: &crate::system::ContactLaw| Touch {
            mode: Phase::Open,
            resting: false,
            shared: false,
            tolerated: 0.0,
            p: contact.law.dimension(),
            prescribed: contact.normal_force,
            gap: 0.0,
            slip: [0.0; 3],
            sliding: [0.0; 3],
            normal_force: 0.0,
            force: [0.0; 3],
            resistance: 1.0,
            size: 0.0,
            speed: 0.0,
            creep: 0.0,
            reach: 0.0,
        };
        let row = vec![0.0; ROWS * contacts];
        let rows = vec![0.0; ROWS * contacts * n];
        let constancy = system.constancy();
        Self {
            system,
            n,
            touches: system.contacts().iter().map(touch).collect(),
            acceleration: vec![0.0; n],
            load: 0.0,
            creep: 0.0,
            latest: t_end.next_down(),
            held: Vec::new(),
            rows: rows.clone(),
            chi: row.clone(),
            drift: row.clone(),
            response: rows.clone(),
            factor: None,
            mass: DMatrix::zeros(n, n),
            constant: constancy.mass && constancy.contacts,
            ready: false,
            stencil: 0.0,
            widest: 0.0,
            along: vec![[0.0; 4]; ROWS * contacts],
            unknown: Vec::new(),
            columns: Vec::new(),
            inverse: Inverse::default(),
            solution: Vec::new(),
            defects: Vec::new(),
            smooth_u: vec![0.0; n * n],
            smooth_q: vec![0.0; n * n],
            slip_gradient: rows,
            scratch: vec![0.0; ROWS * n],
            scratch_q: vec![0.0; n],
        }
    }

    pub(crate) fn law(&self, contact: usize) -> &'a Law {
        &self.system.contacts()[contact].law
    }

    pub(crate) fn row(&self, row: usize) -> &[f64] {
        &self.rows[row * self.n..(row + 1) * self.n]
    }

    /// `γ̈_N` or a component of `γ̇` with these accelerations.
    pub(crate) fn rate(&self, row: usize, acceleration: &[f64]) -> f64 {
        dot(self.row(row), acceleration) + self.drift[row]
    }

    /// Rows of a contact that say `γ̇_N = 0` and `γ̇ = 0`.
    pub(crate) fn rows_of(&self, contact: usize) -> std::ops::Range<usize> {
        let touch = &self.touches[contact];
        let first = ROWS * contact + usize::from(touch.prescribed.is_some());
        first..ROWS * contact + 1 + touch.p
    }

    /// Rows, gaps and relative velocities of all contacts.
    pub(crate) fn kinematics(&mut self, t: f64, q: &[f64], u: &[f64]) -> Result<(), FieldError> {
        let (n, fresh) = (self.n, !self.constant || !self.ready);
        for (i, touch) in self.touches.iter_mut().enumerate() {
            let own = &mut self.rows[ROWS * i * n..ROWS * (i + 1) * n];
            if touch.prescribed.is_none() {
                touch.gap = self.system.gap(t, q, i, &mut own[..n])?;
            }
            let chi = &mut self.chi[ROWS * i + 1..ROWS * i + 1 + touch.p];
            let tangent = &mut own[n..(1 + touch.p) * n];
            if fresh {
                self.system.tangent(t, q, i, tangent, chi)?;
            }
            let mut size = 0.0;
            for ((slip, chi), row) in touch.slip.iter_mut().zip(chi).zip(tangent.chunks_exact(n)) {
                *slip = *chi + dot(row, u);
                let parts: f64 = row.iter().zip(u).map(|(w, u)| (w * u).abs()).sum();
                size += (chi.abs() + parts) * (chi.abs() + parts);
            }
            touch.size = size.sqrt();
        }
        if !fresh {
            return Ok(());
        }
        if self.factor.is_none() || !self.system.constancy().mass {
            self.system.mass(q, &mut self.mass)?;
            self.factor = MassFactor::new(&self.mass);
        }
        let Some(factor) = &self.factor else { return Err(FieldError::SingularMass { time: t }) };
        self.response.copy_from_slice(&self.rows);
        self.response.chunks_exact_mut(n).for_each(|row| factor.solve(row));
        self.ready = true;
        (0..self.touches.len())
            .filter(|&i| !self.touches[i].is_free())
            .try_for_each(|i| self.check_rows(i))
    }

    /// Accelerations and contact forces; `frozen` leaves the sliding forces per unit normal force as they are.
    pub(crate) fn evaluate(
        &mut self,
        t: f64,
        q: &[f64],
        u: &[f64],
        frozen: bool,
    ) -> Result<(), FieldError> {
        let t = t.min(self.latest);
        self.kinematics(t, q, u)?;
        if !self.constant {
            self.update_drift(t, q, u, |touch| !touch.is_free())?;
        }
        self.system.forces(t, q, u, &mut self.acceleration)?;
        if let Some(factor) = &self.factor {
            factor.solve(&mut self.acceleration);
        }
        self.load = largest(&self.acceleration);
        for i in 0..self.touches.len() {
            if self.touches[i].mode == Phase::Slip && !frozen {
                let slip = self.touches[i].slip;
                if let Some(sliding) = sliding_force::sliding(self.law(i), &slip) {
                    self.touches[i].sliding = sliding;
                }
            }
        }
        for &(i, z) in &self.held {
            let slip = self.touches[i].slip;
            if let Some(at) = sliding_force::at_point(self.law(i), &z, &slip) {
                self.touches[i].sliding = at.sliding;
            }
        }
        self.given_forces();
        self.unknown_forces();
        Ok(())
    }

    /// Friction forces of slipping contacts with given normal force.
    fn given_forces(&mut self) {
        let n = self.n;
        for (i, touch) in self.touches.iter_mut().enumerate() {
            (touch.force, touch.shared) = ([0.0; 3], false);
            touch.normal_force = touch.prescribed.unwrap_or(0.0);
            if let (Phase::Slip, Some(normal_force)) = (touch.mode, touch.prescribed) {
                for r in 0..touch.p {
                    touch.force[r] = normal_force * touch.sliding[r];
                    let column = &self.response[(ROWS * i + 1 + r) * n..][..n];
                    add(&mut self.acceleration, touch.force[r], column);
                    self.load = self.load.max(touch.force[r].abs() * largest(column));
                }
            }
        }
    }

    /// Forces that the constraints need, and what they do.
    fn unknown_forces(&mut self) {
        let n = self.n;
        self.unknown.clear();
        self.columns.clear();
        for i in 0..self.touches.len() {
            let touch = self.touches[i];
            match (touch.mode, touch.prescribed) {
                (Phase::Stick, _) => {
                    let rows = self.rows_of(i);
                    self.columns.extend_from_slice(&self.response[rows.start * n..rows.end * n]);
                    self.unknown.extend(rows);
                }
                (Phase::Slip, None) => {
                    let normal = ROWS * i;
                    let first = self.columns.len();
                    self.unknown.push(normal);
                    self.columns.extend_from_slice(&self.response[normal * n..(normal + 1) * n]);
                    let column = &mut self.columns[first..];
                    let frictionless = dot(&self.rows[normal * n..(normal + 1) * n], column);
                    for r in 0..touch.p {
                        add(column, touch.sliding[r], &self.response[(normal + 1 + r) * n..][..n]);
                    }
                    let all = dot(&self.rows[normal * n..(normal + 1) * n], column);
                    self.touches[i].resistance = all / frictionless;
                }
                _ => {}
            }
        }
        let count = self.unknown.len();
        if count == 0 {
            return;
        }
        let (unknown, rows, columns) = (&self.unknown, &self.rows, &self.columns);
        let row = |k: usize| &rows[unknown[k] * n..(unknown[k] + 1) * n];
        self.inverse.of(count, |k, l| dot(row(k), &columns[l * n..(l + 1) * n]));
        self.solution.clear();
        self.solution.resize(count, 0.0);
        // An inverse leaves residuals that grow with the condition of the matrix, such as where light and heavy
        // degrees of freedom meet. Where forces balance they would be accelerations: solved once more for what is
        // left they are those of rounding.
        for _ in 0..2 {
            self.defects.clear();
            let defect = |k: usize| -self.drift[unknown[k]] - dot(row(k), &self.acceleration);
            self.defects.extend((0..count).map(defect));
            self.inverse.apply(&mut self.defects);
            let parts = columns.chunks_exact(n).zip(&self.defects);
            for ((column, x), total) in parts.zip(&mut self.solution) {
                add(&mut self.acceleration, *x, column);
                self.load = self.load.max(x.abs() * largest(column));
                *total += x;
            }
        }
        self.read_solution();
    }

    fn read_solution(&mut self) {
        for (&row, &x) in self.unknown.iter().zip(&self.solution) {
            let touch = &mut self.touches[row / ROWS];
            match (row % ROWS, touch.mode) {
                (0, Phase::Slip) => {
                    touch.normal_force = x;
                    touch.force = touch.sliding.map(|f| f * x);
                }
                (0, _) => touch.normal_force = x,
                (r, _) => touch.force[r - 1] = x,
            }
        }
    }

    /// `M⁻¹` times a vector given as `M⁻¹` of it already, less what the unknown forces answer; their change
    /// is left in `solution`.
    pub(crate) fn constrain(&mut self, response: &mut [f64]) {
        let n = self.n;
        self.solution.clear();
        for &row in &self.unknown {
            self.solution.push(-dot(&self.rows[row * n..(row + 1) * n], response));
        }
        self.inverse.apply(&mut self.solution);
        for (column, x) in self.columns.chunks_exact(n).zip(&self.solution) {
            add(response, *x, column);
        }
    }

    /// Whether the contacts can share the last unknown forces in many ways, of which the smallest was taken.
    pub(crate) fn indeterminate(&self) -> bool {
        !self.unknown.is_empty() && self.inverse.singular
    }

    /// The contacts' rows of the last unknown forces.
    pub(crate) fn unknown(&self) -> &[usize] {
        &self.unknown
    }
}

/// The largest size of a component.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

/// `target += factor values`.
#[inline]
pub(crate) fn add(target: &mut [f64], factor: f64, values: &[f64]) {
    for (t, v) in target.iter_mut().zip(values) {
        *t += factor * v;
    }
}

#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
