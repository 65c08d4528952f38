//! A mission as GeoJSON.

use super::antimeridian::{Vertex, between, cut};
use super::way::{EXACT_M, thinned, way_of_call};
use super::{ExportError, Place, rounded};
use crate::mission_svg::title;
use crate::places::name_of;
use crate::record::MissionPicture;
use crate::tasks::{Assignment, Where, assignments};
use ::geojson::{Feature, FeatureCollection, Geometry};
use auv_graph::NodeId;
use auv_mission::Mission;
use auv_obstacles::TimedPoint;
use auv_ocean::LocalFrame;
use auv_types::Point3;
use serde_json::{Map, Value, json};

/// What the third coordinate is, in the words of the file.
const VERTICAL: &str = "the third coordinate is the elevation in metres above the sea surface, positive up (minus the \
                        depth); it is not a height above the WGS84 ellipsoid";

/// A mission as a GeoJSON `FeatureCollection` (RFC 7946).
///
/// Coordinates are `[longitude, latitude, elevation]`: elevation in metres above the sea surface,
/// positive up, so minus the depth; properties called `depth_m` are positive down. Each feature has
/// a `kind`:
/// - `track`, one `LineString`: the flown track, to 0.1 m; `times_s` holds the mission time of each
///   of its vertices.
/// - `position`, a `Point` for each of these vertices, where the launch is known ([`MissionPicture::launched_at`]):
///   `datetime` in UTC, by which the temporal controller of QGIS plays them, `time_s`, `depth_m`. `track` and `planned`
///   then have `datetime` and `datetime_end`.
/// - `planned`, a `LineString` for each trajectory that was in force, as far as it was, to 0.1 m: `from_s`, `until_s`.
/// - `waypoint`, a `Point` each: `name`, `depth_m`, `visited`; where tasks belong to it also
///   `task_weight`, `task_time_s` (of all of them) and `task_done` (all of them).
/// - `task`, a `LineString` each: a task along an edge, with the same three properties.
/// - `route`, a `LineString` for each route call, with the detours round land: `call`, `reason`,
///   `at_s`, `valid`, `adopted`, `tasks`, `weight`, `time_s`, `waypoints`.
///
/// A line that crosses the antimeridian is a `MultiLineString`, cut there (RFC 7946, 3.1.9), and `times_s` holds
/// the times of the vertices of all its parts in order.
///
/// Equal missions give equal text.
///
/// # Errors
/// No mission was recorded.
pub fn mission_geojson(
    picture: &MissionPicture,
    frame: &LocalFrame,
) -> Result<String, ExportError> {
    let setting = picture.setting.as_ref();
    let mission = &setting.ok_or(ExportError::NotRecorded)?.mission;
    let tasks = assignments(mission, picture);
    let mut features = vec![track(picture, frame)];
    features.extend(positions(picture, frame));
    let followed = picture.followed();
    features.extend(followed.map(|followed| planned(picture, &followed, frame)));
    let nodes = 0..mission.network.num_nodes() as u32;
    features.extend(nodes.map(|node| waypoint(picture, mission, frame, &tasks, NodeId(node))));
    for task in &tasks {
        if let Where::Along(from, to) = task.place {
            let ends = [from, to].map(|node| mission.position_of(node));
            let mut properties = json!({
                "kind": "task",
                "name": format!("{}-{}", name_of(mission, from), name_of(mission, to)),
            });
            describe(&mut properties, &[*task]);
            features.push(feature(line(&ends, frame), properties));
        }
    }
    features.extend((0..picture.routes.len()).map(|k| route(picture, mission, frame, k)));
    let mut collection = FeatureCollection::new(features);
    let datum = frame.datum();
    collection.foreign_members = object(json!({
        "title": title(picture),
        "datum": { "latitude_deg": datum.latitude_deg, "longitude_deg": datum.longitude_deg },
        "vertical": VERTICAL,
        "notes": picture.notes,
    }));
    Ok(serde_json::to_string(&collection)?)
}

fn position(point: &Point3<f64>, frame: &LocalFrame) -> Vec<f64> {
    let place = Place::of(point, frame);
    vec![place.longitude_deg, place.latitude_deg, place.elevation_m]
}

fn line<'a>(
    points: impl IntoIterator<Item = &'a Point3<f64>>,
    frame: &LocalFrame,
) -> Option<Geometry> {
    let positions: Vec<_> = points.into_iter().map(|p| position(p, frame)).collect();
    geometry(cut(&positions))
}

/// A line, or several where it is cut.
fn geometry(parts: Vec<Vec<Vertex>>) -> Option<Geometry> {
    let mut lines: Vec<Vec<Vec<f64>>> = parts
        .into_iter()
        .map(|part| part.into_iter().map(|vertex| vertex.0).collect())
        .collect();
    match lines.len() {
        0 => None,
        1 => lines.pop().map(Geometry::new_line_string),
        _ => Some(Geometry::new_multi_line_string(lines)),
    }
}

fn object(value: Value) -> Option<Map<String, Value>> {
    match value {
        Value::Object(map) => Some(map),
        _ => None,
    }
}

fn feature(geometry: Option<Geometry>, properties: Value) -> Feature {
    Feature {
        geometry,
        properties: object(properties),
        ..Feature::default()
    }
}

fn track(picture: &MissionPicture, frame: &LocalFrame) -> Feature {
    let kept = thinned(&picture.track, EXACT_M);
    let positions: Vec<_> = kept.iter().map(|p| position(&p.position, frame)).collect();
    let parts = cut(&positions);
    let told_s: Vec<f64> = kept.iter().map(|p| p.time_s).collect();
    let times_s: Vec<f64> = parts
        .iter()
        .flatten()
        .map(|(_, place)| rounded(between(&told_s, *place), 1e3))
        .collect();
    let ending = picture.ending.as_ref();
    let mut properties = json!({
        "kind": "track",
        "name": picture.setting.as_ref().map(|setting| &setting.name),
        "outcome": ending.map(|ending| &ending.outcome),
        "reason": ending.map(|ending| &ending.reason),
        "times_s": times_s,
    });
    date(&mut properties, picture, &kept);
    feature(geometry(parts), properties)
}

/// Adds the first and the last time in UTC, where the launch is known.
fn date(properties: &mut Value, picture: &MissionPicture, line: &[TimedPoint]) {
    for (key, end) in [("datetime", line.first()), ("datetime_end", line.last())] {
        if let Some(utc) = end.and_then(|point| picture.utc(point.time_s)) {
            properties[key] = utc.into();
        }
    }
}

/// Where the vehicle was when, in UTC; none where the launch is not known.
fn positions(picture: &MissionPicture, frame: &LocalFrame) -> Vec<Feature> {
    let kept = thinned(&picture.track, EXACT_M);
    let dated = kept.iter().filter_map(|point| {
        let properties = json!({
            "kind": "position",
            "datetime": picture.utc(point.time_s)?,
            "time_s": rounded(point.time_s, 1e3),
            "depth_m": rounded(point.position.z, 1e3),
        });
        let place = Geometry::new_point(position(&point.position, frame));
        Some(feature(Some(place), properties))
    });
    dated.collect()
}

fn planned(picture: &MissionPicture, followed: &[TimedPoint], frame: &LocalFrame) -> Feature {
    let kept = thinned(followed, EXACT_M);
    let [from_s, until_s] =
        [followed.first(), followed.last()].map(|end| end.map(|point| rounded(point.time_s, 1e3)));
    let mut properties = json!({ "kind": "planned", "from_s": from_s, "until_s": until_s });
    date(&mut properties, picture, followed);
    feature(line(kept.iter().map(|p| &p.position), frame), properties)
}

fn waypoint(
    picture: &MissionPicture,
    mission: &Mission,
    frame: &LocalFrame,
    tasks: &[Assignment],
    node: NodeId,
) -> Feature {
    let place = mission.position_of(node);
    let ending = picture.ending.as_ref();
    let mut properties = json!({
        "kind": "waypoint",
        "name": name_of(mission, node),
        "depth_m": rounded(place.z, 1e3),
        "visited": ending.is_some_and(|ending| ending.visited.contains(&node)),
    });
    let here = tasks.iter().filter(|task| task.place == Where::At(node));
    describe(&mut properties, &here.copied().collect::<Vec<_>>());
    feature(
        Some(Geometry::new_point(position(&place, frame))),
        properties,
    )
}

/// What the tasks of one place add up to; nothing where there are none.
fn describe(properties: &mut Value, tasks: &[Assignment]) {
    if tasks.is_empty() {
        return;
    }
    let weight = tasks.iter().map(|task| task.task.weight());
    let time_s = tasks.iter().map(|task| task.task.completion_time_s);
    properties["task_weight"] = json!(rounded(weight.fold(0.0, |sum, w| sum + w), 1e6));
    properties["task_time_s"] = json!(time_s.fold(0.0, |sum, s| sum + s));
    properties["task_done"] = json!(tasks.iter().all(|task| task.done_s.is_some()));
}

fn route(picture: &MissionPicture, mission: &Mission, frame: &LocalFrame, k: usize) -> Feature {
    let call = &picture.routes[k];
    let names: Vec<_> = call
        .route
        .iter()
        .map(|&node| name_of(mission, node))
        .collect();
    let properties = json!({
        "kind": "route",
        "call": call.call,
        "reason": call.reason.as_str(),
        "at_s": rounded(call.at_s, 1e3),
        "valid": call.valid,
        "adopted": call.adopted,
        "tasks": call.tasks,
        "weight": rounded(call.route_weight, 1e6),
        "time_s": rounded(call.route_s, 1e3),
        "waypoints": names,
    });
    feature(
        line(&way_of_call(picture, mission, call), frame),
        properties,
    )
}

#[cfg(test)]
mod tests {
    use super::super::tests::{back, flown, frame};
    use super::*;
    use ::geojson::{GeoJson, GeometryValue};

    fn read(text: &str) -> FeatureCollection {
        let Ok(GeoJson::FeatureCollection(collection)) = text.parse() else {
            panic!("no collection");
        };
        collection
    }

    fn of_kind<'a>(all: &'a FeatureCollection, kind: &str) -> Vec<&'a Feature> {
        let is = |f: &&Feature| f.property("kind").and_then(Value::as_str) == Some(kind);
        all.features.iter().filter(is).collect()
    }

    #[test]
    fn positions_have_the_time_of_the_calendar_where_the_launch_is_known() {
        let mut picture = flown();
        let undated = read(&mission_geojson(&picture, &frame()).unwrap());
        assert!(of_kind(&undated, "position").is_empty());
        picture.launched_at(1_709_251_200.0);
        let text = mission_geojson(&picture, &frame()).unwrap();
        let dated = read(&text);
        let all = of_kind(&dated, "position");
        let kept = thinned(&picture.track, EXACT_M);
        assert_eq!(all.len(), kept.len());
        for (feature, truth) in all.iter().zip(&kept) {
            assert!((points(feature)[0] - truth.position).norm() < 1e-3);
        }
        let time = |feature: &Feature, key: &str| {
            let text = feature.property(key).and_then(Value::as_str);
            text.unwrap().to_owned()
        };
        assert_eq!(time(all[0], "datetime"), "2024-03-01T00:00:00.000Z");
        let (track, last) = (of_kind(&dated, "track")[0], all[all.len() - 1]);
        assert_eq!(time(track, "datetime_end"), time(last, "datetime"));
    }

    fn points(feature: &Feature) -> Vec<Point3<f64>> {
        let positions = match &feature.geometry.as_ref().unwrap().value {
            GeometryValue::LineString { coordinates } => coordinates.clone(),
            GeometryValue::Point { coordinates } => vec![coordinates.clone()],
            other => panic!("{other:?}"),
        };
        positions.iter().map(|p| back(p[0], p[1], p[2])).collect()
    }

    #[test]
    fn what_is_read_back_is_the_mission_within_a_millimetre() {
        let picture = flown();
        let mission = &picture.setting.as_ref().unwrap().mission;
        let text = mission_geojson(&picture, &frame()).unwrap();
        assert_eq!(text, mission_geojson(&flown(), &frame()).unwrap());
        let all = read(&text);

        let track = of_kind(&all, "track")[0];
        let kept = thinned(&picture.track, EXACT_M);
        let times = track.property("times_s").unwrap().as_array().unwrap();
        assert_eq!(times.len(), kept.len());
        for ((point, time), truth) in points(track).iter().zip(times).zip(&kept) {
            assert!((point - truth.position).norm() < 1e-3);
            assert!((time.as_f64().unwrap() - truth.time_s).abs() < 1e-3);
        }

        let waypoints = of_kind(&all, "waypoint");
        assert_eq!(waypoints.len(), mission.network.num_nodes());
        for (feature, waypoint) in waypoints.iter().zip(mission.network.waypoints()) {
            assert!((points(feature)[0] - waypoint.position).norm() < 1e-3);
            let depth_m = feature.property("depth_m").unwrap().as_f64().unwrap();
            assert!((depth_m - waypoint.position.z).abs() < 1e-3);
        }

        let routes = of_kind(&all, "route");
        assert_eq!(routes.len(), picture.routes.len());
        let first: Vec<_> = picture.routes[0]
            .route
            .iter()
            .map(|&n| mission.position_of(n))
            .collect();
        assert_eq!(points(routes[0]).len(), first.len());
        for (point, truth) in points(routes[0]).iter().zip(&first) {
            assert!((point - truth).norm() < 1e-3);
        }
        let done = of_kind(&all, "task")
            .into_iter()
            .filter(|f| f.property("task_done") == Some(&json!(true)));
        let ending = picture.ending.as_ref().unwrap();
        assert_eq!(done.count(), ending.judged.as_ref().unwrap().tasks);
    }

    #[test]
    fn lines_across_the_antimeridian_are_cut() {
        let datum = auv_ocean::Geodetic {
            latitude_deg: 10.0,
            longitude_deg: -180.0,
            depth_m: 0.0,
        };
        let mut picture = flown();
        let east_m = |p: &Point3<f64>| p.y;
        let middle_m = 0.5
            * (east_m(&picture.track[0].position)
                + east_m(&picture.track[picture.track.len() - 1].position));
        for point in &mut picture.track {
            point.position.y -= middle_m;
        }
        let all = read(&mission_geojson(&picture, &LocalFrame::new(datum).unwrap()).unwrap());
        let mut cuts = 0;
        for feature in &all.features {
            let lines = match feature.geometry.as_ref().map(|g| &g.value) {
                Some(GeometryValue::MultiLineString { coordinates }) => {
                    cuts += 1;
                    coordinates.clone()
                }
                Some(GeometryValue::LineString { coordinates }) => vec![coordinates.clone()],
                _ => continue,
            };
            for line in &lines {
                assert!(
                    line.windows(2)
                        .all(|pair| (pair[0][0] - pair[1][0]).abs() <= 180.0)
                );
            }
            if let Some(times) = feature.property("times_s") {
                let vertices: usize = lines.iter().map(Vec::len).sum();
                assert_eq!(times.as_array().unwrap().len(), vertices);
            }
        }
        assert!(cuts > 0);
    }

    #[test]
    fn what_was_not_recorded_is_not_exported() {
        let nothing = mission_geojson(&MissionPicture::new(), &frame());
        assert!(matches!(nothing, Err(ExportError::NotRecorded)));
    }
}
