//! Solutions of small dense systems, and singular matrices.

use super::*;

#[test]
fn systems_of_all_sizes_are_solved() {
    let mut lu = DenseLu::default();
    for n in (0..20).chain([37, 64]) {
        // Large entries away from the diagonal ask for exchanges of rows.
        let large = |i: usize, j: usize| if (i + 3) % n.max(1) == j { n as f64 } else { 0.0 };
        let entry = |i: usize, j: usize| large(i, j) + ((3 * i + 5 * i * j) as f64).sin();
        for (k, value) in lu.begin(n).iter_mut().enumerate() {
            *value = entry(k / n, k % n);
        }
        let mut x: Vec<f64> =
            (0..n).map(|i| (0..n).map(|j| entry(i, j) * (j as f64 - 2.0)).sum()).collect();
        assert!(lu.factor(1e-13) && lu.solve(&mut x), "{n}");
        assert!(x.iter().enumerate().all(|(j, x)| (x - (j as f64 - 2.0)).abs() < 1e-11), "{n}");
    }
}

#[test]
fn small_pivots_count_as_none() {
    let mut lu = DenseLu::default();
    for (last, regular) in [(4.0, false), (4.0 + 1e-12, false), (4.0 + 1e-9, true)] {
        lu.begin(2).copy_from_slice(&[1.0, 2.0, 2.0, last]);
        assert_eq!(lu.factor(1e-11), regular);
    }
    lu.begin(1)[0] = f64::NAN;
    assert!(!lu.factor(0.0));
}

#[test]
fn a_singular_matrix_after_a_larger_one_has_no_solution_but_no_panic_either() {
    let mut lu = DenseLu::default();
    let entries = lu.begin(6);
    (0..6).for_each(|k| entries[6 * k + 5 - k] = 1.0);
    assert!(lu.factor(0.0));
    lu.begin(3).fill(0.0);
    assert!(!lu.factor(0.0));
    assert!(!lu.solve(&mut [1.0, 2.0, 3.0]));
}
