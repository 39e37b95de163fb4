//! Samples of a motion, whatever has computed it.

use std::ops::Range;

use crate::contact::Phase;

/// Samples of a motion, time first. Vectors of contacts whose law has less than `p` dimensions are padded with NaN.
///
/// ```
/// use asperity::contact::Phase;
/// use asperity::law::FrictionLaw;
/// use asperity::simulate::{Options, simulate};
/// use asperity::system::sliding_point;
///
/// let point = sliding_point(1.0, FrictionLaw::isotropic(0.5)?, 10.0)?;
/// let options = Options::new(1e-2, 0.1)?.with_start(&[0.0, 0.0], &[1.0, 0.0]);
/// let run = simulate(&point, &options)?;
/// let samples = &run.trajectory.samples;
/// let last = samples.len() - 1;
/// let (end, contact) = (samples.state(last), samples.contact(last, 0));
/// // Friction of 5 N against the motion, for 0.1 s.
/// assert!((end.t - 0.1).abs() < 1e-12 && (end.u[0] - 0.5).abs() < 1e-9);
/// assert!(contact.phase == Phase::Slip && (contact.force[0] + 5.0).abs() < 1e-9);
/// assert!(samples.phases(last).all(|phase| phase == Phase::Slip));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
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

/// A sample without its contacts.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StateSample<'a> {
    /// Time in s.
    pub t: f64,
    /// Coordinates.
    pub q: &'a [f64],
    /// Velocities.
    pub u: &'a [f64],
}

/// A contact in a sample; vectors are padded as in [`Samples`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactSample<'a> {
    /// Slip velocity γ in m/s.
    pub slip: &'a [f64],
    /// Friction force λ in N.
    pub force: &'a [f64],
    /// Normal force λ_N in N.
    pub normal_force: f64,
    /// What the contact does.
    pub phase: Phase,
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
    pub(crate) fn push_contact(&mut self, contact: &ContactSample<'_>) {
        for (to, from) in [(&mut self.slip, contact.slip), (&mut self.force, contact.force)] {
            to.extend_from_slice(from);
            to.extend((from.len()..self.p).map(|_| f64::NAN));
        }
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

    /// Time, coordinates and velocities of sample `k`.
    ///
    /// # Panics
    ///
    /// If there is no such sample.
    pub fn state(&self, k: usize) -> StateSample<'_> {
        let q = &self.q[k * self.coordinates..][..self.coordinates];
        StateSample { t: self.t[k], q, u: &self.u[k * self.dof..][..self.dof] }
    }

    /// What the contacts do in sample `k`.
    ///
    /// # Panics
    ///
    /// If there is no such sample.
    pub fn phases(&self, k: usize) -> impl Iterator<Item = Phase> {
        let numbers = &self.phase[k * self.contacts..][..self.contacts];
        numbers.iter().map(|&number| Phase::from_number(number).unwrap_or(Phase::Unknown))
    }

    /// Contact `i` in sample `k`.
    ///
    /// # Panics
    ///
    /// If there is no such sample or contact.
    pub fn contact(&self, k: usize, i: usize) -> ContactSample<'_> {
        let phase = self.phase[k * self.contacts..][..self.contacts][i];
        let at = k * self.contacts + i;
        ContactSample {
            slip: &self.slip[at * self.p..][..self.p],
            force: &self.force[at * self.p..][..self.p],
            normal_force: self.normal_force[at],
            phase: Phase::from_number(phase).unwrap_or(Phase::Unknown),
        }
    }

    /// Appends samples of another run of the same system.
    pub(crate) fn copy(&mut self, of: &Self, samples: Range<usize>) {
        for ((to, width), from) in self.columns_mut().zip(of.columns()) {
            to.extend_from_slice(&from[samples.start * width..samples.end * width]);
        }
        let phases = samples.start * of.contacts..samples.end * of.contacts;
        self.phase.extend_from_slice(&of.phase[phases]);
    }

    /// Appends a sample once more.
    pub(crate) fn repeat(&mut self, sample: usize) {
        for (column, width) in self.columns_mut() {
            column.extend_from_within(sample * width..(sample + 1) * width);
        }
        self.phase.extend_from_within(sample * self.contacts..(sample + 1) * self.contacts);
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
