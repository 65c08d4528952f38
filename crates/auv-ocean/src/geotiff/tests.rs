//! Tests of reading GeoTIFF files that the tests write.

use super::*;
use crate::{Geodetic, LocalFrame, SeaBed};
use tiff::encoder::{TiffEncoder, colortype::Gray32Float};

/// A TIFF of 20 x 30 cells, 10 m shallow at row 5 and column 7, with geo keys.
fn file(keys: &[[u16; 4]], scale: [f64; 2], tie: [f64; 2], value: impl Fn(f32) -> f32) -> Vec<u8> {
    file_with(keys, (scale, tie), "", value)
}

/// The same with GDAL's metadata.
fn file_with(
    keys: &[[u16; 4]],
    (scale, tie): ([f64; 2], [f64; 2]),
    metadata: &str,
    value: impl Fn(f32) -> f32,
) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<Gray32Float>(30, 20).unwrap();
    let mut directory = vec![1_u16, 1, 0, keys.len() as u16];
    directory.extend(keys.iter().flatten());
    let tags = image.encoder();
    tags.write_tag(Tag::GeoKeyDirectoryTag, &directory[..])
        .unwrap();
    tags.write_tag(Tag::ModelPixelScaleTag, &[scale[0], scale[1], 0.0][..])
        .unwrap();
    tags.write_tag(
        Tag::ModelTiepointTag,
        &[0.0, 0.0, 0.0, tie[0], tie[1], 0.0][..],
    )
    .unwrap();
    tags.write_tag(Tag::GdalNodata, "-9999").unwrap();
    if !metadata.is_empty() {
        tags.write_tag(Tag::Unknown(42_112), metadata).unwrap();
    }
    let values: Vec<f32> = (0..600)
        .map(|i| match (i / 30, i % 30) {
            (5, 7) => value(10.0),
            (0, 0) => -9999.0,
            _ => value(60.0),
        })
        .collect();
    image.write_data(&values).unwrap();
    bytes.into_inner()
}

const DEGREES: [[u16; 4]; 3] = [[1024, 0, 1, 2], [2048, 0, 1, 4326], [4099, 0, 1, 9001]];

fn shoal(bytes: &[u8]) -> Geodetic {
    let (chart, _) = read_geotiff(bytes).unwrap();
    let mut soundings = chart.soundings();
    soundings.find(|s| (s.depth_m - 10.0).abs() < 1e-3).unwrap()
}

#[test]
fn cells_have_centres_and_points_have_none() {
    let area = shoal(&file(&DEGREES, [0.01, 0.01], [10.0, 58.0], |depth| -depth));
    assert!(
        (area.latitude_deg - 57.945).abs() < 1e-9 && (area.longitude_deg - 10.075).abs() < 1e-9
    );
    let mut keys = DEGREES.to_vec();
    keys.insert(1, [1025, 0, 1, 2]);
    let point = shoal(&file(&keys, [0.01, 0.01], [10.0, 58.0], |depth| -depth));
    assert!(
        (point.latitude_deg - 57.95).abs() < 1e-9 && (point.longitude_deg - 10.07).abs() < 1e-9
    );
    let (chart, report) =
        read_geotiff(&file(&DEGREES, [0.01, 0.01], [10.0, 58.0], |d| -d)).unwrap();
    assert!((report.variables[0].missing_share - 1.0 / 600.0).abs() < 1e-12);
    let frame = LocalFrame::new(chart.centre().unwrap()).unwrap();
    assert!(chart.to_bed(&frame, 100.0).unwrap().depth_at(0.0, 0.0) > 59.9);
}

#[test]
fn utm_depths_and_feet_are_converted() {
    let utm = |code: u16| {
        [
            [1024, 0, 1, 1],
            [3072, 0, 1, code],
            [4096, 0, 1, 5831],
            [4099, 0, 1, 9002],
        ]
    };
    let feet = |depth: f32| depth / 0.3048;
    let north = shoal(&file(
        &utm(32_632),
        [100.0, 100.0],
        [500_000.0, 6_500_000.0],
        feet,
    ));
    let zone = utm::Zone {
        number: 32,
        south: false,
    };
    let [latitude, longitude] = zone.degrees(500_750.0, 6_499_450.0);
    assert!(
        (north.latitude_deg - latitude).abs() < 1e-9
            && (north.longitude_deg - longitude).abs() < 1e-9
    );
    let south = shoal(&file(
        &utm(32_732),
        [100.0, 100.0],
        [500_000.0, 6_500_000.0],
        feet,
    ));
    assert!(south.latitude_deg < -31.0);
}

#[test]
fn what_is_not_read_is_refused_by_name() {
    let refusal = |keys: &[[u16; 4]], value: fn(f32) -> f32| {
        read_geotiff(&file(keys, [0.01, 0.01], [10.0, 58.0], value))
            .unwrap_err()
            .to_string()
    };
    let up = |depth: f32| -depth;
    for (keys, named) in [
        ([[1024, 0, 1, 1], [3072, 0, 1, 3857]], "EPSG:3857"),
        ([[1024, 0, 1, 2], [2048, 0, 1, 4258]], "EPSG:4258"),
        ([[1024, 0, 1, 1], [3072, 0, 1, 32_767]], "of its own"),
        ([[1025, 0, 1, 1], [1026, 0, 1, 1]], "no coordinate system"),
    ] {
        assert!(refusal(&keys, up).contains(named), "{named}");
    }
    assert!(refusal(&DEGREES, |depth| depth).contains("no water in the whole chart"));
    let metres = [[1024, 0, 1, 2], [2048, 0, 1, 4326], [4099, 0, 1, 9036]];
    assert!(refusal(&metres, up).contains("EPSG:9036"));
    assert!(matches!(
        read_geotiff(b"II*\0"),
        Err(GeotiffError::NotTiff { .. })
    ));
}

#[test]
fn scale_offset_and_unit_of_the_metadata_count() {
    let item = |role: &str, value: &str| {
        format!(
            "<GDALMetadata><Item name=\"{role}\" sample=\"0\" role=\"{role}\">{value}</Item></GDALMetadata>"
        )
    };
    let keys = &DEGREES[..2];
    let read = |keys: &[[u16; 4]], metadata: &str, value: fn(f32) -> f32| {
        read_geotiff(&file_with(
            keys,
            ([0.01, 0.01], [10.0, 58.0]),
            metadata,
            value,
        ))
    };
    let deepest = |metadata: &str, value: fn(f32) -> f32| {
        let (chart, _) = read(keys, metadata, value).unwrap();
        chart.depths_m().iter().copied().fold(0.0, f64::max)
    };
    assert!((deepest(&item("scale", "0.01"), |d| -100.0 * d) - 60.0).abs() < 1e-3);
    assert!((deepest(&item("offset", "-50"), |d| 50.0 - d) - 60.0).abs() < 1e-3);
    assert!((deepest(&item("unittype", "ft"), |d| -d / 0.3048) - 60.0).abs() < 1e-3);
    for (role, value, told) in [
        ("unittype", "parsec", "the unit `parsec`"),
        ("scale", "many", "scale `many`"),
    ] {
        let refusal = read(keys, &item(role, value), |d| -d).unwrap_err();
        assert!(refusal.to_string().contains(told), "{refusal}");
    }
    let refusal = read(&DEGREES, &item("unittype", "feet"), |d| -d).unwrap_err();
    assert!(
        refusal
            .to_string()
            .contains("by their vertical system and of 0.3048 m"),
        "{refusal}"
    );
}
