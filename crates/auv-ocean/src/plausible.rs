//! Values that no sea has.

/// Deepest sounding there is, metres, rounded up.
pub(crate) const DEEPEST_M: f64 = 11_100.0;
/// Highest land there is, metres, rounded up.
const HIGHEST_M: f64 = 9_000.0;
/// Fastest current believed, m/s.
#[cfg(any(feature = "netcdf", test))]
pub(crate) const FASTEST_MPS: f64 = 20.0;
/// Numbers that stand for "missing" where no attribute says so.
const SENTINELS: [f64; 5] = [9_999.0, 99_999.0, 999_999.0, 32_767.0, 32_768.0];
/// So many different implausible values are no fill values but another unit.
const MOST_FILLS: usize = 3;

/// Implausible values below so many times the greatest plausible one go on where these end: another unit.
const TIMES_GREATEST: f64 = 2.0;

/// What was found among some values.
#[derive(Debug, PartialEq)]
pub(crate) enum Implausible {
    /// Nothing.
    None,
    /// So many values were taken as missing; one of them.
    Filled(usize, f64),
    /// Too many different ones: another unit. One of them.
    AnotherUnit(f64),
}

/// Depths (positive down, metres) that no sea has become missing. A file's own unit has `unit_m` metres.
pub(crate) fn mask_depths(depths_m: &mut [f64], unit_m: f64) -> Implausible {
    // Of the file's own unit, or of metres that became another unit with it.
    let is_sentinel = |x: f64| {
        let (metres, stored) = (x.abs(), x.abs() / unit_m);
        let mut sentinels = SENTINELS.iter();
        sentinels.any(|s| (stored - s).abs() < 1e-6 || (metres - s).abs() < 1e-6)
    };
    let deepest_m = depths_m
        .iter()
        .copied()
        .filter(|&x| x <= DEEPEST_M && !is_sentinel(x))
        .fold(0.0, f64::max);
    // A trench may be 9,999 m deep, where there are others like it.
    let is_fill = |x: f64| {
        (x.is_finite() && !(-HIGHEST_M..=DEEPEST_M).contains(&x))
            || (is_sentinel(x) && deepest_m < 0.9 * x.abs())
    };
    mask(depths_m, is_fill, is_sentinel)
}

/// Components of velocities (m/s) that no current has become missing.
#[cfg(any(feature = "netcdf", test))]
pub(crate) fn mask_velocities(values_mps: &mut [f64]) -> Implausible {
    mask(values_mps, |x| x.abs() > FASTEST_MPS, |_| false)
}

fn mask(
    values: &mut [f64],
    is_fill: impl Fn(f64) -> bool,
    is_sentinel: impl Fn(f64) -> bool,
) -> Implausible {
    let (mut kinds, mut count, mut sound) = (Vec::new(), 0, 0_usize);
    let (mut least_fill, mut greatest) = (f64::INFINITY, 0.0);
    for &value in values.iter() {
        if is_fill(value) {
            count += 1;
            if !is_sentinel(value) {
                least_fill = f64::min(least_fill, value.abs());
            }
            if kinds.len() <= MOST_FILLS && !kinds.contains(&value) {
                kinds.push(value);
            }
        } else if value.is_finite() {
            sound += 1;
            greatest = f64::max(greatest, value.abs());
        }
    }
    let Some(&one) = kinds.first() else {
        return Implausible::None;
    };
    // Fill values lie far from all others.
    let go_on = least_fill < TIMES_GREATEST * greatest;
    if (kinds.len() > MOST_FILLS || go_on) && count * 100 > sound {
        return Implausible::AnotherUnit(one);
    }
    for value in values.iter_mut() {
        if is_fill(*value) {
            *value = f64::NAN;
        }
    }
    Implausible::Filled(count, one)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fills_are_masked_and_another_unit_is_told_from_them() {
        let mut depths = vec![10.0, 32_767.0, 20.0, -9_999.0, 32_767.0];
        assert_eq!(
            mask_depths(&mut depths, 1.0),
            Implausible::Filled(3, 32_767.0)
        );
        assert!(depths[1].is_nan() && depths[3].is_nan() && depths[0] == 10.0);
        // Feet: the sentinel is 9,987 m deep.
        let mut feet = [131.0, 32_767.0, 99_999.0].map(|x| x * 0.3048);
        let found = mask_depths(&mut feet, 0.3048);
        assert!(matches!(found, Implausible::Filled(2, _)), "{found:?}");
        let mut ocean = vec![8_000.0, 9_999.0, 7_000.0];
        assert_eq!(
            mask_depths(&mut ocean, 1.0),
            Implausible::Filled(1, 9_999.0)
        );
        let mut trench = vec![9_990.0, 9_999.0, 10_003.0];
        assert_eq!(mask_depths(&mut trench, 1.0), Implausible::None);
        let mut millimetres: Vec<f64> = (0..50).map(|i| 10_000.0 + 333.0 * f64::from(i)).collect();
        assert_eq!(
            mask_depths(&mut millimetres, 1.0),
            Implausible::AnotherUnit(11_332.0)
        );
        let mut speeds = vec![0.1, -999.0, 0.2];
        assert_eq!(mask_velocities(&mut speeds), Implausible::Filled(1, -999.0));
        // Centimetres a second called metres, of few different values.
        let mut centimetres = vec![30.0, 24.0, 18.0, 18.0];
        assert_eq!(
            mask_velocities(&mut centimetres),
            Implausible::AnotherUnit(30.0)
        );
    }
}
