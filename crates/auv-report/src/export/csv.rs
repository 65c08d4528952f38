//! The flown track as comma-separated values.

use super::{Place, rounded};
use crate::Table;
use crate::record::MissionPicture;
use auv_ocean::LocalFrame;
use auv_types::libm;

/// The flown track as CSV (RFC 4180, one heading row), a row each recorded point.
///
/// | column | unit and sign |
/// |---|---|
/// | `time_s` | mission time, seconds since launch |
/// | `utc` | the same in UTC; left out where the launch is not known ([`MissionPicture::launched_at`]) |
/// | `latitude_deg`, `longitude_deg` | degrees on WGS84; left out without a frame |
/// | `depth_m` | metres below the sea surface, positive down |
/// | `north_m`, `east_m` | metres from the datum |
/// | `speed_mps`, `course_deg` | over ground from this point to the next (the last repeats the one before): metres per second along the track, degrees clockwise from local north |
/// | `altitude_m` | metres above the true sea bed (of a real flight: the charted one); empty without one |
/// | `leg` | number of the leg, from 1; 0 before the first |
///
/// Equal missions give equal text. A picture of a mission that was not recorded gives headings only.
#[must_use]
pub fn track_csv(picture: &MissionPicture, frame: Option<&LocalFrame>) -> String {
    let place: &[&str] = match frame {
        Some(_) => &["latitude_deg", "longitude_deg"],
        None => &[],
    };
    let rest = [
        "depth_m",
        "north_m",
        "east_m",
        "speed_mps",
        "course_deg",
        "altitude_m",
        "leg",
    ];
    let utc: &[&str] = match picture.launch_unix_s {
        Some(_) => &["utc"],
        None => &[],
    };
    let mut table = Table::new([&["time_s"][..], utc, place, &rest].concat());
    let bed = picture.setting.as_ref().and_then(|s| s.bed.as_ref());
    let number = |value: f64| rounded(value, 1e3).to_string();
    let (mut speed_mps, mut course_deg) = (0.0, 0.0);
    for (i, point) in picture.track.iter().enumerate() {
        if let Some(next) = picture.track.get(i + 1) {
            let step = next.position - point.position;
            speed_mps = step.norm() / (next.time_s - point.time_s);
            if step.xy().norm() > 0.0 {
                course_deg = libm::atan2(step.y, step.x).to_degrees();
            }
        }
        let position = &point.position;
        let mut row = vec![number(point.time_s)];
        row.extend(picture.utc(point.time_s));
        if let Some(frame) = frame {
            let place = Place::of(position, frame);
            row.extend([
                place.latitude_deg.to_string(),
                place.longitude_deg.to_string(),
            ]);
        }
        let bed_m = bed.map(|bed| bed.depth_at(position.x, position.y));
        let leg = picture.legs.partition_point(|leg| leg.at_s <= point.time_s);
        row.extend([
            number(position.z),
            number(position.x),
            number(position.y),
            number(speed_mps),
            number(course_deg.rem_euclid(360.0)),
            bed_m.map_or(String::new(), |bed_m| number(bed_m - position.z)),
            leg.to_string(),
        ]);
        table.row(row);
    }
    table.to_csv()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{back, flown, frame};
    use super::*;

    fn rows(text: &str) -> Vec<std::collections::BTreeMap<String, f64>> {
        let mut reader = ::csv::Reader::from_reader(text.as_bytes());
        let headings = reader.headers().unwrap().clone();
        let number = |text: &str| text.parse().unwrap_or(f64::NAN);
        let row = |record: ::csv::StringRecord| {
            let cells = headings.iter().zip(record.iter());
            cells.map(|(k, v)| (k.to_owned(), number(v))).collect()
        };
        reader
            .records()
            .map(|record| row(record.unwrap()))
            .collect()
    }

    #[test]
    fn every_point_is_read_back_within_a_millimetre() {
        let picture = flown();
        let rows = rows(&track_csv(&picture, Some(&frame())));
        assert_eq!(rows.len(), picture.track.len());
        for (row, point) in rows.iter().zip(&picture.track) {
            let again = back(row["longitude_deg"], row["latitude_deg"], -row["depth_m"]);
            assert!((again - point.position).norm() < 1e-3);
            assert!((row["north_m"] - point.position.x).abs() < 1e-3);
            assert!((row["time_s"] - point.time_s).abs() < 1e-3);
            assert!(row["altitude_m"].is_nan());
        }
        let length_m: f64 = picture
            .track
            .windows(2)
            .map(|p| (p[1].position - p[0].position).norm())
            .sum();
        let by_speed_m: f64 = rows
            .windows(2)
            .map(|r| r[0]["speed_mps"] * (r[1]["time_s"] - r[0]["time_s"]))
            .sum();
        assert!((length_m - by_speed_m).abs() < 1e-3 * length_m);
    }

    #[test]
    fn without_a_frame_there_are_no_latitudes() {
        let text = track_csv(&flown(), None);
        assert!(text.starts_with("time_s,depth_m,north_m,east_m,"));
        assert!(track_csv(&MissionPicture::new(), None).lines().count() == 1);
        let mut picture = flown();
        picture.launched_at(1_709_251_200.0);
        let text = track_csv(&picture, None);
        let mut lines = text.lines();
        assert!(lines.next().unwrap().starts_with("time_s,utc,depth_m"));
        assert!(
            lines
                .next()
                .unwrap()
                .starts_with("0,2024-03-01T00:00:00.000Z,")
        );
    }
}
