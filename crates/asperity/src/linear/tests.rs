//! The factorisation against dense ones.

use std::cell::Cell;

use nalgebra::{DMatrix, DVector};

use super::{Kind, Numeric, Symbolic};
use crate::contact::{BlockMatrix, Delassus};
use crate::random::random;

/// To the end.
const ALONE: &dyn Fn() -> bool = &|| false;

/// A matrix of random blocks whose pattern is a chain with random chords.
fn example(nodes: usize, chords: usize, seed: &mut u64) -> BlockMatrix {
    let mut neighbours: Vec<Vec<usize>> = (0..nodes).map(|i| vec![i]).collect();
    let pick = |seed: &mut u64| ((random(seed) + 1.0) * 0.5 * nodes as f64) as usize % nodes;
    let mut join = |i: usize, j: usize| {
        neighbours[i].push(j);
        neighbours[j].push(i);
    };
    (1..nodes).filter(|i| i % 7 != 0).for_each(|i| join(i - 1, i));
    for _ in 0..chords {
        let (i, j) = (pick(seed), pick(seed));
        join(i, j);
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    let sizes: Vec<usize> = (0..nodes).map(|i| 1 + i % 4).collect();
    let mut matrix = BlockMatrix::with_pattern(&sizes, &neighbours);
    for value in matrix.values_mut() {
        *value = random(seed);
    }
    for (i, &size) in sizes.iter().enumerate() {
        let k = matrix.neighbours(i).iter().position(|&j| j == i).unwrap();
        let (_, block) = matrix.block_mut(i, k);
        (0..size).for_each(|a| block[a * size + a] += 4.0);
    }
    matrix
}

/// The symmetric part of a matrix, with diagonals that make it definite.
fn definite(mut matrix: BlockMatrix) -> BlockMatrix {
    let a = dense(&matrix);
    let symmetric = 0.5 * (&a + a.transpose());
    let offsets = matrix.offsets().to_vec();
    for i in 0..matrix.contacts() {
        for k in 0..matrix.neighbours(i).len() {
            let columns = matrix.size(matrix.neighbours(i)[k]);
            let (j, block) = matrix.block_mut(i, k);
            for (at, value) in block.iter_mut().enumerate() {
                let (row, column) = (offsets[i] + at / columns, offsets[j] + at % columns);
                *value = symmetric[(row, column)];
                if row == column {
                    *value += symmetric.row(row).abs().sum();
                }
            }
        }
    }
    matrix
}

fn dense(matrix: &BlockMatrix) -> DMatrix<f64> {
    Delassus::from(matrix.clone()).to_dense()
}

#[test]
fn solves_as_a_dense_factorisation_does() {
    let mut seed = 1;
    let (mut symbolic, mut numeric);
    for (nodes, chords) in [(1, 0), (2, 1), (5, 3), (40, 10), (120, 60), (90, 900), (300, 150)] {
        let mut matrix = example(nodes, chords, &mut seed);
        symbolic = Symbolic::new(&matrix);
        numeric = Numeric::default();
        numeric.reserve(&symbolic);
        for round in 0..2 {
            matrix.values_mut().iter_mut().for_each(|value| *value *= 1.0 + 0.1 * round as f64);
            let b = DVector::from_fn(matrix.rows(), |_, _| random(&mut seed));
            let mut x = b.clone();
            assert!(numeric.factor(&symbolic, (&matrix, Kind::General), ALONE));
            numeric.solve(&symbolic, x.as_mut_slice());
            let error = (dense(&matrix) * &x - &b).amax() / x.amax();
            assert!(error < 1e-11, "{nodes} nodes: {error}");
        }
    }
}

/// Also where what was factored before has left other numbers above the diagonal.
#[test]
fn solves_definite_matrices_as_a_dense_factorisation_does() {
    let mut seed = 2;
    let mut numeric = Numeric::default();
    for (nodes, chords) in [(1, 0), (2, 1), (5, 3), (40, 10), (120, 60), (90, 900), (300, 9000)] {
        let general = example(nodes, chords, &mut seed);
        let matrix = definite(general.clone());
        let symbolic = Symbolic::new(&matrix);
        numeric.reserve(&symbolic);
        let b = DVector::from_fn(matrix.rows(), |_, _| random(&mut seed));
        for (matrix, kind) in [
            (&matrix, Kind::Definite),
            (&general, Kind::General),
            (&matrix, Kind::Definite),
            (&matrix, Kind::General),
        ] {
            assert!(numeric.factor(&symbolic, (matrix, kind), ALONE));
            let mut x = b.clone();
            numeric.solve(&symbolic, x.as_mut_slice());
            let error = (dense(matrix) * &x - &b).amax() / x.amax();
            assert!(error < 1e-10, "{nodes} nodes, {kind:?}: {error}");
        }
    }
}

/// Rows and columns of sizes that differ by twelve orders of magnitude, and nearly dependent ones: what is left over is
/// compared with what a dense factorisation with partial pivoting leaves over.
#[test]
fn ill_conditioned_matrices_leave_little_more_than_a_dense_factorisation() {
    let mut seed = 9;
    for (nodes, chords) in [(5, 3), (40, 10), (120, 60), (90, 900)] {
        for kind in 0..2 {
            let mut matrix = example(nodes, chords, &mut seed);
            let sizes: Vec<f64> =
                (0..nodes).map(|_| 10_f64.powf(3.0 * random(&mut seed))).collect();
            for i in 0..nodes {
                for k in 0..matrix.neighbours(i).len() {
                    let (j, block) = matrix.block_mut(i, k);
                    let scale = if kind == 0 { sizes[i] * sizes[j] } else { 1.0 };
                    block.iter_mut().for_each(|value| *value *= scale);
                    if kind == 1 && i == j && i % 3 == 0 {
                        // A pivot block that is small beside its neighbours.
                        block.iter_mut().for_each(|value| *value *= 1e-3);
                    }
                }
            }
            let symbolic = Symbolic::new(&matrix);
            let mut numeric = Numeric::default();
            numeric.reserve(&symbolic);
            let a = dense(&matrix);
            let b = DVector::from_fn(matrix.rows(), |_, _| random(&mut seed));
            assert!(numeric.factor(&symbolic, (&matrix, Kind::General), ALONE));
            let mut x = b.clone();
            numeric.solve(&symbolic, x.as_mut_slice());
            let left = |x: &DVector<f64>| {
                let sizes = a.abs() * x.abs() + b.abs();
                (&a * x - &b).abs().component_div(&sizes).max()
            };
            let reference = a.clone().lu().solve(&b).unwrap();
            let (found, least) = (left(&x), left(&reference).max(f64::EPSILON));
            assert!(found < 1e4 * least, "{nodes} nodes, kind {kind}: {found:e}, dense {least:e}");
        }
    }
}

#[test]
fn a_vanishing_pivot_is_reported() {
    let matrix = BlockMatrix::with_pattern(&[2, 2], &[vec![0, 1], vec![0, 1]]);
    let symbolic = Symbolic::new(&matrix);
    let mut numeric = Numeric::default();
    numeric.reserve(&symbolic);
    assert!(!numeric.factor(&symbolic, (&matrix, Kind::General), ALONE));
    assert!(!numeric.factor(&symbolic, (&matrix, Kind::Definite), ALONE));
}

#[test]
fn a_matrix_that_is_not_definite_is_reported() {
    let mut matrix = definite(example(40, 10, &mut 3));
    let symbolic = Symbolic::new(&matrix);
    let mut numeric = Numeric::default();
    numeric.reserve(&symbolic);
    assert!(numeric.factor(&symbolic, (&matrix, Kind::Definite), ALONE));
    for factor in [-1.0, f64::NAN] {
        let k = matrix.neighbours(7).iter().position(|&j| j == 7).unwrap();
        matrix.block_mut(7, k).1[0] *= factor;
        assert!(!numeric.factor(&symbolic, (&matrix, Kind::Definite), ALONE), "{factor}");
    }
}

#[test]
fn factorisations_are_given_up_and_made_again() {
    let matrix = definite(example(300, 20_000, &mut 5));
    let symbolic = Symbolic::new(&matrix);
    for kind in [Kind::General, Kind::Definite] {
        let mut numeric = Numeric::default();
        numeric.reserve(&symbolic);
        let asked = Cell::new(0);
        let given_up = || {
            asked.set(asked.get() + 1);
            true
        };
        assert!(!numeric.factor(&symbolic, (&matrix, kind), &given_up));
        assert!(asked.get() > 0);
        assert!(numeric.factor(&symbolic, (&matrix, kind), ALONE));
    }
}
