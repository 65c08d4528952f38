//! Claims about whole missions flown by the synchroniser.

#![allow(clippy::float_cmp, reason = "tests compare exact values on purpose")]

mod table2;
mod vehicle;
