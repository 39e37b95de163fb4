//! From a system to the constants of its step, and between its states and those of lanes.

use std::ops::RangeInclusive;

use asperity_set::{Convex, Form, Matrix, Star, StarSet, Vector};

use super::ellipses::Ellipses;
use super::kernel::{Coefficients, State};
use super::superellipses::Superellipses;
use super::vector::Pair;
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
/// Largest condition of the maps of both sets to their unit disks.
const LARGEST_CONDITION: f64 = 1e3;
/// Exponents of superellipses that lanes take: beyond, in nearly rectangular sets, Newton's method often finds no slip.
const EXPONENTS: RangeInclusive<f64> = 1.1..=20.0;

/// A run in a lane.
pub(super) struct Plan<'a> {
    pub(super) coefficients: Coefficients<f64>,
    /// Whether both sets are ellipses, whose equation has no powers.
    pub(super) of_ellipses: bool,
    ellipses: Ellipses<f64>,
    superellipses: Superellipses<f64>,
    reservoir: &'a Convex<2>,
    uniqueness: Uniqueness<'a>,
    /// `F`, which maps the unit disk of a norm to *D*, and `Wᵀ`, with their inverses.
    from_disk: M,
    to_disk: M,
    rows: M,
    inverse_rows: M,
    /// χ.
    velocity: V,
}

/// A set as the image of the unit disk `{z : Σ|zᵢ|^s ≤ 1}`.
struct Image {
    from_disk: M,
    to_disk: M,
    exponent: f64,
}

impl Image {
    /// Nothing of a set that is none, or one that lanes do not take.
    fn new(set: &dyn StarSet<2>) -> Option<Self> {
        let image = match set.form() {
            Form::Ellipsoid { from_ball, to_ball } => {
                Self { from_disk: from_ball, to_disk: to_ball, exponent: 2.0 }
            }
            Form::Powers { lower, upper, reciprocal } if lower == upper => Self {
                from_disk: M::from_diagonal(&upper),
                to_disk: M::from_diagonal(&upper.map(f64::recip)),
                exponent: reciprocal.recip(),
            },
            Form::Image { of, map } => {
                let Self { from_disk, to_disk, exponent } = Self::new(of)?;
                let (from_disk, to_disk) = (map * from_disk, to_disk * map.try_inverse()?);
                Self { from_disk, to_disk, exponent }
            }
            _ => return None,
        };
        let condition = image.from_disk.norm() * image.to_disk.norm();
        (condition <= LARGEST_CONDITION && EXPONENTS.contains(&image.exponent)).then_some(image)
    }

    /// The largest Euclidean norm of a point of the unit disk.
    fn largest_norm(&self) -> f64 {
        f64::max(1.0, 2f64.powf(0.5 - 1.0 / self.exponent))
    }

    /// A map under which no image has a norm less than the gauge.
    fn bound(&self) -> M {
        self.to_disk * f64::max(1.0, 2f64.powf(1.0 / self.exponent - 0.5))
    }
}

/// The ends of an interval of gauges, which may be empty.
fn ends((low, high): (f64, f64)) -> Pair<f64> {
    if low <= high { [low.max(0.0), high] } else { [f64::INFINITY, 0.0] }
}

fn rows_of(matrix: &M) -> [Pair<f64>; 2] {
    [[matrix.m11, matrix.m12], [matrix.m21, matrix.m22]]
}

fn pair_of(v: &V) -> Pair<f64> {
    [v.x, v.y]
}

/// The sets as ellipses.
pub(super) fn ellipses<'p>(plan: &'p Plan<'_>) -> &'p Ellipses<f64> {
    &plan.ellipses
}

/// The sets as superellipses.
pub(super) fn superellipses<'p>(plan: &'p Plan<'_>) -> &'p Superellipses<f64> {
    &plan.superellipses
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
        let of_reservoir = Image::new(reservoir)?;
        let Image { from_disk, to_disk, exponent } = Image::new(law.direction())?;
        let uniqueness = Uniqueness::new(stepper.problem(), law, &of_reservoir.bound())?;
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
        let to_reservoir = of_reservoir.to_disk * from_disk;
        let gauge = to_reservoir.transpose() * to_reservoir;
        // The smallest eigenvalue is det Γ/tr Γ at least.
        let largest_radius =
            of_reservoir.largest_norm() * (gauge.trace() / gauge.determinant()).sqrt();
        let coefficients = Coefficients {
            half: 0.5 * dt,
            belt: pair_of(&belt),
            by_position: rows_of(&by_position),
            by_velocity: rows_of(&by_velocity),
            constant: pair_of(&constant),
            resistance: rows_of(&resistance),
            compliance: rows_of(&resistance.try_inverse()?),
            strongest: resistance.norm() * largest_radius,
            doubtful: ends(uniqueness.doubtful),
        };
        Some(Self {
            coefficients,
            of_ellipses: exponent == 2.0 && of_reservoir.exponent == 2.0,
            ellipses: Ellipses { gauge: [gauge.m11, gauge.m12, gauge.m22] },
            superellipses: Superellipses::new(
                exponent,
                of_reservoir.exponent,
                rows_of(&to_reservoir),
            ),
            reservoir,
            uniqueness,
            from_disk,
            to_disk,
            rows,
            inverse_rows,
            velocity,
        })
    }

    /// Whether a contact may have several solutions by the force `F x` of stick; narrows the gauges that are in doubt.
    pub(super) fn may_have_several(&mut self, x: Pair<f64>) -> bool {
        let load = self.from_disk * V::from(x);
        let several = self.uniqueness.may_have_several(&load, self.reservoir.gauge(&load));
        self.coefficients.doubtful = ends(self.uniqueness.doubtful);
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
