//! What the vehicle does in an emergency, by its cause and by where the vehicle is then.

use crate::{AbortReason, Contingency};
use auv_ocean::{Footprint, MapPoint};
use auv_types::Point3;

/// Why a mission is given up, as an operator tells it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum EmergencyCause {
    /// The sonar has been silent for too long.
    SonarLost,
    /// The energy left is needed to surface.
    BatteryLow,
    /// Water in the vehicle ([`crate::Event::Leak`]).
    Leak,
    /// The position or the clock is lost.
    PositionLost,
    /// No way leads to the destination, or the mission lasted far beyond its budget.
    NoWayHome,
    /// No path led on for too long.
    ShutIn,
}

impl EmergencyCause {
    /// The cause behind a reason; `None` where no emergency tells it.
    #[must_use]
    pub const fn of(reason: AbortReason) -> Option<Self> {
        Some(match reason {
            AbortReason::SonarLost => Self::SonarLost,
            AbortReason::EnergySpent => Self::BatteryLow,
            AbortReason::Leak => Self::Leak,
            AbortReason::BadPosition | AbortReason::BadClock => Self::PositionLost,
            AbortReason::Unreachable | AbortReason::TimedOut => Self::NoWayHome,
            AbortReason::ShutIn => Self::ShutIn,
            AbortReason::NoAltitude | AbortReason::TooLow | AbortReason::CannotFollow => {
                return None;
            }
        })
    }
}

/// A ladder of contingencies for one cause, everywhere or within a polygon.
#[derive(Clone, Debug, PartialEq)]
pub struct Emergency {
    /// The cause.
    pub when: EmergencyCause,
    /// The corners of a polygon in which the vehicle must be then (`None`: anywhere).
    pub within: Option<Vec<MapPoint>>,
    /// What to do, in order of preference. An empty ladder ends the mission at once.
    pub ladder: Vec<Contingency>,
}

impl Emergency {
    pub(crate) fn holds(&self, reason: AbortReason, here: &Point3<f64>) -> bool {
        let is_inside = |outline: &Vec<MapPoint>| {
            let area = Footprint::Area {
                outline: outline.clone(),
            };
            area.distance_m(here.x, here.y) <= 0.0
        };
        EmergencyCause::of(reason) == Some(self.when) && self.within.as_ref().is_none_or(is_inside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_types::Violations;

    #[test]
    fn the_first_emergency_that_holds_counts() {
        let mut mission = Fixture::new().mission;
        let loiter = Contingency::Loiter { for_s: 60.0 };
        let square = vec![[0.0, 0.0], [0.0, 100.0], [100.0, 100.0], [100.0, 0.0]];
        let emergency = |when, within, ladder: &[Contingency]| Emergency {
            when,
            within,
            ladder: ladder.to_vec(),
        };
        mission.emergencies = vec![
            emergency(EmergencyCause::Leak, Some(square), &[loiter]),
            emergency(EmergencyCause::Leak, None, &[Contingency::ReturnAlongTrack]),
            emergency(EmergencyCause::ShutIn, None, &[]),
        ];
        let [inside, outside] = [50.0, 150.0].map(|x| Point3::new(x, 50.0, 20.0));
        assert_eq!(mission.ladder(AbortReason::Leak, &inside), [loiter]);
        let back = [Contingency::ReturnAlongTrack];
        assert_eq!(mission.ladder(AbortReason::Leak, &outside), back);
        assert!(mission.ladder(AbortReason::ShutIn, &inside).is_empty());
        let rest = &mission.contingencies;
        assert_eq!(mission.ladder(AbortReason::TooLow, &inside), rest);
        assert_eq!(mission.ladder(AbortReason::SonarLost, &inside), rest);
        mission.emergencies[0].within = Some(vec![[0.0, 0.0], [1.0, 1.0]]);
        mission.emergencies[1].ladder = vec![Contingency::Loiter { for_s: -1.0 }];
        let mut violations = Violations::new();
        mission.check_ladders(&mut violations);
        let text = violations.to_string();
        assert!(text.contains("emergencies[0].within"), "{text}");
        assert!(
            text.contains("emergencies[1].ladder[0].loiter.for_s"),
            "{text}"
        );
    }
}
