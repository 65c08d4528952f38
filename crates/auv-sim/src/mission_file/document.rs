//! The schema of a mission file.

use super::MissionFileError;
use super::heights::Height;
use super::nearest_name::nearest;
use super::place::Place;
use super::plain_words::{key_before, list_too_long, plain};
use super::surveys::entry::SurveyEntry;
use super::surveys::line::{Drawn, Line};
use super::{utc, versions};
use crate::{Altimeter, Body, Preset};
use auv_graph::Task;
use auv_mission::{Contingency, Docking, EmergencyCause, Manner, Navigation, Pattern, Surfacing};
use auv_obstacles::ais::ColumnNames;
use auv_obstacles::truth::{AfterLastFix, ObstacleClass};
use auv_ocean::{AnalyticBed, AnalyticCurrent, DepthSigma, WaterLevel};
use serde::Deserialize;
use std::collections::BTreeMap;

/// A mission file as parsed. `docs/mission-file.md` explains every key with an example.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MissionFile {
    pub(super) version: u32,
    pub(super) name: String,
    #[serde(default)]
    pub(super) description: String,
    #[serde(default)]
    pub(super) credit: String,
    pub(super) preset: Preset,
    pub(super) start: String,
    pub(super) destination: Option<String>,
    /// Since version 2.
    pub(super) docks: Option<Vec<String>>,
    pub(super) budget_s: Option<f64>,
    pub(super) reserve_s: Option<f64>,
    pub(super) tick_s: Option<f64>,
    pub(super) guidance_error_m: Option<f64>,
    pub(super) clearance_m: Option<f64>,
    pub(super) contingencies: Option<Vec<Contingency>>,
    pub(super) datum: Option<Datum>,
    #[serde(rename = "box")]
    pub(super) extent: Option<Extent>,
    #[serde(default)]
    pub(super) altitude: AltitudeEntry,
    #[serde(default)]
    pub(super) vehicle: toml::Table,
    #[serde(default)]
    pub(super) sonar: toml::Table,
    #[serde(default)]
    pub(super) tracker: toml::Table,
    #[serde(default)]
    pub(super) clearance: toml::Table,
    #[serde(default)]
    pub(super) synchroniser: toml::Table,
    #[serde(default)]
    pub(super) obstacle_motion: toml::Table,
    pub(super) sea_bed: Option<SeaBedEntry>,
    pub(super) current: Option<CurrentEntry>,
    #[serde(default)]
    pub(super) tasks: BTreeMap<String, TaskEntry>,
    pub(super) waypoints: Vec<WaypointEntry>,
    /// Since version 2.
    #[serde(default)]
    pub(super) surveys: Vec<SurveyEntry>,
    /// The lines of the surveys.
    #[serde(skip)]
    pub(super) lines: Vec<Line>,
    #[serde(default)]
    pub(super) edges: Vec<EdgeEntry>,
    pub(super) connect: Option<Connect>,
    #[serde(default)]
    pub(super) obstacles: Vec<ObstacleEntry>,
    #[serde(default)]
    pub(super) obstacle_groups: Vec<GroupEntry>,
    #[serde(default)]
    pub(super) random_obstacles: usize,
    #[serde(default)]
    pub(super) ships: Vec<ShipEntry>,
    pub(super) ais: Option<AisEntry>,
    /// Since version 2.
    pub(super) water_level: Option<WaterLevel>,
    /// Since version 2.
    pub(super) altimeter: Option<Altimeter>,
    /// Since version 2.
    pub(super) navigation: Option<Navigation>,
    /// Since version 2.
    pub(super) docking: Option<Docking>,
    /// Since version 2.
    pub(super) surface: Option<SurfaceEntry>,
    /// Since version 2.
    pub(super) battery: Option<BatteryEntry>,
    /// Since version 2.
    #[serde(default)]
    pub(super) emergency: Vec<EmergencyEntry>,
    /// When mission time 0 is, in UTC. Since version 2. Times in UTC count from it before they are read.
    pub(super) launch: Option<toml::Value>,
    /// The same, seconds since 1970.
    #[serde(skip)]
    pub(super) launch_unix_s: Option<f64>,
    /// Since version 2.
    #[serde(default)]
    pub(super) keep_out: Vec<FenceEntry>,
    /// Since version 2.
    #[serde(default)]
    pub(super) keep_in: Vec<FenceEntry>,
    /// The body asked for instead of the file's.
    #[serde(skip)]
    pub(super) body: Option<Body>,
}

/// The position of the local origin.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Datum {
    pub(super) latitude_deg: f64,
    pub(super) longitude_deg: f64,
}

/// The box, in local metres or in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Extent {
    pub(super) north_m: Option<[f64; 2]>,
    pub(super) east_m: Option<[f64; 2]>,
    pub(super) latitude_deg: Option<[f64; 2]>,
    pub(super) longitude_deg: Option<[f64; 2]>,
    pub(super) depth_m: [f64; 2],
}

/// An area that the vehicle stays out of, or in.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct FenceEntry {
    pub(super) name: Option<String>,
    pub(super) polygon: Vec<Place>,
    pub(super) depth_m: Option<[f64; 2]>,
    pub(super) from: Option<f64>,
    pub(super) until: Option<f64>,
}

/// Energy as a budget beside time.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BatteryEntry {
    pub(super) usable_wh: f64,
    pub(super) hotel_w: f64,
    /// `[m/s through the water, watts]`.
    pub(super) propulsion: Vec<[f64; 2]>,
    #[serde(default = "reserve_percent")]
    pub(super) reserve_percent: f64,
}

const fn reserve_percent() -> f64 {
    15.0
}

/// Fixes at the surface from time to time.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SurfaceEntry {
    pub(super) every_s: f64,
    #[serde(default = "at_most_s")]
    pub(super) at_most_s: f64,
    /// Waypoints near which they are taken.
    #[serde(rename = "where")]
    pub(super) places: Option<Vec<String>>,
}

const fn at_most_s() -> f64 {
    Surfacing::every(0.0).at_most_s
}

/// What to do in an emergency.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EmergencyEntry {
    pub(super) when: EmergencyCause,
    #[serde(rename = "where")]
    pub(super) within: Option<Vec<Place>>,
    #[serde(rename = "do")]
    pub(super) ladder: Vec<Contingency>,
}

/// A fixed number, or an interval from which the seed draws a number uniformly.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "give a number or [low, high]")]
pub(super) enum DrawnNumber {
    Exactly(f64),
    Between([f64; 2]),
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AltitudeEntry {
    pub(super) least_m: Option<f64>,
    pub(super) sigmas: Option<f64>,
}

/// One of three kinds of sea bed.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct SeaBedEntry {
    pub(super) flat_m: Option<f64>,
    pub(super) analytic: Option<AnalyticBed>,
    pub(super) chart: Option<ChartEntry>,
    /// Since version 2.
    pub(super) truth: BedTruth,
    /// Since version 2.
    pub(super) correlation_m: Option<f64>,
}

/// What the true bed is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum BedTruth {
    /// The charted one.
    #[default]
    Chart,
    /// Drawn from the chart's standard deviation.
    Drawn,
}

#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ChartEntry {
    pub(super) file: Option<String>,
    /// What depths are measured from. Version 2.
    pub(super) datum: Option<String>,
    pub(super) cell_m: Option<f64>,
    pub(super) sigma: DepthSigma,
}

/// One of three kinds of current, and the error of its forecast.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct CurrentEntry {
    pub(super) still: Option<bool>,
    pub(super) analytic: Option<AnalyticCurrent>,
    pub(super) model: Option<ModelEntry>,
    pub(super) moves_vehicle: Option<bool>,
    pub(super) truth: Option<TruthEntry>,
}

#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct ModelEntry {
    pub(super) file: Option<String>,
    pub(super) cell_m: Option<f64>,
    pub(super) levels_m: Option<Vec<f64>>,
    /// `None`: by `launch`, or at the first record.
    pub(super) start_after_first_record_s: Option<f64>,
    /// Whether the first and the last record hold before and after. Version 2.
    pub(super) extrapolate: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct TruthEntry {
    pub(super) gain: DrawnNumber,
    pub(super) delay_s: DrawnNumber,
}

impl Default for TruthEntry {
    /// The truth equals the forecast.
    fn default() -> Self {
        Self {
            gain: DrawnNumber::Exactly(1.0),
            delay_s: DrawnNumber::Exactly(0.0),
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TaskEntry {
    pub(super) priority: f64,
    pub(super) risk: f64,
    /// Needed where there is no pattern.
    pub(super) time_s: Option<f64>,
    /// Since version 2.
    #[serde(default)]
    pub(super) mandatory: bool,
    /// Since version 2.
    #[serde(default)]
    pub(super) after: Vec<String>,
    /// Since version 2.
    #[serde(default)]
    pub(super) windows: Vec<[f64; 2]>,
    /// Since version 2.
    pub(super) pattern: Option<Pattern>,
    /// Since version 2.
    pub(super) speed_mps: Option<f64>,
    /// Since version 2.
    pub(super) altitude_m: Option<f64>,
    /// Since version 2.
    pub(super) depth_m: Option<f64>,
}

impl TaskEntry {
    /// How it is done at a place over a charted bed of so many metres; `None` where it is just stayed for.
    pub(super) fn manner(&self, bed_m: f64) -> Option<Manner> {
        let manner = Manner {
            pattern: self.pattern,
            speed_mps: self.speed_mps,
            depth_m: Height::given(self.depth_m, self.altitude_m).over_m(bed_m),
        };
        (manner != Manner::default()).then_some(manner)
    }

    pub(super) fn task(&self) -> Task {
        Task {
            priority: self.priority,
            risk: self.risk,
            completion_time_s: self.time_s.unwrap_or_default(),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WaypointEntry {
    pub(super) name: String,
    pub(super) at: Place,
    /// Done once per mission, on arrival over an edge without a task of its own.
    pub(super) task: Option<String>,
    /// Since version 2.
    pub(super) tasks: Option<Vec<String>>,
    /// The line of a survey that it is an end of.
    #[serde(skip)]
    pub(super) line: Option<usize>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct EdgeEntry {
    pub(super) from: String,
    pub(super) to: String,
    #[serde(default)]
    pub(super) directed: bool,
    pub(super) task: Option<String>,
    /// Since version 2.
    pub(super) tasks: Option<Vec<String>>,
    /// Since version 2.
    pub(super) speed_mps: Option<f64>,
    /// Since version 2.
    pub(super) altitude_m: Option<f64>,
    /// Since version 2.
    pub(super) depth_m: Option<f64>,
    /// What it is to a survey.
    #[serde(skip)]
    pub(super) drawn: Option<Drawn>,
}

/// Edges found automatically.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Connect {
    /// Number of nearest waypoints, by guide length, that each waypoint is connected to.
    pub(super) nearest: usize,
    /// Greatest length of an edge, metres.
    pub(super) within_m: Option<f64>,
    /// Cell size of the map in which edges are routed, metres.
    pub(super) cell_m: Option<f64>,
    /// Waypoints connected by listed edges only.
    #[serde(default)]
    pub(super) except: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObstacleEntry {
    #[serde(default)]
    pub(super) name: String,
    pub(super) class: ObstacleClass,
    pub(super) at: Place,
    pub(super) radius_m: DrawnNumber,
    pub(super) top_m: Option<f64>,
    pub(super) bottom_m: Option<f64>,
    #[serde(default)]
    pub(super) velocity_mps: [f64; 3],
    pub(super) uncertainty_m: Option<f64>,
    #[serde(default)]
    pub(super) appears_s: f64,
    /// Greatest random offset from its position, metres.
    #[serde(default)]
    pub(super) scatter_m: f64,
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GroupEntry {
    #[serde(default)]
    pub(super) name: String,
    pub(super) class: ObstacleClass,
    pub(super) count: usize,
    pub(super) north_m: [f64; 2],
    pub(super) east_m: [f64; 2],
    pub(super) depth_m: DrawnNumber,
    pub(super) radius_m: DrawnNumber,
    pub(super) top_m: Option<f64>,
    pub(super) bottom_m: Option<f64>,
    pub(super) speed_mps: Option<DrawnNumber>,
    pub(super) uncertainty_m: Option<f64>,
    /// Least initial distance of a surface from any waypoint, metres.
    #[serde(default = "default_clear_m")]
    pub(super) clear_of_waypoints_m: f64,
}

fn default_clear_m() -> f64 {
    100.0
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ShipEntry {
    pub(super) name: String,
    pub(super) length_m: f64,
    pub(super) draught_m: f64,
    /// One `[seconds, metres north, metres east]` per fix.
    pub(super) timetable: Vec<[f64; 3]>,
    #[serde(default)]
    pub(super) after_last_fix: AfterLastFix,
    /// Its delay, seconds.
    pub(super) delay_s: Option<DrawnNumber>,
}

#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct AisEntry {
    pub(super) file: Option<String>,
    pub(super) shift_north_m: f64,
    pub(super) shift_east_m: f64,
    pub(super) after_last_fix: AfterLastFix,
    pub(super) assumed_length_m: Option<f64>,
    pub(super) assumed_draught_m: Option<f64>,
    /// Greatest speed between two fixes of one track, m/s.
    pub(super) fastest_mps: Option<f64>,
    /// Names of columns. Version 2.
    pub(super) columns: Option<ColumnNames>,
}

impl MissionFile {
    /// The newest version of the schema. Files of version 1 keep their meaning.
    pub const VERSION: u32 = 2;

    /// Reads a mission file.
    ///
    /// # Errors
    /// Text that is not TOML, another version, unknown or missing keys, keys of a later version, values of
    /// the wrong type. Values out of range are found by [`MissionFile::scenario`].
    pub fn from_toml(text: &str) -> Result<Self, MissionFileError> {
        let syntax = |error: &toml::de::Error| MissionFileError::Syntax(explained(text, error));
        let table: toml::Table = toml::from_str(text).map_err(|error| syntax(&error))?;
        match table.get("version") {
            None => Err(MissionFileError::Syntax(
                "the key `version` is missing: begin the file with version = 1 or 2".into(),
            )),
            Some(&toml::Value::Integer(version @ 1..=2)) => {
                let launch_unix_s = utc::launch_unix_s(&table)?;
                let in_seconds = utc::in_seconds(text, launch_unix_s)?;
                let seconds = in_seconds.as_deref().unwrap_or(text);
                let mut file: Self = toml::from_str(seconds).map_err(|error| syntax(&error))?;
                no_list_too_long(seconds)?;
                file.launch_unix_s = launch_unix_s;
                file.expand();
                match versions::too_new(text, version) {
                    Some(key) => Err(MissionFileError::Syntax(format!(
                        "the key `{key}` is not in version 1: set version = 2; see docs/mission-file.md"
                    ))),
                    None => Ok(file),
                }
            }
            Some(other) => Err(MissionFileError::Syntax(format!(
                "version = {other} is not understood: give version = 1 or 2"
            ))),
        }
    }

    /// The mission's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file's description; may be empty.
    #[must_use]
    pub fn description(&self) -> &str {
        &self.description
    }

    /// The credit its data require; may be empty.
    #[must_use]
    pub fn credit(&self) -> &str {
        &self.credit
    }

    /// When mission time 0 is, seconds since 1970 UTC; `None` if the file does not say.
    #[must_use]
    pub fn launch_unix_s(&self) -> Option<f64> {
        self.launch_unix_s
    }

    /// The preset.
    #[must_use]
    pub fn preset(&self) -> Preset {
        self.preset
    }

    /// The name of its bathymetry file.
    #[must_use]
    pub fn bathymetry_file(&self) -> Option<&str> {
        self.sea_bed.as_ref()?.chart.as_ref()?.file.as_deref()
    }

    /// The name of its current model file.
    #[must_use]
    pub fn currents_file(&self) -> Option<&str> {
        self.current.as_ref()?.model.as_ref()?.file.as_deref()
    }

    /// The name of its file of ship tracks.
    #[must_use]
    pub fn ais_file(&self) -> Option<&str> {
        self.ais.as_ref()?.file.as_deref()
    }

    /// The shift of its ship tracks north and east, metres; `None` without ship tracks.
    #[must_use]
    pub fn tracks_shifted_m(&self) -> Option<[f64; 2]> {
        self.ais
            .as_ref()
            .map(|ais| [ais.shift_north_m, ais.shift_east_m])
    }
}

/// Refuses lists with more entries than their keys take: a file that is read as text drops them.
fn no_list_too_long(text: &str) -> Result<(), MissionFileError> {
    let table = toml::from_str::<toml::Table>(text);
    let error = table.and_then(toml::Table::try_into::<MissionFile>).err();
    let told = error.map(|error| error.to_string().trim().replace('\n', " "));
    match told.and_then(|told| list_too_long(&told)) {
        Some(told) => Err(MissionFileError::Syntax(format!(
            "{told}; see docs/mission-file.md"
        ))),
        None => Ok(()),
    }
}

/// A TOML error in one line, with its line and column.
fn explained(text: &str, error: &toml::de::Error) -> String {
    let message = error.message().trim().replace('\n', ": ");
    let message = nearest(&message).unwrap_or(message);
    let key = error.span().and_then(|span| key_before(text, span.start));
    let message = plain(&message, key).unwrap_or(message);
    let remedy = "see docs/mission-file.md";
    let Some(span) = error.span() else {
        return format!("{message}; {remedy}");
    };
    let before = text.get(..span.start).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|&c| c != '\n').count() + 1;
    format!("line {line}, column {column}: {message}; {remedy}")
}
