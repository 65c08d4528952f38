//! The regions of a leg, grown by the clearance and listed by where and when they matter.

use crate::taut::contact::{BAND_M, Contact, contact};
use auv_obstacles::{Region, RegionShape, TimedPoint};
use auv_planning::PathProblem;
use auv_types::{Point3, Vector3, libm};

/// Metres kept beyond the clearance asked for, so that rounding never breaks it.
const MARGIN_M: f64 = 2e-3;
/// A line shorter than this has no direction, metres.
const LEAST_LENGTH_M: f64 = 1e-9;
/// Most slabs, and the thinnest, metres: a segment of a string seldom reaches over more than a few.
const MOST_SLABS: f64 = 64.0;
const LEAST_SLAB_M: f64 = 20.0;
/// The latest that a slab is reached: after a detour of 8 % and 20 s. Later segments are compared
/// with every region.
const DETOUR: f64 = 1.08;
const DELAY_S: f64 = 20.0;
/// Rounds in which a moving region's slabs and times narrow each other down.
const NARROWING_ROUNDS: usize = 4;

/// A region at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RegionAt {
    pub(crate) centre: Point3<f64>,
    pub(crate) radius_m: f64,
    /// Top and bottom of a cylinder; `None` for a ball.
    pub(crate) depths_m: Option<(f64, f64)>,
}

/// All regions of a leg, grown by the clearance.
///
/// The leg is cut across its straight line into slabs. Each lists the regions that reach it while the
/// vehicle may be there, so that a segment is compared with few of them.
#[derive(Debug)]
pub(crate) struct GrownRegions {
    grown: Vec<Region>,
    /// The straight line, and the thickness of a slab along it.
    origin: Point3<f64>,
    axis: Vector3<f64>,
    slab_m: f64,
    slabs: Vec<Slab>,
    /// Indices of the regions of all slabs, slab by slab.
    listed: Vec<u32>,
    /// First slab of each region.
    first: Vec<u32>,
}

/// The regions that reach a stretch across the leg while the vehicle may be there.
#[derive(Clone, Copy, Debug, Default)]
struct Slab {
    /// Range in the list of all slabs.
    begin: usize,
    end: usize,
    /// When the vehicle may be there, seconds.
    early_s: f64,
    late_s: f64,
}

impl GrownRegions {
    /// All regions of a problem, `slack_m` larger than the clearance asks. With `round` none is smaller
    /// than the vehicle's turn radius, so that a corner rounded with it stays outside.
    pub(crate) fn new(problem: &PathProblem<'_>, slack_m: f64, round: bool) -> Self {
        let margin_m = problem.clearance_m + MARGIN_M + slack_m;
        let least_m = if round {
            problem.vehicle.turn_radius_m
        } else {
            0.0
        };
        let grown: Vec<_> = problem
            .regions
            .iter()
            .map(|region| {
                let region = flattened(region.inflated(margin_m));
                Region {
                    radius_m: region.radius_m.max(least_m),
                    ..region
                }
            })
            .collect();
        let line = problem.target - problem.start;
        let length_m = line.norm().max(LEAST_LENGTH_M);
        let mut regions = Self {
            first: vec![0; grown.len()],
            grown,
            origin: problem.start,
            axis: line / length_m,
            slab_m: (length_m / MOST_SLABS).max(LEAST_SLAB_M),
            slabs: Vec::new(),
            listed: Vec::new(),
        };
        regions.sort_into_slabs(problem, length_m);
        regions
    }

    /// Lists for every slab the regions that reach it while the vehicle may be there: at the
    /// earliest when it flies straight, at the latest after a detour.
    fn sort_into_slabs(&mut self, problem: &PathProblem<'_>, length_m: f64) {
        let speed_mps = problem.vehicle.speed_mps;
        let count = libm::ceil(length_m / self.slab_m) as usize;
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); count];
        self.slabs = (0..count)
            .map(|b| {
                let (near_m, far_m) = (b as f64 * self.slab_m, (b + 1) as f64 * self.slab_m);
                let (early_s, late_s) = if problem.current.is_none() {
                    (near_m / speed_mps, DETOUR * far_m / speed_mps + DELAY_S)
                } else {
                    (0.0, f64::INFINITY)
                };
                Slab {
                    early_s: problem.departure_s + early_s,
                    late_s: problem.departure_s + late_s,
                    ..Slab::default()
                }
            })
            .collect();
        for (i, region) in self.grown.iter().enumerate() {
            let (low, high) = self.slabs_reached(region, problem.departure_s);
            self.first[i] = low as u32;
            for list in &mut members[low..high] {
                list.push(i as u32);
            }
        }
        for (slab, list) in self.slabs.iter_mut().zip(&members) {
            slab.begin = self.listed.len();
            self.listed.extend(list);
            slab.end = self.listed.len();
        }
    }

    /// Range of slabs that a region reaches at a time when the vehicle may be there, sometimes one
    /// more. The end slabs hold everything beyond them.
    fn slabs_reached(&self, region: &Region, departure_s: f64) -> (usize, usize) {
        let still = region.velocity_mps == Vector3::zeros() && region.growth_mps == 0.0;
        let axis = self.axis;
        let begin_m = (region.centre_at(departure_s) - self.origin).dot(&axis);
        let advance_mps = region.velocity_mps.dot(&axis);
        let mut band_m = region.radius_at(departure_s) + BAND_M;
        if let Some((top_m, bottom_m)) = depths_m(region)
            && axis.z != 0.0
        {
            let z = region.centre.z;
            band_m += axis.z.abs() * (top_m - z).abs().max((bottom_m - z).abs());
        }
        let reach = |begin_s: f64, end_s: f64| {
            let (begin_s, end_s) = (begin_s - departure_s, end_s - departure_s);
            let (a, b) = (
                begin_m + advance_mps * begin_s,
                begin_m + advance_mps * end_s,
            );
            let grown_m = (region.growth_mps * begin_s).max(region.growth_mps * end_s);
            let radius_m = band_m + grown_m;
            (a.min(b) - radius_m, a.max(b) + radius_m)
        };
        let last = self.slabs.len() - 1;
        let index = |m: f64| (m / self.slab_m).clamp(0.0, last as f64) as usize;
        let (mut low, mut high) = (0, last);
        // The slabs bound the times and the times bound the slabs.
        for _ in 0..NARROWING_ROUNDS {
            let begin_s = self.slabs[low].early_s.max(region.from_s).max(departure_s);
            let end_s = self.slabs[high].late_s.min(region.until_s);
            if begin_s > end_s {
                return (0, 0);
            }
            if !still && end_s == f64::INFINITY {
                break;
            }
            let before = (low, high);
            let (low_m, high_m) = reach(begin_s, if still { begin_s } else { end_s });
            (low, high) = (low.max(index(low_m)), high.min(index(high_m)));
            if low > high {
                return (0, 0);
            }
            if still || (low, high) == before {
                break;
            }
        }
        (low, high + 1)
    }

    /// Calls `found(region, contact)` for every region whose surface comes within [`BAND_M`] of the
    /// segment. Returns the number of regions compared.
    pub(crate) fn contacts(
        &self,
        from: &TimedPoint,
        to: &TimedPoint,
        mut found: impl FnMut(usize, Contact),
    ) -> u64 {
        let last = self.slabs.len() - 1;
        let slab_of = |p: &TimedPoint| {
            let along_m = (p.position - self.origin).dot(&self.axis);
            (along_m / self.slab_m).clamp(0.0, last as f64) as usize
        };
        let (a, b) = (slab_of(from), slab_of(to));
        let (low, high) = (a.min(b), a.max(b));
        let on_time =
            from.time_s >= self.slabs[low].early_s && to.time_s <= self.slabs[high].late_s;
        let mut compare = |i: usize| {
            if let Some(contact) = contact(&self.grown[i], from, to) {
                found(i, contact);
            }
        };
        if !on_time {
            (0..self.grown.len()).for_each(compare);
            return self.grown.len() as u64;
        }
        let mut compared = 0;
        for slab in low..=high {
            let Slab { begin, end, .. } = self.slabs[slab];
            compared += (end - begin) as u64;
            for &i in &self.listed[begin..end] {
                if slab == low.max(self.first[i as usize] as usize) {
                    compare(i as usize);
                }
            }
        }
        compared
    }

    /// Centre and radius of a region, clearance included, at a time.
    pub(crate) fn at(&self, region: usize, time_s: f64) -> (Point3<f64>, f64) {
        let region = &self.grown[region];
        (region.centre_at(time_s), region.radius_at(time_s))
    }

    /// A region at a time, if it exists then.
    pub(crate) fn existing_at(&self, region: usize, time_s: f64) -> Option<RegionAt> {
        let region = &self.grown[region];
        region.exists_at(time_s).then(|| RegionAt {
            centre: region.centre_at(time_s),
            radius_m: region.radius_at(time_s),
            depths_m: depths_m(region),
        })
    }

    /// Calls `found(region)` for every region that reaches the slab of a place.
    pub(crate) fn regions_near(&self, place: &Point3<f64>, found: impl FnMut(usize)) {
        let along_m = (place - self.origin).dot(&self.axis);
        let last = (self.slabs.len() - 1) as f64;
        let slab = &self.slabs[(along_m / self.slab_m).clamp(0.0, last) as usize];
        let listed = &self.listed[slab.begin..slab.end];
        listed.iter().map(|&i| i as usize).for_each(found);
    }
}

/// The region, or without height where it became smaller than nothing.
fn flattened(mut region: Region) -> Region {
    if let RegionShape::Cylinder { top_m, bottom_m } = &mut region.shape
        && *top_m > *bottom_m
    {
        *top_m = 0.5 * (*top_m + *bottom_m);
        *bottom_m = *top_m;
    }
    region
}

/// Top and bottom of a cylinder; `None` for a ball.
fn depths_m(region: &Region) -> Option<(f64, f64)> {
    match region.shape {
        RegionShape::Ball => None,
        RegionShape::Cylinder { top_m, bottom_m } => Some((top_m, bottom_m)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Vehicle;
    use auv_types::{Seed, rand::RngExt};

    #[test]
    fn slabs_never_hide_a_contact() {
        let mut random = Seed(7).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let vehicle = Vehicle::paper();
        let mut found = 0;
        for _ in 0..20 {
            let regions: Vec<_> = (0..60)
                .map(|i| {
                    let centre =
                        Point3::new(draw(-200.0, 3200.0), draw(-400.0, 400.0), draw(0.0, 200.0));
                    let mut region = if i % 4 == 0 {
                        Region::cylinder(centre, draw(5.0, 90.0), 0.0, draw(10.0, 150.0))
                    } else {
                        Region::ball(centre, draw(5.0, 90.0))
                    };
                    if i % 3 > 0 {
                        region.velocity_mps = Vector3::new(draw(-2.0, 2.0), draw(-1.0, 1.0), 0.0);
                        region.growth_mps = draw(-0.1, 0.1);
                    }
                    if i % 5 == 0 {
                        region.from_s = draw(0.0, 900.0);
                        region.until_s = region.from_s + draw(10.0, 500.0);
                    }
                    region
                })
                .collect();
            let target = Point3::new(3000.0, draw(-500.0, 500.0), draw(10.0, 300.0));
            let problem = PathProblem {
                regions: &regions,
                departure_s: draw(0.0, 100.0),
                ..PathProblem::new(Point3::origin(), target, &vehicle)
            };
            let grown = GrownRegions::new(&problem, 0.0, false);
            for _ in 0..200 {
                // A stretch of the leg, off the line, early or late within the detour allowed.
                let at = |share: f64, aside_m: f64, late: f64| {
                    let line = problem.target - problem.start;
                    let flown_s = share * line.norm() / vehicle.speed_mps * late;
                    let aside = Vector3::new(0.0, aside_m, 0.3 * aside_m);
                    let place = problem.start + line * share + aside;
                    TimedPoint::new(place, problem.departure_s + flown_s)
                };
                let (share, late) = (draw(0.0, 0.9), draw(1.0, 1.08));
                let from = at(share, draw(-100.0, 100.0), late);
                let to = at(share + draw(0.005, 0.1), draw(-100.0, 100.0), late);
                let mut listed = Vec::new();
                grown.contacts(&from, &to, |i, _| listed.push(i));
                listed.sort_unstable();
                let all =
                    (0..regions.len()).filter(|&i| contact(&grown.grown[i], &from, &to).is_some());
                assert_eq!(listed, all.collect::<Vec<_>>());
                found += listed.len();
            }
        }
        assert!(found > 1_000);
    }

    #[test]
    fn slack_and_turn_radius_enlarge_the_regions() {
        let vehicle = Vehicle::default();
        let regions = [
            Region::ball(Point3::new(50.0, 0.0, 0.0), 2.0),
            Region::ball(Point3::new(50.0, 0.0, 0.0), 40.0),
        ];
        let problem = PathProblem {
            regions: &regions,
            clearance_m: 3.0,
            ..PathProblem::new(Point3::origin(), Point3::new(100.0, 0.0, 0.0), &vehicle)
        };
        let radii_m = |grown: &GrownRegions| [0, 1].map(|i| grown.at(i, 0.0).1);
        assert_eq!(
            radii_m(&GrownRegions::new(&problem, 0.0, false)),
            [5.002, 43.002]
        );
        assert_eq!(
            radii_m(&GrownRegions::new(&problem, 0.5, true)),
            [20.0, 43.502]
        );
    }
}
