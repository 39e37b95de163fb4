//! What the complete search costs, counted in pieces of cells.

use std::cell::Cell;

use asperity_set::{Arc, Convex, Cuboid, Ellipse, Star, StarSet, Superellipse, Vector};
use nalgebra::DMatrix;

use super::super::block::{Block, Shape};
use super::super::local::Local;
use super::super::single::Single;
use super::super::solution::{LocalSolution, Policy};
use super::equation::{Slip, cross};
use super::newton::newton_on_circle;
use super::scan::Scan;
use super::search::{End, halved, stray};
use super::{
    ImplicitRate, implicit_solutions, proves_no_solution, solutions, solutions_on_a_line,
    without_search,
};
use crate::contact::{ContactProblem, ContactState, NormalForce, Phase};
use crate::law::COARSE;
use crate::law::{Fall, FrictionLaw, Law, Stribeck};
use crate::solver::measure::natural_residual::natural_residual;

/// The solution that is found without the complete search.
fn fast(local: &Local<'_, 2>) -> Option<LocalSolution<2>> {
    without_search(local, &ContactState::UNKNOWN, || local.b_t, Policy::Prove)
}

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
            let speed = block.slip_certificate * (1.0 + 0.1 * c1.abs());
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
    factor: &ImplicitRate<'_>,
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

/// A contact without its law.
struct Unrated {
    delassus: DMatrix<f64>,
    free: Vec<f64>,
    normal: NormalForce,
}

impl Unrated {
    /// What the solutions that a function lists do, which obey the equations, and of which other units change no digit.
    fn obeying<const P: usize>(
        &self,
        law: &FrictionLaw<P>,
        factor: &ImplicitRate<'_>,
        list: impl Fn(&Local<'_, P>, &ImplicitRate<'_>, &mut Vec<LocalSolution<P>>),
    ) -> Vec<Phase>
    where
        Law: From<FrictionLaw<P>>,
    {
        let in_units = |kg: f64, speed: f64| {
            let shared =
                FrictionLaw::new(law.reservoir().clone(), law.direction().clone()).unwrap();
            let normal = match self.normal {
                NormalForce::Prescribed(force) => NormalForce::Prescribed(force * kg * speed),
                unilateral => unilateral,
            };
            let contacts = [(Law::from(shared), normal)];
            let free = self.free.iter().map(|b| b * speed).collect();
            let problem = ContactProblem::new(&self.delassus / kg, free, contacts).unwrap();
            let block = Block::new(&problem, 0);
            let local = Local::new(law, &problem.contacts()[0], &block, &problem.load(0));
            let rate = factor.rate;
            let (typical, viscous) = (rate.speed() * speed, rate.viscous() / speed);
            let rate = Stribeck::new(rate.fall(), typical, rate.ratio(), rate.exponent(), viscous);
            let factor = ImplicitRate { rate: &rate.unwrap(), ..*factor };
            let mut found = Vec::new();
            list(&local, &factor, &mut found);
            if (kg, speed) == (1.0, 1.0) {
                found.iter().for_each(|found| obeys(law, &local, &factor, found));
            }
            for solution in &mut found {
                solution.normal /= kg * speed;
                solution.tangent /= kg * speed;
                solution.slip /= speed;
            }
            found
        };
        let found = in_units(1.0, 1.0);
        for (kg, speed) in [(4f64.powi(12), 1.0), (4f64.powi(-12), 1.0), (1.0, 2f64.powi(30))] {
            assert_eq!(in_units(kg, speed), found, "{kg:e} kg, {speed:e} m/s");
        }
        found.iter().map(|found| found.phase).collect()
    }
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
        let factor = ImplicitRate { rate: &rate, falling, present };
        let unilateral = k % 2 == 0;
        let on_line = k / 6 % 4 == 0;
        let p = if on_line { 1 } else { 2 };
        let rows = p + usize::from(unilateral);
        let a = DMatrix::from_fn(rows, rows, |_, _| 0.3 * unit());
        let mut delassus = DMatrix::identity(rows, rows) + &a * a.transpose() + a * 0.1;
        if unilateral {
            // With the stronger coupling friction pulls some contacts in whatever the factor.
            let coupling = [0.4, 0.4, 2.0][k / 2 % 3];
            (1..rows).for_each(|j| delassus[(0, j)] = coupling * unit());
        }
        let mut free: Vec<f64> = (0..rows).map(|_| 3.0 * unit()).collect();
        if unilateral {
            free[0] = -0.5 - free[0].abs();
        }
        let normal =
            if unilateral { NormalForce::Unilateral } else { NormalForce::Prescribed(1.2) };
        let contact = Unrated { delassus, free, normal };
        let phases = if on_line {
            contact.obeying(&line, &factor, solutions_on_a_line)
        } else {
            contact.obeying(&planar[k / 24 % 3], &factor, implicit_solutions)
        };
        assert!(!phases.is_empty() || unilateral, "{k}");
        let own = phases.iter().filter(|phase| **phase == Phase::Slip).count();
        let found = (own, phases.len() - own);
        (slips, sticks) = (slips + found.0, sticks + found.1);
        unilateral_slips += if unilateral { found.0 } else { 0 };
    }
    assert!(
        slips > 500 && unilateral_slips > 200 && sticks > 50,
        "{slips} {unilateral_slips} {sticks}"
    );
}

/// Laws with their sets turned against each other, which are smooth.
fn turned_laws() -> Vec<FrictionLaw<2>> {
    let ellipse = |a, b, angle: f64| {
        Convex::from(Ellipse::new(Vector::<2>::new(a, b)).unwrap()).rotated(angle).unwrap()
    };
    vec![
        FrictionLaw::isotropic(0.4).unwrap(),
        FrictionLaw::associated(ellipse(0.6, 0.3, 0.0)),
        FrictionLaw::new(ellipse(0.6, 0.3, 0.5).into(), ellipse(0.6, 0.3, 0.0)).unwrap(),
        FrictionLaw::new(ellipse(1.0, 0.2, 0.5).into(), ellipse(1.0, 0.4, 0.0)).unwrap(),
    ]
}

/// Calls a function with contacts that have random blocks, a third of them with a prescribed normal percussion.
fn each_contact(count: usize, visit: &mut dyn FnMut(&ContactProblem, &Local<'_, 2>)) {
    let mut seed = 12_u64;
    let mut unit = || crate::random::random(&mut seed);
    for (k, law) in turned_laws().iter().enumerate().cycle().take(count).enumerate() {
        let (k, (_, law)) = (k, law);
        let rows = if k % 3 == 0 { 2 } else { 3 };
        let a = DMatrix::from_fn(rows, rows + 1, |_, _| unit());
        let skew = DMatrix::from_fn(rows, rows, |_, _| 0.1 * unit());
        let delassus = &a * a.transpose() + skew + DMatrix::identity(rows, rows) * 0.2;
        let free = (0..rows).map(|_| unit()).collect();
        let shared = FrictionLaw::new(law.reservoir().clone(), law.direction().clone()).unwrap();
        let normal = [NormalForce::Prescribed(0.8), NormalForce::Unilateral][usize::from(rows > 2)];
        let contacts = [(Law::from(shared), normal)];
        let problem = ContactProblem::new(delassus, free, contacts).unwrap();
        let block = Block::new(&problem, 0);
        let local = Local::new(law, &problem.contacts()[0], &block, &problem.load(0));
        visit(&problem, &local);
    }
}

/// Products of the columns are `F` and `n·v` at the coarse nodes; what they exclude holds no root, and they exclude what
/// is farther from one than the bounds of the table.
#[test]
fn the_scan_excludes_what_holds_no_root() {
    let (mut single, mut known) = (0, 0);
    each_contact(240, &mut |_, local| {
        let table = local.law.walk().table;
        let slip = Slip::new(local);
        let scan = Scan::new(&slip, table);
        let open: Vec<usize> = scan.open().collect();
        let at = |j: usize| {
            let node = &table.nodes[j];
            let v = slip.velocity_at(node);
            (cross(&node.point.normal, &v), node.point.normal.dot(&v))
        };
        let fine = table.fine_per_coarse;
        let mut roots = Vec::new();
        for cell in 0..COARSE {
            let stray = slip.norm_c * table.columns.normal[cell]
                + slip.norm_a * slip.scale * table.columns.product[cell];
            let ((f, along_f), (g, along_g)) = (at(cell * fine), at((cell + 1) * fine));
            let apart = if (f >= 0.0) == (g >= 0.0) { f.abs().min(g.abs()) } else { 0.0 };
            let margin = apart.max((-along_f).min(-along_g)) - stray;
            if margin.abs() > 1e-12 * (slip.norm_c + slip.norm_a) {
                assert_eq!(open.contains(&cell), margin < 0.0, "{cell}: {margin:e}");
            }
            for j in cell * fine..(cell + 1) * fine {
                let ((f, along), (g, along_g)) = (at(j), at(j + 1));
                if (f >= 0.0) != (g >= 0.0) && along.min(along_g) > 0.0 {
                    assert!(open.contains(&cell), "{cell} {j}");
                }
                if (f >= 0.0) != (g >= 0.0) && open.contains(&cell) {
                    roots.push(j);
                }
            }
        }
        let one = Scan::has_one_root(&slip, table);
        assert!(!one || roots.len() == 1, "{roots:?}");
        single += usize::from(roots.len() == 1);
        known += usize::from(one);
    });
    // 173 to 179 of 223, by the last digit of the scales of *D*, which decides between cells that turn by as much.
    assert!(known * 100 >= single * 77, "{known} of {single}");
}

/// Between two points `F` and `n·v` stray from their chords by no more than the bound, which is not far more, and so it is
/// on both halves of a cell, as often as it is halved.
#[test]
fn values_stray_from_their_chords_by_the_bound() {
    let (mut reached, mut cells) = (0.0, 0.0);
    each_contact(60, &mut |_, local| {
        let walk = local.law.walk();
        let (table, direction) = (walk.table, walk.direction);
        let slip = Slip::new(local);
        for j in (0..table.fine.len()).step_by(37) {
            let (mut a, mut b) =
                (End::new(&slip, table.nodes[j].point), End::new(&slip, table.nodes[j + 1].point));
            let mut bounds = slip.bounds(&table.fine[j]);
            for depth in 0..6 {
                let arc = Arc { start: a.point, end: b.point };
                let bound = stray(&slip, &a, &b, &bounds);
                let middle = End::new(&slip, arc.middle(direction));
                // The nearest place on both chords.
                let off = |w: f64| {
                    let value = middle.value - a.value - w * (b.value - a.value);
                    let along = middle.along - a.along - w * (b.along - a.along);
                    value.abs().max(along.abs())
                };
                let (mut low, mut high) = (0.0, 1.0);
                for _ in 0..80 {
                    let (left, right) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
                    if off(left) < off(right) { high = right } else { low = left }
                }
                assert!(off(low) <= bound + slip.rounding, "{j} {depth}: {:e} {bound:e}", off(low));
                if bound > 100.0 * slip.rounding {
                    reached += off(low) / bound;
                    cells += 1.0;
                }
                bounds = halved(&bounds, &a, &middle, &b);
                if depth % 2 == 0 { b = middle } else { a = middle }
            }
        }
    });
    assert!(reached > 0.13 * cells, "{}", reached / cells);
}

/// What `Shape::Monotone` says holds at all nodes of the table, and of most matrices for which it does hold it is said;
/// multiples of the unit matrix are told apart.
#[test]
fn monotone_matrices_leave_one_solution() {
    let (mut said, mut holds) = (0, 0);
    each_contact(600, &mut |_, local| {
        // What can open is not asked.
        if local.opens() {
            return;
        }
        let (_, a) = local.affine();
        let a = a / a.norm();
        let table = local.law.walk().table;
        let shape = Shape::new(&a, local.law.bounds().smallest_sine);
        let positive = table.nodes.windows(2).all(|pair| {
            let moved = a * (pair[1].x - pair[0].x);
            let n = pair[0].point.normal + pair[1].point.normal;
            cross(&n, &moved) > -1e-9 * moved.norm()
        });
        assert!(positive || shape != Shape::Monotone);
        (said, holds) =
            (said + usize::from(shape == Shape::Monotone), holds + usize::from(positive));
    });
    assert!(100 * said >= 80 * holds, "{said} of {holds}");
    let unit = nalgebra::Matrix2::identity();
    for factor in [1e-30, 1.0, 1e30] {
        assert_eq!(Shape::new(&(unit * factor), 0.5), Shape::Monotone);
        assert_eq!(Shape::new(&(unit * factor), -0.5), Shape::Scalar);
        assert_eq!(Shape::new(&(unit * -factor), 0.5), Shape::General);
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let mut other = unit * factor;
            other[(i, j)] += 1e-13 * factor;
            assert_eq!(Shape::new(&other, -0.5), Shape::General);
        }
    }
    // Rotations by δ are monotone as long as sin δ is less than the sine.
    for (sine, angle, expected) in [
        (0.5, 0.52, Shape::Monotone),
        (0.5, 0.53, Shape::General),
        (0.5, 2.8, Shape::General),
        (0.9, -1.11, Shape::Monotone),
        (0.9, -1.13, Shape::General),
    ] {
        let (s, c) = f64::sin_cos(angle);
        assert_eq!(Shape::new(&nalgebra::Matrix2::new(c, -s, s, c), sine), expected, "{angle}");
        // diag(1 + d, 1 − d) turns by up to asin d.
        let d = f64::sin(angle.abs());
        if angle.abs() < 1.5 {
            assert_eq!(
                Shape::new(&nalgebra::Matrix2::new(1.0 + d, 0.0, 0.0, 1.0 - d), sine),
                expected
            );
            assert_eq!(Shape::new(&nalgebra::Matrix2::new(1.0, d, d, 1.0), sine), expected);
        }
    }
}

/// The defect of one contact by itself is its natural residual, but for percussions that go on approaching.
#[test]
fn defects_of_one_contact_are_its_natural_residual() {
    let mut seed = 21_u64;
    each_contact(300, &mut |problem, local| {
        let Law::Two(law) = &problem.contacts()[0].law else { panic!("the law is planar") };
        let own = |i, j| problem.delassus().own(0, i, j);
        let single = Single::new(law, problem.contacts()[0].normal, own, |i| problem.load(0)[i]);
        let rows = problem.rows();
        let percussion: Vec<f64> = (0..rows).map(|_| crate::random::random(&mut seed)).collect();
        let p =
            crate::law::ContactVector::from_fn(|i, _| percussion.get(i).copied().unwrap_or(0.0));
        let velocity = problem.velocities(&percussion).unwrap();
        let found = single.velocity(&p);
        for (a, b) in found.iter().zip(&velocity) {
            assert!((a - b).abs() < 1e-14 * (1.0 + b.abs()));
        }
        let residual = natural_residual(problem, &percussion, &velocity).unwrap().value;
        let approaches = rows == 3
            && velocity[0]
                < -1e-2 * problem.free_velocity().iter().fold(0.0, |m: f64, b| m.max(b.abs()));
        let expected = if approaches {
            residual.max(
                -velocity[0] / problem.free_velocity().iter().fold(0.0, |m: f64, b| m.max(b.abs())),
            )
        } else {
            residual
        };
        let defect = single.defect(&p);
        assert!((defect - expected).abs() < 1e-13 * expected, "{defect} {expected}");
        let same = local.single().defect(&p);
        assert!((same - defect).abs() <= 1e-14 * defect);
    });
}

/// That there is no solution is proven of no contact that has one, and of most that have none.
#[test]
fn contacts_with_a_solution_are_never_proven_to_have_none() {
    let mut seed = 31_u64;
    let mut unit = || crate::random::random(&mut seed);
    let (mut none, mut proven, mut stick) = (0, 0, 0);
    for law in turned_laws().iter().cycle().take(1600) {
        let a = DMatrix::from_fn(3, 4, |_, _| unit());
        let mut delassus = &a * a.transpose() + DMatrix::identity(3, 3) * 0.02;
        for j in 1..3 {
            delassus[(0, j)] *= 1.0 + 2.0 * unit().abs();
            delassus[(j, 0)] *= 1.0 + 2.0 * unit();
        }
        let free = vec![-unit().abs() - 0.01, unit(), unit()];
        let shared = FrictionLaw::new(law.reservoir().clone(), law.direction().clone()).unwrap();
        let contacts = [(Law::from(shared), NormalForce::Unilateral)];
        let problem = ContactProblem::new(delassus, free, contacts).unwrap();
        let block = Block::new(&problem, 0);
        let local = Local::new(law, &problem.contacts()[0], &block, &problem.load(0));
        let mut found = Vec::new();
        let complete = solutions(&local, &mut found);
        let proves = proves_no_solution(&local);
        assert!(!proves || found.is_empty(), "{found:?} {problem:?}");
        if found.is_empty() && complete {
            (none, proven) = (none + 1, proven + usize::from(proves));
        }
        stick += usize::from(found.len() == 1 && found[0].phase == Phase::Stick);
    }
    assert!(none > 20 && 20 * proven >= 19 * none && stick > 20, "{none} {proven} {stick}");
}

/// A foot of which rows see one direction of motion, which percussions stop, sticks without a search; one that moves in
/// another direction, too, is searched.
#[test]
fn what_moves_nothing_is_not_searched() {
    let law =
        FrictionLaw::associated(Convex::from(Ellipse::new(Vector::<2>::new(0.6, 0.3)).unwrap()));
    let shared = FrictionLaw::new(law.reservoir().clone(), law.direction().clone()).unwrap();
    let shared = Law::from(shared);
    for (kg, speed) in
        [(1.0, 1.0), (4f64.powi(20), 1.0), (4f64.powi(-20), 1.0), (1.0, 2f64.powi(40))]
    {
        for (across, along) in
            [([0.3, 0.1], 0.0), ([-0.2, 0.25], 0.0), ([0.3, 0.1], 1.0), ([-0.2, 0.25], 1.0)]
        {
            let seen = [1.7, 1.7 * across[0], 1.7 * across[1]];
            // Perpendicular to what is seen, of one direction only.
            let other = [0.0, -along, 0.5 * along];
            let delassus =
                DMatrix::from_fn(3, 3, |i, j| (seen[i] * seen[j] + other[i] * other[j]) / kg);
            let free = seen.map(|w| -0.7 * w * speed).to_vec();
            let contacts = [(shared.clone(), NormalForce::Unilateral)];
            let problem = ContactProblem::new(delassus, free, contacts).unwrap();
            let block = Block::new(&problem, 0);
            let local = Local::new(&law, &problem.contacts()[0], &block, &problem.load(0));
            let mut found = Vec::new();
            PIECES.with(|total| total.set(0));
            solutions(&local, &mut found);
            assert_eq!(found.len(), 1, "{found:?}");
            assert_eq!(found[0].phase, Phase::Stick);
            let pieces = PIECES.with(Cell::get);
            assert_eq!(pieces == 0, along == 0.0, "{pieces} pieces: {across:?} {kg:e} {speed:e}");
        }
        // Percussions along the normal that bring more tangential velocity than that of the motion which is seen leave a
        // constant slip velocity.
        let seen = [1.7, 0.5, 0.2];
        let brought = [1.0, 1.5, 1.5];
        let delassus = DMatrix::from_fn(3, 3, |i, j| match (i, j) {
            (_, 0) => seen[i] * seen[0] * brought[i] / kg,
            _ => seen[i] * seen[j] / kg,
        });
        let free = seen.map(|w| -0.7 * w * speed).to_vec();
        let contacts = [(shared.clone(), NormalForce::Unilateral)];
        let problem = ContactProblem::new(delassus, free, contacts).unwrap();
        let block = Block::new(&problem, 0);
        let local = Local::new(&law, &problem.contacts()[0], &block, &problem.load(0));
        let mut found = Vec::new();
        solutions(&local, &mut found);
        let slip = found.iter().find(|found| found.phase == Phase::Slip).unwrap();
        assert!(cross(&slip.slip, &Vector::<2>::new(seen[1], seen[2])).abs() < 1e-9 * speed);
    }
}

/// Isotropic contacts need no walk: Newton's method ends in their slip from any direction within a fifth of a turn, or
/// says that it does not.
#[test]
fn isotropic_contacts_need_no_walk() {
    let mut seed = 17_u64;
    let mut unit = || crate::random::random(&mut seed);
    let (mut slips, mut far) = (0, 0);
    for k in 0..400 {
        let mu = [0.1, 0.4, 1.2][k % 3];
        let rows = 2 + k % 2;
        let a = DMatrix::from_fn(rows, rows + 2, |_, _| 0.3 * unit());
        let delassus = DMatrix::identity(rows, rows) * 0.5 + &a * a.transpose();
        let mut free: Vec<f64> = (0..rows).map(|_| unit()).collect();
        if rows == 3 {
            free[0] = -free[0].abs() - 0.1;
        }
        let normal = [NormalForce::Prescribed(0.7), NormalForce::Unilateral][rows - 2];
        let law = FrictionLaw::<2>::isotropic(mu).unwrap();
        let contacts = [(Law::from(FrictionLaw::<2>::isotropic(mu).unwrap()), normal)];
        let problem = ContactProblem::new(delassus, free, contacts).unwrap();
        let block = Block::new(&problem, 0);
        let local = Local::new(&law, &problem.contacts()[0], &block, &problem.load(0));
        let mut found = Vec::new();
        solutions(&local, &mut found);
        let [only] = found[..] else { panic!("{found:?}") };
        assert!(fast(&local).is_some(), "{k}");
        if only.phase != Phase::Slip {
            continue;
        }
        slips += 1;
        let slip = Slip::new(&local);
        for turn in [-0.2, -0.05, 0.0, 0.01, 0.2, 1.5, 3.0] {
            let (sine, cosine) = f64::sin_cos(turn);
            let start = nalgebra::Matrix2::new(cosine, -sine, sine, cosine) * only.slip.normalize();
            let Some(end) = newton_on_circle(&slip, start, mu) else {
                far += 1;
                assert!(turn.abs() > 0.19, "{k} {turn}");
                continue;
            };
            assert!((end.tangent - only.tangent).norm() < 1e-13 * only.normal, "{k} {turn}");
            assert!((end.slip - only.slip).norm() < 1e-12 * local.b_t.norm(), "{k} {turn}");
        }
    }
    assert!(slips > 150 && far > 100, "{slips} {far}");
}

/// Beside a cusp of the caustic there are three slips near each other: none of them is called the only one.
#[test]
fn slips_beside_cusps_are_never_called_the_only_ones() {
    let mut seed = 41_u64;
    let mut unit = || crate::random::random(&mut seed);
    let mut several = 0;
    for law in turned_laws().split_off(2) {
        let table = law.walk().table;
        // Loads at which slips along neighbouring normals meet, x − (n⊥·x′) n, where x turns back far enough.
        let nodes: Vec<_> = table.nodes.iter().collect();
        let caustic: Vec<Option<Vector<2>>> = nodes
            .windows(2)
            .map(|pair| {
                let (n, m) = (pair[0].point.normal, pair[1].point.normal);
                let angle = cross(&n, &m);
                let back = Vector::<2>::new(n.y, -n.x).dot(&(pair[1].x - pair[0].x)) / angle;
                (angle > 1e-9 && back > 1e-3).then(|| pair[0].x + n * back)
            })
            .collect();
        let speed = |j: usize| {
            let (a, b) = (caustic.get(j.wrapping_sub(1))?.as_ref()?, caustic.get(j + 1)?.as_ref()?);
            Some((a - b).norm())
        };
        // Cusps are where the caustic turns back.
        let cusps = (1..caustic.len() - 1).filter(|&j| {
            let near = [speed(j - 1), speed(j), speed(j + 1)];
            matches!(near, [Some(a), Some(b), Some(c)] if b < a && b < c)
        });
        for cusp in cusps {
            let tip = caustic[cusp].unwrap();
            for k in 0..60 {
                let off = Vector::<2>::new(unit(), unit()) * 10f64.powf(-2.0 - 0.05 * f64::from(k));
                let free = (tip + off).as_slice().to_vec();
                let shared =
                    FrictionLaw::new(law.reservoir().clone(), law.direction().clone()).unwrap();
                let contacts = [(Law::from(shared), NormalForce::Prescribed(1.0))];
                let problem = ContactProblem::new(DMatrix::identity(2, 2), free, contacts).unwrap();
                let block = Block::new(&problem, 0);
                let local = Local::new(&law, &problem.contacts()[0], &block, &problem.load(0));
                let mut found = Vec::new();
                solutions(&local, &mut found);
                let slip = Slip::new(&local);
                let slips = found.iter().filter(|found| found.phase == Phase::Slip).count();
                several += usize::from(slips > 1);
                let one = Scan::has_one_root(&slip, table);
                assert!(!one || slips == 1, "{cusp} {k}: {found:?}");
                assert!(fast(&local).is_none() || found.len() == 1, "{cusp} {k}");
            }
        }
    }
    assert!(several > 50, "{several}");
}
