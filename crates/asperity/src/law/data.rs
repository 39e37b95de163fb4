//! Laws as data that are written and read with serde, in the words of the Python constructors.
//!
//! A law is a table with its `reservoir` and its `direction`, each a set as in [`asperity_set::data`], and its `rate` if
//! the friction depends on the speed, with `speed`, `ratio`, `shape` (`"exponential"` or `"hyperbolic"`), `exponent` and
//! `viscous`; all but the speed may be left out. What is read goes through the checked constructors. A `report` on how
//! the sets were found, which laws of Python may have, is passed over.
//!
//! A file of a law, which Python's `FrictionLaw.save` and `asperity identify` write, is a [`LawFile`]: two lines on its
//! format, and the law in its table `law`. With the crate `toml`:
//!
//! ```
//! use asperity::law::data::LawFile;
//!
//! let text = r#"
//!     format = "asperity law"
//!     version = 1
//!     [law]
//!     reservoir = { type = "Ellipse", a = 0.6, b = 0.2 }
//!     direction = { type = "Disk", radius = 1.0 }
//! "#;
//! let file: LawFile = toml::from_str(text)?;
//! assert_eq!(file.law.dimension(), 2);
//! # Ok::<(), toml::de::Error>(())
//! ```

use asperity_set::SetError;
use asperity_set::data::SetData;
use serde::de::{Error as _, IgnoredAny};
use serde::ser::{Error as _, SerializeStruct as _};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Fall, FrictionLaw, Law, LawError, Stribeck};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct LawData {
    reservoir: SetData,
    direction: SetData,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rate: Option<Stribeck>,
    #[serde(default, skip_serializing)]
    #[expect(dead_code, reason = "is named so that it is no unknown field, and is passed over")]
    report: Option<IgnoredAny>,
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
        Ok(Self { reservoir, direction, rate: law.rate().copied(), report: None })
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
            Self::Zero(_) => {
                Err(S::Error::custom("contacts without friction have no law that could be written"))
            }
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

/// What a file of a law says of itself.
const FORMAT: &str = "asperity law";
/// The newest version of such files that this crate reads, and the one that it writes.
const VERSION: u32 = 1;

/// A file of a law, such as Python's `FrictionLaw.save` and `asperity identify` write.
///
/// What such a file says besides of the parameters of a fit and of its provenance is passed over.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct LawFile {
    /// The law.
    pub law: Law,
}

impl LawFile {
    /// The file of a law.
    pub fn new(law: Law) -> Self {
        Self { law }
    }
}

impl Serialize for LawFile {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut file = serializer.serialize_struct("LawFile", 3)?;
        file.serialize_field("format", FORMAT)?;
        file.serialize_field("version", &VERSION)?;
        file.serialize_field("law", &self.law)?;
        file.end()
    }
}

impl<'de> Deserialize<'de> for LawFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        struct Contents {
            format: String,
            version: u32,
            law: Law,
        }
        let Contents { format, version, law } = Contents::deserialize(deserializer)?;
        if format != FORMAT {
            return Err(D::Error::custom(format!("format: must be {FORMAT:?}, got {format:?}")));
        }
        if !(1..=VERSION).contains(&version) {
            let message =
                format!("version: must be 1 to {VERSION} for this asperity, got {version}");
            return Err(D::Error::custom(message));
        }
        Ok(Self { law })
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
