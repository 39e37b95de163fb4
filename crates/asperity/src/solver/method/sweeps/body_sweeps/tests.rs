//! Sweeps over the velocities of bodies against the natural map.

use nalgebra::{DMatrix, DVector};

use super::{BodySweeps, Cones};
use crate::contact::{ContactProblem, Csr, Factored, NormalForce};
use crate::law::{FrictionLaw, Law};
use crate::random::random;
use crate::set::{Convex, Ellipsoid, Star, Vector};
use crate::solver::measure::natural_map::natural_map;

/// Velocities of a body.
const DOF: usize = 6;

fn ellipse(a: f64, b: f64) -> Convex<2> {
    Convex::from(Ellipsoid::new(Vector::<2>::new(a, b)).unwrap())
}

/// Bodies whose mass matrices are full, `scale` times as heavy as 1 kg, with random contacts in pairs and with the ground,
/// of one and two tangential directions; all in units in which loads are `unit`.
fn bodies_in_contact(count: usize, scale: f64, unit: f64, seed: &mut u64) -> ContactProblem {
    let mut mass = DMatrix::zeros(DOF * count, DOF * count);
    for body in 0..count {
        let root = DMatrix::from_fn(DOF, DOF, |i, j| f64::from(i == j) + 0.1 * random(seed));
        let own = scale * (&root * root.transpose());
        mass.view_mut((DOF * body, DOF * body), (DOF, DOF)).copy_from(&own);
    }
    let laws: [Law; 3] = [
        FrictionLaw::<2>::isotropic(0.3).unwrap().into(),
        FrictionLaw::<1>::isotropic(0.4).unwrap().into(),
        FrictionLaw::associated(ellipse(0.4, 0.35)).into(),
    ];
    let contacts: Vec<(Law, NormalForce)> =
        (0..2 * count).map(|i| (laws[i % 3].clone(), NormalForce::Unilateral)).collect();
    let rows = contacts.iter().map(|(law, _)| 1 + law.dimension()).sum();
    let mut directions = DMatrix::zeros(rows, DOF * count);
    let mut first = 0;
    for (i, (law, _)) in contacts.iter().enumerate() {
        let size = 1 + law.dimension();
        // Every third one is with the ground.
        let pair = [i % count, (i + 1 + i / count) % count];
        for &body in &pair[..if i % 3 == 0 { 1 } else { 2 }] {
            let rows = orthonormal(size, seed);
            directions.view_mut((first, DOF * body), (size, DOF)).copy_from(&rows);
        }
        first += size;
    }
    let loads = (0..rows).map(|_| unit * (random(seed) - 0.2)).collect();
    let normal: Vec<f64> = (0..contacts.len()).map(|i| 0.2 * (i % 2) as f64).collect();
    let tangential = vec![0.0; contacts.len()];
    let before: Vec<f64> = (0..rows).map(|_| unit * random(seed)).collect();
    let problem = loaded(&mass, &directions, loads, contacts);
    problem.with_restitution(&normal, &tangential, &before).unwrap()
}

/// So many directions of a body.
fn orthonormal(rows: usize, seed: &mut u64) -> DMatrix<f64> {
    DMatrix::from_fn(DOF, rows, |_, _| random(seed)).qr().q().transpose()
}

fn read(problem: &ContactProblem) -> Option<(BodySweeps, Cones)> {
    let (mut sweeps, mut cones) = (BodySweeps::default(), Cones::default());
    (cones.read(problem) && sweeps.read(problem, &cones)).then_some((sweeps, cones))
}

/// The percussions after so many sweeps from none.
fn swept(problem: &ContactProblem, count: usize, sweep: fn(&mut BodySweeps)) -> Vec<f64> {
    let (mut sweeps, cones) = read(problem).unwrap();
    sweeps.start(problem, &cones, &vec![0.0; problem.rows()]);
    (0..count).for_each(|_| sweep(&mut sweeps));
    let mut percussion = vec![f64::NAN; problem.rows()];
    sweeps.percussion(problem, &cones, &mut percussion);
    percussion
}

/// In all units, whatever the masses.
#[test]
fn sweeps_end_at_solutions() {
    let mut seed = 3;
    for (count, scale, unit) in [(1, 1.0, 1.0), (5, 1e-9, 1e20), (8, 1e3, 1e-40), (40, 1.0, 1.0)] {
        let problem = bodies_in_contact(count, scale, unit, &mut seed);
        for sweep in [BodySweeps::sweep, BodySweeps::over_relaxed_sweep] {
            let found = swept(&problem, 20_000, sweep);
            let mut velocity = vec![0.0; problem.rows()];
            problem.velocity(&found, &mut velocity);
            let map = natural_map(&problem, &found, &velocity).unwrap();
            assert!(map < 1e-12, "{count} bodies: {map:e}");
            assert!(found.iter().any(|p| *p != 0.0));
        }
    }
}

/// Orders are drawn anew for every problem, and plain sweeps do not take them.
#[test]
fn sweeps_do_not_depend_on_those_before() {
    let problem = bodies_in_contact(12, 1.0, 1.0, &mut 4);
    let (mut sweeps, cones) = read(&problem).unwrap();
    let mut after = |sweep: fn(&mut BodySweeps)| {
        let mut percussion = vec![0.0; problem.rows()];
        assert!(sweeps.read(&problem, &cones));
        sweeps.start(&problem, &cones, &percussion);
        (0..10).for_each(|_| sweep(&mut sweeps));
        sweeps.percussion(&problem, &cones, &mut percussion);
        percussion
    };
    let (plain, over_relaxed) = (after(BodySweeps::sweep), after(BodySweeps::over_relaxed_sweep));
    assert_ne!(plain, over_relaxed);
    assert_eq!(plain, after(BodySweeps::sweep));
    assert_eq!(over_relaxed, after(BodySweeps::over_relaxed_sweep));
}

/// `M` does not couple the velocities of spheres, and contacts on their axes do not act on all of them; what has no contact may
/// stand before them.
#[test]
fn velocities_of_spheres_are_put_together() {
    let count = 3;
    for free in [0, 1] {
        let stride = free + DOF;
        let mass = DMatrix::<f64>::identity(stride * count, stride * count);
        // A column: upwards, sideways with the rotation about the other axis.
        let mut directions = DMatrix::zeros(3 * count, mass.nrows());
        for body in 0..count {
            for (side, sign) in [(body, 1.0), (body.wrapping_sub(1), -1.0)] {
                if side < count {
                    let (row, at) = (3 * body, stride * side + free);
                    directions[(row, at + 2)] = sign;
                    (directions[(row + 1, at)], directions[(row + 1, at + 4)]) = (sign, 0.5);
                    (directions[(row + 2, at + 1)], directions[(row + 2, at + 3)]) = (sign, -0.5);
                }
            }
        }
        let problem = of_matrices(&mass, &directions, isotropic(count));
        assert!(read(&problem).is_some(), "{free}");
    }
}

/// More contacts at one body than there are colours: sweeps end at solutions all the same.
#[test]
fn a_body_may_have_hundreds_of_contacts() {
    let (contacts, mut seed) = (300, 8);
    let mass = DMatrix::<f64>::identity(DOF, DOF);
    let mut directions = DMatrix::zeros(3 * contacts, DOF);
    for i in 0..contacts {
        directions.rows_mut(3 * i, 3).copy_from(&orthonormal(3, &mut seed));
    }
    // Velocities that the body has: it can come to rest.
    let loads = &directions * DVector::from_fn(DOF, |_, _| random(&mut seed));
    let problem = loaded(&mass, &directions, loads.as_slice().to_vec(), isotropic(contacts));
    let found = swept(&problem, 2000, BodySweeps::sweep);
    let mut velocity = vec![0.0; problem.rows()];
    problem.velocity(&found, &mut velocity);
    let map = natural_map(&problem, &found, &velocity).unwrap();
    assert!(map < 1e-10, "{map:e}");
}

/// Contacts of three bodies, mass matrices that couple more than six velocities, friction whose cone is not symmetric or
/// elongated, drilling friction and prescribed normal forces.
#[test]
fn other_problems_are_refused() {
    let mut seed = 5;
    let mut dense = |rows: usize, columns: usize| {
        DMatrix::from_fn(rows, columns, |i, j| 0.2 * random(&mut seed) + f64::from(i == j))
    };
    let unit = DMatrix::<f64>::identity(7, 7);
    let full = dense(7, 7);
    let full = &full * full.transpose();
    let reservoir = Star::from(ellipse(0.4, 0.2));
    let turned = FrictionLaw::new(reservoir, ellipse(0.2, 0.4)).unwrap().into();
    let elongated = FrictionLaw::associated(ellipse(0.4, 0.04)).into();
    let drilling = FrictionLaw::<3>::isotropic(0.3).unwrap().into();
    let given = vec![(isotropic(1)[0].0.clone(), NormalForce::Prescribed(1.0))];
    let unilateral = |law: Law| vec![(law, NormalForce::Unilateral)];
    let (three, four, two) = (dense(3, 6), dense(4, 6), dense(2, 6));
    let six = DMatrix::<f64>::identity(6, 6);
    assert!(read(&of_matrices(&six, &three, isotropic(1))).is_some());
    // Seven velocities that are not coupled, all of them in one contact, are two bodies of six and one.
    assert!(read(&of_matrices(&unit, &dense(3, 7), isotropic(1))).is_some());
    assert!(read(&of_matrices(&DMatrix::identity(13, 13), &dense(3, 13), isotropic(1))).is_none());
    assert!(read(&of_matrices(&full, &dense(3, 7), isotropic(1))).is_none());
    assert!(read(&of_matrices(&six, &three, unilateral(turned))).is_none());
    assert!(read(&of_matrices(&six, &three, unilateral(elongated))).is_none());
    assert!(read(&of_matrices(&six, &four, unilateral(drilling))).is_none());
    assert!(read(&of_matrices(&six, &two, given)).is_none());
}

fn isotropic(count: usize) -> Vec<(Law, NormalForce)> {
    let law = FrictionLaw::<2>::isotropic(0.3).unwrap();
    vec![(law.into(), NormalForce::Unilateral); count]
}

/// Of bodies that fall with a velocity of 1 in all rows.
fn of_matrices(
    mass: &DMatrix<f64>,
    directions: &DMatrix<f64>,
    contacts: Vec<(Law, NormalForce)>,
) -> ContactProblem {
    loaded(mass, directions, vec![-1.0; directions.nrows()], contacts)
}

fn loaded(
    mass: &DMatrix<f64>,
    directions: &DMatrix<f64>,
    loads: Vec<f64>,
    contacts: Vec<(Law, NormalForce)>,
) -> ContactProblem {
    let given = |normal: &NormalForce| normal.prescribed().is_some();
    let size = |(law, normal): &(Law, NormalForce)| law.dimension() + usize::from(!given(normal));
    let sizes: Vec<usize> = contacts.iter().map(size).collect();
    let factored =
        Factored::new(Csr::from_dense(mass).unwrap(), Csr::from_dense(directions).unwrap(), &sizes);
    ContactProblem::new(factored.unwrap(), loads, contacts).unwrap()
}
