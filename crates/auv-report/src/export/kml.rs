//! A flown mission as KML.

use super::way::{EXACT_M, thinned, way_of_call};
use super::{ExportError, Place};
use crate::mission_svg::{subtitle, title};
use crate::places::name_of;
use crate::record::MissionPicture;
use crate::utc::date_time;
use ::kml::types::{
    AltitudeMode, Coord, Element, Folder, Geometry, LineString, LineStyle, Placemark, Point, Style,
};
use ::kml::{Kml, KmlDocument, KmlWriter};
use auv_graph::NodeId;
use auv_mission::Mission;
use auv_ocean::LocalFrame;
use auv_types::Point3;
use std::collections::HashMap;

/// A flown mission as KML 2.2: the track as a `gx:Track`, which a time slider plays; waypoints; the
/// routes that went into force.
///
/// Altitudes are metres above the sea surface, positive up, so minus the depth (altitude mode
/// `absolute`). KML knows calendar time only: the track begins at `launch_unix_s`, seconds since
/// 1970-01-01 00:00 UTC. A mission without a date begins at 0.
///
/// Equal missions give equal text.
///
/// # Errors
/// No mission was recorded.
pub fn track_kml(
    picture: &MissionPicture,
    frame: &LocalFrame,
    launch_unix_s: f64,
) -> Result<String, ExportError> {
    let setting = picture.setting.as_ref();
    let mission = &setting.ok_or(ExportError::NotRecorded)?.mission;
    let coord = |point: &Point3<f64>| {
        let place = Place::of(point, frame);
        Coord::new(
            place.longitude_deg,
            place.latitude_deg,
            Some(place.elevation_m),
        )
    };
    let about = format!(
        "{} Mission time 0 is {}. Altitudes are metres above the sea surface: minus the depth. {}",
        subtitle(picture),
        date_time(launch_unix_s),
        picture.notes.join(" ")
    );
    let document = Kml::Document {
        attrs: HashMap::new(),
        elements: vec![
            Kml::Element(element("name", title(picture))),
            Kml::Element(element("description", about.trim_end().to_owned())),
            line_style("track", "ffb27200", 3.0),
            line_style("route", "99999999", 1.5),
            track(picture, &coord, launch_unix_s),
            waypoints(mission, &coord),
            routes(picture, mission, &coord),
        ],
    };
    // One attribute an element: more would be written in an order that changes from run to run.
    let file = Kml::KmlDocument(KmlDocument {
        attrs: attribute("xmlns", "http://www.opengis.net/kml/2.2"),
        elements: vec![document],
        ..KmlDocument::default()
    });
    let mut bytes = b"<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_vec();
    KmlWriter::from_writer(&mut bytes).write(&file)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

fn attribute(name: &str, value: &str) -> HashMap<String, String> {
    HashMap::from([(name.to_owned(), value.to_owned())])
}

fn element(name: &str, content: String) -> Element {
    Element {
        name: name.into(),
        content: Some(content),
        ..Element::default()
    }
}

/// `colour` is alpha, blue, green, red.
fn line_style(id: &str, colour: &str, width: f64) -> Kml {
    Kml::Style(Style {
        id: Some(id.into()),
        line: Some(LineStyle {
            color: colour.into(),
            width,
            ..LineStyle::default()
        }),
        ..Style::default()
    })
}

fn track(
    picture: &MissionPicture,
    coord: &dyn Fn(&Point3<f64>) -> Coord,
    launch_unix_s: f64,
) -> Kml {
    let kept = thinned(&picture.track, EXACT_M);
    let mut children = vec![element("altitudeMode", "absolute".into())];
    children.extend(
        kept.iter()
            .map(|p| element("when", date_time(launch_unix_s + p.time_s))),
    );
    children.extend(kept.iter().map(|p| {
        let Coord { x, y, z } = coord(&p.position);
        element("gx:coord", format!("{x} {y} {}", z.unwrap_or(0.0)))
    }));
    let track = Element {
        name: "gx:Track".into(),
        attrs: attribute("xmlns:gx", "http://www.google.com/kml/ext/2.2"),
        children,
        ..Element::default()
    };
    Kml::Placemark(Placemark {
        name: Some("flown track".into()),
        children: vec![element("styleUrl", "#track".into()), track],
        ..Placemark::default()
    })
}

fn waypoints(mission: &Mission, coord: &dyn Fn(&Point3<f64>) -> Coord) -> Kml {
    let waypoints = mission.network.waypoints().iter().enumerate();
    let placemark = |(i, waypoint): (usize, &auv_graph::Waypoint)| {
        Kml::Placemark(Placemark {
            name: Some(name_of(mission, NodeId(i as u32))),
            description: Some(format!("depth {} m", waypoint.position.z)),
            geometry: Some(Geometry::Point(Point {
                altitude_mode: AltitudeMode::Absolute,
                ..Point::from(coord(&waypoint.position))
            })),
            ..Placemark::default()
        })
    };
    Kml::Folder(Folder {
        name: Some("waypoints".into()),
        elements: waypoints.map(placemark).collect(),
        ..Folder::default()
    })
}

fn routes(
    picture: &MissionPicture,
    mission: &Mission,
    coord: &dyn Fn(&Point3<f64>) -> Coord,
) -> Kml {
    let adopted = picture.routes.iter().filter(|call| call.adopted);
    let placemark = |call: &auv_mission::RouteCall| {
        let way = way_of_call(picture, mission, call);
        Kml::Placemark(Placemark {
            name: Some(format!("route {} ({})", call.call, call.reason.as_str())),
            description: Some(format!(
                "at {:.0} s, {} tasks, weight {:.2}, {:.0} s",
                call.at_s, call.tasks, call.route_weight, call.route_s
            )),
            geometry: Some(Geometry::LineString(LineString {
                altitude_mode: AltitudeMode::Absolute,
                ..LineString::from(way.iter().map(coord).collect::<Vec<_>>())
            })),
            style_url: Some("#route".into()),
            ..Placemark::default()
        })
    };
    Kml::Folder(Folder {
        name: Some("routes in force".into()),
        elements: adopted.map(placemark).collect(),
        ..Folder::default()
    })
}

#[cfg(test)]
mod tests {
    use super::super::tests::{back, flown, frame};
    use super::*;

    #[test]
    fn what_is_read_back_is_the_mission_within_a_millimetre() {
        let picture = flown();
        let text = track_kml(&picture, &frame(), 0.0).unwrap();
        assert_eq!(text, track_kml(&flown(), &frame(), 0.0).unwrap());
        let Kml::KmlDocument(file) = text.parse().unwrap() else {
            panic!("no document");
        };
        let Kml::Document { elements, .. } = &file.elements[0] else {
            panic!("no document in it");
        };

        let kept = thinned(&picture.track, EXACT_M);
        let track = elements.iter().find_map(|e| match e {
            Kml::Placemark(placemark) => placemark
                .children
                .iter()
                .find(|c| c.name.ends_with("Track")),
            _ => None,
        });
        let named = |name: &str| {
            let children = track.unwrap().children.iter();
            let of_name = children.filter(move |c| c.name.ends_with(name));
            of_name
                .map(|c| c.content.clone().unwrap())
                .collect::<Vec<_>>()
        };
        assert_eq!(named("altitudeMode"), ["absolute"]);
        let (whens, coords) = (named("when"), named("coord"));
        assert_eq!((whens.len(), coords.len()), (kept.len(), kept.len()));
        assert_eq!(whens[0], "1970-01-01T00:00:00.000Z");
        for (text, truth) in coords.iter().zip(&kept) {
            let x: Vec<f64> = text.split(' ').map(|x| x.parse().unwrap()).collect();
            assert!((back(x[0], x[1], x[2]) - truth.position).norm() < 1e-3);
        }

        let mission = &picture.setting.as_ref().unwrap().mission;
        let folder = |name: &str| {
            let folders = elements.iter().filter_map(|e| match e {
                Kml::Folder(folder) => Some(folder),
                _ => None,
            });
            let mut of_name = folders.filter(|f| f.name.as_deref() == Some(name));
            of_name.next().unwrap().elements.clone()
        };
        let waypoints = folder("waypoints");
        assert_eq!(waypoints.len(), mission.network.num_nodes());
        for (element, truth) in waypoints.iter().zip(mission.network.waypoints()) {
            let Kml::Placemark(Placemark {
                geometry: Some(Geometry::Point(point)),
                ..
            }) = element
            else {
                panic!("{element:?}");
            };
            assert_eq!(point.altitude_mode, AltitudeMode::Absolute);
            let Coord { x, y, z } = point.coord;
            assert!((back(x, y, z.unwrap()) - truth.position).norm() < 1e-3);
        }
        let adopted = picture.routes.iter().filter(|call| call.adopted);
        assert_eq!(folder("routes in force").len(), adopted.count());
    }
}
