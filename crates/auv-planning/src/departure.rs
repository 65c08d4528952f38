//! How a vehicle with a turn radius or a pitch limit leaves a place. Path planners begin their trajectories
//! with these.

use crate::PathProblem;
use crate::motion::{Connection, ConnectionEnd, ConnectionStart, Pose, connections_between};
use auv_types::Point3;
use std::f64::consts::FRAC_PI_2;

/// What is flown before the rest of a path begins: turns, and circles that change depth.
#[derive(Clone, Debug, PartialEq)]
pub struct DepartureManoeuvre {
    /// From the start on, without `end`.
    pub corners: Vec<Point3<f64>>,
    /// Where the rest begins.
    pub end: Point3<f64>,
    /// When the rest begins in still water, seconds.
    pub end_s: f64,
    /// The connection that it is the beginning of; `None`: the rest begins at the start.
    connection: Option<Connection>,
}

impl DepartureManoeuvre {
    /// The rest begins at the start.
    #[must_use]
    pub fn none(problem: &PathProblem<'_>) -> Self {
        Self {
            corners: Vec::new(),
            end: problem.start,
            end_s: problem.departure_s,
            connection: None,
        }
    }

    /// A connection up to the straight that it ends with; `None` if it ends with a turn.
    fn of(problem: &PathProblem<'_>, connection: Connection) -> Option<Self> {
        let (corners, rest) = connection.points.split_at(connection.straight_from?);
        let (&end, _) = rest.split_first()?;
        let corners = corners.to_vec();
        let flown = connection.points[..=corners.len()].windows(2);
        let length_m: f64 = flown.map(|pair| (pair[1] - pair[0]).norm()).sum();
        Some(Self {
            corners,
            end,
            end_s: problem.departure_s + length_m / problem.vehicle.speed_mps,
            connection: Some(connection),
        })
    }

    /// The whole way to the place that it was made for, straight at its end.
    #[must_use]
    pub fn whole(&self) -> Option<&Connection> {
        self.connection.as_ref()
    }

    /// The same turns to another place; `None` if they do not lead there.
    #[must_use]
    pub fn towards(&self, problem: &PathProblem<'_>, place: Point3<f64>) -> Option<Self> {
        let kind = self.connection.as_ref()?.kind;
        let aimed = PathProblem {
            target: place,
            ..*problem
        };
        let found = connections_to_target(&aimed).into_iter();
        let mut same = found.filter(|found| found.kind == kind);
        same.find_map(|found| Self::of(problem, found))
    }
}

/// The connections from the start of a problem to its target in still, empty water, shortest first: all that
/// [`connections_between`] finds.
#[must_use]
pub fn connections_to_target(problem: &PathProblem<'_>) -> Vec<Connection> {
    let place = problem.start;
    let pose = |direction| ConnectionStart::Pose(Pose { place, direction });
    let from = problem
        .start_velocity
        .map_or(ConnectionStart::Place(place), pose);
    connections_between(problem.vehicle, from, ConnectionEnd::Place(problem.target))
}

/// Departures in the order in which they are to be tried: the beginnings of the connections to the target,
/// shortest first. A vehicle that turns on the spot and pitches freely leaves straight away.
#[must_use]
pub fn departures(problem: &PathProblem<'_>) -> Vec<DepartureManoeuvre> {
    let vehicle = problem.vehicle;
    if vehicle.turn_radius_m <= 0.0 && vehicle.max_pitch_rad >= FRAC_PI_2 {
        return vec![DepartureManoeuvre::none(problem)];
    }
    let connections = connections_to_target(problem).into_iter();
    let mut found: Vec<_> = connections
        .filter_map(|connection| DepartureManoeuvre::of(problem, connection))
        .collect();
    if found.is_empty() {
        found.push(DepartureManoeuvre::none(problem));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vehicle;
    use auv_types::Vector3;

    fn leg(vehicle: &Vehicle, velocity: Option<Vector3<f64>>, depth_m: f64) -> PathProblem<'_> {
        PathProblem {
            start_velocity: velocity,
            departure_s: 60.0,
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 10.0),
                Point3::new(400.0, 0.0, depth_m),
                vehicle,
            )
        }
    }

    #[test]
    fn a_free_vehicle_leaves_straight_away() {
        let vehicle = Vehicle::paper();
        let problem = leg(&vehicle, Some(Vector3::new(-3.0, 0.0, 0.0)), 90.0);
        assert_eq!(departures(&problem), [DepartureManoeuvre::none(&problem)]);
        // So does one at rest where the target is not too steep.
        let vehicle = Vehicle::default();
        let problem = leg(&vehicle, None, 90.0);
        let found = departures(&problem);
        assert_eq!(
            (found.len(), found[0].end, found[0].end_s),
            (1, problem.start, 60.0)
        );
    }

    #[test]
    fn departures_end_on_the_straight_to_their_target() {
        let vehicle = Vehicle::default();
        for velocity in [(0.0, 1.5), (-1.5, 0.1), (1.5, 0.0)] {
            for depth_m in [10.0, 60.0, 300.0] {
                let velocity = Some(Vector3::new(velocity.0, velocity.1, 0.0));
                let problem = leg(&vehicle, velocity, depth_m);
                let found = departures(&problem);
                assert!(found.len() >= 2);
                for departure in &found {
                    let whole = departure.whole().unwrap();
                    let rest = problem.target - departure.end;
                    let last = whole.points.len() - 1;
                    let arrival = whole.points[last] - whole.points[last - 1];
                    assert!(rest.xy().normalize().dot(&arrival.xy().normalize()) > 1.0 - 1e-6);
                    let other = Point3::new(300.0, 150.0, depth_m);
                    let aimed = departure.towards(&problem, other);
                    assert!(aimed.is_none_or(|aimed| aimed.whole().unwrap().kind == whole.kind));
                }
                assert!(found.is_sorted_by_key(|found| found.whole().map(|w| w.length_m as u64)));
            }
        }
    }
}
