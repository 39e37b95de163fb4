//! Every set as one value: [`Star`] and [`Convex`].
//!
//! Closed enums keep laws comparable, printable and fast; the `Custom` arms take any set of a user.

use std::sync::Arc;

use crate::error::positive;
use crate::{
    Ball, Cone, ConvexSet, CoulombContensou, Cuboid, Ellipsoid, Embedded, Form, Image,
    Intersection, Matrix, MinkowskiSum, Planar, SetError, StarSet, Superellipsoid, Union, Vector,
};

/// A convex set of a crate user; two are equal if they are the same object.
#[derive(Debug, Clone)]
pub struct CustomConvex<const P: usize>(pub Arc<dyn ConvexSet<P>>);

/// A star-shaped set of a crate user; two are equal if they are the same object.
#[derive(Debug, Clone)]
pub struct CustomStar<const P: usize>(pub Arc<dyn StarSet<P>>);

impl<const P: usize> PartialEq for CustomConvex<P> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl<const P: usize> PartialEq for CustomStar<P> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Any convex set. It is closed, as [`Star`] is: whoever matches it is told of a kind that is new, and the `Custom` arm
/// takes the sets of users.
///
/// ```
/// use asperity_set::{Convex, ConvexSet, Ellipse, StarSet, Vector};
///
/// let ellipse: Convex<2> = Ellipse::new(Vector::<2>::new(3.0, 1.0))?.into();
/// let turned = ellipse.rotated(0.5)?.scaled(2.0)?;
/// let far = Vector::<2>::new(9.0, 1.0);
/// assert!((turned.gauge(&turned.project(&far)) - 1.0).abs() < 1e-12);
/// # Ok::<(), asperity_set::SetError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Convex<const P: usize> {
    /// Ball, disk.
    Ball(Ball),
    /// Axis-parallel box, interval.
    Cuboid(Cuboid<P>),
    /// Ellipsoid, ellipse.
    Ellipsoid(Ellipsoid<P>),
    /// Superellipsoid with exponent ≥ 1.
    Superellipsoid(Superellipsoid<P>),
    /// A set of the plane.
    Planar(Box<Embedded<Planar, 2>>),
    /// Coulomb–Contensou friction in R³.
    Contensou(Box<Embedded<CoulombContensou, 3>>),
    /// Intersection of convex sets.
    Intersection(Box<Intersection<Convex<P>, P>>),
    /// Minkowski sum of convex sets.
    Sum(Box<MinkowskiSum<P>>),
    /// Linear image of a convex set.
    Image(Box<Image<Convex<P>, P>>),
    /// A set of the user.
    Custom(CustomConvex<P>),
}

/// Any star-shaped set.
///
/// ```
/// use asperity_set::{Convex, Cuboid, Disk, Star, StarSet, Vector};
///
/// let bar: Star<2> = Convex::from(Cuboid::symmetric(Vector::<2>::new(2.0, 0.5))?).into();
/// let disk: Star<2> = Convex::from(Disk::new(1.0)?).into();
/// let union = Star::union(&[bar, disk])?;
/// assert!(union.as_convex().is_none());
/// assert_eq!(union.gauge(&Vector::<2>::new(4.0, 0.0)), 2.0);
/// # Ok::<(), asperity_set::SetError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub enum Star<const P: usize> {
    /// A convex set.
    Convex(Convex<P>),
    /// Superellipsoid with exponent < 1.
    Superellipsoid(Superellipsoid<P>),
    /// A set of the plane that is not convex.
    Planar(Box<Embedded<Planar, 2>>),
    /// Intersection of sets that are not all convex.
    Intersection(Box<Intersection<Star<P>, P>>),
    /// Union of sets.
    Union(Box<Union<P>>),
    /// Linear image of a star-shaped set.
    Image(Box<Image<Star<P>, P>>),
    /// A set of the user.
    Custom(CustomStar<P>),
}

/// Keeps the code of the larger sets out of the loops of solvers, where the smaller ones are inlined.
#[inline(never)]
fn apart<T>(call: impl FnOnce() -> T) -> T {
    call()
}

/// Calls the same method on whatever set is inside.
macro_rules! each_convex {
    ($self:ident, $set:ident => $call:expr) => {
        match $self {
            Convex::Ball($set) => $call,
            Convex::Cuboid($set) => $call,
            Convex::Ellipsoid($set) => $call,
            Convex::Superellipsoid($set) => $call,
            Convex::Planar($set) => apart(|| $call),
            Convex::Contensou($set) => apart(|| $call),
            Convex::Intersection($set) => apart(|| $call),
            Convex::Sum($set) => apart(|| $call),
            Convex::Image($set) => $call,
            Convex::Custom(CustomConvex($set)) => $call,
        }
    };
}

macro_rules! each_star {
    ($self:ident, $set:ident => $call:expr) => {
        match $self {
            Star::Convex($set) => $call,
            Star::Superellipsoid($set) => $call,
            Star::Planar($set) => apart(|| $call),
            Star::Intersection($set) => apart(|| $call),
            Star::Union($set) => apart(|| $call),
            Star::Image($set) => $call,
            Star::Custom(CustomStar($set)) => $call,
        }
    };
}

impl<const P: usize> Convex<P> {
    /// The set scaled by `factor > 0`.
    ///
    /// # Errors
    ///
    /// [`SetError`] if the factor is not finite and positive, or if the set gets a size that none may have.
    pub fn scaled(&self, factor: f64) -> Result<Self, SetError> {
        let factor = positive("factor", factor)?;
        Ok(match self {
            Self::Ball(ball) => ball.scaled(factor)?.into(),
            Self::Cuboid(cuboid) => cuboid.scaled(factor)?.into(),
            Self::Ellipsoid(ellipsoid) => ellipsoid.scaled(factor)?.into(),
            Self::Superellipsoid(set) => Self::Superellipsoid(set.scaled(factor)?),
            Self::Contensou(set) => {
                Self::Contensou(Box::new(Embedded::new(set.set().scaled(factor)?)))
            }
            other => other.mapped(&(Matrix::identity() * factor))?,
        })
    }

    /// The image under a regular linear map; images of balls and ellipsoids are ellipsoids.
    ///
    /// # Errors
    ///
    /// [`SetError::SingularMap`] if the map is not finite and regular, [`SetError::Parameter`] if the image has a size that
    /// none may have.
    pub fn mapped(&self, map: &Matrix<P>) -> Result<Self, SetError> {
        let image = Image::new(self.clone(), *map)?;
        Ok(match self {
            Self::Ball(ball) => Ellipsoid::from_map(&(map * ball.size()))?.into(),
            Self::Ellipsoid(ellipsoid) => ellipsoid.mapped(map)?.into(),
            Self::Image(inner) => {
                Self::Image(Box::new(Image::new(inner.preimage().clone(), map * inner.map())?))
            }
            _ => Self::Image(Box::new(image)),
        })
    }
}

impl<const P: usize> Star<P> {
    /// The set scaled by `factor > 0`.
    ///
    /// # Errors
    ///
    /// [`SetError`] if the factor is not finite and positive, or if the set gets a size that none may have.
    pub fn scaled(&self, factor: f64) -> Result<Self, SetError> {
        let factor = positive("factor", factor)?;
        match self {
            Self::Convex(set) => Ok(Self::Convex(set.scaled(factor)?)),
            Self::Superellipsoid(set) => Ok(Self::Superellipsoid(set.scaled(factor)?)),
            other => other.mapped(&(Matrix::identity() * factor)),
        }
    }

    /// The image under a regular linear map.
    ///
    /// # Errors
    ///
    /// [`SetError::SingularMap`] if the map is not finite and regular, [`SetError::Parameter`] if the image has a size that
    /// none may have.
    pub fn mapped(&self, map: &Matrix<P>) -> Result<Self, SetError> {
        match self {
            Self::Convex(set) => Ok(Self::Convex(set.mapped(map)?)),
            Self::Image(inner) => {
                Ok(Self::Image(Box::new(Image::new(inner.preimage().clone(), map * inner.map())?)))
            }
            other => Ok(Self::Image(Box::new(Image::new(other.clone(), *map)?))),
        }
    }

    /// The set as a convex one, if it is.
    pub fn as_convex(&self) -> Option<&Convex<P>> {
        match self {
            Self::Convex(set) => Some(set),
            _ => None,
        }
    }

    /// The intersection of some sets; convex if all are.
    ///
    /// # Errors
    ///
    /// [`SetError`] if there are no sets.
    pub fn intersection(sets: &[Self]) -> Result<Self, SetError> {
        let convex: Option<Vec<Convex<P>>> = sets.iter().map(|s| s.as_convex().cloned()).collect();
        Ok(match convex {
            Some(sets) => Self::Convex(Convex::Intersection(Box::new(Intersection::new(sets)?))),
            None => Self::Intersection(Box::new(Intersection::new(sets.to_vec())?)),
        })
    }

    /// The union of some sets.
    ///
    /// # Errors
    ///
    /// [`SetError`] if there are no sets.
    pub fn union(sets: &[Self]) -> Result<Self, SetError> {
        Ok(Self::Union(Box::new(Union::new(sets.to_vec())?)))
    }

    /// The Minkowski sum of some convex sets.
    ///
    /// # Errors
    ///
    /// [`SetError::NotConvex`] if a set is star-shaped only, another [`SetError`] if there are none.
    pub fn minkowski_sum(sets: &[Self]) -> Result<Self, SetError> {
        let convex: Option<Vec<Convex<P>>> = sets.iter().map(|s| s.as_convex().cloned()).collect();
        let reason = String::from("the sum of star-shaped sets is not star-shaped in general");
        let sets = convex.ok_or(SetError::NotConvex { argument: "sets", reason })?;
        Ok(Self::Convex(Convex::Sum(Box::new(MinkowskiSum::new(sets)?))))
    }
}

/// Counter-clockwise rotation by `angle` in rad.
fn rotation(angle: f64) -> Result<Matrix<2>, SetError> {
    if !angle.is_finite() {
        return Err(SetError::Parameter { argument: "angle", allowed: "finite", value: angle });
    }
    let (sine, cosine) = angle.sin_cos();
    Ok(Matrix::<2>::new(cosine, -sine, sine, cosine))
}

impl Convex<2> {
    /// The set turned counter-clockwise by `angle` in rad.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if the angle is not finite.
    pub fn rotated(&self, angle: f64) -> Result<Self, SetError> {
        let rotation = rotation(angle)?;
        match self {
            Self::Ball(_) => Ok(self.clone()),
            // Without the detour through the factorisation of a general map.
            Self::Ellipsoid(ellipsoid) => Ok(ellipsoid.rotated(&rotation)?.into()),
            _ if angle == 0.0 => Ok(self.clone()),
            _ => self.mapped(&rotation),
        }
    }
}

impl Star<2> {
    /// The set turned counter-clockwise by `angle` in rad.
    ///
    /// # Errors
    ///
    /// [`SetError::Parameter`] if the angle is not finite.
    pub fn rotated(&self, angle: f64) -> Result<Self, SetError> {
        match self {
            Self::Convex(set) => Ok(Self::Convex(set.rotated(angle)?)),
            _ if angle == 0.0 => Ok(self.clone()),
            other => other.mapped(&rotation(angle)?),
        }
    }
}

impl<const P: usize> StarSet<P> for Convex<P> {
    #[inline(always)]
    fn gauge(&self, x: &Vector<P>) -> f64 {
        each_convex!(self, set => set.gauge(x))
    }

    #[inline(always)]
    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        each_convex!(self, set => set.gauge_jet(x))
    }

    #[inline(always)]
    fn normal(&self, x: &Vector<P>) -> Vector<P> {
        each_convex!(self, set => set.normal(x))
    }

    fn form(&self) -> Form<'_, P> {
        each_convex!(self, set => set.form())
    }

    fn corners(&self) -> Vec<Vector<P>> {
        each_convex!(self, set => set.corners())
    }
}

impl<const P: usize> ConvexSet<P> for Convex<P> {
    #[inline(always)]
    fn support_point(&self, y: &Vector<P>) -> Vector<P> {
        each_convex!(self, set => set.support_point(y))
    }

    #[inline(always)]
    fn support(&self, y: &Vector<P>) -> f64 {
        each_convex!(self, set => set.support(y))
    }

    #[inline(always)]
    fn support_jet(&self, y: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        each_convex!(self, set => set.support_jet(y))
    }

    #[inline(always)]
    fn support_derivative(&self, y: &Vector<P>, dy: &Vector<P>) -> (Vector<P>, Vector<P>) {
        each_convex!(self, set => set.support_derivative(y, dy))
    }

    fn project(&self, z: &Vector<P>) -> Vector<P> {
        each_convex!(self, set => set.project(z))
    }

    #[inline(always)]
    fn project_from(&self, z: &Vector<P>, start: &Vector<P>) -> Vector<P> {
        each_convex!(self, set => set.project_from(z, start))
    }

    #[inline(always)]
    fn project_jet(&self, z: &Vector<P>, start: &Vector<P>) -> (Vector<P>, Matrix<P>) {
        each_convex!(self, set => set.project_jet(z, start))
    }

    fn normal_cone(&self, x: &Vector<P>, tolerance: f64) -> Option<Cone<P>> {
        each_convex!(self, set => set.normal_cone(x, tolerance))
    }

    fn flat_normals(&self) -> Vec<Vector<P>> {
        each_convex!(self, set => set.flat_normals())
    }
}

impl<const P: usize> StarSet<P> for Star<P> {
    #[inline(always)]
    fn gauge(&self, x: &Vector<P>) -> f64 {
        each_star!(self, set => set.gauge(x))
    }

    #[inline(always)]
    fn gauge_jet(&self, x: &Vector<P>) -> (f64, Vector<P>) {
        each_star!(self, set => set.gauge_jet(x))
    }

    fn form(&self) -> Form<'_, P> {
        each_star!(self, set => set.form())
    }

    fn corners(&self) -> Vec<Vector<P>> {
        each_star!(self, set => set.corners())
    }
}
