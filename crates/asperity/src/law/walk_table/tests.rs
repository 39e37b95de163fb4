//! Bounds of the table: they hold, and by not much more than their margin.

use asperity_set::{Ball, Cuboid, Ellipse, MinkowskiSum, Polygon, Superellipse};

use super::*;
use crate::random::random;

type V = Vector<2>;

fn ellipse(a: f64, b: f64, angle: f64) -> Convex<2> {
    Convex::from(Ellipse::new(V::new(a, b)).unwrap()).rotated(angle).unwrap()
}

fn superellipse(s: f64) -> Convex<2> {
    let set = Superellipse::new(V::new(0.54, 0.46), s).unwrap();
    Star::from(set).as_convex().unwrap().clone()
}

fn smooth() -> Vec<(Star<2>, Convex<2>)> {
    vec![
        (Convex::from(Ball::UNIT).into(), Ball::UNIT.into()),
        (ellipse(0.6, 0.2, 0.0).into(), ellipse(0.6, 0.2, 0.0)),
        (ellipse(0.6, 0.2, 0.5).into(), ellipse(0.6, 0.2, 0.0)),
        (superellipse(2.9).into(), ellipse(0.5, 0.4, 0.0)),
        (superellipse(2.9).into(), superellipse(2.4)),
    ]
}

/// Between two nodes normal, point and their dyad are all within the bounds of one place on their chord, and come as
/// near to these as their margin of a quarter allows.
#[test]
fn deviations_from_chords_are_bounded_tightly() {
    for (k, (reservoir, direction)) in smooth().into_iter().enumerate() {
        let table = WalkTable::new(&reservoir, &direction);
        assert_eq!(table.fine.len() + 1, table.nodes.len());
        let (mut reached, mut cells) = (0.0, 0.0);
        for (pair, cell) in table.nodes.windows(2).zip(&table.fine).step_by(3) {
            let arc = Arc { start: pair[0].point, end: pair[1].point };
            let side = arc.side();
            let dyad = |node: &Node| node.point.normal * node.x.transpose();
            let (n0, m0) = (pair[0].point.normal, dyad(&pair[0]));
            let (dn, dm) = (pair[1].point.normal - n0, dyad(&pair[1]) - m0);
            let dx = pair[1].x - pair[0].x;
            let mut largest = 0.0_f64;
            for i in 1..8 {
                let node = Node::new(&reservoir, arc.point(&direction, side, f64::from(i) / 8.0));
                let (n, m, x) = (node.point.normal - n0, dyad(&node) - m0, node.x - pair[0].x);
                let off = |w: f64| {
                    let normal = (n - dn * w).norm() / cell.normal;
                    let product = (m - dm * w).norm() / cell.product;
                    normal.max(product).max((x - dx * w).norm() / cell.position)
                };
                // The largest of convex functions is convex.
                let (mut low, mut high) = (0.0, 1.0);
                for _ in 0..60 {
                    let (a, b) = ((2.0 * low + high) / 3.0, (low + 2.0 * high) / 3.0);
                    if off(a) < off(b) { high = b } else { low = a }
                }
                largest = largest.max(off(low));
            }
            assert!(largest <= 1.0, "{k}: {largest} {cell:?}");
            reached += largest;
            cells += 1.0;
        }
        assert!((0.79..0.81).contains(&(reached / cells)), "{k}: {}", reached / cells);
    }
}

/// The bounds of the coarse cells, in columns: values at the nodes, and far enough from their chords for all nodes within.
#[test]
fn columns_are_those_of_the_coarse_nodes() {
    for (reservoir, direction) in smooth() {
        let table = WalkTable::new(&reservoir, &direction);
        let columns = &table.columns;
        for i in 0..COARSE {
            let range = i * table.fine_per_coarse..=(i + 1) * table.fine_per_coarse;
            let (first, last) = (&table.nodes[*range.start()], &table.nodes[*range.end()]);
            for a in 0..2 {
                assert_eq!(columns.n[a][i], first.point.normal[a]);
                (0..2).for_each(|b| {
                    assert_eq!(columns.nx[a][b][i], first.point.normal[a] * first.x[b])
                });
            }
            let within = &table.nodes[range];
            let normal =
                within.iter().map(|node| off(node.point.normal, first, last, |n| n.point.normal));
            let product = within.iter().map(|node| off(dyad(node), first, last, dyad));
            for (largest, bound) in [
                (normal.fold(0.0, f64::max), columns.normal[i]),
                (product.fold(0.0, f64::max), columns.product[i]),
            ] {
                assert!(largest <= bound && bound <= 20.0 * largest, "{i}: {largest:e} {bound:e}");
            }
        }
    }
}

/// `n ⊗ x`, row by row.
fn dyad(node: &Node) -> nalgebra::Vector4<f64> {
    let (n, x) = (node.point.normal, node.x);
    nalgebra::Vector4::new(n.x * x.x, n.x * x.y, n.y * x.x, n.y * x.y)
}

/// Distance from the chord between two nodes.
fn off<const N: usize>(
    value: nalgebra::SVector<f64, N>,
    first: &Node,
    last: &Node,
    of: impl Fn(&Node) -> nalgebra::SVector<f64, N>,
) -> f64 {
    let (from, chord) = (value - of(first), of(last) - of(first));
    (from - chord * (from.dot(&chord) / chord.norm_squared())).norm()
}

/// All corners of both sets are nodes, those of *D* with both their normals.
#[test]
fn corners_are_nodes() {
    let rectangle = |a, b| Convex::from(Cuboid::symmetric(V::new(a, b)).unwrap());
    let (reservoir, direction) = (rectangle(0.5, 0.3).rotated(0.4).unwrap(), rectangle(0.3, 0.2));
    let table = WalkTable::new(&reservoir.clone().into(), &direction);
    let near = |a: &V, b: &V| (a - b).norm() < 1e-12;
    for corner in reservoir.corners() {
        assert!(table.nodes.iter().any(|node| near(&node.x, &corner)), "{corner}");
    }
    for corner in direction.corners() {
        for normal in [V::new(corner.x.signum(), 0.0), V::new(0.0, corner.y.signum())] {
            let here = |node: &&Node| {
                near(&node.point.position, &corner) && near(&node.point.normal, &normal)
            };
            assert!(table.nodes.iter().any(|node| here(&node)), "{corner} {normal}");
        }
    }
}

/// With `A = I` a load has several solutions where rays from bdry *C* along normals of *D* cross it more than once. Those
/// are all marked, and no others far away: how many of the loads all around are in doubt without need is counted.
#[test]
fn loads_with_several_solutions_are_marked() {
    let laws = [
        (ellipse(0.6, 0.2, 0.5), ellipse(0.6, 0.2, 0.0)),
        (ellipse(1.0, 0.01, 0.5), ellipse(1.0, 0.01, 0.0)),
    ];
    let mut seed = 3_u64;
    for (k, (reservoir, direction)) in laws.into_iter().enumerate() {
        let star = Star::from(reservoir);
        let table = WalkTable::new(&star, &direction);
        let ambiguous = AmbiguousLoads::new(&table.nodes, &star, &direction);
        let (mut several, mut doubted) = (0, 0);
        for _ in 0..4000 {
            let place = (random(&mut seed) + 1.0) * 0.5 * (table.nodes.len() - 1) as f64;
            let from = &table.nodes[place as usize];
            let reach = 10f64.powf(1.5 * random(&mut seed) - 1.5) * from.x.norm();
            let load = from.x + from.point.normal * reach;
            let gauge = star.gauge(&load);
            // Rays through the load: n × (y − x) changes its sign where n·(y − x) > 0.
            let value = |node: &Node| {
                let (n, off) = (node.point.normal, load - node.x);
                (n.x * off.y - n.y * off.x, n.dot(&off))
            };
            let crosses = |pair: &&[Node]| {
                let [(f, along), (g, _)] = [value(&pair[0]), value(&pair[1])];
                (f >= 0.0) != (g >= 0.0) && along > 0.0
            };
            let rays = table.nodes.windows(2).filter(|pair| crosses(pair)).count();
            let many = rays + usize::from(gauge < 1.0) > 1;
            let marked = ambiguous.may_hold(&load, gauge);
            assert!(marked || !many, "{k}: {load} {rays}");
            several += usize::from(many);
            doubted += usize::from(marked && !many);
        }
        let (most, least) = [(285, 540), (490, 2200)][k];
        assert!(several >= least && doubted <= most, "{k}: {several} {doubted}");
    }
}

/// A sum of an ellipse and a polygon has no corners, and a flat for each side: all their ends are nodes, and the table has
/// as many nodes as its size says.
#[test]
fn ends_of_many_flats_are_nodes() {
    for sides in [4, 350, 600] {
        let corner = |k: usize| {
            let (sine, cosine) = (TAU * k as f64 / sides as f64).sin_cos();
            V::new(0.5 * cosine, 0.5 * sine)
        };
        let corners: Vec<V> = (0..sides).map(corner).collect();
        let polygon = Star::from(Polygon::new(&corners).unwrap()).as_convex().unwrap().clone();
        let sum = MinkowskiSum::new(vec![ellipse(1.0, 0.5, 0.3), polygon]).unwrap();
        let direction = Convex::Sum(Box::new(sum));
        let table = WalkTable::new(&direction.clone().into(), &direction);
        assert_eq!(table.nodes.len(), COARSE * table.fine_per_coarse + 1);
        let pairs = table.nodes.windows(2);
        let side = 2.0 * 0.5 * (TAU / 2.0 / sides as f64).sin();
        let flat = pairs.filter(|pair| {
            let [first, last] = [pair[0].point, pair[1].point];
            let length = (last.position - first.position).norm();
            angle(&first.normal, &last.normal) < 1e-12 && length > 0.999 * side / 64.0
        });
        assert!(flat.count() >= sides, "{sides}");
    }
}
