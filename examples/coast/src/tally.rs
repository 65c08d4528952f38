//! The summary of many flights.

use crate::flight::Flight;
use auv_sim::MissionOutcome;
use serde_json::{Value, json};

/// The most missions printed that were refused or did not dock.
const PRINTED: usize = 40;

/// Counts over all flights.
pub(crate) struct Tally {
    missions: usize,
    refused: usize,
    docked: usize,
    late: usize,
    aborted: usize,
    collided: usize,
    grounded: usize,
    /// Missions with a waypoint at the lowest legal depth near a steep slope.
    steep: usize,
    /// Missions in an empty, still sea.
    empty: usize,
    /// Accepted missions whose least altitude is below the least asked, without standard deviations.
    low: usize,
    /// The least altitude of all, metres.
    lowest_m: f64,
    weight: f64,
    /// Mean and greatest computing time of an accepted mission, milliseconds.
    elapsed_ms: [f64; 2],
    notes: Vec<String>,
}

impl Tally {
    pub(crate) fn of(flights: &[Flight]) -> Self {
        let count = |outcome| {
            let flights = flights.iter();
            flights.filter(|f| f.outcome() == Some(outcome)).count()
        };
        let having = |what: &dyn Fn(&Flight) -> bool| flights.iter().filter(|f| what(f)).count();
        let summaries = || {
            flights
                .iter()
                .filter_map(|f| Some((f, &f.flown.as_ref().ok()?.0)))
        };
        let accepted = summaries().count().max(1) as f64;
        Self {
            missions: flights.len(),
            refused: having(&|flight| flight.flown.is_err()),
            docked: count(MissionOutcome::Docked),
            late: count(MissionOutcome::Late),
            aborted: count(MissionOutcome::Aborted),
            collided: summaries()
                .filter(|(_, s)| s.judgement.collisions > 0)
                .count(),
            grounded: summaries()
                .filter(|(_, s)| s.judgement.groundings > 0)
                .count(),
            steep: having(&|flight| flight.mission.traits().is_steep()),
            empty: having(&|flight| flight.mission.traits().empty),
            low: summaries()
                .filter(|(f, s)| s.judgement.min_altitude_m < f.asked_m)
                .count(),
            lowest_m: summaries().fold(f64::INFINITY, |least, (_, s)| {
                least.min(s.judgement.min_altitude_m)
            }),
            weight: summaries().map(|(_, s)| s.mission_weight).sum::<f64>() / accepted,
            elapsed_ms: [
                summaries().map(|(f, _)| f.elapsed_ms).sum::<f64>() / accepted,
                summaries().fold(0.0, |most, (f, _)| most.max(f.elapsed_ms)),
            ],
            notes: flights.iter().filter_map(note).take(PRINTED).collect(),
        }
    }

    /// A line for each mission that was refused or did not dock.
    pub(crate) fn notes(&self) -> &[String] {
        &self.notes
    }

    pub(crate) fn json(&self) -> Value {
        json!({
            "missions": self.missions,
            "refused": self.refused,
            "docked": self.docked,
            "late": self.late,
            "aborted": self.aborted,
            "collided": self.collided,
            "grounded": self.grounded,
            "below_least_altitude": self.low,
            "min_altitude_m": if self.lowest_m.is_finite() { json!(self.lowest_m) } else { Value::Null },
            "steep_at_limit": self.steep,
            "empty": self.empty,
            "mean_weight": self.weight,
            "mean_elapsed_ms": self.elapsed_ms[0],
            "max_elapsed_ms": self.elapsed_ms[1],
        })
    }

    pub(crate) fn text(&self) -> String {
        format!(
            "missions   {} of which {} have a waypoint at the lowest legal depth near a slope over 20 degrees, {} an empty, still sea\n\
             refused    {}\n\
             docked     {}\n\
             late       {}\n\
             aborted    {}\n\
             collided   {} with obstacles, {} with the sea bed\n\
             altitude   {:.1} m least; {} missions below the least altitude asked\n\
             weight     {:.2} mean\n\
             computing  {:.0} ms mean, {:.0} ms most\n",
            self.missions,
            self.steep,
            self.empty,
            self.refused,
            self.docked,
            self.late,
            self.aborted,
            self.collided,
            self.grounded,
            self.lowest_m,
            self.low,
            self.weight,
            self.elapsed_ms[0],
            self.elapsed_ms[1],
        )
    }
}

/// A line for a mission that was refused or did not dock.
fn note(flight: &Flight) -> Option<String> {
    let k = flight.mission.number;
    match &flight.flown {
        Err(reason) => Some(format!("mission {k} refused: {reason}")),
        Ok((summary, _)) if summary.outcome != MissionOutcome::Docked => Some(format!(
            "mission {k} {}: {}; {} groundings, least altitude {:.1} m",
            summary.outcome,
            summary.reason,
            summary.judgement.groundings,
            summary.judgement.min_altitude_m
        )),
        Ok(_) => None,
    }
}
