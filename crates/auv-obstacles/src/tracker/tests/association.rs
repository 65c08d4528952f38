//! Claims about which echo belongs to which track, and which tracks are kept.

use super::*;

#[test]
fn two_contacts_that_pass_each_other_keep_their_ids() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let (sonar, mut random) = (Sonar::paper(), Seed(11).stream(0));
    let mut names = Vec::new();
    for step in 0..80 {
        let t = f64::from(step) * 10.0;
        let mut truth = [
            Region::ball(Point3::new(300.0, -160.0 + 0.4 * t, 50.0), 20.0),
            Region::ball(Point3::new(330.0, 160.0 - 0.4 * t, 50.0), 20.0),
        ];
        truth[0].velocity_mps.y = 0.4;
        truth[1].velocity_mps.y = -0.4;
        for region in &mut truth {
            region.at_s = t;
        }
        tracker.observe(&sonar.scan(&truth, &Point3::origin(), 0.0, t, &mut random));
        let nearest = |r: &Region| {
            let gap = |track: &Track| (track.position() - r.centre).norm();
            tracker
                .tracks()
                .iter()
                .min_by(|a, b| gap(a).total_cmp(&gap(b)))
                .unwrap()
                .id()
        };
        names.push([nearest(&truth[0]), nearest(&truth[1])]);
    }
    assert_ne!(names[5][0], names[5][1]);
    assert_eq!(names[5], names[79]);
}

#[test]
fn five_of_seven_echoes_confirm_and_two_do_not() {
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let here = |dx: f64| echo(Point3::new(50.0 + dx, 0.0, 0.0), 2.0);
    let pattern = [true, false, true, true, false, true, true];
    for (k, hit) in pattern.into_iter().enumerate() {
        assert!(
            tracker.at(0.5 * k as f64).is_empty(),
            "confirmed before scan {k}"
        );
        let echoes = if hit {
            vec![here(0.1 * k as f64)]
        } else {
            Vec::new()
        };
        tracker.observe(&scan(0.5 * k as f64, echoes));
    }
    assert!(tracker.tracks()[0].is_confirmed());
    // There is time to see it better: until then it is expected about where it is.
    let mut k = 7;
    while tracker.tracks()[0].is_young() {
        let region = tracker.at(0.5 * f64::from(k))[0];
        let speed_mps = region.growth_mps.abs() + region.velocity_mps.norm();
        assert!(speed_mps < 1e-9 && region.radius_m < 30.0, "{region:?}");
        tracker.observe(&scan(0.5 * f64::from(k), vec![here(0.1 * f64::from(k))]));
        k += 1;
    }
    assert!((12..=40).contains(&k), "{k} scans");
    assert!(!tracker.at(0.5 * f64::from(k)).is_empty());
    let mut ghost = Tracker::new(TrackerSettings::default()).unwrap();
    for k in 0..8 {
        let echoes = if k < 2 {
            vec![here(0.1 * f64::from(k))]
        } else {
            Vec::new()
        };
        ghost.observe(&scan(0.5 * f64::from(k), echoes));
        assert!(ghost.at(4.0).is_empty());
    }
    assert!(
        ghost.tracks().is_empty(),
        "a ghost is gone after its window"
    );
}

#[test]
fn a_contact_at_rest_out_of_view_takes_no_echo_of_another() {
    let settings = TrackerSettings::default();
    let mut tracker = Tracker::new(settings.clone()).unwrap();
    let wobble = |k: u32| 0.1 * f64::from(k % 3);
    for k in 0..40 {
        let place = Point3::new(60.0, wobble(k), 0.0);
        tracker.observe(&scan(0.5 * f64::from(k), vec![echo(place, 5.0)]));
    }
    let first = tracker.tracks()[0].clone();
    assert!(first.is_at_rest(&settings));
    let astern = |time_s: f64, detections: Vec<Detection>| Scan {
        heading_rad: std::f64::consts::PI,
        ..scan(time_s, detections)
    };
    for k in 40..160 {
        tracker.observe(&astern(0.5 * f64::from(k), Vec::new()));
    }
    for k in 160..163 {
        let place = Point3::new(60.0, 20.0 + wobble(k), 0.0);
        tracker.observe(&scan(0.5 * f64::from(k), vec![echo(place, 5.0)]));
    }
    let tracks = tracker.tracks();
    assert_eq!(tracks.len(), 2);
    assert_eq!(tracks[0].id(), first.id());
    assert!(tracks[0].is_at_rest(&settings));
    assert_eq!(tracks[0].seen_s(), first.seen_s());
}

#[test]
fn an_unseen_track_coasts_with_a_growing_region_and_is_dropped_in_the_end() {
    let settings = TrackerSettings::campaign();
    let mut tracker = Tracker::new(settings.clone()).unwrap();
    for k in 0..20 {
        let t = f64::from(k) * 10.0;
        let mut seen = echo(
            Point3::new(400.0 + 0.3 * t + 0.01 * libm::sin(t), 0.0, 0.0),
            20.0,
        );
        seen.velocity = Some(Vector3::new(0.3, 0.0, 0.0));
        seen.velocity_sigma_mps = 0.05;
        tracker.observe(&scan(t, vec![seen]));
    }
    let radius = |tracker: &Tracker, t: f64| tracker.at(t).first().map(|r| r.radius_at(t));
    let mut last = 0.0;
    for k in 20..70 {
        let t = f64::from(k) * 10.0;
        tracker.observe(&scan(t, Vec::new()));
        let now = radius(&tracker, t).unwrap();
        assert!(now > last, "at {t} s: {now} after {last}");
        last = now;
    }
    let centre = tracker.at(690.0)[0].centre_at(690.0);
    assert!((centre.x - 607.0).abs() < 10.0, "{centre}");
    for k in 70..90 {
        tracker.observe(&scan(f64::from(k) * 10.0, Vec::new()));
    }
    assert!(
        tracker.tracks().is_empty(),
        "forgotten after {} s",
        settings.forget_after_s
    );
}

#[test]
fn a_track_missed_in_the_field_of_view_is_dropped_after_a_delay() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let at = |t: f64| echo(Point3::new(200.0, 0.001 * t, 0.0), 20.0);
    let elsewhere = |t: f64| echo(Point3::new(-400.0, 0.001 * t, 0.0), 20.0);
    for k in 0..10 {
        let t = f64::from(k) * 10.0;
        tracker.observe(&scan(t, vec![at(t), elsewhere(t)]));
    }
    let mut left = Vec::new();
    for k in 10..20 {
        let t = f64::from(k) * 10.0;
        tracker.observe(&scan(t, vec![elsewhere(t)]));
        left.push(tracker.tracks().len());
    }
    assert_eq!(left[0], 2, "one miss is not the end");
    assert_eq!(left[9], 1);
}

#[test]
fn of_too_many_echoes_the_nearest_are_used() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let storm = (0..10_000).map(|i| {
        let angle = f64::from(i) * 0.618;
        let range = 50.0 + 0.09 * f64::from(i);
        echo(
            Point3::new(range * libm::cos(angle), range * libm::sin(angle), 0.0),
            5.0,
        )
    });
    tracker.observe(&scan(0.0, storm.collect()));
    assert_eq!(tracker.tracks().len(), 100);
    assert_eq!(tracker.rejected().beyond_capacity, 9000 + 900);
    let farthest = tracker
        .tracks()
        .iter()
        .map(|t| t.position().coords.norm())
        .fold(0.0, f64::max);
    assert!(farthest < 60.0, "{farthest}");
}

#[test]
fn echoes_of_charted_obstacles_start_no_tracks() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let rock = Region::ball(Point3::new(300.0, 0.0, 50.0), 60.0);
    tracker.charted(vec![rock]);
    let (sonar, mut random) = (Sonar::paper(), Seed(2).stream(0));
    for k in 0..500 {
        tracker.observe(&sonar.scan(
            &[rock],
            &Point3::origin(),
            0.0,
            f64::from(k) * 10.0,
            &mut random,
        ));
    }
    assert!(tracker.tracks().is_empty());
    assert_eq!(tracker.at(0.0), vec![rock]);
    let near = Region::ball(Point3::new(300.0, 90.0, 50.0), 30.0);
    tracker.observe(&sonar.scan(&[rock, near], &Point3::origin(), 0.0, 6000.0, &mut random));
    assert_eq!(
        tracker.tracks().len(),
        1,
        "what stands beside it is tracked"
    );
}

/// A sea with one obstacle, seen for two minutes by the default sonar from a vehicle that goes north.
fn tracks_after_two_minutes(truth: Region, ships: &[Region]) -> usize {
    let (sonar, mut random) = (Sonar::default(), Seed(4).stream(0));
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let mut most = 0;
    for k in 0..120 {
        let here = Point3::new(f64::from(k), 0.0, 15.0);
        tracker.reported(ships.to_vec());
        tracker.observe(&sonar.scan(&[truth], &here, 0.0, f64::from(k), &mut random));
        let confirmed = tracker.tracks().iter().filter(|track| track.is_confirmed());
        most = most.max(confirmed.count());
    }
    most
}

#[test]
fn echoes_from_within_a_reported_ship_are_the_ship_s() {
    let tanker = Region::cylinder(Point3::new(330.0, 0.0, 0.0), 165.0, -5.0, 21.0);
    assert!(tracks_after_two_minutes(tanker, &[]) > 0);
    assert_eq!(tracks_after_two_minutes(tanker, &[tanker]), 0);
    // What lies beside it or under it is another thing.
    let beside = Region::ball(Point3::new(130.0, 10.0, 15.0), 8.0);
    assert_eq!(tracks_after_two_minutes(beside, &[tanker]), 1);
    let shallow = Region::cylinder(Point3::new(330.0, 0.0, 0.0), 165.0, -5.0, 6.0);
    assert!(tracks_after_two_minutes(tanker, &[shallow]) > 0);
}
