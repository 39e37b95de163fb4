//! Friction laws from bytes.

use asperity::law::{Fall, FrictionLaw, Law, Stribeck};
use asperity::set::{ConvexSet, StarSet, directions};

use crate::decode::{Range, Source};

/// A law of dimension `P`; `None` where its parameters are refused.
pub fn law<const P: usize>(source: &mut Source<'_>, range: Range) -> Option<FrictionLaw<P>> {
    let depth = usize::from(source.once_in(if P == 3 { 16 } else { 4 }));
    match source.below(5) {
        0 => FrictionLaw::isotropic(source.size(range)).ok(),
        1 => source.convex(range, depth).map(FrictionLaw::associated),
        2 => FrictionLaw::collinear(source.star(range, depth)?).ok(),
        _ => {
            let (reservoir, direction) = (source.star(range, depth)?, source.convex(range, depth)?);
            FrictionLaw::new(reservoir, direction).ok()
        }
    }
}

/// A law of any dimension, in the plane mostly.
pub fn any(source: &mut Source<'_>, range: Range) -> Option<Law> {
    Some(match source.below(6) {
        0 => law::<1>(source, range)?.into(),
        1 => law::<3>(source, range)?.into(),
        _ => law::<2>(source, range)?.into(),
    })
}

/// The same, whose friction now and then depends on the speed.
pub fn rated(source: &mut Source<'_>, range: Range) -> Option<Law> {
    if !source.once_in(6) {
        return any(source, range);
    }
    let fall = [Fall::Exponential, Fall::Hyperbolic][source.below(2)];
    let (speed, exponent) = (source.unit(), source.size(Range::Narrow));
    let (viscous, ratio) = (0.1 * source.unit(), source.unit());
    let rate = Stribeck::new(fall, speed, ratio, exponent, viscous).ok()?;
    Some(match source.below(2) {
        0 => law::<1>(source, range)?.with_rate(rate).into(),
        _ => law::<2>(source, range)?.with_rate(rate).into(),
    })
}

/// Length over width of direction sets that count as very slender: rounding of a slip turns the force by up to this ratio
/// times as much.
const SLENDER: f64 = 1e5;

/// Whether the sets are of ordinary size and not very slender: what is promised of solvers is promised for these.
pub fn is_ordinary(law: &Law) -> bool {
    match law {
        Law::Zero(_) => unreachable!(),
        Law::One(law) => ordinary(law),
        Law::Two(law) => ordinary(law),
        Law::Three(law) => ordinary(law),
    }
}

fn ordinary<const P: usize>(law: &FrictionLaw<P>) -> bool {
    // The length of a needle shows in its support function only.
    let direction = law.direction();
    let all = directions::<P>(64);
    let longest = all.iter().map(|d| direction.support(d)).fold(0.0, f64::max);
    all.iter().all(|d| {
        let (c, z) = (law.reservoir().radius(d), direction.radius(d));
        (1e-4..1e4).contains(&c)
            && (1e-4..1e4).contains(&z)
            && z > 1e-3 * c
            && SLENDER * z > longest
    })
}

/// The sets of a law, without the tables that solvers keep with it.
pub fn describe(law: &Law) -> String {
    match law {
        Law::Zero(_) => unreachable!(),
        Law::One(law) => {
            format!("C {:?} D {:?} {:?}", law.reservoir(), law.direction(), law.rate())
        }
        Law::Two(law) => {
            format!("C {:?} D {:?} {:?}", law.reservoir(), law.direction(), law.rate())
        }
        Law::Three(law) => {
            format!("C {:?} D {:?} {:?}", law.reservoir(), law.direction(), law.rate())
        }
    }
}

/// The least radius of the reservoir.
pub fn least_radius(law: &Law) -> f64 {
    fn of<const P: usize>(law: &FrictionLaw<P>) -> f64 {
        let radii = directions::<P>(64).into_iter().map(|d| law.reservoir().radius(&d));
        radii.fold(f64::INFINITY, f64::min)
    }
    match law {
        Law::Zero(_) => unreachable!(),
        Law::One(law) => of(law),
        Law::Two(law) => of(law),
        Law::Three(law) => of(law),
    }
}
