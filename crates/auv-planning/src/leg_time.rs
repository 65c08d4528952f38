//! How long a leg takes.

use crate::Vehicle;
use crate::leg_manoeuvres::LegManoeuvres;
use crate::leg_outline::{LegOutline, UnderWay};
use crate::motion::{NotFlyable, travel_time_s};
use auv_ocean::CurrentField;
use auv_types::Point3;

/// How long legs take a vehicle in the water as forecast: the one estimate that routes, expected leg
/// times, the check before launch and the times home are made of.
///
/// ```
/// use auv_planning::{LegOutline, LegTime, Vehicle};
/// use auv_types::Point3;
///
/// let vehicle = Vehicle::paper();
/// let leg_time = LegTime::in_still_water(&vehicle);
/// let guide = [Point3::origin(), Point3::new(600.0, 0.0, 0.0)];
/// let leg = LegOutline { stay_s: 60.0, ..LegOutline::straight(&guide, 0.0) };
/// let duration = leg_time.of(&leg)?;
/// assert_eq!((duration.under_way_s(), duration.total_s()), (200.0, 260.0));
/// # Ok::<(), auv_planning::NotFlyable>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LegTime<'a> {
    /// The vehicle, which travels at its cruising speed.
    pub vehicle: &'a Vehicle,
    /// The current that moves the vehicle, as forecast (`None`: still water).
    pub current: Option<&'a dyn CurrentField>,
}

/// How long the parts of a leg take, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LegDuration {
    /// Along the guide at cruising speed.
    pub travel_s: f64,
    /// Added by the turn from the direction in which the leg begins; negative where the leg begins nearer
    /// to its end than its guide does.
    pub turns_s: f64,
    /// Added by changes of depth that the pitch limit stretches.
    pub climbs_s: f64,
    /// At the end of the leg: the work, or as many circles as it takes.
    pub stay_s: f64,
}

impl<'a> LegTime<'a> {
    /// For a vehicle in still water.
    #[must_use]
    pub const fn in_still_water(vehicle: &'a Vehicle) -> Self {
        Self {
            vehicle,
            current: None,
        }
    }

    /// How long a leg takes. With a current the guide is followed through the water as it is when
    /// the vehicle is there; in still water the length alone counts.
    ///
    /// Turns, climbs and circles are those that the path planner and the synchroniser fly in still, empty
    /// water. A vehicle that hovers, turns on the spot and pitches freely needs none.
    ///
    /// # Errors
    /// [`NotFlyable`] where the current is too strong to make the leg good.
    pub fn of(&self, leg: &LegOutline<'_>) -> Result<LegDuration, NotFlyable> {
        let speed_mps = leg.speed_mps.unwrap_or(self.vehicle.speed_mps);
        let travel_s = match self.current {
            None => leg.length_m / speed_mps,
            Some(current) => travel_time_s(leg.guide, current, speed_mps, leg.departure_s)?,
        };
        let manoeuvres = LegManoeuvres::of(self.vehicle, leg);
        Ok(LegDuration {
            travel_s,
            turns_s: manoeuvres.turns_m / speed_mps,
            climbs_s: manoeuvres.climbs_m / speed_mps,
            stay_s: manoeuvres.stay_s(self.vehicle, leg.stay_s),
        })
    }

    /// How long a guide takes at cruising speed in the water as it is when the vehicle is there, seconds,
    /// without turns and stretched climbs.
    ///
    /// # Errors
    /// [`NotFlyable`] where the current is too strong to make the way good.
    pub fn travel_s(&self, guide: &[Point3<f64>], departure_s: f64) -> Result<f64, NotFlyable> {
        let speed_mps = self.vehicle.speed_mps;
        match self.current {
            None => Ok(LegOutline::straight(guide, departure_s).length_m / speed_mps),
            Some(current) => travel_time_s(guide, current, speed_mps, departure_s),
        }
    }

    /// How the vehicle leaves the end of a leg; `None`: at rest, or turning on the spot, so that the next
    /// leg may begin in any direction.
    #[must_use]
    pub fn leaves(&self, leg: &LegOutline<'_>) -> Option<UnderWay> {
        let end = *leg.guide.last()?;
        if self.vehicle.turn_radius_m <= 0.0 {
            return None;
        }
        let manoeuvres = LegManoeuvres::of(self.vehicle, leg);
        manoeuvres.leaves(self.vehicle, end, leg.stay_s)
    }
}

impl LegDuration {
    /// From departure to the start of the stay, seconds.
    #[must_use]
    pub fn under_way_s(&self) -> f64 {
        self.travel_s + self.turns_s + self.climbs_s
    }

    /// From departure to the end of the stay, seconds.
    #[must_use]
    pub fn total_s(&self) -> f64 {
        self.under_way_s() + self.stay_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_ocean::UniformCurrent;
    use auv_types::Vector3;

    #[test]
    fn still_water_counts_the_length_and_a_current_the_guide() {
        let vehicle = Vehicle::paper();
        let guide = [0.0, 300.0, 600.0].map(|x| Point3::new(x, 0.0, 10.0));
        let leg = LegOutline {
            length_m: 603.0,
            stay_s: 30.0,
            ..LegOutline::straight(&guide, 100.0)
        };
        let still = LegTime::in_still_water(&vehicle);
        let duration = still.of(&leg).unwrap();
        assert_eq!((duration.under_way_s(), duration.total_s()), (201.0, 231.0));
        let ebb = UniformCurrent::new(Vector3::new(-1.0, 0.0, 0.0));
        let against = LegTime {
            current: Some(&ebb),
            ..still
        };
        assert_eq!(against.of(&leg).unwrap().total_s(), 330.0);
    }

    #[test]
    fn a_leg_against_too_strong_a_current_cannot_be_made_good() {
        let vehicle = Vehicle::paper();
        let guide = [Point3::origin(), Point3::new(400.0, 0.0, 0.0)];
        let leg = LegOutline::straight(&guide, 0.0);
        let against = |mps: f64| {
            let ebb = UniformCurrent::new(Vector3::new(-mps, 0.0, 0.0));
            let leg_time = LegTime {
                current: Some(&ebb),
                ..LegTime::in_still_water(&vehicle)
            };
            leg_time.of(&leg)
        };
        // 2 % of the cruising speed is left over ground, then 0.7 %.
        assert!((against(2.94).unwrap().total_s() - 400.0 / 0.06).abs() < 1e-6);
        let place = Point3::new(200.0, 0.0, 0.0);
        assert_eq!(against(2.98), Err(NotFlyable { place }));
    }
}
