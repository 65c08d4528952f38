//! The scene file: one leg among obstacles, as JSON (feature `serde`).
//!
//! ```json
//! {"id": "gate", "speed": 3.0, "start": [0, 0, 20], "target": [600, 0, 20],
//!  "bounds": {"lo": [-100, -300, 0], "hi": [700, 300, 100]},
//!  "obstacles": [{"centre": [300, 10, 20], "radius": 40, "velocity": [0.1, 0, 0], "growth": 0.02}]}
//! ```
//! Metres (NED), m/s. At time `t` after departure an obstacle is the ball `centre + velocity t` of
//! radius `radius + growth t`; `velocity` and `growth` are 0 where absent. `id`, `kind`, `n`, `seed`
//! and an obstacle's `kind` are notes: `n` must be the number of obstacles, of the others only the
//! type is checked. Unknown keys are rejected.

use crate::{PathProblem, Vehicle};
use auv_obstacles::{ObstacleId, Region};
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
    /// A vehicle of the scene's speed, without turn or pitch limit.
    pub vehicle: Vehicle,
    /// The obstacles; their ids are their indices.
    pub regions: Vec<Region>,
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
        let scene = file.into_scene();
        let in_the_file = |place: &str| {
            let place = place.replace("regions[", "obstacles[");
            place.replace("vehicle.speed_mps", "speed")
        };
        violations.absorb("", scene.problem().validate().renamed(in_the_file));
        match violations.into_result() {
            Ok(()) => Ok(scene),
            Err(violations) => Err(SceneError::Invalid(violations)),
        }
    }

    /// The problem of this scene: departure at 0, clearance 0, no sea bed, still water.
    #[must_use]
    pub fn problem(&self) -> PathProblem<'_> {
        PathProblem {
            bounds: self.bounds,
            regions: &self.regions,
            ..PathProblem::new(self.start, self.target, &self.vehicle)
        }
    }
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

    fn into_scene(self) -> Scene {
        let obstacles = self.obstacles.iter().enumerate();
        let regions = obstacles
            .map(|(i, obstacle)| Region {
                obstacle: ObstacleId(u32::try_from(i).unwrap_or(u32::MAX)),
                velocity_mps: Vector3::from(obstacle.velocity),
                growth_mps: obstacle.growth,
                ..Region::ball(Point3::from(obstacle.centre), obstacle.radius)
            })
            .collect();
        Scene {
            id: self.id,
            start: Point3::from(self.start),
            target: Point3::from(self.target),
            bounds: self
                .bounds
                .map(|b| Bounds::new(Point3::from(b.lo), Point3::from(b.hi))),
            vehicle: Vehicle {
                speed_mps: self.speed,
                max_speed_mps: self.speed,
                ..Vehicle::paper()
            },
            regions,
        }
    }
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
