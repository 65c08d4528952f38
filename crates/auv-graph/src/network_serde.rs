//! A network as data: its waypoints, edges and speed. Reading checks them as `Network::new` does.

use crate::network::Network;
use crate::waypoint::{Edge, Waypoint};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};
use std::borrow::Cow;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Parts<'a> {
    waypoints: Cow<'a, [Waypoint]>,
    edges: Cow<'a, [Edge]>,
    speed_mps: f64,
}

impl Serialize for Network {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Parts {
            waypoints: self.waypoints().into(),
            edges: self.edges().into(),
            speed_mps: self.speed_mps(),
        }
        .serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Network {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let parts = Parts::deserialize(deserializer)?;
        Self::new(&parts.waypoints, &parts.edges, parts.speed_mps).map_err(D::Error::custom)
    }
}

#[cfg(test)]
mod tests {
    use crate::Network;

    #[test]
    fn a_network_is_read_as_it_was_written_and_a_wrong_one_is_refused() {
        let network = Network::builder(1.5)
            .waypoint("ramp", [0.0, 0.1, 10.0])
            .waypoint("dock", [1.0 / 3.0, 70.0, 10.0])
            .transit("ramp", "dock")
            .build()
            .expect("sound");
        let text = serde_json::to_string(&network).expect("is written");
        let read: Network = serde_json::from_str(&text).expect("is read");
        assert_eq!(read, network);
        let wrong = text.replace("1.5", "-1.5");
        let error = serde_json::from_str::<Network>(&wrong).expect_err("speed below 0");
        assert!(error.to_string().contains("speed"), "{error}");
    }
}
