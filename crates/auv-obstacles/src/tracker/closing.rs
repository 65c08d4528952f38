//! Contacts that close in before they are confirmed, and those that there is time to see better.

use super::motion::Motion;
use super::settings::TrackerSettings;
use super::spans;
use super::track::{Motility, Standing, Track};
use crate::{Region, Scan};
use auv_types::{Point3, Vector3, libm};

/// Echoes that a contact which closes in has at least.
const LEAST_HITS: u32 = 3;
/// At the last moment the vehicle passes a contact by this much more than its radius, metres.
const PASSED_BY_M: f64 = 5.0;
/// Standard deviations within which a contact may hit the vehicle.
const SIGMAS: f64 = 2.0;
/// How long a contact that closes in is predicted without being confirmed, seconds.
const PREDICTED_S: f64 = 30.0;

/// The sonar's own motion.
pub(super) struct Own {
    place: Point3<f64>,
    velocity: Vector3<f64>,
    /// Time since the last scan, seconds.
    since_s: f64,
}

impl Own {
    pub(super) fn of(scan: &Scan, last: Option<&Scan>) -> Self {
        let since_s = last.map_or(0.0, |last| scan.time_s - last.time_s);
        let velocity = match last {
            Some(last) if since_s > 0.0 => (scan.from - last.from) / since_s,
            _ => Vector3::zeros(),
        };
        Self {
            place: scan.from,
            velocity,
            since_s,
        }
    }
}

/// Notes whether a track that is not confirmed closes in so fast that the vehicle cannot wait for the echoes
/// that would confirm it, if it is as fast as its echoes allow, and whether one that is confirmed can be seen better first.
pub(super) fn note(track: &mut Track, own: &Own, settings: &TrackerSettings) {
    if track.is_confirmed() {
        track.standing = if is_to_be_seen_better(track, own, settings) {
            Standing::Young
        } else {
            Standing::Confirmed
        };
        return;
    }
    let closes_in = |motion: &Motion| {
        spare_s((track, motion), own, &LEAST, settings).is_some_and(|spare_s| spare_s <= 0.0)
    };
    let fast_closes_in = track.if_fast().is_some_and(closes_in);
    let counts = track.hits(u32::BITS) >= LEAST_HITS
        && (track.is_true(settings) && closes_in(&track.motion)
            || track.is_true_if_fast(settings) && fast_closes_in);
    track.standing = match track.standing {
        _ if counts => Standing::ClosingIn,
        // It was believed, and is not forgotten while the vehicle turns away from it.
        Standing::ClosingIn if track.is_likely() => Standing::Confirmed,
        _ => Standing::Tentative,
    };
}

/// What the vehicle needs to get out of a contact's way.
struct Margin {
    /// By how much more than the contact's radius it passes, metres.
    passed_by_m: f64,
    /// How many times as long as its hardest turn it takes.
    turns: f64,
}

/// At the last moment.
const LEAST: Margin = Margin {
    passed_by_m: PASSED_BY_M,
    turns: 1.0,
};
/// With room to spare.
const EASY: Margin = Margin {
    passed_by_m: 25.0,
    turns: 1.5,
};
/// Standard deviations per axis with which the velocity of a contact at rest, and of one that moves, is known well enough
/// for the prediction not to cover the sea for minutes, m/s.
const REST_KNOWN_MPS: f64 = 0.05;
const MOTION_KNOWN_MPS: f64 = 0.15;
/// How far ahead a young contact is predicted, seconds: by then it is seen better. It is expected there until then.
const YOUNG_S: f64 = 5.0;
/// Less time is not worth the wait, seconds.
const LEAST_SPARE_S: f64 = 2.0;

/// Whether more echoes of a confirmed contact are to be had before it matters: its velocity is hardly known, and the
/// vehicle has time to get out of its way after them.
pub(super) fn is_to_be_seen_better(track: &Track, own: &Own, settings: &TrackerSettings) -> bool {
    let (_, _, [_, _, vv]) = track.state(settings);
    let young = settings.rest_hypothesis
        && match track.decided(settings) {
            Some(Motility::Rests) => vv > REST_KNOWN_MPS * REST_KNOWN_MPS,
            Some(Motility::Moves) => vv > MOTION_KNOWN_MPS * MOTION_KNOWN_MPS,
            None => true,
        };
    let has_time = |motion: &Motion| {
        spare_s((track, motion), own, &EASY, settings).is_none_or(|spare_s| spare_s > LEAST_SPARE_S)
    };
    young && has_time(&track.motion) && track.if_fast().is_none_or(has_time)
}

/// How long the vehicle may wait, and then turn, and be out of the track's way, seconds; at least one scan more
/// than that is left. `None` if the track is not likely to hit it.
fn spare_s(
    (track, motion): (&Track, &Motion),
    own: &Own,
    margin: &Margin,
    settings: &TrackerSettings,
) -> Option<f64> {
    let offset = motion.position - own.place;
    let towards = motion.velocity - own.velocity;
    let radius_m = track.radius_m();
    let gap_m = (offset.norm() - radius_m).max(0.0);
    let closing_mps = -offset.dot(&towards) / offset.norm().max(1e-9);
    if closing_mps <= 0.0 {
        return None;
    }
    let met_s = gap_m / closing_mps;
    let Motion { pp, pv, vv, .. } = *motion;
    let sigma_m = libm::sqrt((pp + met_s * (2.0 * pv + met_s * vv)).max(0.0));
    let nearest_m = (offset + towards * met_s).norm() - radius_m;
    if nearest_m > margin.passed_by_m + SIGMAS * sigma_m {
        return None;
    }
    let out_s = libm::sqrt(2.0 * (radius_m + margin.passed_by_m) / settings.evasion_mps2);
    let missing = settings
        .confirm_hits
        .saturating_sub(track.hits(settings.confirm_window));
    Some(met_s - margin.turns * out_s - f64::from(missing + 1) * own.since_s)
}

/// The region of a young contact: wherever it may be until it is seen better. It is expected there from then on.
pub(super) fn young_region_into(
    track: &Track,
    time_s: f64,
    settings: &TrackerSettings,
    regions: &mut Vec<Region>,
) {
    let soon = TrackerSettings {
        horizon_s: settings.horizon_s.min(YOUNG_S),
        max_spans: 1,
        ..settings.clone()
    };
    let first = regions.len();
    spans::regions_into(&track.likelier(), time_s, &soon, regions);
    regions.truncate(first + 1);
    if let Some(region) = regions.last_mut() {
        let moved_m = region.velocity_mps.norm() * soon.horizon_s;
        region.radius_m = region.radius_at(region.until_s) + moved_m;
        region.growth_mps = 0.0;
        region.velocity_mps = Vector3::zeros();
        region.until_s = match track.decided(settings) {
            Some(Motility::Rests) => f64::INFINITY,
            _ => time_s + settings.horizon_s,
        };
    }
}

/// The settings of the prediction of a contact that is not confirmed: it does not last.
pub(super) fn short_lived(settings: &TrackerSettings) -> TrackerSettings {
    TrackerSettings {
        horizon_s: settings.horizon_s.min(PREDICTED_S),
        rest_hypothesis: false,
        ..settings.clone()
    }
}
