//! Radius and position uncertainty of a drifting obstacle (Eq. 5).

/// How Eq. 5 is applied.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Eq5 {
    /// With two guards: a negative growth rate counts as 0, so `r` never shrinks (the paper: the region
    /// "radiates outward"), and the radius is capped. The obstacle's size is `r + |h|` under that cap,
    /// `h` being the position uncertainty; it can still shrink when `|h|` falls.
    #[default]
    Guarded,
    /// As printed: the size is `r`, limited only to at least 0.
    Literal,
}

/// The three states of Eq. 5: radius, growth rate, position uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Growth {
    /// Radius r, metres.
    pub radius_m: f64,
    /// Growth g: the radius grows by g times the current's speed.
    pub rate: f64,
    /// Position uncertainty h, metres.
    pub uncertainty_m: f64,
}

impl Growth {
    /// One update of Eq. 5 as printed, over `dt_s`: with `U` the speed of the current,
    /// `r' = r + U g dt`, `g' = g + X`, `h' = h + X + drift`, where `drift` is `U U_r` for a whole
    /// step of the paper.
    #[must_use]
    pub fn stepped(self, current_mps: f64, dt_s: f64, noise: f64, drift_m: f64) -> Self {
        Self {
            radius_m: self.radius_m + current_mps * self.rate * dt_s,
            rate: self.rate + noise,
            uncertainty_m: self.uncertainty_m + noise + drift_m,
        }
    }

    /// The same update with the guards of [`Eq5::Guarded`]: a growth of at least 0 and a radius of at most
    /// `max_radius_m`.
    #[must_use]
    pub fn stepped_guarded(
        self,
        current_mps: f64,
        dt_s: f64,
        noise: f64,
        drift_m: f64,
        max_radius_m: f64,
    ) -> Self {
        let next = Self {
            rate: self.rate.max(0.0),
            ..self
        }
        .stepped(current_mps, dt_s, noise, drift_m);
        Self {
            radius_m: next.radius_m.min(max_radius_m),
            rate: self.rate + noise,
            ..next
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_literal_step_matches_the_worked_example() {
        let state = Growth {
            radius_m: 100.0,
            rate: 1.0,
            uncertainty_m: 0.0,
        };
        let next = state.stepped(0.3, 1.0, 0.2, 0.3 * 2.0);
        assert!((next.radius_m - 100.3).abs() < 1e-12);
        assert!((next.rate - 1.2).abs() < 1e-12);
        assert!((next.uncertainty_m - 0.8).abs() < 1e-12);
    }

    #[test]
    fn the_guards_keep_the_radius_from_shrinking_and_from_passing_its_cap() {
        let state = Growth {
            radius_m: 100.0,
            rate: -2.0,
            uncertainty_m: 0.0,
        };
        let kept = state.stepped_guarded(0.3, 10.0, 0.1, 0.0, 250.0);
        assert_eq!(kept.radius_m, 100.0);
        assert!(
            (kept.rate + 1.9).abs() < 1e-12,
            "the growth state itself drifts freely"
        );
        let fast = Growth {
            rate: 100.0,
            ..state
        };
        assert_eq!(
            fast.stepped_guarded(0.3, 10.0, 0.0, 0.0, 250.0).radius_m,
            250.0
        );
    }
}
