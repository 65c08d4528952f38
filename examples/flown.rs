//! Pictures and exports of a flight from its log: `cargo run --release --example flown -- TRACK.csv --mission FILE.toml`.
//!
//! Key points:
//! - the track is a table of times and places, as a vehicle logs it;
//! - what was planned comes from the lines of `log.jsonl` or of `vehicle_stdio`, and is drawn beside the track;
//! - nothing is simulated, and nothing but the mission file is taken from the mission.

use auv_examples::{
    Arguments, CommandLine, Failure, MissionInput, Operand, Opt, Pictures, print, print_json,
    read_file,
};
use auv_obstacles::TimedPoint;
use auv_ocean::LocalFrame;
use auv_planning::Trajectory;
use auv_report::{
    ExportError, MissionPicture, mission_geojson, mission_svg, read_track, replay_html, track_csv,
    track_kml, track_plan,
};
use auv_types::Point3;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

const COMMAND: CommandLine = CommandLine {
    name: "flown",
    about: "Draws and exports a flight from its log, planned beside flown: mission.svg, replay.html, track.csv, and with a\n\
            [datum] in the mission route.geojson, track.kml, track.plan.",
    operands: &[Operand::required(
        "TRACK.csv",
        "the flown track: columns time_s, depth_m, and north_m, east_m or latitude_deg, longitude_deg",
    )],
    options: &[
        MissionInput::MISSION,
        MissionInput::BATHYMETRY,
        MissionInput::CURRENTS,
        MissionInput::AIS,
        Opt::value(
            "planned",
            "FILE",
            "",
            "what was planned: log.jsonl of `mission`, or the lines that vehicle_stdio wrote (default: nothing is drawn)",
        ),
        Opt::value("out", "DIR", "target/flown", "folder of the files"),
        Pictures::PNG,
    ],
    notes: "Example: flown dive7.csv --mission survey.toml --planned orders.jsonl",
};

/// Most bytes of a log.
const MOST_LOG: usize = 1 << 28;

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let pictures = Pictures::asked(arguments)?;
    let input = MissionInput::read(arguments)?;
    let frame = input.file.frame();
    let path = arguments.operand("TRACK.csv").unwrap_or_default();
    let text = text_of(path)?;
    let track = read_track(&text, frame.as_ref()).map_err(|error| Failure::file(path, error))?;
    let scenario = input.scenario(arguments.seed()?)?;

    let mut picture = MissionPicture::of_flight(input.file.name(), Arc::clone(&scenario.mission))
        .with_fences(scenario.fences.clone());
    if let Some(launch_s) = input.file.launch_unix_s() {
        picture.launched_at(launch_s);
    }
    let mut planned = 0;
    if let Some(path) = arguments.text("planned") {
        for (line, text) in text_of(path)?.lines().enumerate() {
            let place = format!("{path}, line {}", line + 1);
            let value: Value =
                serde_json::from_str(text).map_err(|error| Failure::file(&place, error))?;
            if let Some((time_s, trajectory)) = followed(&value, &place)? {
                picture.follow(time_s, &trajectory);
                planned += 1;
            }
        }
    }
    let left_out = picture.fly(&track, &[]);
    if left_out > 0 {
        picture.note(format!(
            "{left_out} of {} places of the track were left out: not later than the one before.",
            track.len()
        ));
    }

    let launch_unix_s = input.file.launch_unix_s().unwrap_or(0.0);
    let files = files_of(&picture, frame.as_ref(), launch_unix_s)
        .map_err(|error| Failure::Internal(error.to_string()))?;
    let out = Path::new(arguments.text("out").unwrap_or_default());
    for (name, text) in &files {
        pictures.write(&out.join(name), text)?;
    }
    let names: Vec<_> = files.iter().map(|file| file.0).collect();
    if arguments.json() {
        return print_json(&json!({
            "places": track.len() - left_out, "left_out": left_out, "planned": planned, "files": names,
        }));
    }
    print(&format!(
        "{} places, {left_out} left out, {planned} planned trajectories; {} in {}\n",
        track.len() - left_out,
        names.join(", "),
        out.display()
    ))
}

/// The pictures and exports of a flight, by file name.
fn files_of(
    picture: &MissionPicture,
    frame: Option<&LocalFrame>,
    launch_unix_s: f64,
) -> Result<Vec<(&'static str, String)>, ExportError> {
    let mut files = vec![
        ("mission.svg", mission_svg(picture)),
        ("replay.html", replay_html(picture)),
        ("track.csv", track_csv(picture, frame)),
    ];
    if let Some(frame) = frame {
        files.push(("route.geojson", mission_geojson(picture, frame)?));
        files.push(("track.kml", track_kml(picture, frame, launch_unix_s)?));
        files.push(("track.plan", track_plan(picture, frame)?));
    }
    Ok(files)
}

fn text_of(path: &str) -> Result<String, Failure> {
    String::from_utf8(read_file(path, MOST_LOG)?)
        .map_err(|error| Failure::file(path, format!("is not UTF-8 ({error}); give text")))
}

/// When a line of a log has a trajectory go into force, and the trajectory: `follow` of a mission's log, or the orders of
/// `vehicle_stdio`.
fn followed(line: &Value, place: &str) -> Result<Option<(f64, Trajectory)>, Failure> {
    let points = match line["event"].as_str() {
        Some("follow") => &line["points"],
        Some(_) => return Ok(None),
        None => &line["trajectory"],
    };
    if points.is_null() {
        return Ok(None);
    }
    let refused = || {
        Failure::file(
            place,
            "is not a trajectory; give points [north, east, down, time]",
        )
    };
    let points: Vec<[f64; 4]> = serde_json::from_value(points.clone()).map_err(|_| refused())?;
    let at = |[x, y, z, t]: [f64; 4]| TimedPoint::new(Point3::new(x, y, z), t);
    let trajectory =
        Trajectory::new(points.into_iter().map(at).collect()).map_err(|_| refused())?;
    let time_s = line["time_s"].as_f64().unwrap_or(trajectory.start().time_s);
    Ok(Some((time_s, trajectory)))
}
