//! What GDAL's metadata say of the values.

use super::error::GeotiffError;
use super::keys::Image;
use crate::units::{self, Quantity};
use tiff::tags::Tag;

const GDAL_METADATA: u16 = 42_112;

/// The XML text, in lower case: `<Item name="SCALE" sample="0" role="scale">0.01</Item>`.
pub(super) struct Metadata(String);

impl Metadata {
    pub(super) fn of(image: &mut Image<'_>) -> Self {
        let text = image.get_tag_ascii_string(Tag::Unknown(GDAL_METADATA));
        Self(text.unwrap_or_default().to_ascii_lowercase())
    }

    /// The attributes and the text of every item.
    fn items(&self) -> impl Iterator<Item = (&str, &str)> {
        let items = self.0.split("<item").skip(1);
        items.filter_map(|item| {
            let (attributes, rest) = item.split_once('>')?;
            Some((attributes, rest.split('<').next()?.trim()))
        })
    }

    fn role(&self, role: &str) -> Option<&str> {
        let wanted = format!("role=\"{role}\"");
        let mut items = self.items();
        items
            .find(|item| item.0.contains(&wanted))
            .map(|item| item.1)
    }

    /// Whether an item `positive`, or one of a variable like `elevation#positive`, is this word.
    pub(super) fn positive(&self, way: &str) -> bool {
        let mut items = self.items();
        items.any(|(attributes, text)| attributes.contains("positive\"") && text == way)
    }

    /// Scale and offset of the values, where there is one of them.
    pub(super) fn packing(&self) -> Result<Option<(f64, f64)>, GeotiffError> {
        let number = |role: &str, unsaid: f64| match self.role(role) {
            None => Ok(unsaid),
            Some(text) => text
                .parse()
                .ok()
                .filter(|x: &f64| x.is_finite())
                .ok_or_else(|| GeotiffError::Values {
                    reason: format!("have {role} `{text}` by their metadata; give a number"),
                }),
        };
        let packing = (number("scale", 1.0)?, number("offset", 0.0)?);
        let unpacked = packing.0.total_cmp(&1.0).is_eq() && packing.1.total_cmp(&0.0).is_eq();
        Ok((!unpacked).then_some(packing))
    }

    /// Metres of a unit of the values.
    pub(super) fn unit_m(&self) -> Result<Option<f64>, GeotiffError> {
        let Some(text) = self.role("unittype").filter(|text| !text.is_empty()) else {
            return Ok(None);
        };
        match units::factor(text, Quantity::Length) {
            Some(unit_m) => Ok(Some(unit_m)),
            None => Err(GeotiffError::Values {
                reason: format!(
                    "have the unit `{text}` by their metadata; give metres, feet or fathoms"
                ),
            }),
        }
    }
}
