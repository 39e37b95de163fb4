//! What counts as zero in a motion: all limits of rounding, each a share of a size that the problem itself has, so that
//! units do not matter.
//!
//! One operation leaves ε = 2.2e-16 of its largest term. Sums over rows of a system leave some ten of them
//! ([`ROUNDING`]), the location of an event a hundred ([`UNRESOLVED_TIME`]), what is integrated to a tolerance a thousand
//! and more ([`NOTHING`]), and contact problems what their solvers leave ([`SOLVED`]).

/// Errors of accelerations over the accelerations that balance in them.
pub(crate) const ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Slip over the speed of a contact, approach over the largest velocity, gap over the reach of a contact, and mobility of a
/// row beside others over its own. Larger values take motions for rest, smaller ones let rounding decide on directions.
pub(crate) const NOTHING: f64 = 1e-12;
/// Overlap over the reach of a contact that rounding explains.
pub(crate) const ROUNDED_OVERLAP: f64 = 1e-14;
/// Height of a bounce over the reach of a contact, and mobility of a contact over its largest.
pub(crate) const ROUNDED: f64 = 1e-13;
/// Share of the whole time within which events count as one: none is located better.
pub(crate) const UNRESOLVED_TIME: f64 = 2e-14;
/// Accelerations of contacts over the load, residuals, and forces beyond a reservoir over the largest normal force: solvers
/// of several contacts leave as much.
pub(crate) const SOLVED: f64 = 1e-9;
/// Slip acceleration over the load of a contact whose problem is solved exactly.
pub(crate) const SOLVED_EXACTLY: f64 = 1e-11;
/// Part of the normal accelerations that dependent rows exclude, over the sizes of their terms, above which surfaces part:
/// far above rounding and differences along the motion.
pub(crate) const PARTS: f64 = 1e-10;
/// Overlap in the unit of coordinates that input may have, in a state of rest at the origin for example, of which no length
/// is known. It decides on nothing else.
pub(crate) const ROUNDED_INPUT: f64 = f64::EPSILON;
/// Number of spacings between floating-point times below which a step is too short.
const SPACINGS: f64 = 4.0;

/// A time too short for a step at `t`.
pub(crate) fn shortest_step(t: f64) -> f64 {
    SPACINGS * f64::EPSILON * t
}
