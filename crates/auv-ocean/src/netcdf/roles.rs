//! What a variable is, by its attributes first, then by its name.

use super::source::{Found, NetcdfError};
use crate::units::{self, Quantity};

/// What a coordinate counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Latitude,
    Longitude,
    /// A distance on a map projection, or along the sides of a basin.
    Projected,
    Time,
    /// Depth, height or layer.
    Level,
}

const LATITUDES: &[&str] = &["lat_rho", "nav_lat", "latitude", "lat"];
const LONGITUDES: &[&str] = &["lon_rho", "nav_lon", "longitude", "lon"];
const TIMES: &[&str] = &[
    "ocean_time",
    "time",
    "scrum_time",
    "time_counter",
    "time_instant",
    "t",
    "mt",
];
const LEVELS: &[&str] = &[
    "depth", "depthu", "depthv", "deptht", "lev", "level", "levels", "z", "s_rho", "sc_r", "sigma",
    "z_r", "zt", "st_ocean", "plev", "layer", "height", "altitude",
];

/// What a coordinate variable counts; `None` for a variable that is no coordinate.
///
/// # Errors
/// Attributes that contradict each other.
pub(super) fn axis_of(found: &Found<'_>) -> Result<Option<Axis>, NetcdfError> {
    let units = found.word("units");
    let by_units = by_units(&units);
    let standard = found.word("standard_name");
    let by_standard = by_standard(found, &standard);
    let conflicts = [
        (Axis::Latitude, Axis::Longitude),
        (Axis::Longitude, Axis::Latitude),
    ];
    if let Some(both) = by_units.zip(by_standard)
        && conflicts.contains(&both)
    {
        return Err(found.contradiction(
            &format!("units `{units}`"),
            format!("its standard_name `{standard}`"),
            "correct one of them, for instance with `ncatted`",
        ));
    }
    let by_name = named(found);
    // Degrees on a map projection: a rotated pole.
    let sure = match by_standard {
        Some(Axis::Projected) => by_standard,
        _ => by_units.or(by_standard),
    };
    if let (Some(sure @ (Axis::Latitude | Axis::Longitude)), Some(name)) = (sure, by_name)
        && conflicts.contains(&(sure, name))
    {
        return Err(found.contradiction(
            &format!("units `{units}`, standard_name `{standard}`"),
            "its name",
            "rename it with `ncrename -v`, or correct its attributes with `ncatted`",
        ));
    }
    let axis = sure.or(by_name);
    let stated = found.word("axis");
    if let (Some(axis @ (Axis::Latitude | Axis::Longitude)), "x" | "y" | "z" | "t") =
        (axis, stated.as_str())
        && stated != if axis == Axis::Latitude { "y" } else { "x" }
    {
        return Err(found.contradiction(
            &format!("axis `{stated}`"),
            format!(
                "that it is a {}",
                if axis == Axis::Latitude {
                    "latitude"
                } else {
                    "longitude"
                }
            ),
            "correct the attribute `axis` with `ncatted`",
        ));
    }
    Ok(axis)
}

/// What the units of a coordinate say.
fn by_units(units: &str) -> Option<Axis> {
    if units::is_north(units) {
        Some(Axis::Latitude)
    } else if units::is_east(units) {
        Some(Axis::Longitude)
    } else if units.contains(" since ") {
        Some(Axis::Time)
    } else {
        None
    }
}

/// What the standard name of a coordinate says.
fn by_standard(found: &Found<'_>, standard: &str) -> Option<Axis> {
    match standard {
        "latitude" => Some(Axis::Latitude),
        "longitude" => Some(Axis::Longitude),
        "projection_x_coordinate"
        | "projection_y_coordinate"
        | "grid_latitude"
        | "grid_longitude" => Some(Axis::Projected),
        "time" => Some(Axis::Time),
        "depth" | "height" | "altitude" => {
            Some(Axis::Level).filter(|_| found.squeezed().len() <= 1)
        }
        _ => standard.starts_with("ocean_s").then_some(Axis::Level),
    }
}

/// Whether a variable has the name of a latitude or longitude, and no unit of one.
pub(super) fn is_position_by_name(found: &Found<'_>) -> bool {
    let name = found.name().to_ascii_lowercase();
    let mut names = LATITUDES.iter().chain(LONGITUDES);
    names.any(|known| *known == name) && matches!(axis_of(found), Ok(None))
}

/// What the name of a coordinate says, where it has the shape and the unit of one.
fn named(found: &Found<'_>) -> Option<Axis> {
    let name = found.name().to_ascii_lowercase();
    let is = |names: &[&str]| names.contains(&name.as_str());
    let degrees = || {
        found
            .text("units")
            .is_none_or(|units| units::factor(&units, Quantity::Angle).is_some())
    };
    if is(LATITUDES) && degrees() {
        return Some(Axis::Latitude);
    }
    if is(LONGITUDES) && degrees() {
        return Some(Axis::Longitude);
    }
    if found.squeezed().len() > 1 {
        return None;
    }
    if is(TIMES) {
        return Some(Axis::Time);
    }
    let own = found.dimensions().len() == 1;
    // GMT's grids call degrees x and y.
    if (is(&["x"]) || is(&["y"])) && own {
        let long = found.word("long_name");
        let told = found
            .text("units")
            .is_some_and(|units| units::factor(&units, Quantity::Angle).is_some());
        return Some(
            match (told || found.text("units").is_none(), name.as_str()) {
                (true, _) if long.contains("latitude") => Axis::Latitude,
                (true, _) if long.contains("longitude") => Axis::Longitude,
                (true, "y") if told => Axis::Latitude,
                (true, "x") if told => Axis::Longitude,
                _ => Axis::Projected,
            },
        );
    }
    let metres = || {
        found
            .text("units")
            .is_some_and(|units| units::factor(&units, Quantity::Length).is_some())
    };
    if own
        && (is(&["easting", "northing", "xc", "yc"])
            || (is(LATITUDES) || is(LONGITUDES)) && metres())
    {
        return Some(Axis::Projected);
    }
    (is(LEVELS) && own).then_some(Axis::Level)
}

/// Which way values count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Down,
    Up,
}

/// What tells the direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Basis {
    Attribute,
    Name,
}

/// How well a variable is known to be the chart: smaller is better.
pub(super) fn chart_rank(found: &Found<'_>) -> Option<usize> {
    let standard = found.word("standard_name");
    let name = found.name();
    if direction_of_standard(&standard).is_some() {
        return Some(0);
    }
    // Another quantity, whatever its name.
    if !standard.is_empty() && !standard.contains("bathymetry") {
        return None;
    }
    const DOWN: &[&str] = &[
        "Bathymetry",
        "bathymetry",
        "h",
        "deptho",
        "depth",
        "bathy",
        "bathy_metry",
        "bathy_meter",
        "water_depth",
        "bottom_depth",
        "Depth",
        "DEPTH",
        "hdept",
        "seafloor_depth",
    ];
    if DOWN.contains(&name) || UP.contains(&name) {
        return Some(1);
    }
    let long = found.word("long_name");
    let other = [
        "deviation",
        "error",
        "count",
        "number",
        "quality",
        "flag",
        "source",
        "interpol",
        "smooth",
    ];
    let told = [
        "bathymetry",
        "sea floor depth",
        "seafloor depth",
        "sea_floor_depth",
        "water depth",
        "elevation",
        "topography",
    ]
    .iter()
    .any(|word| long.contains(word));
    (told && !other.iter().any(|word| long.contains(word))).then_some(2)
}

const UP: &[&str] = &[
    "elevation",
    "z",
    "Band1",
    "altitude",
    "topo",
    "topography",
    "ROSE",
    "Elevation",
    "height",
];

fn direction_of_standard(standard: &str) -> Option<Direction> {
    if standard == "depth"
        || standard.starts_with("sea_floor_depth")
        || standard.starts_with("model_sea_floor_depth")
    {
        return Some(Direction::Down);
    }
    let up = ["height", "altitude", "surface_altitude", "bedrock_altitude"].contains(&standard)
        || standard.starts_with("height_above")
        || standard.starts_with("sea_floor_altitude")
        || standard.starts_with("sea_floor_elevation");
    up.then_some(Direction::Up)
}

/// Which way the values of a chart count, and what says so.
///
/// # Errors
/// `positive` against the standard name.
pub(super) fn chart_direction(found: &Found<'_>) -> Result<(Direction, Basis), NetcdfError> {
    let positive = match found.word("positive").as_str() {
        "up" => Some(Direction::Up),
        "down" => Some(Direction::Down),
        "" => None,
        other => {
            return Err(found.error(format!("has positive = `{other}`; give `up` or `down`")));
        }
    };
    let standard = found.word("standard_name");
    let by_standard = direction_of_standard(&standard);
    if let (Some(a), Some(b)) = (positive, by_standard)
        && a != b
    {
        return Err(found.contradiction(
            &format!("positive `{}`", found.word("positive")),
            format!("its standard_name `{standard}`"),
            "correct one of them with `ncatted`",
        ));
    }
    if let Some(direction) = positive.or(by_standard) {
        return Ok((direction, Basis::Attribute));
    }
    let long = found.word("long_name");
    let up = UP.contains(&found.name()) || (long.contains("elevation") && !long.contains("depth"));
    let direction = if up { Direction::Up } else { Direction::Down };
    Ok((direction, Basis::Name))
}

/// A component of the current.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    East,
    North,
    /// Along the grid's rows.
    Along,
    /// Along the grid's columns.
    Across,
    /// `u` or `v` without a word on the direction.
    First,
    Second,
}

/// Which component of the current a variable is. Means over depth, parts of the current, those at the bottom,
/// ice, wind and waves are none.
pub(super) fn component_of(found: &Found<'_>) -> Option<Component> {
    let standard = found.word("standard_name");
    if !standard.is_empty() {
        let water = standard.contains("sea_water")
            && standard.contains("velocity")
            && ![
                "barotropic",
                "stokes",
                "vertical",
                "at_bottom",
                "at_sea_floor",
                "due_to",
            ]
            .iter()
            .any(|part| standard.contains(part));
        return match () {
            () if !water => None,
            () if standard.contains("eastward") => Some(Component::East),
            () if standard.contains("northward") => Some(Component::North),
            () if standard.contains("x_velocity") || standard.starts_with("x_") => {
                Some(Component::Along)
            }
            () if standard.contains("y_velocity") || standard.starts_with("y_") => {
                Some(Component::Across)
            }
            () => None,
        };
    }
    Some(match found.name().to_ascii_lowercase().as_str() {
        "u_eastward" | "u_east" | "water_u" | "uo" | "eastward_velocity" | "u_geo" => {
            Component::East
        }
        "v_northward" | "v_north" | "water_v" | "vo" | "northward_velocity" | "v_geo" => {
            Component::North
        }
        "vozocrtx" | "x_velocity" => Component::Along,
        "vomecrty" | "y_velocity" => Component::Across,
        "u" | "u_rho" | "ucur" | "u_velocity" | "u-velocity" => Component::First,
        "v" | "v_rho" | "vcur" | "v_velocity" | "v-velocity" => Component::Second,
        _ => return None,
    })
}
