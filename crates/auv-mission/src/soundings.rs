//! Soundings: where the bed was measured shallower than plans over the chart allow for.

use crate::Mission;
use auv_ocean::{MeasuredBed, SeaBed, ShallowestNear, Shoal, raised_at};
use auv_planning::motion::Floor;
use auv_types::Point3;
use std::sync::Arc;

/// Soundings are weighed in shares of `off_track_m`, which follows the size of the vehicle.
///
/// A sounding is news where plans would come nearer than this to the least altitude over the bed as measured.
const LEAST_LEFT: f64 = 0.2;
/// Plans over news keep this above the least altitude, so that the same place is no news again.
const SPARE: f64 = 0.3;
/// Errors of an altitude are no news.
const NOISE: f64 = 0.03;
/// How far a sounding raises the bed around it by the whole, until another one says otherwise.
const REACH: f64 = 15.0;
/// Shoals reach no less far.
const LEAST_REACH: f64 = 2.0;
/// Shoals remembered at most.
const MOST: usize = 64;
/// Distances beyond this are as good as it, metres: a saved state holds finite numbers.
const FAR_M: f64 = 1e6;

/// Where the bed was measured shallower than plans over the chart allow for.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Soundings {
    /// The [`missing_m`] of the sounding before.
    before_m: Option<f64>,
    pub(crate) shoals: Vec<Shoal>,
    /// The bed counts as shallow as it is anywhere within this distance, because the vehicle's place is not known
    /// better, metres.
    #[cfg_attr(feature = "serde", serde(default))]
    within_m: f64,
}

/// Steps of the distance within which the bed counts, metres.
const WITHIN_STEP_M: f64 = 5.0;

impl Soundings {
    /// Takes in the altitude measured at a place. Returns whether plans must change.
    ///
    /// Two soundings in a row must agree, so that a single wrong echo is no news: the one that found more water
    /// raises the bed, the one that found less bounds how far it is raised.
    pub(crate) fn take(
        &mut self,
        launched: &Mission,
        off_track_m: f64,
        place: &Point3<f64>,
        altitude_m: f64,
    ) -> bool {
        let Some(missing_m) = self.missing_m(launched, place, altitude_m) else {
            return false;
        };
        let before_m = self.before_m.replace(missing_m);
        let Some(before_m) = before_m else {
            return false;
        };
        let least_m = margin_m(launched, place) - NOISE * off_track_m;
        let least_m = least_m.min(LEAST_LEFT * off_track_m);
        if -missing_m.max(before_m) >= least_m {
            return self.bound_reach(place, off_track_m);
        }
        let agreed_m = missing_m.min(before_m);
        let news = raised_at(&self.shoals, place.x, place.y) - agreed_m < least_m;
        if news {
            self.raise(place, off_track_m, agreed_m + SPARE * off_track_m);
        }
        news
    }

    /// Sets the distance within which the bed counts, rounded up. Returns whether that changes.
    pub(crate) fn look_within(&mut self, within_m: f64) -> bool {
        let within_m = (within_m / WITHIN_STEP_M).ceil() * WITHIN_STEP_M;
        let changes = within_m.total_cmp(&self.within_m).is_ne();
        self.within_m = within_m;
        changes
    }

    /// Whether plans are made over the bed as charted.
    pub(crate) fn is_charted(&self) -> bool {
        self.shoals.is_empty() && self.within_m <= 0.0
    }

    /// The charted bed for a vehicle that does not know its place exactly.
    fn charted(&self, launched: &Mission) -> Option<Arc<dyn SeaBed>> {
        let bed = launched.sea_bed.as_ref().map(Arc::clone)?;
        Some(if self.within_m > 0.0 {
            Arc::new(ShallowestNear::new(bed, self.within_m))
        } else {
            bed
        })
    }

    /// How much less water was measured than plans over the chart allow for, metres; negative where they leave
    /// more than the least altitude. `None` without a bed.
    fn missing_m(&self, launched: &Mission, place: &Point3<f64>, altitude_m: f64) -> Option<f64> {
        let floor = Floor {
            bed: &*self.charted(launched)?,
            min_altitude_m: launched.min_altitude_m,
            altitude_sigmas: launched.altitude_sigmas,
        };
        let planned_m = floor.deepest_at(place.x, place.y);
        let allowed_m = place.z + altitude_m - launched.min_altitude_m;
        Some((planned_m - allowed_m).clamp(-FAR_M, FAR_M))
    }

    /// Raises the bed around a place by this much more than charted, metres.
    fn raise(&mut self, place: &Point3<f64>, off_track_m: f64, raised_m: f64) {
        let near = |shoal: &&mut Shoal| shoal.away_m(place.x, place.y) < 0.5 * shoal.reach_m;
        if let Some(shoal) = self.shoals.iter_mut().find(near) {
            shoal.raised_m = shoal.raised_m.max(raised_m);
            return;
        }
        if self.shoals.len() >= MOST {
            self.shoals.remove(0);
        }
        self.shoals.push(Shoal {
            north_m: place.x,
            east_m: place.y,
            raised_m,
            reach_m: REACH * off_track_m,
        });
    }

    /// Where the bed is measured as deep as charted, shoals measured elsewhere do not reach. Returns whether
    /// one reached there before.
    fn bound_reach(&mut self, place: &Point3<f64>, off_track_m: f64) -> bool {
        let mut bounded = false;
        for shoal in &mut self.shoals {
            let reach_m = (0.5 * shoal.away_m(place.x, place.y)).max(LEAST_REACH * off_track_m);
            if reach_m < shoal.reach_m {
                shoal.reach_m = reach_m;
                bounded = true;
            }
        }
        bounded
    }

    /// The mission over the bed as measured.
    pub(crate) fn over(&self, launched: &Arc<Mission>) -> Arc<Mission> {
        match self.charted(launched) {
            Some(bed) if !self.is_charted() => {
                let bed = MeasuredBed::new(bed, self.shoals.clone());
                let mut mission = (**launched).clone();
                mission.sea_bed = Some(Arc::new(bed));
                Arc::new(mission)
            }
            _ => Arc::clone(launched),
        }
    }

    /// Whether all numbers fulfil a condition, and shoals are no more than there can be.
    #[cfg(feature = "serde")]
    pub(crate) fn are_sound(&self, is_plausible: impl Fn(&f64) -> bool) -> bool {
        let sound = |shoal: &Shoal| {
            let numbers = [shoal.north_m, shoal.east_m, shoal.raised_m, shoal.reach_m];
            numbers.iter().all(&is_plausible) && shoal.raised_m >= 0.0 && shoal.reach_m > 0.0
        };
        self.before_m.iter().all(&is_plausible)
            && is_plausible(&self.within_m)
            && self.shoals.len() <= MOST
            && self.shoals.iter().all(sound)
    }
}

/// What plans over the chart leave for its errors, metres.
fn margin_m(launched: &Mission, place: &Point3<f64>) -> f64 {
    let bed = launched.sea_bed.as_deref();
    let sigma_m = bed.map_or(0.0, |bed| bed.depth_sigma_m(place.x, place.y));
    launched.altitude_sigmas * sigma_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    /// Plans may go to 33 m over a bed charted at 40 m: 5 m of altitude, 2 m for the chart's errors.
    fn launched() -> Arc<Mission> {
        let mut mission = Fixture::new().mission;
        mission.sea_bed = Some(Arc::new(auv_ocean::AnalyticBed::new(40.0)));
        mission.min_altitude_m = 5.0;
        mission.altitude_sigmas = 1.0;
        Arc::new(mission)
    }

    fn at(x: f64) -> Point3<f64> {
        Point3::new(x, 0.0, 20.0)
    }

    fn told(soundings: &mut Soundings, x: f64, bed_m: f64) -> bool {
        soundings.take(&launched(), 10.0, &at(x), bed_m - 20.0)
    }

    #[test]
    fn two_soundings_in_a_row_raise_the_bed_ahead_and_are_no_news_again() {
        let mut soundings = Soundings::default();
        assert!(!told(&mut soundings, 0.0, 36.0), "one sounding");
        assert!(!told(&mut soundings, 2.0, 40.0), "a wrong echo");
        assert!(!told(&mut soundings, 4.0, 36.0), "again one");
        assert!(told(&mut soundings, 6.0, 36.5));
        let deepest_m = |x: f64| soundings.over(&launched()).deepest_at(x, 0.0);
        // 36.5 m of water, 5 m of altitude, 3 m to spare.
        assert!((deepest_m(6.0) - 28.5).abs() < 1e-9);
        assert!((deepest_m(156.0) - 28.5).abs() < 1e-9);
        assert_eq!(deepest_m(400.0), 33.0);
        for x in 7..150 {
            assert!(!told(&mut soundings, f64::from(x), 36.0), "{x}");
        }
        assert!(!told(&mut soundings, 150.0, f64::INFINITY));
    }

    #[test]
    fn deep_water_bounds_how_far_a_shoal_reaches() {
        let mut soundings = Soundings::default();
        told(&mut soundings, 0.0, 30.0);
        assert!(told(&mut soundings, 1.0, 30.0));
        assert!(!told(&mut soundings, 61.0, 40.0));
        assert!(told(&mut soundings, 61.0, 42.0), "the second of two");
        let known = soundings.over(&launched());
        assert_eq!(known.deepest_at(61.0, 0.0), 33.0);
        assert!(known.deepest_at(1.0, 0.0) < 25.0);
        for _ in 0..9 {
            told(&mut soundings, 1.0, 42.0);
        }
        let known = soundings.over(&launched());
        assert!(known.deepest_at(1.0, 0.0) < 25.0, "a shoal stays");
    }

    #[test]
    fn the_bed_as_charted_is_no_news_whatever_the_margin() {
        for sigmas in [0.0, 0.3, 1.0, 2.0] {
            let mut mission = (*launched()).clone();
            mission.altitude_sigmas = sigmas;
            let mut soundings = Soundings::default();
            for k in 0..40 {
                let noise_m = if k % 3 == 0 { 0.25 } else { -0.25 };
                let altitude_m = 20.0 + noise_m;
                assert!(!soundings.take(&mission, 10.0, &at(f64::from(k)), altitude_m));
            }
        }
    }
}
