//! Which tasks a mission has, and which of them were done.

use crate::record::MissionPicture;
use auv_graph::{EdgeId, NodeId, Task};
use auv_mission::Mission;
use std::collections::BTreeSet;

/// One task of a mission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Assignment {
    pub(super) task: Task,
    pub(super) place: Where,
    pub(super) done: bool,
}

/// Where a task is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Where {
    /// At a waypoint, whichever way it is reached.
    At(NodeId),
    /// Along an edge.
    Along(NodeId, NodeId),
}

/// Every task of the mission, by edge.
pub(super) fn assignments(mission: &Mission, picture: &MissionPicture) -> Vec<Assignment> {
    let network = &mission.network;
    let flown: BTreeSet<EdgeId> = picture
        .legs
        .iter()
        .filter(|leg| leg.completed)
        .filter_map(|leg| network.arc_between(leg.from, leg.to))
        .map(|arc| network.arcs()[arc.index()].edge)
        .collect();
    let mut shared: BTreeSet<EdgeId> = BTreeSet::new();
    let mut all = Vec::new();
    for group in mission
        .shared_tasks
        .iter()
        .filter(|group| !group.is_empty())
    {
        shared.extend(group.iter().copied());
        all.push(Assignment {
            task: network.task(group[0]),
            place: Where::At(NodeId(network.edges()[group[0].index()].to)),
            done: group.iter().any(|edge| flown.contains(edge)),
        });
    }
    for (i, edge) in network.edges().iter().enumerate() {
        let id = EdgeId(i as u32);
        if edge.task.weight() > 0.0 && !shared.contains(&id) {
            all.push(Assignment {
                task: edge.task,
                place: Where::Along(NodeId(edge.from), NodeId(edge.to)),
                done: flown.contains(&id),
            });
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::tests::flown;
    use super::*;

    #[test]
    fn as_many_are_done_as_the_summary_counts() {
        let picture = flown();
        let mission = &picture.scenario.as_ref().unwrap().mission;
        let all = assignments(mission, &picture);
        let done = all.iter().filter(|task| task.done);
        let summary = picture.summary.as_ref().unwrap();
        assert_eq!(done.clone().count(), summary.tasks);
        let weight: f64 = done.map(|task| task.task.weight()).sum();
        assert!((weight - summary.mission_weight).abs() < 1e-9);
    }
}
