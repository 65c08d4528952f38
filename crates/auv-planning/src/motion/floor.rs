//! The deepest the vehicle may be over the bed.

use auv_ocean::SeaBed;
use auv_types::Point3;

/// The deepest the vehicle may be, as a bed of its own: the depth of the sea bed less the altitude
/// to keep above it.
#[derive(Clone, Copy, Debug)]
pub struct Floor<'a> {
    /// The sea bed.
    pub bed: &'a dyn SeaBed,
    /// Least altitude above the bed, metres.
    pub min_altitude_m: f64,
    /// Standard deviations of the bed's depth added to the least altitude.
    pub altitude_sigmas: f64,
}

impl Floor<'_> {
    /// Greatest depth allowed at a place, metres; minus infinity where the bed's depth is unknown.
    #[must_use]
    pub fn deepest_at(&self, north_m: f64, east_m: f64) -> f64 {
        let (depth_m, sigma_m) = self.bed.sounding_m(north_m, east_m);
        let deepest_m = depth_m - self.min_altitude_m - self.altitude_sigmas * sigma_m;
        // A bed of unknown depth is no water: a NaN would pass for clear in every comparison.
        if deepest_m.is_nan() {
            f64::NEG_INFINITY
        } else {
            deepest_m
        }
    }

    /// How far a straight segment dips below the floor, metres; 0 when it is proven to stay above.
    ///
    /// The segment is halved until the bound of the bed's slope proves a piece clear or the piece
    /// is at most 0.5 m long, so a dip is found within 0.25 m times the slope. The depth's standard
    /// deviation is taken to change by at most 5 % of what the depth changes.
    #[must_use]
    pub fn grounding_m(&self, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
        let ends_m = self.below_m(from).max(self.below_m(to));
        self.dip_m(from, to).max(ends_m).max(0.0)
    }

    /// How far a place lies below the floor, metres; negative above it.
    fn below_m(&self, place: &Point3<f64>) -> f64 {
        place.z - self.deepest_at(place.x, place.y)
    }

    /// How far the middles of the pieces of a segment lie below the floor at most, metres.
    fn dip_m(&self, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
        const SHORTEST_M: f64 = 0.5;
        let length_m = (to - from).norm();
        let across_m = (to.xy() - from.xy()).norm();
        let middle = from + (to - from) * 0.5;
        let middle_m = self.below_m(&middle);
        let slope = self.bed.max_slope_near(middle.x, middle.y, 0.5 * across_m)
            * (1.0 + 0.05 * self.altitude_sigmas);
        let could_m = middle_m + slope * 0.5 * across_m + 0.5 * (to.z - from.z).abs();
        if could_m <= 0.0 || length_m <= SHORTEST_M || middle_m.is_infinite() {
            return middle_m;
        }
        self.dip_m(from, &middle)
            .max(self.dip_m(&middle, to))
            .max(middle_m)
    }
}

impl SeaBed for Floor<'_> {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.deepest_at(north_m, east_m)
    }

    /// That of the bed: the standard deviation grows with depth, so the floor is not steeper.
    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        self.bed.max_slope_near(north_m, east_m, radius_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_ocean::{AnalyticBed, BedFeature, FlatBed, Footprint};
    use auv_types::{Seed, rand::RngExt};

    #[test]
    fn is_the_bed_less_the_altitude() {
        let floor = Floor {
            bed: &FlatBed::new(50.0),
            min_altitude_m: 5.0,
            altitude_sigmas: 2.0,
        };
        assert_eq!(floor.deepest_at(3.0, 4.0), 45.0);
        assert_eq!(floor.depth_at(3.0, 4.0), 45.0);
        let at = |z: f64| Point3::new(0.0, 0.0, z);
        assert_eq!(floor.grounding_m(&at(0.0), &at(45.0)), 0.0);
        assert_eq!(floor.grounding_m(&at(0.0), &at(47.0)), 2.0);
    }

    #[test]
    fn a_bed_of_unknown_depth_is_no_water() {
        let floor = Floor {
            bed: &FlatBed::new(f64::NAN),
            min_altitude_m: 5.0,
            altitude_sigmas: 2.0,
        };
        let far = Point3::new(1e6, 0.0, 0.0);
        assert_eq!(floor.grounding_m(&Point3::origin(), &far), f64::INFINITY);
    }

    #[test]
    fn equals_the_deepest_dip_of_fine_samples() {
        let bank = Footprint::Disc {
            centre: [500.0, 300.0],
            radius_m: 50.0,
        };
        let bed = AnalyticBed::new(80.0).with(BedFeature::new("bank", bank, 30.0, 150.0));
        let floor = Floor {
            bed: &bed,
            min_altitude_m: 5.0,
            altitude_sigmas: 0.0,
        };
        let mut random = Seed(4).stream(0);
        let mut place = || {
            let [x, y] = [0, 1].map(|_| random.random_range(0.0..1e3));
            Point3::new(x, y, random.random_range(0.0..75.0))
        };
        let mut dips = 0;
        for _ in 0..200 {
            let (from, to) = (place(), place());
            let sampled_m = (0..=20_000)
                .map(|k| from + (to - from) * (f64::from(k) / 20_000.0))
                .map(|p| p.z - floor.deepest_at(p.x, p.y))
                .fold(0.0, f64::max);
            let found_m = floor.grounding_m(&from, &to);
            dips += usize::from(found_m > 0.0);
            assert!((found_m - sampled_m).abs() < 0.3, "{found_m} {sampled_m}");
        }
        assert!((20..180).contains(&dips), "{dips}");
    }

    /// The floor over a bed, no altitude kept.
    fn on(bed: &dyn SeaBed) -> Floor<'_> {
        Floor {
            bed,
            min_altitude_m: 0.0,
            altitude_sigmas: 0.0,
        }
    }

    #[test]
    fn a_peak_between_the_ends_is_found() {
        let line = vec![[137.0, -50.0], [137.0, 50.0]];
        let ridge = Footprint::Line {
            points: line,
            half_width_m: 2.0,
        };
        let bed = AnalyticBed::new(80.0).with(BedFeature::new("ridge", ridge, 20.0, 25.0));
        let short_m = |z: f64| {
            let ends = [0.0, 400.0].map(|x| Point3::new(x, 0.0, z));
            on(&bed).grounding_m(&ends[0], &ends[1])
        };
        assert!((short_m(30.0) - 10.0).abs() < 0.2);
        assert_eq!(short_m(19.0), 0.0);
    }

    /// A ridge whose crest lies 45 m deep at 85 m north and whose flanks fall by 1 m a metre.
    #[derive(Debug)]
    struct Ridge;

    impl SeaBed for Ridge {
        fn depth_at(&self, north_m: f64, _east_m: f64) -> f64 {
            45.0 + (north_m - 85.0).abs()
        }
        fn max_slope_near(&self, _: f64, _: f64, _: f64) -> f64 {
            1.0
        }
    }

    #[test]
    fn a_descent_into_a_rising_bed_is_found() {
        // Start, middle and end are clear; the bed's slope alone would not reach the segment.
        let (from, to) = (Point3::new(0.0, 0.0, 5.0), Point3::new(100.0, 0.0, 55.0));
        let short_m = on(&Ridge).grounding_m(&from, &to);
        assert!((short_m - 2.5).abs() < 0.3, "{short_m}");
    }
}
