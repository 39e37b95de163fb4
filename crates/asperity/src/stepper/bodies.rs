//! From rigid bodies at the midpoint to the contact problem and back, body by body: a contact touches at
//! most two bodies and meets the other contacts of these only. Nothing is larger than the contacts or
//! the bodies are many.

use nalgebra::Vector3;

use super::closed::{Change, Closed};
use super::meetings::Meetings;
use super::rated::Factors;
use crate::contact::{BlockMatrix, Delassus};
use crate::system::rigid::{Contact, Middle, Pose, RigidBodies, Twist};

/// Bodies and closed contacts at the midpoint.
#[derive(Debug)]
pub(super) struct BodyAssembly {
    middle: Middle,
    /// Angular momenta in the world's axes.
    spins: Vec<Vector3<f64>>,
    contacts: Vec<Partners>,
    /// `W_Nᵀ`, `Wᵀ` row by row, and `M⁻¹W` with the factors of the speed, for the first bodies.
    own: Rows,
    /// The same for the second bodies where there are any.
    others: Rows,
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
    /// Bodies in a state; `momenta` are their angular momenta where they do not follow from it.
    pub(super) fn new(bodies: &RigidBodies, q: &[f64], u: &[f64], momenta: &[[f64; 3]]) -> Self {
        let count = bodies.bodies();
        let spin = |body: usize| match momenta.get(body) {
            Some(&momentum) => momentum.into(),
            None => bodies.spin(q, u, body),
        };
        Self {
            middle: Middle {
                q: q.to_vec(),
                poses: (0..count).map(|body| bodies.pose(q, body)).collect(),
                before: vec![Twist::zeros(); count],
                free: vec![Twist::zeros(); count],
            },
            spins: (0..count).map(spin).collect(),
            contacts: Vec::new(),
            own: Rows::default(),
            others: Rows::default(),
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
        bodies.start((q, u, &self.spins), dt, &mut self.middle);
        let (same_contacts, mut changed) = self.scan(bodies, dt, closed);
        if !same_contacts {
            self.renew(bodies, dt, closed);
            changed = true;
        }
        if self.factors.any() {
            self.factors.update(&closed.problem, |row| self.slip[row]);
            changed = true;
        }
        if changed {
            self.fill(bodies, closed);
        }
        if closed.bounces() {
            closed.bounce(|row| self.slip[row]);
        }
        match (same_contacts, changed) {
            (false, _) => Change::Contacts,
            (true, true) => Change::Operator,
            (true, false) => Change::None,
        }
    }

    /// Finds the closed contacts and brings their rows up to date, in one pass while they are those of the
    /// last step; whether they are, and whether rows have changed.
    ///
    /// A contact is closed where its gap has vanished, or has but for rounding and the solver's
    /// tolerance: a millionth of the way that the contact forces have to make up for in a step is none.
    fn scan(&mut self, bodies: &RigidBodies, dt: f64, closed: &mut Closed) -> (bool, bool) {
        closed.found.clear();
        let (mut same, mut changed) = (closed.ready, false);
        for (index, contact) in bodies.possible_contacts().iter().enumerate() {
            let at = contact.gap(self.pose(contact.body), contact.other.map(|b| self.pose(b)));
            let touches = !contact.unilateral || at.0 <= 0.0 || {
                let drift = |body| self.drift(body, &at.1);
                at.0 <= 1e-6 * dt * (drift(contact.body) + contact.other.map_or(0.0, drift))
            };
            if touches {
                let place = closed.found.len();
                closed.found.push(index);
                same = same && closed.active.get(place) == Some(&index);
                if same {
                    changed |= self.refresh(contact, at, dt, place, closed);
                }
            }
        }
        (same && closed.found.len() == closed.active.len(), changed)
    }

    #[inline]
    fn pose(&self, body: usize) -> &Pose {
        &self.middle.poses[body]
    }

    /// Speed that a point of a body gains in the step from other than contact forces, at the most.
    fn drift(&self, body: usize, point: &Vector3<f64>) -> f64 {
        let change = self.middle.free[body] - self.middle.before[body];
        let lever = (point - self.pose(body).position).norm();
        let part = |first| change.fixed_rows::<3>(first).norm();
        part(0) + part(3) * lever
    }

    /// Rows and blocks for a new set of closed contacts.
    fn renew(&mut self, bodies: &RigidBodies, dt: f64, closed: &mut Closed) {
        let meetings = Meetings::new(bodies, &closed.found);
        closed.renew(bodies.contact_laws(), dt, |contacts| meetings.delassus(bodies, contacts));
        let mut other_rows = 0;
        self.contacts.clear();
        for (rows, &contact) in closed.problem.contacts().iter().zip(&closed.active) {
            let (body, other) = bodies.partners(contact);
            let (row, len) = (rows.offset, rows.len());
            let other = other.map(|other| (other, other_rows));
            other_rows += other.map_or(0, |_| len);
            self.contacts.push(Partners { body, other, row, len });
        }
        let rows = closed.problem.rows();
        self.own.resize(rows);
        self.others.resize(other_rows);
        self.slip.resize(rows, 0.0);
        self.factors.reset(&closed.problem);
        for place in 0..closed.active.len() {
            let contact = &bodies.possible_contacts()[closed.active[place]];
            let at = contact.gap(self.pose(contact.body), contact.other.map(|b| self.pose(b)));
            self.refresh(contact, at, dt, place, closed);
        }
    }

    /// Brings the rows and the velocities of a contact up to date; whether rows have changed.
    ///
    /// A contact that counts as closed above a small gap may close it until the next midpoint: else
    /// resting contacts would creep open within the tolerance of the solver.
    #[inline]
    fn refresh(
        &mut self,
        contact: &Contact,
        at: (f64, Vector3<f64>),
        dt: f64,
        place: usize,
        closed: &mut Closed,
    ) -> bool {
        let Partners { body, other, row, len } = self.contacts[place];
        let (mut own, mut others) = ([Twist::zeros(); 4], [Twist::zeros(); 4]);
        let mut chi = [0.0; 4];
        let poses = (self.pose(body), other.map(|(other, _)| self.pose(other)));
        contact.rows(at, poses, (&mut own, &mut others), &mut chi);
        if contact.unilateral {
            chi[0] = at.0.max(0.0) / dt;
        }
        let mut changed = self.own.store(row, &own[..len]);
        if let Some((_, first)) = other {
            changed |= self.others.store(first, &others[..len]);
        }
        let velocity = |twists: &[Twist], k: usize| {
            let second = other.map_or(0.0, |(other, _)| others[k].dot(&twists[other]));
            own[k].dot(&twists[body]) + second + chi[k]
        };
        for k in 0..len {
            closed.problem.free_velocity_mut()[row + k] = velocity(&self.middle.free, k);
        }
        if closed.bounces() || self.factors.any() {
            for k in 0..len {
                self.slip[row + k] = velocity(&self.middle.before, k);
            }
        }
        changed
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
        closed.problem.refill(|delassus| match delassus {
            Delassus::Blocks(blocks) => self.fill_blocks(blocks),
            Delassus::Factored(factored) => {
                let (_, directions, blocks) = factored.parts_mut();
                self.fill_directions(bodies, directions);
                self.fill_blocks(blocks);
            }
            _ => {}
        });
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

    /// Factors of the speed.
    #[inline]
    pub(super) fn factors(&mut self) -> &mut Factors {
        &mut self.factors
    }

    /// Brings the operator up to date with the factors.
    pub(super) fn rescale(&mut self, bodies: &RigidBodies, closed: &mut Closed) {
        self.fill(bodies, closed);
    }

    /// Angular momenta in the world's axes.
    pub(super) fn momenta(&self) -> impl Iterator<Item = [f64; 3]> {
        self.spins.iter().map(|&spin| spin.into())
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
                self.middle.free[body] += self.own.responses[row + k] * p;
                if let Some((other, first)) = other {
                    self.middle.free[other] += self.others.responses[first + k] * p;
                }
            }
        }
        bodies.finish(&self.middle, &mut self.spins, 0.5 * dt, (q, u));
    }
}
