//! Where boundaries of members of an intersection cross in space.

use crate::numeric::vectors::cross_3;
use crate::{ConvexSet, Matrix, Vector};

/// Members whose gauge is this near to one are touched.
const TOUCHED: f64 = 1e-6;
/// What is left of a direction beside normals, relative to it, that is rounding of the point.
const ROUNDING: f64 = 1e-6;
/// Normals whose angle has a smaller sine are one.
const PARALLEL: f64 = 1e-6;
/// Excess of a gauge that is rounding.
const EXCESS: f64 = 1e-13;
/// Largest change of a point that is an improvement, relative to the point.
const NEAR: f64 = 1e-4;

/// What a point near the edge of two sets says of the point on it that is nearest to a `z` outside.
struct Edge<'a, S, const P: usize> {
    sets: [&'a S; 2],
    point: Vector<P>,
    normals: [Vector<P>; 2],
    tangent: Vector<P>,
    /// `uᵢ` in `z − x = Σ uᵢnᵢ` with the unit normals `nᵢ` of both sets, apart from what is along the tangent.
    multipliers: [f64; 2],
    /// What is along the tangent.
    along: f64,
    /// What leads back to both boundaries, across the edge.
    back: Vector<P>,
}

impl<'a, S: ConvexSet<P>, const P: usize> Edge<'a, S, P> {
    /// `None` where both normals do not pull, or boundaries touch without crossing.
    fn new(sets: [&'a S; 2], z: &Vector<P>, point: Vector<P>) -> Option<Self> {
        let jets = sets.map(|set| set.gauge_jet(&point));
        let normals = jets.map(|jet| jet.1.normalize());
        let [first, second] = &normals;
        let across = cross_3(first, second);
        let sine = across.norm();
        // The comparison also turns away what is not a number.
        if !(sine > PARALLEL) {
            return None;
        }
        let tangent = across / sine;
        // Orthogonal to the other normal and to the tangent.
        let duals = [cross_3(second, &tangent) / sine, cross_3(&tangent, first) / sine];
        let away = z - point;
        let multipliers = duals.map(|dual| dual.dot(&away));
        let gaps = jets.map(|jet| (1.0 - jet.0) / jet.1.norm());
        let back = duals[0] * gaps[0] + duals[1] * gaps[1];
        let along = tangent.dot(&away);
        let pull = multipliers.iter().all(|&u| u > 0.0);
        pull.then_some(Self { sets, point, normals, tangent, multipliers, along, back })
    }

    /// `1/(1 + Σ uᵢκᵢ)` with the curvatures `κᵢ` of the boundaries along the edge: so far the nearest point moves when `z`
    /// moves by one along the tangent.
    fn slope(&self) -> f64 {
        let bend = |i: usize| {
            let curvature = curvature(self.sets[i], &self.point, &self.normals[i], &self.tangent);
            self.multipliers[i] * curvature
        };
        1.0 / (1.0 + bend(0) + bend(1))
    }
}

/// The curvature of a set's boundary at `x` in a direction that is tangential, from the projection onto the set: from
/// the distance `d` along the normal its Jacobian is `(I + d B)⁻¹` on the tangents, with `B` the second fundamental form.
fn curvature<S: ConvexSet<P>, const P: usize>(
    set: &S,
    x: &Vector<P>,
    normal: &Vector<P>,
    tangent: &Vector<P>,
) -> f64 {
    let distance = x.norm();
    let jacobian = set.project_jet(&(x + normal * distance), x).1;
    let beside = cross_3(normal, tangent);
    let entry = |u: &Vector<P>, v: &Vector<P>| u.dot(&(jacobian * v));
    let (along, mixed, other) =
        (entry(tangent, tangent), entry(tangent, &beside), entry(&beside, &beside));
    // On an edge or a corner of the set itself the Jacobian is singular.
    let reciprocal = if other > f64::EPSILON { along - mixed * mixed / other } else { along };
    (1.0 / reciprocal.max(0.0) - 1.0).max(0.0) / distance
}

/// The point nearest to `z` on the edge of two sets, by Newton's method from a point near it; `None` where that is no
/// nearest point of the intersection of both, or another one.
fn onto_edge<S: ConvexSet<P>, const P: usize>(
    sets: [&S; 2],
    z: &Vector<P>,
    near: &Vector<P>,
) -> Option<Vector<P>> {
    const ITERATIONS: usize = 10;
    let rounding = 4.0 * f64::EPSILON * z.norm();
    let (mut slope, mut before) = (None, f64::INFINITY);
    let mut edge = Edge::new(sets, z, *near)?;
    let first = edge.along;
    for _ in 0..ITERATIONS {
        if edge.back.norm() + edge.along.abs() <= rounding {
            break;
        }
        // On so short a way the slope remains.
        let slope = *slope.get_or_insert_with(|| edge.slope());
        let step = edge.back + edge.tangent * (slope * edge.along);
        let length = step.norm();
        // Rounding does not shrink any more.
        if !(length < 0.5 * before) {
            break;
        }
        before = length;
        edge = Edge::new(sets, z, edge.point + step)?;
    }
    // Where a member has an edge of its own the steps may lead anywhere.
    let excess = |x: &Vector<P>| sets.iter().map(|set| set.gauge(x) - 1.0).fold(EXCESS, f64::max);
    let held = excess(&edge.point) <= excess(near) && edge.along.abs() <= first.abs().max(rounding);
    (held && (edge.point - near).norm() <= NEAR * near.norm()).then_some(edge.point)
}

/// The projection of `z` with all digits where it lies on an edge of two members. Methods that look at the distance
/// find half of the digits along the edge.
pub(super) fn refined<S: ConvexSet<P>, const P: usize>(
    sets: &[S],
    z: &Vector<P>,
    x: Vector<P>,
) -> Vector<P> {
    let mut touched = sets.iter().filter(|set| set.gauge(&x) > 1.0 - TOUCHED);
    let (Some(a), Some(b), None) = (touched.next(), touched.next(), touched.next()) else {
        return x;
    };
    onto_edge([a, b], z, &x).unwrap_or(x)
}

/// The Jacobian of the projection of `z` to `x`, which some members touch: that of the member whose normal is along `z − x`,
/// or along the edge of the two whose normals carry it. `None` anywhere else.
pub(super) fn jacobian<S: ConvexSet<P>, const P: usize>(
    sets: &[S],
    z: &Vector<P>,
    x: &Vector<P>,
) -> Option<Matrix<P>> {
    let touched = || sets.iter().filter(|set| set.gauge(x) > 1.0 - TOUCHED);
    if let (Some(set), None) = (touched().next(), touched().nth(1)) {
        return Some(set.project_jet(z, x).1);
    }
    let away = z - x;
    let rounding = ROUNDING * away.norm();
    let is_alone = |set: &&S| {
        let normal = set.gauge_jet(x).1.normalize();
        let along = normal.dot(&away);
        along > 0.0 && (away - normal * along).norm() <= rounding
    };
    if let Some(set) = touched().find(is_alone) {
        return Some(set.project_jet(z, x).1);
    }
    if P != 3 {
        return None;
    }
    for (i, first) in touched().enumerate() {
        for second in touched().take(i) {
            let Some(edge) = Edge::new([first, second], z, *x) else { continue };
            if edge.along.abs() <= rounding {
                return Some(edge.tangent * edge.tangent.transpose() * edge.slope());
            }
        }
    }
    None
}
