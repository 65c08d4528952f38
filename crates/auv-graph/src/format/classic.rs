//! The classic orienteering text files of Tsiligirides (1984) and Chao, Golden and Wasil (1996).

use super::error::FormatError;
use super::node_scores::{ScoredPlace, complete_instance};
use super::text::finite_number;
use crate::instance::RouteInstance;
use crate::network::Network;
use auv_types::{Violations, libm};

/// Reads a classic orienteering file: `Tmax 1` on the first line, then `x y score` on each line. The
/// first point is the start, the second the end. Distances are Euclidean and not rounded.
///
/// Node indices are those of the points in the file, from 0.
///
/// # Errors
/// Every line that is not as above, and everything that [`Network::new`] refuses.
pub fn from_classic(text: &str, name: &str) -> Result<RouteInstance, FormatError> {
    let mut violations = Violations::new();
    let mut limit = 0.0;
    let mut places: Vec<ScoredPlace> = Vec::new();
    let mut lines = (1..)
        .zip(text.lines())
        .map(|(line, content)| (line, content.split_whitespace().collect::<Vec<_>>()))
        .filter(|(_, words)| !words.is_empty());
    match lines.next() {
        Some((line, words)) if (1..=2).contains(&words.len()) => {
            limit = finite_number(words[0], line, "Tmax", &mut violations).unwrap_or(0.0);
            let paths = words.get(1).copied().unwrap_or("1");
            violations.require(paths == "1", &format!("line {line}"), || {
                format!("asks for `{paths}` paths; only one vehicle is planned for: give 1")
            });
        }
        first => violations.push(
            format!("line {}", first.map_or(1, |(line, _)| line)),
            "is not the header; give Tmax and the number of paths, 1",
        ),
    }
    for (line, words) in lines {
        let [x, y, score] = words[..] else {
            violations.push(
                format!("line {line}"),
                format!("has {} entries; give x, y and score", words.len()),
            );
            continue;
        };
        let x = finite_number(x, line, "x", &mut violations);
        let y = finite_number(y, line, "y", &mut violations);
        let score = finite_number(score, line, "score", &mut violations);
        if let (Some(x), Some(y), Some(score)) = (x, y, score) {
            if places.len() == Network::MAX_NODES {
                let most = Network::MAX_NODES;
                violations.push(format!("line {line}"), format!("is beyond {most} points"));
                break;
            }
            violations.require(score >= 0.0, &format!("line {line}"), || {
                format!("has score {score}; give at least 0")
            });
            places.push(ScoredPlace { x, y, score });
        }
    }
    violations.require(places.len() >= 2, "the file", || {
        format!(
            "has {} valid points; give the start, the end and those between",
            places.len()
        )
    });
    violations.into_result()?;
    let distance =
        |i: usize, j: usize| libm::hypot(places[i].x - places[j].x, places[i].y - places[j].y);
    complete_instance(name, &places, (0, 1), limit, distance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EdgeSet, NodeId, Route};

    #[test]
    fn a_route_earns_the_scores_of_its_nodes() {
        let text = "30.5 1\n\n0 0 1\n10 0 2\n3.0\t4.0 8\n10 5 16\n";
        let instance = from_classic(text, "t").unwrap();
        let route = Route::new([0, 2, 3, 1].map(NodeId).to_vec());
        let totals = instance
            .network
            .evaluate(&route, &EdgeSet::empty(), None)
            .unwrap();
        assert_eq!(totals.weight, 27.0);
        assert!((totals.time_s - (5.0 + libm::hypot(7.0, 1.0) + 5.0)).abs() < 1e-12);
        assert_eq!(instance.budget_s, 30.5);
    }

    #[test]
    fn every_bad_line_is_reported() {
        let text = "30 2\n0 0 0\n1 1\nNaN 0 1\n2 2 -1\n3 3 3\n";
        let Err(FormatError::Invalid(violations)) = from_classic(text, "t") else {
            panic!("accepted");
        };
        let places: Vec<_> = violations.list().iter().map(|v| v.place.as_str()).collect();
        assert_eq!(places, ["line 1", "line 3", "line 4", "line 5"]);
    }
}
