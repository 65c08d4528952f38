//! The uncertainty of charted depths.

use auv_types::Violations;

/// The standard deviation of a charted depth: a share of the depth, but at least a minimum.
///
/// The default is that of an ordinary survey: 5 % of the depth, at least 2 m.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct DepthSigma {
    /// The minimum, metres.
    pub least_m: f64,
    /// The share of the depth.
    pub relative: f64,
}

impl Default for DepthSigma {
    fn default() -> Self {
        Self {
            least_m: 2.0,
            relative: 0.05,
        }
    }
}

impl DepthSigma {
    /// Exactly known depths.
    #[must_use]
    pub const fn exact() -> Self {
        Self {
            least_m: 0.0,
            relative: 0.0,
        }
    }

    /// The standard deviation at a depth, metres.
    #[must_use]
    pub fn at_depth(&self, depth_m: f64) -> f64 {
        self.least_m.max(self.relative * depth_m)
    }

    /// Everything malformed about it.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_not_negative(self.least_m, "least_m");
        violations.require_not_negative(self.relative, "relative");
        violations
    }
}
