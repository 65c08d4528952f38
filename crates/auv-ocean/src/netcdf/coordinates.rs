//! The latitudes and longitudes that belong to a variable.

use super::roles::{Axis, axis_of, is_position_by_name};
use super::source::{Found, NetcdfError, Source};

/// A pair of coordinate variables.
pub(super) struct Pair<'a> {
    pub(super) latitude: Found<'a>,
    pub(super) longitude: Found<'a>,
    /// The places of the row and the column dimension among the variable's.
    pub(super) dimensions: [usize; 2],
}

impl<'a> Pair<'a> {
    /// The pair of a variable.
    ///
    /// # Errors
    /// No latitudes and longitudes over its dimensions, positions in metres, attributes that contradict each
    /// other.
    pub(super) fn of(source: &'a Source, found: &Found<'_>) -> Result<Self, NetcdfError> {
        let (latitudes, longitudes) = coordinates(source, found)?;
        let pair = one_dimensional(found, &latitudes, &longitudes)
            .or_else(|| two_dimensional(found, &latitudes, &longitudes))
            .or_else(|| by_size(found, &latitudes, &longitudes));
        match pair {
            Some(pair) => Ok(pair),
            None => Err(unplaced(source, found, &latitudes, &longitudes)?),
        }
    }
}

/// All latitudes and longitudes that share a dimension with a variable, those that its attribute
/// `coordinates` lists first. Where none shares one, all of the file.
fn coordinates<'a>(
    source: &'a Source,
    found: &Found<'_>,
) -> Result<(Vec<Found<'a>>, Vec<Found<'a>>), NetcdfError> {
    let listed = found.text("coordinates").unwrap_or_default();
    let is_listed = |name: &str| listed.split_whitespace().any(|word| word == name);
    let shares = |other: &Found<'_>| {
        let own = found.squeezed();
        other
            .squeezed()
            .iter()
            .any(|d| own.iter().any(|o| o.name == d.name))
    };
    let (mut latitudes, mut longitudes) = (Vec::new(), Vec::new());
    for near in [true, false] {
        for other in source.all().filter(|other| shares(other) == near) {
            if other.name() == found.name() || other.squeezed().is_empty() {
                continue;
            }
            let axis = if near {
                axis_of(&other)?
            } else {
                axis_of(&other).ok().flatten()
            };
            match axis {
                Some(Axis::Latitude) => latitudes.push(other),
                Some(Axis::Longitude) => longitudes.push(other),
                _ => {}
            }
        }
        if !latitudes.is_empty() && !longitudes.is_empty() {
            break;
        }
    }
    latitudes.sort_by_key(|f| !is_listed(f.name()));
    longitudes.sort_by_key(|f| !is_listed(f.name()));
    Ok((latitudes, longitudes))
}

fn dimension_of(found: &Found<'_>, name: &str) -> Option<usize> {
    found
        .dimensions()
        .iter()
        .position(|d| d.name == name && d.size != 1)
}

fn one_dimensional<'a>(
    found: &Found<'_>,
    latitudes: &[Found<'a>],
    longitudes: &[Found<'a>],
) -> Option<Pair<'a>> {
    let along = |axes: &[Found<'a>]| {
        axes.iter().find_map(|axis| {
            let [dimension] = axis.squeezed()[..] else {
                return None;
            };
            Some((*axis, dimension_of(found, &dimension.name)?))
        })
    };
    let (latitude, row) = along(latitudes)?;
    let (longitude, column) = along(longitudes)?;
    (row != column).then_some(Pair {
        latitude,
        longitude,
        dimensions: [row, column],
    })
}

fn two_dimensional<'a>(
    found: &Found<'_>,
    latitudes: &[Found<'a>],
    longitudes: &[Found<'a>],
) -> Option<Pair<'a>> {
    let over = |axis: &Found<'a>| {
        let [first, second] = axis.squeezed()[..] else {
            return None;
        };
        let places = [
            dimension_of(found, &first.name)?,
            dimension_of(found, &second.name)?,
        ];
        // Rows come first, unless the names say otherwise.
        Some(if is_x(&first.name) && !is_x(&second.name) {
            [places[1], places[0]]
        } else {
            places
        })
    };
    let (latitude, dimensions) = latitudes.iter().find_map(|f| Some((*f, over(f)?)))?;
    let same = |f: &&Found<'a>| {
        over(f).is_some_and(|d| d == dimensions || d == [dimensions[1], dimensions[0]])
    };
    let longitude = *longitudes.iter().find(same)?;
    Some(Pair {
        latitude,
        longitude,
        dimensions,
    })
}

/// Coordinates whose dimensions have other names, told by their sizes where these tell.
fn by_size<'a>(
    found: &Found<'_>,
    latitudes: &[Found<'a>],
    longitudes: &[Found<'a>],
) -> Option<Pair<'a>> {
    let large: Vec<usize> = (0..found.dimensions().len())
        .filter(|&i| found.dimensions()[i].size != 1)
        .collect();
    let &[row, column] = large.get(large.len().checked_sub(2)?..)? else {
        return None;
    };
    let [rows, columns] = [row, column].map(|i| found.dimensions()[i].size);
    let sizes = |f: &Found<'a>| f.squeezed().iter().map(|d| d.size).collect::<Vec<_>>();
    let of = |axes: &[Found<'a>], wanted: &[u64]| axes.iter().copied().find(|f| sizes(f) == wanted);
    let pair = |latitude, longitude, dimensions| Pair {
        latitude,
        longitude,
        dimensions,
    };
    if let Some(latitude) = of(latitudes, &[rows, columns])
        && let Some(longitude) = of(longitudes, &[rows, columns])
    {
        return Some(pair(latitude, longitude, [row, column]));
    }
    if rows == columns {
        return None;
    }
    if let Some(latitude) = of(latitudes, &[rows])
        && let Some(longitude) = of(longitudes, &[columns])
    {
        return Some(pair(latitude, longitude, [row, column]));
    }
    Some(pair(
        of(latitudes, &[columns])?,
        of(longitudes, &[rows])?,
        [column, row],
    ))
}

/// Whether a dimension runs along a model's rows, by its name.
pub(super) fn is_x(name: &str) -> bool {
    let name = name.to_ascii_lowercase();
    name.starts_with("xi_")
        || name.starts_with("lon")
        || ["x", "i", "nx", "ni", "nav_lon", "x_c", "xc", "xt_ocean"].contains(&name.as_str())
}

/// The error of a variable without latitudes and longitudes.
fn unplaced(
    source: &Source,
    found: &Found<'_>,
    latitudes: &[Found<'_>],
    longitudes: &[Found<'_>],
) -> Result<NetcdfError, NetcdfError> {
    for other in source.all() {
        let shares = other
            .squeezed()
            .iter()
            .any(|d| dimension_of(found, &d.name).is_some());
        if shares && axis_of(&other)? == Some(Axis::Projected) {
            let units = other
                .text("units")
                .map_or_else(|| "no units".into(), |u| format!("units `{u}`"));
            return Ok(other.error(format!(
                "has {units}: it is no longitude or latitude; give positions in degrees, for instance with \
                 `gdalwarp -t_srs EPSG:4326` or, where they are degrees, `ncatted -a units,{},o,c,degrees_east`",
                other.name()
            )));
        }
    }
    let mut near = source.all().filter(|other| {
        let mut dimensions = other.squeezed().into_iter();
        other.name() != found.name() && dimensions.any(|d| dimension_of(found, &d.name).is_some())
    });
    if let Some(odd) = near.find(is_position_by_name) {
        let units = odd.text("units").unwrap_or_default();
        return Ok(odd.error(format!(
            "has units `{units}`; give degrees_north, degrees_east or radians"
        )));
    }
    let missing = |variable, looked_for: &str| NetcdfError::Missing {
        variable,
        looked_for: looked_for.into(),
    };
    Ok(match (latitudes.first(), longitudes.first()) {
        (None, _) => missing(
            "latitude",
            "units degrees_north, standard_name latitude, or lat, latitude, nav_lat, lat_rho",
        ),
        (_, None) => missing(
            "longitude",
            "units degrees_east, standard_name longitude, or lon, longitude, nav_lon, lon_rho",
        ),
        (Some(latitude), Some(_)) => found.footprint(format!(
            "dimensions that are those of `{}` and of the longitudes, by name or by size",
            latitude.name()
        )),
    })
}
