//! Goldens of currents, beds, ways through water and geodesy at fixed places.
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_ocean::{
    AnalyticBed, AnalyticCurrent, BedFeature, CurrentField, CurrentGain, Effect, Footprint,
    ForecastError, Geodetic, GriddedBed, GriddedCurrent, LambVortex, LocalFrame, MapGrid,
    Perturbed, SeaBed, TidalConstituent, Undulation, WaterMap,
};
use auv_types::{Point3, Seed};
use serde_json::{Value, json};

const PLACES: [[f64; 2]; 7] = [
    [0.0, 0.0],
    [120.5, -33.0],
    [400.0, 410.0],
    [777.7, 250.25],
    [-90.0, 900.0],
    [505.0, 495.0],
    [1300.0, 1400.0],
];

fn check(name: &str, found: &Value) {
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), name, found).unwrap();
}

fn bed() -> AnalyticBed {
    let shoal = Footprint::Disc {
        centre: [500.0, 500.0],
        radius_m: 80.0,
    };
    let basin = Footprint::Ellipse {
        centre: [200.0, 700.0],
        half_axis: [150.0, 60.0],
        half_width_m: 70.0,
    };
    let sill = Footprint::Line {
        points: vec![[0.0, 300.0], [400.0, 350.0], [900.0, 200.0]],
        half_width_m: 25.0,
    };
    let island = Footprint::Area {
        outline: vec![
            [700.0, 700.0],
            [850.0, 720.0],
            [820.0, 880.0],
            [690.0, 800.0],
        ],
    };
    let coast = Footprint::Beyond {
        through: [1200.0, 1200.0],
        towards: [1300.0, 1300.0],
    };
    let mut bed = AnalyticBed::new(60.0)
        .with(BedFeature::new("basin", basin, 110.0, 90.0).effect(Effect::Dig))
        .with(BedFeature::new("sill", sill, 25.0, 60.0).effect(Effect::Raise))
        .with(BedFeature::new("shoal", shoal, 8.0, 120.0))
        .with(BedFeature::new("island", island, -12.0, 70.0))
        .with(BedFeature::new("coast", coast, -30.0, 300.0));
    bed.undulations.push(Undulation {
        amplitude_m: 1.5,
        wavelength: [130.0, 70.0],
    });
    bed
}

fn current() -> AnalyticCurrent {
    AnalyticCurrent {
        mean_mps: [0.1, -0.05],
        tide: vec![
            TidalConstituent::turning_at(3_000.0, [0.6, 0.2]),
            TidalConstituent {
                major_mps: [0.1, 0.0],
                minor_mps: [0.0, 0.07],
                period_s: 86_164.0,
                strongest_s: 900.0,
            },
        ],
        gains: vec![CurrentGain {
            shape: Footprint::Disc {
                centre: [400.0, 300.0],
                radius_m: 100.0,
            },
            gain: 1.8,
            skirt_m: 250.0,
        }],
        vortices: vec![LambVortex {
            centre: [700.0, 300.0],
            circulation_m2ps: -400.0,
            core_radius_m: 90.0,
        }],
    }
}

fn grid() -> MapGrid {
    MapGrid::covering([-100.0, -100.0], [1300.0, 1400.0], 50.0)
}

fn depths(bed: &dyn SeaBed) -> Value {
    let of = |[n, e]: [f64; 2]| {
        json!([
            bed.depth_at(n, e),
            bed.max_slope_near(n, e, 40.0),
            bed.depth_sigma_m(n, e)
        ])
    };
    PLACES.map(of).into()
}

fn velocities(field: &dyn CurrentField) -> Value {
    let mut values = Vec::new();
    for (k, [n, e]) in PLACES.into_iter().enumerate() {
        for time_s in [0.0, 4_321.0, 50_000.0] {
            let v = field.velocity_at(&Point3::new(n, e, 7.0 * k as f64), time_s);
            values.push(json!([v.x, v.y, v.z]));
        }
    }
    json!({ "max_speed_mps": field.max_speed_mps(), "values": values })
}

#[test]
fn sea_beds() {
    let bed = bed();
    let gridded = GriddedBed::sampled(&bed, grid()).unwrap();
    let map = WaterMap::new(&bed, [-100.0, -100.0], [1300.0, 1400.0], 20.0, 30.0).unwrap();
    let pairs = [
        ([0.0, 0.0], [-90.0, 900.0]),
        ([0.0, 0.0], [950.0, 600.0]),
        ([0.0, 900.0], [1000.0, 100.0]),
        ([0.0, 0.0], [500.0, 500.0]),
    ];
    let ways = pairs.map(|(from, to)| {
        let way = map.path(from, to);
        way.map(|way| json!([way.length_m, way.points]))
    });
    check(
        "beds",
        &json!({ "analytic": depths(&bed), "gridded": depths(&gridded), "ways": ways }),
    );
}

#[test]
fn currents() {
    let analytic = current();
    let grid = grid();
    let (levels_m, times_s) = (vec![0.0, 10.0, 30.0], vec![0.0, 3_600.0, 7_200.0]);
    let mut values = Vec::new();
    for time_s in &times_s {
        for level_m in &levels_m {
            for row in 0..grid.rows {
                for column in 0..grid.columns {
                    let [n, e] = grid.place(row, column);
                    let v = analytic.velocity_at(&Point3::new(n, e, *level_m), *time_s);
                    let fade = (1.0 - 0.01 * level_m) as f32;
                    let land = n > 1_000.0 && e > 1_000.0;
                    let value = [v.x as f32 * fade, v.y as f32 * fade];
                    values.push(if land { [f32::NAN; 2] } else { value });
                }
            }
        }
    }
    let gridded = GriddedCurrent::new(grid, levels_m, times_s, values).unwrap();
    let perturbed = Perturbed::new(current(), ForecastError::draw(Seed(9)));
    check(
        "currents",
        &json!({
            "analytic": velocities(&analytic),
            "gridded": velocities(&gridded),
            "perturbed": velocities(&perturbed),
        }),
    );
}

#[test]
fn geodesy() {
    let place = |latitude_deg, longitude_deg, depth_m| Geodetic {
        latitude_deg,
        longitude_deg,
        depth_m,
    };
    let mut found = Vec::new();
    for datum in [
        place(49.5, -124.8, 0.0),
        place(-33.9, 179.99, 0.0),
        place(69.2, 13.4, 0.0),
    ] {
        let frame = LocalFrame::new(datum).unwrap();
        for [north_m, east_m] in PLACES {
            let local = Point3::new(12.0 * north_m, 12.0 * east_m, 30.0);
            let far = frame.to_geodetic(&local);
            let back = frame.to_local(&far);
            found.push(json!([
                far.latitude_deg,
                far.longitude_deg,
                back.x,
                back.y,
                frame.bearing_of_true_north(&far),
                frame.distance_m(&datum, &far)
            ]));
        }
    }
    check("geodesy", &json!(found));
}
