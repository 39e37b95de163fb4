//! Numbers of any kind, also those that are none, as data for serde: words stand for them in formats that people read.

use serde::de::{Error as _, Unexpected};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Number {
    Finite(f64),
    Other(String),
}

const WORDS: [(&str, f64); 3] =
    [("nan", f64::NAN), ("inf", f64::INFINITY), ("-inf", f64::NEG_INFINITY)];

pub(crate) fn serialize<S: Serializer>(values: &[f64], serializer: S) -> Result<S::Ok, S::Error> {
    if !serializer.is_human_readable() {
        return values.serialize(serializer);
    }
    serializer.collect_seq(values.iter().map(|&value| {
        let same = |(_, other): &&(&str, f64)| value == *other || value.is_nan() && other.is_nan();
        match WORDS.iter().find(same) {
            Some((word, _)) => Number::Other((*word).to_owned()),
            None => Number::Finite(value),
        }
    }))
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<f64>, D::Error> {
    if !deserializer.is_human_readable() {
        return Vec::deserialize(deserializer);
    }
    let number = |number| match number {
        Number::Finite(value) => Ok(value),
        Number::Other(word) => WORDS
            .iter()
            .find(|(name, _)| *name == word)
            .map(|(_, value)| *value)
            .ok_or_else(|| D::Error::invalid_value(Unexpected::Str(&word), &"a number")),
    };
    Vec::<Number>::deserialize(deserializer)?.into_iter().map(number).collect()
}
