//! What the complete search costs, counted in pieces of cells.

use std::cell::Cell;

use asperity_set::{Convex, Cuboid, Ellipse, Star, StarSet, Superellipse, Vector};
use nalgebra::DMatrix;

use super::super::block::Block;
use super::super::local::Local;
use super::solutions;
use crate::contact::{ContactProblem, NormalForce, Phase};
use crate::law::{FrictionLaw, Law};

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
