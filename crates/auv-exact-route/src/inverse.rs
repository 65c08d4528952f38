//! The inverse of a basis, as a dense matrix.

use crate::dense::{Entry, add_multiple, add_multiple_and_measure, product, vectorized};

/// Columns are padded to a multiple of this, so that a new row of the program rarely moves them.
const ROOM: usize = 64;

/// One row for each position of the basis, one column for each row of the program. It lies in memory column by
/// column: what is sparse, a column of the program or a row of the inverse, then picks whole columns.
#[derive(Clone, Debug, Default)]
pub(crate) struct Inverse {
    size: usize,
    /// From one column to the next.
    stride: usize,
    /// Zero beyond `size` in each column.
    entries: Vec<f64>,
    /// The squared lengths of the rows, padded like a column. They guide the choice of pivots: rounding errors
    /// in them do no harm.
    length: Vec<f64>,
}

impl Inverse {
    fn column(&self, at: usize) -> &[f64] {
        &self.entries[at * self.stride..][..self.stride]
    }

    fn columns(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.size).map(|at| self.column(at))
    }

    pub(crate) fn row(&self, position: usize) -> Vec<f64> {
        self.columns().map(|column| column[position]).collect()
    }

    pub(crate) fn lengths(&self) -> &[f64] {
        &self.length[..self.size]
    }

    /// Adds a row of the program whose slack enters the basis. `basic` has the entries of the new row for
    /// basic variables, by position.
    pub(crate) fn grow(&mut self, basic: &[Entry]) {
        let mut row: Vec<f64> = self
            .columns()
            .map(|column| -product(basic, column))
            .collect();
        row.push(1.0);
        let position = self.size;
        if position == self.stride {
            self.widen();
        }
        self.size += 1;
        self.entries.resize(self.size * self.stride, 0.0);
        for (at, &entry) in row.iter().enumerate() {
            self.entries[at * self.stride + position] = entry;
        }
        self.length[position] = row.iter().map(|entry| entry * entry).sum();
    }

    /// Makes room for more rows.
    fn widen(&mut self) {
        let stride = self.stride + ROOM;
        let mut entries = Vec::with_capacity((self.size + ROOM) * stride);
        for column in self.columns() {
            entries.extend_from_slice(column);
            entries.resize(entries.len() + ROOM, 0.0);
        }
        (self.stride, self.entries) = (stride, entries);
        self.length.resize(stride, 0.0);
    }

    /// Keeps some positions and rows of the program. The others must belong to each other: slacks.
    pub(crate) fn keep(&mut self, positions: &[usize], rows: &[usize]) {
        let stride = positions.len().next_multiple_of(ROOM);
        let mut entries = Vec::with_capacity((rows.len() + ROOM) * stride);
        for &row in rows {
            let column = self.column(row);
            entries.extend(positions.iter().map(|&at| column[at]));
            entries.resize(entries.len() + stride - positions.len(), 0.0);
        }
        let mut length: Vec<_> = positions.iter().map(|&at| self.length[at]).collect();
        length.resize(stride, 0.0);
        (self.size, self.stride) = (rows.len(), stride);
        (self.entries, self.length) = (entries, length);
    }

    /// The inverse times a column.
    pub(crate) fn solved(&self, column: &[Entry]) -> Vec<f64> {
        let mut sum = vec![0.0; self.stride];
        vectorized(
            #[inline(always)]
            || {
                for &(at, entry) in column {
                    add_multiple(&mut sum, self.column(at as usize), entry);
                }
            },
        );
        sum.truncate(self.size);
        sum
    }

    /// A row, with an entry for each position, times the inverse.
    pub(crate) fn applied(&self, row: &[Entry]) -> Vec<f64> {
        self.columns().map(|column| product(row, column)).collect()
    }

    /// Replaces the variable at a position by one of which the inverse times the column is `direction`.
    pub(crate) fn exchange(&mut self, position: usize, direction: &[f64]) {
        let mut change: Vec<_> = direction.iter().map(|entry| -entry).collect();
        change[position] = 1.0 - direction[position];
        change.resize(self.stride, 0.0);
        let scale = 1.0 / direction[position];
        let columns = self.entries.chunks_exact_mut(self.stride);
        let length = &mut self.length;
        vectorized(
            #[inline(always)]
            || {
                for column in columns {
                    let entry = scale * column[position];
                    if entry != 0.0 {
                        add_multiple_and_measure(column, &change, entry, length);
                    }
                }
            },
        );
        let row = self.row(position);
        self.length[position] = row.iter().map(|entry| entry * entry).sum();
    }

    /// Computes the lengths again.
    pub(crate) fn measure(&mut self) {
        self.length.fill(0.0);
        for column in self.entries.chunks_exact(self.stride.max(1)) {
            for (length, entry) in self.length.iter_mut().zip(column) {
                *length += entry * entry;
            }
        }
    }

    /// The inverse of the basis of all slacks.
    pub(crate) fn reset(&mut self) {
        self.entries.fill(0.0);
        for at in 0..self.size {
            self.entries[at * self.stride + at] = 1.0;
        }
        self.length[..self.size].fill(1.0);
    }
}
