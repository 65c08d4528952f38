//! Times of ship positions.

use super::error::AisError;
use auv_types::days_since_1970;

/// Seconds after 1970-01-01 00:00 UTC of `YYYY-MM-DDThh:mm:ss` or `dd/mm/yyyy hh:mm:ss`, with a final Z or
/// an offset like `+02:00` where given, or of a plain number of such seconds. Dates with slashes have the
/// day first, as the Danish authority writes them.
pub(super) fn unix_seconds(text: &str) -> Option<f64> {
    let Some((date, clock)) = text.split_once(['T', ' ']) else {
        // Times before 1973 are numbers of something else.
        return text.parse().ok().filter(|s| (1e8..1e10).contains(s));
    };
    let days = match date.contains('/') {
        true => days_of(date.rsplitn(3, '/'))?,
        false => days_of(date.splitn(3, '-'))?,
    };
    let (clock, offset_s) = without_offset(clock.trim())?;
    let mut clock = clock.splitn(3, ':');
    let hour: i64 = clock.next()?.parse().ok()?;
    let minute: i64 = clock.next()?.parse().ok()?;
    // Spreadsheets leave the seconds out.
    let second: f64 = clock.next().map_or(Ok(0.0), str::parse).ok()?;
    let valid =
        (0..24).contains(&hour) && (0..60).contains(&minute) && (0.0..61.0).contains(&second);
    let whole_s = days * 86_400 + hour.min(24) * 3600 + minute.min(60) * 60 - offset_s;
    valid.then_some(whole_s as f64 + second)
}

/// What the dates with slashes of a text say of their order.
#[derive(Debug, Default)]
pub(super) struct Slashes {
    any: bool,
    /// Whether a date has a day in the first place that is no month.
    day_first: bool,
    /// Line and text of the first time with a day in the second place that is no month.
    month_first: Option<(usize, String)>,
}

impl Slashes {
    pub(super) fn see(&mut self, time: &str, line: impl FnOnce() -> usize) {
        let mut parts = time.splitn(3, '/').map(|part| part.trim().parse::<u8>());
        let (Some(Ok(first)), Some(Ok(second))) = (parts.next(), parts.next()) else {
            return;
        };
        self.any = true;
        self.day_first |= first > 12;
        if first <= 12 && (13..=31).contains(&second) && self.month_first.is_none() {
            self.month_first = Some((line(), time.to_owned()));
        }
    }

    /// What is assumed of the order of days and months.
    ///
    /// # Errors
    /// Days in the second place.
    pub(super) fn told(self) -> Result<Option<String>, AisError> {
        match self.month_first {
            Some((line, time)) if !self.day_first => Err(AisError::MonthFirst { line, time }),
            _ => Ok((self.any && !self.day_first)
                .then(|| "dates with slashes are taken with the day first".into())),
        }
    }
}

/// Days since 1970 of year, month and day.
fn days_of<'a>(mut parts: impl Iterator<Item = &'a str>) -> Option<i64> {
    let mut part = || parts.next()?.trim().parse::<i64>().ok();
    let (year, month, day) = (part()?, part()?, part()?);
    days_since_1970(year, month, day).filter(|_| (1900..=2200).contains(&year))
}

/// The clock, and how many seconds its zone is ahead of UTC.
fn without_offset(clock: &str) -> Option<(&str, i64)> {
    let clock = clock
        .trim_end_matches("UTC")
        .trim_end_matches(['Z', 'z', ' ']);
    let Some(at) = clock.rfind(['+', '-']) else {
        return Some((clock, 0));
    };
    let (clock, zone) = clock.split_at(at);
    let sign = if zone.starts_with('-') { -1 } else { 1 };
    let zone = &zone[1..];
    let (hours, minutes) = match zone.split_once(':') {
        Some(parts) => parts,
        None if zone.len() == 4 => zone.split_at_checked(2)?,
        None => (zone, "0"),
    };
    let (hours, minutes): (u8, u8) = (hours.parse().ok()?, minutes.parse().ok()?);
    let sound = hours <= 14 && minutes < 60;
    sound.then(|| {
        let offset_s = sign * (i64::from(hours) * 3600 + i64::from(minutes) * 60);
        (clock.trim_end(), offset_s)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn days_come_first_before_slashes_and_zones_are_taken_off() {
        let noon = unix_seconds("2024-05-31T12:00:00");
        for same in [
            "31/05/2024 12:00:00",
            "2024-05-31T14:00:00+02:00",
            "2024-05-31 07:30:00-0430",
            "2024-05-31T12:00:00.0Z",
            "2024-05-31 12:00:00 UTC",
            "1717156800",
        ] {
            assert_eq!(unix_seconds(same), noon, "{same}");
        }
        for bad in [
            "05/31/2024 12:00:00",
            "2023-02-29T12:00:00",
            "2024-05-31T12:00:00+99",
            "17",
        ] {
            assert_eq!(unix_seconds(bad), None, "{bad}");
        }
    }
}
