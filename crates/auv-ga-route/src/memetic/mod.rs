//! The memetic algorithm: populations of locally optimal routes, crossed by edge assembly.
//!
//! ```text
//! build the search space: reachable nodes, table of arcs, neighbour lists
//! best := the better of the known and the greedy route
//! for epoch in 0, 1, 2, ...:
//!     size := twice that of the epoch before, up to the settings' most
//!     population := elite routes, then constructed ones, each improved by descent     (initialise)
//!     update best                                                               (update_best)
//!     set the price of a second for this epoch                                    (set_price)
//!     until `idle_generations` pass without a replacement:
//!         order the population at random                                            (shuffle)
//!         for each pair of neighbours in this order, on all threads:                  (cross)
//!             for each cycle of the parents' difference:             (PairCrossover::cross)
//!                 child := the first parent with the edges of the cycle exchanged  (assemble)
//!                 eject stretches of the child until it is in time                    (eject)
//!                 improve the child by descent                                      (improve)
//!             if no child is worth more than the first parent:
//!                 search windows of the parent instead                    (search_window)
//!             the child of most worth replaces the first parent
//!         update best, perfect it                                               (update_best)
//!     add best to the elite                                                     (next_epoch)
//!     stop after `patience` epochs without a better route
//! perfect and polish best                                                            (finish)
//! ```
//!
//! In a space too large for a table of all pairs, one tour is annealed instead (`annealing`).
//!
//! All routes are in time. Time left has a price while routes are compared and improved, so that a
//! route may give up profit now for room to insert a node later. The objective alone, without that
//! price, decides which route is the best.

mod alternating_cycles;
mod annealing;
mod arc_table;
mod assembly;
mod descent;
mod ejection;
mod initial_routes;
mod linked_tour;
mod moves;
mod neighbour_lists;
mod neighbourhood;
mod numbers;
mod objective;
mod pair_crossover;
mod perfect;
mod polish;
mod profit_time;
mod reachable;
mod search;
mod search_space;
#[cfg(test)]
mod testing;
mod tour;
mod window;

pub(crate) use objective::TourObjective;
pub(crate) use search::MemeticSearch;
