//! The variables of a NetCDF file: lookup, shapes, values without masks and packing.

use crate::VariableReport;
use auv_types::Violations;
use netcdf_reader::{NcDimension, NcFile, NcOpenOptions, NcType, NcVariable};
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
    /// A file says two things that cannot both be true.
    #[error("{first} contradicts {second}; {remedy}")]
    Contradiction {
        /// The one, with the variable.
        first: String,
        /// The other.
        second: String,
        /// What to do.
        remedy: String,
    },
    /// The data could be read, but are not a valid sea bed or current.
    #[error(transparent)]
    Invalid(#[from] Violations),
}

/// Greatest number of values of a variable.
const MOST_VALUES: u64 = 50_000_000;

pub(super) struct Source {
    file: NcFile,
}

/// A variable that exists.
#[derive(Clone, Copy)]
pub(super) struct Found<'a> {
    pub(super) file: &'a NcFile,
    pub(super) variable: &'a NcVariable,
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

    /// All numeric variables, in the file's order.
    pub(super) fn all(&self) -> impl Iterator<Item = Found<'_>> {
        let variables = self.file.variables().unwrap_or_default();
        let file = &self.file;
        variables
            .iter()
            .filter(|variable| variable.dtype().is_primitive() && *variable.dtype() != NcType::Char)
            .map(move |variable| Found { file, variable })
    }

    /// The first variable found under one of several names.
    pub(super) fn look(&self, names: &[&str]) -> Option<Found<'_>> {
        let variable = names
            .iter()
            .find_map(|name| self.file.variable(name).ok())?;
        Some(Found {
            file: &self.file,
            variable,
        })
    }

    /// The numbers of a variable, or of a global attribute where the file keeps them there.
    pub(super) fn numbers(&self, name: &str) -> Option<Result<Vec<f64>, NetcdfError>> {
        if let Some(found) = self.look(&[name]) {
            return Some(found.values());
        }
        let attribute = self.file.global_attribute(name).ok()?;
        attribute.value.as_f64_vec().map(Ok)
    }
}

fn not_netcdf(error: netcdf_reader::Error) -> NetcdfError {
    NetcdfError::NotNetcdf {
        reason: error.to_string(),
    }
}

impl<'a> Found<'a> {
    pub(super) fn name(&self) -> &'a str {
        self.variable.name()
    }

    pub(super) fn dimensions(&self) -> &'a [NcDimension] {
        self.variable.dimensions()
    }

    pub(super) fn shape(&self) -> Vec<u64> {
        self.variable.shape()
    }

    /// The sizes of its dimensions without those of size 1.
    pub(super) fn squeezed(&self) -> Vec<&'a NcDimension> {
        let dimensions = self.dimensions().iter();
        dimensions.filter(|dimension| dimension.size != 1).collect()
    }

    /// A text attribute without blanks around it; `None` where it is empty.
    pub(super) fn text(&self, attribute: &str) -> Option<String> {
        let text = self.variable.attribute(attribute)?.value.as_string()?;
        let text = text.trim_matches(|c: char| c.is_whitespace() || c == '\0');
        (!text.is_empty()).then(|| text.to_owned())
    }

    /// The same in lower case; empty where there is none.
    pub(super) fn word(&self, attribute: &str) -> String {
        self.text(attribute)
            .unwrap_or_default()
            .to_ascii_lowercase()
    }

    pub(super) fn error(&self, reason: impl Into<String>) -> NetcdfError {
        NetcdfError::Data {
            variable: self.name().into(),
            reason: reason.into(),
        }
    }

    pub(super) fn contradiction(
        &self,
        first: &str,
        second: impl Into<String>,
        remedy: &str,
    ) -> NetcdfError {
        NetcdfError::Contradiction {
            first: format!("variable `{}`: {first}", self.name()),
            second: second.into(),
            remedy: remedy.into(),
        }
    }

    pub(super) fn footprint(&self, expected: impl Into<String>) -> NetcdfError {
        NetcdfError::Footprint {
            variable: self.name().into(),
            shape: self.shape(),
            expected: expected.into(),
        }
    }

    /// Checks the shape.
    pub(super) fn require_shape(&self, shape: &[u64], what: &str) -> Result<(), NetcdfError> {
        if self.shape() == shape {
            return Ok(());
        }
        Err(self.footprint(format!("{what} = {shape:?}")))
    }

    /// Checks that a number of values is one that is read.
    pub(super) fn require_few(&self, values: Option<u64>) -> Result<(), NetcdfError> {
        if values.is_some_and(|values| values <= MOST_VALUES) {
            return Ok(());
        }
        Err(NetcdfError::TooLarge {
            variable: self.name().into(),
            shape: self.shape(),
            most: MOST_VALUES,
        })
    }

    /// What the report says of it, without its values.
    pub(super) fn report(&self, role: &str) -> VariableReport {
        let dimensions = self.dimensions().iter();
        VariableReport {
            name: self.name().into(),
            role: role.into(),
            units: self.text("units").unwrap_or_default(),
            shape: dimensions.map(|d| (d.name.clone(), d.size)).collect(),
            ..VariableReport::default()
        }
    }
}
