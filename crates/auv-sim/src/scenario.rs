//! One simulated mission with its true sea.

use crate::{Altimeter, Body, Fences, Preset};
use auv_graph::NodeId;
use auv_mission::{Mission, SyncSettings};
use auv_obstacles::truth::{Obstacle, ObstacleField};
use auv_obstacles::{ClearancePolicy, Region, ShipForecast, Sonar, TimedPoint, TrackerSettings};
use auv_ocean::{CurrentField, LevelledBed, SeaBed, WaterLevel};
use auv_types::{Seed, Violations};
use std::sync::Arc;

/// A mission with its true sea.
///
/// The synchroniser sees `mission`, the charted obstacles and the regions predicted from scans; `field`,
/// `true_current` and `true_bed` are the truth.
#[derive(Clone, Debug)]
pub struct Scenario {
    /// The mission's name, for logs.
    pub name: String,
    /// The name of its preset, for logs: `paper`, `default`, ...
    pub preset: String,
    /// The mission as the synchroniser knows it.
    pub mission: Arc<Mission>,
    /// Settings of the synchroniser.
    pub settings: SyncSettings,
    /// The true obstacles at mission time 0.
    pub field: ObstacleField,
    /// The true current. It moves drifting obstacles, and the vehicle if `current_moves_vehicle`.
    pub true_current: Option<Arc<dyn CurrentField>>,
    /// Whether the current moves the vehicle.
    pub current_moves_vehicle: bool,
    /// The true sea bed below the chart's datum; `None`: the mission's.
    pub true_bed: Option<Arc<dyn SeaBed>>,
    /// The true height of the surface above the chart's datum: it deepens the water over the true bed.
    /// `None`: 0 m. Depths of the vehicle, of waypoints, of the box and of obstacles are measured from the
    /// surface of the moment.
    pub water_level: Option<WaterLevel>,
    /// Areas that the vehicle stays out of, or in. [`Fences::walled_bed`] makes planners keep off them; the regions
    /// of those that hold for a time or at some depths are predicted with the obstacles.
    pub fences: Fences,
    /// The altimeter (`None`: the vehicle has none).
    pub altimeter: Option<Altimeter>,
    /// The sonar.
    pub sonar: Sonar,
    /// The tracker.
    pub tracker: TrackerSettings,
    /// Margins by source of a region, in addition to the mission's clearance.
    pub clearance: ClearancePolicy,
    /// Time between two ticks of the synchroniser and between two scans, seconds.
    pub tick_s: f64,
    /// The body of the simulated vehicle.
    pub body: Body,
    /// Greatest guidance error, metres: a slow, bounded deviation from the trajectory.
    pub guidance_error_m: f64,
    /// Seed of all random draws during the mission.
    pub seed: Seed,
    /// What was left out of the mission as it was written, and why.
    pub warnings: Vec<String>,
}

impl Scenario {
    /// The place of what was left out in the list of what is wrong.
    pub(crate) const TO_KNOW: &'static str = "to know";

    /// A mission among true obstacles, with the values of [`Preset::Default`]: [`Scenario::with_preset`].
    ///
    /// ```
    /// use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
    /// use auv_mission::Mission;
    /// use auv_mission::driver::Stepped;
    /// use auv_obstacles::truth::{Obstacle, ObstacleClass};
    /// use auv_planning::baseline::{GreedyRoute, StraightPath};
    /// use auv_sim::{MissionOutcome, Preset, Scenario, simulate};
    /// use auv_types::{Point3, Seed};
    ///
    /// let values = Preset::Default.values();
    /// let ends = [0.0, 900.0].map(|north_m| Waypoint::at(Point3::new(north_m, 0.0, 20.0)));
    /// let edges = [Edge::directed(0, 1, Task::TRANSIT)];
    /// let network = Network::new(&ends, &edges, values.vehicle.speed_mps)?;
    /// let mission = Mission::new(network.into(), NodeId(0), NodeId(1), 1_200.0, values.vehicle);
    /// let wreck = Obstacle::new(ObstacleClass::Static, Point3::new(450.0, 200.0, 20.0), 30.0);
    ///
    /// let scenario = Scenario::new(mission, vec![wreck], Seed(1))?;
    /// let summary = simulate(&scenario, &Stepped::new(&GreedyRoute, &StraightPath), &mut ())?;
    /// assert_eq!(summary.outcome, MissionOutcome::Docked);
    /// # Ok::<(), auv_types::Violations>(())
    /// ```
    ///
    /// # Errors
    /// Everything malformed about the obstacles.
    pub fn new(
        mission: impl Into<Arc<Mission>>,
        obstacles: Vec<Obstacle>,
        seed: Seed,
    ) -> Result<Self, Violations> {
        Self::with_preset(Preset::Default, mission, obstacles, seed)
    }

    /// A mission among true obstacles, with the values of a preset.
    ///
    /// Synchroniser, sonar, tracker, margins, obstacle motion, tick and guidance error are the preset's.
    /// Arcs that the vehicle has no room to fly are closed with a warning:
    /// [`Mission::close_arcs_without_room`]. Ways in the current are found: [`Mission::find_fronts`]. The true current and the true sea bed are those the mission states; the current moves the
    /// vehicle. All fields may be changed afterwards.
    ///
    /// Vehicle, budget, reserve and altitude belong to the mission: take them from [`Preset::values`].
    ///
    /// # Errors
    /// Everything malformed about the obstacles.
    pub fn with_preset(
        preset: Preset,
        mission: impl Into<Arc<Mission>>,
        obstacles: Vec<Obstacle>,
        seed: Seed,
    ) -> Result<Self, Violations> {
        let (mut mission, values) = (mission.into(), preset.values());
        Arc::make_mut(&mut mission).find_fronts();
        let is_valid = mission.validate().is_empty();
        let warnings = if is_valid {
            let closed = Arc::make_mut(&mut mission).close_arcs_without_room();
            closed.into_iter().map(|(_, text)| text).collect()
        } else {
            Vec::new()
        };
        Ok(Self {
            name: "unnamed".into(),
            preset: preset.as_str().into(),
            field: ObstacleField::new(obstacles, values.obstacle_motion, seed.split(2))?,
            true_current: mission.current.clone(),
            current_moves_vehicle: mission.current.is_some(),
            mission,
            settings: values.synchroniser,
            true_bed: None,
            water_level: None,
            fences: Fences::default(),
            altimeter: None,
            sonar: values.sonar,
            tracker: values.tracker,
            clearance: values.clearance,
            tick_s: values.tick_s,
            body: values.body,
            guidance_error_m: values.guidance_error_m,
            seed: seed.split(3),
            warnings,
        })
    }

    /// The mission's bed without the walls of fences.
    #[must_use]
    pub fn open_bed(&self) -> Option<&Arc<dyn SeaBed>> {
        if self.fences.is_empty() {
            self.mission.sea_bed.as_ref()
        } else {
            self.fences.open_bed.as_ref()
        }
    }

    /// How far ahead ships are predicted from their transponders: until the vehicle can have left their way,
    /// and at least as far as contacts are.
    #[must_use]
    pub fn ship_forecast(&self) -> ShipForecast {
        let vehicle = &self.mission.vehicle;
        ShipForecast {
            speed_mps: vehicle.speed_mps,
            turn_radius_m: vehicle.turn_radius_m,
            least_s: self.tracker.horizon_s,
        }
    }

    /// The true bed below the surface of a moment, with the lower of the levels at two times; `None`
    /// without a bed.
    pub(crate) fn bed_between(
        &self,
        from_s: f64,
        until_s: f64,
    ) -> Option<LevelledBed<&dyn SeaBed>> {
        let bed = self.true_bed.as_ref().or(self.open_bed());
        let bed = bed.map(|bed| &**bed);
        let level_m = self
            .water_level
            .as_ref()
            .map_or(0.0, |level| level.at(from_s).min(level.at(until_s)));
        bed.map(|bed| LevelledBed::new(bed, level_m))
    }

    /// A vehicle docks nowhere if every place to end at lies inside a charted obstacle, which stays. Where
    /// obstacles move, time may open the way.
    fn require_uncharted_destinations(&self, violations: &mut Violations) {
        let mission = &self.mission;
        let charted = self.field.charted();
        let covering = |node: &NodeId| {
            let place = TimedPoint::new(mission.position_of(*node), 0.0);
            let lies_in = |region: &&Region| region.distance_m(&place) <= 0.0;
            let region = charted.iter().find(lies_in)?;
            Some((*node, region.obstacle, -region.distance_m(&place)))
        };
        let ends = || std::iter::once(&mission.destination).chain(&mission.docks);
        if !ends().all(|node| covering(node).is_some()) {
            return;
        }
        for (node, obstacle, depth_m) in ends().filter_map(covering) {
            let (name, number) = (mission.network.name_of(node), obstacle.0);
            violations.push(
                format!("destination (waypoint {name})"),
                format!(
                    "lies {depth_m:.1} m inside obstacles[{number}], which is charted and stays; move the waypoint or the obstacle"
                ),
            );
        }
    }

    /// Every invalid value of the scenario, of its mission and of its settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.absorb("", self.mission.validate());
        violations.absorb("synchroniser.", self.settings.validate());
        violations.absorb("sonar.", self.sonar.validate());
        violations.absorb("tracker.", self.tracker.validate());
        violations.absorb("clearance.", self.clearance.validate());
        if let Some(level) = &self.water_level {
            violations.absorb("water_level.", level.validate());
        }
        if let Some(altimeter) = &self.altimeter {
            violations.absorb("altimeter.", altimeter.validate());
        }
        violations.absorb("vehicle.", self.body.validate(&self.mission.vehicle));
        violations.require_positive(self.tick_s, "tick_s");
        violations.require_not_negative(self.guidance_error_m, "guidance_error_m");
        let start = self.mission.position_of(self.mission.start);
        let room_m = self.field.distance_m(&start);
        violations.require(room_m > 0.0, "start", || {
            format!(
                "lies {:.1} m inside an obstacle; move the start or the obstacle",
                -room_m
            )
        });
        self.require_uncharted_destinations(&mut violations);
        if !violations.is_empty() {
            // What was left out may be what is missing.
            for warning in &self.warnings {
                violations.push(Self::TO_KNOW, warning);
            }
        }
        violations
    }
}
