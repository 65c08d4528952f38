//! Faults of the sea: uncharted obstacles and an unforecast current.

use super::Intensity;
use super::injection::Injection;
use crate::Scenario;
use crate::disturbance::Moment;
use auv_obstacles::Region;
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed, Vector3};

/// Fault 8: obstacles block or enclose the vehicle.
pub(super) struct Enclosed {
    pub(super) intensity: Intensity,
    pub(super) seed: Seed,
}

impl Injection for Enclosed {
    /// The enclosure is permanent: shorter timeouts end the run earlier.
    fn prepare(&mut self, scenario: &mut Scenario) {
        if self.intensity.degree() == 4 {
            scenario.settings.waiting.retry_s = 200.0;
            scenario.settings.watchdogs.timeout_factor = 1.2;
        }
    }

    fn start(&mut self, now: &Moment, obstacles: &mut Vec<Region>) {
        let until_s = self.intensity.of([900.0, 900.0, 300.0, f64::INFINITY]);
        let mut add = |centre: Point3<f64>, radius_m: f64| {
            obstacles.push(Region {
                from_s: now.time_s,
                until_s: now.time_s + until_s,
                ..Region::ball(centre, radius_m)
            });
        };
        let ahead = now.ahead();
        let level = Vector3::new(-ahead.y, ahead.x, 0.0);
        let across = level.try_normalize(1e-6).unwrap_or_else(Vector3::y);
        match self.intensity.degree() {
            1 => add(now.target, 100.0),
            2 => {
                let middle = now.position + ahead * 400.0;
                for k in -8..=8 {
                    add(middle + across * (120.0 * f64::from(k)), 100.0);
                }
            }
            _ => {
                // The balls overlap their neighbours: there is no gap at any depth.
                let turn = self.seed.stream(0).random_range(0.0..1.0);
                for direction in all_round(turn) {
                    add(now.position + direction * 250.0, 140.0);
                }
            }
        }
    }
}

/// 26 directions, 45 degrees from one to the next.
fn all_round(turn: f64) -> impl Iterator<Item = Vector3<f64>> {
    let rings = [-0.5, -0.25, 0.0, 0.25, 0.5];
    rings.into_iter().flat_map(move |elevation: f64| {
        let count = if elevation.abs() > 0.4 { 1 } else { 8 };
        (0..count).map(move |k| {
            let (up, flat) = auv_types::libm::sincos(elevation * std::f64::consts::PI);
            let bearing = std::f64::consts::TAU * (f64::from(k) + turn) / 8.0;
            let (sin, cos) = auv_types::libm::sincos(bearing);
            Vector3::new(cos * flat, sin * flat, up)
        })
    })
}

/// Fault 9: an uncharted obstacle appears ahead.
pub(super) struct Sudden {
    pub(super) intensity: Intensity,
}

impl Injection for Sudden {
    fn start(&mut self, now: &Moment, obstacles: &mut Vec<Region>) {
        const RADIUS_M: f64 = 10.0;
        let distance_m = self.intensity.of([160.0, 80.0, 40.0, 20.0]) + RADIUS_M;
        let heading = now.velocity.try_normalize(1e-6);
        let centre = now.position + heading.unwrap_or_else(|| now.ahead()) * distance_m;
        obstacles.push(Region {
            from_s: now.time_s,
            ..Region::ball(centre, RADIUS_M)
        });
    }
}

/// Fault 15: an unforecast current.
pub(super) struct Current {
    intensity: Intensity,
    side: f64,
    velocity: Vector3<f64>,
}

impl Current {
    const LASTS_S: f64 = 600.0;

    pub(super) fn new(intensity: Intensity, seed: Seed) -> Self {
        let right = seed.stream(0).random::<bool>();
        Self {
            intensity,
            side: if right { 1.0 } else { -1.0 },
            velocity: Vector3::zeros(),
        }
    }
}

impl Injection for Current {
    fn start(&mut self, now: &Moment, _obstacles: &mut Vec<Region>) {
        let mut ahead = now.ahead();
        ahead.z = 0.0;
        let speed_mps = now.velocity.norm();
        let across = Vector3::new(-ahead.y, ahead.x, 0.0) * self.side;
        let strength = self.intensity.of([0.3, 0.6, 1.2, 1.2]) * speed_mps;
        self.velocity = if self.intensity.degree() == 1 {
            across
        } else {
            -ahead
        } * strength;
    }

    fn water(&self, since_s: f64) -> Vector3<f64> {
        let reversed = self.intensity.degree() == 4 && (since_s / 120.0).floor() % 2.0 >= 1.0;
        if since_s >= Self::LASTS_S {
            Vector3::zeros()
        } else if reversed {
            -self.velocity
        } else {
            self.velocity
        }
    }
}
