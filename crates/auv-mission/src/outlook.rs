//! When a vehicle would be where, before it is launched.

use crate::fixes_ahead::{FixesAhead, LegAhead};
use crate::tide::{Stretch, Tide};
use crate::times::{Arrivals, leg_duration, outline};
use crate::{Mission, agenda};
use auv_graph::{ArcId, EdgeSet, NodeId, TimeModel};
use auv_planning::{LegOutline, NotFlyable, TaskDone, UnderWay};
use auv_types::Point3;

/// The times of a mission as far as they are known before the launch: turns, pitch, stays, the current as
/// forecast for the time of each leg, fixes at the surface, and waits for the tide; neither obstacles nor the margins that routes keep for them.
#[derive(Debug)]
pub struct Outlook<'m> {
    mission: &'m Mission,
    arrivals: Arrivals,
    /// Legs by departure, where that matters: the vehicle waits for the current to let it pass.
    tide: Option<Tide>,
}

/// A waypoint of a route, and when the vehicle is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// The waypoint.
    pub node: NodeId,
    /// When it is reached, mission time in seconds.
    pub arrive_s: f64,
    /// When its work is done and it is left, seconds.
    pub leave_s: f64,
    /// The tasks of the mission's time model done there, with the mission times at which they begin.
    pub timed: Vec<TaskDone>,
    /// How long the fixes at the surface on the way there and during its work take, seconds.
    pub fixes_s: f64,
    /// How long it waits there: for windows to open, and for the current to let it pass, seconds.
    pub waits_s: f64,
}

/// The quickest ways from one waypoint to all others.
#[derive(Clone, Debug, PartialEq)]
pub struct Earliest {
    times_s: Vec<f64>,
    via: Vec<Option<NodeId>>,
}

impl<'m> Outlook<'m> {
    /// The outlook of a mission that [`Mission::validate`] accepts.
    #[must_use]
    pub fn new(mission: &'m Mission) -> Self {
        Self {
            mission,
            arrivals: Arrivals::new(mission, &mission.network),
            tide: Tide::of(mission, Stretch::default()),
        }
    }

    /// The times of a route that leaves its first waypoint at a mission time, its work done on the way: the edges'
    /// own tasks, and those of the mission's time model that are due, in order, with waits for their windows. A
    /// leg without an arc leads straight there.
    ///
    /// # Errors
    /// A leg that cannot be made good against the current.
    pub fn stops(
        &self,
        route: &[NodeId],
        departure_s: f64,
        mut due: &[usize],
    ) -> Result<Vec<Stop>, NotFlyable> {
        let first = route.first().map(|&node| Stop {
            node,
            arrive_s: departure_s,
            leave_s: departure_s,
            timed: Vec::new(),
            fixes_s: 0.0,
            waits_s: 0.0,
        });
        let mut ahead = RouteAhead {
            outlook: self,
            now_s: departure_s,
            from: None,
            worked_on: EdgeSet::empty(),
            fixes: FixesAhead::new(self.mission, departure_s),
            stops: first.into_iter().collect(),
        };
        for rest in (1..route.len()).map(|i| &route[i - 1..]) {
            due = ahead.add_leg(rest, due)?;
        }
        Ok(ahead.stops)
    }

    /// When an arc that is left at a mission time is flown and its work done, seconds; infinite where it is
    /// closed or cannot be made good against the current.
    #[must_use]
    pub fn arc_done_s(&self, arc: ArcId, departure_s: f64) -> f64 {
        if departure_s.is_infinite() {
            return departure_s;
        }
        let network = &self.mission.network;
        let departure_s = self.leaves_s(arc, departure_s);
        let leg = leg_duration(self.mission, network, &self.arrivals, arc, departure_s);
        leg.map_or(f64::INFINITY, |leg| departure_s + leg.total_s())
    }

    /// When a vehicle at the start of an arc departs that could at a time.
    fn leaves_s(&self, arc: ArcId, time_s: f64) -> f64 {
        let tide = self.tide.as_ref();
        tide.map_or(time_s, |tide| tide.leaves_s(arc, time_s))
    }

    /// When a task of the mission's time model is done that could begin at a mission time, seconds; infinite where
    /// its windows are over.
    #[must_use]
    pub fn timed_done_s(&self, task: usize, arrives_s: f64) -> f64 {
        let (stay_s, done) = agenda::stay(self.mission, &[task], arrives_s, |_| true);
        if done.is_empty() {
            f64::INFINITY
        } else {
            arrives_s + stay_s
        }
    }

    /// When a vehicle on these ways can be at a dock, seconds; infinite where no way leads there.
    #[must_use]
    pub fn home_s(&self, ways: &Earliest) -> f64 {
        let home = ways.first_of(self.mission.all_docks());
        home.map_or(f64::INFINITY, |(_, home_s)| home_s)
    }

    /// The quickest ways from a waypoint that is left at a mission time, work along the arcs included, past none
    /// of the waypoints to avoid.
    #[must_use]
    pub fn earliest_from(&self, start: NodeId, departure_s: f64, avoid: &[NodeId]) -> Earliest {
        let network = &self.mission.network;
        let count = network.num_nodes();
        let mut earliest = Earliest {
            times_s: vec![f64::INFINITY; count],
            via: vec![None; count],
        };
        let mut is_settled = vec![false; count];
        earliest.times_s[start.index()] = departure_s;
        loop {
            let open = (0..count).filter(|&i| !is_settled[i] && earliest.times_s[i].is_finite());
            let next = open.min_by(|&a, &b| earliest.times_s[a].total_cmp(&earliest.times_s[b]));
            let Some(node) = next else {
                return earliest;
            };
            is_settled[node] = true;
            for i in network.range_from(NodeId(node as u32)) {
                let arc = ArcId(i as u32);
                let head = network.arcs()[i].head;
                if avoid.contains(&head) {
                    continue;
                }
                let head = head.index();
                let done_s = self.arc_done_s(arc, earliest.times_s[node]);
                if done_s < earliest.times_s[head] {
                    earliest.times_s[head] = done_s;
                    earliest.via[head] = Some(NodeId(node as u32));
                }
            }
        }
    }
}

/// A route as far as it is timed.
struct RouteAhead<'m> {
    outlook: &'m Outlook<'m>,
    now_s: f64,
    /// How the vehicle leaves the last stop; `None`: in any direction.
    from: Option<UnderWay>,
    /// Edges whose own task is done.
    worked_on: EdgeSet,
    fixes: FixesAhead<'m>,
    stops: Vec<Stop>,
}

impl<'m> RouteAhead<'m> {
    /// Times the first leg of what is left of a route with its fixes and its work; the tasks that are due after it.
    fn add_leg<'d>(
        &mut self,
        route: &[NodeId],
        due: &'d [usize],
    ) -> Result<&'d [usize], NotFlyable> {
        let mission = self.outlook.mission;
        let leg_time = mission.leg_time();
        let nodes @ [_, to] = [route[0], route[1]];
        let ends = nodes.map(|node| mission.position_of(node));
        let arc = mission.network.arc_between(nodes[0], to);
        let mut leg = match arc {
            Some(arc) => self.along(arc, &ends),
            None => LegOutline::straight(&ends, self.now_s),
        };
        leg.from = self.from;
        let edge = arc.map(|arc| mission.network.arcs()[arc.index()].edge);
        let here = agenda::due_at(mission, due, to, edge);
        let under_way_s = leg_time.of(&leg)?.under_way_s();
        let done = self.stops.iter().flat_map(|stop| &stop.timed);
        let done: Vec<usize> = done.map(|done| done.task).collect();
        let stay = |arrive_s| agenda::stay(mission, &here, arrive_s, |task| done.contains(&task));
        let planned = stay(self.now_s + under_way_s);
        let waits_s = planned.0 - works_s(mission, &planned.1);
        let fixes = self.fixes.on_leg(&LegAhead {
            from: ends[0],
            to,
            leaves_s: self.now_s,
            takes_s: under_way_s,
            waits_s,
            work_s: leg.stay_s + planned.0 - waits_s,
            rest: &route[1..],
        });
        let arrive_s = self.now_s + fixes.under_way_s + under_way_s;
        let (stay_s, timed) = stay(arrive_s);
        leg.stay_s += stay_s;
        let fixes_s = fixes.under_way_s + fixes.at_work_s;
        self.now_s += fixes_s;
        self.now_s += leg_time.of(&leg)?.total_s();
        self.from = far_end(mission, to, &timed).or_else(|| leg_time.leaves(&leg));
        self.stops.push(Stop {
            node: to,
            arrive_s,
            leave_s: self.now_s,
            waits_s: stay_s - works_s(mission, &timed),
            timed,
            fixes_s,
        });
        Ok(&due[here.len()..])
    }

    /// The leg along an arc, departing as soon as the current lets the vehicle pass.
    fn along<'a>(&mut self, arc: ArcId, ends: &'a [Point3<f64>; 2]) -> LegOutline<'a>
    where
        'm: 'a,
    {
        let mission = self.outlook.mission;
        let ready_s = self.now_s;
        self.now_s = self.outlook.leaves_s(arc, ready_s);
        if let Some(stop) = self.stops.last_mut() {
            stop.leave_s = self.now_s;
            stop.waits_s += self.now_s - ready_s;
        }
        let edge = mission.network.arcs()[arc.index()].edge;
        let mut leg = outline(mission, &mission.network, arc, self.now_s, ends);
        if self.worked_on.contains(edge) {
            leg.stay_s = 0.0;
        }
        for edge in mission.done_with(edge) {
            self.worked_on.insert(edge);
        }
        leg
    }
}

/// How long tasks of the mission's time model take, seconds.
fn works_s(mission: &Mission, done: &[TaskDone]) -> f64 {
    let of = |model: &TimeModel| {
        let tasks = done.iter().filter_map(|done| model.tasks.get(done.task));
        tasks.map(|task| task.task.completion_time_s).sum()
    };
    mission.time_model.as_deref().map_or(0.0, of)
}

/// How the vehicle goes on after work that ends elsewhere than at its waypoint.
fn far_end(mission: &Mission, node: NodeId, done: &[TaskDone]) -> Option<UnderWay> {
    let manner = mission.manners.get(&done.last()?.task)?;
    let (place, direction) = manner.pattern?.far_end(mission.position_of(node))?;
    Some(UnderWay {
        place,
        velocity: direction * mission.vehicle.speed_mps,
    })
}

impl Earliest {
    /// When a waypoint is reached and the work on the way there done, seconds; infinite where no way leads.
    #[must_use]
    pub fn at_s(&self, node: NodeId) -> f64 {
        self.times_s
            .get(node.index())
            .copied()
            .unwrap_or(f64::INFINITY)
    }

    /// The one of several waypoints that is reached first, and when, seconds.
    pub fn first_of(&self, nodes: impl Iterator<Item = NodeId>) -> Option<(NodeId, f64)> {
        let reached = nodes.map(|node| (node, self.at_s(node)));
        reached.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The waypoints of the way to a waypoint, that one first.
    pub fn way_to(&self, node: NodeId) -> impl Iterator<Item = NodeId> + '_ {
        std::iter::successors(Some(node), |at| self.via.get(at.index()).copied().flatten())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_graph::{Edge, Network, Task};
    use auv_ocean::UniformCurrent;
    use auv_types::Vector3;
    use std::sync::Arc;

    #[test]
    fn a_route_is_timed_leg_by_leg_with_its_work() {
        let fixture = Fixture::new();
        let outlook = Outlook::new(&fixture.mission);
        let route = [0, 1, 2].map(NodeId);
        let stops = outlook.stops(&route, 50.0, &[]).unwrap();
        let arcs = route.windows(2).map(|pair| {
            let network = &fixture.mission.network;
            network.arc_time_s(network.arc_between(pair[0], pair[1]).unwrap(), None)
        });
        let total_s: f64 = arcs.sum();
        assert_eq!((stops[0].arrive_s, stops[1].arrive_s), (50.0, 350.0));
        assert_eq!(stops[1].leave_s, 410.0);
        assert!((stops[2].leave_s - 50.0 - total_s).abs() < 1e-9);
        let earliest = outlook.earliest_from(NodeId(0), 50.0, &[]);
        assert!(earliest.at_s(NodeId(2)) <= stops[2].leave_s);
        assert!(earliest.way_to(NodeId(1)).eq([1, 0].map(NodeId)));
        let round = outlook.earliest_from(NodeId(0), 50.0, &[NodeId(2)]);
        assert!(round.at_s(NodeId(1)) == 410.0 && round.at_s(NodeId(2)).is_infinite());
    }

    #[test]
    fn a_current_too_strong_leaves_no_way() {
        let mut fixture = Fixture::new();
        let flow = UniformCurrent::new(Vector3::x() * 3.5);
        fixture.mission.current = Some(Arc::new(flow));
        let outlook = Outlook::new(&fixture.mission);
        assert!(outlook.stops(&[NodeId(1), NodeId(0)], 0.0, &[]).is_err());
        assert!(
            outlook
                .earliest_from(NodeId(1), 0.0, &[])
                .at_s(NodeId(0))
                .is_infinite()
        );
    }

    #[test]
    fn work_in_time_is_done_within_its_windows_and_the_wait_for_them_told() {
        // With a model the edges carry no tasks of their own.
        let mut mission = Fixture::with_timed_tasks().mission;
        let edges = [(0, 1), (1, 2)].map(|(a, b)| Edge::undirected(a, b, Task::TRANSIT));
        let network = Network::new(mission.network.waypoints(), &edges, 3.0).unwrap();
        mission.network = Arc::new(network);
        let outlook = Outlook::new(&mission);
        // Task 0: 30 s, from 0 to 100 s or 500 to 600 s.
        for (arrives_s, done_s) in [(90.0, 120.0), (200.0, 530.0), (601.0, f64::INFINITY)] {
            assert_eq!(outlook.timed_done_s(0, arrives_s), done_s);
        }
        let stops = outlook.stops(&[0, 1].map(NodeId), 0.0, &[0, 1]).unwrap();
        let at_1 = &stops[1];
        let begun: Vec<_> = at_1.timed.iter().map(|d| (d.task, d.start_s)).collect();
        assert_eq!(
            (at_1.arrive_s, begun),
            (300.0, vec![(0, 500.0), (1, 530.0)])
        );
        assert_eq!((at_1.waits_s, at_1.leave_s), (200.0, 560.0));
    }

    #[test]
    fn an_edge_passed_twice_is_worked_on_once() {
        let fixture = Fixture::new();
        let outlook = Outlook::new(&fixture.mission);
        let stops = outlook.stops(&[0, 1, 0].map(NodeId), 0.0, &[]).unwrap();
        let stays_s: Vec<f64> = stops.iter().map(|s| s.leave_s - s.arrive_s).collect();
        assert_eq!(stays_s, [0.0, 60.0, 0.0]);
        // 900 m at 3 m/s, each way.
        assert_eq!(stops[2].leave_s, 660.0);
    }

    #[test]
    fn a_vehicle_goes_home_to_the_dock_that_it_reaches_first() {
        let mut fixture = Fixture::new();
        let home_s = |fixture: &Fixture| {
            let outlook = Outlook::new(&fixture.mission);
            outlook.home_s(&outlook.earliest_from(NodeId(0), 0.0, &[]))
        };
        assert_eq!(home_s(&fixture), 600.0);
        fixture.mission.docks = vec![NodeId(1)];
        assert_eq!(home_s(&fixture), 360.0);
        fixture.mission.closed = (0..fixture.mission.network.arcs().len() as u32)
            .map(ArcId)
            .collect();
        assert!(home_s(&fixture).is_infinite());
    }
}
