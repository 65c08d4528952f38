//! What the population-based route planners share: the arcs that a route may use ([`UsableArcs`]),
//! a route with its score ([`ScoredRoute`]), priority vectors that encode routes ([`Decoder`]),
//! selection by cost ([`RouletteWheel`]), and the steps before and after each search
//! ([`plan_from_known`]).
//!
//! ```
//! use auv_graph::{Terrain, EdgeSet};
//! use auv_planning::{Deadline, RouteProblem};
//! use auv_route_encoding::{Decoder, DecoderScratch, Decoding, ScoredRoute, UsableArcs};
//! use auv_types::Seed;
//!
//! let instance = Terrain::figure12().draw(Seed(1))?;
//! let (start, destination) = (instance.start, instance.destination);
//! let problem = RouteProblem::new(&instance.network, start, destination, instance.budget_s);
//! let arcs = UsableArcs::new(&problem, Deadline::default());
//! let quickest = problem.prepare()?;
//! let decoder = Decoder::new(&arcs, &quickest.home);
//! let (mut priorities, mut route) = (Vec::new(), ScoredRoute::none());
//! decoder.draw(Seed(7), 0, 0, &mut priorities);
//! decoder.decode(&priorities, Decoding::BudgetAware, &mut DecoderScratch::default(), &mut route);
//! assert!(problem.check(&route.route()).is_ok());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Features
//!
//! None is on by default.
//!
//! | feature | adds |
//! |---|---|
//! | `serde` | settings can be written and read |

#![cfg_attr(docsrs, feature(doc_cfg))]
#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]

mod decoder;
mod known_route;
mod ranking;
mod roulette;
mod scored_route;
mod usable_arcs;

pub use decoder::{Decoder, DecoderScratch, Decoding};
pub use known_route::{KnownRoute, plan_from_known};
pub use ranking::RouteRanking;
pub use roulette::RouletteWheel;
pub use scored_route::ScoredRoute;
pub use usable_arcs::{UsableArc, UsableArcs};
