//! A flown track from comma-separated values.

use auv_obstacles::TimedPoint;
use auv_ocean::{Geodetic, LocalFrame};
use auv_types::{Point3, Violations};

/// The track of a vehicle from comma-separated values with a row of headings: what [`crate::track_csv`] writes, or the
/// log of a real vehicle.
///
/// Read are the columns `time_s` (mission time), `depth_m` (positive down), and `north_m` and `east_m`, or, given a
/// frame, `latitude_deg` and `longitude_deg`. Their order does not matter; other columns are left out. Give the points
/// to [`crate::MissionPicture::fly`], which says how many of them are out of order.
///
/// # Errors
/// A missing column; a field that is not a finite number, by line and column.
pub fn read_track(text: &str, frame: Option<&LocalFrame>) -> Result<Vec<TimedPoint>, Violations> {
    let mut violations = Violations::new();
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(text.trim_start_matches('\u{feff}').as_bytes());
    let headings = reader.headers().cloned().unwrap_or_default();
    let column = |name: &str| headings.iter().position(|heading| heading == name);
    let local = column("north_m").is_some() && column("east_m").is_some();
    let place = match frame {
        Some(_) if !local => ["latitude_deg", "longitude_deg"],
        _ => ["north_m", "east_m"],
    };
    let names = ["time_s", "depth_m", place[0], place[1]];
    let columns = names.map(column);
    for (name, column) in names.iter().zip(columns) {
        violations.require(column.is_some(), name, || {
            missing(&headings, frame.is_some())
        });
    }
    let mut track = Vec::new();
    for record in reader.records() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                violations.push("row", error.to_string());
                continue;
            }
        };
        let line = record.position().map_or(0, csv::Position::line);
        let field = |k: usize| record.get(columns[k].unwrap_or(usize::MAX)).unwrap_or("");
        let numbers = [0, 1, 2, 3].map(|k| field(k).parse().unwrap_or(f64::NAN));
        for (k, number) in numbers.iter().enumerate() {
            if columns[k].is_some() && !number.is_finite() {
                let text = field(k);
                violations.push(
                    format!("line {line}, {}", names[k]),
                    format!("is {text:?}; give a finite number"),
                );
            }
        }
        let [time_s, depth_m, a, b] = numbers;
        let position = match frame {
            Some(frame) if !local => frame.to_local(&Geodetic {
                latitude_deg: a,
                longitude_deg: b,
                depth_m,
            }),
            _ => Point3::new(a, b, depth_m),
        };
        track.push(TimedPoint::new(position, time_s));
    }
    violations.into_result()?;
    Ok(track)
}

fn missing(headings: &csv::StringRecord, framed: bool) -> String {
    let read = headings.iter().collect::<Vec<_>>().join(", ");
    let geodetic = match framed {
        true => " or latitude_deg and longitude_deg",
        false => " (latitudes need a mission with a datum)",
    };
    format!(
        "is no column of this file, which has {read:?}; give time_s, depth_m, and north_m and east_m{geodetic}"
    )
}

#[cfg(test)]
mod tests {
    use super::super::tests::{flown, frame};
    use super::*;
    use crate::places::place_at;
    use crate::{MissionPicture, mission_geojson, mission_svg, replay_html, track_csv};
    use auv_types::Vector3;
    use std::sync::Arc;

    #[test]
    fn what_was_written_is_read_back() {
        let picture = flown();
        for frame in [None, Some(&frame())] {
            let track = read_track(&track_csv(&picture, frame), frame).unwrap();
            assert_eq!(track.len(), picture.track.len());
            for (a, b) in track.iter().zip(&picture.track) {
                assert!(
                    (a.position - b.position).norm() < 1e-2 && (a.time_s - b.time_s).abs() < 1e-3
                );
            }
        }
    }

    #[test]
    fn columns_in_any_order_and_latitudes_alone_are_read() {
        let text = "\u{feff}depth_m, longitude_deg,latitude_deg,time_s,note\n5,-5.25,56.5,0,launch\n6,-5.25,56.501,70,\n";
        let track = read_track(text, Some(&frame())).unwrap();
        assert_eq!(
            (track.len(), track[1].time_s, track[1].position.z),
            (2, 70.0, 6.0)
        );
        assert!((track[1].position.x - 111.36).abs() < 0.05, "{track:?}");
    }

    #[test]
    fn wrong_columns_and_numbers_are_named_with_their_remedy() {
        let error = read_track("time_s,depth_m,latitude_deg\n0,1,2\n", None)
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("north_m") && error.contains("need a mission with a datum"),
            "{error}"
        );
        let text = "time_s,depth_m,north_m,east_m\n0,1,2,3\n1,x,2,3\n2,1,inf,3\n3,1,2\n";
        let error = read_track(text, None).unwrap_err().to_string();
        for part in ["line 3, depth_m is \"x\"", "line 4, north_m", "row"] {
            assert!(error.contains(part), "{part}: {error}");
        }
    }

    /// A real flight: the track comes from a log, beside what was planned; nothing true is known.
    #[test]
    fn a_real_flight_is_drawn_beside_its_plan() {
        let simulated = flown();
        let mission = Arc::clone(&simulated.setting.as_ref().unwrap().mission);
        let mut picture = MissionPicture::of_flight("survey 12", mission);
        for (time_s, trajectory) in &simulated.follows {
            picture.follow(*time_s, trajectory);
        }
        let off =
            |p: &TimedPoint| TimedPoint::new(p.position + Vector3::new(0.0, 9.0, 0.0), p.time_s);
        let track: Vec<_> = simulated.track.iter().map(off).collect();
        let twice = [
            &track[..],
            &track[..1],
            &[TimedPoint::new(Point3::origin(), f64::NAN)],
        ]
        .concat();
        assert_eq!(picture.fly(&twice, &[]), 2);
        let svg = mission_svg(&picture);
        assert!(
            svg.contains(">planned<") && svg.contains("survey 12"),
            "{svg}"
        );
        assert!(!svg.contains("where they truly were") && !svg.contains("NaN"));
        assert!(!mission_svg(&simulated).contains(">planned<"));
        assert!(replay_html(&picture).contains("survey 12"));
        let text = mission_geojson(&picture, &frame()).unwrap();
        let planned = text.matches("\"planned\"").count();
        assert_eq!(planned, simulated.follows.len());
        // Each is drawn where it was in force.
        for planned in picture.followed().flatten() {
            let flown = place_at(&simulated.track, planned.time_s).unwrap();
            assert!(
                (flown - planned.position).norm() < 5.0,
                "at {} s",
                planned.time_s
            );
        }
    }
}
