//! Random numbers as a mission file states them: rounded, so that they are written short and read exactly.

use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed, libm};

/// How hard the missions of a draw are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hardness {
    /// As most coasts are.
    #[default]
    Usual,
    /// Slopes from 30 to 60 degrees, most waypoints at the lowest legal depth, wider turns, less pitch,
    /// stronger currents, more obstacles, a tight box.
    Hard,
}

/// A stream of random numbers.
pub(crate) struct Dice {
    rng: ChaCha8Rng,
    hardness: Hardness,
}

impl Dice {
    pub(crate) fn new(seed: Seed, stream: u64, hardness: Hardness) -> Self {
        Self {
            rng: seed.stream(stream),
            hardness,
        }
    }

    /// A value by the hardness of the draw.
    pub(crate) fn by_hardness<T>(&self, usual: T, hard: T) -> T {
        match self.hardness {
            Hardness::Usual => usual,
            Hardness::Hard => hard,
        }
    }

    /// The greatest slope of a flank, degrees: usually between `least` and 45.
    pub(crate) fn slope_deg(&mut self, least: f64) -> f64 {
        let [low, high] = self.by_hardness([least, 45.0], [30.0, 60.0]);
        self.between(low, high)
    }

    /// A number between two, uniformly.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.rng.random_range(low..high)
    }

    /// As [`Dice::between`], rounded to hundredths.
    pub(crate) fn hundredth(&mut self, low: f64, high: f64) -> f64 {
        hundredth(self.between(low, high))
    }

    /// As [`Dice::between`], rounded to whole numbers.
    pub(crate) fn whole(&mut self, low: f64, high: f64) -> f64 {
        self.between(low, high).round()
    }

    /// A count from `low` to `high`, both included.
    pub(crate) fn count(&mut self, low: usize, high: usize) -> usize {
        self.rng.random_range(low..=high)
    }

    /// Whether something of this probability happens.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    /// A direction on the map, a unit vector.
    pub(crate) fn direction(&mut self) -> [f64; 2] {
        let angle = self.between(0.0, std::f64::consts::TAU);
        [libm::cos(angle), libm::sin(angle)]
    }

    /// A point of the square of half side `half_m` about the origin, in whole metres.
    pub(crate) fn place(&mut self, half_m: f64) -> [f64; 2] {
        [self.whole(-half_m, half_m), self.whole(-half_m, half_m)]
    }
}

/// A number rounded to hundredths.
pub(crate) fn hundredth(x: f64) -> f64 {
    (x * 100.0).round() / 100.0
}
