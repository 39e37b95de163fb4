//! From the system at the midpoint to the contact problem, and back from percussions to velocities.

use nalgebra::DMatrix;

use super::mass::MassFactor;
use super::rated::Factors;
use crate::contact::{ContactProblem, ContactRows, Delassus, NormalForce};
use crate::system::{System, SystemError};

/// What has changed in the contact problem besides the velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Change {
    /// Nothing.
    None,
    /// The Delassus operator.
    Operator,
    /// The set of closed contacts, and with it everything.
    Contacts,
}

/// The contact problem of the present step with what it was made from.
#[derive(Debug)]
pub(super) struct Assembly {
    dof: usize,
    /// Contacts that are closed at the midpoint, and those of the last step.
    active: Vec<usize>,
    closed: Vec<usize>,
    /// Place of every contact in the problem.
    places: Vec<Option<usize>>,
    /// Whether the problem has been assembled at all.
    ready: bool,
    /// Whether contacts neither open, close nor change their directions.
    fixed: bool,
    /// Rows `W_Nᵀ`, `Wᵀ` of the closed contacts, one after another.
    jacobian: Vec<f64>,
    /// `M⁻¹W`, one column after another.
    response: Vec<f64>,
    chi: Vec<f64>,
    /// `e_N`, `e_T` row by row.
    restitution: Vec<f64>,
    bounces: bool,
    factors: Factors,
    /// Rows of `W_Nᵀ` of all unilateral contacts at the midpoint, and a row of scratch for each.
    normals: Vec<f64>,
    scratch: Vec<f64>,
    problem: ContactProblem,
}

impl Assembly {
    pub(super) fn new(system: &dyn System) -> Self {
        let (dof, contacts) = (system.dof(), system.contacts().len());
        Self {
            dof,
            active: Vec::with_capacity(contacts),
            closed: Vec::with_capacity(contacts),
            places: vec![None; contacts],
            ready: false,
            fixed: system.constancy().contacts
                && system.contacts().iter().all(|contact| contact.normal_force.is_some()),
            jacobian: Vec::new(),
            response: Vec::new(),
            chi: Vec::new(),
            restitution: Vec::new(),
            bounces: false,
            factors: Factors::default(),
            normals: vec![0.0; dof * contacts],
            scratch: vec![0.0; dof * 3],
            problem: ContactProblem::empty(),
        }
    }

    pub(super) fn problem(&self) -> &ContactProblem {
        &self.problem
    }

    /// Contacts in the problem, in its order.
    pub(super) fn active(&self) -> &[usize] {
        &self.active
    }

    /// Contacts that were in the problem before the last change.
    pub(super) fn before(&self) -> &[usize] {
        &self.closed
    }

    /// Place of a contact in the problem, if it is closed.
    #[inline]
    pub(super) fn place(&self, contact: usize) -> Option<usize> {
        self.places[contact]
    }

    /// `γ = Wᵀu + χ` of any contact.
    pub(super) fn slip(
        &mut self,
        system: &dyn System,
        t: f64,
        q: &[f64],
        u: &[f64],
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

    /// Brings the Delassus operator up to date; `before` and `free` are the velocities before the step
    /// and without contact forces.
    pub(super) fn update(
        &mut self,
        system: &dyn System,
        (t, q, dt): (f64, &[f64], f64),
        (before, free): (&[f64], &[f64]),
        factor: &MassFactor,
        new_mass: bool,
    ) -> Result<Change, SystemError> {
        if self.ready && self.fixed && !new_mass {
            return Ok(if self.factors.any() { self.rate(before) } else { Change::None });
        }
        // A resting contact may be lifted by rounding: by a millionth of the way that the contact forces
        // have to make up for in a step it is not open yet.
        let pairs = free.iter().zip(before);
        let drift = 1e-6 * dt * pairs.fold(0.0, |d: f64, (free, u)| d.max((free - u).abs()));
        self.find_closed(system, t, q, drift)?;
        let same_contacts = self.ready && self.closed == self.active;
        if same_contacts && system.constancy().contacts && !new_mass {
            return Ok(if self.factors.any() { self.rate(before) } else { Change::None });
        }
        if !same_contacts {
            std::mem::swap(&mut self.active, &mut self.closed);
            self.resize(system, dt);
        }
        self.fill(system, t, q, factor)?;
        self.factors.keep(&self.problem);
        if self.factors.any() {
            self.rate(before);
        }
        self.ready = true;
        Ok(if same_contacts { Change::Operator } else { Change::Contacts })
    }

    /// Factors of the friction force at the velocities before the step.
    #[cold]
    #[inline(never)]
    fn rate(&mut self, before: &[f64]) -> Change {
        let (n, jacobian, chi) = (self.dof, &self.jacobian, &self.chi);
        let slip = |row: usize| dot(&jacobian[row * n..(row + 1) * n], before) + chi[row];
        self.factors.apply(&mut self.problem, slip);
        Change::Operator
    }

    /// Friction percussion of a row from the one that the solver gives.
    #[inline]
    pub(super) fn percussion(&self, row: usize, solved: f64) -> f64 {
        solved * self.factors.of(row)
    }

    fn find_closed(
        &mut self,
        system: &dyn System,
        t: f64,
        q: &[f64],
        drift: f64,
    ) -> Result<(), SystemError> {
        self.closed.clear();
        for (contact, law) in system.contacts().iter().enumerate() {
            let row = &mut self.normals[contact * self.dof..(contact + 1) * self.dof];
            let closed = law.normal_force.is_some() || {
                let gap = system.gap(t, q, contact, row)?;
                let lift = if self.places[contact].is_some() { drift * largest(row) } else { 0.0 };
                gap <= lift
            };
            if closed {
                self.closed.push(contact);
            }
        }
        Ok(())
    }

    /// Rows, sizes and restitution for a new set of closed contacts.
    fn resize(&mut self, system: &dyn System, dt: f64) {
        let laws = system.contacts();
        let normal_force = |contact: usize| match laws[contact].normal_force {
            Some(force) => NormalForce::Prescribed(force * dt),
            None => NormalForce::Unilateral,
        };
        self.problem = ContactProblem::blank(
            self.active.iter().map(|&c| (laws[c].law.clone(), normal_force(c))),
        );
        self.factors.reset(&self.problem);
        self.places.fill(None);
        for (place, &contact) in self.active.iter().enumerate() {
            self.places[contact] = Some(place);
        }
        let rows = self.problem.rows();
        self.jacobian.resize(rows * self.dof, 0.0);
        self.response.resize(rows * self.dof, 0.0);
        self.chi.resize(rows, 0.0);
        self.restitution.resize(rows, 0.0);
        for (contact, &c) in self.problem.contacts.iter().zip(&self.active) {
            self.restitution[contact.offset] = laws[c].normal_restitution;
            let tangent = contact.tangent()..contact.offset + contact.len();
            self.restitution[tangent].fill(laws[c].tangential_restitution);
        }
        self.bounces = self.restitution.iter().any(|&e| e != 0.0);
    }

    fn fill(
        &mut self,
        system: &dyn System,
        t: f64,
        q: &[f64],
        factor: &MassFactor,
    ) -> Result<(), SystemError> {
        let n = self.dof;
        for (contact, &c) in self.problem.contacts.iter().zip(&self.active) {
            if contact.normal_rows() == 1 {
                self.jacobian[contact.offset * n..(contact.offset + 1) * n]
                    .copy_from_slice(&self.normals[c * n..(c + 1) * n]);
                self.chi[contact.offset] = 0.0;
            }
            let rows = contact.tangent()..contact.offset + contact.len();
            let tangent = &mut self.jacobian[rows.start * n..rows.end * n];
            system.tangent(t, q, c, tangent, &mut self.chi[rows])?;
        }
        self.response.copy_from_slice(&self.jacobian);
        for column in self.response.chunks_exact_mut(n) {
            factor.solve(column);
        }
        let rows = self.problem.rows();
        if let Delassus::Dense(delassus) = &mut self.problem.delassus {
            for i in 0..rows {
                let row = &self.jacobian[i * n..(i + 1) * n];
                for j in 0..rows {
                    delassus[(i, j)] = dot(row, &self.response[j * n..(j + 1) * n]);
                }
            }
        }
        self.problem.update_rho();
        self.check_directions()
    }

    /// A direction that moves nothing would make the friction force meaningless.
    fn check_directions(&self) -> Result<(), SystemError> {
        for (i, (contact, c)) in self.problem.contacts.iter().zip(&self.active).enumerate() {
            let diagonal = |a| self.problem.delassus.own(i, contact.offset, a, a);
            if (0..contact.len()).any(|a| !(diagonal(a) > 0.0)) {
                let message = format!("must be finite and not zero, is not at contact {c}");
                return Err(SystemError::argument("direction", message));
            }
        }
        Ok(())
    }

    /// Free velocities and restitution terms from the velocities before and without contact forces.
    pub(super) fn load(&mut self, before: &[f64], free: &[f64]) {
        let n = self.dof;
        for i in 0..self.problem.rows() {
            let row = &self.jacobian[i * n..(i + 1) * n];
            self.problem.free_velocity[i] = dot(row, free) + self.chi[i];
            if self.bounces {
                self.problem.restitution[i] =
                    self.restitution[i] * (dot(row, before) + self.chi[i]);
            }
        }
    }

    /// `velocity ← velocity + M⁻¹W P`.
    pub(super) fn apply(&self, percussion: &[f64], velocity: &mut [f64]) {
        let n = self.dof;
        let rated = self.factors.any();
        for (j, p) in percussion.iter().enumerate() {
            let p = if rated { self.percussion(j, *p) } else { *p };
            for (value, c) in velocity.iter_mut().zip(&self.response[j * n..(j + 1) * n]) {
                *value += c * p;
            }
        }
    }
}

impl ContactProblem {
    fn empty() -> Self {
        Self::blank(std::iter::empty())
    }

    /// A problem of zeros to be filled in.
    fn blank(contacts: impl Iterator<Item = (crate::law::Law, NormalForce)>) -> Self {
        let mut rows = 0;
        let contacts: Vec<ContactRows> = contacts
            .map(|(law, normal)| {
                let contact = ContactRows { law, normal, offset: rows };
                rows += contact.len();
                contact
            })
            .collect();
        let count = contacts.len();
        Self {
            delassus: DMatrix::zeros(rows, rows).into(),
            free_velocity: vec![0.0; rows],
            restitution: vec![0.0; rows],
            contacts,
            rho: vec![0.0; count],
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |m: f64, v| m.max(v.abs()))
}

#[inline]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
