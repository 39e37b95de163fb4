//! Minimum-norm solutions against the pseudo-inverse.

use super::*;

/// A matrix of given rank, with rows or columns repeated as redundant contacts have them.
fn matrix(rows: usize, columns: usize, rank: usize, repeated: bool) -> DMatrix<f64> {
    let entry = |i: usize, j: usize, k: usize| ((3 * i + 5 * j + 7 * k) as f64 * 0.7).sin();
    let left = DMatrix::from_fn(rows, rank, |i, j| entry(if repeated { i % 2 } else { i }, j, 1));
    let right = DMatrix::from_fn(rank, columns, |i, j| entry(i, j, 2));
    left * right
}

/// The four conditions of Penrose make the pseudo-inverse unique.
#[test]
fn the_solution_is_that_of_the_pseudo_inverse() {
    for (rows, columns) in [(1, 1), (2, 5), (5, 2), (5, 5), (7, 7), (11, 11), (12, 9)] {
        for rank in 0..=rows.min(columns) {
            for repeated in [false, true] {
                let a = matrix(rows, columns, rank, repeated);
                let factors = LeastNorm::new(a.clone(), 1e-11).unwrap();
                let unit = |i| DVector::from_fn(rows, |j, _| f64::from(u8::from(i == j)));
                let solved: Vec<_> = (0..rows).map(|i| factors.solve(&unit(i))).collect();
                let inverse = DMatrix::from_columns(&solved);
                let (range, kernel) = (&a * &inverse, &inverse * &a);
                let scale = a.amax() * inverse.amax();
                assert!((&range * &a - &a).amax() <= 1e-12 * (1.0 + scale) * a.amax());
                assert!(
                    (&kernel * &inverse - &inverse).amax()
                        <= 1e-12 * (1.0 + scale) * inverse.amax()
                );
                assert!((&range - range.transpose()).amax() <= 1e-12 * (1.0 + scale));
                assert!((&kernel - kernel.transpose()).amax() <= 1e-12 * (1.0 + scale));
            }
        }
    }
}

/// Equal entries: the sum of squares is least where all have the same share.
#[test]
fn equal_contacts_have_equal_shares() {
    for n in 1..40 {
        let factors = LeastNorm::new(DMatrix::from_element(n, n, 0.7), 1e-10).unwrap();
        let x = factors.solve(&DVector::from_element(n, 1.4));
        assert!(x.iter().all(|v| (v * n as f64 - 2.0).abs() < 1e-13), "{n}: {x}");
    }
}
