//! A charted bed under a water level.

use crate::SeaBed;

/// The depth of a charted bed below a surface that stands `level_m` above the datum of the chart.
///
/// Land stays land: where the chart has water of less than a positive level, the depth grows only by the
/// charted depth.
///
/// ```
/// use auv_ocean::{FlatBed, LevelledBed, SeaBed};
///
/// assert_eq!(LevelledBed::new(FlatBed::new(20.0), 3.0).depth_at(0.0, 0.0), 23.0);
/// assert_eq!(LevelledBed::new(FlatBed::new(20.0), -1.0).depth_at(0.0, 0.0), 19.0);
/// assert_eq!(LevelledBed::new(FlatBed::new(-2.0), 3.0).depth_at(0.0, 0.0), -2.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelledBed<B> {
    charted: B,
    level_m: f64,
}

impl<B: SeaBed> LevelledBed<B> {
    /// A charted bed under a surface `level_m` above the datum.
    #[must_use]
    pub const fn new(charted: B, level_m: f64) -> Self {
        Self { charted, level_m }
    }

    fn below_surface_m(&self, charted_m: f64) -> f64 {
        charted_m + self.level_m.min(charted_m.max(0.0))
    }
}

impl<B: SeaBed> SeaBed for LevelledBed<B> {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.below_surface_m(self.charted.depth_at(north_m, east_m))
    }

    fn depths_at(&self, north_m: &[f64], east_m: &[f64], depths_m: &mut [f64]) {
        self.charted.depths_at(north_m, east_m, depths_m);
        for depth_m in depths_m {
            *depth_m = self.below_surface_m(*depth_m);
        }
    }

    /// That of the chart, doubled where water may be shallower than the level.
    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let slope = self.charted.max_slope_near(north_m, east_m, radius_m);
        let shallowest_m = self.charted.depth_at(north_m, east_m) - slope * radius_m;
        if self.level_m <= 0.0 || shallowest_m >= self.level_m {
            slope
        } else {
            2.0 * slope
        }
    }

    fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
        self.charted.depth_sigma_m(north_m, east_m)
    }

    fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
        let (charted_m, sigma_m) = self.charted.sounding_m(north_m, east_m);
        (self.below_surface_m(charted_m), sigma_m)
    }
}
