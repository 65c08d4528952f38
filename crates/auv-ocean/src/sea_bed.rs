//! The depth of the water.

use std::fmt::Debug;

/// The depth of the sea bed below the surface as a function of position.
///
/// # Determinism
/// A sea bed is a pure function: equal arguments, equal bits.
pub trait SeaBed: Debug + Send + Sync {
    /// Depth of the bed in metres, positive down; zero or negative on land and outside the data.
    /// Always finite.
    fn depth_at(&self, north_m: f64, east_m: f64) -> f64;

    /// Depths at many positions at once: `depths_m[i]` at (`north_m[i]`, `east_m[i]`). The three slices have
    /// equal lengths.
    fn depths_at(&self, north_m: &[f64], east_m: &[f64], depths_m: &mut [f64]) {
        for ((depth_m, &north_m), &east_m) in depths_m.iter_mut().zip(north_m).zip(east_m) {
            *depth_m = self.depth_at(north_m, east_m);
        }
    }

    /// An upper bound of the slope within `radius_m` of a position, metres of depth per horizontal metre. It
    /// proves the altitude between two samples.
    fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64;

    /// Standard deviation of the depth at a position, metres.
    fn depth_sigma_m(&self, _north_m: f64, _east_m: f64) -> f64 {
        0.0
    }

    /// [`SeaBed::depth_at`] and [`SeaBed::depth_sigma_m`] at once, bit for bit: a bed whose deviation follows from its
    /// depth computes the depth once.
    fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
        let depth_m = self.depth_at(north_m, east_m);
        (depth_m, self.depth_sigma_m(north_m, east_m))
    }
}

macro_rules! lend_bed {
    ($($pointer:ty),*) => {$(
        impl<T: SeaBed + ?Sized> SeaBed for $pointer {
            fn depth_at(&self, north_m: f64, east_m: f64) -> f64 {
                (**self).depth_at(north_m, east_m)
            }

            fn depths_at(&self, north_m: &[f64], east_m: &[f64], depths_m: &mut [f64]) {
                (**self).depths_at(north_m, east_m, depths_m);
            }

            fn max_slope_near(&self, north_m: f64, east_m: f64, radius_m: f64) -> f64 {
                (**self).max_slope_near(north_m, east_m, radius_m)
            }

            fn depth_sigma_m(&self, north_m: f64, east_m: f64) -> f64 {
                (**self).depth_sigma_m(north_m, east_m)
            }

            fn sounding_m(&self, north_m: f64, east_m: f64) -> (f64, f64) {
                (**self).sounding_m(north_m, east_m)
            }
        }
    )*};
}
lend_bed!(&T, Box<T>, std::sync::Arc<T>);

/// The same depth everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct FlatBed {
    depth_m: f64,
}

impl FlatBed {
    /// A bed at `depth_m` below the surface.
    #[must_use]
    pub const fn new(depth_m: f64) -> Self {
        Self { depth_m }
    }
}

impl SeaBed for FlatBed {
    fn depth_at(&self, _north_m: f64, _east_m: f64) -> f64 {
        self.depth_m
    }

    fn max_slope_near(&self, _north_m: f64, _east_m: f64, _radius_m: f64) -> f64 {
        0.0
    }
}
