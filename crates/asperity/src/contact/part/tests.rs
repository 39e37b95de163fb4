//! Velocities of some contacts against those of the whole problem.

use nalgebra::DMatrix;

use super::*;
use crate::contact::{BlockMatrix, Csr, Delassus, Factored, NormalForce};
use crate::law::{FrictionLaw, Law};

/// A chain of bodies, of which every contact touches two, with contacts of all kinds: its operator as blocks, of bodies, and
/// as blocks that are not symmetric.
fn chain(bodies: usize) -> Vec<ContactProblem> {
    let line = Law::from(FrictionLaw::<1>::isotropic(0.4).unwrap());
    let plane = Law::from(FrictionLaw::<2>::isotropic(0.4).unwrap());
    let space = Law::from(FrictionLaw::<3>::isotropic(0.4).unwrap());
    let kinds = [(plane, NormalForce::Unilateral), (line, NormalForce::Prescribed(2.0))];
    let kinds = [kinds[0].clone(), kinds[1].clone(), (space, NormalForce::Unilateral)];
    let contacts: Vec<_> = (0..bodies - 1).map(|i| kinds[i % 3].clone()).collect();
    let sizes: Vec<usize> = (0..bodies - 1).map(|i| [3, 1, 4][i % 3]).collect();
    let rows = sizes.iter().sum();
    let owner: Vec<usize> = sizes.iter().enumerate().flat_map(|(i, &size)| vec![i; size]).collect();
    let directions = DMatrix::from_fn(rows, 3 * bodies, |row, dof| {
        let touches = dof / 3 == owner[row] || dof / 3 == owner[row] + 1;
        if touches { ((row * 7 + dof * 3) % 11) as f64 - 4.5 } else { 0.0 }
    });
    let mass = DMatrix::from_fn(3 * bodies, 3 * bodies, |i, j| match i == j {
        true => 1.0 + i as f64,
        false => 0.0,
    });
    let dense = &directions * mass.clone().try_inverse().unwrap() * directions.transpose();
    let sparse = |matrix| Csr::from_dense(matrix).unwrap();
    let blocks = |matrix| BlockMatrix::from_csr(&sparse(matrix), &sizes).unwrap();
    let factored = Factored::new(sparse(&mass), sparse(&directions), &sizes);
    let skew = DMatrix::from_fn(rows, rows, |i, j| dense[(i, j)] * (1.0 + 0.1 * i as f64));
    let forms: [Delassus; 3] =
        [blocks(&dense).into(), factored.unwrap().into(), blocks(&skew).into()];
    let problem = |form| {
        let free = (0..rows).map(|row| (row % 5) as f64 - 2.0).collect();
        let before: Vec<f64> = (0..rows).map(|row| (row % 4) as f64 - 1.0).collect();
        let restitution = vec![0.5; sizes.len()];
        let problem = ContactProblem::new(form, free, contacts.clone()).unwrap();
        problem.with_restitution(&restitution, &restitution, &before).unwrap()
    };
    forms.map(problem).into()
}

/// Neighbours within the part are kept: velocities are those of the whole where only the part has percussions.
#[test]
fn velocities_of_some_contacts_are_those_in_the_whole() {
    for whole in chain(8) {
        let percussion: Vec<f64> = (0..whole.rows()).map(|row| 0.1 * row as f64 + 1.0).collect();
        let mut velocity = vec![0.0; whole.rows()];
        for contacts in [&[0, 1, 2][..], &[2, 3, 5], &[6], &[0, 1, 2, 3, 4, 5, 6]] {
            let mut part = Part::new(&whole, contacts);
            part.copy_velocities(&whole);
            let rows = part.rows().len();
            let (mut own, mut expected) = (vec![0.0; rows], vec![0.0; rows]);
            take(part.rows(), &percussion, &mut own);
            let mut alone = vec![0.0; whole.rows()];
            put(part.rows(), &own, &mut alone);
            whole.velocity(&alone, &mut velocity);
            take(part.rows(), &velocity, &mut expected);
            let mut found = vec![0.0; rows];
            part.problem().velocity(&own, &mut found);
            let size = expected.iter().fold(1.0, |m: f64, v| m.max(v.abs()));
            for (one, other) in found.iter().zip(&expected) {
                assert!((one - other).abs() <= 1e-13 * size, "{contacts:?}: {one} {other}");
            }
            let normals = contacts.iter().map(|&i| whole.contacts()[i].normal);
            assert!(part.problem().contacts().iter().map(|own| own.normal).eq(normals));
            take(part.rows(), whole.restitution(), &mut expected);
            assert_eq!(part.problem().restitution(), expected);
            let within = contacts.windows(2).filter(|pair| pair[1] == pair[0] + 1).count();
            let blocks = part.problem().delassus().blocks();
            let count = (0..contacts.len()).map(|i| blocks.neighbours(i).len()).sum::<usize>();
            assert_eq!(count, contacts.len() + 2 * within, "{contacts:?}");
        }
    }
}
