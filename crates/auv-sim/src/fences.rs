//! Areas that the vehicle stays out of, or in.

use crate::limits::{Limit, LimitBroken, note};
use auv_obstacles::{ObstacleId, Region, TimedPoint};
use auv_ocean::{FencedBed, FlatBed, Footprint, MapPoint, SeaBed};
use auv_types::{Bounds, Point3};
use std::sync::Arc;

/// A prism: a polygon on the map between two depths, while a time lasts.
#[derive(Clone, Debug, PartialEq)]
pub struct Fence {
    /// Its name in messages.
    pub name: String,
    /// The polygon.
    pub area: Footprint,
    /// Least and greatest depth, metres.
    pub depth_m: [f64; 2],
    /// From when to when it holds, mission time in seconds.
    pub holds_s: [f64; 2],
}

impl Fence {
    /// A polygon at all depths and times.
    #[must_use]
    pub fn always(name: impl Into<String>, outline: Vec<MapPoint>) -> Self {
        Self {
            name: name.into(),
            area: Footprint::Area { outline },
            depth_m: [f64::NEG_INFINITY, f64::INFINITY],
            holds_s: [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The corners of the polygon; the first is not repeated.
    #[must_use]
    pub fn outline(&self) -> &[MapPoint] {
        match &self.area {
            Footprint::Area { outline } => outline,
            _ => &[],
        }
    }

    /// Whether it holds always and at all depths of a box: plans then see it as a wall of the bed.
    #[must_use]
    pub fn is_wall(&self, bounds: Option<&Bounds>) -> bool {
        let [top_m, bottom_m] = self.depth_m;
        let (low_m, high_m) = bounds.map_or((0.0, f64::INFINITY), |b| (b.low.z, b.high.z));
        self.holds_s == [f64::NEG_INFINITY, f64::INFINITY] && top_m <= low_m && bottom_m >= high_m
    }

    fn holds_at(&self, time_s: f64) -> bool {
        let [from_s, until_s] = self.holds_s;
        from_s <= time_s && time_s <= until_s
    }

    /// How deep a timed place lies inside, metres; negative outside.
    #[must_use]
    pub fn depth_inside_m(&self, at: &TimedPoint) -> f64 {
        if !self.holds_at(at.time_s) {
            return f64::NEG_INFINITY;
        }
        let [top_m, bottom_m] = self.depth_m;
        let aside_m = -self.area.distance_m(at.position.x, at.position.y);
        aside_m
            .min(at.position.z - top_m)
            .min(bottom_m - at.position.z)
    }

    /// Vertical cylinders that cover the prism, and how far they reach beyond its polygon, metres.
    #[must_use]
    pub fn cover(&self) -> (Vec<Region>, f64) {
        let (discs, beyond_m) = discs_over(&self.area, self.outline());
        let region = |&(centre, radius_m): &(MapPoint, f64)| Region {
            from_s: self.holds_s[0],
            until_s: self.holds_s[1],
            ..Region::cylinder(
                Point3::new(centre[0], centre[1], 0.0),
                radius_m,
                self.depth_m[0],
                self.depth_m[1],
            )
        };
        (discs.iter().map(region).collect(), beyond_m)
    }
}

/// A polygon is covered by at most so many discs.
const MOST_DISCS: usize = 48;
/// How far discs may reach beyond a polygon where few are enough, as a share of its extent.
const LEAST_BEYOND: f64 = 0.01;

/// Discs that cover a polygon, and how far the farthest of them reaches beyond it, metres: squares are divided
/// until the circles round them do not reach far beyond, farther where that takes too many.
fn discs_over(area: &Footprint, outline: &[MapPoint]) -> (Vec<(MapPoint, f64)>, f64) {
    let fold = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
        outline.iter().map(|corner| corner[axis]).fold(from, pick)
    };
    let low = [0, 1].map(|axis| fold(axis, f64::min, f64::INFINITY));
    let high = [0, 1].map(|axis| fold(axis, f64::max, f64::NEG_INFINITY));
    let side_m = (high[0] - low[0]).max(high[1] - low[1]);
    let mut allowed_m = LEAST_BEYOND * side_m;
    loop {
        let (mut discs, mut beyond_m) = (Vec::new(), 0.0_f64);
        let whole = [0, 1].map(|axis| 0.5 * (low[axis] + high[axis]));
        let mut open = vec![(whole, 0.5 * side_m)];
        while let Some((centre, half_m)) = open.pop() {
            let radius_m = half_m * std::f64::consts::SQRT_2;
            let distance_m = area.distance_m(centre[0], centre[1]);
            if distance_m > radius_m {
                continue;
            }
            let reaches_m = distance_m + radius_m;
            if reaches_m <= allowed_m || radius_m <= 0.5 * allowed_m {
                beyond_m = beyond_m.max(reaches_m);
                discs.push((centre, radius_m));
            } else {
                let quarter = 0.5 * half_m;
                for (n, e) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                    open.push(([centre[0] + n * quarter, centre[1] + e * quarter], quarter));
                }
            }
        }
        if discs.len() <= MOST_DISCS {
            return (discs, beyond_m);
        }
        allowed_m *= 1.25;
    }
}

/// The areas that the vehicle stays out of, and in.
#[derive(Clone, Debug, Default)]
pub struct Fences {
    /// The vehicle enters none of these.
    pub keep_out: Vec<Fence>,
    /// The vehicle stays in at least one of these that hold; anywhere if none does. Plans stay in them at all times.
    pub keep_in: Vec<Fence>,
    /// The mission's bed without them (`None`: there is none). It counts only where there are fences.
    pub open_bed: Option<Arc<dyn SeaBed>>,
}

/// Fences stand on this where there is no bed, metres.
const DEEP_M: f64 = 12_000.0;
/// The regions of fences have the greatest ids.
const LAST_ID: u32 = u32::MAX;

impl Fences {
    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.keep_out.is_empty() && self.keep_in.is_empty()
    }

    /// The bed with the fences that hold always and at all depths: planners keep off them as off land.
    #[must_use]
    pub fn walled_bed(&self, bounds: Option<&Bounds>) -> Option<Arc<dyn SeaBed>> {
        let bed = self.open_bed.clone();
        let walls = self.keep_out.iter().filter(|fence| fence.is_wall(bounds));
        let out: Vec<Footprint> = walls.map(|fence| fence.area.clone()).collect();
        let within = self.keep_in.iter().map(|fence| fence.area.clone());
        let within: Vec<Footprint> = within.collect();
        if out.is_empty() && within.is_empty() {
            return bed;
        }
        let bed = bed.unwrap_or_else(|| Arc::new(FlatBed::new(DEEP_M)));
        Some(Arc::new(FencedBed::new(bed, out, within)))
    }

    /// The areas that are no walls: they hold for a time or at some depths only.
    pub(crate) fn partial<'a>(
        &'a self,
        bounds: Option<&'a Bounds>,
    ) -> impl Iterator<Item = &'a Fence> {
        let keep_out = self.keep_out.iter();
        keep_out.filter(move |fence| !fence.is_wall(bounds))
    }

    /// The regions that planners stay out of: all that hold for a time or at some depths only.
    #[must_use]
    pub fn regions(&self, bounds: Option<&Bounds>) -> Vec<Region> {
        let regions = self.partial(bounds).flat_map(|fence| fence.cover().0);
        let named = |(k, region)| Region {
            obstacle: ObstacleId(LAST_ID - k),
            ..region
        };
        (0..).zip(regions).map(named).collect()
    }

    /// All times later by some seconds.
    pub(crate) fn begin_later(&mut self, by_s: f64) {
        for fence in self.keep_out.iter_mut().chain(&mut self.keep_in) {
            fence.holds_s = fence.holds_s.map(|at_s| at_s + by_s);
        }
    }

    /// Notes where a track breaks them.
    pub(crate) fn judge(&self, track: &[TimedPoint], broken: &mut Vec<LimitBroken>) {
        for at in track {
            let inside_m = |fence: &Fence| fence.depth_inside_m(at);
            let into_m = self.keep_out.iter().map(inside_m);
            let into_m = into_m.fold(f64::NEG_INFINITY, f64::max);
            note(broken, Limit::KeepOut, at.time_s, into_m);
            let mut holding = self
                .keep_in
                .iter()
                .filter(|f| f.holds_at(at.time_s))
                .peekable();
            if holding.peek().is_some() {
                let within_m = holding.map(inside_m).fold(f64::NEG_INFINITY, f64::max);
                note(broken, Limit::KeepIn, at.time_s, -within_m);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Seed, rand::RngExt};

    /// An L of 600 m.
    fn bent() -> Fence {
        let outline = vec![
            [0.0, 0.0],
            [600.0, 0.0],
            [600.0, 200.0],
            [200.0, 200.0],
            [200.0, 600.0],
            [0.0, 600.0],
        ];
        Fence {
            depth_m: [0.0, 15.0],
            holds_s: [100.0, 900.0],
            ..Fence::always("bent", outline)
        }
    }

    #[test]
    fn discs_cover_the_polygon_and_reach_as_far_beyond_as_told() {
        let fence = bent();
        let (regions, beyond_m) = fence.cover();
        assert!(regions.len() <= MOST_DISCS && beyond_m < 60.0, "{beyond_m}");
        let mut random = Seed(2).stream(0);
        let mut covered = 0;
        for _ in 0..5_000 {
            let mut draw = |low: f64, high: f64| random.random_range(low..high);
            let place = Point3::new(draw(-100.0, 700.0), draw(-100.0, 700.0), draw(-5.0, 25.0));
            let at = TimedPoint::new(place, draw(0.0, 1_000.0));
            let inside_m = fence.depth_inside_m(&at);
            let clear_m = regions.iter().map(|region| region.distance_m(&at));
            let is_covered = clear_m.fold(f64::INFINITY, f64::min) <= 0.0;
            assert!(is_covered || inside_m < 0.0, "{place} {inside_m}");
            let aside_m = fence.area.distance_m(place.x, place.y);
            assert!(!is_covered || aside_m <= beyond_m + 1e-9);
            covered += usize::from(is_covered);
        }
        assert!(covered > 500);
    }

    #[test]
    fn what_holds_always_and_at_all_depths_is_a_wall() {
        let bounds = Bounds::new(Point3::new(-1e3, -1e3, 2.0), Point3::new(1e3, 1e3, 60.0));
        let always = Fence::always("reserve", bent().outline().to_vec());
        let fences = Fences {
            keep_out: vec![always.clone(), bent()],
            ..Fences::default()
        };
        assert!(always.is_wall(Some(&bounds)) && !bent().is_wall(Some(&bounds)));
        let bed = fences.walled_bed(Some(&bounds)).unwrap();
        assert!(bed.depth_at(100.0, 100.0) < 0.0 && bed.depth_at(900.0, 900.0) > 60.0);
        let regions = fences.regions(Some(&bounds));
        assert!(!regions.is_empty() && regions.iter().all(|r| r.until_s == 900.0));
        assert!(Fences::default().walled_bed(None).is_none());
    }

    #[test]
    fn the_track_is_judged_by_the_polygons() {
        let mut fences = Fences {
            keep_out: vec![bent()],
            ..Fences::default()
        };
        let at = |x: f64, z: f64, time_s: f64| TimedPoint::new(Point3::new(x, 100.0, z), time_s);
        let track = [
            at(100.0, 14.0, 200.0),
            at(100.0, 20.0, 300.0),
            at(100.0, 5.0, 950.0),
        ];
        let mut broken = Vec::new();
        fences.judge(&track, &mut broken);
        assert_eq!(broken.len(), 1);
        assert_eq!(
            (broken[0].limit, broken[0].at_s, broken[0].by_m),
            (Limit::KeepOut, 200.0, 1.0)
        );
        fences
            .keep_in
            .push(Fence::always("area", bent().outline().to_vec()));
        broken.clear();
        fences.judge(&[at(610.0, 30.0, 10.0)], &mut broken);
        let [out] = broken[..] else {
            panic!("{broken:?}");
        };
        assert!(out.limit == Limit::KeepIn && (out.by_m - 10.0).abs() < 1e-9);
    }
}
