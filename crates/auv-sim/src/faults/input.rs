//! Faults on loading: each must be refused with a typed error that names the faulty entry.

use super::{Fault, FaultResponse, Intensity, Trial};
use crate::{Scenario, simulate};
use auv_graph::{Edge, EdgeSet, Network, NodeId, Task, Waypoint};
use auv_mission::driver::Stepped;
use auv_obstacles::truth::{FieldSettings, Obstacle, ObstacleClass, ObstacleField};
use auv_ocean::FlatBed;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed, Vector3, Violations};
use std::collections::BTreeSet;
use std::sync::Arc;

/// The response to broken input, or what went wrong.
type InputResult = Result<FaultResponse, String>;

/// Breaks a mission's input and tries to load it.
pub(super) fn run(fault: Fault, intensity: Intensity, scenario: &Scenario, seed: Seed) -> Trial {
    let mut random = seed.stream(0);
    let result = match fault {
        Fault::EdgeValues => edge_values(intensity, scenario, &mut random),
        Fault::EdgeList => edge_list(intensity, scenario, &mut random),
        Fault::Disconnected => disconnected(intensity, scenario),
        Fault::ShortBudget => short_budget(intensity, scenario),
        Fault::TinyNetwork => tiny_network(intensity, scenario),
        Fault::BuriedPlace => buried_place(intensity, scenario, &mut random),
        #[cfg(feature = "serde")]
        Fault::DamagedFile => damaged_file(intensity, scenario, &mut random),
        _ => Ok(FaultResponse::Refused),
    };
    match result {
        Ok(response) => Trial::loaded(response, Vec::new()),
        Err(failure) => Trial::loaded(FaultResponse::Unchanged, vec![failure]),
    }
}

/// Checks that a result is an error that names all places, unless the list of violations is cut off.
fn refused<T>(result: Result<T, Violations>, places: &BTreeSet<String>) -> InputResult {
    let Err(violations) = result else {
        return Err(format!("{places:?} was accepted"));
    };
    let named = |place: &String| {
        let mut list = violations.list().iter();
        list.any(|v| v.place.starts_with(place.as_str()) || v.message.contains(place.as_str()))
    };
    if violations.total() > Violations::CAPACITY || places.iter().all(named) {
        Ok(FaultResponse::Refused)
    } else {
        Err(format!("{places:?} is not named in: {violations}"))
    }
}

fn refused_mission(scenario: &Scenario, place: &str) -> InputResult {
    refused(
        scenario.validate().into_result(),
        &BTreeSet::from([place.to_owned()]),
    )
}

fn some_edges(intensity: Intensity, edges: usize, random: &mut ChaCha8Rng) -> Vec<usize> {
    let count = intensity.of([1, 3, 10, 50]).min(edges);
    let mut chosen = BTreeSet::new();
    while chosen.len() < count {
        chosen.insert(random.random_range(0..edges));
    }
    chosen.into_iter().collect()
}

fn named(edges: &[usize]) -> BTreeSet<String> {
    edges.iter().map(|i| format!("edges[{i}]")).collect()
}

fn edge_values(intensity: Intensity, scenario: &Scenario, random: &mut ChaCha8Rng) -> InputResult {
    let network = &scenario.mission.network;
    let mut edges = network.edges().to_vec();
    let chosen = some_edges(intensity, edges.len(), random);
    let bad = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -1.0,
        -1e-300,
        1e308,
    ];
    for &i in &chosen {
        let value = bad[random.random_range(0..bad.len())];
        match random.random_range(0..4) {
            0 => edges[i].task.priority = value,
            1 => edges[i].task.risk = value,
            2 => edges[i].task.completion_time_s = value,
            _ => edges[i].distance_m = Some(value),
        }
    }
    let result = Network::new(network.waypoints(), &edges, network.speed_mps());
    refused(result, &named(&chosen))
}

fn edge_list(intensity: Intensity, scenario: &Scenario, random: &mut ChaCha8Rng) -> InputResult {
    let network = &scenario.mission.network;
    let (nodes, mut edges) = (network.num_nodes() as u32, network.edges().to_vec());
    let mut chosen = Vec::new();
    for i in some_edges(intensity, edges.len(), random) {
        match random.random_range(0..3) {
            0 => {
                edges.push(edges[i]);
                chosen.push(edges.len() - 1);
                continue;
            }
            1 => edges[i].to = edges[i].from,
            _ => edges[i].to = nodes + random.random_range(0..1_000_000_000),
        }
        chosen.push(i);
    }
    let result = Network::new(network.waypoints(), &edges, network.speed_mps());
    refused(result, &named(&chosen))
}

/// The scenario with only the edges that `keep` accepts.
fn with_edges(scenario: &Scenario, keep: impl Fn(&Edge) -> bool) -> Result<Scenario, String> {
    let network = &scenario.mission.network;
    let edges: Vec<Edge> = network
        .edges()
        .iter()
        .filter(|e| keep(e))
        .copied()
        .collect();
    let changed = Network::new(network.waypoints(), &edges, network.speed_mps())
        .map_err(|error| error.to_string())?;
    let mut mission = (*scenario.mission).clone();
    mission.network = Arc::new(changed);
    Ok(Scenario {
        mission: Arc::new(mission),
        ..scenario.clone()
    })
}

fn disconnected(intensity: Intensity, scenario: &Scenario) -> InputResult {
    let (start, destination) = (scenario.mission.start.0, scenario.mission.destination.0);
    let ends_at = |edge: &Edge, node: u32| edge.to == node || (!edge.directed && edge.from == node);
    let broken = match intensity.degree() {
        1 => with_edges(scenario, |e| !ends_at(e, destination)),
        2 => with_edges(scenario, |e| {
            e.from != start && (e.directed || e.to != start)
        }),
        3 => with_edges(scenario, |_| false),
        _ => {
            let half = (start + destination) / 2;
            with_edges(scenario, |e| (e.from <= half) == (e.to <= half))
        }
    };
    refused_mission(&broken?, "destination")
}

fn short_budget(intensity: Intensity, scenario: &Scenario) -> InputResult {
    let mut mission = (*scenario.mission).clone();
    let nothing = EdgeSet::empty();
    let home = mission
        .network
        .quickest_to(mission.destination, &nothing, None);
    let quickest_s = home.time_from_s(mission.start);
    mission.reserve_s = 0.0;
    let mut with_budget = |budget_s: f64| {
        mission.budget_s = budget_s;
        Scenario {
            mission: Arc::new(mission.clone()),
            ..scenario.clone()
        }
    };
    if let Err(error) = with_budget(quickest_s).validate().into_result() {
        return Err(format!("exactly enough time was refused: {error}"));
    }
    let too_short = intensity.of([quickest_s.next_down(), quickest_s - 1.0, 0.0, -quickest_s]);
    refused_mission(&with_budget(too_short), "budget_s")?;
    if intensity.degree() == 4 {
        refused_mission(&with_budget(f64::NAN), "budget_s")?;
    }
    Ok(FaultResponse::Refused)
}

/// A network of one or two nodes is flown to its end, an empty one is refused.
fn tiny_network(intensity: Intensity, scenario: &Scenario) -> InputResult {
    let ends = [scenario.mission.start, scenario.mission.destination]
        .map(|node| Waypoint::at(scenario.mission.position_of(node)));
    let edge = [Edge::directed(0, 1, Task::TRANSIT)];
    let (waypoints, edges) = intensity.of([
        (&ends[..], &edge[..]),
        (&ends[..], &edge[..]),
        (&ends[..1], &[]),
        (&[], &[]),
    ]);
    let speed_mps = scenario.mission.network.speed_mps();
    let network = match Network::new(waypoints, edges, speed_mps) {
        Ok(network) => Arc::new(network),
        Err(violations) => return refused::<()>(Err(violations), &BTreeSet::new()),
    };
    let mut mission = (*scenario.mission).clone();
    let last = NodeId(u32::from(intensity.degree() == 2));
    (mission.network, mission.start, mission.destination) = (network, NodeId(0), last);
    let tiny = Scenario {
        mission: Arc::new(mission),
        ..scenario.clone()
    };
    match simulate(&tiny, &Stepped::new(&GreedyRoute, &StraightPath), &mut ()) {
        Ok(_) => Ok(FaultResponse::FellBack),
        Err(violations) => refused::<()>(Err(violations), &BTreeSet::new()),
    }
}

fn buried_place(intensity: Intensity, scenario: &Scenario, random: &mut ChaCha8Rng) -> InputResult {
    let mut broken = scenario.clone();
    let mission = &scenario.mission;
    let network = &mission.network;
    let mut waypoints = network.waypoints().to_vec();
    let chosen = random.random_range(0..waypoints.len());
    let mut changed = (**mission).clone();
    let mut place = format!("waypoints[{chosen}]");
    match intensity.degree() {
        1 => {
            let aside = Vector3::new(random.random_range(-20.0..20.0), 0.0, 0.0);
            let rock = mission.position_of(mission.start) + aside;
            let rock = Obstacle::new(ObstacleClass::Static, rock, 30.0);
            broken.field = ObstacleField::new(vec![rock], FieldSettings::campaign(), Seed(0))
                .map_err(|error| error.to_string())?;
            place = "start".into();
        }
        2 => {
            let bounds = mission.bounds.ok_or("the mission has no box")?;
            waypoints[chosen].position = bounds.high + Vector3::new(1.0, 0.0, 0.0);
        }
        3 => {
            let depth_m = waypoints[chosen].position.z;
            changed.sea_bed = Some(Arc::new(FlatBed::new((depth_m - 1.0).max(0.5))));
            waypoints[chosen].position.z = depth_m.max(1.0);
        }
        _ => {
            changed.sea_bed = Some(Arc::new(FlatBed::new(-1.0)));
            place = format!("waypoints[{}]", mission.destination.0);
        }
    }
    let rebuilt = Network::new(&waypoints, network.edges(), network.speed_mps());
    changed.network = Arc::new(rebuilt.map_err(|error| error.to_string())?);
    broken.mission = Arc::new(changed);
    refused_mission(&broken, &place)
}

#[cfg(feature = "serde")]
fn damaged_file(intensity: Intensity, scenario: &Scenario, random: &mut ChaCha8Rng) -> InputResult {
    use auv_graph::{RouteInstance, format};
    let mission = &scenario.mission;
    let ends = (mission.start, mission.destination);
    let network = (*mission.network).clone();
    let instance = RouteInstance::new("damaged", network, ends, mission.budget_s)
        .map_err(|error| error.to_string())?;
    let text = format::to_json(&instance).map_err(|error| error.to_string())?;
    let mut bytes = text.clone().into_bytes();
    let files: Vec<Vec<u8>> = match intensity.degree() {
        1 => {
            bytes.truncate(random.random_range(0..bytes.len()));
            vec![bytes]
        }
        2 => vec![
            text.replacen("auv-route-1", "auv-route-2", 1).into_bytes(),
            text.replacen("\"start\"", "\"begin\"", 1).into_bytes(),
            text.replacen("\"speed\":", "\"speed\":\"fast\",\"sped\":", 1)
                .into_bytes(),
        ],
        3 => {
            let at = random.random_range(0..bytes.len());
            bytes[at] = 0xFF;
            let text = format!("\u{feff}{text}");
            let utf16: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
            vec![bytes, utf16]
        }
        _ => vec![
            format!("{}{}", "{\"a\":".repeat(10_000), "}".repeat(10_000)).into_bytes(),
            b"NAME : many\nTYPE : OP\nDIMENSION : 1000000000\nCOST_LIMIT : 10\n".to_vec(),
            vec![b' '; format::MAX_FILE_BYTES + 1],
        ],
    };
    for file in files {
        match format::read(&file, "damaged") {
            Ok(_) => return Err("a damaged file was read".into()),
            Err(error) if error.to_string().is_empty() => return Err("no message".into()),
            Err(_) => {}
        }
    }
    Ok(FaultResponse::Refused)
}
