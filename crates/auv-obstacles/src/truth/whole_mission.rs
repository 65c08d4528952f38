//! The obstacles of a whole mission.

use super::birth::Birth;
use super::field::{FieldSettings, KeepOut, ObstacleField};
use super::obstacle::{Obstacle, ObstacleClass};
use crate::Sonar;
use auv_types::rand::RngExt;
use auv_types::{Bounds, Point3, Seed, Violations};

/// Random obstacles, uniform over the waypoints' layer, in equal numbers of the four classes.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionObstacles {
    /// Number of obstacles; see [`MissionObstacles::count_for_density`].
    pub count: usize,
    /// The layer of their initial positions, metres.
    pub layer: Bounds,
    /// Start of the vehicle. No obstacle starts within sonar range of it or ever enters the keep-out ball
    /// around it.
    pub start: Point3<f64>,
    /// Destination of the vehicle. No obstacle ever enters the keep-out ball around it.
    pub dock: Point3<f64>,
    /// All waypoints. No obstacle starts within `keep_out_m` of one.
    pub waypoints: Vec<Point3<f64>>,
    /// Radius of the keep-out balls, metres.
    pub keep_out_m: f64,
    /// Range of the sonar, metres.
    pub sonar_range_m: f64,
    /// Sizes and motion.
    pub birth: Birth,
    /// The parameters of motion. The keep-out balls of start and destination are added to them.
    pub field: FieldSettings,
}

impl MissionObstacles {
    /// Obstacles of coastal waters: default sizes and motion, keep-out balls of 100 m, the default sonar's
    /// range. A mission file's `preset = "default"` has the same values.
    #[must_use]
    pub fn new(
        count: usize,
        layer: Bounds,
        waypoints: Vec<Point3<f64>>,
        start: Point3<f64>,
        dock: Point3<f64>,
    ) -> Self {
        Self {
            keep_out_m: 100.0,
            sonar_range_m: Sonar::default().range_m,
            birth: Birth::default(),
            field: FieldSettings::default(),
            ..Self::campaign(count, layer, waypoints, start, dock)
        }
    }

    /// Values for whole missions among the paper's obstacles: keep-out balls of 300 m and a sonar range of
    /// 1000 m.
    #[must_use]
    pub fn campaign(
        count: usize,
        layer: Bounds,
        waypoints: Vec<Point3<f64>>,
        start: Point3<f64>,
        dock: Point3<f64>,
    ) -> Self {
        Self {
            count,
            layer,
            start,
            dock,
            waypoints,
            keep_out_m: 300.0,
            sonar_range_m: 1000.0,
            birth: Birth::paper(),
            field: FieldSettings::campaign(),
        }
    }

    /// The obstacles at mission time 0, obstacle `i` of class `i mod 4`. An obstacle for which 1000 attempts
    /// find no free position is left out.
    #[must_use]
    pub fn generate(&self, seed: Seed) -> Vec<Obstacle> {
        (0..self.count)
            .filter_map(|i| self.one(ObstacleClass::ALL[i % 4], seed.split(i as u64)))
            .collect()
    }

    /// The field of these obstacles, with keep-out balls around start and destination.
    ///
    /// # Errors
    /// Everything malformed about the settings.
    pub fn build(&self, seed: Seed) -> Result<ObstacleField, Violations> {
        let mut settings = self.field.clone();
        for centre in [self.start, self.dock] {
            settings.keep_out.push(KeepOut {
                centre,
                radius_m: self.keep_out_m,
            });
        }
        let mut violations = Violations::new();
        violations.absorb("birth.", self.birth.validate());
        violations.require(self.layer.is_valid(), "layer", || {
            "is not finite or not ordered; give low <= high".into()
        });
        violations.into_result()?;
        ObstacleField::new(self.generate(seed.split(0)), settings, seed.split(1))
    }

    /// The number of obstacles for which on average `per_leg` of them have their surface within `near_m` of
    /// a leg's straight line at departure. Estimated from 2000 obstacles and up to 400 legs.
    #[must_use]
    pub fn count_for_density(
        &self,
        legs: &[(Point3<f64>, Point3<f64>)],
        per_leg: f64,
        near_m: f64,
        seed: Seed,
    ) -> usize {
        let stride = legs.len().div_ceil(400).max(1);
        let (mut near, mut pairs) = (0_u64, 0_u64);
        for i in 0..2000 {
            let Some(obstacle) = self.one(ObstacleClass::ALL[i % 4], seed.split(i as u64)) else {
                continue;
            };
            for (from, to) in legs.iter().step_by(stride) {
                let gap_m = distance_to_segment_m(&obstacle.centre, from, to) - obstacle.radius_m;
                near += u64::from(gap_m <= near_m);
                pairs += 1;
            }
        }
        if near == 0 {
            return 0;
        }
        (per_leg * pairs as f64 / near as f64).round() as usize
    }

    fn one(&self, class: ObstacleClass, seed: Seed) -> Option<Obstacle> {
        let mut random = seed.stream(0);
        let reach = match class {
            // A radius drawn later may be larger than the initial one.
            ObstacleClass::Uncertain => 1.0 + 3.0 * self.field.fluctuation_ratio,
            ObstacleClass::Static | ObstacleClass::Moving | ObstacleClass::Drifting => 1.0,
        };
        (0..1000).find_map(|_| {
            let radius_m = self.birth.radius_m(&mut random);
            let mut axis = |k: usize| {
                let share: f64 = random.random();
                self.layer.low[k] + share * (self.layer.high[k] - self.layer.low[k])
            };
            let centre = Point3::new(axis(0), axis(1), axis(2));
            let outside = |place: &Point3<f64>, distance_m: f64| {
                (centre - place).norm() - reach * radius_m >= distance_m
            };
            let free = outside(&self.start, self.sonar_range_m.max(self.keep_out_m))
                && outside(&self.dock, self.keep_out_m)
                && self.waypoints.iter().all(|w| outside(w, self.keep_out_m));
            free.then(|| self.birth.obstacle(class, centre, radius_m, &mut random))
        })
    }
}

/// Distance from a point to a straight segment, metres.
fn distance_to_segment_m(point: &Point3<f64>, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    let along = to - from;
    let square = along.norm_squared();
    let share = if square > 0.0 {
        ((point - from).dot(&along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (point - (from + along * share)).norm()
}
