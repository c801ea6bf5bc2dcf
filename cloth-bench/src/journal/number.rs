//! Numbers as JSON keeps them.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A number of a result that may be infinite or none, which JSON does not know: those are kept as text.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Number(pub f64);

impl Serialize for Number {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // Of the formats here the one that people read is JSON.
        if self.0.is_finite() || !serializer.is_human_readable() {
            self.0.serialize(serializer)
        } else {
            self.0.to_string().serialize(serializer)
        }
    }
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        #[serde(untagged)]
        enum Either {
            Number(f64),
            Text(String),
        }
        match Either::deserialize(deserializer)? {
            Either::Number(number) => Ok(Self(number)),
            Either::Text(text) => text.parse().map(Self).map_err(serde::de::Error::custom),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_with_all_bits() {
        for number in [
            0.1,
            -0.0,
            5e-324,
            f64::MAX,
            1.0 / 3.0,
            f64::INFINITY,
            -f64::INFINITY,
        ] {
            let text = serde_json::to_string(&Number(number)).unwrap();
            let back: Number = serde_json::from_str(&text).unwrap();
            assert_eq!(back.0.to_bits(), number.to_bits());
        }
        let none: Number = serde_json::from_str("\"NaN\"").unwrap();
        assert!(none.0.is_nan());
    }
}
