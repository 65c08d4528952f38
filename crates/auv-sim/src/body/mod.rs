//! The bodies that a simulated vehicle may have.

mod autopilot;
mod remus100;
mod steered;

use auv_planning::Vehicle;
use auv_types::Violations;

pub(crate) use steered::SteeredRemus;

/// The body of the simulated vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Body {
    /// A point that is where its trajectory says, but for its guidance error and for what its speed allows.
    #[default]
    Point,
    /// A REMUS 100 in six degrees of freedom with an autopilot, steered by set-points alone
    /// ([`auv_mission::set_point`]). It has no guidance error but its own. Its greatest speed is 2.5 m/s and its least
    /// turn radius 21 m at 1.5 m/s: the mission's vehicle must ask for no more.
    Remus100,
}

impl Body {
    /// All bodies.
    pub const ALL: [Self; 2] = [Self::Point, Self::Remus100];

    /// The name in mission files and on command lines.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Remus100 => "remus100",
        }
    }

    /// What the mission's vehicle asks for and the body cannot do.
    #[must_use]
    pub fn validate(self, vehicle: &Vehicle) -> Violations {
        let mut violations = Violations::new();
        if self == Self::Point {
            return violations;
        }
        for (name, asked, can) in excesses(vehicle, most_pitch_rad(vehicle.speed_mps), 21.0) {
            violations.push(name, format!("is {asked}; {can}"));
        }
        violations
    }

    /// The vehicle within what the body does with a margin, and what was changed.
    #[must_use]
    pub fn within(self, vehicle: Vehicle) -> (Vehicle, Vec<String>) {
        if self == Self::Point {
            return (vehicle, Vec::new());
        }
        let speed_mps = vehicle.speed_mps.min(CRUISE_MPS);
        let pitch_rad = PLANNED_PITCH * most_pitch_rad(speed_mps);
        let told = excesses(&vehicle, pitch_rad, PLANNED_RADIUS_M);
        let told = told.into_iter().map(|(name, asked, can)| {
            format!("vehicle.{name} is {asked}, and {can}: it is planned with what it can")
        });
        let within = Vehicle {
            speed_mps,
            max_speed_mps: vehicle.max_speed_mps.min(MOST_MPS),
            min_speed_mps: vehicle.min_speed_mps.max(LEAST_MPS).min(speed_mps),
            turn_radius_m: vehicle.turn_radius_m.max(PLANNED_RADIUS_M),
            max_pitch_rad: vehicle.max_pitch_rad.min(pitch_rad),
        };
        (within, told.collect())
    }

    /// The body of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|body| body.as_str() == name)
    }
}

/// A REMUS 100: greatest and least speed, m/s, and the greatest at which it can still make up for being late.
const MOST_MPS: f64 = 2.5;
const LEAST_MPS: f64 = 0.5;
const CRUISE_MPS: f64 = 2.2;
/// Plans turn more widely than the 21 m of full rudder, metres, and pitch by this share of the most.
const PLANNED_RADIUS_M: f64 = 25.0;
const PLANNED_PITCH: f64 = 0.8;

/// The steepest way of a REMUS 100 at a speed, with full stern planes, radians: they must hold it against its
/// righting moment. Fitted to the simulated body from 0.8 to 1.6 m/s.
fn most_pitch_rad(speed_mps: f64) -> f64 {
    (0.157 * speed_mps * speed_mps - 0.025).clamp(0.02, 0.5)
}

/// What a vehicle asks of a REMUS 100 beyond a pitch, a turn radius and its speeds: name, value, and what it can.
fn excesses(vehicle: &Vehicle, pitch_rad: f64, radius_m: f64) -> Vec<(&'static str, f64, String)> {
    let (cruise_mps, most_mps) = (vehicle.speed_mps, vehicle.max_speed_mps);
    let (least_mps, asked_rad) = (vehicle.min_speed_mps, vehicle.max_pitch_rad);
    let asked = [
        (
            cruise_mps > CRUISE_MPS,
            "speed_mps",
            cruise_mps,
            format!("a REMUS 100 cruises at {CRUISE_MPS} m/s at most"),
        ),
        (
            most_mps > MOST_MPS,
            "max_speed_mps",
            most_mps,
            format!("a REMUS 100 makes {MOST_MPS} m/s at most"),
        ),
        (
            least_mps < LEAST_MPS,
            "min_speed_mps",
            least_mps,
            format!("a REMUS 100 steers from {LEAST_MPS} m/s on"),
        ),
        (
            vehicle.turn_radius_m < radius_m,
            "turn_radius_m",
            vehicle.turn_radius_m,
            format!("a REMUS 100 needs {radius_m} m, turn margin included"),
        ),
        (
            asked_rad > pitch_rad,
            "max_pitch_rad",
            asked_rad,
            format!(
                "a REMUS 100 pitches by {pitch_rad:.3} rad at most at {:.2} m/s",
                cruise_mps.min(CRUISE_MPS)
            ),
        ),
    ];
    let asked = asked.into_iter().filter(|(beyond, ..)| *beyond);
    asked
        .map(|(_, name, value, can)| (name, value, can))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vehicle_is_brought_within_what_the_body_can_and_told_so() {
        let usual = Vehicle {
            turn_radius_m: 25.0,
            ..Vehicle::default()
        };
        assert_eq!(Body::Remus100.within(usual), (usual, Vec::new()));
        let wild = Vehicle {
            speed_mps: 2.4,
            min_speed_mps: 0.0,
            max_speed_mps: 3.3,
            turn_radius_m: 8.0,
            max_pitch_rad: 0.6,
        };
        assert_eq!(
            Body::Remus100
                .validate(&wild)
                .to_string()
                .matches("REMUS")
                .count(),
            5
        );
        let (can, told) = Body::Remus100.within(wild);
        assert_eq!(told.len(), 5, "{told:?}");
        assert!(Body::Remus100.validate(&can).is_empty());
        let slow = Vehicle {
            speed_mps: 1.0,
            ..usual
        };
        let (can, told) = Body::Remus100.within(slow);
        assert!((can.max_pitch_rad - 0.1056).abs() < 1e-9);
        assert!(told[0].contains("max_pitch_rad is 0.26"), "{told:?}");
        assert_eq!(Body::Point.within(wild), (wild, Vec::new()));
    }
}
