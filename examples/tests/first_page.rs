//! What newcomers read runs: the first page's programs, the first mission's file, the shipped instance.

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_planning::{Budget, RoutePlanner, RouteProblem, Run};
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{MissionOutcome, simulate};
use auv_types::Seed;

fn blocks<'a>(text: &'a str, language: &str) -> Vec<&'a str> {
    text.split(&format!("```{language}\n"))
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .collect()
}

/// The doctests of the facade crate run its README's programs.
#[test]
fn the_programs_of_the_first_page_are_those_that_tests_run() {
    let first_page = blocks(include_str!("../../README.md"), "rust");
    let run = blocks(include_str!("../../crates/auv/README.md"), "rust");
    assert_eq!(
        first_page.len(),
        4,
        "a route, a path, a mission, a simulation"
    );
    assert_eq!(first_page, run);
}

#[test]
fn the_first_mission_is_flown() {
    let text = blocks(include_str!("../../docs/first-mission.md"), "toml")[0];
    let file = MissionFile::from_toml(text).expect("a sound file");
    let scenario = file
        .scenario(&MissionData::default(), Seed(0))
        .expect("a sound mission");
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    let summary = simulate(&scenario, &Stepped::new(&routes, &paths), &mut ()).expect("flown");
    assert_eq!(summary.outcome, MissionOutcome::Docked, "{summary}");
    assert_eq!(summary.tasks, 2, "{summary}");
}

#[test]
fn the_shipped_instance_is_read_and_planned() {
    let text = include_str!("../instances/harbour.json");
    let instance = auv_graph::format::from_json(text).expect("a sound instance");
    let problem = RouteProblem::new(
        &instance.network,
        instance.start,
        instance.destination,
        instance.budget_s,
    );
    let mut run = Run::new(Seed(0), Budget::evaluations(2_000));
    let planned = GaRoute::new(GaSettings::default())
        .plan_route(&mut run, &problem)
        .expect("planned");
    assert!(
        planned.violation <= 0.0 && planned.cost < -10.0,
        "{planned}"
    );
}
