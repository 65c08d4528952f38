//! Climbing clear of the bed where it was measured shallower than plans allow for.

use crate::check;
use crate::leads::leads;
use crate::path_question::own_problem;
use crate::state::InForce;
use crate::station_keeping::holds;
use crate::view::View;
use crate::way_on::permanent;
use auv_planning::{PathProblem, Trajectory};

/// The first climb to where the vehicle can stay and keeps the whole altitude over the bed as measured: straight
/// on, then on a helix.
///
/// It keeps clear of all that is predicted, or else of what is charted. `None` where no climb does.
pub(crate) fn climb(view: View<'_>) -> Option<InForce> {
    let request = own_problem(view);
    let problem = request.problem();
    let charted = permanent(problem.regions);
    let among_charted = PathProblem {
        regions: &charted,
        ..problem
    };
    climb_among(view, &problem).or_else(|| climb_among(view, &among_charted))
}

fn climb_among(view: View<'_>, problem: &PathProblem<'_>) -> Option<InForce> {
    let velocity = view.beliefs().velocity;
    let fits = |way: &Trajectory| check::leads_on(problem, velocity, way);
    let is_high = |hold: &Trajectory| {
        let mut places = hold.points().iter().map(|point| point.position);
        places.all(|p| p.z <= view.mission.deepest_at(p.x, p.y))
    };
    leads(problem, f64::INFINITY).find_map(|lead| {
        let points = lead.points(problem, velocity);
        if points.last()?.z >= problem.start.z {
            return None;
        }
        let lead = problem.timed(&points).ok().filter(fits)?;
        let mut stays = holds(problem, lead.end(), lead.end_velocity(), view.way_on_s());
        let whole = stays.find_map(|hold| {
            let whole = lead.clone().then(&hold).ok();
            whole.filter(|whole| is_high(&hold) && fits(whole))
        })?;
        Some(InForce {
            ends_s: lead.end().time_s,
            whole,
        })
    })
}

#[cfg(test)]
mod tests {
    use crate::driver::Stepped;
    use crate::fixture::Fixture;
    use crate::{AbortReason, Event, Mission, Observation, Outcome, SyncSettings, Synchroniser};
    use auv_planning::baseline::GreedyRoute;
    use auv_planning::{PathPlanner, PathProblem, PlanError, Planned, Run, Stats, Trajectory};
    use auv_types::{Point3, Seed, Vector3};
    use std::sync::Arc;

    /// Level as high as start and target, and straight down to the target.
    struct LevelPath;

    impl PathPlanner for LevelPath {
        fn name(&self) -> &str {
            "level"
        }

        fn plan_path(
            &self,
            _: &mut Run<'_>,
            problem: &PathProblem<'_>,
        ) -> Result<Planned<Trajectory>, PlanError> {
            let (start, target) = (problem.start, problem.target);
            let top_m = start.z.min(target.z);
            let above = |p: Point3<f64>| Point3::new(p.x, p.y, top_m);
            let path = problem.timed(&[start, above(start), above(target), target]);
            let path = path.unwrap();
            let takes_s = path.duration_s();
            Ok(Planned::new(path, takes_s, 0.0, Stats::default()))
        }
    }

    /// Waypoints at 20 m over a bed charted at 32 m; plans keep 10 m and 1 m for the chart's errors.
    fn mission() -> Mission {
        let mut mission = Fixture::new().mission;
        mission.budget_s = 6_000.0;
        mission.sea_bed = Some(Arc::new(auv_ocean::AnalyticBed::new(32.0)));
        mission.min_altitude_m = 10.0;
        mission.altitude_sigmas = 0.5;
        mission
    }

    /// Flies on track over a true bed; returns the least altitude, and the synchroniser at the end.
    fn flown(mission: Mission, bed_m: impl Fn(f64) -> f64, wrong: u32) -> (f64, Synchroniser) {
        let settings = SyncSettings::default();
        let mut synchroniser = Synchroniser::new(Arc::new(mission), settings, Seed(0)).unwrap();
        let driver = Stepped::new(&GreedyRoute, &LevelPath);
        let mut least_m = f64::INFINITY;
        for k in 0..6_000_u32 {
            let time_s = f64::from(k);
            let start = (Point3::new(0.0, 0.0, 20.0), Vector3::zeros());
            let (position, velocity) = synchroniser.trajectory().map_or(start, |t| t.at(time_s));
            let altitude_m = bed_m(position.x) - position.z;
            least_m = least_m.min(altitude_m);
            let told_m = if wrong > 0 && k % wrong == wrong - 1 {
                6.0
            } else {
                altitude_m
            };
            if k % 10 != 9 {
                driver.tell(
                    &mut synchroniser,
                    Event::AltitudeMeasured { altitude_m: told_m },
                );
            }
            let observation = Observation {
                position_sigma_m: 0.0,
                time_s,
                position,
                velocity,
                regions: [].into(),
            };
            driver.tick(&mut synchroniser, observation);
            if synchroniser.outcome().is_some() {
                break;
            }
        }
        (least_m, synchroniser)
    }

    #[test]
    fn a_bed_shallower_than_charted_is_climbed_clear_of() {
        // From 300 m north the bed rises to 28 m: 8 m below waypoints at 20 m.
        let slope = |x: f64| 32.0 - 4.0 * ((x - 300.0) / 60.0).clamp(0.0, 1.0);
        let (least_m, end) = flown(mission(), slope, 0);
        let said = (end.climbs(), end.raised());
        assert_eq!(end.outcome(), Some(Outcome::Docked), "{said:?}");
        assert!((1..12).contains(&end.climbs()), "{said:?}");
        // 2 m are missing; plans keep 3 m to spare over what was measured.
        let raised = |by_m: &f64| (2.0..5.5).contains(by_m);
        assert!(
            end.raised().len() == 2 && end.raised().iter().all(|(_, m)| raised(m)),
            "{said:?}"
        );
        assert!(!end.shoals().is_empty());
        assert!(least_m >= 10.0, "{least_m} m");
    }

    #[test]
    fn single_wrong_echoes_change_nothing() {
        let (_, with) = flown(mission(), |_| 32.0, 7);
        let (_, without) = flown(mission(), |_| 32.0, 0);
        assert_eq!(with.outcome(), Some(Outcome::Docked));
        assert_eq!((with.climbs(), with.shoals().len()), (0, 0));
        assert_eq!(with.trajectory(), without.trajectory());
    }

    #[test]
    fn a_destination_without_room_over_the_bed_as_measured_ends_the_mission_by_that_name() {
        let slope = |x: f64| 32.0 - 16.0 * ((x - 1_300.0) / 400.0).clamp(0.0, 1.0);
        let (least_m, end) = flown(mission(), slope, 0);
        let outcome = end.outcome();
        assert_eq!(outcome, Some(Outcome::Aborted(AbortReason::TooLow)));
        assert!(least_m >= 10.0, "{least_m} m");
    }
}
