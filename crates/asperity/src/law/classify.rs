//! What kind of law a pair of sets is, with witnesses.

use asperity_set::{Convex, ConvexSet, Star, StarSet, Vector, Verdict, directions};

use super::FrictionLaw;

/// Number of directions that are tried.
const COUNT: usize = 1440;

impl<const P: usize> FrictionLaw<P> {
    /// Whether the law is associated, `D = aC` (\[WL19\] Def. 12). The defect is `1 − min r_D/r_C`, the witness the
    /// sliding direction whose force is farthest from that of the associated law.
    ///
    /// On a line *D* has no influence and every law is associated.
    pub fn associativity(&self) -> Verdict<P> {
        if P == 1 || self.reservoir().as_convex() == Some(self.direction()) {
            return Verdict::exact(true);
        }
        let defect = 1.0 - self.alpha_min();
        let outline = self.outline();
        let apart = |e: &Vector<P>| {
            (self.slip_force(e) - farthest(self.reservoir(), &outline, e)).norm_squared()
        };
        Verdict::sampled(defect, vec![largest(&self.sliding_directions(), apart).1])
    }

    /// Whether the force opposes the sliding velocity, `D` a ball (\[WL19\] Def. 15). The witness is the
    /// sliding direction with the largest deflection.
    pub fn collinearity(&self) -> Verdict<P> {
        if P == 1 || matches!(self.direction(), Convex::Ball(_)) {
            return Verdict::exact(true);
        }
        let deflection = |e: &Vector<P>| {
            let z = self.direction().support_point(e).normalize();
            (z - e * z.dot(e)).norm()
        };
        let worst = largest(&self.sliding_directions(), deflection);
        Verdict::sampled(worst.0, vec![worst.1])
    }

    /// Whether every sliding motion dissipates (\[WL19\] Def. 11). It does by Prop. 5, for the origin is
    /// inside *D* and `−λᵀγ = λ_N Ψ*_D(γ)/k_C(z) > 0`, unless a user's set breaks its promise; the witness is a
    /// sliding direction then.
    pub fn dissipativity(&self) -> Verdict<P> {
        let lack = |e: &Vector<P>| -self.slip_force(e).dot(e);
        let worst = largest(&self.sliding_directions(), lack);
        // The comparison also catches NaN.
        if worst.0 < 0.0 { Verdict::exact(true) } else { Verdict::refuted(worst.0, vec![worst.1]) }
    }

    /// Whether the law is maximal monotone, which associated laws are and others are not (\[WL19\] Prop. 3,
    /// 4). The witness is `γ, λ, γ*, λ*` with `(γ − γ*)ᵀ(λ − λ*) > 0`.
    ///
    /// A pair of slip and stick is enough: with `γ* = 0` every `−λ* ∈ C` is admissible, and monotonicity
    /// asks that `−λ` dissipates most of them.
    pub fn monotonicity(&self) -> Verdict<P> {
        if let Some(falling) = self.falling_speeds() {
            return falling;
        }
        let associated = self.associativity();
        if associated.holds {
            return Verdict { witness: Vec::new(), ..associated };
        }
        let outline = self.outline();
        let excess = |e: &Vector<P>| {
            let best = farthest(self.reservoir(), &outline, e);
            let own = self.slip_force(e);
            (e.dot(&best) - e.dot(&own)) / e.dot(&best)
        };
        let (defect, e) = largest(&self.sliding_directions(), excess);
        // So slow that the speed does not count.
        let slip = e * self.rate().map_or(1.0, |rate| 1e-6 * rate.speed());
        let best = farthest(self.reservoir(), &outline, &e);
        let witness = vec![slip, -self.slip_force(&e), Vector::zeros(), -best];
        Verdict { holds: false, defect: defect.max(0.0), witness, ..associated }
    }

    /// `−λ/λ_N` in slip, without the factor of the speed.
    fn slip_force(&self, slip: &Vector<P>) -> Vector<P> {
        let z = self.direction().support_point(slip);
        z / self.reservoir().gauge(&z)
    }

    /// A refutation of monotonicity by friction that falls with the speed.
    fn falling_speeds(&self) -> Option<Verdict<P>> {
        let rate = self.rate()?;
        let speeds: Vec<f64> = (-60..=60).map(|k| rate.speed() * 1.25_f64.powi(k)).collect();
        let drop = |pair: &[f64]| rate.factor(pair[0]) - rate.factor(pair[1]);
        let steepest = speeds.windows(2).max_by(|a, b| drop(a).total_cmp(&drop(b)))?;
        if drop(steepest) <= 0.0 {
            return None;
        }
        let e = directions::<P>(1)[0];
        let force = self.slip_force(&e);
        let at = |v: f64| [e * v, -force * rate.factor(v)];
        let witness = [at(steepest[0]), at(steepest[1])].concat();
        Some(Verdict::refuted(drop(steepest), witness))
    }

    /// Sliding directions: all around, and the normals beside the corners of both sets.
    fn sliding_directions(&self) -> Vec<Vector<P>> {
        let mut all: Vec<Vector<P>> = directions(COUNT);
        let corners = self.reservoir().corners().into_iter().chain(self.direction().corners());
        all.extend(corners.map(|x| self.direction().normal(&x).normalize()));
        all
    }

    fn outline(&self) -> Vec<Vector<P>> {
        let all = directions::<P>(COUNT);
        let on_boundary = all.into_iter().map(|d| d / self.reservoir().gauge(&d));
        on_boundary.chain(self.reservoir().corners()).collect()
    }
}

/// The point of a reservoir that is farthest along `e`, from points of its outline if it is not convex.
fn farthest<const P: usize>(
    reservoir: &Star<P>,
    outline: &[Vector<P>],
    e: &Vector<P>,
) -> Vector<P> {
    match reservoir.as_convex() {
        Some(convex) => convex.support_point(e),
        None => largest(outline, |x| x.dot(e)).1,
    }
}

fn largest<const P: usize>(
    candidates: &[Vector<P>],
    value: impl Fn(&Vector<P>) -> f64,
) -> (f64, Vector<P>) {
    let pairs = candidates.iter().map(|x| (value(x), *x));
    let best = pairs.max_by(|a, b| a.0.total_cmp(&b.0));
    best.unwrap_or((0.0, Vector::zeros()))
}
