//! How well the vehicle knows its place, and how well it must at the dock.

use auv_planning::Arrival;
use auv_types::{Vector3, Violations, libm};

/// How the vehicle's belief about its place errs, and how it is put right.
///
/// Under water the error grows with the way; a fix at the surface ends it. Errors are horizontal; their standard
/// deviation is that of the distance between the believed and the true place.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Navigation {
    /// Standard deviation of the error, per cent of the way through the water since the last fix.
    pub drift_percent: f64,
    /// Standard deviation of the compass's error, degrees; it stays the same for a whole mission.
    pub compass_deg: f64,
    /// Time at the surface that a fix takes, seconds.
    pub fix_at_surface_s: f64,
    /// The vehicle surfaces for a fix when the standard deviation of its error exceeds this, metres (`None`: the
    /// error may grow until a fix is needed to dock).
    pub most_error_m: Option<f64>,
}

impl Default for Navigation {
    /// Exact; a fix takes a minute.
    fn default() -> Self {
        Self {
            drift_percent: 0.0,
            compass_deg: 0.0,
            fix_at_surface_s: 60.0,
            most_error_m: None,
        }
    }
}

impl Navigation {
    /// Clearances grow by this many standard deviations of the error: it is smaller in 98 of 100 cases.
    pub const SIGMAS: f64 = 2.0;

    /// Standard deviation of the error after a way through the water since the last fix, metres, which led a
    /// distance away from where it began.
    #[must_use]
    pub fn sigma_m(&self, way_m: f64, away_m: f64) -> f64 {
        let turned = self.compass_deg.to_radians() * away_m;
        libm::hypot(0.01 * self.drift_percent * way_m, turned)
    }

    /// Whether the error never grows.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.drift_percent <= 0.0 && self.compass_deg <= 0.0
    }

    /// Everything that is wrong with it.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let mut within = |value: f64, most: f64, place: &str, unit: &str| {
            violations.require((0.0..=most).contains(&value), place, || {
                format!("is {value}; give 0 to {most} {unit}")
            });
        };
        within(
            self.drift_percent,
            100.0,
            "drift_percent",
            "per cent of the way",
        );
        within(self.compass_deg, 45.0, "compass_deg", "degrees");
        within(self.fix_at_surface_s, 3_600.0, "fix_at_surface_s", "s");
        if let Some(most_m) = self.most_error_m {
            violations.require_positive(most_m, "most_error_m");
        }
        violations
    }
}

/// A fix at the surface from time to time, whatever the error.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Surfacing {
    /// The vehicle is at the surface for a fix at least so often from the launch on, seconds.
    pub every_s: f64,
    /// It stays there no longer than this, also where no fix comes, seconds.
    #[cfg_attr(feature = "serde", serde(default = "at_most_s"))]
    pub at_most_s: f64,
}

const fn at_most_s() -> f64 {
    120.0
}

impl Surfacing {
    /// Every so many seconds, for two minutes at most.
    #[must_use]
    pub const fn every(every_s: f64) -> Self {
        Self {
            every_s,
            at_most_s: at_most_s(),
        }
    }

    /// Everything that is wrong with it.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_positive(self.every_s, "every_s");
        violations.require_positive(self.at_most_s, "at_most_s");
        violations
    }
}

/// When the vehicle counts as docked.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct Docking {
    /// Greatest distance of the true place from the destination, metres. A vehicle that does not know its place
    /// so well surfaces for a fix before it docks.
    pub tolerance_m: f64,
    /// The course on which it docks, degrees from north by east (`None`: from anywhere).
    pub heading_deg: Option<f64>,
    /// How much of the way is flown straight on this course at least, metres.
    pub lead_in_m: f64,
    /// How often the vehicle tries to dock: one that is told that it missed the dock surfaces for a fix and tries
    /// again ([`crate::Event::DockContact`]).
    pub tries: u32,
}

impl Default for Docking {
    fn default() -> Self {
        Self {
            tolerance_m: 10.0,
            heading_deg: None,
            lead_in_m: 0.0,
            tries: 1,
        }
    }
}

impl Docking {
    /// No vehicle tries more often.
    const MOST_TRIES: u32 = 10;

    /// How a leg to the dock arrives.
    pub(crate) fn arrival(&self) -> Option<Arrival> {
        let heading_deg = self.heading_deg?;
        let (sin, cos) = libm::sincos(heading_deg.to_radians());
        Some(Arrival {
            direction: Vector3::new(cos, sin, 0.0),
            lead_m: self.lead_in_m,
        })
    }

    /// Everything that is wrong with the approach.
    pub(crate) fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_positive(self.tolerance_m, "tolerance_m");
        if let Some(heading_deg) = self.heading_deg {
            let sound = (-360.0..=360.0).contains(&heading_deg);
            violations.require(sound, "heading_deg", || {
                format!("is {heading_deg}; give degrees from north by east, -360 to 360")
            });
        }
        let sound = (0.0..=10_000.0).contains(&self.lead_in_m);
        violations.require(sound, "lead_in_m", || {
            format!("is {}; give 0 to 10000 m", self.lead_in_m)
        });
        let sound = (1..=Self::MOST_TRIES).contains(&self.tries);
        violations.require(sound, "tries", || {
            format!("is {}; give 1 to {}", self.tries, Self::MOST_TRIES)
        });
        let alone = self.lead_in_m > 0.0 && self.heading_deg.is_none();
        violations.require(!alone, "lead_in_m", || {
            "needs the course that it is flown on; give heading_deg".into()
        });
        violations
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_grows_with_the_way_and_the_compass_turns_it() {
        let navigation = Navigation {
            drift_percent: 1.0,
            compass_deg: 0.5,
            ..Navigation::default()
        };
        assert_eq!(navigation.sigma_m(1_000.0, 0.0), 10.0);
        let turned_m = navigation.sigma_m(0.0, 1_000.0);
        assert!((turned_m - 8.727).abs() < 1e-3, "{turned_m}");
        assert!(Navigation::default().is_exact());
    }

    #[test]
    fn every_value_out_of_range_is_told_by_its_place() {
        let navigation = |drift_percent, compass_deg, fix_at_surface_s, most_error_m| Navigation {
            drift_percent,
            compass_deg,
            fix_at_surface_s,
            most_error_m,
        };
        let docking = |tolerance_m, heading_deg, lead_in_m, tries| Docking {
            tolerance_m,
            heading_deg,
            lead_in_m,
            tries,
        };
        let surfacing = |every_s, at_most_s| Surfacing { every_s, at_most_s };
        let (nan, deg) = (f64::NAN, Some(0.0));
        let cases = [
            (navigation(100.0, 45.0, 3_600.0, Some(1e-9)).validate(), ""),
            (
                navigation(100.1, 0.0, 0.0, None).validate(),
                "drift_percent",
            ),
            (navigation(nan, 0.0, 0.0, None).validate(), "drift_percent"),
            (navigation(0.0, -0.1, 0.0, None).validate(), "compass_deg"),
            (
                navigation(0.0, 0.0, 3_601.0, None).validate(),
                "fix_at_surface_s",
            ),
            (
                navigation(0.0, 0.0, 0.0, Some(0.0)).validate(),
                "most_error_m",
            ),
            (surfacing(1.0, 1.0).validate(), ""),
            (surfacing(0.0, 1.0).validate(), "every_s"),
            (surfacing(1.0, nan).validate(), "at_most_s"),
            (docking(1.0, Some(-360.0), 10_000.0, 10).validate(), ""),
            (docking(0.0, deg, 0.0, 1).validate(), "tolerance_m"),
            (docking(1.0, Some(361.0), 0.0, 1).validate(), "heading_deg"),
            (docking(1.0, deg, 10_001.0, 1).validate(), "lead_in_m"),
            (docking(1.0, None, 1.0, 1).validate(), "lead_in_m"),
            (docking(1.0, deg, 0.0, 0).validate(), "tries"),
            (docking(1.0, deg, 0.0, 11).validate(), "tries"),
        ];
        for (violations, place) in cases {
            let told: Vec<&str> = violations.list().iter().map(|v| &*v.place).collect();
            let wanted: Vec<&str> = Some(place)
                .filter(|place| !place.is_empty())
                .into_iter()
                .collect();
            assert_eq!(told, wanted, "{violations}");
        }
    }

    #[test]
    fn a_dock_with_a_course_is_reached_level_on_it() {
        let heading_deg = Some(30.0);
        let docking = Docking {
            heading_deg,
            lead_in_m: 25.0,
            ..Docking::default()
        };
        let arrival = docking.arrival().unwrap();
        let wanted = Vector3::new(0.75_f64.sqrt(), 0.5, 0.0);
        assert!((arrival.direction - wanted).norm() < 1e-12 && arrival.lead_m == 25.0);
        assert_eq!(Docking::default().arrival(), None);
    }
}
