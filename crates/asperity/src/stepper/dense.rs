//! From any system at the midpoint to the contact problem, and back from percussions to velocities, with
//! dense matrices.

use nalgebra::DMatrix;

use super::StepError;
use super::closed::{Change, Closed};
use super::mass::MassFactor;
use super::rated::Factors;
use crate::contact::Delassus;
use crate::system::{System, SystemError};

/// The system's matrices at the midpoint.
#[derive(Debug)]
pub(super) struct Dense {
    dof: usize,
    /// Whether contacts neither open, close nor change their directions.
    fixed: bool,
    q_mid: Vec<f64>,
    /// Forces, then velocities without contact forces, then the new velocities.
    free: Vec<f64>,
    mass: DMatrix<f64>,
    factor: Option<MassFactor>,
    /// Rows `W_Nᵀ`, `Wᵀ` of the closed contacts, one after another.
    jacobian: Vec<f64>,
    /// `M⁻¹W`, one column after another.
    response: Vec<f64>,
    chi: Vec<f64>,
    factors: Factors,
    /// Rows of `W_Nᵀ` of all unilateral contacts at the midpoint, and a row of scratch for each.
    normals: Vec<f64>,
    scratch: Vec<f64>,
}

impl Dense {
    pub(super) fn new(system: &dyn System) -> Self {
        let (dof, contacts) = (system.dof(), system.contacts().len());
        Self {
            dof,
            fixed: system.constancy().contacts
                && system.contacts().iter().all(|contact| contact.normal_force.is_some()),
            q_mid: vec![0.0; system.coordinates()],
            free: vec![0.0; dof],
            mass: DMatrix::zeros(dof, dof),
            factor: None,
            jacobian: Vec::new(),
            response: Vec::new(),
            chi: Vec::new(),
            factors: Factors::default(),
            normals: vec![0.0; dof * contacts],
            scratch: vec![0.0; dof * 3],
        }
    }

    /// `γ = Wᵀu + χ` of any contact.
    pub(super) fn slip(
        &mut self,
        system: &dyn System,
        t: f64,
        (q, u): (&[f64], &[f64]),
        contact: usize,
    ) -> Result<[f64; 3], SystemError> {
        let p = system.contacts()[contact].law.dimension();
        let mut slip = [0.0; 3];
        let rows = &mut self.scratch[..p * self.dof];
        system.tangent(t, q, contact, rows, &mut slip[..p])?;
        for (value, row) in slip.iter_mut().zip(rows.chunks_exact(self.dof)) {
            *value += dot(row, u);
        }
        Ok(slip)
    }

    /// The contact problem of the step from `q`, `u`.
    pub(super) fn update(
        &mut self,
        system: &dyn System,
        (t, dt): (f64, f64),
        (q, u): (&[f64], &[f64]),
        closed: &mut Closed,
    ) -> Result<Change, StepError> {
        system.advance(q, u, 0.5 * dt, &mut self.q_mid);
        let new_mass = self.update_mass(system, t)?;
        system.forces(t, &self.q_mid, u, &mut self.free)?;
        let Some(factor) = &self.factor else {
            return Err(StepError::SingularMass { time: t });
        };
        factor.solve(&mut self.free);
        for (free, u) in self.free.iter_mut().zip(u) {
            *free = u + dt * *free;
        }
        let change = self.update_operator(system, (t, dt), u, closed, new_mass)?;
        let (n, jacobian, chi) = (self.dof, &self.jacobian, &self.chi);
        let rows = jacobian.chunks_exact(n.max(1)).zip(chi);
        for (value, (row, chi)) in closed.problem.free_velocity_mut().iter_mut().zip(rows) {
            *value = dot(row, &self.free) + chi;
        }
        let velocity = |row: usize, u: &[f64]| dot(&jacobian[row * n..(row + 1) * n], u) + chi[row];
        if closed.bounces() {
            closed.bounce(|row| velocity(row, u));
        }
        Ok(change)
    }

    fn update_mass(&mut self, system: &dyn System, t: f64) -> Result<bool, StepError> {
        if system.constancy().mass && self.factor.is_some() {
            return Ok(false);
        }
        system.mass(&self.q_mid, &mut self.mass)?;
        self.factor = MassFactor::new(&self.mass);
        match self.factor {
            Some(_) => Ok(true),
            None => Err(StepError::SingularMass { time: t }),
        }
    }

    /// Brings the Delassus operator up to date; `u` are the velocities before the step.
    fn update_operator(
        &mut self,
        system: &dyn System,
        (t, dt): (f64, f64),
        u: &[f64],
        closed: &mut Closed,
        new_mass: bool,
    ) -> Result<Change, SystemError> {
        if closed.ready && self.fixed && !new_mass {
            return Ok(if self.factors.any() { self.rate(u, closed) } else { Change::None });
        }
        // A resting contact may be lifted by rounding: by a millionth of the way that the contact forces
        // have to make up for in a step it is not open yet.
        let pairs = self.free.iter().zip(u);
        let drift = 1e-6 * dt * pairs.fold(0.0, |d: f64, (free, u)| d.max((free - u).abs()));
        self.find_closed(system, t, drift, closed)?;
        let same_contacts = closed.ready && closed.found == closed.active;
        if same_contacts && system.constancy().contacts && !new_mass {
            return Ok(if self.factors.any() { self.rate(u, closed) } else { Change::None });
        }
        if !same_contacts {
            closed.renew(system.contacts(), dt, |contacts| {
                let rows = contacts.last().map_or(0, |last| last.offset + last.len());
                DMatrix::zeros(rows, rows).into()
            });
            self.factors.reset(&closed.problem);
            let rows = closed.problem.rows();
            self.jacobian.resize(rows * self.dof, 0.0);
            self.response.resize(rows * self.dof, 0.0);
            self.chi.resize(rows, 0.0);
        }
        self.fill(system, t, closed)?;
        self.factors.keep(&closed.problem);
        if self.factors.any() {
            self.rate(u, closed);
        }
        Ok(if same_contacts { Change::Operator } else { Change::Contacts })
    }

    /// Factors of the friction force at the velocities before the step, with which the search for those of its
    /// end begins.
    #[cold]
    #[inline(never)]
    fn rate(&mut self, before: &[f64], closed: &mut Closed) -> Change {
        let (n, jacobian, chi) = (self.dof, &self.jacobian, &self.chi);
        let slip = |row: usize| dot(&jacobian[row * n..(row + 1) * n], before) + chi[row];
        self.factors.update(&closed.problem, slip);
        self.factors.apply(&mut closed.problem);
        Change::Operator
    }

    /// Factors of the speed.
    #[inline]
    pub(super) fn factors(&mut self) -> &mut Factors {
        &mut self.factors
    }

    fn find_closed(
        &mut self,
        system: &dyn System,
        t: f64,
        drift: f64,
        closed: &mut Closed,
    ) -> Result<(), SystemError> {
        closed.found.clear();
        for (contact, law) in system.contacts().iter().enumerate() {
            let row = &mut self.normals[contact * self.dof..(contact + 1) * self.dof];
            let touches = law.normal_force.is_some() || {
                let gap = system.gap(t, &self.q_mid, contact, row)?;
                let lift = if closed.was_closed(contact) { drift * largest(row) } else { 0.0 };
                gap <= lift
            };
            if touches {
                closed.found.push(contact);
            }
        }
        Ok(())
    }

    fn fill(
        &mut self,
        system: &dyn System,
        t: f64,
        closed: &mut Closed,
    ) -> Result<(), SystemError> {
        let n = self.dof;
        for (contact, &c) in closed.problem.contacts().iter().zip(&closed.active) {
            if contact.normal_rows() == 1 {
                self.jacobian[contact.offset * n..(contact.offset + 1) * n]
                    .copy_from_slice(&self.normals[c * n..(c + 1) * n]);
                self.chi[contact.offset] = 0.0;
            }
            let rows = contact.tangent()..contact.offset + contact.len();
            let tangent = &mut self.jacobian[rows.start * n..rows.end * n];
            system.tangent(t, &self.q_mid, c, tangent, &mut self.chi[rows])?;
        }
        self.response.copy_from_slice(&self.jacobian);
        if let Some(factor) = &self.factor {
            for column in self.response.chunks_exact_mut(n) {
                factor.solve(column);
            }
        }
        let rows = closed.problem.rows();
        closed.problem.refill(|delassus| {
            let Delassus::Dense(delassus) = delassus else { return };
            for i in 0..rows {
                let row = &self.jacobian[i * n..(i + 1) * n];
                for j in 0..rows {
                    delassus[(i, j)] = dot(row, &self.response[j * n..(j + 1) * n]);
                }
            }
        });
        check_directions(closed)
    }

    /// Coordinates and velocities at the end of the step, from the percussions.
    pub(super) fn finish(
        &mut self,
        system: &dyn System,
        percussion: &[f64],
        dt: f64,
        (q, u): (&mut [f64], &mut Vec<f64>),
    ) {
        let (columns, rated) = (self.response.chunks_exact(self.dof.max(1)), self.factors.any());
        for (row, (column, p)) in columns.zip(percussion).enumerate() {
            let p = if rated { p * self.factors.of(row) } else { *p };
            for (value, c) in self.free.iter_mut().zip(column) {
                *value += c * p;
            }
        }
        std::mem::swap(u, &mut self.free);
        system.advance(&self.q_mid, u, 0.5 * dt, q);
    }
}

/// Refuses directions that move nothing.
fn check_directions(closed: &Closed) -> Result<(), SystemError> {
    for (i, (contact, c)) in closed.problem.contacts().iter().zip(&closed.active).enumerate() {
        let diagonal = |a| closed.problem.delassus().own(i, contact.offset, a, a);
        if (0..contact.len()).any(|a| !(diagonal(a) > 0.0)) {
            return Err(SystemError::direction(*c));
        }
    }
    Ok(())
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
