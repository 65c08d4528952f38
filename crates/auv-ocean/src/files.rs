//! Charts and models in whatever form a file has.

use crate::{ChartedDepths, FileReport, ModelCurrents};
use thiserror::Error;

/// Why a file is not read.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileError {
    /// The bytes begin like no form that is known.
    #[error("is neither NetCDF nor GeoTIFF; give a complete {wanted} file")]
    UnknownForm {
        /// The forms that are read here.
        wanted: &'static str,
    },
    /// A form that this build was made without.
    #[error(
        "is a {form} file, which this build does not read; build it with the feature `{feature}`"
    )]
    NotBuilt {
        /// The form.
        form: &'static str,
        /// The feature of this crate.
        feature: &'static str,
    },
    /// A form that holds no currents.
    #[error("is a GeoTIFF file, which holds no currents; give the NetCDF file of an ocean model")]
    NoCurrents,
    /// A NetCDF file is refused.
    #[cfg(feature = "netcdf")]
    #[error(transparent)]
    Netcdf(#[from] crate::netcdf::NetcdfError),
    /// A GeoTIFF file is refused.
    #[cfg(feature = "geotiff")]
    #[error(transparent)]
    Geotiff(#[from] crate::geotiff::GeotiffError),
}

enum Form {
    Netcdf,
    Geotiff,
}

/// The form that the bytes begin like; `wanted` names those that the caller reads.
fn form(bytes: &[u8], wanted: &'static str) -> Result<Form, FileError> {
    // An HDF5 file may begin after a block of its user's.
    let hdf5 = [0, 512, 1024, 2048].iter().any(|&at| {
        bytes
            .get(at..)
            .is_some_and(|rest| rest.starts_with(b"\x89HDF"))
    });
    if bytes.starts_with(b"CDF") || hdf5 {
        return Ok(Form::Netcdf);
    }
    let tiff = [b"II*\0", b"MM\0*", b"II+\0", b"MM\0+"];
    if tiff.iter().any(|magic| bytes.starts_with(*magic)) {
        return Ok(Form::Geotiff);
    }
    Err(FileError::UnknownForm { wanted })
}

/// Reads a chart of depths from the bytes of a NetCDF or GeoTIFF file (features `netcdf` and `geotiff`),
/// with what was read.
///
/// # Errors
/// Another form, a form this build does not read, everything that the reader refuses.
pub fn read_chart(bytes: &[u8]) -> Result<(ChartedDepths, FileReport), FileError> {
    match form(bytes, "NetCDF or GeoTIFF")? {
        #[cfg(feature = "netcdf")]
        Form::Netcdf => Ok(crate::netcdf::read_bathymetry(bytes)?),
        #[cfg(not(feature = "netcdf"))]
        Form::Netcdf => Err(FileError::NotBuilt {
            form: "NetCDF",
            feature: "netcdf",
        }),
        #[cfg(feature = "geotiff")]
        Form::Geotiff => Ok(crate::geotiff::read_geotiff(bytes)?),
        #[cfg(not(feature = "geotiff"))]
        Form::Geotiff => Err(FileError::NotBuilt {
            form: "GeoTIFF",
            feature: "geotiff",
        }),
    }
}

/// Reads the current of an ocean model from the bytes of a NetCDF file (feature `netcdf`), with what was read.
///
/// # Errors
/// As [`read_chart`].
pub fn read_model(bytes: &[u8]) -> Result<(ModelCurrents, FileReport), FileError> {
    match form(bytes, "NetCDF")? {
        #[cfg(feature = "netcdf")]
        Form::Netcdf => Ok(crate::netcdf::read_currents(bytes)?),
        #[cfg(not(feature = "netcdf"))]
        Form::Netcdf => Err(FileError::NotBuilt {
            form: "NetCDF",
            feature: "netcdf",
        }),
        Form::Geotiff => Err(FileError::NoCurrents),
    }
}
