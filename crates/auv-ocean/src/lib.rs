//! The sea around the vehicle: currents, sea beds and geodesy, for planners and simulators.
//!
//! - Sea beds ([`SeaBed`]): [`FlatBed`], [`AnalyticBed`] (composed of basins, sills, shoals, islands and
//!   coasts), [`GriddedBed`] (soundings), each with a proven bound of its slope.
//! - Currents ([`CurrentField`]): [`UniformCurrent`], [`AnalyticCurrent`] (mean, tide, gains,
//!   vortices), [`GriddedCurrent`] (a model's output), and [`Perturbed`], a true current that differs from
//!   its forecast.
//! - Geodesy: [`LocalFrame`] between latitude and longitude and local metres.
//! - [`WaterMap`]: shortest paths through water that is deep enough.
//! - Feature `netcdf`: charts and the currents of ocean models from the bytes of NetCDF files;
//!   [`ChartedDepths`] resamples charts to a local grid, [`FileReport`] tells what was read. Feature `serde`: analytic beds and currents as data; unknown keys are refused.
//!
//! ```
//! use auv_ocean::{CurrentField, FlatBed, SeaBed, UniformCurrent};
//! use auv_types::{Point3, Vector3};
//!
//! let current = UniformCurrent::new(Vector3::new(0.2, -0.1, 0.0));
//! assert_eq!(current.velocity_at(&Point3::origin(), 60.0).x, 0.2);
//! assert_eq!(FlatBed::new(80.0).depth_at(10.0, 20.0), 80.0);
//! ```
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `netcdf` | charts and the currents of ocean models from NetCDF files |
//! | `geotiff` | charts from GeoTIFF files |
//! | `serde` | beds, currents and their reports can be written and read |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod analytic_bed;
mod analytic_current;
#[cfg(any(feature = "netcdf", feature = "geotiff"))]
mod axis_order;
mod charted_depths;
mod current;
mod curvilinear;
mod depth_sigma;
mod drawn_bed;
mod extent;
mod fenced_bed;
mod files;
mod footprint;
mod geodesy;
#[cfg(feature = "geotiff")]
pub mod geotiff;
mod gridded_bed;
mod gridded_current;
mod levelled_bed;
mod map_grid;
mod measured_bed;
mod model_currents;
#[cfg(feature = "netcdf")]
pub mod netcdf;
mod oddities;
mod perturbed;
#[cfg(any(feature = "netcdf", feature = "geotiff"))]
mod plausible;
mod report;
mod sea_bed;
mod shallowest_near;
#[cfg(any(feature = "netcdf", feature = "geotiff"))]
#[cfg_attr(
    not(feature = "netcdf"),
    allow(dead_code, reason = "a chart has lengths alone")
)]
mod units;
mod water_level;
mod water_map;

pub use analytic_bed::{AnalyticBed, BedFeature, Effect, Undulation};
pub use analytic_current::{AnalyticCurrent, CurrentGain, LambVortex, TidalConstituent};
pub use charted_depths::ChartedDepths;
pub use current::{CurrentField, UniformCurrent};
pub use depth_sigma::DepthSigma;
pub use drawn_bed::DrawnBed;
pub use fenced_bed::FencedBed;
pub use files::{FileError, read_chart, read_model};
pub use footprint::{Footprint, MapPoint};
pub use geodesy::{Altitude, Depth, Geodetic, LocalFrame};
pub use gridded_bed::GriddedBed;
pub use gridded_current::GriddedCurrent;
pub use levelled_bed::LevelledBed;
pub use map_grid::MapGrid;
pub use measured_bed::{MeasuredBed, Shoal, raised_at};
pub use model_currents::ModelCurrents;
pub use perturbed::{ForecastError, Perturbed};
pub use report::{FileReport, VariableReport};
pub use sea_bed::{FlatBed, SeaBed};
pub use shallowest_near::ShallowestNear;
pub use water_level::{LevelConstituent, WaterLevel};
pub use water_map::{WaterMap, WaterPath};
