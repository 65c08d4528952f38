//! Ships that sail along recorded fixes.

use crate::{ObstacleId, Region, RegionShape};
use auv_types::{Point3, Vector3, Violations, libm};

/// A recorded position of a ship.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ShipFix {
    /// Mission time, seconds.
    pub time_s: f64,
    /// Metres north.
    pub north_m: f64,
    /// Metres east.
    pub east_m: f64,
}

/// What a ship does after its last fix.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum AfterLastFix {
    /// Sails its track back and forth, without jumps.
    Repeat,
    /// Keeps the course and speed between the last two fixes.
    #[default]
    HoldCourse,
    /// Disappears.
    Leave,
}

/// A ship: a vertical cylinder from above the surface down to its draught, with half the ship's length
/// as radius. Its position is interpolated linearly between fixes. Before the first fix it sails on the
/// course between the first two; a ship with a single fix stays there
/// ([`TrackedShip::with_ends`] gives other velocities).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrackedShip {
    fixes: Vec<ShipFix>,
    radius_m: f64,
    draught_m: f64,
    after_last_fix: AfterLastFix,
    /// Velocities before the first and after the last fix, north and east, m/s.
    #[cfg_attr(feature = "serde", serde(default))]
    ends_mps: [Option<[f64; 2]>; 2],
}

/// A straight leg between two fixes: start time, start place, velocity, end time.
struct ShipLeg {
    at_s: f64,
    place: (f64, f64),
    velocity: (f64, f64),
    until_s: f64,
}

impl TrackedShip {
    /// A ship of a length and draught in metres, with fixes in order of time.
    ///
    /// # Errors
    /// No fixes, fixes out of order or not finite, a length or draught that is not above 0.
    pub fn new(
        fixes: Vec<ShipFix>,
        length_m: f64,
        draught_m: f64,
        after_last_fix: AfterLastFix,
    ) -> Result<Self, Violations> {
        let mut violations = Violations::new();
        violations.require(!fixes.is_empty(), "fixes", || {
            "is empty; give at least one".into()
        });
        violations.require_positive(length_m, "length_m");
        violations.require_positive(draught_m, "draught_m");
        for (i, fix) in fixes.iter().enumerate() {
            let place = format!("fixes[{i}]");
            let finite = [fix.time_s, fix.north_m, fix.east_m]
                .iter()
                .all(|x| x.is_finite());
            violations.require(finite, &place, || {
                "is not finite; give seconds and metres".into()
            });
            violations.require(i == 0 || fix.time_s > fixes[i - 1].time_s, &place, || {
                format!(
                    "at {} s is not after the fix before it; sort them",
                    fix.time_s
                )
            });
        }
        violations.into_result()?;
        Ok(Self {
            fixes,
            radius_m: 0.5 * length_m,
            draught_m,
            after_last_fix,
            ends_mps: [None; 2],
        })
    }

    /// The same ship with other velocities before its first and after its last fix (metres north and east
    /// per second) than those between its two fixes there. They hold where the ship holds its course or
    /// leaves, not where it repeats its track.
    #[must_use]
    pub fn with_ends(mut self, ends_mps: [Option<[f64; 2]>; 2]) -> Self {
        self.ends_mps = ends_mps;
        self
    }

    /// The same ship, everywhere so many seconds later (earlier if negative).
    #[must_use]
    pub fn delayed(mut self, by_s: f64) -> Self {
        for fix in &mut self.fixes {
            fix.time_s += by_s;
        }
        self
    }

    /// The recorded fixes.
    #[must_use]
    pub fn fixes(&self) -> &[ShipFix] {
        &self.fixes
    }

    /// Draught in metres.
    #[must_use]
    pub fn draught_m(&self) -> f64 {
        self.draught_m
    }

    /// The ship at an instant, with its velocity, until it changes course; `None` when it has left.
    #[must_use]
    pub fn region_at(&self, id: ObstacleId, time_s: f64) -> Option<Region> {
        let leg = self.leg(time_s)?;
        Some(self.region(id, &leg, time_s, leg.until_s))
    }

    /// Adds what the ship covers from one time to another: one region for each straight leg.
    pub fn regions_into(
        &self,
        id: ObstacleId,
        from_s: f64,
        until_s: f64,
        regions: &mut Vec<Region>,
    ) {
        let mut time_s = from_s;
        while let Some(leg) = self.leg(time_s) {
            let end_s = leg.until_s.min(until_s);
            regions.push(self.region(id, &leg, time_s, end_s));
            if end_s >= until_s {
                break;
            }
            time_s = end_s.max(time_s + 1e-6);
        }
    }

    fn region(&self, id: ObstacleId, leg: &ShipLeg, time_s: f64, until_s: f64) -> Region {
        let elapsed_s = time_s - leg.at_s;
        let (north, east) = leg.velocity;
        Region {
            obstacle: id,
            shape: RegionShape::Cylinder {
                top_m: f64::NEG_INFINITY,
                bottom_m: self.draught_m,
            },
            at_s: time_s,
            from_s: time_s,
            until_s: until_s.max(time_s),
            centre: Point3::new(
                leg.place.0 + north * elapsed_s,
                leg.place.1 + east * elapsed_s,
                0.0,
            ),
            velocity_mps: Vector3::new(north, east, 0.0),
            radius_m: self.radius_m,
            growth_mps: 0.0,
        }
    }

    /// The straight leg sailed at `time_s`; `None` once the ship has left.
    fn leg(&self, time_s: f64) -> Option<ShipLeg> {
        let (first, last) = (self.fixes.first()?, self.fixes.last()?);
        if let Some(leg) = self.beyond(time_s, first, last) {
            return Some(leg);
        }
        if self.fixes.len() == 1 {
            let gone = self.after_last_fix == AfterLastFix::Leave && time_s >= first.time_s;
            return (!gone).then_some(ShipLeg {
                at_s: first.time_s,
                place: (first.north_m, first.east_m),
                velocity: (0.0, 0.0),
                until_s: match self.after_last_fix {
                    AfterLastFix::Leave => first.time_s,
                    AfterLastFix::Repeat | AfterLastFix::HoldCourse => f64::INFINITY,
                },
            });
        }
        if time_s < last.time_s || self.after_last_fix == AfterLastFix::HoldCourse {
            return Some(self.recorded(time_s));
        }
        match self.after_last_fix {
            AfterLastFix::Leave => None,
            AfterLastFix::Repeat | AfterLastFix::HoldCourse => {
                Some(self.retraced(time_s, first.time_s, last.time_s))
            }
        }
    }

    /// The leg before the first or after the last fix, where its velocity is given.
    fn beyond(&self, time_s: f64, first: &ShipFix, last: &ShipFix) -> Option<ShipLeg> {
        let [before, after] = self.ends_mps;
        let leg = |fix: &ShipFix, [north, east]: [f64; 2], until_s: f64| ShipLeg {
            at_s: fix.time_s,
            place: (fix.north_m, fix.east_m),
            velocity: (north, east),
            until_s,
        };
        match self.after_last_fix {
            AfterLastFix::Repeat => None,
            _ if time_s < first.time_s => Some(leg(first, before?, first.time_s)),
            AfterLastFix::HoldCourse if time_s >= last.time_s => {
                Some(leg(last, after?, f64::INFINITY))
            }
            _ => None,
        }
    }

    /// The recorded leg at a time; the first and the last leg extend beyond their fixes.
    fn recorded(&self, time_s: f64) -> ShipLeg {
        let after = self.fixes.partition_point(|fix| fix.time_s <= time_s);
        let end = after.clamp(1, self.fixes.len() - 1);
        let (from, to) = (&self.fixes[end - 1], &self.fixes[end]);
        let rate = 1.0 / (to.time_s - from.time_s);
        let open = end == self.fixes.len() - 1
            && self.after_last_fix == AfterLastFix::HoldCourse
            && self.ends_mps[1].is_none();
        ShipLeg {
            at_s: from.time_s,
            place: (from.north_m, from.east_m),
            velocity: (
                (to.north_m - from.north_m) * rate,
                (to.east_m - from.east_m) * rate,
            ),
            until_s: if open { f64::INFINITY } else { to.time_s },
        }
    }

    /// The leg at a time after the last fix, for a ship that sails back and forth.
    fn retraced(&self, time_s: f64, first_s: f64, last_s: f64) -> ShipLeg {
        let duration_s = last_s - first_s;
        let sailed = libm::floor((time_s - first_s) / duration_s);
        let start_s = first_s + sailed * duration_s;
        let into_s = (time_s - start_s).max(0.0);
        let back = sailed % 2.0 > 0.5;
        if !back {
            let leg = self.recorded((first_s + into_s).min(last_s));
            let shift_s = start_s - first_s;
            return ShipLeg {
                at_s: leg.at_s + shift_s,
                until_s: leg.until_s + shift_s,
                ..leg
            };
        }
        // The track is sailed backwards: the recorded time is `last_s - into_s`.
        let mirrored_s = last_s - into_s;
        let end = self
            .fixes
            .partition_point(|fix| fix.time_s < mirrored_s)
            .clamp(1, self.fixes.len() - 1);
        let (from, to) = (&self.fixes[end - 1], &self.fixes[end]);
        let rate = 1.0 / (to.time_s - from.time_s);
        ShipLeg {
            at_s: start_s + (last_s - to.time_s),
            place: (to.north_m, to.east_m),
            velocity: (
                (from.north_m - to.north_m) * rate,
                (from.east_m - to.east_m) * rate,
            ),
            until_s: start_s + (last_s - from.time_s),
        }
    }
}
