//! Load-bearing contacts against small quadratic programs and small compliances.

use super::*;

/// Feet in the plane under a body of mass one, with its radii of inertia one, that stand still under a load at the
/// origin if they can; friction presses each foot's normal force sideways at the height `h` below the centre of mass.
struct Feet {
    places: Vec<[f64; 2]>,
    friction: Vec<[f64; 2]>,
    h: f64,
}

impl Feet {
    fn random(seed: usize, h: f64) -> Self {
        let draw = |k: usize| ((78.2 * seed as f64 + 12.9 * k as f64).sin() * 4.3e4).fract().abs();
        let count = 3 + seed % 7;
        let places = (0..count)
            .map(|k| [2.0 * draw(5 * k + 1) - 1.0, 2.0 * draw(5 * k + 2) - 1.0])
            .collect();
        let friction = (0..count).map(|k| {
            let angle = 6.0 * draw(5 * k + 3);
            [0.3 * angle.cos(), 0.3 * angle.sin()]
        });
        Self { places, friction: friction.collect(), h }
    }

    fn row(&self, k: usize) -> DVector<f64> {
        DVector::from_vec(vec![1.0, self.places[k][0], self.places[k][1]])
    }

    fn column(&self, k: usize) -> DVector<f64> {
        let [x, y] = self.friction[k];
        self.row(k) + self.h * DVector::from_vec(vec![0.0, x, y])
    }

    fn normal_forces(&self) -> NormalForces {
        let n = self.places.len();
        NormalForces {
            effects: DMatrix::from_fn(n, n, |k, l| self.row(k).dot(&self.column(l))),
            mobility: DMatrix::from_fn(n, n, |k, l| self.row(k).dot(&self.row(l))),
            free: vec![-1.0; n],
            sizes: vec![1.0; n],
        }
    }
}

fn starts(count: usize) -> [Vec<bool>; 3] {
    [vec![true; count], vec![false; count], (0..count).map(|k| k % 2 == 0).collect()]
}

/// The smallest of the forces that no sign is asked of, over all sets of contacts.
#[test]
fn without_friction_the_forces_are_the_smallest_that_hold_the_load() {
    let mut unloaded = 0;
    for seed in 0..300 {
        let feet = Feet::random(seed, 0.0);
        let (problem, n) = (feet.normal_forces(), feet.places.len());
        let load = DVector::from_vec(vec![1.0, 0.0, 0.0]);
        let mut best: Option<(f64, Vec<bool>)> = None;
        for set in 1..1_usize << n {
            let with: Vec<usize> = (0..n).filter(|k| set >> k & 1 == 1).collect();
            let rows: Vec<_> = with.iter().map(|&k| feet.row(k)).collect();
            let rows = DMatrix::from_columns(&rows);
            let forces = LeastNorm::new(rows.clone(), 1e-9).unwrap().solve(&load);
            let holds = (rows * &forces - &load).amax() < 1e-9 && forces.min() > 0.0;
            if holds && best.as_ref().is_none_or(|(least, _)| forces.norm() < *least) {
                let carries = (0..n).map(|k| with.contains(&k)).collect();
                best = Some((forces.norm(), carries));
            }
        }
        let Some((_, expected)) = best else { continue };
        unloaded += expected.iter().filter(|carries| !**carries).count();
        for start in starts(n) {
            assert_eq!(problem.load_bearing(start), Some(expected.clone()), "{seed}");
        }
    }
    assert!(unloaded > 50, "{unloaded}");
}

/// Where no principal minor of K + ε1 is negative, the only one of all sets of contacts that fits a small compliance ε.
#[test]
fn with_friction_the_contacts_are_those_of_a_small_compliance() {
    let (mut unloaded, mut tried) = (0, 0);
    for seed in 0..300 {
        let feet = Feet::random(seed, 0.4);
        let (problem, n) = (feet.normal_forces(), feet.places.len());
        let mut positive = true;
        let mut solutions: Vec<Vec<bool>> = Vec::new();
        for set in 1..1_usize << n {
            let with: Vec<usize> = (0..n).filter(|k| set >> k & 1 == 1).collect();
            let compliant = DMatrix::from_fn(with.len(), with.len(), |k, l| {
                let compliance = if k == l { 1e-6 } else { 0.0 };
                problem.effects[(with[k], with[l])] + compliance
            });
            let factors = compliant.lu();
            positive &= factors.determinant() > 0.0;
            let right = DVector::from_element(with.len(), 1.0);
            let Some(forces) = factors.solve(&right) else { continue };
            let closes = |k: usize| {
                let parts = with.iter().zip(&forces);
                parts.map(|(&l, f)| problem.effects[(k, l)] * f).sum::<f64>() < 1.0
            };
            let fits = forces.min() > 0.0 && !(0..n).any(|k| !with.contains(&k) && closes(k));
            if fits {
                solutions.push((0..n).map(|k| with.contains(&k)).collect());
            }
        }
        if !positive {
            continue;
        }
        tried += 1;
        assert_eq!(solutions.len(), 1, "{seed}");
        unloaded += solutions[0].iter().filter(|carries| !**carries).count();
        for start in starts(n) {
            assert_eq!(problem.load_bearing(start).as_ref(), solutions.first(), "{seed}");
        }
    }
    assert!(tried > 100 && unloaded > 100, "{tried} {unloaded}");
}

/// Two contacts at one place, of which one surface sinks away; if both rise at different rates, one carries.
#[test]
fn of_surfaces_that_part_the_highest_carries() {
    let one = DMatrix::from_element(2, 2, 1.0);
    let problem = NormalForces {
        effects: one.clone(),
        mobility: one,
        free: vec![-9.0, -10.0],
        sizes: vec![10.0; 2],
    };
    for start in starts(2) {
        assert_eq!(problem.load_bearing(start), Some(vec![false, true]));
    }
}
