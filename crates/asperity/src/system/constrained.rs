//! How bilateral constraints hold a system within a step: joints of rigid bodies, and those that a system gives itself.
//!
//! A step leads from a state that constraints allow to another one. With `J` their rows and `g` what they are off,
//!
//! `q_M = q_B ⊕ (½Δt u_B + M⁻¹J_Mᵀκ)`, `q_E = q_M ⊕ (½Δt u_E + M⁻¹J_Mᵀμ)`, `g(q_M) = g(q_E) = 0`,
//! `u_E = u_B + M⁻¹(Δt h + W P + J_MᵀΛ)`, `J_E u_E = 0`
//!
//! with `κ`, `μ` and `Λ` found by Newton's method with `J_M`. That reads the same backwards but for what acts explicitly: it is
//! of second order, and energy does not drift where forces have a potential. Percussions of contacts act in velocities that
//! constraints let pass ([`Held`]).

use nalgebra::DMatrix;

use super::held::Held;
use super::mass::MassFactors;
use super::{Configuration, Midpoint, Step, System, SystemError, full_rows};
use crate::argument::{entries, refuse};
use crate::contact::LARGEST;

/// Relative defect up to which a start meets the constraints, and up to which a row all but repeats others.
const MET: f64 = 1e-9;
/// Relative defects that are rounding, and that are where rounding of more than one term lets none smaller be found.
const ROUNDED: f64 = 4.0 * f64::EPSILON;
const UNFOUND: f64 = 1e-12;
/// Iterations, each of which leaves a part of the order of `Δt‖Ω‖`.
const MOST_ITERATIONS: usize = 60;
/// Steps of differences in parts of the coordinates: rounding makes them off by up to this part of a row. The finer one is for
/// constraints that bend within the other.
const STEP: f64 = 1e-6;
const FINE: f64 = 1e-9;
/// Rounds in which velocities and accelerations in the middle of a step follow from each other.
const ROUNDS: usize = 3;

/// Coordinates, velocities and momenta.
pub(crate) type End = [Vec<f64>; 3];

/// What holds a system.
pub(crate) trait Constraints {
    /// The system that they hold.
    fn system(&self) -> &dyn System;

    /// Whether rows and masses are the same everywhere.
    fn are_constant(&self) -> bool {
        false
    }

    /// What they hold at these coordinates.
    fn held(&self, t: f64, q: &[f64]) -> Result<Vec<Held>, SystemError>;

    /// What they are off, in the order of [`held`](Self::held).
    fn defects(&self, q: &[f64]) -> Result<Vec<f64>, SystemError>;

    /// The rates of defects, likewise.
    fn rates(&self, q: &[f64], u: &[f64]) -> Result<Vec<f64>, SystemError>;

    /// Coordinates, velocities and momenta at the end of a step after velocities `after`, as constraints hold the former.
    fn end(&self, midpoint: &Midpoint, after: &[f64], half: f64) -> Result<End, SystemError>;

    /// What the user calls the constraint of a row.
    fn name(&self, row: usize) -> String;

    /// The error where they are not held.
    fn lost(&self, time: f64) -> SystemError;
}

/// Constraints that a system gives itself.
pub(super) struct Own<'a>(pub(super) &'a dyn System);

impl Own<'_> {
    fn rows(&self, q: &[f64]) -> Result<Vec<f64>, SystemError> {
        let mut rows = vec![0.0; self.0.constraints() * self.0.dof()];
        self.0.constraint_rows(q, &mut rows)?;
        Ok(rows)
    }

    /// How large the coordinates are that each velocity changes: those below 1 m or 1 rad count as that large, as what they follow
    /// from may be.
    fn extents(&self, q: &[f64]) -> Vec<f64> {
        let largest = q.iter().fold(0.0_f64, |largest, q| largest.max(q.abs()));
        let at = |k: usize| 1.0 + if q.len() == self.0.dof() { q[k].abs() } else { largest };
        (0..self.0.dof()).map(at).collect()
    }

    /// Refuses rows that are not the rates of what they hold, as differences along each velocity tell: those of neither step.
    pub(super) fn check_rows(&self, q: &[f64]) -> Result<(), SystemError> {
        if self.are_constant() {
            return Ok(());
        }
        let (rows, extents) = (self.rows(q)?, self.extents(q));
        for (k, extent) in extents.iter().enumerate() {
            let [fine, coarse] =
                [self.slopes(q, k, FINE * extent)?, self.slopes(q, k, STEP * extent)?];
            for (i, row) in rows.chunks_exact(extents.len()).enumerate() {
                let size: f64 = row.iter().zip(&extents).map(|(j, at)| j.abs() * at).sum();
                let is_off = |(slope, doubt): (f64, f64)| {
                    let rounding = STEP * f64::max(size / extent, slope.abs());
                    (row[k] - slope).abs() > doubt + rounding
                };
                if is_off(fine[i]) && is_off(coarse[i]) {
                    let message = format!(
                        "must be the rates of constraint, has {:.6e} in row {i} for velocity {k}, where differences of constraint give {:.6e}",
                        row[k], coarse[i].0
                    );
                    return Ok(refuse("constraint_rows", message)?);
                }
            }
        }
        Ok(())
    }

    /// Differences of all constraints along a velocity, and by how much they may be off: what they change by with their step and
    /// their side.
    fn slopes(&self, q: &[f64], k: usize, step: f64) -> Result<Vec<(f64, f64)>, SystemError> {
        let (mut way, mut there) = (vec![0.0; self.0.dof()], q.to_vec());
        let mut off = |steps| {
            way[k] = steps;
            self.0.advance(q, &way, step, &mut there);
            self.defects(&there)
        };
        let [far, back, here] = [off(-2.0)?, off(-1.0)?, off(0.0)?];
        let [ahead, farther] = [off(1.0)?, off(2.0)?];
        let slope = |i: usize| {
            let slope = (ahead[i] - back[i]) / (2.0 * step);
            let change = slope - (farther[i] - far[i]) / (4.0 * step);
            let bend = (ahead[i] - 2.0 * here[i] + back[i]) / step;
            (slope, change.abs() + bend.abs())
        };
        Ok((0..here.len()).map(slope).collect())
    }
}

impl Constraints for Own<'_> {
    fn system(&self) -> &dyn System {
        self.0
    }

    fn are_constant(&self) -> bool {
        self.0.as_linear().is_some()
    }

    fn held(&self, t: f64, q: &[f64]) -> Result<Vec<Held>, SystemError> {
        let (system, rows) = (self.0, self.rows(q)?);
        let (count, n) = (system.constraints(), system.dof());
        let mut mass = MassFactors::default();
        mass.update(system, t, q)?;
        let mut responses = rows.clone();
        responses.chunks_exact_mut(n).for_each(|row| mass.solve_block(system, 0, row));
        let extents = self.extents(q);
        let size = |row: &[f64]| row.iter().zip(&extents).map(|(j, at)| j.abs() * at).sum();
        let sizes = rows.chunks_exact(n).map(size).collect();
        let rows = DMatrix::from_row_slice(count, n, &rows);
        let responses = DMatrix::from_column_slice(n, count, &responses);
        Ok(vec![Held::new(0, 0..n, &rows, &responses, sizes)])
    }

    fn defects(&self, q: &[f64]) -> Result<Vec<f64>, SystemError> {
        let mut off = vec![0.0; self.0.constraints()];
        self.0.constraint(q, &mut off)?;
        Ok(off)
    }

    fn rates(&self, q: &[f64], u: &[f64]) -> Result<Vec<f64>, SystemError> {
        let rate = |row: &[f64]| row.iter().zip(u).map(|(j, u)| j * u).sum();
        Ok(self.rows(q)?.chunks_exact(u.len()).map(rate).collect())
    }

    fn end(&self, midpoint: &Midpoint, after: &[f64], half: f64) -> Result<End, SystemError> {
        let Midpoint { t, q: from, held, .. } = midpoint;
        let (mut q, mut u) = (from.clone(), after.to_vec());
        arrive(self, *t, held, (from, &mut u, half), &mut q, |_, _| {})?;
        Ok([q, u, Vec::new()])
    }

    fn name(&self, row: usize) -> String {
        format!("constraint {row}")
    }

    fn lost(&self, time: f64) -> SystemError {
        SystemError::Constraints { time }
    }
}

/// Refuses a state that constraints do not allow, or leave in half a step: at rest, velocities are rounding of a step.
pub(super) fn check(
    constraints: &impl Constraints,
    q: &[f64],
    u: &[f64],
    half: f64,
) -> Result<(), SystemError> {
    let (held, defects) = (constraints.held(0.0, q)?, constraints.defects(q)?);
    let (sizes, rates) = (held.iter().flat_map(|held| &held.sizes), constraints.rates(q, u)?);
    for (row, ((off, rate), size)) in defects.into_iter().zip(rates).zip(sizes).enumerate() {
        let within = |value: f64| value.abs() <= MET * size;
        let name = || constraints.name(row);
        if !within(off) {
            let message =
                format!("coordinates that {} allows, is off by {off:.3e} m or rad", name());
            return Ok(refuse("q0", format!("must be {message}"))?);
        }
        if !within(half * rate) {
            let name = name();
            let message =
                format!("velocities that {name} lets pass, is off by {rate:.3e} m/s or rad/s");
            return Ok(refuse("u0", format!("must be {message}"))?);
        }
    }
    Ok(())
}

/// Changes velocities `x` along forces of constraints until the rates that are `off` are rounding in a time.
fn settle(
    constraints: &(impl Constraints + ?Sized),
    (t, time): (f64, f64),
    held: &[Held],
    x: &mut [f64],
    mut off: impl FnMut(&[f64]) -> Result<Vec<f64>, SystemError>,
) -> Result<(), SystemError> {
    let mut last = f64::INFINITY;
    for _ in 0..MOST_ITERATIONS {
        let off = off(x)?;
        let bound = |held: &Held, k| if held.keeps(k) { 1.0 } else { ROUNDED / MET };
        let scale =
            |held: &Held, k: usize| time * bound(held, k) / held.sizes[k].max(f64::MIN_POSITIVE);
        let scales = held.iter().flat_map(|held| (0..held.count).map(move |k| scale(held, k)));
        let worst = off
            .iter()
            .zip(scales)
            .map(|(off, scale)| off.abs() * scale)
            .fold(0.0, |worst: f64, one| if one > worst || one.is_nan() { one } else { worst });
        if worst <= ROUNDED || worst <= UNFOUND && worst > 0.5 * last {
            return Ok(());
        }
        last = worst;
        let mut rest = &off[..];
        for held in held {
            let (own, others) = rest.split_at(held.count);
            held.take(own, &mut x[held.velocities.clone()]);
            rest = others;
        }
    }
    Err(constraints.lost(t))
}

/// `q ⊕ half u`, moved along forces of constraints to where they hold; `follow` brings `u` up to date with where that is.
pub(super) fn arrive(
    constraints: &(impl Constraints + ?Sized),
    t: f64,
    held: &[Held],
    (q, u, half): (&[f64], &mut [f64], f64),
    out: &mut [f64],
    follow: impl Fn(&[f64], &mut [f64]),
) -> Result<(), SystemError> {
    let mut aside = vec![0.0; u.len()];
    settle(constraints, (t, half), held, &mut aside, |aside| {
        let way: Vec<f64> = aside.iter().zip(&*u).map(|(aside, u)| aside + u).collect();
        constraints.system().advance(q, &way, half, out);
        // The comparison also turns away NaN. What constraints are off there would be none.
        if !out.iter().all(|q| q.abs() <= LARGEST) {
            return Err(constraints.lost(t));
        }
        follow(out, u);
        let mut off = constraints.defects(out)?;
        off.iter_mut().for_each(|off| *off /= half);
        Ok(off)
    })
}

/// The first half of a step: coordinates at the midpoint, and what is held there.
pub(super) fn begin(
    constraints: &impl Constraints,
    step: &Step<'_>,
    mid: &mut [f64],
    held: &mut Vec<Held>,
) -> Result<(), SystemError> {
    let &Step { midpoint: t, dt, q, u } = step;
    let mut rates = u.to_vec();
    let constant = constraints.are_constant();
    // Along forces of constraints as they are before the step, then as they are where that leads.
    for k in 0..if constant { 1 } else { 3 } {
        if !constant || held.is_empty() {
            *held = constraints.held(t, if k == 0 { q } else { mid })?;
        }
        arrive(constraints, t, held, (q, &mut rates, 0.5 * dt), mid, |_, _| {})?;
    }
    Ok(())
}

/// Changes velocities at the midpoint by forces of constraints so that they let those at the end of the step pass.
pub(super) fn hold(
    constraints: &impl Constraints,
    midpoint: &Midpoint,
    after: &mut [f64],
    half: f64,
) -> Result<(), SystemError> {
    settle(constraints, (midpoint.t, half), &midpoint.held, after, |after| {
        let [q, u, _] = constraints.end(midpoint, after, half)?;
        constraints.rates(&q, &u)
    })
}

/// Forces in N or N m of all rows in the middle of a step of length `dt` that ends in a state at `t`, and the coordinates there.
/// `contacts` are the forces of all rows of contacts. Rows that repeat others transmit nothing.
pub(super) fn reactions(
    constraints: &impl Constraints,
    (t, dt): (f64, f64),
    (q, u): (&[f64], &[f64]),
    contacts: &[f64],
) -> Result<(Vec<f64>, Vec<f64>), SystemError> {
    let system = constraints.system();
    let (half, n) = (0.5 * dt, system.dof());
    entries("q", q, system.coordinates())?;
    entries("u", u, n)?;
    let moved = |from: &[f64], u: &[f64], time: f64| {
        let mut out = from.to_vec();
        system.advance(from, u, time, &mut out);
        out
    };
    let middle = moved(q, u, -half);
    let at = Configuration::new(t - half, &middle);
    let (mut pushed, mut rest) = (vec![0.0; n], contacts.iter());
    for (contact, len) in system.contacts().iter().map(|law| law.rows()).enumerate() {
        let (mut rows, mut velocity) = (vec![0.0; len * n], vec![0.0; len]);
        full_rows(system, &at, contact, &mut rows, &mut velocity)?;
        for (row, force) in rows.chunks_exact(n).zip(&mut rest) {
            pushed.iter_mut().zip(row).for_each(|(pushed, w)| *pushed += w * force);
        }
    }
    let (mut mass, mut speeds, mut forces) = (MassFactors::default(), u.to_vec(), Vec::new());
    mass.update(system, t, &middle)?;
    let held = constraints.held(t, &middle)?;
    for _ in 0..ROUNDS {
        let mut accelerations = vec![0.0; n];
        system.forces(&at, &speeds, &mut accelerations)?;
        accelerations.iter_mut().zip(&pushed).for_each(|(h, pushed)| *h += pushed);
        mass.solve(system, &mut accelerations);
        // What J u would change by without joints.
        let ahead = constraints.rates(&moved(&middle, &speeds, half), &speeds)?;
        let behind = constraints.rates(&moved(&middle, &speeds, -half), &speeds)?;
        let mut off = constraints.rates(&middle, &accelerations)?;
        for (off, (ahead, behind)) in off.iter_mut().zip(ahead.iter().zip(&behind)) {
            *off += (ahead - behind) / dt;
        }
        forces.clear();
        for held in &held {
            let own = &off[forces.len()..forces.len() + held.count];
            forces.extend(held.reactions(own));
            held.take(own, &mut accelerations[held.velocities.clone()]);
        }
        let back = speeds.iter_mut().zip(u).zip(&accelerations);
        back.for_each(|((speed, u), a)| *speed = u - half * a);
    }
    Ok((forces, middle))
}

/// Forces in N or N m of the constraints that a system gives itself, [`System::constraint`], in the middle of a step of length `dt` that
/// ends in a state at `t`: one per row of `J`, and `JᵀΛ` acts. `contacts` are the forces of all rows of contacts. Rows that repeat
/// others transmit nothing.
///
/// # Errors
///
/// [`SystemError::Argument`] unless the state has the coordinates and velocities of the system.
pub fn constraint_forces(
    system: &dyn System,
    times: (f64, f64),
    state: (&[f64], &[f64]),
    contacts: &[f64],
) -> Result<Vec<f64>, SystemError> {
    Ok(reactions(&Own(system), times, state, contacts)?.0)
}
