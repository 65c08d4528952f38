//! Claims about fast contacts ahead of the forward-looking sonar, and about what is not one.

use super::*;

/// Scans twice a second from a vehicle that goes north at 1.5 m/s until the contact is met; returns the
/// distance to its surface at the first region that holds it.
fn first_predicted_m(speed_mps: f64, seed: u64) -> Option<f64> {
    let (sonar, mut random) = (Sonar::default(), Seed(seed).stream(0));
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let mut gap_m = 160.0;
    for k in 0.. {
        let time_s = 0.5 * f64::from(k);
        let here = Point3::new(1.5 * time_s, 0.0, 20.0);
        let mut mover = Region::ball(Point3::new(here.x + gap_m + 10.0, 0.0, 20.0), 10.0);
        mover.velocity_mps = Vector3::new(-speed_mps, 0.0, 0.0);
        mover.at_s = time_s;
        tracker.observe(&sonar.scan(&[mover], &here, 0.0, time_s, &mut random));
        let held = |region: &Region| {
            let from_m = (region.centre_at(time_s) - mover.centre).norm();
            from_m < region.radius_at(time_s)
        };
        if tracker.at(time_s).iter().any(held) {
            return Some(gap_m);
        }
        gap_m -= 0.5 * (speed_mps + 1.5);
        if gap_m < 0.0 {
            break;
        }
    }
    None
}

#[test]
fn fast_contacts_are_predicted_while_there_is_time_to_turn() {
    // Speed, and the time to contact at which 95 of 100 are predicted, seconds.
    for (speed_mps, least_s) in [
        (0.5, 25.0),
        (1.0, 24.0),
        (2.0, 16.0),
        (3.0, 13.0),
        (5.0, 7.0),
    ] {
        let mut times_s: Vec<f64> = (0..100)
            .map(|seed| {
                let gap_m = first_predicted_m(speed_mps, seed).unwrap_or(0.0);
                gap_m / (speed_mps + 1.5)
            })
            .collect();
        times_s.sort_by(f64::total_cmp);
        assert!(times_s[5] >= least_s, "{speed_mps} m/s: {times_s:?}");
    }
}

#[test]
fn false_echoes_seldom_close_in() {
    let (sonar, mut random) = (Sonar::default(), Seed(3).stream(0));
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let (mut closing, mut confirmed) = (0, 0);
    for k in 0..40_000 {
        let time_s = 0.5 * f64::from(k);
        let here = Point3::new(1.5 * time_s, 0.0, 20.0);
        let before = tracker.tracks().to_vec();
        tracker.observe(&sonar.scan(&[], &here, 0.0, time_s, &mut random));
        for track in tracker.tracks() {
            let was = before.iter().find(|b| b.id() == track.id());
            closing += u32::from(track.closes_in() && !was.is_some_and(Track::closes_in));
            confirmed += u32::from(track.is_confirmed() && !was.is_some_and(Track::is_confirmed));
        }
    }
    // In 5.6 hours.
    assert!(closing <= 12 && confirmed == 0, "{closing} {confirmed}");
}

#[test]
fn an_echo_of_another_size_is_of_another_contact() {
    let echo = |time_s: f64, radius_m: f64| Scan {
        time_s,
        from: Point3::origin(),
        heading_rad: 0.0,
        background: None,
        detections: vec![Detection {
            position: Point3::new(60.0 - time_s, 0.0, 0.0),
            velocity: None,
            radius_m,
            position_sigma_m: 1.0,
            velocity_sigma_mps: 0.0,
            radius_sigma_m: 0.5,
        }],
    };
    let tracks = |radius_m| {
        let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
        tracker.observe(&echo(0.0, 2.0));
        tracker.observe(&echo(0.5, radius_m));
        tracker.tracks().len()
    };
    assert_eq!((tracks(3.0), tracks(10.0)), (1, 2));
}

#[test]
fn a_fix_moves_contacts_at_rest_too() {
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let (sonar, mut random) = (Sonar::default(), Seed(7).stream(0));
    let rock = Region::ball(Point3::new(50.0, 0.0, 0.0), 10.0);
    for k in 0..60 {
        let time_s = 0.5 * f64::from(k);
        let here = Point3::origin();
        tracker.observe(&sonar.scan(&[rock], &here, 0.0, time_s, &mut random));
    }
    let by = Vector3::new(3.0, -20.0, 0.0);
    let places = |tracker: &Tracker| {
        let regions = tracker.at(29.5);
        let still = regions
            .iter()
            .filter(|region| region.velocity_mps.norm() <= 0.0);
        still.map(|region| region.centre).collect::<Vec<_>>()
    };
    let before = places(&tracker);
    // A fix beyond any place moves nothing.
    for beyond in [1.1e7, f64::MAX, f64::INFINITY, f64::NAN] {
        tracker.moved(&Vector3::new(0.0, beyond, 0.0));
    }
    assert_eq!(places(&tracker), before);
    tracker.moved(&by);
    let after = places(&tracker);
    assert!(!before.is_empty() && before.len() == after.len());
    for (before, after) in before.iter().zip(&after) {
        assert!((after - before - by).norm() < 1e-9);
    }
}
