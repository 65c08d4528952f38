//! The bed that planners get, for a vehicle that is off its path by its guidance error.

use auv_ocean::{LevelledBed, SeaBed, ShallowestNear};
use std::sync::Arc;

/// What the greatest guidance error costs in altitude where the bed is not steep, as a share of it: it is mostly
/// horizontal, and costs that much over a slope of as much.
const ALTITUDE_SHARE: f64 = 0.7;
/// Eight directions are looked in: between two of them a slope costs less by the cosine of 22.5 degrees.
const BETWEEN_DIRECTIONS: f64 = 1.0824;

/// A charted bed that is shallower by what the guidance error may cost: the same everywhere but for steep slopes
/// and walls, next to which it is as shallow as the shallowest place within the error.
#[derive(Clone, Debug)]
pub(super) struct RoomBelow {
    charted: Arc<dyn SeaBed>,
    raised: LevelledBed<Arc<dyn SeaBed>>,
    near: ShallowestNear<Arc<dyn SeaBed>>,
    within_m: f64,
    /// What is no steeper costs no more than [`ALTITUDE_SHARE`].
    steepest: f64,
}

impl RoomBelow {
    pub(super) fn new(charted: Arc<dyn SeaBed>, guidance_error_m: f64) -> Self {
        let within_m = BETWEEN_DIRECTIONS * guidance_error_m;
        Self {
            raised: LevelledBed::new(Arc::clone(&charted), -raised_m(guidance_error_m)),
            near: ShallowestNear::new(Arc::clone(&charted), within_m),
            charted,
            within_m,
            steepest: ALTITUDE_SHARE / BETWEEN_DIRECTIONS,
        }
    }

    /// A depth, as shallow as the shallowest near where the bed is steep.
    fn beside_walls_m(&self, depth_m: f64, north_m: f64, east_m: f64) -> f64 {
        let slope = self.charted.max_slope_near(north_m, east_m, self.within_m);
        if slope <= self.steepest {
            return depth_m;
        }
        depth_m.min(self.near.depth_at(north_m, east_m))
    }
}

/// By how much the bed is raised where it is not steep, metres.
pub(super) fn raised_m(guidance_error_m: f64) -> f64 {
    ALTITUDE_SHARE * guidance_error_m.max(0.0)
}

impl SeaBed for RoomBelow {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.beside_walls_m(self.raised.depth_at(north_m, east_m), north_m, east_m)
    }

    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let near = self.near.max_slope_near(north_m, east_m, radius_m);
        if near <= self.steepest {
            return self.raised.max_slope_near(north_m, east_m, radius_m);
        }
        near.max(self.raised.max_slope_near(north_m, east_m, radius_m))
    }

    fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
        self.charted.depth_sigma_m(north_m, east_m)
    }

    fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
        let (depth_m, sigma_m) = self.raised.sounding_m(north_m, east_m);
        (self.beside_walls_m(depth_m, north_m, east_m), sigma_m)
    }
}
