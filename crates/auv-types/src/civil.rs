//! Dates of the proleptic Gregorian calendar.

/// Days from 1970-01-01 to a date; `None` if there is no such date, or its year is beyond 9999.
///
/// ```
/// use auv_types::days_since_1970;
///
/// assert_eq!(days_since_1970(2000, 3, 1), Some(11_017));
/// assert_eq!(days_since_1970(2023, 2, 29), None);
/// ```
#[must_use]
pub fn days_since_1970(year: i64, month: i64, day: i64) -> Option<i64> {
    if !(-9_999..=9_999).contains(&year) || !(1..=12).contains(&month) {
        return None;
    }
    let leap = year.rem_euclid(4) == 0 && (year.rem_euclid(100) != 0 || year.rem_euclid(400) == 0);
    let length = match month {
        2 => 28 + i64::from(leap),
        4 | 6 | 9 | 11 => 30,
        _ => 31,
    };
    if !(1..=length).contains(&day) {
        return None;
    }
    // Years are counted from March, so that leap days come last.
    let shifted = year - i64::from(month <= 2);
    let (era, of_era) = (shifted.div_euclid(400), shifted.rem_euclid(400));
    let of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    Some(era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_day_of_eight_centuries_follows_the_day_before() {
        let mut before = days_since_1970(1599, 12, 31).unwrap();
        for year in 1600..2400 {
            for month in 1..=12 {
                for day in 1..=31 {
                    if let Some(days) = days_since_1970(year, month, day) {
                        assert_eq!(days, before + 1);
                        before = days;
                    }
                }
            }
        }
        assert_eq!(days_since_1970(1970, 1, 1), Some(0));
        assert_eq!(days_since_1970(1858, 11, 17), Some(-40_587));
    }

    #[test]
    fn dates_that_do_not_exist_are_none() {
        for (year, month, day) in [
            (2023, 2, 29),
            (1900, 2, 29),
            (2024, 4, 31),
            (2024, 13, 1),
            (2024, 0, 1),
            (2024, 1, 0),
            (i64::MAX, 1, 1),
            (2024, i64::MIN, 1),
            (2024, 1, i64::MAX),
        ] {
            assert_eq!(days_since_1970(year, month, day), None);
        }
    }
}
