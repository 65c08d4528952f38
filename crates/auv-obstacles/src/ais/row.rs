//! What one row of a table of ship positions says.

use super::clock::unix_seconds;
use super::columns::Columns;
use super::fix::{AisFix, KNOT_MPS, NavStatus};
use csv::StringRecord;

/// What one row tells of a ship.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub(super) fix: AisFix,
    pub(super) length_m: Option<f64>,
    pub(super) width_m: Option<f64>,
    pub(super) draught_m: Option<f64>,
    pub(super) vessel_type: Option<u32>,
}

fn number(record: &StringRecord, column: Option<usize>) -> Option<f64> {
    let value: f64 = record.get(column?)?.parse().ok()?;
    value.is_finite().then_some(value)
}

/// The vessel and the contents of one row, with its time in seconds after 1970.
pub(super) fn row_of<'a>(
    record: &'a StringRecord,
    columns: &Columns,
) -> Result<(&'a str, Row), String> {
    let cell = |column: usize| record.get(column).unwrap_or("");
    let vessel = cell(columns.vessel);
    if vessel.is_empty() {
        return Err("names no vessel".into());
    }
    let time_s = unix_seconds(columns.time_of(record)).ok_or_else(|| {
        format!(
            "has time \"{}\"; give YYYY-MM-DDThh:mm:ss, or dd/mm/yyyy hh:mm:ss",
            columns.time_of(record)
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
    let text = text.to_ascii_lowercase();
    match text.parse().unwrap_or(-1.0) {
        1.0 => NavStatus::Anchored,
        5.0 => NavStatus::Moored,
        6.0 => NavStatus::Aground,
        _ if text.contains("anchor") => NavStatus::Anchored,
        _ if text.contains("moored") => NavStatus::Moored,
        _ if text.contains("aground") => NavStatus::Aground,
        _ => NavStatus::Free,
    }
}

fn angle_rad(degrees: Option<f64>) -> Option<f64> {
    degrees
        .filter(|x| (0.0..360.0).contains(x))
        .map(f64::to_radians)
}
