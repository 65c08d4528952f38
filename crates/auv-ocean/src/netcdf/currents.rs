//! Currents of ocean models.

use super::bathymetry::charted;
use super::grid::{Horizontal, horizontal};
use super::levels::layers;
use super::roles::{Axis, Component, axis_of, component_of};
use super::source::{Found, NetcdfError, Source};
use super::speed::{in_mps, unit_of};
use super::staggered::{Extent, destaggered, north_east};
use super::time;
use super::units::{self, Quantity};
use crate::{ChartedDepths, FileReport, ModelCurrents};
use auv_types::libm;

/// Reads the current of an ocean model with what was read.
///
/// Components are found by CF `standard_name`, then by usual names (`uo`, `water_u`, `u_eastward`, `u`, ...).
/// Those along a model's grid are turned to true north and east, those between its points (Arakawa C) are
/// interpolated: the velocity at a point is the mean of the wet velocities on its two sides. Layers are
/// depths, or terrain-following ones for a surface at rest (zeta = 0), without the height of the tide.
/// Records of one time, and records without a time or a value, are dropped.
///
/// # Errors
/// Damaged files, missing variables, unknown or missing units, attributes that contradict each other or the
/// values, sizes beyond 50 million.
pub fn read_currents(bytes: &[u8]) -> Result<(ModelCurrents, FileReport), NetcdfError> {
    let mut report = FileReport {
        format: "NetCDF".into(),
        ..FileReport::default()
    };
    let source = Source::open(bytes)?;
    let pair = Pair::chosen(&source)?;
    let outer = [
        Outer::of(&source, &pair.first)?,
        Outer::of(&source, &pair.second)?,
    ];
    let (times_unix_s, kept) = records(&source, &pair.first, &outer[0], &mut report)?;
    let field = if pair.is_staggered(&outer) {
        Field::staggered(&source, &pair, &outer, &mut report)?
    } else {
        Field::at_points(&source, &pair, &outer, &mut report)?
    };
    finished(field, times_unix_s, &kept, report)
}

/// The two components.
struct Pair<'a> {
    first: Found<'a>,
    second: Found<'a>,
    directions: Directions,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Directions {
    EastNorth,
    Grid,
    Unsaid,
}

impl<'a> Pair<'a> {
    fn chosen(source: &'a Source) -> Result<Self, NetcdfError> {
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

    /// Whether the components lie at different places: their horizontal dimensions differ.
    fn is_staggered(&self, outer: &[Outer; 2]) -> bool {
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

/// The dimensions of time and level of a component, by their places.
struct Outer {
    time: Option<usize>,
    level: Option<usize>,
}

impl Outer {
    fn of(source: &Source, found: &Found<'_>) -> Result<Self, NetcdfError> {
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

    fn places(&self) -> Vec<usize> {
        self.time.into_iter().chain(self.level).collect()
    }

    fn count(found: &Found<'_>, place: Option<usize>) -> usize {
        place.map_or(1, |i| found.dimensions()[i].size as usize)
    }
}

/// The records in order of time: their times and their stored places.
fn records(
    source: &Source,
    found: &Found<'_>,
    outer: &Outer,
    report: &mut FileReport,
) -> Result<(Vec<f64>, Vec<usize>), NetcdfError> {
    let Some(place) = outer.time else {
        report
            .assumed
            .push("the current has no time: it is taken as constant".into());
        return Ok((vec![0.0], vec![0]));
    };
    let dimension = &found.dimensions()[place];
    let clock = clock_of(source, dimension)?;
    let times = time::unix_seconds(&clock)?;
    report.variables.push(clock.report("time"));
    if times.undated {
        report.assumed.push(format!(
            "`{}` names no date: it counts from the model's own start",
            clock.name()
        ));
    }
    let kept = in_order(&clock, &times.unix_s, report)?;
    let times_unix_s: Vec<f64> = kept.iter().map(|&i| times.unix_s[i]).collect();
    if let (Some(&first), Some(&last)) = (times_unix_s.first(), times_unix_s.last()) {
        report.records = Some((first, last, times_unix_s.len()));
    }
    Ok((times_unix_s, kept))
}

/// The variable that holds the times along a dimension.
fn clock_of<'a>(
    source: &'a Source,
    dimension: &netcdf_reader::NcDimension,
) -> Result<Found<'a>, NetcdfError> {
    let mut clocks = Vec::new();
    for clock in source.all() {
        let own = matches!(clock.dimensions(), [own] if own.name == dimension.name);
        if own && axis_of(&clock)? == Some(Axis::Time) {
            clocks.push(clock);
        }
    }
    clocks.sort_by_key(|clock| clock.name() != dimension.name);
    clocks.first().copied().ok_or_else(|| NetcdfError::Missing {
        variable: "time",
        looked_for: format!(
            "a variable over `{}` with units like seconds since 2024-01-01, or ocean_time, time",
            dimension.name
        ),
    })
}

/// The stored places of the records in order of time, each time once.
fn in_order(
    clock: &Found<'_>,
    stored: &[f64],
    report: &mut FileReport,
) -> Result<Vec<usize>, NetcdfError> {
    let mut kept: Vec<usize> = (0..stored.len())
        .filter(|&i| stored[i].is_finite())
        .collect();
    let lost = stored.len() - kept.len();
    if kept
        .windows(2)
        .any(|pair| stored[pair[0]] > stored[pair[1]])
    {
        report.dropped.push(format!(
            "`{}`: records are not in order of time; they were sorted",
            clock.name()
        ));
    }
    kept.sort_by(|&a, &b| stored[a].total_cmp(&stored[b]));
    let before = kept.len();
    kept.dedup_by(|later, first| stored[*later] <= stored[*first]);
    for (count, what) in [
        (lost, "without a time"),
        (before - kept.len(), "of a time that an earlier one has"),
    ] {
        if count > 0 {
            report.dropped.push(format!(
                "`{}`: {count} records {what} are left out",
                clock.name()
            ));
        }
    }
    if kept.is_empty() {
        return Err(clock.error("has no time at all; give the times of the records"));
    }
    Ok(kept)
}

/// What both kinds of grid give.
struct Field {
    grid: Horizontal,
    bathymetry: Option<ChartedDepths>,
    layers: super::levels::Layers,
    /// True north and east, index `(time * layers + layer) * points + point` as stored.
    velocities_mps: Vec<[f32; 2]>,
}

impl Field {
    fn staggered(
        source: &Source,
        pair: &Pair<'_>,
        outer: &[Outer; 2],
        report: &mut FileReport,
    ) -> Result<Self, NetcdfError> {
        let (bathymetry, grid) = charted(source, report)?;
        if grid.regular && !grid.in_stored_order() {
            return Err(pair.first.error(
                "lies between the points of a grid whose latitudes or longitudes do not rise; turn the grid with `ncpdq`",
            ));
        }
        let layers = layers(
            source,
            level_name(&pair.first, &outer[0]),
            Some(&bathymetry),
            report,
        )?;
        let extent = Extent {
            times: Outer::count(&pair.first, outer[0].time),
            layers: Outer::count(&pair.first, outer[0].level),
            rows: grid.rows,
            columns: grid.columns,
        };
        let mut component =
            |found: &Found<'_>, outer: &Outer, axis: usize| -> Result<Vec<f64>, NetcdfError> {
                let unit = unit_of(found)?;
                let same = [
                    Outer::count(found, outer.time),
                    Outer::count(found, outer.level),
                ];
                if same != [extent.times, extent.layers] {
                    return Err(
                        found.footprint(format!("the times and layers of `{}`", pair.first.name()))
                    );
                }
                let (component, places) = ((found, unit), outer.places());
                destaggered(source, component, &places, &extent, axis, report)
            };
        let along = component(&pair.first, &outer[0], 1)?;
        let across = component(&pair.second, &outer[1], 0)?;
        report
            .converted
            .push("the current from between the model's points to them".into());
        let turns = turns(source, &grid, pair, true, report)?;
        let mut velocities_mps =
            turned(&along, &across, turns.as_deref(), grid.rows * grid.columns);
        mask_dry(&mut velocities_mps, &bathymetry);
        Ok(Self {
            grid,
            bathymetry: Some(bathymetry),
            layers,
            velocities_mps,
        })
    }

    fn at_points(
        source: &Source,
        pair: &Pair<'_>,
        outer: &[Outer; 2],
        report: &mut FileReport,
    ) -> Result<Self, NetcdfError> {
        let grid = horizontal(source, &pair.first, report)?;
        let points = grid.rows * grid.columns;
        let level = level_name(&pair.first, &outer[0]);
        // Layers that follow the bed need it; others do without.
        let bathymetry = match charted(source, &mut FileReport::default()) {
            Ok((chart, _)) if chart.depths_m().len() == points => Some(chart),
            _ => None,
        };
        let layers = layers(source, level, bathymetry.as_ref(), report)?;
        let mut component = |found: &Found<'_>, outer: &Outer| -> Result<Vec<f64>, NetcdfError> {
            let own = horizontal(source, found, &mut FileReport::default())?;
            let unit = unit_of(found)?;
            let mut values = own.lay_out(found, &outer.places())?;
            in_mps(found, unit, &mut values, report)?;
            Ok(values)
        };
        let along = component(&pair.first, &outer[0])?;
        let across = component(&pair.second, &outer[1])?;
        if along.len() != across.len() {
            return Err(pair
                .second
                .footprint(format!("the shape of `{}`", pair.first.name())));
        }
        let turns = turns(source, &grid, pair, false, report)?;
        let mut velocities_mps = turned(&along, &across, turns.as_deref(), points);
        let follows = matches!(
            layers.depths_m,
            crate::model_currents::LayerDepths::Point(_)
        );
        if let Some(chart) = bathymetry.as_ref().filter(|_| follows) {
            mask_dry(&mut velocities_mps, chart);
        }
        Ok(Self {
            grid,
            bathymetry: bathymetry.filter(|_| follows),
            layers,
            velocities_mps,
        })
    }
}

/// Takes the current off land.
fn mask_dry(velocities_mps: &mut [[f32; 2]], chart: &ChartedDepths) {
    let depths_m = chart.depths_m();
    for (i, velocity) in velocities_mps.iter_mut().enumerate() {
        let depth_m = depths_m[i % depths_m.len()];
        if depth_m.is_nan() || depth_m <= 0.0 {
            *velocity = [f32::NAN; 2];
        }
    }
}

fn level_name<'a>(found: &Found<'a>, outer: &Outer) -> Option<&'a str> {
    outer.level.map(|i| found.dimensions()[i].name.as_str())
}

/// Takes the kept records and the layers in order.
fn finished(
    field: Field,
    times_unix_s: Vec<f64>,
    kept: &[usize],
    mut report: FileReport,
) -> Result<(ModelCurrents, FileReport), NetcdfError> {
    let Field {
        grid,
        bathymetry,
        layers,
        velocities_mps: stored,
    } = field;
    let count = layers.order.len();
    let points = grid.rows * grid.columns;
    let (times, velocities_mps) =
        with_values(&stored, (&times_unix_s, kept), &layers.order, points)?;
    let empty = times_unix_s.len() - times.len();
    if empty > 0 {
        report
            .dropped
            .push(format!("{empty} records without any value are left out"));
    }
    if let (Some(&first), Some(&last), Some(records)) =
        (times.first(), times.last(), report.records.as_mut())
    {
        *records = (first, last, times.len());
    }
    report.dropped.extend(crate::oddities::oddities(
        grid.columns,
        &grid.latitudes_deg,
        &grid.longitudes_deg,
    ));
    let currents = ModelCurrents {
        bathymetry,
        columns: grid.columns,
        latitudes_deg: grid.latitudes_deg,
        longitudes_deg: grid.longitudes_deg,
        times_unix_s: times,
        layers: count,
        layer_depths_m: layers.depths_m,
        velocities_mps,
    };
    Ok((currents, report))
}

/// The records that hold any value: their times and velocities, layers in order.
fn with_values(
    stored: &[[f32; 2]],
    (times_unix_s, kept): (&[f64], &[usize]),
    order: &[usize],
    points: usize,
) -> Result<(Vec<f64>, Vec<[f32; 2]>), NetcdfError> {
    let count = order.len();
    let mut times = Vec::with_capacity(times_unix_s.len());
    let mut velocities_mps = Vec::with_capacity(stored.len());
    for (&time_s, &record) in times_unix_s.iter().zip(kept) {
        let of = |layer: usize| {
            stored.get((record * count + layer) * points..(record * count + layer + 1) * points)
        };
        let whole: Vec<[f32; 2]> = order
            .iter()
            .filter_map(|&layer| of(layer))
            .flatten()
            .copied()
            .collect();
        if whole.len() != count * points {
            return Err(NetcdfError::Data {
                variable: "current".into(),
                reason: "has fewer records or layers than times and depths; give one for each"
                    .into(),
            });
        }
        if whole.iter().any(|v| v[0].is_finite() && v[1].is_finite()) {
            times.push(time_s);
            velocities_mps.extend(whole);
        }
    }
    if times.is_empty() {
        return Err(NetcdfError::Data {
            variable: "current".into(),
            reason: "is missing everywhere; give a file with water in it".into(),
        });
    }
    Ok((times, velocities_mps))
}

/// Sine and cosine of the angle from east to the grid's rows at every point; `None` where the components are
/// eastward and northward.
fn turns(
    source: &Source,
    grid: &Horizontal,
    pair: &Pair<'_>,
    staggered: bool,
    report: &mut FileReport,
) -> Result<Option<Vec<(f64, f64)>>, NetcdfError> {
    let names = format!("`{}` and `{}`", pair.first.name(), pair.second.name());
    if pair.directions == Directions::EastNorth {
        return Ok(None);
    }
    if grid.regular && !staggered {
        if pair.directions == Directions::Unsaid {
            report.assumed.push(format!(
                "{names} are eastward and northward: rows go along latitude"
            ));
        }
        return Ok(None);
    }
    if let Some(found) = source.look(&["angle", "angle_rho"]) {
        let own = horizontal(source, &found, &mut FileReport::default())?;
        let mut angles = own.lay_out(&found, &[])?;
        if angles.len() != grid.rows * grid.columns {
            return Err(found.footprint("the shape of the grid"));
        }
        in_radians(&found, &mut angles, report)?;
        if pair.directions == Directions::Unsaid {
            report.assumed.push(format!(
                "{names} go along the grid and were turned by `{}`",
                found.name()
            ));
        }
        return Ok(Some(angles.into_iter().map(libm::sincos).collect()));
    }
    let (angles, widest_rad, right_handed) = geometric_angles(grid);
    if pair.directions == Directions::Unsaid && !staggered {
        if widest_rad < 0.01 {
            report.assumed.push(format!(
                "{names} are eastward and northward: rows go along latitude"
            ));
            return Ok(None);
        }
        return Err(pair.first.error(format!(
            "does not say whether it is eastward or along the grid, which is turned by up to {:.1} degrees; give \
             standard_name eastward_sea_water_velocity or sea_water_x_velocity",
            widest_rad.to_degrees()
        )));
    }
    if !right_handed {
        return Err(pair.first.error("goes along a grid whose rows go from north to south, without an `angle`; turn the grid with `ncpdq`"));
    }
    report.assumed.push(format!(
        "{names} were turned by the directions of the grid's rows: the file has no `angle`"
    ));
    Ok(Some(angles.into_iter().map(libm::sincos).collect()))
}

fn in_radians(
    found: &Found<'_>,
    angles: &mut [f64],
    report: &mut FileReport,
) -> Result<(), NetcdfError> {
    const TURN: f64 = 2.0 * std::f64::consts::PI;
    let widest = angles
        .iter()
        .copied()
        .filter(|x| x.is_finite())
        .map(f64::abs)
        .fold(0.0, f64::max);
    let units = found.text("units");
    let in_degrees = match &units {
        Some(units) => {
            let factor = units::factor(units, Quantity::Angle).ok_or_else(|| {
                found.error(format!("has units `{units}`; give radians or degrees"))
            })?;
            units::is_one(factor)
        }
        None => {
            let taken = if widest > TURN { "degrees" } else { "radians" };
            report
                .assumed
                .push(format!("`{}` has no units: taken as {taken}", found.name()));
            widest > TURN
        }
    };
    if !in_degrees && widest > TURN {
        return Err(found.contradiction(
            &format!("units `{}`", units.unwrap_or_default()),
            format!("its values, like {widest}"),
            "correct the units with `ncatted -a units`",
        ));
    }
    if in_degrees {
        for angle in angles.iter_mut() {
            *angle = angle.to_radians();
        }
        report
            .converted
            .push(format!("`{}` from degrees to radians", found.name()));
    }
    report
        .variables
        .push(found.report("angle of the grid").with_values(angles));
    Ok(())
}

/// The angle from east to each point's row by the positions of its neighbours, the widest of them, and
/// whether columns go to the left of rows.
fn geometric_angles(grid: &Horizontal) -> (Vec<f64>, f64, bool) {
    let at = |row: usize, column: usize| {
        let i = row * grid.columns + column;
        [grid.latitudes_deg[i], grid.longitudes_deg[i]]
    };
    let step = |from: [f64; 2], to: [f64; 2]| {
        let north = to[0] - from[0];
        let east = libm::remainder(to[1] - from[1], 360.0)
            * libm::cos((0.5 * (from[0] + to[0])).to_radians());
        [north, east]
    };
    let (mut angles, mut widest, mut left) =
        (Vec::with_capacity(grid.rows * grid.columns), 0.0, 0_i64);
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            let (west, east) = (column.saturating_sub(1), (column + 1).min(grid.columns - 1));
            let (south, north) = (row.saturating_sub(1), (row + 1).min(grid.rows - 1));
            let along = step(at(row, west), at(row, east));
            let across = step(at(south, column), at(north, column));
            let angle = libm::atan2(along[0], along[1]);
            widest = f64::max(widest, angle.abs());
            left += if along[1] * across[0] - along[0] * across[1] > 0.0 {
                1
            } else {
                -1
            };
            angles.push(angle);
        }
    }
    (angles, widest, left > 0)
}

/// True north and east of components along a grid's rows and columns.
fn turned(
    along: &[f64],
    across: &[f64],
    turns: Option<&[(f64, f64)]>,
    points: usize,
) -> Vec<[f32; 2]> {
    let pairs = along.iter().zip(across).enumerate();
    pairs
        .map(|(i, (&u, &v))| {
            let north_east = match turns {
                Some(turns) => north_east([u, v], turns[i % points]),
                None => [v, u],
            };
            north_east.map(|x| x as f32)
        })
        .collect()
}
