//! Questions to sets with arguments of any size, answered or refused by name.
//!
//! The methods of [`StarSet`] and [`ConvexSet`] are made for solvers: they square what they are given and do not
//! look whether that is a number still. [`Checked`] is the door for arguments that nobody has looked at. Gauge and
//! support function have degree one, their gradients degree zero: arguments of an unusual size are divided by a
//! power of two, the answer is multiplied by it, and no digit is lost.

use crate::numeric::scaling::{Part, homogeneous, is_usual, shifted};
use crate::{Cone, ConvexSet, Matrix, SetError, Star, StarSet, Vector, tangent_cone};

/// A set whose methods take finite arguments of any size.
///
/// ```
/// use asperity_set::{Checked, Disk, Vector};
///
/// let disk = Disk::new(2.0)?;
/// let gauge = Checked(&disk).gauge(&Vector::<2>::new(3e200, 4e200))?;
/// assert!((gauge / 2.5e200 - 1.0).abs() < 1e-15);
/// assert!(Checked(&disk).gauge_gradient(&Vector::<2>::zeros()).is_err());
/// # Ok::<(), asperity_set::SetError>(())
/// ```
#[derive(Debug)]
pub struct Checked<'a, S: ?Sized>(pub &'a S);

impl<S: ?Sized> Checked<'_, S> {
    /// The gauge, see [`StarSet::gauge`].
    ///
    /// # Errors
    ///
    /// [`SetError`] if the argument is not finite, or the answer beyond the range of numbers.
    #[inline]
    pub fn gauge<const P: usize>(&self, x: &Vector<P>) -> Result<f64, SetError>
    where
        S: StarSet<P>,
    {
        if is_usual(x) {
            return Ok(self.0.gauge(x));
        }
        homogeneous("x", x, |x| self.0.gauge(x))
    }

    /// The gradient of the gauge, see [`StarSet::gauge_gradient`]; refused at the origin.
    ///
    /// # Errors
    ///
    /// [`SetError`] if the argument is not finite; [`SetError::Origin`] at the origin.
    #[inline]
    pub fn gauge_gradient<const P: usize>(&self, x: &Vector<P>) -> Result<Vector<P>, SetError>
    where
        S: StarSet<P>,
    {
        if is_usual(x) {
            return Ok(self.0.gauge_jet(x).1);
        }
        Ok(self.0.gauge_jet(&Part::of("x", x)?.ok_or(SetError::Origin)?.unit).1)
    }

    /// The support function, see [`ConvexSet::support`].
    ///
    /// # Errors
    ///
    /// [`SetError`] if the argument is not finite, or the answer beyond the range of numbers.
    #[inline]
    pub fn support<const P: usize>(&self, y: &Vector<P>) -> Result<f64, SetError>
    where
        S: ConvexSet<P>,
    {
        if is_usual(y) {
            return Ok(self.0.support(y));
        }
        homogeneous("y", y, |y| self.0.support(y))
    }

    /// The support point, see [`ConvexSet::support_point`]; the origin for `y = 0`, where every point is farthest.
    ///
    /// # Errors
    ///
    /// [`SetError`] if the argument is not finite.
    #[inline]
    pub fn support_point<const P: usize>(&self, y: &Vector<P>) -> Result<Vector<P>, SetError>
    where
        S: ConvexSet<P>,
    {
        if is_usual(y) {
            return Ok(self.0.support_point(y));
        }
        let part = Part::of("y", y)?;
        Ok(part.map_or(Vector::zeros(), |part| self.0.support_point(&part.unit)))
    }

    /// The Hessian of the support function, see [`ConvexSet::support_hessian`]; refused for `y = 0`.
    ///
    /// # Errors
    ///
    /// [`SetError`] if the argument is not finite, or the answer beyond the range of numbers;
    /// [`SetError::NoDirection`] for `y = 0`.
    pub fn support_hessian<const P: usize>(&self, y: &Vector<P>) -> Result<Matrix<P>, SetError>
    where
        S: ConvexSet<P>,
    {
        if is_usual(y) {
            return Ok(self.0.support_hessian(y));
        }
        let part = Part::of("y", y)?.ok_or(SetError::NoDirection)?;
        let hessian = self.0.support_hessian(&part.unit);
        let back = hessian.map(|entry| shifted(entry, -part.exponent));
        let lost = |(a, b): (&f64, &f64)| a.is_finite() && !b.is_finite();
        if hessian.iter().zip(back.iter()).any(lost) {
            return Err(SetError::Range { argument: "y", excess: "small" });
        }
        Ok(back)
    }

    /// The proximal point, see [`ConvexSet::project`]; refused beyond 1e80.
    ///
    /// # Errors
    ///
    /// [`SetError`] if the argument is not finite, or larger than 1e80.
    #[inline]
    pub fn project<const P: usize>(&self, z: &Vector<P>) -> Result<Vector<P>, SetError>
    where
        S: ConvexSet<P>,
    {
        if is_usual(z) {
            return Ok(self.0.project(z));
        }
        match Part::of("z", z)? {
            // Not homogeneous: beside a flat face small components count however large the others are.
            Some(part) if part.exponent > 0 => {
                Err(SetError::Parameter { argument: "z", allowed: "at most 1e80", value: z.amax() })
            }
            // Points as near as that to the origin lie in every set.
            _ => Ok(*z),
        }
    }

    /// The normal cone, see [`ConvexSet::normal_cone`].
    ///
    /// # Errors
    ///
    /// [`SetError`] if the argument is not finite.
    pub fn normal_cone<const P: usize>(
        &self,
        x: &Vector<P>,
        tolerance: f64,
    ) -> Result<Option<Cone<P>>, SetError>
    where
        S: ConvexSet<P>,
    {
        match self.place(x, tolerance)? {
            Place::Boundary(x) => Ok(self.0.normal_cone(&x, tolerance)),
            Place::Inside => Ok(Some(Cone::new([]))),
            Place::Outside => Ok(None),
        }
    }

    /// Where a point lies; an argument of usual size is left to the set itself.
    fn place<const P: usize>(&self, x: &Vector<P>, tolerance: f64) -> Result<Place<P>, SetError>
    where
        S: StarSet<P>,
    {
        if is_usual(x) {
            return Ok(Place::Boundary(*x));
        }
        let Some(part) = Part::of("x", x)? else { return Ok(Place::Boundary(*x)) };
        let gauge = self.0.gauge(&part.unit);
        Ok(match shifted(gauge, part.exponent) {
            k if k > 1.0 + tolerance => Place::Outside,
            k if k < 1.0 - tolerance => Place::Inside,
            _ => Place::Boundary(part.unit / gauge),
        })
    }
}

impl<const P: usize> Checked<'_, Star<P>> {
    /// The tangent cone, see [`tangent_cone`].
    ///
    /// # Errors
    ///
    /// [`SetError`] if the argument is not finite.
    pub fn tangent_cone(
        &self,
        x: &Vector<P>,
        tolerance: f64,
    ) -> Result<Option<Vec<Cone<P>>>, SetError> {
        match self.place(x, tolerance)? {
            Place::Boundary(x) => Ok(tangent_cone(self.0, &x, tolerance)),
            Place::Inside => Ok(Some(vec![Cone::whole()])),
            Place::Outside => Ok(None),
        }
    }
}

/// A point as one asks for cones there.
enum Place<const P: usize> {
    Inside,
    Outside,
    Boundary(Vector<P>),
}
