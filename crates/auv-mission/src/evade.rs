//! The search for an evasion: to the nearest place that stays clear, to wait there.

use crate::check;
use crate::leads::{DIRECTIONS, leads};
use crate::shortfall::{Prospect, Shortfall};
use crate::state::InForce;
use crate::station_keeping::stays;
use auv_obstacles::TimedPoint;
use auv_planning::{PathProblem, Trajectory, Vehicle};
use auv_types::Vector3;

/// Share of the greatest speed at which the vehicle hurries: the rest makes up for lag.
const HURRY: f64 = 0.99;
/// It goes slowly at as many times its least speed.
const SLOW: f64 = 1.05;
/// Shortfalls that differ by less are equal but for rounding.
const ROUNDING: f64 = 1e-9;

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
    pub(crate) shortfall: Shortfall,
}

/// A trajectory that stays here, or goes a short distance in some direction and stays there.
///
/// What is certain comes first: of all candidates that the vehicle can fly, those that fall least short
/// of box, bed and charted obstacles; of these the shortest that keeps the problem's clearance from
/// everything predicted without crossing a bow; if there is none, the one with the least [`Shortfall`]. Where
/// none is about clear at cruising speed, the vehicle hurries or goes as slowly as it can if that helps. `None` if
/// the water lets the vehicle fly no candidate. What falls short of what is predicted by `matters_below` or more
/// is found only where nothing better is.
pub(crate) fn evade(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    lasting: Lasting,
    matters_below: f64,
) -> Option<Evasion> {
    let search = |problem: &PathProblem<'_>, best| {
        let limits = (lasting, matters_below);
        search(problem, velocity, limits, best)
    };
    let mut best = search(problem, None);
    let cruising = problem.vehicle;
    let hurried_mps = HURRY * cruising.max_speed_mps;
    let faster = (hurried_mps > cruising.speed_mps).then_some(hurried_mps);
    let slower = (cruising.min_speed_mps > 0.0).then_some(SLOW * cruising.min_speed_mps);
    let slower = slower.filter(|&mps| mps < cruising.speed_mps);
    for speed_mps in faster.into_iter().chain(slower) {
        if best.as_ref().is_none_or(|best| best.shortfall.is_small()) {
            break;
        }
        let vehicle = Vehicle {
            speed_mps,
            ..*cruising
        };
        let other = PathProblem {
            vehicle: &vehicle,
            ..*problem
        };
        best = search(&other, best);
    }
    best
}

/// The best of the candidates, if it is better than the best so far.
fn search(
    problem: &PathProblem<'_>,
    velocity: Vector3<f64>,
    (lasting, matters_below): (Lasting, f64),
    best: Option<Evasion>,
) -> Option<Evasion> {
    let here = TimedPoint::new(problem.start, problem.departure_s);
    let mut search = Search {
        problem,
        lasting,
        prospect: Prospect::new(problem),
        matters_below,
        best,
    };
    for way in stays(problem, here, velocity, search.whole_s()) {
        if search.consider(way) {
            return search.best;
        }
    }
    // A way to one side that is too bad already is the beginning of the longer ones; not where the box bends them or
    // a current times them otherwise.
    let turns = problem.vehicle.turn_radius_m > 0.0 && velocity.norm() > 0.0;
    let turns = turns && problem.current.is_none();
    let mut hopeless = [false; DIRECTIONS];
    for lead in leads(problem, f64::INFINITY) {
        let side = lead.direction().filter(|_| turns);
        if side.is_some_and(|side| hopeless[side]) {
            continue;
        }
        let Ok(way) = problem.timed(&lead.points(problem, velocity)) else {
            continue;
        };
        // No stay at the end can make up for what is lost on the way there.
        if !search.may_begin_with(&way) {
            if let Some(side) = side {
                hopeless[side] = !search.may_lead_on(&way);
            }
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
    prospect: Prospect<'p>,
    matters_below: f64,
    best: Option<Evasion>,
}

impl Search<'_> {
    /// How long a candidate is to last, seconds. A vehicle that hovers needs no way on.
    fn whole_s(&self) -> f64 {
        let Lasting { for_s, way_on_s } = self.lasting;
        if self.problem.vehicle.can_hover() {
            for_s
        } else {
            for_s + way_on_s
        }
    }

    /// A candidate may be better if it falls short of what is predicted by less. Candidates come in order of
    /// length: a longer one must be strictly better.
    fn improves_below(&self) -> f64 {
        match self.best.as_ref().map(|best| best.shortfall) {
            None => f64::INFINITY,
            Some(best) if best.first_m() > 0.0 => self.matters_below,
            Some(best) => best.predicted.min(self.matters_below),
        }
    }

    /// Whether a candidate that begins with a way may be better.
    fn may_begin_with(&self, way: &Trajectory) -> bool {
        let (whole_s, limit) = (self.whole_s(), self.improves_below());
        self.prospect.may_stay_below(way, whole_s, limit)
    }

    /// Whether a longer way that begins with this one may be better.
    fn may_lead_on(&self, way: &Trajectory) -> bool {
        let limit = self.improves_below() + ROUNDING;
        self.prospect.may_stay_below(way, f64::INFINITY, limit)
    }

    /// Keeps a candidate if it is better; returns whether nothing can be better than the best.
    fn consider(&mut self, whole: Trajectory) -> bool {
        let predicted = self
            .prospect
            .predicted_below(&whole, self.improves_below())
            .filter(|_| check::can_be_steered(self.problem, &whole));
        if let Some(predicted) = predicted {
            let shortfall = Shortfall {
                certain_m: self.prospect.certain_m(&whole),
                predicted,
            };
            let mut best = self.best.iter();
            if best.all(|best| shortfall.is_less_than(best.shortfall)) {
                self.best = Some(Evasion {
                    in_force: self.in_force(whole),
                    shortfall,
                });
            }
        }
        let best = self.best.as_ref();
        best.is_some_and(|best| best.shortfall.is_none())
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

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::Region;
    use auv_planning::Vehicle;
    use auv_planning::motion::{distance_to_regions_m, least_clearance};
    use auv_types::{Point3, Seed, libm, rand::RngExt};

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
            let way = evade(
                &problem,
                Vector3::x() * vehicle.speed_mps,
                LASTING,
                f64::INFINITY,
            );
            let way = way.unwrap().in_force.whole;
            let nearest = least_clearance(&way, &regions, (0.0, 120.0), 1e9);
            assert!(nearest.clearance_m >= 10.0, "{nearest:?}");
        }
    }

    #[test]
    fn what_replaces_a_kept_evasion_is_found_whatever_does_not_matter() {
        let (vehicle, here) = (Vehicle::default(), Point3::new(0.0, 0.0, 30.0));
        let velocity = Vector3::x() * vehicle.speed_mps;
        let (mut replaced, mut stayed) = (0, 0);
        for case in 0..40 {
            let mut random = Seed(23).stream(case);
            let mut draw = |low: f64, high: f64| random.random_range(low..high);
            let mut region = |_| {
                let centre = Point3::new(draw(-250.0, 250.0), draw(-250.0, 250.0), 30.0);
                let mut region = Region::cylinder(centre, draw(20.0, 90.0), 0.0, 100.0);
                region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
                region
            };
            let regions: Vec<Region> = (0..12).map(&mut region).collect();
            let problem = PathProblem {
                regions: &regions,
                clearance_m: 10.0,
                ..PathProblem::new(here, Point3::new(500.0, 0.0, 30.0), &vehicle)
            };
            let ahead = [here, here + velocity * draw(50.0, 200.0)];
            let kept = Prospect::new(&problem).shortfall(&problem.timed(&ahead).unwrap());
            let found = |matters_below| evade(&problem, velocity, LASTING, matters_below).unwrap();
            let (best, limited) = (found(f64::INFINITY), found(kept.matters_below(60.0)));
            if kept.gives_way_to(best.shortfall, 60.0) {
                assert_eq!(limited, best, "case {case}");
                replaced += 1;
            } else {
                assert!(!kept.gives_way_to(limited.shortfall, 60.0), "case {case}");
                stayed += 1;
            }
        }
        assert!(replaced > 5 && stayed > 5, "{replaced} {stayed}");
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
        let way = evade(&problem, Vector3::zeros(), LASTING, f64::INFINITY).unwrap();
        let way = way.in_force.whole;
        assert!(distance_to_regions_m(&way.end(), &regions, 1e9) >= 5.0);
    }

    #[test]
    fn stays_in_its_box_within_a_wide_contact_at_rest() {
        for vehicle in [Vehicle::paper(), Vehicle::default()] {
            let regions = [Region {
                from_s: 0.0,
                ..Region::ball(Point3::new(650.0, 0.0, 50.0), 340.0)
            }];
            let bounds = auv_types::Bounds::new(
                Point3::new(-900.0, -900.0, 0.0),
                Point3::new(900.0, 900.0, 100.0),
            );
            let problem = PathProblem {
                regions: &regions,
                clearance_m: 10.0,
                bounds: Some(bounds),
                ..PathProblem::new(
                    Point3::new(750.0, 0.0, 50.0),
                    Point3::new(0.0, 0.0, 50.0),
                    &vehicle,
                )
            };
            let way = evade(
                &problem,
                Vector3::x() * vehicle.speed_mps,
                LASTING,
                f64::INFINITY,
            );
            let way = way.unwrap().in_force.whole;
            let outside = way
                .points()
                .iter()
                .find(|at| !bounds.contains(&at.position));
            assert_eq!(outside, None);
        }
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
        let way = evade(&problem, Vector3::zeros(), LASTING, f64::INFINITY).unwrap();
        let way = way.in_force.whole;
        let nearest = least_clearance(&way, &regions, (0.0, 120.0), 1e9);
        assert!(nearest.clearance_m >= 0.99, "{nearest:?}");
    }
}
