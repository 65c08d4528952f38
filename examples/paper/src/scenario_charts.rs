//! The pictures of Fig. 13 to 16: paths from above and in space, and the swarm by iteration.

use crate::swarm_run::{Chosen, SwarmRun, ends};
use auv_obstacles::{Region, truth::ObstacleClass};
use auv_report::{Axis, Chart, Dash, Mark, PointShape, Style, palette};
use auv_sim::statistics::BoxStats;
use auv_types::{Point3, Vector3, libm};

fn colour(class: ObstacleClass) -> (&'static str, &'static str) {
    match class {
        ObstacleClass::Static => (palette::GREY, "static"),
        ObstacleClass::Uncertain => (palette::ORANGE, "uncertain size"),
        ObstacleClass::Moving => (palette::SKY, "moving"),
        ObstacleClass::Drifting => (palette::PURPLE, "drifting, growing"),
    }
}

fn flat(p: &Point3<f64>) -> (f64, f64) {
    (p.y, p.x)
}

/// When the path is closest to a region, seconds.
fn closest_s(run: &SwarmRun, region: &Region) -> f64 {
    let approaches = run.path.segments().map(|(a, b)| region.clearance(a, b));
    let closest = approaches.min_by(|a, b| a.clearance_m.total_cmp(&b.clearance_m));
    closest.map_or(0.0, |closest| closest.time_s)
}

pub(crate) fn plan_view(run: &SwarmRun, count: usize) -> Chart {
    let mut chart = Chart::map(&format!("{count} obstacles"));
    chart.compass = None;
    for (obstacle, region) in run.obstacles.iter().zip(&run.regions) {
        let (colour, name) = colour(obstacle.class);
        let at_s = closest_s(run, region);
        let mut circle = |time_s: f64, style: Style, legend: &str| {
            chart.add(Mark::Circle {
                centre: flat(&region.centre_at(time_s)),
                radius: region.radius_at(time_s),
                style,
                tip: String::new(),
                legend: legend.into(),
            });
        };
        let thin = Style::line(colour, 1.0);
        if region.growth_mps != 0.0 || region.velocity_mps.norm() > 0.0 {
            circle(region.from_s.max(0.0), thin.dash(Dash::Dotted), "");
            circle(run.path.end().time_s, thin.dash(Dash::Dashed), "");
        }
        circle(at_s, thin.filled(colour, 0.4), name);
    }
    let points: Vec<_> = run
        .path
        .points()
        .iter()
        .map(|p| flat(&p.position))
        .collect();
    let straight = vec![flat(&ends().0), flat(&ends().1)];
    chart.add(Mark::line(
        straight.clone(),
        Style::line(palette::GREY, 0.9).dash(Dash::Dashed),
        "straight line",
    ));
    chart.add(Mark::line(points, Style::line(palette::BLUE, 2.2), "path"));
    for (point, text) in straight.into_iter().zip(["start", "target"]) {
        chart.add(Mark::Points {
            points: vec![point],
            shape: PointShape::Disc,
            size: 4.0,
            style: Style::fill(palette::BLACK, 1.0),
            legend: String::new(),
        });
        chart.add(Mark::Label {
            at: point,
            text: text.into(),
            colour: palette::BLACK,
            size: 11.0,
            always: true,
        });
    }
    chart.x = chart.x.range(-900.0, 2400.0);
    chart.y = chart.y.range(-300.0, 3300.0);
    chart
}

pub(crate) fn boxes(title: &str, label: &str, run: &SwarmRun, what: Chosen) -> Chart {
    let mut chart = Chart::new(
        title,
        Axis::new("iteration").range(-3.0, 103.0),
        Axis::new(label).from_zero(),
        130.0,
    );
    // The first iterations have large values: the axis includes their quartiles, not their whiskers.
    let first = run.history.first().and_then(|g| BoxStats::of(what(g)));
    let last_best = run.history.last().map_or(0.0, |g| {
        what(g).iter().copied().fold(f64::INFINITY, f64::min)
    });
    if let Some(first) = first.filter(|first| first.third_quartile > 1e-9 && last_best > 0.0) {
        chart.y = Axis::new(label).range(
            last_best - 0.1 * (first.third_quartile - last_best),
            1.05 * first.third_quartile,
        );
    }
    let last = run.history.len().saturating_sub(1);
    let mut means = Vec::new();
    for (i, generation) in run.history.iter().enumerate() {
        let Some(stats) = BoxStats::of(what(generation)) else {
            continue;
        };
        means.push(((i + 1) as f64, stats.mean));
        if i % 5 == 0 || i == last {
            chart.add(Mark::Box {
                at: (i + 1) as f64,
                half_width: 1.6,
                stats,
                colour: palette::BLUE,
                legend: String::new(),
            });
        }
    }
    chart.add(Mark::line(
        means,
        Style::line("#b00020", 0.9).faint(0.6),
        "",
    ));
    chart
}

/// An oblique view: east to the right, north into the picture, depth down and three times larger.
pub(crate) fn oblique(run: &SwarmRun) -> Chart {
    let mut chart = Chart::new("", Axis::new("").range(-500.0, 3500.0), Axis::new(""), 0.0);
    (chart.map, chart.bare) = (true, true);
    oblique_surface(&mut chart);
    oblique_obstacles(&mut chart, run);
    oblique_path(&mut chart, run);
    chart
}

fn project(p: &Point3<f64>) -> (f64, f64) {
    (p.y + 0.45 * p.x, 0.32 * p.x - 3.0 * p.z)
}

fn oblique_surface(chart: &mut Chart) {
    let grid = Style::line("#cccccc", 0.8);
    for k in 0..=6 {
        let north = 500.0 * f64::from(k);
        let line = [0.0, 1500.0].map(|east| project(&Point3::new(north, east, 0.0)));
        chart.add(Mark::line(line.to_vec(), grid, ""));
    }
    for k in 0..=3 {
        let east = 500.0 * f64::from(k);
        let line = [0.0, 3000.0].map(|north| project(&Point3::new(north, east, 0.0)));
        chart.add(Mark::line(line.to_vec(), grid, ""));
    }
    for (at, text) in [
        (Point3::new(0.0, 1500.0, 0.0), "1500 m east"),
        (Point3::new(3000.0, 0.0, 0.0), "3000 m north, surface"),
    ] {
        chart.add(Mark::Label {
            at: project(&at),
            text: text.into(),
            colour: palette::GREY,
            size: 11.0,
            always: true,
        });
    }
}

/// Each obstacle as three great circles, at the closest approach.
fn oblique_obstacles(chart: &mut Chart, run: &SwarmRun) {
    for (obstacle, region) in run.obstacles.iter().zip(&run.regions) {
        let (colour, name) = colour(obstacle.class);
        let at_s = closest_s(run, region);
        let (centre, r) = (region.centre_at(at_s), region.radius_at(at_s));
        let ring = |axes: (Vector3<f64>, Vector3<f64>)| -> Vec<(f64, f64)> {
            (0..=64)
                .map(|k| {
                    let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / 64.0);
                    project(&(centre + axes.0 * (r * cos) + axes.1 * (r * sin)))
                })
                .collect()
        };
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        for (k, axes) in [(x, y), (y, z), (x, z)].into_iter().enumerate() {
            let points = ring(axes);
            chart.add(Mark::Area {
                rings: vec![points.clone()],
                style: Style::fill(colour, 0.16),
                legend: String::new(),
            });
            chart.add(Mark::line(
                points,
                Style::line(colour, 1.2),
                if k == 0 { name } else { "" },
            ));
        }
    }
}

/// The path, its shadow at the surface, and its ends.
fn oblique_path(chart: &mut Chart, run: &SwarmRun) {
    let shadow = run
        .path
        .points()
        .iter()
        .map(|p| project(&Point3::new(p.position.x, p.position.y, 0.0)));
    chart.add(Mark::line(
        shadow.collect(),
        Style::line(palette::GREY, 1.6).dash(Dash::Dashed),
        "shadow at the surface",
    ));
    let duration_s = run.path.duration_s();
    for k in 0..=20 {
        let place = run
            .path
            .at(run.path.start().time_s + duration_s * f64::from(k) / 20.0)
            .0;
        let drop = [
            project(&Point3::new(place.x, place.y, 0.0)),
            project(&place),
        ];
        chart.add(Mark::line(
            drop.to_vec(),
            Style::line(palette::GREY, 0.6),
            "",
        ));
    }
    let points = run.path.points().iter().map(|p| project(&p.position));
    chart.add(Mark::line(
        points.collect(),
        Style::line(palette::BLUE, 2.6),
        "path",
    ));
    for (place, text) in [
        (ends().0, "start, 20 m deep"),
        (ends().1, "target, 60 m deep"),
    ] {
        chart.add(Mark::Points {
            points: vec![project(&place)],
            shape: PointShape::Disc,
            size: 4.4,
            style: Style::fill(palette::BLACK, 1.0),
            legend: String::new(),
        });
        chart.add(Mark::Label {
            at: project(&place),
            text: text.into(),
            colour: palette::BLACK,
            size: 12.0,
            always: true,
        });
    }
}
