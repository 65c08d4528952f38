//! Currents on a regular local grid.

use crate::{CurrentField, MapGrid};
use auv_types::{Point3, Vector3, Violations};

/// A current given at the nodes of a regular grid, at depth levels and at times, interpolated linearly.
///
/// Beyond the first and the last level or time, the nearest one is used. Outside the grid the current is 0.
/// Nodes on land (NaN) next to water take the mean of their wet neighbours, so that the current does not
/// vanish towards a coast; farther inland it is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct GriddedCurrent {
    grid: MapGrid,
    levels_m: Vec<f64>,
    times_s: Vec<f64>,
    /// North and east components, m/s, ordered by time, level and node.
    velocities_mps: Vec<[f32; 2]>,
    max_speed_mps: f64,
}

impl GriddedCurrent {
    /// A current from velocities (m/s north and east, NaN on land) with the index
    /// `(time * levels + level) * nodes + node`. Levels are depths in metres and times are mission times in
    /// seconds, both increasing.
    ///
    /// # Errors
    /// Everything malformed: the grid, levels or times that do not increase, a wrong number of velocities,
    /// speeds above 20 m/s.
    pub fn new(
        grid: MapGrid,
        levels_m: Vec<f64>,
        times_s: Vec<f64>,
        mut velocities_mps: Vec<[f32; 2]>,
    ) -> Result<Self, Violations> {
        let mut violations = grid.validate();
        for (axis, place) in [(&levels_m, "levels"), (&times_s, "times")] {
            let increases = axis.windows(2).all(|pair| pair[0] < pair[1]);
            let sound = !axis.is_empty() && axis.iter().all(|x| x.is_finite()) && increases;
            violations.require(sound, place, || {
                "do not increase; give one or more finite, increasing values".into()
            });
        }
        let values = [grid.columns, levels_m.len(), times_s.len()]
            .iter()
            .fold(grid.rows, |product, &n| product.saturating_mul(n));
        violations.require(velocities_mps.len() == values, "velocities", || {
            format!(
                "are {}; give {values}, one for each node, level and time",
                velocities_mps.len()
            )
        });
        let fast = velocities_mps.iter().any(|v| speed_mps(*v) > 20.0);
        violations.require(!fast, "velocities", || {
            "exceed 20 m/s: fill values or another unit; mask fill values as not a number".into()
        });
        violations.into_result()?;
        for layer in velocities_mps.chunks_exact_mut(grid.nodes()) {
            fill_land(layer, &grid);
        }
        let max_speed_mps = velocities_mps
            .iter()
            .map(|v| speed_mps(*v))
            .fold(0.0, f64::max);
        Ok(Self {
            grid,
            levels_m,
            times_s,
            velocities_mps,
            max_speed_mps,
        })
    }

    /// Its grid.
    #[must_use]
    pub fn grid(&self) -> &MapGrid {
        &self.grid
    }

    /// Its levels, metres.
    #[must_use]
    pub fn levels_m(&self) -> &[f64] {
        &self.levels_m
    }

    /// Its times, seconds.
    #[must_use]
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }
}

fn speed_mps(velocity: [f32; 2]) -> f64 {
    let [n, e] = velocity.map(f64::from);
    auv_types::libm::sqrt(n * n + e * e)
}

/// Extends a layer by one node into land and sets the rest of the land to 0.
fn fill_land(layer: &mut [[f32; 2]], grid: &MapGrid) {
    let wet: Vec<bool> = layer
        .iter()
        .map(|v| v[0].is_finite() && v[1].is_finite())
        .collect();
    for i in (0..layer.len()).filter(|&i| !wet[i]) {
        let (row, column) = (i / grid.columns, i % grid.columns);
        let (mut sum, mut count) = ([0.0_f32; 2], 0.0_f32);
        for r in row.saturating_sub(1)..(row + 2).min(grid.rows) {
            for c in column.saturating_sub(1)..(column + 2).min(grid.columns) {
                let neighbour = r * grid.columns + c;
                if wet[neighbour] {
                    let [n, e] = layer[neighbour];
                    sum = [sum[0] + n, sum[1] + e];
                    count += 1.0;
                }
            }
        }
        layer[i] = sum.map(|x| x / count.max(1.0));
    }
}

/// The two entries of an increasing axis around a value, and the weight of the second.
fn bracket(axis: &[f64], value: f64) -> (usize, usize, f64) {
    let above = axis.partition_point(|&x| x <= value);
    if above == 0 {
        (0, 0, 0.0)
    } else if above == axis.len() {
        (above - 1, above - 1, 0.0)
    } else {
        let (low, high) = (axis[above - 1], axis[above]);
        (above - 1, above, (value - low) / (high - low))
    }
}

impl CurrentField for GriddedCurrent {
    fn velocity_at(&self, position: &Point3<f64>, time_s: f64) -> Vector3<f64> {
        let Some(cell) = self.grid.cell_at(position.x, position.y) else {
            return Vector3::zeros();
        };
        let (early, late, later) = bracket(&self.times_s, time_s);
        let (upper, lower, deeper) = bracket(&self.levels_m, position.z);
        let corners = cell.weights(self.grid.columns);
        let mut sum = [0.0; 2];
        for (time, time_share) in [(early, 1.0 - later), (late, later)] {
            for (level, level_share) in [(upper, 1.0 - deeper), (lower, deeper)] {
                let share = time_share * level_share;
                if share > 0.0 {
                    let layer = (time * self.levels_m.len() + level) * self.grid.nodes();
                    for (node, weight) in corners {
                        let [n, e] = self.velocities_mps[layer + node].map(f64::from);
                        sum = [sum[0] + share * weight * n, sum[1] + share * weight * e];
                    }
                }
            }
        }
        Vector3::new(sum[0], sum[1], 0.0)
    }

    fn max_speed_mps(&self) -> f64 {
        // A weighted mean, up to rounding.
        self.max_speed_mps * (1.0 + 1e-12)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: MapGrid = MapGrid {
        north_m: 0.0,
        east_m: 0.0,
        cell_m: 100.0,
        rows: 4,
        columns: 5,
    };

    /// A field that is linear in every argument: linear interpolation reproduces it exactly.
    fn linear(n: f64, e: f64, z: f64, t: f64) -> [f64; 2] {
        [
            0.1 + 1e-4 * n - 2e-4 * e + 1e-3 * z + 1e-5 * t,
            0.2 - 1e-4 * n + 1e-4 * e,
        ]
    }

    fn field(land: &[usize]) -> GriddedCurrent {
        let (levels, times) = (vec![5.0, 20.0, 50.0], vec![0.0, 3_600.0]);
        let mut velocities = Vec::new();
        for &t in &times {
            for &z in &levels {
                for node in 0..GRID.nodes() {
                    let [n, e] = GRID.place(node / GRID.columns, node % GRID.columns);
                    velocities.push(if land.contains(&node) {
                        [f32::NAN; 2]
                    } else {
                        linear(n, e, z, t).map(|x| x as f32)
                    });
                }
            }
        }
        GriddedCurrent::new(GRID, levels, times, velocities).unwrap()
    }

    #[test]
    fn a_linear_field_is_reproduced_and_extended_constantly() {
        let current = field(&[]);
        for (n, e, z, t) in [(33.0, 271.0, 11.0, 900.0), (250.0, 399.0, 49.0, 3_500.0)] {
            let velocity = current.velocity_at(&Point3::new(n, e, z), t);
            let expected = linear(n, e, z, t);
            assert!((velocity.x - expected[0]).abs() < 1e-7);
            assert!((velocity.y - expected[1]).abs() < 1e-7);
        }
        let at = |z, t| current.velocity_at(&Point3::new(150.0, 150.0, z), t);
        assert_eq!(at(0.0, -5.0), at(5.0, 0.0));
        assert_eq!(at(500.0, 1e9), at(50.0, 3_600.0));
        assert_eq!(
            current.velocity_at(&Point3::new(-1.0, 0.0, 5.0), 0.0),
            Vector3::zeros()
        );
        assert!(at(f64::NAN, f64::NAN).iter().all(|x| x.is_finite()));
    }

    #[test]
    fn a_current_extends_to_the_coast_and_is_zero_inland() {
        let current = field(&[2, 3, 4, 7, 8, 9, 12, 13, 14, 17, 18, 19]);
        let at = |e| current.velocity_at(&Point3::new(150.0, e, 5.0), 0.0).norm();
        assert!(at(190.0) > 0.1);
        assert_eq!(at(350.0), 0.0);
        assert!(at(100.0) <= current.max_speed_mps());
    }

    #[test]
    fn fill_values_are_refused() {
        let result = GriddedCurrent::new(
            GRID,
            vec![0.0],
            vec![0.0, 0.0],
            vec![[1e37, 0.0]; GRID.nodes() * 2],
        );
        assert_eq!(result.unwrap_err().total(), 2);
    }
}
