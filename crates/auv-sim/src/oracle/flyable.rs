//! Whether a way that the vehicle can fly stays clear of the truth.

use super::SeaInterval;
use auv_obstacles::TimedPoint;
use auv_ocean::{CurrentField, SeaBed};
use auv_planning::Vehicle;
use auv_types::{Bounds, Point3, Vector3, libm};
use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

/// Ways that end in the same cell count as one: half the way, climb and turn of a step apart.
const SIDE_M: f64 = 1.0;
const HEIGHT_M: f64 = 0.25;
const HEADINGS: f64 = 144.0;
/// Directions in which a vehicle that turns on the spot may leave.
const DIRECTIONS: u32 = 16;
/// The longest step, seconds.
const STEP_S: f64 = 2.0;
/// Most ways that are followed at once.
const MOST: usize = 6_000;

/// What bounds the vehicle's motion.
pub(crate) struct Flier<'a> {
    pub(crate) vehicle: Vehicle,
    pub(crate) bounds: Option<Bounds>,
    pub(crate) bed: Option<&'a dyn SeaBed>,
    /// The current that carries the vehicle.
    pub(crate) current: Option<&'a dyn CurrentField>,
}

#[derive(Clone, Copy)]
struct State {
    place: Point3<f64>,
    heading_rad: f64,
}

/// How the vehicle is steered during a step.
#[derive(Clone, Copy)]
struct Control {
    speed_mps: f64,
    /// Sine of the pitch, down.
    slope: f64,
    heading: Heading,
}

#[derive(Clone, Copy)]
enum Heading {
    /// Turns by this much per metre, radians.
    Turns(f64),
    /// Goes this way at once, radians.
    Is(f64),
}

/// A part of an interval.
struct Step<'a> {
    interval: &'a SeaInterval,
    from_s: f64,
    duration_s: f64,
}

impl Flier<'_> {
    /// Whether a way from the start of the first interval on, with a velocity, keeps clear of all obstacles, box
    /// and bed to the end of the last: with any turn, pitch and speed that the vehicle has. One manoeuvre held,
    /// then straight on, is tried first; then everything else. Ways that come together are followed as one, so
    /// a narrow way may be missed.
    pub(crate) fn has_way(&self, intervals: &[SeaInterval], velocity: Vector3<f64>) -> bool {
        let Some(first) = intervals.first() else {
            return true;
        };
        let start = State {
            place: first.place,
            heading_rad: libm::atan2(velocity.y, velocity.x),
        };
        let near = within_reach(intervals, first.place);
        let steps: Vec<Step<'_>> = near.iter().flat_map(steps_of).collect();
        self.has_simple_way(&steps, start) || self.has_any_way(&steps, start)
    }

    /// Whether a control held for some time, and then straight on, is clear.
    fn has_simple_way(&self, steps: &[Step<'_>], start: State) -> bool {
        let fastest_mps = steps.iter().map(|step| step.interval.max_speed_mps);
        let controls = self.controls(fastest_mps.fold(0.0, f64::max));
        controls.iter().any(|held| {
            let mut here = start;
            for (k, step) in steps.iter().enumerate() {
                let straight = Control {
                    slope: 0.0,
                    heading: match held.heading {
                        Heading::Turns(_) => Heading::Turns(0.0),
                        Heading::Is(_) => held.heading,
                    },
                    ..*held
                };
                let rest = steps[k..].iter();
                let mut after = Some(here);
                for step in rest {
                    after = after.and_then(|here| self.after(here, straight, step));
                }
                if after.is_some() {
                    return true;
                }
                match self.after(here, *held, step) {
                    Some(next) => here = next,
                    None => return false,
                }
            }
            true
        })
    }

    fn has_any_way(&self, steps: &[Step<'_>], start: State) -> bool {
        let mut here = vec![start];
        for step in steps {
            let controls = self.controls(step.interval.max_speed_mps);
            let mut known = BTreeSet::new();
            let mut next = Vec::new();
            for &state in &here {
                for &control in &controls {
                    let to = self.after(state, control, step);
                    next.extend(to.filter(|&to| known.insert(cell(to))));
                }
            }
            let every = next.len().div_ceil(MOST).max(1);
            here = next.into_iter().step_by(every).collect();
            if here.is_empty() {
                return false;
            }
        }
        true
    }

    /// Where a step leads, if that is clear.
    fn after(&self, state: State, control: Control, step: &Step<'_>) -> Option<State> {
        let (interval, duration_s) = (step.interval, step.duration_s);
        let most_mps = interval.max_speed_mps;
        let speed_mps = control.speed_mps.min(most_mps);
        let (mean_rad, heading_rad) = match control.heading {
            Heading::Turns(rad_per_m) => {
                let turn_rad = rad_per_m * speed_mps * duration_s;
                (
                    state.heading_rad + 0.5 * turn_rad,
                    state.heading_rad + turn_rad,
                )
            }
            Heading::Is(heading_rad) => (heading_rad, heading_rad),
        };
        let flat = libm::sqrt((1.0 - control.slope * control.slope).max(0.0));
        let (sin, cos) = libm::sincos(mean_rad);
        let through = Vector3::new(cos * flat, sin * flat, control.slope) * speed_mps;
        let current = self.current;
        let natural = current.map(|current| current.velocity_at(&state.place, step.from_s));
        let water = interval.water + natural.unwrap_or_else(Vector3::zeros);
        let place = state.place + (through + water) * duration_s;
        let way = [
            TimedPoint::new(state.place, step.from_s),
            TimedPoint::new(place, step.from_s + duration_s),
        ];
        self.is_clear(interval, &way)
            .then_some(State { place, heading_rad })
    }

    /// All that the vehicle can do, straight on and fast first.
    fn controls(&self, most_mps: f64) -> Vec<Control> {
        let vehicle = &self.vehicle;
        let steepest = libm::sin(vehicle.max_pitch_rad.min(PI / 2.0));
        let headings: Vec<Heading> = if vehicle.turn_radius_m > 0.0 {
            let sides = [0.0, 1.0, -1.0].into_iter();
            sides
                .map(|side| Heading::Turns(side / vehicle.turn_radius_m))
                .collect()
        } else {
            let parts = (0..DIRECTIONS).map(|k| f64::from(k) / f64::from(DIRECTIONS));
            parts.map(|part| Heading::Is(TAU * part)).collect()
        };
        let mut controls = Vec::new();
        for speed_mps in [most_mps, vehicle.min_speed_mps.min(most_mps)] {
            for &heading in &headings {
                controls.extend([0.0, steepest, -steepest].map(|slope| Control {
                    speed_mps,
                    slope,
                    heading,
                }));
            }
        }
        controls
    }

    fn is_clear(&self, interval: &SeaInterval, way: &[TimedPoint; 2]) -> bool {
        let [from, to] = way;
        let outside_m = |bounds: &Bounds, p: &TimedPoint| bounds.excess_m(&p.position);
        let inside = self
            .bounds
            .as_ref()
            .is_none_or(|bounds| outside_m(bounds, to) <= outside_m(bounds, from).max(0.0));
        let above = self
            .bed
            .is_none_or(|bed| bed.depth_at(to.position.x, to.position.y) > to.position.z);
        let mut regions = interval.regions.iter();
        inside && above && regions.all(|region| region.clearance(from, to).clearance_m >= 0.0)
    }
}

/// The intervals with those obstacles alone that the vehicle can meet from a place on.
fn within_reach(intervals: &[SeaInterval], place: Point3<f64>) -> Vec<SeaInterval> {
    let way_m = |interval: &SeaInterval| {
        let water_mps = interval.water.norm() + interval.water_differs_mps;
        (interval.max_speed_mps + water_mps) * (interval.until_s - interval.from_s)
    };
    let reach_m: f64 = intervals.iter().map(way_m).sum();
    let mut near = intervals.to_vec();
    for interval in &mut near {
        let (from, to) = interval.rest(place);
        let regions = &mut interval.regions;
        regions.retain(|region| region.clearance(&from, &to).clearance_m <= reach_m);
    }
    near
}

fn steps_of(interval: &SeaInterval) -> impl Iterator<Item = Step<'_>> {
    let whole_s = interval.until_s - interval.from_s;
    let steps = (whole_s / STEP_S).ceil().max(1.0);
    let duration_s = whole_s / steps;
    (0..steps as u32).map(move |k| Step {
        interval,
        from_s: interval.from_s + duration_s * f64::from(k),
        duration_s,
    })
}

fn cell(state: State) -> [i64; 4] {
    let place = state.place;
    let turns = (state.heading_rad / TAU).rem_euclid(1.0);
    [
        place.x / SIDE_M,
        place.y / SIDE_M,
        place.z / HEIGHT_M,
        turns * HEADINGS,
    ]
    .map(|cells| cells.floor() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::Region;

    /// A ball of 10 m head-on at a speed, its surface `gap_m` ahead of a vehicle that heads somewhere.
    fn has_way(gap_m: f64, speed_mps: f64, heading_rad: f64) -> bool {
        let (sin, cos) = libm::sincos(heading_rad);
        let ahead = Vector3::new(cos, sin, 0.0);
        let mut mover = Region::ball(Point3::new(0.0, 0.0, 40.0) + ahead * (gap_m + 10.0), 10.0);
        mover.velocity_mps = ahead * -speed_mps;
        let interval = |k: u32| SeaInterval {
            from_s: f64::from(k),
            until_s: f64::from(k + 1),
            place: Point3::new(0.0, 0.0, 40.0),
            regions: vec![mover],
            water: Vector3::zeros(),
            water_differs_mps: 0.0,
            max_speed_mps: 2.0,
        };
        let intervals: Vec<SeaInterval> = (0..40).map(interval).collect();
        let flier = Flier {
            vehicle: Vehicle::default(),
            bounds: None,
            bed: None,
            current: None,
        };
        flier.has_way(&intervals, ahead * 1.5)
    }

    #[test]
    fn a_vehicle_that_turns_in_20_m_needs_time_to_leave() {
        for heading_rad in [0.0, 0.54, 1.0, 2.0, -2.5] {
            // Half a right angle and more of a turn of 20 m leads 10 m aside, after 21 m of way at 2 m/s.
            assert!(has_way(80.0, 5.0, heading_rad) && has_way(50.0, 3.0, heading_rad));
            assert!(!has_way(10.0, 5.0, heading_rad) && !has_way(15.0, 3.0, heading_rad));
            // A vehicle that turns on the spot would leave to the side: 10 m in 5 s.
            assert!(!has_way(25.0, 3.0, heading_rad));
        }
    }
}
