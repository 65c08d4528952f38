//! Legs that are flown along a given line, or arrive in a given direction.

use crate::Mission;
use crate::approach::{along, arriving, places_of};
use crate::mode::Leg;
use crate::question::PathQuestion;
use crate::view::View;
use auv_graph::{ArcId, NodeId};
use auv_planning::{Arrival, PathProblem, Trajectory};
use auv_types::Point3;

impl Mission {
    /// How a leg to a waypoint, along an arc if it follows one, must arrive.
    pub(crate) fn arrival(&self, arc: Option<ArcId>, to: NodeId) -> Option<Arrival> {
        if arc.is_some_and(|arc| self.courses.lines.contains(&arc)) {
            return None;
        }
        let at_dock = || self.docking.arrival().filter(|_| self.is_dock(to));
        self.courses.arrivals.get(&to).copied().or_else(at_dock)
    }
}

/// The ways in which a leg can be flown as asked, in order of preference; none where nothing is asked. `path` is
/// the planner's answer.
pub(crate) fn ways(
    view: View<'_>,
    (leg, question): (&Leg, &PathQuestion),
    asked: &PathProblem<'_>,
    path: &Trajectory,
) -> Vec<Trajectory> {
    if question.stand_off.is_some() {
        return Vec::new();
    }
    let arc = view.mission.network.arc_between(leg.from, leg.to);
    if let Some(arc) = arc.filter(|arc| view.mission.courses.lines.contains(arc)) {
        return along(asked, line(view, arc, asked));
    }
    let arrival = view.mission.arrival(arc, leg.to);
    arrival.map_or(Vec::new(), |arrival| {
        arriving(asked, &places_of(path), &arrival)
    })
}

/// The rest of an arc's line from where it comes nearest to the start of a path, no deeper than the bed as known
/// allows.
fn line(view: View<'_>, arc: ArcId, asked: &PathProblem<'_>) -> Vec<Point3<f64>> {
    let network = &view.mission.network;
    let edge = &network.arcs()[arc.index()];
    let ends = [edge.tail, edge.head].map(|node| view.mission.position_of(node));
    let guide = view
        .mission
        .guides
        .get(&arc)
        .map_or(&ends[..], Vec::as_slice);
    let mut places = rest_of(guide, &asked.start);
    for place in &mut places {
        place.z = place.z.min(asked.deepest_at(place.x, place.y));
    }
    if let Some(last) = places.last_mut() {
        *last = asked.target;
    }
    places
}

/// A polyline from where it comes nearest to a place.
pub(crate) fn rest_of(guide: &[Point3<f64>], place: &Point3<f64>) -> Vec<Point3<f64>> {
    let nearest = |pair: &[Point3<f64>]| {
        let piece = pair[1] - pair[0];
        let share = (place - pair[0]).dot(&piece) / piece.norm_squared().max(1e-9);
        pair[0] + piece * share.clamp(0.0, 1.0)
    };
    let away_m = |k: usize| (nearest(&guide[k..k + 2]) - place).norm();
    let pieces = 0..guide.len().saturating_sub(1);
    let Some(piece) = pieces.min_by(|&a, &b| away_m(a).total_cmp(&away_m(b))) else {
        return guide.to_vec();
    };
    let mut rest = vec![nearest(&guide[piece..piece + 2])];
    rest.extend_from_slice(&guide[piece + 1..]);
    rest
}
