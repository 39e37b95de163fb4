//! Laws as data that are written and read with serde, in the words of the Python constructors.
//!
//! A law is a table with its `reservoir` and its `direction`, each a set as in [`asperity_set::data`], and its `rate` if
//! the friction depends on the speed, with `speed`, `ratio`, `shape` (`"exponential"` or `"hyperbolic"`), `exponent` and
//! `viscous`; all but the speed may be left out. What is read goes through the checked constructors.

use asperity_set::SetError;
use asperity_set::data::SetData;
use serde::de::Error as _;
use serde::ser::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Fall, FrictionLaw, Law, LawError, Stribeck};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LawData {
    reservoir: SetData,
    direction: SetData,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rate: Option<Stribeck>,
}

impl LawData {
    fn law<const P: usize>(&self) -> Result<FrictionLaw<P>, LawError> {
        let law = FrictionLaw::new(self.reservoir.star()?, self.direction.convex()?)?;
        Ok(match self.rate {
            Some(rate) => law.with_rate(rate),
            None => law,
        })
    }
}

impl<const P: usize> TryFrom<&FrictionLaw<P>> for LawData {
    type Error = SetError;

    fn try_from(law: &FrictionLaw<P>) -> Result<Self, SetError> {
        let (reservoir, direction) = (law.reservoir().try_into()?, law.direction().try_into()?);
        Ok(Self { reservoir, direction, rate: law.rate().copied() })
    }
}

impl<const P: usize> Serialize for FrictionLaw<P> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        LawData::try_from(self).map_err(S::Error::custom)?.serialize(serializer)
    }
}

impl<'de, const P: usize> Deserialize<'de> for FrictionLaw<P> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        LawData::deserialize(deserializer)?.law().map_err(D::Error::custom)
    }
}

impl Serialize for Law {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::One(law) => law.as_ref().serialize(serializer),
            Self::Two(law) => law.as_ref().serialize(serializer),
            Self::Three(law) => law.as_ref().serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Law {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let data = LawData::deserialize(deserializer)?;
        match data.reservoir.dimension() {
            1 => data.law::<1>().map(Self::from),
            2 => data.law::<2>().map(Self::from),
            3 => data.law::<3>().map(Self::from),
            other => {
                let message = format!("must be a set of one, two or three dimensions, has {other}");
                Err(SetError::Shape { argument: "reservoir", message }.into())
            }
        }
        .map_err(D::Error::custom)
    }
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Shape {
    Exponential,
    Hyperbolic,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StribeckData {
    speed: f64,
    #[serde(default)]
    ratio: f64,
    #[serde(default = "exponential")]
    shape: Shape,
    #[serde(default = "one")]
    exponent: f64,
    #[serde(default)]
    viscous: f64,
}

fn exponential() -> Shape {
    Shape::Exponential
}

fn one() -> f64 {
    1.0
}

impl Serialize for Stribeck {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let shape = match self.fall() {
            Fall::Exponential => Shape::Exponential,
            Fall::Hyperbolic => Shape::Hyperbolic,
        };
        let (speed, ratio) = (self.speed(), self.ratio());
        let (exponent, viscous) = (self.exponent(), self.viscous());
        StribeckData { speed, ratio, shape, exponent, viscous }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Stribeck {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let StribeckData { speed, ratio, shape, exponent, viscous } =
            StribeckData::deserialize(deserializer)?;
        let fall = match shape {
            Shape::Exponential => Fall::Exponential,
            Shape::Hyperbolic => Fall::Hyperbolic,
        };
        Self::new(fall, speed, ratio, exponent, viscous).map_err(D::Error::custom)
    }
}
