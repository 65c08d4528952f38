//! The box each free control point is searched in (Eq. 14-15).

use crate::swarm::settings::Windows;
use auv_planning::PathProblem;
use auv_types::{Bounds, Point3};

/// Regions grow while the vehicle flies at most this multiple of the straight line.
const LONGEST_FLIGHT: f64 = 1.5;

/// One box for each free control point, in order from start to target.
///
/// With `n` free points the straight line is cut at `n + 1` equally spaced knots `x_0 .. x_n` and
/// point `i` is searched in `[x_{i-1}, x_i]` per axis, clipped to the problem's bounds.
pub(crate) fn windows(policy: Windows, problem: &PathProblem<'_>, free: usize) -> Vec<Bounds> {
    let line = problem.target - problem.start;
    let margin_m = match policy {
        Windows::Literal => 0.0,
        Windows::Widened {
            length_share,
            radii,
        } => {
            let largest_m = largest_radius_m(problem, LONGEST_FLIGHT * line.norm());
            (length_share * line.norm()).max(radii * largest_m)
        }
    };
    (1..=free)
        .map(|i| {
            let knot = |k: usize| problem.start + line * (k as f64 / free as f64);
            let (a, b) = (knot(i - 1), knot(i));
            let low = a.coords.zip_map(&b.coords, f64::min).add_scalar(-margin_m);
            let high = a.coords.zip_map(&b.coords, f64::max).add_scalar(margin_m);
            let (low, high) = (Point3::from(low), Point3::from(high));
            match &problem.bounds {
                Some(bounds) => Bounds::new(bounds.clamp(&low), bounds.clamp(&high)),
                None => Bounds::new(low, high),
            }
        })
        .collect()
}

/// Largest radius plus clearance while the vehicle flies `reach_m`, at most `reach_m`.
fn largest_radius_m(problem: &PathProblem<'_>, reach_m: f64) -> f64 {
    let latest_s = problem.departure_s + reach_m / problem.vehicle.speed_mps;
    let largest_m = problem
        .regions
        .iter()
        .map(|region| {
            region
                .radius_at(problem.departure_s)
                .max(region.radius_at(latest_s))
        })
        .fold(0.0, f64::max);
    (largest_m + problem.clearance_m).min(reach_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::swarm::settings::SwarmSettings;
    use auv_obstacles::Region;
    use auv_planning::Vehicle;

    #[test]
    fn windows_follow_the_line_and_stay_in_the_box() {
        let vehicle = Vehicle::paper();
        let regions = [Region::ball(Point3::new(300.0, 0.0, 20.0), 40.0)];
        let problem = PathProblem {
            bounds: Some(Bounds::new(
                Point3::new(-50.0, -500.0, 0.0),
                Point3::new(700.0, 500.0, 60.0),
            )),
            regions: &regions,
            clearance_m: 10.0,
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 20.0),
                Point3::new(600.0, 0.0, 20.0),
                &vehicle,
            )
        };
        let literal = windows(Windows::Literal, &problem, 6);
        assert_eq!((literal[2].low.x, literal[2].high.x), (200.0, 300.0));
        assert_eq!((literal[2].low.y, literal[2].high.y), (0.0, 0.0));
        let widened = windows(SwarmSettings::paper().windows, &problem, 6);
        assert_eq!((widened[2].low.x, widened[2].high.x), (100.0, 400.0));
        assert_eq!((widened[2].low.z, widened[2].high.z), (0.0, 60.0));
        assert_eq!(widened[0].low.x, -50.0, "clipped to the box");
    }

    #[test]
    fn literal_windows_cover_the_line_in_order() {
        let vehicle = Vehicle::paper();
        let (start, target) = (
            Point3::new(10.0, 400.0, 30.0),
            Point3::new(610.0, -200.0, 90.0),
        );
        let problem = PathProblem::new(start, target, &vehicle);
        let boxes = windows(Windows::Literal, &problem, 3);
        assert_eq!((boxes[0].low.x, boxes[2].high.x), (start.x, target.x));
        assert_eq!((boxes[0].high.y, boxes[2].low.y), (start.y, target.y));
        for pair in boxes.windows(2) {
            assert_eq!(
                (pair[0].high.x, pair[0].low.y),
                (pair[1].low.x, pair[1].high.y)
            );
        }
    }

    #[test]
    fn the_margin_follows_the_largest_region_but_no_farther_than_the_leg() {
        let vehicle = Vehicle::paper();
        let widened = Windows::Widened {
            length_share: 0.1,
            radii: 2.0,
        };
        let margin_m = |radius_m: f64, growth_mps: f64| {
            let mut region = Region::ball(Point3::new(300.0, 0.0, 20.0), radius_m);
            region.growth_mps = growth_mps;
            let regions = [region];
            let problem = PathProblem {
                regions: &regions,
                clearance_m: 10.0,
                ..PathProblem::new(Point3::origin(), Point3::new(600.0, 0.0, 0.0), &vehicle)
            };
            windows(widened, &problem, 2)[0].high.y
        };
        assert_eq!(margin_m(5.0, 0.0), 60.0, "a share of the length");
        assert_eq!(margin_m(40.0, 0.0), 100.0, "twice radius and clearance");
        // Flying half as long again as the line takes 300 s.
        assert_eq!(margin_m(40.0, 0.1), 160.0, "as large as it grows");
        assert_eq!(margin_m(1e6, 0.0), 2.0 * 900.0, "limited by the reach");
    }
}
