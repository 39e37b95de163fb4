//! The contact laws, written out again: what a solver calls a solution is checked here.
//!
//! Nothing of this is taken from the solvers or their measures but the projection onto a set.

use asperity::contact::{ContactProblem, NormalForce};
use asperity::law::{FrictionLaw, Law};
use asperity::set::{ConvexSet, StarSet, Vector, directions};
use nalgebra::{DMatrix, DVector};

use crate::decode::{Range, Source};

/// What a contact does below this size counts as nothing if it is nothing beside the loads of the whole, too.
const NOTHING: f64 = 1e-150;
/// The longest step `ρξ` over the normal percussion that is projected; its square is a number.
const FAR: f64 = 1e100;

/// A contact problem in the open: dense `G`, loads, laws.
pub struct Scene {
    pub delassus: DMatrix<f64>,
    pub free_velocity: DVector<f64>,
    pub contacts: Vec<(Law, NormalForce)>,
    /// Percussions that solve the problem, if it was made from them.
    pub known: Option<DVector<f64>>,
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "\n  G (by columns) {:?}", self.delassus.as_slice())?;
        write!(f, "\n  b {:?}", self.free_velocity.as_slice())?;
        for (law, normal) in &self.contacts {
            write!(f, "\n  contact: {} {normal:?}", crate::laws::describe(law))?;
        }
        write!(f, "\n  known {:?}", self.known.as_ref().map(|p| p.as_slice()))
    }
}

impl Scene {
    /// The problem, unless it is refused.
    pub fn problem(&self) -> Option<ContactProblem> {
        let free = self.free_velocity.iter().copied().collect();
        ContactProblem::new(self.delassus.clone(), free, self.contacts.clone()).ok()
    }

    /// Rows of a contact: the first, and those of the normal.
    fn rows(&self, contact: usize) -> (usize, usize) {
        let first = self.contacts[..contact].iter().map(length).sum();
        (first, usize::from(self.contacts[contact].1 == NormalForce::Unilateral))
    }

    /// Free velocities such that random percussions are a solution: open, stick, slip by chance.
    pub fn solve_backwards(&mut self, source: &mut Source<'_>) {
        let n = self.delassus.nrows();
        let (mut percussion, mut velocity) = (DVector::zeros(n), DVector::zeros(n));
        for i in 0..self.contacts.len() {
            let (first, normal_rows) = self.rows(i);
            let phase = source.below(3);
            let normal = match self.contacts[i].1 {
                NormalForce::Prescribed(value) => value,
                NormalForce::Unilateral if phase == 0 => {
                    velocity[first] = source.size(Range::Narrow);
                    0.0
                }
                NormalForce::Unilateral => {
                    percussion[first] = source.size(Range::Narrow);
                    percussion[first]
                }
            };
            let at = (first + normal_rows, normal, phase == 2);
            match &self.contacts[i].0 {
                Law::Zero(_) => unreachable!(),
                Law::One(law) => tangent(law, at, source, &mut percussion, &mut velocity),
                Law::Two(law) => tangent(law, at, source, &mut percussion, &mut velocity),
                Law::Three(law) => tangent(law, at, source, &mut percussion, &mut velocity),
            }
        }
        self.free_velocity = &velocity - &self.delassus * &percussion;
        self.known = Some(percussion);
    }

    /// The largest relative defect of the contact laws.
    pub fn defect(&self, percussion: &[f64]) -> f64 {
        let p = DVector::from_column_slice(percussion);
        let velocity = &self.delassus * &p + &self.free_velocity;
        let terms = self.delassus.abs() * p.abs() + self.free_velocity.abs();
        let mut worst = 0.0;
        let whole = self.largest_load();
        for i in 0..self.contacts.len() {
            let (first, normal_rows) = self.rows(i);
            let len = length(&self.contacts[i]);
            let own = first..first + len;
            let trace: f64 = own.clone().map(|k| self.delassus[(k, k)]).sum();
            let rho = len as f64 / trace;
            let scale = own.clone().map(|k| p[k].hypot(rho * terms[k])).fold(0.0, f64::max);
            let (normal, mut defect) = match self.contacts[i].1 {
                NormalForce::Prescribed(value) => (value, 0.0),
                NormalForce::Unilateral => {
                    (p[first], (p[first] - (p[first] - rho * velocity[first]).max(0.0)).abs())
                }
            };
            let at = (first + normal_rows, normal, rho);
            defect += match &self.contacts[i].0 {
                Law::Zero(_) => unreachable!(),
                Law::One(law) => inclusion(law, at, &p, &velocity),
                Law::Two(law) => inclusion(law, at, &p, &velocity),
                Law::Three(law) => inclusion(law, at, &p, &velocity),
            };
            if defect > 0.0 && !(scale < NOTHING && scale <= 1e-16 * whole) {
                worst = f64::max(worst, defect / scale);
            }
            if defect.is_nan() {
                return f64::NAN;
            }
        }
        worst
    }

    /// The largest percussion that is given, or that a free velocity asks for by itself; infinite without any, where zero is the
    /// solution and what is next to it counts as zero.
    fn largest_load(&self) -> f64 {
        let asked = |row: usize| (self.free_velocity[row] / self.delassus[(row, row)]).abs();
        let given = self.contacts.iter().filter_map(|(_, normal)| normal.prescribed());
        let largest = (0..self.free_velocity.len()).map(asked).chain(given).fold(0.0, f64::max);
        if largest > 0.0 { largest } else { f64::INFINITY }
    }

    /// Whether a contact alone has a solution for certain: its normal force is given, it is not pressed, or no
    /// friction force that it can transmit presses it in, `g_NN > G_NT x` for all `x` in *C* (no Painlevé
    /// paradox), with a margin.
    pub fn is_solvable(&self) -> bool {
        let (law, normal) = &self.contacts[0];
        if *normal != NormalForce::Unilateral || self.free_velocity[0] >= 0.0 {
            return true;
        }
        let coupling = match law {
            Law::Zero(_) => unreachable!(),
            Law::One(law) => strongest(law, &self.delassus),
            Law::Two(law) => strongest(law, &self.delassus),
            Law::Three(law) => strongest(law, &self.delassus),
        };
        self.delassus[(0, 0)] > 1.05 * coupling
    }

    /// Whether the force of the known solution of a contact alone lies on a cusp of *C*, where the last digits of a force
    /// decide on its gauge: next to it hardly a number solves the problem.
    pub fn is_known_on_a_cusp(&self) -> bool {
        let Some(percussion) = &self.known else { return false };
        let (first, normal_rows) = self.rows(0);
        let normal = self.contacts[0].1.prescribed().unwrap_or(percussion[first]);
        let tangent = &percussion.as_slice()[first + normal_rows..];
        match &self.contacts[0].0 {
            Law::Zero(_) => unreachable!(),
            Law::One(law) => is_on_a_cusp(law, tangent, normal),
            Law::Two(law) => is_on_a_cusp(law, tangent, normal),
            Law::Three(law) => is_on_a_cusp(law, tangent, normal),
        }
    }

    /// Ratio of the largest to the smallest singular value of `G`.
    pub fn condition(&self) -> f64 {
        let values = self.delassus.singular_values();
        values.max() / values.min()
    }
}

fn length(contact: &(Law, NormalForce)) -> usize {
    contact.0.dimension() + usize::from(contact.1 == NormalForce::Unilateral)
}

fn tangent<const P: usize>(
    law: &FrictionLaw<P>,
    (first, normal, slips): (usize, f64, bool),
    source: &mut Source<'_>,
    percussion: &mut DVector<f64>,
    velocity: &mut DVector<f64>,
) {
    let direction = source.direction::<P>();
    if normal == 0.0 || slips {
        let slip = direction * source.size(Range::Narrow);
        velocity.rows_mut(first, P).copy_from(&slip);
        if normal > 0.0
            && let Ok(force) = law.force(&slip, normal)
        {
            percussion.rows_mut(first, P).copy_from(&force);
        }
    } else {
        let share = 0.98 * source.unit() * normal / law.reservoir().gauge(&direction);
        percussion.rows_mut(first, P).copy_from(&(direction * share));
        // A reservoir need not be symmetric.
        let force = Vector::<P>::from_fn(|k, _| -percussion[first + k]);
        let gauge = law.reservoir().gauge(&force);
        if gauge > 0.98 * normal {
            percussion.rows_mut(first, P).scale_mut(0.98 * normal / gauge);
        }
    }
}

/// How far percussion and `ρξ` are from where a step of the projection ends, or from rest, as a percussion.
fn inclusion<const P: usize>(
    law: &FrictionLaw<P>,
    (first, normal, rho): (usize, f64, f64),
    percussion: &DVector<f64>,
    velocity: &DVector<f64>,
) -> f64 {
    let tangent = Vector::<P>::from_fn(|k, _| percussion[first + k]);
    if normal <= 0.0 {
        return tangent.norm();
    }
    let x = -tangent / normal;
    let moved = Vector::<P>::from_fn(|k, _| rho * velocity[first + k]);
    // The projection of what is as far away as that no longer depends on how far it is.
    let step = moved / normal.max(moved.amax() / FAR);
    let excess = |x: &Vector<P>| law.direction().gauge(x) - law.reservoir().gauge(x);
    let shrink = 1.0 + excess(&x);
    let z = x / shrink;
    let end = law.direction().project(&(z + step / shrink));
    let near = end / (1.0 - excess(&end));
    let held = x / law.reservoir().gauge(&x).max(1.0);
    let stepped = normal * f64::max((x - near).norm(), (z - end).norm() * shrink);
    let rest = normal * (x - held).norm() + moved.norm();
    // Beside cusps lengths along neighbouring rays differ though the boundary is near: is it crossed by a short step?
    let (gauge, slope) = law.reservoir().gauge_jet(&x);
    let across = slope * (2.0 * (gauge - 1.0) / slope.norm_squared());
    let aside = |at: Vector<P>| {
        let outward = law.direction().gauge_jet(&at).1.normalize();
        (moved - outward * moved.dot(&outward).max(0.0)).norm()
    };
    let beside = normal * across.norm() + aside(x).max(aside(x - across));
    let crossed = (law.reservoir().gauge(&(x - across)) - 1.0) * (gauge - 1.0) <= 0.0;
    let slips = if crossed && beside < stepped { beside } else { stepped };
    slips.min(rest)
}

/// Whether forces that differ in the thirteenth digit differ in the sixth of their gauges.
fn is_on_a_cusp<const P: usize>(law: &FrictionLaw<P>, tangent: &[f64], normal: f64) -> bool {
    const BESIDE: f64 = 1e-13;
    const STEEP: f64 = 1e-6;
    let x = -Vector::<P>::from_column_slice(tangent) / normal;
    if normal <= 0.0 || x.amax() == 0.0 {
        return false;
    }
    let gauge = law.reservoir().gauge(&x);
    let differs = |k: usize, side: f64| {
        let mut beside = x;
        beside[k] += side * BESIDE * x.norm();
        (law.reservoir().gauge(&beside) - gauge).abs() > STEEP * gauge
    };
    gauge > 1.0 - STEEP && (0..P).any(|k| differs(k, 1.0) || differs(k, -1.0))
}

/// `max G_NT x` over *C*.
fn strongest<const P: usize>(law: &FrictionLaw<P>, delassus: &DMatrix<f64>) -> f64 {
    let row = Vector::<P>::from_fn(|k, _| delassus[(0, 1 + k)]);
    let at = |d: Vector<P>| row.dot(&d) / law.reservoir().gauge(&d);
    directions::<P>(720).into_iter().map(at).fold(0.0, f64::max)
}
