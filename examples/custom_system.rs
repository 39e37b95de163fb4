//! An own `System`: a puck slides freely on an anisotropic plane, in polar coordinates, where mass
//! matrix, forces and contact directions depend on the configuration.
//!
//! Run: cargo run --release -p asperity --example custom_system

use std::error::Error;

use asperity::contact::NormalForce;
use asperity::law::FrictionLaw;
use asperity::set::{Convex, Ellipse, Vector};
use asperity::simulate::{Options, simulate};
use asperity::system::{Blocks, Configuration, ContactLaw, System, SystemError};

/// A puck of 1 kg; coordinates (r, φ).
#[derive(Debug)]
struct Puck {
    blocks: Blocks,
    contact: ContactLaw,
}

impl System for Puck {
    fn blocks(&self) -> &Blocks {
        &self.blocks
    }

    fn contacts(&self) -> &[ContactLaw] {
        std::slice::from_ref(&self.contact)
    }

    fn mass(&self, q: &[f64], _block: usize, mass: &mut [f64]) -> Result<(), SystemError> {
        mass.copy_from_slice(&[1.0, 0.0, 0.0, q[0] * q[0]]);
        Ok(())
    }

    fn forces(&self, at: &Configuration<'_>, u: &[f64], h: &mut [f64]) -> Result<(), SystemError> {
        h[0] = at.q[0] * u[1] * u[1];
        h[1] = -2.0 * at.q[0] * u[0] * u[1];
        Ok(())
    }

    fn rows(
        &self,
        at: &Configuration<'_>,
        _contact: usize,
        rows: &mut [f64],
        velocity: &mut [f64],
    ) -> Result<f64, SystemError> {
        let (r, (sine, cosine)) = (at.q[0], at.q[1].sin_cos());
        // Row by row: ẋ, then ẏ, by ṙ and φ̇.
        rows.copy_from_slice(&[cosine, -r * sine, sine, r * cosine]);
        velocity.fill(0.0);
        Ok(0.0)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let ellipse: Convex<2> = Ellipse::new(Vector::<2>::new(0.4, 0.3))?.into();
    let contact = ContactLaw::new(FrictionLaw::associated(ellipse), NormalForce::Prescribed(9.81))?;
    let options = Options::new(1e-4, 0.3)?.with_start(&[1.0, 0.0], &[1.0, 1.0]);
    let last_only = options.steps;
    let options = options.with_save_every(last_only);
    let run = simulate(&Puck { blocks: Blocks::one(2), contact }, &options)?;
    // The slip of the last sample: the velocity in Cartesian coordinates, (1, 1) m/s at the start.
    let path = &run.trajectory.samples;
    let slip = path.contact(path.len() - 1, 0).slip;
    let (v1, v2) = (slip[0], slip[1]);
    println!("velocity ({v1:.6}, {v2:.6}) m/s");
    // Free sliding under an associated ellipse keeps |v₁/v₁₀| = |v₂/v₂₀|^((a/b)²).
    assert!((v1 - v2.powf(16.0 / 9.0)).abs() < 1e-3);
    Ok(())
}
