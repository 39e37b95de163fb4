//! Samples of motions as data that are written and read with serde.
//!
//! Numbers that are none, as forces before the first step, are words (`"nan"`, `"inf"`, `"-inf"`) in formats that people
//! read: JSON has no others. What is read is refused where lengths do not fit each other.

use super::samples::Samples;
use crate::contact::Phase;
use crate::integrator::event::Motion;

/// What must hold of data before they are a value.
pub(crate) trait Checked: Sized {
    /// What does not fit.
    fn fault(&self) -> Option<&'static str>;

    fn checked<E: serde::de::Error>(self) -> Result<Self, E> {
        self.fault().map_or(Ok(self), |fault| Err(E::custom(fault)))
    }
}

impl Checked for Samples {
    fn fault(&self) -> Option<&'static str> {
        let Self { coordinates, dof, contacts, p, .. } = *self;
        let n = self.t.len();
        let fits = |len: usize, per_sample: Option<usize>| {
            per_sample.and_then(|m| m.checked_mul(n)) == Some(len)
        };
        let vectors = contacts.checked_mul(p);
        if p > 3 {
            return Some("p: must be at most 3");
        }
        let phase = |number: &i8| Phase::from_number(*number).is_some();
        if !self.phase.iter().all(phase) {
            return Some("phase: must be -1, 0, 1 or 2");
        }
        let lengths = fits(self.q.len(), Some(coordinates))
            && fits(self.u.len(), Some(dof))
            && fits(self.slip.len(), vectors)
            && fits(self.force.len(), vectors)
            && fits(self.normal_force.len(), Some(contacts))
            && fits(self.phase.len(), Some(contacts));
        (!lengths)
            .then_some("samples: must have as many entries as samples times what there is of each")
    }
}

impl Checked for Motion {
    fn fault(&self) -> Option<&'static str> {
        let known = |contact: Option<usize>| contact.is_none_or(|c| c < self.samples.contacts);
        let all = self.events.iter().all(|event| known(event.contact));
        (!all).then_some("events: must be of contacts that there are")
    }
}

/// Derived implementations of the type itself, with a check of what is read.
macro_rules! checked {
    ($($type:ident),*) => {
        $(impl serde::Serialize for $type {
            fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                $type::serialize(self, serializer)
            }
        }

        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                $crate::integrator::data::Checked::checked($type::deserialize(deserializer)?)
            }
        })*
    };
}
pub(crate) use checked;

checked!(Samples, Motion);
