//! When a mission is launched, and the times of its file.

use super::document::MissionFile;
use super::moment::Moment;
use auv_types::Violations;

impl MissionFile {
    /// When the mission is launched, seconds since 1970 UTC; `None` if the file does not say.
    #[must_use]
    pub fn launch_unix_s(&self) -> Option<f64> {
        self.launch.as_ref()?.unix_s()
    }

    /// Checks `launch`.
    pub(super) fn check_launch(&self, violations: &mut Violations) {
        let sound = self.launch.as_ref().is_none_or(|at| at.unix_s().is_some());
        violations.require(sound, "launch", || {
            "is no time in UTC; write it as \"2026-06-01T08:30:00Z\"".into()
        });
    }

    /// Mission seconds of a time. A malformed one is a violation and gives 0.
    pub(super) fn mission_s(&self, at: &Moment, place: &str, violations: &mut Violations) -> f64 {
        if let Moment::Seconds(seconds) = at {
            violations.require(seconds.is_finite(), place, || {
                "is not finite; give seconds".into()
            });
            return if seconds.is_finite() { *seconds } else { 0.0 };
        }
        let Some(unix_s) = at.unix_s() else {
            violations.push(
                place,
                "is no time in UTC; write it as \"2026-06-01T08:30:00Z\", or give seconds from the launch",
            );
            return 0.0;
        };
        let Some(launch_s) = self.launch_unix_s() else {
            violations.push(
                place,
                "is given in UTC; say when the mission begins, with launch = \"2026-06-01T08:30:00Z\"",
            );
            return 0.0;
        };
        unix_s - launch_s
    }
}
