//! Loads that may have several solutions.

use asperity_set::{Convex, ConvexSet, Star, StarSet, Vector};

use super::node::{Node, angle};

/// Number of sectors that loads are sorted into: the more, the fewer loads are in doubt, for which the boundary is scanned.
const SECTORS: usize = 1024;

/// An interval of gauges.
#[derive(Debug, Clone, Copy)]
struct Gauges {
    low: f64,
    high: f64,
}

impl Gauges {
    const NONE: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY };
    const ALL: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// The smallest interval that holds both.
    fn join(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    #[inline]
    fn hold(self, gauge: f64) -> bool {
        self.low <= gauge && gauge <= self.high
    }
}

/// Sector of a point other than the origin, by the place of its ray on the square `|x₁| + |x₂| = 1`.
#[inline]
fn sector(y: &Vector<2>) -> usize {
    let along = y.x / (y.x.abs() + y.y.abs());
    let turn = if y.y >= 0.0 { 1.0 - along } else { 3.0 + along };
    (turn * (SECTORS / 4) as f64) as usize % SECTORS
}

/// Gauges `k_C(y)` of the loads `y = c₀/a` that may have several solutions with `A = aI`, sector by sector.
#[derive(Debug, Clone)]
pub(crate) struct AmbiguousLoads {
    sectors: [Gauges; SECTORS],
    /// The same over all sectors.
    anywhere: Gauges,
}

impl AmbiguousLoads {
    pub(crate) fn new(nodes: &[Node], reservoir: &Star<2>, direction: &Convex<2>) -> Self {
        let sectors = ambiguous_gauges(nodes, reservoir, direction);
        Self { anywhere: sectors.iter().fold(Gauges::NONE, |all, own| all.join(*own)), sectors }
    }

    /// The least and the largest gauge of such loads, the first one larger where there are none.
    pub(crate) fn gauges(&self) -> (f64, f64) {
        (self.anywhere.low, self.anywhere.high)
    }

    /// Whether a load with gauge `k_C(y)` may have several solutions.
    #[inline]
    pub(crate) fn may_hold(&self, load: &Vector<2>, gauge: f64) -> bool {
        self.anywhere.hold(gauge) && self.sectors[sector(load)].hold(gauge)
    }
}

/// The intervals of all sectors.
///
/// The load `y` has the slip solutions `y = x + s n`, `s > 0`: rays from bdry *C*. Neighbouring rays intersect at
/// `s_c = −n × dx/dφ`, and the points of a ray before that one are the solutions with index −1.
/// The indices of all solutions add up to one, so that there are several only if one of them is −1: if
/// `y` lies on a piece `0 < s < s_c` of some ray. The pieces of neighbouring nodes are joined to strips,
/// with `s_c` the largest that the nodes or their chord give and half as much again.
fn ambiguous_gauges(
    nodes: &[Node],
    reservoir: &Star<2>,
    direction: &Convex<2>,
) -> [Gauges; SECTORS] {
    let mut sectors = [Gauges::NONE; SECTORS];
    // The bounds of the gauge between two points hold for a convex gauge.
    if reservoir.as_convex().is_none() {
        return [Gauges::ALL; SECTORS];
    }
    for pair in nodes.windows(2) {
        let reach = 1.5 * reach(pair, reservoir, direction);
        if reach <= 0.0 {
            continue;
        }
        let size = pair[0].x.norm();
        // Geometric beyond the size of the set; what lies farther counts as infinitely far.
        let last = reach.min(1e6 * size);
        let along = |k: i32| {
            let s = if last > size {
                1.4_f64.powi(k) - 1.0
            } else {
                f64::from(k) * last / (24.0 * size)
            };
            (s * size).min(last)
        };
        let steps = if last > size { (last / size + 1.0).log(1.4).ceil() as i32 } else { 24 };
        let at = |node: &Node, s: f64| Load::new(reservoir, node.x + node.point.normal * s);
        // Of what lies within a step, per length.
        let dips = [0, 1].map(|i| dip(reservoir, &pair[i].point.normal));
        let mut from = [0, 1].map(|i| at(&pair[i], 0.0));
        let mut before = 0.0;
        across(&mut sectors, reservoir, &from);
        for k in 1..=steps {
            let s = along(k);
            let to = [0, 1].map(|i| at(&pair[i], s));
            for i in 0..2 {
                cover(&mut sectors, &from[i], &to[i], (s - before) * dips[i]);
            }
            across(&mut sectors, reservoir, &to);
            (from, before) = (to, s);
        }
        if last < reach {
            for node in pair {
                let beyond = node.x + node.point.normal * along(steps);
                let far = Gauges { low: 1.0, ..Gauges::ALL };
                mark(&mut sectors, sector(&beyond), sector(&node.point.normal), far);
            }
        }
    }
    sectors
}

/// The largest `s_c` in a cell, not positive where neighbouring rays open.
fn reach(pair: &[Node], reservoir: &Star<2>, direction: &Convex<2>) -> f64 {
    let chord = pair[1].x - pair[0].x;
    let along = |node: &Node, dx: &Vector<2>| {
        let n = node.point.normal;
        n.y * dx.x - n.x * dx.y
    };
    let turned = angle(&pair[0].point.normal, &pair[1].point.normal).max(f64::MIN_POSITIVE);
    let mut reach = along(&pair[0], &chord).max(along(&pair[1], &chord)) / turned;
    for node in pair {
        let n = node.point.normal;
        let (z, dz) = direction.support_derivative(&n, &Vector::<2>::new(-n.y, n.x));
        let (gauge, gradient) = reservoir.gauge_jet(&z);
        let dx = (dz - z * (gradient.dot(&dz) / gauge)) / gauge;
        let local = along(node, &dx);
        // No derivative where D is flat: the chord has seen that.
        if local.is_finite() {
            reach = reach.max(local);
        }
    }
    reach
}

/// A load with its gauge and its sector.
#[derive(Debug, Clone, Copy)]
struct Load {
    y: Vector<2>,
    gauge: f64,
    sector: usize,
}

impl Load {
    fn new(reservoir: &Star<2>, y: Vector<2>) -> Self {
        Self { y, gauge: reservoir.gauge(&y), sector: sector(&y) }
    }
}

/// By how much a convex gauge may be below and above its values at the ends of a segment.
fn dip(reservoir: &Star<2>, segment: &Vector<2>) -> f64 {
    reservoir.gauge(segment).max(reservoir.gauge(&-segment))
}

/// Joins the gauges between two neighbouring rays to all sectors that lie between them.
fn across(sectors: &mut [Gauges; SECTORS], reservoir: &Star<2>, [from, to]: &[Load; 2]) {
    cover(sectors, from, to, dip(reservoir, &(to.y - from.y)));
}

/// Joins the gauges on a segment to all sectors that it crosses.
fn cover(sectors: &mut [Gauges; SECTORS], from: &Load, to: &Load, dip: f64) {
    let (low, high) = (from.gauge.min(to.gauge) - dip, from.gauge.max(to.gauge) + dip);
    mark(sectors, from.sector, to.sector, Gauges { low, high });
}

/// Joins an interval to all sectors from one to another, the short way, and one more at each end.
fn mark(sectors: &mut [Gauges; SECTORS], a: usize, b: usize, interval: Gauges) {
    let ahead = (b + SECTORS - a) % SECTORS;
    let (start, count) = if ahead <= SECTORS / 2 { (a, ahead) } else { (b, SECTORS - ahead) };
    for k in 0..count + 3 {
        let place = &mut sectors[(start + SECTORS - 1 + k) % SECTORS];
        *place = place.join(interval);
    }
}
