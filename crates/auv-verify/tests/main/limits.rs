//! Every limit, just kept and just broken.

use auv_obstacles::{Region, TimedPoint};
use auv_ocean::{CurrentField, FlatBed, SeaBed};
use auv_planning::{PathProblem, Trajectory, Vehicle};
use auv_types::{Bounds, Point3, Vector3};
use auv_verify::{PathViolation as V, RequiredEnds, verify_motion, verify_part, verify_trajectory};

fn at(x: f64, y: f64, z: f64) -> Point3<f64> {
    Point3::new(x, y, z)
}

/// A trajectory of places and times.
fn way(points: &[([f64; 3], f64)]) -> Trajectory {
    let points = points.iter().map(|&(p, t)| TimedPoint::new(p.into(), t));
    Trajectory::new(points.collect()).unwrap()
}

/// A survey vehicle: 1.5 m/s, limits of its own.
const VEHICLE: Vehicle = Vehicle {
    speed_mps: 1.5,
    max_speed_mps: 2.0,
    min_speed_mps: 1.0,
    turn_radius_m: 20.0,
    max_pitch_rad: 0.3,
};

/// 150 m north at 5 m depth, departing at 50 s.
fn problem() -> PathProblem<'static> {
    PathProblem {
        departure_s: 50.0,
        ..PathProblem::new(at(0.0, 0.0, 5.0), at(150.0, 0.0, 5.0), &VEHICLE)
    }
}

#[test]
fn ends_may_be_off_by_a_millimetre_and_a_microsecond() {
    let problem = problem();
    for (off_m, kept) in [(0.9e-3, true), (1.1e-3, false)] {
        let start = way(&[([0.0, off_m, 5.0], 50.0), ([150.0, 0.0, 5.0], 150.0)]);
        let target = way(&[([0.0, 0.0, 5.0], 50.0), ([150.0, 0.0, 5.0 - off_m], 150.0)]);
        let [start, target] = [start, target].map(|w| verify_trajectory(&problem, &w).violations);
        assert_eq!(
            (start.is_empty(), target.is_empty()),
            (kept, kept),
            "{off_m} m"
        );
        assert!(
            kept || matches!(start[..], [V::WrongStart { distance_m }] if (distance_m - off_m).abs() < 1e-12)
        );
        assert!(
            kept || matches!(target[..], [V::WrongTarget { distance_m }] if (distance_m - off_m).abs() < 1e-12)
        );
    }
    for (off_s, kept) in [
        (0.9e-6, true),
        (-0.9e-6, true),
        (1.1e-6, false),
        (-1.1e-6, false),
    ] {
        let late = way(&[([0.0, 0.0, 5.0], 50.0 + off_s), ([150.0, 0.0, 5.0], 150.0)]);
        let violations = verify_trajectory(&problem, &late).violations;
        assert_eq!(violations.is_empty(), kept, "{off_s} s: {violations:?}");
        assert!(
            kept || matches!(
                violations[..],
                [V::WrongDeparture {
                    expected_s: 50.0,
                    ..
                }]
            )
        );
    }
    // Ends that are free may be anywhere.
    let elsewhere = way(&[([7.0, 7.0, 7.0], 0.0), ([150.0, 7.0, 7.0], 95.0)]);
    assert!(verify_motion(&problem, &elsewhere).is_valid());
    let there = RequiredEnds {
        target: Some(at(150.0, 0.0, 5.0)),
        ..RequiredEnds::free()
    };
    assert!(matches!(
        verify_part(&problem, &there, &elsewhere).violations[..],
        [V::WrongTarget { .. }]
    ));
}

#[test]
fn speeds_may_be_off_by_a_ten_thousandth() {
    let speeds = [
        (2.0 * (1.0 + 0.9e-4), true),
        (2.0 * (1.0 + 1.1e-4), false),
        (1.0 * (1.0 - 0.9e-4), true),
        (1.0 * (1.0 - 1.1e-4), false),
    ];
    for (speed_mps, kept) in speeds {
        // The second segment of two: it is named.
        let points = [
            ([0.0, 0.0, 5.0], 0.0),
            ([75.0, 0.0, 5.0], 50.0),
            ([150.0, 0.0, 5.0], 50.0 + 75.0 / speed_mps),
        ];
        let report = verify_motion(&problem(), &way(&points));
        assert_eq!(report.is_valid(), kept, "{speed_mps}: {report}");
        let named = |told: f64, limit: f64| (told - speed_mps).abs() < 1e-9 && limit.fract() == 0.0;
        assert!(
            kept || matches!(report.violations[..],
            [V::TooFast { segment: 1, speed_mps: told, limit_mps }
                | V::TooSlow { segment: 1, speed_mps: told, limit_mps }] if named(told, limit_mps))
        );
        assert!((report.length_m - 150.0).abs() < 1e-9);
        let (least, most) = (report.min_speed_mps, report.max_speed_mps);
        assert!(
            (least.min(1.5) - speed_mps.min(1.5)).abs() < 1e-9,
            "{least}"
        );
        assert!((most.max(1.5) - speed_mps.max(1.5)).abs() < 1e-9, "{most}");
    }
}

#[test]
fn a_turn_may_be_tighter_by_a_hundredth() {
    // Two segments of 40 m: the radius at the corner is 20 m over the tangent of half the angle.
    for (radius_m, kept) in [(19.85, true), (19.75, false)] {
        let angle = 2.0 * auv_types::libm::atan(20.0 / radius_m);
        let (sin, cos) = auv_types::libm::sincos(angle);
        let end = [40.0 + 40.0 * cos, 40.0 * sin, 5.0];
        let corner = way(&[
            ([0.0, 0.0, 5.0], 0.0),
            ([40.0, 0.0, 5.0], 26.0),
            (end, 52.0),
        ]);
        let whole = RequiredEnds {
            start: Some(corner.start()),
            ..RequiredEnds::free()
        };
        let report = verify_part(&problem(), &whole, &corner);
        assert_eq!(report.is_valid(), kept, "{report}");
        assert!(
            (report.min_turn_radius_m - radius_m).abs() < 1e-6,
            "{report}"
        );
        assert!(
            kept || matches!(
                report.violations[..],
                [V::TurnsTooTight {
                    point: 1,
                    limit_m: 20.0,
                    ..
                }]
            )
        );
    }
}

#[test]
fn a_pitch_may_be_steeper_by_a_ten_thousandth_up_and_down() {
    for (excess_rad, kept) in [(0.9e-4, true), (1.1e-4, false)] {
        let rise_m = 90.0 * auv_types::libm::tan(0.3 + excess_rad);
        for (from_m, to_m) in [(50.0, 50.0 + rise_m), (50.0, 50.0 - rise_m)] {
            let line = way(&[([0.0, 0.0, from_m], 0.0), ([90.0, 0.0, to_m], 60.0)]);
            let report = verify_motion(&problem(), &line);
            assert_eq!(report.is_valid(), kept, "{report}");
            assert!(
                (report.max_pitch_rad - 0.3 - excess_rad).abs() < 1e-7,
                "{report}"
            );
        }
    }
    // Straight up is as steep as can be.
    let up = way(&[([0.0, 0.0, 50.0], 0.0), ([0.0, 0.0, 20.0], 20.0)]);
    let report = verify_motion(&problem(), &up);
    assert!(
        (report.max_pitch_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-9 && !report.is_valid()
    );
}

#[test]
fn each_face_of_the_box_is_one() {
    let bounds = Bounds::new(at(-10.0, -10.0, 0.0), at(200.0, 10.0, 50.0));
    let problem = PathProblem {
        bounds: Some(bounds),
        ..problem()
    };
    for axis in 0..3 {
        for face in [bounds.low, bounds.high] {
            let outwards = if face == bounds.low { -1.0 } else { 1.0 };
            for (excess_m, kept) in [(0.0, true), (0.9e-6, true), (1.1e-6, false), (3.0, false)] {
                let mut point = at(75.0, 0.0, 25.0);
                point[axis] = face[axis] + outwards * excess_m;
                let stay = way(&[(point.coords.into(), 0.0)]);
                let report = verify_motion(&problem, &stay);
                assert_eq!(
                    report.is_valid(),
                    kept,
                    "axis {axis}, {excess_m} m: {report}"
                );
                assert!(
                    kept || matches!(report.violations[..],
                    [V::OutsideBox { point: 0, excess_m: told }] if (told - excess_m).abs() < 1e-9)
                );
            }
        }
    }
}

/// Still but for a jet across the way, 40 m wide about a place, that sets in at a time.
#[derive(Debug)]
struct Jet {
    north_m: f64,
    from_s: f64,
    until_s: f64,
    speed_mps: f64,
}

impl CurrentField for Jet {
    fn velocity_at(&self, place: &Point3<f64>, time_s: f64) -> Vector3<f64> {
        let within =
            (place.x - self.north_m).abs() < 20.0 && (self.from_s..self.until_s).contains(&time_s);
        Vector3::new(0.0, if within { self.speed_mps } else { 0.0 }, 0.0)
    }

    fn max_speed_mps(&self) -> f64 {
        self.speed_mps
    }
}

#[test]
fn a_current_that_varies_along_a_segment_or_with_time_is_sampled() {
    let jet = |north_m, from_s, until_s| Jet {
        north_m,
        from_s,
        until_s,
        speed_mps: 2.0,
    };
    let report = |jet: &Jet, way: &Trajectory| {
        let problem = PathProblem {
            current: Some(jet),
            ..problem()
        };
        verify_motion(&problem, way)
    };
    // 150 m at 1.5 m/s: samples are 37.5 m apart. Across a jet of 2 m/s it makes 2.5 m/s through the water.
    let line = way(&[([0.0, 0.0, 5.0], 0.0), ([150.0, 0.0, 5.0], 100.0)]);
    for north_m in [0.0, 37.5, 75.0, 112.5, 150.0] {
        let crossed = report(&jet(north_m, 0.0, 1e3), &line);
        assert!(
            (crossed.max_speed_mps - 2.5).abs() < 1e-9,
            "{north_m}: {crossed}"
        );
        assert!(
            (crossed.min_speed_mps - 1.5).abs() < 1e-9,
            "{north_m}: {crossed}"
        );
        assert!(matches!(
            crossed.violations[..],
            [V::TooFast { segment: 0, .. }]
        ));
    }
    // The jet is over before the vehicle is there, or sets in only then.
    assert!(report(&jet(150.0, 0.0, 60.0), &line).is_valid());
    assert!(!report(&jet(150.0, 60.0, 1e3), &line).is_valid());
    // A stay of 400 s in a current that runs for a while: keeping the place takes 2 m/s, before and after none.
    let stay = way(&[([0.0, 0.0, 5.0], 0.0), ([0.0, 0.0, 5.0], 400.0)]);
    let stayed = report(&jet(0.0, 190.0, 230.0), &stay);
    assert!(
        (stayed.max_speed_mps - 2.0).abs() < 1e-9 && stayed.min_speed_mps.abs() < 1e-9,
        "{stayed}"
    );
}

#[test]
fn a_steep_dive_past_a_cylinder_is_measured_exactly() {
    // A disc 10 m wide between 20 and 30 m of depth.
    let wreck = Region::cylinder(at(50.0, 0.0, 0.0), 5.0, 20.0, 30.0);
    let clearance_m = |from: [f64; 3], to: [f64; 3]| {
        let regions = [wreck];
        let problem = PathProblem {
            regions: &regions,
            ..problem()
        };
        verify_motion(&problem, &way(&[(from, 0.0), (to, 60.0)])).min_clearance_m()
    };
    let near =
        |found_m: f64, wanted_m: f64| assert!((found_m - wanted_m).abs() < 1e-9, "{found_m}");
    // Straight down beside it: 3 m abeam.
    near(clearance_m([58.0, 0.0, 0.0], [58.0, 0.0, 60.0]), 3.0);
    // Straight down onto it, to 4 m above its top; from below to 6 m under it.
    near(clearance_m([50.0, 0.0, 0.0], [50.0, 0.0, 16.0]), 4.0);
    near(clearance_m([50.0, 0.0, 60.0], [50.0, 0.0, 36.0]), 6.0);
    // Through its axis: as deep inside as its radius or half its height.
    near(clearance_m([50.0, 0.0, 0.0], [50.0, 0.0, 60.0]), -5.0);
    // Across its edge at 45 degrees: one metre inside, from the side and from below. Level over it.
    near(clearance_m([33.0, 0.0, 16.0], [63.0, 0.0, 46.0]), -1.0);
    near(clearance_m([26.0, 0.0, 17.0], [56.0, 0.0, 17.0]), 3.0);
}

#[test]
fn a_clearance_may_be_short_by_a_micrometre() {
    let rock = [Region::ball(at(75.0, 30.0, 5.0), 20.0)];
    for (clearance_m, kept) in [(10.0, true), (10.0 + 0.9e-6, true), (10.0 + 1.1e-6, false)] {
        let problem = PathProblem {
            regions: &rock,
            clearance_m,
            ..problem()
        };
        let line = way(&[([0.0, 0.0, 5.0], 50.0), ([150.0, 0.0, 5.0], 150.0)]);
        let report = verify_trajectory(&problem, &line);
        assert_eq!(report.is_valid(), kept, "{report}");
        let closest = report.closest.unwrap();
        assert!((closest.clearance_m - 10.0).abs() < 1e-9 && (closest.time_s - 100.0).abs() < 1e-6);
        assert!((closest.place - at(75.0, 0.0, 5.0)).norm() < 1e-6);
    }
}

/// A flat bed that nobody knows exactly.
#[derive(Debug)]
struct Unsure(FlatBed);

impl SeaBed for Unsure {
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.0.depth_at(north_m, east_m)
    }

    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
        self.0.max_slope_near(north_m, east_m, radius_m)
    }

    fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
        (self.depth_at(north_m, east_m), 2.0)
    }
}

#[test]
fn the_bed_is_kept_at_the_altitude_with_its_standard_deviations() {
    let bed = Unsure(FlatBed::new(40.0));
    // 5 m and three times 2 m above 40 m: 29 m may be reached, but for the chord error of trajectories.
    let slack_m = Trajectory::CHORD_ERROR_M;
    for (depth_m, kept) in [
        (29.0, true),
        (29.0 + 0.9 * slack_m, true),
        (29.0 + 1.1 * slack_m, false),
    ] {
        let problem = PathProblem {
            sea_bed: Some(&bed),
            min_altitude_m: 5.0,
            altitude_sigmas: 3.0,
            ..problem()
        };
        let line = way(&[([0.0, 0.0, depth_m], 0.0), ([150.0, 0.0, depth_m], 100.0)]);
        let report = verify_motion(&problem, &line);
        assert_eq!(report.is_valid(), kept, "{depth_m}: {report}");
        assert!((report.min_altitude_m - (40.0 - depth_m)).abs() < 1e-9);
        let told = |altitude_m: f64, required_m: f64| {
            (altitude_m - (40.0 - depth_m)).abs() < 1e-9 && (required_m - 11.0).abs() < 1e-9
        };
        assert!(
            kept || matches!(report.violations[..],
            [V::TooLow { altitude_m, required_m, .. }] if told(altitude_m, required_m))
        );
        // A single place is checked too.
        let stay = way(&[([9.0, 9.0, depth_m], 0.0)]);
        assert_eq!(verify_motion(&problem, &stay).is_valid(), kept);
    }
}

/// Still water that keeps where and when it is asked.
#[derive(Debug, Default)]
struct Asked(std::sync::Mutex<Vec<(Point3<f64>, f64)>>);

impl CurrentField for Asked {
    fn velocity_at(&self, place: &Point3<f64>, time_s: f64) -> Vector3<f64> {
        self.0.lock().unwrap().push((*place, time_s));
        Vector3::zeros()
    }

    fn max_speed_mps(&self) -> f64 {
        0.0
    }
}

#[test]
fn the_current_is_sampled_at_both_ends_the_middle_and_every_fifty_metres() {
    let samples = |length_m: f64, elapsed_s: f64| {
        let asked = Asked::default();
        let problem = PathProblem {
            current: Some(&asked),
            ..problem()
        };
        let end = [7.0 + length_m, 3.0, 5.0];
        let _ = verify_motion(
            &problem,
            &way(&[([7.0, 3.0, 5.0], 20.0), (end, 20.0 + elapsed_s)]),
        );
        let found = asked.0.into_inner().unwrap();
        let pieces = (found.len() - 1) as f64;
        for (k, (place, time_s)) in found.iter().enumerate() {
            let share = k as f64 / pieces;
            assert!((place - at(7.0 + share * length_m, 3.0, 5.0)).norm() < 1e-6);
            assert!((time_s - 20.0 - share * elapsed_s).abs() < 1e-6);
        }
        pieces
    };
    assert_eq!(samples(10.0, 5.0), 2.0);
    assert_eq!(samples(100.0, 60.0), 2.0);
    assert_eq!(samples(101.0, 60.0), 4.0);
    assert_eq!(samples(450.0, 300.0), 10.0);
    // A stay, and a slow way, as often as a travel at 1.5 m/s.
    assert_eq!(samples(0.0, 400.0), 12.0);
    assert_eq!(samples(30.0, 400.0), 12.0);
    // There is an end to it.
    assert_eq!(samples(3e6, 2e6), 2e4);
}

#[test]
fn what_rounding_makes_of_a_speed_is_forgiven() {
    // In a microsecond a nanometre makes a millimetre a second.
    for (speed_mps, kept) in [
        (2.0011, true),
        (2.0013, false),
        (0.9990, true),
        (0.9988, false),
    ] {
        let step = [1e-6 * speed_mps, 0.0, 5.0];
        let report = verify_motion(&problem(), &way(&[([0.0, 0.0, 5.0], 0.0), (step, 1e-6)]));
        assert_eq!(report.is_valid(), kept, "{speed_mps}: {report}");
        assert!((report.max_speed_mps - speed_mps).abs() < 1e-9);
    }
}
