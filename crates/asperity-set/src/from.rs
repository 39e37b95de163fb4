//! Every kind of set as a [`Star`] or [`Convex`].

use crate::{
    Ball, CappedRectangle, Convex, CoulombContensou, Cuboid, Ellipsoid, Embedded, Planar,
    PolarCurve, Polygon, SetError, Star, Superellipsoid, SupportCurve, WedgeAsperity,
};

impl<const P: usize> From<Ball> for Convex<P> {
    fn from(set: Ball) -> Self {
        Self::Ball(set)
    }
}

impl<const P: usize> From<Cuboid<P>> for Convex<P> {
    fn from(set: Cuboid<P>) -> Self {
        Self::Cuboid(set)
    }
}

impl<const P: usize> From<Ellipsoid<P>> for Convex<P> {
    fn from(set: Ellipsoid<P>) -> Self {
        Self::Ellipsoid(set)
    }
}

impl<const P: usize> TryFrom<Superellipsoid<P>> for Convex<P> {
    type Error = SetError;

    fn try_from(set: Superellipsoid<P>) -> Result<Self, SetError> {
        if set.is_convex() {
            return Ok(Self::Superellipsoid(set));
        }
        let reason = format!("but the exponent {} is below 1", set.exponent());
        Err(SetError::NotConvex { argument: "set", reason })
    }
}

/// Sets that are convex or not, depending on their parameters.
macro_rules! star_from {
    ($($set:ident),*) => {
        $(impl From<$set> for Star<2> {
            fn from(set: $set) -> Self {
                let set = Planar::from(set);
                let convex = set.is_convex();
                let set = Box::new(Embedded::new(set));
                if convex { Self::Convex(Convex::Planar(set)) } else { Self::Planar(set) }
            }
        })*
    };
}
star_from!(WedgeAsperity, Polygon, PolarCurve);

impl From<CappedRectangle> for Convex<2> {
    fn from(set: CappedRectangle) -> Self {
        Self::Planar(Box::new(Embedded::new(set.into())))
    }
}

impl From<SupportCurve> for Convex<2> {
    fn from(set: SupportCurve) -> Self {
        Self::Planar(Box::new(Embedded::new(set.into())))
    }
}

impl From<CoulombContensou> for Convex<3> {
    fn from(set: CoulombContensou) -> Self {
        Self::Contensou(Box::new(Embedded::new(set)))
    }
}

impl<const P: usize> From<Superellipsoid<P>> for Star<P> {
    fn from(set: Superellipsoid<P>) -> Self {
        if set.is_convex() {
            Self::Convex(Convex::Superellipsoid(set))
        } else {
            Self::Superellipsoid(set)
        }
    }
}

impl<const P: usize, T: Into<Convex<P>>> From<T> for Star<P> {
    fn from(set: T) -> Self {
        Self::Convex(set.into())
    }
}
