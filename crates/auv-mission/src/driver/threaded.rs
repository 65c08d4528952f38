//! The driver that plans while the vehicle moves: planners run on threads of their own.

use super::call::{Call, NoAnswer};
use super::orders::{Driver, Orders};
use super::planners::{Asked, Planners, failed};
use super::prepared::Prepared;
use crate::{Command, Event, Observation, Synchroniser};
use auv_planning::{PathPlanner, RoutePlanner};
use std::fmt;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Weak};
use std::time::Duration;

/// Limits of the threaded driver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThreadedSettings {
    /// Wall time after which a route call is abandoned.
    pub route_deadline: Duration,
    /// Wall time after which a path call is abandoned.
    pub path_deadline: Duration,
    /// How long before the end of the trajectory in force (mission time) the route and the path from the
    /// next waypoint are prepared. Zero: nothing is prepared.
    pub anticipation: Duration,
}

impl Default for ThreadedSettings {
    /// 30 s for a route, 10 s for a path, prepared 60 s ahead.
    fn default() -> Self {
        Self {
            route_deadline: Duration::from_secs(30),
            path_deadline: Duration::from_secs(10),
            anticipation: Duration::from_secs(60),
        }
    }
}

type Shared = Planners<Arc<dyn RoutePlanner>, Arc<dyn PathPlanner>>;

/// Route planning, path planning and the vehicle's progress at the same time.
///
/// [`Threaded::tick`] never waits: every request is computed on a thread of its own, and answers are
/// taken in once they are there. A call that overruns its hard deadline is told to stop and no longer waited
/// for: a late result is dropped, and the synchroniser gets an error. As long as two abandoned calls of
/// a planner (overrun, or replaced by a newer request) are still running, a baseline answers in its
/// place. For panics see [`crate::driver`].
///
/// Set [`crate::PlanningSettings::planning_s`] to the usual computing time of a path, so that paths start
/// where the vehicle is when they are ready.
///
/// # Determinism
/// If every answer is waited for ([`Threaded::wait`]) and nothing is prepared ahead, decisions are those
/// of [`super::Stepped`]. Otherwise they depend on how long planners take.
pub struct Threaded {
    planners: Arc<Shared>,
    settings: ThreadedSettings,
    pending: Option<Pending>,
    ahead: Option<Ahead>,
    /// Abandoned calls, alive while their threads are: of routes, of paths, of preparations.
    abandoned: [Vec<Weak<AtomicBool>>; 3],
}

/// The question that the synchroniser waits for.
struct Pending {
    request: u64,
    is_route: bool,
    call: Call<Option<Event>>,
}

/// What is prepared for the waypoint reached after `visited` others.
struct Ahead {
    visited: usize,
    started_s: f64,
    call: Option<Call<Prepared>>,
    prepared: Prepared,
}

impl fmt::Debug for Threaded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Threaded")
            .field("settings", &self.settings)
            .field("waiting", &self.is_waiting())
            .finish_non_exhaustive()
    }
}

impl Threaded {
    /// A driver with these planners.
    #[must_use]
    pub fn new(
        route_planner: Arc<dyn RoutePlanner>,
        path_planner: Arc<dyn PathPlanner>,
        settings: ThreadedSettings,
    ) -> Self {
        Self {
            planners: Arc::new(Planners::new(route_planner, path_planner)),
            settings,
            pending: None,
            ahead: None,
            abandoned: Default::default(),
        }
    }

    /// Whether the synchroniser waits for an answer.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        self.pending.is_some()
    }

    /// Feeds an observation and the answers that are there. Never waits.
    pub fn tick(&mut self, synchroniser: &mut Synchroniser, observation: Observation) -> Orders {
        let mut orders = self.tell(synchroniser, Event::Tick(observation));
        self.take_in(synchroniser, Duration::ZERO, &mut orders);
        self.prepare(synchroniser);
        orders
    }

    /// Feeds any event. Never waits.
    pub fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event) -> Orders {
        let mut orders = Orders::default();
        let commands = synchroniser.step(event);
        self.carry_out(synchroniser, commands, &mut orders);
        orders
    }

    /// Feeds the answers that are there, between two ticks. Never waits.
    pub fn poll(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        let mut orders = Orders::default();
        self.take_in(synchroniser, Duration::ZERO, &mut orders);
        orders
    }

    /// Waits until no question is open and nothing is being prepared, at most until the hard deadlines.
    pub fn wait(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        let mut orders = Orders::default();
        while self.is_waiting() {
            self.take_in(synchroniser, Duration::MAX, &mut orders);
        }
        self.prepare(synchroniser);
        if let Some(ahead) = &mut self.ahead {
            ahead.take_in(Duration::MAX);
        }
        orders
    }

    /// Asks the question that a resumed synchroniser still waits for.
    pub fn carry_on(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        let mut orders = Orders::default();
        let commands = synchroniser.outstanding().into_iter().collect();
        self.carry_out(synchroniser, commands, &mut orders);
        orders
    }

    /// Carries out commands; questions with a prepared answer are answered at once.
    fn carry_out(
        &mut self,
        synchroniser: &mut Synchroniser,
        mut commands: Vec<Command>,
        orders: &mut Orders,
    ) {
        while !commands.is_empty() {
            let answers: Vec<Event> = commands
                .into_iter()
                .filter_map(|command| match command {
                    Command::PlanRoute(_) | Command::PlanPath(_) => self.ask(synchroniser, command),
                    order => {
                        orders.take(order);
                        None
                    }
                })
                .collect();
            commands = answers
                .into_iter()
                .flat_map(|answer| synchroniser.step(answer))
                .collect();
        }
        if synchroniser.outcome().is_some() {
            (self.pending, self.ahead) = (None, None);
        }
    }

    /// Starts a call. Returns the answer if it is prepared, or an error if no thread can be started.
    fn ask(&mut self, synchroniser: &Synchroniser, question: Command) -> Option<Event> {
        let prepared = self.prepared_for(synchroniser);
        let ready = prepared.and_then(|prepared| prepared.answer(&question));
        if ready.is_some() {
            return ready;
        }
        let (request, is_route, deadline) = match &question {
            Command::PlanRoute(request) => (request.id, true, self.settings.route_deadline),
            Command::PlanPath(request) => (request.id, false, self.settings.path_deadline),
            Command::Follow(_) | Command::Finished(_) => return None,
        };
        let asked = if hanging(&mut self.abandoned[usize::from(!is_route)]) >= 2 {
            Asked::Baseline
        } else {
            Asked::Planner
        };
        let planners = Arc::clone(&self.planners);
        let call = Call::start(deadline, move |cancel, clock_s| {
            planners.answer(&question, asked, cancel, clock_s)
        });
        let Some(call) = call else {
            return Some(failure(request, is_route, "no thread can be started", 0.0));
        };
        // The earlier question is no longer open.
        if let Some(old) = self.pending.take() {
            self.abandoned[usize::from(!old.is_route)].push(old.call.abandon());
        }
        self.pending = Some(Pending {
            request,
            is_route,
            call,
        });
        None
    }

    /// Takes in the answer waited for, or abandons the call.
    fn take_in(
        &mut self,
        synchroniser: &mut Synchroniser,
        patience: Duration,
        orders: &mut Orders,
    ) {
        let Some(pending) = &self.pending else { return };
        let (request, is_route) = (pending.request, pending.is_route);
        let spent_s = pending.call.clock_s();
        let event = match pending.call.receive(patience) {
            Ok(Some(event)) => event,
            Err(NoAnswer::Working) => return,
            Err(NoAnswer::Overran) => {
                self.abandoned[usize::from(!is_route)].push(pending.call.abandon());
                failure(request, is_route, "it overran its hard deadline", spent_s)
            }
            Ok(None) | Err(NoAnswer::Died) => {
                failure(request, is_route, "its thread died", spent_s)
            }
        };
        self.pending = None;
        let commands = synchroniser.step(event);
        self.carry_out(synchroniser, commands, orders);
    }

    /// Starts to prepare the next waypoint, and again when what was prepared no longer holds.
    fn prepare(&mut self, synchroniser: &Synchroniser) {
        let visited = synchroniser.visited().len();
        let within_s = self.settings.anticipation.as_secs_f64();
        if within_s <= 0.0 || self.is_waiting() || synchroniser.outcome().is_some() {
            return;
        }
        let Some(arrival) = Prepared::arrival(synchroniser, within_s) else {
            return;
        };
        let started_s = synchroniser.view().now_s();
        let same = self.ahead.as_mut().filter(|ahead| ahead.visited == visited);
        // What was prepared before for the same waypoint is kept until it is replaced.
        let mut prepared = Prepared::default();
        if let Some(ahead) = same {
            ahead.take_in(Duration::ZERO);
            let lately = started_s - ahead.started_s < synchroniser.view().settings.waiting.react_s;
            if lately || ahead.call.is_some() || ahead.prepared.still_holds(synchroniser, &arrival)
            {
                return;
            }
            prepared = std::mem::take(&mut ahead.prepared);
        }
        let late = self.ahead.take().and_then(|ahead| ahead.call);
        self.abandoned[2].extend(late.map(|call| call.abandon()));
        let (planners, copy) = (Arc::clone(&self.planners), synchroniser.clone());
        let paths = self.settings.path_deadline.saturating_mul(2);
        let deadline = self.settings.route_deadline.saturating_add(paths);
        let call = if hanging(&mut self.abandoned[2]) < 2 {
            Call::start(deadline, move |cancel, _| {
                let ask =
                    |command: &Command| planners.answer(command, Asked::Planner, cancel, &|| 0.0);
                Prepared::new(copy, arrival, &ask)
            })
        } else {
            None
        };
        self.ahead = Some(Ahead {
            visited,
            started_s,
            call,
            prepared,
        });
    }

    /// What was prepared for the waypoint just reached.
    fn prepared_for(&mut self, synchroniser: &Synchroniser) -> Option<&mut Prepared> {
        let reached = synchroniser.visited().len();
        let ahead = self
            .ahead
            .as_mut()
            .filter(|ahead| ahead.visited + 1 == reached)?;
        ahead.take_in(Duration::ZERO);
        Some(&mut ahead.prepared)
    }
}

/// Never waits. In a simulation faster than real time, wait after each tick: [`Threaded::wait`].
impl Driver for Threaded {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event) -> Orders {
        Self::tell(self, synchroniser, event)
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        Self::carry_on(self, synchroniser)
    }

    fn tick(&mut self, synchroniser: &mut Synchroniser, observation: Observation) -> Orders {
        Self::tick(self, synchroniser, observation)
    }
}

impl Ahead {
    fn take_in(&mut self, patience: Duration) {
        let Some(call) = &self.call else { return };
        if let Ok(prepared) = call.receive(patience) {
            self.prepared = prepared;
            self.call = None;
        }
    }
}

/// How many of the abandoned calls have not returned.
fn hanging(abandoned: &mut Vec<Weak<AtomicBool>>) -> usize {
    abandoned.retain(|call| call.strong_count() > 0);
    abandoned.len()
}

fn failure(request: u64, is_route: bool, reason: &str, compute_s: f64) -> Event {
    if is_route {
        Event::RoutePlanned {
            request,
            result: Err(failed("of routes", reason)),
            compute_s,
        }
    } else {
        Event::PathPlanned {
            request,
            result: Err(failed("of paths", reason)),
            compute_s,
        }
    }
}
