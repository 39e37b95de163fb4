//! How joints hold bodies within a step.
//!
//! A step leads from a state that joints allow to another one. With `J` the rows of what they hold and `g` what it is off,
//!
//! `q_M = q_B ⊕ (½Δt u_B + M⁻¹J_Mᵀκ)`, `q_E = q_M ⊕ (½Δt u_E + M⁻¹J_Mᵀμ)`, `g(q_M) = g(q_E) = 0`,
//! `u_E = u_B + M⁻¹(Δt h + W P + J_MᵀΛ)`, `J_E u_E = 0`
//!
//! with `κ`, `μ` and `Λ` found by Newton's method with `J_M`. That reads the same backwards but for what acts explicitly: it is
//! of second order, and energy does not drift where forces have a potential. Percussions of contacts act in velocities that
//! joints let pass (`system/held.rs`). Angular momenta are stepped for all bodies with joints, as these turn them
//! besides.

use nalgebra::{DMatrix, Vector3};

use super::joint::Defect;
use super::pose::{Twist, angular, linear, twist};
use super::rigid_bodies::RigidBodies;
use crate::argument::{ArgumentError, refuse};
use crate::system::held::Held;
use crate::system::{Midpoint, System, SystemError};

/// Relative defect up to which a start meets the joints, and up to which a row all but repeats others.
const MET: f64 = 1e-9;
/// Relative defects that are rounding, and that are where rounding of more than one term lets none smaller be found.
const ROUNDED: f64 = 4.0 * f64::EPSILON;
const UNFOUND: f64 = 1e-12;
/// Iterations, each of which leaves a part of the order of `Δt‖Ω‖`.
const MOST_ITERATIONS: usize = 60;

impl RigidBodies {
    /// What joints hold at these coordinates.
    pub(super) fn held(&self, q: &[f64]) -> Vec<Held> {
        let of_block = |(block, joints): &(usize, Vec<usize>)| {
            let velocities = self.blocks.range(*block);
            let (n, first) = (velocities.len(), velocities.start / self.size);
            let (mut rows, mut responses) = (Vec::new(), Vec::new());
            for joint in joints.iter().map(|&joint| &self.joints[joint]) {
                for directions in joint.directions(|body| self.pose_of(q, body)) {
                    let (mut row, mut response) = (vec![0.0; n], vec![0.0; n]);
                    for (body, direction) in joint.bodies().zip(directions) {
                        let inertial = &self.inertial[body];
                        let speed = linear(&direction) * inertial.inverse_mass;
                        let moved = twist(&speed, &inertial.rate(&angular(&direction)));
                        self.set_twist(&mut row, body - first, &direction);
                        self.set_twist(&mut response, body - first, &moved);
                    }
                    rows.extend(row);
                    responses.extend(response);
                }
            }
            let count = rows.len() / n;
            let rows = DMatrix::from_row_slice(count, n, &rows);
            let responses = DMatrix::from_column_slice(n, count, &responses);
            Held::new(*block, velocities, &rows, &responses)
        };
        self.jointed.iter().map(of_block).collect()
    }

    /// Joints of all blocks, in the order of [`held`](Self::held).
    fn defects(&self, q: &[f64]) -> Vec<Defect> {
        let mut defects = Vec::new();
        for &joint in self.jointed.iter().flat_map(|(_, joints)| joints) {
            self.joints[joint].defects(|body| self.pose_of(q, body), &mut defects);
        }
        defects
    }

    /// The rates of defects, likewise.
    fn rates(&self, q: &[f64], u: &[f64]) -> Vec<f64> {
        let mut rates = Vec::new();
        for joint in self.jointed.iter().flat_map(|(_, joints)| joints).map(|&j| &self.joints[j]) {
            let rate = |directions: [Twist; 2]| {
                let parts = joint.bodies().zip(directions);
                parts.map(|(body, direction)| direction.dot(&self.twist(u, body))).sum::<f64>()
            };
            rates.extend(joint.directions(|body| self.pose_of(q, body)).into_iter().map(rate));
        }
        rates
    }

    /// Refuses a state that joints do not allow, or leave in half a step: at rest, velocities are rounding of a step.
    pub(super) fn check_joints(
        &self,
        q: &[f64],
        u: &[f64],
        half: f64,
    ) -> Result<(), ArgumentError> {
        let (defects, rates) = (self.defects(q), self.rates(q, u));
        let mut row = 0;
        for &joint in self.jointed.iter().flat_map(|(_, joints)| joints) {
            for (defect, rate) in
                defects[row..].iter().zip(&rates[row..]).take(self.joints[joint].rows())
            {
                let Defect { value, size } = *defect;
                if value.abs() > MET * size {
                    let message = format!(
                        "must be coordinates that joint {joint} allows, is off by {value:.3e} m or rad"
                    );
                    return refuse("q0", message);
                }
                if half * rate.abs() > MET * size {
                    let message = format!(
                        "must be velocities that joint {joint} lets pass, is off by {rate:.3e} m/s or rad/s"
                    );
                    return refuse("u0", message);
                }
            }
            row += self.joints[joint].rows();
        }
        Ok(())
    }

    /// Changes `x` along forces of joints until what is `off` is rounding.
    fn settle(
        &self,
        t: f64,
        held: &[Held],
        x: &mut [f64],
        mut off: impl FnMut(&[f64]) -> Result<Vec<Defect>, SystemError>,
    ) -> Result<(), SystemError> {
        let mut last = f64::INFINITY;
        for _ in 0..MOST_ITERATIONS {
            let defects = off(x)?;
            let bound = |held: &Held, k| if held.keeps(k) { 1.0 } else { ROUNDED / MET };
            let bounds = held.iter().flat_map(|held| (0..held.count).map(move |k| bound(held, k)));
            let relative =
                defects.iter().zip(bounds).map(|(d, bound)| bound * d.value.abs() / d.size);
            let worst = relative
                .fold(0.0, |worst: f64, one| if one > worst || one.is_nan() { one } else { worst });
            if worst <= ROUNDED || worst <= UNFOUND && worst > 0.5 * last {
                return Ok(());
            }
            last = worst;
            let values: Vec<f64> = defects.iter().map(|defect| defect.value).collect();
            let mut rest = &values[..];
            for held in held {
                let (own, others) = rest.split_at(held.count);
                held.take(own, &mut x[held.velocities.clone()]);
                rest = others;
            }
        }
        Err(SystemError::Joints { time: t })
    }

    /// `q ⊕ half u`, moved along forces of joints to where they hold; `follow` brings `u` up to date with where that is.
    pub(super) fn arrive(
        &self,
        t: f64,
        held: &[Held],
        (q, u, half): (&[f64], &mut [f64], f64),
        out: &mut [f64],
        follow: impl Fn(&[f64], &mut [f64]),
    ) -> Result<(), SystemError> {
        let mut aside = vec![0.0; u.len()];
        self.settle(t, held, &mut aside, |aside| {
            let way: Vec<f64> = aside.iter().zip(&*u).map(|(aside, u)| aside + half * u).collect();
            self.advance(q, &way, 1.0, out);
            follow(out, u);
            Ok(self.defects(out))
        })
    }

    /// Coordinates, velocities and angular momenta at the end of a step, as joints hold the former.
    pub(super) fn end(
        &self,
        midpoint: &Midpoint,
        after: &[f64],
        half: f64,
    ) -> Result<[Vec<f64>; 3], SystemError> {
        let at = midpoint.configuration();
        let (mut q, mut ends, mut spins) = (midpoint.q.clone(), after.to_vec(), Vec::new());
        for (&body, momentum) in self.unequal.iter().zip(midpoint.momenta.chunks_exact(3)) {
            let own = self.twist(after, body);
            let omega = self.end_rate(body, &angular(&own), half)?;
            self.set_twist(&mut ends, body, &twist(&linear(&own), &omega));
            let gained = angular(&own) - angular(&self.twist(&midpoint.before, body));
            let change = self.pose_at(&at, body).rotation * (self.inertial[body].inertia * gained);
            spins.extend_from_slice((Vector3::from_column_slice(momentum) + change).as_slice());
        }
        let Midpoint { t, q: from, held, .. } = midpoint;
        self.arrive(*t, held, (from, &mut ends, half), &mut q, |q, u| {
            for (&body, spin) in self.unequal.iter().zip(spins.chunks_exact(3)) {
                let spin = self.pose_of(q, body).rotation.tr_mul(&Vector3::from_column_slice(spin));
                let omega = self.inertial[body].rate(&spin);
                self.set_twist(u, body, &twist(&linear(&self.twist(u, body)), &omega));
            }
        })?;
        Ok([q, ends, spins])
    }

    /// Changes velocities at the midpoint by forces of joints so that they let those at the end of the step pass.
    pub(super) fn hold_velocities(
        &self,
        midpoint: &Midpoint,
        after: &mut [f64],
        half: f64,
    ) -> Result<(), SystemError> {
        self.settle(midpoint.t, &midpoint.held, after, |after| {
            let [q, u, _] = self.end(midpoint, after, half)?;
            let rates = self.rates(&q, &u).into_iter().zip(self.defects(&q));
            Ok(rates.map(|(value, at)| Defect { value, size: at.size / half }).collect())
        })
    }
}
