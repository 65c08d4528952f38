//! The oracle: whether a vehicle with perfect knowledge could have avoided a collision.
//!
//! A [`Sea`] is the recorded truth over a period of a simulation. [`Sea::escape`] searches for both
//! answers on a grid of cells around the vehicle:
//!
//! - *No escape.* The set of cells the vehicle can possibly be in is propagated; every approximation
//!   favours the vehicle. A cell is closed only while a single obstacle covers all of it. Within an interval
//!   the vehicle passes any number of cells that are not closed, but never gets farther from its start
//!   than its speed through the water allows. Limits on turns, pitch and least speed and the sea bed are
//!   ignored. If no cell remains, no manoeuvre could have kept the vehicle clear.
//! - *Escape.* A track through cells that are clear for a whole interval, at the vehicle's speed. The track
//!   is checked against the truth exactly. It assumes a vehicle that can stop and turn on the spot.
//!
//! ```
//! use auv_obstacles::Region;
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

pub(crate) mod flyable;
mod grid;
mod interval;

use auv_obstacles::Region;
use auv_planning::Trajectory;
use auv_types::Bounds;
use grid::Grid;

pub use interval::SeaInterval;

/// Cell sizes in the order in which they are tried, metres. The grid reaches 800 m around the vehicle with
/// the largest cells and 200 m with the smallest.
const CELLS_M: [f64; 3] = [10.0, 5.0, 2.5];

/// The true sea over a period.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sea {
    /// Consecutive intervals without gaps, the earliest first.
    pub intervals: Vec<SeaInterval>,
    /// The box the vehicle must stay in.
    pub bounds: Option<Bounds>,
}

/// The oracle's answer.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Proven: by this time every possible manoeuvre has led into an obstacle.
    NoEscape {
        /// Mission time, seconds.
        by_s: f64,
    },
    /// A track that stays clear until the end of the period or until it leaves the grid.
    Escape(Trajectory),
    /// Neither answer is found on the finest grid.
    Unknown,
}

impl Sea {
    /// Whether the vehicle could escape from the start of an interval on. [`Verdict::Unknown`] if the
    /// interval does not exist.
    ///
    /// # Determinism
    /// The result depends on the arguments only.
    #[must_use]
    pub fn escape(&self, interval: usize) -> Verdict {
        for cell_m in CELLS_M {
            let Some(grid) = self.grid(interval, cell_m) else {
                break;
            };
            if let Some(track) = grid.escape_track().filter(|track| self.is_clear(track)) {
                return Verdict::Escape(track);
            }
            if let Some(by_s) = grid.no_escape_by_s() {
                return Verdict::NoEscape { by_s };
            }
        }
        Verdict::Unknown
    }

    fn grid(&self, interval: usize, cell_m: f64) -> Option<Grid<'_>> {
        Grid::new(self.intervals.get(interval..)?, self.bounds, cell_m)
    }

    /// Whether an escape is found with the largest cells.
    fn has_escape(&self, interval: usize) -> bool {
        let track = self
            .grid(interval, CELLS_M[0])
            .and_then(|grid| grid.escape_track());
        track.is_some_and(|track| self.is_clear(&track))
    }

    /// The latest start of an interval before `until_s` from which an escape is found with the largest
    /// cells, mission time in seconds. The vehicle is on its own track until then.
    #[must_use]
    pub fn last_escape_s(&self, until_s: f64) -> Option<f64> {
        // If an escape exists from an interval, it exists from every earlier one.
        let (mut low, mut high) = (0, self.intervals.partition_point(|p| p.from_s < until_s));
        while low < high {
            let middle = usize::midpoint(low, high);
            if self.has_escape(middle) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        Some(self.intervals.get(low.checked_sub(1)?)?.from_s)
    }

    /// Whether a track touches no obstacle within the recorded period.
    #[must_use]
    pub fn is_clear(&self, track: &Trajectory) -> bool {
        let met =
            |p: &&SeaInterval| p.from_s < track.end().time_s && p.until_s > track.start().time_s;
        self.intervals.iter().filter(met).all(|interval| {
            let part = track.until(interval.until_s).after(interval.from_s);
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
    use auv_types::{Point3, Vector3};

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
    fn a_ball_that_fills_a_closed_wall_leaves_no_escape() {
        let still = Vector3::zeros();
        let mut regions = wall();
        let mut comes = Region::ball(Point3::new(-400.0, 0.0, 100.0), 250.0);
        comes.obstacle = ObstacleId(50);
        comes.velocity_mps = Vector3::x();
        regions.push(comes);
        // The ball's surface is 150 m away and moves at 1 m/s; the far end of the pocket, 120 m further, is
        // covered after about 270 s.
        let Verdict::NoEscape { by_s } = sea(60, 3.0, still, &regions).escape(0) else {
            panic!("an escape");
        };
        assert!((200.0..=290.0).contains(&by_s), "{by_s}");
        // After 200 s there is still room.
        let before = sea(20, 3.0, still, &regions);
        let Verdict::Escape(track) = before.escape(0) else {
            panic!("no escape");
        };
        assert!(before.is_clear(&track) && track.end().time_s >= 200.0);
        let fastest = track
            .segments()
            .map(|(a, b)| (b.position - a.position).norm() / (b.time_s - a.time_s));
        assert!(fastest.fold(0.0, f64::max) <= 3.0 + 1e-9);
        // The ball hits a vehicle at rest.
        let rest = Trajectory::hover(track.start(), 200.0);
        assert!(!before.is_clear(&rest));
    }

    #[test]
    fn a_gap_in_the_wall_is_an_escape_and_a_strong_current_into_a_closed_wall_is_none() {
        let still = Vector3::zeros();
        let open = &wall()[..11];
        assert!(matches!(
            sea(90, 3.0, still, open).escape(0),
            Verdict::Escape(_)
        ));
        // The current is faster than the vehicle: at least 0.5 m/s towards the wall.
        let fast = Vector3::new(1.5, 0.0, 0.0);
        let Verdict::NoEscape { by_s } = sea(60, 1.0, fast, &wall()).escape(0) else {
            panic!("an escape");
        };
        assert!((120.0..=220.0).contains(&by_s), "{by_s}");
        assert!(matches!(
            sea(90, 3.0, fast, &wall()).escape(0),
            Verdict::Escape(_)
        ));
    }

    #[test]
    fn the_last_escape_is_found_by_bisection() {
        let mut sea = sea(25, 1.0, Vector3::zeros(), &[]);
        // The vehicle moves into an area that a ball covers from 200 s on.
        for (k, interval) in sea.intervals.iter_mut().enumerate() {
            interval.place.x = 5.0 * k as f64;
            let mut lid = Region::ball(Point3::new(100.0, 0.0, 100.0), 0.0);
            lid.at_s = 0.0;
            lid.from_s = 200.0;
            lid.radius_m = 150.0;
            interval.regions.push(lid);
        }
        let last_s = sea.last_escape_s(250.0).unwrap();
        // From x = 5 k the edge at -50 is 50 + 5 k metres away, and 200 - 10 k seconds are left.
        assert!((80.0..=105.0).contains(&last_s), "{last_s}");
    }
}
