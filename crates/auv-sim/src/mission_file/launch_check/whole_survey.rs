//! Whether a survey that is flown as a whole can be done at all.

use super::possible::{Possible, Prospects};
use crate::mission_file::document::MissionFile;
use crate::mission_file::surveys::entry::SurveyEntry;
use crate::mission_file::works::Work;
use auv_graph::NodeId;
use std::collections::BTreeMap;

impl MissionFile {
    /// The survey that the end of a line belongs to, if it is flown as a whole.
    #[must_use]
    pub fn whole_survey_from(&self, waypoint: &str) -> Option<&str> {
        let line = self
            .waypoints
            .iter()
            .find(|entry| entry.name == waypoint)?
            .line?;
        let survey = self.surveys.get(self.lines.get(line)?.survey)?;
        (!survey.may_split()).then(|| survey.name())
    }

    /// The survey that a task belongs to and that is flown as a whole, by its index.
    pub(super) fn whole_survey(&self, task: &str) -> Option<(usize, &SurveyEntry)> {
        let line = self.line_of(task).map(|line| line.survey);
        let begins = || {
            self.surveys
                .iter()
                .position(|survey| survey.begins() == task)
        };
        let survey = line.or_else(begins)?;
        let entry = self.surveys.get(survey)?;
        (!entry.may_split()).then_some((survey, entry))
    }

    /// Whether work can be done alone; of a survey that is flown as a whole, whether all of it can. `known` keeps when
    /// the vehicle is home from each of these.
    pub(super) fn possible(
        &self,
        work: &Work,
        prospects: &Prospects<'_>,
        known: &mut BTreeMap<usize, f64>,
    ) -> Possible {
        let alone = prospects.of(work);
        match (alone, self.whole_survey(&work.name)) {
            (Possible::Yes { .. }, Some((survey, _))) => {
                let home_s = known.entry(survey);
                let home_s = home_s.or_insert_with(|| self.home_from_survey_s(survey, prospects));
                match home_s.is_finite() {
                    true => prospects.home_at(*home_s),
                    false => alone,
                }
            }
            _ => alone,
        }
    }

    /// When the vehicle is home from all lines of a survey, flown in their order from the first or the last, seconds.
    fn home_from_survey_s(&self, survey: usize, prospects: &Prospects<'_>) -> f64 {
        let of_it = self.lines.iter().filter(|line| line.survey == survey);
        let forth: Vec<[NodeId; 2]> = of_it
            .map(|line| line.ends.map(|i| NodeId(i as u32)))
            .collect();
        let back = forth.iter().rev().copied().collect();
        let mut least_s = f64::INFINITY;
        for lines in [forth, back] {
            for side in 0..2 {
                let ends = lines.iter().enumerate().flat_map(|(k, &[a, b])| {
                    let is_forth = (k + side) % 2 == 0;
                    if is_forth { [a, b] } else { [b, a] }
                });
                least_s = least_s.min(prospects.home_along_s(&ends.collect::<Vec<_>>()));
            }
        }
        least_s
    }
}
