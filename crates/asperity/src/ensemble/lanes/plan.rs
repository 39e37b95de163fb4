//! From a system to the constants of its step, and between its states and those of lanes.

use asperity_set::{Convex, Form, Matrix, Star, StarSet, Vector};

use super::kernel::{Coefficients, Pair, State};
use crate::contact::{ContactState, Phase};
use crate::integrator::midpoint::Stepper;
use crate::law::Law;
use crate::simulate::Options;
use crate::solver::{Solver, Uniqueness};
use crate::system::{System, linear::PlanarMotion};

type V = Vector<2>;
type M = Matrix<2>;

/// The least tolerance of steps: slip is found in the coordinates in which *D* is a disk up to a relative defect of some
/// 10⁻¹⁵, which the map to them may magnify by its condition.
const LEAST_TOLERANCE: f64 = 1e-11;
/// Largest condition of the maps of both sets to the unit disk.
const LARGEST_CONDITION: f64 = 1e3;

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

/// The maps of the unit disk to an ellipse and back.
fn maps_of(set: &Convex<2>) -> Option<(M, M)> {
    match set.form() {
        Form::Ellipsoid { from_ball, to_ball }
            if from_ball.norm() * to_ball.norm() <= LARGEST_CONDITION =>
        {
            Some((from_ball, to_ball))
        }
        _ => None,
    }
}

/// The squares of the ends of an interval of gauges, which may be empty.
fn squares((low, high): (f64, f64)) -> Pair<f64> {
    if low <= high { [low.max(0.0).powi(2), high.powi(2)] } else { [f64::INFINITY, 0.0] }
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
        let ((_, to_reservoir), (from_disk, to_disk)) =
            (maps_of(reservoir)?, maps_of(law.direction())?);
        let uniqueness = Uniqueness::new(stepper.problem(), law, &to_reservoir)?;
        let (dt, rows) = (options.dt, direction.transpose());
        let (inverse_rows, response) = (rows.try_inverse()?, mass.try_inverse()? * dt);
        // γ with all forces but friction, as a function of Wᵀq and γ: u = W⁻ᵀ(γ − χ).
        let scaled = from_disk.transpose();
        let (into, back) = (scaled * rows, inverse_rows * to_disk.transpose());
        let (by_position, by_velocity) =
            (into * response * stiffness * back, M::identity() + into * response * damping * back);
        let belt = scaled * velocity;
        let constant = into * response * force + belt - by_velocity * belt;
        let delassus = M::from_fn(|i, j| stepper.problem().delassus().own(0, i, j));
        let resistance = scaled * delassus * from_disk * normal;
        let gauge = to_reservoir * from_disk;
        let gauge = gauge.transpose() * gauge;
        // The smallest eigenvalue is det Γ/tr Γ at least.
        let largest_radius = (gauge.trace() / gauge.determinant()).sqrt();
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
            doubtful: squares(uniqueness.doubtful),
        };
        Some(Self { coefficients, uniqueness, from_disk, to_disk, rows, inverse_rows, velocity })
    }

    /// Whether a contact may have several solutions by the force `F x` that stick needs and the square of its gauge. The
    /// gauges for which this is asked may be fewer afterwards.
    pub(super) fn may_have_several(&mut self, x: Pair<f64>, gauge: f64) -> bool {
        let load = self.from_disk * V::from(x);
        let several = self.uniqueness.may_have_several(&load, gauge.sqrt());
        self.coefficients.doubtful = squares(self.uniqueness.doubtful);
        several
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
