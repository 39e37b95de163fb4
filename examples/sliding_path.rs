//! A disk sliding on ground steel (Walker & Leine 2019, Fig. 27): the path bends towards the grooves.
//!
//! Run: cargo run --release -p asperity --example sliding_path

use asperity::law::FrictionLaw;
use asperity::set::{Convex, Superellipse, Vector};
use asperity::simulate::{Options, simulate};
use asperity::system::sliding_point;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    // Table 1: forces at a normal load of 9.3 N, the first axis across the grooves.
    let reservoir = Superellipse::new(Vector::<2>::new(4.99 / 9.3, 4.25 / 9.3), 2.94)?;
    let direction = Convex::try_from(Superellipse::new(Vector::<2>::new(1.84, 1.19), 2.51)?)?;
    let law = FrictionLaw::new(reservoir.into(), direction)?;
    let disk = sliding_point(0.018, law, 9.81)?;
    let (sine, cosine) = 32f64.to_radians().sin_cos();
    let options = Options::new(1e-4, 1.0)?.with_start(&[0.0; 2], &[1.52 * cosine, 1.52 * sine]);
    let options = options.with_save_every(10).until_rest();
    let run = simulate(&disk, &options)?;
    let path = &run.trajectory.samples;
    let end = path.state(path.len() - 1);
    let (x, y) = (end.q[0], end.q[1]);
    println!("{:?} after {:.4} s", run.outcome, end.t);
    println!("end point {:.3} mm across, {:.3} mm along the grooves", 1e3 * x, 1e3 * y);
    println!("deflection {:.3} mm", 1e3 * (y * cosine - x * sine));
    println!("{} samples, {} ambiguous steps", path.len(), run.trajectory.ambiguous_steps);
    // The converged end point.
    assert!((x - 0.165_171_6).hypot(y - 0.140_954_7) < 5e-5);
    Ok(())
}
