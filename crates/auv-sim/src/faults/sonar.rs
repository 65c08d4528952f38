//! Faults of the sonar: false, missing, stale, malformed and too many echoes.

use super::Intensity;
use super::injection::Injection;
use crate::disturbance::Moment;
use auv_obstacles::{Detection, Scan};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Seed, Vector3};
use std::collections::VecDeque;

/// Duration of most sonar faults, seconds.
const LASTS_S: f64 = 600.0;

fn echo(position: Point3<f64>, radius_m: f64) -> Detection {
    Detection {
        position,
        velocity: Some(Vector3::zeros()),
        radius_m,
        position_sigma_m: 5.0,
        velocity_sigma_mps: 0.05,
        radius_sigma_m: 5.0,
    }
}

/// An echo at a random position within `range_m` on each horizontal axis.
fn anywhere(from: &Point3<f64>, range_m: f64, random: &mut ChaCha8Rng) -> Detection {
    let mut side = || random.random_range(-range_m..range_m);
    let offset = Vector3::new(side(), side(), 0.1 * side());
    echo(from + offset, random.random_range(1.0..20.0))
}

/// Fault 10: false echoes.
pub(super) struct Ghosts {
    intensity: Intensity,
    random: ChaCha8Rng,
    shown: u32,
}

impl Ghosts {
    pub(super) fn new(intensity: Intensity, seed: Seed) -> Self {
        Self {
            intensity,
            random: seed.stream(0),
            shown: 0,
        }
    }
}

impl Injection for Ghosts {
    fn scans(&mut self, now: &Moment, scans: &mut Vec<Scan>) {
        let lasts_s = self.intensity.of([0.0, 0.0, 120.0, LASTS_S]);
        for scan in scans {
            if self.intensity.degree() <= 2 {
                if self.shown < self.intensity.of([1, 3, 0, 0]) {
                    let ghost = now.position + now.ahead() * 150.0;
                    scan.detections.push(echo(ghost, 30.0));
                    self.shown += 1;
                }
            } else if now.since_s < lasts_s {
                let clutter = (0..50).map(|_| anywhere(&scan.from, 700.0, &mut self.random));
                scan.detections.extend(clutter);
            }
        }
    }
}

/// Fault 11: no scans.
pub(super) struct Dropout {
    pub(super) intensity: Intensity,
}

impl Injection for Dropout {
    fn scans(&mut self, now: &Moment, scans: &mut Vec<Scan>) {
        if now.since_s < self.intensity.of([1.0, 60.0, LASTS_S, f64::INFINITY]) {
            scans.clear();
        }
    }
}

/// Fault 12: stale scans.
pub(super) struct StaleScans {
    intensity: Intensity,
    held: VecDeque<Scan>,
}

impl StaleScans {
    pub(super) fn new(intensity: Intensity) -> Self {
        Self {
            intensity,
            held: VecDeque::new(),
        }
    }
}

impl Injection for StaleScans {
    fn scans(&mut self, now: &Moment, scans: &mut Vec<Scan>) {
        if now.since_s >= LASTS_S && self.intensity.degree() < 4 {
            return;
        }
        match self.intensity.degree() {
            1 => scans.extend(scans.clone()),
            2 => {
                self.held.extend(scans.drain(..));
                if self.held.len() > 5 {
                    scans.extend(self.held.pop_front());
                }
            }
            3 => {
                // Two scans swap their order.
                self.held.extend(scans.drain(..));
                if self.held.len() == 2 {
                    scans.extend(self.held.drain(..).rev());
                }
            }
            _ => {
                for scan in scans {
                    let first = self.held.front().cloned();
                    match first {
                        // A sonar driver stamps old data with the present time.
                        Some(stuck) => {
                            scan.background = stuck.background;
                            scan.detections = stuck.detections;
                        }
                        None => self.held.push_back(scan.clone()),
                    }
                }
            }
        }
    }
}

/// Fault 13: malformed echoes.
pub(super) struct BadEchoes {
    intensity: Intensity,
    random: ChaCha8Rng,
}

impl BadEchoes {
    pub(super) fn new(intensity: Intensity, seed: Seed) -> Self {
        Self {
            intensity,
            random: seed.stream(0),
        }
    }

    fn spoil(&mut self, echo: &mut Detection) {
        match self.random.random_range(0..8) {
            0 => echo.position.x = f64::NAN,
            1 => echo.position *= 1e9,
            2 => echo.radius_m = f64::INFINITY,
            3 => echo.position_sigma_m = f64::NAN,
            4 => echo.position_sigma_m = -5.0,
            5 => echo.position_sigma_m = 0.0,
            6 => echo.velocity = Some(Vector3::new(0.0, f64::NEG_INFINITY, 0.0)),
            _ => echo.radius_sigma_m = f64::NAN,
        }
    }
}

impl Injection for BadEchoes {
    fn scans(&mut self, now: &Moment, scans: &mut Vec<Scan>) {
        if now.since_s >= LASTS_S {
            return;
        }
        let share = self.intensity.of([0.0, 0.25, 0.5, 1.0]);
        for scan in scans {
            for i in 0..scan.detections.len() {
                let only_one = self.intensity.degree() == 1 && i == 0;
                if only_one || self.random.random::<f64>() < share {
                    self.spoil(&mut scan.detections[i]);
                }
            }
        }
    }
}

/// Fault 14: too many echoes.
pub(super) struct Storm {
    intensity: Intensity,
    random: ChaCha8Rng,
}

impl Storm {
    pub(super) fn new(intensity: Intensity, seed: Seed) -> Self {
        Self {
            intensity,
            random: seed.stream(0),
        }
    }
}

impl Injection for Storm {
    fn scans(&mut self, now: &Moment, scans: &mut Vec<Scan>) {
        if now.since_s >= self.intensity.of([1.0, 1.0, 1.0, 60.0]) {
            return;
        }
        let count = self.intensity.of([100, 1_000, 10_000, 10_000]);
        for scan in scans {
            let echoes = (0..count).map(|_| anywhere(&scan.from, 900.0, &mut self.random));
            scan.detections.extend(echoes);
        }
    }
}
