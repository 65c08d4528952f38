//! Texts beside points of a chart.

use super::chart::Chart;
use super::frame::Frame;
use super::marks::Mark;
use super::svg::{Anchor, Font, Svg};
use super::width::width_of;

/// Where a text is anchored: x, y, and how.
type Place = (f64, f64, Anchor);

/// The box of a text: left, top, right and bottom.
fn text_box(&(x, y, anchor): &Place, wide: f64, size: f64) -> [f64; 4] {
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - 0.5 * wide,
        Anchor::End => x - wide,
    };
    [left, y - 0.8 * size, left + wide, y + 0.2 * size]
}

fn holds(frame: &Frame, b: &[f64; 4]) -> bool {
    b[0] >= frame.left
        && b[2] <= frame.left + frame.width
        && b[1] >= frame.top
        && b[3] <= frame.top + frame.height
}

fn do_not_overlap(a: &[f64; 4], b: &[f64; 4]) -> bool {
    a[0] > b[2] || a[2] < b[0] || a[1] > b[3] || a[3] < b[1]
}

/// Half the side of the box that stays free round a point, pixels.
const POINT: f64 = 4.0;

impl Chart {
    /// The boxes of the points.
    fn points(&self, frame: &Frame) -> Vec<[f64; 4]> {
        let points = self.marks.iter().filter_map(|mark| match mark {
            Mark::Points { points, .. } => Some(points),
            _ => None,
        });
        let boxed = |&at: &(f64, f64)| {
            let (x, y) = frame.at(at);
            [x - POINT, y - POINT, x + POINT, y + POINT]
        };
        points.flatten().map(boxed).collect()
    }

    /// Draws texts beside points, each at the first of four sides where it covers no other text and no point. A text
    /// that is always shown covers points or texts where it must.
    pub(super) fn draw_labels(&self, svg: &mut Svg, frame: &Frame) {
        let points = self.points(frame);
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
            // Points that are always named have larger symbols.
            let aside = if *always { 9.0 } else { 6.0 };
            let places = [
                (x + aside, y + 0.35 * size, Anchor::Start),
                (x - aside, y + 0.35 * size, Anchor::End),
                (x, y - aside - 1.0, Anchor::Middle),
                (x, y + size + aside - 2.0, Anchor::Middle),
            ];
            let boxed = |place: &Place| text_box(place, wide, *size);
            let inside = |place: &&Place| holds(frame, &boxed(place));
            let clear = |place: &&Place, of: &[[f64; 4]]| {
                let b = boxed(place);
                of.iter().all(|other| do_not_overlap(&b, other))
            };
            let within = || places.iter().filter(inside);
            let free = within().find(|place| clear(place, &taken) && clear(place, &points));
            let beside_texts = || within().find(|place| clear(place, &taken));
            let fallback = || beside_texts().or_else(|| within().next());
            let free = free.or_else(|| if *always { fallback() } else { None });
            if let Some(place) = free {
                taken.push(boxed(place));
                let mut font = Font::new(*size, place.2);
                font.colour = colour;
                font.halo = true;
                svg.text(place.0, place.1, text, &font);
            }
        }
    }
}
