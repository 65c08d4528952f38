//! What a mission's pictures show, recorded in simulation or from a real flight.

use crate::utc::date_time;
use auv_graph::NodeId;
use auv_mission::{Mission, PathCall, RouteCall, Synchroniser};
use auv_obstacles::truth::ObstacleClass;
use auv_obstacles::{ObstacleId, Region, RegionShape, TimedPoint};
use auv_ocean::{CurrentField, SeaBed};
use auv_planning::{TaskDone, Trajectory};
use auv_sim::{Entry, Fences, Recorder, Scenario, Summary};
use auv_types::Point3;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Records a mission for its pictures: give it to [`auv_sim::simulate`] as the recorder, then
/// draw it with [`crate::mission_svg`] and [`crate::replay_html`].
///
/// A mission of a real vehicle is recorded by hand: [`MissionPicture::of_flight`]. Planned trajectories are then drawn
/// beside the flown track. Nothing true is known of obstacles; predictions are shown in the replay.
///
/// ```
/// # use auv_mission::Synchroniser;
/// # use auv_obstacles::{Region, TimedPoint};
/// use auv_report::{MissionPicture, mission_svg};
///
/// fn draw(synchroniser: &Synchroniser, track: &[TimedPoint], predicted: &[Region]) -> String {
///     let mut picture = MissionPicture::of_flight("survey 12", synchroniser.mission().clone());
///     if let Some(trajectory) = synchroniser.trajectory() {
///         picture.follow(0.0, trajectory); // whenever it changes
///     }
///     let left_out = picture.fly(track, predicted); // as often as you like
///     picture.note(format!("{left_out} fixes were left out."));
///     picture.end(synchroniser);
///     mission_svg(&picture)
/// }
/// ```
#[derive(Clone, Debug, Default)]
pub struct MissionPicture {
    pub(crate) setting: Option<Setting>,
    pub(crate) notes: Vec<String>,
    /// When mission time 0 is, seconds since 1970 UTC.
    pub(crate) launch_unix_s: Option<f64>,
    /// The true track.
    pub(crate) track: Vec<TimedPoint>,
    pub(crate) obstacles: BTreeMap<ObstacleId, Seen>,
    pub(crate) predicted: BTreeMap<ObstacleId, Vec<Prediction>>,
    /// Time and least true distance to any surface over the tick before it, metres.
    pub(crate) clearances: Vec<(f64, f64)>,
    pub(crate) routes: Vec<RouteCall>,
    pub(crate) legs: Vec<PathCall>,
    /// Trajectories and when they went into force.
    pub(crate) follows: Vec<(f64, Trajectory)>,
    pub(crate) ending: Option<Ending>,
}

/// The mission that was flown, and what is true or known of its sea.
#[derive(Clone, Debug)]
pub(crate) struct Setting {
    pub(crate) name: String,
    pub(crate) mission: Arc<Mission>,
    /// The true bed of a simulation, else that of the chart.
    pub(crate) bed: Option<Arc<dyn SeaBed>>,
    /// The bed as charted, without the walls of fences.
    pub(crate) chart: Option<Arc<dyn SeaBed>>,
    pub(crate) fences: Fences,
    pub(crate) current: Option<Arc<dyn CurrentField>>,
    /// The simulation; `None`: a real vehicle flew.
    pub(crate) simulated: Option<Scenario>,
}

/// How the mission ended.
#[derive(Clone, Debug)]
pub(crate) struct Ending {
    pub(crate) outcome: String,
    /// Empty: nothing but the outcome is known.
    pub(crate) reason: String,
    pub(crate) visited: Vec<NodeId>,
    pub(crate) timed_done: Vec<TaskDone>,
    pub(crate) mission_weight: f64,
    pub(crate) time_s: f64,
    pub(crate) remaining_s: f64,
    /// The comparison with the truth, of a simulation.
    pub(crate) judged: Option<Summary>,
}

impl Ending {
    fn of(summary: &Summary) -> Self {
        Self {
            outcome: summary.outcome.to_string(),
            reason: summary.reason.to_string(),
            visited: summary.visited.clone(),
            timed_done: summary.timed_done.clone(),
            mission_weight: summary.mission_weight,
            time_s: summary.time_s,
            remaining_s: summary.remaining_s,
            judged: Some(summary.clone()),
        }
    }
}

/// The true kind of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum ObstacleKind {
    Charted,
    Uncertain,
    Moving,
    Drifting,
    Ship,
}

/// One true obstacle over the mission.
#[derive(Clone, Debug)]
pub(crate) struct Seen {
    pub(crate) kind: ObstacleKind,
    /// Where it was; linear in between.
    pub(crate) poses: Vec<Pose>,
    pub(crate) closest: Option<NearestPose>,
}

/// Where an obstacle is at a time, and its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    pub(crate) time_s: f64,
    pub(crate) centre: Point3<f64>,
    pub(crate) radius_m: f64,
    /// Whether it is a ball; else a vertical cylinder.
    pub(crate) ball: bool,
    /// Upper and lower depth, metres.
    pub(crate) depths_m: (f64, f64),
}

/// A closest approach.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NearestPose {
    pub(crate) clearance_m: f64,
    pub(crate) pose: Pose,
}

/// A region as predicted at one time: then, and at the horizon shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Prediction {
    pub(crate) time_s: f64,
    pub(crate) now: Pose,
    pub(crate) later: Pose,
    /// The last time at which the prediction was the same, seconds.
    pub(crate) last_s: f64,
}

impl Pose {
    fn of(region: &Region, time_s: f64) -> Self {
        let (centre, radius_m) = (region.centre_at(time_s), region.radius_at(time_s).max(0.0));
        let depths_m = match region.shape {
            RegionShape::Ball => (centre.z - radius_m, centre.z + radius_m),
            RegionShape::Cylinder { top_m, bottom_m } => (top_m.max(-1e4), bottom_m.min(1e4)),
        };
        Self {
            time_s,
            centre,
            radius_m,
            ball: region.shape == RegionShape::Ball,
            depths_m,
        }
    }

    /// Between this pose and a later one.
    fn between(&self, later: &Self, time_s: f64) -> (Point3<f64>, f64) {
        let whole_s = later.time_s - self.time_s;
        let share = if whole_s > 0.0 {
            (time_s - self.time_s) / whole_s
        } else {
            1.0
        };
        (
            self.centre + (later.centre - self.centre) * share,
            self.radius_m + (later.radius_m - self.radius_m) * share,
        )
    }

    fn differs(&self, centre: &Point3<f64>, radius_m: f64, by_m: f64) -> bool {
        (self.centre - centre).norm() > by_m || (self.radius_m - radius_m).abs() > by_m
    }
}

impl MissionPicture {
    /// How far ahead predictions are shown, seconds.
    pub(crate) const HORIZON_S: f64 = 300.0;
    /// Tolerance of the positions of obstacles, metres.
    const EXACT_M: f64 = 2.0;

    /// An empty recording, for a simulation.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A recording of a real vehicle's flight.
    #[must_use]
    pub fn of_flight(name: impl Into<String>, mission: Arc<Mission>) -> Self {
        Self {
            setting: Some(Setting {
                name: name.into(),
                bed: mission.sea_bed.clone(),
                chart: mission.sea_bed.clone(),
                fences: Fences::default(),
                current: mission.current.clone(),
                mission,
                simulated: None,
            }),
            ..Self::default()
        }
    }

    /// The fences of the mission flown: they are drawn as such, and the bed without their walls.
    #[must_use]
    pub fn with_fences(mut self, fences: Fences) -> Self {
        if let Some(setting) = &mut self.setting
            && !fences.is_empty()
        {
            setting.chart.clone_from(&fences.open_bed);
            setting.bed.clone_from(&fences.open_bed);
            setting.fences = fences;
        }
        self
    }

    /// A trajectory went into force at a mission time in seconds.
    pub fn follow(&mut self, time_s: f64, trajectory: &Trajectory) {
        self.follows.push((time_s, trajectory.clone()));
    }

    /// The vehicle was at these places, and these regions were predicted then. Returns how many places were left out:
    /// those that are not finite, or not later than the one before.
    pub fn fly(&mut self, track: &[TimedPoint], predicted: &[Region]) -> usize {
        let mut left_out = 0;
        for point in track {
            let known_s = self.track.last().map_or(f64::NEG_INFINITY, |p| p.time_s);
            let finite = point.time_s.is_finite() && point.position.iter().all(|x| x.is_finite());
            if finite && point.time_s > known_s {
                self.track.push(*point);
            } else {
                left_out += 1;
            }
        }
        if let Some(end) = self.track.last() {
            self.see_predicted(end.time_s, predicted);
        }
        left_out
    }

    /// The flight is over, or as far as it has come: takes the tables, the waypoints and the outcome.
    pub fn end(&mut self, synchroniser: &Synchroniser) {
        self.routes = synchroniser.route_calls().to_vec();
        self.legs = synchroniser.path_calls().to_vec();
        let outcome = synchroniser.outcome();
        self.ending = Some(Ending {
            outcome: outcome.map_or_else(|| "under way".into(), |outcome| outcome.to_string()),
            reason: String::new(),
            visited: synchroniser.visited().to_vec(),
            timed_done: synchroniser.timed_done().to_vec(),
            mission_weight: synchroniser.weight(),
            time_s: self.track.last().map_or(0.0, |p| p.time_s),
            remaining_s: synchroniser.available_s(),
            judged: None,
        });
    }

    /// Says when mission time 0 is, seconds since 1970-01-01 00:00 UTC: the replay and exports then have the times of
    /// the calendar as well.
    pub fn launched_at(&mut self, unix_s: f64) {
        self.launch_unix_s = Some(unix_s);
    }

    /// A mission time in UTC, where the launch is known.
    pub(crate) fn utc(&self, time_s: f64) -> Option<String> {
        Some(date_time(self.launch_unix_s? + time_s))
    }

    /// Adds a sentence that stands below the pictures, for instance that ship tracks were shifted
    /// in space.
    pub fn note(&mut self, sentence: impl Into<String>) {
        self.notes.push(sentence.into());
    }

    /// The range of the simulated sonar, metres; 0 of a real flight.
    pub(crate) fn sonar_m(&self) -> f64 {
        let simulated = self.setting.as_ref().and_then(|s| s.simulated.as_ref());
        simulated.map_or(0.0, |scenario| scenario.sonar.range_m)
    }

    /// When a leg ended, seconds: the start of the next one, or the end of the track.
    pub(crate) fn leg_end_s(&self, leg: usize) -> f64 {
        let next = self.legs.get(leg + 1).map(|next| next.at_s);
        next.or(self.track.last().map(|p| p.time_s)).unwrap_or(0.0)
    }

    /// Of each trajectory the part that was in force, in the clock of the mission.
    pub(crate) fn followed(&self) -> impl Iterator<Item = Vec<TimedPoint>> {
        self.follows
            .iter()
            .enumerate()
            .map(|(k, (from_s, trajectory))| {
                let next_s = self.follows.get(k + 1).map(|next| next.0);
                let flown_s = self.track.last().map_or(f64::INFINITY, |p| p.time_s);
                let until_s = next_s.unwrap_or(flown_s).max(*from_s);
                let at = |time_s| TimedPoint::new(trajectory.at(time_s).0, time_s);
                let within = |p: &&TimedPoint| p.time_s > *from_s && p.time_s < until_s;
                let between = trajectory.points().iter().filter(within).copied();
                std::iter::once(at(*from_s))
                    .chain(between)
                    .chain([at(until_s)])
                    .collect()
            })
    }

    fn see_truth(&mut self, track: &[TimedPoint], truth: &[Region]) {
        let Some(end) = track.last() else {
            return;
        };
        let begin_s = track[0].time_s;
        let mut least_m = f64::INFINITY;
        for region in truth {
            let id = region.obstacle;
            let simulated = self.setting.as_ref().and_then(|s| s.simulated.as_ref());
            let class = simulated.and_then(|s| s.field.class(id));
            let seen = self.obstacles.entry(id).or_insert_with(|| Seen {
                kind: match class {
                    Some(ObstacleClass::Static) => ObstacleKind::Charted,
                    Some(ObstacleClass::Uncertain) => ObstacleKind::Uncertain,
                    Some(ObstacleClass::Moving) => ObstacleKind::Moving,
                    Some(ObstacleClass::Drifting) => ObstacleKind::Drifting,
                    None => ObstacleKind::Ship,
                },
                poses: vec![Pose::of(region, region.from_s.max(begin_s))],
                closest: None,
            });
            seen.keep(Pose::of(region, region.until_s.min(end.time_s)));
            for pair in track.windows(2) {
                let closest = region.clearance(&pair[0], &pair[1]);
                least_m = least_m.min(closest.clearance_m);
                if closest.clearance_m < seen.closest.map_or(f64::INFINITY, |c| c.clearance_m) {
                    seen.closest = Some(NearestPose {
                        clearance_m: closest.clearance_m,
                        pose: Pose::of(region, closest.time_s),
                    });
                }
            }
        }
        self.clearances.push((end.time_s, least_m));
    }

    fn see_predicted(&mut self, time_s: f64, predicted: &[Region]) {
        for region in predicted.iter().filter(|r| r.exists_at(time_s)) {
            let later_s = time_s + Self::HORIZON_S;
            let ahead = predicted
                .iter()
                .find(|r| r.obstacle == region.obstacle && r.exists_at(later_s));
            let later = ahead.map_or_else(
                || Pose::of(region, region.until_s.min(later_s)),
                |r| Pose::of(r, later_s),
            );
            let now = Pose::of(region, time_s);
            let series = self.predicted.entry(region.obstacle).or_default();
            if let Some(last) = series.last_mut() {
                let same =
                    |a: &Pose, b: &Pose| !a.differs(&b.centre, b.radius_m, 2.0 * Self::EXACT_M);
                if same(&last.now, &now) && same(&last.later, &later) {
                    last.last_s = time_s;
                    continue;
                }
            }
            series.push(Prediction {
                time_s,
                now,
                later,
                last_s: time_s,
            });
        }
    }
}

impl Seen {
    /// Appends a pose. Drops the pose before it if interpolation gives the same.
    fn keep(&mut self, pose: Pose) {
        if let [.., before, last] = self.poses.as_slice() {
            let (centre, radius_m) = before.between(&pose, last.time_s);
            let long = pose.time_s - before.time_s > 300.0;
            if !long && !last.differs(&centre, radius_m, MissionPicture::EXACT_M) {
                self.poses.pop();
            }
        }
        self.poses.push(pose);
    }
}

impl Recorder for MissionPicture {
    fn record(&mut self, entry: Entry<'_>) {
        match entry {
            Entry::Started(scenario) => {
                let mission = Arc::clone(&scenario.mission);
                let chart = scenario.open_bed().cloned();
                let bed = scenario.true_bed.clone().or_else(|| chart.clone());
                self.setting = Some(Setting {
                    name: scenario.name.clone(),
                    mission,
                    bed,
                    chart,
                    fences: scenario.fences.clone(),
                    current: scenario.true_current.clone(),
                    simulated: Some(scenario.clone()),
                });
            }
            Entry::Route(call) => self.routes.push(call.clone()),
            Entry::Leg(call) => self.legs.push(call.clone()),
            Entry::Follow(time_s, trajectory) => self.follow(time_s, trajectory),
            Entry::Flown {
                track,
                truth,
                predicted,
            } => {
                let known = self.track.last().map_or(f64::NEG_INFINITY, |p| p.time_s);
                self.track.extend(track.iter().filter(|p| p.time_s > known));
                self.see_truth(track, truth);
                if let Some(end) = track.last() {
                    self.see_predicted(end.time_s, predicted);
                }
            }
            Entry::Ended(summary) => self.ending = Some(Ending::of(summary)),
            _ => {}
        }
    }
}
