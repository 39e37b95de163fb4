//! All solutions of one contact.

use super::super::local::{Local, LocalSolution};
use super::equation::Slip;
use super::scan::Scan;
use super::search::{End, Search};
use crate::contact::Phase;
use crate::law::Walk;

/// Slip velocities below this part of what cancels in them are rounding, as singular values are in `single.rs`.
const VANISHING: f64 = 1e-13;

/// All solutions, in the order open, stick, slips counter-clockwise along bdry *D*; false if a cell was given
/// up in which there may be more.
pub(crate) fn solutions(local: &Local<'_, 2>, out: &mut Vec<LocalSolution<2>>) -> bool {
    out.clear();
    if local.opens() {
        out.push(local.open());
    }
    if local.prescribed == Some(0.0) {
        return true;
    }
    out.extend(local.any_stick());
    if local.prescribed.is_none() && local.b_n == 0.0 {
        return true;
    }
    let Walk { table, direction } = local.law.walk();
    let slip = Slip::new(local, local.law.bounds().largest_radius);
    // What is not a number would be searched for in vain.
    if !(slip.norm_c + slip.norm_a).is_finite() {
        return false;
    }
    if moves_nothing(local, &slip) {
        return true;
    }
    let scan = Scan::new(&slip, table);
    let mut search = Search::new(&slip, direction, out);
    for i in scan.open() {
        for j in i * table.fine_per_coarse..(i + 1) * table.fine_per_coarse {
            let (first, last) = (&table.nodes[j], &table.nodes[j + 1]);
            if !slip.excluded_between(first, last, slip.stray(&table.fine[j])) {
                let ends = [first, last].map(|node| End::new(&slip, node.point));
                search.cell(&ends[0], &ends[1], slip.bounds(&table.fine[j]));
            }
        }
    }
    let complete = search.complete;
    // Neighbours that are one root need not be refined one by one.
    merge(local, out);
    refine(local, out);
    merge(local, out);
    if out.is_empty() {
        out.extend(local.stick_on_border());
    }
    complete
}

/// Whether nothing but rounding is left of the slip velocities of all friction: a foot whose rows see one direction of
/// motion that other contacts stop. Slip would be stick, and every piece of the boundary would be searched to the end.
fn moves_nothing(local: &Local<'_, 2>, slip: &Slip<'_, '_>) -> bool {
    let block = local.block;
    // One of the two terms that cancel.
    let (constant, linear) = (local.b_t.norm() * block.g_nn, local.b_n.abs() * block.g_tt.norm());
    !block.sound
        && local.prescribed.is_none()
        && slip.norm_c <= VANISHING * constant
        && slip.norm_a <= VANISHING * linear
}

/// Slip solutions to the last digits, without what only looked like one.
fn refine(local: &Local<'_, 2>, out: &mut Vec<LocalSolution<2>>) {
    let mut kept = 0;
    for i in 0..out.len() {
        let found = out[i];
        let refined = if found.phase == Phase::Slip { local.refined(&found) } else { Some(found) };
        if let Some(refined) = refined {
            out[kept] = refined;
            kept += 1;
        }
    }
    out.truncate(kept);
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
