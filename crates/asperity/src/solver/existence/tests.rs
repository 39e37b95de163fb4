//! The bound on percussions against solutions, and problems on either side of existence.

use nalgebra::DMatrix;

use super::*;
use crate::contact::{Csr, Delassus, Factored, Memory, NormalForce};
use crate::law::{FrictionLaw, Law};
use crate::random::random;
use crate::set::{Convex, Ellipsoid, Star, Vector};
use crate::solver::measure::stop::Stop;
use crate::solver::method::Past;
use crate::solver::{Solver, Status, Workspace};
use crate::threads::Threads;

fn ellipse(a: f64, b: f64) -> Convex<2> {
    Convex::from(Ellipsoid::new(Vector::<2>::new(a, b)).unwrap())
}

/// Bodies of three velocities, which their inertia couples, each four times as heavy as the one before, with random contacts
/// in pairs and with the ground; the directions of slip are those of other ellipses than the reservoirs, and a part of the
/// loads is restitution.
fn bodies(count: usize, contacts: usize, seed: &mut u64) -> ContactProblem {
    let mut mass = DMatrix::zeros(3 * count, 3 * count);
    for body in 0..count {
        let root = DMatrix::from_fn(3, 3, |i, j| random(seed) - 0.5 + f64::from(i == j));
        let own = 4.0_f64.powi(body as i32) * (&root * root.transpose());
        mass.view_mut((3 * body, 3 * body), (3, 3)).copy_from(&own);
    }
    let mut directions = DMatrix::zeros(3 * contacts, 3 * count);
    for i in 0..contacts {
        let frame = DMatrix::from_fn(3, 3, |_, _| random(seed) - 0.5).qr().q();
        let pair = [i % count, (i + 1 + i / count) % count];
        for (sign, body) in [1.0, -1.0].into_iter().zip(pair).take(1 + i % 3) {
            directions.view_mut((3 * i, 3 * body), (3, 3)).copy_from(&(sign * &frame));
        }
    }
    let mut velocities = || (0..3 * contacts).map(|_| random(seed) - 0.5).collect::<Vec<f64>>();
    let (free, before) = (velocities(), velocities());
    let reservoir = Star::from(ellipse(0.5, 0.3));
    let law: Law = FrictionLaw::new(reservoir, ellipse(0.2, 0.4)).unwrap().into();
    let problem = of_bodies(&mass, &directions, free, &law);
    problem.with_restitution(&vec![0.3; contacts], &vec![0.1; contacts], &before).unwrap()
}

fn of_bodies(
    mass: &DMatrix<f64>,
    directions: &DMatrix<f64>,
    free: Vec<f64>,
    law: &Law,
) -> ContactProblem {
    let contacts = free.len() / (1 + law.dimension());
    let [mass, directions] = [mass, directions].map(|m| Csr::from_dense(m).unwrap());
    let sizes = vec![1 + law.dimension(); contacts];
    let factored = Factored::new(mass, directions, &sizes).unwrap();
    let all = vec![(law.clone(), NormalForce::Unilateral); contacts];
    ContactProblem::new(factored, free, all).unwrap()
}

/// Velocities of contacts within the dual cone, and `vᵀ M v` of the velocities of bodies that bring them.
struct Proof {
    velocity: Vec<f64>,
    energy: f64,
}

fn proof(problem: &ContactProblem) -> Option<Proof> {
    let (stop, threads) = (Stop::default(), Threads::NONE);
    let (history, past, within_another) = (&[][..], Past::Unswept, false);
    let other = with_suitable_masses(problem)?;
    let task = Task { problem: &other, stop, history, threads, past, within_another };
    let (mut cones, mut interior) = (Cones::default(), Interior::default());
    assert!(cones.read(problem));
    let mut found = None;
    let proven = proves(&task, &cones, &mut interior, |p| found = Some(p.to_vec()));
    assert_eq!(proven, found.is_some());
    assert_eq!(proven, is_proven(&Task { problem, ..task }, &cones, &mut interior));
    let found = found?;
    let mut velocity = vec![0.0; problem.rows()];
    other.velocity(&found, &mut velocity);
    let (Delassus::Factored(own), Delassus::Factored(suitable)) =
        (problem.delassus(), other.delassus())
    else {
        unreachable!()
    };
    let mut of_bodies = vec![0.0; own.mass().rows()];
    for (row, p) in found.iter().enumerate() {
        let (columns, values) = suitable.directions().row(row);
        columns.iter().zip(values).for_each(|(&k, w)| of_bodies[k] += w * p);
    }
    for (k, velocity) in of_bodies.iter_mut().enumerate() {
        *velocity /= suitable.mass().row(k).1[0];
    }
    let mut energy = 0.0;
    for (k, velocity) in of_bodies.iter().enumerate() {
        let (columns, masses) = own.mass().row(k);
        energy +=
            columns.iter().zip(masses).map(|(&l, m)| velocity * m * of_bodies[l]).sum::<f64>();
    }
    Some(Proof { velocity, energy })
}

/// The sum of `P_Ni`, each times what its velocity is within the dual cone, is at most `¼ vᵀ M v` at a solution.
#[test]
fn solutions_are_within_the_bound() {
    let (mut seed, mut nearest, mut counts) = (5, 0.0_f64, [0, 0]);
    for case in 0..400 {
        let problem = bodies(2 + case % 5, 3 + case % 11, &mut seed);
        let Some(Proof { velocity, energy }) = proof(&problem) else {
            counts[0] += 1;
            continue;
        };
        let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
        let report =
            Solver::default().solve(&problem, Stop::default(), &mut memory, &mut workspace);
        assert_eq!(report.status, Status::Converged, "case {case}");
        let mut cones = Cones::default();
        assert!(cones.read(&problem));
        let cones = cones.associated();
        let mut sum = 0.0;
        for (i, rows) in problem.contacts().iter().enumerate() {
            let own = |values: &[f64]| {
                ContactVector::from_fn(|k, _| if k < 3 { values[rows.offset + k] } else { 0.0 })
            };
            let (dual, p) = (cones.k[i] * own(&velocity), cones.t[i] * own(&memory.percussion));
            sum += p[0] * (dual[0] - dual.rows(1, 3).norm());
        }
        assert!(sum <= 0.25 * energy, "case {case}: {sum} > {energy}/4");
        nearest = nearest.max(4.0 * sum / energy);
        counts[1] += 1;
    }
    assert!(counts[0] > 20 && counts[1] > 100 && nearest > 0.5, "{counts:?} {nearest}");
}

/// Jaws that close on a body, and jaws that open; the load decides.
#[test]
fn what_has_no_solution_is_not_proven_to_have_one() {
    let law: Law = FrictionLaw::<1>::isotropic(0.3).unwrap().into();
    let directions = DMatrix::from_row_slice(4, 2, &[1.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 1.0]);
    for (opening, exists) in
        [(-1.0, false), (-1e-9, false), (1e-9, false), (1e-4, true), (1.0, true)]
    {
        let free = vec![opening - 0.5, 0.0, 0.5, 0.0];
        let problem = of_bodies(&DMatrix::identity(2, 2), &directions, free, &law);
        assert_eq!(proof(&problem).is_some(), exists, "{opening}");
    }
}

/// Who gives `G` alone does not say whether it is that of bodies.
#[test]
fn operators_without_bodies_are_not_asked() {
    let law: Law = FrictionLaw::<1>::isotropic(0.3).unwrap().into();
    let all = [(law, NormalForce::Unilateral)];
    let problem = ContactProblem::new(DMatrix::identity(2, 2), vec![1.0, 0.0], all).unwrap();
    assert!(proof(&problem).is_none());
}
