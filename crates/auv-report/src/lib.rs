//! Pictures and tables of missions, and the module that draws them.
//!
//! - [`MissionPicture`]: a [`Recorder`](auv_sim::Recorder) that records a simulated mission;
//!   [`mission_svg`] draws it (plan view and depth over distance), [`replay_html`] makes a page that
//!   plays it offline. [`MissionPicture::of_flight`] records a real vehicle's flight.
//! - [`track_csv`], and with feature `export` `mission_geojson`, `track_kml`, `route_plan` and `track_plan`: the
//!   mission for other programs; `read_track` reads the flown track of a real vehicle. [`track_csv`] has latitude and longitude where it is given a frame; the
//!   others need one.
//! - [`route_table`], [`path_table`], [`Table`]: the paper's two tables of a mission as Markdown or
//!   CSV.
//! - [`Figure`], [`Chart`], [`Mark`]: box plots, bands, curves and maps as SVG; with feature `png`, `svg_png` turns
//!   any of these pictures into PNG.
//!
//! Colours are those of Okabe and Ito, distinguishable with any colour vision. Pictures and tables are
//! text; this crate opens no file. Equal missions give equal text.
//!
//! ```
//! use auv_mission::driver::Stepped;
//! use auv_planning::baseline::{GreedyRoute, StraightPath};
//! use auv_report::{MissionPicture, mission_svg, route_table};
//! use auv_sim::{Campaign, simulate};
//! use auv_types::Seed;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let mut campaign = Campaign::table2(Seed(1))?;
//! campaign.obstacles = 4;
//! let scenario = campaign.scenario(0)?;
//! let mut picture = MissionPicture::new();
//! let summary = simulate(&scenario, &Stepped::new(&GreedyRoute, &StraightPath), &mut picture)?;
//! let svg = mission_svg(&picture); // write it to mission.svg
//! assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
//! let table = route_table(&scenario.mission, &summary.route_calls).to_markdown();
//! assert!(table.starts_with("| call |"));
//! # Ok(())
//! # }
//! ```
//! To use a second recorder, give both as a pair: `simulate(&scenario, &driver, &mut (log, picture))`.
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `export` | GeoJSON, KML and QGroundControl plans; `read_track` |
//! | `png` | `svg_png` |

#![cfg_attr(docsrs, feature(doc_cfg))]

mod contour;
mod draw;
mod export;
mod mission_svg;
mod places;
#[cfg(feature = "png")]
mod png;
mod record;
mod replay;
mod table;
mod tasks;
mod thin;
mod utc;

pub use draw::palette;
pub use draw::{Axis, Chart, Colour, Corner, Dash, Figure, Mark, PointShape, Style};
pub use export::track_csv;
#[cfg(feature = "export")]
pub use export::{ExportError, mission_geojson, read_track, route_plan, track_kml, track_plan};
pub use mission_svg::mission_svg;
#[cfg(feature = "png")]
pub use png::{PngError, svg_png};
pub use record::MissionPicture;
pub use replay::replay_html;
pub use table::{Table, path_table, route_table};
pub use utc::date_time;
