//! Claims about tracks of a forward-looking sonar that sees near faces.

use super::*;

#[test]
fn gear_at_rest_is_recognised_bounded_and_kept() {
    let (sonar, settings) = (Sonar::default(), TrackerSettings::default());
    let mut wrong = 0;
    for seed in 0..40 {
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        let mut random = Seed(seed).stream(0);
        let gear = Region::cylinder(Point3::new(95.0, 6.0, 0.0), 5.0, 0.0, 60.0);
        let mut from = Point3::new(0.0, 0.0, 20.0);
        for k in 0..140 {
            from.x = 0.75 * f64::from(k);
            tracker.observe(&sonar.scan(&[gear], &from, 0.0, 0.5 * f64::from(k), &mut random));
            if k == 80 {
                let holds = tracker.at(40.0).iter().any(|r| {
                    r.exists_at(70.0)
                        && (r.centre_at(70.0).xy() - gear.centre.xy()).norm() + 5.0
                            <= r.radius_at(70.0)
                        && r.radius_at(70.0) < 25.0
                });
                wrong += usize::from(!holds);
            }
        }
        // Long afterwards the contact is out of view; its region remains and is no wider.
        for k in 140..600 {
            from.x = 0.75 * f64::from(k);
            tracker.observe(&sonar.scan(&[], &from, 0.0, 0.5 * f64::from(k), &mut random));
        }
        let kept = tracker.at(300.0).iter().any(|r| {
            let offset_m = (r.centre.xy() - gear.centre.xy()).norm();
            offset_m + 5.0 <= r.radius_at(1e5) && r.exists_at(1e5) && r.radius_at(1e5) < 20.0
        });
        wrong += usize::from(!kept);
    }
    assert!(wrong <= 1, "{wrong} of 80");
}

#[test]
fn the_near_face_of_a_farm_larger_than_the_range_is_bounded() {
    let (sonar, settings) = (Sonar::default(), TrackerSettings::default());
    let farm = Region::cylinder(Point3::new(260.0, 20.0, 0.0), 150.0, 0.0, 40.0);
    let (mut open, mut looks) = (0, 0);
    for seed in 0..40 {
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        let mut random = Seed(seed).stream(0);
        for k in 0..100 {
            let (time_s, from) = (
                0.5 * f64::from(k),
                Point3::new(0.75 * f64::from(k), 0.0, 20.0),
            );
            tracker.observe(&sonar.scan(&[farm], &from, 0.0, time_s, &mut random));
            let gap_m = farm.distance_m(&TimedPoint::new(from, time_s));
            if gap_m > 60.0 {
                continue;
            }
            // One metre behind the face, straight ahead.
            let towards = (farm.centre.xy() - from.xy()).normalize() * (gap_m + 1.0);
            let face =
                TimedPoint::new(from + Vector3::new(towards.x, towards.y, 0.0), time_s + 5.0);
            looks += 1;
            open += usize::from(
                !tracker
                    .at(time_s)
                    .iter()
                    .any(|r| r.distance_m(&face) <= 0.0),
            );
        }
    }
    assert!(
        looks > 1000 && open * 100 < looks,
        "open in {open} of {looks} looks"
    );
}

#[test]
fn gear_at_rest_ahead_covers_little_sea_while_there_is_time_to_see_it_better() {
    let (sonar, settings) = (Sonar::default(), TrackerSettings::default());
    let (mut wide, mut looks) = (0, 0);
    for seed in 0..100 {
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        let mut random = Seed(seed).stream(0);
        let gear = Region::cylinder(Point3::new(100.0, 4.0, 0.0), 5.0, 0.0, 60.0);
        // At 1.5 m/s until 65 m before it.
        for k in 0..40 {
            let from = Point3::new(0.75 * f64::from(k), 0.0, 20.0);
            let time_s = 0.5 * f64::from(k);
            tracker.observe(&sonar.scan(&[gear], &from, 0.0, time_s, &mut random));
            for region in tracker.contacts(time_s) {
                let end_s = region.until_s.min(time_s + 120.0);
                looks += 1;
                wide += usize::from(region.radius_at(end_s) > 50.0);
            }
        }
    }
    // It may be fast for all that a few echoes tell.
    assert!(looks > 1000 && wide * 16 < looks, "{wide} of {looks}");
}

/// The share of predictions that contain a contact which the vehicle approaches at 0.5 m/s: 15 s ahead, and 5 s ahead
/// while it is young.
#[test]
fn moving_contacts_ahead_of_the_forward_sonar_are_bounded() {
    let (sonar, settings) = (Sonar::default(), TrackerSettings::default());
    let (mut held, mut looks, mut radius) = (0.0, 0.0, 0.0);
    for seed in 0..200 {
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        let mut random = Seed(seed).stream(0);
        let mut boat = Region::ball(Point3::new(80.0, 0.0, 20.0), 3.0);
        boat.velocity_mps = normal_vector(&mut random) * 0.3;
        boat.velocity_mps.z = 0.0;
        for k in 0..60 {
            boat.at_s = 0.5 * f64::from(k);
            let from = Point3::new(0.5 * boat.at_s, 0.0, 20.0);
            tracker.observe(&sonar.scan(&[boat], &from, 0.0, boat.at_s, &mut random));
            let young = tracker.tracks().iter().any(Track::is_young);
            if k >= 20 {
                let at_s = boat.at_s + if young { 5.0 } else { 15.0 };
                let bound = tracker.at(boat.at_s).into_iter().find(|r| {
                    let offset = (r.centre_at(at_s) - boat.centre_at(at_s)).xy().norm();
                    r.exists_at(at_s) && offset + 3.0 <= r.radius_at(at_s)
                });
                looks += 1.0;
                held += f64::from(u8::from(bound.is_some()));
                radius += bound.map_or(0.0, |r| r.radius_at(at_s));
            }
            boat.centre += boat.velocity_mps * 0.5;
        }
    }
    assert!(looks > 7500.0, "{looks}");
    assert!(held / looks > 0.99, "{} of {looks}", held / looks);
    assert!(
        radius / held < 20.0,
        "regions of {} m on average",
        radius / held
    );
}
