//! Whether two files give one field.

use auv_ocean::{ChartedDepths, ModelCurrents};

pub(crate) fn close(a: f64, b: f64) -> bool {
    (a.is_nan() && b.is_nan()) || (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1e-3)
}

pub(crate) fn same_chart(a: &ChartedDepths, b: &ChartedDepths, told: &str) {
    assert_eq!(a.shape(), b.shape(), "{told}");
    for (x, y) in sorted(a).into_iter().zip(sorted(b)) {
        assert!(
            close(x[0], y[0]) && close(x[1], y[1]),
            "{told}: {x:?} {y:?}"
        );
        // Land is land, however high.
        let depth = |d: f64| if d > 0.0 { d } else { 0.0 };
        assert!(close(depth(x[2]), depth(y[2])), "{told}: {x:?} {y:?}");
    }
}

/// Latitude, longitude from 0 and depth of every node, from south-west on.
fn sorted(chart: &ChartedDepths) -> Vec<[f64; 3]> {
    let mut all: Vec<[f64; 3]> = chart
        .soundings()
        .map(|s| [s.latitude_deg, s.longitude_deg.rem_euclid(360.0), s.depth_m])
        .collect();
    let key = |x: f64| (x * 1e6).round() as i64;
    all.sort_by_key(|s| (key(s[0]), key(s[1])));
    all
}

pub(crate) fn same_currents(a: &ModelCurrents, b: &ModelCurrents, told: &str) {
    assert_eq!((a.shape(), a.layers()), (b.shape(), b.layers()), "{told}");
    assert_eq!(a.times_unix_s().len(), b.times_unix_s().len(), "{told}");
    for (x, y) in a.times_unix_s().iter().zip(b.times_unix_s()) {
        assert!((x - y).abs() < 1e-5, "{told}: {x} {y}");
    }
    let (rows, columns) = a.shape();
    for (x, y) in a.places_deg().zip(b.places_deg()) {
        assert!(close(x[0], y[0]) && close(x[1], y[1]), "{told}");
    }
    for time in 0..a.times_unix_s().len() {
        for layer in 0..a.layers() {
            assert!(close(a.depth_m(layer, 0), b.depth_m(layer, 0)), "{told}");
            for point in 0..rows * columns {
                let of = |m: &ModelCurrents| {
                    m.velocity_mps(time, layer, point / columns, point % columns)
                };
                match (of(a), of(b)) {
                    (Some(x), Some(y)) => assert!(
                        (0..2).all(|k| close(x[k].into(), y[k].into())),
                        "{told}: {x:?} {y:?}"
                    ),
                    (x, y) => assert_eq!(x.is_some(), y.is_some(), "{told}"),
                }
            }
        }
    }
}
