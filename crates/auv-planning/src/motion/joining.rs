//! Where another way joins a path.

use auv_types::{Point3, Vector3};

/// A path is joined along a piece that is at least this long, metres.
const LEAST_PIECE_M: f64 = 0.5;

/// The first vertex at least `cut_m` along a path from which a piece of at least 0.5 m leads on, and the
/// direction of that piece. `None` where there is none.
#[must_use]
pub fn join(places: &[Point3<f64>], cut_m: f64) -> Option<(usize, Vector3<f64>)> {
    let mut gone_m = 0.0;
    places.windows(2).enumerate().find_map(|(k, pair)| {
        let piece = pair[1] - pair[0];
        let far_enough = gone_m >= cut_m && piece.norm() >= LEAST_PIECE_M;
        gone_m += piece.norm();
        far_enough.then_some((k, piece))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_joined_along_its_next_long_piece() {
        let places = [0.0, 5.0, 10.0, 10.2, 30.0].map(|x| Point3::new(x, 0.0, 0.0));
        let joined = |cut_m: f64| join(&places, cut_m).map(|(at, piece)| (at, piece.x));
        assert_eq!(joined(0.0), Some((0, 5.0)));
        assert_eq!(joined(3.0), Some((1, 5.0)));
        assert_eq!(joined(10.0).map(|(at, _)| at), Some(3));
        assert_eq!(joined(30.0), None);
    }
}
