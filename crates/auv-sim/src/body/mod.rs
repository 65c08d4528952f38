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
        let mut require = |holds: bool, place: &str, value: f64, remedy: &str| {
            violations.require(holds, place, || format!("is {value}; a REMUS 100 {remedy}"));
        };
        let most_mps = vehicle.max_speed_mps;
        require(
            most_mps <= 2.5,
            "max_speed_mps",
            most_mps,
            "makes 2.5 m/s at most",
        );
        let least_mps = vehicle.min_speed_mps;
        require(
            least_mps >= 0.5,
            "min_speed_mps",
            least_mps,
            "steers from 0.5 m/s on",
        );
        let radius_m = vehicle.turn_radius_m;
        require(
            radius_m >= 21.0,
            "turn_radius_m",
            radius_m,
            "needs 21 m, turn margin included",
        );
        let pitch_rad = vehicle.max_pitch_rad;
        require(
            pitch_rad <= 0.5,
            "max_pitch_rad",
            pitch_rad,
            "pitches by 0.5 rad at most",
        );
        violations
    }

    /// The body of a name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|body| body.as_str() == name)
    }
}
