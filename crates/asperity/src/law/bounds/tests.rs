//! Bounds against the nodes of the table.

use asperity_set::{CappedRectangle, Cuboid, Ellipse, Superellipse};

use super::super::WalkTable;
use super::*;
use crate::random::random;

type V = Vector<2>;

fn ellipse(a: f64, b: f64, angle: f64) -> Convex<2> {
    Convex::from(Ellipse::new(V::new(a, b)).unwrap()).rotated(angle).unwrap()
}

fn disk(radius: f64) -> Convex<2> {
    Ball::new(radius).unwrap().into()
}

#[test]
fn bounds_of_ellipses_are_their_closed_forms() {
    let bounds = |reservoir: Convex<2>, direction: Convex<2>| {
        Bounds::of_smooth_sets(&reservoir.into(), &direction).unwrap()
    };
    let own = bounds(ellipse(0.6, 0.2, 0.4), ellipse(0.6, 0.2, 0.4));
    assert!((own.smallest_sine - 1.0).abs() < 1e-12, "{own:?}");
    assert!((own.largest_radius - 0.6).abs() < 1e-15, "{own:?}");
    let above = own.largest_advance / (0.36 / 0.2) - 1.0;
    assert!((0.0..0.01).contains(&above), "{own:?}");
    // A disk within twice the disk: ways are twice as long.
    let twice = bounds(disk(0.8), disk(0.4));
    assert!((0.8..0.808).contains(&twice.largest_advance), "{twice:?}");
    assert!((twice.largest_radius - 0.8).abs() < 1e-15, "{twice:?}");
    // The normal of an ellipse is off the ray by at most asin((a² − b²)/(a² + b²)), of which the cosine counts.
    let aside = bounds(ellipse(0.6, 0.2, 0.3), disk(0.2));
    let sine = (1.0 - (0.32f64 / 0.4).powi(2)).sqrt();
    assert!((aside.smallest_sine - sine).abs() < 1e-12, "{aside:?} {sine}");
}

/// Bounds hold at all nodes of the table, and between them; they are not far from what the nodes say.
#[test]
fn bounds_hold_all_along_the_boundary() {
    let mut seed = 7_u64;
    let mut within = |low: f64, high: f64| low + 0.5 * (high - low) * (1.0 + random(&mut seed));
    let mut apart = [0.0; 3];
    for k in 0..120 {
        let slender = if k % 10 == 0 { 3.0 } else { 1.0 };
        let mut axes =
            || V::new(10f64.powf(within(-slender, 0.0)), 10f64.powf(within(-slender, 0.0)));
        let mut set = |kind: i32| match kind {
            0 => Convex::from(Ellipse::new(axes()).unwrap()),
            1 => disk(axes().x),
            _ => Superellipse::new(axes(), [1.3, 2.5, 8.0, 60.0][(k / 7 % 4) as usize])
                .unwrap()
                .try_into()
                .unwrap(),
        };
        let (reservoir, direction) = (set(k % 3), set(k / 3 % 3));
        let turns = [0.0, within(-3.0, 3.0)][usize::from(k % 4 > 0)];
        let (reservoir, direction) = (reservoir.rotated(turns).unwrap(), direction);
        let reservoir = Star::from(reservoir);
        let scale = asperity_set::largest_scale_inside(&direction, &reservoir);
        let direction = direction.scaled(scale).unwrap();
        let bounds = Bounds::of_smooth_sets(&reservoir, &direction).unwrap();
        let table = WalkTable::new(&reservoir, &direction);
        let rough = table.bounds(&direction);
        let (mut sine, mut advance) = (1.0_f64, 0.0_f64);
        for node in &table.nodes {
            let normal = reservoir.gauge_jet(&node.point.position).1.normalize();
            sine = sine.min(normal.dot(&direction.normal(&node.point.position).normalize()));
        }
        for pair in table.nodes.windows(2) {
            let (m, n) = (pair[0].point.normal, pair[1].point.normal);
            let turned = (m.x * n.y - m.y * n.x).atan2(m.dot(&n));
            // Where nothing turns, rounding does.
            if turned > 1e-6 {
                advance = advance.max((pair[1].x - pair[0].x).norm() / turned);
            }
        }
        let largest = table.nodes.iter().map(|node| node.x.norm()).fold(0.0, f64::max);
        let name =
            format!("{k}: {bounds:?} {rough:?} {sine} {advance} of {reservoir:?} {direction:?}");
        assert!(bounds.smallest_sine <= sine + 1e-9, "{name}");
        assert!(bounds.largest_radius >= largest * (1.0 - 1e-12), "{name}");
        assert!(bounds.largest_advance >= advance * (1.0 - 1e-4), "{name}");
        apart[0] = f64::max(apart[0], sine - bounds.smallest_sine);
        apart[1] = f64::max(apart[1], bounds.largest_radius / largest - 1.0);
        if bounds.largest_advance.is_finite() {
            apart[2] = f64::max(apart[2], bounds.largest_advance / rough.largest_advance);
        }
    }
    assert!(apart[0] < 0.02 && apart[1] < 1e-3 && apart[2] < 1.05, "{apart:?}");
}

#[test]
fn corners_have_no_bounds_without_the_table() {
    let boxed = Convex::from(Cuboid::symmetric(V::new(0.5, 0.3)).unwrap());
    let runner = CappedRectangle::new(0.3, 0.1, 0.1).unwrap().into();
    assert!(Bounds::of_smooth_sets(&boxed.clone().into(), &disk(0.2)).is_none());
    assert!(Bounds::of_smooth_sets(&disk(0.2).into(), &runner).is_none());
    let table = WalkTable::new(&boxed.into(), &runner);
    assert_eq!(table.bounds(&runner).largest_advance, f64::INFINITY);
}
