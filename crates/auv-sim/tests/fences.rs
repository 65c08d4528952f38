//! Areas of a mission file that the vehicle stays out of, or in.
#![cfg(feature = "mission-file")]
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::{MissionData, MissionFile};
use auv_sim::{MissionOutcome, Scenario, Summary, simulate};
use auv_types::Seed;

/// From a to b, 2 km to the north, over a bed of 50 m or none.
fn scenario(bed: &str, fences: &str) -> Result<Scenario, String> {
    let text = format!(
        "version = 2\nname = \"fences\"\npreset = \"default\"\nbudget_s = 6000\nstart = \"a\"\ndestination = \"b\"\n\
         launch = \"2026-06-01T08:00:00Z\"\n\
         waypoints = [{{ name = \"a\", at = [0, 0, 10] }}, {{ name = \"c\", at = [1000, 500, 10], task = \"look\" }}, {{ name = \"b\", at = [2000, 0, 10] }}]\n\
         connect.nearest = 2\ncurrent.still = true\nsonar.clutter_per_scan = 0\n\
         tasks.look = {{ priority = 5, risk = 1, time_s = 60 }}\n\
         datum = {{ latitude_deg = 50, longitude_deg = 0 }}\n\
         box = {{ north_m = [-500, 2500], east_m = [-1500, 1500], depth_m = [2, 45] }}\n{bed}\n{fences}\n"
    );
    let file = MissionFile::from_toml(&text).map_err(|error| error.to_string())?;
    let scenario = file.scenario(&MissionData::default(), Seed(1));
    scenario.map_err(|error| error.to_string())
}

const BED: &str = "sea_bed.flat_m = 50";
const ACROSS: &str =
    "[[keep_out]]\nname = \"range\"\npolygon = [[400, -600], [700, -600], [700, 450], [400, 450]]";

fn flown(scenario: &Scenario) -> Summary {
    let routes = GaRoute::new(GaSettings::default());
    let paths = PsoPath::new(PathSearch::default());
    simulate(scenario, &Stepped::new(&routes, &paths), &mut ()).unwrap()
}

/// Flies the mission, which must be home with its task and no limit broken. Returns its time, seconds.
fn home_s(bed: &str, fences: &str) -> f64 {
    let scenario = scenario(bed, fences).unwrap();
    // What is covered by cylinders is told.
    let told = scenario
        .warnings
        .iter()
        .filter(|text| !text.contains("cylinders cover it"));
    assert_eq!(told.count(), 0);
    let partial = fences.contains("depth_m") || fences.contains("from") || fences.contains("until");
    assert_eq!(scenario.warnings.is_empty(), !partial);
    let summary = flown(&scenario);
    assert_eq!(
        (summary.outcome, summary.tasks),
        (MissionOutcome::Docked, 1),
        "{fences}"
    );
    let judgement = &summary.judgement;
    assert_eq!(judgement.limits_broken, [], "{fences}");
    assert_eq!(judgement.min_altitude_m.is_finite(), !bed.is_empty());
    summary.time_s
}

#[test]
fn the_vehicle_flies_round_what_is_closed_at_all_depths() {
    let open_s = home_s(BED, "");
    for bed in [BED, ""] {
        let round_s = home_s(bed, ACROSS);
        assert!(round_s > open_s + 20.0, "{round_s} {open_s}");
    }
    // A corridor that is kept, with a hole in it.
    let corridor = "[[keep_in]]\npolygon = [[-300, -300], [2300, -300], [2300, 900], [-300, 900]]";
    home_s(BED, &format!("{corridor}\n{ACROSS}"));
    let shallow = format!("{corridor}\ndepth_m = [0, 12]\nuntil = 900");
    let bounds = scenario(BED, &shallow).unwrap().mission.bounds.unwrap();
    assert!((bounds.high.z - 12.0).abs() < 1e-12);
}

#[test]
fn it_dives_under_what_is_closed_near_the_surface_and_waits_for_no_other_day() {
    // Ice over the way, 6 m thick: the way at 10 m stays open but for the margin.
    let ice = ACROSS.replace("\"range\"", "\"ice\"") + "\ndepth_m = [0, 4]";
    let open_s = home_s(BED, "");
    assert!(home_s(BED, &ice) < open_s + 120.0);
    // Closed from tomorrow on.
    let later = ACROSS.to_owned() + "\nfrom = \"2026-06-02T08:00:00Z\"";
    assert!(home_s(BED, &later) < open_s + 1.0);
    // Closed for the first quarter of an hour: the vehicle goes round, or waits.
    let soon = ACROSS.to_owned() + "\nuntil = 900";
    home_s(BED, &soon);
}

#[test]
fn an_error_of_place_closes_no_depth_under_the_ice() {
    // 20 m of error where the way is longest: the box ends 43 m below the ice.
    let ice = ACROSS.replace("[700, 450], [400, 450]", "[700, 1400], [400, 1400]");
    let drifting = "[navigation]\ndrift_percent = 1";
    home_s(BED, &format!("{ice}\ndepth_m = [0, 2]\n{drifting}"));
}

#[test]
fn what_is_wrong_is_said_by_name_with_the_remedy() {
    let refused = |fences: &str| scenario(BED, fences).unwrap_err();
    for (fences, parts) in [
        (
            "[[keep_out]]\nname = \"x\"\npolygon = [[0, 0], [1, 1]]",
            &["keep_out[0] (x).polygon", "give 3"][..],
        ),
        (
            "[[keep_out]]\npolygon = [[900, 400], [1100, 400], [1100, 600], [900, 600]]",
            &["waypoints[1] (c)", "keep_out", "move one"],
        ),
        (
            "[[keep_in]]\npolygon = [[-300, -300], [1900, -300], [1900, 900], [-300, 900]]",
            &["waypoints[2] (b)", "keep_in", "move one"],
        ),
        (
            "[[keep_out]]\npolygon = [[900, 400], [1100, 400], [1100, 600], [900, 600]]\ndepth_m = [5, 20]",
            &["waypoints[1] (c)", "lies in a keep_out"],
        ),
        (
            "[[keep_out]]\npolygon = [[-60, -60], [60, -60], [60, 60], [-60, 60]]\nuntil = 900",
            &["waypoints[0] (a)", "lies in a keep_out", "move one"],
        ),
        (
            "[[keep_in]]\npolygon = [[-300, -300], [2300, -300], [2300, 900], [-300, 900]]\nuntil = 600\n\
             [[keep_in]]\npolygon = [[-300, -300], [2300, -300], [2300, 900], [-300, 900]]",
            &["keep_in[1]", "give all the same"],
        ),
        (
            "[[keep_in]]\npolygon = [[-300, -300], [2300, -300], [2300, 900], [-300, 900]]\ndepth_m = [900, 1000]",
            &["keep_in[0].depth_m", "[box] depth_m"],
        ),
        (
            "[[keep_out]]\npolygon = [[400, 0], [500, 0], [500, 50]]\nfrom = 900\nuntil = 100",
            &["keep_out[0].until", "800 s before from; give a later time"],
        ),
        (
            "[[keep_out]]\npolygon = [[400, 0], [500, 0], [500, 50]]\nfrom = \"tomorrow\"",
            &["keep_out[0].from", "not a time in UTC"],
        ),
        (
            "[[keep_out]]\npolygon = [[400, 0], [500, 0], [500, 50]]\ndepth_m = [20, 5]",
            &["keep_out[0].depth_m", "give [least, greatest]"],
        ),
        (
            "[[keep_out]]\npolygon = [[400, 0], [500, 0], [500, 50]]\ndepth_m = [-5, -1]",
            &[
                "keep_out[0].depth_m",
                "above the surface; give depths below it",
            ],
        ),
        (
            "[[keep_out]]\npolygon = [[400, 0], [500, 0], 7]",
            &[
                "line 17, column 11",
                "give [north, east, depth] in metres or { latitude_deg, longitude_deg, depth_m }",
            ],
        ),
    ] {
        let text = refused(fences);
        for part in parts {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert_eq!(text.lines().count(), 1, "{text}");
    }
    let degrees = "[[keep_out]]\npolygon = [{ latitude_deg = 50.004, longitude_deg = 0 }, { latitude_deg = 50.005, longitude_deg = 0 }, { latitude_deg = 50.004, longitude_deg = 0.002 }]";
    home_s(BED, degrees);
}
