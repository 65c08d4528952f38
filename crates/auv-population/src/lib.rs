//! What the population-based planners share: [`search`], the loop of GA, ICA and PSO; a [`Search`],
//! whose tasks are done on all threads and written to its [`Members`]; and [`Workers`], the threads.
//!
//! # Determinism
//! A task reads the search, writes its own member, and must not depend on what its thread did before;
//! so the outcome does not depend on the number of threads.
//!
//! ```
//! use auv_planning::{Budget, Run, StopReason};
//! use auv_population::{Members, Search, Standing, Workers, search};
//! use auv_types::{Seed, rand::RngExt};
//!
//! /// Random search for the least `(x - 3)²`.
//! struct Darts {
//!     generation: u64,
//!     best: f64,
//!     darts: Members<f64>,
//! }
//!
//! impl Search for Darts {
//!     type Room = ();
//!     fn room(&self) {}
//!     fn propose(&mut self) -> u64 {
//!         self.darts.len() as u64
//!     }
//!     fn begin(&mut self, granted: u64) -> usize {
//!         granted as usize
//!     }
//!     fn work(&self, task: usize, _room: &mut ()) {
//!         let random = &mut Seed(self.generation).stream(task as u64);
//!         *self.darts.lock(task) = random.random_range(-10.0..10.0);
//!     }
//!     fn select(&mut self, granted: u64) -> Option<StopReason> {
//!         let costs = self.darts.iter_mut().map(|x| (*x - 3.0) * (*x - 3.0));
//!         self.best = costs.take(granted as usize).fold(self.best, f64::min);
//!         self.generation += 1;
//!         None
//!     }
//!     fn standing(&mut self, _is_observed: bool) -> Standing<'_> {
//!         Standing { best_cost: self.best, best_violation: 0.0, costs: &[], violations: &[] }
//!     }
//! }
//!
//! let mut darts = Darts {
//!     generation: 0,
//!     best: f64::INFINITY,
//!     darts: Members::new(100, || 0.0),
//! };
//! let mut run = Run::new(Seed(0), Budget::evaluations(5_000));
//! let stop = search(&mut run, &Workers::new(2)?, &mut darts);
//! assert_eq!(stop, StopReason::EvaluationsSpent);
//! assert!(darts.best < 1e-3);
//! # Ok::<(), auv_population::NoThreads>(())
//! ```

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod apart;
mod crew;
mod members;
pub mod route;
mod search;
mod workers;

pub use members::Members;
pub use search::{Search, Standing, search};
pub use workers::{NoThreads, Workers};
