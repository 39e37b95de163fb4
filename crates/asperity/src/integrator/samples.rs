//! Samples of a motion, whatever has computed it.

use std::ops::Range;

use crate::contact::Phase;

/// Samples of a motion, time first. Vectors of contacts whose law has less than `p` dimensions are padded with NaN.
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(remote = "Self", deny_unknown_fields))]
#[non_exhaustive]
pub struct Samples {
    /// Number of coordinates.
    pub coordinates: usize,
    /// Number of degrees of freedom.
    pub dof: usize,
    /// Number of contacts.
    pub contacts: usize,
    /// Largest dimension of the laws.
    pub p: usize,
    /// Times in s.
    #[cfg_attr(feature = "serde", serde(with = "crate::integrator::numbers"))]
    pub t: Vec<f64>,
    /// Coordinates `(n_t, coordinates)`.
    #[cfg_attr(feature = "serde", serde(with = "crate::integrator::numbers"))]
    pub q: Vec<f64>,
    /// Velocities `(n_t, dof)`.
    #[cfg_attr(feature = "serde", serde(with = "crate::integrator::numbers"))]
    pub u: Vec<f64>,
    /// Slip velocities γ `(n_t, n_c, p)`.
    #[cfg_attr(feature = "serde", serde(with = "crate::integrator::numbers"))]
    pub slip: Vec<f64>,
    /// Friction forces λ `(n_t, n_c, p)`.
    #[cfg_attr(feature = "serde", serde(with = "crate::integrator::numbers"))]
    pub force: Vec<f64>,
    /// Normal forces λ_N `(n_t, n_c)`.
    #[cfg_attr(feature = "serde", serde(with = "crate::integrator::numbers"))]
    pub normal_force: Vec<f64>,
    /// Phases `(n_t, n_c)`.
    pub phase: Vec<i8>,
}

/// A contact in a sample.
pub(crate) struct ContactSample {
    /// Dimension of the law.
    pub(crate) dimension: usize,
    pub(crate) slip: [f64; 3],
    pub(crate) force: [f64; 3],
    pub(crate) normal_force: f64,
    pub(crate) phase: Phase,
}

impl Samples {
    /// No samples of a system with these laws yet.
    pub(crate) fn new(coordinates: usize, dof: usize, dimensions: &[usize]) -> Self {
        let p = dimensions.iter().copied().max().unwrap_or(0);
        Self { coordinates, dof, contacts: dimensions.len(), p, ..Self::default() }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Appends a contact to the sample that the next call of [`push_state`](Self::push_state) completes.
    pub(crate) fn push_contact(&mut self, contact: &ContactSample) {
        let padded = |v: [f64; 3]| {
            (0..self.p).map(move |i| if i < contact.dimension { v[i] } else { f64::NAN })
        };
        self.slip.extend(padded(contact.slip));
        self.force.extend(padded(contact.force));
        self.normal_force.push(contact.normal_force);
        self.phase.push(contact.phase as i8);
    }

    /// Completes a sample, after its contacts.
    pub(crate) fn push_state(&mut self, t: f64, q: &[f64], u: &[f64]) {
        self.t.push(t);
        self.q.extend_from_slice(q);
        self.u.extend_from_slice(u);
    }

    /// The columns of numbers.
    fn columns(&self) -> [&Vec<f64>; 6] {
        [&self.t, &self.q, &self.u, &self.slip, &self.force, &self.normal_force]
    }

    /// The columns of numbers with their entries per sample.
    fn columns_mut(&mut self) -> impl Iterator<Item = (&mut Vec<f64>, usize)> {
        let Self { coordinates, dof, contacts, t, q, u, slip, force, normal_force, .. } = self;
        let row = *contacts * self.p;
        let state = [(t, 1), (q, *coordinates), (u, *dof)];
        let forces = [(slip, row), (force, row), (normal_force, *contacts)];
        state.into_iter().chain(forces)
    }

    /// Time, coordinates and velocities of a sample.
    pub(crate) fn state(&self, sample: usize) -> (f64, &[f64], &[f64]) {
        let q = &self.q[sample * self.coordinates..][..self.coordinates];
        (self.t[sample], q, &self.u[sample * self.dof..][..self.dof])
    }

    /// What the contacts do in a sample.
    pub(crate) fn phases(&self, sample: usize) -> impl Iterator<Item = Phase> {
        let numbers = &self.phase[sample * self.contacts..][..self.contacts];
        numbers.iter().map(|&number| Phase::from_number(number).unwrap_or(Phase::Unknown))
    }

    /// Appends samples of another run of the same system.
    pub(crate) fn copy(&mut self, of: &Self, samples: Range<usize>) {
        for ((to, width), from) in self.columns_mut().zip(of.columns()) {
            to.extend_from_slice(&from[samples.start * width..samples.end * width]);
        }
        let phases = samples.start * of.contacts..samples.end * of.contacts;
        self.phase.extend_from_slice(&of.phase[phases]);
    }

    /// Appends samples that there are not: NaN, and phases unknown.
    pub(crate) fn leave_out(&mut self, samples: usize) {
        for (to, width) in self.columns_mut() {
            to.resize(to.len() + samples * width, f64::NAN);
        }
        let phases = self.phase.len() + samples * self.contacts;
        self.phase.resize(phases, Phase::Unknown as i8);
    }

    /// Replaces samples from one on by others.
    pub(crate) fn overwrite(&mut self, first: usize, by: &Self) {
        for ((to, width), from) in self.columns_mut().zip(by.columns()) {
            to[first * width..][..from.len()].copy_from_slice(from);
        }
        self.phase[first * by.contacts..][..by.phase.len()].copy_from_slice(&by.phase);
    }

    /// Keeps the first samples, without contacts of one that is not complete.
    pub(crate) fn truncate(&mut self, samples: usize) {
        self.columns_mut().for_each(|(to, width)| to.truncate(samples * width));
        self.phase.truncate(samples * self.contacts);
    }
}
