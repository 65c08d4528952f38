//! Which tasks a mission has, and when they were done.

use crate::record::MissionPicture;
use auv_graph::{EdgeId, NodeId, Task, TaskPlace};
use auv_mission::Mission;
use std::collections::{BTreeMap, BTreeSet};

/// One task of a mission.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Assignment {
    pub(crate) task: Task,
    pub(crate) place: Where,
    /// When it was done, if it was, seconds.
    pub(crate) done_s: Option<f64>,
}

/// Where a task is to be done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Where {
    /// At a waypoint, whichever way it is reached.
    At(NodeId),
    /// Along an edge.
    Along(NodeId, NodeId),
}

/// Every task of the mission: by edge, then those planned in time.
pub(crate) fn assignments(mission: &Mission, picture: &MissionPicture) -> Vec<Assignment> {
    let network = &mission.network;
    let mut flown_s: BTreeMap<EdgeId, f64> = BTreeMap::new();
    for (k, leg) in picture.legs.iter().enumerate() {
        if let Some(arc) = network
            .arc_between(leg.from, leg.to)
            .filter(|_| leg.completed)
        {
            let edge = network.arcs()[arc.index()].edge;
            flown_s.entry(edge).or_insert_with(|| picture.leg_end_s(k));
        }
    }
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
            done_s: group
                .iter()
                .filter_map(|edge| flown_s.get(edge).copied())
                .min_by(f64::total_cmp),
        });
    }
    for (i, edge) in network.edges().iter().enumerate() {
        let id = EdgeId(i as u32);
        if edge.task.weight() > 0.0 && !shared.contains(&id) {
            all.push(Assignment {
                task: edge.task,
                place: Where::Along(NodeId(edge.from), NodeId(edge.to)),
                done_s: flown_s.get(&id).copied(),
            });
        }
    }
    all.extend(in_time(mission, picture));
    all
}

/// The tasks of the mission's time model.
fn in_time<'a>(
    mission: &'a Mission,
    picture: &'a MissionPicture,
) -> impl Iterator<Item = Assignment> + 'a {
    let model = mission.time_model.iter();
    let tasks = model.flat_map(|model| model.tasks.iter().enumerate());
    tasks.map(|(i, known)| {
        let mut done = picture.ending.iter().flat_map(|s| &s.timed_done);
        let place = match known.place {
            TaskPlace::Node(node) => Where::At(node),
            TaskPlace::Edge(edge) => {
                let edge = &mission.network.edges()[edge.index()];
                Where::Along(NodeId(edge.from), NodeId(edge.to))
            }
        };
        Assignment {
            task: known.task,
            place,
            done_s: done
                .find(|done| done.task == i)
                .map(|done| done.start_s + known.task.completion_time_s),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::tests::flown;

    #[test]
    fn as_many_are_done_as_the_summary_counts() {
        let picture = flown();
        let mission = &picture.setting.as_ref().unwrap().mission;
        let all = assignments(mission, &picture);
        let done = all.iter().filter(|task| task.done_s.is_some());
        let ending = picture.ending.as_ref().unwrap();
        let summary = ending.judged.as_ref().unwrap();
        assert_eq!(done.clone().count(), summary.tasks);
        let weight: f64 = done.map(|task| task.task.weight()).sum();
        assert!((weight - summary.mission_weight).abs() < 1e-9);
        let times: BTreeSet<_> = all
            .iter()
            .filter_map(|task| task.done_s)
            .map(f64::to_bits)
            .collect();
        assert!(times.len() > 1, "each at the end of its own leg");
    }
}
