//! Drawing: an SVG writer, and charts on top of it.
//!
//! Pictures need circles in metres, growing regions, land, arrows and scale bars besides box plots
//! and bands. Two plotting libraries were tried and did not draw them (docs/drawing.md). The output is
//! plain SVG 1.1 text, and equal input gives equal bytes.

mod axis;
mod chart;
mod compass;
mod figure;
mod frame;
mod labels;
mod marks;
mod paint;
pub mod palette;
mod svg;
mod width;

pub use axis::Axis;
pub(crate) use axis::nice_step;
pub use chart::{Chart, Corner};
pub use figure::Figure;
pub use marks::{Dash, Mark, PointShape, Style};
pub use palette::Colour;
