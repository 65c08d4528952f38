//! Waypoints placed over a bed as an operator does: where the water is deep enough, often as deep as the
//! rules allow, often close to a steep slope.

use crate::dice::Dice;
use crate::sea::Sea;
use auv_ocean::{AnalyticBed, SeaBed};
use auv_planning::Vehicle;
use auv_types::libm;

/// What bounds the depth of a waypoint.
pub(crate) struct Rules<'a> {
    pub(crate) bed: &'a AnalyticBed,
    /// Least altitude and standard deviations above it.
    pub(crate) altitude: [f64; 2],
    /// Least depth of the box, metres.
    pub(crate) top_m: f64,
    pub(crate) vehicle: Vehicle,
    /// Half side of the square in which waypoints lie, metres.
    pub(crate) half_m: f64,
}

/// A waypoint with its task.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Place {
    pub(crate) at: [f64; 3],
    /// Whether it lies at the lowest legal depth.
    pub(crate) at_limit: bool,
    /// The steepest slope within two turn radii, degrees.
    pub(crate) slope_deg: f64,
    /// Duration of its task, seconds; `None` without a task.
    pub(crate) task_s: Option<f64>,
}

/// Least distance between two waypoints, metres.
const APART_M: f64 = 200.0;
/// Least water of the sea between waypoints, below the top of the box, metres.
const PASSAGE_M: f64 = 6.0;
/// Attempts to place one waypoint.
const ATTEMPTS: usize = 3_000;

impl Rules<'_> {
    /// The lowest legal depth, in whole centimetres.
    fn lowest_m(&self, [n, e]: [f64; 2]) -> f64 {
        let [least_m, sigmas] = self.altitude;
        let margin_m = least_m + sigmas * self.bed.depth_sigma_m(n, e);
        ((self.bed.depth_at(n, e) - margin_m) * 100.0 - 1e-6).floor() / 100.0
    }

    /// The steepest slope within two turn radii, degrees.
    fn slope_deg(&self, [n, e]: [f64; 2]) -> f64 {
        let slope = |n: f64, e: f64| {
            let depth_m = |n: f64, e: f64| self.bed.depth_at(n, e);
            let north = depth_m(n + 0.5, e) - depth_m(n - 0.5, e);
            let east = depth_m(n, e + 0.5) - depth_m(n, e - 0.5);
            libm::sqrt(north * north + east * east)
        };
        let ring = self.ring([n, e], 2.0 * self.vehicle.turn_radius_m);
        let steepest = ring.fold(slope(n, e), |most, [n, e]| most.max(slope(n, e)));
        libm::atan(steepest) * 180.0 / std::f64::consts::PI
    }

    /// Points of three rings up to a radius.
    fn ring(&self, [n, e]: [f64; 2], radius_m: f64) -> impl Iterator<Item = [f64; 2]> {
        (0..36).map(move |k| {
            let angle = std::f64::consts::TAU * f64::from(k % 12) / 12.0;
            let radius_m = radius_m * f64::from(k / 12 + 1) / 3.0;
            [
                n + radius_m * libm::cos(angle),
                e + radius_m * libm::sin(angle),
            ]
        })
    }

    /// Whether a circle about a waypoint stays in legal water at its depth.
    fn circle_fits(&self, [n, e, depth_m]: [f64; 3]) -> bool {
        let mut ring = self.ring([n, e], 2.2 * self.vehicle.turn_radius_m);
        ring.all(|place| depth_m <= self.lowest_m(place))
    }

    /// A depth for a waypoint: at the limit, a few metres above it, or in mid-water.
    fn depth_m(&self, limit_m: f64, steep: bool, dice: &mut Dice) -> f64 {
        let kind = dice.between(0.0, 1.0);
        let at_limit = if steep {
            0.6
        } else {
            dice.by_hardness(0.25, 0.7)
        };
        let depth_m = if kind < at_limit {
            limit_m
        } else if kind < at_limit + 0.2 {
            limit_m - dice.hundredth(0.0, 6.0)
        } else {
            dice.hundredth((limit_m - 60.0).max(self.top_m), limit_m)
        };
        depth_m.max(self.top_m)
    }

    /// One more waypoint clear of the others; near a steep slope if `steep`.
    fn place(&self, others: &[Place], sea: &Sea, steep: bool, dice: &mut Dice) -> Option<Place> {
        for _ in 0..ATTEMPTS {
            let at = dice.place(self.half_m);
            let apart = |other: &Place| {
                let (n, e) = (other.at[0] - at[0], other.at[1] - at[1]);
                n * n + e * e >= APART_M * APART_M
            };
            let limit_m = self.lowest_m(at);
            if limit_m < self.top_m + 1.0 || !sea.joins(at) || !others.iter().all(apart) {
                continue;
            }
            let slope_deg = self.slope_deg(at);
            if steep && slope_deg < 20.0 {
                continue;
            }
            let depth_m = self.depth_m(limit_m, steep, dice);
            return Some(Place {
                at: [at[0], at[1], depth_m],
                at_limit: depth_m >= limit_m,
                slope_deg,
                task_s: None,
            });
        }
        None
    }

    /// All waypoints in the order of a short tour, start first and destination last; `None` where the bed
    /// has no room for them.
    pub(crate) fn places(&self, dice: &mut Dice) -> Option<Vec<Place>> {
        let count = dice.count(5, 9);
        let steep = if dice.chance(dice.by_hardness(0.4, 0.8)) {
            dice.count(1, dice.by_hardness(2, 4))
        } else {
            0
        };
        let passage_m = self.top_m + PASSAGE_M;
        let deep = |place| self.lowest_m(place) >= passage_m;
        let sea = Sea::flooded(self.half_m, deep);
        let mut places: Vec<Place> = Vec::new();
        for k in 0..count {
            match self.place(&places, &sea, k < steep, dice) {
                Some(place) => places.push(place),
                None if places.len() >= 5 => break,
                None => return None,
            }
        }
        let mut places = tour(places, dice);
        let last = places.len() - 1;
        for place in &mut places[1..last] {
            place.task_s = self.task_s(place, dice);
        }
        Some(places)
    }

    /// The duration of a waypoint's task. A stay is asked for where its circle fits, seldom elsewhere.
    fn task_s(&self, place: &Place, dice: &mut Dice) -> Option<f64> {
        if dice.chance(0.2) {
            return None;
        }
        let room = self.circle_fits(place.at) || dice.chance(0.08);
        let stay_s = dice.whole(20.0, 120.0);
        Some(if room && dice.chance(0.5) {
            stay_s
        } else {
            0.0
        })
    }
}

/// The places in the order in which each is the nearest to the one before.
fn tour(mut places: Vec<Place>, dice: &mut Dice) -> Vec<Place> {
    let first = dice.count(0, places.len() - 1);
    let mut tour = vec![places.swap_remove(first)];
    while !places.is_empty() {
        let here = tour[tour.len() - 1].at;
        let square = |place: &Place| {
            let (n, e) = (place.at[0] - here[0], place.at[1] - here[1]);
            n * n + e * e
        };
        let nearest = (0..places.len())
            .min_by(|&a, &b| square(&places[a]).total_cmp(&square(&places[b])))
            .unwrap_or(0);
        tour.push(places.swap_remove(nearest));
    }
    tour
}
