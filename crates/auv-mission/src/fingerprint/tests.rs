use super::*;
use crate::fixture::{Fixture, place};
use crate::{Battery, Emergency, EmergencyCause, Manner, Navigation, Pattern, Surfacing};
use auv_graph::{ArcId, EdgeId, Network, NodeId, TimeModel};
use auv_ocean::{FlatBed, UniformCurrent};
use auv_planning::Arrival;
use auv_types::{Bounds, Vector3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A mission with a value for everything that may be left out.
fn whole() -> Mission {
    let mut mission = Fixture::with_timed_tasks().mission;
    mission.docks = vec![NodeId(1)];
    mission.battery = Some(Battery {
        usable_j: 1e6,
        hotel_w: 10.0,
        propulsion_j_per_m: 20.0,
    });
    mission.navigation = Some(Navigation {
        most_error_m: Some(9.0),
        ..Navigation::default()
    });
    mission.surfacing = Some(Surfacing::every(900.0));
    mission.fix_places = vec![NodeId(1)];
    mission.docking.tries = 2;
    mission.docking.heading_deg = Some(10.0);
    mission.docking.lead_in_m = 30.0;
    let corners = [[-1e3, -1e3, 0.0], [3e3, 1e3, 50.0]].map(Point3::from);
    mission.bounds = Some(Bounds::new(corners[0], corners[1]));
    mission.sea_bed = Some(Arc::new(FlatBed::new(60.0)));
    mission.current = Some(Arc::new(UniformCurrent::new(Vector3::x() * 0.1)));
    mission.courses.lines.insert(ArcId(0));
    mission.courses.speeds_mps.insert(ArcId(1), 1.0);
    let arrival = Arrival {
        direction: Vector3::x(),
        lead_m: 20.0,
    };
    mission.courses.arrivals.insert(NodeId(1), arrival);
    mission
        .guides
        .insert(ArcId(0), vec![place(0.0), place(900.0)]);
    mission.closed.insert(ArcId(3));
    mission.shared_tasks = vec![vec![EdgeId(0), EdgeId(1)]];
    mission.manners = BTreeMap::from([(0, Manner::default())]);
    mission.emergencies = vec![Emergency {
        when: EmergencyCause::Leak,
        within: Some(vec![[0.0, 0.0], [0.0, 9.0], [9.0, 9.0]]),
        ladder: vec![Contingency::ReturnAlongTrack],
    }];
    mission
}

fn model(mission: &mut Mission, change: impl FnOnce(&mut TimeModel)) {
    change(Arc::make_mut(mission.time_model.as_mut().unwrap()));
}

/// Another network of the same size.
fn network(
    mission: &mut Mission,
    change: impl FnOnce(&mut Vec<auv_graph::Waypoint>, &mut Vec<auv_graph::Edge>),
) {
    let old = &mission.network;
    let (mut waypoints, mut edges) = (old.waypoints().to_vec(), old.edges().to_vec());
    change(&mut waypoints, &mut edges);
    mission.network = Arc::new(Network::new(&waypoints, &edges, old.speed_mps()).unwrap());
}

type Change = fn(&mut Mission);

/// One change of each value.
const NETWORK: [(&str, Change); 12] = [
    ("a waypoint", |m| {
        network(m, |waypoints, _| waypoints[1].position.y += 1.0)
    }),
    ("an edge's ends", |m| {
        network(m, |_, edges| {
            edges[2] = auv_graph::Edge {
                from: 2,
                to: 0,
                ..edges[2]
            };
        });
    }),
    ("an edge's direction", |m| {
        network(m, |_, edges| edges[2].directed = true)
    }),
    ("an edge's priority", |m| {
        network(m, |_, edges| edges[0].task.priority += 1.0)
    }),
    ("an edge's length", |m| {
        network(m, |_, edges| edges[0].distance_m = Some(2e3))
    }),
    ("a task's risk", |m| {
        model(m, |model| model.tasks[0].task.risk += 1.0)
    }),
    ("a task's duty", |m| {
        model(m, |model| model.tasks[0].mandatory ^= true)
    }),
    ("a task's window", |m| {
        model(m, |model| model.tasks[0].windows[0][1] += 1.0)
    }),
    ("a task's order", |m| {
        model(m, |model| model.tasks[2].after = vec![1])
    }),
    ("a task's waypoint", |m| {
        model(m, |model| model.tasks[0].place = TaskPlace::Node(NodeId(2)))
    }),
    ("a task's edge", |m| {
        model(m, |model| model.tasks[2].place = TaskPlace::Edge(EdgeId(0)))
    }),
    ("a number of a waypoint for that of an edge", |m| {
        model(m, |model| model.tasks[1].place = TaskPlace::Edge(EdgeId(1)));
    }),
];

const LIMITS: [(&str, Change); 30] = [
    ("start", |m| m.start = NodeId(1)),
    ("destination", |m| m.destination = NodeId(1)),
    ("docks", |m| m.docks = vec![NodeId(0)]),
    ("closed", |m| m.closed = [ArcId(2)].into()),
    ("budget_s", |m| m.budget_s += 1.0),
    ("reserve_s", |m| m.reserve_s += 1.0),
    ("min_altitude_m", |m| m.min_altitude_m += 1.0),
    ("altitude_sigmas", |m| m.altitude_sigmas += 1.0),
    ("clearance_m", |m| m.clearance_m += 1.0),
    ("speed", |m| m.vehicle.speed_mps += 0.1),
    ("turn radius", |m| m.vehicle.turn_radius_m += 1.0),
    ("pitch", |m| m.vehicle.max_pitch_rad -= 0.1),
    ("battery", |m| m.battery = None),
    ("hotel load", |m| m.battery.as_mut().unwrap().hotel_w += 1.0),
    ("drift", |m| {
        m.navigation.as_mut().unwrap().drift_percent += 0.1
    }),
    ("compass", |m| {
        m.navigation.as_mut().unwrap().compass_deg += 0.1
    }),
    ("time of a fix", |m| {
        m.navigation.as_mut().unwrap().fix_at_surface_s += 1.0
    }),
    ("greatest error", |m| {
        m.navigation.as_mut().unwrap().most_error_m = None
    }),
    ("docking tolerance", |m| m.docking.tolerance_m += 1.0),
    ("docking course", |m| m.docking.heading_deg = Some(20.0)),
    ("docking from anywhere", |m| m.docking.heading_deg = None),
    ("docking lead-in", |m| m.docking.lead_in_m += 1.0),
    ("tries to dock", |m| m.docking.tries += 1),
    ("time between fixes", |m| {
        m.surfacing.as_mut().unwrap().every_s += 1.0
    }),
    ("time at the surface", |m| {
        m.surfacing.as_mut().unwrap().at_most_s += 1.0
    }),
    ("places for fixes", |m| m.fix_places = vec![NodeId(2)]),
    ("box", |m| m.bounds.as_mut().unwrap().high.z += 1.0),
    ("open water", |m| m.open_water ^= true),
    ("bed", |m| m.sea_bed = Some(Arc::new(FlatBed::new(61.0)))),
    ("current", |m| m.current = None),
];

const CHOICES: [(&str, Change); 16] = [
    ("lines", |m| m.courses.lines = [ArcId(2)].into()),
    ("speed along an arc", |m| {
        *m.courses.speeds_mps.get_mut(&ArcId(1)).unwrap() += 0.1
    }),
    ("direction of arrival", |m| {
        m.courses.arrivals.get_mut(&NodeId(1)).unwrap().direction = Vector3::y();
    }),
    ("lead of an arrival", |m| {
        m.courses.arrivals.get_mut(&NodeId(1)).unwrap().lead_m += 1.0
    }),
    ("a guide", |m| {
        m.guides.get_mut(&ArcId(0)).unwrap().insert(1, place(300.0))
    }),
    ("the arc of a guide", |m| {
        let guide = m.guides.remove(&ArcId(0)).unwrap();
        m.guides.insert(ArcId(2), guide);
    }),
    ("shared tasks", |m| m.shared_tasks.clear()),
    ("the ladder", |m| m.contingencies.reverse()),
    ("the length of a loiter", |m| {
        m.contingencies = vec![Contingency::Surface, Contingency::Loiter { for_s: 60.0 }]
    }),
    ("the cause of an emergency", |m| {
        m.emergencies[0].when = EmergencyCause::ShutIn
    }),
    ("the area of an emergency", |m| {
        m.emergencies[0].within = None
    }),
    ("the ladder of an emergency", |m| {
        m.emergencies[0].ladder.push(Contingency::Surface)
    }),
    ("no manner", |m| m.manners.clear()),
    ("the speed of a task", |m| {
        m.manners.get_mut(&0).unwrap().speed_mps = Some(1.0)
    }),
    ("the depth of a task", |m| {
        m.manners.get_mut(&0).unwrap().depth_m = Some(30.0)
    }),
    ("the pattern of a task", |m| {
        let (radius_m, turns) = (50.0, 1.0);
        m.manners.get_mut(&0).unwrap().pattern = Some(Pattern::Circle { radius_m, turns });
    }),
];

#[test]
fn missions_that_differ_in_one_value_have_different_hashes() {
    let changes = [&NETWORK[..], &LIMITS, &CHOICES].concat();
    let mut seen = BTreeMap::from([(of(&whole()), "nothing")]);
    for (name, change) in changes {
        let mut mission = whole();
        change(&mut mission);
        let before = seen.insert(of(&mission), name);
        assert_eq!(before, None, "{name}");
    }
    assert_eq!(of(&whole()), of(&whole().clone()));
}

#[test]
fn patterns_that_differ_in_one_value_have_different_hashes() {
    let (top_m, bottom_m) = (10.0, 20.0);
    let yoyo = |length_m, heading_deg| Pattern::Yoyo {
        top_m,
        bottom_m,
        length_m,
        heading_deg,
    };
    let circle = |radius_m, turns| Pattern::Circle { radius_m, turns };
    let profile = |from_m, to_m| Pattern::Profile { from_m, to_m };
    let patterns = [
        yoyo(100.0, 0.0),
        yoyo(101.0, 0.0),
        yoyo(100.0, 1.0),
        circle(top_m, bottom_m),
        circle(bottom_m, top_m),
        profile(top_m, bottom_m),
        profile(bottom_m, top_m),
    ];
    let hashes = patterns.map(|pattern| {
        let mut mission = whole();
        mission.manners.get_mut(&0).unwrap().pattern = Some(pattern);
        of(&mission)
    });
    for (i, hash) in hashes.iter().enumerate() {
        assert!(!hashes[..i].contains(hash), "{:?}", patterns[i]);
    }
}

/// Without the lengths of its lists, each of these pairs is written as one row of equal bytes.
#[test]
fn missions_whose_lists_join_to_one_have_different_hashes() {
    let of_changed = |change: &dyn Fn(&mut Mission)| {
        let mut mission = whole();
        change(&mut mission);
        of(&mission)
    };
    // All of them 2: the arcs, the start, the destination and the docks.
    let closed = |arcs: &'static [u32]| {
        move |m: &mut Mission| {
            m.closed = arcs.iter().map(|&arc| ArcId(arc)).collect();
            (m.start, m.destination) = (NodeId(2), NodeId(2));
            m.docks = vec![NodeId(2); 3 - arcs.len()];
        }
    };
    assert_ne!(
        of_changed(&closed(&[2])),
        of_changed(&closed(&[])),
        "closed arcs, docks"
    );
    let windows = |in_window: bool| {
        move |m: &mut Mission| {
            model(m, |model| {
                let task = &mut model.tasks[2];
                // One window of the bytes of 1 and 2, or the tasks 1 and 2 before it.
                let (from, to) = (f64::from_bits(1), f64::from_bits(2));
                task.windows = if in_window {
                    vec![[from, to]]
                } else {
                    Vec::new()
                };
                task.after = if in_window { Vec::new() } else { vec![1, 2] };
            });
        }
    };
    assert_ne!(
        of_changed(&windows(true)),
        of_changed(&windows(false)),
        "windows"
    );
}
