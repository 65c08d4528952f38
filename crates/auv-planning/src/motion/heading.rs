//! Horizontal directions.

use auv_types::Vector3;

/// The horizontal unit vector in the direction of a velocity (or of any vector); `None` where its
/// horizontal part is no longer than 1e-6.
#[must_use]
pub fn level_heading(velocity: &Vector3<f64>) -> Option<Vector3<f64>> {
    Vector3::new(velocity.x, velocity.y, 0.0).try_normalize(1e-6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vertical_part_is_dropped() {
        let heading = level_heading(&Vector3::new(3.0, -4.0, 12.0));
        assert_eq!(heading, Some(Vector3::new(0.6, -0.8, 0.0)));
        assert_eq!(level_heading(&Vector3::new(1e-7, 0.0, -2.0)), None);
    }
}
