//! What the complete search costs, counted in pieces of cells.

use std::cell::Cell;

use asperity_set::{Convex, Cuboid, Ellipse, Star, StarSet, Superellipse, Vector};
use nalgebra::DMatrix;

use super::super::block::Block;
use super::super::local::{Local, LocalSolution};
use super::{Rising, rising_solutions, solutions, solutions_on_a_line};
use crate::contact::{ContactProblem, NormalForce, Phase};
use crate::law::{Fall, FrictionLaw, Law, Stribeck};

thread_local! {
    static PIECES: Cell<usize> = const { Cell::new(0) };
}

/// Adds the pieces of a cell that was searched.
pub(super) fn count(pieces: usize) {
    PIECES.with(|total| total.set(total.get() + pieces));
}

/// Pieces that the complete search looks at, and the phases that it finds.
fn search(law: &Law, load: Vector<2>) -> (usize, Vec<Phase>) {
    let Law::Two(planar) = law else { panic!("the law is planar") };
    let contacts = [(law.clone(), NormalForce::Prescribed(1.0))];
    let free = vec![load.x, load.y];
    let problem = ContactProblem::new(DMatrix::identity(2, 2), free, contacts).unwrap();
    let block = Block::new(&problem, 0);
    let mut found = Vec::new();
    PIECES.with(|total| total.set(0));
    let complete = solutions(
        &Local::new(planar, &problem.contacts()[0], &block, &problem.load(0)),
        &mut found,
    );
    assert!(complete);
    (PIECES.with(Cell::get), found.iter().map(|s| s.phase).collect())
}

fn gauge(law: &Law, x: &Vector<2>) -> f64 {
    let Law::Two(law) = law else { panic!("the law is planar") };
    law.reservoir().gauge(x)
}

/// However near a load is to a corner, the search costs at most three times what it costs far from it.
#[test]
fn loads_beside_corners_cost_as_much_as_others() {
    let rectangle = |a, b| Convex::from(Cuboid::symmetric(Vector::<2>::new(a, b)).unwrap());
    let rounded = |s| {
        let set = Superellipse::new(Vector::<2>::new(0.54, 0.48), s).unwrap();
        Star::from(set).as_convex().unwrap().clone()
    };
    let ellipse = Convex::from(Ellipse::new(Vector::<2>::new(1.0, 0.7)).unwrap());
    let laws = [
        FrictionLaw::associated(rectangle(0.54, 0.48)),
        FrictionLaw::new(rectangle(0.54, 0.48).into(), rectangle(0.5, 0.48)).unwrap(),
        FrictionLaw::new(rectangle(0.54, 0.48).into(), ellipse).unwrap(),
        FrictionLaw::associated(rounded(1.0)),
        FrictionLaw::associated(rounded(40.0)),
    ];
    for (k, law) in laws.map(Law::from).iter().enumerate() {
        // The corner of the rectangle, the tip of the rhombus; next to corners of the last one.
        let corner = match k {
            3 => Vector::<2>::new(0.54, 0.0),
            4 => {
                let direction = Vector::<2>::new(0.54, 0.48);
                direction / gauge(law, &direction)
            }
            _ => Vector::<2>::new(0.54, 0.48),
        };
        let beside = |d: f64| corner.component_mul(&Vector::<2>::new(1.0 + d, 1.0 + 1.7 * d));
        for sign in [1.0, -1.0] {
            let far = search(law, beside(0.1 * sign)).0.max(64);
            for exponent in 2..15 {
                let d = sign * 0.1_f64.powi(exponent);
                let (near, phases) = search(law, beside(d));
                assert!(!phases.is_empty(), "law {k}, {d:e}");
                assert!(near <= 3 * far, "law {k}, {d:e}: {near} pieces, far away {far}");
            }
        }
    }
}

/// Beyond the bound that the block knows a slip is the only solution, however strongly normal and tangential rows are
/// coupled. Half the bound would not do, nor would it without one of its terms.
#[test]
fn a_slip_that_is_certain_is_the_only_solution() {
    let ellipse = |a, b, angle: f64| {
        Convex::from(Ellipse::new(Vector::<2>::new(a, b)).unwrap()).rotated(angle).unwrap()
    };
    let laws = [
        FrictionLaw::isotropic(1.0).unwrap(),
        FrictionLaw::associated(ellipse(1.0, 0.2, 0.3)),
        FrictionLaw::new(ellipse(1.0, 0.2, 0.5).into(), ellipse(1.0, 0.2, 0.0)).unwrap(),
        FrictionLaw::new(ellipse(0.3, 1.0, 0.0).into(), ellipse(1.0, 0.7, 0.0)).unwrap(),
    ];
    let mut seed = 1_u64;
    let mut unit = || 0.5 * (crate::random::random(&mut seed) + 1.0);
    let mut turn = || (std::f64::consts::TAU * unit()).sin_cos();
    for law in laws {
        let law = Law::from(law);
        for _ in 0..4000 {
            let [(s0, c0), (s1, c1), (s2, c2)] = [turn(), turn(), turn()];
            let coupling = 1.0 - 0.9 * s2.powi(2);
            let (beside, brought) = (Vector::<2>::new(c0, s0) * coupling, Vector::<2>::new(c2, s2));
            let mut delassus = DMatrix::identity(3, 3) * (0.05 + 0.5 * s1.abs());
            delassus[(0, 0)] = 1.0;
            for i in 0..2 {
                (delassus[(0, 1 + i)], delassus[(1 + i, 0)]) = (beside[i], brought[i]);
                (0..2).for_each(|j| delassus[(1 + i, 1 + j)] += beside[i] * beside[j]);
            }
            let contacts = [(law.clone(), NormalForce::Unilateral)];
            let mut problem =
                ContactProblem::new(delassus, vec![-1.0, 0.0, 0.0], contacts).unwrap();
            let block = Block::new(&problem, 0);
            let speed = block.certain_slip * (1.0 + 0.1 * c1.abs());
            let direction = Vector::<2>::new(c1, s1) * speed;
            problem.free_velocity_mut()[1..].copy_from_slice(direction.as_slice());
            let Law::Two(planar) = &law else { panic!("the law is planar") };
            let local = Local::new(planar, &problem.contacts()[0], &block, &problem.load(0));
            let mut found = Vec::new();
            assert!(solutions(&local, &mut found));
            let single = found.len() == 1 && found[0].phase == Phase::Slip;
            assert!(single, "{found:?} {problem:?}");
        }
    }
}

/// The rows of a contact whose friction has the factor of the speed at which it slips, and the force on the border of
/// the reservoir that goes with the slip; stick within that of the falling part.
fn obeys<const P: usize>(
    law: &FrictionLaw<P>,
    local: &Local<'_, P>,
    factor: &Rising<'_>,
    found: &LocalSolution<P>,
) {
    let (block, normal) = (local.block, found.normal);
    let speed = found.slip.norm();
    let part = (factor.falling + factor.rate.rising(speed)) / factor.present;
    // Columns have the present factor, and percussions do not have the one of the solution.
    let friction = found.tangent * part;
    let along = |row: usize| (0..P).map(|j| block.g_tt[(row, j)] * friction[j]).sum::<f64>();
    for i in 0..P {
        let brought = if local.prescribed.is_some() { 0.0 } else { block.g_tn[i] * normal };
        let off = local.b_t[i] + brought + along(i) - found.slip[i];
        assert!(off.abs() < 2e-13 * (1.0 + local.b_t.norm()), "{off:e} {found:?}");
    }
    if local.prescribed.is_none() {
        let off = local.b_n
            + block.g_nn * normal
            + (0..P).map(|j| block.g_nt[j] * friction[j]).sum::<f64>();
        assert!(off.abs() < 1e-13 * (1.0 + normal), "{off:e} {found:?}");
    }
    assert!(normal > 0.0);
    let gauge = law.reservoir().gauge(&(found.tangent / -normal));
    if found.phase == Phase::Stick {
        assert!(speed == 0.0 && gauge <= 1.0 + 1e-12, "{gauge} {found:?}");
        return;
    }
    assert!((gauge - 1.0).abs() < 1e-12, "{gauge} {found:?}");
    let force = law.force(&found.slip, normal).unwrap();
    assert!((force - found.tangent).norm() < 1e-10 * normal, "{force} {found:?}");
}

/// Solutions of contacts whose friction rises with the speed obey all their equations to rounding, and where the normal
/// percussion is given there always is one.
#[test]
fn friction_that_rises_has_solutions_to_the_last_digits() {
    let ellipse = |a, b, angle: f64| {
        Convex::from(Ellipse::new(Vector::<2>::new(a, b)).unwrap()).rotated(angle).unwrap()
    };
    let planar = [
        FrictionLaw::isotropic(0.5).unwrap(),
        FrictionLaw::associated(ellipse(0.6, 0.3, 0.3)),
        FrictionLaw::new(ellipse(0.6, 0.4, 0.5).into(), ellipse(0.5, 0.3, 0.0)).unwrap(),
    ];
    let line = FrictionLaw::<1>::isotropic(0.6).unwrap();
    let mut seed = 5_u64;
    let mut unit = || crate::random::random(&mut seed);
    let (mut slips, mut sticks, mut unilateral_slips) = (0, 0, 0);
    for k in 0..900 {
        let rate = match k % 3 {
            0 => Stribeck::new(Fall::Exponential, 0.1, 1.0, 1.0, 3.0),
            1 => Stribeck::new(Fall::Hyperbolic, 0.3, 4.0, 1.0, 0.0),
            _ => Stribeck::new(Fall::Exponential, 0.4, 2.5, 2.0, 1.0),
        };
        let rate = rate.unwrap();
        let (falling, present) = (1.0 + 0.3 * unit(), 1.5 + 0.5 * unit());
        let factor = Rising { rate: &rate, falling, present };
        let unilateral = k % 2 == 0;
        let on_line = k / 6 % 4 == 0;
        let p = if on_line { 1 } else { 2 };
        let rows = p + usize::from(unilateral);
        let a = DMatrix::from_fn(rows, rows, |_, _| 0.3 * unit());
        let mut delassus = DMatrix::identity(rows, rows) + &a * a.transpose() + a * 0.1;
        if unilateral {
            (1..rows).for_each(|j| delassus[(0, j)] = 0.4 * unit());
        }
        let mut free: Vec<f64> = (0..rows).map(|_| 3.0 * unit()).collect();
        if unilateral {
            free[0] = -0.5 - free[0].abs();
        }
        let normal =
            if unilateral { NormalForce::Unilateral } else { NormalForce::Prescribed(1.2) };
        let check = |phases: Vec<Phase>| {
            assert!(!phases.is_empty() || unilateral, "{k}");
            phases.iter().filter(|phase| **phase == Phase::Slip).count()
        };
        let found = if on_line {
            let shared = FrictionLaw::<1>::isotropic(0.6).unwrap();
            let contacts = [(Law::from(shared), normal)];
            let problem = ContactProblem::new(delassus, free, contacts).unwrap();
            let block = Block::new(&problem, 0);
            let local = Local::new(&line, &problem.contacts()[0], &block, &problem.load(0));
            let mut found = Vec::new();
            solutions_on_a_line(&local, &factor, &mut found);
            found.iter().for_each(|found| obeys(&line, &local, &factor, found));
            let slips = check(found.iter().map(|found| found.phase).collect());
            (slips, found.len() - slips)
        } else {
            let law = &planar[k / 24 % 3];
            let shared =
                FrictionLaw::new(law.reservoir().clone(), law.direction().clone()).unwrap();
            let contacts = [(Law::from(shared), normal)];
            let problem = ContactProblem::new(delassus, free, contacts).unwrap();
            let block = Block::new(&problem, 0);
            let local = Local::new(law, &problem.contacts()[0], &block, &problem.load(0));
            let mut found = Vec::new();
            rising_solutions(&local, &factor, &mut found);
            found.iter().for_each(|found| obeys(law, &local, &factor, found));
            let slips = check(found.iter().map(|found| found.phase).collect());
            (slips, found.len() - slips)
        };
        (slips, sticks) = (slips + found.0, sticks + found.1);
        unilateral_slips += if unilateral { found.0 } else { 0 };
    }
    assert!(
        slips > 500 && unilateral_slips > 200 && sticks > 50,
        "{slips} {unilateral_slips} {sticks}"
    );
}
