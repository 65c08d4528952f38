//! Initial positions and sizes of obstacles (Eq. 2, 3).

use super::obstacle::{Obstacle, ObstacleClass};
use crate::random::normal;
use crate::{Region, TimedPoint};
use auv_types::rand::{Rng, RngExt};
use auv_types::{Point3, Seed, Vector3, Violations, libm};
use std::f64::consts::TAU;

/// Distributions of initial size and velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Birth {
    /// Standard deviation of the half-normal radius, metres. The paper's "~(0, 100)" allows negative
    /// radii, and gives very small ones if 100 is a variance; the magnitude of N(0, 100²) is used.
    pub radius_sigma_m: f64,
    /// Smallest radius, metres.
    pub min_radius_m: f64,
    /// Greatest initial radius, metres (may be `+inf`).
    #[cfg_attr(feature = "serde", serde(with = "crate::unbounded"))]
    pub max_radius_m: f64,
    /// Greatest speed through the water of a moving obstacle, m/s. The speed is uniform from 0.
    pub max_speed_mps: f64,
    /// Whether moving obstacles also move vertically. By default they do not: they would leave a layer of
    /// 100 m within minutes.
    pub vertical_motion: bool,
    /// Share of class 4 obstacles without a velocity through the water ("floating").
    pub floating_share: f64,
    /// Uncertainty U_r of class 4, metres.
    pub uncertainty_m: f64,
    /// Least standard deviation of a position between two waypoints, as a share of their distance, per axis
    /// (Eq. 3). With 0 the standard deviation is the radius, literally as in the paper: all obstacles of a
    /// long leg then overlap at its middle.
    pub spread: f64,
    /// Least distance of an obstacle's surface from the waypoints of its leg, metres.
    pub clearance_m: f64,
}

impl Birth {
    /// The paper's sizes and speeds, for whole missions: radii of at most 250 m. The same as
    /// `preset = "paper"`.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            radius_sigma_m: 100.0,
            min_radius_m: 10.0,
            max_radius_m: 250.0,
            max_speed_mps: 0.5,
            vertical_motion: false,
            floating_share: 0.5,
            uncertainty_m: 1.0,
            spread: 0.25,
            clearance_m: 10.0,
        }
    }

    /// The same for the paper's single legs: radii without a limit.
    #[must_use]
    pub const fn single_leg() -> Self {
        let mut birth = Self::paper();
        birth.max_radius_m = f64::INFINITY;
        birth
    }

    /// Every invalid value.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_not_negative(self.radius_sigma_m, "radius_sigma_m");
        violations.require_positive(self.min_radius_m, "min_radius_m");
        violations.require(
            self.max_radius_m >= self.min_radius_m,
            "max_radius_m",
            || format!("is {}; give at least min_radius_m", self.max_radius_m),
        );
        violations.require_not_negative(self.max_speed_mps, "max_speed_mps");
        violations.require(
            (0.0..=1.0).contains(&self.floating_share),
            "floating_share",
            || format!("is {}; give 0 to 1", self.floating_share),
        );
        violations.require_not_negative(self.uncertainty_m, "uncertainty_m");
        violations.require_not_negative(self.spread, "spread");
        violations.require_not_negative(self.clearance_m, "clearance_m");
        violations
    }

    /// A radius `max(r_min, |N(0, sigma²)|)`, limited to the greatest radius.
    pub(super) fn radius_m(&self, random: &mut impl Rng) -> f64 {
        (self.radius_sigma_m * normal(random).abs())
            .max(self.min_radius_m)
            .min(self.max_radius_m)
    }

    /// An obstacle of a class at a position, with a random velocity if its class has one.
    pub(super) fn obstacle(
        &self,
        class: ObstacleClass,
        centre: Point3<f64>,
        radius_m: f64,
        random: &mut impl Rng,
    ) -> Obstacle {
        let mut obstacle = Obstacle::new(class, centre, radius_m);
        obstacle.uncertainty_m = self.uncertainty_m;
        let moves = match class {
            ObstacleClass::Static | ObstacleClass::Uncertain => false,
            ObstacleClass::Moving => true,
            ObstacleClass::Drifting => random.random::<f64>() >= self.floating_share,
        };
        if moves {
            let speed = self.max_speed_mps * random.random::<f64>();
            let (sin, cos) = libm::sincos(TAU * random.random::<f64>());
            let down = if self.vertical_motion {
                2.0 * random.random::<f64>() - 1.0
            } else {
                0.0
            };
            let flat = libm::sqrt(1.0 - down * down);
            obstacle.velocity_mps = Vector3::new(cos * flat, sin * flat, down) * speed;
        }
        obstacle
    }
}

impl Default for Birth {
    /// Obstacles of coastal waters: radii |N(0, 30²)| from 2 m to 80 m, at most 0.3 m/s. A mission file's
    /// `preset = "default"` has the same values.
    fn default() -> Self {
        Self {
            radius_sigma_m: 30.0,
            min_radius_m: 2.0,
            max_radius_m: 80.0,
            max_speed_mps: 0.3,
            ..Self::paper()
        }
    }
}

/// The paper's four scenarios of a single leg (section 7).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum LegScenario {
    /// Scenario 1: a random mix of classes 1 and 2.
    Fixed,
    /// Scenario 2: class 3. The first three exist from the start, the others appear at equal fractions of
    /// the direct time.
    Moving,
    /// Scenario 3: class 4.
    Drifting,
    /// Scenario 4: all classes in turn.
    Mixed,
}

/// The obstacles of one leg between two waypoints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegObstacles {
    /// The scenario: which classes.
    pub scenario: LegScenario,
    /// Number of obstacles (the paper's figures show 3 to 6).
    pub count: usize,
    /// Departure, metres.
    pub from: Point3<f64>,
    /// Arrival, metres.
    pub to: Point3<f64>,
    /// The vehicle's speed, which gives the time of arrival, m/s.
    pub speed_mps: f64,
    /// The current that moves and widens class 4, m/s.
    pub current_mps: Vector3<f64>,
    /// Sizes and motion.
    pub birth: Birth,
}

impl LegObstacles {
    /// The obstacles at departure. Positions follow the truncated normal of Eq. 3. No obstacle covers a
    /// waypoint (Eq. 2) when it appears nor, according to its mean motion, around departure and arrival.
    /// An obstacle for which 10,000 attempts find no such position is left out.
    #[must_use]
    pub fn generate(&self, seed: Seed) -> Vec<Obstacle> {
        let mut obstacles = Vec::with_capacity(self.count);
        for i in 0..self.count {
            let mut random = seed.stream(i as u64);
            let class = match self.scenario {
                LegScenario::Fixed if random.random::<bool>() => ObstacleClass::Static,
                LegScenario::Fixed => ObstacleClass::Uncertain,
                LegScenario::Moving => ObstacleClass::Moving,
                LegScenario::Drifting => ObstacleClass::Drifting,
                LegScenario::Mixed => ObstacleClass::ALL[i % 4],
            };
            let direct_s = (self.to - self.from).norm() / self.speed_mps;
            let late = i.saturating_sub(2) as f64;
            let fraction = match self.scenario {
                LegScenario::Moving if i > 2 => late / (self.count as f64 - 2.0),
                _ => 0.0,
            };
            for _ in 0..10_000 {
                let radius_m = self.birth.radius_m(&mut random);
                let centre = self.place(radius_m, &mut random);
                let mut obstacle = self.birth.obstacle(class, centre, radius_m, &mut random);
                obstacle.appears_s = fraction * direct_s;
                if self.leaves_waypoints_free(&obstacle, direct_s) {
                    obstacles.push(obstacle);
                    break;
                }
            }
        }
        obstacles
    }

    fn place(&self, radius_m: f64, random: &mut impl Rng) -> Point3<f64> {
        let mut axis = |k: usize| {
            let (mut low, mut high) = (self.from[k].min(self.to[k]), self.from[k].max(self.to[k]));
            if high - low < 1.0 {
                (low, high) = (low - radius_m, high + radius_m);
            }
            truncated_normal(
                radius_m.max(self.birth.spread * (high - low)),
                low,
                high,
                random,
            )
        };
        Point3::new(axis(0), axis(1), axis(2))
    }

    fn leaves_waypoints_free(&self, obstacle: &Obstacle, direct_s: f64) -> bool {
        let drifts = obstacle.class == ObstacleClass::Drifting;
        let water = if drifts {
            self.current_mps
        } else {
            Vector3::zeros()
        };
        let region = Region {
            shape: obstacle.shape,
            at_s: obstacle.appears_s,
            from_s: obstacle.appears_s,
            velocity_mps: obstacle.velocity_mps + water,
            growth_mps: water.norm(),
            ..Region::ball(obstacle.centre, obstacle.radius_m)
        };
        let stays = |place: Point3<f64>, from_s: f64, until_s: f64| {
            let (from, to) = (
                TimedPoint::new(place, from_s),
                TimedPoint::new(place, until_s),
            );
            region.clearance(&from, &to).clearance_m >= self.birth.clearance_m
        };
        let at_birth = |place| stays(place, obstacle.appears_s, obstacle.appears_s);
        at_birth(self.from)
            && at_birth(self.to)
            && stays(self.from, 0.0, 60.0)
            && stays(self.to, direct_s - 60.0, 1.1 * direct_s + 60.0)
    }
}

/// A draw from the normal about the middle of `[low, high]`, truncated to that interval (Eq. 3). The
/// paper's mean is read as an offset from the middle: a mean of zero in world coordinates would place the
/// obstacles at the waypoint nearer the origin.
pub(super) fn truncated_normal(sigma: f64, low: f64, high: f64, random: &mut impl Rng) -> f64 {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    if sigma < half {
        loop {
            let offset = sigma * normal(random);
            if offset.abs() <= half {
                return middle + offset;
            }
        }
    }
    // Wide normal: rejection sampling from a uniform distribution.
    loop {
        let offset = half * (2.0 * random.random::<f64>() - 1.0);
        let z = offset / sigma;
        if random.random::<f64>() < libm::exp(-0.5 * z * z) {
            return middle + offset;
        }
    }
}
