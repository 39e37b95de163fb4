//! How large a set fits inside another.

use super::closed_form::ratio_in_closed_form;
use super::peaks::{largest_in_space, slender_frame};
use super::turning_directions::TurningDirections;
use crate::numeric::vectors::along;
use crate::{Cancelled, ConvexSet, Matrix, StarSet, Vector, directions};

/// The largest `s` with `s·inner ⊆ outer`: the reciprocal of the largest gauge of `outer` on `inner`.
///
/// In closed form where there is one ([`ratio_in_closed_form`]). Else it is searched for from the highest points among corners
/// and scans of the boundary, also in frames in which slender sets are round.
pub fn largest_scale_inside<const P: usize>(
    inner: &dyn ConvexSet<P>,
    outer: &dyn StarSet<P>,
) -> f64 {
    if let Some((ratio, _)) = known_ratio(outer, inner, &|| false) {
        return 1.0 / ratio;
    }
    let largest = match P {
        1 => [1.0, -1.0].map(|s| outer.gauge(&inner.support_point(&Vector::repeat(s)))),
        2 => [climb(inner, outer), largest_ratio(outer, inner).0],
        _ => {
            let (ratio, at) = largest_ratio(outer, inner);
            [ratio, ascend(inner, outer, ratio, at / inner.gauge(&at)).0]
        }
    };
    1.0 / largest[0].max(largest[1])
}

/// The largest ratio of two gauges over all directions, `max k_a(x)/k_b(x)`, and a unit direction that has
/// it: `b` scaled by the reciprocal lies inside `a` and touches it there.
pub fn largest_ratio<const P: usize>(a: &dyn StarSet<P>, b: &dyn StarSet<P>) -> (f64, Vector<P>) {
    largest_ratio_unless(a, b, &|| false)
}

/// The same, unless `cancelled` gives it up, which is asked between evaluations of gauges: the ratio then says nothing.
pub fn largest_ratio_unless<const P: usize>(
    a: &dyn StarSet<P>,
    b: &dyn StarSet<P>,
    cancelled: Cancelled<'_>,
) -> (f64, Vector<P>) {
    if let Some(known) = known_ratio(a, b, cancelled) {
        return known;
    }
    // With nothing to gain anywhere every search ends after a few more moves.
    let ratio = |d: &Vector<P>| {
        if cancelled() { f64::NEG_INFINITY } else { a.gauge(d) / b.gauge(d) }
    };
    if P == 3 {
        let (value, at) = largest_in_space(&[a, b], &ratio, cancelled);
        return search(&ratio, value, at, 1e-4);
    }
    let around = directions::<P>(2880);
    let mut ranked: Vec<Peak<P>> = Vec::new();
    // The whole cap of a slender set may lie between two neighbouring directions of the scan.
    let slender = [a, b].into_iter().filter_map(|set| slender_frame(set, cancelled));
    for frame in std::iter::once(Matrix::identity()).chain(slender) {
        let values: Vec<f64> = around.iter().map(|unit| ratio(&(frame * unit))).collect();
        let count = around.len();
        // Of equidistant angles only those with lower neighbours.
        let is_peak = |&i: &usize| {
            let neighbours = [(i + count - 1) % count, (i + 1) % count];
            P != 2 || neighbours.iter().all(|&j| values[i] >= values[j])
        };
        let peak = |i: usize| Peak { value: values[i], at: around[i], frame };
        ranked.extend((0..count).filter(is_peak).map(peak));
    }
    let corners = a.corners().into_iter().chain(b.corners());
    ranked.extend(corners.map(|x| Peak { value: ratio(&x), at: x, frame: Matrix::identity() }));
    ranked.sort_by(|p, q| q.value.total_cmp(&p.value));
    ranked.truncate(24);
    let refined = ranked.into_iter().map(|Peak { value, at, frame }| {
        let (value, at) = search(&|x| ratio(&(frame * x)), value, at, REACH);
        (value, (frame * at).normalize())
    });
    let largest = refined.max_by(|p, q| p.0.total_cmp(&q.0));
    largest.unwrap_or((f64::NEG_INFINITY, Vector::zeros()))
}

/// A direction `frame · at` to search from: one of a scan that has a larger value than its neighbours, or a corner.
struct Peak<const P: usize> {
    value: f64,
    at: Vector<P>,
    frame: Matrix<P>,
}

/// The largest ratio where a closed form gives it, or in the plane directions in which both sets are resolved.
fn known_ratio<const P: usize>(
    a: &dyn StarSet<P>,
    b: &dyn StarSet<P>,
    cancelled: Cancelled<'_>,
) -> Option<(f64, Vector<P>)> {
    ratio_in_closed_form(a, b).or_else(|| {
        let around = TurningDirections::new(a, b)?;
        let ratio = |d: &Vector<P>| {
            if cancelled() { f64::NEG_INFINITY } else { a.gauge(d) / b.gauge(d) }
        };
        let (ratio, x) = around.largest(ratio);
        Some((ratio, x.normalize()))
    })
}

/// Largest gauge of `outer` on `inner` in the plane: the best of many directions climb, and a search shrinks around what
/// they reach.
fn climb<const P: usize>(inner: &dyn ConvexSet<P>, outer: &dyn StarSet<P>) -> f64 {
    let on_boundary = |direction: &Vector<P>| direction / inner.gauge(direction);
    let mut starts: Vec<Vector<P>> = directions::<P>(720);
    starts.extend(inner.corners());
    starts.extend(outer.corners());
    let mut ranked: Vec<(f64, Vector<P>)> = starts
        .iter()
        .flat_map(|d| [on_boundary(d), inner.support_point(d)])
        .map(|x| (outer.gauge(&x), x))
        .collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked.truncate(12);
    let climbed = ranked.into_iter().map(|(value, x)| {
        let (best, at) = ascend(inner, outer, value, x);
        search(&|d| outer.gauge(&on_boundary(d)), best, at, REACH).0
    });
    climbed.fold(f64::NEG_INFINITY, f64::max)
}

/// From a point of `inner` with this gauge `x ← inner.support_point(∇k_outer(x))`, which never descends for a convex
/// `outer`.
fn ascend<const P: usize>(
    inner: &dyn ConvexSet<P>,
    outer: &dyn StarSet<P>,
    mut best: f64,
    mut at: Vector<P>,
) -> (f64, Vector<P>) {
    for _ in 0..50 {
        let next = inner.support_point(&outer.gauge_jet(&at).1);
        let gauge = outer.gauge(&next);
        if !(gauge > best) {
            break;
        }
        (best, at) = (gauge, next);
    }
    (best, at)
}

/// Moves of one length before a shorter one is tried, the first length, and the last one relative to a coordinate.
const MOVES: usize = 30;
const REACH: f64 = 0.02;
const SHORTEST: f64 = 1e-13;
/// The last length from a coordinate that is zero. A cusp on an axis can be so sharp that the largest value lies where a
/// direction away from the axis would be rounded onto it.
const BESIDE_AXES: f64 = 1e-60;

/// Local maximum over directions around `at` by a pattern of shrinking steps.
fn search<const P: usize>(
    value: &dyn Fn(&Vector<P>) -> f64,
    best: f64,
    at: Vector<P>,
    reach: f64,
) -> (f64, Vector<P>) {
    let (mut best, mut at, mut step, mut moves) = (best, at.normalize(), reach, 0);
    while step > BESIDE_AXES {
        let (mut moved, mut tried) = (false, false);
        for i in 0..2 * P {
            if step <= SHORTEST * at[i / 2].abs() {
                continue;
            }
            tried = true;
            let trial = at + along(i / 2, if i % 2 == 0 { step } else { -step });
            let gauge = value(&trial);
            if gauge > best {
                (best, at, moved) = (gauge, trial.normalize(), true);
            }
        }
        if !tried {
            break;
        }
        // On rounding errors there is always a way up.
        moves += 1;
        if !moved || moves > MOVES {
            (step, moves) = (0.5 * step, 0);
        }
    }
    (best, at)
}
