//! What the check of a trajectory finds.

use crate::obstacles::ClosestApproach;
use auv_types::Point3;
use thiserror::Error;

/// One thing wrong with a trajectory. Of each kind the worst place is reported; each region that
/// comes too close is reported.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PathViolation {
    /// It has no points.
    #[error("the trajectory is empty")]
    Empty,
    /// A position or time is not finite; nothing else is checked then.
    #[error("point {point} is not finite")]
    NotFinite {
        /// Index of the point.
        point: usize,
    },
    /// Time does not advance although the position changes; nothing else is checked then.
    #[error("time does not advance to point {point}")]
    TimeStands {
        /// Index of the point.
        point: usize,
    },
    /// It starts elsewhere.
    #[error("begins {distance_m} m from the start")]
    WrongStart {
        /// Distance in metres.
        distance_m: f64,
    },
    /// It starts at another time.
    #[error("departs at {time_s} s, not at {expected_s} s")]
    WrongDeparture {
        /// When it starts, seconds.
        time_s: f64,
        /// When it should, seconds.
        expected_s: f64,
    },
    /// It ends elsewhere.
    #[error("ends {distance_m} m from the target")]
    WrongTarget {
        /// Distance in metres.
        distance_m: f64,
    },
    /// Slower than the vehicle steers.
    #[error("segment {segment} takes {speed_mps} m/s through the water, less than {limit_mps}")]
    TooSlow {
        /// Index of the segment.
        segment: usize,
        /// Least speed through the water there, m/s.
        speed_mps: f64,
        /// The limit, m/s.
        limit_mps: f64,
    },
    /// Faster than the vehicle is.
    #[error("segment {segment} takes {speed_mps} m/s through the water, more than {limit_mps}")]
    TooFast {
        /// Index of the segment.
        segment: usize,
        /// Greatest speed through the water there, m/s.
        speed_mps: f64,
        /// The limit, m/s.
        limit_mps: f64,
    },
    /// Tighter than the vehicle turns (at point 0: from its velocity at the start).
    #[error("turns with a radius of {radius_m} m at point {point}; the least is {limit_m} m")]
    TurnsTooTight {
        /// Index of the vertex.
        point: usize,
        /// Turn radius there, metres.
        radius_m: f64,
        /// The least allowed, metres.
        limit_m: f64,
    },
    /// Steeper than the vehicle pitches.
    #[error("segment {segment} pitches by {pitch_rad} rad; the most is {limit_rad} rad")]
    TooSteep {
        /// Index of the segment.
        segment: usize,
        /// Angle to the horizontal, radians.
        pitch_rad: f64,
        /// The most allowed, radians.
        limit_rad: f64,
    },
    /// It leaves the box.
    #[error("point {point} lies {excess_m} m outside the box")]
    OutsideBox {
        /// Index of the point.
        point: usize,
        /// How far outside, metres.
        excess_m: f64,
    },
    /// It comes too near to the sea bed, or the bed's slope does not rule that out.
    #[error("altitude {altitude_m} m at {time_s} s, less than {required_m} m or not proven")]
    TooLow {
        /// Where, metres.
        place: Point3<f64>,
        /// When, seconds.
        time_s: f64,
        /// Altitude there, metres.
        altitude_m: f64,
        /// The least allowed there, metres.
        required_m: f64,
    },
    /// It comes too near to a region.
    #[error(
        "passes obstacle {obstacle} (region {region}) at {clearance} m at {time} s; the least is {required_m} m",
        obstacle = approach.obstacle.0, region = approach.region,
        clearance = approach.clearance_m, time = approach.time_s
    )]
    TooClose {
        /// How near, where and when.
        approach: ClosestApproach,
        /// The least clearance allowed, metres.
        required_m: f64,
    },
}

/// All figures of a trajectory and everything wrong with it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PathReport {
    /// Length over ground in metres (Eq. 16).
    pub length_m: f64,
    /// Duration in seconds.
    pub duration_s: f64,
    /// Least speed through the water, m/s (`+inf` when nothing takes time).
    pub min_speed_mps: f64,
    /// Greatest speed through the water, m/s.
    pub max_speed_mps: f64,
    /// Least turn radius at a vertex in metres (`+inf` when it never turns).
    pub min_turn_radius_m: f64,
    /// Greatest angle to the horizontal in radians.
    pub max_pitch_rad: f64,
    /// Least altitude of the places sampled in metres (`+inf` without a sea bed).
    pub min_altitude_m: f64,
    /// The closest approach to any region (`None`: no region exists at that time).
    pub closest: Option<ClosestApproach>,
    /// Everything wrong.
    pub violations: Vec<PathViolation>,
}

impl Default for PathReport {
    fn default() -> Self {
        Self {
            length_m: 0.0,
            duration_s: 0.0,
            min_speed_mps: f64::INFINITY,
            max_speed_mps: 0.0,
            min_turn_radius_m: f64::INFINITY,
            max_pitch_rad: 0.0,
            min_altitude_m: f64::INFINITY,
            closest: None,
            violations: Vec::new(),
        }
    }
}

impl PathReport {
    /// Whether the trajectory satisfies everything.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.violations.is_empty()
    }

    /// Least clearance to any region in metres (`+inf` when none exists at that time).
    #[must_use]
    pub fn min_clearance_m(&self) -> f64 {
        self.closest
            .map_or(f64::INFINITY, |closest| closest.clearance_m)
    }
}

/// The worst value seen and its index. A NaN is worst of all.
pub(crate) struct Worst {
    sign: f64,
    worst: Option<(usize, f64)>,
}

impl Worst {
    /// The least value is the worst.
    pub(crate) fn least() -> Self {
        Self {
            sign: -1.0,
            worst: None,
        }
    }

    /// The greatest value is the worst.
    pub(crate) fn greatest() -> Self {
        Self {
            sign: 1.0,
            worst: None,
        }
    }

    pub(crate) fn see(&mut self, value: f64, index: usize) {
        if self
            .worst
            .is_none_or(|(_, worst)| !(self.sign * value <= self.sign * worst) && !worst.is_nan())
        {
            self.worst = Some((index, value));
        }
    }

    /// The worst value if it is beyond the limit.
    pub(crate) fn beyond(&self, limit: f64) -> Option<(usize, f64)> {
        self.worst
            .filter(|(_, worst)| !(self.sign * worst <= self.sign * limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_value_is_kept_and_nan_is_worst() {
        let mut least = Worst::least();
        assert_eq!(least.beyond(5.0), None);
        for (i, value) in [7.0, 3.0, 4.0, 3.0].into_iter().enumerate() {
            least.see(value, i);
        }
        assert_eq!(
            (least.beyond(5.0), least.beyond(3.0)),
            (Some((1, 3.0)), None)
        );
        least.see(f64::NAN, 4);
        least.see(-9.0, 5);
        assert!(
            least
                .beyond(-1e9)
                .is_some_and(|(i, worst)| i == 4 && worst.is_nan())
        );
        let mut greatest = Worst::greatest();
        greatest.see(2.0, 0);
        greatest.see(1.0, 1);
        assert_eq!(
            (greatest.beyond(1.5), greatest.beyond(2.0)),
            (Some((0, 2.0)), None)
        );
    }
}
