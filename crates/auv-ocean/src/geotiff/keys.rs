//! What a GeoTIFF says of its coordinates.

use super::error::GeotiffError;
use super::utm::Zone;
use std::io::Cursor;
use tiff::decoder::Decoder;
use tiff::tags::Tag;

pub(super) type Image<'a> = Decoder<Cursor<&'a [u8]>>;

/// The coordinates that the file's own are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coordinates {
    /// Degrees east and north on WGS84.
    Degrees,
    /// Eastings and northings.
    Utm(Zone),
}

/// What the geo keys say.
pub(super) struct Keys {
    pub(super) coordinates: Coordinates,
    /// Half a cell where a position is that of a cell's corner.
    pub(super) offset: f64,
    /// Metres of a unit of the values, where the vertical system says.
    pub(super) unit_m: Option<f64>,
    /// Whether the vertical system counts depths.
    pub(super) depths: bool,
}

/// Vertical systems that count downwards.
fn counts_depths(code: u16) -> bool {
    matches!(code, 5715 | 5831 | 5861..=5874)
}

pub(super) fn keys(image: &mut Image<'_>) -> Result<Keys, GeotiffError> {
    let directory: Vec<u16> = image
        .find_tag_unsigned_vec(Tag::GeoKeyDirectoryTag)
        .ok()
        .flatten()
        .ok_or(GeotiffError::NoGeoreference)?;
    let entry = |key: u16| {
        let mut entries = directory.get(4..).unwrap_or_default().chunks_exact(4);
        // The value lies in the entry itself where its location is 0.
        entries.find(|e| e[0] == key && e[1] == 0).map(|e| e[3])
    };
    let refused = |what: String| Err(GeotiffError::Reference { what });
    let coordinates = match (entry(1024), entry(2048), entry(3072)) {
        (Some(2), Some(4326), _) => Coordinates::Degrees,
        (Some(2), Some(other), _) => return refused(format!("the geographic system EPSG:{other}")),
        (Some(1), _, Some(code @ (32_601..=32_660 | 32_701..=32_760))) => Coordinates::Utm(Zone {
            number: code % 100,
            south: code > 32_700,
        }),
        (Some(1), _, Some(32_767) | None) => {
            return refused("a map projection of its own".into());
        }
        (Some(1), _, Some(other)) => return refused(format!("the projection EPSG:{other}")),
        _ => return refused("no coordinate system".into()),
    };
    match (coordinates, entry(2054), entry(3076)) {
        (Coordinates::Degrees, Some(unit), _) if unit != 9102 => {
            return refused(format!("the angular unit EPSG:{unit}"));
        }
        (Coordinates::Utm(_), _, Some(unit)) if unit != 9001 => {
            return refused(format!("the linear unit EPSG:{unit}"));
        }
        _ => {}
    }
    let unit_m = match entry(4099) {
        Some(9001) => Some(1.0),
        Some(9002) => Some(0.3048),
        Some(9003) => Some(1_200.0 / 3_937.0),
        Some(9014) => Some(1.8288),
        None => None,
        Some(other) => return refused(format!("the vertical unit EPSG:{other}")),
    };
    Ok(Keys {
        coordinates,
        offset: if entry(1025) == Some(2) { 0.0 } else { 0.5 },
        unit_m,
        depths: entry(4096).is_some_and(counts_depths),
    })
}

/// From column and row to the file's coordinates: x = a column + b row + c, y = d column + e row + f.
#[derive(Clone, Copy, Debug)]
pub(super) struct Affine(pub(super) [f64; 6]);

impl Affine {
    pub(super) fn of(image: &mut Image<'_>) -> Result<Self, GeotiffError> {
        let mut numbers = |tag| image.get_tag_f64_vec(tag).ok();
        if let Some(matrix) = numbers(Tag::ModelTransformationTag)
            && let &[a, b, _, c, d, e, _, f, ..] = matrix.as_slice()
        {
            return Self([a, b, c, d, e, f]).sound();
        }
        let (scale, tie) = (
            numbers(Tag::ModelPixelScaleTag),
            numbers(Tag::ModelTiepointTag),
        );
        match (scale.as_deref(), tie.as_deref()) {
            (Some(&[wide, high, ..]), Some(&[column, row, _, x, y, _])) => {
                Self([wide, 0.0, x - column * wide, 0.0, -high, y + row * high]).sound()
            }
            _ => Err(GeotiffError::NoGeoreference),
        }
    }

    fn sound(self) -> Result<Self, GeotiffError> {
        let [a, b, _, d, e, _] = self.0;
        let area = a * e - b * d;
        if self.0.iter().all(|x| x.is_finite()) && area.abs() > 0.0 {
            Ok(self)
        } else {
            Err(GeotiffError::NoGeoreference)
        }
    }

    pub(super) fn at(&self, column: f64, row: f64) -> [f64; 2] {
        let [a, b, c, d, e, f] = self.0;
        [a * column + b * row + c, d * column + e * row + f]
    }
}
