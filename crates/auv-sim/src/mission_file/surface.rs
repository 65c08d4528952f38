//! `[surface]` of a mission file.

use super::document::MissionFile;
use super::network::node_of;
use auv_graph::NodeId;
use auv_mission::Surfacing;
use auv_types::Violations;

impl MissionFile {
    /// How often the vehicle surfaces for a fix.
    pub(super) fn surfacing(&self) -> Option<Surfacing> {
        self.surface.as_ref().map(|entry| Surfacing {
            every_s: entry.every_s,
            at_most_s: entry.at_most_s,
        })
    }

    fn fix_place_names(&self) -> &[String] {
        let places = self
            .surface
            .as_ref()
            .and_then(|entry| entry.places.as_ref());
        places.map_or(&[], Vec::as_slice)
    }

    /// Where it does.
    pub(super) fn fix_places(&self) -> Vec<NodeId> {
        let names = self.fix_place_names().iter();
        let nodes = names.filter_map(|name| node_of(self, name));
        nodes.map(|i| NodeId(i as u32)).collect()
    }

    /// What is wrong with the names of those places.
    pub(super) fn check_fix_places(&self, violations: &mut Violations) {
        let places = self
            .surface
            .as_ref()
            .and_then(|entry| entry.places.as_ref());
        violations.require(
            places.is_none_or(|names| !names.is_empty()),
            "surface.where",
            || "is empty; name waypoints, or leave it out".into(),
        );
        for (i, name) in self.fix_place_names().iter().enumerate() {
            let known = node_of(self, name).is_some();
            violations.require(known, &format!("surface.where[{i}]"), || {
                format!("names the waypoint {name}, which does not exist; correct the name")
            });
        }
    }
}
