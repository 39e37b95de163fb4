//! The boundary of the direction set as a table, made once per law for the exact one-contact solver.
//!
//! Walked along bdry *D*, a slip solution is a zero of `F = n × v(x)`, `v(x) = c₀ − A x`, with `n` the
//! normal of *D* at `z` and `x = z/k_C(z)` on bdry *C*. For every law `F` is linear in `(c₀, A)`: its
//! values at all nodes are a product with columns that depend on the law alone, and so is a bound of
//! how far `F` strays from its chord between two nodes, which excludes zeros. The bounds are sampled
//! between the nodes and carry a margin; corners are nodes, so that nothing sharp lies in between.

mod ambiguous_loads;
mod node;

use std::collections::BinaryHeap;
use std::f64::consts::TAU;

use asperity_set::{Arc, BoundaryPoint, Convex, ConvexSet, Star, StarSet, Vector};

pub(crate) use ambiguous_loads::AmbiguousLoads;
pub(crate) use node::Node;
use node::angle;

use super::Bounds;

/// Number of coarse cells.
pub(crate) const COARSE: usize = 64;
/// Smallest and largest number of fine cells in a coarse one: enough for all corners, and for a quarter of smooth nodes.
const FINE: usize = 16;
const FINEST: usize = 1024;
/// Most nodes at corners and ends of flats: of a polygon with more than some 16 000 corners the others turn by less than
/// 0.03° and lie within cells.
const MOST_AT_CORNERS: usize = COARSE * FINEST * 3 / 4;

/// Bounds over a cell: `F` differs from a point of its chord by at most `|c₀| normal + |A| product`.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cell {
    /// Largest distance of the normal from its chord.
    pub normal: f64,
    /// Largest distance of the dyad `n ⊗ x` from its chord.
    pub product: f64,
    /// Largest distance of `x` from its chord, the same part of which is meant as for the normal.
    pub position: f64,
}

/// Columns whose linear combinations are `n × v` and `n · v` at the coarse nodes, and their bounds over the coarse cells.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    pub(crate) n: [[f64; COARSE]; 2],
    /// `nx[i][j]` is `nᵢ xⱼ`.
    pub(crate) nx: [[[f64; COARSE]; 2]; 2],
    /// `F` and `n·v` differ from their chords by at most `|c₀| normal + |A| product`, see [`Cell`].
    pub(crate) normal: [f64; COARSE],
    pub(crate) product: [f64; COARSE],
}

/// See the module page.
#[derive(Debug, Clone)]
pub(crate) struct WalkTable {
    /// Fine nodes, counter-clockwise, the first repeated at the end.
    pub(crate) nodes: Vec<Node>,
    /// Number of fine cells in a coarse one.
    pub(crate) fine_per_coarse: usize,
    pub(crate) fine: Vec<Cell>,
    pub(crate) columns: Box<Columns>,
    /// Factor of what is sampled, for what lies between the samples.
    margin: f64,
}

impl WalkTable {
    /// The table of a law.
    pub fn new(reservoir: &Star<2>, direction: &Convex<2>) -> Self {
        let mut corners = corners(reservoir, direction);
        corners.extend(ends_of_flats(direction, &corners));
        // A corner between the inner nodes may stray twice as far as they do.
        let margin = if corners.len() > MOST_AT_CORNERS { 2.5 } else { 1.25 };
        corners.truncate(MOST_AT_CORNERS);
        let fine_per_coarse =
            (corners.len() * 4 / 3).div_ceil(COARSE).next_power_of_two().clamp(FINE, FINEST);
        let mut nodes = nodes(reservoir, direction, corners, COARSE * fine_per_coarse);
        debug_assert_eq!(nodes.len(), COARSE * fine_per_coarse);
        nodes.push(nodes[0]);
        let fine: Vec<Cell> = nodes
            .windows(2)
            .map(|pair| {
                let arc = Arc { start: pair[0].point, end: pair[1].point };
                let side = arc.side();
                let inner =
                    [0.25, 0.5, 0.75].map(|w| Node::new(reservoir, arc.point(direction, side, w)));
                deviation(&pair[0], &pair[1], &inner, margin)
            })
            .collect();
        let coarse: [Cell; COARSE] = std::array::from_fn(|i| {
            let range = i * fine_per_coarse..=(i + 1) * fine_per_coarse;
            let (first, last) = (nodes[*range.start()], nodes[*range.end()]);
            let own = deviation(&first, &last, &nodes[range.clone()], margin);
            let within = &fine[*range.start()..*range.end()];
            Cell {
                normal: own.normal + within.iter().map(|c| c.normal).fold(0.0, f64::max),
                product: own.product + within.iter().map(|c| c.product).fold(0.0, f64::max),
                position: own.position + within.iter().map(|c| c.position).fold(0.0, f64::max),
            }
        });
        let at = |i: usize| nodes[i * fine_per_coarse];
        let column = |f: &dyn Fn(Node) -> f64| std::array::from_fn(|i| f(at(i)));
        let columns = Box::new(Columns {
            n: [0, 1].map(|i| column(&|node| node.point.normal[i])),
            nx: [0, 1].map(|i| [0, 1].map(|j| column(&|node| node.point.normal[i] * node.x[j]))),
            normal: coarse.map(|cell| cell.normal),
            product: coarse.map(|cell| cell.product),
        });
        Self { nodes, fine_per_coarse, fine, columns, margin }
    }

    /// What the nodes say of the whole boundary.
    pub(super) fn bounds(&self, direction: &Convex<2>) -> Bounds {
        let Self { nodes, margin, .. } = self;
        Bounds {
            smallest_sine: smallest_sine(nodes),
            largest_radius: nodes.iter().map(|node| node.x.norm()).fold(0.0, f64::max),
            largest_advance: margin * largest_stretch(nodes) * largest_curvature_radius(direction),
        }
    }
}

/// A cell that waits to be split, ordered by how much position, normal and the tangent of *C* turn.
struct Pending {
    turn: f64,
    arc: Arc,
}

impl Pending {
    fn new(arc: Arc, reservoir: &Star<2>, direction: &Convex<2>) -> Self {
        let (start, end) = (&arc.start, &arc.end);
        let turn = angle(&start.position, &end.position) + angle(&start.normal, &end.normal);
        // Just inside the ends, so that a corner of C at a node counts in neither of its cells.
        let side = arc.side();
        let tangent = |w| reservoir.gauge_jet(&arc.point(direction, side, w).position).1;
        let bend = if turn > 1e-6 { angle(&tangent(0.01), &tangent(0.99)) } else { 0.0 };
        Self { turn: turn + bend, arc }
    }
}

impl PartialEq for Pending {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Pending {}

impl PartialOrd for Pending {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Pending {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.turn.total_cmp(&other.turn)
    }
}

/// The corners of both sets, those of *D* with their first and last normals, the sharpest ones first.
fn corners(reservoir: &Star<2>, direction: &Convex<2>) -> Vec<BoundaryPoint> {
    let mut found: Vec<(f64, Vec<BoundaryPoint>)> = Vec::new();
    for position in direction.corners() {
        let cone = direction.normal_cone(&position, 1e-9);
        let normals = cone.as_ref().map_or(&[][..], |cone| cone.generators());
        let turn = normals.first().zip(normals.last()).map_or(0.0, |(a, b)| angle(a, b));
        let points = normals.iter().map(|&normal| BoundaryPoint { position, normal });
        found.push((turn, points.collect()));
    }
    for x in reservoir.corners() {
        let aside = Vector::<2>::new(-x.y, x.x) * 1e-9;
        let turn =
            angle(&reservoir.gauge_jet(&(x + aside)).1, &reservoir.gauge_jet(&(x - aside)).1);
        found.push((turn, vec![BoundaryPoint::at_position(direction, &x)]));
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().flat_map(|corner| corner.1).collect()
}

/// Nodes all around by position and by normal and at the corners, then wherever the walk turns most until there are
/// `count`.
///
/// By position alone, two neighbours may lie on the opposite flat sides of a slender set: between normals that are a
/// half turn apart nothing can be interpolated.
fn nodes(
    reservoir: &Star<2>,
    direction: &Convex<2>,
    corners: Vec<BoundaryPoint>,
    count: usize,
) -> Vec<Node> {
    let mut chain: Vec<BoundaryPoint> = (0..16)
        .flat_map(|k| {
            let (sine, cosine) = (TAU * (k as f64 + 0.5) / 16.0).sin_cos();
            let around = Vector::<2>::new(cosine, sine);
            [
                BoundaryPoint::at_position(direction, &around),
                BoundaryPoint::at_normal(direction, &around),
            ]
        })
        .collect();
    chain.extend(corners);
    let mut chain = in_turn(chain);
    chain.dedup_by(|a, b| a.0 - b.0 < 1e-12);
    let chain: Vec<BoundaryPoint> = chain.into_iter().map(|(_, point)| point).collect();
    let next = |i: usize| chain[(i + 1) % chain.len()];
    let pending = |start, end| Pending::new(Arc { start, end }, reservoir, direction);
    let mut heap: BinaryHeap<Pending> =
        (0..chain.len()).map(|i| pending(chain[i], next(i))).collect();
    while heap.len() < count {
        let Some(Pending { arc, .. }) = heap.pop() else { break };
        let middle = arc.middle(direction);
        heap.push(pending(arc.start, middle));
        heap.push(pending(middle, arc.end));
    }
    let starts = in_turn(heap.into_iter().map(|pending| pending.arc.start));
    let mut points: Vec<BoundaryPoint> = starts.into_iter().map(|(_, point)| point).collect();
    widen_flats(&mut points, direction);
    points.into_iter().map(|point| Node::new(reservoir, point)).collect()
}

/// Both ends of each flat of *D* that is known, but for those at corners, the longest ones first: a flat may be shorter than
/// a cell, of which three inner points do not see it.
fn ends_of_flats(direction: &Convex<2>, corners: &[BoundaryPoint]) -> Vec<BoundaryPoint> {
    // Turns of a normal that lead to the ends of its flat: sides of polygons take small ones for none.
    const ASIDE: [f64; 4] = [1e-12, 1e-11, 1e-10, 1e-9];
    // Least lengths of a flat, as parts of the radius and of what a turn alone makes of it.
    const SHORTEST: f64 = 1e-9;
    const ROUND: f64 = 100.0;
    let corners = in_turn(corners.iter().copied());
    let is_corner = |end: &BoundaryPoint| {
        let angle = walk_angle(end);
        let next = corners.partition_point(|corner| corner.0 < angle - SHORTEST);
        corners.get(next).is_some_and(|corner| corner.0 <= angle + SHORTEST)
    };
    let mut found: Vec<(f64, [BoundaryPoint; 2])> = Vec::new();
    for normal in direction.flat_normals() {
        let normal = normal.normalize();
        let sideways = Vector::<2>::new(-normal.y, normal.x);
        let flat = ASIDE.iter().find_map(|&aside| {
            let turned = [normal - sideways * aside, normal + sideways * aside];
            let [first, last] = turned.map(|n| direction.support_point(&n));
            let length = (last - first).norm() / first.norm();
            let ends = [first, last].map(|position| BoundaryPoint { position, normal });
            (length > SHORTEST.max(ROUND * aside)).then_some((length, ends))
        });
        found.extend(flat);
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().flat_map(|flat| flat.1).filter(|end| !is_corner(end)).collect()
}

/// Moves the outermost nodes on each flat of *D* to its ends.
///
/// There the normal begins to turn with a jump of the curvature, which halves of a cell would not see: the distance to the
/// chord that a kink beside an end of the cell causes does not fall until the kink is in the middle.
fn widen_flats(points: &mut [BoundaryPoint], direction: &Convex<2>) {
    const PARALLEL: f64 = 1e-14;
    // As many as a position has bits.
    const HALVINGS: usize = 54;
    let count = points.len();
    let parallel = |a: &BoundaryPoint, b: &BoundaryPoint| angle(&a.normal, &b.normal) <= PARALLEL;
    let end = |flat: BoundaryPoint, beyond: BoundaryPoint| {
        let (mut on, mut off) = (flat, beyond.position);
        // Points are known to the digits of the gauge only, so that they need not come together.
        for _ in 0..HALVINGS {
            let middle = BoundaryPoint::at_position(direction, &(on.position + off));
            if parallel(&middle, &flat) { on = middle } else { off = middle.position }
        }
        on
    };
    let given = points.to_vec();
    for i in 0..count {
        let [before, here, after, last] =
            [i + count - 1, i, i + 1, i + 2].map(|k| given[k % count]);
        if !parallel(&here, &after) || here.position == after.position {
            continue;
        }
        if !parallel(&before, &here) {
            points[i] = end(here, before);
        }
        if !parallel(&after, &last) {
            points[(i + 1) % count] = end(after, last);
        }
    }
}

/// Points with their walk angles, sorted by these.
fn in_turn(points: impl IntoIterator<Item = BoundaryPoint>) -> Vec<(f64, BoundaryPoint)> {
    let mut turned: Vec<(f64, BoundaryPoint)> =
        points.into_iter().map(|point| (walk_angle(&point), point)).collect();
    turned.sort_by(|a, b| a.0.total_cmp(&b.0));
    turned
}

/// `θ + φ`, position angle plus normal angle, in `[0, 4π)`: never decreases along the walk.
fn walk_angle(point: &BoundaryPoint) -> f64 {
    let (z, n) = (&point.position, &point.normal);
    let theta = z.y.atan2(z.x).rem_euclid(TAU);
    2.0 * theta + (z.x * n.y - z.y * n.x).atan2(z.dot(n))
}

/// How far `n` and `n ⊗ x` stray from their chord at the inner nodes, with a margin for the points between these.
fn deviation(first: &Node, last: &Node, inner: &[Node], margin: f64) -> Cell {
    let dyad = |node: &Node| node.point.normal * node.x.transpose();
    let (n0, dn) = (first.point.normal, last.point.normal - first.point.normal);
    let (m0, dm) = (dyad(first), dyad(last) - dyad(first));
    let scale = 1.0 / m0.norm_squared();
    let length = dn.norm_squared() + scale * dm.norm_squared();
    let mut cell = Cell::default();
    for node in inner {
        let (n, m) = (node.point.normal - n0, dyad(node) - m0);
        let along = n.dot(&dn) + scale * m.dot(&dm);
        let weight = if length > 0.0 { (along / length).clamp(0.0, 1.0) } else { 0.0 };
        cell.normal = cell.normal.max((n - dn * weight).norm());
        cell.product = cell.product.max((m - dm * weight).norm());
        let off_chord = node.x - first.x - (last.x - first.x) * weight;
        cell.position = cell.position.max(off_chord.norm());
    }
    Cell {
        normal: margin * cell.normal,
        product: margin * cell.product,
        position: margin * cell.position,
    }
}

/// Largest radius of curvature of bdry *D*, where a closed form bounds it.
fn largest_curvature_radius(direction: &Convex<2>) -> f64 {
    match direction {
        Convex::Ball(disk) => disk.size(),
        Convex::Ellipsoid(ellipse) => ellipse.semi_axes().max().powi(2) / ellipse.semi_axes().min(),
        _ => f64::INFINITY,
    }
}

/// Largest way along bdry *C* per way along bdry *D*.
fn largest_stretch(nodes: &[Node]) -> f64 {
    let ratio = |pair: &[Node]| {
        let way = (pair[1].point.position - pair[0].point.position).norm();
        if way > 0.0 { (pair[1].x - pair[0].x).norm() / way } else { 0.0 }
    };
    nodes.windows(2).map(ratio).fold(0.0, f64::max)
}

/// Smallest `n × t` with `t` the unit tangent of bdry *C*, taken as the chords next to every node.
fn smallest_sine(nodes: &[Node]) -> f64 {
    let mut smallest: f64 = 1.0;
    for pair in nodes.windows(2) {
        let chord = pair[1].x - pair[0].x;
        // Where the walk stands at a corner of D the point of C does not move.
        if chord.norm() <= 1e-12 * pair[0].x.norm() {
            continue;
        }
        for node in pair {
            let n = node.point.normal;
            smallest = smallest.min((n.x * chord.y - n.y * chord.x) / chord.norm());
        }
    }
    smallest
}

#[cfg(test)]
mod tests;
