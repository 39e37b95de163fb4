//! Which velocities belong to one body.

use nalgebra::{SMatrix, SVector};

use crate::contact::{Components, ContactProblem, Factored, Members};

/// Most velocities of a body.
pub(super) const VELOCITIES: usize = 6;

/// How bodies are told apart where the velocities of several have the same contacts, or some of those of another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Order {
    /// Six by six from the first one, those without contacts among them.
    FirstToLast,
    /// Six by six from the last one, those without contacts apart: they, or what else fits the contacts of a body, may stand
    /// before it.
    LastToFirst,
}

/// The bodies of a problem.
pub(super) struct Bodies {
    /// The body of every velocity, and its place there.
    pub(super) of_velocity: Vec<(u32, usize)>,
    /// `L` with `LLᵀ = M` of every body, and ones for velocities that it does not have.
    factors: Vec<SMatrix<f64, VELOCITIES, VELOCITIES>>,
}

impl Bodies {
    /// Nothing if `M` couples more velocities than a body has, or is not positive definite.
    pub(super) fn of(problem: &ContactProblem, factored: &Factored, order: Order) -> Option<Self> {
        let mass = factored.mass();
        let mut of_velocity = vec![(0, 0); mass.rows()];
        let mut factors = Vec::new();
        for mut own in groups(problem, factored, order) {
            own.sort_unstable();
            if own.len() > VELOCITIES {
                return None;
            }
            let mut part = SMatrix::<f64, VELOCITIES, VELOCITIES>::identity();
            for (a, &i) in own.iter().enumerate() {
                of_velocity[i] = (factors.len() as u32, a);
                let (columns, values) = mass.row(i);
                for (j, value) in columns.iter().zip(values) {
                    part[(a, own.iter().position(|other| other == j)?)] = *value;
                }
            }
            factors.push(part.cholesky()?.l());
        }
        Some(Self { of_velocity, factors })
    }

    /// Their number, which is also that of the ground.
    pub(super) fn count(&self) -> usize {
        self.factors.len()
    }

    /// `L⁻¹w` of a row `w` of `Wᵀ` for a body; zero for the ground.
    pub(super) fn divided(&self, body: u32, row: [f64; VELOCITIES]) -> [f64; VELOCITIES] {
        let factor = self.factors.get(body as usize);
        let solved = factor.and_then(|l| l.solve_lower_triangular(&SVector::from(row)));
        solved.map_or([0.0; VELOCITIES], Into::into)
    }
}

/// The connected parts of `M`, put together where they follow each other and the contacts of the one are all among those of
/// the other: `M` does not couple the velocities of a sphere, and not each of its contacts acts on all of them.
fn groups(problem: &ContactProblem, factored: &Factored, order: Order) -> Vec<Vec<usize>> {
    let mass = factored.mass();
    let mut contacts_at = vec![Vec::new(); mass.rows()];
    for (i, contact) in problem.contacts().iter().enumerate() {
        for &velocity in contact.rows().flat_map(|row| factored.directions().row(row).0) {
            if contacts_at[velocity].last() != Some(&i) {
                contacts_at[velocity].push(i);
            }
        }
    }
    let mut connected = Components::default();
    connected.separate(mass.rows());
    for i in 0..mass.rows() {
        mass.row(i).0.iter().for_each(|&j| connected.join(i, j));
    }
    let mut parts = Members::default();
    parts.update(&mut connected);
    let mut groups = Vec::new();
    // Parts that may belong together, and the contacts of all of them.
    let mut run: Vec<&[usize]> = Vec::new();
    let mut known: Vec<usize> = Vec::new();
    for part in 0..parts.count() {
        let own = parts.of(part);
        let contacts = own.iter().flat_map(|&velocity| contacts_at[velocity].iter().copied());
        let mut contacts: Vec<usize> = contacts.collect();
        contacts.sort_unstable();
        contacts.dedup();
        if order == Order::LastToFirst && contacts.is_empty() {
            groups.push(own.to_vec());
            continue;
        }
        if !are_among(&contacts, &known) && !are_among(&known, &contacts) {
            divide(&mut run, order, &mut groups);
            known.clear();
        }
        run.push(own);
        if contacts.len() > known.len() {
            known = contacts;
        }
    }
    divide(&mut run, order, &mut groups);
    groups
}

/// Makes bodies of the parts of a run.
fn divide(run: &mut Vec<&[usize]>, order: Order, groups: &mut Vec<Vec<usize>>) {
    if order == Order::LastToFirst {
        run.reverse();
    }
    let mut body = Vec::new();
    for part in run.drain(..) {
        if !body.is_empty() && body.len() + part.len() > VELOCITIES {
            groups.push(std::mem::take(&mut body));
        }
        body.extend_from_slice(part);
    }
    if !body.is_empty() {
        groups.push(body);
    }
}

/// Whether all contacts of a list are in another one, both ascending.
fn are_among(some: &[usize], all: &[usize]) -> bool {
    some.iter().all(|contact| all.binary_search(contact).is_ok())
}
