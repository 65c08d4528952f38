//! Builds a scenario from a mission file.

use super::document::MissionFile;
use super::guides::GuideFinder;
use super::misplaced::Misplaced;
use super::network::{Charted, network};
use super::no_room::{LeftOut, NoRoom};
use super::obstacles::{Surroundings, field};
use super::room_below::{RoomBelow, raised_m};
use super::sea::{Beside, Voyage, Water, sea_bed, water};
use super::ships::ships;
use super::{DataReport, MissionData, MissionFileError, places};
use crate::{Altimeter, Fences, PresetValues, Scenario};
use auv_graph::{Network, NodeId};
use auv_mission::{Battery, Emergency, Mission};
use auv_obstacles::truth::{ObstacleField, TrackedShip};
use auv_obstacles::{Region, RegionSource, TimedPoint};
use auv_ocean::{LocalFrame, SeaBed};
use auv_types::{Bounds, Point3, Seed, Violations};
use std::sync::Arc;

/// The contents of a mission file except obstacles and edges, in local metres.
struct Inputs {
    values: PresetValues,
    frame: Option<LocalFrame>,
    bounds: Option<Bounds>,
    /// The waypoints.
    points: Vec<Point3<f64>>,
    /// Indices of start and destination, and of the other docks.
    ends: [usize; 2],
    docks: Vec<usize>,
    /// The bed below the lowest surface of the mission.
    bed: Option<Arc<dyn SeaBed>>,
    fences: Fences,
    battery: Option<Battery>,
    emergencies: Vec<Emergency>,
    /// The charted bed, below the datum.
    charted_bed: Option<Arc<dyn SeaBed>>,
    water: Water,
    ships: Vec<TrackedShip>,
    /// Cell size of the map in which edges are routed.
    cell_m: Option<f64>,
    /// What the vehicle's body cannot do as the file asks, and what may be a slip.
    limited: Vec<String>,
}

impl Inputs {
    fn surroundings(&self) -> Surroundings<'_> {
        let [start, dock] = self.ends;
        Surroundings {
            frame: self.frame.as_ref(),
            bounds: self.bounds.as_ref(),
            sea_bed: self.bed.as_deref(),
            waypoints: &self.points,
            start,
            dock,
            sonar_range_m: self.values.sonar.range_m,
        }
    }
}

/// A mission as the file describes it, even where it cannot be flown.
pub(super) struct Draft {
    pub(super) scenario: Scenario,
    /// Everything that keeps it from being flown.
    pub(super) problems: Violations,
    /// What it leaves out.
    pub(super) no_room: Vec<NoRoom>,
}

/// Room under a raised waypoint for the turn that leads on from it, metres.
const TURNING_ROOM_M: f64 = 0.5;

impl Inputs {
    /// Makes room for the guidance error: planners get a bed that is raised by what the vehicle may be off
    /// its path, and waypoints too near to that bed are raised. Returns their indices, and by how much.
    fn keep_room_below(&mut self) -> Vec<(usize, f64)> {
        let mut raised = Vec::new();
        if self.values.guidance_error_m <= 0.0 {
            return raised;
        }
        let Some(bed) = self.bed.take() else {
            return raised;
        };
        let raised_bed = RoomBelow::new(bed, self.values.guidance_error_m);
        let floor = self.values.floor(Some(&raised_bed));
        let top_m = self.bounds.map_or(0.0, |bounds| bounds.low.z);
        for (i, point) in self.points.iter_mut().enumerate() {
            let deepest_m =
                floor.map_or(f64::INFINITY, |f| f.deepest_at(point.x, point.y)) - TURNING_ROOM_M;
            let at_m = deepest_m.max(top_m);
            if point.z > at_m {
                raised.push((i, point.z - at_m));
                point.z = at_m;
            }
        }
        self.bed = Some(Arc::new(raised_bed));
        raised
    }
}

impl MissionFile {
    /// The mission with its sea. The seed draws what the file leaves open: obstacles, the difference
    /// between true and forecast current, delays of ships, noise.
    ///
    /// A mission over a sea bed needs a map of the water, which takes some tens of milliseconds.
    ///
    /// # Determinism
    /// Equal file, data and seed give an equal scenario.
    ///
    /// # Errors
    /// Every invalid value of the file, or the first data file that is missing or damaged.
    pub fn scenario(
        &self,
        data: &MissionData<'_>,
        seed: Seed,
    ) -> Result<Scenario, MissionFileError> {
        self.scenario_with_report(data, seed, &mut DataReport::default())
    }

    /// The same, with what was read from the files beside the mission: also of those read before something
    /// is refused.
    ///
    /// # Errors
    /// As [`MissionFile::scenario`].
    pub fn scenario_with_report(
        &self,
        data: &MissionData<'_>,
        seed: Seed,
        report: &mut DataReport,
    ) -> Result<Scenario, MissionFileError> {
        let draft = self.draft(data, seed, report)?;
        refused(Violations::new(), draft.problems)?;
        Ok(draft.scenario)
    }

    /// The mission even where it cannot be flown, with everything that keeps it from being flown.
    pub(super) fn draft(
        &self,
        data: &MissionData<'_>,
        seed: Seed,
        report: &mut DataReport,
    ) -> Result<Draft, MissionFileError> {
        let mut inputs = self.inputs(data, seed, report)?;
        let mut mission = self.mission_without_edges(&inputs)?;
        let field = self.field(&mut inputs, seed.split(2))?;
        let raised = inputs.keep_room_below();
        mission.sea_bed.clone_from(&inputs.bed);
        let speed_mps = inputs.values.vehicle.speed_mps;
        mission.network = Arc::new(self.bare_network(&inputs.points, speed_mps)?);
        let charted = self.charted_network(&inputs, &mission)?;
        let raised = self.told(&raised, inputs.values.guidance_error_m);
        let no_room = self.put_network(&mut mission, charted)?;
        let true_bed = self.true_bed(inputs.charted_bed.as_ref(), &mission, seed.split(4));
        let drawn = self.draws_bed().then(Altimeter::default);
        let Inputs {
            values,
            water,
            fences,
            limited,
            ..
        } = inputs;
        let mut scenario = Scenario {
            name: self.name.clone(),
            preset: self.preset.as_str().into(),
            mission: Arc::new(mission),
            settings: values.synchroniser,
            field,
            true_current: water.truth,
            current_moves_vehicle: water.moves_vehicle,
            true_bed,
            water_level: self.water_level.clone(),
            fences,
            altimeter: self.altimeter.or(drawn),
            sonar: values.sonar,
            tracker: values.tracker,
            clearance: values.clearance,
            tick_s: values.tick_s,
            body: values.body,
            guidance_error_m: values.guidance_error_m,
            seed: seed.split(3),
            warnings: no_room.iter().map(NoRoom::told).collect(),
        };
        let bounds = scenario.mission.bounds.as_ref();
        let covered = Self::told_of_cover(&scenario.fences, bounds);
        let told = limited.into_iter().chain(covered).chain(raised);
        scenario.warnings.extend(told);
        scenario.warnings.splice(0..0, report.warnings());
        Ok(Draft {
            problems: scenario.validate(),
            scenario,
            no_room,
        })
    }

    /// Gives a mission its network, and its tasks with windows and order, if there are any. Returns what is left out.
    fn put_network(
        &self,
        mission: &mut Mission,
        charted: Charted,
    ) -> Result<Vec<NoRoom>, MissionFileError> {
        (mission.network, mission.guides) = (Arc::new(charted.network), charted.guides);
        mission.courses = self.courses(mission);
        mission.find_fronts();
        mission.shared_tasks = charted.shared_tasks;
        let mut no_room = charted.no_room;
        no_room.extend(closed_arcs(mission));
        let mut violations = Violations::new();
        let model = self.time_model(mission, &mut no_room, &mut violations);
        violations.into_result()?;
        if let Some(model) = &model {
            mission.manners = self.manners(mission, model);
        }
        mission.time_model = model.map(Arc::new);
        Ok(no_room)
    }

    /// What is told of raised waypoints.
    fn told(&self, raised: &[(usize, f64)], error_m: f64) -> Option<String> {
        let name = |&(i, by_m): &(usize, f64)| {
            Some(format!("{} {by_m:.1} m", self.waypoints.get(i)?.name))
        };
        let names: Vec<String> = raised.iter().filter_map(name).collect();
        (!names.is_empty()).then(|| {
            format!(
                "flown higher than given: {}; with a guidance error of {error_m} m the vehicle would come nearer to the bed than asked",
                names.join(", ")
            )
        })
    }

    /// Everything the file states except obstacles and edges. All of it must be valid before anything is
    /// placed around the waypoints.
    fn inputs(
        &self,
        data: &MissionData<'_>,
        seed: Seed,
        report: &mut DataReport,
    ) -> Result<Inputs, MissionFileError> {
        let mut violations = Violations::new();
        let mut limited = Vec::new();
        let values = self.values(&mut limited, &mut violations);
        let frame = places::frame(self.datum, &mut violations);
        let bounds = places::bounds(self.extent.as_ref(), frame.as_ref(), &mut violations);
        let bounds = self.within_keep_in(bounds, &mut violations);
        let mut points = self.points(frame.as_ref(), &mut violations);
        limited.extend(self.told_of_one_place(&points));
        let (ends, docks) = self.ends(&mut violations).unwrap_or_default();
        self.check_fix_places(&mut violations);
        let mut beside = Beside {
            data,
            frame: frame.as_ref(),
            report,
        };
        let bed = sea_bed(self, &mut beside, bounds.as_ref(), &mut violations)?;
        let charted_bed = bed.clone();
        let open = self.under_lowest_surface(bed, &values, &mut violations);
        self.place_lines(&mut points, open.as_deref(), &mut violations);
        let mut fences = self.fences(frame.as_ref(), bounds.as_ref(), &mut violations);
        fences.open_bed = open;
        let battery = self.battery_at(values.vehicle.speed_mps, &mut violations);
        let emergencies = self.emergencies(frame.as_ref(), &mut violations);
        let bed = fences.walled_bed(bounds.as_ref());
        if violations.is_empty() {
            let floors = [&fences.open_bed, &bed].map(|bed| values.floor(bed.as_deref()));
            let margin = (bounds.as_ref(), values.clearance.tracking_error_m);
            self.check_fenced_waypoints(&points, &fences, floors.into(), margin, &mut violations);
        }
        let voyage = Voyage {
            points: &points,
            ends,
            speed_mps: values.vehicle.speed_mps,
            budget_s: values.budget_s,
        };
        let water = water(self, &mut beside, (&voyage, seed.split(0)), &mut violations)?;
        let ships = ships(self, &mut beside, seed.split(1), &mut violations)?;
        let cell_m = self.connect.as_ref().and_then(|connect| connect.cell_m);
        places::check_cell(cell_m, "connect.cell_m", &mut violations);
        violations.into_result()?;
        Ok(Inputs {
            values,
            frame,
            bounds,
            points,
            ends,
            docks,
            bed,
            fences,
            battery,
            emergencies,
            charted_bed,
            water,
            ships,
            cell_m,
            limited,
        })
    }

    /// A scenario of this file with a budget that is longer by some seconds (shorter if negative), as if the file said
    /// so: a reserve that it does not give is the same share of the time there is.
    #[must_use]
    pub fn with_budget_longer(&self, scenario: Scenario, by_s: f64) -> Scenario {
        let available_s = |mission: &Mission| mission.available_s(mission.budget_s, 0.0);
        let before_s = available_s(&scenario.mission);
        let mut scenario = scenario.with_budget_longer(by_s);
        if self.reserve_s.is_none() && before_s > 0.0 {
            let share = available_s(&scenario.mission).max(0.0) / before_s;
            Arc::make_mut(&mut scenario.mission).reserve_s *= share;
        }
        scenario
    }

    /// The mission without its edges. Misplaced waypoints are reported here: without valid waypoints no
    /// edge can be routed, and messages about edges would mislead.
    fn mission_without_edges(&self, inputs: &Inputs) -> Result<Mission, MissionFileError> {
        let values = &inputs.values;
        let [start, dock] = inputs.ends;
        let forecast = inputs.water.forecast.clone();
        let mut mission = Mission {
            reserve_s: self.reserve_s.unwrap_or_default(),
            bounds: inputs.bounds,
            sea_bed: inputs.bed.clone(),
            min_altitude_m: values.min_altitude_m,
            altitude_sigmas: values.altitude_sigmas,
            current: forecast.filter(|_| inputs.water.moves_vehicle),
            clearance_m: values.clearance_m,
            open_water: inputs.bed.is_none(),
            navigation: self.navigation,
            surfacing: self.surfacing(),
            fix_places: self.fix_places(),
            docking: self.docking.unwrap_or_default(),
            docks: inputs.docks.iter().map(|&i| NodeId(i as u32)).collect(),
            battery: inputs.battery,
            emergencies: inputs.emergencies.clone(),
            ..Mission::new(
                Arc::new(self.bare_network(&inputs.points, values.vehicle.speed_mps)?),
                NodeId(start as u32),
                NodeId(dock as u32),
                values.budget_s,
                values.vehicle,
            )
        };
        if let Some(ladder) = &self.contingencies {
            mission.contingencies.clone_from(ladder);
        }
        if self.reserve_s.is_none() {
            // A share of the time there is: of what the battery lasts, where that is less than the budget.
            mission.reserve_s = values.reserve_share * mission.available_s(values.budget_s, 0.0);
        }
        // The keys as the file has them.
        let malformed = mission.malformed().renamed(|place| {
            let place = place.replace("emergencies[", "emergency[");
            place.replace("].ladder[", "].do[")
        });
        refused(malformed, self.misplaced(&mission))?;
        Ok(mission)
    }

    /// The true obstacles and ships, with every waypoint outside of them.
    fn field(&self, inputs: &mut Inputs, seed: Seed) -> Result<ObstacleField, MissionFileError> {
        let (mut violations, mut shut) = (Violations::new(), Violations::new());
        let motion = inputs.values.obstacle_motion.clone();
        let ships = std::mem::take(&mut inputs.ships);
        let field = field(self, motion, &inputs.surroundings(), seed, &mut violations);
        let field = field.map(|field| field.with_ships(ships));
        if let Some(field) = &field {
            self.check_room(inputs, field, &mut shut);
        }
        refused(violations, shut)?;
        field.ok_or_else(not_built)
    }

    /// The network with the guides of its edges.
    fn charted_network(
        &self,
        inputs: &Inputs,
        mission: &Mission,
    ) -> Result<Charted, MissionFileError> {
        let (mut violations, mut shut) = (Violations::new(), Violations::new());
        let values = &inputs.values;
        let floor = values.floor(inputs.bed.as_deref());
        let (bounds, pitch_rad) = (inputs.bounds.as_ref(), values.vehicle.max_pitch_rad);
        let finder = GuideFinder::new(floor, bounds, inputs.cell_m, pitch_rad, &mut violations);
        let charted = finder.and_then(|finder| {
            network(
                self,
                (&inputs.points, raised_m(inputs.values.guidance_error_m)),
                &finder,
                mission,
                (&mut violations, &mut shut),
            )
        });
        refused(violations, shut)?;
        charted.ok_or_else(not_built)
    }

    /// Checks that the start lies outside every obstacle, the waypoints outside charted ones, and the
    /// destination outside charted ones with their clearances.
    fn check_room(&self, inputs: &Inputs, field: &ObstacleField, violations: &mut Violations) {
        let (values, points, [start, dock]) = (&inputs.values, &inputs.points, inputs.ends);
        let named = |region: &Region| match self.obstacles.get(region.obstacle.0 as usize) {
            Some(entry) => format!("obstacles[{}] ({})", region.obstacle.0, entry.name),
            None => "an obstacle of a group, a random obstacle or a ship".to_owned(),
        };
        let mut wrong = Vec::new();
        let mut check = |i: usize, region: &Region, with: &str| {
            let within_m = -region.distance_m(&TimedPoint::new(points[i], 0.0));
            if within_m >= 0.0 {
                wrong.push(Misplaced {
                    waypoint: i,
                    rank: region.obstacle.0,
                    by_m: within_m,
                    what: format!("lies {within_m:.1} m inside {}{with}", named(region)),
                    remedy: "move one of them",
                    of_survey: "move the survey, or it",
                });
            }
        };
        for region in field.now() {
            check(start, region, "");
        }
        for region in field.charted() {
            for i in (0..points.len()).filter(|&i| i != start && i != dock) {
                check(i, &region, "");
            }
            let kept = values.clearance.inflated(RegionSource::Charted, region);
            check(
                dock,
                &kept.inflated(values.clearance_m),
                " with the clearance around it",
            );
        }
        self.tell(wrong, violations);
    }

    /// The waypoints without edges.
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

/// Closes the arcs that the vehicle has no room to fly.
fn closed_arcs(mission: &mut Mission) -> impl Iterator<Item = NoRoom> + use<> {
    let closed = mission.close_arcs_without_room().into_iter();
    closed.map(|(arc, text)| NoRoom {
        what: LeftOut::Arc(arc),
        text,
    })
}

/// The error of wrong values, of what keeps the mission from being flown, or of both.
fn refused(mut wrong: Violations, no_go: Violations) -> Result<(), MissionFileError> {
    if wrong.is_empty() {
        return no_go.into_result().map_err(MissionFileError::NoGo);
    }
    wrong.absorb("", no_go);
    Err(MissionFileError::Invalid(wrong))
}

/// The error for a part that is missing although nothing was found wrong.
fn not_built() -> MissionFileError {
    MissionFileError::Syntax("the mission could not be built".into())
}
