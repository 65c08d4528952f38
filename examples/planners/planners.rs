//! Planners of other families beside the default ones, on the same missions:
//! `cargo run --release --example planners -- --missions 20`.

use auv_examples::{Arguments, CommandLine, Failure, Opt, print};
use auv_ga_route::GaRoute;
use auv_mission::driver::Stepped;
use auv_other_planners::{DifferentialEvolution, Insertion};
use auv_planning::{PathPlanner, RoutePlanner};
use auv_pso_path::PsoPath;
use auv_sim::{Campaign, Log, MissionOutcome, simulate};

const COMMAND: CommandLine = CommandLine {
    name: "planners",
    about: "Flies missions of the Table 2 set-up with the default planners, a path planner by differential evolution\n\
            and a route planner by insertion, and prints what each pair earns.",
    operands: &[],
    options: &[Opt::value("missions", "N", "20", "number of missions")],
    notes: "Example: planners --missions 50 --seed 3",
};

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let missions = arguments.number("missions")?.unwrap_or(20);
    let internal = |error: &dyn std::fmt::Display| Failure::Internal(error.to_string());
    let campaign = Campaign::table2(arguments.seed()?).map_err(|error| internal(&error))?;
    let (ga, insertion) = (GaRoute::default(), Insertion::default());
    let (pso, evolution) = (PsoPath::default(), DifferentialEvolution::default());
    let pairs: [(&dyn RoutePlanner, &dyn PathPlanner); 4] = [
        (&ga, &pso),
        (&insertion, &pso),
        (&ga, &evolution),
        (&insertion, &evolution),
    ];
    print("| routes | paths | docked | collisions | mean weight |\n|---|---|---|---|---|\n")?;
    for (routes, paths) in pairs {
        let driver = Stepped::new(routes, paths);
        let (mut docked, mut collisions, mut weight) = (0, 0, 0.0);
        for k in 0..missions {
            let scenario = campaign.scenario(k).map_err(|error| internal(&error))?;
            let summary = simulate(&scenario, &driver, &mut Log::hash_only());
            let summary = summary.map_err(|error| internal(&error))?;
            docked += u64::from(summary.outcome == MissionOutcome::Docked);
            collisions += u64::from(summary.judgement.collisions);
            weight += summary.mission_weight;
        }
        let mean = weight / missions.max(1) as f64;
        let names = (routes.name(), paths.name());
        print(&format!(
            "| {} | {} | {docked} of {missions} | {collisions} | {mean:.2} |\n",
            names.0, names.1
        ))?;
    }
    Ok(())
}
