//! The columns of a table of ship positions, found by their names.

use super::error::AisError;

/// The names of a table's columns where they are not the usual ones. A name that is not given is looked
/// for under the names that MarineCadastre (old and new) and the Danish Maritime Authority use.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(default, deny_unknown_fields)
)]
pub struct ColumnNames {
    /// The ship's number or name.
    pub vessel: Option<String>,
    /// Time of the position.
    pub time: Option<String>,
    /// Degrees north.
    pub latitude: Option<String>,
    /// Degrees east.
    pub longitude: Option<String>,
    /// Speed over ground, knots.
    pub speed: Option<String>,
    /// Course over ground, degrees.
    pub course: Option<String>,
    /// Heading, degrees.
    pub heading: Option<String>,
    /// Navigational status, its number or text.
    pub status: Option<String>,
    /// Type of ship, its number.
    pub vessel_type: Option<String>,
    /// Length over all, metres.
    pub length: Option<String>,
    /// Beam, metres.
    pub width: Option<String>,
    /// Draught, metres.
    pub draught: Option<String>,
}

/// Where each column is.
pub(super) struct Columns {
    pub(super) vessel: usize,
    pub(super) time: usize,
    pub(super) latitude: usize,
    pub(super) longitude: usize,
    pub(super) speed: Option<usize>,
    pub(super) course: Option<usize>,
    pub(super) heading: Option<usize>,
    pub(super) status: Option<usize>,
    pub(super) vessel_type: Option<usize>,
    pub(super) length: Option<usize>,
    pub(super) width: Option<usize>,
    pub(super) draught: Option<usize>,
    /// What sends: a ship, a buoy, a station ashore.
    pub(super) sender: Option<usize>,
}

/// A name without case, blanks, signs and underscores: `# Timestamp` and `base_date_time` are
/// `timestamp` and `basedatetime`.
fn plain(name: &str) -> String {
    name.chars()
        .filter(char::is_ascii_alphanumeric)
        .map(|c| c.to_ascii_lowercase())
        .collect()
}

impl Columns {
    /// What a row has in the column of times.
    pub(super) fn time_of<'a>(&self, record: &'a csv::StringRecord) -> &'a str {
        record.get(self.time).unwrap_or_default()
    }

    pub(super) fn of<'a>(
        header: impl Iterator<Item = &'a str>,
        names: &ColumnNames,
    ) -> Result<Self, AisError> {
        let header: Vec<&str> = header.collect();
        let plainly: Vec<String> = header.iter().map(|name| plain(name)).collect();
        let find = |given: &Option<String>, usual: &[&str]| match given {
            Some(name) => match header.iter().position(|n| n.trim() == name.trim()) {
                Some(column) => Ok(Some(column)),
                None => Err(AisError::MissingColumn {
                    column: name.clone(),
                }),
            },
            None => Ok(usual
                .iter()
                .find_map(|name| plainly.iter().position(|n| n == name))),
        };
        let need = |given: &Option<String>, usual: &[&str], column: &str| {
            find(given, usual)?.ok_or_else(|| AisError::MissingColumn {
                column: column.into(),
            })
        };
        Ok(Self {
            vessel: need(&names.vessel, &["mmsi", "vessel"], "vessel")?,
            time: need(
                &names.time,
                &["basedatetime", "timestamp", "time", "datetime"],
                "BaseDateTime",
            )?,
            latitude: need(&names.latitude, &["lat", "latitude"], "LAT")?,
            longitude: need(&names.longitude, &["lon", "longitude"], "LON")?,
            speed: find(&names.speed, &["sog"])?,
            course: find(&names.course, &["cog"])?,
            heading: find(&names.heading, &["heading"])?,
            status: find(&names.status, &["status", "navigationalstatus"])?,
            vessel_type: find(&names.vessel_type, &["vesseltype", "shiptype"])?,
            length: find(&names.length, &["length"])?,
            width: find(&names.width, &["width", "beam"])?,
            draught: find(&names.draught, &["draft", "draught"])?,
            sender: find(&None, &["typeofmobile"])?,
        })
    }
}
