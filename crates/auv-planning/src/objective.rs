//! What a route planner minimises: the default objective and the paper's (equations 19 to 21).

use auv_graph::RouteTotals;
use auv_types::Violations;
use std::cmp::Ordering;

/// What a route planner minimises among feasible routes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Objective {
    /// The most weight, ties broken by less time: the cost is minus the weight.
    #[default]
    MostWeight,
    /// The paper's cost of a route.
    RouteCost(RouteCost),
}

impl Objective {
    /// The paper's objective with the factors of [`RouteCost::paper`].
    #[must_use]
    pub const fn paper() -> Self {
        Self::RouteCost(RouteCost::paper())
    }

    /// The cost of a route with these totals; finite, dimensionless.
    #[must_use]
    pub fn cost(&self, totals: &RouteTotals, time_available_s: f64) -> f64 {
        match self {
            Self::MostWeight => -totals.weight,
            Self::RouteCost(cost) => cost.total(totals, time_available_s, 0.0),
        }
    }

    /// Deb's order of two routes: less excess over the time available first, then less cost, then
    /// less time.
    #[must_use]
    pub fn order(&self, a: &RouteTotals, b: &RouteTotals, time_available_s: f64) -> Ordering {
        let excess_s = |totals: &RouteTotals| (totals.time_s - time_available_s).max(0.0);
        let cost = |totals| self.cost(totals, time_available_s);
        excess_s(a)
            .total_cmp(&excess_s(b))
            .then_with(|| cost(a).total_cmp(&cost(b)))
            .then(a.time_s.total_cmp(&b.time_s))
    }

    /// All errors in the objective's factors.
    #[must_use]
    pub fn validate(&self) -> Violations {
        match self {
            Self::MostWeight => Violations::new(),
            Self::RouteCost(cost) => cost.validate(),
        }
    }
}

/// How the tasks of a route enter its cost (Eq. 20).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum TaskCost {
    /// `1 / W_R`: falls when a task is added, as Eq. 9 asks.
    #[default]
    InverseWeight,
    /// `sum xi / rho` as Eq. 20 prints it; falls when a task is dropped, against Eq. 9.
    SumInverse,
    /// `sum xi / sum rho`, as the subscripts of Eq. 20 suggest.
    RatioOfSums,
}

/// The cost of a route, equations 19 to 21:
/// `phi1 Cost_task + phi2 |T_route - T_avail| / T_avail + lambda max(0, T_route / T_avail - 1) + c T_compute`.
///
/// The paper gives no factors; those of [`RouteCost::paper`] are fitted to its Table 1. Transits
/// (priority 0) carry no task and enter the time alone.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RouteCost {
    /// How the tasks enter.
    pub task: TaskCost,
    /// `phi1`, the factor of the tasks' cost.
    pub task_factor: f64,
    /// `phi2`, the factor of the time unused or exceeded, as a share of the time available.
    pub time_factor: f64,
    /// `lambda`, the factor of the excess over the time available.
    pub lateness_factor: f64,
    /// Cost per second of computing (Eq. 21 adds seconds to pure numbers). Planners charge none;
    /// callers who do give the seconds to [`RouteCost::total`].
    pub compute_factor: f64,
}

impl RouteCost {
    /// The cost of a route without any task where `1 / W_R` and ratios have no value.
    pub const WITHOUT_TASKS: f64 = 1e6;

    /// `phi1 = 1`, `phi2 = 0.3`, `lambda = 10`, computing not charged. Least squares over the three
    /// rows of Table 1 that keep their time gives `phi1 = 0.94`, `phi2 = 0.29`.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            task: TaskCost::InverseWeight,
            task_factor: 1.0,
            time_factor: 0.3,
            lateness_factor: 10.0,
            compute_factor: 0.0,
        }
    }

    /// The part of the tasks (Eq. 20).
    #[must_use]
    pub fn of_tasks(&self, totals: &RouteTotals) -> f64 {
        let ratio = match self.task {
            TaskCost::InverseWeight => 1.0 / totals.weight,
            TaskCost::SumInverse => totals.risk_per_priority,
            TaskCost::RatioOfSums => totals.risk / totals.priority,
        };
        if ratio.is_nan() {
            Self::WITHOUT_TASKS
        } else {
            ratio.min(Self::WITHOUT_TASKS)
        }
    }

    /// The part of the time (Eq. 19): `|T_route - T_avail| / T_avail`; 0 where time is unlimited, in
    /// seconds where none is available.
    #[must_use]
    pub fn of_time(&self, time_s: f64, time_available_s: f64) -> f64 {
        share((time_s - time_available_s).abs(), time_available_s)
    }

    /// The whole cost (Eq. 21), `compute_s` seconds of computing included.
    #[must_use]
    pub fn total(&self, totals: &RouteTotals, time_available_s: f64, compute_s: f64) -> f64 {
        let excess_s = (totals.time_s - time_available_s).max(0.0);
        self.task_factor * self.of_tasks(totals)
            + self.time_factor * self.of_time(totals.time_s, time_available_s)
            + self.lateness_factor * share(excess_s, time_available_s)
            + self.compute_factor * compute_s
    }

    /// All errors in the factors.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        for (factor, place) in [
            (self.task_factor, "task_factor"),
            (self.time_factor, "time_factor"),
            (self.lateness_factor, "lateness_factor"),
            (self.compute_factor, "compute_factor"),
        ] {
            violations.require_not_negative(factor, place);
        }
        violations
    }
}

impl Default for RouteCost {
    fn default() -> Self {
        Self::paper()
    }
}

/// A time as a share of the time available.
fn share(time_s: f64, time_available_s: f64) -> f64 {
    if time_available_s.is_infinite() {
        0.0
    } else if time_available_s > 0.0 {
        time_s / time_available_s
    } else {
        time_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn totals(weight: f64, time_s: f64) -> RouteTotals {
        RouteTotals {
            weight,
            time_s,
            ..RouteTotals::default()
        }
    }

    #[test]
    fn costs_of_table_1_come_out_within_a_tenth() {
        // GA50, GA100 and ICA50 of Table 1: weight, T_route and cost.
        for (weight, time_s, cost) in [
            (54.0, 23_981.0, 0.034),
            (57.0, 23_875.0, 0.029),
            (45.0, 22_218.0, 0.056),
        ] {
            let ours = Objective::paper().cost(&totals(weight, time_s), 25_200.0);
            assert!((ours - cost).abs() < 0.1 * cost + 0.002, "{ours} {cost}");
        }
    }

    #[test]
    fn dropping_a_task_pays_only_under_the_printed_sum() {
        let two = RouteTotals {
            weight: 5.0,
            priority: 11.0,
            risk: 4.0,
            risk_per_priority: 0.8,
            ..RouteTotals::default()
        };
        let one = RouteTotals {
            weight: 3.0,
            priority: 6.0,
            risk: 2.0,
            risk_per_priority: 1.0 / 3.0,
            ..RouteTotals::default()
        };
        let cost = |task, totals| {
            RouteCost {
                task,
                ..RouteCost::paper()
            }
            .of_tasks(totals)
        };
        assert!(cost(TaskCost::InverseWeight, &two) < cost(TaskCost::InverseWeight, &one));
        assert!(cost(TaskCost::SumInverse, &two) > cost(TaskCost::SumInverse, &one));
        assert_eq!(cost(TaskCost::RatioOfSums, &two), 4.0 / 11.0);
    }

    #[test]
    fn the_cost_is_always_finite() {
        for task in [
            TaskCost::InverseWeight,
            TaskCost::SumInverse,
            TaskCost::RatioOfSums,
        ] {
            let objective = Objective::RouteCost(RouteCost {
                task,
                ..RouteCost::paper()
            });
            for available_s in [0.0, -5.0, 1.0, f64::INFINITY] {
                assert!(objective.cost(&totals(0.0, 10.0), available_s).is_finite());
            }
        }
    }

    #[test]
    fn lateness_comes_first_then_cost_then_time() {
        let order = |a, b| Objective::MostWeight.order(&a, &b, 100.0);
        assert!(order(totals(1.0, 100.0), totals(9.0, 100.5)).is_lt());
        assert!(order(totals(2.0, 90.0), totals(1.0, 10.0)).is_lt());
        assert!(order(totals(2.0, 80.0), totals(2.0, 90.0)).is_lt());
    }
}
