//! Bad input is named.

use asperity::event::{Options, Outcome, Section, integrate};
use asperity::law::FrictionLaw;
use asperity::set::{Convex, Cuboid, Vector};
use asperity::system::{Contact, LinearSystem, System, sliding_point};
use nalgebra::DMatrix;

use crate::support::*;

fn refused(system: &dyn System, options: &Options) -> String {
    integrate(system, options).unwrap_err().to_string()
}

#[test]
fn bad_options_are_named() {
    let system = sliding_point(1.0, FrictionLaw::isotropic(0.5).unwrap(), 10.0).unwrap();
    let good = options(&[0.0; 2], &[0.0; 2], 1.0);
    let section = |normal: Vec<f64>, level| Section { normal, level, after: 0.0 };
    let mut backwards = good.clone();
    backwards.t_end = -1.0;
    let cases = [
        ("t_end", backwards),
        ("q0", good.clone().with_start(&[0.0], &[0.0; 2])),
        ("u0", good.clone().with_start(&[0.0; 2], &[0.0, f64::NAN])),
        ("tolerance", good.clone().with_tolerance(0.0)),
        ("tolerance", good.clone().with_tolerance(1.0)),
        ("sample_every", good.clone().with_sample(0.0)),
        ("section", good.clone().with_section(section(vec![1.0], 0.0))),
        ("section", good.clone().with_section(section(vec![1.0; 4], f64::NAN))),
        ("max_events", good.clone().with_max_events(0)),
    ];
    assert!(Options::new(f64::NAN).unwrap_err().to_string().starts_with("t_end"));
    for (argument, options) in cases {
        let message = refused(&system, &options);
        assert!(message.starts_with(argument), "{message}");
    }
}

#[test]
fn systems_that_cannot_be_integrated_are_refused() {
    let square = Convex::from(Cuboid::symmetric(Vector::<2>::new(0.5, 0.3)).unwrap());
    let table = sliding_point(1.0, FrictionLaw::associated(square), 10.0).unwrap();
    let message = refused(&table, &options(&[0.0; 2], &[1.0, 0.0], 1.0));
    assert!(message.contains("direction set of contact 0"), "{message}");

    let one = DMatrix::identity(1, 1);
    let law = FrictionLaw::<1>::isotropic(0.5).unwrap();
    let contact = Contact::unilateral(law, one.clone(), vec![1.0], -0.1);
    let zero = DMatrix::zeros(1, 1);
    let deep = LinearSystem::new(one, zero.clone(), zero, vec![0.0], vec![contact]).unwrap();
    let message = refused(&deep, &options(&[0.0], &[0.0], 1.0));
    assert!(message.starts_with("q0: must not let contacts overlap"), "{message}");
}

#[test]
fn runs_stop_when_they_are_told_to() {
    let system = sliding_point(1.0, FrictionLaw::isotropic(0.5).unwrap(), 10.0).unwrap();
    let good = options(&[0.0; 2], &[1.0, 0.0], 1.0);
    let few = good.with_max_events(1);
    let run = integrate(&system, &few).unwrap();
    assert!(matches!(run.outcome, Outcome::TooManyEvents));
    assert_eq!(run.motion.events.len(), 1);
}
