//! The sonar: its field of view and its errors.

use crate::random::{normal, normal_vector, poisson};
use crate::{Detection, Region, RegionShape, Scan};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Seed, Vector3, Violations, libm};
use std::f64::consts::{PI, TAU};

/// A sonar that detects obstacles in its field of view with Gaussian errors, misses and clutter.
///
/// The position error is isotropic with variance `position_sigma_m² + (angle_sigma_rad range)²`. An
/// obstacle is in view if any part of it is.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Sonar {
    /// Greatest distance at which a surface returns an echo, metres.
    pub range_m: f64,
    /// Half the horizontal opening, radians (pi: all round).
    pub half_width_rad: f64,
    /// Half the vertical opening, radians (pi/2: all round).
    pub half_height_rad: f64,
    /// Time between two scans, seconds.
    pub period_s: f64,
    /// Error of a position, standard deviation per axis in metres.
    pub position_sigma_m: f64,
    /// Error of a direction, standard deviation in radians.
    pub angle_sigma_rad: f64,
    /// Error of a velocity, standard deviation per axis in m/s; `None`: velocities are not measured.
    pub velocity_sigma_mps: Option<f64>,
    /// Error of a radius, standard deviation in metres.
    pub radius_sigma_m: f64,
    /// Probability of an echo up to `sure_range_m`.
    pub detection_near: f64,
    /// Probability of an echo at the end of the range; linear in between.
    pub detection_far: f64,
    /// Distance up to which `detection_near` holds, metres.
    pub sure_range_m: f64,
    /// Mean number of false echoes per scan (Poisson, uniform over the sector), at most 100.
    pub clutter_per_scan: f64,
    /// Whether only the part of an obstacle within range is seen. A large obstacle then appears as a ball
    /// of that part's extent behind its near face.
    pub near_face: bool,
}

impl Sonar {
    /// The paper's sonar: all round, 1000 m, errors of 5 m in position, 0.05 m/s and 5 m in radius, one scan
    /// per step of 10 s, no misses.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            range_m: 1000.0,
            half_width_rad: PI,
            half_height_rad: PI / 2.0,
            period_s: 10.0,
            position_sigma_m: 5.0,
            angle_sigma_rad: 0.0,
            velocity_sigma_mps: Some(0.05),
            radius_sigma_m: 5.0,
            detection_near: 1.0,
            detection_far: 1.0,
            sure_range_m: 1000.0,
            clutter_per_scan: 0.0,
            near_face: false,
        }
    }

    /// Every invalid value.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_positive(self.range_m, "range_m");
        violations.require_positive(self.half_width_rad, "half_width_rad");
        violations.require_positive(self.half_height_rad, "half_height_rad");
        violations.require_positive(self.period_s, "period_s");
        violations.require_not_negative(self.position_sigma_m, "position_sigma_m");
        violations.require_not_negative(self.angle_sigma_rad, "angle_sigma_rad");
        violations
            .require_not_negative(self.velocity_sigma_mps.unwrap_or(0.0), "velocity_sigma_mps");
        violations.require_not_negative(self.radius_sigma_m, "radius_sigma_m");
        violations.require_not_negative(self.sure_range_m, "sure_range_m");
        for (value, place) in [
            (self.detection_near, "detection_near"),
            (self.detection_far, "detection_far"),
        ] {
            violations.require((0.0..=1.0).contains(&value), place, || {
                format!("is {value}; give a probability")
            });
        }
        violations.require(
            (0.0..=100.0).contains(&self.clutter_per_scan),
            "clutter_per_scan",
            || format!("is {}; give 0 to 100", self.clutter_per_scan),
        );
        violations
    }

    /// One scan of the true regions that exist at `time_s`. Velocities are measured as the regions'
    /// velocities.
    ///
    /// # Determinism
    /// The result depends on the arguments and the state of `random` only.
    #[must_use]
    pub fn scan(
        &self,
        truth: &[Region],
        from: &Point3<f64>,
        heading_rad: f64,
        time_s: f64,
        random: &mut ChaCha8Rng,
    ) -> Scan {
        let mut detections = Vec::new();
        for region in truth {
            if !region.exists_at(time_s) {
                continue;
            }
            let centre = seen_centre(region, from, time_s);
            let radius_m = region.radius_at(time_s);
            let probability = self.detection_probability(from, heading_rad, &centre, radius_m);
            if probability <= 0.0 || random.random::<f64>() >= probability {
                continue;
            }
            let (centre, radius_m) = self.seen_part(from, centre, radius_m, region.shape);
            let range_m = ((centre - from).norm() - radius_m).max(0.0);
            detections.push(self.echo(
                centre,
                Some(region.velocity_mps),
                radius_m,
                range_m,
                random,
            ));
        }
        for _ in 0..poisson(self.clutter_per_scan, random) {
            let range_m = self.range_m * libm::sqrt(random.random::<f64>());
            let bearing = heading_rad + self.half_width_rad * (2.0 * random.random::<f64>() - 1.0);
            let elevation = self.half_height_rad * (2.0 * random.random::<f64>() - 1.0);
            let (sin, cos) = libm::sincos(bearing);
            let (up, flat) = libm::sincos(elevation);
            let at = from + Vector3::new(cos * flat, sin * flat, up) * range_m;
            let radius_m = random.random_range(0.5..3.0);
            detections.push(self.echo(at, Some(Vector3::zeros()), radius_m, range_m, random));
        }
        Scan {
            time_s,
            from: *from,
            heading_rad,
            background: Some(background(time_s)),
            detections,
        }
    }

    /// Whether a region that exists at `time_s` may return an echo to the sonar.
    #[must_use]
    pub fn sees(&self, region: &Region, from: &Point3<f64>, heading_rad: f64, time_s: f64) -> bool {
        let centre = seen_centre(region, from, time_s);
        let radius_m = region.radius_at(time_s);
        region.exists_at(time_s)
            && self.detection_probability(from, heading_rad, &centre, radius_m) > 0.0
    }

    /// The probability that a ball returns an echo to a sonar at `from`; 0 outside the field of view.
    #[must_use]
    pub fn detection_probability(
        &self,
        from: &Point3<f64>,
        heading_rad: f64,
        centre: &Point3<f64>,
        radius_m: f64,
    ) -> f64 {
        let offset = centre - from;
        let distance_m = offset.norm();
        let range_m = distance_m - radius_m;
        if !(radius_m >= 0.0 && range_m <= self.range_m) {
            return 0.0;
        }
        if range_m > 0.0 && !self.in_sector(&offset, heading_rad, radius_m / distance_m) {
            return 0.0;
        }
        if range_m <= self.sure_range_m {
            return self.detection_near;
        }
        let far = (range_m - self.sure_range_m) / (self.range_m - self.sure_range_m);
        self.detection_near + far * (self.detection_far - self.detection_near)
    }

    fn in_sector(&self, offset: &Vector3<f64>, heading_rad: f64, sine: f64) -> bool {
        if self.half_width_rad >= PI && self.half_height_rad >= PI / 2.0 {
            return true;
        }
        let half_angle = libm::asin(sine.min(1.0));
        let flat_m = libm::hypot(offset.x, offset.y);
        let elevation = libm::atan2(offset.z, flat_m).abs();
        let turn = libm::atan2(offset.y, offset.x) - heading_rad;
        let bearing = (turn - TAU * libm::rint(turn / TAU)).abs();
        elevation <= self.half_height_rad + half_angle
            && bearing <= self.half_width_rad + half_angle
    }

    /// The ball that represents the part of an obstacle within range: the obstacle itself, or a ball as
    /// wide as the visible part that touches the near face from inside. Of a cylinder it lies at the depth that
    /// is seen.
    fn seen_part(
        &self,
        from: &Point3<f64>,
        centre: Point3<f64>,
        radius_m: f64,
        shape: RegionShape,
    ) -> (Point3<f64>, f64) {
        let mut offset = centre - from;
        let mut range_square = self.range_m * self.range_m;
        if let RegionShape::Cylinder { .. } = shape {
            range_square -= offset.z * offset.z;
            offset.z = 0.0;
        }
        let distance_m = offset.norm();
        let horizon_square = distance_m * distance_m - radius_m * radius_m;
        if !self.near_face || horizon_square <= range_square || distance_m <= radius_m {
            return (centre, radius_m);
        }
        // Distance at which the sphere of the range intersects the obstacle's surface.
        let along_m = (horizon_square + range_square) / (2.0 * distance_m);
        let seen_m = libm::sqrt((range_square - along_m * along_m).max(0.0)).min(radius_m);
        (centre - offset * ((radius_m - seen_m) / distance_m), seen_m)
    }

    fn echo(
        &self,
        centre: Point3<f64>,
        velocity: Option<Vector3<f64>>,
        radius_m: f64,
        range_m: f64,
        random: &mut ChaCha8Rng,
    ) -> Detection {
        let across_m = self.angle_sigma_rad * range_m;
        let position_sigma_m =
            libm::sqrt(self.position_sigma_m * self.position_sigma_m + across_m * across_m);
        let velocity = self
            .velocity_sigma_mps
            .zip(velocity)
            .map(|(sigma, velocity)| velocity + normal_vector(random) * sigma);
        Detection {
            position: centre + normal_vector(random) * position_sigma_m,
            velocity,
            radius_m: (radius_m + normal(random) * self.radius_sigma_m).max(0.0),
            position_sigma_m,
            velocity_sigma_mps: self.velocity_sigma_mps.unwrap_or(0.0),
            radius_sigma_m: self.radius_sigma_m,
        }
    }
}

impl Default for Sonar {
    /// A forward-looking sonar of a small survey vehicle: 120 x 20 degrees, 100 m, 2 Hz, 0.3 m and
    /// 1 degree, no velocity, detection 0.9 up to 60 m falling to 0.5, two false echoes a scan.
    fn default() -> Self {
        Self {
            range_m: 100.0,
            half_width_rad: PI / 3.0,
            half_height_rad: PI / 18.0,
            period_s: 0.5,
            position_sigma_m: 0.3,
            angle_sigma_rad: PI / 180.0,
            velocity_sigma_mps: None,
            radius_sigma_m: 0.5,
            detection_near: 0.9,
            detection_far: 0.5,
            sure_range_m: 60.0,
            clutter_per_scan: 2.0,
            near_face: true,
        }
    }
}

/// The centre of the ball a sonar at `from` sees. Of a cylinder it sees the part at its own depth.
fn seen_centre(region: &Region, from: &Point3<f64>, time_s: f64) -> Point3<f64> {
    let mut centre = region.centre_at(time_s);
    if let RegionShape::Cylinder { top_m, bottom_m } = region.shape {
        centre.z = from.z.max(top_m).min(bottom_m);
    }
    centre
}

/// The noise level of a sweep: different for each, and independent of the other draws.
fn background(time_s: f64) -> f64 {
    Seed(time_s.to_bits()).stream(0).random()
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;

    #[test]
    fn only_obstacles_in_the_sector_are_detected() {
        let sonar = Sonar::default();
        let from = Point3::new(0.0, 0.0, 20.0);
        let seen = |x: f64, y: f64, z: f64| {
            sonar.detection_probability(&from, 0.0, &Point3::new(x, y, z), 1.0)
        };
        assert_eq!(seen(50.0, 0.0, 20.0), 0.9);
        assert!((seen(101.0, 0.0, 20.0) - 0.5).abs() < 1e-12);
        assert!((seen(81.0, 0.0, 20.0) - 0.7).abs() < 1e-12);
        assert_eq!(seen(102.0, 0.0, 20.0), 0.0);
        assert_eq!(seen(-50.0, 0.0, 20.0), 0.0, "astern");
        assert_eq!(seen(50.0, 0.0, 35.0), 0.0, "below the fan");
        assert_eq!(seen(20.0, 60.0, 20.0), 0.0, "abeam");
        let turned = sonar.detection_probability(&from, -3.0, &Point3::new(-50.0, 1.0, 20.0), 1.0);
        assert_eq!(turned, 0.9, "across the wrap of the angle");
    }

    #[test]
    fn a_large_obstacle_appears_as_the_part_in_range_at_its_near_face() {
        let sonar = Sonar::default();
        let from = Point3::origin();
        let ball = RegionShape::Ball;
        let (centre, radius_m) = sonar.seen_part(&from, Point3::new(200.0, 0.0, 0.0), 150.0, ball);
        assert!((centre.x - radius_m - 50.0).abs() < 1e-9, "same near face");
        assert!(radius_m > 50.0 && radius_m < 90.0, "{radius_m}");
        let whole = Point3::new(60.0, 0.0, 0.0);
        assert_eq!(sonar.seen_part(&from, whole, 5.0, ball), (whole, 5.0));
        // A hull above the vehicle is seen at its own depth.
        let hull = Region::cylinder(Point3::origin(), 150.0, -5.0, 20.0).shape;
        let (centre, radius_m) = sonar.seen_part(
            &Point3::new(0.0, 0.0, 50.0),
            Point3::new(220.0, 0.0, 20.0),
            150.0,
            hull,
        );
        assert!((centre.x - radius_m - 70.0).abs() < 1e-9 && centre.z == 20.0);
    }

    #[test]
    fn echoes_misses_and_clutter_have_the_stated_rates() {
        let mut random = Seed(1).stream(0);
        let target = Region::ball(Point3::new(50.0, 0.0, 0.0), 1.0);
        let clean = Sonar {
            clutter_per_scan: 0.0,
            ..Sonar::default()
        };
        let scans = 20_000;
        let (mut echoes, mut clutter, mut square) = (0.0, 0.0, 0.0);
        for _ in 0..scans {
            let scan = clean.scan(&[target], &Point3::origin(), 0.0, 0.0, &mut random);
            for echo in &scan.detections {
                assert!(echo.velocity.is_none());
                let error = (echo.position - target.centre).norm() / echo.position_sigma_m;
                square += error * error;
                echoes += 1.0;
            }
            let empty = Sonar::default().scan(&[], &Point3::origin(), 0.0, 0.0, &mut random);
            clutter += empty.detections.len() as f64;
        }
        let n = f64::from(scans);
        assert!((echoes / n - 0.9).abs() < 0.01, "{}", echoes / n);
        assert!((clutter / n - 2.0).abs() < 0.04, "{}", clutter / n);
        assert!((square / echoes - 3.0).abs() < 0.08, "{}", square / echoes);
    }

    #[test]
    fn the_paper_s_sonar_measures_everything_within_a_kilometre() {
        let mut random = Seed(1).stream(0);
        let mut regions =
            [990.0, -500.0, 1100.0].map(|x| Region::ball(Point3::new(x, 0.0, 50.0), 20.0));
        regions[1].velocity_mps.y = 0.4;
        let scan = Sonar::paper().scan(
            &regions,
            &Point3::new(0.0, 0.0, 50.0),
            2.0,
            7.0,
            &mut random,
        );
        assert_eq!(scan.detections.len(), 2);
        assert!((scan.detections[1].velocity.unwrap().y - 0.4).abs() < 0.25);
        assert_eq!((scan.time_s, scan.heading_rad), (7.0, 2.0));
    }
}
