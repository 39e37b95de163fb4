//! Rotations by unit quaternions `(w, x, y, z)`, which turn body-fixed into world coordinates.

use nalgebra::{Matrix3, Vector3};

use crate::argument::{ArgumentError, refuse};
use crate::vectors::{combine, largest};

/// A rotation of space among the coordinates of a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rotation {
    /// The first of its four coordinates: a unit quaternion `(w, x, y, z)` that turns the body's axes to the world's.
    pub coordinate: usize,
    /// The first of its three velocities: the angular velocity in the body's axes.
    pub velocity: usize,
}

/// `out ← q ⊕ dt u`: rotations turn by `R exp(dt Ω)`, all other coordinates have the other velocities as rates.
///
/// # Panics
///
/// If the slices are too short for the rotations, or there are not as many coordinates as velocities beside them.
#[inline]
pub fn advance(rotations: &[Rotation], q: &[f64], u: &[f64], dt: f64, out: &mut [f64]) {
    let (mut from, mut rate) = (0, 0);
    for &Rotation { coordinate, velocity } in rotations {
        combine(&q[from..coordinate], dt, &u[rate..velocity], &mut out[from..coordinate]);
        (from, rate) = (coordinate + 4, velocity + 3);
        let omega = Vector3::from_column_slice(&u[velocity..rate]);
        let own = &mut out[coordinate..from];
        own.copy_from_slice(&q[coordinate..from]);
        // What does not turn keeps its attitude to the bit.
        if omega.amax() > 0.0 {
            own.copy_from_slice(&turned(&[own[0], own[1], own[2], own[3]], &(omega * dt)));
        }
    }
    combine(&q[from..], dt, &u[rate..], &mut out[from..]);
}

/// Brings the quaternions of initial coordinates to the length one.
pub(crate) fn normalise(rotations: &[Rotation], q0: &mut [f64]) -> Result<(), ArgumentError> {
    for (number, rotation) in rotations.iter().enumerate() {
        let own = &mut q0[rotation.coordinate..rotation.coordinate + 4];
        let Some(orientation) = unit([own[0], own[1], own[2], own[3]]) else {
            let message =
                format!("the quaternion {number}, (w, x, y, z), must not be of length zero");
            return refuse("q0", message);
        };
        own.copy_from_slice(&orientation);
    }
    Ok(())
}

/// Rotation matrix of a unit quaternion.
#[inline]
pub(crate) fn matrix(q: &[f64; 4]) -> Matrix3<f64> {
    let [w, x, y, z] = *q;
    let (x2, y2, z2) = (x + x, y + y, z + z);
    let (wx, wy, wz) = (w * x2, w * y2, w * z2);
    let (xx, xy, xz) = (x * x2, x * y2, x * z2);
    let (yy, yz, zz) = (y * y2, y * z2, z * z2);
    Matrix3::new(
        1.0 - (yy + zz),
        xy - wz,
        xz + wy,
        xy + wz,
        1.0 - (xx + zz),
        yz - wx,
        xz - wy,
        yz + wx,
        1.0 - (xx + yy),
    )
}

/// The quaternion after a rotation by the body-fixed vector `angle`: `q ⊗ exp(½ angle)`, of length one.
#[inline]
pub(crate) fn turned(q: &[f64; 4], angle: &Vector3<f64>) -> [f64; 4] {
    let [w, x, y, z] = *q;
    let [a, b, c, d] = exponential(angle);
    normalized([
        w * a - x * b - y * c - z * d,
        w * b + x * a + y * d - z * c,
        w * c - x * d + y * a + z * b,
        w * d + x * c - y * b + z * a,
    ])
}

/// `exp(−angle) v`: what is fixed in space as seen from a body that has turned by `angle`.
#[inline]
pub(crate) fn turned_back(angle: &Vector3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    let [w, x, y, z] = exponential(angle);
    let axis = Vector3::new(x, y, z);
    let twice = axis.cross(v) * 2.0;
    v - twice * w + axis.cross(&twice)
}

/// `D(θ)` in `δ(exp(θ) v) = (D(θ) δθ) × exp(θ) v`: how the world sees a rotation vector change, to some eight digits.
pub(crate) fn differential(angle: &Vector3<f64>) -> Matrix3<f64> {
    let [cosine, x, y, z] = exponential(angle);
    let (square, axis) = (angle.norm_squared(), angle.cross_matrix());
    // (1 − cos θ)/θ² and (θ − sin θ)/θ³; the sine of the half is that of the quaternion.
    let half = Vector3::new(x, y, z).norm_squared();
    let (first, second) = if square < 0.01 {
        (0.5 - square / 24.0, 1.0 / 6.0 - square / 120.0)
    } else {
        let sine = 2.0 * cosine * half.sqrt();
        (2.0 * half / square, (1.0 - sine / square.sqrt()) / square)
    };
    Matrix3::identity() + axis * first + axis * axis * second
}

/// A rotation `exp(angle)` by what it moves, which keeps its digits where the angle is small.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Turn {
    cosine: f64,
    axis: Vector3<f64>,
    sinc: f64,
}

impl Turn {
    #[inline]
    pub(crate) fn new(angle: &Vector3<f64>) -> Self {
        let square = 0.25 * angle.norm_squared();
        let (cosine, sinc) = if square < 0.25 { series(square) } else { closed(square.sqrt()) };
        Self { cosine, axis: angle * (0.5 * sinc), sinc }
    }

    /// The rotation back.
    #[inline]
    pub(crate) fn inverse(&self) -> Self {
        Self { axis: -self.axis, ..*self }
    }

    /// `(exp(angle) − 1) v`.
    #[inline]
    pub(crate) fn chord(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let twice = self.axis.cross(v) * 2.0;
        twice * self.cosine + self.axis.cross(&twice)
    }

    /// `∫ exp(s angle) v ds` over s from 0 to 1 for `v` across the axis: the mean of what turns along.
    #[inline]
    pub(crate) fn mean(&self, v: &Vector3<f64>) -> Vector3<f64> {
        (v * self.cosine + self.axis.cross(v)) * self.sinc
    }
}

/// Unit quaternion of a rotation vector; by its series where that is exact to rounding.
#[inline]
fn exponential(angle: &Vector3<f64>) -> [f64; 4] {
    let Turn { cosine, axis, .. } = Turn::new(angle);
    [cosine, axis.x, axis.y, axis.z]
}

/// `(cos x, sin(x)/x)` from `x² < ¼`; the first terms left out are below 1e-17.
#[inline]
fn series(square: f64) -> (f64, f64) {
    let (mut cosine, mut sinc) = (1.0, 1.0);
    for n in (1..=7).rev() {
        let even = f64::from(2 * n);
        cosine = 1.0 - square * cosine / (even * (even - 1.0));
        sinc = 1.0 - square * sinc / (even * (even + 1.0));
    }
    (cosine, sinc)
}

fn closed(half: f64) -> (f64, f64) {
    let (sine, cosine) = half.sin_cos();
    (cosine, sine / half)
}

/// The quaternion at length one, to the bit where it already is but for rounding; `None` of length zero.
pub(crate) fn unit(q: [f64; 4]) -> Option<[f64; 4]> {
    let square = q.iter().map(|c| c * c).sum::<f64>();
    if (square - 1.0).abs() <= 2e-15 {
        return Some(q);
    }
    // Scaled first, as squares overflow and underflow.
    let largest = largest(&q);
    (largest > 0.0).then(|| normalized(q.map(|c| c / largest)))
}

#[inline]
fn normalized(q: [f64; 4]) -> [f64; 4] {
    let scale = 1.0 / q.iter().map(|c| c * c).sum::<f64>().sqrt();
    q.map(|c| c * scale)
}

#[cfg(test)]
mod tests;
