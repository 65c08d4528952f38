//! Flies one whole mission: `cargo run --release --example mission`.

mod check;

use auv_examples::{
    Arguments, Bounded, Clock, CommandLine, Failure, MissionInput, Opt, Pictures, gap_percent,
    note, print, print_json, write_file,
};
use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::{EdgeId, Network, NodeId};
use auv_mission::driver::Stepped;
use auv_mission::{PathCall, RouteCall};
use auv_planning::timed::LeftOut;
use auv_pso_path::{PathSearch, PsoPath};
use auv_report::{
    ExportError, MissionPicture, Table, mission_geojson, mission_svg, replay_html, route_plan,
    track_csv, track_kml, track_plan,
};
use auv_sim::mission_file::{DataReport, MissionFile};
use auv_sim::{Log, MissionOutcome, Scenario, Summary, simulate};
use std::fmt::Write;
use std::path::Path;

const COMMAND: CommandLine = CommandLine {
    name: "mission",
    about: "Flies one whole mission in a simulated sea and judges it by the truth: routes over a network of waypoints\n\
            and tasks, paths among obstacles seen and predicted, replanned as the sea changes.",
    operands: &[],
    options: &[
        MissionInput::MISSION,
        MissionInput::BATHYMETRY,
        MissionInput::CURRENTS,
        MissionInput::AIS,
        MissionInput::BODY,
        Opt::value(
            "bound-ms",
            "MS",
            "",
            "milliseconds for a proven bound of each route's weight, shown in the route table (default: none); the mission stays as it is",
        ),
        Opt::flag(
            "check",
            "print whether the mission can be launched, what it is expected to do and when, what it leaves out and why",
        ),
        Opt::flag(
            "data",
            "print what was read from each file beside the mission, and fly nothing",
        ),
        Opt::value(
            "out",
            "DIR",
            "target/mission",
            "where to write mission.svg, replay.html, log.jsonl and track.csv; with a datum also route.geojson, track.kml, track.plan and route.plan",
        ),
        Pictures::PNG,
    ],
    notes: "--seed draws the obstacles, how the current differs from its forecast, and all noise; planners are given\n\
            evaluation budgets only, so that the same seed gives the same mission (log_sha256) on any machine.\n\
            Example: mission --mission examples/missions/baynes_sound.toml --seed 3",
};

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let seed = arguments.seed()?;
    let workers = arguments.workers()?;
    let input = MissionInput::read(arguments)?.with_body(arguments)?;
    let routes = GaRoute::new(GaSettings::default()).with_workers(workers.clone());
    let routes = Bounded::new(routes, arguments.bound_time()?);
    let paths = PsoPath::new(PathSearch::default()).with_workers(workers);
    if arguments.flag("check") {
        let check = input.launch_check(seed, &Stepped::new(&routes, &paths))?;
        return match arguments.json() {
            true => print_json(&check),
            false => {
                let launch_unix_s = input.file.launch_unix_s();
                print(&check::text(input.file.name(), &check, launch_unix_s))
            }
        };
    }
    let mut read = DataReport::default();
    let scenario = input.scenario_with_report(seed, &mut read);
    if arguments.flag("data") && (scenario.is_ok() || !read.files.is_empty()) {
        match arguments.json() {
            true => print_json(&read)?,
            false => print(&read.to_text())?,
        }
        // What was read is told also where the mission is refused.
        return scenario.map(drop);
    }
    let scenario = scenario?;
    input.require_go(seed, &Stepped::new(&routes, &paths))?;
    fly(arguments, &input, &scenario, (&routes, &paths))
}

/// Flies the mission, writes its files and prints what came of it.
fn fly(
    arguments: &Arguments,
    input: &MissionInput,
    scenario: &Scenario,
    (routes, paths): (&Bounded<GaRoute>, &PsoPath),
) -> Result<(), Failure> {
    let file = &input.file;
    let out = Path::new(arguments.text("out").unwrap_or_default());
    if out.as_os_str().is_empty() {
        return Err(Failure::option("out", "is empty; give a folder"));
    }
    let pictures = Pictures::asked(arguments)?;
    // A folder that cannot be written to is reported before the flight.
    write_file(&out.join("log.jsonl"), b"")?;

    let clock = Clock::start();
    let seconds = || clock.elapsed_ms() / 1e3;
    let driver = Stepped::new(routes, paths).with_stopwatch(&seconds);
    let mut records = (Log::keeping_lines(), noted_picture(file));
    for warning in &scenario.warnings {
        note(&format!("warning: {warning}"));
    }
    let summary = simulate(scenario, &driver, &mut records)
        .map_err(|error| Failure::file(&input.path, error))?;
    let (log, picture) = records;
    let flown_s = seconds();

    let mut lines = log.lines().join("\n");
    lines.push('\n');
    let mut files = vec![
        ("log.jsonl", lines),
        ("mission.svg", mission_svg(&picture)),
        ("replay.html", replay_html(&picture)),
    ];
    let exports = exports(file, scenario, &picture, &summary);
    files.extend(exports.map_err(|error| Failure::Internal(error.to_string()))?);
    for (name, text) in &files {
        pictures.write(&out.join(name), text)?;
    }
    if arguments.json() {
        let mut told = told(scenario, &summary, &log.sha256(), routes);
        told["tasks_done"] = tasks_done(file, scenario, &summary);
        return print_json(&told);
    }
    print(&report(file, scenario, &summary, routes))?;
    note(&format!(
        "flown in {flown_s:.1} s of computing; {} in {}, sha256 {}",
        files
            .iter()
            .map(|file| file.0)
            .collect::<Vec<_>>()
            .join(", "),
        out.display(),
        log.sha256()
    ));
    note(&format!("open {}", out.join("replay.html").display()));
    Ok(())
}

/// The tasks done, with the time at which each began where tasks are planned in time.
fn tasks_done(file: &MissionFile, scenario: &Scenario, summary: &Summary) -> serde_json::Value {
    let works = file.works(&scenario.mission);
    let done = file.works_done(&scenario.mission, summary);
    let begins_s = |task: Option<usize>| {
        let mut timed = summary.timed_done.iter();
        timed
            .find(|done| Some(done.task) == task)
            .map(|done| done.start_s)
    };
    let told = works.iter().zip(done).filter(|(_, done)| *done);
    let told = told.map(|(work, _)| {
        serde_json::json!({ "name": work.name, "at": work.at, "begins_s": begins_s(work.timed) })
    });
    told.collect()
}

/// A picture with the notes of the mission.
fn noted_picture(file: &MissionFile) -> MissionPicture {
    let mut picture = MissionPicture::new();
    if let Some(unix_s) = file.launch_unix_s() {
        picture.launched_at(unix_s);
    }
    if let Some(shift) = shift(file) {
        picture.note(shift);
    }
    if !file.credit().is_empty() {
        picture.note(file.credit());
    }
    picture
}

/// The JSON object printed about a mission.
fn told(
    scenario: &Scenario,
    summary: &Summary,
    sha256: &str,
    routes: &Bounded<GaRoute>,
) -> serde_json::Value {
    let mut told = summary.to_json(sha256);
    told["warnings"] = scenario.warnings.clone().into();
    for (row, (most, gap)) in bounds(&summary.route_calls, &routes.most_weights()) {
        told["route_calls"][row]["bound"] = most.into();
        told["route_calls"][row]["gap_percent"] = gap.into();
    }
    told["left_out"] = left_out(scenario, summary, routes)
        .into_iter()
        .map(|([from, to], why)| serde_json::json!({ "from": from, "to": to, "why": why }))
        .collect();
    told
}

/// The files for other programs; those on the Earth only where the mission has a datum.
fn exports(
    file: &MissionFile,
    scenario: &Scenario,
    picture: &MissionPicture,
    summary: &Summary,
) -> Result<Vec<(&'static str, String)>, ExportError> {
    let frame = file.frame();
    let mut files = vec![("track.csv", track_csv(picture, frame.as_ref()))];
    let Some(frame) = frame else {
        note(
            "no route.geojson, track.kml, track.plan and route.plan, and no latitudes in track.csv: the mission has no [datum]",
        );
        return Ok(files);
    };
    files.push(("route.geojson", mission_geojson(picture, &frame)?));
    files.push((
        "track.kml",
        track_kml(picture, &frame, file.launch_unix_s().unwrap_or(0.0))?,
    ));
    files.push(("track.plan", track_plan(picture, &frame)?));
    // The first route from a waypoint that went into force: what the mission was launched with.
    let mission = &scenario.mission;
    let mut calls = summary.route_calls.iter();
    if let Some(call) = calls.find(|call| call.adopted && mission.network.has_node(call.start)) {
        files.push(("route.plan", route_plan(mission, &frame, &call.route)?));
    }
    Ok(files)
}

/// The text printed about a mission.
fn report(
    file: &MissionFile,
    scenario: &Scenario,
    summary: &Summary,
    routes: &Bounded<GaRoute>,
) -> String {
    let mission = &scenario.mission;
    let network = &mission.network;
    let mut text = format!(
        "{}\n{}\npreset {}, {} waypoints, {} edges, {} tasks; {:.0} s, of which {:.0} s are kept in reserve\n",
        file.name(),
        file.description().trim(),
        scenario.preset,
        network.num_nodes(),
        network.num_edges(),
        file.works(mission).len(),
        mission.budget_s,
        mission.reserve_s,
    );
    if let Some(shift) = shift(file) {
        let _ = writeln!(text, "{shift}");
    }
    if !file.credit().is_empty() {
        let _ = writeln!(text, "{}", file.credit());
    }
    let left = left_out(scenario, summary, routes);
    let _ = write!(
        text,
        "\nRoute calls\n{}\nPath calls\n{}\n{}",
        route_table(network, &summary.route_calls, &routes.most_weights())
            + &told_left_out(file, &left),
        path_table(network, &summary.path_calls),
        ending(network, summary),
    );
    text
}

/// The note on ship tracks that were shifted in space.
fn shift(file: &MissionFile) -> Option<String> {
    let [north_m, east_m] = file.tracks_shifted_m()?;
    Some(format!(
        "ship tracks shifted in space: {north_m:.0} m north, {east_m:.0} m east"
    ))
}

fn name(network: &Network, node: NodeId) -> String {
    let waypoint = network.waypoints().get(node.index());
    waypoint.map_or_else(|| "here".into(), |waypoint| waypoint.name.clone())
}

/// Most tasks left out that the text lists.
const MOST_LISTED: usize = 12;

/// Lines of text on the tasks that the first route leaves out: a survey that is flown as a whole is one.
fn told_left_out(file: &MissionFile, left: &[([String; 2], LeftOut)]) -> String {
    let told = left.iter().map(|([from, to], why)| {
        let survey = file.whole_survey_from(from);
        let what = survey.map_or_else(|| format!("{from} - {to}"), |name| format!("survey {name}"));
        format!("route 1 leaves out {what}: {why}\n")
    });
    let mut lines: Vec<String> = told.collect();
    lines.dedup();
    let more = lines.len().saturating_sub(MOST_LISTED);
    lines.truncate(MOST_LISTED);
    if more > 0 {
        lines.push(format!("route 1 leaves out {more} more\n"));
    }
    lines.concat()
}

/// The ends of the edges with tasks that the first route leaves out, and why. A task that several edges share is
/// listed once, and not at all where the route does it.
fn left_out(
    scenario: &Scenario,
    summary: &Summary,
    routes: &Bounded<GaRoute>,
) -> Vec<([String; 2], LeftOut)> {
    let mission = &scenario.mission;
    let network = &mission.network;
    let passed = summary
        .route_calls
        .first()
        .map_or(&[][..], |call| &call.route);
    let arcs = passed
        .windows(2)
        .filter_map(|leg| network.arc_between(leg[0], leg[1]));
    let mut done: Vec<EdgeId> = arcs.map(|arc| network.arcs()[arc.index()].edge).collect();
    let mut left = Vec::new();
    for &(edge, why) in routes.left_out() {
        let sharing = mission
            .shared_tasks
            .iter()
            .filter(|group| group.contains(&edge));
        let is_known = done.contains(&edge) || sharing.flatten().any(|other| done.contains(other));
        if !is_known && edge.index() < network.num_edges() {
            let ends = &network.edges()[edge.index()];
            left.push((
                [ends.from, ends.to].map(|node| network.name_of(NodeId(node))),
                why,
            ));
            done.push(edge);
        }
    }
    left
}

/// For each row of the route table that a planner answered and that has a bound: the row, the most that its
/// route may weigh, and the gap in percent.
fn bounds(
    calls: &[RouteCall],
    most: &[Option<f64>],
) -> impl Iterator<Item = (usize, (f64, Option<f64>))> {
    let answered = (0..calls.len()).filter(|&row| calls[row].evaluations > 0);
    let bounded = answered
        .zip(most)
        .filter_map(|(row, most)| Some((row, (*most)?)));
    bounded.map(|(row, most)| (row, (most, gap_percent(most, calls[row].route_weight))))
}

/// What the columns of the route table hold.
const ROUTE_COLUMNS: &str = "\
why: what asked for a route; at: when, from: where; tasks, weight: of the route,
in all: with what is done; left: time to the end of the budget, route: what the
route takes; CPU: of planning; valid: verified, taken: went into force
";
/// What the columns of the path table hold.
const PATH_COLUMNS: &str = "\
route: the route call that the leg belongs to; at: when it began; violation: of
the path's constraints; CPU: of planning; took, expected: the leg's time; left:
time to the end of the budget; paths: planned on the leg; waited: seconds; done:
reached its end; replan: a route was asked for at its end
";

fn route_table(network: &Network, calls: &[RouteCall], most: &[Option<f64>]) -> String {
    let mut table = Table::new([
        "call",
        "why",
        "at (s)",
        "from",
        "tasks",
        "weight",
        "in all",
        "left (s)",
        "route (s)",
        "CPU (ms)",
        "valid",
        "taken",
    ]);
    for call in calls {
        table.row([
            call.call.to_string(),
            call.reason.as_str().into(),
            format!("{:.0}", call.at_s),
            name(network, call.start),
            call.tasks.to_string(),
            format!("{:.2}", call.route_weight),
            format!("{:.2}", call.mission_weight),
            format!("{:.0}", call.available_s),
            format!("{:.0}", call.route_s),
            format!("{:.1}", call.compute_s * 1e3),
            yes(call.valid),
            yes(call.adopted),
        ]);
    }
    let mut text = table.to_string() + ROUTE_COLUMNS;
    let mut before: &[NodeId] = &[];
    for call in calls {
        // A route that continues the one before is not printed again.
        if !before.ends_with(&call.route) {
            let names: Vec<_> = call.route.iter().map(|node| name(network, *node)).collect();
            let _ = writeln!(text, "route {}: {}", call.call, wrapped(&names, 68));
        }
        before = &call.route;
    }
    for (row, (most, gap)) in bounds(calls, most) {
        let gap = gap.map_or(String::new(), |gap| format!(", {gap:.2} % above its route"));
        let _ = writeln!(
            text,
            "call {}: proven to be at most {most:.2}{gap}",
            calls[row].call
        );
    }
    text
}

fn path_table(network: &Network, calls: &[PathCall]) -> String {
    let mut table = Table::new([
        "leg",
        "route",
        "from",
        "to",
        "at (s)",
        "violation",
        "CPU (ms)",
        "took (s)",
        "expected",
        "left (s)",
        "paths",
        "waited",
        "done",
        "replan",
    ]);
    for call in calls {
        table.row([
            call.call.to_string(),
            call.route_call.to_string(),
            name(network, call.from),
            name(network, call.to),
            format!("{:.0}", call.at_s),
            format!("{:.4}", call.violation),
            format!("{:.1}", call.compute_s * 1e3),
            format!("{:.0}", call.leg_s),
            format!("{:.0}", call.expected_s),
            format!("{:.0}", call.available_s),
            (call.replanned_paths + 1).to_string(),
            format!("{:.0}", call.waited_s),
            yes(call.completed),
            yes(call.replan),
        ]);
    }
    table.to_string() + PATH_COLUMNS
}

fn yes(it_is: bool) -> String {
    if it_is { "yes" } else { "no" }.into()
}

/// Words joined by commas, in lines of at most `width`.
fn wrapped(words: &[String], width: usize) -> String {
    let mut text = String::new();
    let mut line = 0;
    for (i, word) in words.iter().enumerate() {
        let comma = if i + 1 < words.len() { ", " } else { "" };
        if line + word.chars().count() > width {
            text.push_str("\n    ");
            line = 4;
        }
        line += word.chars().count() + comma.len();
        let _ = write!(text, "{word}{comma}");
    }
    text
}

/// Adds what was met on the way: a bed shallower than charted, ships.
fn met(text: &mut String, network: &Network, summary: &Summary) {
    if summary.climbs > 0 || !summary.raised.is_empty() {
        let raised = summary.raised.iter();
        let raised: String = raised
            .map(|(node, by_m)| format!("; {} reached {by_m:.1} m higher", name(network, *node)))
            .collect();
        let climbs = summary.climbs;
        let _ = writeln!(
            text,
            "bed        measured shallower than charted: climbed {climbs} times{raised}"
        );
    }
    let judgement = &summary.judgement;
    let (ships, nearest_m) = (judgement.ships.len(), judgement.min_ship_distance_m);
    if nearest_m < 0.0 {
        let _ = writeln!(
            text,
            "ships      {ships} came within 1 km, one passed over the vehicle"
        );
    } else if nearest_m.is_finite() {
        let _ = writeln!(
            text,
            "ships      {ships} came within 1 km, the nearest to {nearest_m:.0} m abeam, measured level"
        );
    }
}

fn ending(network: &Network, summary: &Summary) -> String {
    let judgement = &summary.judgement;
    let metres = |x: f64| {
        if x.is_finite() {
            format!("{x:.1} m")
        } else {
            "none met".into()
        }
    };
    let visited: Vec<_> = summary
        .visited
        .iter()
        .map(|node| name(network, *node))
        .collect();
    let mut text = format!(
        "visited    {visited}\n\
         outcome    {outcome}: {reason}\n\
         tasks      {tasks} done, weight {weight:.2}\n\
         time       {time:.0} s, {remaining:.0} s left\n\
         clearance  {clearance} least true distance to any obstacle, at {at:.0} s; {collisions} collisions\n\
         altitude   {altitude} least over the sea bed; {groundings} groundings\n",
        visited = wrapped(&visited, 68),
        outcome = summary.outcome,
        reason = summary.reason,
        tasks = summary.tasks,
        weight = summary.mission_weight,
        time = summary.time_s,
        remaining = summary.remaining_s,
        clearance = metres(judgement.min_clearance_m),
        at = judgement.min_clearance_at_s,
        collisions = judgement.collisions,
        altitude = metres(judgement.min_altitude_m),
        groundings = judgement.groundings,
    );
    let broken = judgement.limits_broken.iter();
    let broken: Vec<String> = broken.map(ToString::to_string).collect();
    let broken = if broken.is_empty() {
        "none broken".into()
    } else {
        format!("BROKEN: {}", broken.join(", "))
    };
    let _ = writeln!(text, "limits     {broken}");
    met(&mut text, network, summary);
    if summary.outcome != MissionOutcome::Collided {
        text.push_str("A sonar that looks ahead does not see what comes from astern.\n");
    }
    text
}
