//! Why a GeoTIFF file is refused.

use auv_types::Violations;
use thiserror::Error;

/// Greatest number of values.
pub(super) const MOST_VALUES: u64 = 50_000_000;

/// Why a GeoTIFF file is refused.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GeotiffError {
    /// The bytes are not a TIFF file that is read, or a damaged one.
    #[error(
        "no readable GeoTIFF file ({reason}); give a complete one, without compression or with Deflate or LZW"
    )]
    NotTiff {
        /// The decoder's message.
        reason: String,
    },
    /// The file says nothing of where it lies.
    #[error(
        "has no georeference (geo keys, and a pixel scale with a tie point or a transformation); add it with `gdal_translate -a_srs -a_ullr`"
    )]
    NoGeoreference,
    /// A coordinate system or unit that is not read.
    #[error("has {what}; convert it with `gdalwarp -t_srs EPSG:4326`, or to a UTM zone of WGS84")]
    Reference {
        /// Which.
        what: String,
    },
    /// Several bands, colours.
    #[error("has {bands}; give one band of depths, for instance with `gdal_translate -b 1`")]
    Bands {
        /// What it has.
        bands: String,
    },
    /// Too many values.
    #[error(
        "has {values} values, more than {MOST_VALUES}; cut out the part you need with `gdalwarp -te`"
    )]
    TooLarge {
        /// How many.
        values: u64,
    },
    /// The values cannot be depths.
    #[error("the values {reason}")]
    Values {
        /// What is wrong, with the remedy.
        reason: String,
    },
    /// The data could be read, but are not a valid chart.
    #[error(transparent)]
    Invalid(#[from] Violations),
}
