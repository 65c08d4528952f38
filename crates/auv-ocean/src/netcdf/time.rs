//! CF time axes.

use super::source::{Found, NetcdfError};
use auv_types::days_since_1970;

/// Times of records, and what was assumed about them.
#[derive(Debug)]
pub(super) struct Times {
    /// Seconds since 1970-01-01 00:00 UTC; NaN where missing.
    pub(super) unix_s: Vec<f64>,
    /// Whether the units name no date: the times count from the run's own start.
    pub(super) undated: bool,
}

/// The times of a variable with units like `hours since 2016-02-01 12:00:00 +01:00`, in any calendar whose
/// dates exist.
pub(super) fn unix_seconds(found: &Found<'_>) -> Result<Times, NetcdfError> {
    let units = found.text("units").unwrap_or_default();
    let refused = || {
        found.error(format!(
            "has units `{units}`; give seconds, minutes, hours or days since YYYY-MM-DD hh:mm:ss, \
             for instance with `ncatted -a units,{},o,c,\"seconds since 2024-01-01\"`",
            found.name()
        ))
    };
    let (unit, epoch) = match units.split_once(" since ") {
        Some((unit, epoch)) => (unit, Some(epoch)),
        None => (units.as_str(), None),
    };
    let unit_s = seconds_of(unit).ok_or_else(refused)?;
    let values = found.values()?;
    let Some(epoch) = epoch else {
        let unix_s = values.iter().map(|x| x * unit_s).collect();
        return Ok(Times {
            unix_s,
            undated: true,
        });
    };
    let (date, clock_s) = parsed(epoch).ok_or_else(refused)?;
    let named = found.text("calendar").unwrap_or_else(|| "standard".into());
    let calendar = Calendar::named(&named).ok_or_else(|| {
        found.error(format!(
            "counts in calendar `{named}`; give one whose days exist: standard, proleptic_gregorian, julian, \
             noleap, all_leap or 360_day"
        ))
    })?;
    let first_day = calendar.day_of(date).ok_or_else(refused)?;
    let unix_s: Option<Vec<f64>> = values
        .iter()
        .map(|&x| calendar.unix_seconds(first_day, clock_s, x * unit_s))
        .collect();
    let unix_s = unix_s.ok_or_else(|| {
        found.error(format!(
            "has a day in calendar `{named}` that does not exist; give times in the standard calendar"
        ))
    })?;
    Ok(Times {
        unix_s,
        undated: false,
    })
}

fn seconds_of(unit: &str) -> Option<f64> {
    Some(match unit.trim().to_ascii_lowercase().as_str() {
        "s" | "sec" | "secs" | "second" | "seconds" => 1.0,
        "ms" | "msec" | "msecs" | "millisecond" | "milliseconds" => 1e-3,
        "min" | "mins" | "minute" | "minutes" => 60.0,
        "h" | "hr" | "hrs" | "hour" | "hours" => 3_600.0,
        "d" | "day" | "days" => 86_400.0,
        "week" | "weeks" => 604_800.0,
        _ => return None,
    })
}

/// Year, month and day, and the seconds after midnight UTC, of an epoch.
fn parsed(epoch: &str) -> Option<([i64; 3], f64)> {
    let epoch = epoch.trim();
    let (date, clock) = epoch.split_once([' ', 'T']).unwrap_or((epoch, ""));
    let (sign, date) = match date.strip_prefix('-') {
        Some(rest) => (-1, rest),
        None => (1, date),
    };
    let mut parts = date.splitn(3, '-').map(|part| part.parse::<i64>().ok());
    let date = [sign * parts.next()??, parts.next()??, parts.next()??];
    let mut clock = clock.trim().to_ascii_uppercase();
    for zone in ["UTC", "GMT", "Z"] {
        if let Some(rest) = clock.strip_suffix(zone) {
            clock = rest.trim_end().to_owned();
        }
    }
    let (clock, zone) = match clock.rfind([' ', '+', '-']) {
        Some(at) => clock.split_at(at),
        None => (clock.as_str(), ""),
    };
    let mut clock_s = -zone_s(zone.trim())?;
    for (i, part) in clock.trim().split(':').enumerate() {
        let weight = [3_600.0, 60.0, 1.0].get(i)?;
        if !part.is_empty() {
            let number: f64 = part.parse().ok()?;
            let most = if i == 0 { 24.0 } else { 60.999_999 };
            clock_s += Some(number).filter(|x| (0.0..=most).contains(x))? * weight;
        }
    }
    Some((date, clock_s))
}

/// How far a zone is ahead of UTC, seconds: `+1`, `-6:00`, `+0530`.
fn zone_s(zone: &str) -> Option<f64> {
    if zone.is_empty() {
        return Some(0.0);
    }
    let (sign, digits) = match zone.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, zone.strip_prefix('+').unwrap_or(zone)),
    };
    let (hours, minutes) = match digits.split_once(':') {
        Some(parts) => parts,
        None if digits.len() == 4 => digits.split_at_checked(2)?,
        None => (digits, "0"),
    };
    let (hours, minutes): (u8, u8) = (hours.parse().ok()?, minutes.parse().ok()?);
    let sound = hours <= 14 && minutes < 60;
    sound.then(|| sign * (f64::from(hours) * 3_600.0 + f64::from(minutes) * 60.0))
}

/// The calendars of the CF conventions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Calendar {
    /// Julian until 1582-10-04, Gregorian from 1582-10-15.
    Standard,
    Proleptic,
    Julian,
    /// All years have so many days in February, and no year is a leap year.
    Fixed {
        february: i64,
    },
    /// Twelve months of 30 days.
    Equal,
}

const CHANGE_DAY: i64 = -141_427;

impl Calendar {
    fn named(name: &str) -> Option<Self> {
        Some(match name.trim().to_ascii_lowercase().as_str() {
            "" | "standard" | "gregorian" => Self::Standard,
            "proleptic_gregorian" => Self::Proleptic,
            "julian" => Self::Julian,
            "noleap" | "365_day" => Self::Fixed { february: 28 },
            "all_leap" | "366_day" => Self::Fixed { february: 29 },
            "360_day" => Self::Equal,
            _ => return None,
        })
    }

    /// The number of a date in this calendar's own count of days; for those that are continuous with the
    /// Gregorian one, days since 1970.
    fn day_of(self, [year, month, day]: [i64; 3]) -> Option<i64> {
        if !(1..=12).contains(&month) || !(1..=31).contains(&day) || year.abs() > 9_999 {
            return None;
        }
        match self {
            Self::Proleptic => days_since_1970(year, month, day),
            Self::Julian => Some(julian_day(year, month, day)),
            Self::Standard if (year, month, day) < (1582, 10, 15) => {
                Some(julian_day(year, month, day))
            }
            Self::Standard => days_since_1970(year, month, day),
            Self::Fixed { february } => {
                let lengths = month_lengths(february);
                let before: i64 = lengths.iter().take(month as usize - 1).sum();
                let whole: i64 = lengths.iter().sum();
                let exists = day <= *lengths.get(month as usize - 1)?;
                exists.then_some(year * whole + before + day - 1)
            }
            Self::Equal => (day <= 30).then_some(year * 360 + (month - 1) * 30 + day - 1),
        }
    }

    /// Seconds since 1970 UTC of a time after midnight of a day; `None` on days that do not exist.
    fn unix_seconds(self, first_day: i64, clock_s: f64, after_s: f64) -> Option<f64> {
        if !after_s.is_finite() {
            return Some(f64::NAN);
        }
        match self {
            Self::Standard | Self::Proleptic | Self::Julian => {
                Some(first_day as f64 * 86_400.0 + clock_s + after_s)
            }
            Self::Fixed { .. } | Self::Equal => {
                let whole_s = clock_s + after_s;
                let days = (whole_s / 86_400.0).floor();
                let date = self.date_of(first_day.checked_add(days as i64)?)?;
                let day = days_since_1970(date[0], date[1], date[2])?;
                Some(day as f64 * 86_400.0 + (whole_s - days * 86_400.0))
            }
        }
    }

    /// The date of a day in a calendar of its own count.
    fn date_of(self, day: i64) -> Option<[i64; 3]> {
        let lengths = match self {
            Self::Fixed { february } => month_lengths(february),
            _ => [30; 12],
        };
        let whole: i64 = lengths.iter().sum();
        let mut rest = day.rem_euclid(whole);
        for (month, length) in (1_i64..).zip(lengths) {
            if rest < length {
                return Some([day.div_euclid(whole), month, rest + 1]);
            }
            rest -= length;
        }
        None
    }
}

fn month_lengths(february: i64) -> [i64; 12] {
    [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31]
}

/// Days since 1970-01-01 (Gregorian) of a date of the Julian calendar.
fn julian_day(year: i64, month: i64, day: i64) -> i64 {
    let shifted = year - i64::from(month <= 2);
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    // 1582-10-05 (Julian) is the day that the Gregorian calendar calls 1582-10-15.
    let count = |shifted: i64, of_year: i64| shifted * 365 + shifted.div_euclid(4) + of_year;
    count(shifted, of_year) - count(1582, 218) + CHANGE_DAY
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(units: &str, calendar: &str, value: f64) -> Option<f64> {
        let (unit, epoch) = units.split_once(" since ")?;
        let (date, clock_s) = parsed(epoch)?;
        let calendar = Calendar::named(calendar)?;
        calendar.unix_seconds(calendar.day_of(date)?, clock_s, value * seconds_of(unit)?)
    }

    #[test]
    fn epochs_zones_and_units_are_parsed() {
        for (units, expected) in [
            ("seconds since 1970-01-01 00:00:00", 0.0),
            ("hours since 2016-02-02T12:00:00Z", 1_454_414_400.0),
            ("days since 1858-11-17", -40_587.0 * 86_400.0),
            ("days since 2000-02-29", 951_782_400.0),
            ("seconds since 1968-05-23 00:00:00 GMT", -50_803_200.0),
            ("second since 1970-1-1 0:0:0.0", 0.0),
            ("hours since 1970-01-01 01:00:00 +01:00", 0.0),
            ("hours since 1970-01-01 01:00:00+01:00", 0.0),
            ("hours since 1969-12-31 18:00:00 -6", 0.0),
            ("hours since 1969-12-31 18:00:00 -6:00", 0.0),
            ("hours since 1970-01-01 05:30 +0530", 0.0),
            ("minutes since 1970-01-01 00:00:00 UTC", 0.0),
            ("d since 1970-01-01T00:00", 0.0),
        ] {
            assert_eq!(first(units, "standard", 0.0), Some(expected), "{units}");
        }
        for bad in [
            "",
            "parsecs since 1970-01-01",
            "days since yesterday",
            "days since 1970-13-01",
            "days since 1970-02-30",
            "months since 1970-01-01",
            "days since 1970-01-01 25:00",
            "days since 1970-01-01 00:00 +99",
        ] {
            assert_eq!(first(bad, "standard", 0.0), None, "{bad}");
        }
    }

    #[test]
    fn calendars_give_their_dates() {
        // The standard calendar is the Julian one before 1582-10-15: year 1 begins two days earlier.
        let proleptic = first("days since 0001-01-01", "proleptic_gregorian", 0.0).unwrap();
        let standard = first("days since 0001-01-01", "gregorian", 0.0).unwrap();
        assert_eq!(proleptic - standard, 2.0 * 86_400.0);
        assert_eq!(
            first("days since 1582-10-04", "standard", 1.0),
            first("days since 1582-10-15", "standard", 0.0)
        );
        // 60 days after 2000-01-01: 29 February exists, or not.
        let day = |y, m, d| Some(days_since_1970(y, m, d).unwrap() as f64 * 86_400.0);
        assert_eq!(
            first("days since 2000-01-01", "standard", 60.0),
            day(2000, 3, 1)
        );
        assert_eq!(
            first("days since 2000-01-01", "noleap", 59.0),
            day(2000, 3, 1)
        );
        assert_eq!(
            first("days since 2001-01-01", "all_leap", 60.0),
            day(2001, 3, 1)
        );
        assert_eq!(first("days since 2001-01-01", "360_day", 59.25), None);
        assert_eq!(
            first("days since 2001-01-01", "360_day", 89.5),
            day(2001, 3, 30).map(|s| s + 43_200.0)
        );
        assert_eq!(first("days since 2000-01-01", "mayan", 0.0), None);
    }
}
