//! Straight pieces that bound a track's growing uncertainty.

use super::settings::TrackerSettings;
use super::track::Track;
use crate::{Region, Shape};
use auv_types::libm;

/// Adds the regions that bound a track from `time_s` on over the horizon.
///
/// Position bound and radius bound are convex in time (norms of affine functions and of powers
/// above 1; jitter, which alone is concave, counts at its value at the end of a piece), so that a
/// chord bounds them from above. The cap of the radius is concave: a piece ends there.
pub(super) fn regions_into(
    track: &Track,
    time_s: f64,
    settings: &TrackerSettings,
    regions: &mut Vec<Region>,
) {
    let bound = Bound::new(track, time_s, settings);
    let mut cuts = [0.0; 18];
    let mut count = 2;
    cuts[1] = settings.horizon_s;
    if let Some(cap_s) = bound.cap_s() {
        (cuts[1], cuts[2], count) = (cap_s, settings.horizon_s, 3);
    }
    while count <= settings.max_spans {
        let (mut worst, mut piece) = (settings.span_tolerance_m, 0);
        for i in 0..count - 1 {
            let excess_m = bound.excess_m(cuts[i], cuts[i + 1]);
            if excess_m > worst {
                (worst, piece) = (excess_m, i + 1);
            }
        }
        if piece == 0 {
            break;
        }
        cuts.copy_within(piece..count, piece + 1);
        cuts[piece] = split(cuts[piece - 1], cuts[piece + 1]);
        count += 1;
    }
    for i in 0..count - 1 {
        regions.push(bound.region(cuts[i], cuts[i + 1]));
    }
}

/// Where a piece is cut: early, since the bound bends most at its begin.
fn split(from_s: f64, until_s: f64) -> f64 {
    from_s + 0.3 * (until_s - from_s)
}

struct Bound<'a> {
    track: &'a Track,
    settings: &'a TrackerSettings,
    time_s: f64,
    /// From the track's state to `time_s`.
    elapsed_s: f64,
    covariance: [f64; 3],
    at_rest: bool,
}

impl<'a> Bound<'a> {
    fn new(track: &'a Track, time_s: f64, settings: &'a TrackerSettings) -> Self {
        Self {
            track,
            settings,
            time_s,
            elapsed_s: (time_s - track.time_s).max(0.0),
            covariance: track.state(settings).2,
            at_rest: track.is_at_rest(settings),
        }
    }

    fn radius_m(&self, ahead_s: f64) -> f64 {
        self.track
            .size
            .bound_m(self.elapsed_s + ahead_s, self.settings)
            .min(self.settings.max_radius_m)
    }

    /// Radius and position bound at `ahead_s`, with the jitter of `until_s`.
    fn total_m(&self, ahead_s: f64, until_s: f64) -> f64 {
        let [pp, pv, vv] = self.covariance;
        let t = self.elapsed_s + ahead_s;
        let noise = if self.at_rest {
            0.0
        } else {
            self.settings.acceleration_density()
        };
        let variance = pp
            + 2.0 * pv * t
            + vv * t * t
            + noise * t * t * t / 3.0
            + self.settings.jitter_m2ps * (self.elapsed_s + until_s);
        self.radius_m(ahead_s) + self.settings.position_sigmas * libm::sqrt(variance.max(0.0))
    }

    fn excess_m(&self, from_s: f64, until_s: f64) -> f64 {
        let (begin_m, end_m) = (
            self.total_m(from_s, until_s),
            self.total_m(until_s, until_s),
        );
        let cut_s = split(from_s, until_s);
        begin_m + 0.3 * (end_m - begin_m) - self.total_m(cut_s, cut_s)
    }

    /// When the radius reaches its cap, if within the horizon.
    fn cap_s(&self) -> Option<f64> {
        let cap_m = self.settings.max_radius_m;
        let uncapped = |ahead_s: f64| {
            self.track
                .size
                .bound_m(self.elapsed_s + ahead_s, self.settings)
        };
        let (mut low, mut high) = (0.0, self.settings.horizon_s);
        if uncapped(low) >= cap_m || uncapped(high) <= cap_m {
            return None;
        }
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            if uncapped(middle) < cap_m {
                low = middle;
            } else {
                high = middle;
            }
        }
        (high - 0.0 > 1e-3 && self.settings.horizon_s - high > 1e-3).then_some(high)
    }

    fn region(&self, from_s: f64, until_s: f64) -> Region {
        let (position, velocity, _) = self.track.state(self.settings);
        let (begin_m, end_m) = (
            self.total_m(from_s, until_s),
            self.total_m(until_s, until_s),
        );
        let at_s = self.time_s + from_s;
        Region {
            obstacle: self.track.id,
            shape: if self.settings.columns {
                Shape::Cylinder {
                    top_m: f64::NEG_INFINITY,
                    bottom_m: f64::INFINITY,
                }
            } else {
                Shape::Ball
            },
            at_s,
            from_s: at_s,
            until_s: self.time_s + until_s,
            centre: position + velocity * (at_s - self.track.time_s),
            velocity_mps: velocity,
            radius_m: begin_m,
            growth_mps: (end_m - begin_m) / (until_s - from_s),
        }
    }
}
