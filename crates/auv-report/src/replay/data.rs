//! The data of the page: what its scripts read as `MISSION`.

use super::json::{array, list, number, rows, text};
use super::obstacles::{obstacles, predictions};
use crate::mission_svg;
use crate::places::{extent, name_of, short_name, water};
use crate::record::{MissionPicture, Prediction};
use crate::tasks::assignments;
use crate::thin::thinned;
use auv_graph::NodeId;
use auv_mission::Mission;
use auv_ocean::SeaBed;
use auv_sim::{Fence, Fences};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The fields of a JSON object, in the order in which they are written.
struct Fields {
    out: String,
}

impl Fields {
    fn write(&mut self, name: &str, value: impl AsRef<str>) {
        let comma = if self.out.len() > 1 { "," } else { "" };
        let _ = write!(self.out, "{comma}\"{name}\":{}", value.as_ref());
    }
}

/// The part of the sea that the page shows, metres.
#[derive(Clone, Copy)]
struct Map {
    east: (f64, f64),
    north: (f64, f64),
    /// The size of a pixel: details below it are left out.
    pixel_m: f64,
}

impl Map {
    fn of(picture: &MissionPicture, mission: &Mission) -> Self {
        let (mut east, mut north) = extent(picture, mission);
        if let Some(bounds) = &mission.bounds {
            widen(
                &mut east,
                0.75 * (north.1 - north.0),
                (bounds.low.y, bounds.high.y),
            );
            widen(
                &mut north,
                0.75 * (east.1 - east.0),
                (bounds.low.x, bounds.high.x),
            );
        }
        // A pixel is about a thousandth of the map.
        let pixel_m = 1e-3 * (east.1 - east.0).max(north.1 - north.0);
        Self {
            east,
            north,
            pixel_m,
        }
    }

    /// Whether a prediction lies on the map or near it, now or at the horizon.
    fn shows(&self, prediction: &Prediction) -> bool {
        let room_m = 200.0 * self.pixel_m;
        [prediction.now, prediction.later].iter().any(|pose| {
            let (centre, reach_m) = (pose.centre, pose.radius_m + room_m);
            centre.y > self.east.0 - reach_m
                && centre.y < self.east.1 + reach_m
                && centre.x > self.north.0 - reach_m
                && centre.x < self.north.1 + reach_m
        })
    }
}

/// Widens a range to a width, on both sides, where the mission's box allows it.
fn widen(range: &mut (f64, f64), width_m: f64, allowed: (f64, f64)) {
    let room_m = 0.5 * (width_m - (range.1 - range.0)).max(0.0);
    range.0 = range.0.min(allowed.0.max(range.0 - room_m));
    range.1 = range.1.max(allowed.1.min(range.1 + room_m));
}

/// The page's data as JSON.
pub(super) fn data(picture: &MissionPicture) -> String {
    let Some(setting) = &picture.setting else {
        return NOT_RECORDED.into();
    };
    let mission = &setting.mission;
    let map = Map::of(picture, mission);
    let mut fields = Fields { out: "{".into() };
    fields.write("title", text(&mission_svg::title(picture)));
    fields.write("subtitle", text(&mission_svg::subtitle(picture)));
    fields.write("notes", text(&picture.notes.join(" ")));
    let launch_s = picture.launch_unix_s;
    fields.write("launch", launch_s.map_or("null".into(), |s| s.to_string()));
    fields.write("budget", number(mission.budget_s));
    fields.write("reserve", number(mission.reserve_s));
    fields.write("sonar", number(picture.sonar_m()));
    fields.write("start", mission.start.0.to_string());
    fields.write("dest", mission.destination.0.to_string());
    let (east, north) = (map.east, map.north);
    fields.write("box", array(&[east.0, east.1, north.0, north.1]));
    if let Some(water) = water(picture, east, north) {
        fields.write("current", format!("[{:.4},{:.4}]", water.0, water.1));
    }
    fields.write("fences", fences(&setting.fences));
    network(&mut fields, mission);
    decisions(&mut fields, picture, mission);
    fields.write("obstacles", obstacles(picture, 0.5 * map.pixel_m));
    let predicted = picture.predicted.values();
    let predicted = predicted.map(|series| predictions(series, map.pixel_m, |p| map.shows(p)));
    fields.write("predicted", list(predicted));
    let clearances: Vec<_> = picture
        .clearances
        .iter()
        .map(|&(time_s, clearance_m)| [time_s, clearance_m.min(500.0)])
        .collect();
    fields.write("clear", rows(&thinned(&clearances, 1.0)));
    if let Some(bed) = &setting.bed {
        sea_bed(&mut fields, picture, &map, bed.as_ref());
    }
    fields.out.push('}');
    fields.out
}

const NOT_RECORDED: &str = "{\"title\":\"No mission was recorded\",\"subtitle\":\"\",\"notes\":\"\",\"track\":[],\"nodes\":[],\"edges\":[],\
    \"legs\":[],\"tasks\":[],\"routes\":[],\"follows\":[],\"obstacles\":[],\"predicted\":[],\"clear\":[],\"box\":[0,1,0,1],\"sonar\":0,\"launch\":null,\"budget\":1,\"reserve\":0,\"start\":-1,\"dest\":-1}";

/// The areas to keep out of and to stay in: kind, name, depths and times, and corners.
fn fences(fences: &Fences) -> String {
    let of = |kind: &str, fence: &Fence| {
        let corners = fence.outline().iter();
        let ring = corners.map(|&[north_m, east_m]| array(&[east_m, north_m]));
        let [top_m, bottom_m] = fence.depth_m;
        format!(
            "{{\"kind\":{},\"name\":{},\"span\":{},\"holds\":{},\"p\":{}}}",
            text(kind),
            text(short_name(&fence.name)),
            array(&[top_m.max(0.0), bottom_m]),
            array(&fence.holds_s.map(|at_s| at_s.clamp(-1e9, 1e9))),
            list(ring)
        )
    };
    let out = fences.keep_out.iter().map(|fence| of("keep out", fence));
    let within = fences.keep_in.iter().map(|fence| of("keep in", fence));
    list(out.chain(within))
}

fn network(fields: &mut Fields, mission: &Mission) {
    let waypoints = mission.network.waypoints().iter().enumerate();
    let nodes = waypoints.map(|(i, waypoint)| {
        let (place, name) = (waypoint.position, mission.name_of(NodeId(i as u32)));
        format!(
            "[{},{},{},{}]",
            number(place.y),
            number(place.x),
            number(place.z),
            text(&name)
        )
    });
    fields.write("nodes", list(nodes));
    let arcs = mission.network.arcs().iter();
    let edges: BTreeSet<_> = arcs
        .map(|arc| (arc.tail.0.min(arc.head.0), arc.tail.0.max(arc.head.0)))
        .collect();
    let edges = edges.iter().map(|(a, b)| format!("[{a},{b}]"));
    fields.write("edges", list(edges));
}

/// The track, the legs, the tasks done, the routes, and the trajectories that were in force.
fn decisions(fields: &mut Fields, picture: &MissionPicture, mission: &Mission) {
    let track = picture.track.iter();
    let track: Vec<_> = track
        .map(|p| [p.time_s, p.position.y, p.position.x, p.position.z])
        .collect();
    fields.write("track", rows(&thinned(&track, 0.3)));
    fields.write(
        "legs",
        list((0..picture.legs.len()).map(|k| leg(picture, k))),
    );
    let tasks = assignments(mission, picture);
    let done = tasks.iter().filter_map(|task| {
        let at_s = task.done_s?;
        Some(array(&[at_s, task.task.weight()]))
    });
    fields.write("tasks", list(done));
    let end_s = picture.track.last().map_or(0.0, |p| p.time_s);
    fields.write(
        "routes",
        list((0..picture.routes.len()).map(|k| route(picture, k, end_s))),
    );
    let follows = picture.follows.iter().map(|(at_s, trajectory)| {
        let points = trajectory.points();
        let stride = points.len().div_ceil(60).max(1);
        let kept = points.iter().step_by(stride).chain(points.last());
        let kept = kept
            .map(|p| [p.position.y, p.position.x, p.position.z])
            .map(|p| array(&p.map(f64::round)));
        format!("{{\"at\":{},\"p\":{}}}", number(*at_s), list(kept))
    });
    fields.write("follows", list(follows));
}

/// The depth of the bed below the track, and on a grid over the map.
fn sea_bed(fields: &mut Fields, picture: &MissionPicture, map: &Map, bed: &dyn SeaBed) {
    let stride = picture.track.len().div_ceil(600).max(1);
    let floor = picture.track.iter().step_by(stride);
    let floor = floor.map(|p| array(&[p.time_s, bed.depth_at(p.position.x, p.position.y)]));
    fields.write("floor", list(floor));
    let n = 121_usize;
    let depths: Vec<f64> = (0..n * n)
        .map(|k| {
            let share = |i: usize| i as f64 / (n - 1) as f64;
            let east_m = map.east.0 + share(k % n) * (map.east.1 - map.east.0);
            let north_m = map.north.0 + share(k / n) * (map.north.1 - map.north.0);
            bed.depth_at(north_m, east_m)
        })
        .collect();
    let deepest = depths.iter().copied().fold(1.0, f64::max);
    fields.write(
        "bed",
        format!(
            "{{\"n\":{n},\"max\":{},\"v\":{}}}",
            number(deepest),
            array(&depths)
        ),
    );
}

fn leg(picture: &MissionPicture, k: usize) -> String {
    let leg = &picture.legs[k];
    let mission = picture.setting.as_ref().map(|s| &s.mission);
    let name = mission.map_or(String::new(), |m| {
        format!("{}→{}", name_of(m, leg.from), name_of(m, leg.to))
    });
    format!(
        "{{\"at\":{},\"end\":{},\"from\":{},\"to\":{},\"name\":{},\"expected\":{},\"took\":{},\"waited\":{},\"late\":{},\"done\":{}}}",
        number(leg.at_s),
        number(picture.leg_end_s(k)),
        leg.from.0,
        leg.to.0,
        text(&name),
        number(leg.expected_s),
        number(leg.leg_s),
        number(leg.waited_s),
        leg.replan,
        leg.completed
    )
}

fn route(picture: &MissionPicture, k: usize, end_s: f64) -> String {
    let call = &picture.routes[k];
    let mission = picture.setting.as_ref().map(|s| &s.mission);
    let names = call
        .route
        .iter()
        .map(|&node| mission.map_or(String::new(), |m| name_of(m, node)));
    let until_s = picture.routes.get(k + 1).map_or(end_s, |next| next.at_s);
    format!(
        "{{\"call\":{},\"at\":{},\"until\":{},\"reason\":{},\"adopted\":{},\"time\":{},\"weight\":{},\"names\":{},\"route\":{}}}",
        call.call,
        number(call.at_s),
        number(until_s),
        text(call.reason.as_str()),
        call.adopted,
        number(call.route_s),
        number(call.mission_weight),
        text(&names.collect::<Vec<_>>().join(" → ")),
        list(call.route.iter().map(|node| node.0.to_string()))
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_map_is_widened_within_the_box_only() {
        let mut range = (0.0, 10.0);
        widen(&mut range, 30.0, (-4.0, 100.0));
        assert_eq!(range, (-4.0, 20.0));
        widen(&mut range, 5.0, (0.0, 1.0));
        assert_eq!(range, (-4.0, 20.0));
    }
}
