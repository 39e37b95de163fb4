//! How planes move: shaken tables and rocking ones.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::argument::{ArgumentError, refuse};
use crate::system::{Break, Moment, TimeFunction};

/// How a plane moves, in the axes of the world or of the body that it is fixed to.
///
/// Its point goes to `point + displacement`, and the plane with its axes turns by `exp(rotation)` about it. Velocities
/// follow from the same functions: signals know their rates, functions of the user return them.
///
/// ```
/// use asperity::system::rigid::{Plane, PlaneMotion};
/// use asperity::system::{Signal, TimeFunction};
///
/// // Shaken up and down with 50 Hz.
/// let shaking = Signal::sine(50.0, &[0.0, 0.0, 1e-3], &[0.0; 3], &[0.0; 3])?;
/// let motion = PlaneMotion { displacement: shaking.into(), rotation: TimeFunction::ZERO };
/// let table = Plane { motion: Some(motion), ..Plane::floor() };
/// # assert!(table.body.is_none());
/// # Ok::<(), asperity::system::SystemError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneMotion {
    /// Displacement of the plane's point in m.
    pub displacement: TimeFunction<3>,
    /// Rotation vector in rad.
    pub rotation: TimeFunction<3>,
}

/// Where the motion has taken a plane, and its velocities.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlacedMotion {
    pub(super) displacement: Vector3<f64>,
    pub(super) rotation: Matrix3<f64>,
    pub(super) velocity: Vector3<f64>,
    pub(super) angular_velocity: Vector3<f64>,
}

impl PlaneMotion {
    /// The motion of a line of planar systems: displacement along x and y, and the angle.
    ///
    /// # Errors
    ///
    /// [`ArgumentError`] if a signal has another number of components.
    pub fn planar(
        displacement: &TimeFunction<2>,
        rotation: &TimeFunction<1>,
    ) -> Result<Self, ArgumentError> {
        displacement.check("displacement")?;
        rotation.check("rotation")?;
        Ok(Self { displacement: displacement.spread([0, 1]), rotation: rotation.spread([2]) })
    }

    /// Refuses jumps, and functions that do not know their rates.
    pub(super) fn check(&self, planar: bool) -> Result<(), ArgumentError> {
        // What leads out of the plane of planar systems.
        let displacement = ("displacement", &self.displacement, &[2][..]);
        for (argument, function, out) in [displacement, ("rotation", &self.rotation, &[0, 1])] {
            let refuse = |message: &str| refuse(argument, message);
            function.check(argument)?;
            match function {
                TimeFunction::Signal(signal) if signal.jumps() => {
                    return refuse("must not jump: no velocity is that of a jump");
                }
                TimeFunction::Custom(_) => return refuse("must be a function with its rate"),
                _ => {}
            }
            if planar && out.iter().any(|&component| !function.may_vanish(component)) {
                return refuse("must stay in the plane z = 0 in planar systems");
            }
        }
        Ok(())
    }

    /// Where the plane is, and how it moves there.
    pub(super) fn at(&self, at: Moment) -> PlacedMotion {
        let [displacement, velocity] = self.displacement.value_and_rate(at).map(Vector3::from);
        let [angle, rate] = self.rotation.value_and_rate(at).map(Vector3::from);
        PlacedMotion {
            displacement,
            rotation: *Rotation3::new(angle).matrix(),
            velocity,
            angular_velocity: angular_velocity(&angle, &rate),
        }
    }

    /// The next time at which it is not smooth.
    pub(super) fn next_break(&self, t: f64) -> Option<Break> {
        Break::earlier(self.displacement.next_break(t), self.rotation.next_break(t))
    }
}

/// The angular velocity of `exp ρ` in the axes that do not turn,
/// `ω = (1 + (1 − cos φ)/φ² ρ× + (φ − sin φ)/φ³ ρ×ρ×) ρ̇` with `φ = ‖ρ‖`.
fn angular_velocity(rho: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    let square = rho.norm_squared();
    let (a, b) = if square < 0.25 {
        // Σ (−1)ᵏ φ²ᵏ/(2k + 2)! and Σ (−1)ᵏ φ²ᵏ/(2k + 3)!, without cancellation; the next terms are below rounding.
        let (mut a, mut b, mut term) = (0.0, 0.0, 0.5);
        for k in 0..8 {
            let even = f64::from(2 * k);
            a += term;
            b += term / (even + 3.0);
            term *= -square / ((even + 3.0) * (even + 4.0));
        }
        (a, b)
    } else {
        let angle = square.sqrt();
        let half = (0.5 * angle).sin();
        (2.0 * half * half / square, (angle - angle.sin()) / (square * angle))
    };
    let turned = rho.cross(rate);
    rate + turned * a + rho.cross(&turned) * b
}

#[cfg(test)]
mod tests;
