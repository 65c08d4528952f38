//! The classic orienteering text files of Tsiligirides (1984) and Chao, Golden and Wasil (1996).

use super::error::FormatError;
use super::node_scores::{ScoredPlace, complete_instance};
use super::text::{finite_number, shortened, without_mark};
use crate::instance::RouteInstance;
use crate::network::Network;
use auv_types::{Violations, libm};

/// Reads a classic orienteering file: a header, then `x y score` on each line. Distances are Euclidean
/// and not rounded. Words are separated by white space or semicolons.
///
/// There are two headers:
/// - `Tmax 1` on one line, with the number of paths, 1. The first point is the start, the second the end.
/// - `n N`, `m 1` and `tmax T` on lines of their own: the number of points, the number of paths, and
///   the limit. The first point is the start, the last the end.
///
/// Node indices are those of the points in the file, from 0.
///
/// # Errors
/// Every line that is not as above, a number of points other than `n`, more points than a complete
/// [`Network`] may have, and everything that [`Network::new`] refuses.
pub fn from_classic(text: &str, name: &str) -> Result<RouteInstance, FormatError> {
    let mut violations = Violations::new();
    let text = without_mark(text);
    let mut lines = (1..)
        .zip(text.lines())
        .map(|(line, content)| (line, words(content)))
        .filter(|(_, words)| !words.is_empty())
        .peekable();
    let header = if starts_with_header_key(text) {
        let keyed = std::iter::from_fn(|| lines.next_if(|(_, words)| is_header_key(words[0])));
        ClassicHeader::keyed(keyed, &mut violations)
    } else {
        ClassicHeader::on_one_line(lines.next(), &mut violations)
    };
    let places = points(lines, &mut violations);
    violations.require(places.len() >= 2, "the file", || {
        format!(
            "has {} valid points; give the start, the end and those between",
            places.len()
        )
    });
    if let (Some((line, given)), true) = (header.points, violations.is_empty()) {
        violations.require(given == places.len(), &format!("line {line}"), || {
            format!(
                "gives n {given}, but {0} points follow; give {0}",
                places.len()
            )
        });
    }
    violations.into_result()?;
    let end = match header.end {
        EndPoint::Second => 1,
        EndPoint::Last => places.len() - 1,
    };
    let distance =
        |i: usize, j: usize| libm::hypot(places[i].x - places[j].x, places[i].y - places[j].y);
    complete_instance(name, &places, (0, end), header.limit, distance)
}

/// A line's number and its words.
type Words<'a> = (usize, Vec<&'a str>);

fn words(content: &str) -> Vec<&str> {
    content
        .split(|c: char| c == ';' || c.is_whitespace())
        .filter(|word| !word.is_empty())
        .collect()
}

/// Whether the first word is that of a header with keys, so that the file is a classic one.
pub(super) fn starts_with_header_key(text: &str) -> bool {
    let first = text.lines().map(words).find(|words| !words.is_empty());
    first.is_some_and(|words| is_header_key(words[0]))
}

fn is_header_key(word: &str) -> bool {
    ["n", "m", "tmax"].contains(&header_key(word).as_str())
}

fn header_key(word: &str) -> String {
    word.trim_end_matches([':', '=']).to_ascii_lowercase()
}

/// Which point is the end of the route.
#[derive(Clone, Copy, Debug)]
enum EndPoint {
    Second,
    Last,
}

#[derive(Debug)]
struct ClassicHeader {
    limit: f64,
    /// The number of points, if given, and its line.
    points: Option<(usize, usize)>,
    end: EndPoint,
}

impl ClassicHeader {
    /// Reads `Tmax 1`.
    fn on_one_line(first: Option<Words<'_>>, violations: &mut Violations) -> Self {
        let mut limit = 0.0;
        match first {
            Some((line, words)) if (1..=2).contains(&words.len()) => {
                limit = finite_number(words[0], line, "Tmax", violations).unwrap_or(0.0);
                require_one_path(words.get(1).copied().unwrap_or("1"), line, violations);
            }
            first => violations.push(
                format!("line {}", first.map_or(1, |(line, _)| line)),
                "is not the header; give Tmax and the number of paths, 1",
            ),
        }
        Self {
            limit,
            points: None,
            end: EndPoint::Second,
        }
    }

    /// Reads `n N`, `m 1` and `tmax T`, in any order.
    fn keyed<'a>(lines: impl Iterator<Item = Words<'a>>, violations: &mut Violations) -> Self {
        let (mut limit, mut points) = (None, None);
        for (line, words) in lines {
            let key = header_key(words[0]);
            let values: Vec<_> = words[1..]
                .iter()
                .filter(|&&w| w != ":" && w != "=")
                .collect();
            let &[&value] = &values[..] else {
                let message = format!("has {} values; give `{key}` and one number", values.len());
                violations.push(format!("line {line}"), message);
                // Its value is wrong, not absent.
                limit = limit.or((key == "tmax").then_some(0.0));
                continue;
            };
            match key.as_str() {
                "m" => require_one_path(value, line, violations),
                "n" => {
                    let count = value.parse::<usize>().ok();
                    violations.require(count.is_some(), &format!("line {line}"), || {
                        let value = shortened(value);
                        format!("gives n `{value}`; give the number of points")
                    });
                    points = count.map(|count| (line, count));
                }
                _ => limit = Some(finite_number(value, line, "tmax", violations).unwrap_or(0.0)),
            }
        }
        violations.require(limit.is_some(), "tmax", || {
            "is missing; give the limit of the distance before the points".into()
        });
        Self {
            limit: limit.unwrap_or(0.0),
            points,
            end: EndPoint::Last,
        }
    }
}

fn require_one_path(paths: &str, line: usize, violations: &mut Violations) {
    violations.require(paths == "1", &format!("line {line}"), || {
        let paths = shortened(paths);
        format!("asks for `{paths}` paths; only one vehicle is planned for: give 1")
    });
}

/// Reads the points that are valid.
fn points<'a>(
    lines: impl Iterator<Item = Words<'a>>,
    violations: &mut Violations,
) -> Vec<ScoredPlace> {
    let mut places: Vec<ScoredPlace> = Vec::new();
    for (line, words) in lines {
        let [x, y, score] = words[..] else {
            violations.push(
                format!("line {line}"),
                format!("has {} entries; give x, y and score", words.len()),
            );
            continue;
        };
        let x = finite_number(x, line, "x", violations);
        let y = finite_number(y, line, "y", violations);
        let score = finite_number(score, line, "score", violations);
        if let (Some(x), Some(y), Some(score)) = (x, y, score) {
            if places.len() == Network::MAX_NODES {
                let most = Network::MAX_NODES;
                violations.push(
                    format!("line {line}"),
                    format!("is beyond {most} points (Network::MAX_NODES)"),
                );
                break;
            }
            violations.require(score >= 0.0, &format!("line {line}"), || {
                format!("has score {score}; give at least 0")
            });
            places.push(ScoredPlace { x, y, score });
        }
    }
    places
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

    const KEYED: &str = "n 4\nm 1\ntmax 20\n0 0 0\n3 4 10\n0\t8.0\t5\n6 8 0\n";

    fn places_and_messages(text: &str) -> Vec<String> {
        let Err(FormatError::Invalid(violations)) = from_classic(text, "t") else {
            panic!("accepted: {text}");
        };
        let list = violations.list().iter();
        list.map(|v| format!("{} {}", v.place, v.message)).collect()
    }

    #[test]
    fn a_header_with_keys_makes_the_last_point_the_end() {
        let instance = from_classic(KEYED, "t").unwrap();
        assert_eq!(
            (instance.start, instance.destination),
            (NodeId(0), NodeId(3))
        );
        let route = Route::new([0, 1, 3].map(NodeId).to_vec());
        let network = &instance.network;
        let totals = network.evaluate(&route, &EdgeSet::empty(), None).unwrap();
        assert_eq!((totals.weight, totals.time_s), (10.0, 10.0));
        assert_eq!(instance.budget_s, 20.0);
    }

    #[test]
    fn separators_order_and_case_of_the_header_do_not_matter() {
        let instance = from_classic(KEYED, "t").unwrap();
        let mark = format!("\u{feff}{KEYED}");
        let semicolons = KEYED.replace([' ', '\t'], ";");
        let other = KEYED.replace("n 4\nm 1\ntmax 20", "Tmax: 20\nN = 4\nM 1");
        let without = KEYED.replace("n 4\nm 1\n", "");
        for text in [
            mark,
            semicolons,
            other,
            without,
            KEYED.replace('\n', "\r\n"),
        ] {
            assert_eq!(from_classic(&text, "t").unwrap(), instance, "{text}");
        }
        let plain = from_classic("20 1\n0 0 0\n6 8 0\n3 4 10\n", "t").unwrap();
        let same = from_classic("20;1\n0;0;0\n6;8;0\n3; 4; 10\n", "t").unwrap();
        assert_eq!(plain, same);
    }

    #[test]
    fn a_wrong_header_with_keys_is_one_violation() {
        for (old, new, expected) in [
            (
                "n 4",
                "n 5",
                "line 1 gives n 5, but 4 points follow; give 4",
            ),
            (
                "n 4",
                "n x",
                "line 1 gives n `x`; give the number of points",
            ),
            (
                "m 1",
                "m 2",
                "line 2 asks for `2` paths; only one vehicle is planned for: give 1",
            ),
            (
                "tmax 20",
                "tmax",
                "line 3 has 0 values; give `tmax` and one number",
            ),
            (
                "tmax 20\n",
                "",
                "tmax is missing; give the limit of the distance before the points",
            ),
            (
                "8.0",
                "8,0",
                "line 6 holds `8,0` as y; give a finite number",
            ),
        ] {
            assert_eq!(places_and_messages(&KEYED.replace(old, new)), [expected]);
        }
    }
}
