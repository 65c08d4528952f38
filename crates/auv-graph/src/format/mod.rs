//! Reading and writing instances: `auv-route-1` (JSON, feature `serde`), OPLib and the classic
//! orienteering text files.
//!
//! Input is untrusted: its size and its counts are limited before anything is allocated from them,
//! every offender is listed, and nothing panics.
//!
//! ```
//! use auv_graph::format;
//!
//! let text = "20 1\n0 0 0\n10 0 0\n5 0 8\n";
//! let instance = format::read(text.as_bytes(), "three points")?;
//! assert_eq!((instance.network.num_nodes(), instance.budget_s), (3, 20.0));
//! # Ok::<(), format::FormatError>(())
//! ```

mod classic;
mod node_scores;
#[cfg(feature = "serde")]
mod number;
mod oplib;
#[cfg(feature = "serde")]
mod route_json;

pub use classic::from_classic;
pub use oplib::from_oplib;
#[cfg(feature = "serde")]
pub use route_json::{from_json, to_json};

use crate::RouteInstance;
use auv_types::Violations;
use thiserror::Error;

/// Largest file read, in bytes.
pub const MAX_FILE_BYTES: usize = 16 << 20;

/// Why a file is not an instance.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FormatError {
    /// It is longer than [`MAX_FILE_BYTES`].
    #[error("has {bytes} bytes; at most {MAX_FILE_BYTES} are read")]
    TooLarge {
        /// Its length.
        bytes: usize,
    },
    /// It is not in the format: the first place where reading failed.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// It is in the format, but what it says is wrong: every offender.
    #[error(transparent)]
    Invalid(#[from] Violations),
    /// An instance that the format cannot express.
    #[error("the format cannot hold {0}")]
    NotExpressible(String),
}

/// Reads an instance in any of the formats, told apart by how the text begins: `{` is
/// `auv-route-1`, a digit the classic orienteering format, a letter OPLib.
///
/// `name` is taken where the file has none.
///
/// # Errors
/// As the reader of the format found; without feature `serde`, JSON is a syntax error.
pub fn read(bytes: &[u8], name: &str) -> Result<RouteInstance, FormatError> {
    let text = text_of(bytes)?;
    match text.trim_start().chars().next() {
        #[cfg(feature = "serde")]
        Some('{') => from_json(text),
        Some(c) if c.is_ascii_digit() => from_classic(text, name),
        Some(c) if c.is_ascii_alphabetic() => from_oplib(text, name),
        first => {
            let found = first.map_or("nothing".to_owned(), |c| format!("`{}`", c.escape_debug()));
            Err(syntax_at(
                text,
                text.len() - text.trim_start().len(),
                format!(
                    "found {found}; give an auv-route-1 JSON object, an OPLib file or a classic \
                     orienteering file (Tmax and 1 on the first line)"
                ),
            ))
        }
    }
}

/// The bytes as text, if they are short enough, UTF-8 and without a byte-order mark.
fn text_of(bytes: &[u8]) -> Result<&str, FormatError> {
    if bytes.len() > MAX_FILE_BYTES {
        return Err(FormatError::TooLarge { bytes: bytes.len() });
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let valid = &bytes[..error.valid_up_to()];
        syntax_at(
            &String::from_utf8_lossy(valid),
            valid.len(),
            "is not UTF-8 text; save the file as UTF-8".into(),
        )
    })?;
    if text.starts_with('\u{feff}') {
        let message = "begins with a byte-order mark; save the file as UTF-8 without it";
        return Err(syntax_at(text, 0, message.into()));
    }
    Ok(text)
}

/// A syntax error at a byte offset.
fn syntax_at(text: &str, offset: usize, message: String) -> FormatError {
    let before = &text.as_bytes()[..offset];
    let line_start = before
        .iter()
        .rposition(|&b| b == b'\n')
        .map_or(0, |i| i + 1);
    FormatError::Syntax {
        line: 1 + before.iter().filter(|&&b| b == b'\n').count(),
        column: 1 + offset - line_start,
        message,
    }
}

/// A finite number from one word of a text file; a violation naming the line where it is none.
fn number(word: &str, line: usize, what: &str, violations: &mut Violations) -> Option<f64> {
    let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
    if value.is_none() {
        violations.push(
            format!("line {line}"),
            format!(
                "holds `{}` as {what}; give a finite number",
                shortened(word)
            ),
        );
    }
    value
}

/// A word short enough for an error message.
fn shortened(word: &str) -> String {
    let escaped = word.escape_debug();
    if word.chars().count() <= 40 {
        escaped.collect()
    } else {
        escaped.take(40).chain("...".chars()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_is_no_text_and_says_where() {
        let place = |bytes: &[u8]| match read(bytes, "x") {
            Err(FormatError::Syntax { line, column, .. }) => (line, column),
            other => panic!("{other:?}"),
        };
        assert_eq!(place(b""), (1, 1));
        assert_eq!(place(b"\n\n  ["), (3, 3));
        assert_eq!(place(b"ab\ncd\xff"), (2, 3));
        assert_eq!(place("\u{feff}{}".as_bytes()), (1, 1));
        let long = vec![b' '; MAX_FILE_BYTES + 1];
        assert!(matches!(
            read(&long, "x"),
            Err(FormatError::TooLarge { .. })
        ));
    }
}
