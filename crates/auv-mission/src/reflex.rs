//! Evasion without a planner: to the nearest place that stays clear, to wait there.

use crate::check;
use crate::leads::leads;
use crate::path_question::own_problem;
use crate::state::InForce;
use crate::station_keeping::stays;
use crate::view::View;
use crate::way_on::{permanent, way_on};
use auv_obstacles::{Region, TimedPoint};
use auv_planning::motion::{ALWAYS, distance_to_regions_m, least_clearance};
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Point3, Vector3};

/// How far ahead candidates are compared, seconds. Beyond this a prediction says little.
const COMPARED_S: f64 = 120.0;

/// How long a vehicle that cannot stop circles on one trajectory while it waits, seconds.
const CIRCLES_S: f64 = 150.0;

/// No evasion is planned for longer, seconds.
const LONGEST_S: f64 = 1e6;

/// What the vehicle does when it must evade now; `None` if nothing is better than to go on as it does.
pub(crate) fn evasion(view: View<'_>) -> Option<InForce> {
    let request = own_problem(view);
    let (problem, velocity) = (request.problem(), view.beliefs().velocity);
    let lookahead_s = view.settings.margins.lookahead_s.min(LONGEST_S);
    // Circles are planned for a shorter time: they are renewed at their end.
    let for_s = if view.mission.vehicle.can_hover() {
        lookahead_s
    } else {
        lookahead_s.min(CIRCLES_S)
    };
    let lasting = Lasting {
        for_s,
        way_on_s: view.way_on_s(),
    };
    let evasion = evade(&problem, velocity, lasting);
    let certain_m = evasion
        .as_ref()
        .map_or(f64::INFINITY, |best| best.certain_m);
    let lower = |way: &Trajectory| {
        certain_shortfall_m(&problem, &permanent(problem.regions), way) < certain_m
    };
    if certain_m > 0.0 && view.is_on_track() {
        if view
            .in_force()
            .is_some_and(|whole| !view.is_flown() && lower(&whole.after(view.now_s())))
        {
            return None;
        }
        if let Some(again) = held_again(view, &problem).filter(|again| lower(&again.whole)) {
            return Some(again);
        }
    }
    let rest = || Trajectory::hover(view.here(), view.settings.waiting.retry_s);
    match evasion {
        Some(evasion) => Some(evasion.in_force),
        None => view.is_flown().then(|| InForce::new(rest(), None)),
    }
}

/// The circles at the end of the trajectory in force once more, from where it ends.
fn held_again(view: View<'_>, problem: &PathProblem<'_>) -> Option<InForce> {
    let whole = view.in_force()?;
    let (end, velocity) = (whole.end(), whole.end_velocity());
    let there = PathProblem {
        start: end.position,
        departure_s: end.time_s,
        ..*problem
    };
    let hold = way_on(&there, end, velocity, view.way_on_s())?;
    let again = whole.after(view.now_s()).then(&hold).ok()?;
    Some(InForce {
        whole: again,
        ends_s: end.time_s,
    })
}

/// How long an evasion lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lasting {
    /// Until a path is wanted again, seconds.
    pub(crate) for_s: f64,
    /// The way on after that, seconds.
    pub(crate) way_on_s: f64,
}

/// An evasion, and how far it falls short.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Evasion {
    pub(crate) in_force: InForce,
    /// See [`certain_shortfall_m`].
    pub(crate) certain_m: f64,
}

/// A trajectory that stays here, or goes a short distance in some direction and stays there.
///
/// What is certain comes first: of all candidates that the vehicle can fly, those that fall least short
/// of box, bed and charted obstacles; of these the shortest that keeps the problem's clearance from
/// everything predicted; if there is none, the one with the least [`shortfall`]. `None` if the water
/// lets the vehicle fly no candidate.
pub(crate) fn evade(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    lasting: Lasting,
) -> Option<Evasion> {
    let here = TimedPoint::new(problem.start, problem.departure_s);
    let mut search = Search::new(problem, lasting);
    for way in stays(problem, here, velocity, search.whole_s()) {
        if search.consider(way) {
            return search.best;
        }
    }
    for points in leads(problem, velocity, f64::INFINITY) {
        let Ok(way) = problem.timed(&points) else {
            continue;
        };
        // No stay at the end can make up for what is lost on the way there.
        if !search.may_improve(least_shortfall(problem, &way, search.whole_s())) {
            continue;
        }
        let rest_s = (here.time_s + search.whole_s() - way.end().time_s).max(1.0);
        let rest_s = rest_s.max(lasting.way_on_s);
        for stay in stays(problem, way.end(), way.end_velocity(), rest_s) {
            let whole = way.clone().then(&stay);
            if whole.is_ok_and(|whole| search.consider(whole)) {
                return search.best;
            }
        }
    }
    search.best
}

/// The best candidate so far.
struct Search<'p> {
    problem: &'p PathProblem<'p>,
    lasting: Lasting,
    permanent: Vec<Region>,
    best: Option<Evasion>,
    /// The [`shortfall`] of the best.
    predicted: f64,
}

impl<'p> Search<'p> {
    fn new(problem: &'p PathProblem<'p>, lasting: Lasting) -> Self {
        Self {
            problem,
            lasting,
            permanent: permanent(problem.regions),
            best: None,
            predicted: f64::INFINITY,
        }
    }

    /// How long a candidate is to last, seconds. A vehicle that hovers needs no way on.
    fn whole_s(&self) -> f64 {
        let Lasting { for_s, way_on_s } = self.lasting;
        if self.problem.vehicle.can_hover() {
            for_s
        } else {
            for_s + way_on_s
        }
    }

    /// Whether a candidate with such a [`shortfall`] may be better. Candidates come in order of length:
    /// a longer one must be strictly better.
    fn may_improve(&self, predicted: f64) -> bool {
        let best = self.best.as_ref();
        best.is_none_or(|best| best.certain_m > 0.0 || predicted < self.predicted)
    }

    /// Keeps a candidate if it is better; returns whether nothing can be better than the best.
    fn consider(&mut self, whole: Trajectory) -> bool {
        let predicted = shortfall(self.problem, &whole);
        if self.may_improve(predicted) && check::can_be_steered(self.problem, &whole) {
            let certain_m = self.certain_m(&whole);
            let better = self.best.as_ref().is_none_or(|best| {
                let order = certain_m.total_cmp(&best.certain_m);
                order.then(predicted.total_cmp(&self.predicted)).is_lt()
            });
            if better {
                self.predicted = predicted;
                self.best = Some(Evasion {
                    in_force: self.in_force(whole),
                    certain_m,
                });
            }
        }
        let best = self.best.as_ref();
        best.is_some_and(|best| best.certain_m <= 0.0) && self.predicted <= 0.0
    }

    /// See [`certain_shortfall_m`]: nothing where the verifier finds nothing.
    fn certain_m(&self, whole: &Trajectory) -> f64 {
        let charted = PathProblem {
            regions: &self.permanent,
            ..*self.problem
        };
        if check::is_free(&charted, whole) {
            0.0
        } else {
            certain_shortfall_m(self.problem, &self.permanent, whole).max(LEAST_M)
        }
    }

    fn in_force(&self, whole: Trajectory) -> InForce {
        let way_on_s = if self.problem.vehicle.can_hover() {
            0.0
        } else {
            self.lasting.way_on_s
        };
        InForce {
            ends_s: (whole.end().time_s - way_on_s).max(whole.start().time_s),
            whole,
        }
    }
}

/// Greatest distance between two samples of the bed, metres.
const SAMPLED_M: f64 = 5.0;
/// Shortfalls are compared in steps of this, metres: rounding must not decide.
const LEAST_M: f64 = 0.01;

/// How far a trajectory leads below the deepest depth allowed over the bed, out of the box or into charted
/// obstacles, metres; the greatest of them at samples.
pub(crate) fn certain_shortfall_m(
    problem: &PathProblem<'_>,
    permanent: &[Region],
    way: &Trajectory,
) -> f64 {
    let wanted_m = problem.clearance_m;
    let nearest = least_clearance(way, permanent, ALWAYS, wanted_m);
    let inside_m = wanted_m - nearest.clearance_m;
    let below = |p: Point3<f64>| p.z - problem.deepest_at(p.x, p.y);
    let below_m = way.segments().flat_map(sampled_places).map(below);
    let below_m = below_m.fold(0.0, f64::max);
    let bounds = problem.bounds.as_ref();
    let outside = |p: &TimedPoint| bounds.map_or(0.0, |bounds| bounds.excess_m(&p.position));
    let outside_m = way.points().iter().map(outside).fold(0.0, f64::max);
    let short_m = inside_m.max(below_m).max(outside_m);
    (short_m / LEAST_M).floor() * LEAST_M
}

/// Places on a segment at even distances of at most [`SAMPLED_M`], the end included.
fn sampled_places((from, to): (&TimedPoint, &TimedPoint)) -> impl Iterator<Item = Point3<f64>> {
    let (from, way) = (from.position, to.position - from.position);
    let count = (way.norm() / SAMPLED_M).ceil().max(1.0);
    (1..=count as u32).map(move |k| from + way * (f64::from(k) / count))
}

/// How far and for how long a trajectory falls short of the problem's clearance, in metres summed over
/// samples; 0 if it keeps the clearance. Leading deeper into a region than the vehicle is now adds
/// [`DEEPER`] times that depth for every sample.
fn shortfall(problem: &PathProblem<'_>, way: &Trajectory) -> f64 {
    let start_s = problem.departure_s;
    let end_s = way.end().time_s.min(start_s + COMPARED_S);
    let wanted_m = problem.clearance_m;
    let nearest = least_clearance(way, problem.regions, (start_s, end_s), wanted_m);
    if nearest.clearance_m >= wanted_m {
        return 0.0;
    }
    sampled(problem, way, end_s).max(1e-9)
}

/// A lower bound on [`shortfall`] for all candidates of `duration_s` that start with `way`.
fn least_shortfall(problem: &PathProblem<'_>, way: &Trajectory, duration_s: f64) -> f64 {
    let end_s = problem.departure_s + COMPARED_S;
    if way.end().time_s >= end_s {
        shortfall(problem, way)
    } else if duration_s > COMPARED_S + 1.0 {
        sampled(problem, way, end_s)
    } else {
        0.0
    }
}

/// Samples of a candidate over the time compared.
const SAMPLES: u32 = 24;
/// A vehicle that is too near to a region rather stays there than crosses it.
const DEEPER: f64 = 5.0;

/// The sum of metres by which a trajectory is too near at even times from departure to `end_s` (or its
/// end), and [`DEEPER`] times how much deeper it leads than the vehicle is now, for every sample.
fn sampled(problem: &PathProblem<'_>, way: &Trajectory, end_s: f64) -> f64 {
    let (start_s, wanted_m) = (problem.departure_s, problem.clearance_m);
    let (mut sum_m, mut here_m, mut worst_m) = (0.0, 0.0, 0.0_f64);
    for k in 0..=SAMPLES {
        let time_s = start_s + (end_s - start_s) * f64::from(k) / f64::from(SAMPLES);
        if time_s > way.end().time_s + 1e-9 {
            break;
        }
        let place = TimedPoint::new(way.at(time_s).0, time_s);
        let depth_m = wanted_m - distance_to_regions_m(&place, problem.regions, wanted_m);
        if k == 0 {
            here_m = depth_m;
        }
        sum_m += depth_m;
        worst_m = worst_m.max(depth_m - here_m);
    }
    sum_m + DEEPER * f64::from(SAMPLES) * worst_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Vehicle;
    use auv_types::libm;

    const LASTING: Lasting = Lasting {
        for_s: 300.0,
        way_on_s: 120.0,
    };

    #[test]
    fn evades_a_ball_and_waits() {
        for vehicle in [Vehicle::paper(), Vehicle::default()] {
            let mut ball = Region::ball(Point3::new(-150.0, 0.0, 50.0), 60.0);
            ball.velocity_mps = Vector3::new(1.0, 0.0, 0.0);
            let regions = [ball];
            let problem = PathProblem {
                regions: &regions,
                clearance_m: 10.0,
                ..PathProblem::new(
                    Point3::new(0.0, 0.0, 50.0),
                    Point3::new(500.0, 0.0, 50.0),
                    &vehicle,
                )
            };
            let way = evade(&problem, Vector3::x() * vehicle.speed_mps, LASTING);
            let way = way.unwrap().in_force.whole;
            let nearest = least_clearance(&way, &regions, (0.0, COMPARED_S), 1e9);
            assert!(nearest.clearance_m >= 10.0, "{nearest:?}");
        }
    }

    #[test]
    fn leaves_a_region_that_contains_the_vehicle() {
        let vehicle = Vehicle::paper();
        let regions = [Region::ball(Point3::new(0.0, -40.0, 50.0), 60.0)];
        let problem = PathProblem {
            regions: &regions,
            clearance_m: 5.0,
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 50.0),
                Point3::new(500.0, 0.0, 50.0),
                &vehicle,
            )
        };
        let way = evade(&problem, Vector3::zeros(), LASTING).unwrap();
        let way = way.in_force.whole;
        assert!(distance_to_regions_m(&way.end(), &regions, 1e9) >= 5.0);
    }

    #[test]
    fn stays_within_a_margin_rather_than_go_through_a_wall() {
        let vehicle = Vehicle::paper();
        let regions: Vec<Region> = (0..8)
            .map(|k| {
                let bearing = std::f64::consts::TAU * f64::from(k) / 8.0;
                let (sin, cos) = libm::sincos(bearing);
                Region::cylinder(Point3::new(21.0 * cos, 21.0 * sin, 50.0), 20.0, 0.0, 100.0)
            })
            .collect();
        let problem = PathProblem {
            regions: &regions,
            clearance_m: 10.0,
            bounds: Some(auv_types::Bounds::new(
                Point3::new(-900.0, -900.0, 0.0),
                Point3::new(900.0, 900.0, 100.0),
            )),
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 50.0),
                Point3::new(500.0, 0.0, 50.0),
                &vehicle,
            )
        };
        let way = evade(&problem, Vector3::zeros(), LASTING).unwrap();
        let way = way.in_force.whole;
        let nearest = least_clearance(&way, &regions, (0.0, COMPARED_S), 1e9);
        assert!(nearest.clearance_m >= 0.99, "{nearest:?}");
    }
}
