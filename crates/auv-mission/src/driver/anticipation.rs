//! Ready at the waypoint: what will be asked there is asked before.

use super::planners::{Asked, Planners};
use crate::{Event, Observation, PathRequest, RouteRequest, Synchroniser, check};
use auv_graph::Route;
use auv_planning::{PathPlanner, Planned, RoutePlanner, Trajectory};
use std::sync::atomic::AtomicBool;

/// Answers to the questions expected at the next waypoint.
#[derive(Debug, Default)]
pub(super) struct Candidates {
    route: Option<Planned<Route>>,
    path: Option<Planned<Trajectory>>,
}

/// The vehicle at the end of the trajectory in force, if the next waypoint is reached there at most
/// `within_s` from now.
pub(super) fn arrival(synchroniser: &Synchroniser, within_s: f64) -> Option<Observation> {
    let state = &synchroniser.state;
    let leg = state.leg.as_ref()?;
    let in_force = state.in_force.as_ref()?;
    let end = in_force.end();
    // A stand-off is no waypoint: what is asked there is a path on.
    let under_way = leg.pending.is_none() && leg.stays_from_s.is_some() && !leg.approaching;
    (under_way && end.time_s - state.now_s <= within_s).then(|| Observation {
        time_s: end.time_s,
        position: end.position,
        velocity: in_force.end_velocity(),
        regions: state.regions.as_slice().into(),
    })
}

/// Lets a copy of the synchroniser arrive as expected and answers what it asks there.
pub(super) fn prepare<R: RoutePlanner, P: PathPlanner>(
    mut ahead: Synchroniser,
    arrival: Observation,
    planners: &Planners<R, P>,
    cancel: &AtomicBool,
) -> Candidates {
    let mut candidates = Candidates::default();
    let mut commands = ahead.step(Event::Tick(arrival));
    // A route, a path, and the path's second attempt.
    let asked = Asked::Planner(ahead.settings.acceptance);
    for _ in 0..3 {
        let answers = commands
            .iter()
            .filter_map(|command| planners.answer(command, asked, cancel, &|| 0.0));
        let Some(answer) = answers.last() else { break };
        match &answer {
            Event::RoutePlanned { result, .. } => candidates.route = result.as_ref().ok().cloned(),
            Event::PathPlanned { result, .. } => candidates.path = result.as_ref().ok().cloned(),
            _ => {}
        }
        commands = ahead.step(answer);
    }
    candidates
}

impl Candidates {
    /// The prepared route, if it answers the real question.
    pub(super) fn take_route(&mut self, request: &RouteRequest) -> Option<Planned<Route>> {
        let planned = self.route.take()?;
        check::route_is_valid(&request.problem(), &planned.best).then_some(planned)
    }

    /// The prepared path from where and when the vehicle really departs, if it answers the real
    /// question so.
    pub(super) fn take_path(&mut self, request: &PathRequest) -> Option<Planned<Trajectory>> {
        let mut planned = self.path.take()?;
        let problem = request.problem();
        let start = planned.best.start();
        let as_expected =
            start.position == request.start && start.time_s.total_cmp(&request.departure_s).is_eq();
        if !as_expected {
            let rest = planned.best.points().iter().skip(1).map(|p| p.position);
            let points: Vec<_> = std::iter::once(request.start).chain(rest).collect();
            planned.best = problem.timed(&points).ok()?;
            planned.cost = planned.best.duration_s();
        }
        let good = planned.violation <= 0.0 && check::path_is_valid(&problem, &planned.best);
        good.then_some(planned)
    }
}
