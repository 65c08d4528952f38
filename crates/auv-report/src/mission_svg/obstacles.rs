//! Obstacles in the plan view: as they truly were, and as they were predicted at the closest approach.

use super::{flat, place_at};
use crate::draw::palette;
use crate::draw::{Chart, Dash, Mark, Shape, Style};
use crate::record::{Kind, MissionPicture, Pose, Seen};

/// How long before and after its closest approach a ship's way is drawn, seconds.
const SHIP_SHOWN_S: f64 = 600.0;

/// How an obstacle of a kind looks, and what it is called.
pub(super) fn look(kind: Kind) -> (Style, &'static str) {
    let style = |colour| Style::line(colour, 1.3).filled(colour, 0.35);
    match kind {
        Kind::Charted => (style(palette::GREY), "charted obstacle"),
        Kind::Uncertain => (style(palette::ORANGE).dash(Dash::Dashed), "uncertain size"),
        Kind::Moving => (style(palette::SKY), "moving"),
        Kind::Drifting => (
            style(palette::PURPLE).dash(Dash::Dotted),
            "drifting and growing",
        ),
        Kind::Ship => (
            Style::line(palette::BLACK, 1.3).filled(palette::BLACK, 0.55),
            "ship",
        ),
    }
}

pub(super) fn obstacles(chart: &mut Chart, picture: &MissionPicture) {
    let sonar_m = picture.scenario.as_ref().map_or(0.0, |s| s.sonar.range_m);
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
        let first = seen.poses[0];
        let way_m = (closest.pose.centre - first.centre).norm();
        let grown_m = (closest.pose.radius_m - first.radius_m).abs();
        if near && (way_m > 30.0 || grown_m > 10.0) && seen.kind != Kind::Ship {
            let ring = Style::line(style.stroke.unwrap_or(palette::GREY), 0.9).dash(Dash::Dotted);
            chart.add(Mark::Circle {
                centre: flat(&first.centre),
                radius: first.radius_m,
                style: ring,
                tip: String::new(),
                legend: String::new(),
            });
        }
        if seen.kind == Kind::Ship {
            // Ships may go to and fro: the way about the closest approach says enough.
            let about = |pose: &&Pose| (pose.time_s - closest.pose.time_s).abs() <= SHIP_SHOWN_S;
            let poses = seen.poses.iter().filter(about);
            let points = poses.map(|pose| flat(&pose.centre)).collect();
            chart.add(Mark::line(
                points,
                Style::line(palette::BLACK, 0.9).dash(Dash::Dotted),
                "",
            ));
        } else if near && way_m > 60.0 {
            chart.add(Mark::Arrow {
                from: flat(&first.centre),
                to: flat(&closest.pose.centre),
                style: Style::line(style.stroke.unwrap_or(palette::GREY), 1.0),
            });
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

/// The moment of the closest approach: sonar range, and what was predicted then.
pub(super) fn predictions(chart: &mut Chart, picture: &MissionPicture) {
    let (Some(scenario), Some(summary)) = (&picture.scenario, &picture.summary) else {
        return;
    };
    let at_s = summary.judgement.min_clearance_at_s;
    let Some(here) =
        place_at(&picture.track, at_s).filter(|_| summary.judgement.min_clearance_m.is_finite())
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
        shape: Shape::Cross,
        size: 5.0,
        style: Style::line("#b00020", 2.4),
        legend: "closest approach".into(),
    });
}
