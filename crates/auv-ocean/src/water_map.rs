//! Shortest paths through water that is deep enough.

use crate::{MapGrid, SeaBed};
use auv_types::{Violations, libm};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// A map of the cells in which the water is proven deep enough, with a search for shortest paths.
///
/// A cell is water if the depth and slope bound of the sea bed prove the least depth everywhere in it. Cells
/// without a proof after eight bisections count as land. So every point of a [`WaterPath`] is deep enough,
/// not only the sampled ones.
///
/// ```
/// use auv_ocean::{AnalyticBed, BedFeature, Footprint, WaterMap};
///
/// let island = Footprint::Disc { centre: [500.0, 500.0], radius_m: 100.0 };
/// let bed = AnalyticBed::new(40.0).with(BedFeature::new("island", island, -5.0, 100.0));
/// let water = WaterMap::new(&bed, [0.0, 0.0], [1_000.0, 1_000.0], 10.0, 10.0).expect("a valid grid");
/// let around = water.path([500.0, 100.0], [500.0, 900.0]).expect("a path around the island");
/// assert!(around.length_m > 850.0 && around.length_m < 950.0);
/// assert!(water.path([500.0, 100.0], [500.0, 500.0]).is_none());
/// ```
#[derive(Clone, Debug)]
pub struct WaterMap {
    /// Nodes are the cells' centres.
    grid: MapGrid,
    water: Vec<bool>,
    /// The connected component of each water cell: no path joins different components.
    components: Vec<u32>,
}

/// A path through deep water.
#[derive(Clone, Debug, PartialEq)]
pub struct WaterPath {
    /// Its points, north and east in metres, both ends included.
    pub points: Vec<[f64; 2]>,
    /// Its horizontal length, metres.
    pub length_m: f64,
}

/// An open cell of the search: least estimated length first, ties by index.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Open(Reverse<(u64, usize)>);

impl Open {
    /// Lengths are not negative, so their bits have the same order.
    fn new(estimate_m: f64, cell: usize) -> Self {
        Self(Reverse((estimate_m.to_bits(), cell)))
    }
}

impl WaterMap {
    /// A map of the box between two corners (north, east in metres) in square cells, for water of at least
    /// `least_depth_m`.
    ///
    /// Complexity: linear in the cells; cells near the least depth are split.
    ///
    /// # Errors
    /// A box or cell size that gives a grid too large or too small.
    pub fn new(
        bed: &dyn SeaBed,
        south_west: [f64; 2],
        north_east: [f64; 2],
        cell_m: f64,
        least_depth_m: f64,
    ) -> Result<Self, Violations> {
        let half_m = 0.5 * cell_m;
        let grid = MapGrid::covering(
            south_west.map(|x| x + half_m),
            north_east.map(|x| x - half_m),
            cell_m,
        );
        let mut violations = grid.validate();
        violations.require(least_depth_m.is_finite(), "least_depth_m", || {
            "is not finite; give metres".into()
        });
        violations.into_result()?;
        let water: Vec<bool> = (0..grid.nodes())
            .map(|i| {
                let centre = grid.place(i / grid.columns, i % grid.columns);
                is_deep(bed, centre, half_m, least_depth_m, 8)
            })
            .collect();
        let components = vec![0; water.len()];
        let mut map = Self {
            grid,
            water,
            components,
        };
        map.flood();
        Ok(map)
    }

    /// Numbers the connected components from 1.
    fn flood(&mut self) {
        let (mut name, mut open) = (0, Vec::new());
        for source in 0..self.water.len() {
            if !self.water[source] || self.components[source] != 0 {
                continue;
            }
            name += 1;
            self.components[source] = name;
            open.push(source);
            while let Some(cell) = open.pop() {
                let before = open.len();
                open.extend(self.neighbours(cell).filter(|&k| self.components[k] == 0));
                for &next in &open[before..] {
                    self.components[next] = name;
                }
            }
        }
    }

    /// The cells' centres.
    #[must_use]
    pub fn grid(&self) -> &MapGrid {
        &self.grid
    }

    /// Whether a position lies in a cell of deep water.
    #[must_use]
    pub fn is_water(&self, place: [f64; 2]) -> bool {
        self.cell_of(place).is_some_and(|cell| self.water[cell])
    }

    /// A short path between two positions: the straight line if every cell on it is deep enough, otherwise
    /// the result of an any-angle search over the cells (Lazy Theta*: Nash, Koenig and Tovey 2010) with
    /// needless corners removed. `None` if either end is not in deep water or no path joins them.
    ///
    /// Deterministic. Complexity: linear in the cells on the straight line, or about `n log n` in the cells
    /// searched.
    #[must_use]
    pub fn path(&self, from: [f64; 2], to: [f64; 2]) -> Option<WaterPath> {
        let (start, target) = (self.cell_of(from)?, self.cell_of(to)?);
        if !self.water[start] || self.components[start] != self.components[target] {
            return None;
        }
        if self.sees(from, to) {
            return Some(WaterPath::through(vec![from, to]));
        }
        let parents = self.search(start, target)?;
        let mut points = vec![to];
        let mut cell = target;
        while cell != start {
            points.push(self.centre(cell));
            cell = parents[cell];
        }
        points.push(self.centre(start));
        points.push(from);
        points.reverse();
        Some(WaterPath::through(self.pulled_tight(points)))
    }

    /// Lazy Theta*: a cell first gets its predecessor's parent as its own. Whether the line to it is free is
    /// checked when the cell is expanded; if not, the parent is corrected then.
    fn search(&self, start: usize, target: usize) -> Option<Vec<usize>> {
        const UNSEEN: usize = usize::MAX;
        let mut lengths = vec![f64::INFINITY; self.water.len()];
        let mut parents = vec![UNSEEN; self.water.len()];
        let mut closed = vec![false; self.water.len()];
        let mut open = BinaryHeap::new();
        lengths[start] = 0.0;
        parents[start] = start;
        open.push(Open::new(self.distance_m(start, target), start));
        while let Some(Open(Reverse((_, cell)))) = open.pop() {
            if std::mem::replace(&mut closed[cell], true) {
                continue;
            }
            if !self.sees(self.centre(parents[cell]), self.centre(cell)) {
                let (length_m, parent) = self
                    .neighbours(cell)
                    .filter(|&next| closed[next] && next != cell)
                    .map(|next| (lengths[next] + self.distance_m(next, cell), next))
                    .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
                lengths[cell] = length_m;
                parents[cell] = parent;
            }
            if cell == target {
                return Some(parents);
            }
            let parent = parents[cell];
            for next in self.neighbours(cell) {
                if closed[next] {
                    continue;
                }
                let length_m = lengths[parent] + self.distance_m(parent, next);
                if length_m < lengths[next] {
                    lengths[next] = length_m;
                    parents[next] = parent;
                    open.push(Open::new(length_m + self.distance_m(next, target), next));
                }
            }
        }
        None
    }

    /// Removes every point whose neighbours see each other, until none is left.
    fn pulled_tight(&self, mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
        loop {
            let before = points.len();
            let mut kept = vec![points[0]];
            let mut at = 0;
            while at + 1 < points.len() {
                let farthest = (at + 2..points.len())
                    .rev()
                    .find(|&k| self.sees(points[at], points[k]));
                at = farthest.unwrap_or(at + 1);
                kept.push(points[at]);
            }
            points = kept;
            if points.len() == before {
                return points;
            }
        }
    }

    /// Whether a straight line touches only cells of deep water. All cells on it are visited; where it passes
    /// through a corner, both cells beside it.
    fn sees(&self, from: [f64; 2], to: [f64; 2]) -> bool {
        let in_cells = |x: [f64; 2]| {
            [
                (x[0] - self.grid.north_m) / self.grid.cell_m + 0.5,
                (x[1] - self.grid.east_m) / self.grid.cell_m + 0.5,
            ]
        };
        let (a, b) = (in_cells(from), in_cells(to));
        let mut cell = a.map(|x| x.floor() as i64);
        let last = b.map(|x| x.floor() as i64);
        let slope = [b[0] - a[0], b[1] - a[1]];
        let step = slope.map(|x| if x > 0.0 { 1 } else { -1 });
        // Shares of the line at which it leaves the cell, by axis.
        let mut leaves = [0, 1].map(|k| {
            let border = (cell[k] + i64::from(step[k] > 0)) as f64;
            if slope[k] == 0.0 {
                f64::INFINITY
            } else {
                (border - a[k]) / slope[k]
            }
        });
        let pace = slope.map(|x| 1.0 / x.abs());
        let moves = (last[0] - cell[0]).abs() + (last[1] - cell[1]).abs();
        if !self.is_water_cell(cell) {
            return false;
        }
        for _ in 0..moves {
            // Through a corner, up to rounding: both adjacent cells must be free.
            if (leaves[0] - leaves[1]).abs() < 1e-9 {
                let beside = [[cell[0] + step[0], cell[1]], [cell[0], cell[1] + step[1]]];
                if !beside.iter().all(|&side| self.is_water_cell(side)) {
                    return false;
                }
            }
            // Rounding never leads beyond the last cell of an axis.
            let axis = if cell[0] == last[0] {
                1
            } else if cell[1] == last[1] {
                0
            } else {
                usize::from(leaves[1] < leaves[0])
            };
            cell[axis] += step[axis];
            leaves[axis] += pace[axis];
            if !self.is_water_cell(cell) {
                return false;
            }
        }
        true
    }

    fn is_water_cell(&self, cell: [i64; 2]) -> bool {
        let (rows, columns) = (self.grid.rows as i64, self.grid.columns as i64);
        let inside = (0..rows).contains(&cell[0]) && (0..columns).contains(&cell[1]);
        inside && self.water[(cell[0] * columns + cell[1]) as usize]
    }

    /// The neighbouring water cells that a cell sees.
    fn neighbours(&self, cell: usize) -> impl Iterator<Item = usize> + '_ {
        const AROUND: [[i64; 2]; 8] = [
            [-1, -1],
            [-1, 0],
            [-1, 1],
            [0, -1],
            [0, 1],
            [1, -1],
            [1, 0],
            [1, 1],
        ];
        let columns = self.grid.columns;
        let (row, column) = ((cell / columns) as i64, (cell % columns) as i64);
        AROUND.into_iter().filter_map(move |[up, right]| {
            let free = self.is_water_cell([row + up, column + right])
                && self.is_water_cell([row + up, column])
                && self.is_water_cell([row, column + right]);
            free.then(|| (row + up) as usize * columns + (column + right) as usize)
        })
    }

    fn cell_of(&self, place: [f64; 2]) -> Option<usize> {
        let row = (place[0] - self.grid.north_m) / self.grid.cell_m + 0.5;
        let column = (place[1] - self.grid.east_m) / self.grid.cell_m + 0.5;
        let inside = row >= 0.0
            && column >= 0.0
            && row < self.grid.rows as f64
            && column < self.grid.columns as f64;
        inside.then(|| row as usize * self.grid.columns + column as usize)
    }

    fn centre(&self, cell: usize) -> [f64; 2] {
        self.grid
            .place(cell / self.grid.columns, cell % self.grid.columns)
    }

    fn distance_m(&self, a: usize, b: usize) -> f64 {
        distance_m(self.centre(a), self.centre(b))
    }
}

impl WaterPath {
    fn through(points: Vec<[f64; 2]>) -> Self {
        let length_m = points.windows(2).map(|p| distance_m(p[0], p[1])).sum();
        Self { points, length_m }
    }
}

fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (n, e) = (b[0] - a[0], b[1] - a[1]);
    libm::sqrt(n * n + e * e)
}

/// Whether a square is proven deep enough. It is bisected along the two axes in turn.
fn is_deep(
    bed: &dyn SeaBed,
    centre: [f64; 2],
    half_m: f64,
    least_depth_m: f64,
    halvings: u32,
) -> bool {
    let spare_m = bed.depth_at(centre[0], centre[1]) - least_depth_m;
    if spare_m < 0.0 {
        return false;
    }
    let reach_m = half_m * std::f64::consts::SQRT_2;
    if spare_m >= bed.max_slope_near(centre[0], centre[1], reach_m) * reach_m {
        return true;
    }
    let quarter_m = 0.5 * half_m;
    halvings >= 2
        && [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]]
            .iter()
            .all(|[n, e]| {
                let part = [centre[0] + n * quarter_m, centre[1] + e * quarter_m];
                is_deep(bed, part, quarter_m, least_depth_m, halvings - 2)
            })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{AnalyticBed, BedFeature, Effect, Footprint};
    use auv_types::Seed;
    use auv_types::rand::RngExt;

    /// A long wall with one gap, an island and an undulation.
    fn bed() -> AnalyticBed {
        let line = |points: Vec<[f64; 2]>, half_width_m| Footprint::Line {
            points,
            half_width_m,
        };
        AnalyticBed::new(60.0)
            .with(BedFeature::new(
                "wall",
                line(vec![[2_000.0, 0.0], [2_000.0, 5_000.0]], 100.0),
                -5.0,
                200.0,
            ))
            .with(
                BedFeature::new(
                    "gap",
                    line(vec![[1_500.0, 4_000.0], [2_500.0, 4_000.0]], 100.0),
                    30.0,
                    150.0,
                )
                .effect(Effect::Dig),
            )
            .with(BedFeature::new(
                "island",
                Footprint::Disc {
                    centre: [1_000.0, 2_500.0],
                    radius_m: 300.0,
                },
                -8.0,
                200.0,
            ))
    }

    fn map(cell_m: f64) -> WaterMap {
        WaterMap::new(&bed(), [0.0, 0.0], [4_000.0, 5_000.0], cell_m, 12.0).unwrap()
    }

    /// Dijkstra's algorithm over the same cells and their eight neighbours.
    fn along_cells_m(water: &WaterMap, from: [f64; 2], to: [f64; 2]) -> Option<f64> {
        let (start, target) = (water.cell_of(from)?, water.cell_of(to)?);
        let mut lengths = vec![f64::INFINITY; water.water.len()];
        lengths[start] = 0.0;
        let mut queue = std::collections::VecDeque::from([start]);
        while let Some(cell) = queue.pop_front() {
            for next in water.neighbours(cell) {
                let length_m = lengths[cell] + water.distance_m(cell, next);
                if length_m < lengths[next] - 1e-9 {
                    lengths[next] = length_m;
                    queue.push_back(next);
                }
            }
        }
        lengths[target].is_finite().then_some(lengths[target])
    }

    #[test]
    fn paths_stay_in_deep_water_and_are_shorter_than_along_cells() {
        let (bed, water) = (bed(), map(50.0));
        let mut random = Seed(8).stream(0);
        let mut turned = 0;
        for _ in 0..60 {
            let mut draw = || {
                [
                    random.random_range(0.0..4_000.0),
                    random.random_range(0.0..5_000.0),
                ]
            };
            let (from, to) = (draw(), draw());
            let path = water.path(from, to);
            if !water.is_water(from) || !water.is_water(to) {
                assert!(path.is_none());
                continue;
            }
            let cells_m = along_cells_m(&water, from, to);
            assert_eq!(path.is_some(), cells_m.is_some());
            let (Some(path), Some(cells_m)) = (path, cells_m) else {
                continue;
            };
            turned += usize::from(path.points.len() > 2);
            assert!(path.length_m >= distance_m(from, to) - 1e-9);
            // The ends lie up to half a cell diagonal from the cells' centres.
            assert!(path.length_m <= cells_m + 50.0 * std::f64::consts::SQRT_2 + 1e-6);
            for ends in path.points.windows(2) {
                for i in 0..=500 {
                    let share = f64::from(i) / 500.0;
                    let place = [0, 1].map(|k| ends[0][k] + share * (ends[1][k] - ends[0][k]));
                    assert!(bed.depth_at(place[0], place[1]) >= 12.0 - 1e-9);
                }
            }
        }
        assert!(turned > 10, "only {turned} paths had to turn");
    }

    #[test]
    fn a_path_round_a_disc_is_close_to_the_tangents_and_the_arc() {
        let (bed, radius_m) = (bed(), 500.0);
        let water = WaterMap::new(&bed, [0.0, 0.0], [1_700.0, 5_000.0], 10.0, 59.999).unwrap();
        let path = water.path([1_000.0, 1_000.0], [1_000.0, 4_000.0]).unwrap();
        let tangent = libm::sqrt(1_500.0 * 1_500.0 - radius_m * radius_m);
        let arc = radius_m * (std::f64::consts::PI - 2.0 * libm::acos(radius_m / 1_500.0));
        let shortest_m = 2.0 * tangent + arc;
        assert!(path.length_m > shortest_m - 1.0, "{}", path.length_m);
        assert!(
            path.length_m < shortest_m * 1.01,
            "{} {shortest_m}",
            path.length_m
        );
    }

    #[test]
    fn no_path_leads_through_a_closed_wall() {
        let mut closed = bed();
        closed.features.remove(1);
        let water = WaterMap::new(&closed, [0.0, 0.0], [4_000.0, 5_000.0], 50.0, 12.0).unwrap();
        assert!(water.path([500.0, 500.0], [3_500.0, 500.0]).is_none());
        assert!(map(50.0).path([500.0, 500.0], [3_500.0, 500.0]).is_some());
        assert!(water.path([f64::NAN, 0.0], [-5.0, 0.0]).is_none());
        assert!(WaterMap::new(&closed, [0.0; 2], [1e9; 2], 0.1, 5.0).is_err());
    }
}
