//! Linear systems with contacts, and where they start.

use asperity::contact::Phase;
use asperity::law::Law;
use asperity::system::{Contact, LinearSystem};
use nalgebra::DMatrix;

use crate::decode::{Range, Source};
use crate::laws;

/// A system, its start, and the parameters that it hides.
pub struct Scene {
    pub system: LinearSystem,
    /// M, K, B and f.
    matrices: [DMatrix<f64>; 4],
    pub contacts: Vec<Contact>,
    pub q0: Vec<f64>,
    pub u0: Vec<f64>,
    /// Whether friction forces are bounded by laws of ordinary size and nothing else feeds energy in.
    pub tame: bool,
}

impl std::fmt::Debug for Scene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        for (name, matrix) in ["M", "K", "B", "f"].iter().zip(&self.matrices) {
            write!(f, "\n  {name} (by columns) {:?}", matrix.as_slice())?;
        }
        for c in &self.contacts {
            let law = laws::describe(&c.law);
            write!(f, "\n  contact: {law}\n    W (by columns) {:?}", c.direction.as_slice())?;
            write!(f, " χ {:?} {:?} e {:?}", c.velocity, c.normal_force, c.restitution)?;
            write!(f, " normal {:?} gap {:?}", c.normal, c.gap)?;
        }
        write!(f, "\n  q0 {:?} u0 {:?}", self.q0, self.u0)
    }
}

/// Up to three degrees of freedom and contacts; `None` where something is refused.
pub fn scene(source: &mut Source<'_>, rated: bool) -> Option<Scene> {
    let n = 1 + source.below(3);
    let range = Range::Narrow;
    let mass = if source.once_in(3) {
        let factor = DMatrix::from_fn(n, n, |_, _| source.signed());
        factor.transpose() * factor + DMatrix::identity(n, n)
    } else {
        DMatrix::from_diagonal(&nalgebra::DVector::from_fn(n, |_, _| source.size(range)))
    };
    let mut tame = true;
    let stiffness = match source.below(4) {
        0 => DMatrix::zeros(n, n),
        1 => {
            tame = n == 1;
            DMatrix::from_fn(n, n, |i, j| source.signed() + if i == j { n as f64 } else { 0.0 })
        }
        _ => {
            let factor = DMatrix::from_fn(n, n, |_, _| source.signed());
            factor.transpose() * factor * source.size(range)
        }
    };
    let damping = match source.below(3) {
        0 => DMatrix::identity(n, n) * source.unit(),
        _ => DMatrix::zeros(n, n),
    };
    let force: Vec<f64> = (0..n).map(|_| source.number(range)).collect();
    let count = source.below(4);
    let contacts: Vec<Contact> =
        (0..count).map(|_| contact(source, n, rated)).collect::<Option<_>>()?;
    tame &= contacts.iter().all(|c| laws::is_ordinary(&c.law));
    let rest = source.once_in(4);
    let start = |source: &mut Source<'_>| {
        (0..n).map(|_| if rest { 0.0 } else { source.signed() }).collect()
    };
    let (q0, u0) = (start(source), start(source));
    let load = DMatrix::from_column_slice(n, 1, &force);
    let matrices = [mass.clone(), stiffness.clone(), damping.clone(), load];
    let system = LinearSystem::new(mass, stiffness, damping, force, contacts.clone()).ok()?;
    Some(Scene { system, matrices, contacts, q0, u0, tame })
}

fn contact(source: &mut Source<'_>, n: usize, rated: bool) -> Option<Contact> {
    let law: Law =
        if rated { laws::rated(source, Range::Narrow)? } else { laws::any(source, Range::Narrow)? };
    let p = law.dimension();
    let axes = source.once_in(2);
    let direction = if axes {
        DMatrix::from_fn(n, p, |i, j| if i == j { 1.0 } else { 0.0 })
    } else {
        DMatrix::from_fn(n, p, |_, _| source.signed())
    };
    let belt = source.once_in(2);
    let velocity = (0..p).map(|_| if belt { source.number(Range::Narrow) } else { 0.0 }).collect();
    let at_rest = if source.once_in(3) {
        let normal =
            (0..n).map(|i| if axes && i + 1 == n { 1.0 } else { source.signed() }).collect();
        let touching = source.once_in(2);
        let gap = if touching { 0.0 } else { source.size(Range::Narrow) };
        Contact::unilateral(law, direction, normal, gap)
    } else {
        Contact::with_force(law, direction, source.size(Range::Narrow))
    };
    let restitution = if source.once_in(3) { (source.unit(), 0.0) } else { (0.0, 0.0) };
    Some(Contact { velocity, restitution, ..at_rest })
}

impl Scene {
    /// Asserts that normal forces do not pull and friction forces lie in their reservoirs; where phases are given, that
    /// they are on the boundary in slip and that open contacts do not press.
    ///
    /// Reservoirs grow and shrink with a factor of the speed. Its part that rises with the speed is that of the slip, the
    /// part that falls that of the slip `lag` samples before.
    pub fn check_forces(&self, forces: &Forces<'_>) {
        let Forces { p, lag, slip, force, normal_force, phase, with_phase, .. } = *forces;
        let Forces { slack, tolerance, dt, u, .. } = *forces;
        let dof = self.u0.len();
        let m = self.contacts.len();
        let size = normal_force.iter().fold(1e-3, |m: f64, f| m.max(f.abs()));
        let mobility: Vec<f64> = self.contacts.iter().map(|c| self.mobility(c)).collect();
        let turned = slips_by_rounding(slip, phase, p);
        for (k, &normal) in normal_force.iter().enumerate() {
            let contact = &self.contacts[k % m];
            // Laws of fewer dimensions are padded.
            let own = &force[k * p..k * p + contact.law.dimension()];
            // Not known where a contact is at an event or not closed, nor at the start.
            if own.iter().any(|f| f.is_nan()) || normal.is_nan() || k < lag * m {
                continue;
            }
            assert!(normal >= -slack * size, "contact {} pulls with {normal}: {self:?}", k % m);
            let speed = |k: usize| {
                let own = &slip[k * p..k * p + contact.law.dimension()];
                own.iter().map(|v| v * v).sum::<f64>().sqrt()
            };
            let (before, now) = (speed(k - lag * m), speed(k));
            // Speeds are known as well as the percussions that bring them, in this step and in the one before.
            let brought = |sample: usize| {
                let percussion = |j: usize| {
                    let own = force[(sample * m + j) * p..][..p].iter().filter(|f| !f.is_nan());
                    dt * own.map(|f| f * f).sum::<f64>().sqrt()
                };
                (0..m).map(|j| percussion(j) * (mobility[k % m] * mobility[j]).sqrt()).sum::<f64>()
            };
            let brought = brought(k / m) + brought(k / m - lag);
            // At rest a speed of the size of rounding may stand for none, and the other way round.
            let factor_with = |error: f64| {
                let [falling_at, rising_at] = [before + error, now - error].map(|v| v.max(0.0));
                let rate = contact.law.rate();
                rate.map_or(1.0, |rate| rate.falling(falling_at) + rate.rising(rising_at))
            };
            // A slip is a difference of velocities, which may be far larger.
            let velocities = &u[(k / m - lag) * dof..][..(1 + lag) * dof];
            let largest =
                contact.direction.amax() * velocities.iter().map(|u| u.abs()).sum::<f64>();
            let rounded = 8.0 * f64::EPSILON * largest;
            let uncertain = 1e-9 + tolerance * brought + rounded;
            let (least, factor) = (factor_with(uncertain), factor_with(-uncertain));
            let (gauge, slope) = gauge(&contact.law, own);
            // Percussions are known relative to their loads, which the other contacts bring, too; beside cusps the gauge
            // tells less of what they lack.
            let loads = if mobility[k % m] > 0.0 && dt > 0.0 {
                (before + now + brought) / (mobility[k % m] * dt)
            } else {
                0.0
            };
            let step = tolerance * loads;
            let radius = laws::least_radius(&contact.law);
            // Where a speed grows tenfold in a step, the accuracy of the one before may be, as a percussion, more than the
            // reservoir holds.
            let runs_away = mobility[k % m] > 0.0
                && dt > 0.0
                && now > 10.0 * before
                && normal > slack * size
                && tolerance * before > radius * normal * factor * mobility[k % m] * dt;
            let beside = f64::max(step * slope, spread(&contact.law, own, step));
            let beside = beside.min(0.1 * normal * factor);
            let own = (step / radius).min(0.1 * normal * factor);
            let error = slack * (size + normal * factor) + f64::max(own, beside);
            // What a contact has to hold that sticks beside another whose force rounding turns is as uncertain as that.
            let others = &turned[k / m * m..][..m];
            if !with_phase && phase[k] == Phase::Stick as i8 && others.contains(&true) {
                continue;
            }
            assert!(
                runs_away || gauge <= normal * factor + error,
                "contact {}: k_C(−λ) = {gauge} at λ_N = {normal} and f = {factor}: {self:?}",
                k % m
            );
            if !with_phase {
                continue;
            }
            let phase = phase[k];
            assert!(
                runs_away || phase != Phase::Slip as i8 || gauge >= normal * least - error,
                "contact {} slips: k_C(−λ) = {gauge} at λ_N = {normal} and f = {least}: {self:?}",
                k % m
            );
            // Beside loads that have run away it cannot be told whether the percussion of a step is any.
            assert!(
                phase != Phase::Open as i8 || normal <= slack * size + step,
                "contact {} is open and presses with {normal}: {self:?}",
                k % m
            );
        }
    }

    /// The mean velocity along the rows of a contact for a unit percussion along each.
    fn mobility(&self, contact: &Contact) -> f64 {
        let inverse = self.matrices[0].clone().try_inverse().expect("a mass matrix is regular");
        let trace = (contact.direction.transpose() * inverse * &contact.direction).trace();
        trace / contact.law.dimension() as f64
    }
}

/// Forces along a motion; `p` numbers per contact.
pub struct Forces<'a> {
    pub p: usize,
    /// Samples since the speed at which the falling part of the rate factor is taken: none in an event-driven
    /// integration, one in Moreau's steps, which take it at the beginning of the step.
    pub lag: usize,
    pub slip: &'a [f64],
    /// Velocities of the system.
    pub u: &'a [f64],
    pub force: &'a [f64],
    pub normal_force: &'a [f64],
    /// What the contacts do.
    pub phase: &'a [i8],
    /// Whether that is to be checked: an event-driven integration knows speeds within its tolerance only, and steep factors
    /// of the speed magnify that.
    pub with_phase: bool,
    /// Relative to the largest normal force.
    pub slack: f64,
    /// The tolerance of percussions relative to their loads, and the length of the step: forces of short steps are known
    /// the less the shorter these are. Zero where forces are integrated.
    pub tolerance: f64,
    pub dt: f64,
}

/// Contacts in samples that slip so slowly that rounding of the velocities turns their slip.
fn slips_by_rounding(slip: &[f64], phase: &[i8], p: usize) -> Vec<bool> {
    const ROUNDING: f64 = 1e-12;
    let speed = |own: &[f64]| own.iter().filter(|v| !v.is_nan()).map(|v| v * v).sum::<f64>().sqrt();
    let speeds: Vec<f64> = slip.chunks_exact(p.max(1)).map(speed).collect();
    let fastest = speeds.iter().fold(0.0, |m: f64, v| m.max(*v));
    let slow = speeds.iter().map(|v| *v <= ROUNDING * fastest);
    slow.zip(phase).map(|(slow, phase)| slow && *phase == Phase::Slip as i8).collect()
}

/// By how much the gauge of `−λ` changes at most where a component of the force changes by a step: on a cusp the slope
/// tells nothing of it.
fn spread(law: &Law, force: &[f64], step: f64) -> f64 {
    let own = gauge(law, force).0;
    let mut beside = force.to_vec();
    let mut most: f64 = 0.0;
    for k in 0..force.len() {
        for side in [step, -step] {
            beside[k] = force[k] + side;
            most = most.max((gauge(law, &beside).0 - own).abs());
        }
        beside[k] = force[k];
    }
    most
}

/// `k_C(−λ)` and the size of its gradient.
fn gauge(law: &Law, force: &[f64]) -> (f64, f64) {
    use asperity::law::FrictionLaw;
    use asperity::set::{StarSet, Vector};
    fn of<const P: usize>(law: &FrictionLaw<P>, force: &[f64]) -> (f64, f64) {
        let force = Vector::<P>::from_fn(|k, _| -force[k]);
        // The trait's methods take arguments whose squares are numbers; a factor of the rate may be smaller than that.
        let size = force.amax();
        let (gauge, gradient) = law.reservoir().gauge_jet(&(force / size));
        (gauge * size, gradient.norm())
    }
    if force.iter().all(|f| *f == 0.0) {
        return (0.0, 0.0);
    }
    match law {
        Law::Zero(_) => unreachable!(),
        Law::One(law) => of(law, force),
        Law::Two(law) => of(law, force),
        Law::Three(law) => of(law, force),
    }
}
