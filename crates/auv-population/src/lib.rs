//! What the population-based planners share: [`Workers`], the pool that evaluates a population in
//! order on any number of threads, and [`search`], the loop of GA, ICA and PSO.
//!
//! # Determinism
//! Members are evaluated independently and results stay in their places, so the outcome does not
//! depend on the number of threads.
//!
//! ```
//! use auv_population::Workers;
//!
//! let mut squares: Vec<u64> = (0..100).collect();
//! let workers = Workers::new(2)?;
//! workers.for_each(&mut squares, 16, &mut [(), ()], |_, member, ()| *member *= *member);
//! assert_eq!(squares[99], 9_801);
//! # Ok::<(), auv_population::NoThreads>(())
//! ```

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

pub mod route;
mod search;
mod workers;

pub use search::{Search, Standing, search};
pub use workers::{NoThreads, Workers};
