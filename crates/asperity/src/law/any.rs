//! The one place where the dimension of a law is erased.

use std::sync::Arc;

use super::{FrictionLaw, Stribeck};

/// A shared friction law of any dimension.
#[derive(Debug, Clone)]
pub enum Law {
    /// On a line.
    One(Arc<FrictionLaw<1>>),
    /// In the contact plane.
    Two(Arc<FrictionLaw<2>>),
    /// In the contact plane with drilling.
    Three(Arc<FrictionLaw<3>>),
}

impl Law {
    /// Number of components of the friction force.
    pub fn dimension(&self) -> usize {
        match self {
            Self::One(_) => 1,
            Self::Two(_) => 2,
            Self::Three(_) => 3,
        }
    }

    /// The factor of the sliding speed, if there is one.
    pub fn rate(&self) -> Option<&Stribeck> {
        match self {
            Self::One(law) => law.rate(),
            Self::Two(law) => law.rate(),
            Self::Three(law) => law.rate(),
        }
    }

    /// `min r_D/r_C`, see [`FrictionLaw::alpha_min`].
    pub fn alpha_min(&self) -> f64 {
        match self {
            Self::One(law) => law.alpha_min(),
            Self::Two(law) => law.alpha_min(),
            Self::Three(law) => law.alpha_min(),
        }
    }
}

impl PartialEq for Law {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::One(a), Self::One(b)) => a == b,
            (Self::Two(a), Self::Two(b)) => a == b,
            (Self::Three(a), Self::Three(b)) => a == b,
            _ => false,
        }
    }
}

impl From<FrictionLaw<1>> for Law {
    fn from(law: FrictionLaw<1>) -> Self {
        Self::One(Arc::new(law))
    }
}

impl From<FrictionLaw<2>> for Law {
    fn from(law: FrictionLaw<2>) -> Self {
        Self::Two(Arc::new(law))
    }
}

impl From<FrictionLaw<3>> for Law {
    fn from(law: FrictionLaw<3>) -> Self {
        Self::Three(Arc::new(law))
    }
}
