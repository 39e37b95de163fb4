//! Every method on random problems that have a solution, in every form of the operator, against the natural map and
//! against each other.

mod common;

use std::cell::Cell;

use asperity::contact::{
    BlockMatrix, ContactProblem, Csr, Delassus, Factored, Memory, NormalForce, Phase,
};
use asperity::law::{FrictionLaw, Law};
use asperity::set::{Convex, Ellipse, Ellipsoid, Vector};
use asperity::solver::{
    Measure, Method, ProxStep, SolveReport, Solver, Status, Steps, Stop, Workspace, natural_map,
    natural_residual,
};
use common::Random;
use nalgebra::{DMatrix, DVector};

const TOLERANCE: f64 = 1e-9;

/// What makes a problem hard.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Situation {
    /// Fewer rows than velocities of bodies.
    Regular,
    /// More contacts than bodies can tell apart: `G` has no full rank.
    Redundant,
    /// Bodies whose masses differ by ten thousand, in both orders.
    LightOnHeavy,
    HeavyOnLight,
    /// Normal free velocities that vanish.
    Grazing,
}

const SITUATIONS: [Situation; 5] = [
    Situation::Regular,
    Situation::Redundant,
    Situation::LightOnHeavy,
    Situation::HeavyOnLight,
    Situation::Grazing,
];

fn without_conic_methods() -> Steps {
    Steps::ALL.without("admm").and_then(|left| left.without("interior_point")).unwrap()
}

/// Velocities of a body.
const DOF: usize = 6;

fn laws(p: usize) -> Vec<Law> {
    let axes = [0.4, 0.2, 0.3];
    match p {
        1 => vec![FrictionLaw::<1>::isotropic(0.3).unwrap().into()],
        2 => {
            let ellipse = Ellipsoid::new(Vector::<2>::new(axes[0], axes[1])).unwrap();
            vec![
                FrictionLaw::<2>::isotropic(0.3).unwrap().into(),
                FrictionLaw::associated(Convex::from(ellipse)).into(),
            ]
        }
        _ => {
            let ellipsoid = Ellipsoid::new(Vector::<3>::from(axes)).unwrap();
            vec![
                FrictionLaw::<3>::isotropic(0.3).unwrap().into(),
                FrictionLaw::associated(Convex::from(ellipsoid)).into(),
            ]
        }
    }
}

/// A problem in all forms of its operator.
///
/// Bodies stand in a row, every contact touches two neighbours, the first and the last body also the surroundings. Some
/// motion opens all contacts, so that percussions that friction limits can stop any approach: there is a solution.
fn problems(p: usize, situation: Situation, random: &mut Random) -> Vec<ContactProblem> {
    let counts = match situation {
        Situation::Redundant => (2, 6),
        _ => (4, 4),
    };
    problems_of(p, situation, counts, random)
}

/// The same with so many bodies and contacts.
fn problems_of(
    p: usize,
    situation: Situation,
    (bodies, contacts): (usize, usize),
    random: &mut Random,
) -> Vec<ContactProblem> {
    let (size, rows, dof) = (p + 1, contacts * (p + 1), bodies * DOF);
    let mut mass = DMatrix::zeros(dof, dof);
    for body in 0..bodies {
        let weight = match situation {
            Situation::LightOnHeavy if body == 0 => 1e4,
            Situation::HeavyOnLight if body + 1 == bodies => 1e4,
            _ => 1.0,
        };
        let root = DMatrix::from_fn(DOF, DOF, |_, _| 0.3 * random.normal());
        let block = (&root * root.transpose() + DMatrix::identity(DOF, DOF)) * weight;
        mass.view_mut((DOF * body, DOF * body), (DOF, DOF)).copy_from(&block);
    }
    let opening = DVector::from_fn(dof, |_, _| random.normal());
    let mut directions = DMatrix::zeros(rows, dof);
    for contact in 0..contacts {
        let first = contact % bodies;
        let touched = if first + 1 < bodies { vec![first, first + 1] } else { vec![first] };
        for row in contact * size..(contact + 1) * size {
            for body in &touched {
                (0..DOF).for_each(|k| directions[(row, DOF * body + k)] = random.normal());
            }
        }
        let row = contact * size;
        if directions.row(row).transpose().dot(&opening) < 0.0 {
            directions.row_mut(row).neg_mut();
        }
    }
    let approach = DVector::from_fn(dof, |k, _| random.normal() - 0.5 * opening[k]);
    let mut free = &directions * approach;
    if situation == Situation::Grazing {
        (0..contacts).for_each(|contact| free[contact * size] = 0.0);
    }
    let laws = laws(p);
    let dense = &directions * mass.clone().try_inverse().unwrap() * directions.transpose();
    let sizes = vec![size; contacts];
    let factored = Factored::new(
        Csr::from_dense(&mass).unwrap(),
        Csr::from_dense(&directions).unwrap(),
        &sizes,
    );
    let full = BlockMatrix::from_dense(&dense, &sizes).unwrap();
    let blocks = BlockMatrix::from_csr(&Csr::from_dense(&dense).unwrap(), &sizes);
    let forms: [Delassus; 3] = [full.into(), blocks.unwrap().into(), factored.unwrap().into()];
    let problem = |delassus: Delassus| {
        let contacts =
            (0..contacts).map(|i| (laws[i % laws.len()].clone(), NormalForce::Unilateral));
        ContactProblem::new(delassus, free.as_slice().to_vec(), contacts).unwrap()
    };
    forms.map(problem).into()
}

struct Solved {
    report: SolveReport,
    percussion: Vec<f64>,
    velocity: Vec<f64>,
}

fn solve(solver: Solver, problem: &ContactProblem) -> Solved {
    let mut workspace = Workspace::default();
    let mut memory = Memory::new(problem.rows(), problem.contacts().len());
    let report = solver.solve(problem, Stop::at(TOLERANCE), &mut memory, &mut workspace);
    Solved { report, percussion: memory.percussion, velocity: workspace.velocity().to_vec() }
}

/// Methods, and whether each must solve a problem of this kind.
fn methods(situation: Situation) -> Vec<(Solver, bool)> {
    let of_one_weight = matches!(situation, Situation::Regular | Situation::Grazing);
    let (step, max_iterations) = (ProxStep::Adaptive, 200_000);
    vec![
        (Solver::AUTO, true),
        (Solver::Auto { steps: without_conic_methods(), threads: 1 }, true),
        (Solver::Exact { max_sweeps: 100_000 }, of_one_weight),
        (Solver::SemismoothNewton { max_iterations: 300 }, false),
        (Solver::ProximalPoint { max_iterations: 3000 }, true),
        (Solver::InteriorPoint { max_iterations: 200 }, of_one_weight),
        (Solver::Admm { max_iterations: 100_000 }, of_one_weight),
        (Solver::ProxJacobi { step, max_iterations }, of_one_weight),
        (Solver::ProxGaussSeidel { step, max_iterations }, of_one_weight),
    ]
}

#[test]
fn methods_agree_on_random_problems() {
    let mut random = Random::new(13);
    let mut newton = (0, 0);
    for p in 1..=3 {
        for situation in SITUATIONS {
            for _ in 0..3 {
                let problems = problems(p, situation, &mut random);
                let reference = solve(methods(situation)[0].0, &problems[0]);
                let size = problems[0].free_velocity().iter().fold(0.0, |m: f64, v| m.max(v.abs()));
                for (problem, form) in problems.iter().zip(["dense", "blocks", "factored"]) {
                    for (solver, must) in methods(situation) {
                        let found = solve(solver, problem);
                        let name = format!("p = {p}, {situation:?}, {form}, {solver:?}");
                        let converged = found.report.status == Status::Converged;
                        assert!(converged || !must, "{name}: {:?}", found.report);
                        if let Solver::SemismoothNewton { .. } = solver {
                            newton = (newton.0 + usize::from(converged), newton.1 + 1);
                        }
                        if !converged {
                            continue;
                        }
                        // The report's measure is that of single contacts, this one of all together.
                        let map = natural_map(problem, &found.percussion, &found.velocity).unwrap();
                        assert!(map <= 10.0 * TOLERANCE, "{name}: natural map {map:e}");
                        if reference.report.ambiguous || found.report.ambiguous {
                            continue;
                        }
                        for (a, b) in found.velocity.iter().zip(&reference.velocity) {
                            assert!((a - b).abs() <= 1e-5 * size, "{name}: {a} {b}");
                        }
                    }
                }
            }
        }
    }
    assert!(2 * newton.0 > newton.1, "Newton alone solved {} of {}", newton.0, newton.1);
}

/// The same problem among contacts and among bodies: the same Newton iterations but for rounding.
#[test]
fn newton_takes_the_same_way_in_contact_and_in_body_space() {
    let mut random = Random::new(4);
    for _ in 0..20 {
        // More rows than those of a matrix that is factored densely.
        let problems = problems_of(2, Situation::Redundant, (2, 12), &mut random);
        let [dense, _, factored] = [0, 1, 2].map(|k| {
            let solver = Solver::ProximalPoint { max_iterations: 5 };
            solve(solver, &problems[k])
        });
        let size = dense.percussion.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
        for (a, b) in dense.velocity.iter().zip(&factored.velocity) {
            assert!((a - b).abs() <= 1e-5 * size, "{a} {b}");
        }
    }
}

/// A column of bodies of equal masses that falls on the ground: sweeps carry a load from one body to the next only.
fn column(height: usize) -> ContactProblem {
    let rows = 2 * height;
    let delassus = DMatrix::from_fn(rows, rows, |i, j| match (i / 2).abs_diff(j / 2) {
        _ if i % 2 != j % 2 => 0.0,
        0 => {
            if i < 2 {
                1.0
            } else {
                2.0
            }
        }
        1 => -1.0,
        _ => 0.0,
    });
    let mut free = vec![0.0; rows];
    (free[0], free[1]) = (-1.0, 0.2);
    let contact = (FrictionLaw::<1>::isotropic(0.3).unwrap().into(), NormalForce::Unilateral);
    ContactProblem::new(delassus, free, vec![contact; height]).unwrap()
}

/// Sweeps that creep are soon followed by Newton's method, whatever the measure, in a matrix that is factored densely or
/// not; a start that solves the problem is not touched.
#[test]
fn newton_follows_a_few_sweeps_that_creep() {
    for (height, measure) in [10, 30]
        .into_iter()
        .flat_map(|height| [Measure::Contact, Measure::Global].map(|measure| (height, measure)))
    {
        let problem = column(height);
        let stop = Stop::at(1e-9).with_measure(measure);
        let sweeps = problem.solve(&Solver::Exact { max_sweeps: 100_000 }, stop);
        assert!(sweeps.report.iterations > 100, "{height}: {:?}", sweeps.report);
        let solution = problem.solve(&Solver::default(), stop);
        assert_eq!(solution.report.status, Status::Converged, "{height}: {solution:?}");
        let [first, .., last] = &solution.stages[..] else { panic!("{:?}", solution.stages) };
        assert_eq!((first.method, last.method), (Method::GaussSeidel, Method::Newton));
        assert_eq!(solution.stages.len(), 2, "{:?}", solution.stages);
        assert!(first.iterations <= 10 && last.factorizations <= 8, "{:?}", solution.stages);
        for (a, b) in solution.velocity.iter().zip(&sweeps.velocity) {
            assert!((a - b).abs() < 1e-6, "{height}: {a} {b}");
        }
        let percussion = solution.percussion.clone();
        let mut memory = Memory { percussion: percussion.clone(), states: solution.states.clone() };
        let mut workspace = Workspace::default();
        let again = Solver::default().solve(&problem, stop, &mut memory, &mut workspace);
        assert_eq!((again.iterations, &memory.percussion), (0, &percussion), "{height}");
    }
}

/// A solution answers by contact, whatever rows the contacts before have.
#[test]
fn a_solution_answers_by_contact() {
    let line: Law = FrictionLaw::<1>::isotropic(0.5).unwrap().into();
    let plane: Law = FrictionLaw::<2>::isotropic(0.5).unwrap().into();
    let contacts = [(line, NormalForce::Prescribed(2.0)), (plane, NormalForce::Unilateral)];
    let free = vec![3.0, -1.0, 0.3, 0.4];
    let problem = ContactProblem::new(DMatrix::identity(4, 4), free, contacts).unwrap();
    let solution = problem.solve(&Solver::default(), Stop::default());
    assert_eq!(solution.report.status, Status::Converged);
    let (slips, sticks) = (solution.contact(0), solution.contact(1));
    assert_eq!((slips.state.phase, sticks.state.phase), (Phase::Slip, Phase::Stick));
    assert_eq!((slips.normal_percussion, slips.normal_velocity), (2.0, None));
    assert_eq!((slips.tangential_percussion, slips.tangential_velocity), (&[-1.0][..], &[2.0][..]));
    assert_eq!(sticks.normal_percussion, solution.percussion[1]);
    assert_eq!(sticks.normal_velocity, Some(solution.velocity[1]));
    assert_eq!(sticks.tangential_percussion, &solution.percussion[2..]);
    assert_eq!(sticks.tangential_velocity, &solution.velocity[2..]);
}

/// `G` and `b` of two contacts that influence each other and nothing else.
struct Island {
    delassus: DMatrix<f64>,
    free: Vec<f64>,
}

impl Island {
    fn random(random: &mut Random) -> Self {
        let directions = DMatrix::from_fn(6, 8, |_, _| random.normal());
        let free = (0..6).map(|row| random.normal() - if row % 3 == 0 { 2.0 } else { 0.0 });
        Self { free: free.collect(), delassus: &directions * directions.transpose() }
    }
}

/// The problem of contacts that are given by their islands and their places there.
fn of_islands(islands: &[Island], contacts: &[(usize, usize)]) -> ContactProblem {
    let (mut starts, mut indices, mut values) = (vec![0], Vec::new(), Vec::new());
    for &(island, place) in contacts {
        for row in 3 * place..3 * place + 3 {
            for (other, &(_, beside)) in
                contacts.iter().enumerate().filter(|(_, (own, _))| *own == island)
            {
                for k in 0..3 {
                    indices.push(3 * other + k);
                    values.push(islands[island].delassus[(row, 3 * beside + k)]);
                }
            }
            starts.push(indices.len());
        }
    }
    let rows = 3 * contacts.len();
    let matrix = Csr::new(rows, rows, starts, indices, values).unwrap();
    let blocks = BlockMatrix::from_csr(&matrix, &vec![3; contacts.len()]).unwrap();
    let free = contacts.iter().flat_map(|&(island, place)| {
        islands[island].free[3 * place..3 * place + 3].iter().copied()
    });
    let laws = laws(2);
    let of_contact =
        |&(island, _): &(usize, usize)| (laws[island % 2].clone(), NormalForce::Unilateral);
    ContactProblem::new(blocks, free.collect(), contacts.iter().map(of_contact)).unwrap()
}

/// What an island of contacts does depends on no other island, to the bit, whatever the order of contacts.
#[test]
fn islands_do_not_depend_on_each_other() {
    let mut random = Random::new(17);
    let islands: Vec<Island> = (0..6).map(|_| Island::random(&mut random)).collect();
    let solve = |solver: Solver, contacts: &[(usize, usize)]| {
        let problem = of_islands(&islands, contacts);
        let (mut memory, mut workspace) = (Memory::default(), Workspace::default());
        let report = solver.solve(&problem, Stop::at(TOLERANCE), &mut memory, &mut workspace);
        assert_eq!(report.status, Status::Converged, "{solver:?}: {report:?}");
        assert!(natural_map(&problem, &memory.percussion, workspace.velocity()).unwrap() < 1e-8);
        let velocities = problem.velocities(&memory.percussion).unwrap();
        let off = |(a, b): (&f64, &f64)| (a - b).abs();
        let off = velocities.iter().zip(workspace.velocity()).map(off).fold(0.0, f64::max);
        assert!(off < 1e-12, "{solver:?}: velocities are {off:e} off");
        memory
    };
    let side_by_side: Vec<_> = (0..6).flat_map(|island| [(island, 0), (island, 1)]).collect();
    let interleaved: Vec<_> =
        [0, 1].into_iter().flat_map(|place| (0..6).rev().map(move |k| (k, place))).collect();
    let auto = Solver::AUTO;
    for solver in [Solver::Exact { max_sweeps: 10_000 }, auto] {
        let (one, other) = (solve(solver, &side_by_side), solve(solver, &interleaved));
        for (i, contact) in side_by_side.iter().enumerate() {
            let j = interleaved.iter().position(|other| other == contact).unwrap();
            let rows = |memory: &Memory, i: usize| memory.percussion[3 * i..3 * i + 3].to_vec();
            assert_eq!(rows(&one, i), rows(&other, j), "{solver:?}: {contact:?}");
            assert_eq!(one.states[i], other.states[j], "{solver:?}: {contact:?}");
            if matches!(solver, Solver::Exact { .. }) {
                let alone = solve(solver, &[(contact.0, 0), (contact.0, 1)]);
                assert_eq!(rows(&one, i), rows(&alone, contact.1), "{contact:?}");
            }
        }
    }
}

/// A solve that is given up at any time tells the residual of what it leaves, also where it could not be given up again.
#[test]
fn who_gives_up_once_is_told_what_is_left() {
    check_giving_up(40);
}

/// Of more than 512 contacts several threads sweep islands, too.
#[test]
fn who_gives_up_sweeps_of_several_threads_is_told_what_is_left() {
    check_giving_up(300);
}

fn check_giving_up(count: usize) {
    let mut random = Random::new(23);
    let islands: Vec<Island> = (0..count).map(|_| Island::random(&mut random)).collect();
    let contacts: Vec<_> = (0..count).flat_map(|island| [(island, 0), (island, 1)]).collect();
    let problem = of_islands(&islands, &contacts);
    for (threads, measure) in
        [(1, Measure::Contact), (2, Measure::Contact), (1, Measure::Global), (2, Measure::Global)]
    {
        let solver = Solver::Auto { steps: Steps::ALL, threads };
        for at in [1, 2, 3, 5, 8, 13, 21, 34] {
            let asked = Cell::new(0);
            let once = || {
                asked.set(asked.get() + 1);
                asked.get() == at
            };
            let stop = Stop::at(TOLERANCE).with_measure(measure).unless(&once);
            let solution = problem.solve(&solver, stop);
            let what = format!("{threads} threads, {measure:?}, given up at {at}");
            assert!(asked.get() <= at, "{what}: asked {} times", asked.get());
            let velocity = problem.velocities(&solution.percussion).unwrap();
            let off = velocity.iter().zip(&solution.velocity).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-12, "{what}");
            let of = &solution.percussion;
            let residual = match measure {
                Measure::Global => natural_map(&problem, of, &velocity).unwrap(),
                _ => natural_residual(&problem, of, &velocity).unwrap().value,
            };
            let SolveReport { status, residual: told, .. } = solution.report;
            assert!((told - residual).abs() <= 1e-3 * residual + 1e-14, "{what}: {told:e}");
            assert_eq!(status == Status::Converged, residual <= TOLERANCE, "{what}: {status:?}");
        }
    }
}

/// Where islands are solved but not the whole, they go on: those that were solved remain so whenever that is given up.
#[test]
fn who_gives_up_a_later_round_has_islands_that_are_solved() {
    let mut random = Random::new(31);
    let mut later = 0;
    for trial in 0..500 {
        // Open contacts of heavy bodies raise the prox parameter of the whole.
        let rows = 12 + 3 * 60;
        let (mut delassus, mut free) = (DMatrix::identity(rows, rows) * 1e-3, Vec::new());
        for island in 0..2 {
            let directions = DMatrix::from_fn(6, 6, |_, _| random.normal());
            let block = &directions * directions.transpose();
            delassus.view_mut((6 * island, 6 * island), (6, 6)).copy_from(&block);
            free.extend((0..6).map(|k| random.normal() - if k % 3 == 0 { 2.0 } else { 0.0 }));
        }
        free.extend((12..rows).map(|row| if row % 3 == 0 { 1e-6 } else { 0.0 }));
        let law = || Law::from(FrictionLaw::<2>::isotropic(1.5).unwrap());
        let contacts = (0..rows / 3).map(|_| (law(), NormalForce::Unilateral));
        let problem = ContactProblem::new(delassus, free, contacts).unwrap();
        let solve = |at: usize| {
            let asked = Cell::new(0);
            let once = || {
                asked.set(asked.get() + 1);
                asked.get() == at
            };
            let stop = Stop::at(TOLERANCE).with_measure(Measure::Global).unless(&once);
            (problem.solve(&Solver::default(), stop), asked.get())
        };
        let (_, questions) = solve(usize::MAX);
        let mut solved = false;
        for at in 1..=questions.min(600) {
            let (solution, _) = solve(at);
            let all = solution.islands.iter().all(|own| own.report.status == Status::Converged);
            assert!(all || !solved, "problem {trial}, given up at {at}");
            solved |= all && solution.report.status == Status::TimeLimit;
        }
        later += usize::from(solved);
    }
    assert!(later > 10, "{later}");
}

/// A factorisation of some hundred million operations is given up on the way.
#[test]
fn who_gives_up_does_not_wait_for_a_factorisation() {
    let mut random = Random::new(29);
    let contacts = 250;
    let directions = DMatrix::from_fn(3 * contacts, 3 * contacts + 6, |_, _| random.normal());
    let free = (0..3 * contacts).map(|_| random.normal()).collect();
    let laws = vec![(laws(2)[0].clone(), NormalForce::Unilateral); contacts];
    let problem = ContactProblem::new(&directions * directions.transpose(), free, laws).unwrap();
    for solver in [
        Solver::SemismoothNewton { max_iterations: 1 },
        Solver::ProximalPoint { max_iterations: 1 },
        Solver::InteriorPoint { max_iterations: 1 },
        Solver::Admm { max_iterations: 1 },
    ] {
        let asked = Cell::new(0);
        let soon = || {
            asked.set(asked.get() + 1);
            asked.get() == 12
        };
        let solution = problem.solve(&solver, Stop::at(TOLERANCE).unless(&soon));
        assert_eq!(asked.get(), 12, "{solver:?}");
        assert_eq!(solution.report.status, Status::TimeLimit, "{solver:?}");
        assert!(solution.stages.iter().all(|stage| stage.factorizations <= 1), "{solver:?}");
    }
}

/// One step of the paper's iteration, [WL19] (69) and (70), written out for a disk within an ellipse: from percussions within
/// the reservoir, and from percussions beyond it, whose α is that of the border.
#[test]
fn one_iteration_of_the_paper_is_its_formula() {
    let ellipse = |a, b| Convex::from(Ellipse::new(Vector::<2>::new(a, b)).unwrap());
    let law = FrictionLaw::new(ellipse(0.5, 0.25).into(), ellipse(1.0, 1.0)).unwrap();
    let (k_c, k_d) = (|x: &Vector<2>| x.x.hypot(2.0 * x.y) / 0.5, |x: &Vector<2>| x.norm() / 0.25);
    let (normal, free) = (2.0, Vector::<2>::new(0.7, -0.4));
    let g = nalgebra::Matrix2::new(1.5, 0.2, 0.2, 0.8);
    let contacts = [(Law::from(law), NormalForce::Prescribed(normal))];
    let delassus = DMatrix::from_fn(2, 2, |i, j| g[(i, j)]);
    let problem = ContactProblem::new(delassus, free.as_slice().to_vec(), contacts).unwrap();
    let steps = [ProxStep::Adaptive, ProxStep::Constant(0.3)];
    for start in
        [Vector::<2>::new(0.3, -0.1), Vector::<2>::new(-0.6, 0.2), Vector::<2>::new(1.7, 1.1)]
    {
        let mut x = -start / normal;
        x /= f64::max(1.0, k_c(&x));
        let alpha = 1.0 / (k_d(&x) - k_c(&x) + 1.0);
        let slip = free + g * start;
        for step in steps {
            let r = if step == ProxStep::Adaptive { alpha / 1.7 } else { 0.3 };
            let z = x * alpha + slip * (r / normal);
            let z = z / f64::max(1.0, k_d(&z));
            let expected = z * (-normal / alpha);
            for solver in [
                Solver::ProxJacobi { step, max_iterations: 1 },
                Solver::ProxGaussSeidel { step, max_iterations: 1 },
            ] {
                let (mut memory, mut workspace) = (Memory::new(2, 1), Workspace::default());
                memory.percussion = start.as_slice().to_vec();
                solver.solve(&problem, Stop::at(1e-12), &mut memory, &mut workspace);
                let found = Vector::<2>::from_column_slice(&memory.percussion);
                assert!(
                    (found - expected).norm() < 1e-14,
                    "{solver:?} {start}: {found} {expected}"
                );
            }
        }
    }
}
