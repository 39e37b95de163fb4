//! The measures of contact problems against small cases that are written out by hand.

mod common;

use std::f64::consts::TAU;

use asperity::contact::{
    BlockMatrix, ContactProblem, ContactState, Csr, Delassus, Factored, Memory, NormalForce, Phase,
};
use asperity::law::{FrictionLaw, Law};
use asperity::set::{
    Convex, ConvexSet, Cuboid, Ellipse, Ellipsoid, Interval, Matrix, StarSet, Vector,
};
use asperity::solver::{
    Certificate, Infeasibility, InfeasibilityKind, Solver, Stop, Workspace, natural_map,
    natural_residual,
};
use common::Random;
use nalgebra::{DMatrix, DVector};

fn isotropic(mu: f64) -> Law {
    FrictionLaw::<2>::isotropic(mu).unwrap().into()
}

fn ellipse(a: f64, b: f64) -> Convex<2> {
    Ellipse::new(Vector::<2>::new(a, b)).unwrap().into()
}

/// One contact with normal force 2, `G = diag(g)`, `ρ = 2/(g₁ + g₂)`.
fn prescribed(law: Law, g: [f64; 2], free: [f64; 2]) -> ContactProblem {
    let delassus = DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(&g));
    ContactProblem::new(delassus, free.to_vec(), [(law, NormalForce::Prescribed(2.0))]).unwrap()
}

/// One unilateral contact, `G = diag(g)`, `ρ = 3/tr G`.
fn unilateral(law: Law, g: [f64; 3], free: [f64; 3]) -> ContactProblem {
    let delassus = DMatrix::from_diagonal(&nalgebra::DVector::from_column_slice(&g));
    ContactProblem::new(delassus, free.to_vec(), [(law, NormalForce::Unilateral)]).unwrap()
}

fn residual(problem: &ContactProblem, percussion: &[f64]) -> f64 {
    let velocity = problem.velocities(percussion).unwrap();
    natural_residual(problem, percussion, &velocity).unwrap().value
}

fn map(problem: &ContactProblem, percussion: &[f64]) -> f64 {
    let velocity = problem.velocities(percussion).unwrap();
    natural_map(problem, percussion, &velocity).unwrap()
}

#[track_caller]
fn close(value: f64, expected: f64) {
    assert!((value - expected).abs() <= 1e-13 * expected.abs().max(1e-3), "{value} for {expected}");
}

#[test]
fn solutions_have_no_defect() {
    // Stick: P = −G⁻¹b inside the reservoir 2·0.5.
    let stick = prescribed(isotropic(0.5), [2.0, 4.0], [0.4, -0.8]);
    close(residual(&stick, &[-0.2, 0.2]), 0.0);
    close(map(&stick, &[-0.2, 0.2]), 0.0);
    // Slip along e₁: P₁ = −1, γ₁ = 3 − 2 = 1.
    let slip = prescribed(isotropic(0.5), [2.0, 4.0], [3.0, 0.0]);
    close(residual(&slip, &[-1.0, 0.0]), 0.0);
    close(map(&slip, &[-1.0, 0.0]), 0.0);
    // Open: not pressed.
    let open = unilateral(isotropic(0.5), [1.0, 1.0, 1.0], [0.5, 3.0, 0.0]);
    close(residual(&open, &[0.0; 3]), 0.0);
    close(map(&open, &[0.0; 3]), 0.0);
    // Pressed: P_N = 4/2, slip with P₁ = −0.5 P_N.
    let pressed = unilateral(isotropic(0.5), [2.0, 1.0, 1.0], [-4.0, 3.0, 0.0]);
    close(residual(&pressed, &[2.0, -1.0, 0.0]), 0.0);
    close(map(&pressed, &[2.0, -1.0, 0.0]), 0.0);
}

/// Prescribed normal force 2, radius μP_N = 1, ρ = 2/6: a percussion that is too small or too large.
#[test]
fn defects_of_friction_are_projections() {
    let rho = 1.0 / 3.0;
    let problem = prescribed(isotropic(0.5), [2.0, 4.0], [3.0, 0.0]);
    // At P = 0: z = 0, z + ργ = 1 on the boundary: the defect is 1, the scale ρ|b| = 1.
    close(residual(&problem, &[0.0, 0.0]), 1.0);
    close(map(&problem, &[0.0, 0.0]), 1.0);
    // At P = (−0.5, 0): γ = 2, −P + ργ = 0.5 + 2/3 is projected onto 1.
    close(residual(&problem, &[-0.5, 0.0]), 0.5 / (rho * 3.0));
    close(map(&problem, &[-0.5, 0.0]), 0.5 / (rho * 3.0));
    // At P = (−1.5, 0): γ = 0, 1.5 is projected onto 1; the percussion is the larger scale.
    close(residual(&problem, &[-1.5, 0.0]), 0.5 / 1.5);
    close(map(&problem, &[-1.5, 0.0]), 0.5 / 1.5);
    // Inside, the defect is ρ‖γ‖: P = (0, 0.1), γ = (0.3, 0.4).
    let slow = prescribed(isotropic(0.5), [2.0, 4.0], [0.3, 0.0]);
    close(residual(&slow, &[0.0, 0.1]), rho * 0.5 / f64::max(0.1, rho * 0.3));
    close(map(&slow, &[0.0, 0.1]), rho * 0.5 / f64::max(0.1, rho * 0.3));
}

/// C = ellipse (1, ½)·P_N, D = disk: −P = (1.5, 0) is outside C by k_C = 1.5 and outside D by k_D = 3.
#[test]
fn the_extended_law_enters_with_alpha() {
    let law = FrictionLaw::new(ellipse(0.5, 0.25).into(), ellipse(1.0, 1.0)).unwrap();
    let problem = prescribed(law.into(), [1.0, 1.0], [1.0, 0.0]);
    let percussion = [-1.2, 0.0];
    // x = 0.6: k_C = 1.2, k_D = 2.4, α = 1/2.2; γ = −0.2, σ = −0.1: z′ = (0.6 − 0.1)/2.2 = 5/22 is inside of D, where
    // 1/α(z′) = 1/(10/22 − 20/22 + 1) = 11/6, x′ = 5/12: off by 11/60, less than rest, 0.1 + 0.1.
    close(residual(&problem, &percussion), 2.0 * 11.0 / 60.0 / 1.2);
    close(map(&problem, &percussion), 2.0 * 11.0 / 60.0 / 1.2);
    // x = 0.49: k_C = 0.98, k_D = 1.96, α = 1/1.98; γ = 0.02, σ = 0.01: z′ = 0.25, x′ = 0.5.
    close(residual(&problem, &[-0.98, 0.0]), 0.02);
    // x = 0.45: σ = 0.05, z + ασ = 0.5/1.9 is outside, x′ = 0.5; rest is as near as slip.
    close(residual(&problem, &[-0.9, 0.0]), 0.1);
    // x = 0.499, k_D = 1.996, α = 1/1.998; σ = −0.001 leads inside, and rest is the velocity away.
    let pressed = prescribed(problem.contacts()[0].law.clone(), [1.0, 1.0], [0.996, 0.0]);
    close(residual(&pressed, &[-0.998, 0.0]), 0.002 / 0.998);
}

/// A law whose direction set is an ellipsoid of that slenderness, turned by chance against another one.
fn slender<const P: usize>(slenderness: f64, random: &mut Random) -> FrictionLaw<P> {
    let axes = Vector::<P>::from_fn(|_, _| random.within(0.3, 1.0));
    let mirror = Vector::<P>::from_fn(|_, _| random.normal()).normalize();
    let mirror = Matrix::identity() - mirror * mirror.transpose() * 2.0;
    let reservoir = Convex::from(Ellipsoid::new(axes).unwrap()).mapped(&mirror).unwrap();
    let axes = Vector::<P>::from_fn(|i, _| {
        random.within(0.5, 1.0) * if i == 0 { 1.0 } else { slenderness }
    });
    FrictionLaw::new(reservoir.into(), Ellipsoid::new(axes).unwrap().into()).unwrap()
}

/// The same on a line: one end of the direction set is near.
fn one_sided(nearness: f64, random: &mut Random) -> FrictionLaw<1> {
    let interval = |low: f64, high: f64| {
        Convex::from(Interval::new(Vector::<1>::new(-low), Vector::<1>::new(high)).unwrap())
    };
    let reservoir = interval(random.within(0.3, 1.0), random.within(0.3, 1.0));
    FrictionLaw::new(reservoir.into(), interval(1.0, nearness)).unwrap()
}

/// The defect of friction, a percussion, where `ρ = 1` and the normal percussion is one.
fn defect<const P: usize>(law: Law, percussion: Vector<P>, velocity: Vector<P>) -> f64 {
    let free = velocity - percussion;
    let contacts = [(law, NormalForce::Prescribed(1.0))];
    let problem =
        ContactProblem::new(DMatrix::identity(P, P), free.as_slice().to_vec(), contacts).unwrap();
    residual(&problem, percussion.as_slice()) * f64::max(percussion.norm(), free.norm())
}

/// Percussions that slide along a velocity, made longer and shorter, and held; velocities that are turned.
fn check_defects<const P: usize>(law: FrictionLaw<P>, velocity: Vector<P>, random: &mut Random)
where
    Law: From<FrictionLaw<P>>,
{
    let force = |velocity: &Vector<P>| law.force(velocity, 1.0).unwrap();
    let (percussion, speed) = (force(&velocity), velocity.norm());
    let aside = Vector::<P>::from_fn(|_, _| random.normal());
    let aside = aside - velocity * (aside.dot(&velocity) / (speed * speed));
    let turned = |angle: f64| velocity + aside * (speed * angle / aside.norm());
    let off = |angle: f64| (force(&turned(angle)) - percussion).norm();
    let size = percussion.norm().max(speed);
    let cases = [1e-3, 1e-4, 1e-5, 1e-6].map(|part| {
        let beyond = percussion * (1.0 + part);
        let mut cases = vec![
            ("beyond", beyond, velocity, part * percussion.norm()),
            ("held beyond", beyond, velocity * 0.0, part * percussion.norm()),
            ("within", percussion * (1.0 - part), velocity, part * percussion.norm().min(speed)),
        ];
        if P > 1 {
            // Either half of the angle is a defect of the velocity, or the other half one of the percussion.
            let least = off(0.5 * part).min(0.5 * part * speed);
            cases.push(("turned", percussion, turned(part), least));
        }
        cases.into_iter().map(move |case| (part, case))
    });
    let law = Law::from(law);
    for (part, (what, percussion, velocity, least)) in cases.into_iter().flatten() {
        let found = defect(law.clone(), percussion, velocity);
        // The distance from an ellipsoid is down to 0.3 of what a point is too long by.
        assert!(found >= 0.25 * least, "{what} by {part}: {found:e} for {least:e}");
        assert!(found <= 20.0 * part * size, "{what} by {part}: {found:e} of {size:e}");
    }
    let exact = defect(law, percussion, velocity);
    assert!(exact <= 1e-12 * size, "{exact:e}");
}

/// A measure in *D* alone is blind by the square of how thin it is beside *C* in the direction of slip.
#[test]
fn defects_show_however_thin_the_direction_set_is() {
    let mut random = Random::new(16);
    for k in 0..400 {
        let ratio = 10f64.powf(random.within(-3.0, 0.0));
        let speed = 10f64.powf(random.within(-1.0, 2.0));
        let along = |sign: f64| Vector::<1>::new(sign * speed);
        check_defects(one_sided(ratio, &mut random), along([-1.0, 1.0][k % 2]), &mut random);
        let velocity = Vector::<2>::from_fn(|_, _| random.normal()).normalize() * speed;
        check_defects(slender::<2>(ratio, &mut random), velocity, &mut random);
        let velocity = Vector::<3>::from_fn(|_, _| random.normal()).normalize() * speed;
        check_defects(slender::<3>(ratio, &mut random), velocity, &mut random);
    }
}

/// Stick on the border is as far off as its velocity, whichever way that points.
#[test]
fn stick_is_off_by_its_velocity() {
    let mut random = Random::new(17);
    for _ in 0..300 {
        let law = slender::<2>(10f64.powf(random.within(-3.0, 0.0)), &mut random);
        let outward = Vector::<2>::from_fn(|_, _| random.normal());
        let percussion = outward * (-(1.0 - 1e-7) / law.reservoir().gauge(&outward));
        let velocity = Vector::<2>::from_fn(|_, _| random.normal()) * 1e-10;
        let found = defect(law.into(), percussion, velocity);
        assert!(found <= velocity.norm() * (1.0 + 1e-4), "{found:e}");
    }
}

/// From percussions half a per cent beyond the reservoir, of a body that is fast against what friction can bring: what
/// is called converged obeys the law in percussions.
#[test]
fn solvers_leave_no_percussion_beyond_its_reservoir() {
    let solvers = [
        Solver::Exact { max_sweeps: 1 },
        Solver::AUTO,
        Solver::ProximalPoint { max_iterations: 200 },
        Solver::InteriorPoint { max_iterations: 100 },
    ];
    let mut random = Random::new(20);
    for k in 0..200 {
        let law = slender::<2>(10f64.powf(random.within(-3.0, 0.0)), &mut random);
        let velocity = Vector::<2>::from_fn(|_, _| random.normal()).normalize();
        let speed = 10f64.powf(random.within(-1.0, 5.0));
        let friction = law.force(&velocity, 1.0).unwrap();
        let known = nalgebra::DVector::from_vec(vec![1.0, friction.x, friction.y]);
        let slip = nalgebra::DVector::from_vec(vec![0.0, speed * velocity.x, speed * velocity.y]);
        let delassus = DMatrix::identity(3, 3);
        let free = &slip - &known;
        let size = free.norm();
        let reservoir = law.reservoir().clone();
        let contacts = [(Law::from(law), NormalForce::Unilateral)];
        let problem = ContactProblem::new(delassus, free.as_slice().to_vec(), contacts).unwrap();
        let mut memory = Memory::new(3, 1);
        memory.percussion = vec![1.0, 1.005 * friction.x, 1.005 * friction.y];
        memory.states[0] = ContactState::new(Phase::Slip, [slip[1], slip[2], 0.0]);
        let solver = solvers[k % solvers.len()];
        let mut workspace = Workspace::default();
        let report = solver.solve(&problem, Stop::at(1e-10), &mut memory, &mut workspace);
        assert_eq!(report.status.name(), "converged", "{solver:?} {report:?}");
        let found = Vector::<2>::new(memory.percussion[1], memory.percussion[2]);
        let off = (reservoir.gauge(&-found) / memory.percussion[0] - 1.0).abs();
        assert!(off * found.norm() <= 4e-10 * size, "{solver:?}: {off:e} at {speed:e}");
    }
}

/// Any scale of *D* is the same law, and that of *C* the associated one, with the natural map of [WL19] (12).
#[test]
fn the_scale_of_the_direction_set_does_not_count() {
    let mut random = Random::new(18);
    for _ in 0..300 {
        let law = slender::<2>(10f64.powf(random.within(-3.0, 0.0)), &mut random);
        let percussion = Vector::<2>::from_fn(|_, _| random.normal());
        let velocity = Vector::<2>::from_fn(|_, _| random.normal());
        let scaled = |factor: f64| {
            let direction = law.direction().scaled(factor).unwrap();
            FrictionLaw::new(law.reservoir().clone(), direction).unwrap()
        };
        let found = defect(scaled(1.0).into(), percussion, velocity);
        for factor in [1e-3, 0.7, 1e6] {
            let other = defect(scaled(factor).into(), percussion, velocity);
            assert!((other - found).abs() <= 1e-9 * found, "{factor}: {other} for {found}");
        }
        let reservoir = law.reservoir().as_convex().unwrap();
        let same = FrictionLaw::new(law.reservoir().clone(), reservoir.scaled(0.3).unwrap());
        let found = defect(same.unwrap().into(), percussion, velocity);
        close(found, (-percussion - reservoir.project(&(velocity - percussion))).norm());
    }
}

/// Other tangential axes and other units are the same problem.
#[test]
fn the_choice_of_rows_does_not_count() {
    let mut random = Random::new(19);
    for _ in 0..300 {
        let law = slender::<2>(10f64.powf(random.within(-3.0, 0.0)), &mut random);
        let percussion = Vector::<2>::from_fn(|_, _| random.normal());
        let velocity = Vector::<2>::from_fn(|_, _| random.normal());
        let found = defect(law.rotated(0.0).unwrap().into(), percussion, velocity);
        let angle = random.within(0.0, TAU);
        let turn = |v: Vector<2>| {
            let (s, c) = angle.sin_cos();
            Vector::<2>::new(c * v.x - s * v.y, s * v.x + c * v.y)
        };
        let other = defect(law.rotated(angle).unwrap().into(), turn(percussion), turn(velocity));
        assert!((other - found).abs() <= 1e-9 * found, "{angle}: {other} for {found}");
    }
}

#[test]
fn defects_of_normal_forces_are_complementarity() {
    // ρ = 3/3 = 1.
    let problem = unilateral(isotropic(0.5), [1.0, 1.0, 1.0], [-2.0, 0.0, 0.0]);
    // P = 0: ξ_N = −2, P_N − max(0, P_N − ρξ_N) = −2, the scale ρ|b| = 2.
    close(residual(&problem, &[0.0; 3]), 1.0);
    close(map(&problem, &[0.0; 3]), 1.0);
    // Too large by 1: ξ_N = 1; the scale is P_N = 3.
    close(residual(&problem, &[3.0, 0.0, 0.0]), 1.0 / 3.0);
    close(map(&problem, &[3.0, 0.0, 0.0]), 1.0 / 3.0);
    // A pull counts whole, and friction without a normal force.
    let open = unilateral(isotropic(0.5), [1.0, 1.0, 1.0], [1.0, 0.0, 0.0]);
    close(residual(&open, &[-0.5, 0.0, 0.0]), 0.5);
    let with_friction = residual(&open, &[0.0, 0.3, 0.4]);
    close(with_friction, 0.5);
    assert!(map(&open, &[0.0, 0.3, 0.4]) > 0.1);
    // P_N > 0 of a contact that opens: min(P_N, ρξ_N).
    close(residual(&open, &[0.25, 0.0, 0.0]), 0.25);
}

/// The projection onto the friction cone: inside, in the polar cone, between.
#[test]
fn isotropic_contacts_enter_the_natural_map_with_their_cone() {
    let problem = unilateral(isotropic(0.5), [1.0, 1.0, 1.0], [-2.0, 1.0, 0.0]);
    // P = (1, −0.1, 0): ξ = (−1, 0.9, 0), ξ̃_N = −1 + 0.45 = −0.55, z = (1.55, −1.0, 0): projected onto
    // (1.55 + 0.5)/1.25 = 1.64, −0.82.
    let defect = f64::hypot(1.64 - 1.0, 0.82 - 0.1);
    close(map(&problem, &[1.0, -0.1, 0.0]), defect / f64::hypot(2.0, 1.0));
    // Inside the cone: P = (1, 0, 0) with b = (−2, 0.2, 0): ξ̃_N = −1 + 0.1, z = (1.9, −0.2, 0).
    let inside = unilateral(isotropic(0.5), [1.0, 1.0, 1.0], [-2.0, 0.2, 0.0]);
    close(map(&inside, &[1.0, 0.0, 0.0]), f64::hypot(0.9, 0.2) / f64::hypot(2.0, 0.2));
    // In the polar cone: z = (−1 − 0.5·0.3, −0.3, 0) is projected onto 0.
    let polar = unilateral(isotropic(0.5), [1.0, 1.0, 1.0], [1.0, 0.3, 0.0]);
    close(map(&polar, &[0.0; 3]), 0.0);
    // Other laws by their two inclusions.
    let law = FrictionLaw::associated(ellipse(0.5, 0.25));
    let ellipses = unilateral(law.into(), [1.0, 1.0, 1.0], [-2.0, 1.0, 0.0]);
    // ξ = (−1, 0.9, 0): normal defect 1; −P_T + ρξ_T = 0.1 + 0.9 = 1 is projected onto 0.5: defect 0.4.
    close(map(&ellipses, &[1.0, -0.1, 0.0]), f64::hypot(1.0, 0.4) / f64::hypot(2.0, 1.0));
}

/// Squares that are no numbers make every scale infinite, beside which any defect vanishes.
#[test]
fn percussions_beyond_all_numbers_solve_nothing() {
    let problem = unilateral(isotropic(0.5), [2.0, 1.0, 1.0], [-4.0, 3.0, 0.0]);
    for percussion in [[1e160, 0.0, 0.0], [0.0, 1e160, 0.0], [1e250, 1e250, 1e250]] {
        assert_eq!(residual(&problem, &percussion), f64::INFINITY);
        assert_eq!(map(&problem, &percussion), f64::INFINITY);
    }
    let problem =
        unilateral(FrictionLaw::associated(ellipse(0.5, 0.3)).into(), [2.0; 3], [-4.0; 3]);
    assert_eq!(map(&problem, &[1e160, 0.0, 0.0]), f64::INFINITY);
}

/// The measure names the worst contact; a light contact cannot hide behind a heavy one.
#[test]
fn the_worst_contact_is_named() {
    let law = || -> Law {
        FrictionLaw::associated(Convex::from(
            Interval::new(Vector::<1>::new(-0.5), Vector::<1>::new(0.5)).unwrap(),
        ))
        .into()
    };
    let contacts = [1e6, 1.0].map(|load| (law(), NormalForce::Prescribed(load)));
    let delassus = DMatrix::from_row_slice(2, 2, &[1e-6, 0.0, 0.0, 1.0]);
    let problem = ContactProblem::new(delassus, vec![0.3, 0.3], contacts).unwrap();
    let percussion = [-3e5, -0.2];
    let velocity = problem.velocities(&percussion).unwrap();
    let found = natural_residual(&problem, &percussion, &velocity).unwrap();
    assert_eq!(found.worst_contact, 1);
    close(velocity[1], 0.1);
    // The load is counted once as b and once as G P.
    assert!(found.value > 0.1 && found.value <= 0.1 / 0.3 + 1e-12, "{found:?}");
}

#[test]
fn measures_do_not_know_units() {
    for law in [isotropic(0.5), FrictionLaw::associated(ellipse(0.5, 0.25)).into()] {
        let given = unilateral(law.clone(), [2.0, 1.0, 3.0], [-2.0, 1.0, 0.5]);
        let percussion = [0.7, -0.2, 0.1];
        let (kg, speed) = (2f64.powi(40), 2f64.powi(-30));
        let other =
            unilateral(law, [2.0, 1.0, 3.0].map(|g| g / kg), [-2.0, 1.0, 0.5].map(|b| b * speed));
        let moved = percussion.map(|p| p * kg * speed);
        assert_eq!(residual(&given, &percussion), residual(&other, &moved));
        assert_eq!(map(&given, &percussion), map(&other, &moved));
    }
}

#[test]
fn restitution_enters_the_measures() {
    let law = isotropic(0.5);
    let problem = unilateral(law, [1.0, 1.0, 1.0], [-1.0, 0.0, 0.0])
        .with_restitution(&[0.5], &[0.0], &[-1.0, 0.0, 0.0])
        .unwrap();
    // ξ_N = P_N − 1 − 0.5 vanishes at 1.5.
    close(residual(&problem, &[1.5, 0.0, 0.0]), 0.0);
    close(map(&problem, &[1.5, 0.0, 0.0]), 0.0);
    assert!(residual(&problem, &[1.0, 0.0, 0.0]) > 0.1);
    assert!(map(&problem, &[1.0, 0.0, 0.0]) > 0.1);
}

/// A body that bounces with half its velocities, along the surface too: `ξ = γ + e γ_B` vanishes in stick.
#[test]
fn restitution_enters_the_phases() {
    let problem = unilateral(isotropic(0.5), [1.0, 0.1, 0.1], [-1.0, 0.02, 0.0])
        .with_restitution(&[0.5], &[0.5], &[-1.0, 0.02, 0.0])
        .unwrap();
    let percussion = [1.5, -0.3, 0.0];
    close(residual(&problem, &percussion), 0.0);
    assert_eq!(Certificate::new(&problem, &percussion).unwrap().phases, [0, 1, 0]);
    // Faster it slips, to the same side: ξ_T = 0.15 − 0.1·0.75.
    let problem = unilateral(isotropic(0.5), [1.0, 0.1, 0.1], [-1.0, 0.1, 0.0])
        .with_restitution(&[0.5], &[0.5], &[-1.0, 0.1, 0.0])
        .unwrap();
    let percussion = [1.5, -0.75, 0.0];
    close(residual(&problem, &percussion), 0.0);
    assert_eq!(Certificate::new(&problem, &percussion).unwrap().phases, [0, 0, 1]);
}

#[test]
fn certificates_are_in_physical_units() {
    let problem = unilateral(isotropic(0.5), [1.0, 1.0, 1.0], [-2.0, 1.0, 0.0]);
    // P_N too small by 0.5, friction outside the cone by 0.25.
    let found = Certificate::new(&problem, &[1.5, -1.0, 0.0]).unwrap();
    close(found.penetration_velocity, 0.5);
    close(found.complementarity, 0.75);
    close(found.tension, 0.0);
    close(found.cone_violation, 0.25);
    // γ = 0: −P = 1 is projected onto 0.75.
    close(found.direction_violation, 0.25);
    close(found.natural_map, map(&problem, &[1.5, -1.0, 0.0]));
    close(found.contact_residual, residual(&problem, &[1.5, -1.0, 0.0]));
    assert_eq!(found.worst_contact, 0);
    let pulls = Certificate::new(&problem, &[-0.5, 0.0, 0.1]).unwrap();
    close(pulls.tension, 0.5);
    close(pulls.penetration_velocity, 2.5);
    close(pulls.complementarity, 1.25);
    // Without a normal force all friction is too much.
    close(pulls.cone_violation, 0.1);
    close(pulls.direction_violation, 0.1);
    assert_eq!(pulls.phases, [1, 0, 0]);
    // In space: −P = (0.3, 0.6, 0.6) of length 0.9 is 0.15 too long for 0.5·1.5.
    let law = FrictionLaw::<3>::isotropic(0.5).unwrap().into();
    let space = ContactProblem::new(
        DMatrix::identity(4, 4),
        vec![-1.5, 0.3, 0.6, 0.6],
        [(law, NormalForce::Unilateral)],
    )
    .unwrap();
    let found = Certificate::new(&space, &[1.5, -0.3, -0.6, -0.6]).unwrap();
    close(found.cone_violation, 0.15);
    close(found.direction_violation, 0.15);
    // What is in order has none of it.
    let open = unilateral(isotropic(0.5), [1.0, 1.0, 1.0], [1.0, 1.0, 0.0]);
    let found = Certificate::new(&open, &[0.0; 3]).unwrap();
    assert_eq!(
        (found.penetration_velocity, found.complementarity, found.cone_violation),
        (0.0, 0.0, 0.0)
    );
    assert_eq!(found.phases, [1, 0, 0]);
}

#[test]
fn certificates_count_phases() {
    // Three contacts side by side: open, stick, slip.
    let contacts = [0.5; 3].map(|mu| (isotropic(mu), NormalForce::Unilateral));
    let free = vec![1.0, 0.0, 0.0, -2.0, 0.2, 0.0, -2.0, 3.0, 0.0];
    let problem = ContactProblem::new(DMatrix::identity(9, 9), free, contacts).unwrap();
    let found =
        Certificate::new(&problem, &[0.0, 0.0, 0.0, 2.0, -0.2, 0.0, 2.0, -1.0, 0.0]).unwrap();
    assert_eq!(found.phases, [1, 1, 1]);
    close(found.contact_residual, 0.0);
    // And with given normal forces, of every dimension.
    let laws: [Law; 3] = [
        FrictionLaw::<1>::isotropic(0.5).unwrap().into(),
        FrictionLaw::associated(Convex::from(
            Cuboid::symmetric(Vector::<2>::new(0.5, 0.5)).unwrap(),
        ))
        .into(),
        FrictionLaw::<3>::isotropic(0.5).unwrap().into(),
    ];
    let free = vec![3.0, 0.1, 0.2, 3.0, 0.0, 0.0];
    let problem = ContactProblem::new(
        DMatrix::identity(6, 6),
        free,
        laws.map(|law| (law, NormalForce::Prescribed(2.0))),
    )
    .unwrap();
    let found = Certificate::new(&problem, &[-1.0, -0.1, -0.2, -1.0, 0.0, 0.0]).unwrap();
    assert_eq!(found.phases, [0, 1, 2]);
    close(found.direction_violation, 0.0);
}

/// A body of mass `m` between two walls that move at it: `b_N` of both, tangential rows along the walls.
fn squeezed(mass: f64, walls: [f64; 2]) -> ContactProblem {
    let (x, y) = ([1.0, 0.0, -1.0, 0.0], [0.0, 1.0, 0.0, 1.0]);
    let delassus = DMatrix::from_fn(4, 4, |i, j| (x[i] * x[j] + y[i] * y[j]) / mass);
    let law = || Law::from(FrictionLaw::<1>::isotropic(0.5).unwrap());
    let contacts = [0, 1].map(|_| (law(), NormalForce::Unilateral));
    ContactProblem::new(delassus, vec![walls[0], 0.3, walls[1], 0.3], contacts).unwrap()
}

/// Both walls close on the body with the mean of their velocities, whatever acts between: `d = (½, 0, ½, 0)`.
#[test]
fn walls_that_close_on_a_body_are_proven_to_have_no_solution() {
    let solvers = [Solver::Exact { max_sweeps: 2000 }, Solver::AUTO];
    for solver in solvers {
        for mass in [1e-6, 1.0, 1e6] {
            for (first, second) in [(-1.0, -0.5), (-1.0, 0.5), (0.25, -2.0)] {
                let problem = squeezed(mass, [first, second]);
                let (mut memory, mut workspace) = (Memory::new(4, 2), Workspace::default());
                let report = solver.solve(&problem, Stop::at(1e-10), &mut memory, &mut workspace);
                assert_eq!(report.status.name(), "no_solution", "{solver:?} {mass} {first}");
                let proof = workspace.infeasibility().unwrap();
                assert_eq!(proof.kind, InfeasibilityKind::Closing);
                let weights = [0.5, 0.0, 0.5, 0.0];
                for (d, expected) in proof.direction.iter().zip(weights) {
                    close(*d, expected);
                }
                close(proof.closing_velocity, -0.5 * (first + second));
                assert!(proof.residual <= 4e-15);
            }
            // The body gives way, or the walls part.
            for (first, second) in [(-1.0, 1.0), (-1.0, 1.5), (0.5, 0.25), (-1.0, 1.0 + 1e-6)] {
                let problem = squeezed(mass, [first, second]);
                let (mut memory, mut workspace) = (Memory::new(4, 2), Workspace::default());
                let report = solver.solve(&problem, Stop::at(1e-10), &mut memory, &mut workspace);
                assert_eq!(report.status.name(), "converged", "{solver:?} {mass} {second}");
                assert!(workspace.infeasibility().is_none());
            }
        }
    }
}

/// Painlevé's rod: `γ_N = (G_NN − μ G_NT) P_N + b_N` falls with `P_N`, and the contact slips.
#[test]
fn a_rod_that_friction_presses_down_is_proven_to_have_no_solution() {
    for (sign, velocity) in [(1.0, 1.0), (-1.0, -1.0)] {
        let delassus = DMatrix::from_row_slice(2, 2, &[1.0, 2.0 * sign, 2.0 * sign, 3.0]);
        let solve = |mu: f64, b: f64| {
            let law = FrictionLaw::<1>::isotropic(mu).unwrap().into();
            let contacts = [(law, NormalForce::Unilateral)];
            let problem =
                ContactProblem::new(delassus.clone(), vec![b, 5.0 * velocity], contacts).unwrap();
            let (mut memory, mut workspace) = (Memory::new(2, 1), Workspace::default());
            let solver = Solver::Exact { max_sweeps: 1 };
            let report = solver.solve(&problem, Stop::at(1e-10), &mut memory, &mut workspace);
            (report.status.name(), workspace.infeasibility().cloned())
        };
        let (status, proof) = solve(0.8, -1.0);
        assert_eq!(status, "no_solution");
        let proof = proof.unwrap();
        assert_eq!((proof.kind, proof.contact), (InfeasibilityKind::OneContact, 0));
        assert_eq!((proof.direction, proof.closing_velocity), (vec![1.0, 0.0], 1.0));
        // Too smooth to be pressed down, or not pressed at all.
        assert_eq!(solve(0.4, -1.0), ("converged", None));
        assert_eq!(solve(0.8, 1.0), ("converged", None));
    }
}

/// Painlevé's paradox again, where friction, not the normal load, calls for percussions: they solve the problem
/// however small the approach is.
#[test]
fn percussions_of_one_contact_do_not_run_away_from_a_vanishing_load() {
    let root =
        DMatrix::from_row_slice(3, 3, &[0.47, -0.05, -0.03, 1.05, -0.72, -0.47, -0.52, 1.17, 0.99]);
    for approach in [1.0, 1e-3, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-15, 0.0] {
        let contacts = [(isotropic(0.9), NormalForce::Unilateral)];
        let free = vec![-approach, 1.29, -0.03];
        let problem = ContactProblem::new(&root * root.transpose(), free, contacts).unwrap();
        let (mut memory, mut workspace) = (Memory::new(3, 1), Workspace::default());
        let solver = Solver::Exact { max_sweeps: 1 };
        let report = solver.solve(&problem, Stop::at(1e-10), &mut memory, &mut workspace);
        assert_eq!(report.status.name(), "converged", "{approach:e}: {report:?}");
    }
}

/// A single coordinate along which friction pulls a contact that slides on a belt into the surface: percussions that cancel
/// in it may be as large as they like, and their residual as small, but solve nothing.
#[test]
fn percussions_of_one_contact_that_cancel_are_no_solution() {
    let ellipsoid = Ellipsoid::new(nalgebra::Vector3::new(89.0, 5.6, 17.8)).unwrap();
    let rows = nalgebra::DVector::from_row_slice(&[-0.84, 0.764, 0.956, 0.6625]);
    let belt = nalgebra::DVector::from_row_slice(&[0.0, -9.2, 0.0114, 0.562]);
    for (mass, speed) in [(0.0117, 27.5), (1.0, 27.5), (0.0117, 3.0), (1e3, 300.0)] {
        let law = Law::from(FrictionLaw::associated(Convex::from(ellipsoid)));
        let free = (&rows * speed + &belt).as_slice().to_vec();
        let delassus = &rows * rows.transpose() / mass;
        let problem =
            ContactProblem::new(delassus, free, [(law, NormalForce::Unilateral)]).unwrap();
        let solution = problem.solve(&Solver::default(), Stop::default());
        let status = solution.report.status.name();
        assert!(
            ["unbounded", "no_solution", "stalled"].contains(&status),
            "{mass} {speed}: {status}"
        );
    }
}

/// What a contact does, told from percussions that are no solution, on both sides of every switch.
#[test]
fn phases_switch_where_the_natural_map_does() {
    let phase = |problem: &ContactProblem, percussion: &[f64]| {
        let phases = Certificate::new(problem, percussion).unwrap().phases;
        phases.iter().position(|&count| count == 1).unwrap()
    };
    // ρ = ¾: open from P_N ≤ ¾ (2 P_N + b_N), 1 ≤ ¾ (2 + b_N).
    let normal = |b: f64| unilateral(isotropic(0.5), [2.0, 1.0, 1.0], [b, 0.0, 0.0]);
    assert_eq!(phase(&normal(-0.70), &[1.0, 0.0, 0.0]), 1);
    assert_eq!(phase(&normal(-0.65), &[1.0, 0.0, 0.0]), 0);
    assert_eq!(phase(&normal(-0.65), &[-1.0, 0.0, 0.0]), 0);
    // P = −0.98 of 2: x = 0.49, k_C = 0.98, k_D = 1.96, α = 1/1.98, α (0.49 + γ/2) is outside 0.25 from γ = 0.01 on.
    let law = || FrictionLaw::new(ellipse(0.5, 0.25).into(), ellipse(1.0, 1.0)).unwrap().into();
    let slip = |gamma: f64| prescribed(law(), [1.0, 1.0], [0.98 + gamma, 0.0]);
    assert_eq!(phase(&slip(0.0095), &[-0.98, 0.0]), 1);
    assert_eq!(phase(&slip(0.0105), &[-0.98, 0.0]), 2);
    // Without friction: x = 0, slip from ργ/P_N = γ/2 outside D = 0.25 on.
    let slip = |gamma: f64| prescribed(law(), [1.0, 1.0], [0.0, gamma]);
    assert_eq!(phase(&slip(0.49), &[0.0, 0.0]), 1);
    assert_eq!(phase(&slip(0.51), &[0.0, 0.0]), 2);
}

/// The weights with which three directions of the plane keep balance.
fn balance(angles: [f64; 3]) -> [f64; 3] {
    let weight = |i: usize| (angles[(i + 2) % 3] - angles[(i + 1) % 3]).sin();
    let sum = weight(0) + weight(1) + weight(2);
    [0, 1, 2].map(|i| weight(i) / sum)
}

/// A body of the plane between three walls, and a contact of another body, in every form of the operator.
fn between_walls(
    angles: [f64; 3],
    approach: [f64; 3],
    masses: [f64; 2],
) -> Vec<(&'static str, ContactProblem)> {
    // Velocities of the first body, of the second.
    let directions = DMatrix::from_fn(8, 4, |row, column| match (row, column) {
        (6, 2) | (7, 3) => 1.0,
        (..6, 0) => [angles[row / 2].cos(), -angles[row / 2].sin()][row % 2],
        (..6, 1) => [angles[row / 2].sin(), angles[row / 2].cos()][row % 2],
        _ => 0.0,
    });
    let mass = |i: usize| masses[i / 2];
    let inverse = DMatrix::from_fn(4, 4, |i, j| if i == j { 1.0 / mass(i) } else { 0.0 });
    let dense = &directions * inverse * directions.transpose();
    let sparse = |matrix: &DMatrix<f64>| {
        let (mut starts, mut indices, mut values) = (vec![0], vec![], vec![]);
        for row in matrix.row_iter() {
            for (j, value) in row.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                indices.push(j);
                values.push(*value);
            }
            starts.push(indices.len());
        }
        Csr::new(matrix.nrows(), matrix.ncols(), starts, indices, values).unwrap()
    };
    let masses = DMatrix::from_fn(4, 4, |i, j| if i == j { mass(i) } else { 0.0 });
    let factored = Factored::new(sparse(&masses), sparse(&directions), &[2; 4]).unwrap();
    let blocks = BlockMatrix::from_csr(&sparse(&dense), &[2; 4]).unwrap();
    let [a, b, c] = approach.map(|v| -v);
    let free = vec![a, 0.2, b, -0.1, c, 0.3, -1.0, 0.5];
    let full = BlockMatrix::from_dense(&dense, &[2; 4]).unwrap();
    let forms: [(&str, Delassus); 3] =
        [("dense", full.into()), ("blocks", blocks.into()), ("factored", factored.into())];
    forms
        .into_iter()
        .map(|(name, delassus)| {
            let law = || Law::from(FrictionLaw::<1>::isotropic(0.3).unwrap());
            let contacts = (0..4).map(|_| (law(), NormalForce::Unilateral));
            (name, ContactProblem::new(delassus, free.clone(), contacts).unwrap())
        })
        .collect()
}

/// `max_j |(Gᵀd)_j|/s_j` over `max_i s_i d_i`, `s = √diag G`.
fn part_of_closing_that_percussions_change(problem: &ContactProblem, direction: &[f64]) -> f64 {
    let delassus = problem.delassus().to_dense();
    let brought = delassus.tr_mul(&DVector::from_column_slice(direction));
    let scale = delassus.diagonal().map(f64::sqrt);
    let largest = scale.component_mul(&DVector::from_column_slice(direction)).amax();
    brought.component_div(&scale).amax() / largest
}

/// Three walls at any angles: the proof has the weights of the balance of forces, whatever the masses and the operator.
#[test]
fn proofs_have_the_weights_of_the_balance_of_forces() {
    for (angles, approach) in [
        ([0.0, 2.0, 4.0], [1.0, 1.0, 1.0]),
        ([0.3, 2.9, 4.1], [1.0, -0.1, 0.4]),
        ([1.0, 3.9, 4.3], [-0.2, 0.7, 2.0]),
    ] {
        let weights = balance(angles);
        let closing: f64 = weights.iter().zip(&approach).map(|(d, v)| d * v).sum();
        assert!(closing > 0.0 && weights.iter().all(|d| *d > 0.0), "{weights:?}");
        let largest = weights.iter().copied().fold(0.0, f64::max);
        for masses in [[1.0, 1.0], [1e-5, 1e4], [1e6, 1e-3], [1e10, 1.0], [1e-10, 1e-9]] {
            let problems = between_walls(angles, approach, masses);
            let open = between_walls(angles, approach.map(|v| v - closing - 1e-3), masses);
            for ((name, problem), (_, open)) in problems.iter().zip(&open) {
                for solver in [Solver::Exact { max_sweeps: 500 }, Solver::AUTO] {
                    let (mut memory, mut workspace) = (Memory::new(8, 4), Workspace::default());
                    let report = solver.solve(problem, Stop::at(1e-9), &mut memory, &mut workspace);
                    assert_eq!(report.status.name(), "no_solution", "{name} {masses:?} {solver:?}");
                    let proof = workspace.infeasibility().unwrap();
                    assert_eq!(proof.kind, InfeasibilityKind::Closing);
                    assert_eq!(report.worst_contact, proof.contact);
                    close(weights[proof.contact], largest);
                    for (row, d) in proof.direction.iter().enumerate() {
                        let expected = if row % 2 == 0 && row < 6 { weights[row / 2] } else { 0.0 };
                        assert!((d - expected).abs() < 1e-12, "{name}: {:?}", proof.direction);
                    }
                    close(proof.closing_velocity, closing);
                    assert!(proof.residual <= 1e-14, "{proof:?}");
                    let left = part_of_closing_that_percussions_change(problem, &proof.direction);
                    let off = (proof.residual - left).abs();
                    assert!(off <= 4.0 * f64::EPSILON, "{name} {masses:?}: {left:e} {proof:?}");
                    // A little slower they part, and what they close on is only what friction holds.
                    let (mut memory, mut workspace) = (Memory::new(8, 4), Workspace::default());
                    solver.solve(open, Stop::at(1e-9), &mut memory, &mut workspace);
                    let closing = |proof: &Infeasibility| proof.kind == InfeasibilityKind::Closing;
                    assert!(!workspace.infeasibility().is_some_and(closing), "{name}");
                }
            }
        }
    }
}

/// Many walls that all close: some combination proves it, and can be checked from the problem alone.
#[test]
fn proofs_among_many_walls_can_be_checked() {
    let mut random = Random::new(7);
    for count in [4, 6, 9] {
        for _ in 0..6 {
            let angles: Vec<f64> = (0..count)
                .map(|k| TAU * (k as f64 + random.within(-0.3, 0.3)) / count as f64)
                .collect();
            let row = |i: usize| match i % 2 {
                0 => [angles[i / 2].cos(), angles[i / 2].sin()],
                _ => [-angles[i / 2].sin(), angles[i / 2].cos()],
            };
            let scale = 10f64.powf(random.within(-3.0, 3.0));
            let delassus = DMatrix::from_fn(2 * count, 2 * count, |i, j| {
                (row(i)[0] * row(j)[0] + row(i)[1] * row(j)[1]) * scale
            });
            let free: Vec<f64> =
                (0..2 * count)
                    .map(|i| {
                        if i % 2 == 0 { -random.within(0.1, 1.0) } else { random.within(-1.0, 1.0) }
                    })
                    .collect();
            let law = || Law::from(FrictionLaw::<1>::isotropic(0.4).unwrap());
            let contacts = (0..count).map(|_| (law(), NormalForce::Unilateral));
            let problem = ContactProblem::new(delassus.clone(), free.clone(), contacts).unwrap();
            let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
            let solver = Solver::AUTO;
            let report = solver.solve(&problem, Stop::at(1e-9), &mut memory, &mut workspace);
            assert_eq!(report.status.name(), "no_solution", "{count}");
            let proof = workspace.infeasibility().unwrap();
            let d = nalgebra::DVector::from_column_slice(&proof.direction);
            close(d.sum(), 1.0);
            assert!(d.iter().enumerate().all(|(i, d)| *d >= 0.0 && (i % 2 == 0 || *d == 0.0)));
            assert!((delassus.transpose() * &d).amax() <= 1e-14 * scale);
            let closing: f64 = -free.iter().zip(d.iter()).map(|(b, d)| b * d).sum::<f64>();
            close(proof.closing_velocity, closing);
            assert!(closing > 0.0);
            assert_eq!(proof.direction[2 * proof.contact], d.max());
        }
    }
}

/// Heavy on light: percussions a million times those of the light body alone are a solution and no flight.
#[test]
fn large_percussions_of_stacks_are_solutions() {
    for ratio in [1e2, 1e4, 1e6] {
        // A light body on the ground, a heavy one upon it: normal rows +1 of the upper, −1 of the lower body.
        let (light, heavy) = (1.0, ratio);
        let normal = [[1.0 / light, -1.0 / light], [-1.0 / light, 1.0 / light + 1.0 / heavy]];
        let delassus =
            DMatrix::from_fn(4, 4, |i, j| if i % 2 == j % 2 { normal[i / 2][j / 2] } else { 0.0 });
        let law = || Law::from(FrictionLaw::<1>::isotropic(0.5).unwrap());
        let contacts = [0, 1].map(|_| (law(), NormalForce::Unilateral));
        // Both fall with 1 m/s; the lower one slides with 0.1 m/s under the upper one, which moves with it.
        let free = vec![-1.0, 0.1, 0.0, 0.0];
        let problem = ContactProblem::new(delassus, free, contacts).unwrap();
        for solver in [Solver::Exact { max_sweeps: 100_000_000 }, Solver::AUTO] {
            if ratio > 1e3 && matches!(solver, Solver::Exact { .. }) {
                continue;
            }
            let (mut memory, mut workspace) = (Memory::new(4, 2), Workspace::default());
            let report = solver.solve(&problem, Stop::at(1e-12), &mut memory, &mut workspace);
            assert_eq!(report.status.name(), "converged", "{ratio:e} {solver:?} {report:?}");
            let expected = [light + heavy, -0.1 * (light + heavy), heavy, -0.1 * heavy];
            for (p, expected) in memory.percussion.iter().zip(expected) {
                assert!((p - expected).abs() < 1e-5 * heavy, "{ratio:e}: {:?}", memory.percussion);
            }
        }
    }
}

/// A light body between the ground and a heavy one that comes down: `G` in double precision does not know any more that
/// the heavy body can be moved, but its percussions `(M, 0, M, 0)` solve the problem exactly.
#[test]
fn heavy_bodies_that_the_operator_has_lost_are_never_said_to_have_no_solution() {
    for heavy in [1e15, 1e16, 1e17, 1e20, 1e25, 1e30] {
        let masses = [1.0, 1.0, heavy, heavy];
        let mass = Csr::new(4, 4, (0..=4).collect(), (0..4).collect(), masses.to_vec()).unwrap();
        // Rows: light on ground, normal and along; heavy on light likewise. Velocities (x, y) of both bodies.
        let (starts, columns) = (vec![0, 1, 2, 4, 6], vec![1, 0, 1, 3, 0, 2]);
        let values = vec![1.0, 1.0, -1.0, 1.0, -1.0, 1.0];
        let directions = Csr::new(4, 4, starts, columns, values).unwrap();
        let factored = Factored::new(mass, directions, &[2, 2]).unwrap();
        let law = || Law::from(FrictionLaw::<1>::isotropic(0.3).unwrap());
        let contacts = [0, 1].map(|_| (law(), NormalForce::Unilateral));
        let free = vec![0.0, 0.0, -1.0, 0.0];
        let problem = ContactProblem::new(Delassus::from(factored), free, contacts).unwrap();
        for solver in [
            Solver::Exact { max_sweeps: 200 },
            Solver::AUTO,
            Solver::InteriorPoint { max_iterations: 200 },
        ] {
            let (mut memory, mut workspace) = (Memory::new(4, 2), Workspace::default());
            let report = solver.solve(&problem, Stop::at(1e-10), &mut memory, &mut workspace);
            assert_ne!(report.status.name(), "no_solution", "{heavy:e} {solver:?}");
            assert!(workspace.infeasibility().is_none(), "{heavy:e} {solver:?}");
        }
    }
}

/// What solvers report is the residual of the percussions and velocities that they leave, of contacts that
/// meet and of others, that bounce and that do not.
#[test]
fn reported_residuals_are_those_of_the_percussions() {
    let mut random = Random::new(27);
    let mut nonzero = 0;
    for k in 0..120 {
        let law = |k: usize| -> Law {
            match k % 4 {
                0 => FrictionLaw::<1>::isotropic(0.4).unwrap().into(),
                1 => isotropic(0.5),
                2 => FrictionLaw::new(ellipse(0.5, 0.25).into(), ellipse(1.0, 1.0)).unwrap().into(),
                _ => FrictionLaw::<3>::isotropic(0.3).unwrap().into(),
            }
        };
        let count = 1 + k % 5;
        // With a small force velocities, not percussions, are what the defect is compared with.
        let normal = |i: usize| match (k / 3 + i) % 3 {
            0 => NormalForce::Prescribed([1.3, 1e-3][k % 2]),
            _ => NormalForce::Unilateral,
        };
        let contacts: Vec<(Law, NormalForce)> =
            (0..count).map(|i| (law(k / 2 + i), normal(i))).collect();
        let size = |(law, normal): &(Law, NormalForce)| {
            law.dimension() + usize::from(*normal == NormalForce::Unilateral)
        };
        let sizes: Vec<usize> = contacts.iter().map(size).collect();
        let rows: usize = sizes.iter().sum();
        let owner: Vec<usize> =
            sizes.iter().enumerate().flat_map(|(i, n)| std::iter::repeat_n(i, *n)).collect();
        let mut delassus = common::gram(rows, rows + 2, &mut random);
        if k % 2 == 0 {
            for i in 0..rows {
                (0..rows).filter(|j| owner[*j] != owner[i]).for_each(|j| delassus[(i, j)] = 0.0);
            }
        }
        let free: Vec<f64> = (0..rows).map(|_| random.within(-1.0, 0.3)).collect();
        let bounce = vec![if k % 5 < 2 { 0.4 } else { 0.0 }; count];
        let problem = ContactProblem::new(delassus, free.clone(), contacts).unwrap();
        let problem = problem.with_restitution(&bounce, &bounce, &free).unwrap();
        for solver in [Solver::Exact { max_sweeps: 2 }, Solver::AUTO] {
            let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
            let report = solver.solve(&problem, Stop::at(1e-5), &mut memory, &mut workspace);
            let velocity = workspace.velocity();
            let found = natural_residual(&problem, &memory.percussion, velocity).unwrap();
            assert_eq!(report.residual, found.value, "{k} {solver:?} {report:?} {found:?}");
            nonzero += usize::from(report.residual > 1e-9);
            assert_eq!(velocity, problem.velocities(&memory.percussion).unwrap(), "{k} {solver:?}");
        }
    }
    assert!(nonzero > 20, "{nonzero}");
}

/// A contact that has no solution with the percussions of the others, but with other ones: that is no proof.
#[test]
fn a_contact_that_others_can_help_is_not_said_to_have_no_solution() {
    // Painlevé's rod, whose second contact can lift the first.
    let mut delassus = DMatrix::from_row_slice(4, 4, &[0.0; 16]);
    let own = [[1.0, 2.0], [2.0, 3.0]];
    for i in 0..2 {
        for j in 0..2 {
            delassus[(i, j)] = own[i][j];
        }
    }
    (delassus[(2, 2)], delassus[(3, 3)]) = (1.0, 1.0);
    (delassus[(0, 2)], delassus[(2, 0)]) = (0.9, 0.9);
    let law = || Law::from(FrictionLaw::<1>::isotropic(0.8).unwrap());
    let contacts = [0, 1].map(|_| (law(), NormalForce::Unilateral));
    for (last, helped) in [(-2.0, true), (1.0, false)] {
        let free = vec![-1.0, 5.0, last, 0.0];
        let problem = ContactProblem::new(delassus.clone(), free, contacts.clone()).unwrap();
        let (mut memory, mut workspace) = (Memory::new(4, 2), Workspace::default());
        let exact = Solver::Exact { max_sweeps: 1 };
        let report = exact.solve(&problem, Stop::at(1e-10), &mut memory, &mut workspace);
        let alone = workspace
            .infeasibility()
            .is_some_and(|proof| proof.kind == InfeasibilityKind::OneContact);
        assert!(!alone, "{last}: {report:?}");
        // With more sweeps the second contact lifts the first, which opens.
        let exact = Solver::Exact { max_sweeps: 100 };
        let report = exact.solve(&problem, Stop::at(1e-10), &mut memory, &mut workspace);
        assert_eq!(report.status.name() == "converged", helped, "{last}: {report:?}");
    }
}

/// More walls than the search for the nearest weights takes, whose loads are whole multiples of their scales: the proof
/// comes from the percussions that have grown, and among few walls from any.
#[test]
fn proofs_do_not_need_percussions_that_run_away_exactly() {
    for count in [3, 8, 60] {
        for tangential in [1.0, 0.1, 30.0] {
            let angle = |i: usize| TAU * (i / 2) as f64 / count as f64;
            let row = |i: usize| match i % 2 {
                0 => [angle(i).cos(), angle(i).sin()],
                _ => [-angle(i).sin() * tangential, angle(i).cos() * tangential],
            };
            let delassus = DMatrix::from_fn(2 * count, 2 * count, |i, j| {
                4.0 * (row(i)[0] * row(j)[0] + row(i)[1] * row(j)[1])
            });
            // √G_NN = 2.
            let free: Vec<f64> = (0..2 * count)
                .map(|i| if i % 2 == 0 { -2.0 * (1 + i % 3) as f64 } else { 0.0 })
                .collect();
            let law = || Law::from(FrictionLaw::<1>::isotropic(0.4).unwrap());
            let contacts = (0..count).map(|_| (law(), NormalForce::Unilateral));
            let problem = ContactProblem::new(delassus.clone(), free.clone(), contacts).unwrap();
            for solver in [Solver::Exact { max_sweeps: 400 }, Solver::AUTO] {
                let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
                let report = solver.solve(&problem, Stop::at(1e-9), &mut memory, &mut workspace);
                assert_eq!(
                    report.status.name(),
                    "no_solution",
                    "{count} {tangential} {solver:?} {report:?}"
                );
                let proof = workspace.infeasibility().unwrap();
                assert_eq!(
                    proof.kind,
                    InfeasibilityKind::Closing,
                    "{count} {tangential} {solver:?} {report:?}"
                );
                let d = nalgebra::DVector::from_column_slice(&proof.direction);
                let brought = delassus.transpose() * &d;
                for (j, velocity) in brought.iter().enumerate() {
                    assert!(
                        velocity.abs() <= 1e-14 * delassus[(j, j)].sqrt(),
                        "{count}: {velocity:e}"
                    );
                }
                close(d.sum(), 1.0);
                close(
                    proof.closing_velocity,
                    -free.iter().zip(d.iter()).map(|(b, d)| b * d).sum::<f64>(),
                );
            }
        }
    }
}
