//! How slipping contacts share normal forces that are statically indeterminate.
//!
//! Normal rows that depend on each other, `W_N z = 0` for the columns `z` of a matrix `Z`, leave `Zᵀλ_N` open, such as the load
//! of the fourth foot of a table. Friction makes it matter: feet that slip in different directions accelerate a body by an
//! amount that depends on their shares. The shares are those of contacts of one and the same normal compliance, however
//! small it is: `λ_N = W_Nᵀx` for some `x`, hence `Zᵀλ_N = 0`.
//!
//! With `P` the orthogonal projection onto the columns of `Z` and any `ρ > 0`, `ρPλ_N` is added to the normal
//! accelerations. While the rows go on to depend on each other, `Zᵀγ̈_N = 0` whatever the forces are, so that
//! `γ̈_N + ρPλ_N = 0` asks for both, `γ̈_N = 0` and `Zᵀλ_N = 0`. Where surfaces part, as the floor and a table that is
//! lowered do, no forces close all contacts, `Zᵀγ̈_N` says so, and nothing is shared.

use nalgebra::{DMatrix, DVector};

use crate::integrator::event::dynamics::contact_variables::ROWS;
use crate::integrator::event::resolution::PARTS;
use crate::linear::{BlockLu, LeastNorm};
use crate::solver::SINGULAR;

/// A normal acceleration, and the size of what it is the sum of.
pub(crate) struct Rate {
    pub(crate) value: f64,
    pub(crate) scale: f64,
}

/// The matrix `ρP` of the contacts that share normal forces.
#[derive(Debug, Default)]
pub(crate) struct Sharing {
    mobility: BlockLu,
    /// The contacts that may share.
    contacts: Vec<usize>,
    /// The group of each contact that shares, and its place there.
    places: Vec<Option<Place>>,
    groups: Vec<DMatrix<f64>>,
    /// Whether normal rows depend on each other, whether or not the contacts share.
    pub(crate) dependent: bool,
}

/// `ρP` of normal rows with the factored mobility `N = W_NᵀM⁻¹W_N`, ρ the mean of its diagonal; `None` of independent rows.
pub(crate) fn null_projection(
    mobility: &DMatrix<f64>,
    factors: &LeastNorm,
) -> Option<DMatrix<f64>> {
    let (size, range) = (mobility.nrows(), factors.range());
    if range.ncols() == size {
        return None;
    }
    let projection = DMatrix::identity(size, size) - range * range.transpose();
    Some(projection * mean_mobility(mobility))
}

/// The mean `ρ` of the diagonal of `N`.
pub(crate) fn mean_mobility(mobility: &DMatrix<f64>) -> f64 {
    mobility.trace() / mobility.nrows() as f64
}

#[derive(Debug, Clone, Copy)]
struct Place {
    group: usize,
    row: usize,
}

impl Sharing {
    /// Whether no contact shares.
    pub(crate) fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    pub(crate) fn clear(&mut self) {
        self.dependent = false;
        self.groups.clear();
        self.places.clear();
    }

    /// Whether the contact shares its normal force with others.
    pub(crate) fn includes(&self, contact: usize) -> bool {
        self.entry(ROWS * contact, ROWS * contact) > 0.0
    }

    /// The entry of `ρP` for two rows of the system.
    pub(crate) fn entry(&self, row: usize, other: usize) -> f64 {
        match (self.place(row), self.place(other)) {
            (Some(a), Some(b)) if a.group == b.group => self.groups[a.group][(a.row, b.row)],
            _ => 0.0,
        }
    }

    /// The place of a normal row of a contact that shares.
    fn place(&self, row: usize) -> Option<Place> {
        let normal = row.is_multiple_of(ROWS);
        self.places.get(row / ROWS).copied().flatten().filter(|_| normal)
    }

    /// A row of `ρP` times forces along other rows.
    pub(crate) fn product(&self, row: usize, others: &[usize], forces: &[f64]) -> f64 {
        let entries = others.iter().map(|&other| self.entry(row, other));
        entries.zip(forces).map(|(entry, force)| entry * force).sum()
    }

    /// Finds which of some contacts share normal forces. `mobility` is `w_NᵀM⁻¹w_N` of two of them, `rate` a normal
    /// acceleration with any forces, and `all` the number of all contacts of the system.
    pub(crate) fn find(
        &mut self,
        among: impl Iterator<Item = usize>,
        all: usize,
        mobility: impl Fn(usize, usize) -> f64,
        rate: impl Fn(usize) -> Rate,
    ) {
        self.clear();
        let Self { mobility: matrix, contacts, places, groups, dependent } = self;
        contacts.clear();
        contacts.extend(among);
        let count = contacts.len();
        for (k, value) in matrix.begin(count).iter_mut().enumerate() {
            *value = mobility(contacts[k / count], contacts[k % count]);
        }
        places.resize(all, None);
        matrix.factor_parts(SINGULAR.sqrt(), |entries, members| {
            let size = members.len();
            let entry = |i: usize, j: usize| entries[members[i] * count + members[j]];
            let part = DMatrix::from_fn(size, size, entry);
            let Some(factors) = LeastNorm::new(part.clone(), SINGULAR) else { return };
            let Some(projection) = null_projection(&part, &factors) else { return };
            *dependent = true;
            let rates = members.iter().map(|&member| rate(contacts[member]));
            let (values, scales): (Vec<f64>, Vec<f64>) = rates.map(|r| (r.value, r.scale)).unzip();
            let parting = (&projection * DVector::from_vec(values)).amax();
            if parting > PARTS * mean_mobility(&part) * scales.into_iter().fold(0.0, f64::max) {
                return;
            }
            for (row, &member) in members.iter().enumerate() {
                places[contacts[member]] = Some(Place { group: groups.len(), row });
            }
            groups.push(projection);
        });
    }
}
