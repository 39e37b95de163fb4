//! What the features of the crate change: time and reach, never a result that needs no factored matrix of several
//! contacts.
//!
//! Every run writes the bits that it has found into the folder of the build, under a name made of all sources, and
//! compares them with those of other features that it finds there: `make test` runs this file with and without default
//! features.

mod common;

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

use asperity::contact::{BlockMatrix, ContactProblem, NormalForce};
use asperity::event;
use asperity::law::{FrictionLaw, Law};
use asperity::simulate::{Options, simulate};
use asperity::solver::{ProxStep, Solver, Status, Steps, Stop};
use asperity::system::rigid::{Body, Pair, Plane, RigidBodies, Shape};
use asperity::system::sliding_point;
use common::{FAMILIES, Random, laws, one_contact};

/// All files below a folder, in a fixed order.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut entries: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    entries.sort();
    let inside = |path: PathBuf| if path.is_dir() { files(&path) } else { vec![path] };
    entries.into_iter().flat_map(inside).collect()
}

/// A number that changes with every source of both crates, with this file and with the profile of the build.
fn fingerprint() -> u64 {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut hasher = DefaultHasher::new();
    for folder in ["src", "../asperity-set/src", "tests"] {
        for file in files(&own.join(folder)) {
            fs::read(file).unwrap().hash(&mut hasher);
        }
    }
    (cfg!(debug_assertions), std::env::consts::ARCH).hash(&mut hasher);
    hasher.finish()
}

/// The bits of everything that is computed without factors of a large matrix.
fn bits() -> Vec<u64> {
    let mut found: Vec<f64> = Vec::new();
    let mut random = Random::new(31);
    for (_, law) in laws() {
        let law = Law::from(law);
        for family in FAMILIES {
            for _ in 0..5 {
                let problem = one_contact(law.clone(), family, &mut random);
                let solution = problem.solve(&Solver::default(), Stop::default());
                found.extend(solution.percussion);
                found.push(solution.report.residual);
            }
        }
    }
    // Contacts that do not influence each other, more than one thread takes at a time, and such that do, by sweeps.
    let law = Law::from(FrictionLaw::<2>::isotropic(0.4).unwrap());
    let count = 2000;
    for coupling in [0.0, 0.05] {
        let near = |i: usize| {
            let last = if coupling == 0.0 { i } else { (i + 1).min(count - 1) };
            (i.saturating_sub(last - i)..=last).collect()
        };
        let neighbours: Vec<Vec<usize>> = (0..count).map(near).collect();
        let mut blocks = BlockMatrix::from_pattern(&vec![3; count], &neighbours).unwrap();
        for i in 0..count {
            for k in 0..blocks.neighbours(i).len() {
                let (j, block) = blocks.block_mut(i, k);
                (0..3).for_each(|a| block[4 * a] = if i == j { 1.0 } else { coupling });
            }
        }
        let free = (0..3 * count).map(|_| random.within(-1.0, 1.0)).collect();
        let contacts = (0..count).map(|_| (law.clone(), NormalForce::Unilateral));
        let problem = ContactProblem::new(blocks, free, contacts).unwrap();
        let auto = Solver::Auto { steps: Steps::ALL, threads: 4 };
        let exact = Solver::Exact { max_sweeps: 500 };
        let prox = Solver::ProxJacobi { step: ProxStep::Adaptive, max_iterations: 100_000 };
        for solver in [auto, exact, prox] {
            let solution = problem.solve(&solver, Stop::default());
            assert_eq!(solution.report.status, Status::Converged, "{solver:?}");
            found.extend(solution.percussion);
        }
    }
    // Motions, from step to step and from event to event.
    let point = sliding_point(1.0, FrictionLaw::isotropic(0.3).unwrap(), 9.81).unwrap();
    let ball =
        Body { velocity: [1.0, 0.2, 0.0], position: [0.0, 0.0, 0.1], ..Body::ball(1.0, 0.1) };
    let plane = Plane::floor();
    let shape = Shape::SpherePlane { body: 0, centre: [0.0; 3], radius: 0.1, plane };
    let ball =
        RigidBodies::new(vec![ball], &[Pair::new(shape, law)], vec![], [0.0, 0.0, -9.81]).unwrap();
    let mut options = Options::new(1e-3, 0.5).unwrap();
    let run = simulate(&ball, &options).unwrap();
    found.extend(run.trajectory.samples.q);
    options = options.with_start(&[0.0; 2], &[1.0, 0.5]);
    let run = simulate(&point, &options).unwrap();
    found.extend(run.trajectory.samples.q);
    let options = event::Options::new(0.5).unwrap().with_start(&[0.0; 2], &[1.0, 0.5]);
    let run = event::integrate(&point, &options).unwrap();
    found.extend(run.motion.samples.q);
    found.into_iter().map(f64::to_bits).collect()
}

#[test]
fn features_change_no_bit() {
    let own = format!("parallel={}", cfg!(feature = "parallel"));
    let found: Vec<String> = bits().into_iter().map(|bits| format!("{bits:016x}")).collect();
    let found = found.join("\n");
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let prefix = format!("bits {:016x} ", fingerprint());
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if let Some(features) = name.strip_prefix(&prefix) {
            assert!(fs::read_to_string(&path).unwrap() == found, "{features} and {own} differ");
        } else if name.starts_with("bits ") {
            // Of sources that are no more.
            fs::remove_file(&path).unwrap();
        }
    }
    fs::write(folder.join(prefix + &own), found).unwrap();
}
