//! Depth over the distance flown.

use super::obstacles::look;
use crate::draw::palette;
use crate::draw::{Axis, Chart, Dash, Mark, Style};
use crate::places::pieces;
use crate::record::{MissionPicture, NearestPose, ObstacleKind};
use auv_mission::Mission;
use auv_obstacles::TimedPoint;

/// Depth over the distance flown, with the sea bed and the obstacles that came near.
pub(super) fn profile(picture: &MissionPicture, mission: &Mission) -> Chart {
    let mut chart = Chart::new(
        "Depth over the distance flown",
        Axis::new("distance flown (km)"),
        Axis::new("depth (m)").reversed().from_zero(),
        190.0,
    );
    let distance_km = distances_km(picture);
    let flown_km = distance_km.last().copied().unwrap_or(0.0);
    chart.x = chart.x.range(0.0, flown_km.max(0.001));
    let floor_m = sea_bed(&mut chart, picture, mission, &distance_km);
    chart.y = chart.y.range(-0.03 * floor_m, floor_m);
    fences(&mut chart, picture, &distance_km, floor_m);
    obstacles(&mut chart, picture, &distance_km);
    track(&mut chart, picture, &distance_km);
    names(&mut chart, picture, mission, &distance_km);
    chart
}

/// The distance flown up to each point of the track, kilometres.
fn distances_km(picture: &MissionPicture) -> Vec<f64> {
    let track = &picture.track;
    let mut flown_m = 0.0;
    let mut distance_km = Vec::with_capacity(track.len());
    for (i, point) in track.iter().enumerate() {
        flown_m += if i > 0 {
            (point.position - track[i - 1].position).norm()
        } else {
            0.0
        };
        distance_km.push(flown_m / 1000.0);
    }
    distance_km
}

/// The bed below the track, and the deepest that the vehicle may go. Returns the depth at which the
/// chart ends, metres.
fn sea_bed(
    chart: &mut Chart,
    picture: &MissionPicture,
    mission: &Mission,
    distance_km: &[f64],
) -> f64 {
    let track = &picture.track;
    let deepest_m = track.iter().map(|p| p.position.z).fold(0.0, f64::max);
    let bed = picture.setting.as_ref().and_then(|s| s.bed.as_ref());
    let Some(bed) = bed else {
        let waypoints = mission.network.waypoints().iter();
        let waypoint_m = waypoints.map(|w| w.position.z).fold(deepest_m, f64::max);
        return 1.15 * waypoint_m + 5.0;
    };
    let depths: Vec<(f64, f64)> = track
        .iter()
        .zip(distance_km)
        .map(|(p, &km)| (km, bed.depth_at(p.position.x, p.position.y)))
        .collect();
    let floor_m = 1.08 * depths.iter().map(|d| d.1).fold(deepest_m, f64::max) + 2.0;
    chart.add(Mark::Band {
        points: depths
            .iter()
            .map(|&(km, depth_m)| (km, depth_m, 2.0 * floor_m))
            .collect(),
        style: Style::line("#7a6a45", 1.2).filled("#cfc3a5", 1.0),
        legend: "sea bed".into(),
    });
    let allowed = track
        .iter()
        .zip(distance_km)
        .map(|(p, &km)| (km, mission.deepest_at(p.position.x, p.position.y)));
    let style = Style::line("#7a6a45", 1.0).dash(Dash::Dashed);
    chart.add(Mark::line(allowed.collect(), style, "deepest allowed"));
    floor_m
}

/// The depths of each `keep_out` while the vehicle is above or below it.
fn fences(chart: &mut Chart, picture: &MissionPicture, distance_km: &[f64], floor_m: f64) {
    let fences = picture.setting.iter().flat_map(|s| &s.fences.keep_out);
    let mut name = "keep out";
    for fence in fences {
        let [from_s, until_s] = fence.holds_s;
        let is_over = |at: &TimedPoint| {
            let holds = (from_s..=until_s).contains(&at.time_s);
            holds && fence.area.distance_m(at.position.x, at.position.y) <= 0.0
        };
        let over: Vec<bool> = picture.track.iter().map(is_over).collect();
        let (upper_m, lower_m) = (
            fence.depth_m[0].max(-floor_m),
            fence.depth_m[1].min(floor_m),
        );
        let mut first = 0;
        for run in over.chunk_by(|a, b| a == b) {
            let (from_km, to_km) = (distance_km[first], distance_km[first + run.len() - 1]);
            first += run.len();
            if run[0] {
                chart.add(Mark::Area {
                    rings: vec![vec![
                        (from_km, upper_m),
                        (to_km, upper_m),
                        (to_km, lower_m),
                        (from_km, lower_m),
                    ]],
                    style: Style::fill(palette::VERMILLION, 0.35),
                    legend: std::mem::take(&mut name).into(),
                });
            }
        }
    }
}

/// The obstacles that came within 100 m, at their closest approaches.
fn obstacles(chart: &mut Chart, picture: &MissionPicture, distance_km: &[f64]) {
    for seen in picture.obstacles.values() {
        let Some(closest) = seen.closest.filter(|c| c.clearance_m < 100.0) else {
            continue;
        };
        let km = index_at(picture, closest.pose.time_s)
            .and_then(|at| distance_km.get(at).copied())
            .unwrap_or(0.0);
        chart.add(Mark::Area {
            rings: vec![outline(seen.kind, &closest, km)],
            style: look(seen.kind).0,
            legend: String::new(),
        });
    }
}

/// The outline of an obstacle in the profile: a rectangle for a ship, else an ellipse.
fn outline(kind: ObstacleKind, closest: &NearestPose, km: f64) -> Vec<(f64, f64)> {
    let (upper_m, lower_m) = closest.pose.depths_m;
    let half_km = closest.pose.radius_m / 1000.0;
    if kind == ObstacleKind::Ship {
        return vec![
            (km - half_km, upper_m),
            (km + half_km, upper_m),
            (km + half_km, lower_m),
            (km - half_km, lower_m),
        ];
    }
    let corner = |k: i32| {
        let (sin, cos) = auv_types::libm::sincos(std::f64::consts::TAU * f64::from(k) / 48.0);
        (
            km + half_km * cos,
            0.5 * (upper_m + lower_m) + 0.5 * (lower_m - upper_m) * sin,
        )
    };
    (0..48).map(corner).collect()
}

/// The vehicle's depth, in the colours of the legs.
fn track(chart: &mut Chart, picture: &MissionPicture, distance_km: &[f64]) {
    let first = chart.marks.len();
    for (colour, range) in pieces(picture) {
        let points = range
            .map(|i| (distance_km[i], picture.track[i].position.z))
            .collect();
        chart.add(Mark::line(points, Style::line(colour, 2.2), ""));
    }
    if let Some(Mark::Line { legend, .. }) = chart.marks.get_mut(first) {
        *legend = "vehicle (a colour a leg); obstacles that came within 100 m".into();
    }
}

/// The names of the waypoints reached.
fn names(chart: &mut Chart, picture: &MissionPicture, mission: &Mission, distance_km: &[f64]) {
    let legs = picture.legs.iter().enumerate();
    for (k, leg) in legs.filter(|(_, leg)| leg.completed) {
        if let Some(at) = index_at(picture, picture.leg_end_s(k)) {
            chart.add(Mark::Label {
                at: (distance_km[at], picture.track[at].position.z),
                text: mission.name_of(leg.to),
                colour: palette::BLACK,
                size: 10.5,
                always: false,
            });
        }
    }
}

/// The first point of the track from a time on, or its last point.
fn index_at(picture: &MissionPicture, time_s: f64) -> Option<usize> {
    let last = picture.track.len().checked_sub(1)?;
    let next = picture.track.partition_point(|p| p.time_s < time_s);
    Some(next.min(last))
}
