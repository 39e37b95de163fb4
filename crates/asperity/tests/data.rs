//! Laws, problems and motions are written and read back to the bit, and what is none is refused.

mod common;

use std::collections::BTreeSet;
use std::fmt::Debug;
use std::sync::Arc;

use asperity::contact::{
    BlockMatrix, ContactProblem, Csr, DelassusOperator, Factored, MatrixFree, NormalForce,
};
use asperity::event::{self, Motion};
use asperity::law::data::LawFile;
use asperity::law::{Fall, FrictionLaw, Law, Stribeck};
use asperity::set::{Ball, CoulombContensou, Ellipsoid, Interval, Pressure, Vector};
use asperity::simulate::{Options, simulate};
use asperity::system::sliding_point;
use asperity::trajectory::Trajectory;
use common::{FAMILIES, Random, laws, one_contact};
use nalgebra::DMatrix;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The same value out of both formats; a printed number has all its digits.
fn returns<T: Serialize + DeserializeOwned + Debug>(value: &T) -> String {
    let json = serde_json::to_string(value).unwrap();
    let toml = toml::to_string(value).unwrap();
    for read in [serde_json::from_str::<T>(&json).unwrap(), toml::from_str(&toml).unwrap()] {
        assert_eq!(format!("{read:?}"), format!("{value:?}"), "{toml}");
    }
    toml
}

/// What the law says of random slips.
fn answers<const P: usize>(law: &FrictionLaw<P>) -> Vec<u64> {
    let mut random = Random::new(3);
    let mut found = vec![law.alpha_min()];
    for _ in 0..50 {
        let slip = Vector::<P>::from_fn(|_, _| random.normal());
        found.extend(law.force(&slip, random.within(0.1, 9.0)).unwrap().iter());
        found.push(law.alpha(&slip));
    }
    found.into_iter().map(f64::to_bits).collect()
}

fn law_returns<const P: usize>(law: FrictionLaw<P>) -> String {
    let toml = toml::to_string(&law).unwrap();
    let json = serde_json::to_string(&law).unwrap();
    let (a, b): (FrictionLaw<P>, FrictionLaw<P>) =
        (toml::from_str(&toml).unwrap(), serde_json::from_str(&json).unwrap());
    for read in [a, b] {
        assert_eq!(read, law, "{toml}");
        assert_eq!(answers(&read), answers(&law), "{toml}");
        assert_eq!(read.isotropic_coefficient(), law.isotropic_coefficient());
        assert_eq!(read.is_associated(), law.is_associated());
    }
    let any: Law = toml::from_str(&toml).unwrap();
    assert_eq!((any.dimension(), any.alpha_min()), (P, law.alpha_min()));
    toml
}

#[test]
fn laws_come_back_to_the_bit() {
    let mut random = Random::new(8);
    for (_, law) in laws() {
        law_returns(law.rotated(random.within(-3.0, 3.0)).unwrap());
        let fall = [Fall::Exponential, Fall::Hyperbolic][usize::from(random.unit() < 0.5)];
        let (speed, exponent) = (random.within(0.01, 1.0), random.within(0.5, 2.0));
        let rate =
            Stribeck::new(fall, speed, random.unit(), exponent, 0.1 * random.unit()).unwrap();
        law_returns(law.with_rate(rate));
    }
    for _ in 0..200 {
        let mu = random.within(0.05, 2.0);
        law_returns(FrictionLaw::<1>::isotropic(mu).unwrap());
        law_returns(FrictionLaw::<3>::isotropic(mu).unwrap());
        let ends = [-random.within(0.1, 1.0), random.within(0.1, 1.0)].map(Vector::<1>::new);
        law_returns(FrictionLaw::associated(Interval::new(ends[0], ends[1]).unwrap().into()));
        let axes = Vector::<3>::from_fn(|_, _| random.within(0.1, 1.0));
        let direction = Ellipsoid::new(axes).unwrap().into();
        law_returns(FrictionLaw::new(Ball::new(mu).unwrap().into(), direction).unwrap());
    }
    let contensou = CoulombContensou::new(0.3, Pressure::Uniform).unwrap();
    law_returns(FrictionLaw::associated(contensou.into()));
}

#[test]
fn laws_are_written_in_the_words_of_their_constructors() {
    let ellipse = Ellipsoid::new(Vector::<2>::new(0.54, 0.48)).unwrap();
    let law = FrictionLaw::associated(ellipse.into());
    let rate = Stribeck::new(Fall::Hyperbolic, 0.1, 0.5, 1.0, 0.0).unwrap();
    let text = law_returns(law.with_rate(rate));
    assert_eq!(
        text,
        "[reservoir]\ntype = \"Ellipse\"\na = 0.54\nb = 0.48\n\n\
         [direction]\ntype = \"Ellipse\"\na = 0.54\nb = 0.48\n\n\
         [rate]\nspeed = 0.1\nratio = 0.5\nshape = \"hyperbolic\"\nexponent = 1.0\nviscous = 0.0\n"
    );
    let short = "reservoir = { type = \"Disk\", radius = 0.3 }\n\
                 direction = { type = \"Disk\", radius = 1.0 }\nrate = { speed = 0.2 }\n";
    let law: FrictionLaw<2> = toml::from_str(short).unwrap();
    assert_eq!((law.isotropic_coefficient(), law.rate().unwrap().exponent()), (Some(0.3), 1.0));
    for (text, complaint) in [
        ("reservoir = { type = \"Disk\", radius = 0.3 }", "missing field `direction`"),
        (
            "reservoir = { type = \"Disk\", radius = 0.3 }\n\
             direction = { type = \"Interval\", lower = -1.0, upper = 1.0 }",
            "set: must be one of R^2",
        ),
        (
            "reservoir = { type = \"Box\", half_widths = [1.0, 1.0, 1.0, 1.0] }\n\
             direction = { type = \"Disk\", radius = 0.3 }",
            "reservoir: must be a set of one, two or three dimensions",
        ),
        (
            "reservoir = { type = \"Disk\", radius = 0.3 }\n\
             direction = { type = \"Disk\", radius = 0.3 }\nrate = { speed = -0.2 }",
            "speed: must be finite and positive",
        ),
        (
            "reservoir = { type = \"Disk\", radius = 0.3 }\n\
             direction = { type = \"Disk\", radius = 0.3 }\nload = 3.0",
            "unknown field `load`",
        ),
    ] {
        let error = toml::from_str::<Law>(text).unwrap_err().to_string();
        assert!(error.contains(complaint), "{text}\n{error}");
    }
}

/// Products only.
#[derive(Debug)]
struct Products;

impl DelassusOperator for Products {
    fn rows(&self) -> usize {
        3
    }

    fn apply(&self, percussion: &[f64], velocity: &mut [f64]) {
        velocity.copy_from_slice(percussion);
    }
}

#[test]
fn problems_come_back_to_the_bit() {
    let mut random = Random::new(5);
    let solved = |problem: &ContactProblem| {
        let solution = problem.solve(&Default::default(), Default::default());
        solution.percussion.into_iter().map(f64::to_bits).collect::<Vec<_>>()
    };
    let check = |problem: &ContactProblem| {
        let text = serde_json::to_string(problem).unwrap();
        let read: ContactProblem = serde_json::from_str(&text).unwrap();
        let other: ContactProblem = toml::from_str(&toml::to_string(problem).unwrap()).unwrap();
        assert!(&read == problem && &other == problem, "{text}");
        assert_eq!(solved(&read), solved(problem));
        text
    };
    for (_, law) in laws() {
        let law = Law::from(law);
        for family in FAMILIES {
            let problem = one_contact(law.clone(), family, &mut random);
            check(&problem);
            let velocity: Vec<f64> = (0..problem.rows()).map(|_| random.normal()).collect();
            check(&problem.with_restitution(&[0.3], &[0.1], &velocity).unwrap());
        }
    }
    let law = Law::from(FrictionLaw::<2>::isotropic(0.4).unwrap());
    let contacts = [
        (law.clone(), NormalForce::Unilateral),
        (FrictionLaw::<1>::isotropic(0.2).unwrap().into(), NormalForce::Prescribed(2.0)),
        (law, NormalForce::Unilateral),
    ];
    let sizes = [3, 1, 3];
    let mut blocks = BlockMatrix::from_pattern(&sizes, &[vec![0, 1], vec![0, 1], vec![2]]).unwrap();
    for i in 0..3 {
        for k in 0..blocks.neighbours(i).len() {
            let (j, block) = blocks.block_mut(i, k);
            block.iter_mut().for_each(|g| *g = 0.1 * random.normal());
            if i == j {
                (0..sizes[i]).for_each(|a| block[(sizes[i] + 1) * a] = 2.0);
            }
        }
    }
    let free: Vec<f64> = (0..7).map(|_| random.normal()).collect();
    let problem = ContactProblem::new(blocks, free.clone(), contacts.clone()).unwrap();
    let text = check(&problem);
    // Contacts that share a law share it in the data.
    assert_eq!(text.matches("\"reservoir\"").count(), 2, "{text}");
    let mass = Csr::new(2, 2, vec![0, 1, 2], vec![0, 1], vec![2.0, 0.5]).unwrap();
    let starts: Vec<usize> = (0..8).map(|i| 2 * i).collect();
    let values: Vec<f64> = (0..14).map(|_| random.normal()).collect();
    let directions = Csr::new(7, 2, starts, [0, 1].repeat(7), values).unwrap();
    let factored = Factored::new(mass, directions, &sizes).unwrap();
    check(&ContactProblem::new(factored, free, contacts.clone()).unwrap());
    let mixed = [(Law::frictionless(), NormalForce::Unilateral), contacts[0].clone()];
    let problem = ContactProblem::new(DMatrix::identity(4, 4), vec![-1.0; 4], mixed).unwrap();
    let text = check(&problem);
    assert_eq!(text.matches("\"law\"").count(), 1, "{text}");
    let free = MatrixFree::new(Arc::new(Products), &[3]).unwrap();
    let problem = ContactProblem::new(free, vec![-1.0; 3], contacts[..1].to_vec()).unwrap();
    let error = serde_json::to_string(&problem).unwrap_err().to_string();
    assert!(error.contains("delassus: must have entries"), "{error}");
}

#[test]
fn what_is_no_problem_is_refused() {
    let law = Law::from(FrictionLaw::<2>::isotropic(0.4).unwrap());
    let contacts = [(law, NormalForce::Unilateral)];
    let problem = ContactProblem::new(DMatrix::identity(3, 3), vec![-1.0; 3], contacts).unwrap();
    let text = serde_json::to_string(&problem).unwrap();
    for (from, to, complaint) in [
        ("\"law\":0", "\"law\":1", "contacts: must have the numbers of laws"),
        ("[-1.0,-1.0,-1.0]", "[-1.0,-1.0]", "free_velocity: must have 3 entries"),
        ("[0.0,0.0,0.0]}", "[0.0,0.0]}", ""),
        ("[1.0,0.0,0.0]", "[-1.0,0.0,0.0]", "delassus: must be positive"),
        ("[1.0,0.0,0.0]", "[1.0,0.0]", "delassus: must have as many columns as rows"),
        ("\"type\":\"Dense\"", "\"type\":\"Sparse\"", "unknown variant `Sparse`"),
        ("\"law\":0", "\"law\":0,\"normal_force\":1.0", "free_velocity: must have 2 entries"),
        ("\"law\":0", "\"normal_force\":1.0", "free_velocity: must have 0 entries"),
        ("\"law\":0", "\"law\":0,\"friction\":1.0", "unknown field `friction`"),
        ("\"radius\":0.4", "\"radius\":-0.4", "radius: must be"),
    ] {
        let changed = text.replacen(from, to, 1);
        if complaint.is_empty() {
            continue;
        }
        assert_ne!(changed, text, "{from}");
        let error = serde_json::from_str::<ContactProblem>(&changed).unwrap_err().to_string();
        assert!(error.contains(complaint), "{changed}\n{error}");
    }
}

#[test]
fn motions_come_back_to_the_bit() {
    let point = sliding_point(1.0, FrictionLaw::isotropic(0.3).unwrap(), 9.81).unwrap();
    let options = Options::new(1e-2, 0.5).unwrap().with_start(&[0.0; 2], &[1.0, 0.3]);
    let run = simulate(&point, &options).unwrap();
    let text = returns(&run.trajectory);
    assert!(text.contains("\"nan\""), "the first sample has no forces");
    let options = event::Options::new(0.5).unwrap().with_start(&[0.0; 2], &[1.0, 0.3]);
    let run = event::integrate(&point, &options).unwrap();
    assert!(!run.motion.events.is_empty());
    let motion = returns(&run.motion);
    let refused = |text: &str, from: &str, to: &str, complaint: &str| {
        let changed = text.replacen(from, to, 1);
        assert_ne!(changed, text, "{from}");
        let error = match text.contains("iterations") {
            true => toml::from_str::<Trajectory>(&changed).unwrap_err().to_string(),
            false => toml::from_str::<Motion>(&changed).unwrap_err().to_string(),
        };
        assert!(error.contains(complaint), "{error}");
    };
    refused(&text, "coordinates = 2", "coordinates = 3", "samples: must have");
    refused(&text, "contacts = 1", "contacts = 18446744073709551", "samples: must have");
    refused(&text, "p = 2", "p = 7", "p: must be at most 3");
    refused(&text, "iterations = [0", "iterations = [0, 0", "trajectory: must have");
    refused(&text, "phase = [-1", "phase = [-2", "phase: must be");
    refused(&text, "\"nan\"", "\"none\"", "a number");
    refused(&text, "failed_steps", "failed", "unknown field `failed`");
    refused(&motion, "contact = 0", "contact = 9", "events: must be of contacts");
    refused(&motion, "kind = \"stick\"", "kind = \"glue\"", "unknown variant `glue`");
}

/// Files that Python has written: `python tests/stored_laws.py` writes them anew.
const STORED: [&str; 7] = ["plane", "reported", "engine", "line", "drilling", "space", "pentagon"];

fn stored(name: &str) -> String {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/laws");
    std::fs::read_to_string(format!("{folder}/{name}")).unwrap()
}

fn force(law: &Law, slip: &[f64]) -> Vec<f64> {
    fn of<const P: usize>(law: &FrictionLaw<P>, slip: &[f64]) -> Vec<f64> {
        law.force(&Vector::from_column_slice(slip), 2.0).unwrap().as_slice().to_vec()
    }
    match law {
        Law::Zero(_) => unreachable!(),
        Law::One(law) => of(law, slip),
        Law::Two(law) => of(law, slip),
        Law::Three(law) => of(law, slip),
    }
}

#[test]
fn files_of_python_are_read() {
    let expected: serde_json::Value = serde_json::from_str(&stored("forces.json")).unwrap();
    for name in STORED {
        let file: LawFile = toml::from_str(&stored(&format!("{name}.toml"))).unwrap();
        let numbers = |key: &str| -> Vec<Vec<f64>> {
            serde_json::from_value(expected[name][key].clone()).unwrap()
        };
        let (slips, forces) = (numbers("slip"), numbers("force"));
        assert!(slips.len() > 9);
        for (slip, wanted) in slips.iter().zip(forces) {
            for (found, wanted) in force(&file.law, slip).iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-9, "{name}: {found} instead of {wanted}");
            }
        }
        returns(&file);
    }
}

#[test]
fn both_languages_have_the_same_kinds_of_sets() {
    let complaint = toml::from_str::<Law>("reservoir = { type = \"none\" }").unwrap_err();
    let listed = complaint.message().split_once("expected one of ").unwrap().1;
    let mut known: BTreeSet<&str> = listed.split(", ").map(|name| name.trim_matches('`')).collect();
    // Python has superellipses of the plane only.
    assert!(known.remove("Superellipsoid"));
    let files: String = STORED.map(|name| stored(&format!("{name}.toml"))).concat();
    let kinds = files.lines().filter_map(|line| line.strip_prefix("type = "));
    assert_eq!(kinds.map(|name| name.trim_matches('"')).collect::<BTreeSet<_>>(), known);
}

#[test]
fn files_of_laws_say_what_they_are() {
    let text = stored("line.toml");
    for (old, new, complaint) in [
        ("asperity law", "asperity set", "format: must be \"asperity law\""),
        ("version = 1", "version = 2", "version: must be 1 to 1"),
        ("version = 1\n", "", "missing field `version`"),
        ("[law.reservoir]", "[law.reservior]", "unknown field `reservior`"),
    ] {
        let wrong = text.replacen(old, new, 1);
        let told = toml::from_str::<LawFile>(&wrong).unwrap_err().to_string();
        assert!(told.contains(complaint), "{told}");
    }
}
