//! The values of a variable: unpacked, NaN where they are missing.

use super::source::{Found, NetcdfError};
use crate::FileReport;
use netcdf_reader::{NcAttrValue, NcType};

/// Values of at least this magnitude are fill values (1e37, 9.97e36), regardless of the attributes.
const FILL_FROM: f64 = 1e30;

impl Found<'_> {
    fn attribute(&self, name: &str) -> Option<&NcAttrValue> {
        self.variable.attribute(name).map(|found| &found.value)
    }

    /// All values, unpacked, with NaN for fill values. `valid_min`, `valid_max` and `valid_range` are ignored:
    /// tools that join files leave those of the first on coordinates.
    pub(super) fn values(&self) -> Result<Vec<f64>, NetcdfError> {
        Ok(self.unpacked(None)?.0)
    }

    /// All values, unpacked, with NaN for fill values and for values that the attributes `valid_min`,
    /// `valid_max` and `valid_range` exclude, with a word on these.
    ///
    /// # Errors
    /// Attributes that exclude most values.
    pub(super) fn valid_values(&self, report: &mut FileReport) -> Result<Vec<f64>, NetcdfError> {
        let Some(valid) = self.valid_range() else {
            return self.values();
        };
        let (values, excluded) = self.unpacked(Some(valid))?;
        let sound = values.iter().filter(|x| x.is_finite()).count();
        if let Some(one) = excluded.one {
            if excluded.count > sound {
                return Err(self.contradiction(
                    &format!("its valid range, {} to {},", valid.0[0], valid.0[1]),
                    format!("most of its values, like {one}"),
                    &format!("correct the attributes, or take them out with `ncatted -a valid_range,{0},d,, -a valid_min,{0},d,, -a valid_max,{0},d,,`", self.name()),
                ));
            }
            report.dropped.push(format!(
                "`{}`: {} values like {one} are outside of its valid range and count as missing",
                self.name(),
                excluded.count
            ));
        }
        Ok(values)
    }

    fn unpacked(&self, valid: Option<Valid>) -> Result<(Vec<f64>, Excluded), NetcdfError> {
        let sizes = self.shape();
        let mut sizes = sizes.iter();
        self.require_few(sizes.try_fold(1_u64, |product, &n| product.checked_mul(n)))?;
        let raw = self
            .file
            .read_variable_as_f64(self.name())
            .map_err(|error| self.error(format!("{error}; give a complete numeric variable")))?;
        // In place, where the values are in order, as they are: a large chart is kept once.
        let mut values = match raw.is_standard_layout() {
            true => raw.into_raw_vec_and_offset().0,
            false => raw.iter().copied().collect(),
        };
        let wrap = self.wrap();
        let wrapped = |x: f64| if x < 0.0 { x + wrap } else { x };
        let mut fills = self.fills();
        fills.iter_mut().for_each(|fill| *fill = wrapped(*fill));
        let number = |name| self.attribute(name).and_then(NcAttrValue::as_f64);
        let scale = number("scale_factor").unwrap_or(1.0);
        let offset = number("add_offset").unwrap_or(0.0);
        let mut excluded = Excluded::default();
        for x in &mut values {
            let stored = wrapped(*x);
            let value = stored * scale + offset;
            let equal = |fill: &f64| stored.total_cmp(fill).is_eq();
            let missing = !stored.is_finite()
                || stored.abs() >= FILL_FROM
                || fills.iter().any(equal)
                || !value.is_finite()
                || value.abs() >= FILL_FROM;
            *x = match valid {
                _ if missing => f64::NAN,
                Some(valid) if !valid.holds(stored, value) => {
                    excluded.count += 1;
                    excluded.one.get_or_insert(value);
                    f64::NAN
                }
                _ => value,
            };
        }
        Ok((values, excluded))
    }

    /// What is added to negative values: the attribute `_Unsigned` says that integers stored as signed are not.
    fn wrap(&self) -> f64 {
        if self.word("_Unsigned") != "true" {
            return 0.0;
        }
        match self.variable.dtype() {
            NcType::Byte => 256.0,
            NcType::Short => 65_536.0,
            NcType::Int => 4_294_967_296.0,
            _ => 0.0,
        }
    }

    /// The values that mean "missing", as stored: by attribute, else netCDF's own for cells that were never
    /// written.
    fn fills(&self) -> Vec<f64> {
        let of = |name| self.attribute(name).and_then(NcAttrValue::as_f64_vec);
        let own = of("_FillValue").unwrap_or_else(|| self.default_fill().into_iter().collect());
        let mut fills = own;
        fills.extend(of("missing_value").unwrap_or_default());
        // An attribute of another type than the data may differ by its rounding.
        if *self.variable.dtype() == NcType::Float {
            let narrow: Vec<f64> = fills.iter().map(|&fill| f64::from(fill as f32)).collect();
            fills.extend(narrow);
        }
        fills
    }

    fn default_fill(&self) -> Option<f64> {
        Some(match self.variable.dtype() {
            NcType::Short => -32_767.0,
            NcType::Int => -2_147_483_647.0,
            NcType::UShort => 65_535.0,
            NcType::UInt => 4_294_967_295.0,
            NcType::Int64 => -9_223_372_036_854_775_806.0,
            NcType::UInt64 => 18_446_744_073_709_551_614.0,
            // Those of floats are above `FILL_FROM`; bytes have none.
            _ => return None,
        })
    }

    /// The range that the attributes give, in their own kind of values (netCDF User's Guide: those of packed
    /// values, unless the attribute is of a wider type, like the scale).
    fn valid_range(&self) -> Option<Valid> {
        let of = |name| Some((self.attribute(name)?, self.attribute(name)?.as_f64_vec()?));
        let (kind, [low, high]) = match of("valid_range") {
            Some((kind, range)) => (kind, [*range.first()?, *range.get(1)?]),
            None => {
                let (low, high) = (of("valid_min"), of("valid_max"));
                let end = |end: &Option<(&NcAttrValue, Vec<f64>)>, open: f64| {
                    let found = end.as_ref().and_then(|(_, values)| values.first().copied());
                    found.unwrap_or(open)
                };
                let range = [end(&low, f64::NEG_INFINITY), end(&high, f64::INFINITY)];
                (low.or(high)?.0, range)
            }
        };
        let whole = !matches!(self.variable.dtype(), NcType::Float | NcType::Double);
        let real = matches!(kind, NcAttrValue::Floats(_) | NcAttrValue::Doubles(_));
        Some(Valid([low, high], whole && real))
    }
}

/// The least and greatest valid value, and whether they are of unpacked values.
#[derive(Clone, Copy)]
struct Valid([f64; 2], bool);

impl Valid {
    fn holds(self, stored: f64, value: f64) -> bool {
        let Self([low, high], unpacked) = self;
        let x = if unpacked { value } else { stored };
        // The attribute may be rounded to fewer digits than the value.
        low - 1e-6 * low.abs() <= x && x <= high + 1e-6 * high.abs()
    }
}

/// Values that a valid range excludes.
#[derive(Default)]
struct Excluded {
    count: usize,
    one: Option<f64>,
}
