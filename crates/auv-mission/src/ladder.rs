//! The first contingency that can be flown, and its trajectory.

use crate::Contingency;
use crate::leads::turn_towards;
use crate::mode::Mode;
use crate::path_question::own_problem;
use crate::state::InForce;
use crate::station_keeping::{level_heading, stays};
use crate::surfacing::surface;
use crate::view::View;
use crate::way_on::way_on;
use crate::{check, reflex};
use auv_planning::polyline::rounded;
use auv_planning::{PathProblem, Trajectory};
use auv_types::Point3;

/// Corrections of the turn onto a line.
const TURN_CORRECTIONS: u32 = 10;

/// The first contingency of the ladder that can be flown, with its trajectory. If none can be flown:
/// an evasive trajectory without a contingency. `None` if the ladder is empty (no evasion is tried), or
/// if no evasion is found either.
pub(crate) fn seek(view: View<'_>) -> Option<(Option<Contingency>, InForce)> {
    let ladder = match &view.state.mode {
        Mode::Contingency(state) => view.mission.ladder(state.reason, &view.beliefs().position),
        _ => &view.mission.contingencies,
    };
    let flyable = ladder
        .iter()
        .find_map(|&contingency| Some((Some(contingency), manoeuvre(view, contingency)?)));
    flyable.or_else(|| {
        if ladder.is_empty() {
            return None;
        }
        reflex::evasion(view).map(|evasion| (None, evasion))
    })
}

/// A trajectory of a contingency from here that is flyable and clear, if there is one. At the surface the
/// vehicle drifts, circles can be repeated; at the end of a track there must be a way on.
fn manoeuvre(view: View<'_>, contingency: Contingency) -> Option<InForce> {
    match contingency {
        Contingency::Surface => Some(InForce::new(surface(view)?, None)),
        Contingency::ReturnAlongTrack => return_along_track(view),
        Contingency::Loiter { for_s } => {
            let request = own_problem(view);
            let problem = request.problem();
            let mut stays = stays(&problem, view.here(), view.beliefs().velocity, for_s);
            let flown = stays.find(|way| is_free(view, &problem, way))?;
            Some(InForce::new(flown, None))
        }
    }
}

fn return_along_track(view: View<'_>) -> Option<InForce> {
    let request = own_problem(view);
    let problem = request.problem();
    let tracks = tracks_back(view);
    let mut flown = tracks
        .iter()
        .filter_map(|points| problem.timed(points).ok());
    let flown = flown.find(|way| is_free(view, &problem, way))?;
    let (end, velocity) = (flown.end(), flown.end_velocity());
    let way_on = way_on(&problem, end, velocity, view.way_on_s())?;
    Some(InForce::new(flown, Some(&way_on)))
}

/// Whether the vehicle can fly a trajectory, and it stays clear over the look-ahead time.
fn is_free(view: View<'_>, problem: &PathProblem<'_>, way: &Trajectory) -> bool {
    let until_s = view.now_s() + view.settings.margins.lookahead_s;
    view.is_clear(way, until_s, 0.0) && check::is_flyable(problem, way)
}

/// Two polylines from here through the waypoints reached, last first, to the start: one with the first
/// turn to the right, one to the left.
fn tracks_back(view: View<'_>) -> Vec<Vec<Point3<f64>>> {
    let mission = view.mission;
    let mut back = Vec::new();
    let mut later = None;
    for &node in view.state.ledger.visited.iter().rev() {
        let arc = later.and_then(|later| mission.network.arc_between(node, later));
        let guide = arc.and_then(|arc| mission.guides.get(&arc));
        back.extend(guide.into_iter().flat_map(|way| way.iter().rev().copied()));
        back.push(mission.position_of(node));
        later = Some(node);
    }
    let turn_m = mission.vehicle.turn_radius_m;
    let (here, velocity) = (view.beliefs().position, view.beliefs().velocity);
    let from = |side: f64| {
        let mut points = vec![here];
        if turn_m > 0.0 && velocity.norm() > 0.0 {
            // The turn must end on the line to the next point; a few corrections find it.
            let mut turned = here;
            for _ in 0..TURN_CORRECTIONS {
                let direction = back[0] - turned;
                points.truncate(1);
                points.extend(turn_towards(here, velocity, &direction, side * turn_m));
                turned = points[points.len() - 1];
            }
        }
        // Level for a moment, so that a climb or dive can start gently.
        let end = points[points.len() - 1];
        let level = level_heading(&(back[0] - end)) * turn_m;
        let corners: Vec<_> = [end, end + level].into_iter().chain(back.clone()).collect();
        points.extend(rounded(&corners, turn_m).into_iter().skip(1));
        points
    };
    vec![from(1.0), from(-1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{Fixture, place};
    use auv_graph::NodeId;
    use auv_obstacles::Region;
    use auv_planning::Vehicle;
    use auv_types::Vector3;

    const LOITER: Contingency = Contingency::Loiter { for_s: 900.0 };

    /// At 450 m, under way north; waypoint 0 was reached.
    fn under_way(vehicle: Vehicle, contingencies: &[Contingency]) -> Fixture {
        let mut fixture = Fixture::new().at(150.0, 450.0);
        fixture.mission.vehicle = vehicle;
        fixture.mission.contingencies = contingencies.to_vec();
        fixture.state.beliefs.velocity = Vector3::x() * vehicle.speed_mps;
        fixture
    }

    fn sought(fixture: &Fixture) -> (Option<Contingency>, Trajectory) {
        let (flown, in_force) = fixture.view(seek).unwrap();
        (flown, in_force.purpose())
    }

    #[test]
    fn each_contingency_is_flown_by_vehicles_that_hover_and_that_cannot_stop() {
        for vehicle in [Vehicle::paper(), Vehicle::default()] {
            let hovers = vehicle.can_hover();
            let (flown, up) = sought(&under_way(vehicle, &[Contingency::Surface]));
            assert_eq!(flown, Some(Contingency::Surface));
            assert!(up.end().position.z.abs() < 1e-9);
            let aside_m = (up.end().position - place(450.0)).xy().norm();
            assert_eq!(aside_m < 1e-9, hovers);

            let returns = Contingency::ReturnAlongTrack;
            let mut fixture = under_way(vehicle, &[returns]);
            fixture = fixture.at(450.0, 1_350.0);
            fixture.state.ledger.visited.push(NodeId(1));
            let (flown, back) = sought(&fixture);
            assert_eq!(flown, Some(returns));
            assert!((back.end().position - place(0.0)).norm() < 1e-6);
            let nearest_m = |x: f64| {
                let points = back.points().iter().map(|p| (p.position - place(x)).norm());
                points.fold(f64::INFINITY, f64::min)
            };
            assert!(nearest_m(900.0) < 30.0, "{} m", nearest_m(900.0));
            assert!(back.duration_s() < 1.2 * 1_350.0 / vehicle.speed_mps);

            let (flown, stay) = sought(&under_way(vehicle, &[LOITER]));
            assert_eq!(flown, Some(LOITER));
            assert!((stay.duration_s() - 900.0).abs() < 300.0 && stay.duration_s() >= 899.0);
            let farthest_m = stay
                .points()
                .iter()
                .map(|p| (p.position - place(450.0)).norm());
            assert!(farthest_m.fold(0.0, f64::max) < 100.0);
            assert_eq!(stay.length_m() < 1.0, hovers);
        }
    }

    #[test]
    fn the_vehicle_surfaces_whatever_the_top_of_its_box() {
        let mut fixture = under_way(Vehicle::paper(), &[Contingency::Surface]);
        fixture.mission.bounds = Some(auv_types::Bounds::new(
            Point3::new(-1e4, -1e4, 8.0),
            Point3::new(1e4, 1e4, 99.0),
        ));
        assert_eq!(sought(&fixture).1.end().position.z, 0.0);
    }

    #[test]
    fn the_first_of_the_ladder_that_is_clear_is_flown() {
        // A region lies over the vehicle.
        let above = Region::cylinder(place(450.0), 60.0, 0.0, 10.0);
        let ladder = [Contingency::Surface, LOITER];
        let free = under_way(Vehicle::paper(), &ladder);
        assert_eq!(sought(&free).0, Some(Contingency::Surface));
        let covered = free.among(&[above]);
        assert_eq!(sought(&covered).0, Some(LOITER));
        // Nothing is clear here: it evades, and no contingency is flown.
        let around = Region::ball(place(450.0), 60.0);
        let (flown, evasion) = sought(&under_way(Vehicle::paper(), &ladder).among(&[around]));
        assert_eq!(flown, None);
        assert!((evasion.end().position - place(450.0)).norm() > 60.0);
        let none = under_way(Vehicle::paper(), &[]).among(&[around]);
        assert!(none.view(seek).is_none());
    }

    #[test]
    fn a_guide_is_followed_back() {
        let mut fixture = under_way(Vehicle::paper(), &[Contingency::ReturnAlongTrack]);
        fixture = fixture.at(450.0, 1_350.0);
        fixture.state.ledger.visited.push(NodeId(1));
        let arc = fixture.mission.network.arc_between(NodeId(0), NodeId(1));
        let mut corner = place(450.0);
        corner.y = 200.0;
        let guide = vec![place(0.0), corner, place(900.0)];
        fixture.mission.guides.insert(arc.unwrap(), guide);
        let back = sought(&fixture).1;
        let nearest_m = back.points().iter().map(|p| (p.position - corner).norm());
        assert!(nearest_m.fold(f64::INFINITY, f64::min) < 1.0);
        let round_m = 2.0 * (corner - place(0.0)).norm();
        assert!((back.length_m() - (450.0 + round_m)).abs() < 1.0);
    }
}
