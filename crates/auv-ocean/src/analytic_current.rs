//! Analytic currents, given as data: mean, tide, gains, vortices.

use crate::footprint::{length, share_at};
use crate::{CurrentField, Footprint, MapPoint};
use auv_types::{Point3, Vector3, Violations, libm};
use std::f64::consts::TAU;

/// A horizontal current, equal at all depths: `gain(place) x (mean + tide(time)) + vortices(place)`. The
/// default is still water.
///
/// ```
/// use auv_ocean::{AnalyticCurrent, CurrentField, TidalConstituent};
/// use auv_types::Point3;
///
/// let ebb = AnalyticCurrent {
///     mean_mps: [0.0, 0.1],
///     tide: vec![TidalConstituent::turning_at(3.0 * 3_600.0, [0.4, 0.0])],
///     ..AnalyticCurrent::default()
/// };
/// assert!(ebb.validate().is_empty());
/// let place = Point3::new(0.0, 0.0, 20.0);
/// assert!(ebb.velocity_at(&place, 0.0).x < -0.3);
/// assert!(ebb.velocity_at(&place, 3.0 * 3_600.0).x.abs() < 1e-12);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct AnalyticCurrent {
    /// The steady part, m/s north and east, direction "towards".
    pub mean_mps: [f64; 2],
    /// The constituents of the tide.
    pub tide: Vec<TidalConstituent>,
    /// Areas of stronger or weaker mean and tide. They apply in order.
    pub gains: Vec<CurrentGain>,
    /// Vortices.
    pub vortices: Vec<LambVortex>,
}

/// One periodic part of a tide. Its velocity vector describes an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct TidalConstituent {
    /// Velocity at its strongest, m/s north and east.
    pub major_mps: [f64; 2],
    /// Velocity a quarter period later, m/s north and east; 0 for a tide along one line.
    #[cfg_attr(feature = "serde", serde(default))]
    pub minor_mps: [f64; 2],
    /// Its period, seconds.
    pub period_s: f64,
    /// A mission time at which the velocity is `major_mps`, seconds; text may call it `strongest`.
    #[cfg_attr(feature = "serde", serde(alias = "strongest"))]
    pub strongest_s: f64,
}

/// An area where mean and tide are stronger (over a sill) or weaker (in a bay).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct CurrentGain {
    /// The area of its full effect.
    pub shape: Footprint,
    /// The factor inside the shape.
    pub gain: f64,
    /// Distance from the shape over which the effect fades out, metres.
    pub skirt_m: f64,
}

/// A viscous Lamb vortex: circulating flow around a centre, at rest in it.
///
/// `v_north = -G (e - e0) / (2 pi r^2) (1 - exp(-r^2 / l^2))`, `v_east = +G (n - n0) / (2 pi r^2) (...)`
/// with the circulation `G` and the core radius `l`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct LambVortex {
    /// Its centre.
    pub centre: MapPoint,
    /// Circulation in m2/s; positive turns clockwise on the map.
    pub circulation_m2ps: f64,
    /// Radius of its core, metres. The flow is strongest at 1.12 times this radius.
    pub core_radius_m: f64,
}

impl TidalConstituent {
    /// Period of the principal lunar tide (M2), seconds.
    pub const M2_PERIOD_S: f64 = 44_714.164;

    /// A principal lunar tide (M2) with slack water at a mission time. Before that it runs against
    /// `flood_mps`, afterwards along it.
    #[must_use]
    pub fn turning_at(slack_s: f64, flood_mps: [f64; 2]) -> Self {
        Self {
            major_mps: flood_mps,
            minor_mps: [0.0; 2],
            period_s: Self::M2_PERIOD_S,
            strongest_s: slack_s + Self::M2_PERIOD_S / 4.0,
        }
    }

    fn velocity_mps(&self, time_s: f64) -> [f64; 2] {
        let angle = TAU * ((time_s - self.strongest_s) / self.period_s);
        let (sin, cos) = libm::sincos(angle);
        [0, 1].map(|k| self.major_mps[k] * cos + self.minor_mps[k] * sin)
    }
}

impl LambVortex {
    fn velocity_mps(&self, north_m: f64, east_m: f64) -> [f64; 2] {
        let (n, e) = (north_m - self.centre[0], east_m - self.centre[1]);
        let square = n * n + e * e;
        if square == 0.0 {
            return [0.0; 2];
        }
        let core = self.core_radius_m * self.core_radius_m;
        // 1 - exp(-x), exact near the centre as well.
        let turning = self.circulation_m2ps * -libm::expm1(-square / core) / (TAU * square);
        [-turning * e, turning * n]
    }

    /// Its strongest flow: the maximum of `(1 - exp(-x^2)) / x` is 0.638172686...
    fn max_speed_mps(&self) -> f64 {
        0.638_172_687 * self.circulation_m2ps.abs() / (TAU * self.core_radius_m)
    }
}

impl AnalyticCurrent {
    /// Greatest number of constituents, of gains and of vortices.
    pub const MOST_PARTS: usize = 1_000;

    fn gain_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.gains.iter().fold(1.0, |gain, part| {
            if part.shape.is_far(north_m, east_m, part.skirt_m) {
                return gain;
            }
            let share = share_at(part.shape.distance_m(north_m, east_m), part.skirt_m);
            if share > 0.0 {
                gain + share * (part.gain - gain)
            } else {
                gain
            }
        })
    }

    /// Everything malformed about the current. Only a current without violations satisfies the contract of
    /// [`CurrentField`].
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let speed = |violations: &mut Violations, velocity: [f64; 2], place: &str| {
            violations.require(length(velocity) <= 20.0, place, || {
                format!("is {velocity:?}; give m/s north and east, 20 m/s at most")
            });
        };
        for (count, place) in [
            (self.tide.len(), "tide"),
            (self.gains.len(), "gains"),
            (self.vortices.len(), "vortices"),
        ] {
            violations.require(count <= Self::MOST_PARTS, place, || {
                format!("has {count} parts; give at most {}", Self::MOST_PARTS)
            });
        }
        speed(&mut violations, self.mean_mps, "mean_mps");
        for (i, part) in self.tide.iter().enumerate() {
            let place = |field| format!("tide[{i}].{field}");
            speed(&mut violations, part.major_mps, &place("major_mps"));
            speed(&mut violations, part.minor_mps, &place("minor_mps"));
            violations.require_positive(part.period_s, &place("period_s"));
            violations.require(part.strongest_s.is_finite(), &place("strongest_s"), || {
                "is not finite; give seconds".into()
            });
        }
        for (i, part) in self.gains.iter().enumerate() {
            let place = |field| format!("gains[{i}].{field}");
            part.shape.validate_into(&place("shape"), &mut violations);
            violations.require_not_negative(part.gain, &place("gain"));
            violations.require_positive(part.skirt_m, &place("skirt_m"));
        }
        for (i, vortex) in self.vortices.iter().enumerate() {
            let place = |field| format!("vortices[{i}].{field}");
            let finite = vortex.centre.iter().all(|x| x.is_finite());
            violations.require(finite, &place("centre"), || {
                format!("is {:?}; give metres", vortex.centre)
            });
            violations.require_positive(vortex.core_radius_m, &place("core_radius_m"));
            violations.require(
                vortex.max_speed_mps() <= 20.0,
                &place("circulation_m2ps"),
                || {
                    format!(
                        "is {}: the flow is not finite or above 20 m/s; give less",
                        vortex.circulation_m2ps
                    )
                },
            );
        }
        violations
    }
}

impl CurrentField for AnalyticCurrent {
    fn velocity_at(&self, position: &Point3<f64>, time_s: f64) -> Vector3<f64> {
        let (north_m, east_m) = (position.x, position.y);
        if !(north_m.is_finite() && east_m.is_finite() && time_s.is_finite()) {
            return Vector3::zeros();
        }
        let add = |a: [f64; 2], b: [f64; 2]| [a[0] + b[0], a[1] + b[1]];
        let stream = self
            .tide
            .iter()
            .map(|part| part.velocity_mps(time_s))
            .fold(self.mean_mps, add);
        let gain = self.gain_at(north_m, east_m);
        let [north_mps, east_mps] = self
            .vortices
            .iter()
            .map(|vortex| vortex.velocity_mps(north_m, east_m))
            .fold([gain * stream[0], gain * stream[1]], add);
        Vector3::new(north_mps, east_mps, 0.0)
    }

    fn max_speed_mps(&self) -> f64 {
        let gain = self.gains.iter().map(|part| part.gain).fold(1.0, f64::max);
        // The speed on a tidal ellipse never exceeds the root of the two velocities' squares.
        let tide: f64 = self
            .tide
            .iter()
            .map(|part| {
                let (major, minor) = (length(part.major_mps), length(part.minor_mps));
                libm::sqrt(major * major + minor * minor)
            })
            .sum();
        let vortices: f64 = self.vortices.iter().map(LambVortex::max_speed_mps).sum();
        gain * (length(self.mean_mps) + tide) + vortices
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;
    use auv_types::rand::RngExt;

    fn harbour() -> AnalyticCurrent {
        AnalyticCurrent {
            mean_mps: [0.1, -0.05],
            tide: vec![
                TidalConstituent::turning_at(10_800.0, [0.4, 0.0]),
                TidalConstituent {
                    major_mps: [0.0, 0.1],
                    minor_mps: [0.05, 0.0],
                    period_s: 43_200.0,
                    strongest_s: 900.0,
                },
            ],
            gains: vec![CurrentGain {
                shape: Footprint::Line {
                    points: vec![[2_000.0, 0.0], [2_000.0, 10_000.0]],
                    half_width_m: 100.0,
                },
                gain: 1.6,
                skirt_m: 500.0,
            }],
            vortices: vec![LambVortex {
                centre: [4_000.0, 4_000.0],
                circulation_m2ps: 600.0,
                core_radius_m: 300.0,
            }],
        }
    }

    #[test]
    fn the_speed_bound_holds_and_is_tight() {
        let current = harbour();
        assert!(current.validate().is_empty(), "{}", current.validate());
        let mut random = Seed(5).stream(0);
        let fastest = (0..200_000)
            .map(|_| {
                let place = Point3::new(
                    random.random_range(0.0..8_000.0),
                    random.random_range(0.0..8_000.0),
                    10.0,
                );
                let time_s = random.random_range(0.0..90_000.0);
                current.velocity_at(&place, time_s).norm()
            })
            .fold(0.0, f64::max);
        let bound = current.max_speed_mps();
        assert!(
            fastest <= bound && fastest > 0.7 * bound,
            "{fastest} {bound}"
        );
    }

    #[test]
    fn a_vortex_is_strongest_where_its_bound_says() {
        let vortex = harbour().vortices[0];
        let fastest = (1..20_000)
            .map(|i| length(vortex.velocity_mps(4_000.0 + 0.05 * f64::from(i), 4_000.0)))
            .fold(0.0, f64::max);
        assert!((fastest / vortex.max_speed_mps() - 1.0).abs() < 1e-6);
        assert!(vortex.velocity_mps(4_100.0, 4_000.0)[1] > 0.0, "clockwise");
        assert_eq!(vortex.velocity_mps(4_000.0, 4_000.0), [0.0, 0.0]);
    }

    #[test]
    fn the_tide_is_stronger_over_the_sill() {
        let mut current = harbour();
        current.vortices.clear();
        let at = |north_m| current.velocity_at(&Point3::new(north_m, 500.0, 5.0), 0.0);
        assert!((at(2_050.0) - at(5_000.0) * 1.6).norm() < 1e-12);
        assert!(at(2_350.0).norm() > at(5_000.0).norm());
    }

    #[test]
    fn a_malformed_current_lists_everything() {
        let mut current = harbour();
        current.tide[0].period_s = 0.0;
        current.gains[0].gain = -1.0;
        current.vortices[0].core_radius_m = 0.0;
        // Without a core the speed is not finite either.
        assert_eq!(current.validate().total(), 4, "{}", current.validate());
    }
}
