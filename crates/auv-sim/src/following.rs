//! How well the vehicle keeps to the timed places of its trajectories.

/// Distances between the true place and the place where the trajectory in force has the vehicle at that time.
///
/// Memory does not grow with the mission: distances are counted by tenths of a metre.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Following {
    /// `counts[k]`: distances from `k` to `k + 1` tenths of a metre; the last one also those beyond.
    counts: Vec<u64>,
    most_m: f64,
}

impl Following {
    const TENTHS: usize = 1_000;

    /// Adds one distance, metres.
    pub(crate) fn see(&mut self, off_m: f64) {
        if self.counts.is_empty() {
            self.counts = vec![0; Self::TENTHS];
        }
        let tenth = (off_m * 10.0).clamp(0.0, (Self::TENTHS - 1) as f64) as usize;
        self.counts[tenth] += 1;
        self.most_m = self.most_m.max(off_m);
    }

    /// The distance that `share` of all do not exceed, to a tenth of a metre (never too small, 100 m at most); 0 without any.
    #[must_use]
    pub fn quantile_m(&self, share: f64) -> f64 {
        let total: u64 = self.counts.iter().sum();
        let mut left = (share.clamp(0.0, 1.0) * total as f64).ceil() as u64;
        for (tenth, count) in self.counts.iter().enumerate() {
            if left <= *count {
                return if left == 0 {
                    0.0
                } else {
                    (tenth + 1) as f64 / 10.0
                };
            }
            left -= count;
        }
        0.0
    }

    /// The greatest distance, metres.
    #[must_use]
    pub const fn most_m(&self) -> f64 {
        self.most_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_distances_rounded_up() {
        let mut following = Following::default();
        assert_eq!(following.quantile_m(0.95), 0.0);
        for k in 0..100 {
            following.see(f64::from(k) * 0.05);
        }
        following.see(1e6);
        assert_eq!((following.quantile_m(0.5), following.most_m()), (2.6, 1e6));
        assert_eq!(
            (following.quantile_m(0.0), following.quantile_m(1.0)),
            (0.0, 100.0)
        );
    }
}
