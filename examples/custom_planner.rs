//! Your own planners, flown by the same synchroniser: `cargo run --release --example custom_planner`.
//!
//! Key points:
//! - a route planner implements one method and gives back a route; the synchroniser checks it;
//! - a path planner implements one method and gives back a timed polyline; the synchroniser checks it
//!   against every predicted region before it is flown, and moves clear when it is wrong;
//! - both get their budget through `Run` and draw random numbers from its seed only.

use auv_examples::{Arguments, CommandLine, Failure, Opt, print, print_json};
use auv_graph::{NodeId, Route};
use auv_mission::driver::Stepped;
use auv_planning::motion::{ALWAYS, least_clearance};
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, StopReason,
    Trajectory,
};
use auv_sim::{Campaign, Log, simulate};
use auv_types::{Point3, Vector3};

const COMMAND: CommandLine = CommandLine {
    name: "custom_planner",
    about: "Flies one mission with a route planner and a path planner written in this example.",
    operands: &[],
    options: &[Opt::value(
        "mission",
        "K",
        "0",
        "number of the campaign mission to fly",
    )],
    notes: "Example: custom_planner --mission 3 --json",
};

/// Always takes the nearest waypoint from which the destination can still be reached in time.
struct NearestFirst;

impl RoutePlanner for NearestFirst {
    fn name(&self) -> &str {
        "nearest first"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        let quickest = problem.prepare()?;
        run.grant(1);
        let (mut score, mut best) = (quickest.score, quickest.route);
        let nearest = nearest_first(problem);
        for route in nearest.iter().chain(problem.incumbent) {
            if let Ok(totals) = problem.check(route)
                && problem.score(&totals) < score
            {
                (score, best) = (problem.score(&totals), route.clone());
            }
        }
        Ok(Planned::new(
            best,
            score.cost,
            score.violation,
            run.stats(StopReason::Finished),
        ))
    }
}

fn nearest_first(problem: &RouteProblem<'_>) -> Option<Route> {
    let network = problem.network;
    let (mut nodes, mut time_s) = (vec![problem.start], 0.0);
    loop {
        let at = *nodes.last()?;
        let time_to = |from: NodeId, to: NodeId| {
            let arc = network.arc_between(from, to)?;
            (!problem.removed.contains(network.arcs()[arc.index()].edge))
                .then(|| network.arc_time_s(arc, problem.times))
        };
        let home_s = time_to(at, problem.destination);
        let next = (0..network.num_nodes() as u32)
            .map(NodeId)
            .filter(|node| !nodes.contains(node) && *node != problem.destination)
            .filter_map(|node| {
                Some((
                    time_to(at, node)?,
                    time_to(node, problem.destination)?,
                    node,
                ))
            })
            .filter(|(there_s, back_s, _)| time_s + there_s + back_s <= problem.time_available_s)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        match next {
            Some((there_s, _, node)) => {
                time_s += there_s;
                nodes.push(node);
            }
            None => {
                home_s?;
                nodes.push(problem.destination);
                return Some(Route::new(nodes));
            }
        }
    }
}

/// A straight path, or one over a single via point: the first candidate that is clear.
struct DogLeg;

impl PathPlanner for DogLeg {
    fn name(&self) -> &str {
        "dog-leg"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        problem.validate().into_result()?;
        let way = problem.target - problem.start;
        let across = way
            .cross(&Vector3::z())
            .try_normalize(1e-9)
            .unwrap_or_else(Vector3::x);
        let mut best: Option<(f64, Trajectory)> = None;
        for step in 0..400_i32 {
            if run.grant(1) == 0 {
                break;
            }
            // Via points ever farther from the straight line, alternately on both sides.
            let side = if step % 2 == 0 { 1.0 } else { -1.0 };
            let along = [0.5, 0.3, 0.7, 0.15, 0.85][(step / 2 % 5) as usize];
            let knee: Point3<f64> =
                problem.start + way * along + across * (side * 25.0 * f64::from(step / 10));
            let failed = |error: &dyn std::fmt::Display| PlanError::Failed {
                planner: self.name().into(),
                reason: error.to_string(),
            };
            let trajectory = problem
                .timed(&[problem.start, knee, problem.target])
                .map_err(|error| failed(&error))?;
            let too_near_m = too_near_m(problem, &trajectory);
            if best
                .as_ref()
                .is_none_or(|(least_m, _)| too_near_m < *least_m)
            {
                best = Some((too_near_m, trajectory));
            }
            if too_near_m <= 0.0 {
                break;
            }
        }
        let (violation, trajectory) =
            best.unwrap_or((f64::MAX, Trajectory::hover(start_of(problem), 0.0)));
        let cost = trajectory.duration_s();
        Ok(Planned::new(
            trajectory,
            cost,
            violation,
            run.stats(StopReason::Finished),
        ))
    }
}

fn start_of(problem: &PathProblem<'_>) -> auv_obstacles::TimedPoint {
    auv_obstacles::TimedPoint::new(problem.start, problem.departure_s)
}

/// The shortfall of a trajectory's clearance, metres.
fn too_near_m(problem: &PathProblem<'_>, trajectory: &Trajectory) -> f64 {
    let nearest = least_clearance(trajectory, problem.regions, ALWAYS, problem.clearance_m);
    problem.clearance_m - nearest.clearance_m
}

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let k = arguments.number("mission")?.unwrap_or(0);
    let internal = |error: &dyn std::fmt::Display| Failure::Internal(error.to_string());
    let campaign = Campaign::table2(arguments.seed()?).map_err(|error| internal(&error))?;
    let scenario = campaign.scenario(k).map_err(|error| internal(&error))?;
    let driver = Stepped::new(&NearestFirst, &DogLeg);
    let mut log = Log::hash_only();
    let summary = simulate(&scenario, &driver, &mut log).map_err(|error| internal(&error))?;
    if arguments.json() {
        return print_json(&summary.to_json(&log.sha256()));
    }
    print(&format!("{summary}\n"))
}
