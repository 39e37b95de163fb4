//! Sets as data that are written and read with serde: names and arguments of the Python constructors.
//!
//! A set is a table with its `type` and the arguments of that type, in TOML
//! `{ type = "Superellipse", a = 0.54, b = 0.46, exponent = 2.9, angle = 0.1 }`. What is read goes through the checked
//! constructors, and what no type has as an argument is refused. Numbers come back to the bit from formats that keep
//! them.
//!
//! | `type` | arguments |
//! |---|---|
//! | `Ball` | `radius`, `dimension` (3) |
//! | `Disk` | `radius` |
//! | `Interval` | `lower`, `upper` |
//! | `Ellipse` | `a`, `b`, `angle` (0) |
//! | `Ellipsoid` | `semi_axes`, `axes`: unit vectors along them, as columns (those of the coordinates) |
//! | `Superellipse` | `a`, `b`, `exponent`, `angle` (0) |
//! | `Superellipsoid` | `semi_axes`, `exponent` |
//! | `Rectangle` | `a`, `b`, `angle` (0) |
//! | `Box` | `half_widths`, or `lower` and `upper` |
//! | `CappedRectangle` | `a`, `b`, `cap`, `angle` (0) |
//! | `WedgeAsperity` | `mu`, `beta`, `angle` (0) |
//! | `Polygon` | `vertices` |
//! | `PolarCurve` | `angle`, `radius` |
//! | `SupportCurve` | `angle`, `support` |
//! | `CoulombContensou` | `mu`, `pressure` (`"hertz"`, or `"uniform"`) |
//! | `Intersection`, `Union`, `MinkowskiSum` | `sets` |
//! | `Mapped` | `set`, `matrix`, row by row |
//!
//! Python reads and writes the same tables.
//!
//! Sets of users hold code: they are refused when they are to be written.

use std::any::Any;

use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{
    Ball, CappedRectangle, Convex, CoulombContensou, Cuboid, Ellipsoid, Embedded, Image, Interval,
    Matrix, Planar, PolarCurve, Polygon, Pressure, SetError, Star, Superellipsoid, SupportCurve,
    Vector, WedgeAsperity,
};

/// A set as data, see the page of the crate's feature `serde`; of any dimension, and not checked yet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", deny_unknown_fields)]
#[non_exhaustive]
#[allow(missing_docs)] // The arguments are those of the constructors.
pub enum SetData {
    Ball {
        radius: f64,
        #[serde(default = "three")]
        dimension: usize,
    },
    Disk {
        radius: f64,
    },
    Interval {
        lower: f64,
        upper: f64,
    },
    Ellipse {
        a: f64,
        b: f64,
        #[serde(default, skip_serializing_if = "is_zero")]
        angle: f64,
    },
    Ellipsoid {
        semi_axes: Vec<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        axes: Option<Vec<Vec<f64>>>,
    },
    Superellipse {
        a: f64,
        b: f64,
        exponent: f64,
        #[serde(default, skip_serializing_if = "is_zero")]
        angle: f64,
    },
    Superellipsoid {
        semi_axes: Vec<f64>,
        exponent: f64,
    },
    Rectangle {
        a: f64,
        b: f64,
        #[serde(default, skip_serializing_if = "is_zero")]
        angle: f64,
    },
    Box {
        #[serde(default, skip_serializing_if = "Option::is_none")]
        half_widths: Option<Vec<f64>>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        lower: Option<Vec<f64>>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        upper: Option<Vec<f64>>,
    },
    CappedRectangle {
        a: f64,
        b: f64,
        cap: f64,
        #[serde(default, skip_serializing_if = "is_zero")]
        angle: f64,
    },
    WedgeAsperity {
        mu: f64,
        beta: f64,
        #[serde(default, skip_serializing_if = "is_zero")]
        angle: f64,
    },
    Polygon {
        vertices: Vec<[f64; 2]>,
    },
    PolarCurve {
        angle: Vec<f64>,
        radius: Vec<f64>,
    },
    SupportCurve {
        angle: Vec<f64>,
        support: Vec<f64>,
    },
    CoulombContensou {
        mu: f64,
        #[serde(default)]
        pressure: PressureData,
    },
    Intersection {
        sets: Vec<SetData>,
    },
    Union {
        sets: Vec<SetData>,
    },
    MinkowskiSum {
        sets: Vec<SetData>,
    },
    Mapped {
        set: Box<SetData>,
        matrix: Vec<Vec<f64>>,
    },
}

/// The words for distributions of pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)]
pub enum PressureData {
    #[default]
    Hertz,
    Uniform,
}

fn three() -> usize {
    3
}

/// Whether an angle is left out.
fn is_zero(angle: &f64) -> bool {
    angle.to_bits() == 0
}

fn refuse<T>(argument: &'static str, message: impl Into<String>) -> Result<T, SetError> {
    Err(SetError::Shape { argument, message: message.into() })
}

impl SetData {
    /// Dimension of the space of the set.
    pub fn dimension(&self) -> usize {
        match self {
            Self::Ball { dimension, .. } => *dimension,
            Self::Interval { .. } => 1,
            Self::Ellipsoid { semi_axes, .. } | Self::Superellipsoid { semi_axes, .. } => {
                semi_axes.len()
            }
            Self::Box { half_widths, lower, .. } => {
                half_widths.as_ref().or(lower.as_ref()).map_or(0, Vec::len)
            }
            Self::CoulombContensou { .. } => 3,
            Self::Intersection { sets } | Self::Union { sets } | Self::MinkowskiSum { sets } => {
                sets.first().map_or(0, Self::dimension)
            }
            Self::Mapped { matrix, .. } => matrix.len(),
            _ => 2,
        }
    }

    /// The set.
    ///
    /// # Errors
    ///
    /// [`SetError`] if the set is not one of this dimension, and as the constructor of its type.
    pub fn star<const P: usize>(&self) -> Result<Star<P>, SetError> {
        match self {
            Self::Ball { radius, dimension } if *dimension == P => {
                Ok(Convex::from(Ball::new(*radius)?).into())
            }
            Self::Disk { radius } => {
                as_dimension(Star::<2>::from(Convex::from(Ball::new(*radius)?)))
            }
            Self::Interval { lower, upper } => {
                let [lower, upper] = [lower, upper].map(|x| Vector::<1>::new(*x));
                as_dimension(Star::<1>::from(Convex::from(Interval::new(lower, upper)?)))
            }
            Self::Ellipse { a, b, angle } => {
                let upright = Ellipsoid::new(Vector::<2>::new(*a, *b))?;
                turned(Convex::from(upright).into(), *angle)
            }
            Self::Ellipsoid { semi_axes, axes } => {
                let semi_axes = vector("semi_axes", semi_axes)?;
                let Some(axes) = axes else {
                    return Ok(Convex::from(Ellipsoid::new(semi_axes)?).into());
                };
                Ok(Convex::from(Ellipsoid::turned(semi_axes, matrix("axes", axes)?)?).into())
            }
            Self::Superellipse { a, b, exponent, angle } => {
                turned(Superellipsoid::new(Vector::<2>::new(*a, *b), *exponent)?.into(), *angle)
            }
            Self::Superellipsoid { semi_axes, exponent } => {
                Ok(Superellipsoid::new(vector::<P>("semi_axes", semi_axes)?, *exponent)?.into())
            }
            Self::Rectangle { a, b, angle } => {
                let upright = Cuboid::symmetric(Vector::<2>::new(*a, *b))?;
                turned(Convex::from(upright).into(), *angle)
            }
            Self::Box { half_widths: Some(widths), lower: None, upper: None } => {
                Ok(Convex::from(Cuboid::symmetric(vector::<P>("half_widths", widths)?)?).into())
            }
            Self::Box { half_widths: None, lower: Some(lower), upper: Some(upper) } => {
                let [lower, upper] = [vector::<P>("lower", lower)?, vector("upper", upper)?];
                Ok(Convex::from(Cuboid::new(lower, upper)?).into())
            }
            Self::Box { .. } => {
                refuse("half_widths", "must be given, or else both lower and upper")
            }
            Self::CappedRectangle { a, b, cap, angle } => {
                turned(Convex::from(CappedRectangle::new(*a, *b, *cap)?).into(), *angle)
            }
            Self::WedgeAsperity { mu, beta, angle } => {
                turned(WedgeAsperity::new(*mu, *beta)?.into(), *angle)
            }
            Self::Polygon { vertices } => {
                let vertices: Vec<_> = vertices.iter().map(|v| Vector::<2>::from(*v)).collect();
                as_dimension(Star::<2>::from(Polygon::new(&vertices)?))
            }
            Self::PolarCurve { angle, radius } => {
                as_dimension(Star::<2>::from(PolarCurve::new(angle, radius)?))
            }
            Self::SupportCurve { angle, support } => {
                as_dimension(Star::<2>::from(Convex::from(SupportCurve::new(angle, support)?)))
            }
            Self::CoulombContensou { mu, pressure } => {
                let pressure = match pressure {
                    PressureData::Hertz => Pressure::Hertz,
                    PressureData::Uniform => Pressure::Uniform,
                };
                as_dimension(Star::<3>::from(Convex::from(CoulombContensou::new(*mu, pressure)?)))
            }
            Self::Intersection { sets } => Star::intersection(&stars(sets)?),
            Self::Union { sets } => Star::union(&stars(sets)?),
            Self::MinkowskiSum { sets } => Star::minkowski_sum(&stars(sets)?),
            Self::Mapped { set, matrix: map } => set.star::<P>()?.mapped(&matrix("matrix", map)?),
            Self::Ball { .. } => wrong_dimension(P),
        }
    }

    /// The set, which must be convex.
    ///
    /// # Errors
    ///
    /// As [`star`](Self::star), and if the set is star-shaped only.
    pub fn convex<const P: usize>(&self) -> Result<Convex<P>, SetError> {
        let star = self.star::<P>()?;
        let reason = String::from("is star-shaped only");
        star.as_convex().cloned().ok_or(SetError::NotConvex { argument: "set", reason })
    }
}

fn stars<const P: usize>(sets: &[SetData]) -> Result<Vec<Star<P>>, SetError> {
    sets.iter().map(SetData::star).collect()
}

fn wrong_dimension<T>(dimension: usize) -> Result<T, SetError> {
    refuse("set", format!("must be one of R^{dimension}, as the others are"))
}

/// A set of known dimension as one of `P` dimensions, if that is the same.
fn as_dimension<const P: usize, const Q: usize>(set: Star<Q>) -> Result<Star<P>, SetError> {
    let set: Box<dyn Any> = Box::new(set);
    set.downcast().map_or_else(|_| wrong_dimension(P), |set| Ok(*set))
}

fn turned<const P: usize>(upright: Star<2>, angle: f64) -> Result<Star<P>, SetError> {
    as_dimension(upright.rotated(angle)?)
}

fn vector<const P: usize>(argument: &'static str, values: &[f64]) -> Result<Vector<P>, SetError> {
    if values.len() != P {
        return refuse(argument, format!("must have {P} entries, has {}", values.len()));
    }
    Ok(Vector::from_column_slice(values))
}

fn matrix<const P: usize>(
    argument: &'static str,
    rows: &[Vec<f64>],
) -> Result<Matrix<P>, SetError> {
    if rows.len() != P || rows.iter().any(|row| row.len() != P) {
        return refuse(argument, format!("must have {P} rows of {P} entries"));
    }
    Ok(Matrix::from_fn(|i, j| rows[i][j]))
}

fn rows<const P: usize>(matrix: &Matrix<P>) -> Vec<Vec<f64>> {
    (0..P).map(|i| (0..P).map(|j| matrix[(i, j)]).collect()).collect()
}

/// A set of a user.
fn custom<T>() -> Result<T, SetError> {
    refuse("set", "of a user holds code and cannot be written")
}

impl<const P: usize> TryFrom<&Star<P>> for SetData {
    type Error = SetError;

    fn try_from(set: &Star<P>) -> Result<Self, SetError> {
        match set {
            Star::Convex(set) => Self::try_from(set),
            Star::Superellipsoid(set) => Ok(superellipsoid(set)),
            Star::Planar(set) => Ok(planar(set)),
            Star::Intersection(set) => Ok(Self::Intersection { sets: data(set.sets())? }),
            Star::Union(set) => Ok(Self::Union { sets: data(set.sets())? }),
            Star::Image(image) => mapped(Self::try_from(image.preimage())?, image),
            Star::Custom(_) => custom(),
        }
    }
}

impl<const P: usize> TryFrom<&Convex<P>> for SetData {
    type Error = SetError;

    fn try_from(set: &Convex<P>) -> Result<Self, SetError> {
        Ok(match set {
            Convex::Ball(ball) if P == 2 => Self::Disk { radius: ball.size() },
            Convex::Ball(ball) => Self::Ball { radius: ball.size(), dimension: P },
            Convex::Cuboid(cuboid) => {
                let (lower, upper) = (cuboid.lower().as_slice(), cuboid.upper().as_slice());
                if let ([lower], [upper]) = (lower, upper) {
                    Self::Interval { lower: *lower, upper: *upper }
                } else if lower.iter().zip(upper).all(|(a, b)| -a == *b) {
                    let half_widths = Some(upper.to_vec());
                    Self::Box { half_widths, lower: None, upper: None }
                } else {
                    let (lower, upper) = (Some(lower.to_vec()), Some(upper.to_vec()));
                    Self::Box { half_widths: None, lower, upper }
                }
            }
            Convex::Ellipsoid(set) => ellipsoid(set),
            Convex::Superellipsoid(set) => superellipsoid(set),
            Convex::Planar(set) => planar(set),
            Convex::Contensou(set) => {
                let (mu, pressure) = set.set().parameters();
                let pressure = match pressure {
                    Pressure::Hertz => PressureData::Hertz,
                    Pressure::Uniform => PressureData::Uniform,
                };
                Self::CoulombContensou { mu, pressure }
            }
            Convex::Intersection(set) => Self::Intersection { sets: data(set.sets())? },
            Convex::Sum(set) => Self::MinkowskiSum { sets: data(set.sets())? },
            Convex::Image(image) => mapped(Self::try_from(image.preimage())?, image)?,
            Convex::Custom(_) => return custom(),
        })
    }
}

fn data<'a, S: 'a>(sets: &'a [S]) -> Result<Vec<SetData>, SetError>
where
    SetData: TryFrom<&'a S, Error = SetError>,
{
    sets.iter().map(SetData::try_from).collect()
}

/// The image of a set; what the constructor of images would have joined into one set comes back as that.
fn mapped<S, const P: usize>(set: SetData, image: &Image<S, P>) -> Result<SetData, SetError> {
    Ok(SetData::Mapped { set: Box::new(set), matrix: rows(image.map()) })
}

/// With its angle where that says the same to the bit, else with its axes.
fn ellipsoid<const P: usize>(set: &Ellipsoid<P>) -> SetData {
    let (semi_axes, axes) = (set.semi_axes().as_slice(), set.axes());
    if let &[a, b] = semi_axes {
        let angle = axes[(1, 0)].atan2(axes[(0, 0)]);
        let simple = SetData::Ellipse { a, b, angle };
        if simple.convex() == Ok(Convex::Ellipsoid(*set)) {
            return simple;
        }
    }
    let axes = (*axes != Matrix::<P>::identity()).then(|| rows(axes));
    SetData::Ellipsoid { semi_axes: semi_axes.to_vec(), axes }
}

fn superellipsoid<const P: usize>(set: &Superellipsoid<P>) -> SetData {
    let (semi_axes, exponent) = (set.semi_axes().as_slice(), set.exponent());
    match semi_axes {
        &[a, b] => SetData::Superellipse { a, b, exponent, angle: 0.0 },
        _ => SetData::Superellipsoid { semi_axes: semi_axes.to_vec(), exponent },
    }
}

fn planar(set: &Embedded<Planar, 2>) -> SetData {
    let angle = 0.0;
    match set.set() {
        Planar::CappedRectangle(set) => {
            let [a, b, cap] = set.parameters();
            SetData::CappedRectangle { a, b, cap, angle }
        }
        Planar::WedgeAsperity(set) => {
            SetData::WedgeAsperity { mu: set.mu(), beta: set.beta(), angle }
        }
        Planar::Polygon(set) => {
            SetData::Polygon { vertices: set.vertices().iter().map(|v| [v.x, v.y]).collect() }
        }
        Planar::PolarCurve(set) => {
            let (angle, radius) = set.samples();
            SetData::PolarCurve { angle: angle.to_vec(), radius: radius.to_vec() }
        }
        Planar::SupportCurve(set) => {
            let (angle, support) = set.samples();
            SetData::SupportCurve { angle: angle.to_vec(), support: support.to_vec() }
        }
    }
}

impl<const P: usize> Serialize for Star<P> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        SetData::try_from(self).map_err(S::Error::custom)?.serialize(serializer)
    }
}

impl<const P: usize> Serialize for Convex<P> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        SetData::try_from(self).map_err(S::Error::custom)?.serialize(serializer)
    }
}

impl<'de, const P: usize> Deserialize<'de> for Star<P> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        SetData::deserialize(deserializer)?.star().map_err(D::Error::custom)
    }
}

impl<'de, const P: usize> Deserialize<'de> for Convex<P> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        SetData::deserialize(deserializer)?.convex().map_err(D::Error::custom)
    }
}
