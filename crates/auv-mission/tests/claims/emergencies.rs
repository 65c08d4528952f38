//! A vehicle with water in it, or that can follow nothing any more, gives the mission up as its ladder says.

use crate::flight::{Flight, fly, mission};
use auv_mission::{AbortReason, Contingency, Emergency, EmergencyCause, Event, Outcome};
use auv_planning::Vehicle;

/// Tells the event once, in the middle of the first leg.
fn told(event: Event, emergencies: &[Emergency], vehicle: Vehicle) -> Flight {
    let mut mission = mission(vehicle, 6e3);
    mission.emergencies = emergencies.to_vec();
    let mut open = Some(event);
    let middle_s = 400.0 / vehicle.speed_mps;
    fly(
        mission,
        |_| 0.0,
        move |_, here| {
            let is_due = here.time_s > middle_s;
            open.take_if(|_| is_due)
        },
    )
}

#[test]
fn a_leak_or_a_lost_drive_ends_the_mission_at_the_surface() {
    for vehicle in [Vehicle::default(), Vehicle::paper()] {
        for (event, reason) in [
            (Event::Leak, AbortReason::Leak),
            (Event::CannotFollow, AbortReason::CannotFollow),
        ] {
            let flight = told(event, &[], vehicle);
            let synchroniser = &flight.synchroniser;
            assert_eq!(synchroniser.outcome(), Some(Outcome::Aborted(reason)));
            assert_eq!(synchroniser.contingency(), Some(Contingency::Surface));
            let last = flight.track.last().unwrap();
            assert!(last.position.z < 0.1, "{last:?}");
            // It goes up at once: no waypoint is reached any more.
            assert_eq!(synchroniser.visited().len(), 1);
            assert_eq!(flight.surfacings(), 1);
        }
    }
}

#[test]
fn the_ladder_of_its_cause_is_flown() {
    let leak = Emergency {
        when: EmergencyCause::Leak,
        within: None,
        ladder: vec![Contingency::ReturnAlongTrack],
    };
    let flight = told(Event::Leak, std::slice::from_ref(&leak), Vehicle::default());
    assert_eq!(
        flight.synchroniser.contingency(),
        Some(Contingency::ReturnAlongTrack)
    );
    let (first, last) = (
        flight.track[0].position,
        flight.track.last().unwrap().position,
    );
    assert!((first - last).norm() < 1.0, "back at the start: {last:?}");
    assert_eq!(flight.surfacings(), 0);
    // Of another cause it is not.
    let flight = told(Event::CannotFollow, &[leak], Vehicle::default());
    assert_eq!(
        flight.synchroniser.contingency(),
        Some(Contingency::Surface)
    );
}
