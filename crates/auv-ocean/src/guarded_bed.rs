//! A sea bed for a vehicle that is not exactly where it is meant to be.

use crate::SeaBed;

/// Places on the circle round a position at which the bed is sampled, as unit vectors north and east.
const AROUND: [[f64; 2]; 8] = {
    let diagonal = std::f64::consts::FRAC_1_SQRT_2;
    [
        [1.0, 0.0],
        [diagonal, diagonal],
        [0.0, 1.0],
        [-diagonal, diagonal],
        [-1.0, 0.0],
        [-diagonal, -diagonal],
        [0.0, -1.0],
        [diagonal, -diagonal],
    ]
};

/// The shallowest depth of a bed at a position and at eight places round it, less a vertical margin.
///
/// What keeps an altitude above it keeps that altitude above the bed also when it is off its place by as
/// much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuardedBed<B> {
    bed: B,
    radius_m: f64,
    above_m: f64,
}

impl<B: SeaBed> GuardedBed<B> {
    /// A bed for a vehicle that may be off by `radius_m` horizontally and `below_m` downwards. Negative values
    /// count as 0.
    pub fn new(bed: B, radius_m: f64, below_m: f64) -> Self {
        Self {
            bed,
            radius_m: radius_m.max(0.0),
            above_m: below_m.max(0.0),
        }
    }
}

impl<B: SeaBed> SeaBed for GuardedBed<B> {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        let depth = |offset: &[f64; 2]| {
            let (north_m, east_m) = (
                north_m + self.radius_m * offset[0],
                east_m + self.radius_m * offset[1],
            );
            self.bed.depth_at(north_m, east_m)
        };
        let here_m = self.bed.depth_at(north_m, east_m);
        AROUND.iter().map(depth).fold(here_m, f64::min) - self.above_m
    }

    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        self.bed
            .max_slope_near(north_m, east_m, radius_m + self.radius_m)
    }

    /// That of the bed at the position itself.
    fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
        self.bed.depth_sigma_m(north_m, east_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnalyticBed, BedFeature, FlatBed, Footprint};
    use auv_types::{Seed, libm, rand::RngExt};

    #[test]
    fn a_vehicle_off_its_place_keeps_its_altitude() {
        let shore = Footprint::Beyond {
            through: [0.0, 100.0],
            towards: [0.0, 200.0],
        };
        let bed = AnalyticBed::new(60.0).with(BedFeature::new("shore", shore, 5.0, 80.0));
        let guarded = GuardedBed::new(&bed, 2.0, 0.4);
        let mut random = Seed(1).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        for _ in 0..500 {
            let (north_m, east_m) = (draw(-50.0, 50.0), draw(0.0, 150.0));
            let deepest_m = guarded.depth_at(north_m, east_m);
            let (off_m, bearing) = (draw(0.0, 2.0), draw(0.0, 6.3));
            let (sin, cos) = libm::sincos(bearing);
            let there_m = bed.depth_at(north_m + off_m * cos, east_m + off_m * sin);
            // Between the sampled places a disc bulges by 8 % of its radius.
            assert!(there_m >= deepest_m + 0.4 - 0.16, "{there_m} {deepest_m}");
        }
        assert_eq!(guarded.depth_at(0.0, -500.0), 59.6);
    }

    #[test]
    fn a_flat_bed_is_raised_by_the_vertical_margin() {
        let guarded = GuardedBed::new(FlatBed::new(30.0), 5.0, 1.0);
        assert_eq!(
            (guarded.depth_at(1.0, 2.0), guarded.depth_sigma_m(1.0, 2.0)),
            (29.0, 0.0)
        );
        assert_eq!(guarded.max_slope_near(1.0, 2.0, 9.0), 0.0);
    }
}
