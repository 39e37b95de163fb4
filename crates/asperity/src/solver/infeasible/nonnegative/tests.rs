use super::*;

/// Columns that repeat or combine others leave the conditions of a minimum as they are: no part of the rest along a
/// column that is held, none at all along one that is used.
#[test]
fn dependent_columns_do_not_keep_the_active_sets_from_settling() {
    let entry = |i: usize, j: usize| ((7 * i + 13 * j + 1) as f64 * 0.618).sin();
    for rows in 2..9 {
        for columns in 2..24 {
            let free = (rows / 2).max(1).min(columns);
            let a = DMatrix::from_fn(rows, columns, |i, j| match j < free {
                true => entry(i, j),
                false => (0..free).map(|k| entry(i, k) * entry(k, j)).sum(),
            });
            let f = DVector::from_fn(rows, |i, _| entry(i, columns + rows));
            let x = least_squares(&a, &f).unwrap();
            let gradient = a.tr_mul(&(&f - &a * DVector::from_column_slice(&x)));
            let scale = 1e-9 * a.norm() * f.norm();
            for (x, slope) in x.iter().zip(&gradient) {
                assert!(*x >= 0.0 && *slope <= scale, "{rows} {columns}: {x} {slope}");
                assert!(*x == 0.0 || slope.abs() <= scale, "{rows} {columns}: {x} {slope}");
            }
            let large = 2f64.powi(30);
            for (unit, of_f) in [(large, 1.0), (1.0 / large, 1.0), (1.0, large), (1.0, 1.0 / large)]
            {
                let other = least_squares(&(&a * unit), &(&f * of_f)).unwrap();
                let same = other.iter().map(|x| x * unit / of_f);
                assert!(same.eq(x.iter().copied()), "{rows} {columns}: {other:?} {x:?}");
            }
        }
    }
}
