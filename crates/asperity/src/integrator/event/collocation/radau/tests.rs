//! The order of the Radau nodes and weights.

use super::*;

#[test]
fn nodes_and_weights_have_the_order_nine() {
    let table = Tableau::radau();
    assert_eq!(table.c[STAGES - 1], 1.0);
    for k in 0..9 {
        let sum: f64 = (0..STAGES).map(|j| table.a[(STAGES - 1, j)] * table.c[j].powi(k)).sum();
        assert!((sum - 1.0 / (f64::from(k) + 1.0)).abs() < 1e-14, "{k}: {sum}");
    }
    let sum: f64 = (0..STAGES).map(|j| table.a[(STAGES - 1, j)] * table.c[j].powi(9)).sum();
    assert!((sum - 0.1).abs() > 1e-6);
    let characteristic = (table.a - Square::identity() * table.gamma).determinant();
    assert!(characteristic.abs() < 1e-17, "{characteristic}");
}
