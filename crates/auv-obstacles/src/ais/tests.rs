//! Tests of reading ship tracks.
#![cfg(test)]

use super::fix::KNOT_MPS;
use super::*;
use crate::truth::{AfterLastFix, ShipFix, TrackedShip};
use auv_types::libm;

const HEADER: &str = "vessel,BaseDateTime,LAT,LON,SOG,COG,Heading,VesselType,Length,Width,Draft";

#[test]
fn codes_for_not_available_give_no_value() {
    let text = format!(
        "{HEADER}\n4,2022-01-03T00:18:15,49.2,-122.9,102.3,360.0,511,30,,6,0\n\
         4,2022-01-03T00:19:15,49.2,-122.9,10,90,270,30,21,6,3.2\n"
    );
    let table = parse(&text).unwrap();
    let ship = &table.ships[0];
    let (first, second) = (ship.fixes[0], ship.fixes[1]);
    assert_eq!(
        (first.speed_mps, first.course_rad, first.heading_rad),
        (None, None, None)
    );
    assert!((second.speed_mps.unwrap() - 5.1444).abs() < 1e-4);
    assert!((second.course_rad.unwrap() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert_eq!((ship.length_m, ship.draught_m), (Some(21.0), Some(3.2)));
}

#[test]
fn rows_are_sorted_duplicates_dropped_and_bad_rows_named() {
    let text = format!(
        "\u{feff}{HEADER}\r\n1,2022-01-03T00:02:00,48.01,-123,0,0,0,,,,\r\n1,2022-01-03T00:00:00,48.0,-123,0,0,0,,,,\r\n\
         1,2022-01-03T00:00:00,48.0001,-123,0,0,0,,,,\r\n1,2022-01-03T00:01:00,91,-123\r\n,,,\r\n\r\n1,2022-01-03\r\n"
    );
    let table = parse(&text).unwrap();
    let latitudes: Vec<f64> = table.ships[0]
        .fixes
        .iter()
        .map(|f| f.latitude_deg)
        .collect();
    assert_eq!(latitudes, [48.0, 48.01]);
    assert_eq!((table.duplicates, table.skipped.total()), (1, 3));
    assert!(table.skipped.list()[0].place.contains("line 5"));
}

#[test]
fn a_text_without_tracks_is_an_error_that_says_why() {
    assert_eq!(
        parse("a,b\n").unwrap_err(),
        AisError::MissingColumn {
            column: "vessel".into()
        }
    );
    let message = parse(&format!("{HEADER}\n1,never,1,2\n"))
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("line 2") && message.contains("never"),
        "{message}"
    );
}

#[test]
#[expect(clippy::print_stderr, reason = "says why it was skipped")]
fn the_salish_sea_file_is_read_completely() {
    let Ok(folder) = std::env::var("AUV_DATA_DIR") else {
        eprintln!("skipped: set AUV_DATA_DIR");
        return;
    };
    let text = std::fs::read_to_string(format!("{folder}/ocean/ais_salish_sea.csv")).unwrap();
    let table = parse(&text).unwrap();
    assert_eq!((table.ships.len(), table.skipped.total()), (66, 0));
    let fixes: usize = table.ships.iter().map(|ship| ship.fixes.len()).sum();
    // Nine numbers begin with a fix that their ship cannot have sailed from.
    assert_eq!(table.strays, 9);
    assert_eq!(
        fixes + table.duplicates + table.strays,
        text.lines().count() - 1
    );
    for ship in &table.ships {
        let tracked = |after| ship.tracked(&local, AssumedSize::default(), after).unwrap();
        let fixes = tracked(AfterLastFix::Repeat).fixes().to_vec();
        assert_eq!(fixes, longest_run(&text, &ship.vessel), "{}", ship.vessel);
        // A ship at rest is one place, near all its fixes.
        let held = tracked(AfterLastFix::HoldCourse);
        for fix in &fixes {
            let [n, e] = at(&held, fix.time_s);
            assert!(libm::hypot(n - fix.north_m, e - fix.east_m) <= 25.0);
        }
    }
}

/// The longest run of a vessel's fixes without a jump, the first row of each time alone: what was used
/// before ships were told apart by motion. The tracks of this file are the same.
fn longest_run(text: &str, vessel: &str) -> Vec<ShipFix> {
    let mut fixes: Vec<ShipFix> = text
        .lines()
        .filter_map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let (n, e) = local(cells[2].parse().ok()?, cells[3].parse().ok()?);
            (cells[0] == vessel).then(|| ShipFix {
                time_s: clock::unix_seconds(cells[1]).unwrap() - 1_641_168_000.0,
                north_m: n,
                east_m: e,
            })
        })
        .collect();
    fixes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    fixes.dedup_by(|later, kept| later.time_s <= kept.time_s);
    let runs = fixes.chunk_by(|a, b| {
        let gone_m = libm::hypot(b.north_m - a.north_m, b.east_m - a.east_m);
        gone_m <= FASTEST_MPS * (b.time_s - a.time_s) + 50.0
    });
    runs.rev().max_by_key(|run| run.len()).unwrap().to_vec()
}

const METRES_NORTH: f64 = 111_195.0;

/// Metres about 58 N, 11 E.
fn local(latitude: f64, longitude: f64) -> (f64, f64) {
    let wide = libm::cos(58.0_f64.to_radians());
    (
        (latitude - 58.0) * METRES_NORTH,
        (longitude - 11.0) * METRES_NORTH * wide,
    )
}

/// A row of MarineCadastre's columns for a ship at metres north and east.
fn row(number: u32, time_s: u32, [north_m, east_m]: [f64; 2], rest: &str) -> String {
    let latitude = 58.0 + north_m / METRES_NORTH;
    let longitude = 11.0 + east_m / METRES_NORTH / libm::cos(58.0_f64.to_radians());
    format!(
        "{number},2024-05-01T{:02}:{:02}:{:02},{latitude:.6},{longitude:.6},{rest}\n",
        time_s / 3600,
        time_s / 60 % 60,
        time_s % 60
    )
}

const COLUMNS: &str =
    "MMSI,BaseDateTime,LAT,LON,SOG,COG,Heading,VesselName,Status,Length,Width,Draft\n";

fn places(ship: &AisShip) -> TrackedShip {
    ship.tracked(&local, AssumedSize::default(), AfterLastFix::HoldCourse)
        .unwrap()
}

/// Where a ship is, north and east.
fn at(ship: &TrackedShip, time_s: f64) -> [f64; 2] {
    let region = ship.region_at(crate::ObstacleId(0), time_s).unwrap();
    [region.centre.x, region.centre.y]
}

#[test]
fn two_ships_under_one_number_are_two_ships() {
    // A tanker at 5 m/s to the east; another ship under her number 40 km, 2 km or 500 m off, lying still or
    // sailing the other way.
    for (off_m, other_mps) in [
        (40_000.0, 0.0),
        (2_000.0, 0.0),
        (2_000.0, -4.0),
        (500.0, 0.0),
    ] {
        let mut text = COLUMNS.to_owned();
        for k in 0..30_u32 {
            let t = f64::from(k * 60);
            text += &row(1, k * 60, [0.0, 5.0 * t], "9.72,90,90,A,0,330,58,21");
            let east_m = 700.0 + other_mps * (t + 30.0);
            let rest = format!("{:.2},270,270,B,0,20,5,2", f64::abs(other_mps) / KNOT_MPS);
            text += &row(1, k * 60 + 30, [off_m, east_m], &rest);
        }
        let table = parse(&text).unwrap();
        let sizes: Vec<_> = table
            .ships
            .iter()
            .map(|s| (s.length_m, s.draught_m))
            .collect();
        assert_eq!(
            sizes,
            [(Some(330.0), Some(21.0)), (Some(20.0), Some(2.0))],
            "{off_m} {other_mps}"
        );
        assert!(table.ships.iter().all(|ship| ship.fixes.len() == 30));
        assert!(table.notes[0].contains("vessel 1: 2 ships share the number"));
        for time_s in [0.0, 345.0, 1_740.0, 4_000.0] {
            let [n, e] = at(&places(&table.ships[0]), time_s);
            assert!(
                n.abs() < 5.0 && (e - 5.0 * time_s).abs() < 25.0,
                "{time_s} {n} {e}"
            );
        }
    }
}

#[test]
fn a_shared_number_without_sizes_or_speeds_is_told_apart_by_distance_alone() {
    let mut text = "MMSI,BaseDateTime,LAT,LON\n".to_owned();
    for k in 0..30_u32 {
        text += &row(1, k * 60, [0.0, 300.0 * f64::from(k)], "").replace(",\n", "\n");
        text += &row(1, k * 60 + 30, [40_000.0, 0.0], "").replace(",\n", "\n");
    }
    let table = parse(&text).unwrap();
    assert_eq!(table.ships.len(), 2);
    assert!(table.ships.iter().all(|ship| ship.fixes.len() == 30));
}

#[test]
fn a_stray_fix_is_left_out_with_a_word_and_splits_no_track() {
    for stray in [0, 7, 19] {
        let mut text = COLUMNS.to_owned();
        for k in 0..20_u32 {
            let place = if k == stray {
                [-900_000.0, 0.0]
            } else {
                [0.0, 300.0 * f64::from(k)]
            };
            text += &row(4, k * 60, place, "9.72,90,90,A,0,120,20,7");
        }
        let table = parse(&text).unwrap();
        assert_eq!(
            (table.ships.len(), table.ships[0].fixes.len(), table.strays),
            (1, 19, 1)
        );
        assert!(table.notes[0].contains("stray"), "{:?}", table.notes);
    }
}

#[test]
fn a_reported_speed_that_is_stuck_does_not_tear_a_track_to_pieces() {
    let mut text = COLUMNS.to_owned();
    for k in 0..20_u32 {
        text += &row(
            4,
            k * 120,
            [0.0, 1_000.0 * f64::from(k)],
            "0.0,90,90,A,0,120,20,7",
        );
    }
    let table = parse(&text).unwrap();
    assert_eq!(
        (table.ships.len(), table.ships[0].fixes.len(), table.strays),
        (1, 20, 0)
    );
    // The way made good decides against the report.
    let [_, e] = at(&places(&table.ships[0]), 3_000.0);
    assert!((e - 25_000.0).abs() < 50.0, "{e}");
}

#[test]
fn a_ship_at_anchor_stays_there_before_and_after_its_noisy_fixes() {
    for (speed, status) in [
        ("0.0", "0"),
        ("0.1", "1"),
        ("102.3", "1"),
        ("1.2", "5"),
        ("0.3", "15"),
    ] {
        let mut text = COLUMNS.to_owned();
        let rest = format!("{speed},90,90,A,{status},330,58,21");
        // The first and the last two fixes are 8 m and 10 s apart.
        for (time_s, east_m) in [
            (0, 8.0),
            (10, 0.0),
            (180, 0.0),
            (360, 0.0),
            (590, 0.0),
            (600, 8.0),
        ] {
            text += &row(1, 3600 + time_s, [0.0, east_m], &rest);
        }
        text += &row(2, 0, [9_000.0, 0.0], &rest);
        let table = parse(&text).unwrap();
        let ship = places(&table.ships[0]);
        for time_s in [0.0, 1_800.0, 3_700.0, 4_200.0, 9_000.0, 90_000.0] {
            let [n, e] = at(&ship, time_s);
            assert!(
                libm::hypot(n, e) < 10.0,
                "{speed} {status} {time_s}: {n} {e}"
            );
        }
    }
}

#[test]
fn the_noise_of_a_ship_at_rest_is_no_motion_and_its_swinging_is() {
    // Metres east, every 30 s; the ship lies at the median of its fixes.
    let track = |easts: &[f64], speed: &str| {
        let mut text = COLUMNS.to_owned();
        for (k, east_m) in (0_u32..).zip(easts) {
            let rest = format!("{speed},90,90,A,1,330,58,21");
            text += &row(1, 30 * k, [0.0, *east_m], &rest);
        }
        places(&parse(&text).unwrap().ships[0])
    };
    let clean = track(&[0.0; 12], "0.0");
    for noisy in [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0],
        [
            9.0, 0.0, -12.0, 0.0, 4.0, 0.0, 0.0, 0.0, -3.0, 0.0, 8.0, -20.0,
        ],
    ] {
        assert_eq!(track(&noisy, "0.0"), clean);
        assert_eq!(track(&noisy, "0.1"), clean);
    }
    let swinging = [0.0, 40.0, 80.0, 120.0, 160.0, 120.0, 80.0, 40.0, 0.0];
    let ship = track(&swinging, "0.8");
    let [_, e] = at(&ship, 120.0);
    assert!((e - 160.0).abs() < 1.0, "{e}");
    // Under way, fixes near each other are where the ship was.
    let [_, e] = at(&track(&[0.0, 10.0, 20.0, 30.0], "6.0"), 45.0);
    assert!((e - 15.0).abs() < 1.0, "{e}");
}

#[test]
fn a_ship_under_way_sails_on_as_it_reports_and_a_single_fix_moves_too() {
    let mut text = COLUMNS.to_owned();
    // North-east at 10 knots; the last two fixes are noisy.
    for (time_s, north_m, east_m) in [
        (0, 0.0, 0.0),
        (300, 1_091.0, 1_091.0),
        (302, 1_094.0, 1_110.0),
    ] {
        text += &row(1, time_s, [north_m, east_m], "10.0,45,45,A,0,100,20,6");
    }
    text += &row(2, 0, [0.0, -9_000.0], "10.0,90,90,B,0,100,20,6");
    let table = parse(&text).unwrap();
    let [n, e] = at(&places(&table.ships[0]), 1_302.0);
    let way_m = 1_000.0 * 10.0 * KNOT_MPS / 2.0_f64.sqrt();
    assert!(
        (n - 1_094.0 - way_m).abs() < 20.0 && (e - 1_110.0 - way_m).abs() < 20.0,
        "{n} {e}"
    );
    let [n, e] = at(&places(&table.ships[1]), 1_000.0);
    assert!(
        n.abs() < 5.0 && (e + 9_000.0 - 1_000.0 * 10.0 * KNOT_MPS).abs() < 20.0,
        "{n} {e}"
    );
}

#[test]
fn a_comma_in_a_quoted_name_shifts_nothing() {
    let text = format!(
        "{COLUMNS}9,2024-05-01T00:00:00,58,11,9.7,90,90,\"ALPHA, \"\"II\"\", \",15,180,32,11.5\n"
    );
    let ship = &parse(&text).unwrap().ships[0];
    assert_eq!(
        (ship.length_m, ship.width_m, ship.draught_m),
        (Some(180.0), Some(32.0), Some(11.5))
    );
    let open = format!(
        "{COLUMNS}9,2024-05-01T00:00:00,58,11,9.7,90,90,\"ALPHA,15,180,32,11.5\n8,2024-05-01T00:00:00,58,11,9.7,90,90,B,15,180,32,11.5\n"
    );
    assert_eq!(parse(&open).unwrap_err(), AisError::OpenQuote { line: 2 });
}

#[test]
fn the_columns_of_other_publishers_are_read() {
    let old = format!("{COLUMNS}9,2024-05-01T00:00:10,58.1,11.2,9.7,90,91,A,1,180,32,11.5\n");
    let newer = "mmsi,base_date_time,longitude,latitude,sog,cog,heading,vessel_name,imo,call_sign,vessel_type,status,length,width,draft,cargo,transceiver\n\
                 9,2024-05-01 00:00:10,11.2,58.1,9.7,90.0,91,A,,C,,1,180,32,11.5,70,A\n";
    let danish = "# Timestamp,Type of mobile,MMSI,Latitude,Longitude,Navigational status,ROT,SOG,COG,Heading,IMO,Callsign,Name,Ship type,Cargo type,Width,Length,Type of position fixing device,Draught,Destination,ETA,Data source type,A,B,C,D\n\
                  01/05/2024 00:00:10,Class A,9,58.1,11.2,At anchor,0,9.7,90,91,,C,A,Cargo,,32,180,GPS,11.5,X,,AIS,1,1,1,1\n\
                  01/05/2024 00:00:10,Base Station,2190047,57.1,10.2,Unknown value,,,,,,,,Undefined,,,,,,,,AIS,,,,\n";
    let semicolons = newer.replace(',', ";");
    let expected = parse(&old).unwrap();
    for text in [newer, danish, &semicolons] {
        let table = parse(text).unwrap();
        assert_eq!(
            (&table.ships, table.start_unix_s),
            (&expected.ships, expected.start_unix_s)
        );
    }
    assert!(parse(danish).unwrap().notes[0].contains("1 rows of base stations"));
}

#[test]
fn dates_with_slashes_have_the_day_first_or_are_refused() {
    let text = |dates: [&str; 2]| {
        let rows =
            dates.map(|date| format!("9,{date} 00:10,58,11,9.7,90,90,A,At Anchor,180,32,11.5\n"));
        format!("{COLUMNS}{}", rows.concat())
    };
    let table = parse(&text(["05/06/2024", "06/06/2024"])).unwrap();
    assert!(table.notes[0].contains("day first"), "{:?}", table.notes);
    assert_eq!(table.ships[0].fixes[1].time_s, 86_400.0);
    assert_eq!(table.ships[0].fixes[0].status, NavStatus::Anchored);
    let sure = parse(&text(["31/05/2024", "01/06/2024"])).unwrap();
    assert!(sure.notes.is_empty());
    assert_eq!(sure.ships[0].fixes[1].time_s, 86_400.0);
    let refusal = parse(&text(["05/06/2024", "05/31/2024"])).unwrap_err();
    let told = refusal.to_string();
    assert!(
        told.contains("line 3") && told.contains("05/31/2024") && told.contains("YYYY-MM-DD"),
        "{told}"
    );
    // One row that is wrong among others that are sure is left out by itself.
    let mixed = text(["31/05/2024", "05/31/2024"]);
    assert_eq!(parse(&mixed).unwrap().skipped.total(), 1);
}

#[test]
fn other_columns_are_read_by_the_names_that_are_given() {
    let text = "ship,when,phi,lambda,kn,long\n9,2024-05-01T00:00:10Z,58.1,11.2,9.7,180\n";
    assert!(
        parse(text)
            .unwrap_err()
            .to_string()
            .contains("[ais.columns]")
    );
    let name = |name: &str| Some(name.to_owned());
    let mut columns = ColumnNames {
        vessel: name("ship"),
        time: name("when"),
        latitude: name("phi"),
        longitude: name("lambda"),
        speed: name("kn"),
        length: name("long"),
        ..ColumnNames::default()
    };
    let options = |columns: &ColumnNames| AisOptions {
        columns: columns.clone(),
        ..AisOptions::default()
    };
    let ship = &parse_with(text, &options(&columns)).unwrap().ships[0];
    assert_eq!(
        (ship.length_m, ship.fixes[0].latitude_deg),
        (Some(180.0), 58.1)
    );
    columns.draught = name("tief");
    assert!(
        parse_with(text, &options(&columns))
            .unwrap_err()
            .to_string()
            .contains("tief")
    );
}

#[test]
fn any_order_of_rows_gives_the_same_ships() {
    let mut rows = Vec::new();
    for k in 0..40_u32 {
        rows.push(row(
            1,
            k * 60,
            [0.0, 300.0 * f64::from(k)],
            "9.72,90,90,A,0,330,58,21",
        ));
        rows.push(row(1, k * 60 + 30, [3_000.0, 0.0], "0,270,270,B,0,20,5,2"));
        rows.push(row(
            2,
            k * 45,
            [100.0, 100.0 * f64::from(k)],
            "4,90,90,C,0,50,9,3",
        ));
    }
    let of = |rows: &[String]| parse(&(COLUMNS.to_owned() + &rows.concat())).unwrap();
    let table = of(&rows);
    rows.reverse();
    assert_eq!(of(&rows), table);
    rows.rotate_left(31);
    assert_eq!(of(&rows), table);
}
