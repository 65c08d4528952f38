//! Numbers of a JSON file, those that are none included: they are refused by name, not by place.

use serde::de::{Deserializer, Error, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A number, or what programs write where they have none: `null`, or a word that is quoted by
/// [`quoted`], such as `NaN`, `-Infinity` and `1e999`.
#[derive(Clone, Copy, Serialize)]
pub(super) struct Number(pub(super) f64);

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Any;
        impl Visitor<'_> for Any {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<Number, E> {
                Ok(Number(value))
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_u64<E: Error>(self, value: u64) -> Result<Number, E> {
                Ok(Number(value as f64))
            }

            fn visit_unit<E: Error>(self) -> Result<Number, E> {
                Ok(Number(f64::NAN))
            }

            fn visit_str<E: Error>(self, word: &str) -> Result<Number, E> {
                let value = not_finite(word).map(Number);
                value.ok_or_else(|| E::invalid_type(serde::de::Unexpected::Str(word), &self))
            }
        }
        deserializer.deserialize_any(Any)
    }
}

/// What a word means that reads as a number which is infinite or none.
fn not_finite(word: &str) -> Option<f64> {
    word.parse().ok().filter(|value: &f64| !value.is_finite())
}

/// The text with every bare word that means no finite number in quotes, so that all of them can be
/// named; nothing where there are none. Strings stay as they are. Complexity: O(length).
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
    fn quotes_words_that_are_no_finite_numbers_and_nothing_else() {
        let text = r#"{"NaN, \" inf": [NaN, 1e5,-Infinity ,1e999, "ä NaN", true, nano],"#;
        let expected = r#"{"NaN, \" inf": ["NaN", 1e5,"-Infinity" ,"1e999", "ä NaN", true, nano],"#;
        assert_eq!(quoted(text).as_deref(), Some(expected));
        for text in ["", "\"", "\"\\", "\"NaN", "[1, 2, -3e4]", "ä"] {
            assert_eq!(quoted(text), None);
        }
        assert_eq!(quoted("NaN").as_deref(), Some("\"NaN\""));
    }
}
