//! A simulated mission, step by step.

use crate::closed_loop::ClosedLoop;
use crate::disturbance::{Disturbance, Undisturbed};
#[cfg(feature = "mission-file")]
use crate::navigator::Navigator;
use crate::{Entry, Recorder, Scenario, SimulatedSonar, SimulatedVehicle, Summary};
use auv_mission::driver::Driver;
use auv_mission::{Contingency, Synchroniser};
use auv_obstacles::{ObstaclePredictor, Region};
use auv_planning::Trajectory;
use auv_types::{Point3, Vector3, Violations};
use std::fmt;

/// A mission that lasts longer than this many budgets, and this many ticks more, counts as endless.
const MOST_BUDGETS: f64 = 10.0;
const SPARE_TICKS: f64 = 100_000.0;

/// A simulated mission that its caller steps, with any driver, vehicle, sonar and tracker.
///
/// ```
/// use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
/// use auv_mission::{Mission, driver::Stepped};
/// use auv_obstacles::{Frozen, Sonar};
/// use auv_planning::baseline::{GreedyRoute, StraightPath};
/// use auv_sim::{MissionOutcome, Preset, Scenario, Simulation};
/// use auv_types::{Point3, Seed};
///
/// let vehicle = Preset::Default.values().vehicle;
/// let ends = [0.0, 900.0].map(|north_m| Waypoint::at(Point3::new(north_m, 0.0, 20.0)));
/// let network = Network::new(&ends, &[Edge::directed(0, 1, Task::TRANSIT)], vehicle.speed_mps)?;
/// let mission = Mission::new(network.into(), NodeId(0), NodeId(1), 1_200.0, vehicle);
/// let scenario = Scenario::new(mission, Vec::new(), Seed(1))?;
///
/// // A tracker that believes every echo needs a sonar without false ones.
/// let sonar = Sonar { clutter_per_scan: 0.0, ..scenario.sonar.clone() };
/// let mut simulation = Simulation::new(&scenario)?.with_sonar(sonar).with_tracker(Frozen::default());
/// let mut driver = Stepped::new(&GreedyRoute, &StraightPath);
/// let summary = loop {
///     if let Some(summary) = simulation.step(&mut driver, &mut ())? {
///         break summary;
///     }
///     assert!(simulation.position().x > -5.0 && simulation.time_s() < 1_200.0);
/// };
/// assert_eq!(summary.outcome, MissionOutcome::Docked);
/// # Ok::<(), auv_types::Violations>(())
/// ```
pub struct Simulation<'a> {
    scenario: &'a Scenario,
    closed_loop: ClosedLoop<'a>,
    /// Steps made.
    steps: u64,
    over: Option<Summary>,
}

impl fmt::Debug for Simulation<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Simulation")
            .field("scenario", &self.scenario.name)
            .field("time_s", &self.time_s())
            .field("position", &self.position())
            .finish_non_exhaustive()
    }
}

impl<'a> Simulation<'a> {
    /// A mission before its start, with the vehicle, sonar and tracker of the scenario.
    ///
    /// # Errors
    /// Every reason why the scenario is invalid.
    pub fn new(scenario: &'a Scenario) -> Result<Self, Violations> {
        scenario.validate().into_result()?;
        Ok(Self {
            scenario,
            closed_loop: ClosedLoop::new(scenario)?,
            steps: 0,
            over: None,
        })
    }

    /// Flies this vehicle in place of the scenario's. It starts where it is.
    #[must_use]
    pub fn with_vehicle(mut self, vehicle: impl SimulatedVehicle + 'a) -> Self {
        self.closed_loop.vehicle = Box::new(vehicle);
        self
    }

    /// Scans with this sonar in place of the scenario's. The tracker of the scenario takes the errors and the field of
    /// view of its own sonar for granted: change [`Scenario::tracker`] too, or the tracker.
    #[must_use]
    pub fn with_sonar(mut self, sonar: impl SimulatedSonar + 'a) -> Self {
        self.closed_loop.sonar = Box::new(sonar);
        self
    }

    /// Predicts obstacles with this tracker in place of the scenario's. It has to know what is charted
    /// (`scenario.field.charted()`).
    #[must_use]
    pub fn with_tracker(mut self, tracker: impl ObstaclePredictor + 'a) -> Self {
        self.closed_loop.tracker = Box::new(tracker);
        self
    }

    /// Lets the vehicle be where it believes to be, though it cannot know that.
    #[cfg(feature = "mission-file")]
    pub(crate) fn without_errors_of_place(mut self) -> Self {
        let navigator = self.closed_loop.navigator.take();
        self.closed_loop.navigator = navigator.map(Navigator::without_errors);
        self
    }

    /// Flies to the next scan, tick or time that the synchroniser is due at, whichever is first, and carries that out. The first step is the tick at the
    /// start. Returns the summary once the mission is over; further steps change nothing.
    ///
    /// # Errors
    /// A vehicle of the caller's own that does not move as [`SimulatedVehicle::advance`] says.
    pub fn step(
        &mut self,
        driver: &mut dyn Driver,
        recorder: &mut dyn Recorder,
    ) -> Result<Option<Summary>, Violations> {
        self.step_disturbed(&mut Undisturbed(driver), recorder)
    }

    pub(crate) fn step_disturbed(
        &mut self,
        disturbance: &mut dyn Disturbance,
        recorder: &mut dyn Recorder,
    ) -> Result<Option<Summary>, Violations> {
        if self.over.is_some() {
            return Ok(self.over.clone());
        }
        if self.steps == 0 {
            recorder.record(Entry::Started(self.scenario));
        } else {
            self.closed_loop.fly_to_next_tick(disturbance, recorder)?;
        }
        self.closed_loop.tick(disturbance, recorder);
        let is_over = self.closed_loop.is_over();
        let endless = !is_over && self.steps >= most_ticks(self.scenario);
        if endless {
            disturbance.fail("the mission does not end".into());
        }
        self.steps += 1;
        if endless || is_over {
            let summary = self.closed_loop.summary();
            recorder.record(Entry::Ended(&summary));
            self.over = Some(summary);
        }
        Ok(self.over.clone())
    }

    /// Mission time, seconds.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.closed_loop.time_s
    }

    /// The true place of the vehicle, metres.
    #[must_use]
    pub fn position(&self) -> Point3<f64> {
        self.closed_loop.vehicle.position()
    }

    /// The true velocity of the vehicle over ground, m/s.
    #[must_use]
    pub fn velocity(&self) -> Vector3<f64> {
        self.closed_loop.vehicle.velocity()
    }

    /// The synchroniser: what it is doing, its tables, its trajectory as the vehicle believes it.
    #[must_use]
    pub fn synchroniser(&self) -> &Synchroniser {
        &self.closed_loop.synchroniser
    }

    /// The trajectory that the vehicle follows.
    #[must_use]
    pub fn trajectory(&self) -> Option<&Trajectory> {
        self.closed_loop.trajectory.as_deref()
    }

    /// The regions predicted at the last tick, clearances included.
    #[must_use]
    pub fn predicted(&self) -> &[Region] {
        &self.closed_loop.predicted
    }

    /// The true obstacles now.
    #[must_use]
    pub fn truth(&self) -> &[Region] {
        self.closed_loop.field.now()
    }
}

/// Number of ticks after which a mission counts as endless. It grows with the budget, so that a long
/// mission with short ticks is flown to its end.
fn most_ticks(scenario: &Scenario) -> u64 {
    let longest_s = MOST_BUDGETS * scenario.mission.budget_s + Contingency::LONGEST_S;
    (longest_s / scenario.tick_s + SPARE_TICKS) as u64
}
