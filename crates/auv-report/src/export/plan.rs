//! A route, or the track that was flown, as a mission of QGroundControl.

use super::way::{thinned, way};
use super::{ExportError, Place};
use crate::record::MissionPicture;
use auv_graph::NodeId;
use auv_mission::Mission;
use auv_ocean::LocalFrame;
use auv_types::Point3;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// `MAV_CMD_NAV_WAYPOINT`.
const NAV_WAYPOINT: u16 = 16;
/// `MAV_FRAME_GLOBAL_RELATIVE_ALT`: altitudes above home, positive up.
const FRAME_RELATIVE_ALT: u8 = 3;
/// The ground station's name for the same: relative to home.
const ALTITUDE_RELATIVE: u8 = 1;
/// `MAV_AUTOPILOT_ARDUPILOTMEGA`.
const FIRMWARE: u8 = 3;
/// `MAV_TYPE_SUBMARINE`.
const VEHICLE: u8 = 12;

/// A route of a mission as a QGroundControl plan (`.plan`, JSON, version 1).
///
/// Every waypoint of the route is a `NAV_WAYPOINT` item, and so is every corner of a detour round land.
/// Their altitudes are relative to home, positive up, and home lies on the sea surface over the
/// route's first waypoint. An altitude is so minus the depth, as `ArduSub` expects. The hold time of an
/// item is the duration of its task. The cruise speed is the vehicle's speed through water.
///
/// The plan holds only the route: it avoids no obstacle and drops no task when time runs short.
///
/// # Errors
/// The route is empty or names a node that the network does not have.
pub fn route_plan(
    mission: &Mission,
    frame: &LocalFrame,
    route: &[NodeId],
) -> Result<String, ExportError> {
    let unknown = route.iter().find(|&&node| !mission.network.has_node(node));
    if let Some(node) = unknown {
        return Err(ExportError::UnknownNode(node.0));
    }
    let holds_s = holds_s(mission, route);
    let mut visits = 0;
    let mut items = Vec::new();
    for (point, node) in way(mission, route, None) {
        let hold_s = if node.is_some() { holds_s[visits] } else { 0.0 };
        visits += usize::from(node.is_some());
        items.push(item(items.len() + 1, &point, hold_s, frame));
    }
    let home = mission.position_of(route.first().copied().unwrap_or(mission.start));
    document(mission, frame, &home, &items)
}

/// Deviations of the track below this are left out, metres.
const STRAIGHT_M: f64 = 2.0;

/// The flown track as a QGroundControl plan, to repeat it or to lay it over a chart. Its bends are
/// `NAV_WAYPOINT` items; points within 2 m of the straight line are left out. Where the vehicle
/// hovered, the item has that hold time. Altitudes and home are those of [`route_plan`].
///
/// # Errors
/// No mission was recorded.
pub fn track_plan(picture: &MissionPicture, frame: &LocalFrame) -> Result<String, ExportError> {
    let setting = picture.setting.as_ref();
    let mission = &setting.ok_or(ExportError::NotRecorded)?.mission;
    let mut stops: Vec<(Point3<f64>, f64)> = Vec::new();
    let mut before_s = 0.0;
    for point in thinned(&picture.track, STRAIGHT_M) {
        match stops.last_mut() {
            Some((place, hold_s)) if *place == point.position => {
                *hold_s += point.time_s - before_s;
            }
            _ => stops.push((point.position, 0.0)),
        }
        before_s = point.time_s;
    }
    let items: Vec<Value> = stops
        .iter()
        .enumerate()
        .map(|(k, (place, hold_s))| item(k + 1, place, *hold_s, frame))
        .collect();
    let home = stops.first().map(|(place, _)| *place);
    let home = home.unwrap_or_else(|| mission.position_of(mission.start));
    document(mission, frame, &home, &items)
}

/// A plan of these items; home lies on the sea surface over a place.
fn document(
    mission: &Mission,
    frame: &LocalFrame,
    home: &Point3<f64>,
    items: &[Value],
) -> Result<String, ExportError> {
    let home = Place::of(home, frame);
    let speed_mps = mission.vehicle.speed_mps;
    let plan = json!({
        "fileType": "Plan",
        "version": 1,
        "groundStation": "QGroundControl",
        "mission": {
            "version": 2,
            "firmwareType": FIRMWARE,
            "vehicleType": VEHICLE,
            "globalPlanAltitudeMode": ALTITUDE_RELATIVE,
            "cruiseSpeed": speed_mps,
            "hoverSpeed": speed_mps,
            "plannedHomePosition": [home.latitude_deg, home.longitude_deg, 0],
            "items": items,
        },
        "geoFence": { "version": 2, "circles": [], "polygons": [] },
        "rallyPoints": { "version": 2, "points": [] },
    });
    Ok(serde_json::to_string_pretty(&plan)? + "\n")
}

/// The time of the task done at each node of a route, seconds; a task is done once.
fn holds_s(mission: &Mission, route: &[NodeId]) -> Vec<f64> {
    let network = &mission.network;
    let mut done = BTreeSet::new();
    let mut holds_s = vec![0.0; route.len()];
    for (k, pair) in route.windows(2).enumerate() {
        let Some(arc) = network.arc_between(pair[0], pair[1]) else {
            continue;
        };
        let edge = network.arcs()[arc.index()].edge;
        if done.insert(edge) {
            holds_s[k + 1] = network.task(edge).completion_time_s;
        }
        let groups = mission.shared_tasks.iter();
        done.extend(groups.filter(|group| group.contains(&edge)).flatten());
    }
    holds_s
}

fn item(number: usize, point: &Point3<f64>, hold_s: f64, frame: &LocalFrame) -> Value {
    let place = Place::of(point, frame);
    json!({
        "type": "SimpleItem",
        "autoContinue": true,
        "command": NAV_WAYPOINT,
        "doJumpId": number,
        "frame": FRAME_RELATIVE_ALT,
        // Hold, acceptance radius and pass radius (the autopilot's own), heading (free), place.
        "params": [hold_s, 0, 0, null, place.latitude_deg, place.longitude_deg, place.elevation_m],
        "Altitude": place.elevation_m,
        "AltitudeMode": ALTITUDE_RELATIVE,
        "AMSLAltAboveTerrain": null,
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{back, flown, frame};
    use super::*;

    #[test]
    fn the_items_are_the_route_with_depth_as_negative_altitude() {
        let picture = flown();
        let mission = &picture.setting.as_ref().unwrap().mission;
        let route = &picture.routes[0].route;
        let text = route_plan(mission, &frame(), route).unwrap();
        let plan: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(plan["mission"]["plannedHomePosition"][2], 0);
        let items = plan["mission"]["items"].as_array().unwrap();
        assert_eq!(items.len(), route.len());
        let mut held_s = 0.0;
        for (item, node) in items.iter().zip(route) {
            let number = |k: usize| item["params"][k].as_f64().unwrap();
            let truth = mission.position_of(*node);
            assert!((back(number(5), number(4), number(6)) - truth).norm() < 1e-3);
            assert!((number(6) + truth.z).abs() < 1e-3);
            assert_eq!(item["Altitude"], item["params"][6]);
            assert_eq!(
                (&item["frame"], &item["AltitudeMode"]),
                (&json!(3), &json!(1))
            );
            held_s += number(0);
        }
        assert!(held_s > 0.0);
    }

    #[test]
    fn a_node_of_no_network_is_named() {
        let picture = flown();
        let mission = &picture.setting.as_ref().unwrap().mission;
        let wrong = route_plan(mission, &frame(), &[NodeId(999)]);
        assert!(matches!(wrong, Err(ExportError::UnknownNode(999))));
    }

    #[test]
    fn the_track_is_flown_again_within_two_metres() {
        let picture = flown();
        let text = track_plan(&picture, &frame()).unwrap();
        let plan: Value = serde_json::from_str(&text).unwrap();
        let items = plan["mission"]["items"].as_array().unwrap();
        let number = |item: &Value, k: usize| item["params"][k].as_f64().unwrap();
        let places: Vec<Point3<f64>> = items
            .iter()
            .map(|item| back(number(item, 5), number(item, 4), number(item, 6)))
            .collect();
        let off_m = |point: &Point3<f64>, pair: &[Point3<f64>]| {
            let way = pair[1] - pair[0];
            let share = (point - pair[0]).dot(&way) / way.norm_squared().max(1e-12);
            (point - (pair[0] + way * share.clamp(0.0, 1.0))).norm()
        };
        for point in &picture.track {
            let nearest_m = places
                .windows(2)
                .map(|pair| off_m(&point.position, pair))
                .fold(f64::INFINITY, f64::min);
            assert!(nearest_m <= STRAIGHT_M + 0.01, "{nearest_m}");
        }
        assert!(items.len() < picture.track.len());
        let still = |pair: &&[auv_obstacles::TimedPoint]| pair[0].position == pair[1].position;
        let hovered = picture.track.windows(2).filter(still);
        let hovered_s: f64 = hovered.map(|pair| pair[1].time_s - pair[0].time_s).sum();
        let held_s: f64 = items.iter().map(|item| number(item, 0)).sum();
        assert!(
            hovered_s > 0.0 && (held_s - hovered_s).abs() < 0.05 * hovered_s,
            "{held_s} {hovered_s}"
        );
    }
}
