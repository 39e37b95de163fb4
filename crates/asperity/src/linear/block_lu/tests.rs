//! The factorisation by parts against that of the whole matrix.

use super::*;

#[test]
fn parts_that_nothing_connects_are_solved_as_the_whole_matrix_is() {
    let (n, mut blocks, mut whole) = (23, BlockLu::default(), DenseLu::default());
    for parts in [1, 2, 5, 23] {
        let entry = |i: usize, j: usize| match (i % parts == j % parts, i == j) {
            (false, _) => 0.0,
            (true, same) => (f64::from(u8::from(same)) * 9.0) + ((3 * i + 5 * j) as f64).sin(),
        };
        for matrix in [blocks.begin(n), whole.begin(n)] {
            for (k, value) in matrix.iter_mut().enumerate() {
                *value = entry(k / n, k % n);
            }
        }
        let mut x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let mut y = x.clone();
        assert!(blocks.factor(1e-11) && whole.factor(1e-11));
        assert!(blocks.solve(&mut x) && whole.solve(&mut y));
        assert_eq!(blocks.members.count(), parts);
        assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-14), "{parts}");
    }
}

#[test]
fn the_rows_of_singular_parts_are_told() {
    let mut lu = BlockLu::default();
    lu.begin(4).copy_from_slice(&[
        1.0, 0.0, 1.0, 0.0, // rows 0 and 2 are the same
        0.0, 1e-30, 0.0, 0.0, //
        1.0, 0.0, 1.0, 0.0, //
        0.0, 0.0, 0.0, 0.0,
    ]);
    let mut failed = Vec::new();
    assert!(!lu.factor_parts(1e-11, |_, rows| failed.push(rows.to_vec())));
    assert_eq!(failed, [vec![0, 2], vec![3]]);
}
