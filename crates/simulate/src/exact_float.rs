//! Floating-point numbers in JSON, none of their bits lost.

use serde::de::{self, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// A number that JSON gives back bit for bit: the shortest decimal that is this f64, or `"inf"`, `"-inf"`, `"NaN"`, which
/// JSON has no numbers for. Only the payload of a NaN is lost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExactFloat(pub f64);

impl Serialize for ExactFloat {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0.is_finite() {
            true => serializer.serialize_f64(self.0),
            false => serializer.serialize_str(&self.0.to_string()),
        }
    }
}

impl<'de> Deserialize<'de> for ExactFloat {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<ExactFloat, D::Error> {
        deserializer.deserialize_any(ExactFloatVisitor)
    }
}

struct ExactFloatVisitor;

impl Visitor<'_> for ExactFloatVisitor {
    type Value = ExactFloat;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number, \"inf\", \"-inf\" or \"NaN\"")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<ExactFloat, E> {
        Ok(ExactFloat(value))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<ExactFloat, E> {
        Ok(ExactFloat(value as f64))
    }

    fn visit_u64<E: de::Error>(self, value: u64) -> Result<ExactFloat, E> {
        Ok(ExactFloat(value as f64))
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<ExactFloat, E> {
        match text {
            "inf" => Ok(ExactFloat(f64::INFINITY)),
            "-inf" => Ok(ExactFloat(f64::NEG_INFINITY)),
            "NaN" => Ok(ExactFloat(f64::NAN)),
            _ => Err(E::invalid_value(de::Unexpected::Str(text), &self)),
        }
    }
}

/// A length in m: four decimals, or four significant digits.
pub(crate) fn in_four_digits(depth: f64) -> String {
    if (1e-3..1e4).contains(&depth) { format!("{depth:.4}") } else { format!("{depth:.3e}") }
}

#[cfg(test)]
mod tests {
    use super::ExactFloat;
    use proptest::prelude::*;

    fn back(value: f64) -> f64 {
        let text = serde_json::to_string(&ExactFloat(value)).expect("JSON");
        serde_json::from_str::<ExactFloat>(&text).expect("a number").0
    }

    #[test]
    fn the_ends_of_the_range_come_back() {
        let all = [0.0, -0.0, 5e-324, -5e-324, f64::MIN_POSITIVE, f64::MAX, f64::MIN, 0.1, 1.0, 2e53, f64::INFINITY];
        for value in all.into_iter().chain([f64::NEG_INFINITY, f64::from(0.1f32), 1.0f64.next_up()]) {
            assert_eq!(back(value).to_bits(), value.to_bits(), "{value:e}");
        }
        assert!(back(f64::NAN).is_nan());
        for wrong in ["\"infinity\"", "null", "[1]"] {
            assert!(serde_json::from_str::<ExactFloat>(wrong).is_err(), "{wrong}");
        }
    }

    proptest! {
        #[test]
        fn every_number_comes_back(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            prop_assert!(value.is_nan() || back(value).to_bits() == bits);
        }
    }
}
