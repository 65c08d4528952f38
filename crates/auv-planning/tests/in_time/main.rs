//! Routes in time against an enumeration of all routes and all orders of their tasks; why tasks are left out,
//! and what cannot be planned at all.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

mod detour;
mod drawn;
mod enumeration;
mod partial;
mod refused;
mod tour_end;
mod why;
