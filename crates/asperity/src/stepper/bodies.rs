//! From rigid bodies at the midpoint to the contact problem and back, body by body: a contact touches at
//! most two bodies and meets the other contacts of these only. Nothing is larger than the contacts or
//! the bodies are many.

use nalgebra::Vector3;

use super::closed::{Change, Closed};
use super::meetings::Meetings;
use super::rated::Factors;
use crate::contact::{BlockMatrix, Delassus};
use crate::system::rigid::{Pose, RigidBodies, Twist};

/// Bodies and closed contacts at the midpoint.
#[derive(Debug)]
pub(super) struct BodyAssembly {
    q_mid: Vec<f64>,
    poses: Vec<Pose>,
    /// Velocities at the midpoint before the step, and without contact forces.
    before: Vec<Twist>,
    free: Vec<Twist>,
    /// Angular momenta in the world's axes.
    spins: Vec<Vector3<f64>>,
    contacts: Vec<Partners>,
    /// `W_Nᵀ`, `Wᵀ` row by row, and `M⁻¹W` with the factors of the speed, for the first bodies.
    own: Rows,
    /// The same for the second bodies where there are any.
    others: Rows,
    chi: Vec<f64>,
    /// Velocities before the step, row by row, where they are needed.
    slip: Vec<f64>,
    factors: Factors,
}

/// The bodies of a closed contact.
#[derive(Debug, Clone, Copy)]
struct Partners {
    body: usize,
    /// The second body, and the contact's first row among those of second bodies.
    other: Option<(usize, usize)>,
    /// First row, and number of rows.
    row: usize,
    len: usize,
}

#[derive(Debug, Default)]
struct Rows {
    directions: Vec<Twist>,
    responses: Vec<Twist>,
}

/// The rows of one contact for one of its bodies.
struct Side<'a> {
    directions: &'a [Twist],
    responses: &'a [Twist],
}

impl Rows {
    #[inline]
    fn side(&self, first: usize, len: usize) -> Side<'_> {
        let own = first..first + len;
        Side { directions: &self.directions[own.clone()], responses: &self.responses[own] }
    }

    fn resize(&mut self, rows: usize) {
        // Not a number differs from everything, so that all rows count as changed.
        let blank = Twist::repeat(f64::NAN);
        for list in [&mut self.directions, &mut self.responses] {
            list.clear();
            list.resize(rows, blank);
        }
    }

    /// Takes new directions; whether they differ from the old ones.
    #[inline]
    fn store(&mut self, first: usize, new: &[Twist]) -> bool {
        let old = &mut self.directions[first..first + new.len()];
        let changed = old != new;
        if changed {
            old.copy_from_slice(new);
        }
        changed
    }
}

impl BodyAssembly {
    pub(super) fn new(bodies: &RigidBodies, q: &[f64], u: &[f64]) -> Self {
        let count = bodies.bodies();
        Self {
            q_mid: q.to_vec(),
            poses: (0..count).map(|body| bodies.pose(q, body)).collect(),
            spins: (0..count).map(|body| bodies.spin(q, u, body)).collect(),
            before: vec![Twist::zeros(); count],
            free: vec![Twist::zeros(); count],
            contacts: Vec::new(),
            own: Rows::default(),
            others: Rows::default(),
            chi: Vec::new(),
            slip: Vec::new(),
            factors: Factors::default(),
        }
    }

    /// The contact problem of the step from `q`, `u`.
    pub(super) fn update(
        &mut self,
        bodies: &RigidBodies,
        dt: f64,
        (q, u): (&[f64], &[f64]),
        closed: &mut Closed,
    ) -> Change {
        bodies.midpoint((q, u), dt, &mut self.q_mid, &mut self.poses);
        bodies.free_twists(&self.poses, (u, &self.spins), dt, &mut self.before, &mut self.free);
        self.find_closed(bodies, dt, closed);
        let same_contacts = closed.ready && closed.found == closed.active;
        if !same_contacts {
            self.renew(bodies, dt, closed);
        }
        let turned = self.refresh(bodies, dt, closed);
        self.load(closed);
        let changed = turned || self.factors.any();
        if changed {
            self.factors.update(&closed.problem, |row| self.slip[row]);
            self.fill(bodies, closed);
        }
        match (same_contacts, changed) {
            (false, _) => Change::Contacts,
            (true, true) => Change::Operator,
            (true, false) => Change::None,
        }
    }

    /// A contact is closed where its gap has vanished, or has but for rounding and the solver's
    /// tolerance: a millionth of the way that the contact forces have to make up for in a step is none.
    fn find_closed(&self, bodies: &RigidBodies, dt: f64, closed: &mut Closed) {
        closed.found.clear();
        for (contact, law) in bodies.contact_laws().iter().enumerate() {
            let touches = law.normal_force.is_some() || {
                let (gap, point) = bodies.gap_at(&self.poses, contact);
                gap <= 0.0 || {
                    let (body, other) = bodies.partners(contact);
                    let drift = |body| self.drift(body, &point);
                    gap <= 1e-6 * dt * (drift(body) + other.map_or(0.0, drift))
                }
            };
            if touches {
                closed.found.push(contact);
            }
        }
    }

    /// Speed that a point of a body gains in the step from other than contact forces, at the most.
    fn drift(&self, body: usize, point: &Vector3<f64>) -> f64 {
        let change = self.free[body] - self.before[body];
        let lever = (point - self.poses[body].position).norm();
        let part = |first| change.fixed_rows::<3>(first).norm();
        part(0) + part(3) * lever
    }

    /// Rows and blocks for a new set of closed contacts.
    fn renew(&mut self, bodies: &RigidBodies, dt: f64, closed: &mut Closed) {
        let meetings = Meetings::new(bodies, &closed.found);
        closed.renew(bodies.contact_laws(), dt, |contacts| meetings.delassus(bodies, contacts));
        let mut other_rows = 0;
        self.contacts.clear();
        for (rows, &contact) in closed.problem.contacts.iter().zip(&closed.active) {
            let (body, other) = bodies.partners(contact);
            let (row, len) = (rows.offset, rows.len());
            let other = other.map(|other| (other, other_rows));
            other_rows += other.map_or(0, |_| len);
            self.contacts.push(Partners { body, other, row, len });
        }
        let rows = closed.problem.rows();
        self.own.resize(rows);
        self.others.resize(other_rows);
        self.chi.resize(rows, 0.0);
        self.slip.resize(rows, 0.0);
        self.factors.reset(&closed.problem);
    }

    /// Brings the rows up to date; whether any has changed.
    ///
    /// A contact that counts as closed above a small gap may close it until the next midpoint: else
    /// resting contacts would creep open within the tolerance of the solver.
    fn refresh(&mut self, bodies: &RigidBodies, dt: f64, closed: &Closed) -> bool {
        let mut changed = false;
        for (partners, &contact) in self.contacts.iter().zip(&closed.active) {
            let Partners { other, row, len, .. } = *partners;
            let (mut own, mut others) = ([Twist::zeros(); 4], [Twist::zeros(); 4]);
            let chi = &mut self.chi[row..row + len];
            let rows = (own.as_mut_slice(), others.as_mut_slice());
            let gap = bodies.contact_rows(&self.poses, contact, rows, chi);
            if gap > 0.0 && bodies.contact_laws()[contact].normal_force.is_none() {
                chi[0] = gap / dt;
            }
            changed |= self.own.store(row, &own[..len]);
            if let Some((_, first)) = other {
                changed |= self.others.store(first, &others[..len]);
            }
        }
        changed
    }

    /// Free velocities and restitution terms.
    fn load(&mut self, closed: &mut Closed) {
        self.velocities(&self.free, &mut closed.problem.free_velocity);
        if closed.bounces() || self.factors.any() {
            let mut slip = std::mem::take(&mut self.slip);
            self.velocities(&self.before, &mut slip);
            closed.bounce(|row| slip[row]);
            self.slip = slip;
        }
    }

    /// `γ = Wᵀu + χ` of all rows.
    fn velocities(&self, twists: &[Twist], out: &mut [f64]) {
        for &Partners { body, other, row, len } in &self.contacts {
            let (u, chi) = (&twists[body], &self.chi[row..row + len]);
            let rows = self.own.directions[row..row + len].iter().zip(chi);
            let out = &mut out[row..row + len];
            for (out, (direction, chi)) in out.iter_mut().zip(rows) {
                *out = direction.dot(u) + chi;
            }
            if let Some((other, first)) = other {
                let rows = &self.others.directions[first..first + len];
                for (out, direction) in out.iter_mut().zip(rows) {
                    *out += direction.dot(&twists[other]);
                }
            }
        }
    }

    /// `M⁻¹W`, scaled by the factors of the speed, and the blocks of the Delassus operator.
    fn fill(&mut self, bodies: &RigidBodies, closed: &mut Closed) {
        for &Partners { body, other, row, len } in &self.contacts {
            for k in 0..len {
                let factor = self.factors.of(row + k);
                let response = bodies.response(body, &self.own.directions[row + k]);
                self.own.responses[row + k] = response * factor;
                if let Some((other, first)) = other {
                    let response = bodies.response(other, &self.others.directions[first + k]);
                    self.others.responses[first + k] = response * factor;
                }
            }
        }
        match &mut closed.problem.delassus {
            Delassus::Blocks(blocks) => self.fill_blocks(blocks),
            Delassus::Factored(factored) => {
                let (_, directions, blocks) = factored.parts_mut();
                self.fill_directions(bodies, directions);
                self.fill_blocks(blocks);
            }
            _ => {}
        }
        closed.problem.update_rho();
    }

    fn fill_blocks(&self, blocks: &mut BlockMatrix) {
        for (i, contact) in self.contacts.iter().enumerate() {
            for k in 0..blocks.neighbours(i).len() {
                let (j, block) = blocks.block_mut(i, k);
                self.fill_block(contact, &self.contacts[j], block);
            }
        }
    }

    /// The entries of `Wᵀ`, row by row, the body with the lower number first.
    fn fill_directions(&self, bodies: &RigidBodies, directions: &mut [f64]) {
        let n = bodies.velocities_per_body();
        let mut entries = directions.chunks_exact_mut(n);
        for contact in &self.contacts {
            let swapped = contact.other.is_some_and(|(other, _)| other < contact.body);
            for k in 0..contact.len {
                let own = &self.own.directions[contact.row + k];
                let other = contact.other.map(|(_, first)| &self.others.directions[first + k]);
                let (first, second) = if swapped { (other, Some(own)) } else { (Some(own), other) };
                for row in first.into_iter().chain(second) {
                    if let Some(entries) = entries.next() {
                        bodies.set_twist(entries, 0, row);
                    }
                }
            }
        }
    }

    /// `G_ij`: what the percussions of one contact do to the velocities of another, over the bodies that
    /// both touch.
    #[inline]
    fn fill_block(&self, i: &Partners, j: &Partners, block: &mut [f64]) {
        block.fill(0.0);
        for (body, rows) in self.sides(i) {
            for (_, columns) in self.sides(j).filter(|side| side.0 == body) {
                for (a, row) in rows.directions.iter().enumerate() {
                    for (b, column) in columns.responses.iter().enumerate() {
                        block[a * j.len + b] += row.dot(column);
                    }
                }
            }
        }
    }

    /// The bodies of a contact with its rows for them.
    #[inline]
    fn sides(&self, contact: &Partners) -> impl Iterator<Item = (usize, Side<'_>)> {
        let Partners { body, other, row, len } = *contact;
        let other = other.map(|(body, first)| (body, self.others.side(first, len)));
        std::iter::once((body, self.own.side(row, len))).chain(other)
    }

    /// Factor of the friction percussion of a row.
    #[inline]
    pub(super) fn factor(&self, row: usize) -> f64 {
        self.factors.of(row)
    }

    /// Coordinates and velocities at the end of the step, from the percussions.
    pub(super) fn finish(
        &mut self,
        bodies: &RigidBodies,
        percussion: &[f64],
        dt: f64,
        (q, u): (&mut [f64], &mut [f64]),
    ) {
        for &Partners { body, other, row, len } in &self.contacts {
            for (k, &p) in percussion[row..row + len].iter().enumerate() {
                self.free[body] += self.own.responses[row + k] * p;
                if let Some((other, first)) = other {
                    self.free[other] += self.others.responses[first + k] * p;
                }
            }
        }
        let (mid, twists) = ((&*self.q_mid, &*self.poses), (&*self.before, &*self.free));
        bodies.finish(mid, twists, &mut self.spins, 0.5 * dt, (q, u));
    }
}
