//! Charted depths on a curvilinear grid of latitudes and longitudes.

use crate::curvilinear::Curvilinear;
use crate::extent::extent_deg;
use crate::oddities::oddities;
use crate::{Geodetic, GriddedBed, LocalFrame, MapGrid};
use auv_types::Violations;

/// Depths at the nodes of a curvilinear grid, row-major.
#[derive(Clone, Debug, PartialEq)]
pub struct ChartedDepths {
    columns: usize,
    latitudes_deg: Vec<f64>,
    longitudes_deg: Vec<f64>,
    depths_m: Vec<f64>,
}

impl ChartedDepths {
    /// Depths in metres (positive down; 0, negative or not a number: land) and their positions, all with the
    /// index `row * columns + column`. Nodes without a valid position are holes.
    ///
    /// # Errors
    /// Slices of different lengths, fewer than two rows or columns, or no valid position.
    pub fn new(
        columns: usize,
        latitudes_deg: Vec<f64>,
        longitudes_deg: Vec<f64>,
        depths_m: Vec<f64>,
    ) -> Result<Self, Violations> {
        let mut violations = Violations::new();
        let n = depths_m.len();
        let whole = columns >= 2 && n >= 2 * columns && n.is_multiple_of(columns);
        violations.require(whole, "depths", || {
            format!("are {n} in rows of {columns}; give two or more whole rows of two or more")
        });
        for (axis, place) in [
            (&latitudes_deg, "latitudes"),
            (&longitudes_deg, "longitudes"),
        ] {
            violations.require(axis.len() == n, place, || {
                format!("are {} for {n} depths; give one each", axis.len())
            });
        }
        let charted = Self {
            columns,
            latitudes_deg,
            longitudes_deg,
            depths_m,
        };
        violations.require(charted.centre().is_some(), "latitudes", || {
            "and longitudes name no place on Earth; give degrees".into()
        });
        violations.into_result()?;
        Ok(charted)
    }

    /// Rows and columns.
    #[must_use]
    pub fn shape(&self) -> (usize, usize) {
        (self.depths_m.len() / self.columns, self.columns)
    }

    /// Depths in metres, row-major.
    #[must_use]
    pub fn depths_m(&self) -> &[f64] {
        &self.depths_m
    }

    /// The position and depth of every node, row-major.
    pub fn soundings(&self) -> impl Iterator<Item = Geodetic> + '_ {
        let places = self.latitudes_deg.iter().zip(&self.longitudes_deg);
        places
            .zip(&self.depths_m)
            .map(|((&latitude_deg, &longitude_deg), &depth_m)| Geodetic {
                latitude_deg,
                longitude_deg,
                depth_m,
            })
    }

    /// The centre of the box around all nodes, a good datum.
    #[must_use]
    pub fn centre(&self) -> Option<Geodetic> {
        let [south, north, west, east] = extent_deg(&self.latitudes_deg, &self.longitudes_deg)?;
        Some(Geodetic {
            latitude_deg: 0.5 * (south + north),
            longitude_deg: 0.5 * (west + east),
            depth_m: 0.0,
        })
    }

    /// Southernmost and northernmost latitude, westernmost and easternmost longitude, degrees; longitudes count
    /// from 0 where the chart lies across the antimeridian.
    #[must_use]
    pub fn extent_deg(&self) -> Option<[f64; 4]> {
        extent_deg(&self.latitudes_deg, &self.longitudes_deg)
    }

    /// The depths as a sea bed in a local frame, on a grid of `cell_m` that covers all of them.
    ///
    /// Bilinear within the cells of the chart, with depth 0 on land, then raised where needed so that **the
    /// bed is never deeper than charted at a charted node**: a single shoal is not smoothed away. Outside the
    /// chart is land.
    ///
    /// # Errors
    /// A cell size that gives a grid too large or too small.
    pub fn to_bed(&self, frame: &LocalFrame, cell_m: f64) -> Result<GriddedBed, Violations> {
        let chart = self.projected(frame);
        let (south_west, north_east) = chart.extent();
        self.laid_over(&chart, MapGrid::covering(south_west, north_east, cell_m))
    }

    /// The same on a given grid, for instance over a part of the chart.
    ///
    /// # Errors
    /// A malformed grid.
    pub fn to_bed_on(&self, frame: &LocalFrame, grid: MapGrid) -> Result<GriddedBed, Violations> {
        self.laid_over(&self.projected(frame), grid)
    }

    /// What is odd about the chart's cells, one sentence each: cells many times as long as those around them
    /// and cells between repeated positions are holes, and so land.
    #[must_use]
    pub fn oddities(&self) -> Vec<String> {
        oddities(self.columns, &self.latitudes_deg, &self.longitudes_deg)
    }

    /// How many nodes of a local grid lie in several cells of the chart, of which the smallest counts.
    ///
    /// # Errors
    /// A malformed grid.
    pub fn overlaps(&self, frame: &LocalFrame, grid: &MapGrid) -> Result<usize, Violations> {
        grid.validate().into_result()?;
        Ok(self.projected(frame).stencils(grid).1)
    }

    fn projected(&self, frame: &LocalFrame) -> Curvilinear {
        Curvilinear::new(
            frame,
            self.columns,
            &self.latitudes_deg,
            &self.longitudes_deg,
        )
    }

    fn laid_over(&self, chart: &Curvilinear, grid: MapGrid) -> Result<GriddedBed, Violations> {
        grid.validate().into_result()?;
        // NaN becomes 0 too.
        let charted_m = |node: usize| self.depths_m[node].max(0.0);
        let mut depths_m: Vec<f64> = chart
            .stencils(&grid)
            .0
            .into_iter()
            .map(|stencil| {
                stencil.map_or(0.0, |nodes| {
                    nodes.iter().map(|&(node, w)| w * charted_m(node)).sum()
                })
            })
            .collect();
        for (node, place) in chart.places.iter().enumerate() {
            if let Some(cell) = grid.cell_at(place[0], place[1]) {
                let corners = cell.weights(grid.columns);
                let bed_m: f64 = corners.iter().map(|&(i, w)| w * depths_m[i]).sum();
                let excess_m = bed_m - charted_m(node);
                if excess_m > 0.0 {
                    for (i, _) in corners {
                        depths_m[i] -= excess_m;
                    }
                }
            }
        }
        GriddedBed::new(grid, depths_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SeaBed;

    /// The largest excess of a bed's depth over the chart at the charted nodes, metres.
    fn deepest_excess_m(charted: &ChartedDepths, frame: &LocalFrame, bed: &dyn SeaBed) -> f64 {
        charted
            .soundings()
            .filter(|sounding| sounding.validate().is_empty())
            .map(|sounding| {
                let point = frame.to_local(&sounding);
                bed.depth_at(point.x, point.y) - sounding.depth_m.max(0.0)
            })
            .fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn a_single_shoal_between_local_nodes_is_kept() {
        let (rows, columns) = (12, 10);
        let (mut latitudes, mut longitudes, mut depths) = (Vec::new(), Vec::new(), Vec::new());
        for row in 0..rows {
            for column in 0..columns {
                let (r, c) = (f64::from(row), f64::from(column));
                latitudes.push(49.6 + 0.0012 * r + 0.0002 * c);
                longitudes.push(-124.8 + 0.0018 * c - 0.0003 * r);
                depths.push(if (row, column) == (6, 4) { 3.0 } else { 50.0 });
            }
        }
        let charted = ChartedDepths::new(10, latitudes, longitudes, depths).unwrap();
        let frame = LocalFrame::new(charted.centre().unwrap()).unwrap();
        for cell_m in [40.0, 130.0, 200.0] {
            let bed = charted.to_bed(&frame, cell_m).unwrap();
            assert!(deepest_excess_m(&charted, &frame, &bed) <= 1e-9);
            let deepest = bed.node_depths_m().iter().copied().fold(0.0, f64::max);
            assert!((deepest - 50.0).abs() < 1e-9, "{deepest}");
        }
    }

    #[test]
    fn depths_without_positions_are_refused() {
        let nowhere = ChartedDepths::new(2, vec![f64::NAN; 4], vec![1e37; 4], vec![5.0; 4]);
        assert_eq!(nowhere.unwrap_err().total(), 1);
        assert!(ChartedDepths::new(0, vec![], vec![], vec![]).is_err());
    }
}
