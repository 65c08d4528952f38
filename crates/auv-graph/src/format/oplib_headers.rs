//! The headers of an OPLib file and its depot, and whether they fit its sections.

use super::node_scores::require_size;
use super::node_table::node_index;
use super::oplib_text::{OplibText, TextLine};
use super::text::{finite_number, shortened};
use super::tsplib_distance::{self, Distance};
use super::weight_matrix::{MatrixLayout, words};
use auv_types::Violations;

/// What `EDGE_WEIGHT_TYPE` and `EDGE_WEIGHT_FORMAT` ask for.
#[derive(Clone, Copy, Debug)]
pub(super) enum WeightSource {
    Formula(Distance),
    Matrix(MatrixLayout),
}

pub(super) fn check_type(file: &OplibText<'_>, violations: &mut Violations) {
    if let Some(kind) = file.kind {
        violations.require(kind.content == "OP", &kind.place(), || {
            format!("has TYPE `{}`; only OP is read", shortened(kind.content))
        });
    }
}

pub(super) fn cost_limit(file: &OplibText<'_>, violations: &mut Violations) -> Option<f64> {
    let header = required("COST_LIMIT", file.cost_limit, violations)?;
    finite_number(header.content, header.number, "COST_LIMIT", violations)
}

/// A header or its violation.
fn required<'a>(
    key: &str,
    header: Option<TextLine<'a>>,
    violations: &mut Violations,
) -> Option<TextLine<'a>> {
    violations.require(header.is_some(), key, || "is missing; add it".into());
    header
}

/// The number of nodes, checked before memory is allocated for it.
pub(super) fn dimension(file: &OplibText<'_>, violations: &mut Violations) -> Option<usize> {
    let header = required("DIMENSION", file.dimension, violations)?;
    let n = header.content.parse::<usize>().ok().filter(|&n| n > 0);
    violations.require(n.is_some(), &header.place(), || {
        let given = shortened(header.content);
        format!("has DIMENSION `{given}`; give the number of nodes, at least 1")
    });
    n.filter(|n| require_size(n.saturating_add(1), &header.place(), violations))
}

/// Whether the sections can be read with `DIMENSION`. If at least two sections agree on another number
/// of nodes and none on this one, `DIMENSION` is the one violation, in place of one for each line.
pub(super) fn dimension_agrees(
    file: &OplibText<'_>,
    source: Option<WeightSource>,
    n: usize,
    violations: &mut Violations,
) -> bool {
    let sections = [&file.coordinates, &file.display, &file.scores];
    let rows: Vec<_> = sections.into_iter().flatten().map(Vec::len).collect();
    let Some(&others) = rows.first() else {
        return true;
    };
    let fits_matrix = match (source, &file.weights) {
        (Some(WeightSource::Matrix(layout)), Some(lines)) => {
            Some(words(lines).count() == layout.count(others))
        }
        _ => None,
    };
    let witnesses = rows.len() + usize::from(fits_matrix == Some(true));
    let all_others = rows.iter().all(|&row| row == others) && fits_matrix != Some(false);
    if others == n || others == 0 || witnesses < 2 || !all_others {
        return true;
    }
    let place = file.dimension.map_or_else(String::new, |line| line.place());
    let message =
        format!("has DIMENSION `{n}`, but the sections list {others} nodes; give {others}");
    violations.push(place, message);
    false
}

pub(super) fn weight_source(
    file: &OplibText<'_>,
    violations: &mut Violations,
) -> Option<WeightSource> {
    let header = required("EDGE_WEIGHT_TYPE", file.weight_type, violations)?;
    if header.content == "EXPLICIT" {
        return explicit_layout(file, violations).map(WeightSource::Matrix);
    }
    let Some(distance) = tsplib_distance::named(header.content) else {
        let given = shortened(header.content);
        violations.push(
            header.place(),
            format!(
                "has EDGE_WEIGHT_TYPE `{given}`; EUC_2D, CEIL_2D, ATT, GEO and EXPLICIT are read"
            ),
        );
        return None;
    };
    let given = shortened(header.content);
    if file.weights.is_some() {
        let remedy = "give EXPLICIT, or remove that section";
        let message =
            format!("has EDGE_WEIGHT_TYPE `{given}` beside EDGE_WEIGHT_SECTION; {remedy}");
        violations.push(header.place(), message);
        return None;
    }
    if let Some(format) = file.weight_format {
        violations.require(format.content == "FUNCTION", &format.place(), || {
            let format = shortened(format.content);
            format!(
                "has EDGE_WEIGHT_FORMAT `{format}`; with EDGE_WEIGHT_TYPE {given} give FUNCTION"
            )
        });
    }
    Some(WeightSource::Formula(distance))
}

/// The layout of the matrix of an `EXPLICIT` file.
fn explicit_layout(file: &OplibText<'_>, violations: &mut Violations) -> Option<MatrixLayout> {
    violations.require(file.weights.is_some(), "EDGE_WEIGHT_SECTION", || {
        "is missing; EDGE_WEIGHT_TYPE EXPLICIT needs it".into()
    });
    let formats = MatrixLayout::FORMATS;
    let Some(format) = file.weight_format else {
        violations.push(
            "EDGE_WEIGHT_FORMAT",
            format!("is missing; give one of {formats}"),
        );
        return None;
    };
    let layout = MatrixLayout::named(format.content);
    violations.require(layout.is_some(), &format.place(), || {
        let given = shortened(format.content);
        format!("has EDGE_WEIGHT_FORMAT `{given}`; with EXPLICIT give one of {formats}")
    });
    layout
}

/// The line and the word of the one depot.
pub(super) fn depot<'a>(
    file: &OplibText<'a>,
    violations: &mut Violations,
) -> Option<(TextLine<'a>, &'a str)> {
    violations.require(file.depot.is_some(), "DEPOT_SECTION", || {
        "is missing; add it".into()
    });
    let lines = file.depot.as_deref()?;
    let mut named = words(lines).filter(|&(_, word)| word != "-1");
    let first = named.next();
    violations.require(first.is_some(), "DEPOT_SECTION", || {
        "names no node; give one".into()
    });
    for (line, _) in named {
        let message = "names a second depot; only one is planned for";
        violations.push(line.place(), message);
    }
    first.map(|(line, word)| (*line, word))
}

pub(super) fn known_depot(
    (line, word): (TextLine<'_>, &str),
    n: usize,
    violations: &mut Violations,
) -> Option<usize> {
    let node = node_index(word, n);
    violations.require(node.is_some(), &line.place(), || {
        format!("names node `{}`; nodes are 1 to {n}", shortened(word))
    });
    node
}
