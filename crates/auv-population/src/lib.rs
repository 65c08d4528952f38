//! What the population-based planners share: [`search`], the loop over generations of GA, ICA and
//! PSO. A planner implements [`Search`]; its tasks run on all threads of [`Workers`] and write to
//! [`Members`].
//!
//! # Determinism
//! A task reads the search, writes its own member, and does not depend on what its thread did
//! before. So the result does not depend on the number of threads.
//!
//! ```
//! use auv_planning::{Budget, Run, Score, StopReason};
//! use auv_population::{Members, Progress, Search, Workers, search};
//! use auv_types::{Seed, rand::RngExt};
//!
//! /// Random search for the least `(x - 3)²`.
//! struct RandomSearch {
//!     generation: u64,
//!     best: f64,
//!     points: Members<f64>,
//! }
//!
//! impl Search for RandomSearch {
//!     type Scratch = ();
//!     fn scratch(&self) {}
//!     fn propose(&mut self) -> u64 {
//!         self.points.len() as u64
//!     }
//!     fn begin(&mut self, granted: u64) -> usize {
//!         granted as usize
//!     }
//!     fn work(&self, task: usize, _scratch: &mut ()) {
//!         let random = &mut Seed(self.generation).stream(task as u64);
//!         *self.points.lock(task) = random.random_range(-10.0..10.0);
//!     }
//!     fn select(&mut self, granted: u64) -> Option<StopReason> {
//!         let costs = self.points.iter_mut().map(|x| (*x - 3.0) * (*x - 3.0));
//!         self.best = costs.take(granted as usize).fold(self.best, f64::min);
//!         self.generation += 1;
//!         None
//!     }
//!     fn progress(&mut self, _is_observed: bool) -> Progress<'_> {
//!         Progress { best: Score::feasible(self.best), costs: &[], violations: &[] }
//!     }
//! }
//!
//! let mut population = RandomSearch {
//!     generation: 0,
//!     best: f64::INFINITY,
//!     points: Members::new(100, || 0.0),
//! };
//! let mut run = Run::new(Seed(0), Budget::evaluations(5_000));
//! let stop = search(&mut run, &Workers::new(2)?, &mut population);
//! assert_eq!(stop, StopReason::EvaluationsSpent);
//! assert!(population.best < 1e-3);
//! # Ok::<(), auv_population::ThreadsUnavailable>(())
//! ```
//!
//! # Features
//!
//! `parallel` is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `parallel` | a pool of threads, by rayon |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod cache_padded;
mod generations;
mod members;
mod search;
mod task_pool;
mod workers;

pub use generations::search;
pub use members::Members;
pub use search::{Progress, Search};
pub use workers::{ThreadsUnavailable, Workers};
