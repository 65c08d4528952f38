//! Timed polylines: the form in which paths are verified, flown, plotted and exchanged.

use auv_bspline::BSpline;
use auv_obstacles::TimedPoint;
use auv_types::{Point3, Vector3, Violations};
use std::fmt;

/// A timed polyline: between points the motion is straight and of constant speed. It has at least one
/// point. Times never decrease; two points of equal time have equal positions.
///
/// A planner that works on a smooth curve samples it with a chord error of at most
/// [`Trajectory::CHORD_ERROR_M`] and may keep the curve with the points.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "TrajectoryFile")
)]
pub struct Trajectory {
    points: Vec<TimedPoint>,
    curve: Option<BSpline>,
}

impl fmt::Display for Trajectory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (length_m, duration_s) = (self.length_m(), self.duration_s());
        let points = self.points.len();
        write!(f, "{points} points, {length_m:.1} m in {duration_s:.1} s")
    }
}

/// A trajectory as a file states it, before it is checked.
#[cfg(feature = "serde")]
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TrajectoryFile {
    points: Vec<TimedPoint>,
    curve: Option<BSpline>,
}

#[cfg(feature = "serde")]
impl TryFrom<TrajectoryFile> for Trajectory {
    type Error = Violations;

    fn try_from(file: TrajectoryFile) -> Result<Self, Violations> {
        let mut trajectory = Self::new(file.points)?;
        trajectory.curve = file.curve;
        Ok(trajectory)
    }
}

impl Trajectory {
    /// Greatest distance between a smooth curve and its polyline, metres.
    pub const CHORD_ERROR_M: f64 = 0.01;

    /// A trajectory through the given points.
    ///
    /// # Errors
    /// No points, a non-finite value, or time that runs back or stands still while the position
    /// changes.
    pub fn new(points: Vec<TimedPoint>) -> Result<Self, Violations> {
        let mut violations = Violations::new();
        violations.require(!points.is_empty(), "points", || {
            "is empty; give at least one".into()
        });
        for (i, point) in points.iter().enumerate() {
            let finite = point.time_s.is_finite() && point.position.iter().all(|x| x.is_finite());
            if !finite {
                violations.push(format!("points[{i}]"), "is not finite");
            }
        }
        for (i, pair) in points.windows(2).enumerate() {
            let elapsed_s = pair[1].time_s - pair[0].time_s;
            let still = pair[1].position == pair[0].position;
            if !(elapsed_s > 0.0 || (elapsed_s >= 0.0 && still)) {
                let (now_s, before_s) = (pair[1].time_s, pair[0].time_s);
                violations.push(
                    format!("points[{}]", i + 1),
                    format!("has time {now_s} after {before_s}; time must advance"),
                );
            }
        }
        violations.into_result()?;
        Ok(Self {
            points,
            curve: None,
        })
    }

    /// From points known to be finite and in order.
    pub(crate) fn from_ordered(points: Vec<TimedPoint>) -> Self {
        debug_assert!(!points.is_empty(), "a trajectory has a point");
        Self {
            points,
            curve: None,
        }
    }

    /// Staying at one place for `duration_s` seconds (0: just the place).
    #[must_use]
    pub fn hover(place: TimedPoint, duration_s: f64) -> Self {
        let mut points = vec![place];
        if duration_s > 0.0 && duration_s.is_finite() {
            points.push(TimedPoint::new(place.position, place.time_s + duration_s));
        }
        Self {
            points,
            curve: None,
        }
    }

    /// Keeps the smooth curve with the polyline.
    #[must_use]
    pub fn with_curve(mut self, curve: BSpline) -> Self {
        self.curve = Some(curve);
        self
    }

    /// The points.
    #[must_use]
    pub fn points(&self) -> &[TimedPoint] {
        &self.points
    }

    /// The smooth curve, where there is one.
    #[must_use]
    pub fn curve(&self) -> Option<&BSpline> {
        self.curve.as_ref()
    }

    /// The segments in order.
    pub fn segments(
        &self,
    ) -> impl ExactSizeIterator<Item = (&TimedPoint, &TimedPoint)> + DoubleEndedIterator + '_ {
        self.points.windows(2).map(|pair| (&pair[0], &pair[1]))
    }

    /// Where and when it starts.
    #[must_use]
    pub fn start(&self) -> TimedPoint {
        self.points[0]
    }

    /// Where and when it ends.
    #[must_use]
    pub fn end(&self) -> TimedPoint {
        self.points[self.points.len() - 1]
    }

    /// Duration in seconds.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.end().time_s - self.start().time_s
    }

    /// Length over ground in metres (Eq. 16).
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.segments()
            .map(|(a, b)| (b.position - a.position).norm())
            .fold(0.0, |sum, length_m| sum + length_m)
    }

    /// Position in metres and ground velocity in m/s at a time. Before the start and after the end
    /// the vehicle rests there.
    #[must_use]
    pub fn at(&self, time_s: f64) -> (Point3<f64>, Vector3<f64>) {
        let next = self.points.partition_point(|point| point.time_s <= time_s);
        if next == 0 {
            return (self.start().position, Vector3::zeros());
        }
        if next == self.points.len() {
            return (self.end().position, Vector3::zeros());
        }
        let (a, b) = (&self.points[next - 1], &self.points[next]);
        let velocity = (b.position - a.position) / (b.time_s - a.time_s);
        (a.position + velocity * (time_s - a.time_s), velocity)
    }

    /// Ground velocity at the end in m/s: that of the last segment; zero without one.
    #[must_use]
    pub fn end_velocity(&self) -> Vector3<f64> {
        let last = self.segments().next_back();
        last.map_or_else(Vector3::zeros, |(a, b)| {
            let elapsed_s = b.time_s - a.time_s;
            if elapsed_s > 0.0 {
                (b.position - a.position) / elapsed_s
            } else {
                Vector3::zeros()
            }
        })
    }

    /// The part from `time_s` on; the end point alone after the end.
    #[must_use]
    pub fn after(&self, time_s: f64) -> Self {
        if time_s <= self.start().time_s {
            return self.clone();
        }
        let next = self.points.partition_point(|point| point.time_s <= time_s);
        if next == self.points.len() {
            return Self {
                points: vec![self.end()],
                curve: None,
            };
        }
        let mut points = vec![TimedPoint::new(self.at(time_s).0, time_s)];
        points.extend_from_slice(&self.points[next..]);
        Self {
            points,
            curve: None,
        }
    }

    /// The part up to `time_s`; the start point alone before the start.
    #[must_use]
    pub fn until(&self, time_s: f64) -> Self {
        let count = self.points.partition_point(|point| point.time_s <= time_s);
        let mut points = self.points[..count.max(1)].to_vec();
        if count > 0 && count < self.points.len() && self.points[count - 1].time_s < time_s {
            points.push(TimedPoint::new(self.at(time_s).0, time_s));
        }
        Self {
            points,
            curve: None,
        }
    }

    /// This trajectory followed by another that starts where and when it ends.
    ///
    /// # Errors
    /// When the other starts earlier, or elsewhere at the same time.
    pub fn then(mut self, next: &Self) -> Result<Self, Violations> {
        let mut rest = next.points();
        if rest[0] == self.end() {
            rest = &rest[1..];
        }
        self.points.extend_from_slice(rest);
        Self::new(self.points)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line() -> Trajectory {
        let points = [(0.0, 10.0), (30.0, 20.0), (30.0, 25.0), (60.0, 35.0)];
        Trajectory::new(
            points
                .map(|(x, t)| TimedPoint::new(Point3::new(x, 0.0, 5.0), t))
                .to_vec(),
        )
        .unwrap()
    }

    #[test]
    fn cuts_and_joins_without_loss() {
        let line = line();
        assert_eq!((line.duration_s(), line.length_m()), (25.0, 60.0));
        assert_eq!(
            line.at(15.0),
            (Point3::new(15.0, 0.0, 5.0), Vector3::new(3.0, 0.0, 0.0))
        );
        assert_eq!(line.at(22.0).1, Vector3::zeros());
        for cut_s in [10.0, 12.5, 20.0, 23.0, 35.0] {
            let joined = line.until(cut_s).then(&line.after(cut_s)).unwrap();
            assert_eq!(
                (joined.duration_s(), joined.length_m()),
                (25.0, 60.0),
                "cut at {cut_s}"
            );
        }
    }

    #[cfg(feature = "serde")]
    #[test]
    fn files_are_checked_like_calls() {
        let text = serde_json::to_string(&line()).unwrap();
        assert_eq!(serde_json::from_str::<Trajectory>(&text).unwrap(), line());
        let backwards = text.replace("35.0", "24.0");
        assert!(serde_json::from_str::<Trajectory>(&backwards).is_err());
        let empty = "{\"points\":[],\"curve\":null}";
        assert!(serde_json::from_str::<Trajectory>(empty).is_err());
    }

    #[test]
    fn rejects_time_that_does_not_advance() {
        let at = |x: f64, t: f64| TimedPoint::new(Point3::new(x, 0.0, 0.0), t);
        assert!(Trajectory::new(vec![at(0.0, 1.0), at(1.0, 1.0)]).is_err());
        assert!(Trajectory::new(vec![at(0.0, 1.0), at(0.0, 1.0)]).is_ok());
        assert!(
            Trajectory::new(vec![at(f64::NAN, 1.0)]).is_err() && Trajectory::new(vec![]).is_err()
        );
    }
}
