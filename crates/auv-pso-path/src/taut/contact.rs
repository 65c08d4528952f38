//! The closest approach of a timed segment to a region.

use auv_obstacles::{Region, RegionShape, TimedPoint};
use auv_types::{Point3, Vector3, libm};

/// How far from a segment regions are looked for, metres. A string whose vertices move less than
/// this in a round stays on its side of a region.
pub(crate) const BAND_M: f64 = 30.0;
/// A point closer to a centre or an axis than this lies on it, metres.
const ON_CENTRE_M: f64 = 1e-6;
/// A direction whose horizontal part is shorter than this is vertical, metres.
const VERTICAL_M: f64 = 1e-9;

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

/// The closest approach of a segment to a region, if it is closer than [`BAND_M`].
pub(crate) fn contact(region: &Region, from: &TimedPoint, to: &TimedPoint) -> Option<Contact> {
    match region.shape {
        RegionShape::Ball => contact_with_ball(region, from, to),
        RegionShape::Cylinder { top_m, bottom_m } => {
            let (a, b) = (from.position.z, to.position.z);
            let over_m = (top_m - a.max(b)).max(a.min(b) - bottom_m);
            // A segment too far from the disc seen from above is too far from the cylinder.
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
    // Too far is the whole line, or the start of a segment that recedes, or the end of one that
    // approaches.
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
        normal: if distance_m > ON_CENTRE_M {
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
    let outward = if across_m > ON_CENTRE_M {
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

/// A horizontal unit vector across a direction. It decides the side where a segment points exactly at
/// a centre.
pub(crate) fn sideways(direction: &Vector3<f64>) -> Vector3<f64> {
    let across = Vector3::new(-direction.y, direction.x, 0.0);
    let length = across.norm();
    if length > VERTICAL_M {
        across / length
    } else {
        Vector3::x()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Seed, rand::RngExt};

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
}
