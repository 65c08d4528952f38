//! The horizontal grid of a variable: its latitudes and longitudes, and the order of its values.

use super::roles::{Axis, axis_of};
use super::source::{Found, NetcdfError, Source};
use super::units::{self, Quantity};
use crate::axis_order::axis_order;
use crate::{FileReport, VariableReport};

/// The grid of a variable. Rows go along latitude where positions are given by two axes.
#[derive(Clone, Debug)]
pub(super) struct Horizontal {
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// Degrees of every node, row-major.
    pub(super) latitudes_deg: Vec<f64>,
    pub(super) longitudes_deg: Vec<f64>,
    /// The places of the row and the column dimension among the variable's.
    dimensions: [usize; 2],
    /// For each row and column the stored one.
    orders: [Vec<usize>; 2],
    /// Whether positions are given by two one-dimensional axes.
    pub(super) regular: bool,
}

/// A pair of coordinate variables.
struct Pair<'a> {
    latitude: Found<'a>,
    longitude: Found<'a>,
    dimensions: [usize; 2],
}

/// Finds the grid of a variable.
///
/// # Errors
/// No latitudes and longitudes over its dimensions, positions in metres, attributes that contradict each
/// other or the values.
pub(super) fn horizontal(
    source: &Source,
    found: &Found<'_>,
    report: &mut FileReport,
) -> Result<Horizontal, NetcdfError> {
    let (latitudes, longitudes) = coordinates(source, found)?;
    let pair = one_dimensional(found, &latitudes, &longitudes)
        .or_else(|| two_dimensional(found, &latitudes, &longitudes))
        .or_else(|| by_size(found, &latitudes, &longitudes));
    let Some(pair) = pair else {
        return Err(unplaced(source, found, &latitudes, &longitudes)?);
    };
    let latitude = degrees(&pair.latitude, "latitude", 90.0, report)?;
    let longitude = degrees(&pair.longitude, "longitude", 360.0, report)?;
    let regular = pair.latitude.squeezed().len() == 1;
    let size = |k: usize| found.shape()[pair.dimensions[k]] as usize;
    let (rows, columns) = (size(0), size(1));
    if rows < 2 || columns < 2 {
        return Err(found.footprint("two or more rows and columns"));
    }
    let mut grid = Horizontal {
        rows,
        columns,
        latitudes_deg: Vec::new(),
        longitudes_deg: Vec::new(),
        dimensions: pair.dimensions,
        orders: [(0..rows).collect(), (0..columns).collect()],
        regular,
    };
    if regular {
        grid.lay_axes(&pair, &latitude, &longitude, report);
    } else {
        // The two coordinate variables may have another order of dimensions than the grid.
        let row = &found.dimensions()[pair.dimensions[0]].name;
        grid.latitudes_deg = turned(&pair.latitude, latitude, row);
        grid.longitudes_deg = turned(&pair.longitude, longitude, row);
    }
    report.extent_deg = Some(grid.extent_deg());
    Ok(grid)
}

/// The values of a coordinate of two dimensions, those along `row` first.
fn turned(coordinate: &Found<'_>, values: Vec<f64>, row: &str) -> Vec<f64> {
    let own = coordinate.squeezed();
    if own[0].name == row || own[1].name != row {
        return values;
    }
    let sizes = [own[0].size as usize, own[1].size as usize];
    permuted(values, &sizes, &[1, 0])
}

/// All latitudes and longitudes that share a dimension with a variable, those that its attribute
/// `coordinates` lists first. Where none shares one, all of the file.
fn coordinates<'a>(
    source: &'a Source,
    found: &Found<'_>,
) -> Result<(Vec<Found<'a>>, Vec<Found<'a>>), NetcdfError> {
    let listed = found.text("coordinates").unwrap_or_default();
    let is_listed = |name: &str| listed.split_whitespace().any(|word| word == name);
    let shares = |other: &Found<'_>| {
        let own = found.squeezed();
        other
            .squeezed()
            .iter()
            .any(|d| own.iter().any(|o| o.name == d.name))
    };
    let (mut latitudes, mut longitudes) = (Vec::new(), Vec::new());
    for near in [true, false] {
        for other in source.all().filter(|other| shares(other) == near) {
            if other.name() == found.name() || other.squeezed().is_empty() {
                continue;
            }
            let axis = if near {
                axis_of(&other)?
            } else {
                axis_of(&other).ok().flatten()
            };
            match axis {
                Some(Axis::Latitude) => latitudes.push(other),
                Some(Axis::Longitude) => longitudes.push(other),
                _ => {}
            }
        }
        if !latitudes.is_empty() && !longitudes.is_empty() {
            break;
        }
    }
    latitudes.sort_by_key(|f| !is_listed(f.name()));
    longitudes.sort_by_key(|f| !is_listed(f.name()));
    Ok((latitudes, longitudes))
}

fn dimension_of(found: &Found<'_>, name: &str) -> Option<usize> {
    found
        .dimensions()
        .iter()
        .position(|d| d.name == name && d.size != 1)
}

fn one_dimensional<'a>(
    found: &Found<'_>,
    latitudes: &[Found<'a>],
    longitudes: &[Found<'a>],
) -> Option<Pair<'a>> {
    let along = |axes: &[Found<'a>]| {
        axes.iter().find_map(|axis| {
            let [dimension] = axis.squeezed()[..] else {
                return None;
            };
            Some((*axis, dimension_of(found, &dimension.name)?))
        })
    };
    let (latitude, row) = along(latitudes)?;
    let (longitude, column) = along(longitudes)?;
    (row != column).then_some(Pair {
        latitude,
        longitude,
        dimensions: [row, column],
    })
}

fn two_dimensional<'a>(
    found: &Found<'_>,
    latitudes: &[Found<'a>],
    longitudes: &[Found<'a>],
) -> Option<Pair<'a>> {
    let over = |axis: &Found<'a>| {
        let [first, second] = axis.squeezed()[..] else {
            return None;
        };
        let places = [
            dimension_of(found, &first.name)?,
            dimension_of(found, &second.name)?,
        ];
        // Rows come first, unless the names say otherwise.
        Some(if is_x(&first.name) && !is_x(&second.name) {
            [places[1], places[0]]
        } else {
            places
        })
    };
    let (latitude, dimensions) = latitudes.iter().find_map(|f| Some((*f, over(f)?)))?;
    let same = |f: &&Found<'a>| {
        over(f).is_some_and(|d| d == dimensions || d == [dimensions[1], dimensions[0]])
    };
    let longitude = *longitudes.iter().find(same)?;
    Some(Pair {
        latitude,
        longitude,
        dimensions,
    })
}

/// Coordinates whose dimensions have other names, told by their sizes where these tell.
fn by_size<'a>(
    found: &Found<'_>,
    latitudes: &[Found<'a>],
    longitudes: &[Found<'a>],
) -> Option<Pair<'a>> {
    let large: Vec<usize> = (0..found.dimensions().len())
        .filter(|&i| found.dimensions()[i].size != 1)
        .collect();
    let &[row, column] = large.get(large.len().checked_sub(2)?..)? else {
        return None;
    };
    let [rows, columns] = [row, column].map(|i| found.dimensions()[i].size);
    let sizes = |f: &Found<'a>| f.squeezed().iter().map(|d| d.size).collect::<Vec<_>>();
    let of = |axes: &[Found<'a>], wanted: &[u64]| axes.iter().copied().find(|f| sizes(f) == wanted);
    let pair = |latitude, longitude, dimensions| Pair {
        latitude,
        longitude,
        dimensions,
    };
    if let Some(latitude) = of(latitudes, &[rows, columns])
        && let Some(longitude) = of(longitudes, &[rows, columns])
    {
        return Some(pair(latitude, longitude, [row, column]));
    }
    if rows == columns {
        return None;
    }
    if let Some(latitude) = of(latitudes, &[rows])
        && let Some(longitude) = of(longitudes, &[columns])
    {
        return Some(pair(latitude, longitude, [row, column]));
    }
    Some(pair(
        of(latitudes, &[columns])?,
        of(longitudes, &[rows])?,
        [column, row],
    ))
}

/// Whether a dimension runs along a model's rows, by its name.
pub(super) fn is_x(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.starts_with("xi_")
        || name.starts_with("lon")
        || ["x", "i", "nx", "ni", "nav_lon", "x_c", "xc", "xt_ocean"].contains(&name.as_str())
}

/// The error of a variable without latitudes and longitudes.
fn unplaced(
    source: &Source,
    found: &Found<'_>,
    latitudes: &[Found<'_>],
    longitudes: &[Found<'_>],
) -> Result<NetcdfError, NetcdfError> {
    for other in source.all() {
        let shares = other
            .squeezed()
            .iter()
            .any(|d| dimension_of(found, &d.name).is_some());
        if shares && axis_of(&other)? == Some(Axis::Projected) {
            let units = other
                .text("units")
                .map_or_else(|| "no units".into(), |u| format!("units `{u}`"));
            return Ok(other.error(format!(
                "has {units}: it is no longitude or latitude; give positions in degrees, for instance with \
                 `gdalwarp -t_srs EPSG:4326` or, where they are degrees, `ncatted -a units,{},o,c,degrees_east`",
                other.name()
            )));
        }
    }
    let missing = |variable, looked_for: &str| NetcdfError::Missing {
        variable,
        looked_for: looked_for.into(),
    };
    Ok(match (latitudes.first(), longitudes.first()) {
        (None, _) => missing(
            "latitude",
            "units degrees_north, standard_name latitude, or lat, latitude, nav_lat, lat_rho",
        ),
        (_, None) => missing(
            "longitude",
            "units degrees_east, standard_name longitude, or lon, longitude, nav_lon, lon_rho",
        ),
        (Some(latitude), Some(_)) => found.footprint(format!(
            "dimensions that are those of `{}` and of the longitudes, by name or by size",
            latitude.name()
        )),
    })
}

/// The values of a coordinate in degrees. Values beyond the limit become NaN where they are few.
fn degrees(
    found: &Found<'_>,
    role: &str,
    limit: f64,
    report: &mut FileReport,
) -> Result<Vec<f64>, NetcdfError> {
    let units = found.text("units");
    let factor = match &units {
        None => {
            report
                .assumed
                .push(format!("`{}` has no units: taken as degrees", found.name()));
            1.0
        }
        Some(units) => units::factor(units, Quantity::Angle).ok_or_else(|| {
            found.error(format!(
                "has units `{units}`; give degrees_north or degrees_east"
            ))
        })?,
    };
    let mut values = found.values()?;
    if !units::is_one(factor) {
        for value in &mut values {
            *value *= factor;
        }
        report.converted.push(format!(
            "`{}` from {} to degrees",
            found.name(),
            units.as_deref().unwrap_or_default()
        ));
    }
    drop_beyond(found, &mut values, (role, limit), report)?;
    let own = found.report(role);
    report
        .variables
        .push(VariableReport::with_values(own, &values));
    Ok(values)
}

/// Takes out values beyond a limit where they are few.
fn drop_beyond(
    found: &Found<'_>,
    values: &mut [f64],
    (role, limit): (&str, f64),
    report: &mut FileReport,
) -> Result<(), NetcdfError> {
    let sound = values.iter().filter(|x| x.is_finite()).count();
    let beyond = |x: f64| x.abs() > limit + 1e-6;
    let wrong = values
        .iter()
        .filter(|x| x.is_finite() && beyond(**x))
        .count();
    if wrong * 10 > sound {
        let worst = values
            .iter()
            .copied()
            .find(|x| x.is_finite() && beyond(*x))
            .unwrap_or_default();
        let units = found.text("units").unwrap_or_else(|| "degrees".into());
        return Err(found.contradiction(
            &format!("units `{units}`"),
            format!("its values, like {worst}"),
            "give degrees of latitude within 90 and of longitude within 360",
        ));
    }
    if wrong > 0 {
        report.dropped.push(format!(
            "`{}`: {wrong} values are no {role} and leave holes",
            found.name()
        ));
        for value in values {
            if beyond(*value) {
                *value = f64::NAN;
            }
        }
    }
    Ok(())
}

impl Horizontal {
    /// Takes in the positions of two axes, in rising order.
    fn lay_axes(
        &mut self,
        pair: &Pair<'_>,
        latitude: &[f64],
        longitude: &[f64],
        report: &mut FileReport,
    ) {
        let (row_order, rows_told) = axis_order(latitude, false);
        let (column_order, columns_told) = axis_order(longitude, true);
        for (name, told) in [
            (pair.latitude.name(), rows_told),
            (pair.longitude.name(), columns_told),
        ] {
            report
                .dropped
                .extend(told.map(|told| format!("{name}: {told}")));
        }
        (self.rows, self.columns) = (row_order.len(), column_order.len());
        for &row in &row_order {
            for &column in &column_order {
                self.latitudes_deg.push(latitude[row]);
                self.longitudes_deg.push(longitude[column]);
            }
        }
        self.orders = [row_order, column_order];
    }

    /// South, north, west and east.
    fn extent_deg(&self) -> [f64; 4] {
        let within = |values: &[f64]| {
            let sound = || values.iter().copied().filter(|x| x.is_finite());
            let low = sound().fold(f64::INFINITY, f64::min);
            let high = sound().fold(f64::NEG_INFINITY, f64::max);
            [low, high]
        };
        let ([south, north], [west, east]) =
            (within(&self.latitudes_deg), within(&self.longitudes_deg));
        [south, north, west, east]
    }

    /// The values of a variable over this grid, its other dimensions `outer` (places among the variable's)
    /// first.
    ///
    /// # Errors
    /// Another dimension of more than one value.
    pub(super) fn lay_out(
        &self,
        found: &Found<'_>,
        outer: &[usize],
    ) -> Result<Vec<f64>, NetcdfError> {
        let dimensions = found.dimensions();
        let order: Vec<usize> = outer.iter().copied().chain(self.dimensions).collect();
        for (i, dimension) in dimensions.iter().enumerate() {
            if dimension.size != 1 && !order.contains(&i) {
                return Err(found.footprint(format!(
                    "one value of `{name}`, for instance with `ncks -d {name},0`",
                    name = dimension.name
                )));
            }
        }
        let sizes: Vec<usize> = dimensions.iter().map(|d| d.size as usize).collect();
        let values = permuted(found.values()?, &sizes, &order);
        let [rows, columns] = self.dimensions.map(|i| sizes[i]);
        Ok(self.reordered(values, rows, columns))
    }

    /// Rows and columns in this grid's order.
    fn reordered(&self, values: Vec<f64>, rows: usize, columns: usize) -> Vec<f64> {
        let [row_order, column_order] = &self.orders;
        let same = |order: &[usize], n: usize| {
            order.len() == n && order.iter().enumerate().all(|(i, &k)| i == k)
        };
        if same(row_order, rows) && same(column_order, columns) {
            return values;
        }
        let layers = values.chunks_exact(rows * columns);
        layers
            .flat_map(|layer| {
                row_order.iter().flat_map(move |row| {
                    column_order
                        .iter()
                        .map(move |column| layer[row * columns + column])
                })
            })
            .collect()
    }

    /// Whether rows and columns are as stored.
    pub(super) fn in_stored_order(&self) -> bool {
        let mut orders = self.orders.iter();
        orders.all(|order| order.iter().enumerate().all(|(i, &k)| i == k))
    }
}

/// Values with their dimensions in another order. Dimensions that `order` leaves out have size 1.
pub(super) fn permuted(values: Vec<f64>, sizes: &[usize], order: &[usize]) -> Vec<f64> {
    if order.windows(2).all(|pair| pair[0] < pair[1]) {
        return values;
    }
    let stride = |dimension: usize| sizes[dimension + 1..].iter().product::<usize>();
    let strides: Vec<usize> = order.iter().map(|&d| stride(d)).collect();
    let counts: Vec<usize> = order.iter().map(|&d| sizes[d]).collect();
    let mut index = vec![0; order.len()];
    let mut turned = Vec::with_capacity(values.len());
    for _ in 0..values.len() {
        turned.push(
            values[index
                .iter()
                .zip(&strides)
                .map(|(i, s)| i * s)
                .sum::<usize>()],
        );
        for k in (0..index.len()).rev() {
            index[k] += 1;
            if index[k] < counts[k] {
                break;
            }
            index[k] = 0;
        }
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permuted_dimensions_are_put_in_order() {
        let values: Vec<f64> = (0..24).map(f64::from).collect();
        let sizes = [2, 3, 1, 4];
        let turned = permuted(values.clone(), &sizes, &[3, 0, 1]);
        for (i, value) in turned.iter().enumerate() {
            let (x, rest) = (i / 6, i % 6);
            assert_eq!(*value as usize, (rest / 3) * 12 + (rest % 3) * 4 + x);
        }
        assert_eq!(permuted(values.clone(), &sizes, &[0, 1, 3]), values);
    }
}
