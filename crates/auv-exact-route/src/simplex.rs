//! The dual simplex method with a bound flipping ratio test (Koberstein, Progress in the dual simplex
//! method, 2005). Stopped at any time, its multipliers give a bound.

use crate::dense::{add_multiple, product};
use crate::program::{Program, Standing, Variable, VariableId};

/// Why a solution ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Solution {
    Optimal,
    /// The row of the basis at this position has no feasible point: its variable stays below (sign 1)
    /// or above (-1) its bounds.
    Infeasible {
        position: usize,
        sign: f64,
    },
    /// The caller had no time left, or rounding errors prevented an end.
    Stopped,
}

/// Values within this of their bounds are feasible.
const TOLERANCE: f64 = 1e-7;
/// Entries below this are never divided by.
const LEAST_PIVOT: f64 = 1e-7;
/// Squared lengths of rows of the inverse below this are rounding errors.
const LEAST_LENGTH: f64 = 1e-9;
/// The inverse is computed again after so many changes.
const MOST_CHANGES: usize = 400;

/// The result of a pivot.
enum Pivot {
    Done,
    /// No point is feasible; the sign is that of [`Solution::Infeasible`].
    NoEntering {
        sign: f64,
    },
    Inaccurate,
}

impl Program {
    /// Improves the basis until it is optimal. `may_pivot` is asked before every pivot.
    pub(crate) fn solve(&mut self, mut may_pivot: impl FnMut() -> bool) -> Solution {
        let mut row = Vec::new();
        let mut is_fresh = false;
        loop {
            let Some(position) = self.leaving() else {
                return Solution::Optimal;
            };
            if !may_pivot() {
                return Solution::Stopped;
            }
            match self.pivot(position, &mut row) {
                Pivot::Done => is_fresh = false,
                Pivot::NoEntering { sign } => return Solution::Infeasible { position, sign },
                Pivot::Inaccurate => {
                    if is_fresh || !self.invert() {
                        return Solution::Stopped;
                    }
                    is_fresh = true;
                }
            }
            if self.changes >= MOST_CHANGES && !self.invert() {
                return Solution::Stopped;
            }
        }
    }

    /// The position of the basic variable that is farthest outside its bounds, in the norm of dual
    /// steepest edges.
    fn leaving(&self) -> Option<usize> {
        let mut best = (0.0, None);
        for (position, (&value, &length)) in
            self.value.iter().zip(self.inverse.lengths()).enumerate()
        {
            let length = length.max(LEAST_LENGTH);
            let variable = &self.variables[self.basis[position]];
            let outside = (variable.lower - value).max(value - variable.upper);
            if outside > TOLERANCE && outside * outside > best.0 * length {
                best = (outside * outside / length, Some(position));
            }
        }
        best.1
    }

    /// Replaces the basic variable at a position. `row` is room for the entries of its row.
    fn pivot(&mut self, position: usize, row: &mut Vec<f64>) -> Pivot {
        let leaving = self.basis[position];
        let Variable { lower, upper, .. } = self.variables[leaving];
        let is_below = self.value[position] < lower;
        let (sign, target) = if is_below {
            (1.0, lower)
        } else {
            (-1.0, upper)
        };
        let outside = sign * (target - self.value[position]);
        self.fill_row(position, row);
        let Some((entering, flipped)) = self.entering(row, sign, outside) else {
            return Pivot::NoEntering { sign };
        };
        let direction = self.inverse.solved(&self.columns[entering]);
        let (pivot, in_row) = (direction[position], row[entering]);
        if (pivot - in_row).abs() > 1e-6 * (1.0 + in_row.abs()) || pivot.abs() < LEAST_PIVOT {
            return Pivot::Inaccurate;
        }
        self.flip(&flipped);
        let step = (self.value[position] - target) / pivot;
        add_multiple(&mut self.value, &direction, -step);
        let dual_step = self.variables[entering].reduced / in_row;
        for (variable, entry) in self.variables.iter_mut().zip(&*row) {
            if !variable.is_basic() {
                variable.reduced -= dual_step * entry;
            }
        }
        self.value[position] = self.value_of(entering) + step;
        self.variables[leaving].reduced = -dual_step;
        self.variables[leaving].standing = if is_below {
            Standing::Lower
        } else {
            Standing::Upper
        };
        self.exchange(position, entering, &direction);
        Pivot::Done
    }

    /// The entries of a position's row for all variables that may enter the basis.
    fn fill_row(&self, position: usize, row: &mut Vec<f64>) {
        let inverse = self.inverse.row(position);
        row.clear();
        row.extend(
            self.variables
                .iter()
                .zip(&*self.columns)
                .map(|(variable, column)| {
                    if variable.is_basic() || variable.is_idle() {
                        0.0
                    } else {
                        product(column, &inverse)
                    }
                }),
        );
    }

    /// The variable that enters, and those that move to their other bounds. `None` if no point is
    /// feasible.
    fn entering(
        &self,
        row: &[f64],
        sign: f64,
        outside: f64,
    ) -> Option<(VariableId, Vec<VariableId>)> {
        let mut candidates = Vec::new();
        for (id, (variable, &entry)) in self.variables.iter().zip(row).enumerate() {
            let is_candidate = match variable.standing {
                Standing::Basic(_) => false,
                Standing::Lower => sign * entry < -LEAST_PIVOT,
                Standing::Upper => sign * entry > LEAST_PIVOT,
            };
            if is_candidate && variable.range() > 0.0 {
                candidates.push((variable.reduced.abs() / entry.abs(), entry.abs(), id));
            }
        }
        candidates.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.2.cmp(&b.2)));
        let mut left = outside;
        let passed = candidates.iter().position(|&(_, entry, id)| {
            left -= entry * self.variables[id].range();
            // All of them together may reach the bound but for a rounding error.
            left <= TOLERANCE
        })?;
        // Among about equal ratios, the largest entry is divided by.
        let ratio = candidates[passed].0;
        let first = candidates[..passed].partition_point(|c| c.0 < ratio - 1e-9);
        let equal = candidates[first..]
            .iter()
            .take_while(|c| c.0 <= ratio + 1e-9);
        let (best, chosen) = (first..)
            .zip(equal)
            .max_by(|a, b| a.1.1.total_cmp(&b.1.1).then(b.0.cmp(&a.0)))?;
        let flipped = candidates[..best.min(passed)].iter().map(|c| c.2);
        Some((chosen.2, flipped.collect()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Seed, rand::RngExt};

    /// The most that whole numbers of 0 and 1 earn, and whether some satisfy the rows.
    fn best_of_all(
        costs: &[f64],
        rows: &[(Vec<f64>, f64)],
        allowed: impl Fn(usize, bool) -> bool,
    ) -> f64 {
        let mut best = f64::NEG_INFINITY;
        for chosen in 0..1_usize << costs.len() {
            let is_in = |i: usize| chosen >> i & 1 == 1;
            let sum = |entries: &[f64]| {
                (0..entries.len())
                    .filter(|&i| is_in(i))
                    .map(|i| entries[i])
                    .sum::<f64>()
            };
            let holds = rows.iter().all(|(entries, right)| sum(entries) <= *right);
            if holds && (0..costs.len()).all(|i| allowed(i, is_in(i))) {
                best = best.max(sum(costs));
            }
        }
        best
    }

    /// The bound that multipliers of rows `a x <= right` prove over `0 <= x <= upper`.
    fn bound(
        program: &Program,
        costs: &[f64],
        rows: &[(Vec<f64>, f64)],
        fixed: Option<usize>,
    ) -> f64 {
        let multipliers: Vec<f64> = program.multipliers().iter().map(|m| m.max(0.0)).collect();
        let credit: f64 = multipliers
            .iter()
            .zip(rows)
            .map(|(m, (_, right))| m * right)
            .sum();
        let reduced = |i: usize| {
            let charged: f64 = multipliers
                .iter()
                .zip(rows)
                .map(|(m, (entries, _))| m * entries[i])
                .sum();
            (costs[i] - charged).max(0.0)
        };
        credit
            + (0..costs.len())
                .filter(|&i| Some(i) != fixed)
                .map(reduced)
                .sum::<f64>()
    }

    #[test]
    fn solutions_satisfy_the_rows_and_meet_their_bound_as_rows_columns_and_bounds_change() {
        for seed in 0..200 {
            let random = &mut Seed(seed).stream(1);
            let mut draw = |count: usize| {
                (0..count)
                    .map(|_| random.random_range(0.0..1.0))
                    .collect::<Vec<f64>>()
            };
            let (costs, first, second) = (draw(8), draw(8), draw(8));
            let mut program = Program::default();
            program.add_row(&[], 1.5, 1.5);
            let mut ids = Vec::new();
            for i in 0..5 {
                ids.push(program.add_variable(costs[i], vec![(0, first[i])]));
            }
            assert_eq!(program.solve(|| true), Solution::Optimal);
            let entries: Vec<_> = ids
                .iter()
                .zip(&second)
                .map(|(&id, &entry)| (id, entry))
                .collect();
            program.add_row(&entries, 0.9, 0.9);
            for i in 5..8 {
                ids.push(program.add_variable(costs[i], vec![(0, first[i]), (1, second[i])]));
            }
            let rows = [(first, 1.5), (second, 0.9)];
            assert_eq!(program.solve(|| true), Solution::Optimal);
            check(&program, &ids, &costs, &rows, None);
            program.set_bounds(ids[2], (0.0, 0.0));
            assert_eq!(program.solve(|| true), Solution::Optimal);
            check(&program, &ids, &costs, &rows, Some(2));
            assert!(program.invert());
            assert_eq!(program.solve(|| true), Solution::Optimal);
            check(&program, &ids, &costs, &rows, Some(2));
            program.set_bounds(ids[2], (0.0, 1.0));
            assert_eq!(program.solve(|| true), Solution::Optimal);
            check(&program, &ids, &costs, &rows, None);
        }
    }

    fn check(
        program: &Program,
        ids: &[VariableId],
        costs: &[f64],
        rows: &[(Vec<f64>, f64)],
        closed: Option<usize>,
    ) {
        let values: Vec<f64> = ids.iter().map(|&id| program.value_of(id)).collect();
        let dot = |a: &[f64]| a.iter().zip(&values).map(|(a, v)| a * v).sum::<f64>();
        for (entries, right) in rows {
            assert!(dot(entries) <= right + 1e-6);
        }
        assert!(values.iter().all(|v| (-1e-6..=1.0 + 1e-6).contains(v)));
        let bound = bound(program, costs, rows, closed);
        assert!((dot(costs) - bound).abs() < 1e-6, "{} {bound}", dot(costs));
        let whole = best_of_all(costs, rows, |i, is_in| !(is_in && closed == Some(i)));
        assert!(whole <= bound + 1e-9);
    }

    #[test]
    fn a_row_without_a_feasible_point_is_found_and_proven() {
        let mut program = Program::default();
        // x + y = 1, x + y <= 0.5.
        program.add_row(&[], 1.0, 0.0);
        program.add_row(&[], 0.5, 0.5);
        for _ in 0..2 {
            program.add_variable(1.0, vec![(0, 1.0), (1, 1.0)]);
        }
        let Solution::Infeasible { position, sign } = program.solve(|| true) else {
            panic!("solved");
        };
        let bound = |by: f64| {
            let m = program.multipliers_along(position, by);
            m[0] + 0.5 * m[1].max(0.0) + 2.0 * (1.0 - m[0] - m[1]).max(0.0)
        };
        assert!(bound(1e3 * sign) < -100.0);
    }

    #[test]
    fn rows_that_are_not_tight_can_be_removed() {
        let mut program = Program::default();
        program.add_row(&[], 1.0, 1.0);
        program.add_row(&[], 9.0, 9.0);
        program.add_row(&[], 0.5, 0.5);
        let a = program.add_variable(1.0, vec![(0, 1.0), (1, 1.0), (2, 1.0)]);
        let b = program.add_variable(0.5, vec![(0, 1.0), (1, 1.0)]);
        assert_eq!(program.solve(|| true), Solution::Optimal);
        let before = (program.value_of(a), program.value_of(b));
        assert_eq!(before, (0.5, 0.5));
        assert!(program.has_basic_slack(1) && !program.has_basic_slack(2));
        let ids = program.remove_rows(&[true, false, true]);
        let [a, b] = [a, b].map(|id| ids[id].unwrap());
        assert_eq!((program.value_of(a), program.value_of(b)), before);
        program.add_row(&[(b, 1.0)], 0.25, 0.25);
        assert_eq!(program.solve(|| true), Solution::Optimal);
        assert_eq!((program.value_of(a), program.value_of(b)), (0.5, 0.25));
        assert_eq!(program.num_rows(), 3);
    }
}
