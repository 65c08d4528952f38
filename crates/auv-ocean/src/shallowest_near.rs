//! A bed for a vehicle that does not know its place exactly.

use crate::SeaBed;

/// Unit vectors in the eight main directions, and in those between them.
const MAIN: [[f64; 2]; 8] = {
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [
        [1.0, 0.0],
        [D, D],
        [0.0, 1.0],
        [-D, D],
        [-1.0, 0.0],
        [-D, -D],
        [0.0, -1.0],
        [D, -D],
    ]
};
const BETWEEN: [[f64; 2]; 8] = {
    /// Cosine and sine of 22.5 degrees.
    const C: f64 = 0.923_879_532_511_286_7;
    const S: f64 = 0.382_683_432_365_089_8;
    [
        [C, S],
        [S, C],
        [-S, C],
        [-C, S],
        [-C, -S],
        [-S, -C],
        [S, -C],
        [C, -S],
    ]
};

/// A bed that is everywhere as shallow as the shallowest of seventeen places near: the place itself, eight at a
/// distance and eight at half of it. A vehicle that is off by no more than the distance keeps its altitude over
/// the bed at those places if it keeps it over this one. A rise narrower than the gaps between them may be missed;
/// the deviation of the charted depth is what is kept for it.
///
/// ```
/// use auv_ocean::{AnalyticBed, FlatBed, SeaBed, ShallowestNear};
///
/// assert_eq!(ShallowestNear::new(FlatBed::new(30.0), 50.0).depth_at(0.0, 0.0), 30.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ShallowestNear<B> {
    bed: B,
    within_m: f64,
}

impl<B: SeaBed> ShallowestNear<B> {
    /// A bed, for a vehicle that is off by at most this distance, metres.
    #[must_use]
    pub const fn new(bed: B, within_m: f64) -> Self {
        Self { bed, within_m }
    }
}

impl<B: SeaBed> SeaBed for ShallowestNear<B> {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        let ring = |places: &[[f64; 2]; 8], away_m: f64, least_m: f64| {
            places.iter().fold(least_m, |least_m, [north, east]| {
                let (north_m, east_m) = (north_m + north * away_m, east_m + east * away_m);
                least_m.min(self.bed.depth_at(north_m, east_m))
            })
        };
        let here_m = self.bed.depth_at(north_m, east_m);
        let least_m = ring(&MAIN, self.within_m, here_m);
        ring(&BETWEEN, 0.5 * self.within_m, least_m)
    }

    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let radius_m = radius_m + self.within_m;
        self.bed.max_slope_near(north_m, east_m, radius_m)
    }

    fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
        self.bed.depth_sigma_m(north_m, east_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FlatBed;

    /// 1 m deeper for every 2 m north.
    #[derive(Debug)]
    struct Ramp;

    impl SeaBed for Ramp {
        fn depth_at(&self, north_m: f64, _east_m: f64) -> f64 {
            50.0 + 0.5 * north_m
        }

        fn max_slope_near(&self, _north_m: f64, _east_m: f64, radius_m: f64) -> f64 {
            0.5 + 1e-6 * radius_m
        }
    }

    #[test]
    fn a_ramp_is_shallower_by_its_slope_and_a_flat_bed_stays() {
        let bed = ShallowestNear::new(Ramp, 40.0);
        assert!((bed.depth_at(100.0, 7.0) - 80.0).abs() < 1e-12);
        assert!(bed.max_slope_near(0.0, 0.0, 10.0) > 0.500_049);
        let flat = ShallowestNear::new(FlatBed::new(30.0), 40.0);
        assert_eq!(flat.sounding_m(1.0, 2.0), (30.0, 0.0));
    }

    /// What lies between the rings is found by neither; what lies on them is.
    #[test]
    fn a_shoal_half_the_distance_away_counts() {
        use crate::{MeasuredBed, Shoal};
        let shoal = Shoal {
            north_m: 0.0,
            east_m: 0.0,
            raised_m: 9.0,
            reach_m: 20.0,
        };
        let bed = ShallowestNear::new(MeasuredBed::new(FlatBed::new(30.0), vec![shoal]), 60.0);
        for k in 0..64 {
            let angle = f64::from(k) * std::f64::consts::TAU / 64.0;
            let (sin, cos) = auv_types::libm::sincos(angle);
            for away_m in [10.0, 30.0, 45.0, 60.0] {
                let depth_m = bed.depth_at(away_m * cos, away_m * sin);
                assert!(depth_m < 24.0, "{away_m} m off: {depth_m}");
            }
        }
    }
}
