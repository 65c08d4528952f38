//! Asking for routes and adopting them.

use crate::forecast::FieldForecast;
use crate::synchroniser::{Phase, RouteFrom};
use crate::{
    AbortReason, Acceptance, Command, RouteCall, RouteReason, RouteRequest, Synchroniser, check,
    here, times,
};
use auv_graph::{EdgeSet, Network, NodeId, Route, RouteTotals};
use auv_planning::{PlanError, Planned};
use std::sync::Arc;

/// A route is asked for anew, with a new seed, after so many answers in a row that are none: a driver
/// that has seen as many panics lets a baseline answer by then.
const MOST_ROUTE_FAILURES: usize = 3;

impl Synchroniser {
    /// Asks for a route.
    pub(crate) fn ask_route(
        &mut self,
        reason: RouteReason,
        from: RouteFrom,
        commands: &mut Vec<Command>,
    ) {
        let request = self.route_request(from);
        self.state.phase = Phase::Routing {
            request: request.id,
            reason,
            from,
        };
        commands.push(Command::PlanRoute(request));
    }

    fn route_request(&mut self, from: RouteFrom) -> RouteRequest {
        let (id, seed) = self.next_request();
        self.request_with(id, seed, from)
    }

    /// The request as it is (or was) asked: it depends on the state alone.
    pub(crate) fn request_with(
        &self,
        id: u64,
        seed: auv_types::Seed,
        from: RouteFrom,
    ) -> RouteRequest {
        let (network, start) = self.network_for(from);
        let rest = match from {
            RouteFrom::Waypoint => &self.state.route[..],
            RouteFrom::Target => self.state.route.get(1..).unwrap_or_default(),
            RouteFrom::Here => &[],
        };
        let incumbent = (rest.len() > 1).then(|| Route::new(rest.to_vec()));
        let mut removed = self.state.removed.clone();
        let mut departs_s = self.state.now_s;
        if let (RouteFrom::Target, Some(leg)) = (from, &self.state.leg) {
            departs_s = self.due_s().max(departs_s);
            for done in leg
                .edge
                .iter()
                .flat_map(|&edge| self.mission.done_with(edge))
            {
                removed.insert(done);
            }
        }
        let mut forecast = FieldForecast::new(&self.mission, &self.settings, &self.state.regions);
        if let (RouteFrom::Here, Some(leg)) = (from, &self.state.leg)
            && let Some(arrives_s) = leg.stays_from_s
        {
            let target = self.mission.position_of(leg.to);
            forecast = forecast.with_way(target, arrives_s - departs_s);
        }
        RouteRequest {
            id,
            times: times::arc_times_s(
                &self.mission,
                &self.settings,
                &network,
                departs_s,
                (start, &forecast),
            ),
            network,
            removed,
            start,
            destination: self.mission.destination,
            time_available_s: self.available_s()
                - self.mission.reserve_s
                - self.answered_in_s(from)
                - (departs_s - self.state.now_s),
            incumbent,
            seed,
            budget: if self.state.route_calls.is_empty() {
                self.settings.launch_budget
            } else {
                self.settings.route_budget
            },
        }
    }

    /// Time that a route takes to be planned for while the vehicle waits for it, seconds.
    fn answered_in_s(&self, from: RouteFrom) -> f64 {
        match from {
            RouteFrom::Waypoint | RouteFrom::Here => self.settings.planning_s,
            RouteFrom::Target => 0.0,
        }
    }

    /// The network and the waypoint a route begins at; the vehicle's place is added as one.
    fn network_for(&self, from: RouteFrom) -> (Arc<Network>, NodeId) {
        let target = self.state.leg.as_ref().map(|leg| leg.to);
        let start = match from {
            RouteFrom::Target => target.unwrap_or(self.state.at),
            RouteFrom::Waypoint | RouteFrom::Here => self.state.at,
        };
        let whole = (Arc::clone(&self.mission.network), start);
        if from != RouteFrom::Here {
            return whole;
        }
        let anchors = self.anchors();
        match here::network_from(&self.mission, self.state.position, &anchors) {
            Ok(network) => {
                let here = NodeId(network.num_nodes() as u32 - 1);
                (Arc::new(network), here)
            }
            Err(_) => whole,
        }
    }

    /// Where a way from the vehicle's own place may lead first: the ends of the leg, or anywhere in open
    /// water; not to a target that is waited for in vain.
    pub(crate) fn anchors(&self) -> Vec<NodeId> {
        let network = &self.mission.network;
        let leg = self.state.leg.as_ref();
        let given_up = leg
            .filter(|leg| leg.waiting || leg.approaching)
            .map(|leg| leg.to)
            .filter(|&to| to != self.mission.destination);
        let mut nodes: Vec<NodeId> = if self.mission.open_water {
            (0..network.num_nodes() as u32).map(NodeId).collect()
        } else {
            let ends = leg.iter().flat_map(|leg| [leg.from, leg.to]);
            ends.chain([self.state.at]).collect()
        };
        nodes.retain(|&node| network.has_node(node) && Some(node) != given_up);
        nodes.sort_unstable();
        nodes.dedup();
        if nodes.is_empty() {
            nodes.extend(given_up);
        }
        nodes
    }

    pub(crate) fn on_route(
        &mut self,
        request: u64,
        result: Result<Planned<Route>, PlanError>,
        compute_s: f64,
        commands: &mut Vec<Command>,
    ) {
        let Phase::Routing {
            request: waited_for,
            reason,
            from,
        } = self.state.phase
        else {
            return;
        };
        if request != waited_for {
            return;
        }
        let mut asked = self.request_with(request, self.seed.split(request), from);
        asked.time_available_s += self.answered_in_s(from);
        self.charge(compute_s, true);
        let mut call = self.call_for(&asked, reason, compute_s);
        let went_wrong = match &result {
            Err(PlanError::Unreachable { .. }) => false,
            Err(_) => true,
            Ok(planned) => planned.violation <= 0.0,
        };
        let planned = result.ok();
        if let Some(planned) = &planned {
            call.cost = planned.cost;
            call.evaluations = planned.stats.evaluations;
            call.valid = check::route_is_valid(&asked.problem(), &planned.best);
        }
        let chosen = self.choose_route(&asked, planned.map(|p| p.best), &mut call);
        let nodes = match chosen {
            Some(route) => {
                self.state.homeward = false;
                route.nodes().to_vec()
            }
            // The leg goes on; what comes after it is decided at its end.
            None if from == RouteFrom::Target => {
                self.state.route_calls.push(call);
                self.state.phase = Phase::Flying;
                return;
            }
            // For want of a plan no task is given up that the next answer may still bring.
            None if went_wrong && self.route_failures() < MOST_ROUTE_FAILURES => {
                self.state.route_calls.push(call);
                return self.ask_route(reason, from, commands);
            }
            None => match self.way_home(&asked) {
                Some(nodes) => nodes,
                None => return self.abort(AbortReason::Unreachable, commands),
            },
        };
        self.take_route(&asked, nodes, (call, from), commands);
    }

    /// How many answers in a row were no valid route.
    fn route_failures(&self) -> usize {
        let calls = self.state.route_calls.iter().rev();
        calls.take_while(|call| !call.valid).count()
    }

    /// Leaves the leg and its tasks for the quickest way home; no planner is asked.
    pub(crate) fn go_home(&mut self, reason: RouteReason, commands: &mut Vec<Command>) {
        if let Some(leg) = self.state.leg.clone() {
            self.record_leg(&leg, false, true, false);
        }
        let asked = self.route_request(RouteFrom::Here);
        let call = self.call_for(&asked, reason, 0.0);
        match self.way_home(&asked) {
            Some(nodes) => self.take_route(&asked, nodes, (call, RouteFrom::Here), commands),
            None => self.abort(AbortReason::Unreachable, commands),
        }
    }

    /// A row of the route table, before there is an answer.
    fn call_for(&self, asked: &RouteRequest, reason: RouteReason, compute_s: f64) -> RouteCall {
        RouteCall {
            call: self.state.route_calls.len() + 1,
            reason,
            at_s: self.state.now_s,
            start: asked.start,
            destination: asked.destination,
            tasks: 0,
            route_weight: 0.0,
            mission_weight: self.state.weight,
            cost: f64::MAX,
            available_s: self.available_s(),
            route_s: 0.0,
            valid: false,
            adopted: false,
            evaluations: 0,
            compute_s,
            route: Vec::new(),
        }
    }

    /// Puts a route in force.
    fn take_route(
        &mut self,
        asked: &RouteRequest,
        nodes: Vec<NodeId>,
        (mut call, from): (RouteCall, RouteFrom),
        commands: &mut Vec<Command>,
    ) {
        if let Some(totals) = totals_of(asked, &nodes) {
            let planned_weight = if self.state.homeward {
                0.0
            } else {
                totals.weight
            };
            call.tasks = tasks_on(asked, &nodes);
            call.route_weight = planned_weight;
            call.mission_weight += planned_weight;
            call.route_s = totals.time_s;
        }
        call.route.clone_from(&nodes);
        self.state.route_calls.push(call);
        if let (RouteFrom::Target, Some(leg)) = (from, &self.state.leg) {
            self.state.route = std::iter::once(leg.from).chain(nodes).collect();
            self.state.phase = Phase::Flying;
            return;
        }
        self.state.route = nodes;
        self.state.leg = None;
        self.next_leg(commands);
    }

    /// The planner's route if it is valid and better than what is in force, else what is in force
    /// if that is still valid.
    fn choose_route(
        &self,
        asked: &RouteRequest,
        planned: Option<Route>,
        call: &mut RouteCall,
    ) -> Option<Route> {
        if self.settings.acceptance == Acceptance::AsClaimed && planned.is_some() {
            call.adopted = true;
            return planned;
        }
        let problem = asked.problem();
        let score = |route: &Route| {
            problem.check(route).ok().map(|totals| {
                (
                    problem.objective.cost(&totals, asked.time_available_s),
                    totals.time_s,
                )
            })
        };
        let new = planned
            .filter(|_| call.valid)
            .and_then(|route| score(&route).map(|score| (score, route)));
        let old = asked
            .incumbent
            .clone()
            .and_then(|route| score(&route).map(|score| (score, route)));
        match (new, old) {
            (Some((new_score, new)), Some((old_score, old))) => {
                call.adopted = new_score
                    .0
                    .total_cmp(&old_score.0)
                    .then(new_score.1.total_cmp(&old_score.1))
                    .is_lt();
                Some(if call.adopted { new } else { old })
            }
            (Some((_, new)), None) => {
                call.adopted = true;
                Some(new)
            }
            (None, old) => old.map(|(_, route)| route),
        }
    }

    /// The quickest way home, passed edges and all, tasks left undone.
    fn way_home(&mut self, asked: &RouteRequest) -> Option<Vec<NodeId>> {
        self.state.homeward = true;
        if self.mission.open_water {
            return Some(vec![asked.start, self.mission.destination]);
        }
        let nothing = EdgeSet::empty();
        let (mission, network) = (&self.mission, &asked.network);
        let forecast_s = times::travel_times_s(mission, network, self.state.now_s).collect();
        let still_s = |arc: &auv_graph::NetworkArc| arc.distance_m / mission.vehicle.speed_mps;
        let still_s: Vec<f64> = network.arcs().iter().map(still_s).collect();
        // Where the forecast lets no way through, the shortest is tried all the same.
        [forecast_s, still_s].iter().find_map(|times_s: &Vec<f64>| {
            let home = network.quickest_to(mission.destination, &nothing, Some(times_s));
            let route = home.route_from(asked.start);
            route.map(|route| route.nodes().to_vec())
        })
    }
}

fn totals_of(asked: &RouteRequest, nodes: &[NodeId]) -> Option<RouteTotals> {
    let nothing = EdgeSet::empty();
    asked
        .network
        .evaluate(
            &Route::new(nodes.to_vec()),
            &nothing,
            asked.times.as_deref(),
        )
        .ok()
}

/// Tasks that a route passes, each once; transits are none.
fn tasks_on(asked: &RouteRequest, nodes: &[NodeId]) -> usize {
    let network = &asked.network;
    let mut passed = EdgeSet::empty();
    let arcs = nodes
        .windows(2)
        .filter_map(|leg| network.arc_between(leg[0], leg[1]));
    let edges = arcs.map(|arc| network.arcs()[arc.index()].edge);
    edges
        .filter(|&edge| network.task(edge).weight() > 0.0 && passed.insert(edge))
        .count()
}
