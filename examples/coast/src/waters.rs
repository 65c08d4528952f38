//! Random tides and obstacles.

use crate::dice::{Dice, hundredth};
use crate::waypoints::Place;
use auv_ocean::{AnalyticBed, AnalyticCurrent, SeaBed, TidalConstituent};

/// What moves in the sea. The default is an empty, still sea.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Waters {
    /// The forecast current; `None`: still water.
    pub(crate) current: Option<AnalyticCurrent>,
    /// Range of the true current's gain, and of its delay in seconds.
    pub(crate) truth: [[f64; 2]; 2],
    pub(crate) movers: Vec<Mover>,
    /// Charted rocks: place and radius.
    pub(crate) rocks: Vec<([f64; 3], f64)>,
    /// Number of pots: lines from the surface to the bed, of uncertain width.
    pub(crate) pots: usize,
}

/// A moving or drifting obstacle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Mover {
    pub(crate) drifts: bool,
    pub(crate) at: [f64; 3],
    pub(crate) radius_m: f64,
    pub(crate) velocity_mps: [f64; 3],
}

/// Least distance of an obstacle's surface from any waypoint, metres.
const ROOM_M: f64 = 80.0;

impl Waters {
    /// Whether the sea is empty and still.
    pub(crate) fn is_empty(&self) -> bool {
        self.current.is_none() && self.movers.is_empty() && self.rocks.is_empty() && self.pots == 0
    }

    pub(crate) fn draw(bed: &AnalyticBed, places: &[Place], half_m: f64, dice: &mut Dice) -> Self {
        let mut waters = Self::default();
        if dice.chance(dice.by_hardness(0.5, 0.3)) {
            return waters;
        }
        if dice.chance(0.8) {
            waters.current = Some(tide(dice));
            waters.truth = [[0.9, 1.1], [-300.0, 300.0]];
        }
        let somewhere = |radius_m: f64, dice: &mut Dice| {
            for _ in 0..200 {
                let at = dice.place(half_m);
                let room = |place: &Place| {
                    let (n, e) = (place.at[0] - at[0], place.at[1] - at[1]);
                    let reach_m = radius_m + ROOM_M;
                    n * n + e * e > reach_m * reach_m
                };
                let depth_m = bed.depth_at(at[0], at[1]);
                if depth_m > 5.0 && places.iter().all(room) {
                    return Some([at[0], at[1], dice.hundredth(1.0, depth_m)]);
                }
            }
            None
        };
        for _ in 0..dice.count(0, dice.by_hardness(3, 6)) {
            let radius_m = dice.whole(4.0, 15.0);
            let drifts = dice.chance(0.4);
            let [n, e] = dice.direction();
            let speed_mps = dice.between(0.0, if drifts { 0.1 } else { 0.7 });
            waters
                .movers
                .extend(somewhere(radius_m, dice).map(|at| Mover {
                    drifts,
                    at,
                    radius_m,
                    velocity_mps: [hundredth(n * speed_mps), hundredth(e * speed_mps), 0.0],
                }));
        }
        for _ in 0..dice.count(0, 2) {
            let radius_m = dice.whole(8.0, 35.0);
            let rock = somewhere(radius_m, dice).map(|at| (at, radius_m));
            waters.rocks.extend(rock);
        }
        if dice.chance(0.6) {
            waters.pots = dice.count(1, dice.by_hardness(8, 15));
        }
        waters
    }
}

fn tide(dice: &mut Dice) -> AnalyticCurrent {
    let [n, e] = dice.direction();
    let strongest_mps = dice.between(0.05, dice.by_hardness(0.4, 0.8));
    let mean_mps = dice.between(-0.1, 0.1);
    AnalyticCurrent {
        mean_mps: [hundredth(n * mean_mps), hundredth(e * mean_mps)],
        tide: vec![TidalConstituent {
            major_mps: [hundredth(n * strongest_mps), hundredth(e * strongest_mps)],
            minor_mps: [0.0, 0.0],
            period_s: 44_714.0,
            strongest_s: dice.whole(0.0, 44_714.0),
        }],
        ..AnalyticCurrent::default()
    }
}
