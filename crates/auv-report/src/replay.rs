//! A mission as one page that plays offline.

use crate::mission_svg::{self, name_of};
use crate::record::{Kind, MissionPicture, Prediction};
use crate::thin::thinned;
use auv_graph::NodeId;
use std::collections::BTreeSet;
use std::fmt::Write;

const PAGE: &str = include_str!("replay.html");

/// A mission as one self-contained HTML page that needs no network: plan view, depth, budget,
/// clearance and time line, with play, pause, speed and scrubbing (also by keyboard: space and
/// arrows; `#t=600` opens it at 600 s).
///
/// Equal missions give equal text. A picture of a mission that was not recorded gives an empty page.
#[must_use]
pub fn replay_html(picture: &MissionPicture) -> String {
    PAGE.replacen("__DATA__", &data(picture), 1)
}

/// A number with one decimal at most; what is no number becomes a large one.
fn number(value: f64) -> String {
    let value = if value.is_finite() {
        value.clamp(-1e9, 1e9)
    } else {
        1e9
    };
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map_or(text.clone(), |whole| {
        if whole == "-0" {
            "0".into()
        } else {
            whole.into()
        }
    })
}

fn array(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|&v| number(v)).collect();
    format!("[{}]", texts.join(","))
}

/// A JSON string that cannot end the script element it stands in.
fn text(value: &str) -> String {
    let mut out = String::from("\"");
    for c in value.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

fn list(items: impl IntoIterator<Item = String>) -> String {
    let items: Vec<String> = items.into_iter().collect();
    format!("[{}]", items.join(","))
}

fn rows<const N: usize>(rows: &[[f64; N]]) -> String {
    list(rows.iter().map(|row| array(row)))
}

/// What was predicted of one obstacle: time, circle now, circle later, and until when; at most one
/// each five seconds, the first of them standing for the others.
fn predictions(series: &[Prediction]) -> String {
    let mut kept: Vec<[f64; 8]> = Vec::new();
    for p in series {
        match kept.last_mut() {
            Some(last) if p.time_s < last[0] + 5.0 => last[7] = p.last_s,
            _ => kept.push([
                p.time_s,
                p.now.centre.y,
                p.now.centre.x,
                p.now.radius_m,
                p.later.centre.y,
                p.later.centre.x,
                p.later.radius_m,
                p.last_s,
            ]),
        }
    }
    for value in kept.iter_mut().flatten() {
        *value = value.round();
    }
    rows(&kept)
}

fn data(picture: &MissionPicture) -> String {
    let Some(scenario) = &picture.scenario else {
        return "{\"title\":\"No mission was recorded\",\"subtitle\":\"\",\"notes\":\"\",\"track\":[],\"nodes\":[],\"edges\":[],\
                \"legs\":[],\"routes\":[],\"follows\":[],\"obstacles\":[],\"predicted\":[],\"clear\":[],\"box\":[0,1,0,1],\"sonar\":0,\"budget\":1,\"start\":-1,\"dest\":-1}"
            .into();
    };
    let mission = &scenario.mission;
    let end_s = picture.track.last().map_or(0.0, |p| p.time_s);
    let waypoints = mission.network.waypoints();
    let mut edges = BTreeSet::new();
    for arc in mission.network.arcs() {
        edges.insert((arc.tail.0.min(arc.head.0), arc.tail.0.max(arc.head.0)));
    }
    let (east, north) = mission_svg::extent(picture, mission);
    // What no screen shows is left out: a pixel is about a thousandth of the map.
    let pixel_m = 1e-3 * (east.1 - east.0).max(north.1 - north.0);
    let track = picture.track.iter();
    let track: Vec<_> = track
        .map(|p| [p.time_s, p.position.y, p.position.x, p.position.z])
        .collect();
    let mut out = String::from("{");
    let mut field = |name: &str, value: String| {
        let comma = if out.len() > 1 { "," } else { "" };
        let _ = write!(out, "{comma}\"{name}\":{value}");
    };
    field("title", text(&mission_svg::title(picture)));
    field("subtitle", text(&mission_svg::subtitle(picture)));
    field("notes", text(&picture.notes.join(" ")));
    field("budget", number(mission.budget_s));
    field("sonar", number(scenario.sonar.range_m));
    field("start", mission.start.0.to_string());
    field("dest", mission.destination.0.to_string());
    field("box", array(&[east.0, east.1, north.0, north.1]));
    if let Some(water) = mission_svg::water(picture, east, north) {
        field("current", format!("[{:.4},{:.4}]", water.0, water.1));
    }
    field(
        "nodes",
        list(waypoints.iter().enumerate().map(|(i, w)| {
            let name = mission.name_of(NodeId(i as u32));
            format!(
                "[{},{},{}]",
                number(w.position.y),
                number(w.position.x),
                text(&name)
            )
        })),
    );
    field(
        "edges",
        list(edges.iter().map(|(a, b)| format!("[{a},{b}]"))),
    );
    field("track", rows(&thinned(&track, 0.3)));
    field(
        "legs",
        list((0..picture.legs.len()).map(|k| leg(picture, k))),
    );
    field(
        "routes",
        list((0..picture.routes.len()).map(|k| route(picture, k, end_s))),
    );
    field(
        "follows",
        list(picture.follows.iter().map(|(at_s, trajectory)| {
            let points = trajectory.points();
            let stride = points.len().div_ceil(60).max(1);
            let kept = points.iter().step_by(stride).chain(points.last());
            let kept = kept.map(|p| array(&[p.position.y.round(), p.position.x.round()]));
            format!("{{\"at\":{},\"p\":{}}}", number(*at_s), list(kept))
        })),
    );
    field(
        "obstacles",
        list(picture.obstacles.values().map(|seen| {
            let kind = match seen.kind {
                Kind::Charted => "charted",
                Kind::Uncertain => "uncertain",
                Kind::Moving => "moving",
                Kind::Drifting => "drifting",
                Kind::Ship => "ship",
            };
            let poses = seen.poses.iter();
            let poses: Vec<_> = poses
                .map(|p| [p.time_s, p.centre.y, p.centre.x, p.radius_m].map(f64::round))
                .collect();
            let poses = rows(&thinned(&poses, 0.5 * pixel_m));
            format!("{{\"kind\":\"{kind}\",\"p\":{poses}}}")
        })),
    );
    field(
        "predicted",
        list(picture.predicted.values().map(|series| predictions(series))),
    );
    let clearances: Vec<_> = picture
        .clearances
        .iter()
        .map(|&(time_s, clearance_m)| [time_s, clearance_m.min(500.0)])
        .collect();
    field("clear", rows(&thinned(&clearances, 1.0)));
    let bed = scenario.true_bed.as_ref().or(mission.sea_bed.as_ref());
    if let Some(bed) = bed {
        let floor = picture
            .track
            .iter()
            .step_by(picture.track.len().div_ceil(600).max(1));
        field(
            "floor",
            list(floor.map(|p| array(&[p.time_s, bed.depth_at(p.position.x, p.position.y)]))),
        );
        let n = 90_usize;
        let depths: Vec<f64> = (0..n * n)
            .map(|k| {
                let share = |i: usize| i as f64 / (n - 1) as f64;
                let east_m = east.0 + share(k % n) * (east.1 - east.0);
                let north_m = north.0 + share(k / n) * (north.1 - north.0);
                bed.depth_at(north_m, east_m).round()
            })
            .collect();
        let deepest = depths.iter().copied().fold(1.0, f64::max);
        field(
            "bed",
            format!(
                "{{\"n\":{n},\"max\":{},\"v\":{}}}",
                number(deepest),
                array(&depths)
            ),
        );
    }
    out.push('}');
    out
}

fn leg(picture: &MissionPicture, k: usize) -> String {
    let leg = &picture.legs[k];
    let mission = picture.scenario.as_ref().map(|s| &s.mission);
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
    let mission = picture.scenario.as_ref().map(|s| &s.mission);
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
    use auv_mission::driver::Stepped;
    use auv_planning::baseline::{GreedyRoute, StraightPath};
    use auv_sim::{Campaign, simulate};
    use auv_types::Seed;

    #[test]
    fn a_three_hour_mission_fits_into_two_megabytes_and_calls_nobody() {
        let scenario = Campaign::table2(Seed(4)).unwrap().scenario(0).unwrap();
        let mut picture = MissionPicture::new();
        simulate(
            &scenario,
            &Stepped::new(&GreedyRoute, &StraightPath),
            &mut picture,
        )
        .unwrap();
        picture.note("</script><b>");
        let page = replay_html(&picture);
        assert!(page.len() < 2_000_000, "{} bytes", page.len());
        assert!(!page.contains("http") && !page.contains("__DATA__"));
        assert_eq!(page.matches("</script>").count(), 2);
    }

    #[test]
    fn text_is_json_that_stays_in_its_element() {
        assert_eq!(text("a\"<\n"), "\"a\\\"\\u003c\\u000a\"");
        assert_eq!(
            [number(1.25), number(f64::NAN), number(-0.01)],
            ["1.2", "1000000000", "0"]
        );
    }
}
