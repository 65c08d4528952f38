//! How far a trajectory falls short of what it should keep clear of.

use crate::bow::Mover;
use crate::check;
use crate::way_on::permanent;
use auv_obstacles::{Region, TimedPoint};
use auv_planning::motion::{ALWAYS, least_clearance};
use auv_planning::{PathProblem, Trajectory};
use auv_types::Point3;

/// How far ahead trajectories are compared, seconds. Beyond this a prediction says little ...
const COMPARED_S: f64 = 120.0;
/// ... but for what is faster than the vehicle: that is compared as far ahead as this.
const LONGEST_S: f64 = 300.0;
/// Greatest time between two samples, and least where something is faster than the vehicle, seconds.
const STEP_S: f64 = 5.0;
const LEAST_STEP_S: f64 = 1.0;
/// Between two samples what is fast moves by no more than this share of its radius.
const STEP_SHARE: f64 = 0.25;

/// Greatest distance between two samples of the bed, metres.
const SAMPLED_M: f64 = 5.0;
/// Shortfalls are compared in steps of this, metres: rounding must not decide.
const LEAST_M: f64 = 0.01;

/// Falling short of bed and charted obstacles by less counts only between equals: it is within their margins, and over
/// a slope all level ways fall short by so much.
const SLIGHT_M: f64 = 0.5;
/// What leads into a region falls short by at least this.
const LEAST: f64 = 1e-9;
/// Weight of the mean over all samples, beside the worst of them.
const MEAN: f64 = 0.2;
/// The crossing of a bow counts as much as this share of a region's radius.
const BOW: f64 = 0.2;
/// A trajectory in force gives way only to one that falls short by this share less ...
const BETTER: f64 = 0.1;
/// ... by this one if it was chosen less than [`FRESH_S`] ago: the next echoes may take back what the first ones told ...
const BETTER_THAN_FRESH: f64 = 0.3;
const FRESH_S: f64 = 10.0;
/// ... and by this much less.
const LEAST_BETTER: f64 = 0.05;
/// What falls short by less is not worth a change.
const SMALL: f64 = 0.02;

/// How far a trajectory falls short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shortfall {
    /// Of bed, box and charted obstacles: see [`Prospect::certain_shortfall_m`].
    pub(crate) certain_m: f64,
    /// Of everything predicted: see [`Prospect::predicted_below`].
    pub(crate) predicted: f64,
}

impl Shortfall {
    pub(crate) fn is_none(self) -> bool {
        self.certain_m <= 0.0 && self.predicted <= 0.0
    }

    /// Of bed, box and charted obstacles, where that counts before everything predicted, metres.
    pub(crate) fn first_m(self) -> f64 {
        if self.certain_m < SLIGHT_M {
            0.0
        } else {
            self.certain_m
        }
    }

    /// Whether nothing can be better by what is worth a change.
    pub(crate) fn is_small(self) -> bool {
        self.first_m() <= 0.0 && self.predicted <= SMALL
    }

    /// Whether it is less: what is certain counts first.
    pub(crate) fn is_less_than(self, other: Self) -> bool {
        let order = self.first_m().total_cmp(&other.first_m());
        order
            .then(self.predicted.total_cmp(&other.predicted))
            .then(self.certain_m.total_cmp(&other.certain_m))
            .is_lt()
    }

    /// Whether an evasion in force, chosen some time ago, gives way to another: only if that is clear, or clearly better.
    pub(crate) fn gives_way_to(self, other: Self, chosen_ago_s: f64) -> bool {
        if self.first_m().total_cmp(&other.first_m()).is_ne() {
            return other.first_m() < self.first_m();
        }
        if other.predicted <= 0.0 {
            return self.predicted > SMALL;
        }
        other.predicted < self.clearly_better(chosen_ago_s)
    }

    /// What falls short of what is predicted by this or more never replaces it, nor is it small.
    pub(crate) fn matters_below(self, chosen_ago_s: f64) -> f64 {
        if self.first_m() > 0.0 {
            f64::INFINITY
        } else {
            self.clearly_better(chosen_ago_s).max(2.0 * SMALL)
        }
    }

    /// Between equals, what falls short of what is predicted by less is clearly better.
    fn clearly_better(self, chosen_ago_s: f64) -> f64 {
        let share = if chosen_ago_s < FRESH_S {
            BETTER_THAN_FRESH
        } else {
            BETTER
        };
        self.predicted - (share * self.predicted).max(LEAST_BETTER)
    }
}

/// What trajectories from the start of a problem are compared by.
pub(crate) struct Prospect<'p> {
    problem: &'p PathProblem<'p>,
    permanent: Vec<Region>,
    /// Regions that the vehicle can meet in the time compared.
    near: Vec<Region>,
    movers: Vec<Mover>,
    /// End of the time compared.
    until_s: f64,
    /// Time between two samples.
    step_s: f64,
}

impl<'p> Prospect<'p> {
    pub(crate) fn new(problem: &'p PathProblem<'p>) -> Self {
        let (now_s, own_mps) = (problem.departure_s, problem.vehicle.max_speed_mps);
        let fast = |region: &&Region| region.velocity_mps.norm() > own_mps;
        let regions = problem.regions.iter();
        let ends_s = regions
            .clone()
            .filter(fast)
            .map(|region| region.until_s - now_s);
        let ahead_s = ends_s.fold(COMPARED_S, f64::max).min(LONGEST_S);
        let water_mps = problem
            .current
            .map_or(0.0, |current| current.max_speed_mps());
        let reach_m = (own_mps + water_mps) * ahead_s + problem.clearance_m;
        let near = regions.filter(|region| {
            let (from_s, until_s) = (
                now_s.max(region.from_s),
                region.until_s.min(now_s + ahead_s),
            );
            from_s <= until_s && {
                let radius_m = region.radius_at(from_s).max(region.radius_at(until_s));
                let moved_m = region.velocity_mps.norm() * (until_s - from_s);
                let offset = problem.start - region.centre_at(from_s);
                offset.xy().norm() <= reach_m + radius_m + moved_m
            }
        });
        let near: Vec<Region> = near.copied().collect();
        let step_s = |region: &Region| {
            let closing_mps = region.velocity_mps.norm() + own_mps;
            STEP_SHARE * (region.radius_m + problem.clearance_m) / closing_mps
        };
        let steps_s = near.iter().filter(fast).map(step_s);
        Self {
            step_s: steps_s.fold(STEP_S, f64::min).max(LEAST_STEP_S),
            problem,
            permanent: permanent(problem.regions),
            movers: Mover::of(&near, now_s),
            near,
            until_s: now_s + ahead_s,
        }
    }

    pub(crate) fn shortfall(&self, way: &Trajectory) -> Shortfall {
        Shortfall {
            certain_m: self.certain_m(way),
            predicted: self
                .predicted_below(way, f64::INFINITY)
                .unwrap_or(f64::INFINITY),
        }
    }

    /// See [`Prospect::certain_shortfall_m`]: nothing where the verifier finds nothing.
    pub(crate) fn certain_m(&self, whole: &Trajectory) -> f64 {
        let charted = PathProblem {
            regions: &self.permanent,
            ..*self.problem
        };
        if check::is_free(&charted, whole) {
            0.0
        } else {
            self.certain_shortfall_m(whole).max(LEAST_M)
        }
    }

    /// How far a trajectory leads below the deepest depth allowed over the bed, out of the box (and [`SLIGHT_M`] more)
    /// or into charted obstacles, metres; the greatest of them at samples.
    pub(crate) fn certain_shortfall_m(&self, way: &Trajectory) -> f64 {
        let problem = self.problem;
        let wanted_m = problem.clearance_m;
        let nearest = least_clearance(way, &self.permanent, ALWAYS, wanted_m);
        let inside_m = wanted_m - nearest.clearance_m;
        let below = |p: Point3<f64>| p.z - problem.deepest_at(p.x, p.y);
        let below_m = way.segments().flat_map(sampled_places).map(below);
        let below_m = below_m.fold(0.0, f64::max);
        let bounds = problem.bounds.as_ref();
        let outside = |p: &TimedPoint| bounds.map_or(0.0, |bounds| bounds.excess_m(&p.position));
        let outside_m = way.points().iter().map(outside).fold(0.0, f64::max);
        // The box has no margin: leaving it is never slight.
        let outside_m = if outside_m > 0.0 {
            outside_m + SLIGHT_M
        } else {
            0.0
        };
        let short_m = inside_m.max(below_m).max(outside_m);
        (short_m / LEAST_M).floor() * LEAST_M
    }

    /// How far a trajectory falls short of the problem's clearance from what is predicted, if that is less than a
    /// limit; 0 if it keeps the clearance and crosses no bow.
    ///
    /// It is the worst and a part of the mean over samples of how deep the trajectory leads into a region, as a
    /// share of its radius: of what is known worse, which makes wide regions, a metre counts less. It is at least
    /// [`BOW`] where a bow is crossed: what is hit whichever side it is passed on is passed where that is farthest.
    pub(crate) fn predicted_below(&self, way: &Trajectory, limit: f64) -> Option<f64> {
        let wanted_m = self.problem.clearance_m;
        let during_s = (self.problem.departure_s, way.end().time_s.min(self.until_s));
        let sampled = self.sampled_below(way, during_s.1, None, limit)?;
        // Between two samples too.
        let is_clear = || {
            let nearest = least_clearance(way, &self.near, during_s, wanted_m);
            nearest.clearance_m >= wanted_m
        };
        let deep = if sampled < LEAST && is_clear() {
            0.0
        } else {
            sampled.max(LEAST)
        };
        let predicted = if deep < BOW && self.crosses_a_bow(way, during_s.1) {
            BOW
        } else {
            deep
        };
        (predicted < limit).then_some(predicted)
    }

    /// Whether a candidate of `duration_s` that starts with `way` may fall short of what is predicted by less than
    /// a limit.
    pub(crate) fn may_stay_below(&self, way: &Trajectory, duration_s: f64, limit: f64) -> bool {
        if way.end().time_s >= self.until_s {
            return self.predicted_below(way, limit).is_some();
        }
        let whole_s = duration_s.min(self.until_s - self.problem.departure_s);
        self.sampled_below(way, way.end().time_s, Some(whole_s), limit)
            .is_some()
    }

    /// The worst and a part of the mean of how deep a trajectory leads, at even times until `until_s`, if that is
    /// less than a limit; the mean over the samples of `whole_s`, if it is given.
    fn sampled_below(
        &self,
        way: &Trajectory,
        until_s: f64,
        whole_s: Option<f64>,
        limit: f64,
    ) -> Option<f64> {
        let count = self.times_s(until_s).count() as f64;
        let whole = whole_s.map_or(count, |whole_s| (whole_s / self.step_s).floor() + 1.0);
        let whole = whole.max(count).max(1.0);
        let (mut worst, mut sum) = (0.0_f64, 0.0);
        for place in self.places(way, until_s) {
            let deep = self.deep(&place);
            worst = worst.max(deep);
            sum += deep;
            // Later samples only add to it.
            if worst + MEAN * (sum / whole) >= limit {
                return None;
            }
        }
        Some(worst + MEAN * (sum / whole))
    }

    /// How deep a place lies in any region grown by the clearance, as a share of its radius.
    fn deep(&self, place: &TimedPoint) -> f64 {
        let wanted_m = self.problem.clearance_m;
        let deep = |region: &Region| {
            let depth_m = wanted_m - region.distance_m(place);
            if depth_m > 0.0 {
                depth_m / (region.radius_at(place.time_s) + wanted_m).max(depth_m)
            } else {
                0.0
            }
        };
        self.near.iter().map(deep).fold(0.0, f64::max)
    }

    /// Where a trajectory is at even times from departure to `until_s`.
    fn places<'a>(
        &self,
        way: &'a Trajectory,
        until_s: f64,
    ) -> impl Iterator<Item = TimedPoint> + use<'a> {
        self.times_s(until_s)
            .map(|time_s| TimedPoint::new(way.at(time_s).0, time_s))
    }

    /// Even times from departure to `until_s`.
    fn times_s(&self, until_s: f64) -> impl Iterator<Item = f64> + use<> {
        let (start_s, step_s) = (self.problem.departure_s, self.step_s);
        let times_s = (0..).map(move |k| start_s + step_s * f64::from(k));
        times_s.take_while(move |time_s| *time_s <= until_s + 1e-9)
    }

    fn crosses_a_bow(&self, way: &Trajectory, until_s: f64) -> bool {
        if self.movers.is_empty() {
            return false;
        }
        let places: Vec<TimedPoint> = self.places(way, until_s).collect();
        let crossed = |mover: &Mover| places.windows(2).any(|step| mover.is_crossed(step));
        self.movers.iter().any(crossed)
    }
}

/// Places on a segment at even distances of at most [`SAMPLED_M`], the end included.
fn sampled_places((from, to): (&TimedPoint, &TimedPoint)) -> impl Iterator<Item = Point3<f64>> {
    let (from, way) = (from.position, to.position - from.position);
    let count = (way.norm() / SAMPLED_M).ceil().max(1.0);
    (1..=count as u32).map(move |k| from + way * (f64::from(k) / count))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slight_shortfall_of_the_bed_counts_less_than_a_collision() {
        let shortfall = |certain_m, predicted| Shortfall {
            certain_m,
            predicted,
        };
        let into_a_mover = shortfall(0.0, 0.9);
        let over_a_slope = shortfall(0.4, 0.3);
        let into_the_bed = shortfall(0.6, 0.0);
        assert!(over_a_slope.is_less_than(into_a_mover));
        assert!(into_a_mover.gives_way_to(over_a_slope, 0.0));
        assert!(into_a_mover.is_less_than(into_the_bed));
        assert!(!into_a_mover.gives_way_to(into_the_bed, 60.0));
        assert!(into_the_bed.gives_way_to(into_a_mover, 0.0));
        // Between equals it counts.
        assert!(shortfall(0.0, 0.3).is_less_than(over_a_slope));
    }

    #[test]
    fn what_does_not_matter_neither_replaces_nor_is_small() {
        let certain_m = [0.0, 0.4, 0.6];
        let predicted = (0..40).map(|k| 0.01 * f64::from(k));
        let all = certain_m.into_iter().flat_map(|certain_m| {
            predicted.clone().map(move |predicted| Shortfall {
                certain_m,
                predicted,
            })
        });
        for kept in all.clone().filter(|kept| !kept.is_small()) {
            for ago_s in [0.0, 60.0] {
                let matters = kept.matters_below(ago_s);
                for other in all.clone().filter(|other| other.predicted >= matters) {
                    assert!(!kept.gives_way_to(other, ago_s), "{kept:?} {other:?}");
                    assert!(!other.is_small(), "{kept:?} {other:?}");
                }
            }
        }
    }

    #[test]
    fn a_fresh_choice_is_kept_against_more() {
        let deep = |predicted| Shortfall {
            certain_m: 0.0,
            predicted,
        };
        let fresh = |other| deep(0.9).gives_way_to(deep(other), 9.0);
        let old = |other| deep(0.9).gives_way_to(deep(other), 11.0);
        assert_eq!(
            [0.0, 0.62, 0.64, 0.8, 0.82].map(fresh),
            [true, true, false, false, false]
        );
        assert_eq!(
            [0.0, 0.62, 0.64, 0.8, 0.82].map(old),
            [true, true, true, true, false]
        );
    }
}
