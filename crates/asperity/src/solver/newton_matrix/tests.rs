//! `A + B G` in contact space and in body space against dense factorisations.

use nalgebra::{DMatrix, DVector};

use super::NewtonMatrix;
use crate::contact::{BlockMatrix, ContactProblem, Csr, Delassus, Factored, NormalForce};
use crate::law::{ContactMatrix, FrictionLaw, Law};
use crate::random::random;

/// By one thread, to the end.
const ALONE: &dyn Fn() -> bool = &|| false;

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
    let blocks = BlockMatrix::from_csr(&Csr::from_dense(&dense).unwrap(), &sizes).unwrap();
    let factored = Factored::new(
        Csr::from_dense(&mass).unwrap(),
        Csr::from_dense(&directions).unwrap(),
        &sizes,
    );
    let full = BlockMatrix::from_dense(&dense, &sizes);
    let forms: [Delassus; 3] = [full.unwrap().into(), blocks.into(), factored.unwrap().into()];
    let problem = |g: Delassus| ContactProblem::new(g, vec![0.0; rows], laws.clone()).unwrap();
    forms.map(problem).into()
}

/// A matrix of all rows with blocks of contacts on its diagonal.
fn wide(problem: &ContactProblem, blocks: &[ContactMatrix]) -> DMatrix<f64> {
    let mut out = DMatrix::zeros(problem.rows(), problem.rows());
    for (rows, block) in problem.contacts().iter().zip(blocks) {
        for (i, row) in rows.rows().enumerate() {
            for (j, column) in rows.rows().enumerate() {
                out[(row, column)] = block[(i, j)];
            }
        }
    }
    out
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
            let dense =
                wide(&problems[0], &a) + wide(&problems[0], &b) * problems[0].delassus().to_dense();
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

/// Where `A⁻¹B` is symmetric it is LDLᵀ among the bodies, if it is definite; where it is hardly unsymmetric, it is not.
#[test]
fn symmetric_matrices_are_solved_whether_they_are_definite_or_not() {
    let mut seed = 11;
    let problems = problems(60, 20, &mut seed);
    let (n, problem) = (problems[0].rows(), &problems[2]);
    let mut matrix = NewtonMatrix::default();
    matrix.prepare(problem);
    assert!(matrix.in_body_space);
    for (sign, skew) in [(1.0, 0.0), (-1.0, 0.0), (1.0, 1e-6), (1.0, 0.5)] {
        let mut b = Vec::new();
        for (i, rows) in problem.contacts().iter().enumerate() {
            let noise = ContactMatrix::from_fn(|_, _| 0.1 * random(&mut seed));
            let mut block = ContactMatrix::identity() + noise + noise.transpose();
            block[(0, 1)] += skew;
            // Every third block is negative, which leaves the matrix regular, but not definite.
            block *= if i % 3 == 0 { sign } else { 1.0 };
            (rows.len()..4).for_each(|r| (0..4).for_each(|c| block[(r, c)] = 0.0));
            (rows.len()..4).for_each(|c| (0..4).for_each(|r| block[(r, c)] = 0.0));
            b.push(block);
        }
        let a = vec![ContactMatrix::identity(); problem.contacts().len()];
        let g = problem.delassus().to_dense();
        let dense = wide(problem, &a) + wide(problem, &b) * g;
        let right = DVector::from_fn(n, |_, _| random(&mut seed));
        let expected = dense.lu().solve(&right).unwrap();
        assert!(matrix.factor(problem, &a, &b, ALONE));
        let mut found = right.clone();
        matrix.solve(problem, found.as_mut_slice());
        let error = (&found - &expected).amax() / expected.amax();
        assert!(error < 1e-9, "{sign} {skew}: {error:e}");
    }
}
