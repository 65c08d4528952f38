//! Tracks from the positions reported under one number, by how ships move.

use super::fix::{AisFix, KNOT_MPS, MetresOf};
use super::row::Row;
use auv_types::libm;

/// Slack of a distance between two fixes, metres: fixes are rounded to several metres.
const SLACK_M: f64 = 50.0;
/// Slack where the reported speed bounds the distance: two ships nearer than this are one.
const NEAR_M: f64 = 300.0;
/// Rate of change of speed allowed for between two reports, m/s^2.
const ACCELERATION_MPS2: f64 = 0.05;
/// Speeds over ground below this are noise of a ship that lies still, m/s.
const STILL_MPS: f64 = 0.5 * KNOT_MPS;
/// Speeds below this are swinging, for a ship that reports that it lies at anchor, moored or aground.
const SWINGING_MPS: f64 = 2.0 * KNOT_MPS;
/// A course made good is taken over at least this long, seconds, or this far, metres.
const BASE_S: f64 = 60.0;
const BASE_M: f64 = 200.0;
/// A ship that makes this way good sails, whatever speed it reports, m/s.
const SAILS_MPS: f64 = 1.0;
/// So many ships may share a number.
const MOST_TRACKS: usize = 200;

/// The tracks of one number.
#[derive(Debug, Default)]
pub(super) struct Tracks {
    /// In order of their first fix.
    pub(super) tracks: Vec<Vec<Row>>,
    /// Rows of a place and time that a track has already.
    pub(super) duplicates: usize,
    /// Single fixes that no ship of this number can have sailed to.
    pub(super) strays: Vec<Row>,
}

/// Separates the rows of one number, in order of time, into ships.
///
/// A fix joins the track that could have sailed to it and whose expected place is nearest; if there is
/// none, a new track begins. Reported speeds bound the distance unless that would tear the rows to pieces,
/// as for ships whose reported speed is stuck. A single fix beside other tracks is a stray unless it
/// reports another size. `None` where there are more than [`MOST_TRACKS`].
pub(super) fn separated(rows: &[Row], fastest_mps: f64) -> Option<Tracks> {
    let strict = associated(rows, 8, |from, to| {
        let told_mps = from.fix.speed_mps.zip(to.fix.speed_mps);
        let elapsed_s = to.fix.time_s - from.fix.time_s;
        let told_m = told_mps.map_or(f64::INFINITY, |(a, b)| {
            2.0 * a.max(b) * elapsed_s + ACCELERATION_MPS2 * elapsed_s * elapsed_s + NEAR_M
        });
        let reach_m = told_m.min(fastest_mps * elapsed_s + SLACK_M);
        if sizes_differ(from, to) {
            reach_m.min(SLACK_M)
        } else {
            reach_m
        }
    });
    let whole = |tracks: &Tracks| {
        let long = tracks.tracks.iter().filter(|track| track.len() >= 3);
        long.map(Vec::len).sum::<usize>() * 5 >= rows.len() * 4
    };
    let strict = strict.filter(|strict| strict.tracks.len() <= 1 || whole(strict));
    let mut tracks = strict.or_else(|| {
        associated(rows, MOST_TRACKS, |from, to| {
            fastest_mps * (to.fix.time_s - from.fix.time_s) + SLACK_M
        })
    })?;
    take_out_strays(&mut tracks);
    Some(tracks)
}

/// The rows as at most so many tracks; `None` where there are more.
fn associated(rows: &[Row], most: usize, reach_m: impl Fn(&Row, &Row) -> f64) -> Option<Tracks> {
    let mut found = Tracks::default();
    for row in rows {
        let mut best: Option<(f64, usize)> = None;
        let mut taken = false;
        for (i, track) in found.tracks.iter().enumerate() {
            let Some(last) = track.last() else { continue };
            let gone_m = distance_m(&last.fix, &row.fix);
            if row.fix.time_s <= last.fix.time_s {
                taken |= gone_m <= SLACK_M;
                continue;
            }
            if gone_m > reach_m(last, row) {
                continue;
            }
            let miss_m = miss_m(track, row);
            if best.is_none_or(|(least_m, _)| miss_m < least_m) {
                best = Some((miss_m, i));
            }
        }
        match best {
            _ if taken => found.duplicates += 1,
            Some((_, i)) => found.tracks[i].push(*row),
            None if found.tracks.len() == most => return None,
            None => found.tracks.push(vec![*row]),
        }
    }
    Some(found)
}

/// How far a row lies from where its track would be by now, metres. A ship of another size is far.
fn miss_m(track: &[Row], row: &Row) -> f64 {
    let Some(last) = track.last() else {
        return f64::INFINITY;
    };
    let elapsed_s = row.fix.time_s - last.fix.time_s;
    let [north_m, east_m] = offset_m(&last.fix, &row.fix);
    let [north_mps, east_mps] = told(&last.fix)
        .or_else(|| {
            let before = track.len().checked_sub(2).map(|i| &track[i].fix)?;
            let duration_s = last.fix.time_s - before.time_s;
            Some(offset_m(before, &last.fix).map(|m| m / duration_s))
        })
        .unwrap_or_default();
    let miss_m = libm::hypot(
        north_m - north_mps * elapsed_s,
        east_m - east_mps * elapsed_s,
    );
    if sizes_differ(last, row) {
        miss_m + 1e6
    } else {
        miss_m
    }
}

/// Whether two rows tell of ships of different length.
fn sizes_differ(a: &Row, b: &Row) -> bool {
    a.length_m
        .zip(b.length_m)
        .is_some_and(|(a, b)| (a - b).abs() > 0.2 * a.max(b))
}

/// Takes out single fixes beside a track. Where there are single fixes only, those of the first one's time
/// and size are taken out, and the others are ships.
fn take_out_strays(found: &mut Tracks) {
    let Some(longest) = found.tracks.iter().rev().max_by_key(|track| track.len()) else {
        return;
    };
    let longest = longest.clone();
    let alone = longest.len() < 2;
    let (strays, mut first) = (&mut found.strays, alone);
    found.tracks.retain(|track| {
        let &[single] = track.as_slice() else {
            return true;
        };
        let another = longest.iter().any(|row| sizes_differ(row, &single));
        let elsewhen = alone && longest.iter().all(|row| row.fix.time_s < single.fix.time_s);
        if another || elsewhen || std::mem::take(&mut first) {
            return true;
        }
        strays.push(single);
        false
    });
}

/// North and east from one fix to another, metres, on a sphere. Exact enough to tell ships apart.
fn offset_m(from: &AisFix, to: &AisFix) -> [f64; 2] {
    const METRES_PER_DEGREE: f64 = 111_195.0;
    let mean_rad = 0.5 * (from.latitude_deg + to.latitude_deg).to_radians();
    let east_deg = libm::remainder(to.longitude_deg - from.longitude_deg, 360.0);
    [
        (to.latitude_deg - from.latitude_deg) * METRES_PER_DEGREE,
        east_deg * METRES_PER_DEGREE * libm::cos(mean_rad),
    ]
}

fn distance_m(from: &AisFix, to: &AisFix) -> f64 {
    let [north_m, east_m] = offset_m(from, to);
    libm::hypot(north_m, east_m)
}

/// The velocity that a fix reports, north and east.
fn told(fix: &AisFix) -> Option<[f64; 2]> {
    let speed_mps = fix.speed_mps?;
    if speed_mps < STILL_MPS {
        return Some([0.0, 0.0]);
    }
    let (sin, cos) = libm::sincos(fix.course_rad?);
    Some([speed_mps * cos, speed_mps * sin])
}

/// Whether a ship reports that it makes no way: by its speed, or by its status where it reports no speed.
pub(super) fn reports_rest(fix: &AisFix) -> bool {
    match fix.speed_mps {
        Some(told_mps) if fix.lies_still() => told_mps < SWINGING_MPS,
        Some(told_mps) => told_mps < STILL_MPS,
        None => fix.lies_still(),
    }
}

/// The velocity with which a ship sails on from the last of some fixes (or came to the first, where they
/// are given backwards), metres north and east per second; `None` where it is that between the two fixes
/// at the end.
///
/// A ship that reports no speed, or that it lies at anchor, moored or aground, stays where it is, whatever
/// the noise between two fixes is; the way made good over a minute or more decides against a report.
pub(super) fn end_velocity(fixes: &[AisFix], metres: &MetresOf<'_>) -> Option<[f64; 2]> {
    let (end, before) = fixes.split_last()?;
    let at = |fix: &AisFix| metres(fix.latitude_deg, fix.longitude_deg);
    let mut made_good = None;
    for fix in before.iter().rev() {
        let ((n, e), (from_n, from_e)) = (at(end), at(fix));
        let elapsed_s = end.time_s - fix.time_s;
        if elapsed_s.abs() >= BASE_S || libm::hypot(n - from_n, e - from_e) >= BASE_M {
            made_good = Some([(n - from_n) / elapsed_s, (e - from_e) / elapsed_s]);
            break;
        }
    }
    let speed = |[n, e]: [f64; 2]| libm::hypot(n, e);
    let sails = made_good.is_some_and(|v| speed(v) > SAILS_MPS);
    match end.speed_mps {
        _ if reports_rest(end) && !sails => Some([0.0, 0.0]),
        Some(told_mps) if told_mps >= STILL_MPS => {
            let course_rad = end.course_rad?;
            // The course is true, the metres are those of the local frame: a step of a minute of arc tells.
            let (sin, cos) = libm::sincos(course_rad);
            let step_deg = 1.0 / 60.0;
            let wide = libm::cos(end.latitude_deg.to_radians()).max(1e-3);
            let ahead = metres(
                (end.latitude_deg + step_deg * cos).clamp(-90.0, 90.0),
                end.longitude_deg + step_deg * sin / wide,
            );
            let here = at(end);
            let way = [ahead.0 - here.0, ahead.1 - here.1];
            Some(way.map(|m| m / speed(way).max(1e-9) * told_mps))
        }
        _ => made_good,
    }
}
