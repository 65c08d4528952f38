//! Lines on the Earth, cut where they cross the antimeridian (RFC 7946, 3.1.9).

/// A vertex of a line: its coordinates, longitude first, and how far along the line it is, counted in the
/// vertices of the line before it was cut.
pub(super) type Vertex = (Vec<f64>, f64);

/// The parts of a line, two vertices or more each, none of which crosses the antimeridian. A vertex is added on
/// either side of it. Two vertices more than 180 degrees apart are joined the short way round.
pub(super) fn cut(positions: &[Vec<f64>]) -> Vec<Vec<Vertex>> {
    let mut parts: Vec<Vec<Vertex>> = vec![Vec::new()];
    for (i, position) in positions.iter().enumerate() {
        let before = i.checked_sub(1).map(|k| &positions[k]);
        if let Some(before) = before
            && (position[0] - before[0]).abs() > 180.0
        {
            let left = 180.0 - before[0].abs();
            let share = left / (left + 180.0 - position[0].abs()).max(f64::MIN_POSITIVE);
            let side = 180.0_f64.copysign(before[0]);
            let place = (i - 1) as f64 + share;
            let at = |longitude: f64| -> Vertex {
                let mut met: Vec<f64> = before
                    .iter()
                    .zip(position)
                    .map(|(a, b)| a + share * (b - a))
                    .collect();
                met[0] = longitude;
                (met, place)
            };
            // A vertex on the antimeridian itself is not repeated.
            if share > 0.0
                && let Some(part) = parts.last_mut()
            {
                part.push(at(side));
            }
            parts.push(if share < 1.0 {
                vec![at(-side)]
            } else {
                Vec::new()
            });
        }
        if let Some(part) = parts.last_mut() {
            part.push((position.clone(), i as f64));
        }
    }
    parts.retain(|part| part.len() > 1);
    parts
}

/// The value of a list at a place between its entries.
pub(super) fn between(values: &[f64], place: f64) -> f64 {
    let low = (place as usize).min(values.len().saturating_sub(1));
    let high = (low + 1).min(values.len().saturating_sub(1));
    let share = place - low as f64;
    match (values.get(low), values.get(high)) {
        (Some(a), Some(b)) if share > 0.0 => a + share * (b - a),
        (Some(a), _) => *a,
        (None, _) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn longitudes(line: &[f64]) -> Vec<Vec<f64>> {
        let positions: Vec<Vec<f64>> = line
            .iter()
            .map(|x| vec![*x, 10.0 + x.abs() / 100.0])
            .collect();
        let parts = cut(&positions);
        for part in &parts {
            assert!(
                part.windows(2)
                    .all(|pair| (pair[0].0[0] - pair[1].0[0]).abs() <= 180.0)
            );
            assert!(part.windows(2).all(|pair| pair[0].1 < pair[1].1));
        }
        let of = |part: &Vec<Vertex>| part.iter().map(|vertex| vertex.0[0]).collect();
        parts.iter().map(of).collect()
    }

    #[test]
    fn lines_are_cut_at_180_degrees_in_either_direction() {
        assert_eq!(longitudes(&[1.0, 2.0, 3.0]), [[1.0, 2.0, 3.0]]);
        assert_eq!(
            longitudes(&[179.0, 179.5, -179.5, -179.0, 179.0]),
            [
                vec![179.0, 179.5, 180.0],
                vec![-180.0, -179.5, -179.0, -180.0],
                vec![180.0, 179.0]
            ]
        );
        // On the antimeridian itself, written either way.
        assert_eq!(
            longitudes(&[180.0, -179.0, -178.0]),
            [[-180.0, -179.0, -178.0]]
        );
        assert_eq!(
            longitudes(&[179.0, -180.0, -179.0]),
            [vec![179.0, 180.0], vec![-180.0, -179.0]]
        );
        assert_eq!(longitudes(&[179.0, 180.0, 179.0]), [[179.0, 180.0, 179.0]]);
        assert!(longitudes(&[5.0]).is_empty());
    }

    #[test]
    fn times_are_interpolated_at_the_cut() {
        let parts = cut(&[vec![179.9, 0.0, -5.0], vec![-179.7, 4.0, -9.0]]);
        let (met, place) = &parts[0][1];
        assert!((met[1] - 1.0).abs() < 1e-9 && (met[2] + 6.0).abs() < 1e-9);
        assert!((between(&[100.0, 140.0], *place) - 110.0).abs() < 1e-9);
        assert!((between(&[100.0, 140.0], 1.0) - 140.0).abs() < 1e-12);
    }
}
