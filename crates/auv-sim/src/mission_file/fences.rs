//! The areas of a mission file that the vehicle stays out of, and in.

use super::document::{FenceEntry, MissionFile};
use super::misplaced::Misplaced;
use super::place::Place;
use super::places;
use crate::{Fence, Fences};
use auv_obstacles::{Region, TimedPoint};
use auv_ocean::{FencedBed, FlatBed, Footprint, LocalFrame, MapPoint};
use auv_planning::motion::Floor;
use auv_types::{Bounds, Point3, Violations};

impl MissionFile {
    /// The fences of the file in local metres.
    pub(super) fn fences(
        &self,
        frame: Option<&LocalFrame>,
        bounds: Option<&Bounds>,
        violations: &mut Violations,
    ) -> Fences {
        let mut read = |entries: &[FenceEntry], list: &str| -> Vec<Fence> {
            let named = entries.iter().enumerate();
            let fences = named.map(|(i, entry)| {
                let place = entry.name.as_ref().map_or_else(
                    || format!("{list}[{i}]"),
                    |name| format!("{list}[{i}] ({name})"),
                );
                fence(entry, &place, frame, violations)
            });
            fences.collect()
        };
        let fences = Fences {
            keep_out: read(&self.keep_out, "keep_out"),
            keep_in: read(&self.keep_in, "keep_in"),
            open_bed: None,
        };
        let needs_box = !fences.is_empty() && bounds.is_none() && self.extent.is_none();
        violations.require(!needs_box, "box", || {
            "is missing; give one: a mission with keep_out or keep_in needs it".into()
        });
        fences
    }

    /// The box between the depths of the areas to stay in. All of them hold at the same depths and times: else plans
    /// that stay in one of them might not be where one holds.
    pub(super) fn within_keep_in(
        &self,
        bounds: Option<Bounds>,
        violations: &mut Violations,
    ) -> Option<Bounds> {
        let Some(first) = self.keep_in.first() else {
            return bounds;
        };
        for (i, other) in self.keep_in.iter().enumerate() {
            let is_alike = (other.depth_m, other.from, other.until)
                == (first.depth_m, first.from, first.until);
            violations.require(is_alike, &format!("keep_in[{i}]"), || {
                "has other depths or times than keep_in[0]; give all the same, and limit one of them with keep_out".into()
            });
        }
        let mut bounds = bounds?;
        if let Some([top_m, bottom_m]) = first.depth_m {
            bounds.low.z = bounds.low.z.max(top_m);
            bounds.high.z = bounds.high.z.min(bottom_m);
            violations.require(bounds.low.z < bounds.high.z, "keep_in[0].depth_m", || {
                format!(
                    "leaves no depth of the box; give depths within [box] depth_m, [{}, {}]",
                    bounds.low.z, bounds.high.z
                )
            });
        }
        Some(bounds)
    }

    /// What is told of areas that plans keep farther from than asked.
    pub(super) fn told_of_cover(fences: &Fences, bounds: Option<&Bounds>) -> Vec<String> {
        let told = fences.partial(bounds).map(|fence| {
            let (regions, beyond_m) = fence.cover();
            format!(
                "{}: {} cylinders cover it, and plans keep up to {beyond_m:.0} m farther from it than its polygon asks",
                fence.name,
                regions.len()
            )
        });
        told.collect()
    }

    /// Checks that the fences leave room for every waypoint: plans keep a margin from what covers them. `bed` has
    /// the fences, `open` has not.
    pub(super) fn check_fenced_waypoints(
        &self,
        points: &[Point3<f64>],
        fences: &Fences,
        (open, bed): (Option<Floor<'_>>, Option<Floor<'_>>),
        (bounds, margin_m): (Option<&Bounds>, f64),
        violations: &mut Violations,
    ) {
        let regions = fences.regions(bounds);
        let mut wrong = Vec::new();
        for (waypoint, point) in points.iter().enumerate() {
            let deepest_m = |floor: Option<Floor<'_>>| {
                floor.map_or(f64::INFINITY, |floor| floor.deepest_at(point.x, point.y))
            };
            let walled = deepest_m(bed) < point.z && deepest_m(open) >= point.z;
            let mut always = regions.iter().filter(|region| region.is_permanent());
            let at_launch_m = |region: &Region| region.distance_m(&TimedPoint::new(*point, 0.0));
            let near = |region: &Region| at_launch_m(region) <= margin_m;
            // A keep-out with an end hinders the start only where it holds at the launch.
            let is_start = self
                .waypoints
                .get(waypoint)
                .is_some_and(|w| w.name == self.start);
            let shut_in = is_start && regions.iter().any(|region| at_launch_m(region) <= 0.0);
            let found = |rank: u32, by_m: f64, what: String| Misplaced {
                waypoint,
                rank,
                by_m,
                what,
                remedy: "move one of them",
                of_survey: "move the survey, or it",
            };
            if walled {
                let missing_m = (point.z - deepest_m(bed)) * FencedBed::<FlatBed>::ROOM_M;
                let what = format!(
                    "lies {missing_m:.0} m too near to the edge of a keep_out or keep_in, or on the wrong side of it"
                );
                wrong.push(found(0, missing_m, what));
            } else if always.any(near) || shut_in {
                let what = "lies in a keep_out, or so near that the discs which cover it reach over the waypoint";
                wrong.push(found(1, 0.0, what.into()));
            }
        }
        self.tell(wrong, violations);
    }
}

/// One fence of the file.
fn fence(
    entry: &FenceEntry,
    place: &str,
    frame: Option<&LocalFrame>,
    violations: &mut Violations,
) -> Fence {
    let key = |name: &str| format!("{place}.{name}");
    let outline = flat(&entry.polygon, frame, &key("polygon"), violations);
    let mut fence = Fence::always(place, outline);
    check_polygon(&fence.area, &key("polygon"), violations);
    if let Some([top_m, bottom_m]) = entry.depth_m {
        violations.require(top_m < bottom_m, &key("depth_m"), || {
            format!("is [{top_m}, {bottom_m}]; give [least, greatest], metres below the surface")
        });
        violations.require(bottom_m > 0.0, &key("depth_m"), || {
            format!(
                "is [{top_m}, {bottom_m}], above the surface; give depths below it, positive down"
            )
        });
        // What begins at the surface holds above it too.
        let top_m = if top_m <= 0.0 {
            f64::NEG_INFINITY
        } else {
            top_m
        };
        fence.depth_m = [top_m, bottom_m];
    }
    let [from_s, until_s] = [
        entry.from.unwrap_or(f64::NEG_INFINITY),
        entry.until.unwrap_or(f64::INFINITY),
    ];
    fence.holds_s = [from_s, until_s];
    violations.require(from_s < until_s, &key("until"), || {
        let early_s = from_s - until_s;
        format!("is {early_s} s before from; give a later time")
    });
    fence
}

/// The corners of a polygon in local metres; a closed ring repeats its first corner.
pub(super) fn flat(
    polygon: &[Place],
    frame: Option<&LocalFrame>,
    place: &str,
    violations: &mut Violations,
) -> Vec<MapPoint> {
    let corners = polygon.iter().map(|at| {
        let corner = places::point(at, frame, place, violations);
        [corner.x, corner.y]
    });
    let mut outline: Vec<MapPoint> = corners.collect();
    if outline.len() > 3 && outline.first() == outline.last() {
        outline.pop();
    }
    outline
}

/// Checks a polygon.
pub(super) fn check_polygon(area: &Footprint, place: &str, violations: &mut Violations) {
    let mut wrong = Violations::new();
    area.validate_into("", &mut wrong);
    violations.absorb("", wrong.renamed(|_| place.to_owned()));
}
