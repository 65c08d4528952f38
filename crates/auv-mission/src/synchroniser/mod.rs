//! The synchroniser: a state machine that flies a mission leg by leg (Fig. 3 and 4).

mod apply;

use crate::beliefs::Beliefs;
use crate::check::Acceptor;
use crate::decide::{Situation, decide};
use crate::facts::Facts;
use crate::ledger::Ledger;
use crate::mode::{LegMode, Mode, NextRoute};
use crate::soundings::Soundings;
use crate::state::{RouteInForce, State};
use crate::tide::{Stretch, Tide};
use crate::trigger::{Payload, Trigger};
use crate::view::View;
use crate::{
    Command, Contingency, Event, Mission, Outcome, PathCall, RouteCall, SyncSettings,
    path_question, route_from_vehicle,
};
use auv_graph::NodeId;
use auv_ocean::Shoal;
use auv_planning::{TaskDone, Trajectory};
use auv_types::{Seed, Violations};
use std::sync::Arc;

/// Flies a mission: `(state, event) -> (state, commands)`. It never blocks, reads no clock and calls
/// no planner; the driver does (see [`crate::driver`]).
///
/// The decisions are listed in `docs/synchroniser.md`.
///
/// # Determinism
/// Equal mission, settings, seed and events give equal commands.
#[derive(Clone, Debug)]
pub struct Synchroniser {
    /// The mission as given.
    mission: Arc<Mission>,
    /// The mission over the bed as measured.
    known: Arc<Mission>,
    settings: SyncSettings,
    seed: Seed,
    acceptor: Acceptor,
    home_s: Vec<f64>,
    /// Legs by departure, where that matters; `home_s` is not used then.
    tide: Option<Arc<Tide>>,
    /// Written by `apply` only.
    state: State,
}

impl Synchroniser {
    /// A synchroniser for one mission.
    ///
    /// # Errors
    /// Everything that keeps the mission from starting (see [`Mission::validate`]) and every setting out of
    /// range.
    pub fn new(
        mission: Arc<Mission>,
        settings: SyncSettings,
        seed: Seed,
    ) -> Result<Self, Violations> {
        let mut violations = mission.validate();
        violations.absorb("settings.", settings.validate());
        violations.into_result()?;
        let state = State {
            mode: Mode::Ready,
            beliefs: Beliefs::new(&mission),
            soundings: Soundings::default(),
            ledger: Ledger::new(&mission),
            route: RouteInForce::None,
            due: Vec::new(),
            in_force: None,
            next_question: 0,
        };
        Ok(Self::with_state(mission, settings, seed, state))
    }

    /// A synchroniser in a given state. The state must fit the mission.
    pub(crate) fn with_state(
        mission: Arc<Mission>,
        settings: SyncSettings,
        seed: Seed,
        state: State,
    ) -> Self {
        let since_s = match &state.mode {
            Mode::Leg(leg) => leg.started_s,
            _ => mission.launch_s,
        };
        let stretch = Stretch {
            share: settings.margins.detour_margin,
            each_s: settings.margins.detour_margin_s + settings.planning.planning_s,
        };
        let tide = Tide::of(&mission, stretch).map(Arc::new);
        Self {
            home_s: route_from_vehicle::home_times_s(&mission, since_s),
            tide,
            known: state.soundings.over(&mission),
            mission,
            settings,
            seed,
            acceptor: Acceptor::Verifier,
            state,
        }
    }

    /// Takes in an event and returns the commands that follow, in order.
    ///
    /// An answer to a question that is no longer open is ignored. After the end all events are ignored.
    pub fn step(&mut self, event: Event) -> Vec<Command> {
        let mut commands = Vec::new();
        let mut next = if self.outcome().is_none() {
            self.apply_event(event)
        } else {
            None
        };
        while let Some((trigger, payload)) = next {
            let facts = Facts::at(self.view(), trigger, &payload);
            let decision = decide(Situation::of(&self.state.mode), trigger, facts);
            let follows = self.apply(decision, payload, &mut commands);
            next = follows.map(|trigger| (trigger, self.payload_of(trigger)));
        }
        commands
    }

    /// What a trigger that follows from a decision comes with: for a wanted path, where it may lead.
    fn payload_of(&self, trigger: Trigger) -> Payload {
        match (trigger, self.view().leg()) {
            (Trigger::PathWanted, Some(leg)) => {
                Payload::Reach(path_question::reach(self.view(), leg))
            }
            _ => Payload::None,
        }
    }

    /// What decisions are made from.
    pub(crate) fn view(&self) -> View<'_> {
        View {
            mission: &self.known,
            settings: &self.settings,
            seed: self.seed,
            acceptor: self.acceptor,
            home_s: &self.home_s,
            tide: self.tide.as_deref(),
            state: &self.state,
        }
    }

    /// How the mission ended; `None` while it lasts.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        match self.state.mode {
            Mode::Finished { outcome, .. } => Some(outcome),
            _ => None,
        }
    }

    /// Mission time left of the budget in seconds, charged computing deducted, or how long the
    /// battery lasts if that is less. Negative when late.
    #[must_use]
    pub fn available_s(&self) -> f64 {
        self.view().available_s()
    }

    /// The waypoints reached, in order, the start included.
    #[must_use]
    pub fn visited(&self) -> &[NodeId] {
        &self.state.ledger.visited
    }

    /// Weight of the tasks done.
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.state.ledger.weight
    }

    /// Number of tasks done. A transit is not a task.
    #[must_use]
    pub fn tasks(&self) -> usize {
        self.state.ledger.tasks
    }

    /// What the route in force still does of the tasks of the mission's time model, by index, in order.
    #[must_use]
    pub fn timed_due(&self) -> &[usize] {
        &self.state.due
    }

    /// The tasks of the mission's time model that are done, in order, with the mission time at which each
    /// began.
    #[must_use]
    pub fn timed_done(&self) -> &[TaskDone] {
        &self.state.ledger.done
    }

    /// The rest of the route in force, from the last waypoint or the vehicle's own place on.
    #[must_use]
    pub fn route(&self) -> &[NodeId] {
        self.state.route.nodes()
    }

    /// The trajectory in force, with the way on from its end.
    #[must_use]
    pub fn trajectory(&self) -> Option<&Trajectory> {
        self.view().in_force()
    }

    /// The table of route calls so far.
    #[must_use]
    pub fn route_calls(&self) -> &[RouteCall] {
        &self.state.ledger.route_calls
    }

    /// The table of legs so far.
    #[must_use]
    pub fn path_calls(&self) -> &[PathCall] {
        &self.state.ledger.path_calls
    }

    /// Whether the vehicle surfaces on purpose: for a fix, or because the mission is aborted. It leaves its box
    /// upwards then.
    #[must_use]
    pub fn surfaces(&self) -> bool {
        match &self.state.mode {
            Mode::Leg(leg) => leg.mode == LegMode::Surfacing,
            Mode::Contingency(state) => state.flown == Some(Contingency::Surface),
            Mode::Ready | Mode::AwaitRoute(_) | Mode::Finished { .. } => false,
        }
    }

    /// The contingency being flown, or flown before the end.
    #[must_use]
    pub fn contingency(&self) -> Option<Contingency> {
        match self.state.mode {
            Mode::Contingency(state) => state.flown,
            Mode::Finished { contingency, .. } => contingency,
            Mode::Ready | Mode::AwaitRoute(_) | Mode::Leg(_) => None,
        }
    }

    /// The mission as given. Plans are made over the bed as measured: see [`Synchroniser::shoals`].
    #[must_use]
    pub fn mission(&self) -> &Arc<Mission> {
        &self.mission
    }

    /// Where the bed was measured shallower than the chart allows for, oldest first.
    #[must_use]
    pub fn shoals(&self) -> &[Shoal] {
        &self.state.soundings.shoals
    }

    /// How often the vehicle climbed because it was too low over the bed as measured.
    #[must_use]
    pub fn climbs(&self) -> u32 {
        self.state.ledger.climbs
    }

    /// Waypoints that were reached higher than given, because the bed there is shallower than charted, and by
    /// how much, metres.
    #[must_use]
    pub fn raised(&self) -> &[(NodeId, f64)] {
        &self.state.ledger.raised
    }

    /// When the next tick is due at the latest, mission time in seconds: at the end of what the
    /// trajectory in force is followed for, then at the end of the way on from there. Once the mission has an
    /// outcome, the time of the last tick.
    #[must_use]
    pub fn due_s(&self) -> f64 {
        let view = self.view();
        match self.outcome() {
            Some(_) => view.now_s(),
            None => view.due_s(),
        }
    }

    /// The question to a planner that is not answered yet, if there is one.
    #[must_use]
    pub fn outstanding(&self) -> Option<Command> {
        let route = match &self.state.mode {
            Mode::AwaitRoute(question) => question,
            Mode::Leg(leg) => match (leg.awaited.question(), &leg.next_route) {
                (Some(path), _) => {
                    return Some(Command::PlanPath(path.request(&self.known, self.seed)));
                }
                (None, NextRoute::Asked(question)) => question,
                (None, NextRoute::AtTarget | NextRoute::Decided) => return None,
            },
            Mode::Ready | Mode::Contingency(_) | Mode::Finished { .. } => return None,
        };
        Some(Command::PlanRoute(route.request(
            &self.known,
            self.tide.as_deref(),
            self.seed,
        )))
    }
}

#[cfg(test)]
impl Synchroniser {
    /// The same state in another mission.
    pub(crate) fn with_mission(mut self, mission: Mission) -> Self {
        self.known = Arc::new(mission);
        self.mission = Arc::clone(&self.known);
        self
    }

    /// The same state with other settings.
    pub(crate) fn with_settings(mut self, settings: SyncSettings) -> Self {
        self.settings = settings;
        self
    }

    /// Takes plans as claimed, without verification.
    pub(crate) fn trusting(mut self) -> Self {
        self.acceptor = Acceptor::AsClaimed;
        self
    }
}
