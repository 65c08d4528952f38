//! Ways on that a vehicle can keep, and ways on that are broken on purpose.

use auv_obstacles::Region;
use auv_ocean::{FlatBed, SeaBed};
use auv_planning::{PathProblem, Trajectory, Vehicle};
use auv_types::{Bounds, Point3, Vector3, libm};
use auv_verify::{EndState, KeptEnd, PathViolation, WayOn, WayOnViolation, verify_way_on};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// A bed that is flat up to an east coordinate and steep beyond it.
#[derive(Debug)]
struct Wall {
    depth_m: f64,
    foot_m: f64,
    slope: f64,
}

impl SeaBed for Wall {
    fn depth_at(&self, _north_m: f64, east_m: f64) -> f64 {
        self.depth_m - self.slope * (east_m - self.foot_m).max(0.0)
    }

    fn max_slope_near(&self, _north_m: f64, _east_m: f64, _radius_m: f64) -> f64 {
        self.slope
    }
}

/// A path of 200 m to the north and circles at its end, in a way that a test can break.
#[derive(Clone, Copy, Debug)]
struct Way {
    radius_m: f64,
    circles: f64,
    /// To the right (1) or left (-1).
    side: f64,
    /// Added depth at the end of the circles, metres.
    sinks_m: f64,
    /// Added depth in the middle of each circle, metres.
    dips_m: f64,
}

const DEPTH_M: f64 = 30.0;
const PATH_M: f64 = 200.0;

impl Way {
    fn points(&self) -> Vec<Point3<f64>> {
        let count = (self.circles * TAU / 0.05).ceil();
        let mut points = vec![
            Point3::new(-PATH_M, 0.0, DEPTH_M),
            Point3::new(0.0, 0.0, DEPTH_M),
        ];
        points.extend((1..=count as usize).map(|k| {
            let share = k as f64 / count;
            let (sin, cos) = libm::sincos(TAU * self.circles * share);
            let down_m = self.sinks_m * share + 0.5 * self.dips_m * (1.0 - cos);
            Point3::new(
                self.radius_m * sin,
                self.side * self.radius_m * (1.0 - cos),
                DEPTH_M + down_m,
            )
        }));
        points
    }

    fn flown(&self, problem: &PathProblem<'_>) -> (Trajectory, f64) {
        let whole = problem.timed(&self.points()).unwrap();
        (whole, PATH_M / problem.vehicle.speed_mps)
    }
}

fn problem(vehicle: &Vehicle) -> PathProblem<'_> {
    let start = Point3::new(-PATH_M, 0.0, DEPTH_M);
    PathProblem::new(start, Point3::new(0.0, 0.0, DEPTH_M), vehicle)
}

fn found(problem: &PathProblem<'_>, way: &Way, lasts_s: f64) -> Vec<WayOnViolation> {
    let (whole, ends_s) = way.flown(problem);
    let end = EndState::UnderWay;
    let asked = WayOn {
        ends_s,
        lasts_s,
        end,
    };
    verify_way_on(problem, &whole, &asked).violations
}

prop_compose! {
    fn ways()(radius_m in 21.0..80.0_f64, circles in 1_u32..4, right in prop::bool::ANY) -> Way {
        let side = if right { 1.0 } else { -1.0 };
        Way { radius_m, circles: f64::from(circles), side, sinks_m: 0.0, dips_m: 0.0 }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whole_circles_are_kept_for_as_long_as_they_last(way in ways()) {
        let vehicle = Vehicle::default();
        let problem = problem(&vehicle);
        let lasts_s = 0.999 * TAU * way.radius_m * way.circles / vehicle.speed_mps;
        let (whole, ends_s) = way.flown(&problem);
        let asked = WayOn { ends_s, lasts_s, end: EndState::UnderWay };
        let report = verify_way_on(&problem, &whole, &asked);
        prop_assert!(report.is_valid(), "{:?}", report);
        let period_s = TAU * way.radius_m / vehicle.speed_mps;
        let circles = matches!(report.kept, Some(KeptEnd::Circling { period_s: one_s, .. }) if (one_s / period_s - 1.0).abs() < 1e-2);
        prop_assert!(circles, "{:?} {}", report.kept, period_s);
        // Too short for what is asked.
        let longer = found(&problem, &way, 1.05 * lasts_s);
        prop_assert!(matches!(longer[..], [WayOnViolation::TooShort { .. }]), "{:?}", longer);
    }

    #[test]
    fn what_does_not_close_is_found(way in ways(), missing in 0.05..0.9_f64) {
        let vehicle = Vehicle::default();
        let open = Way { circles: 1.0 - missing, ..way };
        let found = found(&problem(&vehicle), &open, 0.0);
        prop_assert!(matches!(found[..], [WayOnViolation::NotClosed { nearest_m }] if nearest_m > 1.0), "{:?}", found);
    }

    #[test]
    fn what_is_not_level_is_found(way in ways(), sinks_m in 0.3..3.0_f64, dips_m in 0.2..2.0_f64) {
        let vehicle = Vehicle::default();
        let helix = Way { sinks_m: sinks_m * way.circles, ..way };
        let problem = problem(&vehicle);
        let helix = found(&problem, &helix, 0.0);
        prop_assert!(matches!(helix[..], [WayOnViolation::NotClosed { .. }]), "{:?}", helix);
        let wave = found(&problem, &Way { dips_m, ..way }, 0.0);
        prop_assert!(matches!(wave[..], [WayOnViolation::NotLevel { height_m }] if (height_m - dips_m).abs() < 0.01), "{:?}", wave);
    }

    #[test]
    fn what_leads_into_the_bed_is_found(way in ways(), slope in 0.5..3.0_f64, short_m in 0.1..5.0_f64, wall in prop::bool::ANY) {
        let vehicle = Vehicle::default();
        // Beyond the farthest place of the circle the wall is too near, or the flat bed everywhere.
        let east_m = 2.0 * way.radius_m;
        let steep = Wall { depth_m: 60.0, foot_m: east_m - 25.0 / slope - short_m, slope };
        let flat = FlatBed::new(DEPTH_M + 5.0 - short_m);
        let bed: &dyn SeaBed = if wall { &steep } else { &flat };
        let over = PathProblem { sea_bed: Some(bed), min_altitude_m: 5.0, ..problem(&vehicle) };
        let found = found(&over, &Way { side: 1.0, ..way }, 0.0);
        prop_assert!(matches!(found[..], [WayOnViolation::Path(PathViolation::TooLow { .. })]), "{:?}", found);
    }

    #[test]
    fn what_leads_through_a_region_is_found_while_it_is_asked_about(way in ways(), share in 0.1..0.9_f64, charted in prop::bool::ANY) {
        let vehicle = Vehicle::default();
        let open = problem(&vehicle);
        let (whole, ends_s) = way.flown(&open);
        let way_s = whole.end().time_s - ends_s;
        let hit_s = ends_s + share * way_s;
        let ball = Region::ball(whole.at(hit_s).0, 8.0);
        // A predicted region lasts for a moment, a charted one for ever.
        let (from_s, until_s) = if charted { (ball.from_s, ball.until_s) } else { (hit_s - 1.0, hit_s + 1.0) };
        let regions = [Region { from_s, until_s, ..ball }];
        let among = PathProblem { regions: &regions, clearance_m: 2.0, ..open };
        let asked = |lasts_s: f64| found(&among, &way, lasts_s);
        let through = asked(way_s);
        prop_assert!(matches!(through[..], [WayOnViolation::Path(PathViolation::TooClose { .. })]), "{:?}", through);
        // What is predicted for later than asked does not count; what is charted does.
        let before_s = share * way_s - 2.0;
        let early = asked(before_s.max(0.0));
        let counts = charted || before_s < 0.0;
        prop_assert_eq!(early.is_empty(), !counts, "{:?}", early);
    }

    #[test]
    fn what_leaves_the_box_is_found(way in ways(), cut_m in 0.1..30.0_f64) {
        let vehicle = Vehicle::default();
        let high_m = way.radius_m - cut_m.min(0.5 * way.radius_m);
        let bounds = Bounds::new(Point3::new(-PATH_M, -500.0, 0.0), Point3::new(high_m, 500.0, 100.0));
        let boxed = PathProblem { bounds: Some(bounds), ..problem(&vehicle) };
        let found = found(&boxed, &way, 0.0);
        prop_assert!(matches!(found[..], [WayOnViolation::Path(PathViolation::OutsideBox { .. })]), "{:?}", found);
    }

    #[test]
    fn what_turns_too_tightly_is_found(way in ways(), share in 0.2..0.9_f64) {
        let vehicle = Vehicle::default();
        let tight = Way { radius_m: share * vehicle.turn_radius_m, ..way };
        let found = found(&problem(&vehicle), &tight, 0.0);
        prop_assert!(found.iter().any(|v| matches!(v, WayOnViolation::Path(PathViolation::TurnsTooTight { .. }))), "{:?}", found);
    }
}

#[test]
fn a_vehicle_that_hovers_rests_and_its_rest_is_checked() {
    let vehicle = Vehicle::paper();
    let end = Point3::new(0.0, 0.0, DEPTH_M);
    // It comes to where the vehicle rests 60 s after its arrival.
    let mut comes = Region::ball(end + Vector3::y() * 80.0, 10.0);
    (comes.at_s, comes.velocity_mps) = (PATH_M / 3.0, -Vector3::y());
    let regions = [comes];
    let problem = PathProblem {
        regions: &regions,
        ..problem(&vehicle)
    };
    let path = problem.timed(&[problem.start, end]).unwrap();
    let asked = |lasts_s| WayOn {
        ends_s: path.end().time_s,
        lasts_s,
        end: EndState::UnderWay,
    };
    let before = verify_way_on(&problem, &path, &asked(60.0));
    assert!(before.is_valid() && before.kept == Some(KeptEnd::Resting));
    assert_eq!(before.lasts_s, 60.0);
    let hit = verify_way_on(&problem, &path, &asked(120.0));
    assert!(
        matches!(
            hit.violations[..],
            [WayOnViolation::Path(PathViolation::TooClose { .. })]
        ),
        "{hit:?}"
    );
}

#[test]
fn a_dock_and_the_surface_need_not_last() {
    let vehicle = Vehicle::default();
    let up = Point3::new(0.0, 0.0, 1.0);
    let mut problem = PathProblem {
        target: up,
        start: Point3::new(-PATH_M, 0.0, 1.0),
        ..problem(&vehicle)
    };
    problem.bounds = Some(Bounds::new(
        Point3::new(-900.0, -900.0, 1.0),
        Point3::new(900.0, 900.0, 50.0),
    ));
    let path = problem.timed(&[problem.start, up]).unwrap();
    let asked = |end| WayOn {
        ends_s: path.end().time_s,
        lasts_s: 120.0,
        end,
    };
    for (end, kept) in [
        (EndState::Docked, KeptEnd::Docked),
        (EndState::Drifting, KeptEnd::Drifting),
    ] {
        let report = verify_way_on(&problem, &path, &asked(end));
        assert!(report.is_valid() && report.kept == Some(kept), "{report:?}");
    }
    let deeper = PathProblem {
        target: up + Vector3::z() * 7.0,
        bounds: None,
        ..problem
    };
    let found = |end| verify_way_on(&deeper, &path, &asked(end)).violations;
    assert_eq!(
        found(EndState::Docked),
        [WayOnViolation::NotDocked { distance_m: 7.0 }]
    );
    assert_eq!(
        found(EndState::Drifting),
        [WayOnViolation::NotAtSurface { depth_m: 1.0 }]
    );
}

#[test]
fn times_outside_the_trajectory_are_found() {
    let vehicle = Vehicle::paper();
    let problem = problem(&vehicle);
    let path = problem.timed(&[problem.start, problem.target]).unwrap();
    for (ends_s, lasts_s) in [
        (-1.0, 9.0),
        (99.0, 9.0),
        (f64::NAN, 9.0),
        (9.0, f64::NAN),
        (9.0, -1.0),
    ] {
        let asked = WayOn {
            ends_s,
            lasts_s,
            end: EndState::UnderWay,
        };
        let found = verify_way_on(&problem, &path, &asked).violations;
        assert!(
            found
                .iter()
                .any(|v| matches!(v, WayOnViolation::NotWithin { .. })),
            "{ends_s} {lasts_s}"
        );
    }
}
