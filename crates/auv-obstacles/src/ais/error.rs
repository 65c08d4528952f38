//! Why a text of ship positions is refused.

use auv_types::Violations;
use thiserror::Error;

/// Largest text accepted, bytes.
pub const MAX_BYTES: usize = 64 << 20;

/// Why a text holds no usable ship tracks.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum AisError {
    /// A required column is missing from the header.
    #[error(
        "line 1: the column {column} is missing; the header must name vessel (or MMSI), BaseDateTime, LAT and LON, \
         or the mission file must say what they are called ([ais.columns], version = 2)"
    )]
    MissingColumn {
        /// Its name.
        column: String,
    },
    /// The text is too large.
    #[error("the text has {bytes} bytes; give at most {MAX_BYTES}")]
    TooLarge {
        /// Its size.
        bytes: usize,
    },
    /// A quotation mark takes in the rows after it.
    #[error("line {line}: a quotation mark is not closed in its line; close it or take it out")]
    OpenQuote {
        /// Where it is.
        line: usize,
    },
    /// Dates that have a day in the second place.
    #[error(
        "line {line}: the date in \"{time}\" has the month first, which cannot be told from the day in other rows; \
         write YYYY-MM-DD"
    )]
    MonthFirst {
        /// Where it is.
        line: usize,
        /// The time as written.
        time: String,
    },
    /// Fixes of one number at hundreds of places at once.
    #[error(
        "vessel {vessel} is at hundreds of places at once: that is not the number of a ship; give its rows numbers of their \
         own, or take them out"
    )]
    Scattered {
        /// The number.
        vessel: String,
    },
    /// No row could be used.
    #[error("no row holds a usable fix; give rows with vessel, time, latitude and longitude{first}", first = first_of(.skipped))]
    NoFix {
        /// Why each row was skipped.
        skipped: Violations,
    },
}

fn first_of(skipped: &Violations) -> String {
    skipped
        .list()
        .first()
        .map_or_else(String::new, |v| format!("; {} {}", v.place, v.message))
}
