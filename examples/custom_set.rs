//! An own star-shaped set as force reservoir: three lobes, so that friction depends on the sense of
//! sliding (r_C(θ) ≠ r_C(θ + π)), which no ellipse can say.
//!
//! Run: cargo run --release -p asperity --example custom_set

use std::error::Error;
use std::sync::Arc;

use asperity::law::FrictionLaw;
use asperity::set::{CustomStar, Star, StarSet, Vector};
use asperity::simulate::{Options, simulate};
use asperity::system::sliding_point;

const GRAVITY: f64 = 9.81;

/// `r_C(θ) = mean (1 + waviness cos 3θ)`.
#[derive(Debug)]
struct Lobes {
    mean: f64,
    waviness: f64,
}

impl StarSet<2> for Lobes {
    fn gauge(&self, x: &Vector<2>) -> f64 {
        let angle = x.y.atan2(x.x);
        x.norm() / (self.mean * (1.0 + self.waviness * (3.0 * angle).cos()))
    }
}

/// Distance that a point mass slides with 1 m/s at the start.
fn distance(law: FrictionLaw<2>, direction: f64) -> Result<f64, Box<dyn Error>> {
    let point = sliding_point(1.0, law, GRAVITY)?;
    let options = Options::new(1e-4, 2.0)?.with_start(&[0.0; 2], &[direction, 0.0]);
    let options = options.with_save_every(20_000).until_rest();
    let run = simulate(&point, &options)?;
    let path = &run.trajectory.samples;
    let end = path.state(path.len() - 1);
    Ok(end.q[0].hypot(end.q[1]))
}

fn main() -> Result<(), Box<dyn Error>> {
    let lobes = Star::Custom(CustomStar(Arc::new(Lobes { mean: 0.3, waviness: 0.2 })));
    // Collinear: friction opposes sliding, and its size is the reservoir's radius.
    let law = FrictionLaw::<2>::collinear(lobes.clone())?;
    println!("radius of D, the largest disk inside C: {:.6}", law.direction_scale());
    let mut distances = [0.0; 2];
    for (sense, reached) in [1.0, -1.0].into_iter().zip(&mut distances) {
        let force = law.force(&Vector::<2>::new(sense, 0.0), 1.0)?;
        *reached = distance(FrictionLaw::<2>::collinear(lobes.clone())?, sense)?;
        println!(
            "sliding along {sense:+}: friction {:.3}, stops after {reached:.5} m",
            force.norm()
        );
        // v²/(2 μ g) with the coefficient of this direction.
        assert!((*reached - 0.5 / (force.norm() * GRAVITY)).abs() < 1e-5);
    }
    assert!((distances[1] / distances[0] - 1.5).abs() < 1e-3);
    Ok(())
}
