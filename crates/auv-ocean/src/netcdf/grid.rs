//! The horizontal grid of a variable: its latitudes and longitudes, and the order of its values.

use super::coordinates::Pair;
use super::degrees::degrees;
use super::permuted::permuted;
use super::source::{Found, NetcdfError, Source};
use crate::FileReport;
use crate::axis_order::axis_order;
use crate::extent::extent_deg;

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
    let pair = Pair::of(source, found)?;
    // Two short axes may span a grid that no memory holds.
    let sizes = pair.dimensions.map(|i| found.shape()[i]);
    found.require_few(sizes[0].checked_mul(sizes[1]))?;
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
    report.extent_deg = extent_deg(&grid.latitudes_deg, &grid.longitudes_deg);
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

    /// The values of a variable over this grid, its other dimensions `outer` (places among the variable's)
    /// first.
    ///
    /// # Errors
    /// Another dimension of more than one value.
    pub(super) fn lay_out(
        &self,
        found: &Found<'_>,
        outer: &[usize],
        report: &mut FileReport,
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
        let values = permuted(found.valid_values(report)?, &sizes, &order);
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
