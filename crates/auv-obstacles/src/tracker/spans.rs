//! Spans: consecutive regions that bound a track's growing uncertainty.

use super::settings::{MAX_SPANS, TrackerSettings};
use super::size::RadiusBound;
use super::track::Track;
use crate::{Region, RegionShape};
use auv_types::{Point3, Vector3, libm};

/// Adds the regions that bound a track from `time_s` on until the horizon.
///
/// The bounds of position and radius are convex in time, so a chord bounds them from above. (They are
/// norms of affine functions and of powers above 1; jitter alone is concave and counts with its value at
/// the end of a span.) The cap of the radius is concave: a span ends where it is reached.
pub(super) fn regions_into(
    track: &Track,
    time_s: f64,
    settings: &TrackerSettings,
    regions: &mut Vec<Region>,
) {
    let bound = Bound::new(track, time_s, settings);
    let horizon_s = settings.horizon_s;
    let mut cuts = [0.0; MAX_SPANS + 3];
    let mut count = 1;
    if bound.capped_from_s > 1e-3 && bound.capped_from_s < horizon_s - 1e-3 {
        cuts[count] = bound.capped_from_s;
        count += 1;
    }
    cuts[count] = horizon_s;
    count += 1;
    while count <= settings.max_spans {
        let (mut worst, mut span) = (settings.span_tolerance_m, 0);
        for i in 1..count {
            let excess_m = bound.excess_m(cuts[i - 1], cuts[i]);
            if excess_m > worst {
                (worst, span) = (excess_m, i);
            }
        }
        if span == 0 {
            break;
        }
        cuts.copy_within(span..count, span + 1);
        cuts[span] = split(cuts[span - 1], cuts[span + 1]);
        count += 1;
    }
    regions.extend((1..count).map(|i| bound.region(cuts[i - 1], cuts[i])));
    if let (true, Some(last)) = (bound.rests, regions.last().copied()) {
        regions.push(Region {
            radius_m: last.radius_at(last.until_s),
            growth_mps: 0.0,
            at_s: last.until_s,
            from_s: last.until_s,
            until_s: f64::INFINITY,
            ..last
        });
    }
}

/// Where a span is split, as a share of its duration: early, where the bound curves most.
const CUT: f64 = 0.3;

fn split(from_s: f64, until_s: f64) -> f64 {
    from_s + CUT * (until_s - from_s)
}

/// The bound of a track as a function of the time after `time_s`.
struct Bound<'a> {
    track: &'a Track,
    settings: &'a TrackerSettings,
    time_s: f64,
    position: Point3<f64>,
    velocity: Vector3<f64>,
    radius: RadiusBound,
    /// Time from which the radius equals its cap.
    capped_from_s: f64,
    /// Whether the track is at rest. Its last region then lasts beyond the horizon.
    rests: bool,
    /// Time from the track's state to `time_s`.
    elapsed_s: f64,
    /// Coefficients of the position's variance, a cubic in time.
    variance: [f64; 4],
}

impl<'a> Bound<'a> {
    fn new(track: &'a Track, time_s: f64, settings: &'a TrackerSettings) -> Self {
        let (position, velocity, [pp, pv, vv]) = track.state(settings);
        let rests = track.is_at_rest(settings);
        let noise = if rests {
            0.0
        } else {
            settings.acceleration_density()
        };
        let mut bound = Self {
            track,
            settings,
            time_s,
            position,
            velocity,
            radius: track.size.bound(rests, settings),
            rests,
            capped_from_s: f64::INFINITY,
            elapsed_s: (time_s - track.time_s).max(0.0),
            variance: [pp, 2.0 * pv, vv, noise / 3.0],
        };
        bound.capped_from_s = bound.cap_s();
        bound
    }

    /// The last time found at which the radius is below its cap; 0 if it never is, `+inf` if it always is.
    fn cap_s(&self) -> f64 {
        let below =
            |ahead_s: f64| self.radius.at(self.elapsed_s + ahead_s) < self.settings.max_radius_m;
        let (mut low, mut high) = (0.0, self.settings.horizon_s);
        if below(high) {
            return f64::INFINITY;
        }
        for _ in 0..12 {
            let middle = 0.5 * (low + high);
            if below(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// The sum of radius bound and position bound at `ahead_s` within the span `[from_s, until_s]`.
    fn total_m(&self, ahead_s: f64, from_s: f64, until_s: f64) -> f64 {
        let t = self.elapsed_s + ahead_s;
        let capped = from_s >= self.capped_from_s;
        let radius_m = if capped {
            self.settings.max_radius_m
        } else {
            self.radius.at(t)
        };
        let [a, b, c, d] = self.variance;
        let jitter = self.settings.jitter_m2ps * (self.elapsed_s + until_s);
        let variance = a + t * (b + t * (c + t * d)) + jitter;
        radius_m + self.settings.position_sigmas * libm::sqrt(variance.max(0.0))
    }

    /// How far a span's chord exceeds the bound where the span would be split, metres.
    fn excess_m(&self, from_s: f64, until_s: f64) -> f64 {
        let start_m = self.total_m(from_s, from_s, until_s);
        let end_m = self.total_m(until_s, from_s, until_s);
        let cut_s = split(from_s, until_s);
        start_m + CUT * (end_m - start_m) - self.total_m(cut_s, from_s, cut_s)
    }

    fn region(&self, from_s: f64, until_s: f64) -> Region {
        let start_m = self.total_m(from_s, from_s, until_s);
        let end_m = self.total_m(until_s, from_s, until_s);
        let at_s = self.time_s + from_s;
        let everywhere = RegionShape::Cylinder {
            top_m: f64::NEG_INFINITY,
            bottom_m: f64::INFINITY,
        };
        Region {
            obstacle: self.track.id,
            shape: if self.settings.columns {
                everywhere
            } else {
                RegionShape::Ball
            },
            at_s,
            from_s: at_s,
            until_s: self.time_s + until_s,
            centre: self.position + self.velocity * (at_s - self.track.time_s),
            velocity_mps: self.velocity,
            radius_m: start_m,
            growth_mps: (end_m - start_m) / (until_s - from_s),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tracker::part::Seen;
    use crate::{Detection, ObstacleId};

    #[test]
    fn the_spans_cover_the_bound_at_every_time() {
        for settings in [
            TrackerSettings::paper(),
            TrackerSettings::campaign(),
            TrackerSettings::default(),
        ] {
            let mut echo = Detection {
                position: Point3::new(100.0, 0.0, 0.0),
                velocity: None,
                radius_m: 40.0,
                position_sigma_m: 5.0,
                velocity_sigma_mps: 0.0,
                radius_sigma_m: 5.0,
            };
            let mut track = Track::new(ObstacleId(7), 0.0, (&echo, Seen::Whole), &settings);
            for k in 1..25 {
                echo.radius_m += 2.0;
                track.predict(f64::from(k) * 10.0, &settings);
                track.update(&echo, &settings);
                let time_s = track.time_s + 5.0;
                let mut regions = Vec::new();
                regions_into(&track, time_s, &settings, &mut regions);
                assert!((1..=settings.max_spans + 2).contains(&regions.len()));
                let (_, _, [pp, pv, vv]) = track.state(&settings);
                let noise = if track.is_at_rest(&settings) {
                    0.0
                } else {
                    settings.acceleration_density()
                };
                for instant in 0..=720 {
                    let ahead_s = settings.horizon_s * f64::from(instant) / 720.0;
                    let t = ahead_s + 5.0;
                    let variance = pp
                        + 2.0 * pv * t
                        + vv * t * t
                        + noise * t * t * t / 3.0
                        + settings.jitter_m2ps * t;
                    let needed_m = track
                        .size
                        .bound(track.is_at_rest(&settings), &settings)
                        .at(t)
                        .min(settings.max_radius_m)
                        + settings.position_sigmas * variance.sqrt();
                    let at_s = time_s + ahead_s;
                    let there = regions.iter().find(|r| r.exists_at(at_s)).unwrap();
                    let given_m = there.radius_at(at_s);
                    assert!(
                        given_m >= needed_m - 1e-6,
                        "{given_m} for {needed_m} at {ahead_s} s"
                    );
                }
            }
        }
    }
}
