//! Bodies as blocks against all bodies as one block, and repeats.

use asperity::contact::{Delassus, Factored, NormalForce};
use asperity::stepper::Stepper;
use asperity::system::rigid::{Body, Pair, Partners, PlanarBody, Plane, RigidBodies, Shape};
use asperity::system::{
    Blocks, Configuration, Constancy, ContactLaw, Midpoint, Step, System, SystemError, Turning,
    full_rows,
};
use nalgebra::Vector3;

use crate::support::*;

/// Rigid bodies in their own blocks or in one, stepped by the midpoint rule as it stands, with or without chords.
#[derive(Debug)]
struct Plain {
    blocks: Blocks,
    bodies: RigidBodies,
    chords: bool,
}

impl Plain {
    fn is_one_block(&self) -> bool {
        self.blocks.count() == 1
    }
}

impl System for Plain {
    fn blocks(&self) -> &Blocks {
        &self.blocks
    }
    fn coordinates(&self) -> usize {
        self.bodies.coordinates()
    }
    fn advance(&self, q: &[f64], u: &[f64], dt: f64, out: &mut [f64]) {
        self.bodies.advance(q, u, dt, out);
    }
    fn contacts(&self) -> &[ContactLaw] {
        self.bodies.contacts()
    }
    fn constancy(&self) -> Constancy {
        self.bodies.constancy()
    }
    fn touched(&self, contact: usize) -> &[usize] {
        if self.is_one_block() { &[0] } else { self.bodies.touched(contact) }
    }
    fn mass(&self, q: &[f64], block: usize, mass: &mut [f64]) -> Result<(), SystemError> {
        if !self.is_one_block() {
            return self.bodies.mass(q, block, mass);
        }
        mass.fill(0.0);
        for block in 0..self.bodies.bodies() {
            let range = self.bodies.blocks().range(block);
            let mut own = vec![0.0; range.len() * range.len()];
            self.bodies.mass(q, block, &mut own)?;
            for (j, column) in own.chunks_exact(range.len()).enumerate() {
                let first = (range.start + j) * self.dof() + range.start;
                mass[first..first + range.len()].copy_from_slice(column);
            }
        }
        Ok(())
    }
    fn forces(&self, at: &Configuration<'_>, u: &[f64], h: &mut [f64]) -> Result<(), SystemError> {
        self.bodies.forces(at, u, h)
    }
    fn gap(&self, at: &Configuration<'_>, contact: usize) -> Result<f64, SystemError> {
        self.bodies.gap(at, contact)
    }
    fn rows(
        &self,
        at: &Configuration<'_>,
        contact: usize,
        rows: &mut [f64],
        chi: &mut [f64],
    ) -> Result<f64, SystemError> {
        if self.is_one_block() {
            return full_rows(&self.bodies, at, contact, rows, chi);
        }
        self.bodies.rows(at, contact, rows, chi)
    }
    fn turning(&self) -> Option<&dyn Turning> {
        self.chords.then_some(self)
    }
}

impl Turning for Plain {
    fn derive(&self, _q: &[f64], _derived: &mut Vec<f64>) {}
    fn chord(
        &self,
        midpoint: &Midpoint,
        step: &Step<'_>,
        contact: usize,
        rows: &[f64],
        correction: &mut [f64],
    ) -> bool {
        self.bodies.chord(midpoint, step, contact, rows, correction)
    }
    fn momenta(&self, q: &[f64], u: &[f64]) -> Vec<f64> {
        self.bodies.momenta(q, u)
    }
    fn has_momenta(&self, q: &[f64], u: &[f64], momenta: &[f64]) -> bool {
        self.bodies.has_momenta(q, u, momenta)
    }
    fn begin(&self, step: &Step<'_>, midpoint: &mut Midpoint) -> Result<(), SystemError> {
        self.bodies.begin(step, midpoint)
    }
    fn finish(
        &self,
        midpoint: &mut Midpoint,
        after: &[f64],
        dt: f64,
        q: &mut [f64],
        u: &mut [f64],
    ) -> Result<(), SystemError> {
        self.bodies.finish(midpoint, after, dt, q, u)
    }
}

/// Balls, of isotropic inertia, that fall onto a floor and each other.
fn balls() -> RigidBodies {
    let at = |x: f64, z: f64, spin: f64| Body {
        position: [x, 0.01 * x, z],
        angular_velocity: [0.2, spin, 0.1],
        ..Body::ball(1.0 + x, 0.1)
    };
    let bodies = vec![at(0.0, 0.1, 5.0), at(0.05, 0.32, -3.0), at(0.3, 0.2, 2.0)];
    let mut pairs: Vec<Pair> = (0..3)
        .map(|body| restituting(Pair::new(sphere(body, 0.1, Plane::floor()), disk(0.3)), 0.4, 0.0))
        .collect();
    for (body, other) in [(1, 0), (2, 0), (2, 1)] {
        let shape = Shape::SphereSphere {
            body,
            centre: [0.0; 3],
            radius: 0.1,
            other,
            other_centre: [0.0; 3],
            other_radius: 0.1,
        };
        pairs.push(Pair::new(shape, disk(0.2)));
    }
    RigidBodies::new(bodies, &pairs, vec![], [0.1, 0.0, -G]).unwrap()
}

fn planar_boxes() -> RigidBodies {
    let at =
        |y: f64, angle: f64| PlanarBody { position: [0.0, y], angle, ..PlanarBody::new(1.0, 0.01) };
    let lower = Shape::BoxPlane { body: 0, half_sizes: [0.2, 0.1, 0.0], plane: ground() };
    let top = Plane { body: Some(0), ..Plane::line([0.0, 0.1], [0.0, 1.0]) };
    let upper = Shape::BoxPlane { body: 1, half_sizes: [0.1, 0.1, 0.0], plane: top };
    let pairs = [Pair::new(lower, line(0.5)), Pair::new(upper, line(0.2))];
    RigidBodies::new(vec![at(0.12, 0.05), at(0.36, 0.2)], &pairs, vec![], [1.0, -G, 0.0]).unwrap()
}

#[test]
fn bodies_move_as_in_one_block() {
    for bodies in [balls(), planar_boxes()] {
        let plain = |blocks: &Blocks, chords: bool| {
            let (blocks, bodies) = (blocks.clone(), bodies.clone());
            Plain { blocks, bodies, chords }
        };
        let one_block = Blocks::one(bodies.dof());
        agree(&bodies, &plain(bodies.blocks(), true));
        // In a step with an impact no contact of the struck blocks has a chord, and one block is always struck.
        agree(&plain(bodies.blocks(), false), &plain(&one_block, false));
    }
}

fn agree(one: &dyn System, other: &Plain) {
    let (q0, u0) = (other.bodies.q0(), other.bodies.u0());
    let mut one = Stepper::new(one, EXACT, 1e-13, 1e-3, &State::new(0.0, q0, u0)).unwrap();
    let mut two = Stepper::new(other, EXACT, 1e-13, 1e-3, &State::new(0.0, q0, u0)).unwrap();
    for step in 0..300 {
        one.step().unwrap();
        two.step().unwrap();
        let apart = one.q().iter().zip(two.q()).map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart < 1e-9, "step {step}: {apart:e}");
    }
}

/// A pile whose second box carries a plane for the first: bodies of contacts come in either order.
fn pile() -> RigidBodies {
    let half = [0.1, 0.07, 0.05];
    let at = |z: f64| Body { position: [0.01, 0.0, z], ..Body::cuboid(1.0, half) };
    let top = Plane { point: [0.0, 0.0, 0.05], body: Some(1), ..Plane::floor() };
    let on = |body, plane| Pair::new(Shape::BoxPlane { body, half_sizes: half, plane }, disk(0.4));
    let pairs = [on(1, Plane::floor()), on(0, top)];
    RigidBodies::new(vec![at(0.15), at(0.05)], &pairs, vec![], [0.3, 0.0, -G]).unwrap()
}

/// The factors that are handed to the solvers are those of the operator.
#[test]
fn the_operator_is_the_product_of_its_factors() {
    let flat = |x: f64| PlanarBody { position: [x, 0.1], ..PlanarBody::new(2.0, 0.03) };
    let half_sizes = [0.2, 0.1, 0.0];
    let pair = |body| Pair::new(Shape::BoxPlane { body, half_sizes, plane: ground() }, line(0.5));
    let planar =
        RigidBodies::new(vec![flat(0.0), flat(1.0)], &[pair(0), pair(1)], vec![], [0.0, -G, 0.0])
            .unwrap();
    for (system, contacts) in [(pile(), 8), (planar, 4)] {
        let mut stepper = stepper(&system, 1e-3);
        for _ in 0..20 {
            stepper.step().unwrap();
        }
        let problem = stepper.problem();
        let sizes: Vec<usize> = problem.contacts().iter().map(|contact| contact.len()).collect();
        assert_eq!(sizes.len(), contacts);
        let Delassus::Factored(given) = problem.delassus() else {
            panic!("no factors: {:?}", problem.delassus());
        };
        let made = Factored::new(given.mass().clone(), given.directions().clone(), &sizes).unwrap();
        let pairs = given.blocks().values().iter().zip(made.blocks().values());
        assert!(pairs.clone().all(|(a, b)| (a - b).abs() < 1e-12), "{given:?}");
        assert_eq!(given.blocks().offsets(), made.blocks().offsets());
    }
}

/// The normal force that is given acts on both bodies: it carries the weight here, and brakes.
#[test]
fn a_given_normal_force_acts() {
    let body = Body { velocity: [2.0, 0.0, 0.0], ..Body::new(2.0, [0.1; 3]) };
    let shape = Shape::PointPlane { body: 0, point: [0.0; 3], plane: Plane::floor() };
    let clamp = |force: f64| {
        let normal_force = NormalForce::Prescribed(force);
        let pair = Pair { normal_force, ..Pair::new(shape.clone(), disk(0.3)) };
        RigidBodies::new(vec![body.clone()], &[pair], vec![], [0.0, 0.0, -G]).unwrap()
    };
    let state = run(&clamp(2.0 * G), 1e-3, 0.5, |_| {});
    assert!(state.u[2].abs() < 1e-13 && (state.u[0] - 2.0 + 0.15 * G).abs() < 1e-12);
    let state = run(&clamp(4.0 * G), 1e-3, 0.1, |_| {});
    assert!((state.u[2] - 0.1 * G).abs() < 1e-12 && (state.u[0] - 2.0 + 0.06 * G).abs() < 1e-12);
}

/// Forces on the body, in the world: those of a box at rest sum up to its weight.
#[test]
fn contact_forces_carry_the_weight() {
    let system = pile();
    let mut stepper = stepper(&system, 1e-3);
    for _ in 0..50 {
        stepper.step().unwrap();
    }
    let mut forces = [Vector3::zeros(); 2];
    for contact in 0..16 {
        let output = stepper.output(contact).unwrap();
        let geometry = system.contact_geometry(0.0, stepper.q(), contact).unwrap();
        let [f1, f2, _] = output.force;
        let Partners { body, other } = system.partners(contact).unwrap();
        let force = geometry.world([f1, f2, output.normal_force]);
        forces[body] += force;
        if let Some(other) = other {
            forces[other] -= force;
        }
    }
    for force in forces {
        assert!((force - Vector3::new(-0.3, 0.0, G)).norm() < 1e-9, "{forces:?}");
    }
}

#[test]
fn repeats_agree_to_the_bit() {
    let system = balls();
    let once = run(&system, 1e-3, 0.5, |_| {});
    assert_eq!(once, run(&system, 1e-3, 0.5, |_| {}));
}
