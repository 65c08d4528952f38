//! Settings of the particle swarm.

use auv_planning::Score;
use auv_types::{Violations, libm};
use std::cmp::Ordering;

/// How strongly particles are drawn to their own and to the swarm's best (Eq. 13).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Acceleration {
    /// Clerc's constriction: `v <- chi (v + c1 r1 (pbest - x) + c2 r2 (gbest - x))` with
    /// `chi = 2 / |2 - phi - sqrt(phi^2 - 4 phi)|`, `phi = c1 + c2 > 4`. Each coefficient changes
    /// linearly from its first to its last value over the iterations.
    Constricted {
        /// c1, first and last.
        cognitive: (f64, f64),
        /// c2, first and last.
        social: (f64, f64),
    },
    /// Plain inertia: `v <- omega v + c1 r1 (pbest - x) + c2 r2 (gbest - x)`.
    Inertia {
        /// omega.
        inertia: f64,
        /// c1, first and last.
        cognitive: (f64, f64),
        /// c2, first and last.
        social: (f64, f64),
    },
}

/// The box each control point is searched in (Eq. 14-15).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Windows {
    /// Exactly `[x_{i-1}, x_i]` per axis. On an axis where start and target agree the window has no
    /// width, so no curve can avoid an obstacle along it.
    Literal,
    /// Widened on both sides of every axis by the larger of `length_share` times the leg's length
    /// and `radii` times the largest region's radius plus clearance.
    Widened {
        /// Share of the straight line's length.
        length_share: f64,
        /// Multiple of the largest radius.
        radii: f64,
    },
}

/// How two curves are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum PathRanking {
    /// Violation first, then cost (Deb).
    Deb,
    /// By the penalised cost alone, as printed: the best may keep a small violation.
    Penalised,
}

impl PathRanking {
    /// The better one is less.
    pub(crate) fn order(self, a: &Score, b: &Score) -> Ordering {
        match self {
            Self::Deb => a.cmp(b),
            Self::Penalised => {
                let by_cost = a.cost.total_cmp(&b.cost);
                by_cost.then(a.violation.total_cmp(&b.violation))
            }
        }
    }
}

/// Settings of the paper's particle swarm.
///
/// A field that a file leaves out has its value from [`SwarmSettings::paper`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default = "SwarmSettings::paper", deny_unknown_fields)
)]
pub struct SwarmSettings {
    /// Particles, 1 to 100,000. The paper: 150.
    pub particles: usize,
    /// Most iterations, at least 1. The paper: 100.
    pub iterations: u64,
    /// Control points of a particle's curve, start and target included, 3 to 64. The paper: at
    /// most 8.
    pub control_points: usize,
    /// Order of the curve (degree + 1), 2 to the number of control points. The paper's "K = 3.5"
    /// is no integer; the presets take 4, cubic curves.
    pub order: usize,
    /// Samples at which a curve is costed, 2 to 10,000. The paper: 100.
    pub samples: usize,
    /// Coefficients of the velocity update (Eq. 13).
    pub acceleration: Acceleration,
    /// Where each control point is searched (Eq. 14-15).
    pub windows: Windows,
    /// Greatest speed of a particle per iteration, as a share of the window's width.
    pub velocity_share: f64,
    /// Weight beta of the violation in the cost.
    pub penalty: f64,
    /// Length that makes the cost dimensionless, metres. The published costs are about
    /// length / 10,000 m.
    pub reference_length_m: f64,
    /// How curves are compared.
    pub ranking: PathRanking,
}

impl SwarmSettings {
    /// The paper's swarm: 150 particles, 100 iterations, 8 control points, 100 samples.
    ///
    /// The paper's "2.0 to 2.5" are read as c1 and c2. Their sum is unstable as printed, so the
    /// update is constricted; the windows are widened, because the printed ones leave no room beside
    /// the straight line.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            particles: 150,
            iterations: 100,
            control_points: 8,
            order: 4,
            samples: 100,
            acceleration: Acceleration::Constricted {
                cognitive: (2.5, 2.0),
                social: (2.0, 2.5),
            },
            windows: Windows::Widened {
                length_share: 0.15,
                radii: 2.0,
            },
            velocity_share: 0.2,
            penalty: 100.0,
            reference_length_m: 10_000.0,
            ranking: PathRanking::Deb,
        }
    }

    /// The paper's swarm with the coefficients in common use (inertia 0.7298, c = 1.4962).
    #[must_use]
    pub const fn standard() -> Self {
        Self {
            acceleration: Acceleration::Inertia {
                inertia: 0.7298,
                cognitive: (1.4962, 1.4962),
                social: (1.4962, 1.4962),
            },
            ..Self::paper()
        }
    }

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let mut within = |value: usize, low: usize, high: usize, place: &str| {
            violations.require((low..=high).contains(&value), place, || {
                format!("is {value}; give {low} to {high}")
            });
        };
        within(self.particles, 1, 100_000, "particles");
        within(self.control_points, 3, 64, "control_points");
        within(self.order, 2, self.control_points.max(2), "order");
        within(self.samples, 2, 10_000, "samples");
        violations.require(self.iterations > 0, "iterations", || {
            "is 0; give at least 1".into()
        });
        violations.require_positive(self.velocity_share, "velocity_share");
        violations.require_not_negative(self.penalty, "penalty");
        violations.require_positive(self.reference_length_m, "reference_length_m");
        if let Windows::Widened {
            length_share,
            radii,
        } = self.windows
        {
            violations.require_not_negative(length_share, "windows.length_share");
            violations.require_not_negative(radii, "windows.radii");
        }
        self.acceleration.validate_into(&mut violations);
        violations
    }
}

/// The three factors of one iteration's update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Factors {
    pub(crate) inertia: f32,
    pub(crate) cognitive: f32,
    pub(crate) social: f32,
}

impl Acceleration {
    /// Factors at a share of the iterations, 0 to 1.
    pub(crate) fn at(&self, share: f64) -> Factors {
        let between = |(first, last): (f64, f64)| first + (last - first) * share;
        let (scale, inertia, cognitive, social) = match *self {
            Self::Constricted { cognitive, social } => {
                let (c1, c2) = (between(cognitive), between(social));
                let phi = c1 + c2;
                let chi = 2.0 / (2.0 - phi - libm::sqrt(phi * phi - 4.0 * phi)).abs();
                (chi, 1.0, c1, c2)
            }
            Self::Inertia {
                inertia,
                cognitive,
                social,
            } => (1.0, inertia, between(cognitive), between(social)),
        };
        Factors {
            inertia: (scale * inertia) as f32,
            cognitive: (scale * cognitive) as f32,
            social: (scale * social) as f32,
        }
    }

    fn validate_into(&self, violations: &mut Violations) {
        let (cognitive, social) = match *self {
            Self::Constricted { cognitive, social } => {
                let least = (cognitive.0 + social.0).min(cognitive.1 + social.1);
                violations.require(least > 4.0, "acceleration", || {
                    format!("has c1 + c2 = {least}; constriction needs more than 4")
                });
                (cognitive, social)
            }
            Self::Inertia {
                inertia,
                cognitive,
                social,
            } => {
                violations.require_not_negative(inertia, "acceleration.inertia");
                (cognitive, social)
            }
        };
        for value in [cognitive.0, cognitive.1, social.0, social.1] {
            violations.require_not_negative(value, "acceleration");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_coefficients_are_constricted_to_one_half() {
        let factors = SwarmSettings::paper().acceleration.at(0.0);
        assert_eq!(
            (factors.inertia, factors.cognitive, factors.social),
            (0.5, 1.25, 1.0)
        );
        assert_eq!(SwarmSettings::paper().acceleration.at(1.0).social, 1.25);
    }

    #[test]
    fn validate_lists_everything() {
        let settings = SwarmSettings {
            particles: 0,
            order: 9,
            velocity_share: f64::NAN,
            acceleration: Acceleration::Constricted {
                cognitive: (1.0, 1.0),
                social: (1.0, 1.0),
            },
            ..SwarmSettings::paper()
        };
        assert_eq!(settings.validate().total(), 4);
        for preset in [SwarmSettings::paper(), SwarmSettings::standard()] {
            assert!(preset.validate().is_empty());
        }
    }
}
