//! A mission in one picture: plan view and depth over distance.

use crate::contour::Grid;
use crate::draw::palette::{self, Colour};
use crate::draw::{Axis, Chart, Corner, Dash, Figure, Mark, Shape, Style};
use crate::record::{Kind, MissionPicture, Pose, Seen};
use auv_graph::NodeId;
use auv_mission::Mission;
use auv_obstacles::TimedPoint;
use auv_types::Point3;
use std::collections::BTreeSet;

/// Colours of legs, in turn; none is a colour of obstacles.
const LEGS: [Colour; 4] = [
    palette::BLUE,
    palette::VERMILLION,
    palette::GREEN,
    palette::BLACK,
];

/// How long before and after its closest approach a ship's way is drawn, seconds.
const SHIP_SHOWN_S: f64 = 600.0;

/// One picture of a mission: the plan view (waypoints, tasks, flown track by leg, true obstacles at
/// their closest approach, current, sea bed, sonar range) and depth over the distance flown.
///
/// Equal missions give equal text. A picture of a mission that was not recorded says so.
#[must_use]
pub fn mission_svg(picture: &MissionPicture) -> String {
    let Some(scenario) = &picture.scenario else {
        return Figure::new("No mission", "The mission was not recorded.").to_svg();
    };
    let mut figure = Figure::new(&title(picture), &subtitle(picture));
    figure.charts = vec![
        plan_view(picture, &scenario.mission),
        profile(picture, &scenario.mission),
    ];
    figure.notes = notes(picture);
    figure.to_svg()
}

pub(crate) fn title(picture: &MissionPicture) -> String {
    let name = picture.scenario.as_ref().map_or("", |s| s.name.as_str());
    match &picture.summary {
        Some(summary) => format!("{name}: {} ({})", summary.outcome, summary.reason),
        None => name.into(),
    }
}

pub(crate) fn subtitle(picture: &MissionPicture) -> String {
    let (Some(scenario), Some(summary)) = (&picture.scenario, &picture.summary) else {
        return String::new();
    };
    let judgement = &summary.judgement;
    let mut text = format!(
        "{:.0} s of {:.0} s used, {:.0} s left (reserve {:.0} s); {} tasks, weight {:.1}; {} route calls, {} legs",
        summary.time_s,
        scenario.mission.budget_s,
        summary.remaining_s,
        scenario.mission.reserve_s,
        summary.tasks,
        summary.mission_weight,
        summary.route_calls.len(),
        summary.path_calls.len(),
    );
    if judgement.min_clearance_m.is_finite() {
        text += &format!(
            "; least true clearance {:.1} m at {:.0} s",
            judgement.min_clearance_m, judgement.min_clearance_at_s
        );
    }
    if judgement.min_altitude_m.is_finite() {
        text += &format!("; least altitude {:.1} m", judgement.min_altitude_m);
    }
    text + "."
}

fn notes(picture: &MissionPicture) -> Vec<String> {
    let mut notes = vec![
        "Obstacles are drawn where they truly were when the vehicle came closest; faint ones never came within \
         sonar range. Dotted rings and arrows: where they were at the start of the mission, and where they went since; of ships, \
         ten minutes before and after."
            .into(),
    ];
    notes.extend(picture.notes.iter().cloned());
    notes
}

/// East and north.
fn flat(p: &Point3<f64>) -> (f64, f64) {
    (p.y, p.x)
}

fn plan_view(picture: &MissionPicture, mission: &Mission) -> Chart {
    let mut chart = Chart::map("Plan view");
    let (east, north) = extent(picture, mission);
    let places = places(picture, mission);
    chart.x = chart.x.range(east.0, east.1);
    chart.y = chart.y.range(north.0, north.1);
    chart.compass = Some(emptiest_corner(&places, east, north));
    chart.current_mps = water(picture, east, north);
    sea_bed(&mut chart, mission, east, north);
    network(&mut chart, picture, mission);
    obstacles(&mut chart, picture);
    predictions(&mut chart, picture);
    track(&mut chart, picture);
    names(&mut chart, picture, mission);
    chart
}

/// All waypoints and the track.
fn places<'a>(picture: &'a MissionPicture, mission: &'a Mission) -> Vec<&'a Point3<f64>> {
    let waypoints = mission.network.waypoints().iter().map(|w| &w.position);
    waypoints
        .chain(picture.track.iter().map(|p| &p.position))
        .collect()
}

/// East and north that the plan view has to show, metres.
pub(crate) fn extent(picture: &MissionPicture, mission: &Mission) -> ((f64, f64), (f64, f64)) {
    let places = places(picture, mission);
    let range = |value: &dyn Fn(&Point3<f64>) -> f64| {
        let low = places
            .iter()
            .map(|p| value(p))
            .fold(f64::INFINITY, f64::min);
        let high = places
            .iter()
            .map(|p| value(p))
            .fold(f64::NEG_INFINITY, f64::max);
        let room = 0.04 * (high - low) + 50.0;
        (low - room, high + room)
    };
    (range(&|p| p.y), range(&|p| p.x))
}

/// The current in the middle of the plan view at the start, (east, north) in m/s.
pub(crate) fn water(
    picture: &MissionPicture,
    east: (f64, f64),
    north: (f64, f64),
) -> Option<(f64, f64)> {
    let current = picture.scenario.as_ref()?.true_current.as_ref()?;
    let middle = Point3::new(0.5 * (north.0 + north.1), 0.5 * (east.0 + east.1), 10.0);
    let water = current.velocity_at(&middle, 0.0);
    Some((water.y, water.x))
}

/// A waypoint's name; the vehicle's own place, which is no waypoint, is called `here`.
pub(crate) fn name_of(mission: &Mission, node: NodeId) -> String {
    if mission.network.has_node(node) {
        mission.name_of(node)
    } else {
        "here".into()
    }
}

/// The corner with the fewest waypoints and track points.
fn emptiest_corner(places: &[&Point3<f64>], east: (f64, f64), north: (f64, f64)) -> Corner {
    let corners = [
        Corner::LowerRight,
        Corner::LowerLeft,
        Corner::UpperRight,
        Corner::UpperLeft,
    ];
    let crowd = |corner: &Corner| {
        let right = matches!(corner, Corner::LowerRight | Corner::UpperRight);
        let upper = matches!(corner, Corner::UpperLeft | Corner::UpperRight);
        let near = |p: &&&Point3<f64>| {
            let across = (p.y - east.0) / (east.1 - east.0);
            let up = (p.x - north.0) / (north.1 - north.0);
            (if right { across > 0.76 } else { across < 0.24 })
                && (if upper { up > 0.86 } else { up < 0.14 })
        };
        places.iter().filter(near).count()
    };
    corners
        .into_iter()
        .min_by_key(|corner| crowd(corner))
        .unwrap_or(Corner::LowerRight)
}

fn sea_bed(chart: &mut Chart, mission: &Mission, east: (f64, f64), north: (f64, f64)) {
    let Some(bed) = &mission.sea_bed else {
        return;
    };
    let grid = Grid::sample((121, 121), (east, north), |east_m, north_m| {
        bed.depth_at(north_m, east_m)
    });
    let land = Grid::sample((121, 121), (east, north), |east_m, north_m| {
        -bed.depth_at(north_m, east_m)
    });
    let step_m = crate::draw::nice_step(grid.greatest() / 6.0);
    let levels = (1..=8)
        .map(|k| step_m * f64::from(k))
        .filter(|level| *level < grid.greatest());
    for (k, level) in levels.enumerate() {
        chart.add(Mark::Area {
            rings: grid.above(level),
            style: Style::fill(palette::BLUE, 0.055),
            legend: if k == 0 {
                format!("a shade every {step_m} m of depth")
            } else {
                String::new()
            },
        });
    }
    let rings = land.above(0.0);
    if !rings.is_empty() {
        chart.add(Mark::Area {
            rings,
            style: Style::fill("#cfc3a5", 1.0),
            legend: "land".into(),
        });
    }
}

/// The network in grey, and the tasks: done, still planned at the end, planned once but dropped.
fn network(chart: &mut Chart, picture: &MissionPicture, mission: &Mission) {
    let position = |node: u32| flat(&mission.position_of(NodeId(node)));
    let mut pairs = BTreeSet::new();
    for arc in mission.network.arcs() {
        pairs.insert((arc.tail.0.min(arc.head.0), arc.tail.0.max(arc.head.0)));
    }
    let opacity = (60.0 / pairs.len().max(1) as f64).clamp(0.10, 0.5);
    let mut points = Vec::new();
    for (a, b) in pairs {
        points.extend([position(a), position(b), (f64::NAN, f64::NAN)]);
    }
    chart.add(Mark::line(
        points,
        Style::line("#808080", 0.6).faint(opacity),
        "",
    ));
    chart.legends.push(Mark::line(
        Vec::new(),
        Style::line("#b0b0b0", 1.0),
        "edge of the network",
    ));

    let done: BTreeSet<_> = picture
        .legs
        .iter()
        .filter(|leg| leg.completed)
        .map(|leg| (leg.from, leg.to))
        .collect();
    let mut dropped = BTreeSet::new();
    for call in picture.routes.iter().filter(|call| call.route.len() > 1) {
        for pair in call.route.windows(2) {
            let known = pair.iter().all(|&node| mission.network.has_node(node));
            if known && !done.contains(&(pair[0], pair[1])) {
                dropped.insert((pair[0], pair[1]));
            }
        }
    }
    let mut points = Vec::new();
    for (from, to) in dropped {
        points.extend([position(from.0), position(to.0), (f64::NAN, f64::NAN)]);
    }
    let style = Style::line(palette::GREY, 1.4).dash(Dash::Dashed);
    chart.add(Mark::line(points, style, "planned once, dropped"));

    let waypoints = mission.network.waypoints();
    let visited: BTreeSet<u32> = picture
        .summary
        .iter()
        .flat_map(|summary| summary.visited.iter().map(|node| node.0))
        .collect();
    let (mut on, mut off) = (Vec::new(), Vec::new());
    for (i, waypoint) in waypoints.iter().enumerate() {
        let list = if visited.contains(&(i as u32)) {
            &mut on
        } else {
            &mut off
        };
        list.push(flat(&waypoint.position));
    }
    let point = |points, style, size, legend: &str| Mark::Points {
        points,
        shape: Shape::Disc,
        size,
        style,
        legend: legend.into(),
    };
    chart.add(point(
        off,
        Style::line(palette::GREY, 1.2).filled("#ffffff", 1.0),
        3.2,
        "waypoint",
    ));
    chart.legends.push(point(
        on,
        Style::line(palette::BLACK, 1.0).filled(palette::BLACK, 1.0),
        4.0,
        "visited",
    ));
}

/// How an obstacle of a kind looks, and what it is called.
pub(crate) fn look(kind: Kind) -> (Style, &'static str) {
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

fn obstacles(chart: &mut Chart, picture: &MissionPicture) {
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
fn predictions(chart: &mut Chart, picture: &MissionPicture) {
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

/// Where the vehicle was, by the points of a track about that time.
pub(crate) fn place_at(track: &[TimedPoint], time_s: f64) -> Option<Point3<f64>> {
    let next = track.partition_point(|p| p.time_s < time_s);
    let b = track.get(next).or(track.last())?;
    let a = &track[next.saturating_sub(1).min(track.len() - 1)];
    let whole_s = b.time_s - a.time_s;
    let share = if whole_s > 0.0 {
        ((time_s - a.time_s) / whole_s).clamp(0.0, 1.0)
    } else {
        0.0
    };
    Some(a.position + (b.position - a.position) * share)
}

/// The pieces of the track by leg: colour, and indices of its points.
fn pieces(picture: &MissionPicture) -> Vec<(Colour, std::ops::Range<usize>)> {
    let track = &picture.track;
    let at = |time_s: f64| track.partition_point(|p| p.time_s < time_s - 1e-6);
    let mut pieces: Vec<_> = (0..picture.legs.len())
        .map(|k| {
            let end = (at(picture.leg_end_s(k)) + 1).min(track.len());
            (LEGS[k % LEGS.len()], at(picture.legs[k].at_s).min(end)..end)
        })
        .collect();
    if pieces.is_empty() {
        pieces.push((LEGS[0], 0..track.len()));
    }
    pieces
}

fn track(chart: &mut Chart, picture: &MissionPicture) {
    for (colour, range) in pieces(picture) {
        let points: Vec<_> = picture.track[range]
            .iter()
            .map(|p| flat(&p.position))
            .collect();
        chart.add(Mark::line(
            points.clone(),
            Style::line("#ffffff", 4.6).faint(0.8),
            "",
        ));
        chart.add(Mark::line(points, Style::line(colour, 2.4), ""));
    }
    chart.legends.push(Mark::line(
        Vec::new(),
        Style::line(LEGS[0], 2.4),
        "flown (a colour a leg)",
    ));
}

fn names(chart: &mut Chart, picture: &MissionPicture, mission: &Mission) {
    let visited: Vec<NodeId> = picture
        .summary
        .iter()
        .flat_map(|s| s.visited.iter().copied())
        .collect();
    let style = Style::line("#ffffff", 1.0).filled(palette::BLACK, 1.0);
    chart.add(Mark::Points {
        points: visited
            .iter()
            .map(|&node| flat(&mission.position_of(node)))
            .collect(),
        shape: Shape::Disc,
        size: 4.4,
        style,
        legend: String::new(),
    });
    for (node, shape, size, name) in [
        (mission.start, Shape::Triangle, 7.0, "start"),
        (mission.destination, Shape::Square, 6.0, "dock"),
    ] {
        chart.add(Mark::Points {
            points: vec![flat(&mission.position_of(node))],
            shape,
            size,
            style: Style::line(palette::BLACK, 1.4).filled("#F0E442", 1.0),
            legend: name.into(),
        });
    }
    let mut labelled = BTreeSet::new();
    for (i, waypoint) in mission.network.waypoints().iter().enumerate() {
        let node = NodeId(i as u32);
        let ends = node == mission.start || node == mission.destination;
        let on = visited.contains(&node);
        if labelled.insert(node) {
            chart.add(Mark::Label {
                at: flat(&waypoint.position),
                text: mission.name_of(node),
                colour: if on || ends {
                    palette::BLACK
                } else {
                    "#8a8a8a"
                },
                size: if on || ends { 12.0 } else { 9.5 },
                always: on || ends,
            });
        }
    }
}

/// Depth over the distance flown, with the sea bed and the obstacles that came near.
fn profile(picture: &MissionPicture, mission: &Mission) -> Chart {
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

#[cfg(test)]
mod tests {
    use super::*;
    use auv_mission::driver::Stepped;
    use auv_planning::baseline::{GreedyRoute, StraightPath};
    use auv_sim::{Campaign, simulate};
    use auv_types::Seed;

    fn flown() -> MissionPicture {
        let campaign = Campaign::table2(Seed(3)).unwrap();
        let mut picture = MissionPicture::new();
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        simulate(&campaign.scenario(0).unwrap(), &driver, &mut picture).unwrap();
        picture
    }

    #[test]
    fn the_picture_names_every_visited_waypoint_and_is_the_same_again() {
        let picture = flown();
        let svg = mission_svg(&picture);
        assert_eq!(svg, mission_svg(&flown()));
        let visited = &picture.summary.as_ref().unwrap().visited;
        assert!(visited.len() > 2);
        assert!(
            visited
                .iter()
                .all(|node| svg.contains(&format!(">{}</text>", node.0)))
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn what_was_not_recorded_is_said() {
        assert!(mission_svg(&MissionPicture::new()).contains("not recorded"));
    }

    #[test]
    fn poses_thinned_stay_on_the_true_way() {
        let picture = flown();
        for seen in picture.obstacles.values() {
            let closest = seen.closest.unwrap().pose;
            let next = seen
                .poses
                .partition_point(|p| p.time_s < closest.time_s)
                .clamp(1, seen.poses.len() - 1);
            let (a, b) = (seen.poses[next - 1], seen.poses[next]);
            let share = (closest.time_s - a.time_s) / (b.time_s - a.time_s);
            let between = a.centre + (b.centre - a.centre) * share;
            assert!((between - closest.centre).norm() < 25.0, "{:?}", seen.kind);
        }
    }
}
