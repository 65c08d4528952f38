//! The answer of a check before launch.

use super::possible::Possible;
use crate::Scenario;
use crate::mission_file::no_room::NoRoom;
use crate::mission_file::works::Work;
use auv_types::Violations;
use serde::Serialize;

/// Whether a mission can be launched, and what it is expected to do. Its JSON keeps its keys.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LaunchCheck {
    /// Whether it can be launched.
    pub go: bool,
    /// What keeps it from being launched, each with its remedy.
    pub problems: Vec<String>,
    /// Every task at its place.
    pub tasks: Vec<TaskCheck>,
    /// What is flown in the sea as forecast, stop by stop: later routes may pass a waypoint again for work that the
    /// first had no room for. The route of the launch where that does not come home; empty where none is planned.
    pub route: Vec<StopCheck>,
    /// The tasks that are left out.
    pub left_out: Vec<LeftOut>,
    /// What is left of the budget at the destination, the reserve included, seconds; `None` without a route.
    pub margin_s: Option<f64>,
    /// By how much the launch can be delayed with the vehicle still at its destination when it would have to be
    /// there, reserve untouched, tasks left out as necessary, seconds; `None` where no later launch goes.
    pub latest_launch_s: Option<f64>,
    /// What is left in the battery at the destination, percent; `None` without a battery.
    pub energy_left_percent: Option<f64>,
    /// What was assumed, raised or left out.
    pub warnings: Vec<String>,
}

/// A task at a place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TaskCheck {
    /// Its name.
    pub name: String,
    /// The waypoint, or both ends of the edge.
    pub at: String,
    /// Whether the vehicle can do it, alone, and be at the destination in time.
    pub possible: bool,
    /// Why it cannot, with the remedy.
    pub reason: Option<String>,
    /// The survey that it is a line of and that is flown as a whole.
    #[serde(skip)]
    pub survey: Option<String>,
}

/// A waypoint of the route, in seconds from mission time 0.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StopCheck {
    /// Its name.
    pub place: String,
    /// When it is reached.
    pub arrive_s: f64,
    /// When its work is done and it is left.
    pub leave_s: f64,
    /// The tasks done there, or along the edge that leads there.
    pub tasks: Vec<String>,
    /// How long the vehicle climbs to the surface and stays there for fixes, on the way there and during the work.
    pub fixes_s: f64,
    /// How long the vehicle waits there: for windows to open, and for the current to let it pass.
    pub waits_s: f64,
}

/// A task that the route leaves out.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOut {
    /// Its name.
    pub task: String,
    /// Where it is.
    pub at: String,
    /// What keeps it out.
    pub reason: WhyLeftOut,
    /// The same for people.
    pub text: String,
    /// The survey that it is a line of and that is flown as a whole.
    #[serde(skip)]
    pub survey: Option<String>,
}

/// What keeps a task out of a route.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum WhyLeftOut {
    /// No time is left, alone or beside what is done.
    Time,
    /// The battery does not last for it.
    Energy,
    /// No way leads there and on, or no room is there.
    NoWay,
    /// Its windows close too early.
    Window,
    /// It comes after a task that is left out.
    Order,
}

/// Where there are problems nothing is planned.
pub(super) const NOTHING_PLANNED: &str = "nothing is planned before the problems are mended";
const NO_TIME: &str = "no time is left for it beside the tasks that are done; give a longer budget_s, a shorter reserve_s or a higher priority";
/// There would be time even to fly there and home for it alone.
const PASSED_TWICE: &str = "no route found, at the launch or under way, does it beside the tasks that are done; add edges that lead there and on from there";

impl LaunchCheck {
    /// An answer with these problems, and nothing planned.
    pub(super) fn no_go(problems: &Violations) -> Self {
        // Warnings are told apart.
        let texts = problems.list().iter();
        let texts = texts.filter(|wrong| wrong.place != Scenario::TO_KNOW);
        Self {
            go: problems.is_empty(),
            problems: texts
                .map(|wrong| format!("{}: {}", wrong.place, wrong.message))
                .collect(),
            tasks: Vec::new(),
            route: Vec::new(),
            left_out: Vec::new(),
            margin_s: None,
            latest_launch_s: None,
            energy_left_percent: None,
            warnings: Vec::new(),
        }
    }

    /// Adds a task, with what keeps it out for lack of room. The route is home so many seconds before it must be.
    pub(super) fn add(
        &mut self,
        (work, survey): (&Work, Option<&str>),
        possible: &Possible,
        (is_planned, slack_s): (bool, f64),
        shortage: Option<&NoRoom>,
    ) {
        let (why, text) = match possible {
            Possible::Yes { .. } => (WhyLeftOut::Time, None),
            Possible::TooLong { .. } => (WhyLeftOut::Time, possible.text(work)),
            Possible::WindowOver => (WhyLeftOut::Window, possible.text(work)),
            Possible::NotAlone | Possible::NoWay => {
                let text = shortage.map(|known| known.text.clone());
                let text = text.or_else(|| possible.text(work));
                (WhyLeftOut::NoWay, text)
            }
        };
        if !is_planned {
            let (reason, beside) = match possible {
                _ if !self.go => (why, NOTHING_PLANNED),
                Possible::Yes { takes_s } if *takes_s <= slack_s => {
                    (WhyLeftOut::NoWay, PASSED_TWICE)
                }
                _ => (why, NO_TIME),
            };
            self.left_out.push(LeftOut {
                task: work.name.clone(),
                at: work.at.clone(),
                reason,
                text: text.clone().unwrap_or_else(|| beside.into()),
                survey: survey.map(Into::into),
            });
        }
        self.tasks.push(TaskCheck {
            name: work.name.clone(),
            at: work.at.clone(),
            possible: text.is_none(),
            reason: text,
            survey: survey.map(Into::into),
        });
    }
}
