//! What carries the vehicle off its trajectory: a current that was not forecast, a failing drive.

use auv_obstacles::{ObstacleId, Region};
use auv_planning::Trajectory;
use auv_types::{Point3, Vector3};
use std::collections::BTreeSet;
use std::sync::Arc;

/// A vehicle that kept to its trajectory for this long does not drift, seconds.
const STEADY_S: f64 = 10.0;
/// Two consecutive slips that differ by no more than this share show a drift.
const ALIKE: f64 = 0.5;
/// Cosine between slip and course above which the vehicle is merely early.
const AHEAD: f64 = 0.7;

/// How the vehicle leaves its trajectories, m/s over ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Drift {
    /// How it left the last one.
    slip: Option<Vector3<f64>>,
    /// How it is expected to leave the next one.
    believed: Vector3<f64>,
}

impl Drift {
    /// The drift after the vehicle was seen at a place, while a trajectory was in force.
    pub(crate) fn after(
        self,
        in_force: Option<&Trajectory>,
        off_track_m: f64,
        time_s: f64,
        place: &Point3<f64>,
    ) -> Self {
        let Some(in_force) = in_force else {
            return self;
        };
        let flown_s = time_s - in_force.start().time_s;
        let (there, course) = in_force.at(time_s);
        let off = place - there;
        if off.norm() > off_track_m && flown_s >= 1.0 {
            let slip = off / flown_s;
            let alike = |before: Vector3<f64>| (slip - before).norm() <= ALIKE * slip.norm();
            // A vehicle that is only early keeps to its trajectory.
            let early = slip.dot(&course) > AHEAD * slip.norm() * course.norm();
            let drifts = !early && self.slip.is_some_and(alike);
            Self {
                slip: Some(slip),
                believed: if drifts { slip } else { Vector3::zeros() },
            }
        } else if flown_s >= STEADY_S {
            Self::default()
        } else {
            self
        }
    }

    /// The predicted regions in the drifting frame: the believed drift is subtracted from their
    /// velocities, so that what is planned among them is right for a drifting vehicle. If any region
    /// of an obstacle is malformed, the obstacle's last valid regions are kept.
    pub(crate) fn in_drifting_frame(
        self,
        last: &[Region],
        told: &[Region],
        now_s: f64,
    ) -> Arc<[Region]> {
        let drift = self.believed;
        let malformed: BTreeSet<ObstacleId> = told
            .iter()
            .filter(|region| !region.is_sound())
            .map(|region| region.obstacle)
            .collect();
        let is_kept = |region: &&Region| malformed.contains(&region.obstacle);
        let kept = last.iter().filter(is_kept).copied();
        let fresh = told.iter().filter(|region| !is_kept(region)).copied();
        if drift == Vector3::zeros() {
            return kept.chain(fresh).collect();
        }
        let drifting = fresh.map(|region| {
            let drifting = Region {
                centre: region.centre + drift * (now_s - region.at_s),
                velocity_mps: region.velocity_mps - drift,
                ..region
            };
            if drifting.is_sound() {
                return drifting;
            }
            // Its time lies too far back: the same region, from now on.
            Region {
                centre: region.centre_at(now_s),
                radius_m: region.radius_at(now_s).max(0.0),
                at_s: now_s,
                ..drifting
            }
        });
        let drifting = drifting.filter(Region::is_sound);
        kept.chain(drifting).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::{Mission, Observation, SyncSettings, Synchroniser, driver::Stepped};
    use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    use auv_obstacles::Region;
    use auv_planning::motion::{distance_to_regions_m, least_clearance};
    use auv_planning::{
        Trajectory, Vehicle,
        baseline::{GreedyRoute, StraightPath},
    };
    use auv_types::{Bounds, Point3, Seed, Vector3};
    use std::sync::Arc;

    /// Under way north at 3 m/s from the origin at 20 m depth, in a box down to 100 m.
    fn under_way() -> Synchroniser {
        let waypoints = [0.0, 3_000.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
        let edges = [Edge::undirected(0, 1, Task::TRANSIT)];
        let network = Arc::new(Network::new(&waypoints, &edges, 3.0).unwrap());
        let mut mission = Mission::new(network, NodeId(0), NodeId(1), 5_000.0, Vehicle::paper());
        mission.clearance_m = 5.0;
        mission.bounds = Some(Bounds::new(
            Point3::new(-5_000.0, -5_000.0, 0.0),
            Point3::new(5_000.0, 5_000.0, 100.0),
        ));
        let settings = SyncSettings::default();
        let mut synchroniser = Synchroniser::new(Arc::new(mission), settings, Seed(0)).unwrap();
        tick(&mut synchroniser, 0.0, Point3::new(0.0, 0.0, 20.0), &[]);
        synchroniser
    }

    fn tick(
        synchroniser: &mut Synchroniser,
        time_s: f64,
        position: Point3<f64>,
        regions: &[Region],
    ) -> Option<Arc<Trajectory>> {
        let observation = Observation {
            position_sigma_m: 0.0,
            time_s,
            position,
            velocity: Vector3::zeros(),
            regions: regions.into(),
        };
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        driver.tick(synchroniser, observation).follow
    }

    #[test]
    fn a_drift_seen_twice_is_subtracted_from_the_velocities_of_regions() {
        let mut synchroniser = under_way();
        let ball = Region {
            velocity_mps: Vector3::new(0.5, 0.0, 0.0),
            at_s: 3.0,
            ..Region::ball(Point3::new(-300.0, 0.0, 20.0), 50.0)
        };
        let against = Vector3::new(-3.6, 1.0, 0.0);
        let mut place = Point3::new(0.0, 0.0, 20.0);
        for time_s in [10.0, 20.0] {
            let wanted = synchroniser.trajectory().unwrap().at(time_s).0;
            place = wanted + against * 10.0;
            tick(&mut synchroniser, time_s, place, &[ball]);
            let met = synchroniser.view().beliefs().regions[0];
            let carried = if time_s > 10.0 {
                against
            } else {
                Vector3::zeros()
            };
            assert!((met.velocity_mps - (ball.velocity_mps - carried)).norm() < 1e-9);
            assert!((met.centre_at(time_s) - ball.centre_at(time_s)).norm() < 1e-9);
        }
        // It keeps to its trajectory again.
        let kept = synchroniser.trajectory().unwrap().at(35.0).0;
        assert!((kept - place).norm() > 1.0);
        tick(&mut synchroniser, 35.0, kept, &[ball]);
        assert_eq!(*synchroniser.view().beliefs().regions, [ball]);
    }

    #[test]
    fn a_vehicle_that_lags_behind_its_evasion_evades_again() {
        let mut synchroniser = under_way();
        // It comes from ahead faster than the vehicle makes its way, and covers the straight path.
        let comes = Region {
            velocity_mps: Vector3::new(-1.0, 0.0, 0.0),
            ..Region::ball(Point3::new(150.0, 0.0, 20.0), 100.0)
        };
        let here = Point3::new(0.0, 0.0, 20.0);
        let evasion = tick(&mut synchroniser, 10.0, here, &[comes]).unwrap();
        let away = evasion.end();
        assert!(distance_to_regions_m(&away, &[comes], 1e9) >= 5.0);
        assert!((away.position - here).norm() > 20.0);
        // The vehicle has not moved and would be hit, although the evasion in force is clear.
        let again = tick(&mut synchroniser, 30.0, here, &[comes]).unwrap();
        assert!((again.start().position - here).norm() < 1e-9);
        let nearest = least_clearance(&again, &[comes], (30.0, 150.0), 1e9);
        assert!(
            nearest.clearance_m >= 5.0,
            "{nearest:?} {again:?} {evasion:?}"
        );
    }

    #[test]
    fn a_vehicle_carried_out_of_its_box_comes_back() {
        let mut synchroniser = under_way();
        let below = Point3::new(30.0, 0.0, 130.0);
        let back = tick(&mut synchroniser, 60.0, below, &[]).unwrap();
        assert_eq!(back.start().position, below);
        assert_eq!(back.end().position, Point3::new(3_000.0, 0.0, 20.0));
    }
}
