//! Water velocity.

use auv_types::{Point3, Vector3};
use std::fmt::Debug;

/// The velocity of the water as a function of position and time. Its direction is where the water flows
/// to.
///
/// # Determinism
/// A field is a pure function: equal arguments, equal bits.
pub trait CurrentField: Debug + Send + Sync {
    /// Water velocity in m/s (NED) at a position in metres and a mission time in seconds.
    /// Always finite; zero outside the field's data.
    fn velocity_at(&self, position: &Point3<f64>, time_s: f64) -> Vector3<f64>;

    /// An upper bound of the speed anywhere and at any time, m/s.
    fn max_speed_mps(&self) -> f64;
}

macro_rules! lend_current {
    ($($pointer:ty),*) => {$(
        impl<T: CurrentField + ?Sized> CurrentField for $pointer {
            fn velocity_at(&self, position: &Point3<f64>, time_s: f64) -> Vector3<f64> {
                (**self).velocity_at(position, time_s)
            }

            fn max_speed_mps(&self) -> f64 {
                (**self).max_speed_mps()
            }
        }
    )*};
}
lend_current!(&T, Box<T>, std::sync::Arc<T>);

/// The same velocity everywhere and at all times: the paper's current.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct UniformCurrent {
    velocity_mps: Vector3<f64>,
}

impl UniformCurrent {
    /// A current with the given velocity (m/s, NED, direction "towards").
    #[must_use]
    pub const fn new(velocity_mps: Vector3<f64>) -> Self {
        Self { velocity_mps }
    }
}

impl CurrentField for UniformCurrent {
    fn velocity_at(&self, _position: &Point3<f64>, _time_s: f64) -> Vector3<f64> {
        self.velocity_mps
    }

    fn max_speed_mps(&self) -> f64 {
        self.velocity_mps.norm()
    }
}
