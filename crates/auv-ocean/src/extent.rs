//! The box around positions.

/// South, north, west and east of the positions on Earth, degrees; `None` where there is none. Longitudes count
/// from 0 where that makes the box narrower: across the antimeridian.
pub(crate) fn extent_deg(latitudes_deg: &[f64], longitudes_deg: &[f64]) -> Option<[f64; 4]> {
    let ends = |axis: &[f64], limit: f64, of: fn(f64) -> f64| {
        let on_earth = axis.iter().copied().filter(|x| x.abs() <= limit).map(of);
        let [low, high] = on_earth.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
            [low.min(x), high.max(x)]
        });
        (low <= high).then_some([low, high])
    };
    let [south, north] = ends(latitudes_deg, 90.0, |x| x)?;
    let [mut west, mut east] = ends(longitudes_deg, 360.0, |x| x)?;
    if east - west > 180.0 {
        let from_0 = |x: f64| if x < 0.0 { x + 360.0 } else { x };
        let [other_west, other_east] = ends(longitudes_deg, 360.0, from_0)?;
        if other_east - other_west < east - west {
            [west, east] = [other_west, other_east];
        }
    }
    Some([south, north, west, east])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_across_the_antimeridian_is_narrow() {
        let latitudes = [58.0, 59.0, f64::NAN];
        assert_eq!(
            extent_deg(&latitudes, &[179.5, -180.0, -179.5]),
            Some([58.0, 59.0, 179.5, 180.5])
        );
        assert_eq!(
            extent_deg(&latitudes, &[-0.5, 0.5]),
            Some([58.0, 59.0, -0.5, 0.5])
        );
        assert_eq!(extent_deg(&[f64::NAN], &[0.0]), None);
    }
}
