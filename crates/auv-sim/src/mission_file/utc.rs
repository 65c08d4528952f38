//! Times in UTC become mission seconds where the file says when mission time 0 is.

use super::MissionFileError;
use jiff::Timestamp;
use toml::Value;

/// The keys that hold times; `*` stands for any name or any entry of a list.
const TIMES: [&str; 9] = [
    "tasks.*.windows.*.*",
    "surveys.*.windows.*.*",
    "keep_out.*.from",
    "keep_out.*.until",
    "keep_in.*.from",
    "keep_in.*.until",
    "water_level.tide.*.highest",
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
        MissionFileError::Syntax(format!("launch is no time in UTC; write it as {EXAMPLE}"))
    })
}

/// Replaces every time in UTC by mission seconds. Returns whether there was one.
pub(super) fn in_seconds(
    file: &mut toml::Table,
    launch_s: Option<f64>,
) -> Result<bool, MissionFileError> {
    let mut file_value = Value::Table(std::mem::take(file));
    let mut found = false;
    for path in TIMES {
        let keys: Vec<&str> = path.split('.').collect();
        found |= replaced(&mut file_value, &keys, "", launch_s)?;
    }
    if let Value::Table(table) = file_value {
        *file = table;
    }
    Ok(found)
}

fn replaced(
    value: &mut Value,
    keys: &[&str],
    place: &str,
    launch_s: Option<f64>,
) -> Result<bool, MissionFileError> {
    let Some((first, rest)) = keys.split_first() else {
        let Some(text) = text_of(value) else {
            return Ok(false);
        };
        let wrong = |message: String| MissionFileError::Syntax(format!("{place} {message}"));
        let Some(at_s) = unix_s(&text) else {
            return Err(wrong(format!(
                "is no time in UTC; write it as {EXAMPLE}, or give seconds from the launch"
            )));
        };
        let Some(launch_s) = launch_s else {
            return Err(wrong(format!(
                "is given in UTC; say when the mission begins, with launch = {EXAMPLE}"
            )));
        };
        *value = Value::Float(at_s - launch_s);
        return Ok(true);
    };
    let mut found = false;
    match value {
        Value::Array(list) => {
            let only: Option<usize> = first.parse().ok();
            for (i, entry) in list.iter_mut().enumerate() {
                if only.is_none_or(|only| only == i) {
                    found |= replaced(entry, rest, &format!("{place}[{i}]"), launch_s)?;
                }
            }
        }
        Value::Table(table) => {
            for (name, entry) in table.iter_mut() {
                if *first == "*" || *first == name {
                    let dot = if place.is_empty() { "" } else { "." };
                    found |= replaced(entry, rest, &format!("{place}{dot}{name}"), launch_s)?;
                }
            }
        }
        _ => {}
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<toml::Table, String> {
        let mut table: toml::Table = text.parse().unwrap();
        let launch_s = launch_unix_s(&table).map_err(|error| error.to_string())?;
        in_seconds(&mut table, launch_s).map_err(|error| error.to_string())?;
        Ok(table)
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
            wrong.contains("keep_out[0].until is no time in UTC"),
            "{wrong}"
        );
        assert!(refused("launch = 5").contains("launch is no time in UTC"));
        assert!(refused("launch = 2026-06-01").contains("launch is no time in UTC"));
    }
}
