use asperity_set::{Convex, Ellipse, Star, Superellipse};

use super::*;
use crate::random::random;

/// A problem of one to three contacts, hinges among them, with percussions that solve it, however close to a limit.
fn with_a_solution(seed: &mut u64) -> ContactProblem {
    let freedoms = pick(seed, 4) + 1;
    let mut contacts = Vec::new();
    let (mut directions, mut percussion, mut velocity) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..=pick(seed, 3) {
        let (p, bilateral) = (1 + pick(seed, 2), pick(seed, 5) == 0);
        let law = law(seed, p);
        let seen = vector(seed, freedoms);
        let hinge = pick(seed, 2) == 0;
        for _ in 0..p + usize::from(!bilateral) {
            let along = random(seed);
            let other = vector(seed, freedoms);
            // A row may be far larger or smaller than the others of its contact.
            let size = 10_f64.powf(3.0 * random(seed) * f64::from(pick(seed, 4) == 0));
            directions.push(if hinge { &seen * along } else { other } * size);
        }
        let size = 10_f64.powf(2.0 * random(seed));
        let near = [0.0, 1e-9, 1e-4, random(seed).abs()][pick(seed, 4)];
        let mut angle = PI * random(seed);
        if p == 1 {
            angle = [0.0, PI][pick(seed, 2)];
        }
        let z = match &law {
            Law::One(_) => unit(angle),
            Law::Two(law) => law.direction().support_point(&unit(angle)),
            Law::Zero(_) | Law::Three(_) => unreachable!(),
        };
        let friction = -z / law.gauge(&z.as_slice()[..p]);
        let normal =
            if bilateral { NormalForce::Prescribed(size) } else { NormalForce::Unilateral };
        let state = pick(seed, 3) + usize::from(bilateral);
        let (push, lift, friction, slip) = match state {
            0 => (0.0, near, friction, unit(angle) * random(seed)),
            1 => (size, 0.0, friction * (1.0 - near), Vector::<2>::zeros()),
            _ => (size, 0.0, friction, unit(angle) * near),
        };
        if !bilateral {
            percussion.push(push);
            velocity.push(lift);
        }
        percussion.extend((0..p).map(|k| push * friction[k]));
        velocity.extend((0..p).map(|k| slip[k]));
        contacts.push((law, normal));
    }
    let w = DMatrix::from_columns(&directions);
    let root = DMatrix::from_fn(freedoms, freedoms, |i, j| random(seed) + f64::from(i == j));
    let operator = (&root * &w).transpose() * (&root * &w);
    let free = DVector::from_vec(velocity) - &operator * DVector::from_vec(percussion);
    ContactProblem::new(operator, free.as_slice().to_vec(), contacts).unwrap()
}

fn law(seed: &mut u64, p: usize) -> Law {
    let mu = 0.65 + 0.55 * random(seed);
    if p == 1 {
        return FrictionLaw::<1>::isotropic(mu).unwrap().into();
    }
    let axes = Vector::<2>::new(mu, mu * (0.65 + 0.35 * random(seed)));
    let ellipse = Convex::from(Ellipse::new(axes).unwrap()).rotated(PI * random(seed)).unwrap();
    match pick(seed, 3) {
        0 => FrictionLaw::<2>::isotropic(mu).unwrap().into(),
        1 => FrictionLaw::associated(ellipse).into(),
        _ => {
            let exponent = 3.6 + 2.4 * random(seed);
            let axes = Vector::<2>::new(1.0, 0.6 + 0.4 * random(seed));
            let direction = Star::from(Superellipse::new(axes, exponent).unwrap());
            let direction = direction.as_convex().unwrap().rotated(PI * random(seed)).unwrap();
            FrictionLaw::new(Star::Convex(ellipse), direction).unwrap().into()
        }
    }
}

fn pick(seed: &mut u64, count: usize) -> usize {
    ((0.5 + 0.5 * random(seed)) * count as f64) as usize % count
}

fn vector(seed: &mut u64, size: usize) -> DVector<f64> {
    DVector::from_fn(size, |_, _| random(seed))
}

fn never_proven(count: usize) {
    let mut seed = 7_u64;
    for k in 0..count {
        let problem = with_a_solution(&mut seed);
        assert_eq!(prove_by_cases(&problem, Stop::default()), None, "{k} {problem:?}");
    }
}

#[test]
fn problems_with_a_solution_are_not_refuted() {
    never_proven(200);
}

#[test]
#[ignore = "ten thousand searches that do not end early"]
fn many_problems_with_a_solution_are_not_refuted() {
    never_proven(10_000);
}
