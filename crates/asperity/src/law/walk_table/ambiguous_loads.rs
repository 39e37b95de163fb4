//! Loads that may have several solutions.

use asperity_set::{Convex, ConvexSet, Star, StarSet, Vector};

use super::node::{Node, angle};

/// Number of sectors that loads are sorted into. In 2.7 % of the steps of the mass on a belt of `benches/step.rs` a load is
/// in doubt and the boundary is scanned, with 128 sectors in 6.5 %.
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
        let at = |node: &Node, k: i32| {
            let s = if last > size {
                1.4_f64.powi(k) - 1.0
            } else {
                f64::from(k) * last / (24.0 * size)
            };
            node.x + node.point.normal * (s * size).min(last)
        };
        let steps = if last > size { (last / size + 1.0).log(1.4).ceil() as i32 } else { 24 };
        for k in 0..steps {
            let [a, b] = [0, 1].map(|n| [at(&pair[n], k), at(&pair[n], k + 1)]);
            for (from, to) in [(a[0], a[1]), (b[0], b[1]), (a[0], b[0]), (a[1], b[1])] {
                cover(&mut sectors, reservoir, &from, &to);
            }
        }
        if last < reach {
            for node in pair {
                let beyond = at(node, steps);
                let far = Gauges { low: 1.0, ..Gauges::ALL };
                mark(&mut sectors, &beyond, &node.point.normal, far);
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

/// Joins the gauges on a segment to all sectors that it crosses.
fn cover(sectors: &mut [Gauges; SECTORS], reservoir: &Star<2>, from: &Vector<2>, to: &Vector<2>) {
    let (first, last) = (reservoir.gauge(from), reservoir.gauge(to));
    let step = to - from;
    let dip = reservoir.gauge(&step).max(reservoir.gauge(&-step));
    let between = Gauges { low: first.min(last) - dip, high: first.max(last) + dip };
    mark(sectors, from, to, between);
}

/// Joins an interval to all sectors from one ray to another, the short way, and one more at each end.
fn mark(sectors: &mut [Gauges; SECTORS], from: &Vector<2>, to: &Vector<2>, interval: Gauges) {
    let (a, b) = (sector(from), sector(to));
    let ahead = (b + SECTORS - a) % SECTORS;
    let (start, count) = if ahead <= SECTORS / 2 { (a, ahead) } else { (b, SECTORS - ahead) };
    for k in 0..count + 3 {
        let place = &mut sectors[(start + SECTORS - 1 + k) % SECTORS];
        *place = place.join(interval);
    }
}
