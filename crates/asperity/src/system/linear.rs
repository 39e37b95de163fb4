//! Linear systems, which say most users' models as data.

use std::sync::{Mutex, PoisonError};

use nalgebra::{DMatrix, Matrix2, Vector2};

use super::{
    Blocks, Configuration, Constancy, ContactLaw, MotionBounds, System, SystemError, SystemPart,
};
use crate::argument::{ArgumentError, entries, finite, refuse};
use crate::contact::{Components, NormalForce};
use crate::law::Law;
use crate::vectors::{dot, unrolled};

/// A contact of a linear system, with constant directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// Friction law.
    pub law: Law,
    /// `W`, one column per component of the friction force.
    pub direction: DMatrix<f64>,
    /// χ in `γ = Wᵀu + χ`; a belt moving with v has χ = −v.
    pub velocity: Vec<f64>,
    /// Normal force, in N if it is prescribed.
    pub normal_force: NormalForce,
    /// `w_N` in the gap `g_N = w_Nᵀq + gap` of a unilateral contact; empty for others, which ignore it.
    pub normal: Vec<f64>,
    /// Gap at `q = 0` in m.
    pub gap: f64,
    /// `e_N` and `e_T`, both in [0, 1].
    pub restitution: (f64, f64),
}

impl Contact {
    /// Contact with prescribed normal force, at rest, without restitution.
    pub fn with_force(law: impl Into<Law>, direction: DMatrix<f64>, normal_force: f64) -> Self {
        let law = law.into();
        Self {
            velocity: vec![0.0; law.dimension()],
            law,
            direction,
            normal_force: NormalForce::Prescribed(normal_force),
            normal: Vec::new(),
            gap: 0.0,
            restitution: (0.0, 0.0),
        }
    }

    /// Unilateral contact with the gap `normalᵀq + gap`, at rest, without restitution.
    pub fn unilateral(
        law: impl Into<Law>,
        direction: DMatrix<f64>,
        normal: Vec<f64>,
        gap: f64,
    ) -> Self {
        let normal_force = NormalForce::Unilateral;
        Self { normal_force, normal, gap, ..Self::with_force(law, direction, 0.0) }
    }
}

/// `M q̈ + B q̇ + K q = f + W_N λ_N + W λ`.
///
/// ```
/// use asperity::law::FrictionLaw;
/// use asperity::nalgebra::DMatrix;
/// use asperity::system::{Contact, LinearSystem, System};
///
/// // A block on a floor: x along it, z above it.
/// let column = |x: f64, z: f64| DMatrix::from_column_slice(2, 1, &[x, z]);
/// let law = FrictionLaw::<1>::isotropic(0.3)?;
/// let contact = Contact::unilateral(law, column(1.0, 0.0), vec![0.0, 1.0], 0.0);
/// let (mass, zero) = (DMatrix::identity(2, 2) * 2.0, DMatrix::zeros(2, 2));
/// let block = LinearSystem::new(mass, zero.clone(), zero, vec![0.0, -19.6], vec![contact])?;
/// assert_eq!((block.dof(), block.contacts().len()), (2, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LinearSystem {
    blocks: Blocks,
    mass: DMatrix<f64>,
    /// `−K` and `−B` of few velocities, column by column.
    stiffness: Vec<f64>,
    damping: Vec<f64>,
    /// The entries where either is not zero.
    internal: Vec<Internal>,
    force: Vec<f64>,
    contacts: Vec<LinearContact>,
    laws: Vec<ContactLaw>,
    /// The rows of `J` in the constraints `J q + c = 0`, one after another, and `c`.
    constraint_rows: Vec<f64>,
    constraint: Vec<f64>,
    longest_step: LongestStep,
}

/// The step of the last question and the longest one, if it is too long: eigenvalues take longer than a run of an ensemble.
#[derive(Debug, Default)]
struct LongestStep(Mutex<Option<(f64, Option<f64>)>>);

impl Clone for LongestStep {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl PartialEq for LongestStep {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// Up to so many velocities all forces are computed in registers: numbers stored one by one cannot be loaded in pairs.
const FEW: usize = 3;

/// An entry of `−K` and `−B`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Internal {
    row: usize,
    column: usize,
    stiffness: f64,
    damping: f64,
}

#[derive(Debug, Clone, PartialEq)]
struct LinearContact {
    /// `W_Nᵀ`, if it is unilateral, and `Wᵀ`, row by row.
    rows: Vec<f64>,
    /// χ_N and χ.
    velocity: Vec<f64>,
    /// Gap at `q = 0`.
    gap: f64,
}

impl LinearSystem {
    /// A linear system; `mass` symmetric positive definite, all matrices `n × n`.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a matrix or vector has another shape or is not finite, if `mass` is not symmetric positive
    /// definite, or if a number of a contact is out of its range.
    pub fn new(
        mass: DMatrix<f64>,
        stiffness: DMatrix<f64>,
        damping: DMatrix<f64>,
        force: Vec<f64>,
        contacts: Vec<Contact>,
    ) -> Result<Self, ArgumentError> {
        let n = mass.nrows();
        check_matrix("mass", &mass, n, n)?;
        check_matrix("stiffness", &stiffness, n, n)?;
        check_matrix("damping", &damping, n, n)?;
        entries("force", &force, n)?;
        if (&mass - mass.transpose()).amax() > 1e-12 * mass.amax()
            || mass.clone().cholesky().is_none()
        {
            return refuse("mass", "must be symmetric positive definite");
        }
        let (stiffness, damping) = (-stiffness, -damping);
        let entry = |(row, column)| Internal {
            row,
            column,
            stiffness: stiffness[(row, column)],
            damping: damping[(row, column)],
        };
        let internal = (0..n)
            .flat_map(|row| (0..n).map(move |column| (row, column)))
            .map(entry)
            .filter(|entry| entry.stiffness != 0.0 || entry.damping != 0.0)
            .collect();
        let checked = contacts.iter().map(|c| linear_contact(c, n)).collect::<Result<_, _>>()?;
        let laws = contacts.into_iter().map(contact_law).collect::<Result<_, _>>()?;
        let few = |matrix: DMatrix<f64>| if n > FEW { Vec::new() } else { matrix.data.into() };
        Ok(Self {
            blocks: Blocks::one(n),
            mass,
            stiffness: few(stiffness),
            damping: few(damping),
            internal,
            force,
            contacts: checked,
            laws,
            constraint_rows: Vec::new(),
            constraint: Vec::new(),
            longest_step: LongestStep::default(),
        })
    }

    /// The same system with the constraints `J q + c = 0`, which may repeat each other.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] unless `rows`, J, have a column per coordinate and `constraint`, c, an entry per row, all finite.
    pub fn with_constraints(
        self,
        rows: &DMatrix<f64>,
        constraint: Vec<f64>,
    ) -> Result<Self, ArgumentError> {
        check_matrix("constraint_rows", rows, rows.nrows(), self.force.len())?;
        entries("constraint", &constraint, rows.nrows())?;
        let constraint_rows = rows.transpose().data.into();
        Ok(Self { constraint_rows, constraint, longest_step: LongestStep::default(), ..self })
    }
}

/// `M`, `K` and `B` of a linear system, and the directions that its contacts may hold and its constraints do as columns.
pub(crate) struct Matrices<'a> {
    pub(crate) mass: &'a DMatrix<f64>,
    pub(crate) stiffness: DMatrix<f64>,
    pub(crate) damping: DMatrix<f64>,
    pub(crate) held: DMatrix<f64>,
}

/// A linear system of two velocities and one contact in their plane with a given normal force: `M u̇ + B u + K q = f + W λ`
/// and `γ = Wᵀu + χ`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlanarMotion {
    /// `M`, `−K`, `−B`, `f`.
    pub(crate) mass: Matrix2<f64>,
    pub(crate) stiffness: Matrix2<f64>,
    pub(crate) damping: Matrix2<f64>,
    pub(crate) force: Vector2<f64>,
    /// `W`, χ.
    pub(crate) direction: Matrix2<f64>,
    pub(crate) velocity: Vector2<f64>,
}

impl LinearSystem {
    /// The matrices, unless K and B are zero.
    pub(crate) fn internal_forces(&self) -> Option<Matrices<'_>> {
        if self.internal.is_empty() {
            return None;
        }
        let n = self.force.len();
        let (mut stiffness, mut damping) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        for entry in &self.internal {
            stiffness[(entry.row, entry.column)] = -entry.stiffness;
            damping[(entry.row, entry.column)] = -entry.damping;
        }
        let contacts = self.contacts.iter().zip(&self.laws);
        let held: Vec<f64> = contacts
            .filter(|(_, law)| law.normal_force() != NormalForce::Prescribed(0.0))
            .flat_map(|(contact, _)| &contact.rows)
            .chain(&self.constraint_rows)
            .copied()
            .collect();
        let held = DMatrix::from_vec(n, held.len() / n, held);
        Some(Matrices { mass: &self.mass, stiffness, damping, held })
    }

    /// The system of some of its velocities alone, ascending, with the contacts that touch no others.
    fn of_velocities(&self, velocities: &[usize], contacts: &[usize]) -> Self {
        let n = velocities.len();
        let place = |k: usize| velocities.binary_search(&k).ok();
        let internal: Vec<Internal> = (self.internal.iter())
            .filter_map(|entry| {
                let (row, column) = (place(entry.row)?, place(entry.column)?);
                Some(Internal { row, column, ..*entry })
            })
            .collect();
        let few = |value: fn(&Internal) -> f64| {
            let mut matrix = vec![0.0; if n > FEW { 0 } else { n * n }];
            if n <= FEW {
                internal.iter().for_each(|e| matrix[n * e.column + e.row] = value(e));
            }
            matrix
        };
        let contact = |&i: &usize| {
            let LinearContact { rows, velocity, gap } = &self.contacts[i];
            let rows = rows.chunks_exact(self.force.len());
            let rows = rows.flat_map(|row| velocities.iter().map(|&k| row[k])).collect();
            LinearContact { rows, velocity: velocity.clone(), gap: *gap }
        };
        Self {
            blocks: Blocks::one(n),
            mass: DMatrix::from_fn(n, n, |i, j| self.mass[(velocities[i], velocities[j])]),
            stiffness: few(|entry| entry.stiffness),
            damping: few(|entry| entry.damping),
            internal,
            force: velocities.iter().map(|&k| self.force[k]).collect(),
            contacts: contacts.iter().map(contact).collect(),
            laws: contacts.iter().map(|&i| self.laws[i].clone()).collect(),
            constraint_rows: Vec::new(),
            constraint: Vec::new(),
            longest_step: LongestStep::default(),
        }
    }

    /// The longest step if one of a length is too long, as it is found unless it is known.
    pub(crate) fn longest_step(&self, dt: f64, find: impl FnOnce() -> Option<f64>) -> Option<f64> {
        let mut known = self.longest_step.0.lock().unwrap_or_else(PoisonError::into_inner);
        match *known {
            Some((asked, longest)) if asked == dt => longest,
            _ => known.insert((dt, find())).1,
        }
    }

    /// The system by its matrices, if it is such a one.
    pub(crate) fn planar_motion(&self) -> Option<PlanarMotion> {
        let ([contact], [law]) = (&self.contacts[..], &self.laws[..]) else { return None };
        let fits = self.force.len() == 2 && law.rows() == 2 && self.constraint.is_empty();
        let fits = fits && !law.normal_force().is_unilateral();
        fits.then(|| PlanarMotion {
            mass: Matrix2::from_column_slice(self.mass.as_slice()),
            stiffness: Matrix2::from_column_slice(&self.stiffness),
            damping: Matrix2::from_column_slice(&self.damping),
            force: Vector2::from_column_slice(&self.force),
            direction: Matrix2::from_column_slice(&contact.rows),
            velocity: Vector2::from_column_slice(&contact.velocity),
        })
    }
}

fn linear_contact(contact: &Contact, n: usize) -> Result<LinearContact, ArgumentError> {
    let p = contact.law.dimension();
    check_matrix("direction", &contact.direction, n, p)?;
    entries("velocity", &contact.velocity, p)?;
    let (mut rows, mut velocity, mut gap) = (Vec::new(), Vec::new(), 0.0);
    if contact.normal_force.is_unilateral() {
        entries("normal", &contact.normal, n)?;
        finite("gap", &[contact.gap])?;
        rows.extend(&contact.normal);
        velocity.push(0.0);
        gap = contact.gap;
    }
    // Column-major W is row-major Wᵀ.
    rows.extend(contact.direction.as_slice());
    velocity.extend(&contact.velocity);
    Ok(LinearContact { rows, velocity, gap })
}

fn contact_law(contact: Contact) -> Result<ContactLaw, ArgumentError> {
    let (normal, tangential) = contact.restitution;
    ContactLaw::new(contact.law, contact.normal_force)?.with_restitution(normal, tangential)
}

fn check_matrix(
    argument: &'static str,
    matrix: &DMatrix<f64>,
    rows: usize,
    columns: usize,
) -> Result<(), ArgumentError> {
    if matrix.shape() != (rows, columns) {
        let (r, c) = matrix.shape();
        let message = format!("must have shape ({rows}, {columns}), has ({r}, {c})");
        return refuse(argument, message);
    }
    finite(argument, matrix.as_slice())
}

impl System for LinearSystem {
    #[inline]
    fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    #[inline]
    fn contacts(&self) -> &[ContactLaw] {
        &self.laws
    }

    #[inline]
    fn constancy(&self) -> Constancy {
        Constancy { mass: true, contacts: true, autonomous: true }
    }

    fn constraints(&self) -> usize {
        self.constraint.len()
    }

    fn constraint(&self, q: &[f64], off: &mut [f64]) -> Result<(), SystemError> {
        let rows = self.constraint_rows.chunks_exact(q.len());
        for ((off, c), row) in off.iter_mut().zip(&self.constraint).zip(rows) {
            *off = c + dot(row, q);
        }
        Ok(())
    }

    fn constraint_rows(&self, _q: &[f64], rows: &mut [f64]) -> Result<(), SystemError> {
        rows.copy_from_slice(&self.constraint_rows);
        Ok(())
    }

    fn as_linear(&self) -> Option<&LinearSystem> {
        Some(self)
    }

    /// Velocities that no entry of the matrices and no row of a contact connects are of different parts.
    fn parts(&self) -> Vec<SystemPart> {
        let n = self.force.len();
        let mut connected = Components::default();
        connected.separate(n);
        for (k, _) in self.mass.iter().enumerate().filter(|(_, entry)| **entry != 0.0) {
            connected.join(k / n, k % n);
        }
        self.internal.iter().for_each(|entry| connected.join(entry.row, entry.column));
        let mut touched = Vec::new();
        for contact in &self.contacts {
            let entries = contact.rows.iter().enumerate().filter(|(_, entry)| **entry != 0.0);
            let all: Vec<usize> = entries.map(|(k, _)| k % n).collect();
            // A direction that moves nothing is refused by its number in the whole.
            if contact.rows.chunks_exact(n).any(|row| row.iter().all(|entry| *entry == 0.0)) {
                return Vec::new();
            }
            all.iter().for_each(|&k| connected.join(all[0], k));
            touched.push(all[0]);
        }
        let part = |(velocities, contacts): (Vec<usize>, Vec<usize>)| SystemPart {
            system: Box::new(self.of_velocities(&velocities, &contacts)),
            coordinates: velocities.clone(),
            velocities,
            contacts,
        };
        connected.split(touched.into_iter()).into_iter().map(part).collect()
    }

    fn mass(&self, _q: &[f64], _block: usize, mass: &mut [f64]) -> Result<(), SystemError> {
        mass.copy_from_slice(self.mass.as_slice());
        Ok(())
    }

    #[inline(always)]
    fn forces(
        &self,
        at: &Configuration<'_>,
        u: &[f64],
        forces: &mut [f64],
    ) -> Result<(), SystemError> {
        unrolled!(n = forces.len() => {
            let (q, u) = (&at.q[..n], &u[..n]);
            if n > FEW {
                forces.copy_from_slice(&self.force[..n]);
                for entry in &self.internal {
                    let Internal { row, column, stiffness, damping } = *entry;
                    forces[row] += stiffness * q[column] + damping * u[column];
                }
            } else {
                let (k, b) = (&self.stiffness[..n * n], &self.damping[..n * n]);
                let mut sums = [0.0; FEW];
                sums[..n].copy_from_slice(&self.force[..n]);
                for j in 0..n {
                    for i in 0..n {
                        sums[i] += k[n * j + i] * q[j] + b[n * j + i] * u[j];
                    }
                }
                forces.copy_from_slice(&sums[..n]);
            }
        });
        Ok(())
    }

    fn gap(&self, at: &Configuration<'_>, contact: usize) -> Result<f64, SystemError> {
        let LinearContact { rows, gap, .. } = &self.contacts[contact];
        Ok(gap + dot(rows, at.q))
    }

    /// `|w_N|ᵀ|q̈|`.
    fn gap_acceleration(
        &self,
        _at: &Configuration<'_>,
        contact: usize,
        bounds: &MotionBounds,
    ) -> Option<f64> {
        let terms = self.contacts[contact].rows.iter().zip(&bounds.accelerations);
        Some(terms.map(|(w, a)| w.abs() * a).sum())
    }

    fn rows(
        &self,
        at: &Configuration<'_>,
        contact: usize,
        rows: &mut [f64],
        velocity: &mut [f64],
    ) -> Result<f64, SystemError> {
        rows.copy_from_slice(&self.contacts[contact].rows);
        velocity.copy_from_slice(&self.contacts[contact].velocity);
        let unilateral = self.laws[contact].normal_force().is_unilateral();
        if unilateral { self.gap(at, contact) } else { Ok(0.0) }
    }
}
