//! Routes in time: a route as steps with the earliest and the latest time of each, so that an insertion
//! is judged in O(1).
//!
//! A [`TimedTour`] is a sequence of [`Step`]s over a [`TimedNetwork`]. [`Piece`]s are what can be inserted:
//! a node, a node with a task, an edge with its task, a whole chain. [`plan_in_time`] is the frame that
//! every planner of routes in time runs in.

mod conflict;
mod earliest;
mod fill;
mod first_tour;
mod frame;
mod left_out;
mod partial;
mod pieces;
mod rules;
mod timed_network;
mod tour;
mod tour_end;
mod tour_insertion;

pub use fill::{fill, insert, insert_by_detour};
pub use frame::{plan_in_time, schedule_at_once};
pub use left_out::{LeftOut, left_out};
pub use partial::{Extended, PartialRoutes, most_of_all};
pub use pieces::{Piece, corridors, pieces};
pub use timed_network::{NO_TASK, Step, TimedNetwork, TimedWork};
pub use tour::TimedTour;
pub use tour_insertion::Insertion;
