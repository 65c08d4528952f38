//! Recorded ship positions (AIS) from comma-separated text.
//!
//! Columns are found by name, in any order: `vessel` (or `MMSI`), `BaseDateTime`, `LAT`, `LON`, and the
//! optional `SOG` (knots), `COG` and `Heading` (degrees), `VesselType`, `Length`, `Width` and `Draft`
//! (metres). The codes for "not available" (speed 102.3, course 360, heading 511, sizes 0 or empty) become
//! `None`. Rows may be in any order. If a ship has several rows for one time, the first is used.
//!
//! ```
//! let text = "vessel,BaseDateTime,LAT,LON,SOG,Length,Draft\n\
//!             7,2022-01-03T00:01:00,48.33,-123.34,102.3,90,\n\
//!             7,2022-01-03T00:00:00,48.32,-123.34,6.0,90,\n";
//! let table = auv_obstacles::ais::parse(text)?;
//! let ship = &table.ships[0];
//! assert_eq!((ship.fixes[0].time_s, ship.fixes[1].time_s), (0.0, 60.0));
//! assert_eq!((ship.fixes[1].speed_mps, ship.length_m, ship.draught_m), (None, Some(90.0), None));
//! # Ok::<(), auv_obstacles::ais::AisError>(())
//! ```

use crate::truth::{AfterLastFix, ShipFix, TrackedShip};
use auv_types::Violations;
use std::collections::BTreeMap;
use thiserror::Error;

/// Largest text accepted, bytes.
pub const MAX_BYTES: usize = 64 << 20;
/// One knot in m/s.
const KNOT_MPS: f64 = 1852.0 / 3600.0;

/// Why a text holds no usable ship tracks.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum AisError {
    /// A required column is missing from the header.
    #[error(
        "line 1: the column {column} is missing; the header must name vessel (or MMSI), BaseDateTime, LAT and LON"
    )]
    MissingColumn {
        /// Its name.
        column: &'static str,
    },
    /// The text is too large.
    #[error("the text has {bytes} bytes; give at most {MAX_BYTES}")]
    TooLarge {
        /// Its size.
        bytes: usize,
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
}

/// A ship and its reported positions, in order of time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AisShip {
    /// Its name or number.
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
    fn new(vessel: &str) -> Self {
        Self {
            vessel: vessel.to_owned(),
            vessel_type: None,
            length_m: None,
            width_m: None,
            draught_m: None,
            fixes: Vec::new(),
        }
    }

    /// Sorts the fixes and drops repeated times; times then count from `start_unix_s`. Returns the number
    /// of fixes dropped.
    fn order_fixes(&mut self, start_unix_s: f64) -> usize {
        let rows = self.fixes.len();
        self.fixes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        self.fixes
            .dedup_by(|later, kept| later.time_s <= kept.time_s);
        for fix in &mut self.fixes {
            fix.time_s -= start_unix_s;
        }
        rows - self.fixes.len()
    }

    /// The ship as a true obstacle. `to_local` converts degrees north and east to metres north and east of
    /// the mission's origin.
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
        TrackedShip::new(
            fixes.collect(),
            self.length_m.unwrap_or(assumed.length_m),
            self.draught_m.unwrap_or(assumed.draught_m),
            after_last_fix,
        )
    }
}

struct Columns {
    vessel: usize,
    time: usize,
    latitude: usize,
    longitude: usize,
    speed: Option<usize>,
    course: Option<usize>,
    heading: Option<usize>,
    vessel_type: Option<usize>,
    length: Option<usize>,
    width: Option<usize>,
    draught: Option<usize>,
}

impl Columns {
    fn of(header: &str) -> Result<Self, AisError> {
        let names: Vec<&str> = header.split(',').map(str::trim).collect();
        let find = |name: &str| names.iter().position(|n| n.eq_ignore_ascii_case(name));
        let need = |column: &'static str| find(column).ok_or(AisError::MissingColumn { column });
        Ok(Self {
            vessel: find("MMSI").map_or_else(|| need("vessel"), Ok)?,
            time: need("BaseDateTime")?,
            latitude: need("LAT")?,
            longitude: need("LON")?,
            speed: find("SOG"),
            course: find("COG"),
            heading: find("Heading"),
            vessel_type: find("VesselType"),
            length: find("Length"),
            width: find("Width"),
            draught: find("Draft"),
        })
    }
}

/// Parses a text of ship positions.
///
/// # Errors
/// A required column missing, a text larger than [`MAX_BYTES`], or no usable row. Single rows that
/// cannot be used are skipped and listed.
pub fn parse(text: &str) -> Result<AisTable, AisError> {
    if text.len() > MAX_BYTES {
        return Err(AisError::TooLarge { bytes: text.len() });
    }
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut lines = text.lines().enumerate();
    let columns = Columns::of(lines.next().map_or("", |(_, header)| header))?;
    let mut ships: BTreeMap<&str, AisShip> = BTreeMap::new();
    let mut skipped = Violations::new();
    for (index, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let fix = match fix_of(&cells, &columns) {
            Ok(fix) => fix,
            Err(message) => {
                skipped.push(format!("line {}", index + 1), message);
                continue;
            }
        };
        let vessel = cells[columns.vessel];
        let ship = ships.entry(vessel).or_insert_with(|| AisShip::new(vessel));
        let size = |column| number(&cells, column).filter(|x| *x > 0.0 && *x < 1000.0);
        ship.length_m = ship.length_m.or_else(|| size(columns.length));
        ship.width_m = ship.width_m.or_else(|| size(columns.width));
        ship.draught_m = ship.draught_m.or_else(|| size(columns.draught));
        ship.vessel_type = ship
            .vessel_type
            .or_else(|| cells.get(columns.vessel_type?)?.parse().ok());
        ship.fixes.push(fix);
    }
    let start_unix_s = ships
        .values()
        .flat_map(|ship| &ship.fixes)
        .map(|fix| fix.time_s)
        .fold(f64::INFINITY, f64::min);
    if !start_unix_s.is_finite() {
        return Err(AisError::NoFix { skipped });
    }
    let mut ships: Vec<AisShip> = ships.into_values().collect();
    let duplicates = ships
        .iter_mut()
        .map(|ship| ship.order_fixes(start_unix_s))
        .sum();
    Ok(AisTable {
        ships,
        start_unix_s,
        skipped,
        duplicates,
    })
}

fn number(cells: &[&str], column: Option<usize>) -> Option<f64> {
    let value: f64 = cells.get(column?)?.parse().ok()?;
    value.is_finite().then_some(value)
}

/// The fix of one row, with its time in seconds after 1970.
fn fix_of(cells: &[&str], columns: &Columns) -> Result<AisFix, String> {
    let cell = |column: usize| cells.get(column).copied().unwrap_or("");
    if cell(columns.vessel).is_empty() {
        return Err("names no vessel".into());
    }
    let time_s = unix_seconds(cell(columns.time)).ok_or_else(|| {
        format!(
            "has time \"{}\"; give YYYY-MM-DDThh:mm:ss",
            cell(columns.time)
        )
    })?;
    let degrees = |column: usize, name: &str, limit: f64| {
        number(cells, Some(column))
            .filter(|x| x.abs() <= limit)
            .ok_or_else(|| {
                format!(
                    "has {name} \"{}\"; give degrees within {limit}",
                    cell(column)
                )
            })
    };
    Ok(AisFix {
        time_s,
        latitude_deg: degrees(columns.latitude, "LAT", 90.0)?,
        longitude_deg: degrees(columns.longitude, "LON", 180.0)?,
        speed_mps: number(cells, columns.speed)
            .filter(|knots| (0.0..102.25).contains(knots))
            .map(|knots| knots * KNOT_MPS),
        course_rad: angle_rad(number(cells, columns.course)),
        heading_rad: angle_rad(number(cells, columns.heading)),
    })
}

fn angle_rad(degrees: Option<f64>) -> Option<f64> {
    degrees
        .filter(|x| (0.0..360.0).contains(x))
        .map(f64::to_radians)
}

/// Seconds after 1970 of `YYYY-MM-DDThh:mm:ss` (a blank for the T and a final Z are accepted).
fn unix_seconds(text: &str) -> Option<f64> {
    let text = text.strip_suffix('Z').unwrap_or(text);
    let (date, clock) = text.split_once(['T', ' '])?;
    let mut date = date.splitn(3, '-').map(|part| part.parse::<i64>().ok());
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    let mut clock = clock.splitn(3, ':');
    let hour: i64 = clock.next()?.parse().ok()?;
    let minute: i64 = clock.next()?.parse().ok()?;
    let second: f64 = clock.next()?.parse().ok()?;
    let valid = (1900..=2200).contains(&year)
        && (1..=12).contains(&month)
        && (1..=31).contains(&day)
        && (0..24).contains(&hour)
        && (0..60).contains(&minute)
        && (0.0..61.0).contains(&second);
    if !valid {
        return None;
    }
    // Days of the proleptic Gregorian calendar, years counted from March.
    let shifted = year - i64::from(month <= 2);
    let (era, of_era) = (shifted.div_euclid(400), shifted.rem_euclid(400));
    let of_year = (153 * (month + if month > 2 { -3 } else { 9 }) + 2) / 5 + day - 1;
    let days = era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468;
    Some((days * 86_400 + hour * 3600 + minute * 60) as f64 + second)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str =
        "vessel,BaseDateTime,LAT,LON,SOG,COG,Heading,VesselType,Length,Width,Draft";

    #[test]
    fn times_count_from_1970_across_leap_days() {
        assert_eq!(unix_seconds("1970-01-01T00:00:00"), Some(0.0));
        assert_eq!(unix_seconds("2000-03-01 00:00:00Z"), Some(951_868_800.0));
        assert_eq!(unix_seconds("2022-01-03T00:00:07"), Some(1_641_168_007.0));
        assert_eq!(unix_seconds("2022-13-03T00:00:07"), None);
        assert_eq!(unix_seconds("yesterday"), None);
        // Dates outside the calendar are refused before anything is computed from them.
        for date in [
            "2016-9223372036854775807-01",
            "2016-01-9223372036854775807",
            "9223372036854775807-01-01",
            "-9223372036854775808-01-01",
        ] {
            assert_eq!(unix_seconds(&format!("{date}T00:00:00")), None);
        }
        assert_eq!(unix_seconds("2016-01-01T9223372036854775807:00:00"), None);
    }

    #[test]
    fn codes_for_not_available_give_no_value() {
        let text = format!(
            "{HEADER}\n4,2022-01-03T00:18:15,49.2,-122.9,102.3,360.0,511,30,,6,0\n\
             4,2022-01-03T00:19:15,49.2,-122.9,10,90,270,30,21,6,3.2\n"
        );
        let table = parse(&text).unwrap();
        let ship = &table.ships[0];
        let (first, second) = (ship.fixes[0], ship.fixes[1]);
        assert_eq!(
            (first.speed_mps, first.course_rad, first.heading_rad),
            (None, None, None)
        );
        assert!((second.speed_mps.unwrap() - 5.1444).abs() < 1e-4);
        assert!((second.course_rad.unwrap() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!((ship.length_m, ship.draught_m), (Some(21.0), Some(3.2)));
    }

    #[test]
    fn rows_are_sorted_duplicates_dropped_and_bad_rows_named() {
        let text = format!(
            "\u{feff}{HEADER}\r\n1,2022-01-03T00:02:00,48.2,-123,0,0,0,,,,\r\n1,2022-01-03T00:00:00,48.0,-123,0,0,0,,,,\r\n\
             1,2022-01-03T00:00:00,48.9,-123,0,0,0,,,,\r\n1,2022-01-03T00:01:00,91,-123\r\n,,,\r\n\r\n1,2022-01-03\r\n"
        );
        let table = parse(&text).unwrap();
        let latitudes: Vec<f64> = table.ships[0]
            .fixes
            .iter()
            .map(|f| f.latitude_deg)
            .collect();
        assert_eq!(latitudes, [48.0, 48.2]);
        assert_eq!((table.duplicates, table.skipped.total()), (1, 3));
        assert!(table.skipped.list()[0].place.contains("line 5"));
    }

    #[test]
    fn a_text_without_tracks_is_an_error_that_says_why() {
        assert_eq!(
            parse("a,b\n").unwrap_err(),
            AisError::MissingColumn { column: "vessel" }
        );
        let message = parse(&format!("{HEADER}\n1,never,1,2\n"))
            .unwrap_err()
            .to_string();
        assert!(
            message.contains("line 2") && message.contains("never"),
            "{message}"
        );
    }

    #[test]
    #[expect(clippy::print_stderr, reason = "says why it was skipped")]
    fn the_salish_sea_file_is_read_completely() {
        let Ok(folder) = std::env::var("AUV_DATA_DIR") else {
            eprintln!("skipped: set AUV_DATA_DIR");
            return;
        };
        let text = std::fs::read_to_string(format!("{folder}/ocean/ais_salish_sea.csv")).unwrap();
        let table = parse(&text).unwrap();
        assert_eq!((table.ships.len(), table.skipped.total()), (66, 0));
        let fixes: usize = table.ships.iter().map(|ship| ship.fixes.len()).sum();
        assert_eq!(fixes + table.duplicates, text.lines().count() - 1);
        let local = |latitude: f64, longitude: f64| {
            (
                (latitude - 48.5) * 111_000.0,
                (longitude + 123.5) * 73_000.0,
            )
        };
        for ship in &table.ships {
            ship.tracked(&local, AssumedSize::default(), AfterLastFix::Repeat)
                .unwrap();
        }
    }
}
