//! A linear program with a basis. Rows and columns are added, and bounds changed, between solutions.
//!
//! Every variable has finite bounds, the slacks of rows too. So the basis is always dual feasible: a
//! variable at the wrong one of its bounds is moved to the other.

use crate::dense::{Entry, add_multiple, product};
use crate::inverse::Inverse;
use std::rc::Rc;

/// A variable by its index.
pub(crate) type VariableId = usize;

/// Where a variable stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Standing {
    /// In the basis, at this position.
    Basic(usize),
    /// At its lower bound.
    Lower,
    /// At its upper bound.
    Upper,
}

#[derive(Clone, Debug)]
pub(crate) struct Variable {
    cost: f64,
    pub(crate) lower: f64,
    pub(crate) upper: f64,
    /// Cost less the value of the column at the multipliers.
    pub(crate) reduced: f64,
    pub(crate) standing: Standing,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Its column is a unit: its reduced cost is minus the multiplier of its row.
    Slack,
    Structural,
}

impl Variable {
    pub(crate) fn range(&self) -> f64 {
        self.upper - self.lower
    }

    pub(crate) fn is_basic(&self) -> bool {
        matches!(self.standing, Standing::Basic(_))
    }

    /// Whether it neither enters the basis nor stands for a row: its reduced cost is not kept up.
    pub(crate) fn is_idle(&self) -> bool {
        self.range() == 0.0 && self.kind == Kind::Structural
    }
}

/// Maximises the cost under rows `a x + slack = right side`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Program {
    pub(crate) variables: Vec<Variable>,
    /// By variable. Shared with copies, which rarely change it.
    pub(crate) columns: Rc<Vec<Vec<Entry>>>,
    right: Vec<f64>,
    slack_of: Vec<VariableId>,
    /// The basic variables by position.
    pub(crate) basis: Vec<VariableId>,
    /// The values of the basic variables by position.
    pub(crate) value: Vec<f64>,
    pub(crate) inverse: Inverse,
    /// Changes of the basis since the inverse was computed.
    pub(crate) changes: usize,
}

impl Program {
    pub(crate) fn num_rows(&self) -> usize {
        self.right.len()
    }

    /// Adds the row `right - slack <= entries . x <= right`. Its slack variable enters the basis.
    pub(crate) fn add_row(&mut self, entries: &[(VariableId, f64)], right: f64, slack: f64) {
        let row = self.num_rows();
        let mut value = right;
        let mut basic = Vec::new();
        let columns = Rc::make_mut(&mut self.columns);
        columns.push(vec![(row as u32, 1.0)]);
        for &(id, entry) in entries {
            columns[id].push((row as u32, entry));
        }
        for &(id, entry) in entries {
            value -= entry * self.value_of(id);
            if let Standing::Basic(position) = self.variables[id].standing {
                basic.push((position as u32, entry));
            }
        }
        self.inverse.grow(&basic);
        self.value.push(value);
        self.right.push(right);
        self.slack_of.push(self.variables.len());
        self.basis.push(self.variables.len());
        self.variables.push(Variable {
            cost: 0.0,
            lower: 0.0,
            upper: slack,
            reduced: 0.0,
            standing: Standing::Basic(row),
            kind: Kind::Slack,
        });
    }

    /// Adds a variable between 0 and 1 that is not in the basis.
    pub(crate) fn add_variable(&mut self, cost: f64, column: Vec<Entry>) -> VariableId {
        let id = self.variables.len();
        Rc::make_mut(&mut self.columns).push(column);
        self.variables.push(Variable {
            cost,
            lower: 0.0,
            upper: 1.0,
            reduced: 0.0,
            standing: Standing::Lower,
            kind: Kind::Structural,
        });
        self.settle(id);
        id
    }

    /// Changes the bounds of a variable.
    pub(crate) fn set_bounds(&mut self, id: VariableId, (lower, upper): (f64, f64)) {
        let variable = &mut self.variables[id];
        let (more, less) = (upper - variable.upper, lower - variable.lower);
        (variable.lower, variable.upper) = (lower, upper);
        let by = match variable.standing {
            Standing::Basic(_) => return,
            Standing::Lower => less,
            Standing::Upper => more,
        };
        if by != 0.0 {
            self.shift(&[(id, by)]);
        }
        self.settle(id);
    }

    /// Changes the largest slack of a row.
    pub(crate) fn set_slack(&mut self, row: usize, slack: f64) {
        self.set_bounds(self.slack_of[row], (0.0, slack));
    }

    /// Computes the reduced cost of a variable outside the basis, which moves to its other bound if that is
    /// the right one.
    fn settle(&mut self, id: VariableId) {
        let variable = &self.variables[id];
        if variable.kind == Kind::Structural {
            let price =
                |&(row, entry): &Entry| entry * self.variables[self.slack_of[row as usize]].reduced;
            self.variables[id].reduced =
                variable.cost + self.columns[id].iter().map(price).sum::<f64>();
        }
        let variable = &self.variables[id];
        let is_wrong = match variable.standing {
            Standing::Basic(_) => false,
            Standing::Lower => variable.reduced > 0.0,
            Standing::Upper => variable.reduced < 0.0,
        };
        if is_wrong {
            self.flip(&[id]);
        }
    }

    /// The multiplier of each row: what a unit of its right side is worth.
    pub(crate) fn multipliers(&self) -> Vec<f64> {
        let of_row = |&slack: &VariableId| -self.variables[slack].reduced;
        self.slack_of.iter().map(of_row).collect()
    }

    /// The multipliers moved along the row of a position: where that has no feasible point, the bound
    /// they give falls without end as `by` grows.
    pub(crate) fn multipliers_along(&self, position: usize, by: f64) -> Vec<f64> {
        let mut multipliers = self.multipliers();
        add_multiple(&mut multipliers, &self.inverse.row(position), by);
        multipliers
    }

    /// The cost of the present point, which bounds that of every feasible one.
    pub(crate) fn objective(&self) -> f64 {
        let cost = |id: VariableId| self.variables[id].cost * self.value_of(id);
        (0..self.variables.len()).map(cost).sum()
    }

    pub(crate) fn value_of(&self, id: VariableId) -> f64 {
        let variable = &self.variables[id];
        match variable.standing {
            Standing::Basic(position) => self.value[position],
            Standing::Lower => variable.lower,
            Standing::Upper => variable.upper,
        }
    }

    /// Whether the slack of a row is in the basis.
    pub(crate) fn has_basic_slack(&self, row: usize) -> bool {
        self.variables[self.slack_of[row]].is_basic()
    }

    /// Moves variables that are not in the basis to their other bounds.
    pub(crate) fn flip(&mut self, ids: &[VariableId]) {
        let mut moves = Vec::with_capacity(ids.len());
        for &id in ids {
            let variable = &mut self.variables[id];
            let (standing, by) = match variable.standing {
                Standing::Basic(_) => continue,
                Standing::Lower => (Standing::Upper, variable.range()),
                Standing::Upper => (Standing::Lower, -variable.range()),
            };
            variable.standing = standing;
            moves.push((id, by));
        }
        self.shift(&moves);
    }

    /// Changes the values of the basic variables as others move.
    fn shift(&mut self, moves: &[(VariableId, f64)]) {
        let mut sum = vec![0.0; self.num_rows()];
        for &(id, by) in moves {
            for &(row, entry) in &self.columns[id] {
                sum[row as usize] += by * entry;
            }
        }
        let moved: Vec<_> = (0_u32..).zip(sum).filter(|&(_, by)| by != 0.0).collect();
        if !moved.is_empty() {
            let change = self.inverse.solved(&moved);
            add_multiple(&mut self.value, &change, -1.0);
        }
    }

    /// Puts a variable into the basis at a position, where the inverse times its column is `direction`.
    pub(crate) fn exchange(&mut self, position: usize, entering: VariableId, direction: &[f64]) {
        self.inverse.exchange(position, direction);
        self.basis[position] = entering;
        self.variables[entering].standing = Standing::Basic(position);
        self.variables[entering].reduced = 0.0;
        self.changes += 1;
    }

    /// The row of which a variable is the slack.
    fn row_of_slack(&self, id: VariableId) -> Option<usize> {
        let variable = &self.variables[id];
        let row = self.columns[id].first().map(|&(row, _)| row as usize);
        row.filter(|_| variable.kind == Kind::Slack)
    }

    /// Computes inverse, values and reduced costs again. Returns whether the basis has an inverse.
    pub(crate) fn invert(&mut self) -> bool {
        let rows = self.num_rows();
        let mut is_open = vec![true; rows];
        let mut others = Vec::new();
        for &id in &self.basis {
            match self.row_of_slack(id) {
                Some(row) => is_open[row] = false,
                None => others.push(id),
            }
        }
        others.sort_unstable();
        self.inverse.reset();
        self.basis.clone_from(&self.slack_of);
        for row in (0..rows).filter(|&row| !is_open[row]) {
            self.variables[self.slack_of[row]].standing = Standing::Basic(row);
        }
        for id in others {
            let direction = self.inverse.solved(&self.columns[id]);
            let open = (0..rows).filter(|&row| is_open[row]);
            let largest = open.max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs()));
            let Some(row) = largest.filter(|&row| direction[row].abs() > 1e-9) else {
                return false;
            };
            is_open[row] = false;
            self.exchange(row, id, &direction);
        }
        self.changes = 0;
        self.inverse.measure();
        self.compute_reduced();
        self.compute_values();
        true
    }

    fn compute_values(&mut self) {
        let mut right = self.right.clone();
        for (variable, column) in self.variables.iter().zip(&*self.columns) {
            let value = match variable.standing {
                Standing::Basic(_) => continue,
                Standing::Lower => variable.lower,
                Standing::Upper => variable.upper,
            };
            for &(row, entry) in column {
                right[row as usize] -= value * entry;
            }
        }
        let right: Vec<_> = (0_u32..).zip(right).collect();
        self.value = self.inverse.solved(&right);
    }

    /// Reduced costs from the inverse. A variable whose reduced cost has changed its sign moves to its
    /// other bound.
    fn compute_reduced(&mut self) {
        let costs = (0_u32..).zip(&self.basis);
        let costs: Vec<_> = costs
            .map(|(position, &id)| (position, self.variables[id].cost))
            .collect();
        let multipliers = self.inverse.applied(&costs);
        for (variable, column) in self.variables.iter_mut().zip(&*self.columns) {
            variable.reduced = match variable.standing {
                Standing::Basic(_) => 0.0,
                _ => variable.cost - product(column, &multipliers),
            };
            match variable.standing {
                Standing::Lower if variable.reduced > 1e-9 => variable.standing = Standing::Upper,
                Standing::Upper if variable.reduced < -1e-9 => variable.standing = Standing::Lower,
                _ => {}
            }
        }
    }

    /// Removes the variables that are held at one value, but for slacks and those in the basis. Variables get new
    /// ids: the result gives them by old id.
    pub(crate) fn remove_idle(&mut self) -> Vec<Option<VariableId>> {
        let mut kept = 0;
        let new_id: Vec<_> = self
            .variables
            .iter()
            .map(|variable| {
                let stays = variable.is_basic() || !variable.is_idle();
                kept += usize::from(stays);
                stays.then(|| kept - 1)
            })
            .collect();
        self.keep_variables(&new_id);
        for id in self.basis.iter_mut().chain(&mut self.slack_of) {
            *id = new_id[*id].unwrap_or(*id);
        }
        new_id
    }

    /// Keeps the variables that have new ids.
    fn keep_variables(&mut self, new_id: &[Option<VariableId>]) {
        let mut ids = new_id.iter();
        self.variables
            .retain(|_| ids.next().is_some_and(Option::is_some));
        let mut ids = new_id.iter();
        Rc::make_mut(&mut self.columns).retain(|_| ids.next().is_some_and(Option::is_some));
    }

    /// Removes rows whose slacks are in the basis, and with them the slacks. `keep` is by row.
    /// Variables get new ids: the result gives them by old id.
    pub(crate) fn remove_rows(&mut self, keep: &[bool]) -> Vec<Option<VariableId>> {
        let kept_rows: Vec<_> = (0..keep.len()).filter(|&row| keep[row]).collect();
        let is_kept = |&id: &VariableId| self.row_of_slack(id).is_none_or(|row| keep[row]);
        let positions: Vec<_> = (0..self.basis.len())
            .filter(|&p| is_kept(&self.basis[p]))
            .collect();
        let mut new_id = vec![None; self.variables.len()];
        let kept_ids = (0..self.variables.len()).filter(is_kept);
        kept_ids
            .enumerate()
            .for_each(|(new, id)| new_id[id] = Some(new));
        let mut new_row = vec![None; keep.len()];
        for (new, &row) in kept_rows.iter().enumerate() {
            new_row[row] = Some(new as u32);
        }
        self.keep_variables(&new_id);
        for column in Rc::make_mut(&mut self.columns) {
            let entries = column.iter();
            *column = entries
                .filter_map(|&(row, entry)| Some((new_row[row as usize]?, entry)))
                .collect();
        }
        self.basis = positions
            .iter()
            .filter_map(|&p| new_id[self.basis[p]])
            .collect();
        for (position, &id) in self.basis.iter().enumerate() {
            self.variables[id].standing = Standing::Basic(position);
        }
        self.inverse.keep(&positions, &kept_rows);
        self.value = positions.iter().map(|&p| self.value[p]).collect();
        self.right = kept_rows.iter().map(|&row| self.right[row]).collect();
        self.slack_of = kept_rows
            .iter()
            .filter_map(|&row| new_id[self.slack_of[row]])
            .collect();
        new_id
    }
}
