//! Sliding and drilling friction of a circular contact.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::numeric::polarity;
use crate::{ConvexSet, Matrix, SetError, StarSet, Vector, error::size, project};

/// How the normal pressure is spread over the contact's disk.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Pressure {
    /// `p ∝ √(1 − r²/R²)`: an elastic ball on a plane.
    Hertz,
    /// `p` constant: a flat punch.
    Uniform,
}

/// Coulomb–Contensou friction: the forces `(−λ₁, −λ₂, −τ/R)` per unit normal force of a disk of radius `R`
/// that slides with `(v₁, v₂)` and drills with `Rω`, under local isotropic friction μ.
///
/// Its support function is the dissipation `Φ(v, Rω) = (1/λ_N) ∫ μ p ‖v + ω × r‖ dA`; with `u = ‖v‖/(R|ω|)`
/// its gradient is `μ(λ(u), τ(u))`. The set is a body of revolution about the third axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoulombContensou {
    meridian: Meridian,
}

/// The section of the body with a plane through its axis: sliding along the first axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Meridian {
    mu: f64,
    pressure: Pressure,
}

/// Sliding force, torque and curvature for `μ = 1` at the ratio `u` of sliding to drilling.
struct Characteristic {
    force: f64,
    torque: f64,
    /// `dλ/du` for `u ≤ 1`, `u³ dλ/du` beyond, which stays finite.
    stiffness: f64,
}

impl CoulombContensou {
    /// The set for friction coefficient `mu`.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if `mu` is not between 1e-60 and 1e60.
    pub fn new(mu: f64, pressure: Pressure) -> Result<Self, SetError> {
        Ok(Self { meridian: Meridian { mu: size("mu", mu)?, pressure } })
    }

    /// Friction coefficient and distribution of the pressure.
    pub fn parameters(&self) -> (f64, Pressure) {
        (self.meridian.mu, self.meridian.pressure)
    }

    pub(crate) fn scaled(&self, factor: f64) -> Result<Self, SetError> {
        Self::new(self.meridian.mu * factor, self.meridian.pressure)
    }
}

impl Pressure {
    fn characteristic(self, u: f64) -> Characteristic {
        match self {
            Self::Hertz if u <= 1.0 => hertz_drilling(u),
            Self::Hertz if u < 3.0 => hertz_sliding(u),
            Self::Hertz => hertz_far(u),
            Self::Uniform => uniform(u),
        }
    }
}

fn hertz_drilling(u: f64) -> Characteristic {
    let square = u * u;
    Characteristic {
        force: 0.375 * PI * u * (1.0 - 0.25 * square),
        torque: 0.1875 * PI * (1.0 - square + 0.375 * square * square),
        stiffness: 0.375 * PI * (1.0 - 0.75 * square),
    }
}

/// From the force by `dτ = −u dλ`, for `Φ` has degree one.
fn hertz_sliding(u: f64) -> Characteristic {
    let (square, angle, root) = (u * u, u.recip().asin(), (u * u - 1.0).sqrt());
    let force = u * (1.0 - 0.25 * square) * angle + root * (square + 2.0) / (4.0 * u);
    let torque =
        (0.1875 * square * square - 0.5 * square + 0.5) * angle + root * (0.375 - 0.1875 * square);
    let slope = (1.0 - 0.75 * square) * angle + root * (0.75 - 0.5 / square);
    Characteristic {
        force: 0.75 * force,
        torque: 0.75 * torque,
        stiffness: 0.75 * slope * u.powi(3),
    }
}

/// The same as a power series in `t = 1/u²`, which does not cancel: with `asin s = Σ aₙ s²ⁿ⁺¹` and
/// `√(1 − s²) = Σ bₙ s²ⁿ`, `dλ/du = ¾ Σ dₙ u¹⁻²ⁿ`, `dₙ = aₙ₋₁ − ¾aₙ + ¾bₙ − ½bₙ₋₁`, from `n = 2` on.
fn hertz_far(u: f64) -> Characteristic {
    let t = (1.0 / u).powi(2);
    let mut power = 1.0;
    let (mut lack, mut torque, mut stiffness) = (0.0, 0.0, 0.0);
    for FarTerm { of_lack, of_torque, of_stiffness } in &FAR {
        lack += of_lack * power;
        torque += of_torque * power;
        stiffness += of_stiffness * power;
        power *= t;
        if power < 1e-18 {
            break;
        }
    }
    Characteristic { force: 1.0 - lack * t, torque: torque / u, stiffness }
}

/// Coefficients of a power of `t` in the series of `hertz_far`.
#[derive(Clone, Copy)]
struct FarTerm {
    of_lack: f64,
    of_torque: f64,
    of_stiffness: f64,
}

/// The terms from `n = 2` on; at `u = 3` the last is below the rounding of the first.
const FAR: [FarTerm; 22] = far_terms();

const fn far_terms() -> [FarTerm; 22] {
    let mut terms = [FarTerm { of_lack: 0.0, of_torque: 0.0, of_stiffness: 0.0 }; 22];
    let (mut coefficient, mut a, mut b) = (1.0, 1.0, 1.0);
    let mut n = 1;
    while n < 24 {
        let order = n as f64;
        coefficient *= (2.0 * order - 1.0) / (2.0 * order);
        let (last_a, last_b) = (a, b);
        a = coefficient / (2.0 * order + 1.0);
        b = last_b * (2.0 * order - 3.0) / (2.0 * order);
        if n >= 2 {
            let term = 0.75 * (last_a - 0.75 * a + 0.75 * b - 0.5 * last_b);
            terms[n - 2] = FarTerm {
                of_lack: term / (2.0 * order - 2.0),
                of_torque: term / (2.0 * order - 3.0),
                of_stiffness: term,
            };
        }
        n += 1;
    }
    terms
}

/// `Φ` is the mean distance of the points of a unit disk from a point at distance `u` of its centre, given
/// by complete elliptic integrals of the parameter `m = u²` or `1/u²`.
fn uniform(u: f64) -> Characteristic {
    let c = 4.0 / (3.0 * PI);
    let m = if u <= 1.0 { u * u } else { (1.0 / u).powi(2) };
    let Elliptic { first, second, reduced, excess } = Elliptic::new(m);
    // ((1 + m)E − (1 − m)K)/m without cancellation at small m.
    let sum = if m < 0.5 {
        first * (2.0 - (1.0 + m) * (0.5 + m * excess))
    } else {
        ((1.0 + m) * second - reduced) / m
    };
    if u <= 1.0 {
        let torque = c / 3.0 * ((7.0 + m) * second - 4.0 * reduced) - c * m * sum;
        let stiffness = 4.0 / PI * second - c * sum;
        return Characteristic { force: c * u * sum, torque, stiffness };
    }
    let (torque, stiffness) = if m < 0.5 {
        let torque = first / u * (1.0 + 2.0 * excess * (1.0 - 2.0 * m));
        (torque, first * (0.5 - (2.0 - m) * excess))
    } else {
        let torque = u * ((4.0 - 2.0 * u * u) * second + (2.0 * u * u - 3.0) * reduced);
        (torque, u * u * ((2.0 * u * u - 1.0) * second - 2.0 * u * u * reduced))
    };
    Characteristic { force: c * sum, torque: c / 3.0 * torque, stiffness: c * stiffness }
}

/// Complete elliptic integrals by the arithmetic–geometric mean.
struct Elliptic {
    /// `K`, not used where it is infinite.
    first: f64,
    /// `E`.
    second: f64,
    /// `(1 − m)K`.
    reduced: f64,
    /// `(1 − E/K − m/2)/m²`.
    excess: f64,
}

impl Elliptic {
    fn new(m: f64) -> Self {
        if m >= 1.0 {
            return Self { first: f64::INFINITY, second: 1.0, reduced: 0.0, excess: 0.5 };
        }
        let (mut a, mut b) = (1.0, (1.0 - m).sqrt());
        // 1 − E/K = Σ 2ⁿ⁻¹ cₙ², c₀² = m; the others as parts of m.
        let mut part = 0.5 / (1.0 + b);
        let (mut excess, mut weight) = (0.0, 1.0);
        while part * m > 1e-20 * a || weight == 1.0 {
            excess += weight * part * part;
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
            // c of the next mean is c²/4a.
            part *= part * m / (4.0 * (0.5 * (a + b)));
            weight *= 2.0;
        }
        let first = FRAC_PI_2 / a;
        let second = first * (1.0 - 0.5 * m - m * m * excess);
        Self { first, second, reduced: (1.0 - m) * first, excess }
    }
}

impl Meridian {
    /// `λ`, `τ` and the Hessian of `Φ` in the first quadrant.
    fn parts(&self, y: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        let (slide, drill) = (y.x.abs(), y.y.abs());
        let u = slide / drill;
        let c = self.pressure.characteristic(u);
        let (ratio, stiffness) = if u <= 1.0 {
            (Vector::<2>::new(1.0, -u), c.stiffness / drill)
        } else {
            (Vector::<2>::new(drill / slide, -1.0), c.stiffness / slide)
        };
        let sign = Vector::<2>::new(1f64.copysign(y.x), 1f64.copysign(y.y));
        let ratio = ratio.component_mul(&sign);
        let point = Vector::<2>::new(c.force, c.torque).component_mul(&sign) * self.mu;
        (point, ratio * ratio.transpose() * (stiffness * self.mu))
    }
}

impl StarSet<2> for Meridian {
    fn gauge(&self, x: &Vector<2>) -> f64 {
        self.gauge_jet(x).0
    }

    fn gauge_jet(&self, x: &Vector<2>) -> (f64, Vector<2>) {
        polarity::gauge_jet(self, x)
    }
}

impl ConvexSet<2> for Meridian {
    fn support_point(&self, y: &Vector<2>) -> Vector<2> {
        self.parts(y).0
    }

    fn support_jet(&self, y: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        self.parts(y)
    }

    fn project(&self, z: &Vector<2>) -> Vector<2> {
        project::by_normals(self, z, None)
    }

    fn project_from(&self, z: &Vector<2>, start: &Vector<2>) -> Vector<2> {
        project::by_normals(self, z, Some(&(z - start)))
    }

    fn project_jet(&self, z: &Vector<2>, start: &Vector<2>) -> (Vector<2>, Matrix<2>) {
        let x = self.project_from(z, start);
        let Some((n, distance)) = project::jet::normal(self, z, &x) else {
            return (x, Matrix::identity());
        };
        (x, project::jet::from_curvature(&n, distance, &self.parts(&n).1))
    }
}

/// Distance from the axis and height.
fn meridian(x: &Vector<3>) -> Vector<2> {
    Vector::<2>::new(x.x.hypot(x.y), x.z)
}

/// The vector with meridian `m` over the direction of `x`.
fn around(x: &Vector<3>, m: &Vector<2>) -> Vector<3> {
    let distance = x.x.hypot(x.y);
    let unit = if distance > 0.0 { x.xy() / distance } else { Vector::<2>::new(1.0, 0.0) };
    Vector::<3>::new(unit.x * m.x, unit.y * m.x, m.y)
}

/// Derivative of `y ↦ around(y, m(meridian(y)))` from `m` and its derivative `section`: around the axis a vector
/// turns with `y`, on the axis every direction is in a section.
fn revolved(y: &Vector<3>, m: &Vector<2>, section: &Matrix<2>) -> Matrix<3> {
    let (out, up) = (around(y, &Vector::<2>::new(1.0, 0.0)), Vector::<3>::z());
    let axes = Matrix::<3>::from_columns(&[out, up, Vector::zeros()]);
    let mut inner = Matrix::<3>::zeros();
    inner.fixed_view_mut::<2, 2>(0, 0).copy_from(section);
    let distance = y.x.hypot(y.y);
    let hoop = if distance > 0.0 { m.x / distance } else { section[(0, 0)] };
    let across = Vector::<3>::new(-out.y, out.x, 0.0);
    axes * inner * axes.transpose() + across * across.transpose() * hoop
}

impl StarSet<3> for CoulombContensou {
    fn gauge(&self, x: &Vector<3>) -> f64 {
        self.meridian.gauge(&meridian(x))
    }

    fn gauge_jet(&self, x: &Vector<3>) -> (f64, Vector<3>) {
        let (gauge, gradient) = self.meridian.gauge_jet(&meridian(x));
        (gauge, around(x, &gradient))
    }
}

impl ConvexSet<3> for CoulombContensou {
    fn support_point(&self, y: &Vector<3>) -> Vector<3> {
        around(y, &self.meridian.support_point(&meridian(y)))
    }

    fn support_jet(&self, y: &Vector<3>) -> (Vector<3>, Matrix<3>) {
        let (point, section) = self.meridian.support_jet(&meridian(y));
        (around(y, &point), revolved(y, &point, &section))
    }

    fn project(&self, z: &Vector<3>) -> Vector<3> {
        let local = meridian(z);
        let nearest = self.meridian.project(&local);
        // A point inside comes back as it is.
        if nearest == local { *z } else { around(z, &nearest) }
    }

    fn project_from(&self, z: &Vector<3>, start: &Vector<3>) -> Vector<3> {
        let local = meridian(z);
        let nearest = self.meridian.project_from(&local, &meridian(start));
        if nearest == local { *z } else { around(z, &nearest) }
    }

    fn project_jet(&self, z: &Vector<3>, start: &Vector<3>) -> (Vector<3>, Matrix<3>) {
        let local = meridian(z);
        let (nearest, section) = self.meridian.project_jet(&local, &meridian(start));
        if nearest == local {
            return (*z, Matrix::identity());
        }
        (around(z, &nearest), revolved(z, &nearest, &section))
    }
}
