//! `A + B G` in contact space and in body space against dense factorisations.

use nalgebra::{DMatrix, DVector};

use super::NewtonMatrix;
use crate::contact::{BlockMatrix, ContactProblem, Csr, Delassus, Factored, NormalForce};
use crate::law::{ContactMatrix, FrictionLaw, Law};
use crate::linear::Execution;
use crate::random::random;
use crate::threads::Threads;

/// By one thread, to the end.
const ALONE: Execution<'_> = Execution { threads: Threads::NONE, given_up: &|| false };

fn law(p: usize) -> Law {
    match p {
        1 => FrictionLaw::<1>::isotropic(0.3).unwrap().into(),
        2 => FrictionLaw::<2>::isotropic(0.3).unwrap().into(),
        _ => FrictionLaw::<3>::isotropic(0.3).unwrap().into(),
    }
}

/// The same problem in all forms: contacts of all dimensions, with and without normal rows, between bodies of three
/// velocities.
fn problems(contacts: usize, bodies: usize, seed: &mut u64) -> Vec<ContactProblem> {
    let laws: Vec<(Law, NormalForce)> = (0..contacts)
        .map(|i| {
            let given = i % 5 == 3;
            let normal = if given { NormalForce::Prescribed(1.0) } else { NormalForce::Unilateral };
            (law(1 + i % 3), normal)
        })
        .collect();
    let sizes: Vec<usize> = laws
        .iter()
        .map(|(law, normal)| law.dimension() + usize::from(normal.prescribed().is_none()))
        .collect();
    let (rows, dof) = (sizes.iter().sum(), 3 * bodies);
    let mass = DMatrix::from_fn(dof, dof, |i, j| if i == j { 1.5 + random(seed) } else { 0.0 });
    let mut directions = DMatrix::zeros(rows, dof);
    let mut row = 0;
    for (i, size) in sizes.iter().enumerate() {
        for body in [i % bodies, (i + 1) % bodies] {
            for a in 0..*size {
                (0..3).for_each(|k| directions[(row + a, 3 * body + k)] = random(seed));
            }
        }
        row += size;
    }
    let dense = &directions * mass.clone().try_inverse().unwrap() * directions.transpose();
    let blocks =
        BlockMatrix::from_csr(&Csr::from_dense("delassus", &dense).unwrap(), &sizes).unwrap();
    let factored = Factored::new(
        Csr::from_dense("mass", &mass).unwrap(),
        Csr::from_dense("directions", &directions).unwrap(),
        &sizes,
    );
    let full = BlockMatrix::from_dense(&dense, &sizes);
    let forms: [Delassus; 3] = [full.unwrap().into(), blocks.into(), factored.unwrap().into()];
    let problem = |g: Delassus| ContactProblem::new(g, vec![0.0; rows], laws.clone()).unwrap();
    forms.map(problem).into()
}

#[test]
fn solves_as_a_dense_factorisation_does() {
    let mut seed = 5;
    // Few and many contacts per body: elimination is cheaper among contacts, or among bodies.
    for (contacts, bodies) in [(1, 1), (4, 6), (9, 4), (30, 3), (40, 40)] {
        let problems = problems(contacts, bodies, &mut seed);
        let n = problems[0].rows();
        let mut matrices = vec![NewtonMatrix::default(); problems.len()];
        for _ in 0..2 {
            // Unused rows and columns are those of the unit matrix.
            let mut near_unit = |size: f64| -> Vec<ContactMatrix> {
                let rows = problems[0].contacts().iter().map(|rows| rows.len());
                let block = |len: usize| {
                    let noise = ContactMatrix::from_fn(|i, j| match i.max(j) < len {
                        true => 0.2 * random(&mut seed),
                        false => 0.0,
                    });
                    (ContactMatrix::identity() + noise) * size
                };
                rows.map(block).collect()
            };
            let (a, b) = (near_unit(1.0), near_unit(0.7));
            let wide = |blocks: &[ContactMatrix]| {
                let mut out = DMatrix::zeros(n, n);
                for (rows, block) in problems[0].contacts().iter().zip(blocks) {
                    for (i, row) in rows.rows().enumerate() {
                        for (j, column) in rows.rows().enumerate() {
                            out[(row, column)] = block[(i, j)];
                        }
                    }
                }
                out
            };
            let dense = wide(&a) + wide(&b) * problems[0].delassus().to_dense();
            let right = DVector::from_fn(n, |_, _| random(&mut seed));
            let expected = dense.clone().lu().solve(&right).unwrap();
            for (problem, matrix) in problems.iter().zip(&mut matrices) {
                matrix.prepare(problem);
                assert!(matrix.factor(problem, &a, &b, ALONE));
                let mut found = right.clone();
                matrix.solve(problem, found.as_mut_slice());
                let error = (&found - &expected).amax() / expected.amax();
                assert!(error < 1e-9, "{contacts} contacts, {bodies} bodies: {error:e}");
            }
        }
    }
}
