//! From an observation to beliefs: implausible values are replaced or refused.

use crate::beliefs::{Altimeter, Beliefs};
use crate::view::View;
use crate::{AbortReason, Observation};
use auv_types::{Point3, Vector3};

/// A clock that runs backwards by no more than this counts as standing still, seconds.
const CLOCK_SLACK_S: f64 = 1.0;
/// The greatest mission time, seconds. A clock that counts from another epoch is refused at launch.
const LATEST_S: f64 = 1e9;
/// The farthest place from the origin, metres, and the greatest velocity, m/s.
const FARTHEST_M: f64 = 1e7;
const FASTEST_MPS: f64 = 1e3;
/// How far a fix may lie beyond what the vehicle can have travelled since the last one, metres, and standard
/// deviations of the error that it puts right.
const FIX_SLACK_M: f64 = 60.0;
const FIX_SIGMAS: f64 = 4.0;
/// A vehicle no deeper than this has its antenna above the surface, metres.
pub(crate) const ANTENNA_M: f64 = 0.5;
/// How far above the surface, below the box, or below the charted bed and three standard deviations of it
/// a fix may lie, metres. Another is not this vehicle's, however long it is told.
const DEPTH_SLACK_M: f64 = 60.0;
const BELOW_SIGMAS: f64 = 3.0;
/// No sea is deeper, metres.
const DEEPEST_M: f64 = 11_100.0;
/// The strongest current that may have carried the vehicle meanwhile, m/s.
const CURRENT_MPS: f64 = 3.0;

/// The beliefs after an observation.
///
/// # Errors
/// The clock or the position is lost for longer than the settings allow.
pub(crate) fn beliefs_after(view: View<'_>, told: &Observation) -> Result<Beliefs, AbortReason> {
    let before = view.beliefs();
    let (now_s, stalls) = believed_time(view, told.time_s)?;
    let (position, velocity, fixed_s) = believed_place(view, told, now_s)?;
    let altimeter = match before.altimeter {
        Altimeter::Fresh(_) => Altimeter::At(now_s),
        dated => dated,
    };
    let off_track_m = view.settings.margins.off_track_m;
    let drift = before
        .drift
        .after(view.in_force(), off_track_m, now_s, &position);
    let (under_s, fix_s) = last_fix_s(view, now_s, position.z);
    Ok(Beliefs {
        now_s,
        under_s,
        fix_s,
        stalls,
        fixed_s,
        position,
        sigma_m: believed_sigma_m(view, told.position_sigma_m),
        velocity,
        altimeter,
        drift,
        regions: drift.in_drifting_frame(&before.regions, &told.regions, now_s),
    })
}

/// The mission time of an observation, and how often the clock has stood still. Time never runs
/// backwards: a small step back counts as standing still, and a clock that stands still for long is
/// broken.
fn believed_time(view: View<'_>, told_s: f64) -> Result<(f64, u32), AbortReason> {
    if told_s.is_nan() || told_s.abs() > LATEST_S {
        return Err(AbortReason::BadClock);
    }
    let before = view.beliefs();
    if view.is_ready() || told_s > before.now_s {
        return Ok((told_s, 0));
    }
    let stalls = before.stalls.saturating_add(1);
    if told_s < before.now_s - CLOCK_SLACK_S || stalls > view.settings.watchdogs.clock_stalls {
        return Err(AbortReason::BadClock);
    }
    Ok((before.now_s, stalls))
}

/// Place and velocity at a time, and the time of the last believed fix: as observed, or by dead
/// reckoning while the fix is missing or implausible. After `position_silence_s` an implausible fix is
/// believed, and a missing one ends the mission.
fn believed_place(
    view: View<'_>,
    told: &Observation,
    time_s: f64,
) -> Result<(Point3<f64>, Vector3<f64>, f64), AbortReason> {
    let fixed_s = view.beliefs().fixed_s;
    let lost = !is_possible(view, &told.position);
    let silent_s = time_s - fixed_s;
    let too_long = view.is_ready() || silent_s > view.settings.watchdogs.position_silence_s;
    if lost && too_long {
        return Err(AbortReason::BadPosition);
    }
    let reckoned = reckoned(view, time_s);
    let velocity = if told.velocity.iter().all(|x| x.abs() <= FASTEST_MPS) {
        told.velocity
    } else {
        reckoned.1
    };
    if !lost && (too_long || is_plausible(view, told.position, silent_s)) {
        return Ok((told.position, velocity, time_s));
    }
    Ok((reckoned.0, reckoned.1, fixed_s))
}

/// When the vehicle was below the surface last, and when it last had been at the surface for as long as a fix
/// takes. It has a fix before the launch.
fn last_fix_s(view: View<'_>, now_s: f64, depth_m: f64) -> (f64, f64) {
    let before = view.beliefs();
    if view.is_ready() {
        return (now_s, now_s);
    }
    if depth_m > ANTENNA_M {
        return (now_s, before.fix_s);
    }
    let complete = now_s - before.under_s >= view.mission.at_surface_s();
    (before.under_s, if complete { now_s } else { before.fix_s })
}

/// The standard deviation as told; one that is NaN or negative counts as the last one.
fn believed_sigma_m(view: View<'_>, told_m: f64) -> f64 {
    if told_m >= 0.0 {
        told_m.min(FARTHEST_M)
    } else {
        view.beliefs().sigma_m
    }
}

/// Whether a vehicle can be at a place at all: within the farthest distance, and neither far above the
/// surface nor far below the box or the charted bed.
fn is_possible(view: View<'_>, place: &Point3<f64>) -> bool {
    if !place.iter().all(|x| x.abs() <= FARTHEST_M) {
        return false;
    }
    let mission = view.mission;
    let box_m = mission.bounds.map_or(DEEPEST_M, |bounds| bounds.high.z);
    // Beyond the chart there is no depth to compare with.
    let bed_m = mission.sea_bed.as_deref().map(|bed| {
        let (depth_m, sigma_m) = (
            bed.depth_at(place.x, place.y),
            bed.depth_sigma_m(place.x, place.y),
        );
        depth_m + BELOW_SIGMAS * sigma_m
    });
    let bed_m = bed_m.filter(|depth_m| *depth_m > 0.0).unwrap_or(DEEPEST_M);
    (-DEPTH_SLACK_M..=box_m.min(bed_m) + DEPTH_SLACK_M).contains(&place.z)
}

fn is_plausible(view: View<'_>, place: Point3<f64>, silent_s: f64) -> bool {
    let speed_mps = view.mission.vehicle.max_speed_mps + CURRENT_MPS;
    let slack_m = FIX_SLACK_M + FIX_SIGMAS * view.beliefs().sigma_m;
    (place - view.beliefs().position).norm() <= slack_m + speed_mps * silent_s
}

/// Dead reckoning: along the trajectory in force if the vehicle was on it, else straight on.
fn reckoned(view: View<'_>, time_s: f64) -> (Point3<f64>, Vector3<f64>) {
    let before = view.beliefs();
    match view.in_force().filter(|_| view.is_on_track()) {
        Some(in_force) => in_force.at(time_s),
        None => {
            let gone_s = time_s - before.now_s;
            (before.position + before.velocity * gone_s, before.velocity)
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        AbortReason, Contingency, Event, Mission, Observation, Outcome, RouteReason, SyncSettings,
        Synchroniser, WithoutSonar, driver::Stepped,
    };
    use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    use auv_obstacles::Region;
    use auv_planning::{
        Vehicle,
        baseline::{GreedyRoute, StraightPath},
    };
    use auv_types::{Point3, Seed, Vector3};
    use std::sync::Arc;

    fn under_way() -> Synchroniser {
        launched(0.0, place(0.0))
    }

    /// After its first tick, at a time and a place.
    fn launched(time_s: f64, place: Point3<f64>) -> Synchroniser {
        let waypoints = [0.0, 900.0, 1800.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
        let task = Task {
            priority: 6.0,
            risk: 2.0,
            completion_time_s: 60.0,
        };
        let edges = [
            Edge::undirected(0, 1, task),
            Edge::undirected(1, 2, task),
            Edge::undirected(0, 2, Task::TRANSIT),
        ];
        let network = Arc::new(Network::new(&waypoints, &edges, 3.0).unwrap());
        let mission = Mission::new(network, NodeId(0), NodeId(2), 2_000.0, Vehicle::paper());
        let mut synchroniser =
            Synchroniser::new(Arc::new(mission), SyncSettings::default(), Seed(0)).unwrap();
        tick(&mut synchroniser, time_s, place);
        synchroniser
    }

    fn tick(synchroniser: &mut Synchroniser, time_s: f64, position: Point3<f64>) {
        let observation = Observation {
            position_sigma_m: 0.0,
            time_s,
            position,
            velocity: Vector3::new(3.0, 0.0, 0.0),
            regions: [].into(),
        };
        Stepped::new(&GreedyRoute, &StraightPath).tick(synchroniser, observation);
    }

    fn place(x: f64) -> Point3<f64> {
        Point3::new(x, 0.0, 20.0)
    }

    #[test]
    fn the_first_tick_says_when_and_where_the_mission_starts() {
        let early = launched(-100.0, place(700.0));
        assert_eq!(early.outcome(), None);
        let here = (early.view().now_s(), early.view().beliefs().position);
        assert_eq!(here, (-100.0, place(700.0)));
        let ended = Outcome::Aborted(AbortReason::BadPosition);
        let nowhere = launched(0.0, place(f64::NAN));
        assert_eq!(nowhere.outcome(), Some(ended));
    }

    #[test]
    fn a_lost_fix_is_reckoned_for_a_while_and_then_ends_the_mission() {
        let mut synchroniser = under_way();
        tick(&mut synchroniser, 10.0, place(f64::NAN));
        assert_eq!(synchroniser.view().beliefs().position, place(30.0));
        tick(&mut synchroniser, 20.0, place(60.0));
        tick(&mut synchroniser, 50.0, place(f64::NAN));
        assert_eq!(synchroniser.outcome(), None);
        tick(&mut synchroniser, 51.0, place(f64::NAN));
        assert_eq!(
            synchroniser.outcome(),
            Some(Outcome::Aborted(AbortReason::BadPosition))
        );
    }

    #[test]
    fn a_fix_below_box_or_bed_is_never_believed() {
        let mut flat = under_way();
        let mut mission = (**flat.mission()).clone();
        mission.sea_bed = Some(Arc::new(auv_ocean::FlatBed::new(80.0)));
        flat = flat.with_mission(mission.clone());
        mission.sea_bed = None;
        mission.bounds = Some(auv_types::Bounds::new(
            Point3::new(-1e3, -1e3, 0.0),
            Point3::new(3e3, 1e3, 80.0),
        ));
        let boxed = under_way().with_mission(mission);
        // Pascals, millibars and feet instead of metres; open water has the depth of the oceans.
        for (told, wrong_m) in [
            (&flat, 2e5),
            (&boxed, 2e3),
            (&flat, 150.0),
            (&under_way(), 2e5),
            (&flat, -70.0),
        ] {
            let mut synchroniser = told.clone();
            for k in 1..=40 {
                let time_s = f64::from(k);
                tick(
                    &mut synchroniser,
                    time_s,
                    Point3::new(3.0 * time_s, 0.0, wrong_m),
                );
                assert_eq!(synchroniser.view().beliefs().position.z, 20.0);
            }
            let ended = Outcome::Aborted(AbortReason::BadPosition);
            assert_eq!(synchroniser.outcome(), Some(ended), "{wrong_m} m");
        }
    }

    #[test]
    fn an_implausible_fix_is_believed_only_when_it_persists() {
        let mut synchroniser = under_way();
        for time_s in [10.0, 20.0, 30.0] {
            tick(&mut synchroniser, time_s, place(700.0));
            assert_eq!(synchroniser.view().beliefs().position, place(3.0 * time_s));
        }
        tick(&mut synchroniser, 31.0, place(703.0));
        assert_eq!(synchroniser.view().beliefs().position, place(703.0));
    }

    #[test]
    fn a_clock_may_slip_back_a_little_but_neither_jump_nor_stop() {
        let ended = Some(Outcome::Aborted(AbortReason::BadClock));
        let mut synchroniser = under_way();
        tick(&mut synchroniser, 10.0, place(30.0));
        tick(&mut synchroniser, 10.0 - 1e-6, place(30.0));
        assert_eq!(
            (synchroniser.outcome(), synchroniser.view().now_s()),
            (None, 10.0)
        );
        tick(&mut synchroniser.clone(), 20.0, place(60.0));
        let mut stopped = synchroniser.clone();
        for _ in 0..=SyncSettings::default().watchdogs.clock_stalls {
            tick(&mut stopped, 10.0, place(30.0));
        }
        assert_eq!(stopped.outcome(), ended);
        tick(&mut synchroniser, 5.0, place(30.0));
        assert_eq!(synchroniser.outcome(), ended);
    }

    #[test]
    fn a_near_bed_or_a_lost_altitude_ends_the_mission_at_the_surface() {
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        let mut mission = (**under_way().mission()).clone();
        mission.min_altitude_m = 4.0;
        for (told_m, later_s, reason) in [
            (8.0, 20.0, None),
            (2.5, 20.0, None),
            (1.5, 20.0, Some(AbortReason::TooLow)),
            (8.0, 50.0, Some(AbortReason::NoAltitude)),
        ] {
            let mut synchroniser = under_way();
            synchroniser = synchroniser.with_mission(mission.clone());
            tick(&mut synchroniser, 10.0, place(30.0));
            for altitude_m in [told_m, f64::NAN] {
                driver.tell(&mut synchroniser, Event::AltitudeMeasured { altitude_m });
            }
            tick(&mut synchroniser, 15.0, place(45.0));
            tick(&mut synchroniser, later_s, place(3.0 * later_s));
            let up = synchroniser.trajectory().unwrap().end();
            assert_eq!(up.position.z < 1e-9, reason.is_some(), "{told_m} m");
            tick(&mut synchroniser, up.time_s, up.position);
            let ended = reason.map(Outcome::Aborted);
            assert_eq!(synchroniser.outcome(), ended, "{told_m} m");
        }
    }

    #[test]
    fn an_altitude_measured_before_a_tick_is_dated_by_the_tick() {
        let ready = || {
            let mission = Arc::clone(under_way().mission());
            Synchroniser::new(mission, SyncSettings::default(), Seed(0)).unwrap()
        };
        let told = Event::AltitudeMeasured { altitude_m: 8.0 };
        let (mut early, mut seldom) = (ready(), ready());
        early.step(told.clone());
        for k in 0..4 {
            // A clock that counts from midnight, ticks further apart than silence may last.
            seldom.step(told.clone());
            let gone_s = 40.0 * f64::from(k);
            tick(&mut seldom, 43_200.0 + gone_s, place(3.0 * gone_s));
            tick(
                &mut early,
                43_200.0 + f64::from(k),
                place(3.0 * f64::from(k)),
            );
        }
        for synchroniser in [&early, &seldom] {
            assert_eq!(synchroniser.contingency(), None);
            assert_eq!(synchroniser.outcome(), None);
        }
        tick(&mut seldom, 43_360.0, place(480.0));
        assert_eq!(seldom.contingency(), Some(Contingency::Surface));
    }

    #[test]
    fn an_approaching_obstacle_is_evaded_while_no_contingency_can_be_flown() {
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        let mut synchroniser = under_way();
        let mut mission = (**synchroniser.mission()).clone();
        mission.min_altitude_m = 4.0;
        synchroniser = synchroniser.with_mission(mission);
        let mut comes = Region::cylinder(Point3::new(-55.0, 0.0, 0.0), 60.0, 0.0, 100.0);
        comes.velocity_mps = Vector3::new(4.0, 0.0, 0.0);
        comes.from_s = 10.0;
        let seen = |time_s, position, regions: &[Region]| Observation {
            position_sigma_m: 0.0,
            time_s,
            position,
            velocity: Vector3::zeros(),
            regions: regions.into(),
        };
        driver.tick(&mut synchroniser, seen(10.0, place(30.0), &[comes]));
        let too_low = Event::AltitudeMeasured { altitude_m: 1.0 };
        let evasion = driver.tell(&mut synchroniser, too_low).follow.unwrap();
        assert_eq!(
            (synchroniser.outcome(), synchroniser.contingency()),
            (None, None)
        );
        let away = evasion.end();
        driver.tick(&mut synchroniser, seen(away.time_s, away.position, &[]));
        assert_eq!(synchroniser.contingency(), Some(Contingency::Surface));
    }

    #[test]
    fn a_silent_sonar_ends_the_mission_at_the_surface_or_at_home() {
        let mut synchroniser = under_way();
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        tick(&mut synchroniser, 10.0, place(30.0));
        let up = driver
            .tell(&mut synchroniser, Event::SonarSilent { age_s: 41.0 })
            .follow
            .unwrap()
            .end();
        assert!(up.position.z < 1e-9);
        tick(&mut synchroniser, up.time_s, up.position);
        let ended = Outcome::Aborted(AbortReason::SonarLost);
        assert_eq!(synchroniser.outcome(), Some(ended));

        let mut synchroniser = under_way();
        let mut settings = SyncSettings::default();
        settings.watchdogs.without_sonar = WithoutSonar::GoHome;
        synchroniser = synchroniser.with_settings(settings);
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        tick(&mut synchroniser, 10.0, place(30.0));
        let orders = driver.tell(&mut synchroniser, Event::SonarSilent { age_s: 39.0 });
        assert!(orders.follow.is_none());
        let orders = driver.tell(&mut synchroniser, Event::SonarSilent { age_s: f64::NAN });
        let home = orders.follow.unwrap();
        assert_eq!(home.end().position, place(1800.0));
        let last = synchroniser.route_calls().last().unwrap();
        assert_eq!(
            (last.reason, last.route_weight),
            (RouteReason::SonarLost, 0.0)
        );
        tick(&mut synchroniser, 600.0, place(1800.0));
        assert_eq!(synchroniser.outcome(), Some(Outcome::Docked));
        assert_eq!(synchroniser.tasks(), 0);
    }
}
