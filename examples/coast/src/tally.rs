//! The summary of many flights.

use crate::flight::Flight;
use auv_sim::{Limit, MissionOutcome};
use serde_json::{Value, json};

/// The most missions printed that were refused, did not dock or broke a limit.
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
    /// Missions that broke each limit, and the worst excess, metres.
    broken: [(Limit, usize, f64); 3],
    /// Missions that broke any limit.
    any_broken: usize,
    /// Missions that climbed over the bed as measured, and that reached a waypoint higher than given.
    measured: [usize; 2],
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
            broken: [Limit::Altitude, Limit::Box, Limit::Clearance].map(|limit| {
                let broken = summaries().flat_map(|(_, s)| &s.judgement.limits_broken);
                let excesses_m = broken.filter(|b| b.limit == limit).map(|b| b.by_m);
                let worst_m = excesses_m.clone().fold(0.0, f64::max);
                (limit, excesses_m.count(), worst_m)
            }),
            any_broken: summaries()
                .filter(|(_, s)| !s.judgement.limits_broken.is_empty())
                .count(),
            measured: [
                summaries().filter(|(_, s)| s.climbs > 0).count(),
                summaries().filter(|(_, s)| !s.raised.is_empty()).count(),
            ],
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

    /// A line for each mission that was refused, did not dock or broke a limit.
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
            "limits_broken": self.any_broken,
            "by_limit": self.broken.map(|(limit, missions, worst_m)| {
                json!({ "limit": limit, "missions": missions, "worst_by_m": worst_m })
            }),
            "min_altitude_m": if self.lowest_m.is_finite() { json!(self.lowest_m) } else { Value::Null },
            "climbed": self.measured[0],
            "raised": self.measured[1],
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
             altitude   {:.1} m least; {} climbed, {} reached a waypoint higher than given\n\
             limits     broken in {} missions: {}\n\
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
            self.measured[0],
            self.measured[1],
            self.any_broken,
            self.broken
                .map(|(limit, missions, worst_m)| format!(
                    "{limit} {missions}, worst {worst_m:.2} m"
                ))
                .join("; "),
            self.weight,
            self.elapsed_ms[0],
            self.elapsed_ms[1],
        )
    }
}

/// A line for a mission that was refused, did not dock or broke a limit.
fn note(flight: &Flight) -> Option<String> {
    let k = flight.mission.number;
    let summary = match &flight.flown {
        Err(reason) => return Some(format!("mission {k} refused: {reason}")),
        Ok((summary, _)) => summary,
    };
    let judgement = &summary.judgement;
    let broken = judgement.limits_broken.iter();
    let broken: String = broken.map(|b| format!("; limit broken: {b}")).collect();
    let in_order = summary.outcome == MissionOutcome::Docked && broken.is_empty();
    (!in_order).then(|| {
        format!(
            "mission {k} {}: {}{broken}",
            summary.outcome, summary.reason
        )
    })
}
