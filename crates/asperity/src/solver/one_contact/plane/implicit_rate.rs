//! All solutions of one contact whose friction rises with the speed of sliding: an implicit factor of the speed.
//!
//! In slip with the speed `s` and the factor `φ = f₋ + f₊(s)` the percussion is `−P_T = P_N φ x`, on the reservoir
//! `φ C`. Without the normal row, `S = G_TT − G_TN G_NT/g_NN` and `q = S⁻¹(b_T − G_TN b_N/g_NN)` (or `S = G_TT`,
//! `q = S⁻¹b_T` where the normal percussion is prescribed), the slip velocity `γ = s n` obeys
//!
//! `P_N φ x + s S⁻¹n = q`, `P_N = −b_N/(g_NN − φ G_NT x)`.
//!
//! Its component along `n` determines φ for every point of bdry *D*: `P_N φ` never falls with φ, and `n·x > 0`, so
//! that `s = (n·q − P_N φ n·x)/(n·S⁻¹n)` never rises, and `f₋ + f₊(s) − φ` has exactly one zero. What is left is one
//! equation along the closed boundary, `F = n × (q − P_N φ x − s S⁻¹n) = 0`, with the solutions at `s > 0`. Where `s`
//! would be negative, `φ = f₋` continues `F`. For `p = 1` both directions are tried.
//!
//! With a prescribed normal percussion there always is a solution: the loads `q` of slip cover the plane outside of
//! `P_N f₋ C`, where the contact sticks, once, counted with signs. Held factors have no such order: a solution whose speed
//! agrees with its factor may lie between stick and another slip that do not.
//!
//! Two solutions between neighbouring nodes of the law's table, where `F` does not change its sign, are overlooked.

use asperity_set::{Arc, BoundaryPoint, StarSet, Vector};

use super::super::block::Block;
use super::super::local::Local;
use super::super::solution::LocalSolution;
use super::equation::{V, cross};
use crate::contact::Phase;
use crate::law::{Node, Stribeck, Walk};

/// Most corrections of a factor; a viscous factor with a prescribed normal force takes one.
const MOST: usize = 100;

/// The factor of the friction of a contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ImplicitRate<'a> {
    /// The law of the speed, of which the rising part counts.
    pub(crate) rate: &'a Stribeck,
    /// The falling part of the factor, at the speed before.
    pub(crate) falling: f64,
    /// The factor that is in the columns of the problem.
    pub(crate) present: f64,
}

/// The equation `F` of one contact; factors are relative to the present one.
struct Equation<'a> {
    block: &'a Block,
    prescribed: Option<f64>,
    b_n: f64,
    factor: &'a ImplicitRate<'a>,
    /// `q`.
    load: V,
    /// `f₋`.
    least: f64,
}

/// What follows from a point of the boundary.
struct At {
    factor: f64,
    speed: f64,
    /// `F`.
    value: f64,
}

impl<'a> Equation<'a> {
    /// The equation of slips, unless the contact opens, has no normal force or cannot be solved; `out` receives what else
    /// there is: open, or stick, if the reservoir `f₋ C` holds it.
    fn new<const P: usize>(
        local: &Local<'a, P>,
        factor: &'a ImplicitRate<'a>,
        out: &mut Vec<LocalSolution<P>>,
    ) -> Option<Self> {
        out.clear();
        if local.opens() {
            out.push(local.open());
        }
        if local.opens() || !local.block.sound {
            return None;
        }
        let stick = local.stick();
        let least = factor.falling / factor.present;
        if stick.holds(local.law, least) {
            out.push(LocalSolution { tangent: stick.tangent / least, ..stick.solution() });
        }
        let Local { block, prescribed, b_n, .. } = *local;
        let load = V::from_fn(|i, _| if i < P { -stick.tangent[i] } else { 0.0 });
        Some(Self { block, prescribed, b_n, factor, load, least })
    }

    /// Slip along `n` with the force along `x`, if there is a speed.
    fn slip<const P: usize>(&self, n: &V, x: &V) -> Option<LocalSolution<P>> {
        let At { factor, speed, .. } = self.at(n, x);
        let normal = self.pull(x, factor)?.0 / factor;
        let tangent = Vector::from_fn(|i, _| -normal * x[i]);
        let slip = Vector::from_fn(|i, _| speed * n[i]);
        (speed > 0.0).then(|| LocalSolution::new(Phase::Slip, normal, tangent, slip))
    }

    /// `P_N φ`, and its slope; `None` where no finite normal force presses.
    fn pull(&self, x: &V, factor: f64) -> Option<(f64, f64)> {
        let Some(normal) = self.prescribed else {
            let denominator = self.block.g_nn - factor * self.block.g_nt.dot(x);
            let normal = -self.b_n / denominator;
            let slope = normal * self.block.g_nn / denominator;
            return (denominator > 0.0).then_some((normal * factor, slope));
        };
        Some((normal * factor, normal))
    }

    fn at(&self, n: &V, x: &V) -> At {
        let ImplicitRate { rate, present, .. } = self.factor;
        let across = self.block.schur_inverse * n;
        let (drive, drag, give) = (n.dot(&self.load), n.dot(x), n.dot(&across));
        let end = |factor: f64, pull: f64| {
            let speed = (drive - pull * drag) / give;
            At { factor, speed, value: cross(n, &(self.load - x * pull - across * speed)) }
        };
        // The limit of pulls without bound, where no finite normal force presses.
        let value = cross(n, &(across * (drag / give) - x));
        let mut best = At { factor: self.least, speed: f64::NEG_INFINITY, value };
        // Newton's method within bounds. As what lacks falls at least as fast as the factor rises, no step leads beyond
        // the factor of the speed with the least one.
        let (mut low, mut high, mut new) = (self.least, f64::INFINITY, self.least);
        for _ in 0..MOST {
            let mut next = f64::NAN;
            if let Some((pull, slope)) = self.pull(x, new) {
                best = end(new, pull);
                let speed = best.speed.max(0.0);
                let lacks = self.least + rate.rising(speed) / present - new;
                let steep = if speed > 0.0 { rate.rising_slope(speed) / present } else { 0.0 };
                let step = lacks / (1.0 + steep * slope * drag / give);
                if step.abs() <= 2.0 * f64::EPSILON * new {
                    break;
                }
                next = new + step;
                *if step.is_sign_positive() { &mut low } else { &mut high } = new;
            } else {
                high = new;
            }
            let between = |factor: &f64| low < *factor && *factor < high;
            let Some(found) = [next, 0.5 * (low + high)].into_iter().find(between) else { break };
            new = found;
        }
        best
    }
}

/// Open, stick and slips in which speed and factor agree, each with the percussions of a problem that has its factor;
/// neither stick nor slip where the block of the contact is ill-conditioned, for which there is no `S⁻¹`.
pub(crate) fn solutions(
    local: &Local<'_, 2>,
    factor: &ImplicitRate<'_>,
    out: &mut Vec<LocalSolution<2>>,
) {
    let Some(equation) = Equation::new(local, factor, out) else { return };
    let Walk { table, direction } = local.law.walk();
    let scale = local.law.isotropic_coefficient().unwrap_or(1.0);
    let at_node = |node: &Node| equation.at(&node.point.normal, &(node.x * scale)).value;
    let on_reservoir =
        |point: &BoundaryPoint| point.position / local.law.reservoir().gauge(&point.position);
    let mut last = at_node(&table.nodes[0]);
    for pair in table.nodes.windows(2) {
        let next = at_node(&pair[1]);
        if (last >= 0.0) != (next >= 0.0) {
            let arc = Arc { start: pair[0].point, end: pair[1].point };
            let value = |at: &BoundaryPoint| equation.at(&at.normal, &on_reservoir(at)).value;
            let root = arc.root(direction, 0.0, value);
            out.extend(equation.slip(&root.normal, &on_reservoir(&root)));
        }
        last = next;
    }
}

/// The same on a line.
pub(crate) fn solutions_on_a_line(
    local: &Local<'_, 1>,
    factor: &ImplicitRate<'_>,
    out: &mut Vec<LocalSolution<1>>,
) {
    let Some(equation) = Equation::new(local, factor, out) else { return };
    for sign in [1.0, -1.0] {
        let x = sign / local.law.reservoir().gauge(&Vector::<1>::new(sign));
        out.extend(equation.slip(&V::new(sign, 0.0), &V::new(x, 0.0)));
    }
}
