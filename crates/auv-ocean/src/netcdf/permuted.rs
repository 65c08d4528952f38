//! Values with their dimensions in another order.

/// Values with their dimensions in another order. Dimensions that `order` leaves out have size 1.
pub(super) fn permuted(values: Vec<f64>, sizes: &[usize], order: &[usize]) -> Vec<f64> {
    if order.windows(2).all(|pair| pair[0] < pair[1]) {
        return values;
    }
    let stride = |dimension: usize| sizes[dimension + 1..].iter().product::<usize>();
    let strides: Vec<usize> = order.iter().map(|&d| stride(d)).collect();
    let counts: Vec<usize> = order.iter().map(|&d| sizes[d]).collect();
    let mut index = vec![0; order.len()];
    let mut turned = Vec::with_capacity(values.len());
    for _ in 0..values.len() {
        turned.push(
            values[index
                .iter()
                .zip(&strides)
                .map(|(i, s)| i * s)
                .sum::<usize>()],
        );
        for k in (0..index.len()).rev() {
            index[k] += 1;
            if index[k] < counts[k] {
                break;
            }
            index[k] = 0;
        }
    }
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn permuted_dimensions_are_put_in_order() {
        let values: Vec<f64> = (0..24).map(f64::from).collect();
        let sizes = [2, 3, 1, 4];
        let turned = permuted(values.clone(), &sizes, &[3, 0, 1]);
        for (i, value) in turned.iter().enumerate() {
            let (x, rest) = (i / 6, i % 6);
            assert_eq!(*value as usize, (rest / 3) * 12 + (rest % 3) * 4 + x);
        }
        assert_eq!(permuted(values.clone(), &sizes, &[0, 1, 3]), values);
    }
}
