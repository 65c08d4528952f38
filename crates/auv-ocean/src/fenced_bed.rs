//! A bed with fences that plans may not cross.

use crate::{Footprint, SeaBed};

/// A bed that rises into walls at the edges of areas that plans stay out of, or stay in.
///
/// In a forbidden area the depth is at most -10 m: land. Outside of it a wall rises towards it by 5 m a metre. So
/// whatever keeps clear of the bed keeps clear of the areas at all depths: planners, guides, ways home.
///
/// ```
/// use auv_ocean::{FencedBed, FlatBed, Footprint, SeaBed};
///
/// let reserve = Footprint::Disc { centre: [500.0, 0.0], radius_m: 100.0 };
/// let bed = FencedBed::new(FlatBed::new(40.0), vec![reserve], vec![]);
/// assert!(bed.depth_at(500.0, 50.0) < 0.0);
/// assert_eq!(bed.depth_at(395.0, 0.0), 15.0);
/// assert_eq!(bed.depth_at(0.0, 0.0), 40.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FencedBed<B> {
    bed: B,
    keep_out: Vec<Footprint>,
    keep_in: Vec<Footprint>,
}

/// Height of a wall over the surface at the edge of an area, metres.
const EDGE_M: f64 = 10.0;
/// Slope of the walls, metres of depth per horizontal metre.
const SLOPE: f64 = 5.0;

impl<B: SeaBed> FencedBed<B> {
    /// How much farther from its areas plans keep for each metre that they are too deep, metres.
    pub const ROOM_M: f64 = 1.0 / SLOPE;

    /// A bed whose plans stay out of every area of `keep_out`, and within at least one of `keep_in` unless that
    /// is empty.
    #[must_use]
    pub const fn new(bed: B, keep_out: Vec<Footprint>, keep_in: Vec<Footprint>) -> Self {
        Self {
            bed,
            keep_out,
            keep_in,
        }
    }

    /// Distance to the nearest forbidden place, metres; negative within.
    fn room_m(&self, north_m: f64, east_m: f64) -> f64 {
        let distance_m = |area: &Footprint| area.distance_m(north_m, east_m);
        let out_m = self.keep_out.iter().map(distance_m);
        let room_m = out_m.fold(f64::INFINITY, f64::min);
        let within_m = self.keep_in.iter().map(|area| -distance_m(area));
        let within_m = within_m.fold(f64::NEG_INFINITY, f64::max);
        if self.keep_in.is_empty() {
            room_m
        } else {
            room_m.min(within_m)
        }
    }

    /// Depth to which the fences allow plans, metres.
    fn fence_m(&self, north_m: f64, east_m: f64) -> f64 {
        SLOPE * self.room_m(north_m, east_m) - EDGE_M
    }
}

impl<B: SeaBed> SeaBed for FencedBed<B> {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        let depth_m = self.bed.depth_at(north_m, east_m);
        depth_m.min(self.fence_m(north_m, east_m))
    }

    fn depths_at(&self, north_m: &[f64], east_m: &[f64], depths_m: &mut [f64]) {
        self.bed.depths_at(north_m, east_m, depths_m);
        for ((depth_m, &north_m), &east_m) in depths_m.iter_mut().zip(north_m).zip(east_m) {
            *depth_m = depth_m.min(self.fence_m(north_m, east_m));
        }
    }

    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let slope = self.bed.max_slope_near(north_m, east_m, radius_m);
        let deepest_m = self.bed.depth_at(north_m, east_m) + slope * radius_m;
        let shows = self.fence_m(north_m, east_m) - SLOPE * radius_m < deepest_m;
        if shows { slope.max(SLOPE) } else { slope }
    }

    fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
        self.bed.depth_sigma_m(north_m, east_m)
    }

    fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
        let (depth_m, sigma_m) = self.bed.sounding_m(north_m, east_m);
        (depth_m.min(self.fence_m(north_m, east_m)), sigma_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FlatBed;
    use auv_types::{Seed, rand::RngExt};

    fn square(north_m: f64, east_m: f64, side_m: f64) -> Footprint {
        let corner = |n: f64, e: f64| [north_m + n * side_m, east_m + e * side_m];
        Footprint::Area {
            outline: vec![
                corner(0.0, 0.0),
                corner(0.0, 1.0),
                corner(1.0, 1.0),
                corner(1.0, 0.0),
            ],
        }
    }

    #[test]
    fn plans_stay_in_one_area_and_out_of_all_others() {
        let bed = FencedBed::new(
            FlatBed::new(40.0),
            vec![square(200.0, 200.0, 100.0)],
            vec![square(0.0, 0.0, 500.0), square(450.0, 0.0, 500.0)],
        );
        assert_eq!(bed.depth_at(100.0, 100.0), 40.0);
        assert!(bed.depth_at(250.0, 250.0) <= -10.0);
        assert_eq!(bed.depth_at(475.0, 250.0), 40.0, "where two areas overlap");
        assert!(bed.depth_at(-1.0, 100.0) < -10.0);
        assert!((bed.depth_at(4.0, 100.0) - 10.0).abs() < 1e-9);
    }

    #[test]
    fn slopes_and_lists_of_depths_are_those_of_the_depths() {
        let bed = FencedBed::new(
            FlatBed::new(40.0),
            vec![square(0.0, 0.0, 100.0)],
            vec![square(-200.0, -200.0, 600.0)],
        );
        let mut random = Seed(5).stream(0);
        let mut draw = || random.random_range(-250.0..450.0);
        for _ in 0..2_000 {
            let (n, e, dn, de) = (draw(), draw(), 0.1 * draw(), 0.1 * draw());
            let away_m = auv_types::libm::hypot(dn, de);
            let slope = bed.max_slope_near(n, e, away_m);
            let change_m = (bed.depth_at(n + dn, e + de) - bed.depth_at(n, e)).abs();
            assert!(change_m <= slope * away_m + 1e-9);
            let mut depths_m = [0.0];
            bed.depths_at(&[n], &[e], &mut depths_m);
            assert_eq!(depths_m[0], bed.depth_at(n, e));
            assert_eq!(bed.sounding_m(n, e), (depths_m[0], 0.0));
        }
    }
}
