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
        (2.0, 20.0),
        (3.0, 15.5),
        (5.0, 9.5),
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
    assert!(closing <= 2 && confirmed <= 1, "{closing} {confirmed}");
}

#[test]
fn what_closes_in_is_not_forgotten_when_the_vehicle_turns_away() {
    let (sonar, mut random) = (Sonar::default(), Seed(7).stream(0));
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let here = Point3::new(0.0, 0.0, 20.0);
    let mut away_s = None;
    for k in 0..200 {
        let time_s = 0.5 * f64::from(k);
        let mut mover = Region::ball(Point3::new(250.0 - 5.0 * time_s, 0.0, 20.0), 10.0);
        mover.velocity_mps = Vector3::new(-5.0, 0.0, 0.0);
        mover.at_s = time_s;
        let heading_rad = if away_s.is_some() { 3.0 } else { 0.0 };
        tracker.observe(&sonar.scan(&[mover], &here, heading_rad, time_s, &mut random));
        match away_s {
            None if tracker.is_urgent() => away_s = Some(time_s),
            Some(since_s) if time_s > since_s + 12.0 => break,
            _ => {}
        }
        if away_s.is_some() {
            let regions = tracker.at(time_s);
            let held = |region: &Region| {
                region.exists_at(time_s)
                    && (region.centre_at(time_s) - mover.centre_at(time_s)).norm()
                        < region.radius_at(time_s)
            };
            assert!(regions.iter().any(held), "{time_s} s: {regions:?}");
        }
    }
    assert!(away_s.is_some());
}

#[test]
fn a_thing_of_which_more_and_more_is_seen_stands_still() {
    let (sonar, mut random) = (Sonar::default(), Seed(5).stream(0));
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    for k in 0..60 {
        let time_s = 0.5 * f64::from(k);
        let here = Point3::new(1.5 * time_s - 20.0, 0.0, 20.0);
        let thing = Region::ball(Point3::new(115.0, 10.0, 20.0), 20.0);
        tracker.observe(&sonar.scan(&[thing], &here, 0.0, time_s, &mut random));
    }
    let large = tracker
        .tracks()
        .iter()
        .find(|track| track.radius_m() > 15.0);
    let velocity = large.unwrap().velocity();
    assert!(velocity.norm() < 0.25, "{velocity:?}");
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
