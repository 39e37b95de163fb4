//! From a system to the constants of its step, and between its states and those of lanes.

use asperity_set::{Convex, Matrix, Star, Vector};

use super::kernel::{Coefficients, Pair, State};
use crate::contact::{ContactState, Phase};
use crate::integrator::midpoint::Stepper;
use crate::law::Law;
use crate::simulate::Options;
use crate::solver::{Solver, Uniqueness};
use crate::system::{System, linear::PlanarMotion};

type V = Vector<2>;
type M = Matrix<2>;

/// The least tolerance of steps: what lanes find has a residual of rounding, which is a tenth of this at most.
const LEAST_TOLERANCE: f64 = 1e-12;
/// Largest ratio of the semi-axes of both sets, beyond which squares lose too many digits.
const LARGEST_RATIO: f64 = 1e3;

/// A run in a lane.
pub(super) struct Plan<'a> {
    pub(super) coefficients: Coefficients<f64>,
    uniqueness: Uniqueness<'a>,
    /// `F`, which maps the unit disk to *D*, and `Wᵀ`, with their inverses.
    from_disk: M,
    to_disk: M,
    rows: M,
    inverse_rows: M,
    /// χ.
    velocity: V,
}

/// The map of an ellipse to the unit disk and the ratio of its semi-axes.
fn map_of(set: &Convex<2>) -> Option<(M, f64)> {
    match set {
        Convex::Ball(disk) => Some((M::identity() / disk.size(), 1.0)),
        Convex::Ellipsoid(ellipse) => {
            let axes = ellipse.semi_axes();
            Some((*ellipse.to_ball(), axes.max() / axes.min()))
        }
        _ => None,
    }
}

fn rows_of(matrix: &M) -> [Pair<f64>; 2] {
    [[matrix.m11, matrix.m12], [matrix.m21, matrix.m22]]
}

fn pair_of(v: &V) -> Pair<f64> {
    [v.x, v.y]
}

impl<'a> Plan<'a> {
    /// A run of a system, of which `stepper` has made a step; nothing if lanes cannot make its steps.
    pub(super) fn new(
        system: &'a dyn System,
        stepper: &Stepper<'_>,
        options: &Options,
    ) -> Option<Self> {
        let exact = matches!(options.solver, Solver::Auto { .. } | Solver::Exact { .. });
        let PlanarMotion { mass, stiffness, damping, force, direction, velocity } =
            system.as_linear()?.planar_motion()?;
        let ([contact], [given]) = (stepper.problem().contacts(), system.contacts()) else {
            return None;
        };
        let (Law::Two(law), Some(normal)) = (given.law(), contact.normal.prescribed()) else {
            return None;
        };
        let plain = law.rate().is_none() && given.tangential_restitution() == 0.0;
        if !(exact && plain && normal > 0.0 && options.tolerance >= LEAST_TOLERANCE) {
            return None;
        }
        let Star::Convex(reservoir) = law.reservoir() else { return None };
        let ((to_reservoir, one), (to_disk, two)) = (map_of(reservoir)?, map_of(law.direction())?);
        if one.max(two) > LARGEST_RATIO {
            return None;
        }
        let uniqueness = Uniqueness::new(stepper.problem(), law, &to_reservoir)?;
        let (dt, rows) = (options.dt, direction.transpose());
        let (inverse_rows, response) = (rows.try_inverse()?, mass.try_inverse()? * dt);
        let (from_disk, scaled) = (to_disk.try_inverse()?, to_disk.try_inverse()?.transpose());
        // γ with all forces but friction, as a function of Wᵀq and γ: u = W⁻ᵀ(γ − χ).
        let into = scaled * rows;
        let back = inverse_rows * scaled.try_inverse()?;
        let (by_position, by_velocity) =
            (into * response * stiffness * back, M::identity() + into * response * damping * back);
        let belt = scaled * velocity;
        let constant = into * response * force + belt - by_velocity * belt;
        let delassus = M::from_fn(|i, j| stepper.problem().delassus().own(0, i, j));
        let resistance = scaled * delassus * from_disk * normal;
        let gauge = to_reservoir * from_disk;
        let gauge = gauge.transpose() * gauge;
        // The smallest radius of the reservoir in these coordinates is one over the root of the trace at least.
        let largest_radius = (gauge.trace() / gauge.determinant()).sqrt();
        let squared = |gauge: f64| gauge.max(0.0).powi(2);
        let (low, high) = uniqueness.doubtful;
        let coefficients = Coefficients {
            half: 0.5 * dt,
            belt: pair_of(&belt),
            by_position: rows_of(&by_position),
            by_velocity: rows_of(&by_velocity),
            constant: pair_of(&constant),
            resistance: rows_of(&resistance),
            compliance: rows_of(&resistance.try_inverse()?),
            strongest: resistance.norm() * largest_radius,
            gauge: [gauge.m11, gauge.m12, gauge.m22],
            doubtful: if low <= high {
                [squared(low), squared(high)]
            } else {
                [f64::INFINITY, f64::NEG_INFINITY]
            },
        };
        Some(Self { coefficients, uniqueness, from_disk, to_disk, rows, inverse_rows, velocity })
    }

    /// Whether a contact may have several solutions by the force `F x` that stick needs and the square of its gauge.
    pub(super) fn may_have_several(&self, x: Pair<f64>, gauge: f64) -> bool {
        self.uniqueness.may_fail(&(self.from_disk * V::from(x)), gauge.sqrt())
    }

    /// The state of a stepper, after the one of this lane before if it has made a step since.
    pub(super) fn state_of(
        &self,
        stepper: &Stepper<'_>,
        before: Option<&State<f64>>,
    ) -> State<f64> {
        let known = stepper.remembered();
        let scaled = self.from_disk.transpose();
        let (q, u) = (V::from_column_slice(stepper.q()), V::from_column_slice(stepper.u()));
        let slips = known.phase == Phase::Slip;
        let position = pair_of(&(scaled * (self.rows * q)));
        let velocity = pair_of(&(scaled * (self.rows * u + self.velocity)));
        let change = match before {
            Some(before) if slips && before.slips > 0.0 => {
                [0, 1].map(|i| velocity[i] - before.velocity[i])
            }
            _ => [0.0; 2],
        };
        let slip = pair_of(&(scaled * V::new(known.slip[0], known.slip[1])));
        let slips = f64::from(u8::from(slips));
        State { position, velocity, slip, change, bend: [0.0; 2], slips }
    }

    /// Coordinates and velocities.
    pub(super) fn motion(&self, state: &State<f64>) -> (V, V) {
        let unscaled = self.to_disk.transpose();
        let q = self.inverse_rows * (unscaled * V::from(state.position));
        let u = self.inverse_rows * (unscaled * V::from(state.velocity) - self.velocity);
        (q, u)
    }

    /// Hands a state after so many steps over to the stepper.
    pub(super) fn hand_over(&self, state: &State<f64>, steps: usize, stepper: &mut Stepper<'_>) {
        let (q, u) = self.motion(state);
        let slip = self.to_disk.transpose() * V::from(state.slip);
        let phase = if state.slips > 0.0 { Phase::Slip } else { Phase::Stick };
        let known = ContactState::new(phase, [slip.x, slip.y, 0.0]);
        stepper.go_on_from(steps, q.as_slice(), u.as_slice(), known);
    }
}
