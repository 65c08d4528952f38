//! The true obstacles of a mission, advanced in mission time.

use super::growth::{Eq5, Growth};
use super::obstacle::{Obstacle, ObstacleClass};
use super::ship::TrackedShip;
use crate::random::{in_cube, normal, normal_pair_from};
use crate::{ObstacleId, Region, RegionShape, TimedPoint};
use auv_types::{ChaCha8Rng, Point3, Seed, Vector3, Violations, libm};

/// A ball that no obstacle's surface enters. Moving obstacles are reflected; drifting ones slide along it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct KeepOut {
    /// Centre, metres.
    pub centre: Point3<f64>,
    /// Radius, metres.
    pub radius_m: f64,
}

/// Parameters of the obstacles' equations.
///
/// The paper's equations are per step; `paper_step_s` is the duration of that step. For other steps the
/// random parts are scaled so that their variance grows at the same rate: increments by
/// `sqrt(dt / paper_step)`, drifts by `dt / paper_step`. A class 2 radius is drawn once per paper step and
/// is constant between draws, for any step.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct FieldSettings {
    /// Duration of one step of the paper's equations, seconds. Its "iteration" and "time" are read
    /// as mission time.
    pub paper_step_s: f64,
    /// Jitter of moving obstacles (Eq. 4): half the width of the uniform increment per axis and step, m/s.
    pub jitter_mps: f64,
    /// Class 2: standard deviation of the radius as a share of the initial radius r0. Draws are clipped to
    /// `[min_radius_m, r0 + 3 sigma]`.
    pub fluctuation_ratio: f64,
    /// Smallest radius, metres.
    pub min_radius_m: f64,
    /// Class 4: greatest radius as a multiple of the initial radius.
    pub max_growth: f64,
    /// Greatest radius of an obstacle of the four classes, metres (may be `+inf`).
    #[cfg_attr(feature = "serde", serde(with = "crate::unbounded"))]
    pub max_radius_m: f64,
    /// Eq. 5: initial growth state.
    pub first_rate: f64,
    /// Eq. 5: standard deviation of X, per step.
    pub rate_noise: f64,
    /// Eq. 5 with or without guards.
    pub eq5: Eq5,
    /// Balls that no obstacle enters at any time, for all classes and shapes.
    pub keep_out: Vec<KeepOut>,
}

impl FieldSettings {
    /// The paper's equations: 10 s, 0.1 m/s, 0.2 r0, 10 m, at most 4 r0, X ~ N(0, 0.1).
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            paper_step_s: 10.0,
            jitter_mps: 0.1,
            fluctuation_ratio: 0.2,
            min_radius_m: 10.0,
            max_growth: 4.0,
            max_radius_m: f64::INFINITY,
            first_rate: 1.0,
            rate_noise: 0.1,
            eq5: Eq5::Guarded,
            keep_out: Vec::new(),
        }
    }

    /// Values for whole missions: the paper's with radii of at most 250 m.
    #[must_use]
    pub const fn campaign() -> Self {
        let mut settings = Self::paper();
        settings.max_radius_m = 250.0;
        settings
    }

    /// Every invalid value.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_positive(self.paper_step_s, "paper_step_s");
        violations.require_not_negative(self.jitter_mps, "jitter_mps");
        violations.require_not_negative(self.fluctuation_ratio, "fluctuation_ratio");
        violations.require_not_negative(self.min_radius_m, "min_radius_m");
        violations.require(self.max_growth >= 1.0, "max_growth", || {
            format!("is {}; give at least 1", self.max_growth)
        });
        violations.require(
            self.max_radius_m >= self.min_radius_m && self.max_radius_m > 0.0,
            "max_radius_m",
            || format!("is {}; give at least min_radius_m", self.max_radius_m),
        );
        violations.require(self.first_rate.is_finite(), "first_rate", || {
            "is not finite; give a number".into()
        });
        violations.require_not_negative(self.rate_noise, "rate_noise");
        for (i, ball) in self.keep_out.iter().enumerate() {
            violations.require_positive(ball.radius_m, &format!("keep_out[{i}].radius_m"));
            violations.require(
                ball.centre.iter().all(|x| x.is_finite()),
                &format!("keep_out[{i}].centre"),
                || "is not finite; give metres".into(),
            );
        }
        violations
    }
}

impl Default for FieldSettings {
    /// Obstacles of coastal waters, slower and steadier than the paper's: jitter of 0.02 m/s, fluctuation
    /// of 10 %, radii from 1 m to 250 m, growth to at most 1.5 r0. A mission file's `preset = "default"`
    /// has the same values.
    fn default() -> Self {
        Self {
            jitter_mps: 0.02,
            fluctuation_ratio: 0.1,
            min_radius_m: 1.0,
            max_growth: 1.5,
            ..Self::campaign()
        }
    }
}

/// The true obstacles at the present mission time.
///
/// # Determinism
/// Every obstacle has its own random stream, and a class 2 radius is a hash of seed, obstacle and step:
/// nothing depends on the order of evaluation.
#[derive(Clone, Debug)]
pub struct ObstacleField {
    settings: FieldSettings,
    seed: Seed,
    time_s: f64,
    bodies: Vec<Body>,
    ships: Vec<TrackedShip>,
    regions: Vec<Region>,
    now: Vec<Region>,
}

#[derive(Clone, Debug)]
struct Body {
    obstacle: Obstacle,
    random: ChaCha8Rng,
    growth: Growth,
    /// Present centre and radius. `obstacle.velocity_mps` is the present velocity through the water.
    centre: Point3<f64>,
    radius_m: f64,
    /// Velocity without jitter, and growth, over the last step.
    velocity_mps: Vector3<f64>,
    growth_mps: f64,
}

impl ObstacleField {
    /// The obstacles at mission time 0. Obstacle `i` gets [`ObstacleId`] `i`.
    ///
    /// # Errors
    /// Everything malformed about the settings and the obstacles.
    pub fn new(
        obstacles: Vec<Obstacle>,
        settings: FieldSettings,
        seed: Seed,
    ) -> Result<Self, Violations> {
        let mut violations = settings.validate();
        for (i, obstacle) in obstacles.iter().enumerate() {
            obstacle.validate_into(&format!("obstacles[{i}]"), &mut violations);
        }
        violations.into_result()?;
        let bodies = obstacles
            .into_iter()
            .enumerate()
            .map(|(i, obstacle)| Body::new(obstacle, &settings, seed, i as u64))
            .collect();
        let mut field = Self {
            settings,
            seed,
            time_s: 0.0,
            bodies,
            ships: Vec::new(),
            regions: Vec::new(),
            now: Vec::new(),
        };
        field.refresh(0.0);
        Ok(field)
    }

    /// The same field with ships. Their ids follow those of the obstacles.
    #[must_use]
    pub fn with_ships(mut self, ships: Vec<TrackedShip>) -> Self {
        self.ships = ships;
        self.refresh(0.0);
        self
    }

    /// Advances mission time by one step; `current(place, time)` is the water's velocity in m/s. A step that
    /// is not finite or not positive changes nothing. A current that is not finite counts as zero.
    pub fn step(&mut self, dt_s: f64, current: &dyn Fn(&Point3<f64>, f64) -> Vector3<f64>) {
        if !(dt_s.is_finite() && dt_s > 0.0) {
            return;
        }
        let start_s = self.time_s;
        let interval = libm::floor((start_s + 0.5 * dt_s) / self.settings.paper_step_s) as u64;
        self.regions.clear();
        for (i, body) in self.bodies.iter_mut().enumerate() {
            let before = (body.centre, body.radius_m);
            if start_s + dt_s >= body.obstacle.appears_s {
                match body.obstacle.class {
                    ObstacleClass::Static => {}
                    ObstacleClass::Uncertain => {
                        body.fluctuate(&self.settings, self.seed, i as u64, interval)
                    }
                    ObstacleClass::Moving => body.advance(dt_s, Vector3::zeros(), &self.settings),
                    ObstacleClass::Drifting => {
                        let water = current(&body.centre, start_s);
                        let finite = water.iter().all(|x| x.is_finite());
                        let water = if finite { water } else { Vector3::zeros() };
                        body.grow(dt_s, water.norm(), &self.settings);
                        body.advance(dt_s, water, &self.settings);
                    }
                }
            }
            self.regions
                .push(body.over_step(i as u32, start_s, dt_s, before));
        }
        self.time_s = start_s + dt_s;
        self.refresh(start_s);
    }

    /// Rebuilds the regions for the present time. Ships cover their track since `start_s`.
    fn refresh(&mut self, start_s: f64) {
        let count = self.bodies.len();
        if self.time_s <= start_s {
            self.regions.clear();
            for (i, body) in self.bodies.iter().enumerate() {
                let before = (body.centre, body.radius_m);
                self.regions
                    .push(body.over_step(i as u32, start_s, 0.0, before));
            }
        }
        self.now.clear();
        for (i, body) in self.bodies.iter().enumerate() {
            self.now.push(body.henceforth(i as u32, self.time_s));
        }
        for (k, ship) in self.ships.iter().enumerate() {
            let id = ObstacleId((count + k) as u32);
            ship.regions_into(id, start_s, self.time_s, &mut self.regions);
            self.now.extend(ship.region_at(id, self.time_s));
        }
    }

    /// Present mission time, seconds.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// The exact truth over the last step: the regions covered from `t - dt` to `t`. Positions and radii are
    /// linear in time; a class 2 radius is constant; a ship that passes a fix gives two regions. Before the
    /// first step it is the truth at time 0.
    #[must_use]
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// The obstacles at the present time with their mean velocities and growth, extrapolated: what a sonar
    /// measures and what perfect prediction knows.
    #[must_use]
    pub fn now(&self) -> &[Region] {
        &self.now
    }

    /// The charted obstacles (class 1), exact and at all times.
    #[must_use]
    pub fn charted(&self) -> Vec<Region> {
        let charted = |(i, body): (usize, &Body)| {
            (body.obstacle.class == ObstacleClass::Static).then(|| Region {
                obstacle: ObstacleId(i as u32),
                shape: body.obstacle.shape,
                ..Region::ball(body.centre, body.radius_m)
            })
        };
        self.bodies.iter().enumerate().filter_map(charted).collect()
    }

    /// The class of an obstacle; `None` for ships and unknown ids.
    #[must_use]
    pub fn class(&self, id: ObstacleId) -> Option<ObstacleClass> {
        let body = self.bodies.get(usize::try_from(id.0).ok()?)?;
        Some(body.obstacle.class)
    }

    /// The ships.
    #[must_use]
    pub fn ships(&self) -> &[TrackedShip] {
        &self.ships
    }

    /// Signed distance from a position to the nearest surface at the present time, metres; negative inside,
    /// `+inf` without obstacles.
    #[must_use]
    pub fn distance_m(&self, place: &Point3<f64>) -> f64 {
        let here = TimedPoint::new(*place, self.time_s);
        let distance = |region: &Region| region.distance_m(&here);
        self.now.iter().map(distance).fold(f64::INFINITY, f64::min)
    }
}

impl Body {
    fn new(obstacle: Obstacle, settings: &FieldSettings, seed: Seed, index: u64) -> Self {
        let mut body = Self {
            obstacle,
            random: seed.stream(index),
            growth: Growth {
                radius_m: obstacle.radius_m,
                rate: settings.first_rate,
                uncertainty_m: 0.0,
            },
            centre: obstacle.centre,
            radius_m: obstacle.radius_m,
            velocity_mps: Vector3::zeros(),
            growth_mps: 0.0,
        };
        match obstacle.class {
            ObstacleClass::Static => {}
            ObstacleClass::Uncertain => body.fluctuate(settings, seed, index, 0),
            ObstacleClass::Moving | ObstacleClass::Drifting => {
                body.velocity_mps = obstacle.velocity_mps
            }
        }
        body
    }

    /// Class 2: a new radius for each of the paper's steps.
    fn fluctuate(&mut self, settings: &FieldSettings, seed: Seed, index: u64, interval: u64) {
        let hash = seed.split(index).split(interval);
        let unit = |bits: u64| (bits >> 11) as f64 / (1_u64 << 53) as f64;
        let (draw, _) = normal_pair_from(unit(hash.0), unit(hash.split(1).0));
        let sigma_m = settings.fluctuation_ratio * self.obstacle.radius_m;
        let highest_m = (self.obstacle.radius_m + 3.0 * sigma_m).min(settings.max_radius_m);
        self.radius_m = (self.obstacle.radius_m + sigma_m * draw)
            .max(settings.min_radius_m)
            .min(highest_m);
    }

    /// Eq. 5 over `dt_s`, in steps' worth of noise.
    fn grow(&mut self, dt_s: f64, current_mps: f64, settings: &FieldSettings) {
        let steps = dt_s / settings.paper_step_s;
        let noise = settings.rate_noise * libm::sqrt(steps) * normal(&mut self.random);
        let drift_m = current_mps * self.obstacle.uncertainty_m * steps;
        let before_m = self.radius_m;
        match settings.eq5 {
            Eq5::Literal => {
                self.growth = self.growth.stepped(current_mps, dt_s, noise, drift_m);
                self.radius_m = self.growth.radius_m.max(0.0);
            }
            Eq5::Guarded => {
                let cap_m =
                    (settings.max_growth * self.obstacle.radius_m).min(settings.max_radius_m);
                self.growth = self
                    .growth
                    .stepped_guarded(current_mps, dt_s, noise, drift_m, cap_m);
                self.radius_m = (self.growth.radius_m + self.growth.uncertainty_m.abs()).min(cap_m);
            }
        }
        self.growth_mps = (self.radius_m - before_m) / dt_s;
    }

    /// Eq. 4 with the current, followed by reflection at the keep-out balls.
    fn advance(&mut self, dt_s: f64, water: Vector3<f64>, settings: &FieldSettings) {
        let half_m = settings.jitter_mps * libm::sqrt(dt_s * settings.paper_step_s);
        self.centre +=
            (self.obstacle.velocity_mps + water) * dt_s + in_cube(half_m, &mut self.random);
        let mut held_back = Vector3::zeros();
        for ball in &settings.keep_out {
            let offset = self.centre - ball.centre;
            let distance_m = offset.norm();
            let least_m = ball.radius_m + self.radius_m;
            if distance_m >= least_m {
                continue;
            }
            let outward = if distance_m > 0.0 {
                offset / distance_m
            } else {
                Vector3::x()
            };
            self.centre = ball.centre + outward * least_m;
            let inward_mps = -self.obstacle.velocity_mps.dot(&outward);
            if inward_mps > 0.0 {
                self.obstacle.velocity_mps += outward * (2.0 * inward_mps);
            }
            // The ball stops the velocity component towards it: a drifting obstacle slides along.
            let pushed_mps = -(self.obstacle.velocity_mps + water).dot(&outward);
            held_back += outward * pushed_mps.max(0.0);
        }
        self.velocity_mps = self.obstacle.velocity_mps + water + held_back;
    }

    fn over_step(&self, index: u32, start_s: f64, dt_s: f64, before: (Point3<f64>, f64)) -> Region {
        let (centre, radius_m) = before;
        let fluctuates = self.obstacle.class == ObstacleClass::Uncertain;
        let rate = if dt_s > 0.0 { 1.0 / dt_s } else { 0.0 };
        let rise = (self.centre - centre) * rate;
        Region {
            obstacle: ObstacleId(index),
            shape: self.shape(),
            at_s: start_s,
            from_s: start_s.max(self.obstacle.appears_s),
            until_s: (start_s + dt_s).max(self.obstacle.appears_s),
            centre,
            velocity_mps: rise,
            radius_m: if fluctuates { self.radius_m } else { radius_m },
            growth_mps: if fluctuates {
                0.0
            } else {
                (self.radius_m - radius_m) * rate
            },
        }
    }

    fn henceforth(&self, index: u32, time_s: f64) -> Region {
        Region {
            obstacle: ObstacleId(index),
            shape: self.shape(),
            at_s: time_s,
            from_s: time_s.max(self.obstacle.appears_s),
            until_s: f64::INFINITY,
            centre: self.centre,
            velocity_mps: self.velocity_mps,
            radius_m: self.radius_m,
            growth_mps: self.growth_mps,
        }
    }

    fn shape(&self) -> RegionShape {
        self.obstacle.shape
    }
}
