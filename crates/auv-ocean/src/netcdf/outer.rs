//! The dimensions of time and level.

use super::roles::{Axis, axis_of};
use super::source::{Found, NetcdfError, Source};

/// The dimensions of time and level of a component, by their places.
pub(super) struct Outer {
    pub(super) time: Option<usize>,
    pub(super) level: Option<usize>,
}

impl Outer {
    pub(super) fn of(source: &Source, found: &Found<'_>) -> Result<Self, NetcdfError> {
        let mut outer = Self {
            time: None,
            level: None,
        };
        for (i, dimension) in found.dimensions().iter().enumerate() {
            let mut axes = source
                .all()
                .filter(|f| matches!(f.dimensions(), [own] if own.name == dimension.name));
            let told = axes.find_map(|f| axis_of(&f).transpose()).transpose()?;
            let name = dimension.name.to_ascii_lowercase();
            let by_name = || {
                if name.contains("time") {
                    Some(Axis::Time)
                } else if ["s_rho", "depth", "lev", "level", "z", "sigma", "s_r"]
                    .contains(&name.as_str())
                {
                    Some(Axis::Level)
                } else {
                    None
                }
            };
            match told.or_else(by_name) {
                Some(Axis::Time) if outer.time.is_none() => outer.time = Some(i),
                Some(Axis::Level) if outer.level.is_none() => outer.level = Some(i),
                _ => {}
            }
        }
        Ok(outer)
    }

    pub(super) fn places(&self) -> Vec<usize> {
        self.time.into_iter().chain(self.level).collect()
    }

    pub(super) fn count(found: &Found<'_>, place: Option<usize>) -> usize {
        place.map_or(1, |i| found.dimensions()[i].size as usize)
    }
}
