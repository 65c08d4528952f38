//! A figure: a title, charts in a grid, and notes below.

use super::chart::Chart;
use super::svg::{Anchor, Font, Svg};
use super::width::{bold_width_of, width_of};

/// Charts under one title, with notes below.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    /// The title.
    pub title: String,
    /// What was done, under the title; wrapped.
    pub subtitle: String,
    /// The charts, row by row.
    pub charts: Vec<Chart>,
    /// Charts beside each other (0 counts as 1).
    pub columns: usize,
    /// Width, pixels (0: 800).
    pub width: f64,
    /// Notes below the charts; each is wrapped.
    pub notes: Vec<String>,
}

impl Figure {
    const MARGIN: f64 = 14.0;

    /// A figure of one column.
    #[must_use]
    pub fn new(title: &str, subtitle: &str) -> Self {
        Self {
            title: title.into(),
            subtitle: subtitle.into(),
            columns: 1,
            ..Self::default()
        }
    }

    /// The picture as SVG text.
    #[must_use]
    pub fn to_svg(&self) -> String {
        let width = if self.width > 0.0 { self.width } else { 800.0 };
        let columns = self.columns.max(1);
        let inner = width - 2.0 * Self::MARGIN;
        let cell = (inner - 12.0 * (columns - 1) as f64) / columns as f64;
        let mut svg = Svg::default();
        let mut y = Self::MARGIN + 14.0;
        let mut title = Font::new(17.0, Anchor::Start);
        title.bold = true;
        for line in wrapped(&self.title, inner, title.size, bold_width_of) {
            svg.text(Self::MARGIN, y, &line, &title);
            y += 20.0;
        }
        let mut small = Font::new(12.0, Anchor::Start);
        small.colour = "#444444";
        for line in wrapped(&self.subtitle, inner, small.size, width_of) {
            svg.text(Self::MARGIN, y, &line, &small);
            y += 16.0;
        }
        y -= 4.0;
        for (row, charts) in self.charts.chunks(columns).enumerate() {
            let tallest = charts
                .iter()
                .map(|chart| chart.draw_height(cell))
                .fold(0.0, f64::max);
            for (column, chart) in charts.iter().enumerate() {
                let x = Self::MARGIN + column as f64 * (cell + 12.0);
                chart.draw(&mut svg, row * columns + column, x, y, cell);
            }
            y += tallest + 8.0;
        }
        y += 12.0;
        for note in &self.notes {
            for line in wrapped(note, inner, small.size, width_of) {
                svg.text(Self::MARGIN, y, &line, &small);
                y += 16.0;
            }
            y += 2.0;
        }
        let bottom = y.max(40.0);
        svg.document(width, bottom, &self.title)
    }
}

/// A text in lines of at most `width` pixels, by a measure of width.
fn wrapped(text: &str, width: f64, size: f64, width_of: fn(&str, f64) -> f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_of(line, size) + width_of(word, size) + size / 2.0 <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_are_wrapped_and_lose_nothing() {
        let text = "one two three four five six seven";
        let lines = wrapped(text, 80.0, 12.0, width_of);
        assert!(lines.len() > 1 && lines.join(" ") == text);
    }
}
