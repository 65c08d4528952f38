//! The two components of a current.

use super::outer::Outer;
use super::roles::{Component, axis_of, component_of};
use super::source::{Found, NetcdfError, Source};

/// The two components.
pub(super) struct Pair<'a> {
    pub(super) first: Found<'a>,
    pub(super) second: Found<'a>,
    pub(super) directions: Directions,
}

/// What is known of the directions of the components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Directions {
    EastNorth,
    Grid,
    Unsaid,
}

impl<'a> Pair<'a> {
    pub(super) fn chosen(source: &'a Source) -> Result<Self, NetcdfError> {
        let of = |component| -> Result<Option<Found<'a>>, NetcdfError> {
            let mut all = source
                .all()
                .filter(|f| component_of(f) == Some(component) && f.squeezed().len() >= 2);
            let found = all.next();
            // What an attribute says counts more than what a name says; two that say the same do not go.
            if let (Some(a), Some(b)) = (found, all.next()) {
                let told = |f: &Found<'a>| f.text("standard_name").is_some();
                return match (told(&a), told(&b)) {
                    (true, false) => Ok(Some(a)),
                    (false, true) => Ok(Some(b)),
                    _ => Err(a.contradiction(
                        "is a component of the current",
                        format!("variable `{}`, which is the same one", b.name()),
                        "take one of them out with `ncks -x -v`",
                    )),
                };
            }
            Ok(found)
        };
        let mut alone = None;
        for (first, second, directions) in [
            (Component::East, Component::North, Directions::EastNorth),
            (Component::Along, Component::Across, Directions::Grid),
            (Component::First, Component::Second, Directions::Unsaid),
        ] {
            match (of(first)?, of(second)?) {
                (Some(first), Some(second)) => {
                    return Ok(Self {
                        first,
                        second,
                        directions,
                    });
                }
                (Some(one), None) | (None, Some(one)) => alone = alone.or(Some(one)),
                (None, None) => {}
            }
        }
        Err(match alone {
            Some(one) => one.error(
                "has no partner of the same kind; give both components, eastward and northward or along and across the grid",
            ),
            None => NetcdfError::Missing {
                variable: "current",
                looked_for: "standard_name eastward_sea_water_velocity and northward_sea_water_velocity, or u and v, uo and vo, water_u and water_v".into(),
            },
        })
    }

    /// Checks that the second component has the times and levels of the first, where its dimensions of these
    /// have other names.
    ///
    /// # Errors
    /// Other times or levels.
    pub(super) fn require_same_outer(
        &self,
        source: &Source,
        outer: &[Outer; 2],
    ) -> Result<(), NetcdfError> {
        let name = |found: &Found<'a>, place: Option<usize>| {
            place.map(|i| found.dimensions()[i].name.as_str())
        };
        let axes = |dimension: &str| -> Result<Vec<(String, Vec<f64>)>, NetcdfError> {
            let own = |f: &Found<'_>| matches!(f.dimensions(), [own] if own.name == dimension);
            let told = source
                .all()
                .filter(|f| own(f) && matches!(axis_of(f), Ok(Some(_))));
            told.map(|f| Ok((f.word("units") + &f.word("positive"), f.values()?)))
                .collect()
        };
        for (what, first, second) in [
            ("times", outer[0].time, outer[1].time),
            ("levels", outer[0].level, outer[1].level),
        ] {
            let names = name(&self.first, first).zip(name(&self.second, second));
            let Some((first, second)) = names.filter(|(first, second)| first != second) else {
                continue;
            };
            let (a, b) = (axes(first)?, axes(second)?);
            if a.is_empty() || a != b {
                return Err(self.second.contradiction(
                    &format!("has its {what} along `{second}`"),
                    format!(
                        "`{}`, whose {what} along `{first}` differ",
                        self.first.name()
                    ),
                    "interpolate one to those of the other",
                ));
            }
        }
        Ok(())
    }

    /// Whether the components lie at different places: their horizontal dimensions differ.
    pub(super) fn is_staggered(&self, outer: &[Outer; 2]) -> bool {
        let inner = |found: &Found<'_>, outer: &Outer| {
            let dimensions = found.dimensions().iter().enumerate();
            let mut names: Vec<String> = dimensions
                .filter(|(i, d)| d.size != 1 && !outer.places().contains(i))
                .map(|(_, d)| d.name.clone())
                .collect();
            names.sort();
            names
        };
        inner(&self.first, &outer[0]) != inner(&self.second, &outer[1])
    }
}
