//! OPLib: orienteering in TSPLIB's file format (Kobeaga, Merino and Lozano 2018).

use super::error::FormatError;
use super::node_scores::{ScoredPlace, complete_instance};
use super::node_table::node_table;
use super::oplib_headers::{
    WeightSource, check_type, cost_limit, depot, dimension, dimension_agrees, known_depot,
    weight_source,
};
use super::oplib_text::OplibText;
use super::text::without_mark;
use super::tsplib_distance::Distance;
use super::weight_matrix::WeightMatrix;
use crate::instance::RouteInstance;
use auv_types::{Violations, libm};
use std::f64::consts::TAU;

/// Reads an OPLib file, which asks for a closed tour through the depot within `COST_LIMIT` that earns
/// the scores of the nodes it visits.
///
/// # Distances
/// `EDGE_WEIGHT_TYPE` may be `EUC_2D`, `CEIL_2D`, `ATT` or `GEO`, with TSPLIB's rounding to integers
/// (`EDGE_WEIGHT_FORMAT` may then be `FUNCTION`), or `EXPLICIT` with a symmetric matrix as
/// `FULL_MATRIX`, `UPPER_ROW`, `LOWER_ROW`, `UPPER_DIAG_ROW` or `LOWER_DIAG_ROW` (or the same by
/// columns, `UPPER_COL` and so on). `TSPSOL`, comments and display types are ignored.
///
/// # Positions
/// The network stores the distance of every edge, so positions serve pictures only. They are the
/// file's coordinates, without conversion: degrees in a `GEO` file. With `EXPLICIT` they come from
/// `NODE_COORD_SECTION` or `DISPLAY_DATA_SECTION`; a file without both gets its nodes on a circle as
/// wide as the greatest distance. The distances between the positions are then not those of the matrix.
///
/// # Node indices
/// Node `k` of the file has index `k - 1`. The depot is the start, and a copy of it, at index
/// `DIMENSION`, is the destination. So a route `0, 7, 4, 51` on 51 nodes is the tour 1, 8, 5, 1 of the
/// file.
///
/// # Size
/// Above 1,413 nodes, each has edges to its nearest neighbours and to the depot only, as
/// [`nearest_kept`](super::nearest_kept) says.
///
/// # Errors
/// Every line that cannot be read, and every header that is missing or not supported. A fault with
/// consequences for many lines is one violation: an unknown keyword, a section that is missing or lacks
/// nodes, a wrong `DIMENSION`, a matrix that is incomplete, asymmetric or has a weight below 0, more
/// nodes than [`Network::MAX_NODES`](crate::Network::MAX_NODES) allows.
pub fn from_oplib(text: &str, name: &str) -> Result<RouteInstance, FormatError> {
    let mut violations = Violations::new();
    let file = OplibText::split(without_mark(text), &mut violations);
    check_type(&file, &mut violations);
    let limit = cost_limit(&file, &mut violations);
    let source = weight_source(&file, &mut violations);
    let depot = depot(&file, &mut violations);
    let n = dimension(&file, &mut violations);
    let agrees = n.is_none_or(|n| dimension_agrees(&file, source, n, &mut violations));
    let (Some(n), true) = (n, agrees) else {
        return Err(violations.into());
    };
    let depot = depot.and_then(|depot| known_depot(depot, n, &mut violations));
    let weights = weights(&file, source, n, &mut violations);
    let positions = positions(&file, weights.as_ref(), n, &mut violations);
    let negative = |&[score]: &[f64; 1]| {
        let is_negative = score < 0.0;
        is_negative.then(|| format!("has score {score}; give at least 0"))
    };
    let section = "NODE_SCORE_SECTION";
    let scores = node_table(section, file.scores.as_ref(), n, negative, &mut violations);
    violations.into_result()?;
    let (Some(limit), Some(depot), Some(weights)) = (limit, depot, weights) else {
        // Each of them is missing only with a violation.
        return Err(Violations::new().into());
    };
    let mut places: Vec<_> = positions
        .iter()
        .zip(&scores)
        .map(|(&[x, y], &[score])| ScoredPlace { x, y, score })
        .collect();
    // The tour earns the score of the depot once: half at each copy.
    places[depot].score /= 2.0;
    places.push(places[depot]);
    let name = match file.name {
        Some(given) if !given.content.is_empty() => given.content,
        _ => name,
    };
    complete_instance(name, &places, (depot, n), limit, |i, j| {
        // Both copies of the depot are at one place; ATT and GEO would not give 0.
        if (i, j) == (depot, n) {
            return 0.0;
        }
        match &weights {
            Weights::Formula(distance) => distance(&places[i], &places[j]),
            Weights::Matrix(matrix) if j == n => matrix.between(i, depot),
            Weights::Matrix(matrix) => matrix.between(i, j),
        }
    })
}

/// Where distances come from.
#[derive(Debug)]
enum Weights {
    Formula(Distance),
    Matrix(WeightMatrix),
}

/// The distances; `None` with a violation, now or before.
fn weights(
    file: &OplibText<'_>,
    source: Option<WeightSource>,
    n: usize,
    violations: &mut Violations,
) -> Option<Weights> {
    match source? {
        WeightSource::Formula(distance) => Some(Weights::Formula(distance)),
        WeightSource::Matrix(layout) => {
            let lines = file.weights.as_ref()?;
            WeightMatrix::read(lines, layout, n, violations).map(Weights::Matrix)
        }
    }
}

/// The positions of the nodes. A file whose distances are unknown needs none.
fn positions(
    file: &OplibText<'_>,
    weights: Option<&Weights>,
    n: usize,
    violations: &mut Violations,
) -> Vec<[f64; 2]> {
    let (section, lines) = match (&file.coordinates, &file.display, weights) {
        (Some(lines), _, _) => ("NODE_COORD_SECTION", Some(lines)),
        (None, Some(lines), Some(Weights::Matrix(_))) => ("DISPLAY_DATA_SECTION", Some(lines)),
        (None, _, Some(Weights::Formula(_))) => ("NODE_COORD_SECTION", None),
        (None, None, Some(Weights::Matrix(matrix))) => return circle(n, matrix.greatest()),
        (None, _, None) => return vec![[0.0; 2]; n],
    };
    node_table(section, lines, n, |_| None, violations)
}

/// Nodes at equal distances on a circle around the origin, within the coordinates that a network allows.
fn circle(n: usize, diameter: f64) -> Vec<[f64; 2]> {
    let radius = diameter.min(1e7) / 2.0;
    let angle = |i: usize| TAU * i as f64 / n as f64;
    (0..n)
        .map(|i| [radius * libm::cos(angle(i)), radius * libm::sin(angle(i))])
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EdgeSet, NodeId, Route};
    use proptest::prelude::*;

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

    const MATRIX: &str = "NAME : five\nTYPE : OP\nTSPSOL : 40\nDIMENSION : 5\nCOST_LIMIT : 33\n\
        EDGE_WEIGHT_TYPE : EXPLICIT\nEDGE_WEIGHT_FORMAT : LOWER_ROW \nEDGE_WEIGHT_SECTION\n\
        9 4 6 13\n 5 8\n7 11 10 12\nNODE_SCORE_SECTION\n1 2\n2 14\n3 9\n4 22\n5 17\n\
        DEPOT_SECTION\n 2\n -1\nEOF\n";

    fn messages(text: &str) -> Vec<String> {
        let Err(FormatError::Invalid(violations)) = from_oplib(text, "t") else {
            panic!("accepted: {text}");
        };
        let list = violations.list().iter();
        list.map(|v| format!("{} {}", v.place, v.message)).collect()
    }

    #[test]
    fn a_matrix_gives_the_distances_and_a_circle_the_positions() {
        let instance = from_oplib(MATRIX, "t").unwrap();
        let network = &instance.network;
        let distance = |i, j| {
            let arc = network.arc_between(NodeId(i), NodeId(j)).unwrap();
            network.arcs()[arc.index()].distance_m
        };
        // The depot is node 2 of the file, index 1; its copy has index 5.
        let of_depot = [
            distance(1, 0),
            distance(1, 2),
            distance(3, 1),
            distance(4, 1),
        ];
        assert_eq!(of_depot, [9.0, 6.0, 5.0, 11.0]);
        let of_copy = [
            distance(5, 0),
            distance(5, 2),
            distance(3, 5),
            distance(4, 5),
        ];
        assert_eq!(of_copy, of_depot);
        assert_eq!((distance(1, 5), distance(0, 4)), (0.0, 7.0));
        let at = |i: usize| network.waypoints()[i].position;
        for i in 0..5 {
            assert!((at(i).coords.norm() - 6.5).abs() < 1e-12);
        }
        assert_eq!(at(1), at(5));
    }

    #[test]
    fn coordinates_beside_a_matrix_are_positions_only() {
        let plain = from_oplib(MATRIX, "t").unwrap();
        let rows = "1 0 0\n2 3 4\n3 0 10\n4 9 9\n5 1 1\nNODE_SCORE_SECTION";
        for section in ["NODE_COORD_SECTION", "DISPLAY_DATA_SECTION"] {
            let rows = format!("{section}\n{rows}");
            let drawn = from_oplib(&MATRIX.replace("NODE_SCORE_SECTION", &rows), "t").unwrap();
            assert_eq!(drawn.network.edges(), plain.network.edges());
            assert_eq!(drawn.network.waypoints()[3].position.x, 9.0);
        }
    }

    #[test]
    fn keywords_without_meaning_for_the_instance_change_nothing() {
        let plain = from_oplib(SMALL, "t").unwrap();
        for (old, new) in [
            ("EUC_2D\n", "EUC_2D\nEDGE_WEIGHT_FORMAT : FUNCTION \n"),
            ("TYPE : OP\n", "TYPE : OP\nTSPSOL : 25\n"),
            ("NODE_SCORE", "TSPSOL\n1 3 2\n4 -1\nNODE_SCORE"),
            ("NODE_SCORE", "DISPLAY_DATA_SECTION\n1 0 0\nNODE_SCORE"),
            ("NAME", "\u{feff}NAME"),
        ] {
            assert_eq!(
                from_oplib(&SMALL.replace(old, new), "t").unwrap(),
                plain,
                "{new}"
            );
        }
    }

    #[test]
    fn one_wrong_keyword_is_one_violation() {
        let formats = "give one of FULL_MATRIX";
        for (old, new, place, part) in [
            ("EXPLICIT", "MATRIX", "line 6", "`MATRIX`; EUC_2D, "),
            ("EXPLICIT", "GEO", "line 6", "give EXPLICIT, or remove"),
            ("LOWER_ROW", "FUNCTION", "line 7", formats),
            ("LOWER_ROW", "HALF_ROW", "line 7", formats),
            (
                "EDGE_WEIGHT_FORMAT : LOWER_ROW \n",
                "",
                "EDGE_WEIGHT_FORMAT",
                formats,
            ),
            (
                "LOWER_ROW",
                "LOWER_DIAG_ROW",
                "EDGE_WEIGHT_SECTION",
                "give 15",
            ),
            (
                "DIMENSION : 5",
                "DIMENSION : 4",
                "line 4",
                "list 5 nodes; give 5",
            ),
            (
                "DIMENSION : 5",
                "DIMENSION : 7",
                "line 4",
                "list 5 nodes; give 5",
            ),
            ("DIMENSION : 5", "DIMENSION : five", "line 4", "at least 1"),
            ("DIMENSION : 5\n", "", "DIMENSION", "is missing"),
            (
                "DIMENSION : 5",
                "DIMENSION : 10000",
                "line 4",
                "Network::MAX_NODES",
            ),
            (
                "DIMENSION : 5",
                "DIMENSION : 18446744073709551615",
                "line 4",
                "MAX_NODES",
            ),
            ("9 4 6 13", "9 4 -6 13", "line 9", "give 0 to 1e12"),
            ("9 4 6 13", "inf 4 6 13", "line 9", "give a finite number"),
            (
                "7 11 10 12",
                "7 11 10",
                "EDGE_WEIGHT_SECTION",
                "has 9 numbers; give 10",
            ),
            (" 2\n -1", " 6\n -1", "line 19", "`6`; nodes are 1 to 5"),
            (" 2\n -1", "-1", "DEPOT_SECTION", "names no node"),
        ] {
            assert!(MATRIX.contains(old), "{old}");
            let said = messages(&MATRIX.replace(old, new));
            assert!(
                said[0].starts_with(place) && said[0].contains(part),
                "{said:?}"
            );
            assert_eq!(said.len(), 1, "{said:?}");
        }
    }

    #[test]
    fn a_missing_section_is_one_violation() {
        let without = "NODE_COORD_SECTION\n1 0 0\n2 3 4\n3 0 10\n4 9 9\n";
        let section = "NODE_COORD_SECTION is missing; add it";
        assert_eq!(messages(&SMALL.replace(without, "")), [section]);
        let wrong = SMALL.replace("DIMENSION : 4", "DIMENSION : 400");
        let dimension = "line 3 has DIMENSION `400`, but the sections list 4 nodes; give 4";
        assert_eq!(messages(&wrong), [dimension]);
        let format = SMALL.replace("NAME", "EDGE_WEIGHT_FORMAT : UPPER_ROW\nNAME");
        let message = "with EDGE_WEIGHT_TYPE EUC_2D give FUNCTION";
        let said = messages(&format);
        assert!(said.len() == 1 && said[0].contains(message), "{said:?}");
    }

    #[test]
    fn an_unknown_section_is_skipped_with_its_lines() {
        for (section, unknown, line) in [
            ("EDGE_WEIGHT_SECTION", "EDGE_SECTION", 8),
            ("NODE_SCORE_SECTION", "SCORES", 12),
            ("DEPOT_SECTION", "DEPOTS_SECTION : 1", 18),
        ] {
            let said = messages(&MATRIX.replace(section, unknown));
            let key = unknown.trim_end_matches(" : 1");
            let skipped = format!("line {line} has the unknown keyword `{key}`; remove it");
            assert_eq!(said.len(), 2, "{said:?}");
            assert_eq!(said[0], skipped);
            assert!(said[1].starts_with(section), "{said:?}");
        }
    }

    proptest! {
        #[test]
        fn never_panics_on_a_damaged_file(at in 0_usize..MATRIX.len(), byte in 9_u8..127) {
            for text in [SMALL, MATRIX, "n 3\nm 1\ntmax 20\n0 0 0\n3 4 10\n0;8.0;5\n"] {
                let mut bytes = text.as_bytes().to_vec();
                let at = at % bytes.len();
                bytes[at] = byte;
                let _ = crate::format::read(&bytes, "t");
                let _ = crate::format::read(&bytes[..at], "t");
            }
        }
    }
}
