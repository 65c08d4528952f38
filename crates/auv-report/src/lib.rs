//! Pictures and tables.
mod contour;
mod draw;
mod mission_svg;
mod record;

pub use draw::*;
pub use mission_svg::mission_svg;
pub use record::MissionPicture;
