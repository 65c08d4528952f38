//! Where the simulated vehicle believes to be.

use auv_mission::Navigation;
use auv_obstacles::TimedPoint;
use auv_ocean::CurrentField;
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed, Vector3, libm};

/// A vehicle no deeper than this has its antenna above the surface, metres.
const ANTENNA_M: f64 = 0.5;

/// Dead reckoning through the water between fixes at the surface.
///
/// The error is a random vector times the way since the last fix, drawn again at each fix, and the turn of the whole
/// way by the error of the compass, drawn once.
#[derive(Clone, Debug)]
pub(crate) struct Navigator {
    navigation: Navigation,
    /// Draws the errors; `None`: there are none, though the vehicle cannot know that.
    random: Option<ChaCha8Rng>,
    compass_rad: f64,
    /// Error per metre of the way, north and east.
    gain: [f64; 2],
    way_m: f64,
    /// From the last fix, through the water.
    away: Vector3<f64>,
    /// Since when the vehicle is at the surface, mission time in seconds.
    surfaced_s: Option<f64>,
}

impl Navigator {
    /// With a fix before the launch.
    pub(crate) fn new(navigation: Navigation, seed: Seed) -> Self {
        let mut random = seed.stream(0);
        let compass_rad = navigation.compass_deg.to_radians() * normal(&mut random)[0];
        let mut navigator = Self {
            navigation,
            random: Some(random),
            compass_rad,
            gain: [0.0; 2],
            way_m: 0.0,
            away: Vector3::zeros(),
            surfaced_s: None,
        };
        navigator.fix();
        navigator
    }

    /// The same without errors, which the vehicle cannot know.
    #[cfg(feature = "mission-file")]
    pub(crate) fn without_errors(mut self) -> Self {
        (self.random, self.compass_rad, self.gain) = (None, 0.0, [0.0; 2]);
        self
    }

    fn fix(&mut self) {
        // The standard deviation is that of the distance: of each axis it is smaller.
        let sigma = 0.01 * self.navigation.drift_percent * std::f64::consts::FRAC_1_SQRT_2;
        let drawn = self.random.as_mut().map_or([0.0; 2], normal);
        self.gain = drawn.map(|x| sigma * x);
        self.way_m = 0.0;
        self.away = Vector3::zeros();
    }

    /// The vehicle has flown a true track through a current. Returns by how much the believed place jumps, if it
    /// gets a fix.
    pub(crate) fn take(
        &mut self,
        track: &[TimedPoint],
        water: Option<&dyn CurrentField>,
    ) -> Option<Vector3<f64>> {
        for pair in track.windows(2) {
            let (from, to) = (&pair[0], &pair[1]);
            let drift = water.map_or_else(Vector3::zeros, |w| {
                w.velocity_at(&from.position, from.time_s) * (to.time_s - from.time_s)
            });
            let through = to.position - from.position - drift;
            self.way_m += through.norm();
            self.away += through;
        }
        let here = track.last()?;
        if here.position.z > ANTENNA_M {
            self.surfaced_s = None;
            return None;
        }
        let since_s = *self.surfaced_s.get_or_insert(here.time_s);
        if here.time_s - since_s < self.navigation.fix_at_surface_s || self.way_m <= 0.0 {
            return None;
        }
        let before = self.error();
        self.fix();
        self.surfaced_s = Some(here.time_s);
        Some(-before)
    }

    /// The believed place minus the true one, metres.
    pub(crate) fn error(&self) -> Vector3<f64> {
        let (sin, cos) = libm::sincos(self.compass_rad);
        let (north, east) = (self.away.x, self.away.y);
        // A compass that shows too little turns what is believed to the left.
        let turned = Vector3::new(
            cos * north - sin * east - north,
            sin * north + cos * east - east,
            0.0,
        );
        Vector3::new(self.gain[0], self.gain[1], 0.0) * self.way_m + turned
    }

    /// Standard deviation of the error, metres.
    pub(crate) fn sigma_m(&self) -> f64 {
        let away_m = libm::hypot(self.away.x, self.away.y);
        self.navigation.sigma_m(self.way_m, away_m)
    }
}

/// Two numbers of the standard normal distribution.
fn normal(random: &mut ChaCha8Rng) -> [f64; 2] {
    let radius = libm::sqrt(-2.0 * libm::log(1.0 - random.random_range(0.0..1.0)));
    let (sin, cos) = libm::sincos(random.random_range(0.0..std::f64::consts::TAU));
    [radius * cos, radius * sin]
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Point3;

    fn at(x: f64, z: f64, t: f64) -> TimedPoint {
        TimedPoint::new(Point3::new(x, 0.0, z), t)
    }

    #[test]
    fn the_error_is_as_large_as_stated_and_ends_with_a_fix() {
        let navigation = Navigation {
            drift_percent: 1.0,
            compass_deg: 0.5,
            ..Navigation::default()
        };
        let (mut squares, mut within) = (0.0, 0);
        for seed in 0..400 {
            let mut navigator = Navigator::new(navigation, Seed(seed));
            assert!(
                navigator
                    .take(&[at(0.0, 20.0, 0.0), at(1_000.0, 20.0, 700.0)], None)
                    .is_none()
            );
            let (error_m, sigma_m) = (navigator.error().norm(), navigator.sigma_m());
            assert!((sigma_m - 13.27).abs() < 0.01, "{sigma_m}");
            squares += error_m * error_m / 400.0;
            within += usize::from(error_m <= Navigation::SIGMAS * sigma_m);
            assert!(
                navigator
                    .take(&[at(1_000.0, 20.0, 700.0), at(1_000.0, 0.0, 720.0)], None)
                    .is_none()
            );
            let jump = navigator.take(&[at(1_000.0, 0.0, 720.0), at(1_001.0, 0.0, 780.0)], None);
            assert!((jump.unwrap().norm() - error_m).abs() < 1.0);
            assert_eq!((navigator.error().norm(), navigator.sigma_m()), (0.0, 0.0));
        }
        let spread_m = libm::sqrt(squares);
        assert!((spread_m - 13.27).abs() < 1.3, "{spread_m}");
        assert!(within >= 370, "{within} of 400 within 2 sigma");
    }

    /// A current that carries the vehicle along is no way through the water.
    #[test]
    fn drifting_with_the_water_costs_nothing() {
        let navigation = Navigation {
            drift_percent: 1.0,
            ..Navigation::default()
        };
        let water = auv_ocean::UniformCurrent::new(Vector3::x());
        let mut navigator = Navigator::new(navigation, Seed(1));
        navigator.take(&[at(0.0, 20.0, 0.0), at(100.0, 20.0, 100.0)], Some(&water));
        assert_eq!(navigator.sigma_m(), 0.0);
    }
}
