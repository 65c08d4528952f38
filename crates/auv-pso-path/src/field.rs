//! The regions in double precision, found by where along the leg and when they matter, and the
//! contact of one with a timed segment.

use auv_obstacles::{Region, RegionShape, TimedPoint};
use auv_planning::PathProblem;
use auv_types::{Point3, Vector3, libm};

/// Metres kept beyond the clearance asked for, so that rounding never breaks it.
const MARGIN_M: f64 = 2e-3;

/// The closest approach of a segment to a region.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    /// Share of the segment at which it occurs.
    pub(crate) share: f64,
    /// Unit vector from the region to the segment there.
    pub(crate) normal: Vector3<f64>,
    /// Distance to the surface, negative inside, metres.
    pub(crate) gap_m: f64,
}

/// A region at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Section {
    pub(crate) centre: Point3<f64>,
    pub(crate) radius_m: f64,
    /// Top and bottom of a cylinder; `None` for a ball.
    pub(crate) depths_m: Option<(f64, f64)>,
}

/// All regions of a leg, grown by the clearance.
#[derive(Debug)]
pub(crate) struct Field {
    obstacles: Vec<Region>,
    origin: Point3<f64>,
    axis: Vector3<f64>,
    slab_m: f64,
    slabs: Vec<Slab>,
    listed: Vec<u32>,
    /// First slab of each region.
    first: Vec<u32>,
}

/// The regions that reach a stretch across the leg while the vehicle may be there.
#[derive(Clone, Copy, Debug, Default)]
struct Slab {
    begin: usize,
    end: usize,
    early_s: f64,
    late_s: f64,
}

/// How far from a segment regions are looked for, metres.
pub(crate) const BAND_M: f64 = 30.0;

impl Field {
    /// All regions of a problem, `slack_m` larger; with `round` none is smaller than the vehicle's
    /// turn radius, so that a corner rounded with it stays outside.
    pub(crate) fn new(problem: &PathProblem<'_>, slack_m: f64, round: bool) -> Self {
        let margin_m = problem.clearance_m + MARGIN_M + slack_m;
        let least_m = if round {
            problem.vehicle.turn_radius_m
        } else {
            0.0
        };
        let obstacles: Vec<_> = problem
            .regions
            .iter()
            .map(|region| {
                let grown = region.inflated(margin_m);
                Region {
                    radius_m: grown.radius_m.max(least_m),
                    ..grown
                }
            })
            .collect();
        let line = problem.target - problem.start;
        let length_m = line.norm().max(1e-9);
        let mut field = Self {
            first: vec![0; obstacles.len()],
            obstacles,
            origin: problem.start,
            axis: line / length_m,
            slab_m: (length_m / 64.0).max(20.0),
            slabs: Vec::new(),
            listed: Vec::new(),
        };
        field.sort_into_slabs(problem, length_m);
        field
    }

    /// Lists for every slab the regions that reach it while the vehicle may be there: at the
    /// earliest flying straight, at the latest after a detour of 8 % and 20 s.
    fn sort_into_slabs(&mut self, problem: &PathProblem<'_>, length_m: f64) {
        let speed_mps = problem.vehicle.speed_mps;
        let count = libm::ceil(length_m / self.slab_m) as usize;
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); count];
        self.slabs = (0..count)
            .map(|b| {
                let (near_m, far_m) = (b as f64 * self.slab_m, (b + 1) as f64 * self.slab_m);
                let (early_s, late_s) = if problem.current.is_none() {
                    (near_m / speed_mps, 1.08 * far_m / speed_mps + 20.0)
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
        for (i, obstacle) in self.obstacles.iter().enumerate() {
            let (low, high) = self.slabs_reached(obstacle, problem.departure_s);
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

    /// Range of slabs that a region reaches at a time when the vehicle may be there; the end slabs
    /// hold everything beyond them. A slab more now and then, never one less.
    fn slabs_reached(&self, obstacle: &Region, departure_s: f64) -> (usize, usize) {
        let still = obstacle.velocity_mps == Vector3::zeros() && obstacle.growth_mps == 0.0;
        let axis = self.axis;
        let begin_m = (obstacle.centre_at(departure_s) - self.origin).dot(&axis);
        let advance_mps = obstacle.velocity_mps.dot(&axis);
        let mut band_m = obstacle.radius_at(departure_s) + BAND_M;
        if let Some((top_m, bottom_m)) = depths_m(obstacle)
            && axis.z != 0.0
        {
            let z = obstacle.centre.z;
            band_m += axis.z.abs() * (top_m - z).abs().max((bottom_m - z).abs());
        }
        let reach = |begin_s: f64, end_s: f64| {
            let (begin_s, end_s) = (begin_s - departure_s, end_s - departure_s);
            let (a, b) = (
                begin_m + advance_mps * begin_s,
                begin_m + advance_mps * end_s,
            );
            let grown_m = (obstacle.growth_mps * begin_s).max(obstacle.growth_mps * end_s);
            let radius_m = band_m + grown_m;
            (a.min(b) - radius_m, a.max(b) + radius_m)
        };
        let last = self.slabs.len() - 1;
        let index = |m: f64| (m / self.slab_m).clamp(0.0, last as f64) as usize;
        let (mut low, mut high) = (0, last);
        // Slabs say when, and when says which slabs: closer with every round.
        for _ in 0..4 {
            let begin_s = self.slabs[low]
                .early_s
                .max(obstacle.from_s)
                .max(departure_s);
            let end_s = self.slabs[high].late_s.min(obstacle.until_s);
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
    /// segment. Returns how many it looked at.
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
        let mut look = |i: usize| {
            if let Some(contact) = contact(&self.obstacles[i], from, to) {
                found(i, contact);
            }
        };
        if !on_time {
            (0..self.obstacles.len()).for_each(look);
            return self.obstacles.len() as u64;
        }
        let mut looked = 0;
        for slab in low..=high {
            let Slab { begin, end, .. } = self.slabs[slab];
            looked += (end - begin) as u64;
            for &i in &self.listed[begin..end] {
                if slab == low.max(self.first[i as usize] as usize) {
                    look(i as usize);
                }
            }
        }
        looked
    }

    /// Centre and radius of a region, clearance included, at a time.
    pub(crate) fn at(&self, region: usize, time_s: f64) -> (Point3<f64>, f64) {
        let obstacle = &self.obstacles[region];
        (obstacle.centre_at(time_s), obstacle.radius_at(time_s))
    }

    /// A region at a time, if it exists then.
    pub(crate) fn at_time(&self, region: usize, time_s: f64) -> Option<Section> {
        let obstacle = &self.obstacles[region];
        obstacle.exists_at(time_s).then(|| Section {
            centre: obstacle.centre_at(time_s),
            radius_m: obstacle.radius_at(time_s),
            depths_m: depths_m(obstacle),
        })
    }

    /// Calls `found(region)` for every region that reaches the cross-section of the leg at a place.
    pub(crate) fn regions_near(&self, place: &Point3<f64>, found: impl FnMut(usize)) {
        let along_m = (place - self.origin).dot(&self.axis);
        let last = (self.slabs.len() - 1) as f64;
        let slab = &self.slabs[(along_m / self.slab_m).clamp(0.0, last) as usize];
        let listed = &self.listed[slab.begin..slab.end];
        listed.iter().map(|&i| i as usize).for_each(found);
    }
}

/// Top and bottom of a cylinder; `None` for a ball.
fn depths_m(region: &Region) -> Option<(f64, f64)> {
    match region.shape {
        RegionShape::Ball => None,
        RegionShape::Cylinder { top_m, bottom_m } => Some((top_m, bottom_m)),
    }
}

/// The closest approach of a segment to a region, when it is closer than [`BAND_M`].
fn contact(region: &Region, from: &TimedPoint, to: &TimedPoint) -> Option<Contact> {
    match region.shape {
        RegionShape::Ball => contact_with_ball(region, from, to),
        RegionShape::Cylinder { top_m, bottom_m } => {
            let (a, b) = (from.position.z, to.position.z);
            let over_m = (top_m - a.max(b)).max(a.min(b) - bottom_m);
            // From above a cylinder is a disc: too far from that, too far from all of it.
            let flat = |p: &TimedPoint| {
                TimedPoint::new(Point3::new(p.position.x, p.position.y, 0.0), p.time_s)
            };
            let disc = Region {
                centre: Point3::new(region.centre.x, region.centre.y, 0.0),
                velocity_mps: Vector3::new(region.velocity_mps.x, region.velocity_mps.y, 0.0),
                ..*region
            };
            let near =
                over_m < BAND_M && contact_with_ball(&disc, &flat(from), &flat(to)).is_some();
            if near {
                contact_with_cylinder(region, from, to, (top_m, bottom_m))
            } else {
                None
            }
        }
    }
}

fn contact_with_ball(region: &Region, from: &TimedPoint, to: &TimedPoint) -> Option<Contact> {
    let duration_s = to.time_s - from.time_s;
    let offset = from.position - region.centre_at(from.time_s);
    let travel = (to.position - from.position) - region.velocity_mps * duration_s;
    let radius_m = region.radius_at(from.time_s);
    let growth_m = region.growth_mps * duration_s;
    let (mut low, mut high) = (0.0, 1.0);
    if region.from_s > from.time_s || region.until_s < to.time_s {
        if region.from_s > to.time_s || region.until_s < from.time_s || duration_s <= 0.0 {
            return None;
        }
        low = ((region.from_s - from.time_s) / duration_s).max(0.0);
        high = ((region.until_s - from.time_s) / duration_s).min(1.0);
    }
    let a = travel.norm_squared();
    let b = offset.dot(&travel);
    let c = offset.norm_squared();
    let most_m = radius_m.max(radius_m + growth_m) + BAND_M;
    // The closest point of the endless line too far, or the near end where it recedes, or the far
    // end where it comes closer.
    let most = most_m * most_m;
    let too_far =
        c * a - b * b > most * a || (b >= 0.0 && c > most) || (b <= -a && c + 2.0 * b + a > most);
    if most_m < 0.0 || too_far {
        return None;
    }
    let across = c - if a > 0.0 { b * b / a } else { 0.0 };
    let lag = if a > growth_m * growth_m {
        growth_m * libm::sqrt((a * across).max(0.0) / (a - growth_m * growth_m))
    } else {
        0.0
    };
    let share = if a > 0.0 {
        ((lag - b) / a).clamp(low, high)
    } else {
        low
    };
    let delta = offset + travel * share;
    let distance_m = delta.norm();
    let gap_m = distance_m - radius_m - growth_m * share;
    (gap_m < BAND_M).then(|| Contact {
        share,
        normal: if distance_m > 1e-6 {
            delta / distance_m
        } else {
            sideways(&travel)
        },
        gap_m,
    })
}

fn contact_with_cylinder(
    region: &Region,
    from: &TimedPoint,
    to: &TimedPoint,
    (top_m, bottom_m): (f64, f64),
) -> Option<Contact> {
    let closest = region.clearance(from, to);
    let gap_m = closest.clearance_m;
    if gap_m >= BAND_M {
        return None;
    }
    let duration_s = to.time_s - from.time_s;
    let share = if duration_s > 0.0 {
        ((closest.time_s - from.time_s) / duration_s).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let place = from.position + (to.position - from.position) * share;
    let delta = place - region.centre_at(closest.time_s);
    let across_m = delta.xy().norm();
    let radial_m = across_m - region.radius_at(closest.time_s);
    let vertical_m = (top_m - place.z).max(place.z - bottom_m);
    let outward = if across_m > 1e-6 {
        Vector3::new(delta.x / across_m, delta.y / across_m, 0.0)
    } else {
        sideways(&((to.position - from.position) - region.velocity_mps * duration_s))
    };
    let down = if place.z - bottom_m > top_m - place.z {
        1.0
    } else {
        -1.0
    };
    let normal = if radial_m > 0.0 && vertical_m > 0.0 {
        (outward * radial_m + Vector3::z() * (down * vertical_m)).normalize()
    } else if radial_m >= vertical_m {
        outward
    } else {
        Vector3::z() * down
    };
    Some(Contact {
        share,
        normal,
        gap_m,
    })
}

/// A horizontal unit vector across a direction: where a segment meets a centre, any side will do.
pub(crate) fn sideways(direction: &Vector3<f64>) -> Vector3<f64> {
    let across = Vector3::new(-direction.y, direction.x, 0.0);
    let length = across.norm();
    if length > 1e-9 {
        across / length
    } else {
        Vector3::x()
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
            let field = Field::new(&problem, 0.0, false);
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
                field.contacts(&from, &to, |i, _| listed.push(i));
                listed.sort_unstable();
                let all = (0..regions.len())
                    .filter(|&i| contact(&field.obstacles[i], &from, &to).is_some());
                assert_eq!(listed, all.collect::<Vec<_>>());
                found += listed.len();
            }
        }
        assert!(found > 1_000);
    }

    #[test]
    fn a_contact_is_the_closest_of_dense_samples() {
        let mut random = Seed(9).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let (mut inside, mut outside) = (0, 0);
        for round in 0..400 {
            let centre = Point3::new(draw(-40.0, 40.0), draw(-40.0, 40.0), draw(-20.0, 20.0));
            let mut region = if round % 2 == 0 {
                Region::ball(centre, draw(5.0, 40.0))
            } else {
                Region::cylinder(centre, draw(5.0, 40.0), draw(-30.0, 0.0), draw(1.0, 30.0))
            };
            region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
            region.growth_mps = draw(-0.2, 0.2);
            let mut end = |time_s: f64| {
                let place = Point3::new(draw(-60.0, 60.0), draw(-60.0, 60.0), draw(-30.0, 30.0));
                TimedPoint::new(place, time_s)
            };
            let (from, to) = (end(0.0), end(40.0));
            let at = |share: f64| {
                let place = from.position + (to.position - from.position) * share;
                TimedPoint::new(place, 40.0 * share)
            };
            let samples = (0..=4_000).map(|k| region.distance_m(&at(f64::from(k) / 4_000.0)));
            let least_m = samples.fold(f64::INFINITY, f64::min);
            let Some(found) = contact(&region, &from, &to) else {
                assert!(least_m > BAND_M - 1e-6, "round {round}: {least_m}");
                continue;
            };
            let there = at(found.share);
            assert!((found.gap_m - least_m).abs() < 0.05, "round {round}");
            assert!((found.gap_m - region.distance_m(&there)).abs() < 1e-6);
            assert!((found.normal.norm() - 1.0).abs() < 1e-9);
            // A step along the normal opens the gap by as much.
            let moved = TimedPoint::new(there.position + found.normal * 1e-4, there.time_s);
            let opened_m = region.distance_m(&moved) - region.distance_m(&there);
            assert!((opened_m - 1e-4).abs() < 1e-6, "round {round}: {opened_m}");
            inside += usize::from(found.gap_m < 0.0);
            outside += usize::from(found.gap_m > 0.0);
        }
        assert!(inside > 40 && outside > 40, "{inside} {outside}");
    }

    #[test]
    fn a_region_that_is_gone_is_not_touched() {
        let mut region = Region::ball(Point3::new(50.0, 0.0, 0.0), 20.0);
        let (from, to) = (
            TimedPoint::new(Point3::origin(), 0.0),
            TimedPoint::new(Point3::new(100.0, 0.0, 0.0), 100.0),
        );
        assert!(contact(&region, &from, &to).is_some_and(|c| c.gap_m < -19.0));
        region.until_s = 20.0;
        let found = contact(&region, &from, &to).unwrap();
        assert!((found.share - 0.2).abs() < 1e-12 && (found.gap_m - 10.0).abs() < 1e-9);
        (region.from_s, region.until_s) = (101.0, 200.0);
        assert!(contact(&region, &from, &to).is_none());
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
        let radii_m = |field: &Field| [0, 1].map(|i| field.at(i, 0.0).1);
        assert_eq!(radii_m(&Field::new(&problem, 0.0, false)), [5.002, 43.002]);
        assert_eq!(radii_m(&Field::new(&problem, 0.5, true)), [20.0, 43.502]);
    }
}
