//! The variables of a NetCDF file: lookup, shapes, values without masks and packing.

use auv_types::Violations;
use netcdf_reader::{NcFile, NcOpenOptions, NcVariable};
use thiserror::Error;

/// Why a NetCDF file is refused.
#[derive(Debug, Error)]
pub enum NetcdfError {
    /// The bytes are not a NetCDF file, or a damaged one.
    #[error("no readable NetCDF file ({reason}); give a complete NetCDF-3 or NetCDF-4 file")]
    NotNetcdf {
        /// The decoder's message.
        reason: String,
    },
    /// A variable is missing.
    #[error(
        "variable `{variable}` is missing (looked for {looked_for}); add or rename it, \
         for instance with `ncrename -v OLD,NEW`"
    )]
    Missing {
        /// Its purpose.
        variable: &'static str,
        /// The accepted names.
        looked_for: String,
    },
    /// The shape of a variable does not match the other variables.
    #[error("variable `{variable}` has shape {shape:?}; give {expected}")]
    Footprint {
        /// Its name.
        variable: String,
        /// Its shape.
        shape: Vec<u64>,
        /// The expected shape.
        expected: String,
    },
    /// A variable is too large.
    #[error(
        "variable `{variable}` has shape {shape:?}, more than {most} values; cut out the part you need, for instance with `ncks -d`"
    )]
    TooLarge {
        /// Its name.
        variable: String,
        /// Its shape.
        shape: Vec<u64>,
        /// The limit.
        most: u64,
    },
    /// The data of a variable cannot be read or are invalid.
    #[error("variable `{variable}`: {reason}")]
    Data {
        /// Its name.
        variable: String,
        /// What is wrong, with the remedy.
        reason: String,
    },
    /// The data could be read, but are not a valid sea bed or current.
    #[error(transparent)]
    Invalid(#[from] Violations),
}

/// Greatest number of values of a variable.
const MOST_VALUES: u64 = 50_000_000;
/// Values of at least this magnitude are fill values (1e37, 9.97e36), regardless of the attributes.
const FILL_FROM: f64 = 1e30;

pub(super) struct Source {
    file: NcFile,
}

/// A variable that exists, with its shape.
pub(super) struct Found<'a> {
    file: &'a NcFile,
    variable: &'a NcVariable,
    pub(super) shape: Vec<u64>,
}

impl Source {
    pub(super) fn open(bytes: &[u8]) -> Result<Self, NetcdfError> {
        let options = NcOpenOptions {
            max_read_bytes: 8 * MOST_VALUES as usize,
            ..NcOpenOptions::default()
        };
        let file = NcFile::from_bytes_with_options(bytes, options).map_err(not_netcdf)?;
        file.variables().map_err(not_netcdf)?;
        Ok(Self { file })
    }

    /// The first variable found under one of several names.
    pub(super) fn find(
        &self,
        variable: &'static str,
        names: &[&str],
    ) -> Result<Found<'_>, NetcdfError> {
        self.look(names).ok_or_else(|| NetcdfError::Missing {
            variable,
            looked_for: names.join(", "),
        })
    }

    pub(super) fn look(&self, names: &[&str]) -> Option<Found<'_>> {
        let variable = names
            .iter()
            .find_map(|name| self.file.variable(name).ok())?;
        Some(Found {
            file: &self.file,
            variable,
            shape: variable.shape(),
        })
    }
}

fn not_netcdf(error: netcdf_reader::Error) -> NetcdfError {
    NetcdfError::NotNetcdf {
        reason: error.to_string(),
    }
}

impl Found<'_> {
    pub(super) fn name(&self) -> &str {
        self.variable.name()
    }

    pub(super) fn text(&self, attribute: &str) -> Option<String> {
        self.variable.attribute(attribute)?.value.as_string()
    }

    fn number(&self, attribute: &str) -> Option<f64> {
        self.variable.attribute(attribute)?.value.as_f64()
    }

    pub(super) fn error(&self, reason: impl Into<String>) -> NetcdfError {
        NetcdfError::Data {
            variable: self.name().into(),
            reason: reason.into(),
        }
    }

    /// Checks the shape.
    pub(super) fn require_shape(&self, shape: &[u64], what: &str) -> Result<(), NetcdfError> {
        if self.shape == shape {
            return Ok(());
        }
        Err(NetcdfError::Footprint {
            variable: self.name().into(),
            shape: self.shape.clone(),
            expected: format!("{what} = {shape:?}"),
        })
    }

    /// All values, unpacked, with NaN for fill values. `valid_min`, `valid_max` and `valid_range` are ignored:
    /// packing tools leave them in the wrong unit.
    pub(super) fn values(&self) -> Result<Vec<f64>, NetcdfError> {
        let count = self
            .shape
            .iter()
            .try_fold(1_u64, |product, &n| product.checked_mul(n));
        if count.is_none_or(|count| count > MOST_VALUES) {
            return Err(NetcdfError::TooLarge {
                variable: self.name().into(),
                shape: self.shape.clone(),
                most: MOST_VALUES,
            });
        }
        let raw = self
            .file
            .read_variable_as_f64(self.name())
            .map_err(|error| self.error(format!("{error}; give a complete numeric variable")))?;
        let fills = ["_FillValue", "missing_value"].map(|name| self.number(name));
        let scale = self.number("scale_factor").unwrap_or(1.0);
        let offset = self.number("add_offset").unwrap_or(0.0);
        let is_fill = |x: f64| {
            !x.is_finite()
                || x.abs() >= FILL_FROM
                || fills.iter().flatten().any(|fill| x.total_cmp(fill).is_eq())
        };
        Ok(raw
            .iter()
            .map(|&x| {
                let value = x * scale + offset;
                if is_fill(x) || is_fill(value) {
                    f64::NAN
                } else {
                    value
                }
            })
            .collect())
    }

    /// The value of a scalar.
    pub(super) fn scalar(&self) -> Result<f64, NetcdfError> {
        match self.values()?.as_slice() {
            [value] if value.is_finite() => Ok(*value),
            _ => Err(self.error("is no single finite number; give one")),
        }
    }
}
