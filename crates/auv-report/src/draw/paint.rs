//! Marks as they are drawn in a chart and in its legend.

use super::frame::Frame;
use super::marks::{Mark, PointShape, Style};
use super::palette;
use super::svg::{Anchor, Font, Svg};
use auv_sim::statistics::BoxStats;

/// Width of a sample in a legend, pixels.
pub(super) const SWATCH: f64 = 22.0;

pub(super) fn libm_hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// A line with a head.
pub(super) fn arrow(svg: &mut Svg, from: (f64, f64), to: (f64, f64), style: &Style) {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = libm_hypot(dx, dy);
    if length < 1e-9 {
        return;
    }
    let (ux, uy) = (dx / length, dy / length);
    let head = (3.0 + 2.0 * style.width).min(0.6 * length);
    let base = (to.0 - head * ux, to.1 - head * uy);
    svg.line(from, base, style);
    let half = 0.45 * head;
    let corners = [
        to,
        (base.0 - half * uy, base.1 + half * ux),
        (base.0 + half * uy, base.1 - half * ux),
    ];
    let fill = Style::fill(style.stroke.unwrap_or(palette::BLACK), style.stroke_opacity);
    svg.path(corners, true, &fill);
}

pub(super) fn draw_mark(svg: &mut Svg, frame: &Frame, mark: &Mark) {
    match mark {
        Mark::Line { points, style, .. } => draw_line(svg, frame, points, style),
        Mark::Band { points, style, .. } => {
            let low = points.iter().map(|&(x, low, _)| frame.at((x, low)));
            let high = points.iter().rev().map(|&(x, _, high)| frame.at((x, high)));
            svg.path(low.chain(high), true, style);
        }
        Mark::Area { rings, style, .. } => draw_area(svg, frame, rings, style),
        Mark::Box {
            at,
            half_width,
            stats,
            colour,
            ..
        } => draw_box(svg, frame, (*at, *half_width), stats, colour),
        Mark::Bar {
            at,
            half_width,
            value,
            style,
            ..
        } => draw_bar(svg, frame, (*at, *half_width), *value, style),
        Mark::Points {
            points,
            shape,
            size,
            style,
            ..
        } => {
            for &point in points.iter().filter(|p| frame.holds(**p)) {
                draw_point(svg, frame.at(point), *shape, *size, style);
            }
        }
        Mark::Circle {
            centre,
            radius,
            style,
            tip,
            ..
        } => {
            let (x, y) = frame.at(*centre);
            svg.circle(x, y, radius * frame.scale(), style, tip);
        }
        Mark::Arrow { from, to, style } => arrow(svg, frame.at(*from), frame.at(*to), style),
        Mark::Level {
            value,
            style,
            label,
        } => draw_level(svg, frame, *value, style, label),
        Mark::Label { .. } => {}
    }
}

/// A polyline, interrupted at points that are not finite.
fn draw_line(svg: &mut Svg, frame: &Frame, points: &[(f64, f64)], style: &Style) {
    for run in points.split(|p| !(p.0.is_finite() && p.1.is_finite())) {
        svg.path(run.iter().map(|&p| frame.at(p)), false, style);
    }
}

fn draw_area(svg: &mut Svg, frame: &Frame, rings: &[Vec<(f64, f64)>], style: &Style) {
    let rings: Vec<Vec<_>> = rings
        .iter()
        .map(|ring| ring.iter().map(|&p| frame.at(p)).collect())
        .collect();
    svg.area(&rings, style);
}

fn draw_bar(svg: &mut Svg, frame: &Frame, (at, half_width): (f64, f64), value: f64, style: &Style) {
    let (left, top) = frame.at((at - half_width, value.max(0.0)));
    let (right, bottom) = frame.at((at + half_width, value.min(0.0)));
    svg.rect(
        left,
        top.min(bottom),
        right - left,
        (bottom - top).abs(),
        style,
    );
}

/// A horizontal line with its text above it, or below it at the upper edge.
fn draw_level(svg: &mut Svg, frame: &Frame, value: f64, style: &Style, label: &str) {
    let y = frame.at((frame.x.0, value)).1;
    svg.line((frame.left, y), (frame.left + frame.width, y), style);
    let mut font = Font::new(11.0, Anchor::End);
    font.halo = true;
    font.colour = style.stroke.unwrap_or(palette::BLACK);
    let below = y - frame.top < 16.0;
    svg.text(
        frame.left + frame.width - 6.0,
        if below { y + 13.0 } else { y - 4.0 },
        label,
        &font,
    );
}

fn draw_box(
    svg: &mut Svg,
    frame: &Frame,
    (at, half_width): (f64, f64),
    stats: &BoxStats,
    colour: &'static str,
) {
    let (left, upper) = frame.at((at - half_width, stats.third_quartile));
    let (right, lower) = frame.at((at + half_width, stats.first_quartile));
    let middle = 0.5 * (left + right);
    let level = |value: f64| frame.at((at, value)).1;
    let thin = Style::line(colour, 1.2);
    let quarter = 0.25 * (right - left);
    for (whisker, edge) in [(stats.high, upper), (stats.low, lower)] {
        svg.line((middle, edge), (middle, level(whisker)), &thin);
        svg.line(
            (middle - quarter, level(whisker)),
            (middle + quarter, level(whisker)),
            &thin,
        );
    }
    svg.rect(
        left,
        upper.min(lower),
        right - left,
        (lower - upper).abs(),
        &thin.filled(colour, 0.3),
    );
    svg.line(
        (left, level(stats.median)),
        (right, level(stats.median)),
        &Style::line(colour, 2.2),
    );
    let size = (0.3 * (right - left)).clamp(1.8, 3.6);
    draw_point(
        svg,
        (middle, level(stats.mean)),
        PointShape::Cross,
        size,
        &Style::line("#b00020", 1.3),
    );
}

fn draw_point(svg: &mut Svg, (x, y): (f64, f64), shape: PointShape, size: f64, style: &Style) {
    let s = size;
    match shape {
        PointShape::Disc => svg.circle(x, y, s, style, ""),
        PointShape::Square => svg.rect(x - s, y - s, 2.0 * s, 2.0 * s, style),
        PointShape::Diamond => svg.path(
            [
                (x, y - 1.25 * s),
                (x + 1.25 * s, y),
                (x, y + 1.25 * s),
                (x - 1.25 * s, y),
            ],
            true,
            style,
        ),
        PointShape::Triangle => svg.path(
            [
                (x, y - 1.2 * s),
                (x + 1.1 * s, y + 0.8 * s),
                (x - 1.1 * s, y + 0.8 * s),
            ],
            true,
            style,
        ),
        PointShape::Cross => {
            svg.line((x - s, y - s), (x + s, y + s), style);
            svg.line((x - s, y + s), (x + s, y - s), style);
        }
    }
}

/// A sample of a mark in a legend, about 22 pixels wide, round height `y`.
pub(super) fn swatch(svg: &mut Svg, mark: &Mark, x: f64, y: f64) {
    let middle = x + 0.5 * SWATCH;
    match mark {
        Mark::Line { style, .. } => svg.line((x, y), (x + SWATCH, y), style),
        Mark::Band { style, .. } | Mark::Area { style, .. } | Mark::Bar { style, .. } => {
            svg.rect(x, y - 5.0, SWATCH, 10.0, style);
        }
        Mark::Box { colour, .. } => {
            let thin = Style::line(colour, 1.2);
            svg.line((middle, y - 7.0), (middle, y + 7.0), &thin);
            svg.rect(middle - 6.0, y - 4.0, 12.0, 8.0, &thin.filled(colour, 0.3));
            svg.line(
                (middle - 6.0, y),
                (middle + 6.0, y),
                &Style::line(colour, 2.2),
            );
        }
        Mark::Points {
            shape, size, style, ..
        } => draw_point(svg, (middle, y), *shape, size.min(5.0), style),
        Mark::Circle { style, .. } => svg.circle(middle, y, 6.0, style, ""),
        Mark::Arrow { .. } | Mark::Level { .. } | Mark::Label { .. } => {}
    }
}
