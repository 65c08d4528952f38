//! How long a polyline takes in a current.

use super::speed::speed_over_ground_mps;
use auv_ocean::CurrentField;
use auv_types::Point3;
use thiserror::Error;

/// A place where the vehicle makes no way against the current.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("the current at {place} is too strong to make way", place = format_point(&self.place))]
pub struct NotFlyable {
    /// Where the vehicle makes no way.
    pub place: Point3<f64>,
}

/// A place as error texts print it.
pub(crate) fn format_point(p: &Point3<f64>) -> String {
    if p.iter().any(|x| x.abs() > 1e9) {
        return format!("({:e}, {:e}, {:e})", p.x, p.y, p.z);
    }
    format!("({:.1}, {:.1}, {:.1})", p.x, p.y, p.z)
}

/// Longest piece with one current, metres.
const PIECE_M: f64 = 500.0;

/// Travel time in seconds along a polyline that is left at `departure_s`, at `speed_mps` through
/// water that moves as the current says.
///
/// An estimate for routes: each segment is cut into pieces of at most 500 m; a piece is travelled in
/// the current at its middle at the time the piece is entered. [`PathProblem::timed`] samples more
/// finely.
///
/// # Errors
/// [`NotFlyable`] where the vehicle makes no way.
///
/// [`PathProblem::timed`]: crate::PathProblem::timed
pub fn travel_time_s(
    points: &[Point3<f64>],
    current: &dyn CurrentField,
    speed_mps: f64,
    departure_s: f64,
) -> Result<f64, NotFlyable> {
    let mut sum_s = 0.0;
    for pair in points.windows(2) {
        let length_m = (pair[1] - pair[0]).norm();
        if length_m <= 0.0 {
            continue;
        }
        let direction = (pair[1] - pair[0]) / length_m;
        let pieces = (length_m / PIECE_M).ceil().max(1.0);
        for k in 0..pieces as usize {
            let place = pair[0] + direction * (length_m * (k as f64 + 0.5) / pieces);
            let water = current.velocity_at(&place, departure_s + sum_s);
            let ground_mps =
                speed_over_ground_mps(speed_mps, &direction, &water).ok_or(NotFlyable { place })?;
            sum_s += length_m / pieces / ground_mps;
        }
    }
    Ok(sum_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_ocean::{AnalyticCurrent, TidalConstituent, UniformCurrent};
    use auv_types::Vector3;

    fn uniform(north_mps: f64, east_mps: f64) -> UniformCurrent {
        UniformCurrent::new(Vector3::new(north_mps, east_mps, 0.0))
    }

    #[test]
    fn a_uniform_current_helps_hinders_and_stops() {
        let way = [0.0, 0.0, 700.0, 1200.0].map(|x| Point3::new(x, 0.0, 10.0));
        let time_s = |current| travel_time_s(&way, &current, 1.5, 0.0);
        assert!((time_s(uniform(0.5, 0.0)).unwrap() - 600.0).abs() < 1e-9);
        assert!((time_s(uniform(-0.5, 0.0)).unwrap() - 1200.0).abs() < 1e-9);
        // 0.9 across leaves 1.2 along.
        assert!((time_s(uniform(0.0, 0.9)).unwrap() - 1000.0).abs() < 1e-9);
        let place = Point3::new(175.0, 0.0, 10.0);
        assert_eq!(time_s(uniform(-1.49, 0.0)), Err(NotFlyable { place }));
        assert!(time_s(uniform(0.0, 1.6)).is_err());
    }

    #[test]
    fn a_turning_tide_is_followed_as_it_turns() {
        let tide = AnalyticCurrent {
            tide: vec![TidalConstituent::turning_at(9e3, [0.5, 0.0])],
            ..AnalyticCurrent::default()
        };
        let way = [Point3::new(0.0, 0.0, 10.0), Point3::new(15e3, 0.0, 10.0)];
        for departure_s in [0.0, 5e3, 20e3] {
            let found_s = travel_time_s(&way, &tide, 1.5, departure_s).unwrap();
            // Steps of one second.
            let (mut gone_m, mut slow_s) = (0.0, 0.0);
            while gone_m < 15e3 {
                let place = Point3::new(gone_m, 0.0, 10.0);
                gone_m += 1.5 + tide.velocity_at(&place, departure_s + slow_s).x;
                slow_s += 1.0;
            }
            assert!((found_s / slow_s - 1.0).abs() < 0.01, "{found_s} {slow_s}");
        }
    }
}
