//! The judge: compares the true track with the true sea, continuously rather than at samples.

use crate::limits::{Asked, Limit, LimitBroken, note};
use auv_obstacles::{ObstacleId, Region, RegionShape, TimedPoint};
use auv_ocean::SeaBed;
use auv_types::Point3;
use std::collections::BTreeSet;
use std::ops::Range;

/// Collisions, groundings and least distances of a flown track.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Number of collisions. An obstacle that is left and hit again counts twice.
    pub collisions: u32,
    /// Start of the first tick with a collision, mission time in seconds; `+inf` without collisions.
    pub first_collision_s: f64,
    /// Least distance to the surface of any obstacle, metres; negative inside; `+inf` without obstacles.
    pub min_clearance_m: f64,
    /// Mission time of the least distance, seconds.
    pub min_clearance_at_s: f64,
    /// Number of times the sea bed was touched.
    pub groundings: u32,
    /// Least altitude over the sea bed, metres; `+inf` without a bed.
    pub min_altitude_m: f64,
    /// The limits that were broken, each where it was broken most.
    pub limits_broken: Vec<LimitBroken>,
    /// Ships that came within [`Judgement::SHIP_NEAR_M`], measured horizontally.
    pub ships: BTreeSet<ObstacleId>,
    /// Least horizontal distance to a ship's hull, metres; `+inf` without ships.
    pub min_ship_distance_m: f64,
    in_contact: BTreeSet<ObstacleId>,
    aground: bool,
}

impl Default for Judgement {
    fn default() -> Self {
        Self {
            collisions: 0,
            first_collision_s: f64::INFINITY,
            min_clearance_m: f64::INFINITY,
            min_clearance_at_s: 0.0,
            groundings: 0,
            min_altitude_m: f64::INFINITY,
            limits_broken: Vec::new(),
            ships: BTreeSet::new(),
            min_ship_distance_m: f64::INFINITY,
            in_contact: BTreeSet::new(),
            aground: false,
        }
    }
}

impl Judgement {
    /// Horizontal distance within which a ship counts as near, metres.
    pub const SHIP_NEAR_M: f64 = 1000.0;

    /// Adds a part of the track and the truth over the same time. `ships` holds the ids of ships.
    pub(crate) fn judge(
        &mut self,
        track: &[TimedPoint],
        truth: &[Region],
        ships: &Range<u32>,
        bed: Option<&dyn SeaBed>,
        asked: &Asked,
    ) {
        let mut touched = BTreeSet::new();
        for region in truth {
            let mut nearest_m = f64::INFINITY;
            for pair in track.windows(2) {
                if lower_bound_m(region, pair) > self.min_clearance_m.max(0.0)
                    && !ships.contains(&region.obstacle.0)
                {
                    continue;
                }
                let closest = region.clearance(&pair[0], &pair[1]);
                nearest_m = nearest_m.min(closest.clearance_m);
                if closest.clearance_m < self.min_clearance_m {
                    (self.min_clearance_m, self.min_clearance_at_s) =
                        (closest.clearance_m, closest.time_s);
                }
                if ships.contains(&region.obstacle.0) {
                    self.note_ship(region, pair);
                }
            }
            if nearest_m < 0.0 {
                touched.insert(region.obstacle);
            }
        }
        if let (false, Some(start)) = (touched.is_empty(), track.first()) {
            self.first_collision_s = self.first_collision_s.min(start.time_s);
        }
        self.collisions += touched.difference(&self.in_contact).count() as u32;
        self.in_contact = touched;
        let too_near_m = asked.clearance_m - self.min_clearance_m;
        let broken = &mut self.limits_broken;
        note(
            broken,
            Limit::Clearance,
            self.min_clearance_at_s,
            too_near_m,
        );
        for point in track {
            let excess_m = asked.bounds.excess_m(&point.position) - asked.slack_m;
            note(broken, Limit::Box, point.time_s, excess_m);
        }
        if let Some(bed) = bed {
            for pair in track.windows(2) {
                let altitude_m = least_altitude_m(bed, &pair[0].position, &pair[1].position);
                self.min_altitude_m = self.min_altitude_m.min(altitude_m);
                let too_low_m = asked.altitude_m - altitude_m;
                note(broken, Limit::Altitude, pair[1].time_s, too_low_m);
                let aground = altitude_m <= 0.0;
                self.groundings += u32::from(aground && !self.aground);
                self.aground = aground;
            }
        }
    }

    fn note_ship(&mut self, ship: &Region, pair: &[TimedPoint]) {
        let column = Region {
            shape: RegionShape::Cylinder {
                top_m: f64::NEG_INFINITY,
                bottom_m: f64::INFINITY,
            },
            ..*ship
        };
        let abeam_m = column.clearance(&pair[0], &pair[1]).clearance_m;
        self.min_ship_distance_m = self.min_ship_distance_m.min(abeam_m);
        if abeam_m <= Self::SHIP_NEAR_M {
            self.ships.insert(ship.obstacle);
        }
    }
}

/// A lower bound of the distance between a timed segment and a region; cheap to compute.
fn lower_bound_m(region: &Region, pair: &[TimedPoint]) -> f64 {
    let [start_s, end_s] = [pair[0].time_s, pair[1].time_s];
    let reach_m = region.radius_at(start_s).max(region.radius_at(end_s));
    let length_m = (pair[1].position - pair[0].position).norm();
    let drift_m = region.velocity_mps.norm() * (end_s - start_s);
    let offset = pair[0].position - region.centre_at(start_s);
    let distance_m = if region.shape == RegionShape::Ball {
        offset.norm()
    } else {
        offset.xy().norm()
    };
    distance_m - length_m - drift_m - reach_m
}

/// Least altitude over a segment, within 5 cm: the segment is halved until the bound on the bed's slope
/// proves that no part lies lower.
fn least_altitude_m(bed: &dyn SeaBed, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    let altitude_m = |p: &Point3<f64>| bed.depth_at(p.x, p.y) - p.z;
    let mut least_m = altitude_m(from).min(altitude_m(to));
    let mut open = vec![(*from, *to, 0_u32)];
    while let Some((a, b, depth)) = open.pop() {
        let middle = auv_types::nalgebra::center(&a, &b);
        let half_m = 0.5 * (b - a).norm();
        let here_m = altitude_m(&middle);
        least_m = least_m.min(here_m);
        let slope = bed.max_slope_near(middle.x, middle.y, half_m) + 1.0;
        if here_m - slope * half_m < least_m - 0.05 && depth < 24 && half_m > 0.02 {
            open.push((a, middle, depth + 1));
            open.push((middle, b, depth + 1));
        }
    }
    least_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_ocean::FlatBed;
    use auv_types::Bounds;

    const ASKED: Asked = Asked {
        altitude_m: 5.0,
        bounds: Bounds::new(Point3::new(0.0, -9.0, 0.0), Point3::new(90.0, 9.0, 50.0)),
        slack_m: 2.0,
        clearance_m: 3.0,
    };

    fn at(x: f64, z: f64, t: f64) -> TimedPoint {
        TimedPoint::new(Point3::new(x, 0.0, z), t)
    }

    #[test]
    fn a_collision_between_two_samples_counts_once_while_it_lasts() {
        let rock = Region::ball(Point3::new(50.0, 0.0, 10.0), 1.0);
        let mut judgement = Judgement::default();
        judgement.judge(
            &[at(0.0, 10.0, 0.0), at(50.0, 10.0, 50.0)],
            &[rock],
            &(0..0),
            None,
            &ASKED,
        );
        judgement.judge(
            &[at(50.0, 10.0, 50.0), at(100.0, 10.0, 100.0)],
            &[rock],
            &(0..0),
            None,
            &ASKED,
        );
        assert_eq!((judgement.collisions, judgement.min_clearance_m), (1, -1.0));
        assert_eq!(judgement.first_collision_s, 0.0);
        let broken: Vec<String> = judgement
            .limits_broken
            .iter()
            .map(ToString::to_string)
            .collect();
        assert_eq!(
            broken,
            ["clearance by 4.00 m at 50 s", "box by 8.00 m at 100 s"]
        );
    }

    #[test]
    fn groundings_and_near_ships_are_counted() {
        let ship = Region {
            obstacle: ObstacleId(5),
            ..Region::cylinder(Point3::new(50.0, 300.0, 0.0), 40.0, -5.0, 6.0)
        };
        let mut judgement = Judgement::default();
        judgement.judge(
            &[at(0.0, 10.0, 0.0), at(100.0, 31.0, 50.0)],
            &[ship],
            &(5..6),
            Some(&FlatBed::new(30.0)),
            &ASKED,
        );
        assert_eq!((judgement.groundings, judgement.ships.len()), (1, 1));
        assert!((judgement.min_altitude_m + 1.0).abs() < 0.06);
        let [box_broken, altitude_broken] = judgement.limits_broken[..] else {
            panic!("{:?}", judgement.limits_broken);
        };
        assert_eq!((box_broken.limit, box_broken.by_m), (Limit::Box, 8.0));
        assert_eq!(altitude_broken.limit, Limit::Altitude);
        assert!((altitude_broken.by_m - 6.0).abs() < 0.06);
        assert!((judgement.min_ship_distance_m - 260.0).abs() < 1e-9);
    }
}
