//! All solutions of one contact.

use super::super::local::Local;
use super::super::single::VANISHING;
use super::super::solution::LocalSolution;
use super::equation::Slip;
use super::scan::Scan;
use super::search::Search;
use crate::contact::Phase;
use crate::law::Walk;

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
    let slip = Slip::new(local);
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
            search.cell(&table.nodes[j], &table.nodes[j + 1], &table.fine[j]);
        }
    }
    let complete = search.complete;
    #[cfg(test)]
    super::tests::count(search.pieces);
    out.retain_mut(|found| {
        let refined = if found.phase == Phase::Slip { local.refined(found) } else { Some(*found) };
        refined.map(|refined| *found = refined).is_some()
    });
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

/// Removes slip solutions that are stick on the boundary of *C*, and neighbours that are one root.
fn merge(local: &Local<'_, 2>, out: &mut Vec<LocalSolution<2>>) {
    let scale = local.b_t.norm();
    let slips = |s: &LocalSolution<2>| s.phase == Phase::Slip;
    let sticks = out.iter().any(|s| s.phase == Phase::Stick);
    out.retain(|s| !slips(s) || !sticks || s.slip.norm() > 1e-12 * scale);
    // Double roots are located to the size of the last bisection.
    let same = |a: &LocalSolution<2>, b: &LocalSolution<2>| {
        let tolerance = if a.degenerate || b.degenerate { 1e-7 } else { 1e-12 };
        slips(a)
            && slips(b)
            && (a.tangent - b.tangent).norm() <= tolerance * a.tangent.norm()
            && (a.slip - b.slip).norm() <= tolerance * scale
    };
    // A root at the end of a cell is seen from the next cell as a double root.
    out.dedup_by(|next, kept| {
        let one = same(kept, next);
        if one && kept.degenerate {
            *kept = *next;
        }
        one
    });
    let first = out.iter().position(slips).unwrap_or(0);
    if let [.., last] = out[first..]
        && out.len() > first + 1
        && same(&out[first], &last)
    {
        if out[first].degenerate {
            out[first] = last;
        }
        out.pop();
    }
}
