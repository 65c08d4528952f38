//! Whether there was a way out: what a vehicle could have done that knew everything.
//!
//! A [`Sea`] is the truth over a stretch of time, as a simulation left it. [`Sea::escape`] asks from
//! both sides on a grid of cells round the vehicle:
//!
//! - *nowhere left*: every place the vehicle can possibly be is followed, always in its favour. A cell
//!   is shut only while one obstacle holds the whole of it; within a interval of time the vehicle goes as
//!   far as it likes through cells that are not; only never farther from where it began than its
//!   speed through the water takes it. Turn, pitch, least speed and the bed do not bind it. When no
//!   cell is left, nothing that vehicle could have done would have kept it clear;
//! - *a way out*: cells wholly clear for a whole interval of time, from one to the next at the vehicle's
//!   speed. What is found is a track, checked against the truth exactly, of a vehicle that stops and
//!   turns on the spot.
//!
//! ```
//! use auv_obstacles::{Region, TimedPoint};
//! use auv_sim::oracle::{SeaInterval, Sea, Verdict};
//! use auv_types::{Point3, Vector3};
//!
//! // A ball grows over the vehicle faster than it can leave.
//! let growing = Region { growth_mps: 5.0, ..Region::ball(Point3::new(30.0, 0.0, 50.0), 10.0) };
//! let interval = |k: u32| SeaInterval {
//!     from_s: 10.0 * f64::from(k),
//!     until_s: 10.0 * f64::from(k + 1),
//!     place: Point3::new(0.0, 0.0, 50.0),
//!     regions: vec![growing],
//!     water: Vector3::zeros(),
//!     water_differs_mps: 0.0,
//!     max_speed_mps: 3.0,
//! };
//! let sea = Sea { intervals: (0..5).map(interval).collect(), bounds: None };
//! assert!(matches!(sea.escape(0), Verdict::NoEscape { by_s } if by_s <= 30.0));
//! ```

mod grid;

use auv_obstacles::{Region, TimedPoint};
use auv_planning::Trajectory;
use auv_types::{Bounds, Point3, Vector3};
use grid::Grid;

/// Sizes of cells in the order tried, metres: 800 m round the vehicle coarsely, 200 m finely.
const CELLS_M: [f64; 3] = [10.0, 5.0, 2.5];

/// The truth between two moments.
#[derive(Clone, Debug, PartialEq)]
pub struct SeaInterval {
    /// Its begin, mission time in seconds.
    pub from_s: f64,
    /// Its end, seconds.
    pub until_s: f64,
    /// Where the vehicle truly was at its begin.
    pub place: Point3<f64>,
    /// What the obstacles covered.
    pub regions: Vec<Region>,
    /// The current that carries a vehicle, m/s ...
    pub water: Vector3<f64>,
    /// ... and by how much it may differ from that from place to place.
    pub water_differs_mps: f64,
    /// The vehicle's greatest speed through the water, m/s.
    pub max_speed_mps: f64,
}

impl SeaInterval {
    fn duration_s(&self) -> f64 {
        self.until_s - self.from_s
    }

    /// Least distance from a place to a region over the interval.
    fn clearance_m(&self, region: &Region, place: Point3<f64>) -> f64 {
        let (from, to) = self.rest(place);
        region.clearance(&from, &to).clearance_m
    }

    fn rest(&self, place: Point3<f64>) -> (TimedPoint, TimedPoint) {
        (
            TimedPoint::new(place, self.from_s),
            TimedPoint::new(place, self.until_s),
        )
    }
}

/// The sea as it truly was, interval by interval without gaps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sea {
    /// The intervals, the earliest first.
    pub intervals: Vec<SeaInterval>,
    /// The box the vehicle must stay in.
    pub bounds: Option<Bounds>,
}

/// What the oracle says.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Proven: at this time at the latest anything that could have been done had led into an obstacle.
    NoEscape {
        /// Mission time, seconds.
        by_s: f64,
    },
    /// A track that stays clear to the end, or until it is out of the surroundings looked at.
    Escape(Trajectory),
    /// Neither is found on the finest grid.
    Unknown,
}

impl Sea {
    /// Whether there was a way out for the vehicle from the begin of a interval on; [`Verdict::Unknown`]
    /// where there is no such interval.
    ///
    /// # Determinism
    /// Depends on the arguments alone.
    #[must_use]
    pub fn escape(&self, interval: usize) -> Verdict {
        for cell_m in CELLS_M {
            let Some(grid) = self.grid(interval, cell_m) else {
                break;
            };
            if let Some(way) = grid.way_out().filter(|way| self.is_clear(way)) {
                return Verdict::Escape(way);
            }
            if let Some(by_s) = grid.nowhere_left_s() {
                return Verdict::NoEscape { by_s };
            }
        }
        Verdict::Unknown
    }

    fn grid(&self, interval: usize, cell_m: f64) -> Option<Grid<'_>> {
        Grid::new(self.intervals.get(interval..)?, self.bounds, cell_m)
    }

    /// Whether there is a way out through the coarsest cells.
    fn has_way_out(&self, interval: usize) -> bool {
        let way = self
            .grid(interval, CELLS_M[0])
            .and_then(|grid| grid.way_out());
        way.is_some_and(|way| self.is_clear(&way))
    }

    /// The latest begin of a interval from which a way out is found on the coarsest grid, on the vehicle's
    /// own track before `until_s`, seconds.
    #[must_use]
    pub fn last_escape_s(&self, until_s: f64) -> Option<f64> {
        // Where a way out is found, one is there from everything before.
        let (mut low, mut high) = (0, self.intervals.partition_point(|p| p.from_s < until_s));
        while low < high {
            let middle = usize::midpoint(low, high);
            if self.has_way_out(middle) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        Some(self.intervals.get(low.checked_sub(1)?)?.from_s)
    }

    /// Whether a track touches nothing, as far as the intervals go.
    #[must_use]
    pub fn is_clear(&self, way: &Trajectory) -> bool {
        let met = |p: &&SeaInterval| p.from_s < way.end().time_s && p.until_s > way.start().time_s;
        self.intervals.iter().filter(met).all(|interval| {
            let part = way.until(interval.until_s).after(interval.from_s);
            let touches = |region: &Region| {
                let mut legs = part.points().windows(2);
                legs.any(|leg| region.clearance(&leg[0], &leg[1]).clearance_m < 0.0)
            };
            !interval.regions.iter().any(touches)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::ObstacleId;

    fn sea(intervals: u32, max_speed_mps: f64, water: Vector3<f64>, regions: &[Region]) -> Sea {
        let interval = |k: u32| SeaInterval {
            from_s: 10.0 * f64::from(k),
            until_s: 10.0 * f64::from(k + 1),
            place: Point3::new(0.0, 0.0, 100.0),
            regions: regions.to_vec(),
            water,
            water_differs_mps: 0.0,
            max_speed_mps,
        };
        Sea {
            intervals: (0..intervals).map(interval).collect(),
            bounds: Some(Bounds::new(
                Point3::new(-5e3, -5e3, 0.0),
                Point3::new(5e3, 5e3, 200.0),
            )),
        }
    }

    /// A closed wall of columns 60 m away.
    fn wall() -> Vec<Region> {
        (0..12)
            .map(|k| {
                let (sin, cos) =
                    auv_types::libm::sincos(std::f64::consts::FRAC_PI_6 * f64::from(k));
                Region {
                    obstacle: ObstacleId(k),
                    ..Region::cylinder(
                        Point3::new(100.0 * cos, 100.0 * sin, 100.0),
                        40.0,
                        -50.0,
                        250.0,
                    )
                }
            })
            .collect()
    }

    #[test]
    fn what_comes_through_the_wall_leaves_no_way_out_and_what_turns_back_does() {
        let still = Vector3::zeros();
        let mut regions = wall();
        let mut comes = Region::ball(Point3::new(-400.0, 0.0, 100.0), 250.0);
        comes.obstacle = ObstacleId(50);
        comes.velocity_mps = Vector3::x();
        regions.push(comes);
        // The nearest surface is 150 m away; the last of the pocket, 120 m further, is lost at some
        // 270 s at 1 m/s.
        let Verdict::NoEscape { by_s } = sea(60, 3.0, still, &regions).escape(0) else {
            panic!("a way out");
        };
        assert!((200.0..=290.0).contains(&by_s), "{by_s}");
        // At 200 s there still is room.
        let before = sea(20, 3.0, still, &regions);
        let Verdict::Escape(way) = before.escape(0) else {
            panic!("no way out");
        };
        assert!(before.is_clear(&way) && way.end().time_s >= 200.0);
        let fastest = way
            .segments()
            .map(|(a, b)| (b.position - a.position).norm() / (b.time_s - a.time_s));
        assert!(fastest.fold(0.0, f64::max) <= 3.0 + 1e-9);
        // A vehicle at rest is hit.
        let rest = Trajectory::hover(way.start(), 200.0);
        assert!(!before.is_clear(&rest));
    }

    #[test]
    fn an_open_wall_is_left_and_a_current_carries_into_a_closed_one() {
        let still = Vector3::zeros();
        let open = &wall()[..11];
        assert!(matches!(
            sea(90, 3.0, still, open).escape(0),
            Verdict::Escape(_)
        ));
        // Faster than the vehicle: 0.5 m/s towards the wall at least.
        let fast = Vector3::new(1.5, 0.0, 0.0);
        let Verdict::NoEscape { by_s } = sea(60, 1.0, fast, &wall()).escape(0) else {
            panic!("a way out");
        };
        assert!((120.0..=220.0).contains(&by_s), "{by_s}");
        assert!(matches!(
            sea(90, 3.0, fast, &wall()).escape(0),
            Verdict::Escape(_)
        ));
    }

    #[test]
    fn the_last_way_out_is_found_by_halving() {
        let mut sea = sea(25, 1.0, Vector3::zeros(), &[]);
        // The vehicle goes into a dead end whose mouth is closed at 200 s and which fills up.
        for (k, interval) in sea.intervals.iter_mut().enumerate() {
            interval.place.x = 5.0 * k as f64;
            let mut lid = Region::ball(Point3::new(100.0, 0.0, 100.0), 0.0);
            lid.at_s = 0.0;
            lid.from_s = 200.0;
            lid.radius_m = 150.0;
            interval.regions.push(lid);
        }
        let last_s = sea.last_escape_s(250.0).unwrap();
        // From x = 5 k the surface at -50 is 50 + 5 k metres away, and the time 200 - 10 k seconds.
        assert!((80.0..=105.0).contains(&last_s), "{last_s}");
    }
}
