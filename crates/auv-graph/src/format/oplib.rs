//! OPLib: orienteering in TSPLIB's file format (Kobeaga, Merino and Lozano 2018).

use super::error::FormatError;
use super::node_scores::{ScoredPlace, complete_instance};
use super::text::{finite_number, shortened};
use crate::instance::RouteInstance;
use crate::network::Network;
use auv_types::{Violations, libm};

/// Reads an OPLib file, which asks for a closed tour through the depot within `COST_LIMIT` that earns
/// the scores of the nodes it visits. `EDGE_WEIGHT_TYPE` may be `EUC_2D`, `CEIL_2D`, `ATT` or `GEO`,
/// with TSPLIB's rounding to integers.
///
/// # Node indices
/// Node `k` of the file has index `k - 1`. The depot is the start, and a copy of it, at index
/// `DIMENSION`, is the destination. So a route `0, 7, 4, 51` on 51 nodes is the tour 1, 8, 5, 1 of the
/// file.
///
/// # Errors
/// Every line that cannot be read, every node without coordinates or score, and every header that is
/// missing or not supported.
pub fn from_oplib(text: &str, name: &str) -> Result<RouteInstance, FormatError> {
    let mut violations = Violations::new();
    let mut file = OplibFile::default();
    let mut section = FileSection::Header;
    for (line, content) in (1..).zip(text.lines()) {
        let content = content.trim();
        if content == "EOF" {
            break;
        }
        if content.is_empty() {
            continue;
        }
        if content.starts_with(|c: char| c.is_ascii_alphabetic()) {
            section = file.header(line, content, &mut violations);
        } else {
            file.entry(section, line, content, &mut violations);
        }
    }
    let (places, depot, limit) = file.complete(&mut violations);
    violations.into_result()?;
    let measure = file.distance.unwrap_or(euclidean);
    let name = if file.name.is_empty() {
        name
    } else {
        &file.name
    };
    complete_instance(name, &places, (depot, places.len() - 1), limit, |i, j| {
        // Both copies of the depot are at one place; ATT and GEO would not give 0.
        if (i, j) == (depot, places.len() - 1) {
            0.0
        } else {
            measure(&places[i], &places[j])
        }
    })
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum FileSection {
    Header,
    Coordinates,
    Scores,
    Depot,
}

type Distance = fn(&ScoredPlace, &ScoredPlace) -> f64;

/// What has been read so far.
#[derive(Debug, Default)]
struct OplibFile {
    name: String,
    dimension: Option<usize>,
    limit: Option<f64>,
    distance: Option<Distance>,
    coordinates: Vec<Option<(f64, f64)>>,
    scores: Vec<Option<f64>>,
    depot: Option<usize>,
}

impl OplibFile {
    /// Reads `KEYWORD : value` or the name of a section; returns the section that follows.
    fn header(&mut self, line: usize, content: &str, violations: &mut Violations) -> FileSection {
        let (key, value) = content.split_once(':').unwrap_or((content, ""));
        let (key, value) = (key.trim(), value.trim());
        let place = format!("line {line}");
        match key {
            "NODE_COORD_SECTION" => return FileSection::Coordinates,
            "NODE_SCORE_SECTION" => return FileSection::Scores,
            "DEPOT_SECTION" => return FileSection::Depot,
            "NAME" => value.clone_into(&mut self.name),
            "COMMENT" | "DISPLAY_DATA_TYPE" | "NODE_COORD_TYPE" => {}
            "TYPE" => violations.require(value == "OP", &place, || {
                format!("has TYPE `{}`; only OP is read", shortened(value))
            }),
            "DIMENSION" => self.set_dimension(&place, value, violations),
            "COST_LIMIT" => {
                self.limit = finite_number(value, line, key, violations);
            }
            "EDGE_WEIGHT_TYPE" => {
                self.distance = match value {
                    "EUC_2D" => Some(euclidean),
                    "CEIL_2D" => Some(euclidean_ceiling),
                    "ATT" => Some(pseudo_euclidean),
                    "GEO" => Some(geographical),
                    _ => None,
                };
                violations.require(self.distance.is_some(), &place, || {
                    format!(
                        "has EDGE_WEIGHT_TYPE `{}`; EUC_2D, CEIL_2D, ATT and GEO are read",
                        shortened(value)
                    )
                });
            }
            _ => violations.push(
                place,
                format!("has the unknown keyword `{}`; remove it", shortened(key)),
            ),
        }
        FileSection::Header
    }

    /// Checks the count before memory is allocated for it.
    fn set_dimension(&mut self, place: &str, value: &str, violations: &mut Violations) {
        let most = Network::MAX_NODES - 1;
        match value.parse::<usize>() {
            Ok(n) if (1..=most).contains(&n) => {
                self.dimension = Some(n);
                self.coordinates = vec![None; n];
                self.scores = vec![None; n];
            }
            _ => violations.push(
                place,
                format!(
                    "has DIMENSION `{}`; give 1 to {most} before the sections",
                    shortened(value)
                ),
            ),
        }
    }

    /// Reads one line of a section.
    fn entry(&mut self, section: FileSection, line: usize, content: &str, all: &mut Violations) {
        let words: Vec<_> = content.split_whitespace().collect();
        let place = format!("line {line}");
        let expected = match section {
            FileSection::Coordinates => 3,
            FileSection::Scores => 2,
            FileSection::Depot => 1,
            FileSection::Header => {
                all.push(place, "belongs to no section; remove it");
                return;
            }
        };
        if words.len() != expected {
            all.push(
                place,
                format!("has {} entries; give {expected}", words.len()),
            );
            return;
        }
        if section == FileSection::Depot && words[0] == "-1" {
            return;
        }
        let n = self.dimension.unwrap_or(0);
        let Some(node) = words[0]
            .parse::<usize>()
            .ok()
            .filter(|k| (1..=n).contains(k))
        else {
            let word = shortened(words[0]);
            all.push(place, format!("names node `{word}`; nodes are 1 to {n}"));
            return;
        };
        let values: Vec<_> = words[1..]
            .iter()
            .filter_map(|word| finite_number(word, line, "value", all))
            .collect();
        let again = match (section, &values[..]) {
            (FileSection::Coordinates, &[x, y]) => {
                self.coordinates[node - 1].replace((x, y)).is_some()
            }
            (FileSection::Scores, &[score]) => {
                all.require(score >= 0.0, &place, || {
                    format!("has score {score}; give at least 0")
                });
                self.scores[node - 1].replace(score).is_some()
            }
            (FileSection::Depot, _) => self.depot.replace(node - 1).is_some(),
            _ => false,
        };
        all.require(!again, &place, || match section {
            FileSection::Depot => "names a second depot; only one is planned for".into(),
            _ => format!("gives node {node} a second time; keep one"),
        });
    }

    /// The places with the copy of the depot at the end, the index of the depot, and the limit.
    fn complete(&self, violations: &mut Violations) -> (Vec<ScoredPlace>, usize, f64) {
        let headers = [
            ("DIMENSION", self.dimension.is_some()),
            ("COST_LIMIT", self.limit.is_some()),
            ("EDGE_WEIGHT_TYPE", self.distance.is_some()),
            ("DEPOT_SECTION", self.depot.is_some()),
        ];
        for (header, found) in headers {
            violations.require(found, header, || {
                "is missing or not readable; add it".into()
            });
        }
        let mut places = Vec::with_capacity(self.coordinates.len() + 1);
        for (i, (&xy, &score)) in self.coordinates.iter().zip(&self.scores).enumerate() {
            let node = i + 1;
            for (found, section) in [
                (xy.is_some(), "NODE_COORD_SECTION"),
                (score.is_some(), "NODE_SCORE_SECTION"),
            ] {
                violations.require(found, section, || format!("lacks node {node}; add it"));
            }
            let ((x, y), score) = (xy.unwrap_or_default(), score.unwrap_or_default());
            places.push(ScoredPlace { x, y, score });
        }
        let depot = self.depot.unwrap_or(0);
        if let Some(&copy) = places.get(depot) {
            // The tour earns the score of the depot once: half at each copy.
            let half = ScoredPlace {
                score: copy.score / 2.0,
                ..copy
            };
            places[depot] = half;
            places.push(half);
        }
        (places, depot, self.limit.unwrap_or(0.0))
    }
}

fn straight(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    (dx * dx + dy * dy).sqrt()
}

/// TSPLIB's `EUC_2D`: to the nearest integer.
fn euclidean(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    (straight(a, b) + 0.5).floor()
}

/// TSPLIB's `CEIL_2D`: up to the next integer.
fn euclidean_ceiling(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    straight(a, b).ceil()
}

/// TSPLIB's `ATT`: pseudo-Euclidean.
fn pseudo_euclidean(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    ((dx * dx + dy * dy) / 10.0).sqrt().ceil()
}

/// TSPLIB's `GEO`: kilometres on its idealised earth, from degrees and minutes `DDD.MM`, truncated.
fn geographical(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    #[allow(
        clippy::approx_constant,
        reason = "the format prescribes this value of pi"
    )]
    const TSPLIB_PI: f64 = 3.141592;
    let radians = |value: f64| {
        let degrees = value.trunc();
        TSPLIB_PI * (degrees + 5.0 * (value - degrees) / 3.0) / 180.0
    };
    let longitude = libm::cos(radians(a.y) - radians(b.y));
    let minus = libm::cos(radians(a.x) - radians(b.x));
    let plus = libm::cos(radians(a.x) + radians(b.x));
    let cosine = 0.5 * ((1.0 + longitude) * minus - (1.0 - longitude) * plus);
    (6378.388 * libm::acos(cosine.clamp(-1.0, 1.0)) + 1.0).floor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EdgeSet, NodeId, Route};

    const SMALL: &str = "NAME : four\nTYPE : OP\nDIMENSION : 4\nCOST_LIMIT : 40\n\
        EDGE_WEIGHT_TYPE : EUC_2D\nNODE_COORD_SECTION\n1 0 0\n2 3 4\n3 0 10\n4 9 9\n\
        NODE_SCORE_SECTION\n1 2\n2 5\n3 7\n4 11\nDEPOT_SECTION\n3\n-1\nEOF\n";

    #[test]
    fn the_depot_is_split_and_its_score_earned_once() {
        let instance = from_oplib(SMALL, "unused").unwrap();
        assert_eq!((instance.name.as_str(), instance.budget_s), ("four", 40.0));
        assert_eq!(
            (instance.start, instance.destination),
            (NodeId(2), NodeId(4))
        );
        let earn = |nodes: &[u32]| {
            let route = Route::new(nodes.iter().copied().map(NodeId).collect());
            let totals = instance
                .network
                .evaluate(&route, &EdgeSet::empty(), None)
                .unwrap();
            (totals.weight, totals.time_s)
        };
        assert_eq!(earn(&[2, 4]), (7.0, 0.0));
        assert_eq!(earn(&[2, 0, 1, 4]), (14.0, 10.0 + 5.0 + 7.0));
    }

    #[test]
    fn every_invalid_line_is_reported_and_a_huge_count_refused() {
        let bad = SMALL
            .replace("2 3 4", "2 3 x")
            .replace("4 11", "9 11")
            .replace("COST_LIMIT : 40", "CAPACITY : 4");
        let Err(FormatError::Invalid(violations)) = from_oplib(&bad, "t") else {
            panic!("accepted");
        };
        let text = violations.to_string();
        for part in ["line 8", "line 15", "line 4", "COST_LIMIT", "lacks node 4"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        let huge = SMALL.replace("DIMENSION : 4", "DIMENSION : 1000000000");
        assert!(from_oplib(&huge, "t").is_err());
    }

    #[test]
    fn distances_are_those_of_tsplib() {
        let place = |x, y| ScoredPlace { x, y, score: 0.0 };
        assert_eq!(euclidean_ceiling(&place(0.0, 0.0), &place(1.0, 1.0)), 2.0);
        assert_eq!(pseudo_euclidean(&place(0.0, 0.0), &place(10.0, 10.0)), 5.0);
        // ulysses16's first two cities: 38.24 N 20.42 E and 39.57 N 26.15 E.
        assert_eq!(
            geographical(&place(38.24, 20.42), &place(39.57, 26.15)),
            509.0
        );
    }
}
