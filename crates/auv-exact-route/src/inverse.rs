//! The inverse of a basis, as a dense matrix.

use crate::dense::{Entry, add_and_measure, add_multiple, product, squared_length};

/// One row for each position of the basis, one column for each row of the program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inverse {
    rows: Vec<Vec<f64>>,
    /// The squared lengths of the rows.
    length: Vec<f64>,
}

impl Inverse {
    pub(crate) fn row(&self, position: usize) -> &[f64] {
        &self.rows[position]
    }

    pub(crate) fn lengths(&self) -> &[f64] {
        &self.length
    }

    /// Adds a row of the program whose slack enters the basis. `basic` has the entries of the new row for
    /// basic variables, by position.
    pub(crate) fn grow(&mut self, basic: &[(usize, f64)]) {
        let mut row = vec![0.0; self.rows.len() + 1];
        for of_position in &mut self.rows {
            of_position.push(0.0);
        }
        for &(position, entry) in basic {
            add_multiple(&mut row, &self.rows[position], -entry);
        }
        if let Some(last) = row.last_mut() {
            *last = 1.0;
        }
        self.length.push(squared_length(&row));
        self.rows.push(row);
    }

    /// Keeps some positions and rows of the program. The others must belong to each other: slacks.
    pub(crate) fn keep(&mut self, positions: &[usize], rows: &[usize]) {
        let kept = |row: &Vec<f64>| rows.iter().map(|&at| row[at]).collect();
        self.rows = positions.iter().map(|&at| kept(&self.rows[at])).collect();
        self.length = self.rows.iter().map(|row| squared_length(row)).collect();
    }

    /// The inverse times a column.
    pub(crate) fn solved(&self, column: &[Entry]) -> Vec<f64> {
        self.rows.iter().map(|row| product(column, row)).collect()
    }

    /// Replaces the variable at a position by one of which the inverse times the column is `direction`.
    pub(crate) fn exchange(&mut self, position: usize, direction: &[f64]) {
        let mut row = std::mem::take(&mut self.rows[position]);
        let scale = 1.0 / direction[position];
        row.iter_mut().for_each(|entry| *entry *= scale);
        let squared = squared_length(&row);
        for (i, &entry) in direction.iter().enumerate() {
            if i != position && entry.abs() > 1e-13 {
                self.length[i] = add_and_measure(&mut self.rows[i], &row, -entry);
            }
        }
        self.length[position] = squared;
        self.rows[position] = row;
    }

    /// The inverse of the basis of all slacks.
    pub(crate) fn reset(&mut self) {
        for (at, row) in self.rows.iter_mut().enumerate() {
            row.fill(0.0);
            row[at] = 1.0;
        }
        self.length.fill(1.0);
    }
}
