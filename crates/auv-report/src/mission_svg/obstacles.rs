//! Obstacles in the plan view: as they truly were, and as they were predicted at the closest approach.

use crate::draw::palette::{self, Colour};
use crate::draw::{Chart, Dash, Mark, PointShape, Style};
use crate::places::{flat, place_at};
use crate::record::{MissionPicture, ObstacleKind, Pose, Seen};

/// How long before and after its closest approach a ship's way is drawn, seconds.
const SHIP_SHOWN_S: f64 = 600.0;

/// The style and the name of a kind of obstacle.
pub(super) fn look(kind: ObstacleKind) -> (Style, &'static str) {
    let style = |colour| Style::line(colour, 1.3).filled(colour, 0.35);
    match kind {
        ObstacleKind::Charted => (style(palette::GREY), "charted obstacle"),
        ObstacleKind::Uncertain => (style(palette::ORANGE).dash(Dash::Dashed), "uncertain size"),
        ObstacleKind::Moving => (style(palette::SKY), "moving"),
        ObstacleKind::Drifting => (
            style(palette::PURPLE).dash(Dash::Dotted),
            "drifting and growing",
        ),
        ObstacleKind::Ship => (
            Style::line(palette::BLACK, 1.3).filled(palette::BLACK, 0.55),
            "ship",
        ),
    }
}

pub(super) fn obstacles(chart: &mut Chart, picture: &MissionPicture) {
    let sonar_m = picture.sonar_m();
    let mut seen: Vec<(&u32, &Seen)> = picture
        .obstacles
        .iter()
        .map(|(id, seen)| (&id.0, seen))
        .collect();
    seen.sort_by_key(|(id, seen)| (seen.kind, **id));
    for (id, seen) in seen {
        let Some(closest) = seen.closest else {
            continue;
        };
        let (style, name) = look(seen.kind);
        let near = closest.clearance_m <= sonar_m;
        let style = if near {
            style
        } else {
            Style {
                fill_opacity: 0.08,
                stroke_opacity: 0.3,
                ..style
            }
        };
        if seen.kind == ObstacleKind::Ship {
            ship_way(chart, seen, closest.pose.time_s);
        } else if near {
            way(chart, seen, &closest.pose, style.stroke);
        }
        chart.add(Mark::Circle {
            centre: flat(&closest.pose.centre),
            radius: closest.pose.radius_m,
            style,
            tip: format!(
                "{name} {id}: radius {:.0} m, closest {:.1} m at {:.0} s",
                closest.pose.radius_m, closest.clearance_m, closest.pose.time_s
            ),
            legend: if near { name.into() } else { String::new() },
        });
    }
}

/// The track of a ship about its closest approach. The whole track of a ship that sails to and fro
/// would hide the rest.
fn ship_way(chart: &mut Chart, seen: &Seen, closest_s: f64) {
    let about = |pose: &&Pose| (pose.time_s - closest_s).abs() <= SHIP_SHOWN_S;
    let poses = seen.poses.iter().filter(about);
    let points = poses.map(|pose| flat(&pose.centre)).collect();
    chart.add(Mark::line(
        points,
        Style::line(palette::BLACK, 0.9).dash(Dash::Dotted),
        "",
    ));
}

/// Where an obstacle was at the start, and an arrow from there to its closest approach.
fn way(chart: &mut Chart, seen: &Seen, closest: &Pose, stroke: Option<Colour>) {
    let first = seen.poses[0];
    let colour = stroke.unwrap_or(palette::GREY);
    let way_m = (closest.centre - first.centre).norm();
    let grown_m = (closest.radius_m - first.radius_m).abs();
    if way_m > 30.0 || grown_m > 10.0 {
        chart.add(Mark::Circle {
            centre: flat(&first.centre),
            radius: first.radius_m,
            style: Style::line(colour, 0.9).dash(Dash::Dotted),
            tip: String::new(),
            legend: String::new(),
        });
    }
    if way_m > 60.0 {
        chart.add(Mark::Arrow {
            from: flat(&first.centre),
            to: flat(&closest.centre),
            style: Style::line(colour, 1.0),
        });
    }
}

/// The moment of the closest approach: sonar range, and what was predicted then.
pub(super) fn predictions(chart: &mut Chart, picture: &MissionPicture) {
    let simulated = picture.setting.as_ref().and_then(|s| s.simulated.as_ref());
    let judged = picture.ending.as_ref().and_then(|e| e.judged.as_ref());
    let (Some(scenario), Some(judged)) = (simulated, judged) else {
        return;
    };
    let judgement = &judged.judgement;
    let at_s = judgement.min_clearance_at_s;
    let Some(here) =
        place_at(&picture.track, at_s).filter(|_| judgement.min_clearance_m.is_finite())
    else {
        return;
    };
    let circle = |centre, radius, style, legend: &str| Mark::Circle {
        centre,
        radius,
        style,
        tip: String::new(),
        legend: legend.into(),
    };
    let dashed = Style::line(palette::BLUE, 1.1).dash(Dash::Dashed);
    let range_m = scenario.sonar.range_m;
    chart.add(circle(
        flat(&here),
        range_m,
        dashed,
        "sonar range at the closest approach",
    ));
    for series in picture.predicted.values() {
        let then = series
            .iter()
            .rev()
            .find(|p| p.time_s <= at_s && p.last_s >= at_s - 2.0 * scenario.tick_s);
        let Some(then) = then else {
            continue;
        };
        if (then.now.centre - here).norm() - then.now.radius_m < range_m {
            let style = Style::line(palette::BLACK, 0.9).dash(Dash::Dashed);
            chart.add(circle(
                flat(&then.now.centre),
                then.now.radius_m,
                style,
                "predicted then, with clearance",
            ));
        }
    }
    chart.add(Mark::Points {
        points: vec![flat(&here)],
        shape: PointShape::Cross,
        size: 5.0,
        style: Style::line("#b00020", 2.4),
        legend: "closest approach".into(),
    });
}
