//! The scene file: one leg among obstacles, as JSON (feature `serde`).
//!
//! ```json
//! {"id": "gate", "speed": 3.0, "start": [0, 0, 20], "target": [600, 0, 20],
//!  "bounds": {"lo": [-100, -300, 0], "hi": [700, 300, 100]},
//!  "obstacles": [{"centre": [300, 10, 20], "radius": 40, "velocity": [0.1, 0, 0], "growth": 0.02}]}
//! ```
//! Metres (NED), m/s, seconds of mission time. At time `t` an obstacle is the ball `centre + velocity t`
//! of radius `radius + growth t`; `velocity` and `growth` are 0 where absent. `id`, `kind`, `n`, `seed`
//! and an obstacle's `kind` are notes: `n` must be the number of obstacles, of the others only the
//! type is checked. Unknown keys are rejected.
//!
//! Optional keys describe the vehicle and the sea:
//!
//! - `departure`: mission time of departure in seconds (0).
//! - `start_velocity`: velocity over ground at departure, `[north, east, down]` in m/s (any direction).
//! - `vehicle`: `{"turn_radius": m (0), "max_pitch_deg": degrees (90)}`. A vehicle without a turn radius
//!   may hover, one with a turn radius keeps its speed.
//! - `clearance`: least distance to obstacles in metres (0).
//! - `min_altitude`: least altitude above the bed in metres (0).
//! - `current` and `bed`: the water on a grid; see [`GriddedCurrent`] and [`GriddedBed`].
//!
//! ```json
//! {"current": {"grid": {"north_m": 0, "east_m": 0, "cell_m": 100, "rows": 2, "columns": 2},
//!              "levels_m": [0], "times": [0], "velocities": [[0.1, 0], [0.1, 0], [0.2, 0], [0.2, 0]]},
//!  "bed": {"grid": {"north_m": 0, "east_m": 0, "cell_m": 100, "rows": 2, "columns": 2},
//!          "depths": [40, 40, 60, 60]}}
//! ```
//!
//! `velocities` are m/s `[north, east]` by time, level and node, `levels_m` depths (absent: the same
//! current at all depths), `depths` metres by node.

mod water;

use crate::{PathProblem, Vehicle};
use auv_obstacles::{ObstacleId, Region};
use auv_ocean::{CurrentField, GriddedBed, GriddedCurrent, SeaBed};
use auv_types::{Bounds, Point3, Vector3, Violations};
use serde::Deserialize;
use thiserror::Error;

/// Largest scene file accepted, bytes.
pub const MAX_SCENE_BYTES: usize = 16 << 20;
/// Most obstacles of a scene.
pub const MAX_OBSTACLES: usize = 100_000;
/// Longest text value of a scene, bytes.
pub const MAX_TEXT_BYTES: usize = 256;

/// A leg among obstacles; [`Scene::problem`] gives it as a path problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The scene's own name (empty: none given).
    pub id: String,
    /// Where the vehicle is at departure, metres.
    pub start: Point3<f64>,
    /// Where the leg ends, metres.
    pub target: Point3<f64>,
    /// The box the vehicle must stay in.
    pub bounds: Option<Bounds>,
    /// A vehicle of the scene's speed, without turn or pitch limit unless the scene gives one.
    pub vehicle: Vehicle,
    /// The obstacles; their ids are their indices.
    pub regions: Vec<Region>,
    /// Mission time of departure, seconds.
    pub departure_s: f64,
    /// Velocity over ground at departure, m/s (`None`: any direction).
    pub start_velocity: Option<Vector3<f64>>,
    /// Least distance to obstacles, metres.
    pub clearance_m: f64,
    /// Least altitude above the bed, metres.
    pub min_altitude_m: f64,
    /// The current (`None`: still water).
    pub current: Option<GriddedCurrent>,
    /// The sea bed (`None`: none to avoid).
    pub bed: Option<GriddedBed>,
}

/// Why a scene could not be read.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file is larger than [`MAX_SCENE_BYTES`].
    #[error("is {bytes} bytes long; scenes have at most {MAX_SCENE_BYTES}")]
    TooLarge {
        /// Its length.
        bytes: usize,
    },
    /// Not JSON, or not a scene.
    #[error("line {line}, column {column}: {message}")]
    Json {
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What is wrong there.
        message: String,
    },
    /// Well-formed, but with invalid values; all of them are listed.
    #[error("{0}")]
    Invalid(Violations),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    #[serde(default)]
    id: String,
    #[serde(default)]
    kind: String,
    n: Option<usize>,
    #[serde(rename = "seed")]
    _seed: Option<u64>,
    speed: f64,
    start: [f64; 3],
    target: [f64; 3],
    bounds: Option<BoundsFile>,
    obstacles: Vec<ObstacleFile>,
    #[serde(default)]
    departure: f64,
    start_velocity: Option<[f64; 3]>,
    #[serde(default)]
    vehicle: VehicleFile,
    #[serde(default)]
    clearance: f64,
    #[serde(default)]
    min_altitude: f64,
    current: Option<water::CurrentFile>,
    bed: Option<water::BedFile>,
}

#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
struct VehicleFile {
    turn_radius: f64,
    max_pitch_deg: f64,
}

impl Default for VehicleFile {
    fn default() -> Self {
        Self {
            turn_radius: 0.0,
            max_pitch_deg: VERTICAL_DEG,
        }
    }
}

/// No pitch limit, degrees.
const VERTICAL_DEG: f64 = 90.0;
/// Greatest speed of a scene's vehicle as a multiple of its speed. On a piece of a path the vehicle keeps
/// its speed through the water in the mean; where the current changes along the piece it is up to this
/// much faster or slower.
const MOST_SPEED: f64 = 1.005;

impl VehicleFile {
    /// A vehicle that turns on the spot may hover; one with a turn radius keeps its speed.
    fn vehicle(&self, speed_mps: f64) -> Vehicle {
        Vehicle {
            speed_mps,
            min_speed_mps: if self.turn_radius > 0.0 {
                speed_mps
            } else {
                0.0
            },
            max_speed_mps: speed_mps * MOST_SPEED,
            turn_radius_m: self.turn_radius,
            max_pitch_rad: self.max_pitch_deg.to_radians(),
        }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BoundsFile {
    lo: [f64; 3],
    hi: [f64; 3],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObstacleFile {
    centre: [f64; 3],
    radius: f64,
    #[serde(default)]
    velocity: [f64; 3],
    #[serde(default)]
    growth: f64,
    #[serde(default)]
    kind: String,
}

impl Scene {
    /// Reads a scene.
    ///
    /// # Errors
    /// [`SceneError`]: a file too large, malformed JSON with its place, or the list of all
    /// offending values.
    pub fn from_json(bytes: &[u8]) -> Result<Self, SceneError> {
        if bytes.len() > MAX_SCENE_BYTES {
            return Err(SceneError::TooLarge { bytes: bytes.len() });
        }
        let file: SceneFile = serde_json::from_slice(bytes).map_err(|error| SceneError::Json {
            line: error.line(),
            column: error.column(),
            message: explained(bytes, &error),
        })?;
        let mut violations = file.validate();
        let scene = file.into_scene(&mut violations);
        violations.absorb("", scene.problem().validate().renamed(name_in_the_file));
        match violations.into_result() {
            Ok(()) => Ok(scene),
            Err(violations) => Err(SceneError::Invalid(violations)),
        }
    }

    /// The problem of this scene.
    #[must_use]
    pub fn problem(&self) -> PathProblem<'_> {
        PathProblem {
            start_velocity: self.start_velocity,
            departure_s: self.departure_s,
            bounds: self.bounds,
            sea_bed: self.bed.as_ref().map(|bed| bed as &dyn SeaBed),
            min_altitude_m: self.min_altitude_m,
            current: self
                .current
                .as_ref()
                .map(|field| field as &dyn CurrentField),
            regions: &self.regions,
            clearance_m: self.clearance_m,
            ..PathProblem::new(self.start, self.target, &self.vehicle)
        }
    }
}

/// What the file calls a place of the problem.
fn name_in_the_file(place: &str) -> String {
    const NAMES: [(&str, &str); 7] = [
        ("regions[", "obstacles["),
        ("vehicle.speed_mps", "speed"),
        ("vehicle.turn_radius_m", "vehicle.turn_radius"),
        ("vehicle.max_pitch_rad", "vehicle.max_pitch_deg"),
        ("departure_s", "departure"),
        ("clearance_m", "clearance"),
        ("min_altitude_m", "min_altitude"),
    ];
    let renamed = |name: String, (from, to): &(&str, &str)| name.replace(from, to);
    NAMES.iter().fold(place.to_owned(), renamed)
}

/// The error without serde_json's own " at line 1 column 2", and what to give instead.
fn explained(bytes: &[u8], error: &serde_json::Error) -> String {
    let holds = |text: &str| {
        let mut windows = bytes.windows(text.len());
        windows.any(|window| window == text.as_bytes())
    };
    if bytes.trim_ascii().is_empty() {
        return format!("the file is empty; {FORM}");
    }
    if holds("\"auv-route-1\"") {
        return format!("this is an instance for a route planner; {FORM}");
    }
    let message = error.to_string();
    let end = message.rfind(" at line ").unwrap_or(message.len());
    format!("{}; {FORM}", &message[..end])
}

/// What a scene looks like.
const FORM: &str = "give one JSON object with start [x, y, z], target [x, y, z], speed and obstacles \
                    [{centre, radius}] at least";

impl SceneFile {
    /// Errors that the problem's own validation does not find.
    fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let mut short = |text: &str, place: &str| {
            violations.require(text.len() <= MAX_TEXT_BYTES, place, || {
                format!("has {} bytes; give at most {MAX_TEXT_BYTES}", text.len())
            });
        };
        short(&self.id, "id");
        short(&self.kind, "kind");
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            if !obstacle.kind.is_empty() {
                short(&obstacle.kind, &format!("obstacles[{i}].kind"));
            }
        }
        let count = self.obstacles.len();
        violations.require(count <= MAX_OBSTACLES, "obstacles", || {
            format!("has {count} entries; give at most {MAX_OBSTACLES}")
        });
        violations.require(self.n.is_none_or(|n| n == count), "n", || {
            format!("is not the number of obstacles, {count}; correct or remove it")
        });
        violations
    }

    /// The scene, without a current or a bed that is malformed: that is a violation.
    fn into_scene(self, violations: &mut Violations) -> Scene {
        let obstacles = self.obstacles.iter().enumerate();
        let regions = obstacles
            .map(|(i, obstacle)| Region {
                obstacle: ObstacleId(u32::try_from(i).unwrap_or(u32::MAX)),
                velocity_mps: Vector3::from(obstacle.velocity),
                growth_mps: obstacle.growth,
                ..Region::ball(Point3::from(obstacle.centre), obstacle.radius)
            })
            .collect();
        let current = self.current.map(water::CurrentFile::field);
        let bed = self.bed.map(water::BedFile::bed);
        Scene {
            id: self.id,
            start: Point3::from(self.start),
            target: Point3::from(self.target),
            bounds: self
                .bounds
                .map(|b| Bounds::new(Point3::from(b.lo), Point3::from(b.hi))),
            vehicle: self.vehicle.vehicle(self.speed),
            regions,
            departure_s: self.departure,
            start_velocity: self.start_velocity.map(Vector3::from),
            clearance_m: self.clearance,
            min_altitude_m: self.min_altitude,
            current: sound(current, "current.", violations),
            bed: sound(bed, "bed.", violations),
        }
    }
}

/// The value, or what is wrong with it.
fn sound<T>(
    read: Option<Result<T, Violations>>,
    place: &str,
    violations: &mut Violations,
) -> Option<T> {
    read?
        .map_err(|errors| violations.absorb(place, errors))
        .ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const GATE: &str = r#"{"id": "gate", "kind": "moving", "n": 1, "seed": 3, "speed": 3.0,
        "start": [0, 0, 20], "target": [600, 0, 20],
        "bounds": {"lo": [-100, -300, 0], "hi": [700, 300, 100]},
        "obstacles": [{"centre": [300, 10, 20], "radius": 40, "velocity": [0.1, 0, 0], "growth": 0.02,
                       "kind": "moving"}]}"#;

    #[test]
    fn reads_a_scene_as_a_problem() {
        let scene = Scene::from_json(GATE.as_bytes()).unwrap();
        let problem = scene.problem();
        assert_eq!(
            (scene.id.as_str(), problem.vehicle.speed_mps),
            ("gate", 3.0)
        );
        assert_eq!(
            problem.regions[0].centre_at(100.0),
            Point3::new(310.0, 10.0, 20.0)
        );
        assert_eq!(problem.regions[0].radius_at(100.0), 42.0);
        assert!(problem.validate().is_empty());
    }

    const SEA: &str = r#"{"speed": 1.5, "start": [0, 0, 20], "target": [600, 0, 20], "obstacles": [],
        "departure": 90, "start_velocity": [1.5, 0, 0], "clearance": 10, "min_altitude": 3,
        "vehicle": {"turn_radius": 20, "max_pitch_deg": 15},
        "current": {"grid": {"north_m": 0, "east_m": 0, "cell_m": 600, "rows": 2, "columns": 2},
                    "times": [0, 100], "velocities": [[0.1, 0], [0.1, 0], [0.1, 0], [0.1, 0],
                                                      [0.3, 0], [0.3, 0], [0.3, 0], [0.3, 0]]},
        "bed": {"grid": {"north_m": -600, "east_m": -600, "cell_m": 600, "rows": 3, "columns": 3},
                "depths": [9, 9, 9, 9, 50, 9, 9, 9, 9]}}"#;

    #[test]
    fn reads_the_sea_and_the_vehicle() {
        let scene = Scene::from_json(SEA.as_bytes()).unwrap();
        let problem = scene.problem();
        assert_eq!((problem.departure_s, problem.clearance_m), (90.0, 10.0));
        assert_eq!(problem.start_velocity, Some(Vector3::new(1.5, 0.0, 0.0)));
        assert!((problem.vehicle.max_pitch_rad - 15_f64.to_radians()).abs() < 1e-12);
        assert!(!problem.vehicle.can_hover());
        assert_eq!(problem.deepest_at(0.0, 0.0), 47.0);
        let water = problem.current.unwrap();
        let velocity = water.velocity_at(&Point3::new(300.0, 300.0, 20.0), 50.0);
        assert!((velocity.x - 0.2).abs() < 1e-6);
    }

    #[test]
    fn a_malformed_sea_is_named_in_the_words_of_the_file() {
        let bad = SEA
            .replace("[0, 100]", "[0]")
            .replace("50, 9", "50")
            .replace("\"turn_radius\": 20", "\"turn_radius\": -20")
            .replace("\"departure\": 90", "\"departure\": 90, \"max_pitch\": 3");
        let unknown = Scene::from_json(bad.as_bytes()).unwrap_err();
        assert!(matches!(unknown, SceneError::Json { .. }), "{unknown}");
        let bad = bad.replace(", \"max_pitch\": 3", "");
        let text = Scene::from_json(bad.as_bytes()).unwrap_err().to_string();
        for place in ["current.velocities", "bed.depths", "vehicle.turn_radius "] {
            assert!(text.contains(place), "{place} missing in: {text}");
        }
    }

    #[test]
    fn lists_every_offending_value() {
        let bad = GATE
            .replace("\"radius\": 40", "\"radius\": -40")
            .replace("\"speed\": 3.0", "\"speed\": 0")
            .replace("\"n\": 1", "\"n\": 2")
            .replace("-100, -300, 0", "900, -300, 0");
        let Err(SceneError::Invalid(violations)) = Scene::from_json(bad.as_bytes()) else {
            panic!("accepted")
        };
        let text = violations.to_string();
        for place in ["obstacles[0]", "speed", "n ", "bounds"] {
            assert!(text.contains(place), "{place} missing in: {text}");
        }
    }

    #[test]
    fn malformed_files_are_named_by_line_and_column() {
        let unknown = GATE.replace("\"growth\"", "\"grows\"");
        let twice = GATE.replace("\"seed\": 3", "\"speed\": 3");
        let huge = GATE.replace("600", "6e999");
        let cases = [
            &GATE[..90],
            &unknown,
            &twice,
            &huge,
            "[[[[",
            "\u{feff}{}",
            "",
            "{}",
        ];
        for text in cases {
            let error = Scene::from_json(text.as_bytes()).unwrap_err();
            assert!(matches!(error, SceneError::Json { .. }), "{error}");
        }
        assert!(Scene::from_json(&[0xff, 0xfe, b'{']).is_err());
        let long = vec![b' '; MAX_SCENE_BYTES + 1];
        assert!(matches!(
            Scene::from_json(&long),
            Err(SceneError::TooLarge { .. })
        ));
    }
}
