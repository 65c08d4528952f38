//! What a brief says.

use super::flights::{Flights, Flown, Variation};
use crate::origin::Origin;
use auv_report::Table;
use auv_sim::MissionOutcome;
use auv_sim::faults::FailureRate;
use auv_sim::statistics::quantile;
use serde_json::{Value, json};

/// A task done in at least this share of the flights as planned ...
const MOSTLY: f64 = 0.5;
/// ... and in at most this share of those with a change is lost by the change.
const RARELY: f64 = 1.0 / 3.0;
/// How many of the worst flights are told.
const WORST: usize = 3;

/// A probability with its 95 % interval (Clopper and Pearson).
#[derive(Clone, Copy, Debug)]
pub(super) struct Share {
    pub(super) p: f64,
    pub(super) low: f64,
    pub(super) high: f64,
}

/// What changes if one thing is different.
pub(super) struct WhatIf {
    pub(super) variation: Variation,
    pub(super) home: Share,
    /// Tasks mostly done as planned and rarely so.
    pub(super) lost: Vec<String>,
}

/// One of the worst flights.
pub(super) struct Bad {
    pub(super) seed: u64,
    pub(super) outcome: String,
    pub(super) why: String,
    pub(super) command: String,
}

/// The numbers of a brief.
pub(super) struct Brief {
    pub(super) name: String,
    pub(super) missions: usize,
    pub(super) home: Share,
    pub(super) reserve_touched: Share,
    pub(super) reserve_s: f64,
    /// Time left of the budget of all missions that were not given up, ascending, seconds.
    pub(super) margins_s: Vec<f64>,
    pub(super) clearance_m: f64,
    pub(super) altitude_m: f64,
    /// Tasks with the share of missions in which each is done.
    pub(super) tasks: Vec<(String, f64)>,
    pub(super) what_if: Vec<WhatIf>,
    /// By launch, seconds later than planned.
    pub(super) launches: Vec<(f64, Share)>,
    pub(super) worst: Vec<Bad>,
}

impl Brief {
    pub(super) fn of(flights: &Flights, origin: &Origin, name: &str) -> Self {
        let planned = flights.of(Variation::AsPlanned);
        let least = |of: fn(&Flown) -> f64| planned.iter().map(of).fold(f64::INFINITY, f64::min);
        let kept = |flown: &&Flown| !matches!(flown.outcome, None | Some(MissionOutcome::Aborted));
        let mut margins_s: Vec<f64> = planned.iter().filter(kept).map(|f| f.remaining_s).collect();
        margins_s.sort_by(f64::total_cmp);
        let tasks = flights.tasks.iter().enumerate();
        let changes = [Variation::HourLess, Variation::StrongerCurrent];
        let mut launches: Vec<(f64, Share)> = flights.flown.iter().filter_map(launch).collect();
        launches.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            name: name.into(),
            missions: planned.len(),
            home: Share::of(planned, Flown::is_home),
            reserve_touched: Share::of(planned, |f| f.remaining_s < flights.reserve_s),
            reserve_s: flights.reserve_s,
            margins_s,
            clearance_m: least(|f| f.clearance_m),
            altitude_m: least(|f| f.altitude_m),
            tasks: tasks
                .map(|(i, name)| (name.clone(), flights.p_done(Variation::AsPlanned, i)))
                .collect(),
            what_if: changes
                .map(|variation| WhatIf::of(flights, variation))
                .into(),
            launches,
            worst: worst(planned, origin),
        }
    }

    /// A quantile of the margins; `None` where every mission was given up.
    pub(super) fn margin_s(&self, share: f64) -> Option<f64> {
        (!self.margins_s.is_empty()).then(|| quantile(&self.margins_s, share))
    }

    pub(super) fn json(&self) -> Value {
        let finite = |x: f64| if x.is_finite() { json!(x) } else { Value::Null };
        let tasks = self.tasks.iter();
        let what_if = self.what_if.iter().map(|change| {
            json!({
                "change": change.variation.words(),
                "p_home": change.home.json(),
                "lost": change.lost,
            })
        });
        let worst = self.worst.iter().map(|bad| {
            json!({ "seed": bad.seed, "outcome": bad.outcome, "why": bad.why, "command": bad.command })
        });
        let launches = self.launches.iter();
        json!({
            "missions": self.missions,
            "p_home": self.home.json(),
            "p_reserve_touched": self.reserve_touched.json(),
            "margin_s": {
                "min": self.margin_s(0.0),
                "q05": self.margin_s(0.05),
                "median": self.margin_s(0.5),
                "q95": self.margin_s(0.95),
            },
            "least_clearance_m": finite(self.clearance_m),
            "least_altitude_m": finite(self.altitude_m),
            "tasks": tasks.map(|(name, p)| json!({ "name": name, "p_done": p })).collect::<Vec<_>>(),
            "what_if": what_if.collect::<Vec<_>>(),
            "launches": launches
                .map(|(later_s, home)| json!({ "later_s": later_s, "p_home": home.json() }))
                .collect::<Vec<_>>(),
            "worst": worst.collect::<Vec<_>>(),
        })
    }

    /// The numbers as text.
    pub(super) fn text(&self) -> String {
        let metres = |x: f64| {
            if x.is_finite() {
                format!("{x:.1} m")
            } else {
                "none met".into()
            }
        };
        let seconds = |share| {
            self.margin_s(share)
                .map_or("none".into(), |s| format!("{s:.0} s"))
        };
        let mut text = format!("{}: {} missions\n\n", self.name, self.missions);
        let mut row = |what: &str, told: String| text.push_str(&format!("{what:<30}{told}\n"));
        row("home in time", self.home.words());
        row("reserve touched", self.reserve_touched.words());
        row(
            "left of the budget at home",
            format!("least {}, median {}", seconds(0.0), seconds(0.5)),
        );
        row("least clearance", metres(self.clearance_m));
        row("least altitude", metres(self.altitude_m));
        for change in &self.what_if {
            let words = change.variation.words();
            row(&words, format!("home in time {}", change.home.words()));
            row("", format!("tasks lost: {}", change.lost_words()));
        }
        for (later_s, home) in &self.launches {
            row(
                &Variation::Launched(*later_s).words(),
                format!("home in time {}", home.words()),
            );
        }
        let mut table = Table::new(["task", "done in (%)"]);
        for (name, p) in &self.tasks {
            table.row([name.clone(), format!("{:.0}", 100.0 * p)]);
        }
        if !self.tasks.is_empty() {
            text.push_str(&format!("\n{table}"));
        }
        text.push_str("\nWorst\n");
        for bad in &self.worst {
            text.push_str(&format!(
                " - seed {}, {}: {}\n   {}\n",
                bad.seed, bad.outcome, bad.why, bad.command
            ));
        }
        text
    }
}

impl WhatIf {
    fn of(flights: &Flights, variation: Variation) -> Self {
        let tasks = flights.tasks.iter().enumerate();
        let is_lost = |&(i, _): &(usize, &String)| {
            flights.p_done(Variation::AsPlanned, i) >= MOSTLY
                && flights.p_done(variation, i) <= RARELY
        };
        Self {
            variation,
            home: Share::of(flights.of(variation), Flown::is_home),
            lost: tasks
                .filter(is_lost)
                .map(|(_, name)| name.clone())
                .collect(),
        }
    }

    /// The tasks lost, in words.
    pub(super) fn lost_words(&self) -> String {
        if self.lost.is_empty() {
            return "none".into();
        }
        self.lost.join(", ")
    }
}

impl Share {
    fn of(flights: &[Flown], holds: impl Fn(&Flown) -> bool) -> Self {
        let count = flights.iter().filter(|flight| holds(flight)).count();
        let (low, high) = FailureRate {
            failures: count as u64,
            runs: flights.len() as u64,
        }
        .bounds_95();
        Self {
            p: count as f64 / flights.len().max(1) as f64,
            low,
            high,
        }
    }

    fn json(self) -> Value {
        json!([self.p, self.low, self.high])
    }

    /// In percent.
    pub(super) fn words(self) -> String {
        let [p, low, high] = [self.p, self.low, self.high].map(|x| 100.0 * x);
        format!("{p:.1} % (95 %: {low:.1} to {high:.1} %)")
    }
}

/// The launch of a variation with how many get home; the planned launch is one.
fn launch((variation, flights): &(Variation, Vec<Flown>)) -> Option<(f64, Share)> {
    let later_s = match variation {
        Variation::AsPlanned => 0.0,
        Variation::Launched(later_s) => *later_s,
        Variation::HourLess | Variation::StrongerCurrent => return None,
    };
    Some((later_s, Share::of(flights, Flown::is_home)))
}

/// The worst flights: those that are not home first, the worst outcome before others, then the least margin.
fn worst(flights: &[Flown], origin: &Origin) -> Vec<Bad> {
    let rank = |flown: &Flown| match flown.outcome {
        Some(MissionOutcome::Collided) => 0,
        None => 1,
        Some(MissionOutcome::Aborted) => 2,
        Some(MissionOutcome::Late) => 3,
        Some(MissionOutcome::Docked) => 4,
    };
    let mut order: Vec<&Flown> = flights.iter().collect();
    order.sort_by(|a, b| {
        let margin = a.remaining_s.total_cmp(&b.remaining_s);
        rank(a).cmp(&rank(b)).then(margin).then(a.k.cmp(&b.k))
    });
    let bad = |flown: &&Flown| Bad {
        seed: origin.seed_of(flown.k),
        outcome: flown
            .outcome
            .map_or("failed".into(), |outcome| outcome.to_string()),
        why: cause(flown),
        command: origin.command(flown.k),
    };
    order.iter().take(WORST).map(bad).collect()
}

/// Why a flight is among the worst.
fn cause(flown: &Flown) -> String {
    let why = &flown.why;
    match flown.outcome {
        Some(MissionOutcome::Docked) => {
            format!("{why}, with {:.0} s of the budget left", flown.remaining_s)
        }
        Some(MissionOutcome::Late) => format!("{why}, {:.0} s late", -flown.remaining_s),
        _ => why.clone(),
    }
}
