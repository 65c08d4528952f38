//! A tour that ends at another destination, against all ways there.

use crate::drawn::Drawn;
use auv_graph::{NodeId, Passing};
use auv_planning::RouteProblem;
use auv_planning::timed::{NO_TASK, Step, TimedNetwork, TimedTour};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed};

/// A tour over random arcs with random tasks, if it is feasible.
fn drawn_tour(tables: &TimedNetwork<'_>, random: &mut ChaCha8Rng) -> Option<TimedTour> {
    let network = tables.problem.network;
    let mut steps = vec![Step::pass(tables.problem.start.0)];
    let mut is_done = vec![false; tables.works.len()];
    for _ in 0..random.random_range(1..network.num_nodes()) {
        let at = steps[steps.len() - 1].node;
        let is_new = |node: u32| steps.iter().all(|step| step.node != node);
        let heads = network.arcs_from(NodeId(at)).map(|(_, arc)| arc.head.0);
        let heads: Vec<u32> = heads.filter(|&node| is_new(node)).collect();
        if heads.is_empty() {
            break;
        }
        let node = heads[random.random_range(0..heads.len())];
        let mut works = Vec::new();
        for (task, work) in (0..).zip(&tables.works) {
            let is_here = work.is_along(at, node) || !work.is_on_edge && work.ends[0] == node;
            if is_here && !is_done[task as usize] && random.random_bool(0.6) {
                is_done[task as usize] = true;
                works.push((!work.is_on_edge, Step { node, task }));
            }
        }
        // What is on the edge comes first.
        works.sort_by_key(|(is_at_node, _)| *is_at_node);
        steps.push(Step::pass(node));
        if !works.is_empty() {
            steps.pop();
        }
        steps.extend(works.into_iter().map(|(_, step)| step));
    }
    TimedTour::new(tables, steps)
}

/// The quickest of all ways from one node to another after leaving at a time over nodes that are free, the first one
/// left out.
fn quickest_of_all(
    problem: &RouteProblem<'_>,
    (from, leave_s): (u32, f64),
    to: u32,
    is_free: &dyn Fn(u32) -> bool,
) -> Option<Vec<u32>> {
    let mut best = None;
    if from == to {
        return Some(vec![to]);
    }
    go_on(
        problem,
        (&mut vec![from], leave_s),
        (to, is_free),
        &mut best,
    );
    best.map(|(_, way)| way[1..].to_vec())
}

fn go_on(
    problem: &RouteProblem<'_>,
    (way, time_s): (&mut Vec<u32>, f64),
    (to, is_free): (u32, &dyn Fn(u32) -> bool),
    best: &mut Option<(f64, Vec<u32>)>,
) {
    let at = way[way.len() - 1];
    if at == to {
        if best.as_ref().is_none_or(|(least_s, _)| time_s < *least_s) {
            *best = Some((time_s, way.clone()));
        }
        return;
    }
    let model = problem.time_model.unwrap();
    for (id, arc) in problem.network.arcs_from(NodeId(at)) {
        let head = arc.head.0;
        if way.contains(&head) || head != to && !is_free(head) {
            continue;
        }
        let profile = model.profiles.of(id);
        let travel_s = profile.map_or(arc.distance_m / 2.0, |p| p.travel_s(time_s));
        let own_s = problem.network.task(arc.edge).completion_time_s;
        way.push(head);
        go_on(
            problem,
            (way, time_s + travel_s + own_s),
            (to, is_free),
            best,
        );
        way.pop();
    }
}

/// The tour that ends at a destination, and from which of its steps it goes there.
fn ends_at(
    tables: &TimedNetwork<'_>,
    tour: &TimedTour,
    end: u32,
    kept: usize,
) -> Option<(usize, TimedTour)> {
    let steps = tour.steps();
    let start = steps[0].node;
    (1..=kept).rev().find_map(|kept| {
        let stays = |step: &&Step| step.node != end || end == start;
        let mut part: Vec<Step> = steps[..kept].iter().filter(stays).copied().collect();
        let from = part.last().map_or(start, |step| step.node);
        let is_free = |node: u32| {
            let must_work = tables.passing_works() && !tables.at_node[node as usize].is_empty();
            !must_work && part.iter().all(|step| step.node != node)
        };
        let way = quickest_of_all(
            tables.problem,
            (from, tour.ready_s()[kept - 1]),
            end,
            &is_free,
        )?;
        part.extend(way.into_iter().map(|node| Step {
            node,
            task: NO_TASK,
        }));
        Some((kept, TimedTour::new(tables, part)?))
    })
}

fn facts(tour: &TimedTour) -> (Vec<Step>, [u64; 2]) {
    (
        tour.steps().to_vec(),
        [tour.weight(), tour.end_s()].map(f64::to_bits),
    )
}

#[test]
fn a_tour_ends_elsewhere_by_the_quickest_way_from_its_last_step_that_allows_it() {
    let [mut at_once, mut earlier, mut never] = [0; 3];
    for seed in 0..6_000 {
        let drawn = Drawn::new(seed, 6);
        let mut model = drawn.problem().time_model.unwrap().clone();
        if seed % 4 == 0 {
            model.passing = Passing::DoesTasks;
        }
        let problem = RouteProblem {
            time_model: Some(&model),
            ..drawn.problem()
        };
        let tables = TimedNetwork::new(&problem, &model);
        let random = &mut Seed(seed).stream(1);
        let Some(tour) = drawn_tour(&tables, random) else {
            continue;
        };
        let kept = random.random_range(1..=tour.steps().len());
        for &end in &tables.destinations {
            let mut other = tour.clone();
            let is_changed = other.end_at(&tables, end, kept);
            let wanted = ends_at(&tables, &tour, end, kept);
            assert_eq!(is_changed, wanted.is_some(), "problem {seed} to {end}");
            match wanted {
                Some((from, wanted)) => {
                    assert_eq!(facts(&other), facts(&wanted), "problem {seed} to {end}");
                    assert_eq!(other.steps().last().unwrap().node, end);
                    // Tables by node and task are those of the new steps too.
                    for task in 0..tables.works.len() as u32 {
                        assert_eq!(other.step_of(task), wanted.step_of(task));
                    }
                    assert!((0..6).all(|node| other.visits(node) == wanted.visits(node)));
                    *if from == kept {
                        &mut at_once
                    } else {
                        &mut earlier
                    } += 1;
                }
                None => {
                    assert_eq!(facts(&other), facts(&tour), "problem {seed} to {end}");
                    never += 1;
                }
            }
        }
    }
    assert!(
        at_once > 500 && earlier > 100 && never > 40,
        "{at_once} {earlier} {never}"
    );
}
