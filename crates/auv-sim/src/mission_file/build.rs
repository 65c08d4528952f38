//! From a mission file to a scenario.

use super::document::MissionFile;
use super::network::{Charted, network, node_of};
use super::obstacles::{Surroundings, field};
use super::preset::{Numbers, overridden};
use super::sea::{sea_bed, water};
use super::ships::ships;
use super::ways::Ways;
use super::{MissionData, MissionFileError, places};
use crate::Scenario;
use auv_graph::{Network, NodeId};
use auv_mission::Mission;
use auv_obstacles::truth::ObstacleField;
use auv_obstacles::{Region, RegionSource, TimedPoint};
use auv_planning::motion::Floor;
use auv_types::{Point3, Seed, Violations};
use std::sync::Arc;

impl MissionFile {
    /// The mission with its sea. The seed draws what the file leaves to chance: obstacles, how the
    /// truth differs from the forecast, delays of ships, noise.
    ///
    /// Deterministic. Beds need a map of the water: some tens of milliseconds.
    ///
    /// # Errors
    /// Everything wrong with the file's values, or the first of its data that is missing or damaged.
    pub fn scenario(
        &self,
        data: &MissionData<'_>,
        seed: Seed,
    ) -> Result<Scenario, MissionFileError> {
        let mut violations = Violations::new();
        let numbers = self.numbers(&mut violations);
        let frame = places::frame(self.datum, &mut violations);
        let frame = frame.as_ref();
        let bounds = places::bounds(self.extent.as_ref(), frame, &mut violations);
        let points = self.points(frame, &mut violations);
        let ends = self.ends(&mut violations);
        let bed = sea_bed(self, data, frame, bounds.as_ref(), &mut violations)?;
        let water = water(self, data, frame, (&points, seed.split(0)), &mut violations)?;
        let ships = ships(self, data, frame, seed.split(1), &mut violations)?;
        let [start, dock] = ends.unwrap_or_default();
        let around = Surroundings {
            frame,
            bounds: bounds.as_ref(),
            sea_bed: bed.as_deref(),
            waypoints: &points,
            start,
            dock,
            sonar_range_m: numbers.sonar.range_m,
        };
        let cell_m = self.connect.as_ref().and_then(|connect| connect.cell_m);
        places::check_cell(cell_m, "connect.cell_m", &mut violations);
        // Without waypoints nothing that is drawn around them makes sense.
        violations.into_result()?;

        let mut mission = Mission {
            reserve_s: self
                .reserve_s
                .unwrap_or(numbers.reserve_share * numbers.budget_s),
            bounds,
            sea_bed: bed.clone(),
            min_altitude_m: numbers.min_altitude_m,
            altitude_sigmas: numbers.altitude_sigmas,
            current: water.forecast.filter(|_| water.moves_vehicle),
            clearance_m: numbers.clearance_m,
            open_water: bed.is_none(),
            ..Mission::new(
                Arc::new(self.bare_network(&points, numbers.vehicle.speed_mps)?),
                NodeId(start as u32),
                NodeId(dock as u32),
                numbers.budget_s,
                numbers.vehicle,
            )
        };
        // Misplaced waypoints first: without them ways cannot be found, and blaming edges would mislead.
        mission.misplaced().into_result()?;

        let mut violations = Violations::new();
        let motion = numbers.obstacle_motion.clone();
        let field = field(self, motion, &around, seed.split(2), &mut violations);
        let field = field.map(|field| field.with_ships(ships));
        if let Some(field) = &field {
            self.check_room(&points, start, dock, field, &numbers, &mut violations);
        }
        violations.into_result()?;

        let mut violations = Violations::new();
        let floor = bed.as_deref().map(|bed| Floor {
            bed,
            min_altitude_m: numbers.min_altitude_m,
            altitude_sigmas: numbers.altitude_sigmas,
        });
        let pitch_rad = numbers.vehicle.max_pitch_rad;
        let ways = Ways::new(floor, bounds.as_ref(), cell_m, pitch_rad, &mut violations);
        let charted = ways.and_then(|ways| {
            let speed_mps = numbers.vehicle.speed_mps;
            network(self, &points, &ways, speed_mps, &mut violations)
        });
        violations.into_result()?;
        let (Some(charted), Some(field)) = (charted, field) else {
            return Err(MissionFileError::Syntax(
                "the mission could not be built".into(),
            ));
        };
        let Charted {
            network,
            guides,
            shared_tasks,
        } = charted;
        (mission.network, mission.guides) = (Arc::new(network), guides);
        mission.shared_tasks = shared_tasks;
        if let Some(ladder) = &self.contingencies {
            mission.contingencies.clone_from(ladder);
        }

        let scenario = Scenario {
            name: self.name.clone(),
            preset: self.preset.as_str().into(),
            mission: Arc::new(mission),
            settings: numbers.synchroniser,
            field,
            true_current: water.truth,
            current_moves_vehicle: water.moves_vehicle,
            true_bed: None,
            sonar: numbers.sonar,
            tracker: numbers.tracker,
            clearance: numbers.clearance,
            tick_s: numbers.tick_s,
            guidance_error_m: numbers.guidance_error_m,
            seed: seed.split(3),
        };
        scenario.validate().into_result()?;
        Ok(scenario)
    }

    /// The preset's numbers with the file's laid over them.
    fn numbers(&self, violations: &mut Violations) -> Numbers {
        let mut numbers = self.preset.numbers();
        numbers.vehicle = overridden(numbers.vehicle, &self.vehicle, "vehicle", violations);
        numbers.sonar = overridden(numbers.sonar, &self.sonar, "sonar", violations);
        let mut tracker = self.tracker.clone();
        if tracker.remove("sonar").is_some() {
            violations.push(
                "[tracker]",
                "has a sonar of its own; give [sonar], it holds for both",
            );
        }
        numbers.tracker = overridden(numbers.tracker, &tracker, "tracker", violations);
        numbers.tracker.sonar = numbers.sonar.clone();
        numbers.clearance = overridden(numbers.clearance, &self.clearance, "clearance", violations);
        numbers.synchroniser = overridden(
            numbers.synchroniser,
            &self.synchroniser,
            "synchroniser",
            violations,
        );
        numbers.obstacle_motion = overridden(
            numbers.obstacle_motion,
            &self.obstacle_motion,
            "obstacle_motion",
            violations,
        );
        let own = [
            (self.budget_s, &mut numbers.budget_s),
            (self.tick_s, &mut numbers.tick_s),
            (self.guidance_error_m, &mut numbers.guidance_error_m),
            (self.clearance_m, &mut numbers.clearance_m),
            (self.altitude.least_m, &mut numbers.min_altitude_m),
            (self.altitude.sigmas, &mut numbers.altitude_sigmas),
        ];
        for (given, number) in own {
            if let Some(given) = given {
                *number = given;
            }
        }
        violations.absorb("", numbers.validate());
        let reserve_s = self.reserve_s.unwrap_or_default();
        let budget_s = numbers.budget_s;
        violations.require(
            (0.0..budget_s.max(1.0)).contains(&reserve_s),
            "reserve_s",
            || format!("is {reserve_s}; give at least 0 and less than budget_s"),
        );
        numbers
    }

    /// All waypoints in local metres; none and doubled names are noted.
    fn points(
        &self,
        frame: Option<&auv_ocean::LocalFrame>,
        violations: &mut Violations,
    ) -> Vec<Point3<f64>> {
        violations.require(!self.waypoints.is_empty(), "waypoints", || {
            "is empty; give at least start and destination".into()
        });
        let mut names = std::collections::BTreeSet::new();
        for (i, waypoint) in self.waypoints.iter().enumerate() {
            let fresh = names.insert(&waypoint.name) && !waypoint.name.is_empty();
            violations.require(fresh, &format!("waypoints[{i}].name"), || {
                format!("is \"{}\": empty or taken; give another", waypoint.name)
            });
        }
        self.waypoints
            .iter()
            .enumerate()
            .map(|(i, waypoint)| {
                let place = format!("waypoints[{i}] ({})", waypoint.name);
                places::point(&waypoint.at, frame, &place, violations)
            })
            .collect()
    }

    fn ends(&self, violations: &mut Violations) -> Option<[usize; 2]> {
        let mut node = |name: &str, key: &str| {
            let node = node_of(self, name);
            violations.require(node.is_some(), key, || {
                format!("names the waypoint {name}, which there is not; correct the name")
            });
            node
        };
        let (start, dock) = (
            node(&self.start, "start"),
            node(&self.destination, "destination"),
        );
        violations.require(start.is_none() || start != dock, "destination", || {
            "is the start; for a round trip give a second waypoint at the same place".into()
        });
        start.zip(dock).map(|(start, dock)| [start, dock])
    }

    /// Waypoints inside what is charted, a start inside anything, a destination that clearance keeps
    /// the vehicle from.
    fn check_room(
        &self,
        points: &[Point3<f64>],
        start: usize,
        dock: usize,
        field: &ObstacleField,
        numbers: &Numbers,
        violations: &mut Violations,
    ) {
        let named = |region: &Region| match self.obstacles.get(region.obstacle.0 as usize) {
            Some(entry) => format!("obstacles[{}] ({})", region.obstacle.0, entry.name),
            None => "an obstacle of a group, at random or a ship".to_owned(),
        };
        let mut check = |i: usize, region: &Region, with: &str| {
            let within_m = -region.distance_m(&TimedPoint::new(points[i], 0.0));
            let place = format!("waypoints[{i}] ({})", self.waypoints[i].name);
            violations.require(within_m < 0.0, &place, || {
                let obstacle = named(region);
                format!("lies {within_m:.1} m inside {obstacle}{with}; move one of them")
            });
        };
        for region in field.now() {
            check(start, region, "");
        }
        for region in field.charted() {
            for i in (0..points.len()).filter(|&i| i != start && i != dock) {
                check(i, &region, "");
            }
            let kept = numbers.clearance.inflated(RegionSource::Charted, region);
            check(
                dock,
                &kept.inflated(numbers.clearance_m),
                " with the clearance kept from it",
            );
        }
    }

    /// Waypoints alone, to check their places before ways are sought.
    fn bare_network(&self, points: &[Point3<f64>], speed_mps: f64) -> Result<Network, Violations> {
        let waypoints: Vec<auv_graph::Waypoint> = self
            .waypoints
            .iter()
            .zip(points)
            .map(|(entry, position)| auv_graph::Waypoint {
                position: *position,
                name: entry.name.clone(),
            })
            .collect();
        Network::new(&waypoints, &[], speed_mps)
    }
}
