//! What is told of waypoints that lie where they must not: of the ends of a survey's lines once for the survey.

use super::document::MissionFile;
use auv_mission::{Misplacement, Mission};
use auv_types::Violations;
use std::collections::BTreeMap;

/// A waypoint that lies where it must not.
pub(super) struct Misplaced {
    pub(super) waypoint: usize,
    /// Of the faults of a survey the one with the least rank is told.
    pub(super) rank: u32,
    /// How far it is from where it may be, metres.
    pub(super) by_m: f64,
    /// Where it lies.
    pub(super) what: String,
    /// What to do about a waypoint of the file ...
    pub(super) remedy: &'static str,
    /// ... and about a survey.
    pub(super) of_survey: &'static str,
}

impl MissionFile {
    /// The waypoints above the surface, out of the box, on land or too deep.
    pub(super) fn misplaced(&self, mission: &Mission) -> Violations {
        let found = mission.misplacements().into_iter().map(|(node, why)| {
            let line = self.waypoints[node.index()].line;
            let follows = |line: usize| self.lines[line].height.over_m(0.0).is_some();
            let (rank, of_survey) = match why {
                Misplacement::OutsideBox { .. } => (0, "move the survey inside"),
                Misplacement::OnLand => (1, "move the survey into the water"),
                Misplacement::AboveSurface { .. } => (2, "give a smaller altitude_m"),
                _ if line.is_some_and(follows) => (3, "give a greater altitude_m"),
                _ => (3, "give a smaller depth_m"),
            };
            Misplaced {
                waypoint: node.index(),
                rank,
                by_m: why.by_m(),
                what: why.to_string(),
                remedy: why.remedy(),
                of_survey,
            }
        });
        let mut violations = Violations::new();
        self.tell(found.collect(), &mut violations);
        violations
    }

    /// Adds the faults of waypoints, of each survey one: at the end of a line where it is worst.
    pub(super) fn tell(&self, wrong: Vec<Misplaced>, violations: &mut Violations) {
        let mut surveys: BTreeMap<usize, Vec<Misplaced>> = BTreeMap::new();
        for fault in wrong {
            let entry = &self.waypoints[fault.waypoint];
            match entry.line.and_then(|line| self.lines.get(line)) {
                Some(line) => surveys.entry(line.survey).or_default().push(fault),
                None => {
                    let place = format!("waypoints[{}] ({})", fault.waypoint, entry.name);
                    violations.push(place, format!("{}; {}", fault.what, fault.remedy));
                }
            }
        }
        for (survey, mut faults) in surveys {
            let least = faults.iter().map(|fault| fault.rank).min();
            faults.retain(|fault| Some(fault.rank) == least);
            let ends = 2 * self.lines.iter().filter(|l| l.survey == survey).count();
            let Some(worst) = faults.iter().max_by(|a, b| a.by_m.total_cmp(&b.by_m)) else {
                continue;
            };
            let name = &self.waypoints[worst.waypoint].name;
            violations.push(
                format!("surveys[{survey}] ({})", self.surveys[survey].name()),
                format!(
                    "{name}, the end of a line, {}; so {} of its {ends} line ends: {}",
                    worst.what,
                    match faults.len() {
                        1 => "does 1".to_owned(),
                        count => format!("do {count}"),
                    },
                    worst.of_survey
                ),
            );
        }
    }
}
