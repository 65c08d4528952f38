//! Travel times that depend on the departure.

use crate::ids::ArcId;
use auv_types::Violations;
use std::collections::BTreeMap;

/// Travel times by departure for some arcs of a network; the other arcs keep their own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Profiles {
    /// Departures in seconds, ascending.
    times_s: Vec<f64>,
    /// For each arc that has a profile, its travel time in seconds at each of `times_s`, without the
    /// completion time of the edge's task.
    travel_s: BTreeMap<ArcId, Vec<f64>>,
    index: TimeIndex,
}

/// Greatest departure and travel time, seconds: beyond that, sums and products of times lose their order.
const MOST_S: f64 = 1e12;

/// Finds the place of a time among ascending ones: even cells of time, and where to begin in each.
#[derive(Clone, Debug, Default, PartialEq)]
struct TimeIndex {
    first_s: f64,
    cells_per_s: f64,
    /// For each cell, a number of times that all lie before it.
    before: Vec<u32>,
}

impl TimeIndex {
    const CELLS_PER_TIME: usize = 4;

    fn new(times_s: &[f64]) -> Self {
        let (first_s, last_s) = (times_s[0], times_s[times_s.len() - 1]);
        let cells = Self::CELLS_PER_TIME * times_s.len();
        let cells_per_s = cells as f64 / (last_s - first_s).max(f64::MIN_POSITIVE);
        // Where the cell before begins, so that no rounding counts a time too many.
        let begins_s = |cell: usize| first_s + (cell as f64 - 1.0) / cells_per_s;
        let before = |cell| times_s.partition_point(|&t| t < begins_s(cell)) as u32;
        Self {
            first_s,
            cells_per_s,
            before: (0..cells).map(before).collect(),
        }
    }

    /// The number of times before a given one.
    #[inline]
    fn before(&self, times_s: &[f64], at_s: f64) -> usize {
        let cell = ((at_s - self.first_s) * self.cells_per_s) as usize;
        let mut before = self.before[cell.min(self.before.len() - 1)] as usize;
        while times_s.get(before).is_some_and(|&t| t < at_s) {
            before += 1;
        }
        before
    }
}

/// The travel time of one arc by departure: linear between the times given, constant outside. First in,
/// first out: who leaves later never arrives earlier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile<'a> {
    index: &'a TimeIndex,
    times_s: &'a [f64],
    travel_s: &'a [f64],
}

impl Profiles {
    /// Profiles given at the departures `times_s`.
    ///
    /// # Errors
    /// All of: times that are not finite and ascending, an arc without one travel time for each, a travel
    /// time that is negative or not finite, an arc on which a later departure arrives earlier. Arcs are
    /// named by `name`.
    pub fn new(
        times_s: Vec<f64>,
        travel_s: BTreeMap<ArcId, Vec<f64>>,
        name: impl Fn(ArcId) -> String,
    ) -> Result<Self, Violations> {
        let mut violations = Violations::new();
        violations.require(!times_s.is_empty(), "profiles.times", || {
            "is empty; give at least one departure in seconds".into()
        });
        let within = times_s.iter().all(|t| t.abs() <= MOST_S);
        let ascending = within && times_s.is_sorted_by(|a, b| a < b);
        violations.require(ascending, "profiles.times", || {
            format!(
                "is not ascending, or beyond {MOST_S:e} s; give seconds in ascending order, each once"
            )
        });
        for (&arc, travel) in &travel_s {
            check_profile(&times_s, travel, &name(arc), &mut violations);
        }
        violations.into_result()?;
        Ok(Self {
            index: TimeIndex::new(&times_s),
            times_s,
            travel_s,
        })
    }

    /// The profile of an arc, if it has one.
    #[must_use]
    pub fn of(&self, arc: ArcId) -> Option<Profile<'_>> {
        let travel_s = self.travel_s.get(&arc)?;
        Some(Profile {
            index: &self.index,
            times_s: &self.times_s,
            travel_s,
        })
    }

    /// The departures at which travel times are given, in seconds.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// The arcs that have a profile, with their travel times in seconds.
    pub fn arcs(&self) -> impl Iterator<Item = (ArcId, &[f64])> + '_ {
        self.travel_s
            .iter()
            .map(|(&arc, travel)| (arc, &travel[..]))
    }

    /// Whether no arc has a profile.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.travel_s.is_empty()
    }
}

fn check_profile(times_s: &[f64], travel_s: &[f64], place: &str, violations: &mut Violations) {
    if travel_s.len() != times_s.len() {
        let (given, times) = (travel_s.len(), times_s.len());
        let message = format!("has {given} entries; give one for each of the {times} times");
        violations.push(place, message);
        return;
    }
    let bad = travel_s
        .iter()
        .find(|&&t| !(0.0..=MOST_S).contains(&t))
        .copied();
    if let Some(bad) = bad {
        let message = format!("holds {bad:?}; give seconds from 0 to {MOST_S:e}");
        violations.push(place, message);
        return;
    }
    for (k, (times, travel)) in times_s.windows(2).zip(travel_s.windows(2)).enumerate() {
        let (wait_s, gain_s) = (times[1] - times[0], travel[0] - travel[1]);
        if gain_s > wait_s * (1.0 + 1e-12) {
            let (from, to) = (times_s[k], times_s[k + 1]);
            let message = format!(
                "falls by {gain_s} s between departures {from} and {to}, so a later departure arrives \
                 earlier; give travel times that fall by at most 1 s per second"
            );
            violations.push(place, message);
            return;
        }
    }
}

impl Profile<'_> {
    /// Travel time in seconds at a departure.
    #[must_use]
    #[inline]
    pub fn travel_s(&self, departure_s: f64) -> f64 {
        let (times, travel) = (self.times_s, self.travel_s);
        let after = self.index.before(times, departure_s);
        if after == 0 || after == times.len() {
            return travel[after.min(times.len() - 1)];
        }
        let (t0, t1) = (times[after - 1], times[after]);
        let (y0, y1) = (travel[after - 1], travel[after]);
        // Rounding makes no travel time negative.
        (y0 + (y1 - y0) * (departure_s - t0) / (t1 - t0)).max(0.0)
    }

    /// The latest departure that arrives at `arrival_s` or before, in seconds.
    ///
    /// The inverse of departure plus travel time, which never falls.
    #[must_use]
    pub fn latest_departure_s(&self, arrival_s: f64) -> f64 {
        let (times, travel) = (self.times_s, self.travel_s);
        let arrival = |k: usize| times[k] + travel[k];
        let (mut low, mut high) = (0, times.len());
        // The number of given departures that arrive in time.
        while low < high {
            let middle = usize::midpoint(low, high);
            if arrival(middle) <= arrival_s {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        if low == 0 || low == times.len() {
            return arrival_s - travel[low.min(times.len() - 1)];
        }
        let (first, last) = (arrival(low - 1), arrival(low));
        let share = (arrival_s - first) / (last - first);
        times[low - 1] + (times[low] - times[low - 1]) * share
    }

    /// The least travel time at any departure, in seconds.
    #[must_use]
    pub fn least_s(&self) -> f64 {
        self.travel_s.iter().copied().fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn profiles(travel_s: &[f64]) -> Result<Profiles, Violations> {
        let times_s = (0..travel_s.len()).map(|k| 10.0 * k as f64).collect();
        let arcs = [(ArcId(3), travel_s.to_vec())].into();
        Profiles::new(times_s, arcs, |arc| format!("arc {}", arc.0))
    }

    #[test]
    fn a_profile_that_overtakes_is_refused_by_name() {
        let message = profiles(&[30.0, 19.0]).unwrap_err().to_string();
        assert!(
            message.contains("arc 3") && message.contains("falls by 11"),
            "{message}"
        );
        assert!(profiles(&[30.0, 20.0]).is_ok());
        assert!(profiles(&[30.0, f64::NAN]).is_err() && profiles(&[-1.0]).is_err());
    }

    #[test]
    fn times_whose_products_overflow_are_refused() {
        let message = profiles(&[1e300, 30.0]).unwrap_err().to_string();
        assert!(message.contains("holds 1e300"), "{message}");
        let arcs = || [(ArcId(3), vec![1e9, 5.0])].into();
        let far = Profiles::new(vec![-1e308, 1e308], arcs(), |arc| arc.0.to_string());
        assert!(far.is_err());
        let near = Profiles::new(vec![-1e12, 1e12], arcs(), |arc| arc.0.to_string()).unwrap();
        let profile = near.of(ArcId(3)).unwrap();
        for departure_s in [-1e12, -1.0, 0.0, 1e11, 1e12, 1e300] {
            assert!(profile.travel_s(departure_s) >= 0.0);
        }
    }

    proptest! {
        #[test]
        fn the_index_finds_what_a_binary_search_finds(
            steps in prop::collection::vec(1e-6..50.0_f64, 1..9),
            at in -0.2..1.2_f64,
        ) {
            let mut times_s = vec![-7.5];
            times_s.extend(steps.iter().scan(-7.5, |sum, step| { *sum += step; Some(*sum) }));
            let index = TimeIndex::new(&times_s);
            let length_s = times_s[times_s.len() - 1] - times_s[0];
            let drawn = times_s[0] + at * length_s;
            for at_s in times_s.iter().copied().chain([drawn, -1e300, 1e300]) {
                let before = times_s.partition_point(|&t| t < at_s);
                prop_assert_eq!(index.before(&times_s, at_s), before);
            }
        }

        #[test]
        fn the_latest_departure_is_the_inverse(
            steps in prop::collection::vec(-10.0..20.0_f64, 1..6),
            arrival_s in 0.0..300.0_f64,
        ) {
            let travel_s: Vec<_> = steps
                .iter()
                .scan(80.0, |sum, step| { *sum += step; Some(*sum) })
                .collect();
            let profiles = profiles(&travel_s).unwrap();
            let profile = profiles.of(ArcId(3)).unwrap();
            let latest_s = profile.latest_departure_s(arrival_s);
            let arrive = |t: f64| t + profile.travel_s(t);
            prop_assert!(arrive(latest_s) <= arrival_s + 1e-9);
            prop_assert!(arrive(latest_s + 1e-3) >= arrival_s - 1e-9);
        }
    }
}
