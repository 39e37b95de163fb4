//! A disk of PVC slides on ground steel until it rests, [WL19] Fig. 27; then a set by itself.

use asperity::law::FrictionLaw;
use asperity::set::{Convex, Superellipse, Vector};
use asperity::simulate::{Options, simulate};
use asperity::system::sliding_point;
use asperity_set::{ConvexSet, Ellipse};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let reservoir = Superellipse::new(Vector::<2>::new(4.99 / 9.3, 4.25 / 9.3), 2.94)?;
    let direction = Convex::try_from(Superellipse::new(Vector::<2>::new(1.84, 1.19), 2.51)?)?;
    let law = FrictionLaw::new(reservoir.into(), direction)?;
    let disk = sliding_point(0.018, law, 9.81)?;
    let (sine, cosine) = 32f64.to_radians().sin_cos();
    let options = Options::new(1e-4, 1.0)?.with_start(&[0.0; 2], &[1.52 * cosine, 1.52 * sine]);
    let run = simulate(&disk, &options.until_rest())?;
    let path = &run.trajectory.samples;
    let end = path.state(path.len() - 1).q;
    println!("the disk rests at {end:?} m");
    assert!((end[0] - 0.16517).abs() < 5e-5 && (end[1] - 0.14095).abs() < 5e-5);

    let ellipse = Ellipse::new(Vector::<2>::new(3.0, 1.0))?;
    assert_eq!(ellipse.support(&Vector::<2>::new(1.0, 0.0)), 3.0);
    Ok(())
}
