//! The flights that a brief is made of.

use crate::fleet::Fleet;
use crate::progress::Progress;
use auv_examples::{Failure, MissionInput};
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_population::Workers;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::mission_file::MissionFile;
use auv_sim::{MissionOutcome, Scenario, simulate};
use std::collections::BTreeMap;

/// What is different from the mission as planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Variation {
    AsPlanned,
    /// One hour less than the budget.
    HourLess,
    /// The true current is 20 % stronger than it is as planned.
    StrongerCurrent,
    /// Launched so many seconds later.
    Launched(f64),
}

/// One flight.
#[derive(Clone, Debug)]
pub(super) struct Flown {
    /// The number of the mission.
    pub(super) k: u64,
    /// How it ended; `None` where it could not be launched.
    pub(super) outcome: Option<MissionOutcome>,
    /// Why it ended so.
    pub(super) why: String,
    /// Time left of the budget at the end, seconds.
    pub(super) remaining_s: f64,
    /// Least true distance to any obstacle, metres.
    pub(super) clearance_m: f64,
    /// Least altitude, metres.
    pub(super) altitude_m: f64,
    /// Which tasks were done, in the order of [`Flights::tasks`].
    done: Vec<bool>,
}

/// All flights of a brief.
pub(super) struct Flights {
    /// The tasks of the mission by name, with the place where a name stands for several.
    pub(super) tasks: Vec<String>,
    /// Time kept in reserve, seconds.
    pub(super) reserve_s: f64,
    /// By variation, in the order asked.
    pub(super) flown: Vec<(Variation, Vec<Flown>)>,
}

impl Flights {
    /// Flies missions `first`, `first + 1`, ... of each variation.
    pub(super) fn fly(
        fleet: &Fleet,
        input: &MissionInput,
        workers: &Workers,
        asked: &[(Variation, u64)],
        first: u64,
    ) -> Result<Self, Failure> {
        let planned = fleet.scenario(first).map_err(Failure::BadInput)?;
        let jobs = asked.iter().flat_map(|&(variation, count)| {
            (first..first.saturating_add(count)).map(move |k| (variation, k))
        });
        let jobs: Vec<(Variation, u64)> = jobs.collect();
        let mut slots: Vec<Option<Flown>> = vec![None; jobs.len()];
        let progress = Progress::new(jobs.len() as u64);
        workers.for_each(&mut slots, |i, slot| {
            let (variation, k) = jobs[i];
            *slot = Some(fly(fleet, input, variation, k));
            progress.one();
        });
        let mut flown = slots.into_iter().flatten();
        let by_variation = asked
            .iter()
            .map(|&(variation, count)| (variation, flown.by_ref().take(count as usize).collect()));
        Ok(Self {
            flown: by_variation.collect(),
            tasks: task_names(input, &planned),
            reserve_s: planned.mission.reserve_s,
        })
    }

    /// The flights of a variation.
    pub(super) fn of(&self, variation: Variation) -> &[Flown] {
        let mut all = self.flown.iter();
        let found = all.find(|(flown, _)| *flown == variation);
        found.map_or(&[], |(_, flights)| flights)
    }

    /// The share of flights in which a task is done.
    pub(super) fn p_done(&self, variation: Variation, task: usize) -> f64 {
        let flights = self.of(variation);
        let done = flights
            .iter()
            .filter(|flight| flight.done.get(task) == Some(&true));
        done.count() as f64 / flights.len().max(1) as f64
    }
}

impl Flown {
    pub(super) fn is_home(&self) -> bool {
        self.outcome == Some(MissionOutcome::Docked)
    }
}

/// The names of all tasks, with their places where several have one name.
fn task_names(input: &MissionInput, planned: &Scenario) -> Vec<String> {
    let works = input.file.works(&planned.mission);
    let mut count = BTreeMap::new();
    for work in &works {
        *count.entry(work.name.as_str()).or_insert(0) += 1;
    }
    let name = |work: &auv_sim::mission_file::Work| match count.get(work.name.as_str()) {
        Some(1) => work.name.clone(),
        _ => format!("{} at {}", work.name, work.at),
    };
    works.iter().map(name).collect()
}

fn fly(fleet: &Fleet, input: &MissionInput, variation: Variation, k: u64) -> Flown {
    let planners = (
        GaRoute::new(GaSettings::default()),
        PsoPath::new(PathSearch::default()),
    );
    let driver = Stepped::new(&planners.0, &planners.1);
    let flown = fleet.scenario(k).and_then(|scenario| {
        let scenario = variation.of(scenario, &input.file);
        let summary = simulate(&scenario, &driver, &mut ());
        summary
            .map(|summary| (scenario, summary))
            .map_err(|error| error.to_string())
    });
    let (scenario, summary) = match flown {
        Ok(flown) => flown,
        Err(why) => {
            return Flown {
                k,
                outcome: None,
                why: format!("not launched: {why}"),
                remaining_s: f64::NEG_INFINITY,
                clearance_m: f64::INFINITY,
                altitude_m: f64::INFINITY,
                done: Vec::new(),
            };
        }
    };
    let judgement = &summary.judgement;
    Flown {
        k,
        outcome: Some(summary.outcome),
        why: summary.reason.to_string(),
        remaining_s: summary.remaining_s,
        clearance_m: judgement.min_clearance_m,
        altitude_m: judgement.min_altitude_m,
        done: input.file.works_done(&scenario.mission, &summary),
    }
}

impl Variation {
    fn of(self, scenario: Scenario, file: &MissionFile) -> Scenario {
        match self {
            Self::AsPlanned => scenario,
            Self::HourLess => file.with_budget_longer(scenario, -3_600.0),
            Self::StrongerCurrent => scenario.with_current_times(1.2),
            Self::Launched(later_s) => scenario.launched_later(later_s),
        }
    }

    /// What is different, in words.
    pub(super) fn words(self) -> String {
        match self {
            Self::AsPlanned => "as planned".into(),
            Self::HourLess => "one hour less".into(),
            Self::StrongerCurrent => "current 20 % stronger".into(),
            Self::Launched(later_s) => format!("launch {:+.0} min", later_s / 60.0),
        }
    }
}
