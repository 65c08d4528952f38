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
        (1.0, 19.0),
        (2.0, 12.0),
        (3.0, 8.0),
        (5.0, 4.0),
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
    assert!(closing <= 6 && confirmed == 0, "{closing} {confirmed}");
}
