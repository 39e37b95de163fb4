//! All solutions of one contact whose friction rises with the speed of sliding.
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
//! would be negative, `φ = f₋` continues `F`.
//!
//! With a prescribed normal percussion there always is a solution. `φ x` and `s n` depend continuously on the load
//! `q`: for `q` inside of `P_N f₋ C` the contact sticks, and from there the loads of slip cover the rest of the plane
//! once, counted with signs. Held factors have no such order: a solution whose speed agrees with its factor may lie
//! between stick and another slip that do not.
//!
//! Zeros are looked for between the nodes of the law's table, of which two neighbours hold at most one pair that is
//! overlooked.

use asperity_set::{Arc, BoundaryPoint, StarSet};

use super::super::local::{Local, LocalSolution};
use super::equation::{Slip, V, cross};
use crate::contact::Phase;
use crate::law::{Node, Stribeck, Walk};

/// Most corrections of a factor; a viscous factor with a prescribed normal force takes one.
const MOST: usize = 100;

/// The factor of the friction of a contact.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rising<'a> {
    /// The law of the speed, of which the rising part counts.
    pub(crate) rate: &'a Stribeck,
    /// The falling part of the factor, at the speed before.
    pub(crate) falling: f64,
    /// The factor that is in the columns of the problem.
    pub(crate) present: f64,
}

/// The equation `F` of one contact; factors are relative to the present one.
struct Equation<'a, 'b, 'c> {
    slip: &'a Slip<'b, 'c>,
    factor: &'a Rising<'a>,
    /// `q`.
    load: V,
    least: f64,
}

/// What follows from a point of the boundary.
struct At {
    factor: f64,
    speed: f64,
    value: f64,
}

impl Equation<'_, '_, '_> {
    /// `P_N φ`, and its slope; `None` where no finite normal force presses.
    fn pull(&self, x: &V, factor: f64) -> Option<(f64, f64)> {
        let local = self.slip.local;
        match local.prescribed {
            Some(normal) => Some((normal * factor, normal)),
            None => {
                let denominator = local.denominator(&(x * factor));
                let normal = -local.b_n / denominator;
                let slope = normal * local.block.g_nn / denominator;
                (denominator > 0.0).then_some((normal * factor, slope))
            }
        }
    }

    fn at(&self, n: &V, x: &V) -> At {
        let Self { slip, factor: Rising { rate, present, .. }, .. } = self;
        let across = slip.local.block.schur_inverse * n;
        let (drive, drag, give) = (n.dot(&self.load), n.dot(x), n.dot(&across));
        let end = |factor: f64, pull: f64| {
            let speed = (drive - pull * drag) / give;
            At { factor, speed, value: cross(n, &(self.load - x * pull - across * speed)) }
        };
        let Some((pull, _)) = self.pull(x, self.least) else {
            // The limit of pulls without bound.
            let value = cross(n, &(across * (drag / give) - x));
            return At { factor: self.least, speed: f64::NEG_INFINITY, value };
        };
        let first = end(self.least, pull);
        if !(first.speed > 0.0) {
            return first;
        }
        let (mut low, mut high) = (self.least, self.least + rate.rising(first.speed) / present);
        let mut new = low;
        let mut best = first;
        for _ in 0..MOST {
            let Some((pull, slope)) = self.pull(x, new) else {
                (high, new) = (new, 0.5 * (low + new));
                continue;
            };
            best = end(new, pull);
            let speed = best.speed.max(0.0);
            let lacks = self.least + rate.rising(speed) / present - new;
            if lacks > 0.0 {
                low = new
            } else {
                high = new
            }
            let fall =
                if speed > 0.0 { rate.rising_slope(speed) * slope * drag / give } else { 0.0 };
            let step = lacks / (1.0 + fall / present);
            if step.abs() <= 2.0 * f64::EPSILON * new {
                break;
            }
            let next = new + step;
            new = if next > low && next < high { next } else { 0.5 * (low + high) };
            if !(new > low && new < high) {
                break;
            }
        }
        best
    }

    /// The slip at a zero of `F`.
    fn solution(&self, root: &BoundaryPoint) -> Option<LocalSolution<2>> {
        let At { factor, speed, .. } = self.at_point(root);
        let x = self.slip.on_reservoir(root);
        let (pull, _) = self.pull(&x, factor)?;
        let normal = pull / factor;
        (speed > 0.0).then(|| LocalSolution {
            phase: Phase::Slip,
            normal,
            tangent: x * -normal,
            slip: root.normal * speed,
            degenerate: false,
        })
    }

    fn at_point(&self, point: &BoundaryPoint) -> At {
        self.at(&point.normal, &self.slip.on_reservoir(point))
    }
}

/// Open, stick and slips in which speed and factor agree, each with the percussions of a problem that has its factor;
/// neither stick nor slip where the block of the contact is ill-conditioned, for which there is no `S⁻¹`.
pub(in crate::solver) fn solutions(
    local: &Local<'_, 2>,
    factor: &Rising<'_>,
    out: &mut Vec<LocalSolution<2>>,
) {
    out.clear();
    let block = local.block;
    if local.prescribed == Some(0.0) || local.prescribed.is_none() && local.b_n >= 0.0 {
        out.push(local.open());
        return;
    }
    if !block.sound {
        return;
    }
    let least = factor.falling / factor.present;
    let beside = if local.prescribed.is_none() { local.b_n / block.g_nn } else { 0.0 };
    let load = block.schur_inverse * (local.b_t - block.g_tn * beside);
    let normal = local.prescribed.unwrap_or_else(|| block.g_nt.dot(&load) / block.g_nn - beside);
    if normal > 0.0 && local.law.reservoir().gauge(&(load / normal)) <= least {
        let (tangent, slip) = (load / -least, V::zeros());
        let phase = Phase::Stick;
        out.push(LocalSolution { phase, normal, tangent, slip, degenerate: false });
    }
    let Walk { table, direction } = local.law.walk();
    let slip = Slip::new(local, local.law.bounds().largest_radius);
    let equation = Equation { slip: &slip, factor, load, least };
    let at_node = |node: &Node| equation.at(&node.point.normal, &(node.x * slip.scale)).value;
    let mut last = at_node(&table.nodes[0]);
    for pair in table.nodes.windows(2) {
        let next = at_node(&pair[1]);
        if (last >= 0.0) != (next >= 0.0) {
            let arc = Arc { start: pair[0].point, end: pair[1].point };
            let root = arc.root(direction, 0.0, |point| equation.at_point(point).value);
            out.extend(equation.solution(&root));
        }
        last = next;
    }
}
