//! The nearest known name to one that the TOML reader does not know.

/// Of an unknown name the expected ones that resemble it, where some do.
pub(super) fn nearest(message: &str) -> Option<String> {
    let (head, list) = message.split_once(", expected one of ")?;
    let wrong = head.split('`').nth(1)?;
    let names = list.split('`').skip(1).step_by(2);
    let like = |name: &&str| {
        let stem = |text: &str| text.split('_').next().unwrap_or_default().to_owned();
        stem(name) == stem(wrong) || distance(name, wrong) <= 1 + wrong.len() / 5
    };
    let near: Vec<String> = names.filter(like).map(|name| format!("`{name}`")).collect();
    (!near.is_empty()).then(|| format!("{head}; did you mean {}", near.join(" or ")))
}

/// How many letters must be added, left out, replaced or exchanged with their neighbour to get from a name to another.
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let differs = usize::from(a[i - 1] != b[j - 1]);
            let mut least = (rows[i - 1][j] + 1)
                .min(row[j - 1] + 1)
                .min(rows[i - 1][j - 1] + differs);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                least = least.min(rows[i - 2][j - 2] + 1);
            }
            row.push(least);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_an_unknown_name_the_nearest_known_ones_are_told() {
        let message = "unknown field `budget_h`, expected one of `version`, `budget_s`, `name`";
        assert_eq!(
            nearest(message).as_deref(),
            Some("unknown field `budget_h`; did you mean `budget_s`")
        );
        let message = "unknown variant `statc`, expected one of `static`, `moving`";
        assert_eq!(
            nearest(message).as_deref(),
            Some("unknown variant `statc`; did you mean `static`")
        );
        let far = "unknown field `x`, expected one of `spacing_m`, `polygon`";
        assert_eq!(nearest(far), None);
        assert_eq!(distance("waypoitns", "waypoints"), 1);
    }
}
