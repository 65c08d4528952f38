//! A writer of SVG elements in pixels.

use super::marks::{Dash, Style};
use std::fmt::Write;

/// Where a text is anchored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text looks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Font {
    pub(crate) size: f64,
    pub(crate) colour: &'static str,
    pub(crate) anchor: Anchor,
    pub(crate) bold: bool,
    /// A white rim that keeps it legible over lines.
    pub(crate) halo: bool,
    /// Rotated by 90 degrees anticlockwise.
    pub(crate) upright: bool,
}

impl Font {
    pub(crate) const fn new(size: f64, anchor: Anchor) -> Self {
        Self {
            size,
            colour: super::palette::BLACK,
            anchor,
            bold: false,
            halo: false,
            upright: false,
        }
    }
}

/// The elements of an SVG document.
#[derive(Debug, Default)]
pub(crate) struct Svg {
    text: String,
}

/// A length in pixels with one decimal.
pub(crate) fn px(value: f64) -> String {
    let value = if value.is_finite() {
        value.clamp(-1e5, 1e5)
    } else {
        0.0
    };
    let text = format!("{value:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".into(),
        Some(whole) => whole.into(),
        None => text,
    }
}

/// Escapes the characters that XML reserves and replaces those that it forbids by spaces.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() || ('\u{fffe}'..='\u{ffff}').contains(&c) => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

impl Svg {
    fn style(&mut self, style: &Style) {
        let fill = style.fill.unwrap_or("none");
        let _ = write!(self.text, r#" fill="{fill}""#);
        if style.fill.is_some() && style.fill_opacity < 1.0 {
            let _ = write!(self.text, r#" fill-opacity="{:.2}""#, style.fill_opacity);
        }
        if let Some(stroke) = style.stroke {
            let _ = write!(
                self.text,
                r#" stroke="{stroke}" stroke-width="{}""#,
                px(style.width)
            );
            if style.stroke_opacity < 1.0 {
                let _ = write!(
                    self.text,
                    r#" stroke-opacity="{:.2}""#,
                    style.stroke_opacity
                );
            }
            let dashes = match style.dash {
                Dash::Solid => return,
                Dash::Dashed => "6 4",
                Dash::Dotted => "1.5 3",
            };
            let _ = write!(self.text, r#" stroke-dasharray="{dashes}""#);
        }
    }

    /// A polyline, closed if asked; points nearer than half a pixel to the one before are left out.
    pub(crate) fn path(
        &mut self,
        points: impl IntoIterator<Item = (f64, f64)>,
        closed: bool,
        style: &Style,
    ) {
        let mut kept: Vec<(f64, f64)> = Vec::new();
        let mut skipped = None;
        for point in points {
            let near = kept
                .last()
                .is_some_and(|last| (point.0 - last.0).abs() + (point.1 - last.1).abs() < 0.5);
            if near {
                skipped = Some(point);
            } else {
                kept.push(point);
                skipped = None;
            }
        }
        kept.extend(skipped);
        if kept.is_empty() {
            return;
        }
        self.text.push_str(r#"<path d=""#);
        for (i, (x, y)) in kept.iter().enumerate() {
            let _ = write!(
                self.text,
                "{}{} {}",
                if i == 0 { 'M' } else { 'L' },
                px(*x),
                px(*y)
            );
        }
        if closed {
            self.text.push('Z');
        }
        self.text.push('"');
        self.style(style);
        self.text
            .push_str(" stroke-linejoin=\"round\" stroke-linecap=\"round\"/>\n");
    }

    /// An area of many closed rings, holes by the even-odd rule.
    pub(crate) fn area(&mut self, rings: &[Vec<(f64, f64)>], style: &Style) {
        if rings.is_empty() {
            return;
        }
        self.text.push_str(r#"<path fill-rule="evenodd" d=""#);
        for ring in rings {
            for (i, (x, y)) in ring.iter().enumerate() {
                let letter = if i == 0 { 'M' } else { 'L' };
                let _ = write!(self.text, "{letter}{} {}", px(*x), px(*y));
            }
            self.text.push('Z');
        }
        self.text.push('"');
        self.style(style);
        self.text.push_str("/>\n");
    }

    pub(crate) fn rect(&mut self, x: f64, y: f64, width: f64, height: f64, style: &Style) {
        let _ = write!(
            self.text,
            r#"<rect x="{}" y="{}" width="{}" height="{}""#,
            px(x),
            px(y),
            px(width.max(0.0)),
            px(height.max(0.0))
        );
        self.style(style);
        self.text.push_str("/>\n");
    }

    pub(crate) fn circle(&mut self, x: f64, y: f64, radius: f64, style: &Style, tip: &str) {
        let _ = write!(
            self.text,
            r#"<circle cx="{}" cy="{}" r="{}""#,
            px(x),
            px(y),
            px(radius.max(0.0))
        );
        self.style(style);
        if tip.is_empty() {
            self.text.push_str("/>\n");
        } else {
            let _ = writeln!(self.text, "><title>{}</title></circle>", escaped(tip));
        }
    }

    pub(crate) fn line(&mut self, from: (f64, f64), to: (f64, f64), style: &Style) {
        self.path([from, to], false, style);
    }

    pub(crate) fn text(&mut self, x: f64, y: f64, text: &str, font: &Font) {
        let _ = write!(
            self.text,
            r#"<text x="{}" y="{}" font-size="{}" fill="{}""#,
            px(x),
            px(y),
            px(font.size),
            font.colour
        );
        match font.anchor {
            Anchor::Start => {}
            Anchor::Middle => self.text.push_str(r#" text-anchor="middle""#),
            Anchor::End => self.text.push_str(r#" text-anchor="end""#),
        }
        if font.bold {
            self.text.push_str(r#" font-weight="bold""#);
        }
        if font.halo {
            self.text
                .push_str(r##" stroke="#ffffff" stroke-width="3" stroke-linejoin="round" paint-order="stroke""##);
        }
        if font.upright {
            let _ = write!(self.text, r#" transform="rotate(-90 {} {})""#, px(x), px(y));
        }
        let _ = writeln!(self.text, ">{}</text>", escaped(text));
    }

    /// Declares a clipping rectangle.
    pub(crate) fn clip_path(&mut self, id: usize, (x, y, width, height): (f64, f64, f64, f64)) {
        let _ = writeln!(
            self.text,
            r##"<clipPath id="clip{id}"><rect x="{}" y="{}" width="{}" height="{}"/></clipPath>"##,
            px(x),
            px(y),
            px(width),
            px(height)
        );
    }

    /// Draws inside the rectangle of [`Self::clip_path`] only.
    pub(crate) fn clipped(&mut self, id: usize, draw: impl FnOnce(&mut Self)) {
        let _ = writeln!(self.text, r##"<g clip-path="url(#clip{id})">"##);
        draw(self);
        self.text.push_str("</g>\n");
    }

    /// The whole document on white.
    pub(crate) fn document(&self, width: f64, height: f64, title: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\" role=\"img\">\n\
             <title>{}</title>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escaped(title),
            self.text,
            w = px(width),
            h = px(height),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_break_out_of_the_document() {
        let mut svg = Svg::default();
        svg.text(0.0, 0.0, "<script>&\"\u{1}", &Font::new(9.0, Anchor::Start));
        let document = svg.document(10.0, 10.0, "</title>");
        assert!(!document.contains("<script>") && !document.contains("</title></title>"));
        assert!(document.contains("&lt;script&gt;&amp;&quot; "));
    }

    #[test]
    fn numbers_are_short_and_always_numbers() {
        assert_eq!(
            [px(1.0), px(-0.01), px(2.25), px(f64::NAN)],
            ["1", "0", "2.2", "0"]
        );
    }
}
