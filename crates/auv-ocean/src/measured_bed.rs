//! A charted bed, raised where soundings found it shallower.

use crate::SeaBed;
use crate::footprint::{length, share_at, steepest_share};

/// A place where the bed was measured shallower than the chart allows for.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Shoal {
    /// Metres north.
    pub north_m: f64,
    /// Metres east.
    pub east_m: f64,
    /// How much the bed is raised there, metres.
    pub raised_m: f64,
    /// How far the bed is raised by the whole of it, metres. It is raised by less from there on, and by nothing
    /// at twice this distance.
    pub reach_m: f64,
}

impl Shoal {
    /// How much the bed is raised at a place, metres.
    #[must_use]
    pub fn raised_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.raised_m * share_at(self.away_m(north_m, east_m) - self.reach_m, self.reach_m)
    }

    /// Horizontal distance of a place, metres.
    #[must_use]
    pub fn away_m(&self, north_m: f64, east_m: f64) -> f64 {
        length([north_m - self.north_m, east_m - self.east_m])
    }

    /// The steepest change of [`Shoal::raised_at`] within a distance of a place.
    fn slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let skirt_m = self.away_m(north_m, east_m) - self.reach_m;
        self.raised_m * steepest_share(skirt_m - radius_m, skirt_m + radius_m, self.reach_m)
    }
}

/// A charted bed that is raised by shoals. Where several reach, the one that raises it most counts: a bed as
/// measured is never deeper than charted.
///
/// ```
/// use auv_ocean::{FlatBed, MeasuredBed, SeaBed, Shoal};
///
/// let shoal = Shoal { north_m: 100.0, east_m: 0.0, raised_m: 4.0, reach_m: 50.0 };
/// let bed = MeasuredBed::new(FlatBed::new(30.0), vec![shoal]);
/// assert_eq!(bed.depth_at(140.0, 0.0), 26.0);
/// assert_eq!(bed.depth_at(175.0, 0.0), 28.0);
/// assert_eq!(bed.depth_at(200.0, 0.0), 30.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredBed<B> {
    charted: B,
    shoals: Vec<Shoal>,
}

impl<B: SeaBed> MeasuredBed<B> {
    /// A charted bed, raised by shoals.
    #[must_use]
    pub const fn new(charted: B, shoals: Vec<Shoal>) -> Self {
        Self { charted, shoals }
    }

    fn raised_at(&self, north_m: f64, east_m: f64) -> f64 {
        raised_at(&self.shoals, north_m, east_m)
    }
}

/// How much shoals raise the bed at a place, metres.
#[must_use]
pub fn raised_at(shoals: &[Shoal], north_m: f64, east_m: f64) -> f64 {
    let raised = shoals.iter().map(|shoal| shoal.raised_at(north_m, east_m));
    raised.fold(0.0, f64::max)
}

impl<B: SeaBed> SeaBed for MeasuredBed<B> {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.charted.depth_at(north_m, east_m) - self.raised_at(north_m, east_m)
    }

    fn depths_at(&self, north_m: &[f64], east_m: &[f64], depths_m: &mut [f64]) {
        self.charted.depths_at(north_m, east_m, depths_m);
        for ((depth_m, &north_m), &east_m) in depths_m.iter_mut().zip(north_m).zip(east_m) {
            *depth_m -= self.raised_at(north_m, east_m);
        }
    }

    /// That of the chart, and the steepest of the shoals near there.
    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let shoals = self.shoals.iter();
        let slopes = shoals.map(|shoal| shoal.slope_near(north_m, east_m, radius_m));
        let charted = self.charted.max_slope_near(north_m, east_m, radius_m);
        charted + slopes.fold(0.0, f64::max)
    }

    fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
        self.charted.depth_sigma_m(north_m, east_m)
    }

    fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
        let (charted_m, sigma_m) = self.charted.sounding_m(north_m, east_m);
        (charted_m - self.raised_at(north_m, east_m), sigma_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnalyticBed, BedFeature, Footprint};
    use auv_types::rand::RngExt;
    use auv_types::{Seed, libm};

    #[test]
    fn the_slope_bound_holds_and_no_place_is_deeper_than_charted() {
        let bank = Footprint::Disc {
            centre: [300.0, 0.0],
            radius_m: 50.0,
        };
        let chart = AnalyticBed::new(60.0).with(BedFeature::new("bank", bank, 25.0, 120.0));
        let mut random = Seed(2).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let shoals = (0..20).map(|_| Shoal {
            north_m: draw(-400.0, 400.0),
            east_m: draw(-400.0, 400.0),
            raised_m: draw(0.0, 9.0),
            reach_m: draw(10.0, 150.0),
        });
        let bed = MeasuredBed::new(chart.clone(), shoals.collect());
        let mut raised = 0;
        for _ in 0..2_000 {
            let (n, e, radius_m) = (draw(-500.0, 500.0), draw(-500.0, 500.0), draw(0.5, 50.0));
            let angle = draw(0.0, 6.3);
            let (far_n, far_e) = (
                n + radius_m * libm::cos(angle),
                e + radius_m * libm::sin(angle),
            );
            let step_m = (bed.depth_at(far_n, far_e) - bed.depth_at(n, e)).abs();
            let bound = bed.max_slope_near(n, e, radius_m);
            assert!(
                step_m <= bound * radius_m + 1e-9,
                "{step_m} over {radius_m}"
            );
            let mut depth_m = [0.0];
            bed.depths_at(&[n], &[e], &mut depth_m);
            assert_eq!(depth_m[0], bed.depth_at(n, e));
            let charted_m = chart.depth_at(n, e);
            assert!(depth_m[0] <= charted_m);
            raised += usize::from(depth_m[0] < charted_m);
        }
        assert!((200..2_000).contains(&raised), "{raised}");
    }
}
