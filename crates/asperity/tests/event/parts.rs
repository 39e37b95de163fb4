//! Systems of parts that nothing connects: each moves as it would alone.

use asperity::event::{EventKind, Motion, Options, Outcome, Section, integrate};
use asperity::law::FrictionLaw;
use asperity::nalgebra::DMatrix;
use asperity::system::rigid::{Body, Pair, Plane, RigidBodies, Shape};
use asperity::system::{Contact, LinearSystem, System};

use crate::support::*;

const HALF: [f64; 3] = [0.1, 0.15, 0.05];

/// Boxes that slide and turn on a floor, the second one falls on it.
fn boxes(which: &[usize]) -> RigidBodies {
    let body = |&k: &usize| {
        let way = k as f64;
        Body {
            position: [way, 0.0, if k == 1 { 0.3 } else { HALF[2] }],
            velocity: [1.0 - 0.2 * way, 0.3 * way, 0.0],
            angular_velocity: [0.0, 0.0, 3.0 + way],
            ..Body::cuboid(1.0 + way, HALF)
        }
    };
    let pair = |place: usize| {
        let shape = Shape::BoxPlane { body: place, half_sizes: HALF, plane: Plane::floor() };
        Pair::new(shape, FrictionLaw::<2>::isotropic(0.4).unwrap())
    };
    let pairs: Vec<Pair> = (0..which.len()).map(pair).collect();
    let bodies: Vec<Body> = which.iter().map(body).collect();
    RigidBodies::new(bodies, &pairs, vec![], [0.0, 0.0, -9.81]).unwrap()
}

fn start_of(system: &RigidBodies, t_end: f64) -> Options {
    options(system.q0(), system.u0(), t_end)
}

/// The samples of some coordinates, and the events of some contacts with the numbers that they have alone.
fn of_part(
    motion: &Motion,
    coordinates: std::ops::Range<usize>,
    contacts: std::ops::Range<usize>,
) -> (Vec<f64>, Vec<(f64, usize, EventKind)>) {
    let samples = motion.samples.q.chunks_exact(motion.samples.coordinates);
    let q = samples.flat_map(|q| q[coordinates.clone()].to_vec()).collect();
    let own = motion.events.iter().filter_map(|event| {
        let contact = event.contact.filter(|contact| contacts.contains(contact))?;
        Some((event.time, contact - contacts.start, event.kind))
    });
    (q, own.collect())
}

#[test]
fn separate_boxes_move_as_each_does_alone() {
    let all = boxes(&[0, 1, 2]);
    let together = run(&all, &start_of(&all, 1.2).with_sample(0.01));
    let mut steps = 0;
    for k in 0..3 {
        let one = boxes(&[k]);
        let alone = run(&one, &start_of(&one, 1.2).with_sample(0.01));
        let (q, events) = of_part(&together, 7 * k..7 * k + 7, 8 * k..8 * k + 8);
        assert!((q, events) == of_part(&alone, 0..7, 0..8), "box {k}");
        steps += alone.steps;
    }
    assert_eq!(together.steps, steps);
    assert!(together.events.windows(2).all(|pair| pair[0].time <= pair[1].time));
}

#[test]
fn all_parts_are_known_before_and_after_every_event() {
    let all = boxes(&[0, 1, 2]);
    let together = run(&all, &start_of(&all, 1.2));
    let times = &together.samples.t;
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]));
    for event in together.events.iter().filter(|event| event.time > 0.0) {
        // A slip ends with a step, whose end is the sample before.
        let least = if event.kind == EventKind::Stick { 1 } else { 2 };
        assert!(times.iter().filter(|&&t| t == event.time).count() >= least, "{event:?}");
    }
    // In every sample every box is where it is alone.
    for k in 0..3 {
        let one = boxes(&[k]);
        let (q, _) = of_part(&together, 7 * k..7 * k + 7, 0..0);
        for (&t, q) in times.iter().zip(q.chunks_exact(7)).step_by(7).filter(|(t, _)| **t > 0.0) {
            let alone = run(&one, &start_of(&one, t));
            let off = q.iter().zip(last_q(&alone)).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-9, "box {k} at {t}");
        }
    }
}

#[test]
fn a_section_of_one_part_ends_all_there() {
    let all = boxes(&[0, 2]);
    let mut normal = vec![0.0; 14 + 12];
    normal[7] = 1.0;
    let section = Section { normal, level: 2.02, after: 0.0 };
    let motion = run(&all, &start_of(&all, 1.0).with_section(section.clone()));
    let (last, t) = (motion.events.last().unwrap(), *motion.samples.t.last().unwrap());
    assert_eq!((last.kind, last.time), (EventKind::Section, t));
    close(last_q(&motion)[7], 2.02, 1e-12);
    let one = boxes(&[0]);
    close(last_q(&motion)[0], last_q(&run(&one, &start_of(&one, t)))[0], 1e-10);
    // One that depends on both lets them go on together.
    let mut both = section;
    (both.normal[0], both.level) = (1.0, 2.06);
    let motion = run(&all, &start_of(&all, 1.0).with_section(both));
    close(last_q(&motion)[0] + last_q(&motion)[7], 2.06, 1e-12);
}

#[test]
fn failures_name_the_contact_in_the_whole() {
    let system = boxes(&[0, 2]);
    let mut q0 = system.q0().to_vec();
    q0[9] -= 0.01;
    let error = integrate(&system, &options(&q0, system.u0(), 1.0)).unwrap_err();
    assert!(error.to_string().contains("contact 8 does by 1.000e-2"), "{error}");
    // As many events as are allowed in all of them.
    let few = start_of(&system, 1.2).with_max_events(6);
    let run = integrate(&system, &few).unwrap();
    assert!(matches!(run.outcome, Outcome::TooManyEvents));
    assert!((6..=9).contains(&run.motion.events.len()), "{:?}", run.motion.events);
}

#[test]
fn velocities_of_linear_systems_that_nothing_connects_are_parts() {
    // Two masses on belts, the second of two velocities that their mass couples.
    let law = || FrictionLaw::<1>::isotropic(0.4).unwrap();
    let contact = |n: usize, k: usize| {
        let direction = DMatrix::from_fn(n, 1, |i, _| f64::from(u8::from(i == k)));
        Contact { velocity: vec![-0.5], ..Contact::with_force(law(), direction, 2.0) }
    };
    let mass = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 0.0, 0.0, 2.0, 0.3, 0.0, 0.3, 1.0]);
    let stiffness = DMatrix::from_diagonal(&nalgebra::dvector![9.0, 4.0, 7.0]);
    let zero = DMatrix::zeros(3, 3);
    let contacts = vec![contact(3, 2), contact(3, 0)];
    let whole =
        LinearSystem::new(mass.clone(), stiffness.clone(), zero, vec![0.0; 3], contacts).unwrap();
    let parts: Vec<_> = whole.parts().into_iter().map(|p| (p.velocities, p.contacts)).collect();
    assert_eq!(parts, [(vec![0], vec![1]), (vec![1, 2], vec![0])]);
    let motion = run(&whole, &options(&[0.1, 0.2, -0.3], &[0.0; 3], 5.0).with_sample(0.1));
    let own = |from: usize, n: usize, k: usize| {
        let block = |m: &DMatrix<f64>| m.view((from, from), (n, n)).into_owned();
        let (mass, stiffness) = (block(&mass), block(&stiffness));
        let (zero, contacts) = (DMatrix::zeros(n, n), vec![contact(n, k)]);
        LinearSystem::new(mass, stiffness, zero, vec![0.0; n], contacts).unwrap()
    };
    let first = run(&own(0, 1, 0), &options(&[0.1], &[0.0], 5.0).with_sample(0.1));
    let second = run(&own(1, 2, 1), &options(&[0.2, -0.3], &[0.0; 2], 5.0).with_sample(0.1));
    assert_eq!(of_part(&motion, 0..1, 1..2), of_part(&first, 0..1, 0..1));
    assert_eq!(of_part(&motion, 1..3, 0..1), of_part(&second, 0..2, 0..1));
    assert!(second.events.len() > 2);
    // A damper joins them.
    let mut damping = DMatrix::zeros(3, 3);
    damping[(0, 1)] = 0.1;
    let joined =
        LinearSystem::new(mass, stiffness, damping, vec![0.0; 3], vec![contact(3, 2)]).unwrap();
    assert!(joined.parts().is_empty());
}
