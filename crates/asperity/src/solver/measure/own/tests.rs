//! What is measured on the way against what is measured apart.

use nalgebra::DMatrix;

use super::*;
use crate::law::{FrictionLaw, Law};
use crate::random::random;
use crate::solver::measure::natural_residual::{Measured, residual_of};

fn law(p: usize) -> Law {
    match p {
        1 => FrictionLaw::<1>::isotropic(0.3).unwrap().into(),
        2 => FrictionLaw::<2>::isotropic(0.3).unwrap().into(),
        _ => FrictionLaw::<3>::isotropic(0.3).unwrap().into(),
    }
}

/// What is found of a contact on the way is to the bit what is found apart, with percussions and without, for contacts that
/// all have three rows and for contacts of one to four.
#[test]
fn a_measure_on_the_way_has_the_bits_of_one_apart() {
    let mut seed = 3;
    for (case, alike) in (0..40).map(|case| (case, case % 2 == 0)) {
        let contacts = 2 + case % 7;
        let all: Vec<(Law, NormalForce)> = (0..contacts)
            .map(|i| match alike {
                true => (law(2), NormalForce::Unilateral),
                false if i % 3 == 1 => (law(1 + i % 3), NormalForce::Prescribed(0.7)),
                false => (law(1 + i % 3), NormalForce::Unilateral),
            })
            .collect();
        let size = |(law, normal): &(Law, NormalForce)| {
            law.dimension() + usize::from(normal.prescribed().is_none())
        };
        let rows: usize = all.iter().map(size).sum();
        let noise = DMatrix::from_fn(rows, rows, |_, _| random(&mut seed));
        let delassus = &noise * noise.transpose() + DMatrix::identity(rows, rows);
        let free = (0..rows).map(|_| random(&mut seed)).collect();
        let problem = ContactProblem::new(delassus, free, all).unwrap();
        let members: Vec<usize> = (0..contacts).collect();
        for size in [0.0, 1.0] {
            let percussion: Vec<f64> = (0..rows).map(|_| size * random(&mut seed)).collect();
            let (mut apart, mut found) = (vec![0.0; rows], vec![f64::NAN; rows]);
            problem.velocity(&percussion, &mut apart);
            let percussions_of_island = Percussions::of(&problem, &members, &percussion);
            assert_eq!(percussions_of_island.vanish, size == 0.0);
            for i in 0..contacts {
                let defect = percussions_of_island.measure(&problem, i, &mut found);
                let velocity = &apart[problem.contacts()[i].rows()];
                assert_eq!(&found[problem.contacts()[i].rows()], velocity, "{case} {i}");
                let measured =
                    Measured { problem: &problem, percussion: &percussion, velocity: &apart };
                let residual = residual_of(&measured, [i]).value;
                assert_eq!(defect.sqrt(), residual, "{case} {i}");
                found.fill(f64::NAN);
                percussions_of_island.move_one(&problem, i, &mut found);
                assert_eq!(&found[problem.contacts()[i].rows()], velocity, "{case} {i}");
            }
        }
    }
}
