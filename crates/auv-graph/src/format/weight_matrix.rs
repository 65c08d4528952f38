//! TSPLIB's distances given as numbers: `EDGE_WEIGHT_TYPE: EXPLICIT`.

use super::oplib_text::TextLine;
use super::text::shortened;
use auv_types::Violations;

/// The part of a symmetric matrix that a file lists, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MatrixLayout {
    Full,
    /// Above the diagonal.
    Upper,
    /// Below the diagonal.
    Lower,
    /// The diagonal and above.
    UpperDiagonal,
    /// The diagonal and below.
    LowerDiagonal,
}

impl MatrixLayout {
    /// The values of `EDGE_WEIGHT_FORMAT` that are read with `EXPLICIT`, for messages.
    pub(super) const FORMATS: &str =
        "FULL_MATRIX, UPPER_ROW, LOWER_ROW, UPPER_DIAG_ROW, LOWER_DIAG_ROW";

    /// The layout that `EDGE_WEIGHT_FORMAT` names. The columns of a symmetric matrix are its rows.
    pub(super) fn named(format: &str) -> Option<Self> {
        Some(match format {
            "FULL_MATRIX" => Self::Full,
            "UPPER_ROW" | "LOWER_COL" => Self::Upper,
            "LOWER_ROW" | "UPPER_COL" => Self::Lower,
            "UPPER_DIAG_ROW" | "LOWER_DIAG_COL" => Self::UpperDiagonal,
            "LOWER_DIAG_ROW" | "UPPER_DIAG_COL" => Self::LowerDiagonal,
            _ => return None,
        })
    }

    /// How many numbers the matrix of `n` nodes has.
    pub(super) fn count(self, n: usize) -> usize {
        match self {
            Self::Full => n * n,
            Self::Upper | Self::Lower => n * n.saturating_sub(1) / 2,
            Self::UpperDiagonal | Self::LowerDiagonal => n * (n + 1) / 2,
        }
    }

    /// Where the weight between nodes `i < j` of `n` is among the numbers.
    fn index(self, n: usize, i: usize, j: usize) -> usize {
        match self {
            Self::Full => i * n + j,
            Self::Upper => i * (2 * n - i - 1) / 2 + j - i - 1,
            Self::Lower => j * (j - 1) / 2 + i,
            Self::UpperDiagonal => i * (2 * n - i + 1) / 2 + j - i,
            Self::LowerDiagonal => j * (j + 1) / 2 + i,
        }
    }
}

/// A symmetric matrix of edge weights.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct WeightMatrix {
    layout: MatrixLayout,
    n: usize,
    numbers: Vec<f64>,
}

impl WeightMatrix {
    /// Reads the numbers of `EDGE_WEIGHT_SECTION`, which may be broken into lines anywhere. The
    /// diagonal may hold any number.
    ///
    /// A matrix that cannot be used is one violation: the first word that is not a finite number, else
    /// a wrong count, else the first weight that is negative, above 1e12, or different on the way back.
    pub(super) fn read(
        lines: &[TextLine<'_>],
        layout: MatrixLayout,
        n: usize,
        violations: &mut Violations,
    ) -> Option<Self> {
        let mut numbers = Vec::with_capacity(words(lines).count());
        for (line, word) in words(lines) {
            let Some(number) = word.parse::<f64>().ok().filter(|x| x.is_finite()) else {
                let word = shortened(word);
                let message = format!("holds `{word}` as edge weight; give a finite number");
                violations.push(line.place(), message);
                return None;
            };
            numbers.push(number);
        }
        let (found, expected) = (numbers.len(), layout.count(n));
        if found != expected {
            violations.push(
                "EDGE_WEIGHT_SECTION",
                format!(
                    "has {found} numbers; give {expected}, as its EDGE_WEIGHT_FORMAT needs for \
                     DIMENSION {n}"
                ),
            );
            return None;
        }
        let matrix = Self { layout, n, numbers };
        if let Some((at, message)) = matrix.first_fault() {
            let place = words(lines).nth(at).map(|(line, _)| line.place());
            violations.push(place.unwrap_or_default(), message);
            return None;
        }
        Some(matrix)
    }

    /// The weight between two different nodes, by index from 0.
    pub(super) fn between(&self, i: usize, j: usize) -> f64 {
        self.numbers[self.layout.index(self.n, i.min(j), i.max(j))]
    }

    /// The greatest weight between two nodes; 0 if there is only one.
    pub(super) fn greatest(&self) -> f64 {
        let pairs = (0..self.n).flat_map(|j| (0..j).map(move |i| (i, j)));
        pairs.fold(0.0, |most, (i, j)| self.between(i, j).max(most))
    }

    /// The position of the first number that cannot be a weight, and what is wrong with it.
    fn first_fault(&self) -> Option<(usize, String)> {
        for i in 0..self.n {
            for j in i + 1..self.n {
                let (from, to) = (i + 1, j + 1);
                let there = self.layout.index(self.n, i, j);
                // Only a full matrix lists the way back on its own.
                let back = match self.layout {
                    MatrixLayout::Full => j * self.n + i,
                    _ => there,
                };
                let (weight, weight_back) = (self.numbers[there], self.numbers[back]);
                if let Some((at, wrong)) = [(there, weight), (back, weight_back)]
                    .into_iter()
                    .find(|(_, weight)| !(0.0..=1e12).contains(weight))
                {
                    let remedy = "give 0 to 1e12 between every two nodes";
                    let message = format!("has weight {wrong} of nodes {from} and {to}; {remedy}");
                    return Some((at, message));
                }
                if weight.total_cmp(&weight_back).is_ne() {
                    let message = format!(
                        "has weight {weight_back} from node {to} to node {from}, but from {from} to \
                         {to} it is {weight}; give a symmetric matrix"
                    );
                    return Some((back, message));
                }
            }
        }
        None
    }
}

/// Every word of the section, with its line.
pub(super) fn words<'a, 'b>(
    lines: &'b [TextLine<'a>],
) -> impl Iterator<Item = (&'b TextLine<'a>, &'a str)> {
    lines.iter().flat_map(|line| {
        line.content
            .split_whitespace()
            .map(move |word| (line, word))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str, layout: MatrixLayout, n: usize) -> Result<WeightMatrix, String> {
        let mut violations = Violations::new();
        let lines: Vec<_> = (1..)
            .zip(text.lines())
            .map(|(number, content)| TextLine { number, content })
            .collect();
        let matrix = WeightMatrix::read(&lines, layout, n, &mut violations);
        assert_eq!(violations.total(), usize::from(matrix.is_none()));
        matrix.ok_or_else(|| violations.to_string())
    }

    #[test]
    fn every_layout_gives_the_same_weights_wherever_lines_break() {
        let layouts = [
            ("FULL_MATRIX", "0 9 4 13 9 -1 6 5 4 6 7 8 13 5 8 0"),
            ("UPPER_ROW", "9 4 13 6 5 8"),
            ("LOWER_COL", "9 4 13 6 5 8"),
            ("LOWER_ROW", "9 4 6 13 5 8"),
            ("UPPER_COL", "9 4 6 13 5 8"),
            ("UPPER_DIAG_ROW", "0 9 4 13 0 6 5 0 8 0"),
            ("LOWER_DIAG_COL", "0 9 4 13 0 6 5 0 8 0"),
            ("LOWER_DIAG_ROW", "0 9 0 4 6 0 13 5 8 0"),
            ("UPPER_DIAG_COL", "0 9 0 4 6 0 13 5 8 0"),
        ];
        for (format, text) in layouts {
            let layout = MatrixLayout::named(format).unwrap();
            for text in [
                text.to_owned(),
                text.replace(' ', "\n"),
                text.replace(" 5 ", "\n5 "),
            ] {
                let matrix = read(&text, layout, 4).unwrap();
                let pairs = [(0, 1), (0, 2), (3, 0), (1, 2), (3, 1), (2, 3)];
                let weights = pairs.map(|(i, j)| matrix.between(i, j));
                assert_eq!(weights, [9.0, 4.0, 13.0, 6.0, 5.0, 8.0], "{format}");
                assert_eq!(matrix.greatest(), 13.0);
            }
        }
        assert_eq!(MatrixLayout::named("FUNCTION"), None);
    }

    #[test]
    fn an_unusable_matrix_is_one_violation_with_place_and_remedy() {
        use MatrixLayout::{Full, Lower, LowerDiagonal};
        let cases = [
            (
                "0 9 4\n9 0 6\n4 7 0",
                Full,
                "line 3 has weight 7 from node 3 to node 2, but from 2 to 3 it is 6; \
                 give a symmetric matrix",
            ),
            (
                "9\n4 -1",
                Lower,
                "line 2 has weight -1 of nodes 2 and 3; give 0 to 1e12 between every two nodes",
            ),
            (
                "0 9 4\n9 0 6\n4 -6 0",
                Full,
                "line 3 has weight -6 of nodes 2 and 3; give 0 to 1e12 between every two nodes",
            ),
            (
                "9\n4 2e12",
                Lower,
                "line 2 has weight 2000000000000 of nodes 2 and 3; \
                 give 0 to 1e12 between every two nodes",
            ),
            (
                "9 4\nNaN",
                Lower,
                "line 2 holds `NaN` as edge weight; give a finite number",
            ),
            (
                "9 x\ny",
                Lower,
                "line 1 holds `x` as edge weight; give a finite number",
            ),
            (
                "0 9 0 4 6",
                LowerDiagonal,
                "EDGE_WEIGHT_SECTION has 5 numbers; give 6, as its EDGE_WEIGHT_FORMAT needs for \
                 DIMENSION 3",
            ),
            (
                "9 4 6 1",
                Lower,
                "EDGE_WEIGHT_SECTION has 4 numbers; give 3, as its EDGE_WEIGHT_FORMAT needs for \
                 DIMENSION 3",
            ),
        ];
        for (text, layout, expected) in cases {
            assert_eq!(read(text, layout, 3).unwrap_err(), expected);
        }
    }
}
