//! The order of the values of a latitude or longitude axis.

use auv_types::libm;

/// The indices of an axis in rising order, and a word where the stored order was odd.
///
/// Longitudes (`round`) go round the Earth: they begin after the widest gap, whatever convention they are
/// written in, and where they are a whole circle the first is repeated at its end. An axis with missing
/// values keeps its order.
pub(crate) fn axis_order(axis: &[f64], round: bool) -> (Vec<usize>, Option<String>) {
    let stored: Vec<usize> = (0..axis.len()).collect();
    if axis.len() < 2 || axis.iter().any(|x| !x.is_finite()) {
        return (stored, None);
    }
    let key = |x: f64| {
        if round {
            x - 360.0 * libm::floor(x / 360.0)
        } else {
            x
        }
    };
    let mut order = stored;
    // A stable sort: the first of repeated values stays first.
    order.sort_by(|&a, &b| key(axis[a]).total_cmp(&key(axis[b])));
    if round {
        let gap = |i: usize| {
            let (a, b) = (key(axis[order[i]]), key(axis[order[(i + 1) % order.len()]]));
            if i + 1 == order.len() {
                b + 360.0 - a
            } else {
                b - a
            }
        };
        let (mut widest, mut at) = (0.0, 0);
        let mut gaps: Vec<f64> = (0..order.len()).map(gap).collect();
        for (i, &gap) in gaps.iter().enumerate() {
            if gap >= widest {
                (widest, at) = (gap, i);
            }
        }
        gaps.sort_by(f64::total_cmp);
        let whole = order.len() > 3 && widest <= 1.5 * gaps[gaps.len() / 2];
        let n = order.len();
        order.rotate_left((at + 1) % n);
        if whole {
            order.push(order[0]);
        }
    }
    let steps = order.windows(2).map(|pair| pair[1] as i64 - pair[0] as i64);
    let n = axis.len() as i64;
    // Backwards, or cut and joined at one place, is how charts come.
    let odd = steps
        .filter(|&step| step.abs() != 1 && !(round && step.abs() == n - 1))
        .count();
    let told = (odd > 0).then(|| {
        format!(
            "its {} values are not in order; they were sorted with their columns or rows",
            axis.len()
        )
    });
    (order, told)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(axis: &[f64], round: bool) -> Vec<f64> {
        axis_order(axis, round)
            .0
            .into_iter()
            .map(|i| axis[i])
            .collect()
    }

    #[test]
    fn the_antimeridian_may_lie_anywhere() {
        let right = [178.0, 179.0, -180.0, -179.0, -178.0];
        for stored in [
            [178.0, 179.0, -180.0, -179.0, -178.0],
            [-180.0, -179.0, -178.0, 178.0, 179.0],
            [-178.0, -179.0, -180.0, 179.0, 178.0],
        ] {
            assert_eq!(sorted(&stored, true), right);
            assert!(axis_order(&stored, true).1.is_none());
        }
        assert_eq!(
            sorted(&[178.0, 179.0, 180.0, 181.0, 182.0], true),
            [178.0, 179.0, 180.0, 181.0, 182.0]
        );
        assert_eq!(sorted(&[2.0, 1.0, 0.0, -1.0], true), [-1.0, 0.0, 1.0, 2.0]);
        assert_eq!(sorted(&[359.0, 0.0, 1.0], true), [359.0, 0.0, 1.0]);
        assert_eq!(sorted(&[3.0, 2.0, 1.0], false), [1.0, 2.0, 3.0]);
        assert!(axis_order(&[1.0, 7.0, 3.0, 2.0], false).1.is_some());
    }

    #[test]
    fn a_whole_circle_is_closed() {
        let axis: Vec<f64> = (0..36).map(|i| f64::from(i) * 10.0 - 180.0).collect();
        let (order, told) = axis_order(&axis, true);
        assert_eq!((order.len(), order[0], told), (37, order[36], None));
        let missing = [1.0, f64::NAN, 0.0];
        assert_eq!(axis_order(&missing, true).0, [0, 1, 2]);
    }
}
