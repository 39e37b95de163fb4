//! Sweeps over groups of contacts.
//!
//! What is inlined into `call` is compiled for wide registers where the processor has them. There is no fused product and
//! sum, so that all processors find the same percussions.

use std::ops::Range;

use super::bodies::VELOCITIES;
use super::layout::{Group, LANES, Lanes, Percussions, ROWS};

/// The velocities of a body, as many as a line of the cache holds.
#[derive(Debug, Clone, Copy, Default)]
#[repr(align(64))]
pub(super) struct Velocities([f64; 8]);

/// The velocities that percussions bring.
pub(super) struct Brought<'a> {
    pub(super) groups: &'a [Group],
    pub(super) percussions: &'a [Percussions],
    /// Of all bodies and of the ground, zero at first.
    pub(super) velocities: &'a mut [Velocities],
}

impl Brought<'_> {
    pub(super) fn run(self) {
        pulp::Arch::new().dispatch(self);
    }
}

impl pulp::NullaryFnOnce for Brought<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { groups, percussions, velocities } = self;
        for (group, own) in groups.iter().zip(percussions) {
            for body in 0..2 {
                let mut side = gather(group, body, velocities);
                bring(group, body, own, &mut side);
                scatter(group, body, &side, velocities);
            }
        }
    }
}

/// One sweep.
pub(super) struct Sweep<'a> {
    pub(super) groups: &'a [Group],
    /// Groups of colours in their order.
    pub(super) colours: &'a [Range<usize>],
    /// Over-relaxation `ω`.
    pub(super) relaxation: f64,
    pub(super) percussions: &'a mut [Percussions],
    /// Those that the percussions bring.
    pub(super) velocities: &'a mut [Velocities],
}

impl Sweep<'_> {
    /// Colour by colour.
    pub(super) fn run(self) {
        pulp::Arch::new().dispatch(self);
    }
}

impl pulp::NullaryFnOnce for Sweep<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { groups, colours, relaxation, percussions, velocities } = self;
        for colour in colours {
            let own = percussions[colour.clone()].iter_mut();
            for (group, own) in groups[colour.clone()].iter().zip(own) {
                visit(group, relaxation, own, velocities);
            }
        }
    }
}

/// Visits the contacts of a group.
#[inline(always)]
fn visit(group: &Group, relaxation: f64, own: &mut Percussions, velocities: &mut [Velocities]) {
    let mut sides = [gather(group, 0, velocities), gather(group, 1, velocities)];
    let mut xi = group.loads;
    for (directions, side) in group.directions.iter().zip(&sides) {
        for (xi, direction) in xi.iter_mut().zip(directions) {
            for (entries, velocity) in direction.iter().zip(side) {
                for lane in 0..LANES {
                    xi[lane] += entries[lane] * velocity[lane];
                }
            }
        }
    }
    let change = project(group, relaxation, &xi, own);
    for (body, side) in sides.iter_mut().enumerate() {
        bring(group, body, &change, side);
        scatter(group, body, side, velocities);
    }
}

/// Velocities of the first or second body of every contact.
#[inline(always)]
fn gather(group: &Group, body: usize, velocities: &[Velocities]) -> [Lanes; VELOCITIES] {
    let mut gathered = [[0.0; LANES]; VELOCITIES];
    for (lane, bodies) in group.bodies.iter().enumerate() {
        let own = &velocities[bodies[body] as usize].0;
        gathered.iter_mut().zip(own).for_each(|(to, from)| to[lane] = *from);
    }
    gathered
}

/// Writes them back.
#[inline(always)]
fn scatter(
    group: &Group,
    body: usize,
    gathered: &[Lanes; VELOCITIES],
    velocities: &mut [Velocities],
) {
    for (lane, bodies) in group.bodies.iter().enumerate() {
        let own = &mut velocities[bodies[body] as usize].0;
        own.iter_mut().zip(gathered).for_each(|(to, from)| *to = from[lane]);
    }
}

/// Adds what percussions bring to the velocities of the first or second body of every contact.
#[inline(always)]
fn bring(
    group: &Group,
    body: usize,
    percussions: &Percussions,
    velocities: &mut [Lanes; VELOCITIES],
) {
    let [normal, first, second] = &group.directions[body];
    for (k, velocity) in velocities.iter_mut().enumerate() {
        for lane in 0..LANES {
            velocity[lane] += normal[k][lane] * percussions[0][lane]
                + first[k][lane] * percussions[1][lane]
                + second[k][lane] * percussions[2][lane];
        }
    }
}

/// Projects percussions, and returns by how much they have changed. One loop for each line, as only short ones become
/// operations on registers.
#[inline(always)]
fn project(group: &Group, relaxation: f64, xi: &Percussions, own: &mut Percussions) -> Percussions {
    let before = *own;
    let Group { normal_step, tangential_step, coupling, .. } = group;
    let mut change = [[0.0; LANES]; ROWS];
    for lane in 0..LANES {
        let free = before[0][lane] - relaxation * normal_step[lane] * xi[0][lane];
        own[0][lane] = if free > 0.0 { free } else { 0.0 };
        change[0][lane] = own[0][lane] - before[0][lane];
    }
    for row in 1..ROWS {
        for lane in 0..LANES {
            let velocity = xi[row][lane] + coupling[row - 1][lane] * change[0][lane];
            own[row][lane] = before[row][lane] - relaxation * tangential_step[lane] * velocity;
        }
    }
    let mut share = [0.0; LANES];
    for lane in 0..LANES {
        let square = own[1][lane] * own[1][lane] + own[2][lane] * own[2][lane];
        let ratio = own[0][lane] / (square + f64::MIN_POSITIVE).sqrt();
        share[lane] = if ratio < 1.0 { ratio } else { 1.0 };
    }
    for row in 1..ROWS {
        for lane in 0..LANES {
            own[row][lane] *= share[lane];
            change[row][lane] = own[row][lane] - before[row][lane];
        }
    }
    change
}
