//! Recorded ship positions (AIS) from comma-separated text (feature `ais`).
//!
//! Columns are found by name, in any order: those of MarineCadastre, old (`MMSI`, `BaseDateTime`, `LAT`,
//! `LON`, `SOG`, ...) and new (`mmsi`, `base_date_time`, `latitude`, ...), of the Danish Maritime Authority
//! (`# Timestamp`, `Navigational status`, `Draught`, ...), or those that [`ColumnNames`] gives. Speed is in
//! knots, angles are in degrees, sizes in metres. The codes for "not available" (speed 102.3, course 360,
//! heading 511, latitude 91, sizes 0 or empty) become `None`, or the row is left out. Cells may be quoted,
//! rows may be in any order.
//!
//! The rows of one number are separated into ships by motion: two ships may share a number, and a single
//! fix may be a stray. [`AisTable::notes`] tells what was separated or left out.
//!
//! ```
//! let text = "vessel,BaseDateTime,LAT,LON,SOG,Length,Draft\n\
//!             7,2022-01-03T00:01:00,48.33,-123.34,102.3,90,\n\
//!             7,2022-01-03T00:00:00,48.32,-123.34,36.0,90,\n";
//! let table = auv_obstacles::ais::parse(text)?;
//! let ship = &table.ships[0];
//! assert_eq!((ship.fixes[0].time_s, ship.fixes[1].time_s), (0.0, 60.0));
//! assert_eq!((ship.fixes[1].speed_mps, ship.length_m, ship.draught_m), (None, Some(90.0), None));
//! # Ok::<(), auv_obstacles::ais::AisError>(())
//! ```

mod clock;
mod columns;
mod error;
mod fix;
mod lines;
mod motion;
mod rest;
mod row;
mod ship;
mod tests;

pub use columns::ColumnNames;
pub use error::{AisError, MAX_BYTES};
pub use fix::{AisFix, NavStatus};
pub use ship::{AisShip, AssumedSize};

use auv_types::Violations;
use clock::Slashes;
use columns::Columns;
use lines::Lines;
use motion::separated;
use row::{Row, row_of};
use std::collections::BTreeMap;

/// Fastest ship believed, m/s.
pub const FASTEST_MPS: f64 = 30.0;

/// All ships of a text.
#[derive(Clone, Debug, PartialEq)]
pub struct AisTable {
    /// The ships, ordered by name.
    pub ships: Vec<AisShip>,
    /// Time of the first fix, seconds after 1970-01-01T00:00:00 (UTC).
    pub start_unix_s: f64,
    /// The rows that could not be used, with the reasons.
    pub skipped: Violations,
    /// Number of rows dropped because their ship had an earlier row for the same time.
    pub duplicates: usize,
    /// Number of single fixes dropped because no ship of their number can have been there.
    pub strays: usize,
    /// What was separated or left out, one sentence each.
    pub notes: Vec<String>,
}

/// How a text is read.
#[derive(Clone, Debug, PartialEq)]
pub struct AisOptions {
    /// Names of columns that are not the usual ones.
    pub columns: ColumnNames,
    /// Greatest speed between two fixes of one ship, m/s.
    pub fastest_mps: f64,
}

impl Default for AisOptions {
    fn default() -> Self {
        Self {
            columns: ColumnNames::default(),
            fastest_mps: FASTEST_MPS,
        }
    }
}

/// Parses a text of ship positions with the usual columns.
///
/// # Errors
/// As [`parse_with`].
pub fn parse(text: &str) -> Result<AisTable, AisError> {
    parse_with(text, &AisOptions::default())
}

/// Parses a text of ship positions.
///
/// # Determinism
/// The result depends on the rows only, not on their order, but where rows of one place and time differ.
///
/// # Errors
/// A required column missing, a text larger than [`MAX_BYTES`], a quotation mark that is not closed, dates with
/// the month first, a number under which hundreds of ships report, or no usable row. Single rows that cannot be used are skipped and listed.
pub fn parse_with(text: &str, options: &AisOptions) -> Result<AisTable, AisError> {
    if text.len() > MAX_BYTES {
        return Err(AisError::TooLarge { bytes: text.len() });
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let read = Rows::of(text, &options.columns)?;
    let times_s = read.by_number.values().flatten().map(|row| row.fix.time_s);
    let mut table = AisTable {
        ships: Vec::new(),
        start_unix_s: times_s.fold(f64::INFINITY, f64::min),
        skipped: read.skipped,
        duplicates: 0,
        strays: 0,
        notes: read.notes,
    };
    if !table.start_unix_s.is_finite() {
        return Err(AisError::NoFix {
            skipped: table.skipped,
        });
    }
    for (vessel, rows) in read.by_number {
        table.take_in(&vessel, rows, options.fastest_mps)?;
    }
    Ok(table)
}

/// What a text holds.
struct Rows {
    /// The usable rows by the number that they report.
    by_number: BTreeMap<String, Vec<Row>>,
    skipped: Violations,
    notes: Vec<String>,
}

impl Rows {
    fn of(text: &str, names: &ColumnNames) -> Result<Self, AisError> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .delimiter(delimiter(text))
            .from_reader(text.as_bytes());
        let mut records = reader.records().filter_map(Result::ok);
        let header = records.next().unwrap_or_default();
        let columns = Columns::of(header.iter(), names)?;
        let mut rows = Self {
            by_number: BTreeMap::new(),
            skipped: Violations::new(),
            notes: Vec::new(),
        };
        let (mut lines, mut slashes) = (Lines::new(text), Slashes::default());
        let mut ashore = 0;
        for record in
            records.filter(|record| record.iter().any(|cell| !cell.is_empty()) || record.len() > 1)
        {
            if record.iter().any(|cell| cell.contains('\n')) {
                return Err(AisError::OpenQuote {
                    line: lines.of(&record),
                });
            }
            if columns
                .sender
                .is_some_and(|column| is_ashore(record.get(column)))
            {
                ashore += 1;
                continue;
            }
            slashes.see(columns.time_of(&record), || lines.of(&record));
            match row_of(&record, &columns) {
                Ok((vessel, row)) => rows
                    .by_number
                    .entry(vessel.to_owned())
                    .or_default()
                    .push(row),
                Err(message) => {
                    let place = format!("line {}", lines.of(&record));
                    rows.skipped.push(place, message);
                }
            }
        }
        let assumed = slashes.told()?;
        // The Danish authority, which tells what sends, documents its order.
        rows.notes
            .extend(assumed.filter(|_| columns.sender.is_none()));
        if ashore > 0 {
            rows.notes.push(format!(
                "{ashore} rows of base stations, aids to navigation and aircraft are left out: they are no ships"
            ));
        }
        Ok(rows)
    }
}

/// Whether what sends is no ship.
fn is_ashore(sender: Option<&str>) -> bool {
    sender.is_some_and(|sender| ["Base Station", "AtoN", "SAR Airborne"].contains(&sender))
}

impl AisTable {
    /// Adds the ships of one number.
    fn take_in(
        &mut self,
        vessel: &str,
        mut rows: Vec<Row>,
        fastest_mps: f64,
    ) -> Result<(), AisError> {
        rows.sort_by(|a, b| a.fix.time_s.total_cmp(&b.fix.time_s));
        for row in &mut rows {
            row.fix.time_s -= self.start_unix_s;
        }
        let found = separated(&rows, fastest_mps).ok_or_else(|| AisError::Scattered {
            vessel: vessel.into(),
        })?;
        self.duplicates += found.duplicates;
        self.strays += found.strays.len();
        if found.tracks.len() > 1 {
            self.notes.push(format!(
                "vessel {vessel}: {} ships share the number; they are told apart by how they move",
                found.tracks.len()
            ));
        }
        if let Some(stray) = found.strays.first() {
            self.notes.push(format!(
                "vessel {vessel}: {} stray fixes are left out, the first at {:.0} s, latitude {}, longitude {}",
                found.strays.len(),
                stray.fix.time_s,
                stray.fix.latitude_deg,
                stray.fix.longitude_deg
            ));
        }
        for (i, track) in found.tracks.iter().enumerate() {
            let name = match i {
                0 => vessel.to_owned(),
                _ => format!("{vessel} ({})", i + 1),
            };
            self.ships.push(AisShip::new(name, track));
        }
        Ok(())
    }
}

/// What separates the cells of the header.
fn delimiter(text: &str) -> u8 {
    let header = text.lines().next().unwrap_or_default();
    let count = |c: char| header.matches(c).count();
    let mut best = ',';
    for other in [';', '\t'] {
        if count(other) > count(best) {
            best = other;
        }
    }
    best as u8
}
