//! A chart: a frame with axes, marks in it, and a legend above.

use super::axis::Axis;
use super::frame::Frame;
use super::marks::{Mark, Style};
use super::paint::{SWATCH, draw_mark, swatch};
use super::palette;
use super::svg::{Anchor, Font, Svg};
use super::width::width_of;

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

const LEGEND_SIZE: f64 = 11.5;
const LEGEND_ROW: f64 = 17.0;
/// Between two legends of a row, pixels.
const LEGEND_GAP: f64 = 14.0;

/// The width of a mark's sample and its name, pixels.
fn legend_width(name: &str) -> f64 {
    SWATCH + 8.0 + width_of(name, LEGEND_SIZE)
}

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
        for mark in self.marks.iter().filter(|_| self.y.range.is_none()) {
            if let Mark::Level { value, .. } = mark {
                // Its label stands above it.
                range_y.1 = range_y.1.max(value + 0.1 * (range_y.1 - range_y.0));
            }
        }
        let (before, after) = if self.bare { (4.0, 4.0) } else { (58.0, 10.0) };
        let inner = width - before - after;
        let mut height = self.height;
        if self.map {
            // Height over width stays between 1 : 2.5 and 1.15 : 1.
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
            let needs = legend_width(name);
            if used + needs > width - 8.0 {
                rows.push(Vec::new());
                used = 0.0;
            }
            used += needs + LEGEND_GAP;
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
                at += legend_width(mark.legend()) + LEGEND_GAP;
            }
            row_y += LEGEND_ROW;
        }
        if !self.bare {
            self.axes(svg, &frame, x);
        }
        let area = (frame.left, frame.top, frame.width, frame.height);
        svg.clip_path(id, area);
        // A point on the edge of the frame is drawn whole; one beyond it is not drawn.
        let point = |mark: &Mark| matches!(mark, Mark::Points { .. });
        for marks in self.marks.chunk_by(|a, b| point(a) == point(b)) {
            if point(&marks[0]) {
                for mark in marks {
                    draw_mark(svg, &frame, mark);
                }
            } else {
                svg.clipped(id, |svg| {
                    for mark in marks {
                        draw_mark(svg, &frame, mark);
                    }
                });
            }
        }
        svg.clipped(id, |svg| self.draw_labels(svg, &frame));
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
            self.draw_compass(svg, &frame, corner);
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
}
