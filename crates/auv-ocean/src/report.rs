//! What was read from a file, in words and numbers that an operator can check.

/// What was read from one file.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FileReport {
    /// The file's form: `NetCDF`, `GeoTIFF`, ...
    pub format: String,
    /// The variables used.
    pub variables: Vec<VariableReport>,
    /// Southernmost and northernmost latitude, westernmost and easternmost longitude, degrees.
    pub extent_deg: Option<[f64; 4]>,
    /// First and last record, seconds since 1970-01-01 00:00 UTC, and the number of records.
    pub records: Option<(f64, f64, usize)>,
    /// Depths of its levels, metres, where they are the same everywhere.
    pub levels_m: Vec<f64>,
    /// What depths are measured from, in the words of the mission.
    pub vertical: Option<String>,
    /// What was converted: units, signs, orders of axes. Nothing is lost by it.
    pub converted: Vec<String>,
    /// What was dropped: records, cells, values.
    pub dropped: Vec<String>,
    /// What the file does not say and was assumed.
    pub assumed: Vec<String>,
}

/// A variable of a file.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct VariableReport {
    /// Its name.
    pub name: String,
    /// What it was used for.
    pub role: String,
    /// Its units as the file gives them; empty where it gives none.
    pub units: String,
    /// The names and sizes of its dimensions.
    pub shape: Vec<(String, u64)>,
    /// Share of missing values, 0 to 1.
    pub missing_share: f64,
    /// Least and greatest value after conversion.
    pub range: Option<[f64; 2]>,
}

impl VariableReport {
    /// Takes the share of missing values (not finite) and the range of the others from the values.
    #[must_use]
    #[cfg(any(feature = "netcdf", feature = "geotiff"))]
    pub(crate) fn with_values(mut self, values: &[f64]) -> Self {
        let (mut missing, mut range) = (0_usize, None);
        for &value in values {
            if value.is_finite() {
                let [low, high] = range.unwrap_or([value; 2]);
                range = Some([f64::min(low, value), f64::max(high, value)]);
            } else {
                missing += 1;
            }
        }
        self.missing_share = missing as f64 / values.len().max(1) as f64;
        self.range = range;
        self
    }
}

impl FileReport {
    /// What an operator should know before he trusts the file, besides what was converted.
    pub fn warnings(&self) -> impl Iterator<Item = &str> {
        self.dropped.iter().chain(&self.assumed).map(String::as_str)
    }
}
