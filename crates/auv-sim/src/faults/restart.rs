//! A crash and a restart of the vehicle's software.

use super::Intensity;
use super::injection::Injection;
use crate::disturbance;
use auv_mission::{Checkpoint, ResumeError, Synchroniser};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed};
use std::sync::Arc;

/// Fault 24: the software crashes and restarts.
pub(super) struct Restart {
    intensity: Intensity,
    random: ChaCha8Rng,
    /// The last complete checkpoint.
    stored: Option<String>,
    done: bool,
}

impl Restart {
    const DOWN_S: f64 = 60.0;

    pub(super) fn new(intensity: Intensity, seed: Seed) -> Self {
        Self {
            intensity,
            random: seed.stream(0),
            stored: None,
            done: false,
        }
    }

    /// The text with one to three bits flipped, and cut short with probability 1/2.
    fn damaged(&mut self, text: &str) -> String {
        let mut bytes = text.as_bytes().to_vec();
        if self.random.random::<bool>() {
            bytes.truncate(self.random.random_range(0..bytes.len()));
        }
        for _ in 0..self.random.random_range(1..=3) {
            if !bytes.is_empty() {
                let at = self.random.random_range(0..bytes.len());
                bytes[at] ^= 1 << self.random.random_range(0..7);
            }
        }
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

impl Injection for Restart {
    fn is_down(&self, since_s: f64) -> bool {
        self.intensity.degree() == 2 && self.stored.is_some() && since_s < Self::DOWN_S
    }

    fn pace(&self, since_s: f64) -> f64 {
        if self.is_down(since_s) { 0.0 } else { 1.0 }
    }

    fn restart(&mut self, synchroniser: &mut Synchroniser) -> Result<disturbance::Restart, String> {
        if self.done {
            return Ok(disturbance::Restart::None);
        }
        let now = synchroniser.save().to_text().map_err(|e| e.to_string())?;
        let Some(stored) = self.stored.take() else {
            self.stored = Some(now);
            return Ok(disturbance::Restart::None);
        };
        self.done = true;
        let mission = Arc::clone(synchroniser.mission());
        match self.intensity.degree() {
            3 => {
                let damaged = self.damaged(&now);
                if damaged != now && Checkpoint::from_text(&damaged).is_ok() {
                    return Err("a damaged checkpoint was accepted".into());
                }
            }
            4 => {
                let mut other = (*mission).clone();
                other.budget_s += 1.0;
                let checkpoint = Checkpoint::from_text(&now).map_err(|e| e.to_string())?;
                let resumed = Synchroniser::resume(Arc::new(other), checkpoint);
                if !matches!(resumed, Err(ResumeError::WrongMission { .. })) {
                    return Err("a checkpoint of another mission was resumed".into());
                }
            }
            _ => {}
        }
        let text = if self.intensity.degree() == 1 {
            now
        } else {
            stored
        };
        let checkpoint = Checkpoint::from_text(&text).map_err(|e| e.to_string())?;
        *synchroniser = Synchroniser::resume(mission, checkpoint).map_err(|e| e.to_string())?;
        Ok(if self.intensity.degree() == 2 {
            disturbance::Restart::WithoutTracks
        } else {
            disturbance::Restart::WithTracks
        })
    }
}
