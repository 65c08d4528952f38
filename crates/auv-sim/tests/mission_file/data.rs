//! What a mission takes from the files beside it, and what is said of it.

use crate::written;
use auv_sim::Scenario;
use auv_sim::mission_file::{DataReport, MissionData, MissionFile, MissionFileError};
use auv_types::Seed;

/// A straight way of 2,000 m (over 1,300 s at 1.5 m/s) in the water of the written files.
fn crossing(version: u32, keys: &str) -> String {
    format!(
        "version = {version}\nname = \"crossing\"\npreset = \"default\"\nbudget_s = 3600\nstart = \"A\"\ndestination = \"B\"\n\
         waypoints = [{{ name = \"A\", at = [0, 0, 10] }}, {{ name = \"B\", at = [2000, 0, 10] }}]\n\
         edges = [{{ from = \"A\", to = \"B\" }}]\ndatum = {{ latitude_deg = 58.03, longitude_deg = 10.94 }}\n\
         [box]\nnorth_m = [-500, 2500]\neast_m = [-500, 500]\ndepth_m = [2, 60]\n{keys}"
    )
}

const SHIPS: &str = "MMSI,BaseDateTime,LAT,LON,SOG,COG,Status,Length,Draft\n\
                     7,2024-05-01T06:00:00,58.20,10.90,0.0,90,1,120,\n\
                     7,2024-05-01T06:10:00,58.20,10.90,0.0,90,1,120,\n\
                     8,never,58.20,10.90,0.0,90,1,120,\n";

fn built(
    text: &str,
    currents: Option<&[u8]>,
    report: &mut DataReport,
) -> Result<Scenario, MissionFileError> {
    let (chart, ships) = (written::chart().bytes(), SHIPS.as_bytes());
    let data = MissionData {
        bathymetry: Some(&chart),
        currents,
        ais: Some(ships),
    };
    MissionFile::from_toml(text)?.scenario_with_report(&data, Seed(0), report)
}

/// Records from 06:00 to 10:00, hourly.
fn model(after_first_s: f64, extrapolate: bool) -> String {
    let version = if extrapolate { 2 } else { 1 };
    let more = if extrapolate {
        "extrapolate = true\n"
    } else {
        ""
    };
    crossing(
        version,
        &format!("[current.model]\nstart_after_first_record_s = {after_first_s}\n{more}"),
    )
}

#[test]
fn a_mission_outside_of_the_records_is_refused_unless_it_says_so() {
    let currents = written::currents().bytes();
    let read = |after_s: f64, extrapolate: bool| {
        let text = model(after_s, extrapolate);
        built(&text, Some(&currents), &mut DataReport::default())
    };
    assert!(
        read(3_600.0, false)
            .unwrap()
            .warnings
            .iter()
            .all(|w| !w.contains("held"))
    );
    for (after_s, told) in [
        (-600.0, "first record 600 s after the mission starts"),
        (15_000.0, "last record 600 s before the mission starts"),
        (
            13_900.0,
            "last record 500 s after the mission starts, and the straight way",
        ),
    ] {
        let refusal = read(after_s, false).unwrap_err().to_string();
        assert!(refusal.contains(told), "{refusal}");
        assert!(
            refusal.contains("current.model.extrapolate = true"),
            "{refusal}"
        );
        let warnings = read(after_s, true).unwrap().warnings;
        assert!(
            warnings
                .iter()
                .any(|w| w.starts_with("currents: ") && w.contains("held")),
            "{warnings:?}"
        );
    }
    // The records last for the straight way, not for the whole budget: said.
    let warnings = read(12_400.0, false).unwrap().warnings;
    assert!(
        warnings
            .iter()
            .any(|w| w.contains("2000 s after the mission's start and is held")),
        "{warnings:?}"
    );
}

#[test]
fn the_report_says_what_was_read_dropped_and_assumed() {
    let mut file = written::currents();
    file.var("uo").values.iter_mut().for_each(|x| *x *= 100.0);
    file.var("uo").set("units", "cm s-1");
    let mut report = DataReport::default();
    let text = crossing(
        2,
        "[current.model]\n[sea_bed.chart]\ndatum = \"lat\"\n[ais]\nassumed_draught_m = 8\n",
    );
    let scenario = built(&text, Some(&file.bytes()), &mut report).unwrap();
    let text = report.to_text();
    for part in [
        "bathymetry: NetCDF\n",
        "deptho [m] (lat 17 x lon 13), ",
        "extent: 58 to 58.06",
        "vertical: depths are taken as measured from lowest astronomical tide (lat); nothing is converted",
        "currents: NetCDF\n",
        "uo [cm s-1] (time 5 x depth 4 x latitude 7 x longitude 6), ",
        "% missing",
        "times: 5 records over 14400 s",
        "levels: [0.5, 10.5, 20.5, 30.5] m",
        "converted: `uo` from cm s-1 to m/s",
        "ais: comma-separated text, 1 ships",
        "dropped: 1 rows are left out; the first: line 4",
        "assumed: 1 ships report no draught: 8 m is assumed",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    let json = serde_json::to_value(&report).unwrap();
    assert_eq!(json["files"][1]["file"], "currents");
    assert_eq!(json["files"][1]["variables"].as_array().unwrap().len(), 6);
    for warning in report.warnings() {
        assert!(scenario.warnings.contains(&warning), "{warning}");
    }
}

#[test]
fn what_was_read_before_a_refusal_is_kept() {
    let mut report = DataReport::default();
    let text = crossing(1, "[current.model]\n");
    assert!(built(&text, Some(b"no file"), &mut report).is_err());
    assert_eq!(report.files.len(), 1);
}
