//! Positions that several pictures of a mission use.

use crate::draw::palette::{self, Colour};
use crate::record::MissionPicture;
use auv_graph::NodeId;
use auv_mission::Mission;
use auv_obstacles::TimedPoint;
use auv_types::Point3;

/// Colours of legs, in turn; obstacles have other colours.
pub(crate) const LEGS: [Colour; 4] = [
    palette::BLUE,
    palette::VERMILLION,
    palette::GREEN,
    palette::BLACK,
];

/// East and north.
pub(crate) fn flat(p: &Point3<f64>) -> (f64, f64) {
    (p.y, p.x)
}

/// All waypoints and the track.
pub(crate) fn places<'a>(
    picture: &'a MissionPicture,
    mission: &'a Mission,
) -> Vec<&'a Point3<f64>> {
    let waypoints = mission.network.waypoints().iter().map(|w| &w.position);
    waypoints
        .chain(picture.track.iter().map(|p| &p.position))
        .collect()
}

/// The ranges of east and north that the plan view has to show, metres.
pub(crate) fn extent(picture: &MissionPicture, mission: &Mission) -> ((f64, f64), (f64, f64)) {
    let places = places(picture, mission);
    let range = |value: &dyn Fn(&Point3<f64>) -> f64| {
        let low = places
            .iter()
            .map(|p| value(p))
            .fold(f64::INFINITY, f64::min);
        let high = places
            .iter()
            .map(|p| value(p))
            .fold(f64::NEG_INFINITY, f64::max);
        let room = 0.04 * (high - low) + 50.0;
        (low - room, high + room)
    };
    (range(&|p| p.y), range(&|p| p.x))
}

/// The current in the middle of the plan view at the start, (east, north) in m/s.
pub(crate) fn water(
    picture: &MissionPicture,
    east: (f64, f64),
    north: (f64, f64),
) -> Option<(f64, f64)> {
    let current = picture.setting.as_ref()?.current.as_ref()?;
    let middle = Point3::new(0.5 * (north.0 + north.1), 0.5 * (east.0 + east.1), 10.0);
    let water = current.velocity_at(&middle, 0.0);
    Some((water.y, water.x))
}

/// A waypoint's name. A place that is not a waypoint is the vehicle's own: `here`.
pub(crate) fn name_of(mission: &Mission, node: NodeId) -> String {
    if mission.network.has_node(node) {
        mission.name_of(node)
    } else {
        "here".into()
    }
}

/// Where the vehicle was, by the points of a track about that time.
pub(crate) fn place_at(track: &[TimedPoint], time_s: f64) -> Option<Point3<f64>> {
    let next = track.partition_point(|p| p.time_s < time_s);
    let b = track.get(next).or(track.last())?;
    let a = &track[next.saturating_sub(1).min(track.len() - 1)];
    let whole_s = b.time_s - a.time_s;
    let share = if whole_s > 0.0 {
        ((time_s - a.time_s) / whole_s).clamp(0.0, 1.0)
    } else {
        0.0
    };
    Some(a.position + (b.position - a.position) * share)
}

/// The pieces of the track by leg: colour, and indices of its points.
pub(crate) fn pieces(picture: &MissionPicture) -> Vec<(Colour, std::ops::Range<usize>)> {
    let track = &picture.track;
    let at = |time_s: f64| track.partition_point(|p| p.time_s < time_s - 1e-6);
    let mut pieces: Vec<_> = (0..picture.legs.len())
        .map(|k| {
            let end = (at(picture.leg_end_s(k)) + 1).min(track.len());
            (LEGS[k % LEGS.len()], at(picture.legs[k].at_s).min(end)..end)
        })
        .collect();
    if pieces.is_empty() {
        pieces.push((LEGS[0], 0..track.len()));
    }
    pieces
}

/// The name of a fence without its place in the mission file: `ice` of `keep_out[0] (ice)`.
pub(crate) fn short_name(name: &str) -> &str {
    let inner = name.split_once("] (").map(|(_, inner)| inner);
    inner
        .and_then(|inner| inner.strip_suffix(')'))
        .unwrap_or(name)
}
