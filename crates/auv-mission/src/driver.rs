//! Drivers: they call the planners a synchroniser asks for.

mod stepped;

pub use stepped::{Orders, Stepped};
