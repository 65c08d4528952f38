//! The check of a mission before its launch.

mod answer;
mod energy;
mod expected;
mod launch_times;
mod possible;
mod rehearsal;
mod whole_survey;

pub use answer::{LaunchCheck, LeftOut, StopCheck, TaskCheck, WhyLeftOut};

use super::build::Draft;
use super::document::MissionFile;
use super::no_room::NoRoom;
use super::works::Work;
use super::{DataReport, MissionData, MissionFileError};
use crate::Scenario;
use auv_graph::NodeId;
use auv_mission::driver::Stepped;
use auv_mission::{Event, Mission, Observation, Outlook, Stop, Synchroniser};
use auv_types::{Seed, Vector3, Violations};
use expected::Expected;
use possible::{Possible, Prospects};
use rehearsal::{Rehearsal, rehearse};
use std::collections::BTreeMap;
use std::sync::Arc;

impl MissionFile {
    /// Whether the mission can be launched, and what it is expected to do: what the synchroniser flies in the sea as
    /// forecast and charted, without obstacles, with the planners of the driver. It goes where the route at the launch
    /// holds every mandatory task and that flight is home in time.
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
            Ok(draft) => Ok(self.checked(&draft, driver, Asked::Everything)),
            Err(MissionFileError::NoGo(problems)) => Ok(self.refused(&problems)),
            Err(error) => Err(error),
        }
    }

    /// What keeps the mission from being launched, each with its remedy: those of [`MissionFile::launch_check`] that
    /// are found without flying it.
    ///
    /// # Errors
    /// As [`MissionFile::launch_check`].
    pub fn launch_problems(
        &self,
        data: &MissionData<'_>,
        seed: Seed,
        driver: &Stepped<'_>,
        report: &mut DataReport,
    ) -> Result<Vec<String>, MissionFileError> {
        let check = match self.draft(data, seed, report) {
            Ok(draft) => self.checked(&draft, driver, Asked::Problems),
            Err(MissionFileError::NoGo(problems)) => self.refused(&problems),
            Err(error) => return Err(error),
        };
        Ok(check.problems)
    }

    /// The answer where not even the network can be built.
    fn refused(&self, problems: &Violations) -> LaunchCheck {
        let survey = |task: &str| Some(self.surveys[self.line_of(task)?.survey].name().to_owned());
        let refused = self.work_places().into_iter().map(|work| TaskCheck {
            survey: survey(&work.name),
            name: work.name,
            at: work.at,
            possible: false,
            reason: Some(answer::NOTHING_PLANNED.into()),
        });
        LaunchCheck {
            tasks: refused.collect(),
            ..LaunchCheck::no_go(problems)
        }
    }

    fn checked(&self, draft: &Draft, driver: &Stepped<'_>, asked: Asked) -> LaunchCheck {
        let Draft {
            scenario,
            problems,
            no_room,
        } = draft;
        let mut check = LaunchCheck::no_go(problems);
        check.warnings.clone_from(&scenario.warnings);
        let mission = &scenario.mission;
        let planned = problems.is_empty().then(|| Plan::of(scenario, driver));
        let plan = planned.flatten().unwrap_or_default();
        let outlook = Outlook::new(mission);
        let prospects = Prospects::new(mission, &outlook);
        let stops = outlook.stops(&plan.route, mission.launch_s, &plan.due);
        let route = Expected::route(mission, stops.unwrap_or_default());
        let works = self.works(mission);
        let is_planned = route.done(&works);
        let goes = check.go && self.first_duty_left(&works, &is_planned).is_none();
        let (expected, fails) = match asked {
            Asked::Everything if goes && !route.stops.is_empty() => {
                rehearsed(scenario, driver, route)
            }
            Asked::Everything | Asked::Problems => (route, None),
        };
        let (is_done, slack_s) = (expected.done(&works), slack_s(mission, &expected.stops));
        let mut surveys = BTreeMap::new();
        for (work, &is_done) in works.iter().zip(&is_done) {
            let possible = match is_done {
                true => Possible::Yes { takes_s: 0.0 },
                false => self.possible(work, &prospects, &mut surveys),
            };
            let keeps_out = |known: &&NoRoom| self.concerns(known, work, mission);
            let shortage = no_room.iter().find(keeps_out);
            let survey = self
                .whole_survey(&work.name)
                .map(|(_, survey)| survey.name());
            check.add((work, survey), &possible, (is_done, slack_s), shortage);
        }
        if check.go {
            self.require_mandatory(&mut check, &works, &is_planned);
        }
        self.explain_order(&mut check, &works, &is_done);
        check.route = expected.told(&works, mission);
        let goes_later = |delay_s: f64| self.goes_later(scenario, driver, &works, delay_s);
        let stops = &expected.stops;
        launch_times::fill_in(&mut check, (mission, problems), (&outlook, stops));
        if let Some(how) = fails {
            check.go = false;
            check.problems.push(how);
        }
        if asked == Asked::Everything {
            launch_times::fill_in_latest(&mut check, mission, &outlook, goes_later);
            check.warnings.extend(fix_too_late(mission, stops));
            let reserve = self.battery.as_ref().map_or(0.0, |b| b.reserve_percent);
            energy::fill_in(&mut check, mission, reserve, stops);
        }
        check
    }

    /// The first mandatory work that is left out.
    fn first_duty_left<'w>(&self, works: &'w [Work], is_done: &[bool]) -> Option<&'w Work> {
        let mut works = works.iter().zip(is_done);
        let left = works.find(|(work, is_done)| self.is_mandatory(work) && !**is_done);
        left.map(|(work, _)| work)
    }

    fn is_mandatory(&self, work: &Work) -> bool {
        self.tasks
            .get(&work.name)
            .is_some_and(|task| task.mandatory)
    }

    /// Adds the problem of mandatory tasks that cannot all be done.
    fn require_mandatory(&self, check: &mut LaunchCheck, works: &[Work], is_planned: &[bool]) {
        let Some(first) = self.first_duty_left(works, is_planned) else {
            return;
        };
        let works = works.iter().zip(is_planned);
        let duties = works.filter(|(work, _)| self.is_mandatory(work));
        let alone = check
            .tasks
            .iter()
            .find(|t| t.name == first.name && t.at == first.at);
        let why = alone.and_then(|task| task.reason.clone());
        let others: Vec<String> = duties
            .filter(|(_, is_planned)| **is_planned)
            .map(|(work, _)| work.title())
            .collect();
        let why = why.unwrap_or_else(|| format!(
            "no route does it together with {}, mandatory too; give a longer budget_s, other windows, or make one of them optional",
            others.join(", ")
        ));
        check.go = false;
        check.problems.push(format!(
            "tasks.{} (mandatory, at {}): {why}",
            first.name, first.at
        ));
    }

    /// Says of tasks left out that they come after one that is left out.
    fn explain_order(&self, check: &mut LaunchCheck, works: &[Work], is_planned: &[bool]) {
        for left_out in &mut check.left_out {
            let after = self
                .tasks
                .get(&left_out.task)
                .map_or(&[][..], |task| &task.after);
            let is_out = |name: &&String| {
                let mut others = works.iter().zip(is_planned);
                !others.any(|(work, is_planned)| self.is_called(&work.name, name) && *is_planned)
            };
            if let Some(before) = after.iter().find(is_out) {
                left_out.reason = WhyLeftOut::Order;
                left_out.text = format!("it comes after {before}, which is left out");
            }
        }
    }

    /// Whether the mission still goes when it is launched later and has to be home at the same time: all mandatory
    /// tasks are planned.
    fn goes_later(
        &self,
        scenario: &Scenario,
        driver: &Stepped<'_>,
        works: &[Work],
        delay_s: f64,
    ) -> bool {
        if !self.has_mandatory_tasks() {
            return true;
        }
        let mut later = scenario.clone();
        let mission = Arc::make_mut(&mut later.mission);
        mission.launch_s += delay_s;
        mission.budget_s -= delay_s;
        let Some(plan) = Plan::of(&later, driver) else {
            return false;
        };
        let mut duties = works.iter().filter(|work| self.is_mandatory(work));
        duties.all(|work| work.timed.is_some_and(|task| plan.due.contains(&task)))
    }
}

/// How much of a check is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Asked {
    /// What keeps the mission from being launched.
    Problems,
    Everything,
}

/// The mission as it goes in the sea as forecast, and what is wrong with that; the route at the launch where it does not
/// come home there.
fn rehearsed(
    scenario: &Scenario,
    driver: &Stepped<'_>,
    route: Expected,
) -> (Expected, Option<String>) {
    let in_forecast = "mission: flown in the sea as forecast, without obstacles,";
    match rehearse(scenario, driver) {
        Rehearsal::InTime(expected) => (expected, None),
        Rehearsal::Late(expected, by_s) => {
            let text = format!(
                "{in_forecast} it is home {by_s:.0} s too late; give a longer budget_s or less to do; where fixes at the surface take the time, a longer every_s"
            );
            (expected, Some(text))
        }
        Rehearsal::Failed(how) => {
            let text = format!(
                "{in_forecast} it does not come home ({how}); its log without --check shows where it ends; the times told are those of the route at the launch"
            );
            (route, Some(text))
        }
    }
}

/// The route that the synchroniser adopts at the launch, in water without obstacles.
#[derive(Debug, Default)]
struct Plan {
    route: Vec<NodeId>,
    /// What it does of the mission's time model.
    due: Vec<usize>,
}

impl Plan {
    fn of(scenario: &Scenario, driver: &Stepped<'_>) -> Option<Self> {
        let mission = Arc::clone(&scenario.mission);
        let launch = Observation {
            time_s: mission.launch_s,
            position: mission.position_of(mission.start),
            velocity: Vector3::zeros(),
            regions: [].into(),
            position_sigma_m: 0.0,
        };
        let (settings, seed) = (scenario.settings.clone(), scenario.seed.split(0));
        let mut synchroniser = Synchroniser::new(mission, settings, seed).ok()?;
        let commands = synchroniser.step(Event::Tick(launch));
        let answer = commands.iter().find_map(|command| driver.answer(command))?;
        synchroniser.step(answer);
        Some(Self {
            route: synchroniser.route().to_vec(),
            due: synchroniser.timed_due().to_vec(),
        })
    }
}

/// What is told where the waypoints for fixes are too far apart on the route.
fn fix_too_late(mission: &Mission, stops: &[Stop]) -> Option<String> {
    let every_s = mission.surfacing?.every_s;
    let is_fixed = |stop: &Stop| mission.fix_places.contains(&stop.node);
    let ends = stops.iter().enumerate();
    let last = stops.len().checked_sub(1)?;
    let ends = ends.filter(|(i, stop)| *i == 0 || *i == last || is_fixed(stop));
    let ends: Vec<&Stop> = ends.map(|(_, stop)| stop).collect();
    let mut gaps = ends.windows(2).filter(|_| !mission.fix_places.is_empty());
    let gap = gaps.find(|gap| gap[1].arrive_s - gap[0].leave_s > every_s)?;
    Some(format!(
        "surface: {:.0} s without a fix from {} to {}, more than every_s; add a waypoint between them to where",
        gap[1].arrive_s - gap[0].leave_s,
        mission.name_of(gap[0].node),
        mission.name_of(gap[1].node)
    ))
}

/// Planners keep less than this part of the time free for detours and slower legs.
const KEPT_FREE: f64 = 0.1;

/// How long before time or battery are up a route is home, less what planners keep free, seconds.
fn slack_s(mission: &Mission, stops: &[Stop]) -> f64 {
    let enough_s = mission.available_s(mission.budget_s, 0.0) - mission.reserve_s;
    let takes_s = stops.last().map(|home| home.leave_s - mission.launch_s);
    takes_s.map_or(f64::NEG_INFINITY, |takes_s| {
        (1.0 - KEPT_FREE) * enough_s - takes_s
    })
}
