//! Asking for routes and adopting them.

use crate::synchroniser::Phase;
use crate::{
    AbortReason, Acceptance, Command, Outcome, RouteCall, RouteReason, RouteRequest, Synchroniser,
    check, here, times,
};
use auv_graph::{EdgeSet, Network, NodeId, Route, RouteTotals};
use auv_planning::{PlanError, Planned};
use std::sync::Arc;

impl Synchroniser {
    /// Asks for a route from the last waypoint, or from the vehicle's own place.
    pub(crate) fn ask_route(
        &mut self,
        reason: RouteReason,
        from_here: bool,
        commands: &mut Vec<Command>,
    ) {
        let request = self.route_request(from_here);
        self.state.phase = Phase::Routing {
            request: request.id,
            reason,
            from_here,
        };
        commands.push(Command::PlanRoute(request));
    }

    fn route_request(&mut self, from_here: bool) -> RouteRequest {
        let (id, seed) = self.next_request();
        self.request_with(id, seed, from_here)
    }

    /// The request as it is (or was) asked: it depends on the state alone.
    pub(crate) fn request_with(
        &self,
        id: u64,
        seed: auv_types::Seed,
        from_here: bool,
    ) -> RouteRequest {
        let (network, start) = self.network_for(from_here);
        let incumbent = (!from_here && self.state.route.len() > 1)
            .then(|| Route::new(self.state.route.clone()));
        RouteRequest {
            id,
            times: times::arc_times_s(&self.mission, &self.settings, &network, self.state.now_s),
            network,
            removed: self.state.removed.clone(),
            start,
            destination: self.mission.destination,
            time_available_s: self.available_s() - self.mission.reserve_s,
            incumbent,
            seed,
            budget: if self.state.route_calls.is_empty() {
                self.settings.launch_budget
            } else {
                self.settings.route_budget
            },
        }
    }

    /// The mission's network and last waypoint, or the network with the vehicle's place in it.
    fn network_for(&self, from_here: bool) -> (Arc<Network>, NodeId) {
        let whole = (Arc::clone(&self.mission.network), self.state.at);
        if !from_here {
            return whole;
        }
        let given_up = self
            .state
            .leg
            .as_ref()
            .map(|leg| leg.to)
            .filter(|&to| to != self.mission.destination);
        let anchors: Vec<NodeId> = if self.mission.open_water {
            (0..self.mission.network.num_nodes() as u32)
                .map(NodeId)
                .filter(|&node| Some(node) != given_up)
                .collect()
        } else {
            let leg_ends = self.state.leg.iter().flat_map(|leg| [leg.from, leg.to]);
            leg_ends
                .filter(|&node| self.mission.network.has_node(node) && Some(node) != given_up)
                .collect()
        };
        match here::network_from(&self.mission, self.state.position, &anchors) {
            Ok(network) => {
                let here = NodeId(network.num_nodes() as u32 - 1);
                (Arc::new(network), here)
            }
            Err(_) => whole,
        }
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
            from_here,
        } = self.state.phase
        else {
            return;
        };
        if request != waited_for {
            return;
        }
        let asked = self.request_with(request, self.seed.split(request), from_here);
        self.charge(compute_s, true);
        let mut call = RouteCall {
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
        };
        let planned = result.ok();
        if let Some(planned) = &planned {
            call.cost = planned.cost;
            call.evaluations = planned.stats.evaluations;
            call.valid = check::route_is_valid(&asked.problem(), &planned.best);
        }
        let chosen = self.choose_route(&asked, planned.map(|p| p.best), &mut call);
        self.state.homeward = false;
        let nodes = match chosen {
            Some(route) => route.nodes().to_vec(),
            None => match self.way_home(&asked, from_here) {
                Some(nodes) => nodes,
                None => return self.finish(Outcome::Aborted(AbortReason::Unreachable), commands),
            },
        };
        if let Some(totals) = totals_of(&asked, &nodes) {
            let planned_weight = if self.state.homeward {
                0.0
            } else {
                totals.weight
            };
            call.tasks = totals.tasks;
            call.route_weight = planned_weight;
            call.mission_weight += planned_weight;
            call.route_s = totals.time_s;
        }
        call.route.clone_from(&nodes);
        self.state.route_calls.push(call);
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
    fn way_home(&mut self, asked: &RouteRequest, from_here: bool) -> Option<Vec<NodeId>> {
        self.state.homeward = true;
        if self.mission.open_water {
            return Some(vec![asked.start, self.mission.destination]);
        }
        let nothing = EdgeSet::empty();
        let travel_s: Vec<f64> = asked
            .network
            .arcs()
            .iter()
            .map(|arc| arc.distance_m)
            .collect();
        let home = asked
            .network
            .quickest_to(self.mission.destination, &nothing, Some(&travel_s));
        let start = if from_here {
            asked.start
        } else {
            self.state.at
        };
        home.route_from(start).map(|route| route.nodes().to_vec())
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
