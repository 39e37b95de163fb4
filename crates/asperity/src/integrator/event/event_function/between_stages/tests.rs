//! Roots of an event function between the stages of a step.

use super::*;

#[test]
fn a_short_excursion_is_found() {
    let function = |x: f64| 1e-3 - (x - 0.4) * (x - 0.4);
    let c = Tableau::radau().c;
    let values: Vec<f64> = [0.0].iter().chain(&c).map(|&x| function(x)).collect();
    assert!(values.iter().all(|v| *v < 0.0));
    let x = hidden_maximum(&values).unwrap();
    assert!((x - 0.4).abs() < 1e-6);
    let low: Vec<f64> = values.iter().map(|v| v - 2e-3).collect();
    assert_eq!(hidden_maximum(&low), None);
}
