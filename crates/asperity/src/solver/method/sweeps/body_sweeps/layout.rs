//! Bodies and contacts as arrays.

use std::ops::Range;

use super::super::super::cones::{Cones, own_rows};
use super::bodies::{Bodies, Order, VELOCITIES};
use crate::contact::{ContactProblem, Delassus, Factored};
use crate::law::ContactMatrix;
use crate::vectors::dot;

/// Contacts of a group, which are visited side by side: with eight a sweep takes 1.4 times as long, as the velocities of
/// their bodies do not fit the registers of AVX2.
pub(super) const LANES: usize = 4;
/// Most rows of a contact: with drilling friction there are four.
pub(super) const ROWS: usize = 3;
/// Difference of `K` and `T⁻ᵀ` relative to their size that is rounding: the operator of the cones is symmetric then.
const SYMMETRIC: f64 = 1e-12;
/// Largest ratio of the eigenvalues of `Ĝ_TT` of a contact, to which inertia and friction contribute, beyond which one step with
/// the larger one is too short for the other: columns with 1240 contacts whose friction is elliptic with a ratio of 2, 3 and 10
/// of the axes, four, nine and a hundred of the eigenvalues, take 1.5, 2.1 and 7 times as many sweeps as over the blocks of
/// `G`, which solve each contact.
const ELONGATED: f64 = 3.0;

/// A number for each of the contacts of a group.
pub(super) type Lanes = [f64; LANES];
/// `P̂` of the contacts of a group, row by row.
pub(super) type Percussions = [Lanes; ROWS];

/// Contacts that share no body.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Group {
    /// The bodies of every contact; the ground where it has none.
    pub(super) bodies: [[u32; 2]; LANES],
    /// `K Wᵀ L⁻ᵀ`: of each of two bodies, row by row, velocity by velocity; zero where there are none.
    pub(super) directions: [[[Lanes; VELOCITIES]; ROWS]; 2],
    /// `K (b + e γ_B)`.
    pub(super) loads: Percussions,
    /// `1/Ĝ_NN` and `1/g_T`, zero where there is no contact.
    pub(super) normal_step: Lanes,
    pub(super) tangential_step: Lanes,
    /// `Ĝ_TN`.
    pub(super) coupling: [Lanes; ROWS - 1],
}

impl Group {
    /// Of contacts that touch the ground only.
    fn empty(ground: u32) -> Self {
        Self {
            bodies: [[ground; 2]; LANES],
            directions: [[[[0.0; LANES]; VELOCITIES]; ROWS]; 2],
            loads: [[0.0; LANES]; ROWS],
            normal_step: [0.0; LANES],
            tangential_step: [0.0; LANES],
            coupling: [[0.0; LANES]; ROWS - 1],
        }
    }
}

/// A contact problem of bodies.
#[derive(Debug, Clone, Default)]
pub(super) struct Layout {
    bodies: usize,
    groups: Vec<Group>,
    /// The contact in every lane of every group.
    members: Vec<[Option<usize>; LANES]>,
    /// The groups of every colour.
    colours: Vec<Range<usize>>,
}

impl Layout {
    /// Reads a problem; false if some contact is not one between two bodies at most, or its friction has no symmetric cone in
    /// the plane, or its mobilities in the plane differ too much.
    pub(super) fn read(&mut self, problem: &ContactProblem, cones: &Cones) -> bool {
        let Delassus::Factored(factored) = problem.delassus() else { return false };
        [Order::FirstToLast, Order::LastToFirst].into_iter().any(|order| {
            let Some(bodies) = Bodies::of(problem, factored, order) else { return false };
            let contacts = (0..problem.contacts().len())
                .map(|i| Contact::of(problem, i, cones, factored, &bodies))
                .collect::<Option<Vec<Contact>>>();
            let Some(contacts) = contacts else { return false };
            self.bodies = bodies.count();
            self.arrange(&contacts);
            true
        })
    }

    /// Gives every contact the first colour that none of its bodies has, and puts those of a colour into groups.
    fn arrange(&mut self, contacts: &[Contact]) {
        const COLOURS: usize = u128::BITS as usize;
        let Self { bodies, groups, members, colours } = self;
        let ground = *bodies as u32;
        let mut taken = vec![0_u128; *bodies];
        let mut of_colour = vec![Vec::new(); COLOURS + 1];
        for (i, contact) in contacts.iter().enumerate() {
            let own = || contact.bodies.iter().filter(|&&body| body != ground);
            let met = own().fold(0, |met, &body| met | taken[body as usize]);
            let colour = met.trailing_ones() as usize;
            if colour < COLOURS {
                own().for_each(|&body| taken[body as usize] |= 1 << colour);
            }
            of_colour[colour].push(i);
        }
        groups.clear();
        members.clear();
        colours.clear();
        for (colour, own) in of_colour.iter().enumerate().filter(|(_, own)| !own.is_empty()) {
            // What is left of bodies with more contacts than there are colours may share them.
            let first = groups.len();
            let together = if colour < COLOURS { LANES } else { 1 };
            for chunk in own.chunks(together) {
                let mut group = Group::empty(ground);
                let mut member = [None; LANES];
                for (lane, &i) in chunk.iter().enumerate() {
                    contacts[i].write(&mut group, lane);
                    member[lane] = Some(i);
                }
                groups.push(group);
                members.push(member);
            }
            colours.push(first..groups.len());
        }
    }

    /// Number of bodies.
    pub(super) fn bodies(&self) -> usize {
        self.bodies
    }

    /// The groups of every colour.
    pub(super) fn colours(&self) -> &[Range<usize>] {
        &self.colours
    }

    /// All groups, colour by colour.
    pub(super) fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// Percussions in the coordinates of the cones, group by group.
    pub(super) fn pack(
        &self,
        problem: &ContactProblem,
        cones: &Cones,
        percussion: &[f64],
        packed: &mut Vec<Percussions>,
    ) {
        packed.clear();
        for members in &self.members {
            let mut group = [[0.0; LANES]; ROWS];
            for (lane, i) in members.iter().enumerate() {
                let Some(i) = *i else { continue };
                let rows = problem.contacts()[i].rows();
                let own = cones.t[i] * own_rows(percussion, rows.start, rows.len());
                for (row, value) in group.iter_mut().zip(own.iter()) {
                    row[lane] = *value;
                }
            }
            packed.push(group);
        }
    }

    /// The percussions of such coordinates.
    pub(super) fn unpack(
        &self,
        problem: &ContactProblem,
        cones: &Cones,
        packed: &[Percussions],
        percussion: &mut [f64],
    ) {
        for (members, group) in self.members.iter().zip(packed) {
            for (lane, i) in members.iter().enumerate() {
                let Some(i) = *i else { continue };
                let rows = problem.contacts()[i].rows();
                let own = group.map(|row| row[lane]);
                let own = cones.t_inverse[i] * own_rows(&own, 0, ROWS);
                percussion[rows.clone()].copy_from_slice(&own.as_slice()[..rows.len()]);
            }
        }
    }
}

/// A contact in the coordinates of its cone.
struct Contact {
    bodies: [u32; 2],
    directions: [[[f64; VELOCITIES]; ROWS]; 2],
    loads: [f64; ROWS],
}

impl Contact {
    /// Nothing if it touches more than two bodies, has too many rows, no symmetric cone or too different mobilities.
    fn of(
        problem: &ContactProblem,
        i: usize,
        cones: &Cones,
        factored: &Factored,
        bodies: &Bodies,
    ) -> Option<Self> {
        let (rows, k) = (problem.contacts()[i].rows(), &cones.k[i]);
        let apart: ContactMatrix = k - cones.t_inverse[i].transpose();
        if rows.len() > ROWS || apart.amax() > SYMMETRIC * k.amax() {
            return None;
        }
        let ground = bodies.count() as u32;
        let mut touched = [ground; 2];
        let mut plain = [[[0.0; VELOCITIES]; ROWS]; 2];
        for (row, at) in rows.clone().enumerate() {
            let (velocities, values) = factored.directions().row(at);
            for (&velocity, value) in velocities.iter().zip(values) {
                let (body, place) = bodies.of_velocity[velocity];
                let side = touched.iter().position(|known| *known == body || *known == ground)?;
                touched[side] = body;
                plain[side][row][place] = *value;
            }
        }
        let loads = k
            * (own_rows(problem.free_velocity(), rows.start, rows.len())
                + own_rows(problem.restitution(), rows.start, rows.len()));
        let mut directions = [[[0.0; VELOCITIES]; ROWS]; 2];
        for ((body, plain), directions) in touched.iter().zip(&plain).zip(&mut directions) {
            for (row, direction) in directions.iter_mut().enumerate() {
                let in_cone = std::array::from_fn(|place| {
                    plain.iter().enumerate().map(|(j, plain)| k[(row, j)] * plain[place]).sum()
                });
                *direction = bodies.divided(*body, in_cone);
            }
        }
        let loads = [0, 1, 2].map(|row| loads[row]);
        let contact = Self { bodies: touched, directions, loads };
        let [smallest, largest] = contact.tangential();
        (rows.len() < ROWS || largest <= ELONGATED * smallest).then_some(contact)
    }

    /// Entry of its own block of `Ĝ`.
    fn own(&self, a: usize, b: usize) -> f64 {
        self.directions.iter().map(|own| dot(&own[a], &own[b])).sum()
    }

    /// The eigenvalues of `Ĝ_TT`, the smaller one first; of one direction zero and its own.
    fn tangential(&self) -> [f64; 2] {
        let mean = 0.5 * (self.own(1, 1) + self.own(2, 2));
        let apart = (0.5 * (self.own(1, 1) - self.own(2, 2))).hypot(self.own(1, 2));
        [mean - apart, mean + apart]
    }

    /// Writes it into a lane of a group.
    fn write(&self, group: &mut Group, lane: usize) {
        let [_, largest] = self.tangential();
        // What has no mobility keeps its percussion.
        let step = |g: f64| if g > 0.0 { 1.0 / g } else { 0.0 };
        group.bodies[lane] = self.bodies;
        let rows = self.directions.as_flattened().as_flattened();
        let lanes = group.directions.as_flattened_mut().as_flattened_mut();
        lanes.iter_mut().zip(rows).for_each(|(to, from)| to[lane] = *from);
        for (row, load) in group.loads.iter_mut().zip(self.loads) {
            row[lane] = load;
        }
        group.normal_step[lane] = step(self.own(0, 0));
        group.tangential_step[lane] = step(largest);
        for (j, row) in group.coupling.iter_mut().enumerate() {
            row[lane] = self.own(1 + j, 0);
        }
    }
}
