//! A picture of a scene with its path: land, depth, current, isochrones, obstacles.

use super::isochrones::isochrones;
use auv_obstacles::Region;
use auv_ocean::SeaBed;
use auv_planning::Trajectory;
use auv_planning::format::Scene;
use auv_report::{Chart, Figure, Mark, PointShape, Style, palette};
use auv_types::{Bounds, Point3};

/// Samples of the bed across the longer side of a picture, and arrows of the current.
const BED_SAMPLES: f64 = 160.0;
const ARROWS: f64 = 22.0;
/// The room beside the path, as a share of its size.
const ROOM: f64 = 0.15;
/// The longest arrow, in distances between arrows.
const LONGEST: f64 = 0.9;

/// The picture as SVG: the map as it is at departure, and obstacles also when the path passes them.
pub(crate) fn svg(scene: &Scene, path: &Trajectory) -> String {
    let (low, high) = extent(scene, path);
    let mut chart = Chart::map("");
    chart.x = chart.x.range(low.y, high.y);
    chart.y = chart.y.range(low.x, high.x);
    land(&mut chart, scene, low, high);
    current(&mut chart, scene, low, high);
    arrivals(&mut chart, scene, path, (low, high));
    obstacles(&mut chart, scene, path);
    let flown = path.points().iter().map(|p| flat(&p.position)).collect();
    chart.add(Mark::line(flown, Style::line(palette::BLACK, 2.0), "path"));
    let ends = vec![flat(&scene.start), flat(&scene.target)];
    chart.add(Mark::Points {
        points: ends,
        shape: PointShape::Disc,
        size: 4.0,
        style: Style::fill(palette::BLACK, 1.0),
        legend: "start and target".into(),
    });
    let duration = format!("{:.1} s, {:.1} m", path.duration_s(), path.length_m());
    let mut figure = Figure::new(&scene.id, &duration);
    figure.charts.push(chart);
    figure.to_svg()
}

/// East and north of a place.
fn flat(place: &Point3<f64>) -> (f64, f64) {
    (place.y, place.x)
}

/// The corners of the map: the path with some room, no farther than the box.
fn extent(scene: &Scene, path: &Trajectory) -> (Point3<f64>, Point3<f64>) {
    let start = Bounds::new(scene.start, scene.start).grown_to(&scene.target);
    let points = path.points().iter();
    let shown = points.fold(start, |shown, p| shown.grown_to(&p.position));
    let size_m = (shown.high - shown.low).xy().norm();
    let room = auv_types::Vector3::new(1.0, 1.0, 0.0) * (ROOM * size_m).max(1.0);
    let (low, high) = (shown.low - room, shown.high + room);
    let inside = |corner: Point3<f64>| scene.bounds.map_or(corner, |bounds| bounds.clamp(&corner));
    (inside(low), inside(high))
}

/// Areas that are too shallow for the depth of the start, and land.
fn land(chart: &mut Chart, scene: &Scene, low: Point3<f64>, high: Point3<f64>) {
    let Some(bed) = &scene.bed else {
        return;
    };
    let needed_m = scene.start.z + scene.min_altitude_m;
    for (least_m, colour, legend) in [
        (
            needed_m,
            "#dbe6f0",
            "shallower than the start with its altitude",
        ),
        (0.1, "#cfc3a5", "land"),
    ] {
        let rings = shallower(bed, least_m, low, high);
        if !rings.is_empty() {
            chart.add(Mark::Area {
                rings,
                style: Style::fill(colour, 1.0),
                legend: legend.into(),
            });
        }
    }
}

/// Rectangles where the water is shallower than a depth, one for each stretch of a row of samples.
fn shallower(
    bed: &dyn SeaBed,
    least_m: f64,
    low: Point3<f64>,
    high: Point3<f64>,
) -> Vec<Vec<(f64, f64)>> {
    let size = high - low;
    let cell_m = size.x.max(size.y) / BED_SAMPLES;
    let (rows, columns) = ((size.x / cell_m) as usize, (size.y / cell_m) as usize);
    let mut rings = Vec::new();
    for row in 0..rows {
        let north = low.x + cell_m * row as f64;
        let dry = |column: usize| {
            let east = low.y + cell_m * (column as f64 + 0.5);
            column < columns && bed.depth_at(north + 0.5 * cell_m, east) < least_m
        };
        let mut first = None;
        for column in 0..=columns {
            if dry(column) {
                first.get_or_insert(column);
            } else if let Some(first) = first.take() {
                let (west, east) = (
                    low.y + cell_m * first as f64,
                    low.y + cell_m * column as f64,
                );
                let top = north + cell_m;
                rings.push(vec![(west, north), (east, north), (east, top), (west, top)]);
            }
        }
    }
    rings
}

/// Arrows of the current at departure, at the depth of the start; the longest is the strongest.
fn current(chart: &mut Chart, scene: &Scene, low: Point3<f64>, high: Point3<f64>) {
    let Some(field) = &scene.current else {
        return;
    };
    let size = high - low;
    let step_m = size.x.max(size.y) / ARROWS;
    let mut arrows = Vec::new();
    for row in 0..=(size.x / step_m) as usize {
        for column in 0..=(size.y / step_m) as usize {
            let (north, east) = (low.x + step_m * row as f64, low.y + step_m * column as f64);
            let place = Point3::new(north, east, scene.start.z);
            let problem = scene.problem();
            if problem.deepest_at(north, east) > 0.0 {
                let water = auv_ocean::CurrentField::velocity_at(field, &place, scene.departure_s);
                arrows.push((place, water));
            }
        }
    }
    let most_mps = arrows.iter().map(|(_, w)| w.norm()).fold(0.0, f64::max);
    for (place, water) in arrows {
        if water.norm() > 0.02 * most_mps {
            let end = place + water * (LONGEST * step_m / most_mps);
            chart.add(Mark::Arrow {
                from: flat(&place),
                to: flat(&end),
                style: Style::line(palette::BLUE, 0.9),
            });
        }
    }
    chart.legends.push(Mark::line(
        Vec::new(),
        Style::line(palette::BLUE, 0.9),
        &format!("current at departure, up to {most_mps:.2} m/s"),
    ));
}

/// Lines of equal arrival, where the water moves or land is near.
fn arrivals(
    chart: &mut Chart,
    scene: &Scene,
    path: &Trajectory,
    corners: (Point3<f64>, Point3<f64>),
) {
    if scene.current.is_none() && scene.bed.is_none() {
        return;
    }
    let (pieces, apart_s) = isochrones(&scene.problem(), path.duration_s(), corners);
    let style = || Style::line(palette::PURPLE, 0.8);
    for ends in pieces {
        let points = ends.map(|(north, east)| (east, north)).to_vec();
        chart.add(Mark::line(points, style(), ""));
    }
    let legend = format!("earliest arrival, every {apart_s} s");
    chart.legends.push(Mark::line(Vec::new(), style(), &legend));
}

/// Obstacles as they are when the path passes them, and where they are at departure.
fn obstacles(chart: &mut Chart, scene: &Scene, path: &Trajectory) {
    for (k, region) in scene.regions.iter().enumerate() {
        let passed_s = nearest_s(region, path);
        for (time_s, style, legend) in [
            (
                scene.departure_s,
                Style::line(palette::VERMILLION, 0.6).faint(0.5),
                "obstacle at departure",
            ),
            (
                passed_s,
                Style::line(palette::VERMILLION, 1.0).filled(palette::VERMILLION, 0.15),
                "obstacle when the path is nearest",
            ),
        ] {
            chart.add(Mark::Circle {
                centre: flat(&region.centre_at(time_s)),
                radius: region.radius_at(time_s).max(0.0),
                style,
                tip: format!("obstacle {} at {time_s:.0} s", region.obstacle.0),
                // One entry for all of a kind.
                legend: if k == 0 { legend.into() } else { String::new() },
            });
        }
    }
}

/// When the path is nearest to an obstacle, at one of its points.
fn nearest_s(region: &Region, path: &Trajectory) -> f64 {
    let nearest = path
        .points()
        .iter()
        .min_by(|a, b| region.distance_m(a).total_cmp(&region.distance_m(b)));
    nearest.map_or(0.0, |point| point.time_s)
}
