//! A mission as one page that plays offline.

use crate::mission_svg::{self, name_of};
use crate::record::{Kind, MissionPicture, Pose, Prediction};
use crate::tasks::assignments;
use crate::thin::thinned;
use auv_graph::NodeId;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::iter;

const PAGE: &str = include_str!("replay/page.html");
const STYLE: &str = include_str!("replay/style.css");

/// The parts of the page's program, in the order in which they need each other.
const SCRIPTS: [&str; 7] = [
    include_str!("replay/mission.js"),
    include_str!("replay/drawing.js"),
    include_str!("replay/camera.js"),
    include_str!("replay/terrain.js"),
    include_str!("replay/scene.js"),
    include_str!("replay/charts.js"),
    include_str!("replay/player.js"),
];

/// A mission as one self-contained HTML page that needs no network: plan and 3-D view, depth,
/// budget, clearance, time line and what was decided why, with play, pause, speed and scrubbing
/// (also by keyboard: space and arrows; `#t=600` opens it at 600 s, `#t=600&view=3d` in three
/// dimensions).
///
/// Equal missions give equal text. A picture of a mission that was not recorded gives an empty page.
#[must_use]
pub fn replay_html(picture: &MissionPicture) -> String {
    PAGE.replacen("__STYLE__", STYLE, 1)
        .replacen("__SCRIPT__", &SCRIPTS.concat(), 1)
        .replacen("__DATA__", &data(picture), 1)
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

/// The shape of an obstacle: nothing of a ball, the depths of a cylinder's ends.
fn span(pose: &Pose) -> String {
    let (top_m, bottom_m) = pose.depths_m;
    if pose.ball {
        String::new()
    } else {
        format!("\"span\":{},", array(&[top_m, bottom_m]))
    }
}

/// East, north, depth and radius of an obstacle, in whole metres.
fn place(pose: &Pose) -> [f64; 4] {
    let depth_m = if pose.ball { pose.centre.z } else { 0.0 };
    [pose.centre.y, pose.centre.x, depth_m, pose.radius_m].map(f64::round)
}

/// How long an obstacle may go without prediction before it is shown as gone, seconds.
const SILENT_S: f64 = 25.0;

/// What was predicted of one obstacle, in stretches without a gap: where it was said to be and where
/// it was said to go, as rows of time, place now and place later, exact to `exact_m`. Only `near` ones.
fn predictions(series: &[Prediction], exact_m: f64, near: impl Fn(&Prediction) -> bool) -> String {
    let shape = series.first().map_or(String::new(), |p| span(&p.now));
    let series: Vec<_> = series.iter().filter(|p| near(p)).collect();
    let stretches = series.chunk_by(|a, b| b.time_s - a.last_s <= SILENT_S);
    let stretches = stretches.map(|stretch| {
        let mut said: Vec<[f64; 9]> = Vec::new();
        for p in stretch {
            let (now, later) = (place(&p.now), place(&p.later));
            // What was said for long, held; what changes all the time is a line anyway.
            let held = (p.last_s > p.time_s + 10.0).then_some(p.last_s);
            for time_s in iter::once(p.time_s).chain(held) {
                if said.last().is_none_or(|last| time_s > last[0]) {
                    said.push([
                        time_s, now[0], now[1], now[2], now[3], later[0], later[1], later[2],
                        later[3],
                    ]);
                }
            }
        }
        rows(&thinned(&said, exact_m))
    });
    format!("{{{shape}\"p\":{}}}", list(stretches))
}

/// Widens a range to a width, on both sides, where the mission's box allows it.
fn widen(range: &mut (f64, f64), width_m: f64, allowed: (f64, f64)) {
    let room_m = 0.5 * (width_m - (range.1 - range.0)).max(0.0);
    range.0 = range.0.min(allowed.0.max(range.0 - room_m));
    range.1 = range.1.max(allowed.1.min(range.1 + room_m));
}

fn data(picture: &MissionPicture) -> String {
    let Some(scenario) = &picture.scenario else {
        return "{\"title\":\"No mission was recorded\",\"subtitle\":\"\",\"notes\":\"\",\"track\":[],\"nodes\":[],\"edges\":[],\
                \"legs\":[],\"tasks\":[],\"routes\":[],\"follows\":[],\"obstacles\":[],\"predicted\":[],\"clear\":[],\"box\":[0,1,0,1],\"sonar\":0,\"budget\":1,\"reserve\":0,\"start\":-1,\"dest\":-1}"
            .into();
    };
    let mission = &scenario.mission;
    let end_s = picture.track.last().map_or(0.0, |p| p.time_s);
    let waypoints = mission.network.waypoints();
    let mut edges = BTreeSet::new();
    for arc in mission.network.arcs() {
        edges.insert((arc.tail.0.min(arc.head.0), arc.tail.0.max(arc.head.0)));
    }
    let (mut east, mut north) = mission_svg::extent(picture, mission);
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
    // What no screen shows is left out: a pixel is about a thousandth of the map.
    let pixel_m = 1e-3 * (east.1 - east.0).max(north.1 - north.0);
    let room_m = 200.0 * pixel_m;
    let shown = |p: &Prediction| {
        [p.now, p.later].iter().any(|pose| {
            let (centre, reach_m) = (pose.centre, pose.radius_m + room_m);
            centre.y > east.0 - reach_m
                && centre.y < east.1 + reach_m
                && centre.x > north.0 - reach_m
                && centre.x < north.1 + reach_m
        })
    };
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
    field("reserve", number(mission.reserve_s));
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
                "[{},{},{},{}]",
                number(w.position.y),
                number(w.position.x),
                number(w.position.z),
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
    let tasks = assignments(mission, picture);
    let done = tasks.iter().filter_map(|task| {
        let at_s = task.done_s?;
        Some(array(&[at_s, task.task.weight()]))
    });
    field("tasks", list(done));
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
            let kept = kept
                .map(|p| [p.position.y, p.position.x, p.position.z])
                .map(|p| array(&p.map(f64::round)));
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
                .map(|pose| {
                    let [east_m, north_m, depth_m, radius_m] = place(pose);
                    [pose.time_s.round(), east_m, north_m, depth_m, radius_m]
                })
                .collect();
            let poses = rows(&thinned(&poses, 0.5 * pixel_m));
            let shape = seen.poses.first().map_or(String::new(), span);
            format!("{{\"kind\":\"{kind}\",{shape}\"p\":{poses}}}")
        })),
    );
    field(
        "predicted",
        list(
            picture
                .predicted
                .values()
                .map(|series| predictions(series, pixel_m, shown)),
        ),
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
        let n = 121_usize;
        let depths: Vec<f64> = (0..n * n)
            .map(|k| {
                let share = |i: usize| i as f64 / (n - 1) as f64;
                let east_m = east.0 + share(k % n) * (east.1 - east.0);
                let north_m = north.0 + share(k / n) * (north.1 - north.0);
                bed.depth_at(north_m, east_m)
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
    use auv_types::{Point3, Seed};
    use serde_json::Value;

    fn flown() -> MissionPicture {
        let scenario = Campaign::table2(Seed(4)).unwrap().scenario(0).unwrap();
        let mut picture = MissionPicture::new();
        simulate(
            &scenario,
            &Stepped::new(&GreedyRoute, &StraightPath),
            &mut picture,
        )
        .unwrap();
        picture
    }

    fn parsed(picture: &MissionPicture) -> Value {
        serde_json::from_str(&data(picture)).unwrap()
    }

    #[test]
    fn a_three_hour_mission_fits_into_two_megabytes_and_calls_nobody() {
        let mut picture = flown();
        picture.note("</script><b>");
        let page = replay_html(&picture);
        assert!(page.len() < 2_000_000, "{} bytes", page.len());
        for absent in [
            "http",
            "__DATA__",
            "__SCRIPT__",
            "__STYLE__",
            "import ",
            "fetch(",
        ] {
            assert!(!page.contains(absent), "{absent}");
        }
        assert_eq!(page.matches("</script>").count(), 2);
    }

    #[test]
    fn whatever_the_page_reads_was_written() {
        let scripts = SCRIPTS.concat();
        let is_word = |c: char| c.is_ascii_alphanumeric();
        let read: BTreeSet<&str> = scripts
            .split("MISSION.")
            .skip(1)
            .filter_map(|rest| rest.split(|c| !is_word(c)).next())
            .collect();
        assert!(read.len() > 10, "{read:?}");
        for picture in [flown(), MissionPicture::new()] {
            let written = parsed(&picture);
            for field in &read {
                let optional = ["bed", "floor", "current"].contains(field);
                assert!(optional || written.get(field).is_some(), "{field}");
            }
        }
        let page = PAGE.to_owned() + &scripts;
        for rest in scripts.split("byId(\"").skip(1) {
            let id = rest.split('"').next().unwrap();
            assert!(page.contains(&format!("id=\"{id}\"")), "{id}");
        }
    }

    #[test]
    fn everything_in_space_has_its_depth() {
        let picture = flown();
        let written = parsed(&picture);
        let lengths = |rows: &Value| -> BTreeSet<usize> {
            let rows = rows.as_array().unwrap().iter();
            rows.map(|row| row.as_array().unwrap().len()).collect()
        };
        assert_eq!(lengths(&written["nodes"]), BTreeSet::from([4]));
        assert_eq!(lengths(&written["track"]), BTreeSet::from([4]));
        for path in written["follows"].as_array().unwrap() {
            assert_eq!(lengths(&path["p"]), BTreeSet::from([3]));
        }
        let obstacles = written["obstacles"].as_array().unwrap();
        assert_eq!(obstacles.len(), picture.obstacles.len());
        for (obstacle, seen) in obstacles.iter().zip(picture.obstacles.values()) {
            assert_eq!(lengths(&obstacle["p"]), BTreeSet::from([5]));
            assert_eq!(obstacle.get("span").is_none(), seen.poses[0].ball);
        }
        for region in written["predicted"].as_array().unwrap() {
            for stretch in region["p"].as_array().unwrap() {
                assert_eq!(lengths(stretch), BTreeSet::from([9]));
            }
        }
    }

    #[test]
    fn predictions_are_thinned_within_stretches_and_never_across_silence() {
        let pose = |time_s: f64, north_m: f64| Pose {
            time_s,
            centre: Point3::new(north_m, 7.0, 20.0),
            radius_m: 5.0,
            ball: true,
            depths_m: (15.0, 25.0),
        };
        let said = |k: i32| {
            let time_s = f64::from(if k < 50 { k } else { k + 100 });
            Prediction {
                time_s,
                now: pose(time_s, 2.0 * time_s),
                later: pose(time_s + 300.0, 2.0 * time_s + 600.0),
                last_s: time_s,
            }
        };
        let series: Vec<_> = (0..100).map(said).collect();
        assert_eq!(
            predictions(&series, 1.0, |_| true),
            "{\"p\":[[[0,7,0,20,5,7,600,20,5],[49,7,98,20,5,7,698,20,5]],\
             [[150,7,300,20,5,7,900,20,5],[199,7,398,20,5,7,998,20,5]]]}"
        );
    }

    #[test]
    fn a_narrow_map_is_widened_within_the_box_only() {
        let mut range = (0.0, 10.0);
        widen(&mut range, 30.0, (-4.0, 100.0));
        assert_eq!(range, (-4.0, 20.0));
        widen(&mut range, 5.0, (0.0, 1.0));
        assert_eq!(range, (-4.0, 20.0));
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
