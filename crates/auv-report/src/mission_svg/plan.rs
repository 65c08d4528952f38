//! The plan view: sea bed, network, the flown track and names.

use super::obstacles::{obstacles, predictions};
use crate::contour::Grid;
use crate::draw::palette;
use crate::draw::{Chart, Corner, Dash, Mark, PointShape, Style};
use crate::places::short_name;
use crate::places::{LEGS, extent, flat, pieces, places, water};
use crate::record::{MissionPicture, Setting};
use auv_graph::NodeId;
use auv_mission::Mission;
use auv_ocean::SeaBed;
use auv_sim::Fence;
use auv_types::Point3;
use std::collections::BTreeSet;

pub(super) fn plan_view(picture: &MissionPicture, mission: &Mission) -> Chart {
    let mut chart = Chart::map("Plan view");
    let (east, north) = extent(picture, mission);
    let places = places(picture, mission);
    chart.x = chart.x.range(east.0, east.1);
    chart.y = chart.y.range(north.0, north.1);
    chart.compass = Some(emptiest_corner(&places, east, north));
    chart.current_mps = water(picture, east, north);
    let bed = picture.setting.as_ref().and_then(|s| s.chart.as_ref());
    if let Some(bed) = bed {
        sea_bed(&mut chart, &**bed, east, north);
    }
    fences(&mut chart, picture);
    network(&mut chart, picture, mission);
    obstacles(&mut chart, picture);
    predictions(&mut chart, picture);
    planned(&mut chart, picture);
    track(&mut chart, picture);
    names(&mut chart, picture, mission);
    chart
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

/// Depths below this are land, metres: charts write land as depth 0.
const SHORE_M: f64 = 0.1;

/// The polygons of `keep_out` and `keep_in`.
fn fences(chart: &mut Chart, picture: &MissionPicture) {
    let Some(Setting { fences, .. }) = &picture.setting else {
        return;
    };
    let ring = |fence: &Fence| -> Vec<(f64, f64)> {
        let corners = fence.outline().iter().chain(fence.outline().first());
        corners
            .map(|&[north_m, east_m]| (east_m, north_m))
            .collect()
    };
    let mut name = "keep out";
    for fence in &fences.keep_out {
        chart.add(Mark::Area {
            rings: vec![ring(fence)],
            style: Style::fill(palette::VERMILLION, 0.18),
            legend: std::mem::take(&mut name).into(),
        });
        let edge = Style::line(palette::VERMILLION, 1.0);
        chart.add(Mark::line(ring(fence), edge, ""));
    }
    for fence in fences.keep_out.iter().chain(&fences.keep_in) {
        told(chart, fence, picture);
    }
    let mut name = "keep in";
    for fence in &fences.keep_in {
        let edge = Style::line(palette::GREEN, 1.4).dash(Dash::Dashed);
        chart.add(Mark::line(ring(fence), edge, std::mem::take(&mut name)));
    }
}

/// At which depths and when a fence holds, in its middle; nothing where it holds always and at all depths.
fn told(chart: &mut Chart, fence: &Fence, picture: &MissionPicture) {
    let [top_m, bottom_m] = fence.depth_m;
    let [from_s, until_s] = fence.holds_s;
    let at = |time_s: f64| {
        picture
            .utc(time_s)
            .unwrap_or_else(|| format!("{time_s:.0} s"))
    };
    let mut told = Vec::new();
    if bottom_m.is_finite() {
        told.push(format!("{:.0} to {bottom_m:.0} m deep", top_m.max(0.0)));
    } else if top_m > 0.0 {
        told.push(format!("from {top_m:.0} m depth down"));
    }
    if from_s.is_finite() {
        told.push(format!("from {}", at(from_s)));
    }
    if until_s.is_finite() {
        told.push(format!("until {}", at(until_s)));
    }
    if told.is_empty() {
        return;
    }
    let corners = fence.outline();
    let middle = |axis: usize| {
        let sum: f64 = corners.iter().map(|corner| corner[axis]).sum();
        sum / corners.len().max(1) as f64
    };
    chart.add(Mark::Label {
        at: (middle(1), middle(0)),
        text: format!("{}: {}", short_name(&fence.name), told.join(", ")),
        colour: palette::VERMILLION,
        size: 10.5,
        always: true,
    });
}

fn sea_bed(chart: &mut Chart, bed: &dyn SeaBed, east: (f64, f64), north: (f64, f64)) {
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
    // One shade alone is hardly visible in the legend.
    chart.legends.push(Mark::Area {
        rings: Vec::new(),
        style: Style::fill(palette::BLUE, 0.2),
        legend: format!("a shade every {step_m} m of depth"),
    });
    for level in levels {
        chart.add(Mark::Area {
            rings: grid.above(level),
            style: Style::fill(palette::BLUE, 0.055),
            legend: String::new(),
        });
    }
    let rings = land.above(-SHORE_M);
    if !rings.is_empty() {
        chart.add(Mark::Area {
            rings,
            style: Style::fill("#cfc3a5", 1.0),
            legend: "land".into(),
        });
    }
    // Outside the box the frame is grey; white means shallow water.
    let rectangle = |room: f64| {
        let (across, up) = (room * (east.1 - east.0), room * (north.1 - north.0));
        let (e, n) = (
            (east.0 - across, east.1 + across),
            (north.0 - up, north.1 + up),
        );
        vec![(e.0, n.0), (e.1, n.0), (e.1, n.1), (e.0, n.1)]
    };
    chart.add(Mark::Area {
        rings: vec![rectangle(0.0), rectangle(4.0)],
        style: Style::fill("#ededed", 1.0),
        legend: String::new(),
    });
}

/// The network in grey, the edges planned once but dropped, and the waypoints.
fn network(chart: &mut Chart, picture: &MissionPicture, mission: &Mission) {
    edges(chart, mission);
    dropped_edges(chart, picture, mission);
    waypoints(chart, picture, mission);
}

fn edges(chart: &mut Chart, mission: &Mission) {
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
}

fn dropped_edges(chart: &mut Chart, picture: &MissionPicture, mission: &Mission) {
    let position = |node: u32| flat(&mission.position_of(NodeId(node)));
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
}

/// Waypoints visited and not visited.
fn waypoints(chart: &mut Chart, picture: &MissionPicture, mission: &Mission) {
    let waypoints = mission.network.waypoints();
    let visited: BTreeSet<u32> = picture
        .ending
        .iter()
        .flat_map(|ending| ending.visited.iter().map(|node| node.0))
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
        shape: PointShape::Disc,
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

/// What was planned, beside what a real vehicle flew: each trajectory while it was in force. A simulated vehicle is
/// where it is to be, within the width of a line.
fn planned(chart: &mut Chart, picture: &MissionPicture) {
    if picture
        .setting
        .as_ref()
        .is_none_or(|s| s.simulated.is_some())
    {
        return;
    }
    let mut points = Vec::new();
    for followed in picture.followed() {
        points.extend(followed.iter().map(|p| flat(&p.position)));
        points.push((f64::NAN, f64::NAN));
    }
    let style = Style::line(palette::BLACK, 1.1).dash(Dash::Dashed);
    chart.add(Mark::line(points, style, "planned"));
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
        .ending
        .iter()
        .flat_map(|s| s.visited.iter().copied())
        .collect();
    let style = Style::line("#ffffff", 1.0).filled(palette::BLACK, 1.0);
    chart.add(Mark::Points {
        points: visited
            .iter()
            .map(|&node| flat(&mission.position_of(node)))
            .collect(),
        shape: PointShape::Disc,
        size: 4.4,
        style,
        legend: String::new(),
    });
    for (nodes, shape, size, name) in [
        (vec![mission.start], PointShape::Triangle, 7.0, "start"),
        (
            mission.all_docks().collect(),
            PointShape::Square,
            6.0,
            "dock",
        ),
    ] {
        let place = |&node: &NodeId| flat(&mission.position_of(node));
        chart.add(Mark::Points {
            points: nodes.iter().map(place).collect(),
            shape,
            size,
            style: Style::line(palette::BLACK, 1.4).filled("#F0E442", 1.0),
            legend: name.into(),
        });
    }
    let of_survey = line_ends(mission);
    let mut labelled = BTreeSet::new();
    for (i, waypoint) in mission.network.waypoints().iter().enumerate() {
        let node = NodeId(i as u32);
        let ends = node == mission.start || mission.is_dock(node);
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
                always: ends || on && !of_survey.contains(&node),
            });
        }
    }
}

/// The ends of what is flown as a line: there are too many in a survey to name each where no room is.
fn line_ends(mission: &Mission) -> BTreeSet<NodeId> {
    let arcs = mission.courses.lines.iter();
    let ends = arcs.filter_map(|arc| mission.network.arcs().get(arc.index()));
    ends.flat_map(|arc| [arc.tail, arc.head]).collect()
}
