//! The check of a mission before its launch.

mod answer;
mod launch_times;
mod possible;

pub use answer::{LaunchCheck, LeftOut, StopCheck, TaskCheck, WhyLeftOut};

use super::document::MissionFile;
use super::works::Work;
use super::{DataReport, MissionData, MissionFileError};
use crate::Scenario;
use auv_graph::NodeId;
use auv_mission::driver::Stepped;
use auv_mission::{Event, Observation, Outlook, Stop, Synchroniser};
use auv_types::{Seed, Vector3, Violations};
use possible::{Possible, Prospects};
use std::sync::Arc;

impl MissionFile {
    /// Whether the mission can be launched, and what it is expected to do: the route that the driver's route
    /// planner answers at the launch, timed in the sea as forecast. Nothing is flown.
    ///
    /// # Determinism
    /// Equal file, data, seed and planner give an equal answer.
    ///
    /// # Errors
    /// What is wrong with the file or the data beside it. A mission that is understood and cannot be flown is an
    /// answer.
    pub fn launch_check(
        &self,
        data: &MissionData<'_>,
        seed: Seed,
        driver: &Stepped<'_>,
        report: &mut DataReport,
    ) -> Result<LaunchCheck, MissionFileError> {
        match self.draft(data, seed, report) {
            Ok((scenario, problems)) => Ok(self.checked(&scenario, &problems, driver)),
            Err(MissionFileError::NoGo(problems)) => Ok(self.refused(&problems)),
            Err(error) => Err(error),
        }
    }

    /// The answer where not even the network can be built.
    fn refused(&self, problems: &Violations) -> LaunchCheck {
        let refused = self.work_places().into_iter().map(|work| TaskCheck {
            name: work.name,
            at: work.at,
            possible: false,
            reason: Some("nothing is planned before the problems are mended".into()),
        });
        LaunchCheck {
            tasks: refused.collect(),
            ..LaunchCheck::no_go(problems)
        }
    }

    fn checked(
        &self,
        scenario: &Scenario,
        problems: &Violations,
        driver: &Stepped<'_>,
    ) -> LaunchCheck {
        let mut check = LaunchCheck::no_go(problems);
        check.warnings.clone_from(&scenario.warnings);
        let mission = &scenario.mission;
        let planned = problems
            .is_empty()
            .then(|| plan(scenario, driver))
            .flatten();
        let route = planned.as_deref().unwrap_or_default();
        let outlook = Outlook::new(mission);
        let prospects = Prospects::new(mission, &outlook);
        let stops = outlook.stops(route, mission.launch_s).unwrap_or_default();
        let works = self.works(mission);
        for work in &works {
            let is_planned = done_at(work, route, scenario).is_some();
            let possible = match is_planned {
                true => Possible::Yes,
                false => prospects.of(work),
            };
            check.add(work, &possible, is_planned, &scenario.warnings);
        }
        check.route = timed(&works, route, &stops, scenario);
        launch_times::fill_in(&mut check, scenario, &outlook, &stops);
        check
    }
}

/// The route that the synchroniser adopts at the launch, in water without obstacles.
fn plan(scenario: &Scenario, driver: &Stepped<'_>) -> Option<Vec<NodeId>> {
    let mission = Arc::clone(&scenario.mission);
    let position = mission.position_of(mission.start);
    let launch = Observation {
        time_s: mission.launch_s,
        position,
        velocity: Vector3::zeros(),
        regions: [].into(),
        position_sigma_m: 0.0,
    };
    let settings = scenario.settings.clone();
    let mut synchroniser = Synchroniser::new(mission, settings, scenario.seed.split(0)).ok()?;
    let commands = synchroniser.step(Event::Tick(launch));
    let answer = commands.iter().find_map(|command| driver.answer(command))?;
    synchroniser.step(answer);
    Some(synchroniser.route().to_vec())
}

/// The place in a route where work is done: the index of the waypoint at which it ends.
fn done_at(work: &Work, route: &[NodeId], scenario: &Scenario) -> Option<usize> {
    let network = &scenario.mission.network;
    let mut legs = route.windows(2);
    let does = |leg: &[NodeId]| {
        let arc = network.arc_between(leg[0], leg[1]);
        arc.is_some_and(|arc| work.arcs.contains(&arc))
    };
    legs.position(does).map(|i| i + 1)
}

/// The route with its times and its work.
fn timed(works: &[Work], route: &[NodeId], stops: &[Stop], scenario: &Scenario) -> Vec<StopCheck> {
    let mut check: Vec<StopCheck> = stops
        .iter()
        .map(|stop| StopCheck {
            place: scenario.mission.name_of(stop.node),
            arrive_s: stop.arrive_s,
            leave_s: stop.leave_s,
            tasks: Vec::new(),
        })
        .collect();
    for work in works {
        let stop = done_at(work, route, scenario).and_then(|i| check.get_mut(i));
        if let Some(stop) = stop {
            stop.tasks.push(work.name.clone());
        }
    }
    check
}
