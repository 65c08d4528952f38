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
mod motion;
#[cfg(test)]
mod tests;

pub use columns::ColumnNames;

use crate::truth::{AfterLastFix, ShipFix, TrackedShip};
use auv_types::Violations;
use columns::Columns;
use csv::StringRecord;
use motion::{Row, end_velocity, separated};
use std::collections::BTreeMap;
use thiserror::Error;

/// Largest text accepted, bytes.
pub const MAX_BYTES: usize = 64 << 20;
/// One knot in m/s.
const KNOT_MPS: f64 = 1852.0 / 3600.0;
/// Fastest ship believed, m/s.
pub const FASTEST_MPS: f64 = 30.0;

/// Degrees north and east in metres north and east of the mission's origin.
type MetresOf<'a> = dyn Fn(f64, f64) -> (f64, f64) + 'a;

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

/// What a ship says it is doing, as far as its motion is concerned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NavStatus {
    /// Under way, fishing, drifting, or not told.
    #[default]
    Free,
    /// At anchor.
    Anchored,
    /// Moored.
    Moored,
    /// Aground.
    Aground,
}

/// One reported position.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AisFix {
    /// Seconds after the first fix of the whole text.
    pub time_s: f64,
    /// Degrees north.
    pub latitude_deg: f64,
    /// Degrees east.
    pub longitude_deg: f64,
    /// Speed over ground, m/s.
    pub speed_mps: Option<f64>,
    /// Course over ground, clockwise from north in radians.
    pub course_rad: Option<f64>,
    /// Heading, clockwise from north in radians.
    pub heading_rad: Option<f64>,
    /// Navigational status.
    #[cfg_attr(feature = "serde", serde(default))]
    pub status: NavStatus,
}

impl AisFix {
    /// Whether the ship reports that it lies at anchor, moored or aground.
    #[must_use]
    pub fn lies_still(&self) -> bool {
        self.status != NavStatus::Free
    }
}

/// A ship and its reported positions, in order of time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AisShip {
    /// Its name or number. A second ship of one number has ` (2)` behind it.
    pub vessel: String,
    /// AIS code of its type.
    pub vessel_type: Option<u32>,
    /// Length over all, metres.
    pub length_m: Option<f64>,
    /// Beam, metres.
    pub width_m: Option<f64>,
    /// Draught, metres.
    pub draught_m: Option<f64>,
    /// Its positions in order of time, one per time.
    pub fixes: Vec<AisFix>,
}

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

/// The size assumed for ships that report none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct AssumedSize {
    /// Length, metres.
    pub length_m: f64,
    /// Draught, metres.
    pub draught_m: f64,
}

impl Default for AssumedSize {
    /// A coaster of 100 m length and 6 m draught: larger than most ships that report no size.
    fn default() -> Self {
        Self {
            length_m: 100.0,
            draught_m: 6.0,
        }
    }
}

impl AisShip {
    /// A ship from its rows in order of time. Of sizes that change the greatest holds.
    fn new(vessel: String, rows: &[Row]) -> Self {
        let greatest = |of: fn(&Row) -> Option<f64>| rows.iter().filter_map(of).reduce(f64::max);
        Self {
            vessel,
            vessel_type: rows.iter().find_map(|row| row.vessel_type),
            length_m: greatest(|row| row.length_m),
            width_m: greatest(|row| row.width_m),
            draught_m: greatest(|row| row.draught_m),
            fixes: rows.iter().map(|row| row.fix).collect(),
        }
    }

    /// The ship as a true obstacle. `to_local` converts degrees north and east to metres north and east of
    /// the mission's origin.
    ///
    /// With [`AfterLastFix::HoldCourse`] the ship sails on with the speed and course that it reports; if it
    /// reports none, or that it lies still, the way made good over a minute or more decides. The same holds
    /// before its first fix. With [`AfterLastFix::Repeat`] its recorded positions alone count.
    ///
    /// # Errors
    /// Positions that `to_local` does not map to finite metres.
    pub fn tracked(
        &self,
        to_local: &dyn Fn(f64, f64) -> (f64, f64),
        assumed: AssumedSize,
        after_last_fix: AfterLastFix,
    ) -> Result<TrackedShip, Violations> {
        let fixes = self.fixes.iter().map(|fix| {
            let (north_m, east_m) = to_local(fix.latitude_deg, fix.longitude_deg);
            ShipFix {
                time_s: fix.time_s,
                north_m,
                east_m,
            }
        });
        let ship = TrackedShip::new(
            fixes.collect(),
            self.length_m.unwrap_or(assumed.length_m),
            self.draught_m.unwrap_or(assumed.draught_m),
            after_last_fix,
        )?;
        let backwards: Vec<AisFix> = self.fixes.iter().rev().copied().collect();
        Ok(ship.with_ends([
            end_velocity(&backwards, to_local),
            end_velocity(&self.fixes, to_local),
        ]))
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
/// A required column missing, a text larger than [`MAX_BYTES`], a quotation mark that is not closed, or no
/// usable row. Single rows that cannot be used are skipped and listed.
pub fn parse_with(text: &str, options: &AisOptions) -> Result<AisTable, AisError> {
    if text.len() > MAX_BYTES {
        return Err(AisError::TooLarge { bytes: text.len() });
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .delimiter(delimiter(text))
        .from_reader(text.as_bytes());
    let mut records = reader.records().filter_map(Result::ok);
    let header = records.next().unwrap_or_default();
    let columns = Columns::of(header.iter(), &options.columns)?;
    let mut table = AisTable {
        ships: Vec::new(),
        start_unix_s: f64::INFINITY,
        skipped: Violations::new(),
        duplicates: 0,
        strays: 0,
        notes: Vec::new(),
    };
    let mut numbers: BTreeMap<String, Vec<Row>> = BTreeMap::new();
    let mut ashore = 0;
    for record in
        records.filter(|record| record.iter().any(|cell| !cell.is_empty()) || record.len() > 1)
    {
        let line = || line_of(text, &record);
        if record.iter().any(|cell| cell.contains('\n')) {
            return Err(AisError::OpenQuote { line: line() });
        }
        let sender = columns.sender.and_then(|column| record.get(column));
        if sender.is_some_and(|sender| ["Base Station", "AtoN", "SAR Airborne"].contains(&sender)) {
            ashore += 1;
            continue;
        }
        match row_of(&record, &columns) {
            Ok((vessel, row)) => numbers.entry(vessel.to_owned()).or_default().push(row),
            Err(message) => table.skipped.push(format!("line {}", line()), message),
        }
    }
    if ashore > 0 {
        table.notes.push(format!(
            "{ashore} rows of base stations, aids to navigation and aircraft are left out: they are no ships"
        ));
    }
    for rows in numbers.values() {
        let first_s = rows.iter().map(|row| row.fix.time_s);
        table.start_unix_s = first_s.fold(table.start_unix_s, f64::min);
    }
    if !table.start_unix_s.is_finite() {
        return Err(AisError::NoFix {
            skipped: table.skipped,
        });
    }
    for (vessel, rows) in numbers {
        table.take_in(&vessel, rows, options.fastest_mps);
    }
    Ok(table)
}

impl AisTable {
    /// Adds the ships of one number.
    fn take_in(&mut self, vessel: &str, mut rows: Vec<Row>, fastest_mps: f64) {
        rows.sort_by(|a, b| a.fix.time_s.total_cmp(&b.fix.time_s));
        for row in &mut rows {
            row.fix.time_s -= self.start_unix_s;
        }
        let found = separated(&rows, fastest_mps);
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
    }
}

/// The line that a record begins in. The reader's own count is off by one behind `\r\n`.
fn line_of(text: &str, record: &StringRecord) -> usize {
    let byte = record.position().map_or(0, csv::Position::byte) as usize;
    let bytes = text.as_bytes();
    let breaks = bytes
        .iter()
        .skip(byte)
        .take_while(|b| b"\r\n".contains(b))
        .count();
    let before = bytes.iter().take(byte + breaks);
    before.filter(|&&b| b == b'\n').count() + 1
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

fn number(record: &StringRecord, column: Option<usize>) -> Option<f64> {
    let value: f64 = record.get(column?)?.parse().ok()?;
    value.is_finite().then_some(value)
}

/// The vessel and the contents of one row, with its time in seconds after 1970.
fn row_of<'a>(record: &'a StringRecord, columns: &Columns) -> Result<(&'a str, Row), String> {
    let cell = |column: usize| record.get(column).unwrap_or("");
    let vessel = cell(columns.vessel);
    if vessel.is_empty() {
        return Err("names no vessel".into());
    }
    let time_s = clock::unix_seconds(cell(columns.time)).ok_or_else(|| {
        format!(
            "has time \"{}\"; give YYYY-MM-DDThh:mm:ss, or dd/mm/yyyy hh:mm:ss",
            cell(columns.time)
        )
    })?;
    let degrees = |column: usize, name: &str, limit: f64| {
        number(record, Some(column))
            .filter(|x| x.abs() <= limit)
            .ok_or_else(|| {
                format!(
                    "(vessel {vessel}) has {name} \"{}\"; give degrees within {limit}",
                    cell(column)
                )
            })
    };
    let fix = AisFix {
        time_s,
        latitude_deg: degrees(columns.latitude, "LAT", 90.0)?,
        longitude_deg: degrees(columns.longitude, "LON", 180.0)?,
        speed_mps: number(record, columns.speed)
            .filter(|knots| (0.0..102.25).contains(knots))
            .map(|knots| knots * KNOT_MPS),
        course_rad: angle_rad(number(record, columns.course)),
        heading_rad: angle_rad(number(record, columns.heading)),
        status: columns
            .status
            .map_or(NavStatus::Free, |column| status_of(cell(column))),
    };
    let size = |column| number(record, column).filter(|x| *x > 0.0 && *x < 1000.0);
    let row = Row {
        fix,
        length_m: size(columns.length),
        width_m: size(columns.width),
        draught_m: size(columns.draught),
        vessel_type: columns
            .vessel_type
            .and_then(|column| cell(column).parse().ok()),
    };
    Ok((vessel, row))
}

/// The navigational status of its number or its text.
fn status_of(text: &str) -> NavStatus {
    match text.to_ascii_lowercase().as_str() {
        "1" | "1.0" | "at anchor" => NavStatus::Anchored,
        "5" | "5.0" | "moored" => NavStatus::Moored,
        "6" | "6.0" | "aground" => NavStatus::Aground,
        _ => NavStatus::Free,
    }
}

fn angle_rad(degrees: Option<f64>) -> Option<f64> {
    degrees
        .filter(|x| (0.0..360.0).contains(x))
        .map(f64::to_radians)
}
