//! Bounds over the boundaries of both sets, for the one-contact solver: without the table that is walked, where the sets
//! are known well enough.

use std::f64::consts::PI;

use asperity_set::{
    Ball, Convex, ConvexSet, Form, Matrix, Star, StarSet, TurningDirections, Vector, largest_ratio,
};

/// Bounds over the boundaries of both sets.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    /// Smallest sine of the angle from the normal of *D* to the tangent of *C*: 1 for associated laws, negative where
    /// the sliding velocity may point into the reservoir.
    pub smallest_sine: f64,
    /// Largest radius of *C*.
    pub largest_radius: f64,
    /// Largest way of `x` along bdry *C* per angle by which the normal of *D* turns; infinite where no bound is known.
    pub largest_advance: f64,
}

/// Part of an angle that rounding may change in a closed form, above which bounds are searched for.
const ROUNDING: f64 = 1e-6;
/// Samples of a trigonometric polynomial of degree three: what lies between is larger by one in a hundred at the most.
const SAMPLES: usize = 64;
/// Factor of the largest way that is found by a search.
const MARGIN: f64 = 1.25;

impl Bounds {
    /// Of a set on a line, where nothing turns.
    pub(crate) fn on_a_line(largest_radius: f64) -> Self {
        Self { smallest_sine: 0.0, largest_radius, largest_advance: f64::INFINITY }
    }

    /// Of isotropic friction.
    pub(super) fn isotropic(mu: f64) -> Self {
        Self { smallest_sine: 1.0, largest_radius: mu, largest_advance: mu }
    }

    /// Of sets whose boundaries have no corners, in closed form for ellipses, else by a search along directions in which
    /// both are resolved; `None` of any others.
    pub(super) fn of_smooth_sets(reservoir: &Star<2>, direction: &Convex<2>) -> Option<Self> {
        if let (
            Form::Ellipsoid { from_ball, to_ball },
            Form::Ellipsoid { from_ball: from_d, to_ball: to_d },
        ) = (reservoir.form(), direction.form())
            && let Some(bounds) = Self::of_ellipses((from_ball, to_ball), (from_d, to_d))
        {
            return Some(bounds);
        }
        if !(reservoir.corners().is_empty() && direction.corners().is_empty()) {
            return None;
        }
        let around = TurningDirections::new(reservoir, direction)?;
        let against = |x: &Vector<2>| {
            let normal = reservoir.gauge_jet(x).1.normalize();
            -normal.dot(&direction.normal(x).normalize())
        };
        let way = |x: &Vector<2>| {
            let n = direction.normal(x);
            let (z, dz) = direction.support_derivative(&n, &Vector::<2>::new(-n.y, n.x));
            let (gauge, gradient) = reservoir.gauge_jet(&z);
            (dz - z * (gradient.dot(&dz) / gauge)).norm() / gauge
        };
        // The curvature of others may vanish.
        let is_round = matches!(direction, Convex::Ball(_) | Convex::Ellipsoid(_));
        Some(Self {
            smallest_sine: -around.largest(against).0,
            largest_radius: largest_ratio(&Ball::UNIT, reservoir).0,
            largest_advance: if is_round { MARGIN * around.largest(way).0 } else { f64::INFINITY },
        })
    }

    /// Of two ellipses, each with the maps from its ball and to it; `None` where rounding hides the angle.
    ///
    /// At `z` the normals are `w = S z` of *D* and `T z = M w` of *C*, with `M = T S⁻¹`. In complex numbers
    /// `M w = m w + l w̄`, so that `Mw/w` runs around a circle with centre `m` and radius `|l|`: the angle between the
    /// normals is at most `|arg m| + asin(|l|/|m|)`, with `|m|² − |l|² = det M`. The sine from a normal to a tangent is
    /// the cosine from normal to normal.
    ///
    /// With `z = F e(t)` the direction `m` of `N e`, `N = T_b F`, turns by `det N/‖Ne‖² dt` and the normal of *D* by
    /// `dφ = ab/‖K e‖² dt`, `K = diag(b, a)`. With `x = F_C m` the way per angle is `‖F_C m⊥‖ ‖Q m‖² det N/(ab)`,
    /// `Q = K N⁻¹ = ab diag(1/a, 1/b) T_D F_C`. Its square is a trigonometric polynomial of degree three in twice the
    /// angle of `m`, which between `n` equidistant samples is at most `1/cos(3π/n)` times the largest of them.
    fn of_ellipses(
        (from_c, to_c): (Matrix<2>, Matrix<2>),
        (from_d, to_d): (Matrix<2>, Matrix<2>),
    ) -> Option<Self> {
        let axes = |from: &Matrix<2>| [0, 1].map(|i| from.column(i).norm());
        let (c, d) = (axes(&from_c), axes(&from_d));
        let (area_c, area_d) = (c[0] * c[1], d[0] * d[1]);
        let (to, from) = (to_c.transpose() * to_c, from_d * from_d.transpose());
        let (centre, radius) = circle(&(to * from));
        let rounding = 8.0 * f64::EPSILON * to.norm() * from.norm();
        // The comparison also turns away what is not a number.
        if !(rounding <= ROUNDING * centre.norm()) {
            return None;
        }
        let turn = centre.y.atan2(centre.x).abs() + radius.atan2(area_d / area_c);
        let rows = Matrix::<2>::new(1.0 / d[0], 0.0, 0.0, 1.0 / d[1]) * to_d;
        let stretch = rows * from_c * area_d;
        let (sine, cosine) = (PI / SAMPLES as f64).sin_cos();
        let (mut m, mut largest) = (Vector::<2>::new(1.0, 0.0), 0.0_f64);
        for _ in 0..SAMPLES {
            let across = from_c * Vector::<2>::new(-m.y, m.x);
            largest = largest.max(across.norm() * (stretch * m).norm_squared());
            m = Vector::<2>::new(cosine * m.x - sine * m.y, sine * m.x + cosine * m.y);
        }
        let between = (3.0 * PI / SAMPLES as f64).cos().sqrt();
        Some(Self {
            smallest_sine: turn.cos(),
            largest_radius: c[0].max(c[1]),
            largest_advance: largest / (between * area_c),
        })
    }
}

/// The centre and the radius of the circle around which `Mw/w` runs, in complex numbers.
fn circle(m: &Matrix<2>) -> (Vector<2>, f64) {
    let centre = Vector::<2>::new(0.5 * (m.m11 + m.m22), 0.5 * (m.m21 - m.m12));
    (centre, (0.5 * (m.m11 - m.m22)).hypot(0.5 * (m.m12 + m.m21)))
}

#[cfg(test)]
mod tests;
