//! Ships that sail along recorded fixes.

use crate::{ObstacleId, Region, Shape};
use auv_types::{Point3, Vector3, Violations, libm};

/// A recorded place of a ship.
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
    /// Sails its track back and forth, so that it never jumps.
    Repeat,
    /// Keeps course and speed of the last two fixes.
    #[default]
    HoldCourse,
    /// Is gone.
    Leave,
}

/// A ship: a vertical cylinder of radius length / 2 from above the surface down to its draught,
/// whose place is interpolated between fixes. Before its first fix it sails the course of the first
/// two; one with a single fix stays there.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TrackedShip {
    fixes: Vec<ShipFix>,
    radius_m: f64,
    draught_m: f64,
    after_last_fix: AfterLastFix,
}

/// One straight piece of a track: from where, how fast, until when.
struct Piece {
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
        })
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
        let piece = self.piece(time_s)?;
        Some(self.region(id, &piece, time_s, piece.until_s))
    }

    /// Adds what the ship covers from one time to another: one region for each straight piece.
    pub fn regions_into(
        &self,
        id: ObstacleId,
        from_s: f64,
        until_s: f64,
        regions: &mut Vec<Region>,
    ) {
        let mut time_s = from_s;
        while let Some(piece) = self.piece(time_s) {
            let end_s = piece.until_s.min(until_s);
            regions.push(self.region(id, &piece, time_s, end_s));
            if end_s >= until_s {
                break;
            }
            time_s = end_s.max(time_s + 1e-6);
        }
    }

    fn region(&self, id: ObstacleId, piece: &Piece, time_s: f64, until_s: f64) -> Region {
        let elapsed_s = time_s - piece.at_s;
        let (north, east) = piece.velocity;
        Region {
            obstacle: id,
            shape: Shape::Cylinder {
                top_m: f64::NEG_INFINITY,
                bottom_m: self.draught_m,
            },
            at_s: time_s,
            from_s: time_s,
            until_s: until_s.max(time_s),
            centre: Point3::new(
                piece.place.0 + north * elapsed_s,
                piece.place.1 + east * elapsed_s,
                0.0,
            ),
            velocity_mps: Vector3::new(north, east, 0.0),
            radius_m: self.radius_m,
            growth_mps: 0.0,
        }
    }

    /// The straight piece sailed from `time_s` on.
    fn piece(&self, time_s: f64) -> Option<Piece> {
        let (first, last) = (self.fixes.first()?, self.fixes.last()?);
        if self.fixes.len() == 1 {
            let gone = self.after_last_fix == AfterLastFix::Leave && time_s >= first.time_s;
            return (!gone).then_some(Piece {
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

    /// The piece on record, the outer ones extended.
    fn recorded(&self, time_s: f64) -> Piece {
        let after = self.fixes.partition_point(|fix| fix.time_s <= time_s);
        let end = after.clamp(1, self.fixes.len() - 1);
        let (from, to) = (&self.fixes[end - 1], &self.fixes[end]);
        let rate = 1.0 / (to.time_s - from.time_s);
        let open = end == self.fixes.len() - 1 && self.after_last_fix == AfterLastFix::HoldCourse;
        Piece {
            at_s: from.time_s,
            place: (from.north_m, from.east_m),
            velocity: (
                (to.north_m - from.north_m) * rate,
                (to.east_m - from.east_m) * rate,
            ),
            until_s: if open { f64::INFINITY } else { to.time_s },
        }
    }

    /// The piece after the last fix of a ship that sails back and forth.
    fn retraced(&self, time_s: f64, first_s: f64, last_s: f64) -> Piece {
        let duration_s = last_s - first_s;
        let sailed = libm::floor((time_s - first_s) / duration_s);
        let begin_s = first_s + sailed * duration_s;
        let into_s = (time_s - begin_s).max(0.0);
        let back = sailed % 2.0 > 0.5;
        if !back {
            let piece = self.recorded((first_s + into_s).min(last_s));
            let shift_s = begin_s - first_s;
            return Piece {
                at_s: piece.at_s + shift_s,
                until_s: piece.until_s + shift_s,
                ..piece
            };
        }
        // Time runs backwards: recorded time is `last_s - into`; look just before it.
        let mirrored_s = last_s - into_s;
        let end = self
            .fixes
            .partition_point(|fix| fix.time_s < mirrored_s)
            .clamp(1, self.fixes.len() - 1);
        let (from, to) = (&self.fixes[end - 1], &self.fixes[end]);
        let rate = 1.0 / (to.time_s - from.time_s);
        Piece {
            at_s: begin_s + (last_s - to.time_s),
            place: (to.north_m, to.east_m),
            velocity: (
                (from.north_m - to.north_m) * rate,
                (from.east_m - to.east_m) * rate,
            ),
            until_s: begin_s + (last_s - from.time_s),
        }
    }
}
