//! Where a ship lies that reports that it lies still: the noise of its fixes is no motion.

use super::fix::{AisFix, MetresOf};
use super::motion::reports_rest;
use crate::truth::ShipFix;
use auv_types::libm;

/// Fixes of a ship at rest differ by so much from its place, metres. A ship that swings at anchor goes
/// farther, and its positions count as reported.
const NOISE_M: f64 = 25.0;

/// The fixes in metres. Those of a run in which the ship reports rest, all of them near the run's median, are
/// the run's first and last at that median.
pub(super) fn settled(fixes: &[AisFix], metres: &MetresOf<'_>) -> Vec<ShipFix> {
    let mut settled = Vec::with_capacity(fixes.len());
    for run in fixes.chunk_by(|a, b| reports_rest(a) && reports_rest(b)) {
        let mut places = as_reported(run, metres);
        let (north_m, east_m) = (
            median(places.iter().map(|place| place.north_m)),
            median(places.iter().map(|place| place.east_m)),
        );
        let near = |p: &ShipFix| libm::hypot(p.north_m - north_m, p.east_m - east_m) <= NOISE_M;
        if places.len() > 1 && places.iter().all(near) {
            places.drain(1..places.len() - 1);
            for place in &mut places {
                (place.north_m, place.east_m) = (north_m, east_m);
            }
        }
        settled.append(&mut places);
    }
    settled
}

/// The fixes in metres.
pub(super) fn as_reported(fixes: &[AisFix], metres: &MetresOf<'_>) -> Vec<ShipFix> {
    let places = fixes.iter().map(|fix| {
        let (north_m, east_m) = metres(fix.latitude_deg, fix.longitude_deg);
        ShipFix {
            time_s: fix.time_s,
            north_m,
            east_m,
        }
    });
    places.collect()
}

/// The middle value, of an even number the lower one.
fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let middle = values.len().saturating_sub(1) / 2;
    values.get(middle).copied().unwrap_or(f64::NAN)
}
