//! What a planner does with routes in time: it plans them, or says that it does not know them.

use super::any_planner::{is_deterministic, keeps_the_budget};
use super::checks::{CheckResult, ensure};
use super::drawn_network::drawn_network;
use crate::verify_route_in_time;
use auv_graph::{ArcId, NodeId, Profiles, Task, TaskName, TaskPlace, TimeModel, TimedTask};
use auv_planning::{Budget, PlanError, RoutePlanner, RouteProblem, Run};
use auv_types::Seed;

/// Windows, order, one mandatory task and travel times by departure on a drawn network.
fn model(problem: &RouteProblem<'_>) -> Result<TimeModel, String> {
    let network = problem.network;
    let available_s = problem.time_available_s;
    let nodes = network.num_nodes() as u32;
    let task = |node: u32| TimedTask {
        name: TaskName::Text(format!("task {node}")),
        place: TaskPlace::Node(NodeId(node)),
        task: Task {
            priority: f64::from(1 + node % 5),
            risk: 1.0,
            completion_time_s: 30.0,
        },
        windows: vec![[f64::from(node % 3) * 0.2 * available_s, 0.9 * available_s]],
        mandatory: node == nodes - 1,
        after: if node == 1 { vec![0] } else { Vec::new() },
        chain: None,
    };
    let times_s = vec![0.0, 0.5 * available_s];
    let travel = network.arcs().iter().enumerate().map(|(i, arc)| {
        let least_s = arc.distance_m / network.speed_mps();
        (ArcId(i as u32), vec![least_s, 1.2 * least_s])
    });
    let profiles = Profiles::new(times_s, travel.collect(), |arc| arc.0.to_string());
    Ok(TimeModel {
        tasks: (0..nodes).map(task).collect(),
        profiles: profiles.map_err(|error| error.to_string())?,
        ..TimeModel::default()
    })
}

/// Plans are what they claim, deterministic and within the budget; or the problem is declined by
/// [`PlanError::NotInTime`].
pub(super) fn in_time_or_declined(planner: &dyn RoutePlanner) -> CheckResult {
    for seed in 0..4 {
        let drawn = drawn_network(400 + seed, 12, 0.8, seed % 2 == 0)?;
        let model = model(&drawn.problem())?;
        let problem = RouteProblem {
            time_model: Some(&model),
            ..drawn.problem()
        };
        let mut run = Run::new(Seed(seed), Budget::evaluations(300));
        let planned = match planner.plan_route(&mut run, &problem) {
            Err(PlanError::NotInTime) => return Ok(()),
            Err(error) => {
                return Err(format!(
                    "gives an error for a sound problem in time: {error}"
                ));
            }
            Ok(planned) => planned,
        };
        let Some(schedule) = &planned.schedule else {
            return Err("gives a route in time without its schedule".into());
        };
        let (report, broken) = verify_route_in_time(&problem, &planned.best, schedule);
        ensure((planned.violation == 0.0) == broken.is_empty(), || {
            format!(
                "claims violation {}, but breaks {broken:?}",
                planned.violation
            )
        })?;
        ensure(
            (planned.cost + report.weight).abs() <= 1e-9 * (1.0 + report.weight),
            || {
                format!(
                    "claims cost {} for a route of weight {}",
                    planned.cost, report.weight
                )
            },
        )?;
        let plan = |run: &mut Run<'_>| planner.plan_route(run, &problem);
        is_deterministic(&plan)?;
        keeps_the_budget(&plan)?;
    }
    Ok(())
}
