//! A path planner that flies straight.

use crate::motion::{ALWAYS, least_clearance};
use crate::polyline::turn_radius_m;
use crate::{PathPlanner, PathProblem, PlanError, Planned, Run, Score, StopReason, Trajectory};
use auv_obstacles::ObstacleId;
use auv_types::libm;

/// Flies straight to the target through whatever is in the way, and names what blocks.
#[derive(Clone, Copy, Debug, Default)]
pub struct StraightPath;

impl PathPlanner for StraightPath {
    fn name(&self) -> &str {
        "straight"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        problem.validate().into_result()?;
        run.grant(1);
        let line = [problem.start, problem.target];
        let (trajectory, not_made_good_m) = match problem.timed(&line) {
            Ok(trajectory) => (trajectory, 0.0),
            // The current is too strong: the plan for still water, its whole length in violation.
            Err(_) => {
                let points = PathProblem {
                    current: None,
                    ..*problem
                }
                .timed(&line);
                let trajectory = points.map_err(|error| PlanError::Failed {
                    planner: self.name().into(),
                    reason: error.to_string(),
                })?;
                let length_m = trajectory.length_m();
                (trajectory, length_m)
            }
        };
        let (penetration_m, blocked_by) = deepest_penetration(problem, &trajectory);
        let violation = penetration_m + not_made_good_m + excess(problem, &trajectory);
        let cost = trajectory.duration_s();
        run.end_generation(Score::new(violation, cost), &[], &[]);
        let mut planned =
            Planned::new(trajectory, cost, violation, run.stats(StopReason::Finished));
        planned.blocked_by = blocked_by;
        Ok(planned)
    }
}

/// How far a trajectory falls short of the clearance, and the region where it does most.
fn deepest_penetration(
    problem: &PathProblem<'_>,
    trajectory: &Trajectory,
) -> (f64, Option<ObstacleId>) {
    let nearest = least_clearance(trajectory, problem.regions, ALWAYS, problem.clearance_m);
    let blocked_by = nearest.region.map(|i| problem.regions[i].obstacle);
    (problem.clearance_m - nearest.clearance_m, blocked_by)
}

/// The sum of the excesses of a straight path over box and depth (metres), pitch (radians) and turn
/// radius at its start (metres).
fn excess(problem: &PathProblem<'_>, trajectory: &Trajectory) -> f64 {
    let (start, way) = (problem.start, problem.target - problem.start);
    let length_m = way.norm();
    let out_m = problem.bounds.map_or(0.0, |bounds| {
        bounds
            .excess_m(&start)
            .max(bounds.excess_m(&problem.target))
    });
    let pitch_rad = libm::atan2(way.z.abs(), libm::hypot(way.x, way.y));
    let turn_short_m = match (problem.start_velocity, trajectory.points().get(1)) {
        (Some(velocity), Some(next)) if velocity.norm() > 0.0 => {
            let behind = start - velocity.normalize() * length_m;
            problem.vehicle.turn_radius_m - turn_radius_m(&behind, &start, &next.position)
        }
        _ => 0.0,
    };
    out_m
        + (pitch_rad - problem.vehicle.max_pitch_rad).max(0.0)
        + turn_short_m.max(0.0)
        + too_deep_m(problem, trajectory)
}

/// How far a trajectory dips below the deepest allowed, metres.
fn too_deep_m(problem: &PathProblem<'_>, trajectory: &Trajectory) -> f64 {
    let Some(floor) = problem.floor() else {
        return 0.0;
    };
    let start = trajectory.start();
    let segments = trajectory.segments().chain([(&start, &start)]);
    let dips = segments.map(|(from, to)| floor.grounding_m(&from.position, &to.position));
    dips.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Vehicle};
    use auv_obstacles::Region;
    use auv_types::{Point3, Seed};

    #[test]
    fn straight_path_names_what_blocks_it() {
        let vehicle = Vehicle::paper();
        let mut region = Region::ball(Point3::new(50.0, 0.0, 0.0), 10.0);
        region.obstacle = ObstacleId(7);
        let regions = [region];
        let problem = PathProblem {
            regions: &regions,
            ..PathProblem::new(Point3::origin(), Point3::new(100.0, 0.0, 0.0), &vehicle)
        };
        let plan = StraightPath
            .plan_path(&mut Run::new(Seed(0), Budget::evaluations(1)), &problem)
            .unwrap();
        assert_eq!(
            (plan.violation, plan.blocked_by),
            (10.0, Some(ObstacleId(7)))
        );
        assert!(plan.feasible().is_err());
    }
}
