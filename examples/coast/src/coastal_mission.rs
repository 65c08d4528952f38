//! One random coastal mission.

use crate::Landscape;
use crate::dice::{Dice, Hardness};
use crate::traits::Traits;
use crate::vehicle::vehicle;
use crate::waters::Waters;
use crate::waypoints::{Place, Rules};
use auv_ocean::AnalyticBed;
use auv_planning::Vehicle;
use auv_sim::Body;
use auv_types::{Seed, libm};

/// A random coastal mission, plausible for an operator: every waypoint lies in legal water.
///
/// # Determinism
/// It depends on seed and number only.
#[derive(Clone, Debug, PartialEq)]
pub struct CoastalMission {
    /// Its number.
    pub number: u64,
    pub(crate) seed: Seed,
    /// Whether the true bed is drawn from the chart's standard deviation.
    pub drawn_bed: bool,
    pub(crate) traits: Traits,
    pub(crate) bed: AnalyticBed,
    pub(crate) body: Body,
    pub(crate) vehicle: Vehicle,
    /// Least altitude, metres, and standard deviations above it.
    pub(crate) altitude: [f64; 2],
    /// Least and greatest depth of the box, metres.
    pub(crate) depth_m: [f64; 2],
    /// Half side of the box, metres.
    pub(crate) box_m: f64,
    /// Waypoints in the order of a short tour: start first, destination last.
    pub(crate) places: Vec<Place>,
    /// Whether the tour's edges are listed.
    pub(crate) chain: bool,
    /// Which edges of the tour carry a task.
    pub(crate) edge_tasks: Vec<bool>,
    /// Nearest waypoints that each waypoint is connected to.
    pub(crate) nearest: usize,
    pub(crate) budget_s: f64,
    pub(crate) waters: Waters,
}

impl CoastalMission {
    /// Mission `number` of a seed.
    #[must_use]
    pub fn draw(seed: Seed, number: u64, hardness: Hardness, body: Body) -> Self {
        let own = seed.split(number);
        let mut attempt = 0;
        loop {
            if let Some(mission) =
                Self::attempt(seed, number, body, &mut Dice::new(own, attempt, hardness))
            {
                return mission;
            }
            attempt += 1;
        }
    }

    /// What makes it hard.
    #[must_use]
    pub fn traits(&self) -> &Traits {
        &self.traits
    }

    /// A mission; `None` where its bed has no room for waypoints.
    fn attempt(seed: Seed, number: u64, body: Body, dice: &mut Dice) -> Option<Self> {
        let landscape = Landscape::ALL[dice.count(0, Landscape::ALL.len() - 1)];
        let half_m = dice.whole(500.0, 1_000.0);
        let bed = landscape.bed(half_m, dice);
        let vehicle = vehicle(body, dice);
        let altitude = if dice.chance(0.75) {
            [5.0, 2.0]
        } else {
            [dice.hundredth(3.0, 8.0), dice.hundredth(1.0, 3.0)]
        };
        let top_m = if dice.chance(0.5) {
            3.0
        } else {
            dice.whole(0.0, 5.0)
        };
        let rules = Rules {
            bed: &bed,
            altitude,
            top_m,
            vehicle,
            half_m,
        };
        let places = rules.places(dice)?;
        let waters = Waters::draw(&bed, &places, half_m, dice);
        let chain = dice.chance(0.6);
        let budget_s = budget_s(&places, &vehicle, dice);
        Some(Self {
            number,
            seed,
            drawn_bed: false,
            traits: Traits::of(landscape, waters.is_empty(), &places),
            body,
            vehicle,
            altitude,
            depth_m: [top_m, 200.0],
            box_m: half_m + {
                let [low, high] = dice.by_hardness([50.0, 400.0], [0.0, 100.0]);
                dice.whole(low, high)
            },
            edge_tasks: places[1..]
                .iter()
                .map(|_| chain && dice.chance(0.25))
                .collect(),
            places,
            chain,
            nearest: if chain { dice.count(1, 2) } else { 3 },
            budget_s,
            waters,
            bed,
        })
    }
}

/// A budget for the whole tour with time to spare, the preset's reserve of 15 % included.
fn budget_s(places: &[Place], vehicle: &Vehicle, dice: &mut Dice) -> f64 {
    let legs = places.windows(2).map(|ends| {
        let [dn, de, dz] = [0, 1, 2].map(|k| ends[1].at[k] - ends[0].at[k]);
        let level_m = libm::sqrt(dn * dn + de * de);
        let steep_m = dz.abs() / libm::sin(vehicle.max_pitch_rad);
        level_m.max(steep_m) + 4.0 * vehicle.turn_radius_m
    });
    let stays_s: f64 = places.iter().filter_map(|place| place.task_s).sum();
    let tour_s = legs.sum::<f64>() / vehicle.speed_mps + 1.5 * stays_s;
    (tour_s * dice.between(1.6, 3.0) + 900.0).round()
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_sim::mission_file::{MissionData, MissionFile};

    #[test]
    fn missions_are_reproducible_and_as_varied_as_stated() {
        let missions: Vec<CoastalMission> = (0..200)
            .map(|k| CoastalMission::draw(Seed(0), k, Hardness::Usual, Body::Point))
            .collect();
        assert_eq!(
            missions[7],
            CoastalMission::draw(Seed(0), 7, Hardness::Usual, Body::Point)
        );
        assert_ne!(
            missions[7].bed,
            CoastalMission::draw(Seed(1), 7, Hardness::Usual, Body::Point).bed
        );
        let count =
            |what: &dyn Fn(&Traits) -> bool| missions.iter().filter(|m| what(&m.traits)).count();
        let steep = count(&|traits| traits.is_steep());
        let empty = count(&|traits| traits.empty);
        assert!(steep >= 60, "{steep} of 200 are steep");
        assert!((80..=120).contains(&empty), "{empty} of 200 are empty");
        for landscape in Landscape::ALL {
            assert!(count(&|traits| traits.landscape == landscape) >= 20);
        }
    }

    /// Every waypoint lies in legal water: a refusal has other reasons.
    #[test]
    fn the_file_holds_the_mission() {
        for k in 0..20 {
            let mission = CoastalMission::draw(Seed(0), k, Hardness::Usual, Body::Point);
            let file = MissionFile::from_toml(&mission.to_toml()).unwrap();
            let built = file.scenario(&MissionData::default(), Seed(1));
            let scenario = match built {
                Ok(scenario) => scenario,
                Err(refusal) => {
                    assert!(!refusal.to_string().contains("the deepest allowed over"));
                    continue;
                }
            };
            let waypoints = scenario.mission.network.waypoints();
            for (place, waypoint) in mission.places.iter().zip(waypoints) {
                let [n, e, z] = place.at;
                // A waypoint at the limit is flown higher by what the guidance error may cost.
                let flown = waypoint.position;
                assert_eq!([n, e], [flown.x, flown.y]);
                assert!(
                    flown.z <= z && (place.at_limit || flown.z > z - 2.0),
                    "{z} {flown}"
                );
                let deepest_m = scenario.mission.deepest_at(n, e);
                assert!(
                    !place.at_limit || deepest_m - flown.z < 0.511,
                    "W at {flown}: {deepest_m}"
                );
            }
            assert_eq!(scenario.mission.vehicle, mission.vehicle);
        }
    }
}
