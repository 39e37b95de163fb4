//! Runs of rigid bodies.

use asperity::law::FrictionLaw;
use asperity::solver::{Solver, Status};
pub use asperity::stepper::State;
use asperity::stepper::Stepper;
use asperity::system::System;
use asperity::system::rigid::{Pair, Plane, RigidBodies, Shape};

pub const G: f64 = 9.81;

pub const EXACT: Solver = Solver::Exact { max_sweeps: 2000 };

/// The line `y = 0`.
pub fn ground() -> Plane {
    Plane::line([0.0; 2], [0.0, 1.0])
}

/// Isotropic friction of planar systems.
pub fn line(mu: f64) -> FrictionLaw<1> {
    FrictionLaw::isotropic(mu).unwrap()
}

/// Isotropic friction in space.
pub fn disk(mu: f64) -> FrictionLaw<2> {
    FrictionLaw::isotropic(mu).unwrap()
}

/// A ball that rolls on a plane, about the body's origin.
pub fn sphere(body: usize, radius: f64, plane: Plane) -> Shape {
    Shape::SpherePlane { body, centre: [0.0; 3], radius, plane }
}

pub fn restituting(pair: Pair, normal: f64, tangential: f64) -> Pair {
    Pair { normal_restitution: normal, tangential_restitution: tangential, ..pair }
}

/// A scheme that starts in the bodies' initial state.
pub fn stepper(system: &RigidBodies, dt: f64) -> Stepper<'_> {
    Stepper::new(system, EXACT, 1e-12, dt, &State::new(0.0, system.q0(), system.u0())).unwrap()
}

/// Steps until `t_end` and shows every state; every contact problem must be solved.
pub fn run(system: &RigidBodies, dt: f64, t_end: f64, mut see: impl FnMut(&Stepper<'_>)) -> State {
    let mut stepper = stepper(system, dt);
    run_on(&mut stepper, t_end, &mut see);
    State::new(0.0, stepper.q(), stepper.u())
}

/// Goes on until `t_end`.
pub fn run_on(stepper: &mut Stepper<'_>, t_end: f64, see: &mut dyn FnMut(&Stepper<'_>)) {
    while stepper.time() < t_end - 1e-12 {
        let report = stepper.step().unwrap();
        let t = stepper.time();
        assert_eq!(report.status, Status::Converged, "{report:?} at t = {t}");
        see(stepper);
    }
}

/// The observed order of convergence: errors at `dt` and `dt/2`.
pub fn order(errors: [f64; 2]) -> f64 {
    (errors[0] / errors[1]).log2()
}

/// Kinetic and potential energy.
pub fn energy(system: &RigidBodies, q: &[f64], u: &[f64]) -> f64 {
    assert_eq!(q.len(), system.coordinates());
    system.kinetic_energy(u).unwrap() + system.potential_energy(0.0, q).unwrap()
}
