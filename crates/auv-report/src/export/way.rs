//! The points of routes and tracks.

use crate::places::place_at;
use crate::record::MissionPicture;
use auv_graph::NodeId;
use auv_mission::{Mission, RouteCall};
use auv_obstacles::TimedPoint;
use auv_types::Point3;

/// The points of a route: its nodes, and between them the corners of detours round land.
pub(super) fn way(
    mission: &Mission,
    nodes: &[NodeId],
    here: Option<Point3<f64>>,
) -> Vec<(Point3<f64>, Option<NodeId>)> {
    let mut places = Vec::new();
    for (i, &node) in nodes.iter().enumerate() {
        let before = i.checked_sub(1).map(|before| nodes[before]);
        let arc = before.and_then(|before| mission.network.arc_between(before, node));
        if let Some([_, between @ .., _]) = arc
            .and_then(|arc| mission.guides.get(&arc))
            .map(Vec::as_slice)
        {
            places.extend(between.iter().map(|point| (*point, None)));
        }
        if mission.network.has_node(node) {
            places.push((mission.position_of(node), Some(node)));
        } else if let Some(here) = here {
            places.push((here, Some(node)));
        }
    }
    places
}

/// The points of a route call, which may start at the vehicle.
pub(super) fn way_of_call(
    picture: &MissionPicture,
    mission: &Mission,
    call: &RouteCall,
) -> Vec<Point3<f64>> {
    let here = place_at(&picture.track, call.at_s);
    let way = way(mission, &call.route, here);
    way.into_iter().map(|(point, _)| point).collect()
}

/// How far a thinned track may be from the flown one, metres.
pub(super) const EXACT_M: f64 = 0.1;

/// The track without redundant points. Between two points kept, the vehicle was never farther than
/// `exact_m` from where it would have been at constant velocity.
pub(super) fn thinned(track: &[TimedPoint], exact_m: f64) -> Vec<TimedPoint> {
    let rows: Vec<_> = track
        .iter()
        .map(|p| [p.time_s, p.position.x, p.position.y, p.position.z])
        .collect();
    crate::thin::thinned(&rows, exact_m)
        .into_iter()
        .map(|[time_s, x, y, z]| TimedPoint::new(Point3::new(x, y, z), time_s))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::flown;
    use super::*;

    #[test]
    fn a_thinned_track_keeps_its_ends_and_stays_within_ten_centimetres() {
        let track = flown().track;
        let kept = thinned(&track, EXACT_M);
        assert_eq!(kept.first(), track.first());
        assert_eq!(kept.last(), track.last());
        assert!(kept.len() < track.len());
        for p in &track {
            let at = place_at(&kept, p.time_s).unwrap();
            assert!((at - p.position).norm() < 0.1 + 1e-9, "at {} s", p.time_s);
        }
    }
}
