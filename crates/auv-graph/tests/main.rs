//! Every published instance in the data folder that a network can hold is read, and the best known routes are feasible.

#![cfg(feature = "serde")]
#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "tests fail by panicking and say when they are skipped"
)]

use auv_graph::format;
use auv_graph::{EdgeSet, NodeId, Route};
use std::path::PathBuf;

fn data(folder: &str) -> Option<Vec<PathBuf>> {
    let Ok(root) = std::env::var("AUV_DATA_DIR") else {
        println!("skipped: set AUV_DATA_DIR");
        return None;
    };
    let entries = std::fs::read_dir(PathBuf::from(root).join(folder)).unwrap();
    let mut paths: Vec<_> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    Some(paths)
}

#[test]
fn the_proven_optimum_of_every_route_instance_is_feasible() {
    let Some(paths) = data("routes") else { return };
    let is_optima = |path: &&PathBuf| path.ends_with("optimal.json");
    let optima = std::fs::read(paths.iter().find(is_optima).unwrap()).unwrap();
    let optima: serde_json::Value = serde_json::from_slice(&optima).unwrap();
    for path in paths.iter().filter(|path| !is_optima(path)) {
        let instance = format::read(&std::fs::read(path).unwrap(), "unused").unwrap();
        let optimum = &optima[&instance.name];
        let nodes = optimum["route"].as_array().unwrap().iter();
        let route = Route::new(nodes.map(|i| NodeId(i.as_u64().unwrap() as u32)).collect());
        let (none, ends) = (EdgeSet::empty(), (instance.start, instance.destination));
        let totals = route
            .check(&instance.network, &none, None, ends, instance.budget_s)
            .unwrap();
        assert!((totals.weight - optimum["weight"].as_f64().unwrap()).abs() < 1e-6);
        assert!((totals.time_s - optimum["time"].as_f64().unwrap()).abs() < 1e-3);
        let again = format::from_json(&format::to_json(&instance).unwrap()).unwrap();
        assert_eq!(again, instance);
    }
}

#[test]
fn every_oplib_file_is_read_and_complete_ones_are_written_as_json() {
    let Some(paths) = data("oplib") else { return };
    let is_instance = |path: &&PathBuf| path.extension().is_some_and(|e| e == "oplib");
    for path in paths.iter().filter(is_instance) {
        let bytes = std::fs::read(path).unwrap();
        let n = dimension(&String::from_utf8_lossy(&bytes)) + 1;
        let instance = format::read(&bytes, "unused").unwrap();
        assert!(path.to_str().unwrap().contains(&instance.name));
        assert_eq!(instance.network.num_nodes(), n);
        if let Some(nearest) = format::nearest_kept(n) {
            let nodes = (0..n as u32).map(NodeId);
            let least = nodes
                .map(|node| instance.network.range_from(node).len())
                .min();
            assert!(least.is_some_and(|least| least >= nearest / 2));
            continue;
        }
        assert_eq!(instance.network.num_edges(), n * (n - 1) / 2);
        let again = format::from_json(&format::to_json(&instance).unwrap()).unwrap();
        assert_eq!(again, instance);
    }
}

/// The number of nodes that an OPLib file states.
fn dimension(text: &str) -> usize {
    let line = text.lines().find(|line| line.starts_with("DIMENSION"));
    let (_, value) = line.unwrap().split_once(':').unwrap();
    value.trim().parse().unwrap()
}
