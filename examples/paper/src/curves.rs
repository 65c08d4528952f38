//! E0, Fig. 2: B-spline curves of one control polygon by their order.

use crate::output::{Output, Section, internal};
use auv_bspline::BSpline;
use auv_examples::Failure;
use auv_report::{Axis, Chart, Dash, Figure, Mark, PointShape, Style, palette};
use auv_types::Point3;

fn control_points() -> Vec<Point3<f64>> {
    let points = [
        (0.0, 0.0),
        (260.0, 420.0),
        (620.0, 520.0),
        (900.0, 60.0),
        (1300.0, -120.0),
        (1650.0, 360.0),
        (2000.0, 480.0),
        (2300.0, 100.0),
    ]
    .map(|(east, north)| Point3::new(north, east, 20.0));
    points.to_vec()
}

fn flat(p: &Point3<f64>) -> (f64, f64) {
    (p.y, p.x)
}

pub(crate) fn figure2(output: &Output) -> Result<Vec<Section>, Failure> {
    let control = control_points();
    let mut chart = Chart::map("");
    (chart.x, chart.y) = (Axis::new("east (m)"), Axis::new("north (m)"));
    let polygon: Vec<_> = control.iter().map(flat).collect();
    chart.add(Mark::line(
        polygon.clone(),
        Style::line(palette::GREY, 1.0).dash(Dash::Dashed),
        "control polygon",
    ));
    let straight_m: f64 = control
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).norm())
        .sum();
    let mut table = auv_report::Table::new([
        "order K",
        "degree",
        "length (m)",
        "greatest curvature (1/km)",
    ]);
    let mut lengths_m = vec![straight_m];
    let colours = [
        palette::SKY,
        palette::BLUE,
        palette::GREEN,
        palette::VERMILLION,
    ];
    for (order, colour) in (3..=6).zip(colours) {
        let curve = BSpline::new(order, control.clone()).map_err(internal)?;
        let points = curve.uniform_points(400).map_err(internal)?;
        let sharpest = (0..=2000)
            .map(|i| curve.curvature_at(curve.parameter_end() * f64::from(i) / 2000.0))
            .fold(0.0, f64::max);
        lengths_m.push(curve.arc_length_m(0.01));
        table.row([
            order.to_string(),
            (order - 1).to_string(),
            format!("{:.1}", curve.arc_length_m(0.01)),
            format!("{:.2}", 1000.0 * sharpest),
        ]);
        chart.add(Mark::line(
            points.iter().map(flat).collect(),
            Style::line(colour, 2.0),
            &format!("K = {order}"),
        ));
    }
    chart.add(Mark::Points {
        points: polygon,
        shape: PointShape::Disc,
        size: 3.6,
        style: Style::line(palette::BLACK, 1.0).filled("#ffffff", 1.0),
        legend: "control point".into(),
    });
    let mut figure = Figure::new(
        "Fig. 2: B-spline curves of one control polygon",
        "Eight control points, clamped uniform knots; the order K (degree + 1) sets how closely a curve follows its polygon.",
    );
    figure.charts.push(chart);
    output.draw("fig2.svg", &figure)?;

    Ok(vec![section2(&table, &lengths_m)])
}

/// `lengths_m`: of the control polygon and of the curves of orders 3 to 6.
fn section2(table: &auv_report::Table, lengths_m: &[f64]) -> Section {
    let mut section = Section::new("Fig. 2: B-spline curves by order");
    section.show("fig2.svg", "B-spline curves of orders 3 to 6");
    section.say("Configuration: 8 control points, clamped uniform knots, orders 3 to 6. The caption's \"K = 3.5\" is not an order; the planner uses K = 4. \
                 The paper prints no numbers for this figure. The fixtures of Fig. 5 to 10 (decoding, feasibility, crossover, mutation, swarm update) are unit tests of the planners' crates.");
    section.table(table);
    let falls = lengths_m.windows(2).all(|pair| pair[1] < pair[0]);
    section.claim(
        "the order controls the curve, low orders follow the control polygon closely (Sec. 3.3, Fig. 2)",
        falls,
        format!("lengths fall with the order, from {:.0} m of the polygon to {:.0} m at K = 6", lengths_m[0], lengths_m[4]),
    );
    section
}
