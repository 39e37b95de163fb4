//! Closed forms of the largest ratio of two gauges.

use crate::numeric::vectors::{along, orthogonalise};
use crate::{Form, Matrix, StarSet, Vector};

impl<const P: usize> Form<'_, P> {
    /// The same as a set of powers, if its axes are those of the coordinates.
    pub(super) fn powers(&self) -> Option<(Vector<P>, Vector<P>, f64)> {
        match *self {
            Self::Powers { lower, upper, reciprocal } => Some((lower, upper, reciprocal)),
            Self::Ellipsoid { from_ball, .. } => {
                let axes = from_ball.diagonal();
                let parallel = Matrix::from_diagonal(&axes) == from_ball && axes.min() > 0.0;
                parallel.then_some((axes, axes, 0.5))
            }
            _ => None,
        }
    }
}

/// `max k_a(x)/k_b(x)` where there is a closed form, and a direction that has it.
///
/// - Of ellipsoids it is the largest singular value of the map of the one's ball to that of the other.
/// - Of sets `Σ|xᵢ/aᵢ|^s ≤ 1` along the same axes the shares `tᵢ = |xᵢ/bᵢ|^(s_b)`, which add up to one on the boundary of
///   *b*, give `k_a = (Σ rᵢ^(s_a) tᵢ^(s_a/s_b))^(1/s_a)` with `rᵢ = bᵢ/aᵢ`. The largest value is, by Hölder's inequality, the
///   norm of `r` with the exponent `q`, `1/q = 1/s_a − 1/s_b`, where that is positive, at `tᵢ ∝ rᵢ^q`; else it is
///   the largest `rᵢ`.
/// - Images under the same map have the ratio of what is mapped.
pub fn ratio_in_closed_form<const P: usize>(
    a: &dyn StarSet<P>,
    b: &dyn StarSet<P>,
) -> Option<(f64, Vector<P>)> {
    let forms = (a.form(), b.form());
    if let (Form::Image { of: first, map }, Form::Image { of: second, map: same }) = forms {
        let (ratio, x) = (map == same).then(|| ratio_in_closed_form(first, second)).flatten()?;
        return Some((ratio, (map * x).normalize()));
    }
    if let (Some(a), Some(b)) = (forms.0.powers(), forms.1.powers()) {
        return Some(ratio_of_powers(a, b));
    }
    match forms {
        (Form::Ellipsoid { to_ball, .. }, Form::Ellipsoid { from_ball, .. }) => {
            let (ratio, direction) = largest_stretch(&(to_ball * from_ball));
            Some((ratio, (from_ball * direction).normalize()))
        }
        _ => None,
    }
}

type Powers<const P: usize> = (Vector<P>, Vector<P>, f64);

fn ratio_of_powers<const P: usize>(a: Powers<P>, b: Powers<P>) -> (f64, Vector<P>) {
    // The side on which *a* is narrower.
    let sides = [b.0.component_div(&a.0), b.1.component_div(&a.1)];
    let upper = |i: usize| sides[1][i] >= sides[0][i];
    let ratios = Vector::<P>::from_fn(|i, _| sides[usize::from(upper(i))][i]);
    let axes = Vector::<P>::from_fn(|i, _| if upper(i) { b.1[i] } else { -b.0[i] });
    let (largest, inverse) = (ratios.max(), a.2 - b.2);
    if !(inverse > 0.0) {
        let axis = ratios.imax();
        return (largest, along(axis, axes[axis].signum()));
    }
    let powers = (ratios / largest).map(|r| r.powf(1.0 / inverse));
    let sum = powers.sum();
    let shares = (powers / sum).map(|t| t.powf(b.2));
    (largest * sum.powf(inverse), axes.component_mul(&shares).normalize())
}

/// The largest singular value of a matrix, and the unit vector that it stretches most.
fn largest_stretch<const P: usize>(map: &Matrix<P>) -> (f64, Vector<P>) {
    let mut columns = *map;
    orthogonalise(&mut columns);
    let lengths = Vector::<P>::from_fn(|i, _| columns.column(i).norm());
    let longest = lengths.imax();
    // The left singular vector, from which the map takes its transpose to the right one.
    (lengths[longest], map.tr_mul(&(columns.column(longest) / lengths[longest])).normalize())
}
