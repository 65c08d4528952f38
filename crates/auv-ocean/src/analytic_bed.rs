//! Analytic sea beds, given as data.

use crate::footprint::{share_at, steepest_share};
use crate::{DepthSigma, Footprint, MapPoint, SeaBed};
use auv_types::{Violations, libm};

/// A sea bed composed of smooth features over a base depth.
///
/// Features apply in order. Each changes the depth towards its own `depth_m`: completely inside its shape,
/// not at all beyond its skirt, smoothly in between. A negative depth is land. [`Undulation`]s apply last.
///
/// ```
/// use auv_ocean::{AnalyticBed, BedFeature, Effect, SeaBed, Footprint};
///
/// let basin = Footprint::Ellipse { centre: [5e3, 5e3], half_axis: [2e3, 1e3], half_width_m: 1_500.0 };
/// let sill = Footprint::Line { points: vec![[8e3, 0.0], [8e3, 10e3]], half_width_m: 100.0 };
/// let bed = AnalyticBed::new(60.0)
///     .with(BedFeature::new("basin", basin, 110.0, 1_000.0))
///     .with(BedFeature::new("sill", sill, 18.0, 600.0).effect(Effect::Raise));
/// assert!(bed.validate().is_empty());
/// assert_eq!(bed.depth_at(5e3, 5e3), 110.0);
/// assert_eq!(bed.depth_at(8e3, 2e3), 18.0);
/// assert_eq!(bed.depth_at(1e3, 9e3), 60.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct AnalyticBed {
    /// Depth where no feature reaches, metres.
    pub base_depth_m: f64,
    /// Basins, sills, ridges, shoals, islands, coasts, in the order in which they apply.
    #[cfg_attr(feature = "serde", serde(default))]
    pub features: Vec<BedFeature>,
    /// Sine waves added to the depth everywhere.
    #[cfg_attr(feature = "serde", serde(default))]
    pub undulations: Vec<Undulation>,
    /// Standard deviation of the depth.
    #[cfg_attr(feature = "serde", serde(default))]
    pub sigma: DepthSigma,
}

/// One feature of an [`AnalyticBed`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct BedFeature {
    /// Its name in messages and on maps.
    pub name: String,
    /// The area of its full effect.
    pub shape: Footprint,
    /// The depth inside the shape, metres; negative for land.
    pub depth_m: f64,
    /// Distance from the shape over which the effect fades out, metres.
    pub skirt_m: f64,
    /// Whether it may deepen, raise or both.
    #[cfg_attr(feature = "serde", serde(default))]
    pub effect: Effect,
}

/// Whether a feature may deepen or raise the bed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Effect {
    /// Both.
    #[default]
    Set,
    /// Raise only: a sill or ridge that leaves land and shoals unchanged.
    Raise,
    /// Deepen only: a channel that leaves a basin unchanged.
    Dig,
}

/// A sine wave added to the depth.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Undulation {
    /// Half the height from crest to trough, metres.
    pub amplitude_m: f64,
    /// The vector from one crest to the next, metres north and east.
    pub wavelength: MapPoint,
}

impl BedFeature {
    /// A feature that makes its shape `depth_m` deep and fades out over `skirt_m`.
    #[must_use]
    pub fn new(name: impl Into<String>, shape: Footprint, depth_m: f64, skirt_m: f64) -> Self {
        Self {
            name: name.into(),
            shape,
            depth_m,
            skirt_m,
            effect: Effect::Set,
        }
    }

    /// The same feature with another effect.
    #[must_use]
    pub fn effect(mut self, effect: Effect) -> Self {
        self.effect = effect;
        self
    }

    /// The change of depth at full effect, metres.
    fn pull_m(&self, depth_m: f64) -> f64 {
        let pull_m = self.depth_m - depth_m;
        match self.effect {
            Effect::Set => pull_m,
            Effect::Raise => pull_m.min(0.0),
            Effect::Dig => pull_m.max(0.0),
        }
    }
}

impl Undulation {
    fn depth_m(&self, north_m: f64, east_m: f64) -> f64 {
        let [n, e] = self.wavelength;
        let turns = (north_m * n + east_m * e) / (n * n + e * e);
        self.amplitude_m * libm::sin(std::f64::consts::TAU * turns)
    }

    fn steepest(&self) -> f64 {
        let [n, e] = self.wavelength;
        self.amplitude_m.abs() * std::f64::consts::TAU / libm::sqrt(n * n + e * e)
    }
}

/// Bounds of the depth near a position: its range and its steepest slope.
struct Near {
    low_m: f64,
    high_m: f64,
    slope: f64,
}

impl AnalyticBed {
    /// Greatest number of features and of undulations.
    pub const MOST_FEATURES: usize = 1_000;

    /// A flat bed.
    #[must_use]
    pub fn new(base_depth_m: f64) -> Self {
        Self {
            base_depth_m,
            features: Vec::new(),
            undulations: Vec::new(),
            sigma: DepthSigma::default(),
        }
    }

    /// The same bed with one more feature, applied last.
    #[must_use]
    pub fn with(mut self, feature: BedFeature) -> Self {
        self.features.push(feature);
        self
    }

    /// Everything malformed about the bed. Only a bed without violations satisfies the contract of
    /// [`SeaBed`].
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let plausible = |depth_m: f64| depth_m.abs() <= 12_000.0;
        let advice = |depth_m: f64| format!("is {depth_m}; give a depth within 12,000 m");
        violations.require(plausible(self.base_depth_m), "base_depth_m", || {
            advice(self.base_depth_m)
        });
        for (count, place) in [
            (self.features.len(), "features"),
            (self.undulations.len(), "undulations"),
        ] {
            violations.require(count <= Self::MOST_FEATURES, place, || {
                format!("are {count}; give at most {}", Self::MOST_FEATURES)
            });
        }
        for (i, feature) in self.features.iter().enumerate() {
            let place = format!("features[{i}] ({})", feature.name);
            feature
                .shape
                .validate_into(&format!("{place}.shape"), &mut violations);
            violations.require(
                plausible(feature.depth_m),
                &format!("{place}.depth_m"),
                || advice(feature.depth_m),
            );
            violations.require_positive(feature.skirt_m, &format!("{place}.skirt_m"));
        }
        for (i, undulation) in self.undulations.iter().enumerate() {
            let place = format!("undulations[{i}]");
            violations.require(
                plausible(undulation.amplitude_m),
                &format!("{place}.amplitude_m"),
                || advice(undulation.amplitude_m),
            );
            let [n, e] = undulation.wavelength;
            violations.require_positive(n * n + e * e, &format!("{place}.wavelength"));
        }
        violations.absorb("sigma.", self.sigma.validate());
        violations
    }

    /// Bounds of depth and slope over all positions within a radius. They follow feature by feature: the
    /// distance to a shape changes by at most the radius, the share is monotone in the distance, and a blend
    /// lies between the values it blends.
    fn near(&self, north_m: f64, east_m: f64, radius_m: f64) -> Near {
        let mut near = Near {
            low_m: self.base_depth_m,
            high_m: self.base_depth_m,
            slope: 0.0,
        };
        for feature in &self.features {
            let reach_m = feature.skirt_m + radius_m;
            if feature.shape.is_far(north_m, east_m, reach_m) {
                continue;
            }
            let distance_m = feature.shape.distance_m(north_m, east_m);
            let (closest_m, farthest_m) = (distance_m - radius_m, distance_m + radius_m);
            let (least, most) = (
                share_at(farthest_m, feature.skirt_m),
                share_at(closest_m, feature.skirt_m),
            );
            let (pull_low_m, pull_high_m) =
                (feature.pull_m(near.high_m), feature.pull_m(near.low_m));
            let strongest_m = pull_low_m.abs().max(pull_high_m.abs());
            // Where the feature may leave the depth unchanged, the slope remains too.
            let may_idle = match feature.effect {
                Effect::Set => false,
                Effect::Raise => near.low_m < feature.depth_m,
                Effect::Dig => near.high_m > feature.depth_m,
            };
            let kept = if may_idle { 1.0 } else { 1.0 - least };
            near.slope = kept * near.slope
                + strongest_m * steepest_share(closest_m, farthest_m, feature.skirt_m);
            // A blend is monotone in the depth below it and in the share.
            let blends =
                |depth_m: f64, pull_m: f64| (depth_m + least * pull_m, depth_m + most * pull_m);
            let (a, b) = blends(near.low_m, pull_high_m);
            let (c, d) = blends(near.high_m, pull_low_m);
            near.low_m = a.min(b);
            near.high_m = c.max(d);
        }
        near
    }
}

impl SeaBed for AnalyticBed {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        if !(north_m.is_finite() && east_m.is_finite()) {
            return 0.0;
        }
        let mut depth_m = self.base_depth_m;
        for feature in &self.features {
            if feature.shape.is_far(north_m, east_m, feature.skirt_m) {
                continue;
            }
            let share = share_at(feature.shape.distance_m(north_m, east_m), feature.skirt_m);
            if share > 0.0 {
                depth_m += share * feature.pull_m(depth_m);
            }
        }
        for undulation in &self.undulations {
            depth_m += undulation.depth_m(north_m, east_m);
        }
        depth_m
    }

    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        let ripples: f64 = self.undulations.iter().map(Undulation::steepest).sum();
        self.near(north_m, east_m, radius_m).slope + ripples
    }

    fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
        self.sigma.at_depth(self.depth_at(north_m, east_m))
    }

    fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
        let depth_m = self.depth_at(north_m, east_m);
        (depth_m, self.sigma.at_depth(depth_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::footprint::length;
    use auv_types::Seed;
    use auv_types::rand::RngExt;

    fn inlet() -> AnalyticBed {
        let mut bed = AnalyticBed::new(70.0)
            .with(BedFeature::new(
                "basin",
                Footprint::Ellipse {
                    centre: [5_000.0, 5_000.0],
                    half_axis: [1_500.0, 1_500.0],
                    half_width_m: 900.0,
                },
                110.0,
                1_500.0,
            ))
            .with(
                BedFeature::new(
                    "sill",
                    Footprint::Line {
                        points: vec![[1_500.0, 0.0], [2_000.0, 5_000.0], [1_500.0, 10_000.0]],
                        half_width_m: 80.0,
                    },
                    18.0,
                    500.0,
                )
                .effect(Effect::Raise),
            )
            .with(BedFeature::new(
                "island",
                Footprint::Area {
                    outline: vec![
                        [6_000.0, 3_000.0],
                        [6_800.0, 3_300.0],
                        [6_500.0, 3_900.0],
                        [6_200.0, 3_300.0],
                    ],
                },
                -15.0,
                400.0,
            ))
            .with(
                BedFeature::new(
                    "channel",
                    Footprint::Line {
                        points: vec![[0.0, 5_000.0], [4_000.0, 5_000.0]],
                        half_width_m: 50.0,
                    },
                    40.0,
                    250.0,
                )
                .effect(Effect::Dig),
            )
            .with(BedFeature::new(
                "west wall",
                Footprint::Beyond {
                    through: [0.0, 600.0],
                    towards: [0.0, 0.0],
                },
                -10.0,
                300.0,
            ));
        bed.undulations.push(Undulation {
            amplitude_m: 0.8,
            wavelength: [120.0, 60.0],
        });
        bed
    }

    #[test]
    fn the_slope_bound_holds_between_samples() {
        let bed = inlet();
        assert!(bed.validate().is_empty(), "{}", bed.validate());
        let mut random = Seed(3).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let mut tightest: f64 = 0.0;
        for _ in 0..400 {
            let (n, e) = (draw(0.0, 10_000.0), draw(0.0, 10_000.0));
            let radius_m = draw(1.0, 300.0);
            let bound = bed.max_slope_near(n, e, radius_m);
            for _ in 0..200 {
                let mut inside = || {
                    let (x, y) = (draw(-1.0, 1.0), draw(-1.0, 1.0));
                    let shrink = radius_m / libm::sqrt(x * x + y * y).max(1.0);
                    (n + x * shrink, e + y * shrink)
                };
                let (a, b) = (inside(), inside());
                let distance_m = length([a.0 - b.0, a.1 - b.1]);
                let step_m = (bed.depth_at(a.0, a.1) - bed.depth_at(b.0, b.1)).abs();
                assert!(
                    step_m <= bound * distance_m + 1e-9,
                    "{step_m} m over {distance_m} m, bound {bound}"
                );
                if bound > 0.05 {
                    tightest = tightest.max(step_m / distance_m / bound);
                }
            }
        }
        assert!(tightest > 0.9, "the bound is loose: best ratio {tightest}");
    }

    #[test]
    fn features_set_raise_and_dig() {
        let mut bed = inlet();
        bed.undulations.clear();
        assert_eq!(bed.depth_at(5_000.0, 5_000.0), 110.0);
        assert_eq!(bed.depth_at(1_900.0, 4_000.0), 18.0, "the sill");
        assert_eq!(
            bed.depth_at(1_950.0, 5_000.0),
            40.0,
            "the channel through it"
        );
        assert_eq!(bed.depth_at(6_500.0, 3_500.0), -15.0, "the island");
        assert_eq!(
            bed.depth_at(1_560.0, 500.0),
            -10.0,
            "the wall stands over the sill"
        );
        assert_eq!(bed.depth_sigma_m(5_000.0, 5_000.0), 5.5);
        assert_eq!(bed.depth_sigma_m(6_500.0, 3_500.0), 2.0);
        assert_eq!(bed.depth_at(f64::NAN, 0.0), 0.0);
    }

    #[test]
    fn a_malformed_bed_lists_everything() {
        let mut bed = inlet();
        bed.base_depth_m = f64::NAN;
        bed.features[0].skirt_m = 0.0;
        bed.features[2].depth_m = 1e6;
        bed.sigma.relative = -1.0;
        let violations = bed.validate();
        assert_eq!(violations.total(), 4, "{violations}");
        assert!(
            violations
                .to_string()
                .contains("features[0] (basin).skirt_m")
        );
    }

    #[cfg(feature = "serde")]
    #[test]
    fn round_trips_as_data_and_rejects_unknown_keys() {
        let bed = inlet();
        let text = serde_json::to_string(&bed).unwrap();
        assert_eq!(serde_json::from_str::<AnalyticBed>(&text).unwrap(), bed);
        assert!(serde_json::from_str::<AnalyticBed>(&text.replace("skirt_m", "skirt")).is_err());
        let short = r#"{"base_depth_m": 40.0}"#;
        assert_eq!(
            serde_json::from_str::<AnalyticBed>(short).unwrap(),
            AnalyticBed::new(40.0)
        );
    }
}
