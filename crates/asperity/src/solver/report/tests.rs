//! Statuses of residuals.

use super::*;

/// What is done is inexact up to the residual that is handed on for ill-conditioned blocks, stalled beyond.
#[test]
fn rounding_explains_residuals_up_to_a_millionth() {
    let status = |value: f64| {
        let residual = Residual { value, worst_contact: 3 };
        SolveReport::new(Ended::Done, 1, residual, Findings::default(), 1e-10)
    };
    for (value, expected) in [
        (0.9e-10, Status::Converged),
        (1.1e-10, Status::Inexact),
        (0.9e-6, Status::Inexact),
        (1.1e-6, Status::Stalled),
    ] {
        assert_eq!((status(value).status, status(value).worst_contact), (expected, 3));
    }
}
