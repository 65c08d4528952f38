//! Why a file is refused.

use auv_types::Violations;
use thiserror::Error;

/// Size of the largest file that is read, in bytes. The largest networks of whole numbers, of
/// [`Network::MAX_EDGES`](crate::Network::MAX_EDGES) edges, take some 35 MB as JSON.
pub const MAX_FILE_BYTES: usize = 64 << 20;

/// Why a file cannot be read or written as an instance.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FormatError {
    /// The file is longer than [`MAX_FILE_BYTES`].
    #[error("has {bytes} bytes; at most {MAX_FILE_BYTES} are read")]
    TooLarge {
        /// Its length in bytes.
        bytes: usize,
    },
    /// The file is not in the format: the first place where reading failed.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// The file is in the format but has invalid values: all of them.
    #[error(transparent)]
    Invalid(#[from] Violations),
    /// The format cannot express the instance.
    #[error("the format cannot hold {0}")]
    NotExpressible(String),
}
