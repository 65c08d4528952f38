//! Plans prepared before a waypoint is reached, for the questions expected there.

use crate::beliefs::Altimeter;
use crate::mode::Awaited;
use crate::{Command, Event, Observation, PathRequest, RouteRequest, Synchroniser, check};
use auv_graph::Route;
use auv_planning::motion::least_clearance;
use auv_planning::{Planned, Trajectory};
use std::sync::Arc;

/// How much later than expected the vehicle arrives in the late case, seconds.
const LATE_S: f64 = 20.0;

/// Answers to the questions expected at the next waypoint, prepared while the vehicle is on its way there.
///
/// A driver of your own prepares whenever it has time, on a copy of the synchroniser, and asks what it prepared first
/// when the waypoint is reached ([`Synchroniser::visited`] is longer by one): then the vehicle need not wait.
///
/// ```
/// use auv_mission::driver::{Prepared, Stepped};
/// use auv_mission::{Command, Event, Synchroniser};
///
/// fn prepare(synchroniser: &Synchroniser, planners: &Stepped<'_>) -> Option<Prepared> {
///     let arrival = Prepared::arrival(synchroniser, 60.0)?;
///     Some(Prepared::new(synchroniser.clone(), arrival, &|question| planners.answer(question)))
/// }
///
/// fn answer(question: &Command, prepared: &mut Prepared, planners: &Stepped<'_>) -> Option<Event> {
///     prepared.answer(question).or_else(|| planners.answer(question))
/// }
/// ```
#[derive(Clone, Debug, Default)]
pub struct Prepared {
    route: Option<Planned<Route>>,
    /// For an arrival later than expected, or for longer arc times than forecast.
    late_route: Option<Planned<Route>>,
    path: Option<Planned<Trajectory>>,
}

impl Prepared {
    /// The vehicle at the end of the trajectory in force, if the next waypoint is reached there at most
    /// `within_s` from now.
    #[must_use]
    pub fn arrival(synchroniser: &Synchroniser, within_s: f64) -> Option<Observation> {
        let view = synchroniser.view();
        let leg = view.leg()?;
        let in_force = view.state.in_force.as_ref()?.purpose();
        let end = in_force.end();
        // A stand-off is not a waypoint: what is asked there is a path to the target.
        let under_way = leg.awaited == Awaited::Nothing && leg.mode.leads_to_target();
        (under_way && end.time_s - view.now_s() <= within_s).then(|| Observation {
            position_sigma_m: view.beliefs().sigma_m,
            time_s: end.time_s,
            position: end.position,
            velocity: in_force.end_velocity(),
            regions: Arc::clone(&view.beliefs().regions),
        })
    }

    /// Lets a copy of the synchroniser arrive as expected ([`Prepared::arrival`]) and has the questions that it asks there
    /// answered. The route is also asked for a late arrival.
    #[must_use]
    pub fn new(
        mut ahead: Synchroniser,
        arrival: Observation,
        answer: &dyn Fn(&Command) -> Option<Event>,
    ) -> Self {
        let mut prepared = Self::default();
        // The altitude will be measured on the way there.
        if ahead.view().beliefs().altimeter != Altimeter::Silent {
            let altitude_m = f64::MAX;
            ahead.step(Event::AltitudeMeasured { altitude_m });
        }
        let mut late = ahead.clone();
        let late_arrival = Observation {
            time_s: arrival.time_s + LATE_S,
            ..arrival.clone()
        };
        let mut commands = ahead.step(Event::Tick(arrival));
        // A route, a path, and the path's second attempt.
        for _ in 0..3 {
            // Predictions change a little until then: ask for more clearance.
            for command in &mut commands {
                if let Command::PlanPath(request) = command {
                    request.clearance_m += ahead.view().settings.margins.hysteresis_m;
                }
            }
            let Some(event) = commands.iter().filter_map(answer).last() else {
                break;
            };
            match &event {
                Event::RoutePlanned { result, .. } => {
                    prepared.route = result.as_ref().ok().cloned()
                }
                Event::PathPlanned { result, .. } => prepared.path = result.as_ref().ok().cloned(),
                _ => {}
            }
            commands = ahead.step(event);
        }
        let answers = late.step(Event::Tick(late_arrival)).into_iter();
        let mut answers = answers.filter_map(|command| match command {
            Command::PlanRoute(_) => answer(&command),
            _ => None,
        });
        if let Some(Event::RoutePlanned { result, .. }) = answers.next() {
            prepared.late_route = result.ok();
        }
        prepared
    }

    /// Whether the path still starts at the arrival and keeps the clearance that a new path has to keep from the
    /// regions predicted now. If not, prepare again.
    #[must_use]
    pub fn still_holds(&self, synchroniser: &Synchroniser, arrival: &Observation) -> bool {
        let clearance_m = synchroniser.view().wanted_clearance_m();
        self.path.as_ref().is_some_and(|planned| {
            let (path, start) = (&planned.best, planned.best.start());
            let (from_s, until_s) = (start.time_s, path.end().time_s);
            let same = start.position == arrival.position && (from_s - arrival.time_s).abs() < 1.0;
            let regions = &arrival.regions;
            same && least_clearance(path, regions, (from_s, until_s), clearance_m).clearance_m
                >= clearance_m
        })
    }

    /// The prepared answer to a question, if there is one and it is valid for it. It is given once.
    pub fn answer(&mut self, question: &Command) -> Option<Event> {
        match question {
            Command::PlanRoute(request) => Some(Event::RoutePlanned {
                request: request.id,
                result: Ok(self.take_route(request)?),
                compute_s: 0.0,
            }),
            Command::PlanPath(request) => Some(Event::PathPlanned {
                request: request.id,
                result: Ok(self.take_path(request)?),
                compute_s: 0.0,
            }),
            Command::Follow(_) | Command::Finished(_) => None,
        }
    }

    /// The prepared route if it is valid for the request, else the one for a late arrival if that is.
    fn take_route(&mut self, request: &RouteRequest) -> Option<Planned<Route>> {
        [self.route.take(), self.late_route.take()]
            .into_iter()
            .flatten()
            .find(|planned| check::route_is_valid(&request.problem(), planned))
    }

    /// The prepared path, moved to the place and time of the real departure, if it is valid for the
    /// request.
    fn take_path(&mut self, request: &PathRequest) -> Option<Planned<Trajectory>> {
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
