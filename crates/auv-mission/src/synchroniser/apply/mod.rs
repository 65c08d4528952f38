//! The only writer of the state: applies events, then the decisions that follow.

mod decision;
mod event;
