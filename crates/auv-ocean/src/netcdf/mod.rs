//! Bathymetry and currents from NetCDF files (classic and NetCDF-4), given as bytes.
//!
//! Readers go from attributes to roles to a field: what a variable is follows from its CF attributes
//! (`standard_name`, `units`, `positive`, `axis`), then from its name; which value lies where follows from
//! the names of dimensions. No reader knows a producer. Each returns a [`FileReport`](crate::FileReport) of
//! what it read, converted, dropped and assumed.
//!
//! ```no_run
//! use auv_ocean::{LocalFrame, netcdf};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let bytes = std::fs::read("bathymetry.nc")?;
//! let (chart, report) = netcdf::read_bathymetry(&bytes)?;
//! assert!(report.dropped.is_empty());
//! let datum = chart.centre().ok_or("an empty chart")?;
//! let bed = chart.to_bed(&LocalFrame::new(datum)?, 50.0)?;
//! # Ok(())
//! # }
//! ```

mod bathymetry;
mod components;
mod coordinates;
mod currents;
mod degrees;
mod grid;
mod levels;
mod outer;
mod permuted;
mod records;
mod roles;
mod source;
mod speed;
mod staggered;
mod time;
mod turns;
mod unpack;

pub use bathymetry::read_bathymetry;
pub use currents::read_currents;
pub use source::NetcdfError;
