//! What a route planner is asked.

use crate::Objective;
use auv_graph::{EdgeSet, Infeasible, Network, NodeId, Route, RouteTotals, TimeModel};
use auv_types::Violations;

/// A route from `start` to `destination` within the time available.
#[derive(Clone, Copy, Debug)]
pub struct RouteProblem<'a> {
    /// The network.
    pub network: &'a Network,
    /// Edges removed from it.
    pub removed: &'a EdgeSet,
    /// Times of all arcs in seconds by `ArcId`, for instance with current and delays; `+inf` blocks
    /// an arc. `None`: the network's own.
    pub times: Option<&'a [f64]>,
    /// Where the route starts.
    pub start: NodeId,
    /// Where it ends.
    pub destination: NodeId,
    /// Time available in seconds, at least 0; infinite for no limit.
    pub time_available_s: f64,
    /// What a route in time keeps to. `None`: a route without times, whose only limit is the time
    /// available. Planners that know no times refuse the others by [`PlanError::NotInTime`].
    ///
    /// [`PlanError::NotInTime`]: crate::PlanError::NotInTime
    pub time_model: Option<&'a TimeModel>,
    /// What is minimised.
    pub objective: Objective,
    /// A route; the answer is no worse.
    pub incumbent: Option<&'a Route>,
}

impl<'a> RouteProblem<'a> {
    /// A problem on the whole network with the default objective.
    #[must_use]
    pub fn new(
        network: &'a Network,
        start: NodeId,
        destination: NodeId,
        time_available_s: f64,
    ) -> Self {
        static NOTHING: EdgeSet = EdgeSet::empty();
        Self {
            network,
            removed: &NOTHING,
            times: None,
            time_model: None,
            start,
            destination,
            time_available_s,
            objective: Objective::default(),
            incumbent: None,
        }
    }

    /// All errors in the problem itself. Whether a route exists is not checked.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        for (node, place) in [(self.start, "start"), (self.destination, "destination")] {
            violations.require(self.network.has_node(node), place, || {
                format!(
                    "is node {}; nodes are 0 to {}",
                    node.0,
                    self.network.num_nodes() - 1
                )
            });
        }
        // Written so that a NaN is refused too.
        violations.require(self.time_available_s >= 0.0, "time_available_s", || {
            let given = self.time_available_s;
            format!("is {given}; give seconds of at least 0 (infinite for no limit)")
        });
        violations.absorb("objective.", self.objective.validate());
        if let Some(model) = self.time_model {
            violations.absorb("", model.validate(self.network));
        }
        if let Some(times) = self.times {
            let count = self.network.arcs().len();
            violations.require(times.len() == count, "times", || {
                format!(
                    "has {} entries; give one for each of the {count} arcs",
                    times.len()
                )
            });
            for (i, &time_s) in times.iter().enumerate() {
                // Written without `require`, which would format the place of every arc.
                if time_s.is_nan() || time_s < 0.0 {
                    let message = "give seconds of at least 0 (infinite to block the arc)";
                    violations.push(format!("times[{i}]"), format!("is {time_s}; {message}"));
                }
            }
        }
        violations
    }

    /// Checks all five criteria of Fig. 6 for a route.
    ///
    /// # Errors
    /// The first criterion it breaks.
    pub fn check(&self, route: &Route) -> Result<RouteTotals, Infeasible> {
        route.check(
            self.network,
            self.removed,
            self.times,
            (self.start, self.destination),
            self.time_available_s,
        )
    }

    /// How much a route of `time_s` seconds exceeds the time available: 0 if it does not, else the
    /// excess as a share of that time (in seconds where no time is available).
    #[must_use]
    pub fn violation(&self, time_s: f64) -> f64 {
        if time_s <= self.time_available_s {
            0.0
        } else if self.time_available_s > 0.0 {
            time_s / self.time_available_s - 1.0
        } else {
            time_s - self.time_available_s
        }
    }
}
