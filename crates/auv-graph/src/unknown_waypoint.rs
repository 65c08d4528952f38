//! A waypoint asked for by a name that the network does not have.

use crate::NodeId;
use crate::network::Network;

/// The network has no waypoint of this name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no waypoint is named `{name}`; {}", in_words(names, *more))]
pub struct UnknownWaypoint {
    /// The name asked for.
    pub name: String,
    /// The names of the first named waypoints, at most [`UnknownWaypoint::LISTED`].
    pub names: Vec<String>,
    /// How many named waypoints are not among `names`.
    pub more: usize,
}

impl UnknownWaypoint {
    /// How many names are listed.
    pub const LISTED: usize = 8;
}

fn in_words(names: &[String], more: usize) -> String {
    if names.is_empty() {
        return "none has a name: give names with `Waypoint::named`".into();
    }
    let list = names.join("`, `");
    match more {
        0 => format!("give one of `{list}`"),
        _ => format!("give one of `{list}` or of {more} more"),
    }
}

impl Network {
    /// The first waypoint of that name.
    ///
    /// # Errors
    /// The name, and the names there are.
    pub fn waypoint(&self, name: &str) -> Result<NodeId, UnknownWaypoint> {
        self.find(name).ok_or_else(|| {
            let names = self.waypoints().iter().map(|waypoint| &waypoint.name);
            let mut names = names.filter(|name| !name.is_empty());
            UnknownWaypoint {
                name: name.into(),
                names: names
                    .by_ref()
                    .take(UnknownWaypoint::LISTED)
                    .cloned()
                    .collect(),
                more: names.count(),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::{Network, NodeId, Waypoint};
    use auv_types::Point3;

    fn refusal(names: impl IntoIterator<Item = String>) -> String {
        let place = Point3::origin();
        let waypoints: Vec<_> = names
            .into_iter()
            .map(|n| Waypoint::named(n, place))
            .collect();
        let network = Network::new(&waypoints, &[], 1.0).unwrap();
        network.waypoint("dok").unwrap_err().to_string()
    }

    #[test]
    fn an_unknown_name_is_told_with_the_names_there_are() {
        let network = Network::builder(1.0)
            .waypoint("ramp", [0.0; 3])
            .waypoint("dock", [9.0; 3])
            .build()
            .unwrap();
        assert_eq!(network.waypoint("dock"), Ok(NodeId(1)));
        let two = ["ramp", "dock"].map(String::from);
        assert_eq!(
            refusal(two),
            "no waypoint is named `dok`; give one of `ramp`, `dock`"
        );
        let many = refusal((0..10).map(|i| format!("w{i}")));
        assert!(many.ends_with("`w6`, `w7` or of 2 more"), "{many}");
        assert!(refusal([String::new()]).contains("none has a name"));
    }
}
