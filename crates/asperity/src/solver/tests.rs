//! Tests of solves as a whole.

use std::cell::Cell;

use nalgebra::DMatrix;

use super::measure::natural_residual::Measured;
use super::*;
use crate::contact::{ContactProblem, NormalForce};
use crate::law::FrictionLaw;

/// Whenever time ends, also between two measures, what is said is the measure of the percussions that are returned.
#[test]
fn velocities_and_residuals_are_those_of_the_percussions_whenever_time_ends() {
    let law = crate::law::Law::from(FrictionLaw::<1>::isotropic(0.5).unwrap());
    let mut ended = Vec::new();
    // Of the last two contacts the whole sees nothing where their loads are small.
    for (coupling, load) in [(0.45, 1.0), (1e-4, 1e-13)] {
        let mut delassus = DMatrix::identity(6, 6);
        for (i, j, value) in [(0, 1, coupling), (2, 3, coupling), (4, 5, 0.45)] {
            (delassus[(i, j)], delassus[(j, i)]) = (value, value);
        }
        let contacts = vec![(law.clone(), NormalForce::Prescribed(2.0)); 6];
        let free = vec![0.3, 0.2, 0.3, 0.4, -0.2 * load, -0.3 * load];
        let problem = ContactProblem::new(delassus, free, contacts).unwrap();
        let measures = [Measure::Contact, Measure::Global].into_iter();
        for (measure, questions) in measures.flat_map(|m| (0..40).map(move |n| (m, n))) {
            let left = Cell::new(questions);
            let ask = || {
                let none = left.get() == 0;
                left.set(usize::saturating_sub(left.get(), 1));
                none
            };
            let stop = Stop::at(1e-10).with_measure(measure).unless(&ask);
            let solution = problem.solve(&Solver::default(), stop);
            let velocity = problem.velocities(&solution.percussion).unwrap();
            assert_eq!(solution.velocity, velocity, "{load} {measure:?} {questions}");
            let residual = stop.residual(&problem, &solution.percussion, &velocity).value;
            assert_eq!(solution.report.residual, residual, "{load} {measure:?} {questions}");
            assert_eq!(solution.report.status == Status::Converged, residual <= 1e-10);
            ended.push(solution.report.status);
        }
    }
    assert!(ended.contains(&Status::TimeLimit) && ended.contains(&Status::Converged));
}

/// Of contacts without any defect the first one is named.
#[test]
fn the_worst_contact_is_one_of_those_that_are_asked_for() {
    let law = FrictionLaw::<1>::isotropic(0.5).unwrap();
    let contacts = vec![(law.into(), NormalForce::Unilateral); 3];
    let problem = ContactProblem::new(DMatrix::identity(6, 6), vec![0.0; 6], contacts).unwrap();
    let measured = Measured { problem: &problem, percussion: &[0.0; 6], velocity: &[0.0; 6] };
    let residual = measure::natural_residual::residual_of(&measured, [1, 2]);
    assert_eq!((residual.value, residual.worst_contact), (0.0, 1));
}
