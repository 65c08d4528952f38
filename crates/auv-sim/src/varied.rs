//! What a mission is compared with: the same mission, and one thing is different.

use crate::Scenario;
use auv_obstacles::truth::TrackedShip;
use auv_ocean::{CurrentField, ForecastError, Perturbed};
use std::sync::Arc;
#[cfg(feature = "mission-file")]
use {
    auv_obstacles::truth::{FieldSettings, ObstacleField},
    auv_types::Violations,
};

impl Scenario {
    /// The same mission with a budget that is longer by some seconds (shorter if negative). The reserve stays.
    #[must_use]
    pub fn with_budget_longer(mut self, by_s: f64) -> Self {
        Arc::make_mut(&mut self.mission).budget_s += by_s;
        self
    }

    /// The same mission in a sea whose true current is so many times as strong. The forecast stays.
    #[must_use]
    pub fn with_current_times(mut self, gain: f64) -> Self {
        let error = ForecastError { gain, delay_s: 0.0 };
        self.true_current = self.true_current.map(|current| perturbed(current, error));
        self
    }

    /// The same mission in the sea as forecast and charted, without obstacles, ships and false echoes, flown without
    /// errors of guidance.
    #[cfg(feature = "mission-file")]
    pub(crate) fn in_forecast_sea(mut self) -> Result<Self, Violations> {
        let settings = FieldSettings::default();
        self.field = ObstacleField::new(Vec::new(), settings, self.seed)?;
        self.true_current.clone_from(&self.mission.current);
        (self.true_bed, self.water_level, self.altimeter) = (None, None, None);
        self.sonar.clutter_per_scan = 0.0;
        self.guidance_error_m = 0.0;
        Ok(self)
    }

    /// The same mission launched so many seconds later (earlier if negative): current, water level, fences, ships
    /// and the windows of tasks are those of the later time. Obstacles are where they were.
    #[must_use]
    pub fn launched_later(mut self, by_s: f64) -> Self {
        let error = ForecastError {
            gain: 1.0,
            delay_s: -by_s,
        };
        let later = |current: Option<_>| current.map(|current| perturbed(current, error));
        self.true_current = later(self.true_current);
        let mission = Arc::make_mut(&mut self.mission);
        mission.current = later(mission.current.take());
        if mission.fronts.is_some() {
            mission.find_fronts();
        }
        self.fences.begin_later(-by_s);
        for tide in self
            .water_level
            .iter_mut()
            .flat_map(|level| &mut level.tide)
        {
            tide.highest -= by_s;
        }
        if let Some(model) = &mut mission.time_model {
            let tasks = Arc::make_mut(model).tasks.iter_mut();
            for time_s in tasks.flat_map(|task| task.windows.as_flattened_mut()) {
                *time_s -= by_s;
            }
        }
        let ships = self.field.ships().iter().cloned();
        let ships: Vec<TrackedShip> = ships.map(|ship| ship.delayed(-by_s)).collect();
        self.field = self.field.with_ships(ships);
        self
    }
}

fn perturbed(current: Arc<dyn CurrentField>, error: ForecastError) -> Arc<dyn CurrentField> {
    Arc::new(Perturbed::new(current, error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Campaign;
    use auv_obstacles::truth::{AfterLastFix, ShipFix};
    use auv_types::{Point3, Seed};

    #[test]
    fn a_later_launch_meets_the_sea_of_the_later_time() {
        let mut scenario = Campaign::table2(Seed(1)).unwrap().scenario(0).unwrap();
        let fixes = [0.0, 600.0].map(|time_s| ShipFix {
            time_s,
            north_m: time_s,
            east_m: 0.0,
        });
        let ship = TrackedShip::new(fixes.to_vec(), 50.0, 3.0, AfterLastFix::HoldCourse);
        scenario.field = scenario.field.with_ships(vec![ship.unwrap()]);
        let current = scenario.true_current.clone().unwrap();
        let varied = scenario
            .clone()
            .launched_later(120.0)
            .with_current_times(1.5);
        let place = Point3::new(5.0, 5.0, 5.0);
        let now = varied.true_current.unwrap().velocity_at(&place, 30.0);
        let then = current.velocity_at(&place, 150.0) * 1.5;
        assert!((now - then).norm() < 1e-12);
        assert_eq!(varied.field.ships()[0].fixes()[0].time_s, -120.0);
        let shorter = scenario.clone().with_budget_longer(-600.0);
        assert_eq!(shorter.mission.budget_s, scenario.mission.budget_s - 600.0);
        assert_eq!(shorter.mission.reserve_s, scenario.mission.reserve_s);
    }
}
