//! What charts show.

use super::palette::{self, Colour};
use auv_sim::statistics::BoxStats;

/// How a line is broken.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dash {
    /// Not at all.
    #[default]
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

/// Stroke and fill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Colour of the line, if any.
    pub stroke: Option<Colour>,
    /// Width of the line, pixels.
    pub width: f64,
    /// Opacity of the line, 0 to 1.
    pub stroke_opacity: f64,
    /// How the line is broken.
    pub dash: Dash,
    /// Colour of the inside, if any.
    pub fill: Option<Colour>,
    /// Opacity of the inside, 0 to 1.
    pub fill_opacity: f64,
}

impl Style {
    /// A line.
    #[must_use]
    pub const fn line(colour: Colour, width: f64) -> Self {
        Self {
            stroke: Some(colour),
            width,
            stroke_opacity: 1.0,
            dash: Dash::Solid,
            fill: None,
            fill_opacity: 1.0,
        }
    }

    /// A filled inside without a line.
    #[must_use]
    pub const fn fill(colour: Colour, opacity: f64) -> Self {
        Self {
            stroke: None,
            width: 0.0,
            stroke_opacity: 1.0,
            dash: Dash::Solid,
            fill: Some(colour),
            fill_opacity: opacity,
        }
    }

    /// The same with a broken line.
    #[must_use]
    pub const fn dash(mut self, dash: Dash) -> Self {
        self.dash = dash;
        self
    }

    /// The same with a translucent line.
    #[must_use]
    pub const fn faint(mut self, opacity: f64) -> Self {
        self.stroke_opacity = opacity;
        self
    }

    /// The same with a filled inside.
    #[must_use]
    pub const fn filled(mut self, colour: Colour, opacity: f64) -> Self {
        self.fill = Some(colour);
        self.fill_opacity = opacity;
        self
    }
}

/// The shape of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointShape {
    /// A disc.
    Disc,
    /// A square.
    Square,
    /// A diamond.
    Diamond,
    /// A triangle, point up.
    Triangle,
    /// A cross of two diagonals.
    Cross,
}

/// Something in a chart, in the chart's own units (points: size in pixels).
#[derive(Clone, Debug)]
pub enum Mark {
    /// A polyline through points, with a legend (empty: none).
    Line {
        /// The points.
        points: Vec<(f64, f64)>,
        /// How it looks.
        style: Style,
        /// What the legend calls it.
        legend: String,
    },
    /// The area between two curves over the same abscissas.
    Band {
        /// Abscissa, lower and upper value.
        points: Vec<(f64, f64, f64)>,
        /// How it looks.
        style: Style,
        /// What the legend calls it.
        legend: String,
    },
    /// Closed rings, holes by the even-odd rule.
    Area {
        /// The rings.
        rings: Vec<Vec<(f64, f64)>>,
        /// How it looks.
        style: Style,
        /// What the legend calls it.
        legend: String,
    },
    /// A box with whiskers (5 to 95 %), median, and the mean as a cross.
    Box {
        /// Where it stands.
        at: f64,
        /// Half its width.
        half_width: f64,
        /// What it shows.
        stats: BoxStats,
        /// Its colour.
        colour: Colour,
        /// What the legend calls it.
        legend: String,
    },
    /// A bar from 0.
    Bar {
        /// Where it stands.
        at: f64,
        /// Half its width.
        half_width: f64,
        /// Its height.
        value: f64,
        /// How it looks.
        style: Style,
        /// What the legend calls it.
        legend: String,
    },
    /// Points.
    Points {
        /// The points.
        points: Vec<(f64, f64)>,
        /// Their shape.
        shape: PointShape,
        /// Their radius, pixels.
        size: f64,
        /// How they look.
        style: Style,
        /// What the legend calls them.
        legend: String,
    },
    /// A circle whose radius is in units of the abscissa.
    Circle {
        /// Its centre.
        centre: (f64, f64),
        /// Its radius.
        radius: f64,
        /// How it looks.
        style: Style,
        /// Text that viewers show under the pointer.
        tip: String,
        /// What the legend calls it.
        legend: String,
    },
    /// An arrow.
    Arrow {
        /// Where it starts.
        from: (f64, f64),
        /// Where it ends.
        to: (f64, f64),
        /// How it looks.
        style: Style,
    },
    /// A horizontal line through the whole chart with a text on it.
    Level {
        /// Its height.
        value: f64,
        /// How it looks.
        style: Style,
        /// Its text.
        label: String,
    },
    /// A text beside a point; left out where it would cover another one, unless `always`.
    Label {
        /// The point.
        at: (f64, f64),
        /// The text.
        text: String,
        /// Its colour.
        colour: Colour,
        /// Size, pixels.
        size: f64,
        /// Whether it is drawn even over another.
        always: bool,
    },
}

impl Mark {
    /// A line of a series with its legend.
    #[must_use]
    pub fn line(points: Vec<(f64, f64)>, style: Style, legend: &str) -> Self {
        Self::Line {
            points,
            style,
            legend: legend.into(),
        }
    }

    /// A published value: a hollow black diamond, unlike every mark of our own results.
    #[must_use]
    pub fn published(points: Vec<(f64, f64)>, legend: &str) -> Self {
        Self::Points {
            points,
            shape: PointShape::Diamond,
            size: 5.0,
            style: Style::line(palette::BLACK, 1.6).filled("#ffffff", 1.0),
            legend: legend.into(),
        }
    }

    pub(crate) fn legend(&self) -> &str {
        match self {
            Self::Line { legend, .. }
            | Self::Band { legend, .. }
            | Self::Area { legend, .. }
            | Self::Box { legend, .. }
            | Self::Bar { legend, .. }
            | Self::Points { legend, .. }
            | Self::Circle { legend, .. } => legend,
            Self::Arrow { .. } | Self::Level { .. } | Self::Label { .. } => "",
        }
    }

    /// Calls `see` with every value that the axes have to include.
    pub(crate) fn extent(&self, see: &mut dyn FnMut(Option<f64>, Option<f64>)) {
        let mut point = |p: &(f64, f64)| see(Some(p.0), Some(p.1));
        match self {
            Self::Line { points, .. } | Self::Points { points, .. } => {
                points.iter().for_each(point);
            }
            Self::Band { points, .. } => {
                for &(x, low, high) in points {
                    point(&(x, low));
                    point(&(x, high));
                }
            }
            Self::Area { .. } | Self::Label { .. } => {}
            Self::Box {
                at,
                half_width,
                stats,
                ..
            } => {
                point(&(at - half_width, stats.low.min(stats.mean)));
                point(&(at + half_width, stats.high.max(stats.mean)));
            }
            Self::Bar {
                at,
                half_width,
                value,
                ..
            } => {
                point(&(at - half_width, 0.0));
                point(&(at + half_width, *value));
            }
            Self::Circle { centre, radius, .. } => {
                point(&(centre.0 - radius, centre.1 - radius));
                point(&(centre.0 + radius, centre.1 + radius));
            }
            Self::Arrow { from, to, .. } => {
                point(from);
                point(to);
            }
            Self::Level { value, .. } => see(None, Some(*value)),
        }
    }
}
