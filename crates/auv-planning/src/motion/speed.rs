//! Speed over ground in a current.

use auv_types::Vector3;

/// A vehicle makes way in a direction when it is faster over ground than this share of its cruising
/// speed.
pub const LEAST_SPEED_SHARE: f64 = 0.01;

/// Speed over ground in m/s of a vehicle that keeps to a line along the unit vector `direction` at
/// `speed_mps` through water that moves with velocity `water`: it heads far
/// enough upstream to cancel the part of the current across the line.
///
/// `None` where the vehicle makes no way: the current across the line is as fast as the vehicle, or
/// the speed over ground is at most [`LEAST_SPEED_SHARE`] of `speed_mps`.
#[must_use]
pub fn speed_over_ground_mps(
    speed_mps: f64,
    direction: &Vector3<f64>,
    water: &Vector3<f64>,
) -> Option<f64> {
    let along = water.dot(direction);
    let across_square = (water - direction * along).norm_squared();
    let left = speed_mps * speed_mps - across_square;
    let ground = along + left.max(0.0).sqrt();
    (left > 0.0 && ground > LEAST_SPEED_SHARE * speed_mps).then_some(ground)
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Seed, rand::RngExt};

    #[test]
    fn equals_a_search_over_headings() {
        let mut random = Seed(3).stream(0);
        let mut draw = || random.random_range(-1.0..1.0);
        let mut made_way = 0;
        for _ in 0..500 {
            let direction = Vector3::new(draw(), draw(), draw()).normalize();
            let water = Vector3::new(draw(), draw(), 0.3 * draw()) * 1.5;
            // The greatest speed along the line whose velocity through the water is 1 m/s.
            let through_mps = |ground: f64| (direction * ground - water).norm();
            let (mut low, mut high) = (water.dot(&direction), 5.0);
            if through_mps(low) >= 1.0 {
                assert_eq!(speed_over_ground_mps(1.0, &direction, &water), None);
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if through_mps(middle) < 1.0 {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            match speed_over_ground_mps(1.0, &direction, &water) {
                Some(ground) => {
                    made_way += 1;
                    assert!((ground - low).abs() < 1e-9 && ground > 0.01);
                }
                None => assert!(low <= 0.01 + 1e-9),
            }
        }
        assert!(made_way > 100);
    }
}
