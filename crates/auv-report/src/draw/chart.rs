//! A chart: a frame with axes, marks in it, and a legend above.

use super::axis::Axis;
use super::marks::{Mark, Shape, Style};
use super::palette;
use super::svg::{Anchor, Font, Svg, width_of};

/// A corner of a chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corner {
    /// Upper left.
    UpperLeft,
    /// Upper right.
    UpperRight,
    /// Lower left.
    LowerLeft,
    /// Lower right.
    LowerRight,
}

/// A chart.
#[derive(Clone, Debug, Default)]
pub struct Chart {
    /// Its title.
    pub title: String,
    /// The abscissa.
    pub x: Axis,
    /// The ordinate.
    pub y: Axis,
    /// What it shows, drawn in order.
    pub marks: Vec<Mark>,
    /// Height of the frame, pixels; with `map` it follows from the width.
    pub height: f64,
    /// Whether it is a map: both axes in metres at one scale, with a scale bar and a north arrow.
    pub map: bool,
    /// Velocity of the water shown as an arrow, (east, north) in m/s.
    pub current_mps: Option<(f64, f64)>,
    /// Where the scale bar, the north arrow and the current stand.
    pub compass: Option<Corner>,
    /// Legends besides those of the marks: a sample of the mark, drawn as the legend draws it.
    pub legends: Vec<Mark>,
    /// Whether neither axes nor grid are drawn.
    pub bare: bool,
}

/// Where the parts of a chart stand, in pixels, and the ranges of its axes.
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: (f64, f64),
    y: (f64, f64),
    reversed: bool,
}

impl Frame {
    fn at(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let across = (x - self.x.0) / (self.x.1 - self.x.0);
        let up = (y - self.y.0) / (self.y.1 - self.y.0);
        let down = if self.reversed { up } else { 1.0 - up };
        (
            self.left + across * self.width,
            self.top + down * self.height,
        )
    }

    fn scale(&self) -> f64 {
        self.width / (self.x.1 - self.x.0)
    }
}

const LEGEND_SIZE: f64 = 11.5;
const LEGEND_ROW: f64 = 17.0;
const SWATCH: f64 = 22.0;

impl Chart {
    /// A chart of a height.
    #[must_use]
    pub fn new(title: &str, x: Axis, y: Axis, height: f64) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            height,
            ..Self::default()
        }
    }

    /// A map in metres: east to the right, north up.
    #[must_use]
    pub fn map(title: &str) -> Self {
        Self {
            map: true,
            compass: Some(Corner::LowerRight),
            ..Self::new(title, Axis::new("east (m)"), Axis::new("north (m)"), 0.0)
        }
    }

    /// Adds a mark.
    pub fn add(&mut self, mark: Mark) {
        self.marks.push(mark);
    }

    fn frame(&self, x: f64, y: f64, width: f64) -> Frame {
        let (mut seen_x, mut seen_y) = (
            (f64::INFINITY, f64::NEG_INFINITY),
            (f64::INFINITY, f64::NEG_INFINITY),
        );
        for mark in &self.marks {
            mark.extent(&mut |px, py| {
                for (value, seen) in [(px, &mut seen_x), (py, &mut seen_y)] {
                    if let Some(value) = value.filter(|v| v.is_finite()) {
                        *seen = (seen.0.min(value), seen.1.max(value));
                    }
                }
            });
        }
        let (mut range_x, mut range_y) = (self.x.fitted(seen_x), self.y.fitted(seen_y));
        let (before, after) = if self.bare { (4.0, 4.0) } else { (58.0, 10.0) };
        let inner = width - before - after;
        let mut height = self.height;
        if self.map {
            // Neither flatter than 1 : 2.5 nor taller than 1.15 : 1.
            let span = |(low, high): (f64, f64)| high - low;
            let widen = |range: &mut (f64, f64), least: f64| {
                let room = 0.5 * (least - span(*range)).max(0.0);
                *range = (range.0 - room, range.1 + room);
            };
            let (across, up) = (span(range_x), span(range_y));
            widen(&mut range_y, across / 2.5);
            widen(&mut range_x, up / 1.15);
            height = inner * span(range_y) / span(range_x);
        }
        let top = y + self.head_height(width);
        Frame {
            left: x + before,
            top,
            width: inner,
            height,
            x: range_x,
            y: range_y,
            reversed: self.y.reversed,
        }
    }

    fn legend_rows(&self, width: f64) -> Vec<Vec<&Mark>> {
        let mut rows: Vec<Vec<&Mark>> = Vec::new();
        let mut used = f64::INFINITY;
        let mut named: Vec<&str> = Vec::new();
        for mark in self.marks.iter().chain(&self.legends) {
            let name = mark.legend();
            if name.is_empty() || named.contains(&name) {
                continue;
            }
            named.push(name);
            let needs = SWATCH + 8.0 + width_of(name, LEGEND_SIZE) + 14.0;
            if used + needs > width - 20.0 {
                rows.push(Vec::new());
                used = 0.0;
            }
            used += needs;
            if let Some(row) = rows.last_mut() {
                row.push(mark);
            }
        }
        rows
    }

    fn head_height(&self, width: f64) -> f64 {
        let title = if self.title.is_empty() { 6.0 } else { 24.0 };
        title + LEGEND_ROW * self.legend_rows(width).len() as f64 + 4.0
    }

    /// Height of the chart, title and labels included, pixels.
    pub(crate) fn draw_height(&self, width: f64) -> f64 {
        let foot = if self.bare { 4.0 } else { 42.0 };
        self.head_height(width) + self.frame(0.0, 0.0, width).height + foot
    }

    pub(crate) fn draw(&self, svg: &mut Svg, id: usize, x: f64, y: f64, width: f64) {
        let frame = self.frame(x, y, width);
        let mut title = Font::new(13.0, Anchor::Start);
        title.bold = true;
        if !self.title.is_empty() {
            svg.text(x, y + 15.0, &self.title, &title);
        }
        let mut row_y = y + if self.title.is_empty() { 6.0 } else { 24.0 };
        for row in self.legend_rows(width) {
            let mut at = x + 4.0;
            for mark in row {
                swatch(svg, mark, at, row_y + 0.5 * LEGEND_ROW);
                let font = Font::new(LEGEND_SIZE, Anchor::Start);
                svg.text(at + SWATCH + 6.0, row_y + 12.5, mark.legend(), &font);
                at += SWATCH + 8.0 + width_of(mark.legend(), LEGEND_SIZE) + 14.0;
            }
            row_y += LEGEND_ROW;
        }
        if !self.bare {
            self.axes(svg, &frame, x);
        }
        let area = (frame.left, frame.top, frame.width, frame.height);
        svg.clipped(id, area, |svg| {
            for mark in &self.marks {
                draw_mark(svg, &frame, mark);
            }
            self.labels(svg, &frame);
        });
        if !self.bare {
            svg.rect(
                frame.left,
                frame.top,
                frame.width,
                frame.height,
                &Style::line(palette::GREY, 1.0),
            );
        }
        if let Some(corner) = self.compass {
            self.compass(svg, &frame, corner);
        }
    }

    fn axes(&self, svg: &mut Svg, frame: &Frame, x: f64) {
        let grid = Style::line("#ececec", 1.0);
        let tick = Style::line(palette::GREY, 1.0);
        let bottom = frame.top + frame.height;
        let font = Font::new(11.0, Anchor::Middle);
        let widest = |ticks: &[(f64, String)]| {
            ticks
                .iter()
                .map(|t| width_of(&t.1, 11.0))
                .fold(20.0, f64::max)
        };
        let mut most = 10;
        let ticks = loop {
            let ticks = self.x.ticks(frame.x, most);
            let room = frame.width / ticks.len().max(1) as f64;
            if most <= 2 || widest(&ticks) + 8.0 <= room || !self.x.names.is_empty() {
                break ticks;
            }
            most -= 1;
        };
        for (value, text) in ticks {
            let at = frame.at((value, frame.y.0)).0;
            if self.x.names.is_empty() {
                svg.line((at, frame.top), (at, bottom), &grid);
            }
            svg.line((at, bottom), (at, bottom + 4.0), &tick);
            svg.text(at, bottom + 16.0, &text, &font);
        }
        let font = Font::new(11.0, Anchor::End);
        let most = (frame.height / 34.0).clamp(2.0, 10.0) as usize;
        for (value, text) in self.y.ticks(frame.y, most) {
            let at = frame.at((frame.x.0, value)).1;
            svg.line((frame.left, at), (frame.left + frame.width, at), &grid);
            svg.line((frame.left - 4.0, at), (frame.left, at), &tick);
            svg.text(frame.left - 7.0, at + 4.0, &text, &font);
        }
        let label = Font::new(12.0, Anchor::Middle);
        svg.text(
            frame.left + 0.5 * frame.width,
            bottom + 33.0,
            &self.x.label,
            &label,
        );
        let upright = Font {
            upright: true,
            ..label
        };
        svg.text(
            x + 10.0,
            frame.top + 0.5 * frame.height,
            &self.y.label,
            &upright,
        );
    }

    /// Texts beside points, each on the first of four sides where it covers no other.
    fn labels(&self, svg: &mut Svg, frame: &Frame) {
        let mut taken: Vec<[f64; 4]> = Vec::new();
        let texts = |forced: bool| {
            self.marks
                .iter()
                .filter(move |mark| matches!(mark, Mark::Label { always, .. } if *always == forced))
        };
        for mark in texts(true).chain(texts(false)) {
            let Mark::Label {
                at,
                text,
                colour,
                size,
                always,
            } = mark
            else {
                continue;
            };
            let (x, y) = frame.at(*at);
            let wide = width_of(text, *size);
            let places = [
                (x + 6.0, y + 0.35 * size, Anchor::Start),
                (x - 6.0, y + 0.35 * size, Anchor::End),
                (x, y - 7.0, Anchor::Middle),
                (x, y + size + 4.0, Anchor::Middle),
            ];
            let boxed = |&(px, py, anchor): &(f64, f64, Anchor)| {
                let left = match anchor {
                    Anchor::Start => px,
                    Anchor::Middle => px - 0.5 * wide,
                    Anchor::End => px - wide,
                };
                [left, py - 0.8 * size, left + wide, py + 0.2 * size]
            };
            let inside = |b: &[f64; 4]| {
                b[0] >= frame.left
                    && b[2] <= frame.left + frame.width
                    && b[1] >= frame.top
                    && b[3] <= frame.top + frame.height
            };
            let free = places.iter().find(|place| {
                let b = boxed(place);
                inside(&b)
                    && taken
                        .iter()
                        .all(|t| b[0] > t[2] || b[2] < t[0] || b[1] > t[3] || b[3] < t[1])
            });
            let fallback = places
                .iter()
                .find(|place| inside(&boxed(place)))
                .filter(|_| *always);
            if let Some(place) = free.or(fallback) {
                taken.push(boxed(place));
                let mut font = Font::new(*size, place.2);
                font.colour = colour;
                font.halo = true;
                svg.text(place.0, place.1, text, &font);
            }
        }
    }

    fn compass(&self, svg: &mut Svg, frame: &Frame, corner: Corner) {
        let metres_wide = 96.0 / frame.scale();
        let mut bar_m = super::axis::nice_step(metres_wide);
        if bar_m > metres_wide {
            bar_m = super::axis::nice_step(metres_wide / 2.5);
        }
        let bar = bar_m * frame.scale();
        let (wide, high) = (
            bar.max(70.0) + 54.0,
            50.0 + if self.current_mps.is_some() {
                30.0
            } else {
                0.0
            },
        );
        let left = match corner {
            Corner::UpperLeft | Corner::LowerLeft => frame.left + 8.0,
            Corner::UpperRight | Corner::LowerRight => frame.left + frame.width - wide - 8.0,
        };
        let top = match corner {
            Corner::UpperLeft | Corner::UpperRight => frame.top + 8.0,
            Corner::LowerLeft | Corner::LowerRight => frame.top + frame.height - high - 8.0,
        };
        svg.rect(
            left,
            top,
            wide,
            high,
            &Style::line("#bbbbbb", 1.0).filled("#ffffff", 0.88),
        );
        let black = Style::line(palette::BLACK, 1.6);
        let font = Font::new(11.0, Anchor::Middle);
        let (x, y) = (left + 10.0, top + 36.0);
        svg.path(
            [(x, y - 5.0), (x, y), (x + bar, y), (x + bar, y - 5.0)],
            false,
            &black,
        );
        let text = if bar_m >= 1000.0 {
            format!("{} km", bar_m / 1000.0)
        } else {
            format!("{bar_m} m")
        };
        svg.text(x + 0.5 * bar, y - 8.0, &text, &font);
        let north = left + wide - 18.0;
        arrow(svg, (north, top + 42.0), (north, top + 18.0), &black);
        svg.text(north, top + 14.0, "N", &font);
        if let Some((east, north)) = self.current_mps {
            let speed = libm_hypot(east, north);
            let middle = (left + 22.0, top + 64.0);
            if speed > 1e-6 {
                let (dx, dy) = (east / speed * 11.0, -north / speed * 11.0);
                arrow(
                    svg,
                    (middle.0 - dx, middle.1 - dy),
                    (middle.0 + dx, middle.1 + dy),
                    &Style::line(palette::BLUE, 2.0),
                );
            }
            svg.text(
                middle.0 + 16.0,
                middle.1 + 4.0,
                &format!("current {speed:.2} m/s"),
                &Font::new(10.5, Anchor::Start),
            );
        }
    }
}

fn libm_hypot(x: f64, y: f64) -> f64 {
    (x * x + y * y).sqrt()
}

/// A line with a head.
fn arrow(svg: &mut Svg, from: (f64, f64), to: (f64, f64), style: &Style) {
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

fn draw_mark(svg: &mut Svg, frame: &Frame, mark: &Mark) {
    match mark {
        Mark::Line { points, style, .. } => {
            for run in points.split(|p| !(p.0.is_finite() && p.1.is_finite())) {
                svg.path(run.iter().map(|&p| frame.at(p)), false, style);
            }
        }
        Mark::Band { points, style, .. } => {
            let low = points.iter().map(|&(x, low, _)| frame.at((x, low)));
            let high = points.iter().rev().map(|&(x, _, high)| frame.at((x, high)));
            svg.path(low.chain(high), true, style);
        }
        Mark::Area { rings, style, .. } => {
            let rings: Vec<Vec<_>> = rings
                .iter()
                .map(|ring| ring.iter().map(|&p| frame.at(p)).collect())
                .collect();
            svg.area(&rings, style);
        }
        Mark::Box {
            at,
            half_width,
            stats,
            colour,
            ..
        } => draw_box(svg, frame, *at, *half_width, stats, colour),
        Mark::Bar {
            at,
            half_width,
            value,
            style,
            ..
        } => {
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
        Mark::Points {
            points,
            shape,
            size,
            style,
            ..
        } => {
            for &point in points.iter().filter(|p| p.0.is_finite() && p.1.is_finite()) {
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
        } => {
            let y = frame.at((frame.x.0, *value)).1;
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
        Mark::Label { .. } => {}
    }
}

fn draw_box(
    svg: &mut Svg,
    frame: &Frame,
    at: f64,
    half_width: f64,
    stats: &super::BoxStats,
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
        Shape::Cross,
        size,
        &Style::line("#b00020", 1.3),
    );
}

fn draw_point(svg: &mut Svg, (x, y): (f64, f64), shape: Shape, size: f64, style: &Style) {
    let s = size;
    match shape {
        Shape::Disc => svg.circle(x, y, s, style, ""),
        Shape::Square => svg.rect(x - s, y - s, 2.0 * s, 2.0 * s, style),
        Shape::Diamond => svg.path(
            [
                (x, y - 1.25 * s),
                (x + 1.25 * s, y),
                (x, y + 1.25 * s),
                (x - 1.25 * s, y),
            ],
            true,
            style,
        ),
        Shape::Triangle => svg.path(
            [
                (x, y - 1.2 * s),
                (x + 1.1 * s, y + 0.8 * s),
                (x - 1.1 * s, y + 0.8 * s),
            ],
            true,
            style,
        ),
        Shape::Cross => {
            svg.line((x - s, y - s), (x + s, y + s), style);
            svg.line((x - s, y + s), (x + s, y - s), style);
        }
    }
}

/// A sample of a mark in a legend, about 22 pixels wide, round height `y`.
fn swatch(svg: &mut Svg, mark: &Mark, x: f64, y: f64) {
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
