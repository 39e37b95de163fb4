//! All solutions of one contact.

use asperity_set::{Arc, BoundaryPoint, Convex};

use super::super::local::{Local, LocalSolution};
use super::equation::Slip;
use super::scan::Scan;
use crate::contact::Phase;
use crate::law::{COARSE, FINE_PER_COARSE, Walk};

/// All solutions, in the order open, stick, slips counter-clockwise along bdry *D*.
pub(in crate::solver) fn solutions(local: &Local<'_, 2>, out: &mut Vec<LocalSolution<2>>) {
    out.clear();
    if local.prescribed == Some(0.0) {
        out.push(local.open());
        return;
    }
    if local.prescribed.is_none() && local.b_n >= 0.0 {
        out.push(local.open());
    }
    out.extend(local.stick().solution);
    if local.prescribed.is_none() && local.b_n == 0.0 {
        return;
    }
    let Walk { table, direction } = local.law.walk();
    let slip = Slip::new(local, local.law.bounds().largest_radius);
    // What is not a number would be searched for without end.
    if !(slip.norm_c + slip.norm_a).is_finite() {
        return;
    }
    let scan = Scan::new(&slip, table);
    for i in 0..COARSE {
        if scan.excluded(&slip, table, i) {
            continue;
        }
        for j in i * FINE_PER_COARSE..(i + 1) * FINE_PER_COARSE {
            let (first, last) = (&table.nodes[j], &table.nodes[j + 1]);
            let stray = slip.stray(&table.fine[j]);
            if !slip.excluded_between(first, last, stray) {
                let arc = Arc { start: first.point, end: last.point };
                search(&slip, direction, &arc, (stray, 0), out);
            }
        }
    }
    merge(local, out);
}

/// All roots of `F` on an arc from whose chord it strays by at most `stray`.
fn search(
    slip: &Slip<'_, '_>,
    direction: &Convex<2>,
    arc: &Arc,
    (stray, depth): (f64, usize),
    out: &mut Vec<LocalSolution<2>>,
) {
    let ends = [&arc.start, &arc.end].map(|point| slip.value(point));
    let smallest = ends[0].abs().min(ends[1].abs());
    if (ends[0] >= 0.0) != (ends[1] >= 0.0) {
        let root = arc.root(direction, slip.rounding, |point| slip.value(point));
        out.extend(slip.admit(&root, false));
        return;
    }
    let wrong = |p: &BoundaryPoint| {
        slip.sign * p.normal.dot(&slip.velocity(&slip.on_reservoir(p))) < -stray
    };
    if smallest > stray || (wrong(&arc.start) && wrong(&arc.end)) {
        return;
    }
    let middle = arc.middle(direction);
    let flat = slip.value(&middle).abs().max(ends[0].abs()).max(ends[1].abs()) <= slip.rounding;
    if flat || depth == 24 {
        // A continuum of solutions is represented by its ends, a double root by itself.
        let ends = [arc.start, arc.end];
        out.extend(ends.iter().take(if flat { 2 } else { 1 }).filter_map(|p| slip.admit(p, true)));
        return;
    }
    // The distance to the chord falls with the square of the length.
    let halves = [Arc { start: arc.start, end: middle }, Arc { start: middle, end: arc.end }];
    for half in &halves {
        search(slip, direction, half, (0.3 * stray, depth + 1), out);
    }
}

/// Removes slip solutions that are stick on the boundary of *C*, and neighbours that are one root.
fn merge(local: &Local<'_, 2>, out: &mut Vec<LocalSolution<2>>) {
    let sticks = out.iter().any(|s| s.phase == Phase::Stick);
    let scale = local.b_t.norm();
    out.retain(|s| s.phase != Phase::Slip || !sticks || s.slip.norm() > 1e-12 * scale);
    let first = out.iter().position(|s| s.phase == Phase::Slip).unwrap_or(out.len());
    let mut kept = first;
    for i in first..out.len() {
        let candidate = out[i];
        match out[first..kept].iter().position(|s| same_root(s, &candidate, scale)) {
            // A root at the end of a cell is seen from the next cell as a double root.
            Some(place) if out[first + place].degenerate => out[first + place] = candidate,
            Some(_) => {}
            None => {
                out[kept] = candidate;
                kept += 1;
            }
        }
    }
    out.truncate(kept);
}

/// Whether two slip solutions are one; double roots are located to the size of the last bisection.
fn same_root(a: &LocalSolution<2>, b: &LocalSolution<2>, scale: f64) -> bool {
    let tolerance = if a.degenerate || b.degenerate { 1e-7 } else { 1e-12 };
    (a.tangent - b.tangent).norm() <= tolerance * a.tangent.norm()
        && (a.slip - b.slip).norm() <= tolerance * scale
}
