//! Solutions of small dense systems, and singular matrices.

use super::*;

#[test]
fn systems_of_all_sizes_are_solved() {
    let mut lu = PaddedLu::default();
    for n in (0..40).rev().chain([41, 64]) {
        // Large entries away from the diagonal ask for exchanges of rows.
        let large = |i: usize, j: usize| if (i + 3) % n.max(1) == j { n as f64 } else { 0.0 };
        let entry = |i: usize, j: usize| large(i, j) + ((3 * i + 5 * i * j) as f64).sin();
        lu.begin(n);
        for i in 0..n {
            lu.row_mut(i).iter_mut().enumerate().for_each(|(j, value)| *value = entry(i, j));
        }
        let mut x: Vec<f64> =
            (0..n).map(|i| (0..n).map(|j| entry(i, j) * (j as f64 - 2.0)).sum()).collect();
        assert!(lu.factor(), "{n}");
        lu.solve(&mut x);
        assert!(x.iter().enumerate().all(|(j, x)| (x - (j as f64 - 2.0)).abs() < 1e-11), "{n}");
    }
}

#[test]
fn singular_matrices_and_what_is_not_a_number_are_told() {
    let mut lu = PaddedLu::default();
    for rows in [[[1.0, 2.0], [2.0, 4.0]], [[0.0, 1.0], [0.0, 1.0]], [[f64::NAN; 2]; 2]] {
        lu.begin(2);
        rows.iter().enumerate().for_each(|(i, row)| lu.row_mut(i).copy_from_slice(row));
        assert!(!lu.factor());
    }
}
