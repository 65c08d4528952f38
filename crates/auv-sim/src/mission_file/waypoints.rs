//! The waypoints of a mission file, and which of them are its ends.

use super::document::MissionFile;
use super::network::node_of;
use super::places;
use auv_ocean::LocalFrame;
use auv_types::{Point3, Violations};
use std::collections::BTreeSet;

/// Waypoints nearer to each other than this are at one place, metres.
const ONE_PLACE_M: f64 = 0.01;

impl MissionFile {
    /// All waypoints in local metres. Empty and repeated names are violations.
    pub(super) fn points(
        &self,
        frame: Option<&LocalFrame>,
        violations: &mut Violations,
    ) -> Vec<Point3<f64>> {
        violations.require(!self.waypoints.is_empty(), "waypoints", || {
            "is empty; give at least start and destination".into()
        });
        let mut names = BTreeSet::new();
        for (i, waypoint) in self.waypoints.iter().enumerate() {
            let fresh = names.insert(&waypoint.name) && !waypoint.name.is_empty();
            violations.require(fresh, &format!("waypoints[{i}].name"), || {
                match waypoint.name.as_str() {
                    "" => "is empty; give another".into(),
                    name => format!("is \"{name}\", a name that is taken; give another"),
                }
            });
        }
        self.waypoints
            .iter()
            .enumerate()
            .map(|(i, waypoint)| {
                let place = format!("waypoints[{i}] ({})", waypoint.name);
                places::point(&waypoint.at, frame, &place, violations)
            })
            .collect()
    }

    /// What is told of waypoints at one place, which may be slips of the pen: two that the file gives, but for the start
    /// at a dock.
    pub(super) fn told_of_one_place(&self, points: &[Point3<f64>]) -> Vec<String> {
        let given: Vec<_> = self.waypoints.iter().zip(points).collect();
        let is_end = |name: &str| {
            let docks = self.docks.iter().flatten().chain(&self.destination);
            self.start == name || docks.into_iter().any(|dock| dock == name)
        };
        let mut told = Vec::new();
        for (i, (one, at)) in given.iter().enumerate() {
            let others = given[..i].iter();
            let mut others = others.filter(|(other, _)| one.line.is_none() && other.line.is_none());
            let same = others.find(|(other, place)| {
                let ends = is_end(&one.name) && is_end(&other.name);
                !ends && (*place - *at).norm() < ONE_PLACE_M
            });
            if let Some((other, _)) = same {
                told.push(format!(
                    "waypoints {} and {} are at one place; where one is meant to be elsewhere, correct its at; several tasks at one waypoint go into its tasks",
                    other.name, one.name
                ));
            }
        }
        told
    }

    /// Start and dock, and where else the vehicle may dock.
    pub(super) fn ends(&self, violations: &mut Violations) -> Option<([usize; 2], Vec<usize>)> {
        let mut node = |name: &str, key: &str| {
            let node = node_of(self, name);
            violations.require(node.is_some(), key, || {
                format!("names the waypoint {name}, which does not exist; correct the name")
            });
            node
        };
        let start = node(&self.start, "start");
        let (key, names) = match (&self.destination, &self.docks) {
            (Some(name), None) => ("destination", std::slice::from_ref(name)),
            (None, Some(names)) if !names.is_empty() => ("docks", &names[..]),
            (None, Some(_)) => {
                violations.push(
                    "docks",
                    "is empty; name the waypoints where the vehicle may dock",
                );
                return None;
            }
            (Some(_), Some(_)) => {
                violations.push("docks", "are given beside destination; keep one");
                return None;
            }
            (None, None) => {
                violations.push(
                    "destination",
                    "is missing; name the waypoint where the vehicle docks, or several in docks",
                );
                return None;
            }
        };
        let docks: Option<Vec<usize>> = names.iter().map(|name| node(name, key)).collect();
        let (start, docks) = start.zip(docks)?;
        violations.require(!docks.contains(&start), key, || {
            "is the start; for a round trip give a second waypoint at the same place".into()
        });
        let twice = |i: &usize| docks[..*i].contains(&docks[*i]);
        violations.require(!(0..docks.len()).any(|i| twice(&i)), key, || {
            "name a waypoint twice; give it once".into()
        });
        let (&dock, others) = docks.split_first()?;
        Some(([start, dock], others.to_vec()))
    }
}
