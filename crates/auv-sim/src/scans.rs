//! How often the sonar scans.

/// Longest time between two scans, seconds. Over a longer one an echo of an unknown contact is expected so
/// far away that false echoes pass for it, and form tracks.
const LONGEST_S: f64 = 10.0;
/// Scans in a tick that is shorter than twice [`LONGEST_S`], at most: the synchroniser decides no more often.
const MOST: f64 = 2.0;

/// Time between two scans of a sonar with a period, seconds: a tick, or an even part of one.
pub(crate) fn scan_s(tick_s: f64, period_s: f64) -> f64 {
    let wanted_s = period_s.max(tick_s / MOST).min(LONGEST_S);
    tick_s / (tick_s / wanted_s).ceil().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sonar_scans_at_each_tick_and_in_between() {
        // Tick, period of the sonar, time between two scans.
        for (tick_s, period_s, each_s) in [
            (1.0, 0.5, 0.5),
            (1.0, 0.1, 0.5),
            (1.0, 2.0, 1.0),
            (0.2, 0.5, 0.2),
            (10.0, 10.0, 10.0),
            (20.0, 0.5, 10.0),
            (600.0, 0.5, 10.0),
        ] {
            assert_eq!(scan_s(tick_s, period_s), each_s, "{tick_s} s, {period_s} s");
        }
    }
}
