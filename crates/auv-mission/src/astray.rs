//! Whether the vehicle follows its trajectories at all.

use crate::mode::{Astray, Leg};
use crate::view::View;

/// A vehicle that keeps to one trajectory for this long follows it, seconds.
const KEPT_S: f64 = 60.0;
/// A vehicle that comes nearer to its target at this share of its speed makes its way all the same.
const LEAST_WAY: f64 = 0.25;

/// How the vehicle follows the trajectories of a leg after an observation.
pub(crate) fn after(view: View<'_>, leg: &Leg) -> Option<Astray> {
    let Some(in_force) = view.in_force() else {
        return leg.astray;
    };
    let now_s = view.now_s();
    if !view.is_on_track() {
        return leg.astray.or_else(|| {
            Some(Astray {
                since_s: now_s,
                away_m: away_m(view, leg),
            })
        });
    }
    let kept = now_s - in_force.start().time_s >= KEPT_S;
    leg.astray.filter(|_| !kept)
}

/// Whether it has left its trajectories for so long, without coming nearer to the target, that it cannot follow
/// any.
pub(crate) fn cannot_follow(view: View<'_>, leg: &Leg) -> bool {
    leg.astray.is_some_and(|astray| {
        let lasts_s = view.now_s() - astray.since_s;
        let least_m = LEAST_WAY * view.mission.vehicle.speed_mps * lasts_s;
        let nearer_m = astray.away_m - away_m(view, leg);
        lasts_s > view.settings.watchdogs.cannot_follow_s && nearer_m < least_m
    })
}

fn away_m(view: View<'_>, leg: &Leg) -> f64 {
    (view.mission.position_of(leg.to) - view.beliefs().position).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{Fixture, way};

    /// Beside a trajectory that begins now, `off_m` off its place.
    fn seen(before: Option<Astray>, time_s: f64, x: f64, off_m: f64, flown_s: f64) -> Fixture {
        let begins_s = time_s - flown_s;
        let mut fixture = Fixture::new().at(time_s, x);
        let from = x + off_m - 3.0 * flown_s;
        fixture.state.in_force =
            Some(way(&[(from, begins_s), (from + 900.0, begins_s + 300.0)]).into());
        fixture.leg_mut().astray = before;
        fixture
    }

    #[test]
    fn a_vehicle_that_leaves_every_trajectory_and_gets_nowhere_cannot_follow() {
        let mut astray = None;
        for k in 0..62 {
            let time_s = 10.0 * f64::from(k);
            let off_m = if k % 2 == 0 { 20.0 } else { 0.0 };
            let fixture = seen(astray, time_s, 100.0, off_m, 5.0);
            let late = time_s > 600.0;
            assert_eq!(
                astray.is_some() && fixture.ask(cannot_follow),
                late,
                "{time_s} s"
            );
            astray = fixture.ask(after);
            assert_eq!(astray.unwrap().away_m, 800.0);
        }
        // Nearer by 500 m of 1,830 m it could have made.
        assert!(!seen(astray, 610.0, 600.0, 20.0, 5.0).ask(cannot_follow));
        let kept = seen(astray, 610.0, 100.0, 0.0, 60.0);
        assert_eq!(kept.ask(after), None);
    }
}
