//! Numbers of a JSON file. Words such as `NaN` are read too, so that all of them can be reported by the
//! names of their fields.

use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A number, or what programs write in place of one: `null`, or a word such as `NaN`, `-Infinity` or
/// `1e999`, which [`quoted`] puts in quotes.
#[derive(Clone, Copy, Serialize)]
pub(super) struct JsonNumber(pub(super) f64);

impl<'de> Deserialize<'de> for JsonNumber {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl Visitor<'_> for Any {
            type Value = JsonNumber;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<JsonNumber, E> {
                Ok(JsonNumber(value))
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<JsonNumber, E> {
                Ok(JsonNumber(value as f64))
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<JsonNumber, E> {
                Ok(JsonNumber(value as f64))
            }

            fn visit_unit<E: Error>(self) -> Result<JsonNumber, E> {
                Ok(JsonNumber(f64::NAN))
            }

            fn visit_str<E: Error>(self, word: &str) -> Result<JsonNumber, E> {
                let value = not_finite(word).map(JsonNumber);
                value.ok_or_else(|| E::invalid_type(serde::de::Unexpected::Str(word), &self))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

/// The value of a word that means a number which is not finite.
fn not_finite(word: &str) -> Option<f64> {
    word.parse().ok().filter(|value: &f64| !value.is_finite())
}

/// The text with quotes around every bare word that means a number which is not finite; `None` if there
/// is none. Strings are not changed. Complexity: O(length).
pub(super) fn quoted(text: &str) -> Option<String> {
    let bytes = text.as_bytes();
    let is_of_word = |b: &u8| b.is_ascii_alphanumeric() || b"+-.".contains(b);
    let mut changed = String::new();
    let (mut copied, mut at) = (0, 0);
    while let Some(&byte) = bytes.get(at) {
        if byte == b'"' {
            at += 1;
            while let Some(&byte) = bytes.get(at).filter(|&&byte| byte != b'"') {
                at += if byte == b'\\' { 2 } else { 1 };
            }
        }
        let word = bytes.get(at..).unwrap_or_default();
        let length = word.iter().take_while(|b| is_of_word(b)).count();
        if let Some(word) = text.get(at..at + length)
            && not_finite(word).is_some()
        {
            changed.push_str(&text[copied..at]);
            changed.extend(["\"", word, "\""]);
            copied = at + length;
        }
        at += length.max(1);
    }
    (copied > 0).then(|| changed + &text[copied..])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_bare_words_for_numbers_that_are_not_finite_are_quoted() {
        let text = r#"{"NaN, \" inf": [NaN, 1e5,-Infinity ,1e999, "ä NaN", true, nano],"#;
        let expected = r#"{"NaN, \" inf": ["NaN", 1e5,"-Infinity" ,"1e999", "ä NaN", true, nano],"#;
        assert_eq!(quoted(text).as_deref(), Some(expected));
        for text in ["", "\"", "\"\\", "\"NaN", "[1, 2, -3e4]", "ä"] {
            assert_eq!(quoted(text), None);
        }
        assert_eq!(quoted("NaN").as_deref(), Some("\"NaN\""));
    }
}
