//! CF time axes.

use super::NetcdfError;
use super::source::Found;

/// Seconds since 1970-01-01 00:00 UTC of a time variable, from units like `hours since 2016-02-01 12:00:00`.
pub(super) fn unix_seconds(found: &Found<'_>) -> Result<Vec<f64>, NetcdfError> {
    let units = found.text("units").unwrap_or_default();
    let (unit_s, epoch_s) = parse(&units).ok_or_else(|| {
        found.error(format!(
            "has units `{units}`; give seconds, minutes, hours or days since YYYY-MM-DD hh:mm:ss"
        ))
    })?;
    let calendar = found.text("calendar").unwrap_or("standard".into());
    if !["standard", "gregorian", "proleptic_gregorian"].contains(&calendar.as_str()) {
        return Err(found.error(format!(
            "counts in calendar `{calendar}`; give the gregorian one"
        )));
    }
    let values = found.values()?;
    Ok(values.iter().map(|x| epoch_s + x * unit_s).collect())
}

fn parse(units: &str) -> Option<(f64, f64)> {
    let (unit, epoch) = units.split_once(" since ")?;
    let unit_s = match unit.trim().trim_end_matches('s') {
        "second" | "sec" => 1.0,
        "minute" | "min" => 60.0,
        "hour" | "hr" | "h" => 3_600.0,
        "day" | "d" => 86_400.0,
        _ => return None,
    };
    let epoch = epoch.trim().trim_end_matches("UTC").trim_end_matches('Z');
    let (date, clock) = epoch.split_once([' ', 'T']).unwrap_or((epoch, ""));
    let mut date = date.split('-').map(|part| part.parse::<i64>().ok());
    let (year, month, day) = (date.next()??, date.next()??, date.next()??);
    if !(-9_999..=9_999).contains(&year) || !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    let mut clock_s = 0.0;
    for (part, weight) in clock.trim().split(':').zip([3_600.0, 60.0, 1.0]) {
        if !part.is_empty() {
            clock_s += part
                .parse::<f64>()
                .ok()
                .filter(|x| (0.0..61.0).contains(x))?
                * weight;
        }
    }
    Some((
        unit_s,
        days_since_1970(year, month, day) as f64 * 86_400.0 + clock_s,
    ))
}

/// Days since 1970-01-01 in the proleptic Gregorian calendar. Years are counted from March so that leap
/// days come last.
fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    let year = year - i64::from(month <= 2);
    let era = year.div_euclid(400);
    let of_era = year.rem_euclid(400);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn epochs_are_parsed() {
        assert_eq!(parse("seconds since 1970-01-01 00:00:00"), Some((1.0, 0.0)));
        assert_eq!(
            parse("hours since 2016-02-02T12:00:00Z"),
            Some((3_600.0, 1_454_414_400.0))
        );
        assert_eq!(
            parse("days since 1858-11-17"),
            Some((86_400.0, -40_587.0 * 86_400.0))
        );
        assert_eq!(
            parse("days since 2000-02-29"),
            Some((86_400.0, 951_782_400.0))
        );
        for bad in [
            "",
            "parsecs since 1970-01-01",
            "days since yesterday",
            "days since 1970-13-01",
        ] {
            assert_eq!(parse(bad), None, "{bad}");
        }
    }
}
