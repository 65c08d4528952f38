//! Whether a mission's collision could have been avoided by a vehicle that knows the truth.

use crate::closed_loop::ship_ids;
use crate::disturbance::{Disturbance, Moment, Undisturbed};
use crate::oracle::SeaInterval;
use crate::oracle::flyable::Flier;
use crate::simulate::fly;
use crate::{Judgement, Scenario};
use auv_mission::driver::{Driver, Orders};
use auv_mission::{Event, Synchroniser};
use auv_obstacles::{ObstacleId, Region, Scan, TimedPoint};
use auv_types::{Vector3, Violations};

/// A way out is sought from this long before the collision on at the earliest, seconds ...
const BEFORE_S: f64 = 60.0;
/// ... until this long after it.
const AFTER_S: f64 = 20.0;
/// The thing that is hit counts as seen if it was so within this long before, seconds.
const REMEMBERED_S: f64 = 600.0;

/// The first collision of a mission that no way could have avoided: when it happened, mission time in
/// seconds. `None` where there was a way, no collision, or a grounding.
///
/// The mission is flown again, and its truth recorded. A way is one that the vehicle can fly: within its turn
/// radius, pitch, least and greatest speed, box and bed, clear of every true obstacle. It may start with the
/// first echo of the thing that is hit, or from launch where the thing is charted or
/// reports itself by transponder; at most a minute before the collision, which asks more of the vehicle.
///
/// # Errors
/// Every reason why the scenario is invalid.
pub fn unavoidable_s(
    scenario: &Scenario,
    mut driver: impl Driver,
    judgement: &Judgement,
) -> Result<Option<f64>, Violations> {
    let hit_s = judgement.first_collision_s;
    if judgement.groundings > 0 || !hit_s.is_finite() {
        return Ok(None);
    }
    let mut truth = Truth {
        hit_s,
        driver: &mut driver,
        intervals: Vec::new(),
        scans: Vec::new(),
    };
    fly(scenario, &mut truth, &mut ())?;
    let way = truth.has_way(scenario);
    Ok((!way).then_some(hit_s))
}

/// Records the truth around a collision.
struct Truth<'a> {
    /// When it happened.
    hit_s: f64,
    driver: &'a mut dyn Driver,
    intervals: Vec<SeaInterval>,
    scans: Vec<Scan>,
}

impl Disturbance for Truth<'_> {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event, time_s: f64) -> Orders {
        Undisturbed(self.driver).tell(synchroniser, event, time_s)
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser, time_s: f64) -> Orders {
        Undisturbed(self.driver).carry_on(synchroniser, time_s)
    }

    fn scans(&mut self, now: &Moment, scan: Scan) -> Vec<Scan> {
        if self.is_around(now.time_s) {
            self.scans.push(scan.clone());
        }
        vec![scan]
    }

    fn wants_truth(&self) -> bool {
        true
    }

    fn record_truth(&mut self, interval: SeaInterval) {
        if self.is_around(interval.from_s) {
            self.intervals.push(interval);
        }
    }
}

impl Truth<'_> {
    fn is_around(&self, time_s: f64) -> bool {
        (self.hit_s - REMEMBERED_S..=self.hit_s + AFTER_S).contains(&time_s)
    }

    fn has_way(&self, scenario: &Scenario) -> bool {
        let hit_s = self.hit_s;
        let at = self
            .intervals
            .partition_point(|interval| interval.from_s < hit_s);
        let Some(hit) = self.hit(at) else {
            return true;
        };
        let Some(known_s) = self.known_s(scenario, hit) else {
            return false;
        };
        let from_s = known_s.max(hit_s - BEFORE_S);
        let first = self
            .intervals
            .partition_point(|interval| interval.from_s < from_s);
        let last = self
            .intervals
            .partition_point(|interval| interval.until_s <= hit_s + AFTER_S);
        let current = scenario.true_current.as_deref();
        let flier = Flier {
            vehicle: scenario.mission.vehicle,
            bounds: scenario.mission.bounds,
            bed: None,
            current: current.filter(|_| scenario.current_moves_vehicle),
        };
        let bed = scenario.bed_between(from_s, hit_s);
        let flier = Flier {
            bed: bed.as_ref().map(|bed| bed as _),
            ..flier
        };
        let ways = &self.intervals[first..last.max(at + 1).min(self.intervals.len())];
        flier.has_way(ways, self.velocity(first))
    }

    /// What the vehicle hits in an interval.
    fn hit(&self, at: usize) -> Option<ObstacleId> {
        let (interval, next) = (self.intervals.get(at)?, self.intervals.get(at + 1));
        let from = TimedPoint::new(interval.place, interval.from_s);
        let end = next.map_or(interval.place + self.velocity(at), |next| next.place);
        let to = TimedPoint::new(end, interval.until_s);
        let clearance_m = |id: &usize| interval.regions[*id].clearance(&from, &to).clearance_m;
        let nearest =
            (0..interval.regions.len()).min_by(|a, b| clearance_m(a).total_cmp(&clearance_m(b)))?;
        Some(interval.regions[nearest].obstacle)
    }

    /// Since when a thing can be known: from launch, or from its first echo.
    fn known_s(&self, scenario: &Scenario, thing: ObstacleId) -> Option<f64> {
        let charted = scenario.field.charted();
        let is_charted = charted.iter().any(|region| region.obstacle == thing);
        if is_charted || ship_ids(&scenario.field).contains(&thing.0) {
            return Some(f64::NEG_INFINITY);
        }
        let shows = |scan: &&Scan| {
            let until = |interval: &SeaInterval| interval.until_s <= scan.time_s;
            let interval = self.intervals.get(self.intervals.partition_point(until));
            let regions = interval.iter().flat_map(|interval| &interval.regions);
            let mut parts = regions.filter(|region| region.obstacle == thing);
            parts.any(|region| has_echo_of(scan, region))
        };
        self.scans.iter().find(shows).map(|scan| scan.time_s)
    }

    /// The mean velocity over ground in an interval.
    fn velocity(&self, k: usize) -> Vector3<f64> {
        let Some(pair) = self.intervals.get(k..k + 2) else {
            return k
                .checked_sub(1)
                .map_or(Vector3::x(), |before| self.velocity(before));
        };
        (pair[1].place - pair[0].place) / (pair[1].from_s - pair[0].from_s)
    }
}

/// Whether an echo of a scan lies in a region, but for four standard deviations.
fn has_echo_of(scan: &Scan, region: &Region) -> bool {
    let mut echoes = scan.detections.iter();
    echoes.any(|echo| {
        let at = TimedPoint::new(echo.position, scan.time_s);
        region.exists_at(scan.time_s) && region.distance_m(&at) <= 4.0 * echo.position_sigma_m
    })
}
