//! Bathymetry and currents from NetCDF files (classic and NetCDF-4), given as bytes.
//!
//! ```no_run
//! use auv_ocean::{LocalFrame, netcdf};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let bytes = std::fs::read("bathymetry.nc")?;
//! let chart = netcdf::read_bathymetry(&bytes)?;
//! let datum = chart.centre().ok_or("an empty chart")?;
//! let bed = chart.to_bed(&LocalFrame::new(datum)?, 50.0)?;
//! # Ok(())
//! # }
//! ```

mod bathymetry;
mod roms;
mod source;
mod time;

pub use bathymetry::read_bathymetry;
pub use roms::RomsOutput;
pub use source::NetcdfError;
