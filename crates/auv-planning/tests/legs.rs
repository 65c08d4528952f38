//! How long legs take vehicles with a turn radius and a pitch limit, against geometry.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use auv_planning::{Arrival, LegOutline, LegTime, UnderWay, Vehicle};
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const RADIUS_M: f64 = 20.0;

/// Turns within 20 m and pitches freely, at 1 m/s; it cannot hover.
const TURNING: Vehicle = Vehicle {
    speed_mps: 1.0,
    min_speed_mps: 0.5,
    max_speed_mps: 2.0,
    turn_radius_m: RADIUS_M,
    max_pitch_rad: FRAC_PI_2,
};

/// Turns on the spot; pitches by 0.2 rad at most.
const FLAT: Vehicle = Vehicle {
    turn_radius_m: 0.0,
    max_pitch_rad: 0.2,
    ..TURNING
};

/// A guide of three points along the x axis.
fn line(length_m: f64) -> [Point3<f64>; 3] {
    [0.0, 0.5, 1.0].map(|share| Point3::new(share * length_m, 0.0, 0.0))
}

fn under_way(x: f64, y: f64) -> Option<UnderWay> {
    Some(UnderWay {
        place: Point3::origin(),
        velocity: Vector3::new(x, y, 0.0),
    })
}

/// From a place and direction to a point at `away_m` straight behind: an arc of the turn circle, then its
/// tangent, which is as long as the way is far.
fn turned_back_m(away_m: f64) -> f64 {
    let centre_m = libm::hypot(away_m, RADIUS_M);
    let tangent_at = libm::acos(RADIUS_M / centre_m) - libm::atan2(RADIUS_M, away_m);
    RADIUS_M * (1.5 * PI - tangent_at) + away_m
}

/// As long as geometry asks, or up to 1 m more: turns are flown a little wider than the vehicle may.
#[track_caller]
fn assert_turns(found_m: f64, least_m: f64) {
    let is_kept = found_m >= least_m - 1e-6 && found_m < least_m + 1.0;
    assert!(is_kept, "{found_m} m, not {least_m} m");
}

fn under_way_m(vehicle: &Vehicle, leg: &LegOutline<'_>) -> f64 {
    LegTime::in_still_water(vehicle)
        .of(leg)
        .unwrap()
        .under_way_s()
        * vehicle.speed_mps
}

#[test]
fn a_leg_that_begins_backwards_takes_the_turn() {
    let guide = line(1_000.0);
    let leg = LegOutline::straight(&guide, 0.0);
    let ahead = LegOutline {
        from: under_way(1.0, 0.0),
        ..leg
    };
    let back = LegOutline {
        from: under_way(-1.0, 0.0),
        ..leg
    };
    assert!((under_way_m(&TURNING, &ahead) - 1_000.0).abs() < 1e-6);
    assert_turns(under_way_m(&TURNING, &back), turned_back_m(1_000.0));
    // On the spot it takes none.
    assert!((under_way_m(&FLAT, &back) - 1_000.0).abs() < 1e-6);
    // A vehicle that begins anywhere chooses its direction.
    assert!((under_way_m(&TURNING, &leg) - 1_000.0).abs() < 1e-6);
}

#[test]
fn along_a_bent_guide_the_turn_is_over_after_eight_radii() {
    let guide = [(0.0, 0.0), (400.0, 0.0), (400.0, 300.0)];
    let guide = guide.map(|(x, y)| Point3::new(x, y, 0.0));
    let leg = LegOutline::straight(&guide, 0.0);
    assert!((under_way_m(&TURNING, &leg) - 700.0).abs() < 1e-6);
    let back = LegOutline {
        from: under_way(-1.0, 0.0),
        ..leg
    };
    let aim_m = 8.0 * RADIUS_M;
    let expected_m = 700.0 - aim_m + turned_back_m(aim_m);
    assert_turns(under_way_m(&TURNING, &back), expected_m);
    // A guide shorter than that ends where the turn ends.
    let short = guide.map(|p| Point3::from(p.coords * 0.1));
    let short = LegOutline::straight(&short, 0.0);
    let straight_m = 50.0;
    assert!((under_way_m(&TURNING, &short) - straight_m).abs() < 1e-6);
}

#[test]
fn a_leg_that_arrives_in_a_direction_takes_the_turn_at_its_end() {
    let guide = line(1_000.0);
    let leg = |direction, lead_m| LegOutline {
        arrives: Some(Arrival { direction, lead_m }),
        ..LegOutline::straight(&guide, 0.0)
    };
    let along = leg(Vector3::x(), 50.0);
    assert!((under_way_m(&TURNING, &along) - 1_000.0).abs() < 1e-6);
    // The same as leaving backwards, the other way round; the lead is flown from 50 m beyond.
    let back = leg(-Vector3::x(), 0.0);
    assert_turns(under_way_m(&TURNING, &back), turned_back_m(1_000.0));
    let with_lead = leg(-Vector3::x(), 50.0);
    let expected_m = turned_back_m(1_050.0) + 50.0;
    assert_turns(under_way_m(&TURNING, &with_lead), expected_m);
    // Along a long bent guide only its last part is replaced.
    let bent = [(0.0, 0.0), (600.0, 0.0), (600.0, 600.0)];
    let bent = bent.map(|(x, y)| Point3::new(x, y, 0.0));
    let bent = LegOutline::straight(&bent, 0.0);
    let as_it_leads = LegOutline {
        arrives: Some(Arrival {
            direction: Vector3::y(),
            lead_m: 0.0,
        }),
        ..bent
    };
    assert!((under_way_m(&TURNING, &as_it_leads) - 1_200.0).abs() < 1e-6);
    let across = LegOutline {
        arrives: Some(Arrival {
            direction: Vector3::x(),
            lead_m: 0.0,
        }),
        ..bent
    };
    let more_m = under_way_m(&TURNING, &across) - 1_200.0;
    assert!(more_m > 1.0 && more_m < FRAC_PI_2 * RADIUS_M, "{more_m}");
    // A vehicle that turns on the spot arrives in any direction.
    assert!((under_way_m(&FLAT, &back) - 1_000.0).abs() < 1e-6);
}

#[test]
fn a_change_of_depth_takes_as_long_as_the_pitch_allows() {
    let down = |across_m: f64| [Point3::origin(), Point3::new(across_m, 0.0, 100.0)];
    let steep_m = 100.0 / libm::sin(0.2);
    for (across_m, expected_m) in [
        (100.0, steep_m),
        (300.0, steep_m),
        // Flat enough.
        (600.0, libm::hypot(600.0, 100.0)),
    ] {
        let guide = down(across_m);
        let duration = LegTime::in_still_water(&FLAT).of(&LegOutline::straight(&guide, 0.0));
        let duration = duration.unwrap();
        let found_m = duration.under_way_s() * FLAT.speed_mps;
        assert!(
            (found_m / expected_m - 1.0).abs() < 2e-2,
            "{found_m} m, not {expected_m} m"
        );
        assert_eq!(
            duration.climbs_s > 0.0,
            expected_m > libm::hypot(across_m, 100.0) + 1e-6
        );
    }
    // Along a bent guide too.
    let bent = [(0.0, 0.0, 0.0), (60.0, 0.0, 0.0), (60.0, 60.0, 100.0)];
    let bent = bent.map(|(x, y, z)| Point3::new(x, y, z));
    let found_m = under_way_m(&FLAT, &LegOutline::straight(&bent, 0.0));
    assert!((found_m / steep_m - 1.0).abs() < 2e-2, "{found_m} m");
    // Pitching freely it goes straight down.
    let plunge = LegOutline::straight(&bent, 0.0);
    let free = Vehicle {
        max_pitch_rad: FRAC_PI_2,
        ..FLAT
    };
    assert!((under_way_m(&free, &plunge) - plunge.length_m).abs() < 1e-9);
}

#[test]
fn a_vehicle_that_cannot_hover_stays_for_whole_circles_and_leaves_level() {
    let guide = [Point3::origin(), Point3::new(1_000.0, 0.0, 0.0)];
    let leg = |stay_s| LegOutline {
        stay_s,
        ..LegOutline::straight(&guide, 0.0)
    };
    let time = LegTime::in_still_water(&TURNING);
    let stay_s = |stay_s| time.of(&leg(stay_s)).unwrap().stay_s;
    let circle_s = TAU * 1.05 * RADIUS_M;
    assert!(stay_s(0.0).abs() < 1e-12);
    assert!((stay_s(10.0) - circle_s).abs() < 1e-9);
    assert!((stay_s(1_000.0) - 1_000.0).abs() < 1e-9);
    let after = time.leaves(&leg(10.0)).unwrap();
    assert!((after.place - guide[1]).norm() < 1e-9);
    assert!((after.velocity - Vector3::x()).norm() < 1e-9);
    // Pitched by 45 degrees it levels out first, 0.6 radii along and 0.6 level.
    let down = [Point3::origin(), Point3::new(1_000.0, 0.0, 1_000.0)];
    let dive = |stay_s| LegOutline {
        stay_s,
        ..LegOutline::straight(&down, 0.0)
    };
    let levelling_s = time.of(&dive(1_000.0)).unwrap().stay_s - 1_000.0;
    assert!(
        levelling_s > RADIUS_M * 0.5 && levelling_s < 1.2 * RADIUS_M,
        "{levelling_s}"
    );
    let after = time.leaves(&dive(10.0)).unwrap();
    assert!((after.velocity - Vector3::x()).norm() < 1e-9);
    let knee_m = 0.6 * RADIUS_M * 0.5_f64.sqrt();
    let expected = down[1] + Vector3::new(knee_m + 0.6 * RADIUS_M, 0.0, knee_m);
    assert!((after.place - expected).norm() < 1e-6, "{after:?}");
    // Without a stay it leaves as it arrives; one that hovers leaves in any direction.
    let passing = time.leaves(&dive(0.0)).unwrap();
    let diagonal = Vector3::new(0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt());
    assert!((passing.velocity - diagonal).norm() < 1e-9);
    let hovering = Vehicle {
        min_speed_mps: 0.0,
        ..TURNING
    };
    let time = LegTime::in_still_water(&hovering);
    assert_eq!(time.leaves(&leg(10.0)), None);
    assert!((time.of(&leg(10.0)).unwrap().stay_s - 10.0).abs() < 1e-12);
    assert_eq!(LegTime::in_still_water(&FLAT).leaves(&leg(0.0)), None);
}

#[test]
fn a_guide_without_length_takes_no_time() {
    let guide = [Point3::new(3.0, 4.0, 5.0)];
    for vehicle in [TURNING, FLAT] {
        let leg = LegOutline::straight(&guide, 0.0);
        assert!(under_way_m(&vehicle, &leg).abs() < 1e-12);
        let time = LegTime::in_still_water(&vehicle);
        assert!(time.travel_s(&guide, 0.0).unwrap().abs() < 1e-12);
    }
    assert_eq!(
        LegTime::in_still_water(&TURNING).leaves(&LegOutline::straight(&[], 0.0)),
        None
    );
}
