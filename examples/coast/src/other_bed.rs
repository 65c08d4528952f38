//! A true bed that the chart's standard deviation does not explain.

use crate::CoastalMission;
use crate::dice::{Dice, Hardness};
use auv_ocean::{LevelledBed, MeasuredBed, SeaBed, Shoal};
use auv_sim::{Altimeter, Scenario};
use std::sync::Arc;

/// How far apart the draws of banks are from those of the mission.
const OF_BANKS: u64 = 1 << 32;

/// How the true bed differs from the bed that the mission file gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct OtherBed {
    /// By how much it is shallower everywhere, metres.
    pub(crate) shallower_m: f64,
    /// Whether there is a bank on each leg that is not in the chart.
    pub(crate) banks: bool,
}

impl OtherBed {
    /// Puts the bed under a scenario; the vehicle has an altimeter then.
    pub(crate) fn put_under(self, mission: &CoastalMission, scenario: &mut Scenario) {
        if self.shallower_m <= 0.0 && !self.banks {
            return;
        }
        let given: Arc<dyn SeaBed> = scenario
            .true_bed
            .take()
            .unwrap_or_else(|| Arc::new(mission.bed.clone()));
        let banks = if self.banks {
            banks(mission)
        } else {
            Vec::new()
        };
        let bed = LevelledBed::new(given, -self.shallower_m);
        scenario.true_bed = Some(Arc::new(MeasuredBed::new(bed, banks)));
        scenario.altimeter.get_or_insert(Altimeter::default());
    }
}

/// A bank near the middle of each leg of the tour that is long enough: flat-topped, 4 to 10 m high, with slopes
/// of up to 1 in 4.
fn banks(mission: &CoastalMission) -> Vec<Shoal> {
    let dice = &mut Dice::new(
        mission.seed.split(mission.number),
        OF_BANKS,
        Hardness::Usual,
    );
    let mut banks = Vec::new();
    for ends in mission.places.windows(2) {
        let raised_m = dice.between(4.0, 10.0);
        let reach_m = raised_m * dice.between(6.0, 12.0);
        let share = dice.between(0.4, 0.6);
        let [north_m, east_m] = [0, 1].map(|k| {
            let [from, to] = [ends[0].at[k], ends[1].at[k]];
            from + share * (to - from)
        });
        let bank = Shoal {
            north_m,
            east_m,
            raised_m,
            reach_m,
        };
        let clear = |at: [f64; 3]| bank.away_m(at[0], at[1]) > 2.0 * reach_m;
        if ends.iter().all(|end| clear(end.at)) {
            banks.push(bank);
        }
    }
    banks
}
