//! Times in UTC become mission seconds where the file says when mission time 0 is.

use super::MissionFileError;
use jiff::Timestamp;
use std::fmt::Write;
use std::ops::Range;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Value};

/// The keys that hold times; `*` stands for any name or any entry of a list.
const TIMES: [&str; 10] = [
    "tasks.*.windows.*.*",
    "surveys.*.windows.*.*",
    "keep_out.*.from",
    "keep_out.*.until",
    "keep_in.*.from",
    "keep_in.*.until",
    "water_level.tide.*.highest",
    "current.analytic.tide.*.strongest",
    "current.analytic.tide.*.strongest_s",
    "ships.*.timetable.*.0",
];
/// How a time is written.
const EXAMPLE: &str = "\"2026-06-01T08:30:00Z\"";

/// Seconds since 1970 of a time in UTC.
pub(super) fn unix_s(text: &str) -> Option<f64> {
    let time: Timestamp = text.trim().parse().ok()?;
    Some(time.as_millisecond() as f64 / 1_000.0)
}

/// The text of a time; `None` for seconds.
fn text_of(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Datetime(time) => Some(time.to_string()),
        _ => None,
    }
}

/// When the mission is launched, seconds since 1970 UTC; `None` if the file does not say.
pub(super) fn launch_unix_s(file: &toml::Table) -> Result<Option<f64>, MissionFileError> {
    let Some(launch) = file.get("launch") else {
        return Ok(None);
    };
    let seconds = text_of(launch).and_then(|text| unix_s(&text));
    seconds.map(Some).ok_or_else(|| {
        MissionFileError::Syntax(format!(
            "launch is not a time in UTC; write it as {EXAMPLE}"
        ))
    })
}

/// The text of a file with every time in UTC replaced by mission seconds, as many characters long: what else is
/// wrong keeps its line and column. `None` where there is no such time.
pub(super) fn in_seconds(
    text: &str,
    launch_s: Option<f64>,
) -> Result<Option<String>, MissionFileError> {
    // Text that is not TOML is told where it is read.
    let Ok(table) = DeTable::parse(text) else {
        return Ok(None);
    };
    let mut found = Vec::new();
    for path in TIMES {
        let keys: Vec<&str> = path.split('.').collect();
        in_table(table.get_ref(), &keys, "", &mut found);
    }
    if found.is_empty() {
        return Ok(None);
    }
    found.sort_by_key(|time: &Found| time.span.start);
    let mut seconds = String::with_capacity(text.len());
    let mut taken = 0;
    for time in found {
        let wrong = |message: String| {
            let line = 1 + text[..time.span.start].matches('\n').count();
            MissionFileError::Syntax(format!("line {line}: {} {message}", time.place))
        };
        let at_s = unix_s(&time.text).ok_or_else(|| {
            wrong(format!(
                "is not a time in UTC; write it as {EXAMPLE}, or give seconds from the launch"
            ))
        })?;
        let launch_s = launch_s.ok_or_else(|| {
            wrong(format!(
                "is given in UTC; say when the mission begins, with launch = {EXAMPLE}"
            ))
        })?;
        let _ = write!(
            seconds,
            "{}{:<width$?}",
            &text[taken..time.span.start],
            at_s - launch_s,
            width = time.span.len()
        );
        taken = time.span.end;
    }
    seconds.push_str(&text[taken..]);
    Ok(Some(seconds))
}

/// A time in UTC in a file.
struct Found {
    place: String,
    text: String,
    span: Range<usize>,
}

fn in_table(table: &DeTable<'_>, keys: &[&str], place: &str, found: &mut Vec<Found>) {
    let Some((first, rest)) = keys.split_first() else {
        return;
    };
    for (name, value) in table {
        let name = name.get_ref();
        if *first == "*" || *first == name {
            let dot = if place.is_empty() { "" } else { "." };
            in_value(value, rest, &format!("{place}{dot}{name}"), found);
        }
    }
}

fn in_value(value: &Spanned<DeValue<'_>>, keys: &[&str], place: &str, found: &mut Vec<Found>) {
    match (value.get_ref(), keys.split_first()) {
        (DeValue::String(text), None) => found.push(Found {
            place: place.into(),
            text: text.to_string(),
            span: value.span(),
        }),
        (DeValue::Datetime(time), None) => found.push(Found {
            place: place.into(),
            text: time.to_string(),
            span: value.span(),
        }),
        (DeValue::Array(list), Some((first, rest))) => {
            let only: Option<usize> = first.parse().ok();
            let wanted = list
                .iter()
                .enumerate()
                .filter(|(i, _)| only.is_none_or(|only| only == *i));
            for (i, entry) in wanted {
                in_value(entry, rest, &format!("{place}[{i}]"), found);
            }
        }
        (DeValue::Table(table), Some(_)) => in_table(table, keys, place, found),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<toml::Table, String> {
        let table: toml::Table = text.parse().unwrap();
        let launch_s = launch_unix_s(&table).map_err(|error| error.to_string())?;
        let seconds = in_seconds(text, launch_s).map_err(|error| error.to_string())?;
        let seconds = seconds.unwrap_or_else(|| text.into());
        assert_eq!(seconds.len(), text.len());
        Ok(seconds.parse().unwrap())
    }

    #[test]
    fn times_in_utc_count_from_the_launch() {
        let text = "launch = \"2026-06-01T08:00:00Z\"\nname = \"2026-06-01T08:00:00Z\"\n\
                    [[keep_out]]\nfrom = \"2026-06-01T09:30:00.5Z\"\nuntil = 7000\n\
                    [[keep_out]]\nfrom = 2026-06-01T10:00:00+02:00\n\
                    [[ships]]\ntimetable = [[\"2026-06-01T07:59:00Z\", 1, 2], [60, 3, 4]]\n\
                    [current.analytic]\ntide = [{ strongest_s = \"2026-06-01T08:01:00Z\" }]";
        let table = read(text).unwrap();
        assert_eq!(table["keep_out"][0]["from"].as_float(), Some(5_400.5));
        assert_eq!(table["keep_out"][0]["until"].as_integer(), Some(7_000));
        assert_eq!(table["keep_out"][1]["from"].as_float(), Some(0.0));
        assert_eq!(table["ships"][0]["timetable"][0][0].as_float(), Some(-60.0));
        assert!(table["name"].is_str());
        let tide = &table["current"]["analytic"]["tide"][0];
        assert_eq!(tide["strongest_s"].as_float(), Some(60.0));
    }

    #[test]
    fn what_is_no_time_is_named() {
        let refused = |text: &str| read(text).unwrap_err();
        let late = refused("[[keep_out]]\nuntil = \"2026-06-01T08:00:00Z\"");
        assert!(
            late.contains("keep_out[0].until is given in UTC; say when"),
            "{late}"
        );
        let launch = "launch = \"2026-06-01T08:00:00Z\"\n";
        let wrong = refused(&format!("{launch}[[keep_out]]\nuntil = \"noon\""));
        assert!(
            wrong.contains("keep_out[0].until is not a time in UTC"),
            "{wrong}"
        );
        assert!(refused("launch = 5").contains("launch is not a time in UTC"));
        assert!(refused("launch = 2026-06-01").contains("launch is not a time in UTC"));
    }
}
