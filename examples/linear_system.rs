//! A linear system with two contacts: a guide with prescribed normal force (p = 1) and a floor with a
//! gap (p = 2). A block falls onto the floor and slides to rest.
//!
//! Run: cargo run --release -p asperity --example linear_system

use asperity::contact::Phase;
use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Vector};
use asperity::simulate::{Options, simulate};
use asperity::system::{Contact, LinearSystem};
use nalgebra::DMatrix;
use std::error::Error;

const MASS: f64 = 2.0;
const GRAVITY: f64 = 9.81;
const HEIGHT: f64 = 0.05;

fn main() -> Result<(), Box<dyn Error>> {
    // Coordinates x, y, z. The guide rubs against motions along x with 0.1 · 5 N.
    let guide = Contact::with_force(
        FrictionLaw::<1>::isotropic(0.1)?,
        DMatrix::from_column_slice(3, 1, &[1.0, 0.0, 0.0]),
        5.0,
    );
    let ellipse: Convex<2> = Ellipse::new(Vector::<2>::new(0.5, 0.3))?.into();
    let floor = Contact::unilateral(
        FrictionLaw::associated(ellipse),
        DMatrix::identity(3, 2),
        vec![0.0, 0.0, 1.0],
        0.0,
    );
    let zero = DMatrix::zeros(3, 3);
    let block = LinearSystem::new(
        DMatrix::identity(3, 3) * MASS,
        zero.clone(),
        zero,
        vec![0.0, 0.0, -MASS * GRAVITY],
        vec![guide, floor],
    )?;
    let options = Options::new(1e-4, 1.0)?.with_start(&[0.0, 0.0, HEIGHT], &[1.0, 0.5, 0.0]);
    let run = simulate(&block, &options)?;
    let path = &run.trajectory.samples;
    let last = path.len() - 1;
    // Contact 1 is the floor.
    let first = |phase: Phase| {
        (1..=last).find(|&k| path.contact(k, 1).phase == phase).ok_or("this phase never came")
    };
    let (landing, rest) = (path.t[first(Phase::Slip)?], path.t[first(Phase::Stick)?]);
    let (normal_force, end) = (path.contact(last, 1).normal_force, path.state(last));
    println!("{:?}: lands at {landing:.4} s, rests at {rest:.4} s", run.outcome);
    println!("at x = {:.5} m, y = {:.5} m", end.q[0], end.q[1]);
    println!("the floor carries {normal_force:.6} N");
    assert!((landing - (2.0 * HEIGHT / GRAVITY).sqrt()).abs() < 3.0 * options.dt);
    assert!((normal_force - MASS * GRAVITY).abs() < 1e-9);
    Ok(())
}
