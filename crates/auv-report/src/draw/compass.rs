//! Scale bar, north arrow and current of a map.

use super::chart::{Chart, Corner};
use super::frame::Frame;
use super::marks::Style;
use super::paint::{arrow, libm_hypot};
use super::palette;
use super::svg::{Anchor, Font, Svg};
use super::width::width_of;

/// Where the text of the current starts, pixels from the box's left edge, and its size.
const CURRENT_AT: f64 = 38.0;
const CURRENT_SIZE: f64 = 10.5;

impl Chart {
    pub(super) fn draw_compass(&self, svg: &mut Svg, frame: &Frame, corner: Corner) {
        let metres_wide = 96.0 / frame.scale();
        let mut bar_m = super::nice_step(metres_wide);
        if bar_m > metres_wide {
            bar_m = super::nice_step(metres_wide / 2.5);
        }
        let bar = bar_m * frame.scale();
        let current = self.current_mps.map(|(east, north)| {
            let speed = libm_hypot(east, north);
            (east, north, speed, format!("current {speed:.2} m/s"))
        });
        let needed = current.as_ref().map_or(0.0, |(.., text)| {
            CURRENT_AT + width_of(text, CURRENT_SIZE) + 8.0
        });
        let (wide, high) = (
            (bar.max(70.0) + 54.0).max(needed),
            if current.is_some() { 80.0 } else { 50.0 },
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
        draw_scale(svg, (left, top), bar, bar_m);
        let black = Style::line(palette::BLACK, 1.6);
        let north = left + wide - 18.0;
        arrow(svg, (north, top + 42.0), (north, top + 18.0), &black);
        svg.text(north, top + 14.0, "N", &Font::new(11.0, Anchor::Middle));
        if let Some((east, north, speed, text)) = current {
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
                left + CURRENT_AT,
                middle.1 + 4.0,
                &text,
                &Font::new(CURRENT_SIZE, Anchor::Start),
            );
        }
    }
}

/// The scale bar of `bar` pixels, which are `bar_m` metres.
fn draw_scale(svg: &mut Svg, (left, top): (f64, f64), bar: f64, bar_m: f64) {
    let (x, y) = (left + 10.0, top + 36.0);
    svg.path(
        [(x, y - 5.0), (x, y), (x + bar, y), (x + bar, y - 5.0)],
        false,
        &Style::line(palette::BLACK, 1.6),
    );
    let text = if bar_m >= 1000.0 {
        format!("{} km", bar_m / 1000.0)
    } else {
        format!("{bar_m} m")
    };
    svg.text(
        x + 0.5 * bar,
        y - 8.0,
        &text,
        &Font::new(11.0, Anchor::Middle),
    );
}
