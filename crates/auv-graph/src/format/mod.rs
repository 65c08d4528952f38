//! Reading and writing instances: `auv-route-1` (JSON, feature `serde`), OPLib, the classic
//! orienteering text files, and those with time windows (OPTW).
//!
//! Input is untrusted. Its size and its counts are limited before memory is allocated for them, all
//! invalid values are listed, and nothing panics.
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
mod error;
mod node_scores;
mod node_table;
#[cfg(feature = "serde")]
mod number;
mod oplib;
mod oplib_headers;
mod oplib_text;
mod optw;
#[cfg(feature = "serde")]
mod route_json;
mod text;
#[cfg(feature = "serde")]
mod time_keys;
mod tsplib_distance;
mod weight_matrix;

pub use classic::from_classic;
pub use error::{FormatError, MAX_FILE_BYTES};
pub use node_scores::nearest_kept;
pub use oplib::from_oplib;
pub use optw::from_optw;
#[cfg(feature = "serde")]
pub use route_json::{from_json, to_json};

use crate::instance::RouteInstance;
use classic::starts_with_header_key;
use optw::starts_with_optw_header;
use text::{syntax_at, text_of};

/// Reads an instance in any of the formats. The first character of the text decides: `{` is
/// `auv-route-1`, a digit the classic orienteering format (OPTW if the first line has four whole
/// numbers), a letter OPLib, unless the first word is `n`, `m` or `tmax` as in some classic files. A
/// byte-order mark at the start is skipped.
///
/// `name` is used if the file has none.
///
/// # Errors
/// Those of the format's reader. Without feature `serde`, JSON is a syntax error.
pub fn read(bytes: &[u8], name: &str) -> Result<RouteInstance, FormatError> {
    read_with_decimals(bytes, name, None)
}

/// Like [`read`]; distances of an OPTW file are cut to `decimals` ([`from_optw`]).
///
/// # Errors
/// Those of [`read`].
pub fn read_with_decimals(
    bytes: &[u8],
    name: &str,
    decimals: Option<u32>,
) -> Result<RouteInstance, FormatError> {
    let text = text_of(bytes)?;
    match text.trim_start().chars().next() {
        #[cfg(feature = "serde")]
        Some('{') => from_json(text),
        Some(c) if c.is_ascii_digit() && starts_with_optw_header(text) => {
            from_optw(text, name, decimals)
        }
        Some(c) if c.is_ascii_digit() || starts_with_header_key(text) => from_classic(text, name),
        Some(c) if c.is_ascii_alphabetic() => from_oplib(text, name),
        first => {
            let found = first.map_or("nothing".to_owned(), |c| format!("`{}`", c.escape_debug()));
            Err(syntax_at(
                text,
                text.len() - text.trim_start().len(),
                format!(
                    "found {found}; give an auv-route-1 JSON object, an OPLib file, a classic \
                     orienteering file (Tmax and 1 on the first line) or one with time windows \
                     (four whole numbers on the first line)"
                ),
            ))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_not_text_is_refused_with_the_place() {
        let place = |bytes: &[u8]| match read(bytes, "x") {
            Err(FormatError::Syntax { line, column, .. }) => (line, column),
            other => panic!("{other:?}"),
        };
        assert_eq!(place(b""), (1, 1));
        assert_eq!(place(b"\n\n  ["), (3, 3));
        assert_eq!(place(b"ab\ncd\xff"), (2, 3));
        assert_eq!(place("\u{feff}[".as_bytes()), (1, 1));
        assert_eq!(place("\u{feff}\u{feff}20 1".as_bytes()), (1, 1));
        assert_eq!(place(b"\xff\xfe2\x000\x00"), (1, 1));
        let long = vec![b' '; MAX_FILE_BYTES + 1];
        assert!(matches!(
            read(&long, "x"),
            Err(FormatError::TooLarge { .. })
        ));
    }
}
