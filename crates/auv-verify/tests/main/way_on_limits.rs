//! What is asked of a way on, just kept and just broken.

use auv_obstacles::{Region, TimedPoint};
use auv_planning::{PathProblem, Trajectory, Vehicle};
use auv_types::{Bounds, Point3, libm};
use auv_verify::{
    EndState, KeptEnd, PathViolation, WayOn, WayOnReport, WayOnViolation, verify_way_on,
};
use std::f64::consts::TAU;

fn at(x: f64, y: f64, z: f64) -> Point3<f64> {
    Point3::new(x, y, z)
}

/// 300 m north at the surface at 1.5 m/s, from 50 s to 250 s.
fn line(problem: &PathProblem<'_>) -> Trajectory {
    let ends = [(problem.start, 50.0), (problem.target, 250.0)];
    Trajectory::new(ends.map(|(p, t)| TimedPoint::new(p, t)).to_vec()).unwrap()
}

fn problem(vehicle: &Vehicle) -> PathProblem<'_> {
    PathProblem::new(at(0.0, 0.0, 0.0), at(300.0, 0.0, 0.0), vehicle)
}

fn checked(
    problem: &PathProblem<'_>,
    whole: &Trajectory,
    ends_s: f64,
    lasts_s: f64,
    end: EndState,
) -> WayOnReport {
    let asked = WayOn {
        ends_s,
        lasts_s,
        end,
    };
    verify_way_on(problem, whole, &asked)
}

#[test]
fn it_starts_within_the_trajectory_to_a_microsecond() {
    let vehicle = Vehicle::default();
    let problem = problem(&vehicle);
    let whole = line(&problem);
    for (ends_s, kept) in [
        (50.0 - 0.9e-6, true),
        (50.0 - 1.1e-6, false),
        (50.0, true),
        (150.0, true),
        (250.0 + 0.9e-6, true),
        (250.0 + 1.1e-6, false),
    ] {
        let report = checked(&problem, &whole, ends_s, 0.0, EndState::Docked);
        assert!((report.lasts_s - (250.0 - ends_s)).abs() < 1e-9);
        assert_eq!(report.kept, kept.then_some(KeptEnd::Docked));
        let outside = WayOnViolation::NotWithin {
            ends_s,
            start_s: 50.0,
            end_s: 250.0,
        };
        let expected = if kept { vec![] } else { vec![outside] };
        assert_eq!(report.violations, expected, "{ends_s}");
    }
}

/// A path of 200 m and circles of 21 m, in chords of 3 degrees, that dip from the surface by `dip_m`.
fn circles(problem: &PathProblem<'_>, count: u32, dip_m: f64) -> Trajectory {
    let mut places = vec![at(-200.0, 0.0, 0.0)];
    places.extend((0..=120 * count).map(|k| {
        let (sin, cos) = libm::sincos(TAU * f64::from(k) / 120.0);
        at(21.0 * sin, 21.0 * (1.0 - cos), 0.5 * dip_m * (1.0 - cos))
    }));
    problem.timed(&places).unwrap()
}

#[test]
fn it_lasts_to_a_microsecond() {
    let vehicle = Vehicle::default();
    let problem = problem(&vehicle);
    let whole = circles(&problem, 2, 0.0);
    let ends_s = 200.0 / vehicle.speed_mps;
    let lasts_s = whole.end().time_s - ends_s;
    for (more_s, kept) in [(-0.5, true), (0.9e-6, true), (1.1e-6, false)] {
        let report = checked(
            &problem,
            &whole,
            ends_s,
            lasts_s + more_s,
            EndState::UnderWay,
        );
        assert_eq!(report.is_valid(), kept, "{more_s} {report}");
        assert!(
            kept || matches!(report.violations[..], [WayOnViolation::TooShort { lasts_s: told, required_s }]
                if told == lasts_s && required_s == lasts_s + more_s)
        );
    }
    // At the dock and at the surface the same is long enough.
    for end in [EndState::Docked, EndState::Drifting] {
        let there = PathProblem {
            target: whole.end().position,
            ..problem
        };
        assert!(checked(&there, &whole, ends_s, lasts_s + 1.0, end).is_valid());
    }
}

#[test]
fn a_vehicle_that_hovers_lasts_as_long_as_asked_and_no_longer() {
    let vehicle = Vehicle::paper();
    let problem = problem(&vehicle);
    let whole = line(&problem);
    for (ends_s, lasts_s, told_s) in [
        (250.0, 30.0, 30.0),
        (150.0, 30.0, 100.0),
        (150.0, 100.0, 100.0),
    ] {
        let report = checked(&problem, &whole, ends_s, lasts_s, EndState::UnderWay);
        assert_eq!(report.violations, []);
        assert_eq!(
            (report.lasts_s, report.kept),
            (told_s, Some(KeptEnd::Resting))
        );
        let docked = checked(&problem, &whole, ends_s, lasts_s, EndState::Docked);
        assert_eq!(docked.lasts_s, 250.0 - ends_s);
    }
    // No rest lasts for ever.
    let endless = checked(&problem, &whole, 150.0, f64::INFINITY, EndState::UnderWay);
    assert!(matches!(
        endless.violations[..],
        [WayOnViolation::TooShort { lasts_s: 100.0, .. }]
    ));
}

#[test]
fn a_loop_is_level_up_to_a_decimetre() {
    let vehicle = Vehicle::default();
    let problem = problem(&vehicle);
    let ends_s = 200.0 / vehicle.speed_mps;
    for (dip_m, level) in [(0.099, true), (0.1, true), (0.101, false)] {
        let whole = circles(&problem, 1, dip_m);
        let report = checked(&problem, &whole, ends_s, 60.0, EndState::UnderWay);
        let uneven = WayOnViolation::NotLevel { height_m: dip_m };
        let expected = if level { vec![] } else { vec![uneven] };
        assert_eq!(report.violations, expected, "{dip_m}");
        let kept = matches!(report.kept, Some(KeptEnd::Circling { from_s, period_s })
            if (from_s - ends_s).abs() < 1e-6 && (from_s + period_s - whole.end().time_s).abs() < 1e-9);
        assert_eq!(kept, level, "{:?}", report.kept);
    }
}

#[test]
fn a_dock_is_reached_to_a_millimetre_and_the_surface_to_a_centimetre() {
    let vehicle = Vehicle::default();
    let problem = problem(&vehicle);
    let whole = line(&problem);
    for (off_m, kept) in [(0.9e-3, true), (1.1e-3, false)] {
        let aside = PathProblem {
            target: at(300.0, off_m, 0.0),
            ..problem
        };
        let report = checked(&aside, &whole, 250.0, 9.0, EndState::Docked);
        assert_eq!(report.is_valid(), kept);
        assert!(
            kept || matches!(report.violations[..], [WayOnViolation::NotDocked { distance_m }] if (distance_m - off_m).abs() < 1e-12)
        );
    }
    for (low_m, top_m) in [(None, 0.0), (Some(-5.0), 0.0), (Some(3.0), 3.0)] {
        for (below_m, kept) in [(0.009, true), (0.011, false)] {
            let box_from = |low_m| Bounds::new(at(-9.0, -9.0, low_m), at(900.0, 9.0, 99.0));
            let [start, target] = [0.0, 300.0].map(|x| at(x, 0.0, top_m + below_m));
            let below = PathProblem {
                bounds: low_m.map(box_from),
                start,
                target,
                ..problem
            };
            let report = checked(&below, &line(&below), 250.0, 9.0, EndState::Drifting);
            assert_eq!(report.is_valid(), kept, "{report:?}");
            assert!(
                kept || matches!(report.violations[..], [WayOnViolation::NotAtSurface { depth_m }] if (depth_m - below_m).abs() < 1e-12)
            );
        }
    }
}

#[test]
fn clearance_is_asked_of_the_way_on_alone_to_a_micrometre() {
    let vehicle = Vehicle::default();
    let open = problem(&vehicle);
    let whole = line(&open);
    // Both 10 m off: one is passed at 100 m, the other at 200 m, the way on starts at 150 m.
    let rocks = [100.0, 200.0].map(|x| Region::ball(at(x, 30.0, 0.0), 20.0));
    for (clearance_m, kept) in [(10.0 + 0.9e-6, true), (10.0 + 1.1e-6, false)] {
        let among = PathProblem {
            regions: &rocks,
            clearance_m,
            ..open
        };
        let report = checked(&among, &whole, 150.0, 100.0, EndState::Docked);
        assert_eq!(report.is_valid(), kept, "{report}");
        let closest = report.path.closest.unwrap();
        assert_eq!(closest.region, 1);
        assert!(
            (closest.clearance_m - 10.0).abs() < 1e-9
                && (closest.time_s - 50.0 - 200.0 / 1.5).abs() < 1e-6
        );
        assert!(
            kept || matches!(report.violations[..], [WayOnViolation::Path(PathViolation::TooClose { approach, required_m })]
                if approach.region == 1 && required_m == clearance_m)
        );
    }
}

#[test]
fn a_region_at_the_dock_is_the_business_of_the_path() {
    let vehicle = Vehicle::default();
    let rock = [Region::ball(at(300.0, 0.0, 0.0), 5.0)];
    let among = PathProblem {
        regions: &rock,
        ..problem(&vehicle)
    };
    let whole = line(&among);
    let docked = |ends_s, lasts_s| checked(&among, &whole, ends_s, lasts_s, EndState::Docked);
    // Nothing is flown after the end.
    assert_eq!(docked(250.0, 10.0).violations, []);
    // A way on that leads there meets it once.
    assert_eq!(docked(150.0, 100.0).violations.len(), 1);
    // What is charted counts after the time asked as well.
    assert_eq!(docked(150.0, 10.0).violations.len(), 1);
    let predicted = [Region {
        until_s: 1e4,
        ..rock[0]
    }];
    let among = PathProblem {
        regions: &predicted,
        ..among
    };
    assert_eq!(
        checked(&among, &whole, 150.0, 10.0, EndState::Docked).violations,
        []
    );
}

#[test]
fn the_closest_approach_is_the_first_of_the_nearest() {
    let vehicle = Vehicle::default();
    let open = problem(&vehicle);
    let whole = line(&open);
    // Beside the way, at 180 m, 230 m and 280 m; the time asked ends at 250 m.
    for (aside_m, nearest) in [
        ([30.0, 40.0, 50.0], 0),
        ([50.0, 40.0, 30.0], 2),
        ([30.0, 30.0, 30.0], 0),
        ([40.0, 30.0, 30.0], 1),
    ] {
        let rocks: Vec<_> = [180.0, 230.0, 280.0]
            .iter()
            .zip(aside_m)
            .map(|(&x, y)| Region::cylinder(at(x, y, 0.0), 5.0, 0.0, 50.0))
            .collect();
        let among = PathProblem {
            regions: &rocks,
            ..open
        };
        let ends_s = 150.0;
        let lasts_s = 50.0 + 250.0 / 1.5 - ends_s;
        let report = checked(&among, &whole, ends_s, lasts_s, EndState::Docked);
        let closest = report.path.closest.unwrap();
        assert_eq!(closest.region, nearest, "{aside_m:?}");
    }
}
