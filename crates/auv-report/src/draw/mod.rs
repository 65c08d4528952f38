//! Drawing: an SVG writer, and charts on top of it.
//!
//! The pictures of this crate need circles in metres that keep their shape, growing regions with
//! halos, land, arrows and scale bars beside box plots and bands. That is a small drawing surface,
//! not a plotting library (docs/drawing.md has the trial of two): the writer is plain SVG 1.1 text, and
//! equal input gives equal bytes.

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
