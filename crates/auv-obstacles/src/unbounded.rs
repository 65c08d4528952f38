//! Numbers that may be infinite, in formats without infinities: written as "inf" and "-inf".

use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum MaybeInfinite {
    Finite(f64),
    Named(String),
}

pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if value.is_finite() {
        serializer.serialize_f64(*value)
    } else {
        serializer.serialize_str(&value.to_string())
    }
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    match MaybeInfinite::deserialize(deserializer)? {
        MaybeInfinite::Finite(value) => Ok(value),
        MaybeInfinite::Named(name) if name == "inf" => Ok(f64::INFINITY),
        MaybeInfinite::Named(name) if name == "-inf" => Ok(f64::NEG_INFINITY),
        MaybeInfinite::Named(name) => Err(D::Error::custom(format!(
            "\"{name}\" is not a number; give a number, \"inf\" or \"-inf\""
        ))),
    }
}
