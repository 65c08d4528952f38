//! The Lagrange multipliers of the relaxation.

use crate::digraph::Digraph;

/// What a second and a visit of each node cost, in weight.
#[derive(Clone, Debug)]
pub(crate) struct Prices {
    pub(crate) per_second: f64,
    /// By node; 0 for start and destination.
    pub(crate) visit: Vec<f64>,
}

impl Prices {
    /// The constant of the Lagrangian: the price of all seconds available and of one visit of each
    /// node. The reduced weight of a walk plus this credit bounds the weight of a route.
    pub(crate) fn credit(&self, limit_s: f64) -> f64 {
        self.per_second * limit_s + self.visit.iter().sum::<f64>()
    }

    /// The reduced weight of each arc: its weight less the prices of its time and of its head.
    pub(crate) fn reduced(&self, graph: &Digraph) -> Vec<f64> {
        let arcs = 0..graph.num_arcs();
        arcs.map(|arc| {
            graph.weight[arc] - self.per_second * graph.time_s[arc] - self.visit[graph.head[arc]]
        })
        .collect()
    }
}
