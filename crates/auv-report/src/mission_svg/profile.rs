//! Depth over the distance flown.

use super::obstacles::look;
use super::pieces;
use crate::draw::palette;
use crate::draw::{Axis, Chart, Dash, Mark, Style};
use crate::record::{Kind, MissionPicture};
use auv_mission::Mission;

/// Depth over the distance flown, with the sea bed and the obstacles that came near.
pub(super) fn profile(picture: &MissionPicture, mission: &Mission) -> Chart {
    let mut chart = Chart::new(
        "Depth over the distance flown",
        Axis::new("distance flown (km)"),
        Axis::new("depth (m)").reversed().from_zero(),
        190.0,
    );
    let track = &picture.track;
    let mut distance_km = Vec::with_capacity(track.len());
    let mut flown_m = 0.0;
    for (i, point) in track.iter().enumerate() {
        flown_m += if i > 0 {
            (point.position - track[i - 1].position).norm()
        } else {
            0.0
        };
        distance_km.push(flown_m / 1000.0);
    }
    chart.x = chart.x.range(0.0, (flown_m / 1000.0).max(0.001));
    let deepest_m = track.iter().map(|p| p.position.z).fold(0.0, f64::max);
    let waypoint_m = mission
        .network
        .waypoints()
        .iter()
        .map(|w| w.position.z)
        .fold(deepest_m, f64::max);
    let mut floor_m = 1.15 * waypoint_m + 5.0;
    let bed = picture
        .scenario
        .as_ref()
        .and_then(|s| s.true_bed.as_ref().or(mission.sea_bed.as_ref()));
    if let Some(bed) = bed {
        let depths: Vec<(f64, f64)> = track
            .iter()
            .zip(&distance_km)
            .map(|(p, &km)| (km, bed.depth_at(p.position.x, p.position.y)))
            .collect();
        floor_m = 1.08 * depths.iter().map(|d| d.1).fold(deepest_m, f64::max) + 2.0;
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
            .zip(&distance_km)
            .map(|(p, &km)| (km, mission.deepest_at(p.position.x, p.position.y)));
        let style = Style::line("#7a6a45", 1.0).dash(Dash::Dashed);
        chart.add(Mark::line(allowed.collect(), style, "deepest allowed"));
    }
    chart.y = chart.y.range(-0.03 * floor_m, floor_m);
    for seen in picture.obstacles.values() {
        let Some(closest) = seen.closest.filter(|c| c.clearance_m < 100.0) else {
            continue;
        };
        let at = track
            .partition_point(|p| p.time_s < closest.pose.time_s)
            .min(track.len().saturating_sub(1));
        let km = distance_km.get(at).copied().unwrap_or(0.0);
        let (upper_m, lower_m) = closest.pose.depths_m;
        let half_km = closest.pose.radius_m / 1000.0;
        let ring = match seen.kind {
            Kind::Ship => vec![
                (km - half_km, upper_m),
                (km + half_km, upper_m),
                (km + half_km, lower_m),
                (km - half_km, lower_m),
            ],
            _ => (0..48)
                .map(|k| {
                    let (sin, cos) =
                        auv_types::libm::sincos(std::f64::consts::TAU * f64::from(k) / 48.0);
                    (
                        km + half_km * cos,
                        0.5 * (upper_m + lower_m) + 0.5 * (lower_m - upper_m) * sin,
                    )
                })
                .collect(),
        };
        let (style, _) = look(seen.kind);
        chart.add(Mark::Area {
            rings: vec![ring],
            style,
            legend: String::new(),
        });
    }
    let first = chart.marks.len();
    for (colour, range) in pieces(picture) {
        let points = range
            .map(|i| (distance_km[i], track[i].position.z))
            .collect();
        chart.add(Mark::line(points, Style::line(colour, 2.2), ""));
    }
    if let Some(Mark::Line { legend, .. }) = chart.marks.get_mut(first) {
        *legend = "vehicle (a colour a leg); obstacles that came within 100 m".into();
    }
    for (k, leg) in picture
        .legs
        .iter()
        .enumerate()
        .filter(|(_, leg)| leg.completed)
    {
        let at = track
            .partition_point(|p| p.time_s < picture.leg_end_s(k))
            .min(track.len().saturating_sub(1));
        if let Some(point) = track.get(at) {
            chart.add(Mark::Label {
                at: (distance_km[at], point.position.z),
                text: mission.name_of(leg.to),
                colour: palette::BLACK,
                size: 10.5,
                always: false,
            });
        }
    }
    chart
}
