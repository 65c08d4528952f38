//! Sections of an OPLib file with one line for each node.

use super::oplib_text::TextLine;
use super::text::{finite_number, shortened};
use auv_types::Violations;

/// Reads a section of lines `node value ...`, each node from 1 to `n` once, in any order. Nodes are
/// returned in order; where there is a violation, some of their values are 0.
///
/// Every line that cannot be read is a violation, and so is what `wrong` says of its values. All lines
/// with a node beyond `n` are one violation, and all nodes without a line are one.
pub(super) fn node_table<const VALUES: usize>(
    section: &str,
    lines: Option<&Vec<TextLine<'_>>>,
    n: usize,
    wrong: impl Fn(&[f64; VALUES]) -> Option<String>,
    violations: &mut Violations,
) -> Vec<[f64; VALUES]> {
    let Some(lines) = lines else {
        violations.push(section, "is missing; add it");
        return vec![[0.0; VALUES]; n];
    };
    let mut rows = vec![None; n];
    let mut unknown = Vec::new();
    for line in lines {
        let mut words = line.content.split_whitespace();
        let node = words.next().unwrap_or_default();
        let Some(node) = node_index(node, n) else {
            unknown.push((line, node));
            continue;
        };
        let values = line_values(line, words, violations);
        if let Some(message) = values.as_ref().and_then(&wrong) {
            violations.push(line.place(), message);
        }
        // A node with an invalid line is not reported as missing too.
        let again = rows[node].replace(values.unwrap_or([0.0; VALUES]));
        violations.require(again.is_none(), &line.place(), || {
            format!("gives node {} a second time; keep one", node + 1)
        });
    }
    if let Some((line, node)) = unknown.first() {
        let also = match unknown.len() - 1 {
            0 => String::new(),
            more => format!(" ({more} more lines name others)"),
        };
        let node = shortened(node);
        let message = format!("names node `{node}`; nodes are 1 to {n}{also}");
        violations.push(line.place(), message);
    }
    report_missing(section, &rows, violations);
    rows.into_iter()
        .map(|row| row.unwrap_or([0.0; VALUES]))
        .collect()
}

/// The index of a node that the file numbers from 1.
pub(super) fn node_index(word: &str, n: usize) -> Option<usize> {
    let node = word.parse::<usize>().ok()?;
    (1..=n).contains(&node).then(|| node - 1)
}

/// The numbers of a line after its node.
fn line_values<'a, const VALUES: usize>(
    line: &TextLine<'_>,
    words: impl Iterator<Item = &'a str>,
    violations: &mut Violations,
) -> Option<[f64; VALUES]> {
    let words: Vec<_> = words.collect();
    violations.require(words.len() == VALUES, &line.place(), || {
        format!("has {} entries; give {}", words.len() + 1, VALUES + 1)
    });
    let words: [&str; VALUES] = words.try_into().ok()?;
    let values = words.map(|word| finite_number(word, line.number, "value", violations));
    values
        .iter()
        .all(Option::is_some)
        .then(|| values.map(Option::unwrap_or_default))
}

/// Reports the nodes that a section lacks, all of them in one violation.
fn report_missing<T>(section: &str, rows: &[Option<T>], violations: &mut Violations) {
    let mut missing = (1..).zip(rows).filter(|(_, row)| row.is_none());
    if let Some((node, _)) = missing.next() {
        violations.push(
            section,
            match missing.count() {
                0 => format!("lacks node {node}; add it"),
                more => format!("lacks node {node} and {more} more; add them"),
            },
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn violations_of(text: &str, n: usize) -> Vec<String> {
        let mut violations = Violations::new();
        let lines: Vec<_> = (1..)
            .zip(text.lines())
            .map(|(number, content)| TextLine { number, content })
            .collect();
        node_table::<1>("SECTION", Some(&lines), n, |_| None, &mut violations);
        let list = violations.list().iter();
        list.map(|v| format!("{} {}", v.place, v.message)).collect()
    }

    #[test]
    fn lines_with_nodes_beyond_the_dimension_are_one_violation() {
        assert_eq!(
            violations_of("1 5\n7 5\nx 5\n2 5\n8 5\n", 2),
            ["line 2 names node `7`; nodes are 1 to 2 (2 more lines name others)"]
        );
    }

    #[test]
    fn nodes_without_a_line_are_one_violation_and_nodes_with_an_invalid_line_none() {
        assert_eq!(
            violations_of("2 x\n3 1 1\n3 1\n", 9),
            [
                "line 1 holds `x` as value; give a finite number",
                "line 2 has 3 entries; give 2",
                "line 3 gives node 3 a second time; keep one",
                "SECTION lacks node 1 and 6 more; add them",
            ]
        );
    }
}
