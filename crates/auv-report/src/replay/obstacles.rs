//! Obstacles and their predictions as the page shows them.

use super::json::{array, list, rows};
use crate::record::{MissionPicture, ObstacleKind, Pose, Prediction};
use crate::thin::thinned;
use std::iter;

/// The true obstacles, exact to `exact_m`.
pub(super) fn obstacles(picture: &MissionPicture, exact_m: f64) -> String {
    list(picture.obstacles.values().map(|seen| {
        let kind = match seen.kind {
            ObstacleKind::Charted => "charted",
            ObstacleKind::Uncertain => "uncertain",
            ObstacleKind::Moving => "moving",
            ObstacleKind::Drifting => "drifting",
            ObstacleKind::Ship => "ship",
        };
        let poses = seen.poses.iter();
        let poses: Vec<_> = poses
            .map(|pose| {
                let [east_m, north_m, depth_m, radius_m] = place(pose);
                [pose.time_s.round(), east_m, north_m, depth_m, radius_m]
            })
            .collect();
        let poses = rows(&thinned(&poses, exact_m));
        let shape = seen.poses.first().map_or(String::new(), span);
        format!("{{\"kind\":\"{kind}\",{shape}\"p\":{poses}}}")
    }))
}

/// The shape of an obstacle: nothing of a ball, the depths of a cylinder's ends.
fn span(pose: &Pose) -> String {
    let (top_m, bottom_m) = pose.depths_m;
    if pose.ball {
        String::new()
    } else {
        format!("\"span\":{},", array(&[top_m, bottom_m]))
    }
}

/// East, north, depth and radius of an obstacle, in whole metres.
fn place(pose: &Pose) -> [f64; 4] {
    let depth_m = if pose.ball { pose.centre.z } else { 0.0 };
    [pose.centre.y, pose.centre.x, depth_m, pose.radius_m].map(f64::round)
}

/// How long an obstacle may go without prediction before it is shown as gone, seconds.
const SILENT_S: f64 = 25.0;

/// The predictions of one obstacle that are `near`, in stretches without a gap: rows of time, place
/// now and place at the horizon, exact to `exact_m`.
pub(super) fn predictions(
    series: &[Prediction],
    exact_m: f64,
    near: impl Fn(&Prediction) -> bool,
) -> String {
    let shape = series.first().map_or(String::new(), |p| span(&p.now));
    let series: Vec<_> = series.iter().filter(|p| near(p)).collect();
    let stretches = series.chunk_by(|a, b| b.time_s - a.last_s <= SILENT_S);
    let stretches = stretches.map(|stretch| {
        let mut said: Vec<[f64; 9]> = Vec::new();
        for p in stretch {
            let (now, later) = (place(&p.now), place(&p.later));
            // A prediction that holds for long gets a second row; frequent ones form a line anyway.
            let held = (p.last_s > p.time_s + 10.0).then_some(p.last_s);
            for time_s in iter::once(p.time_s).chain(held) {
                if said.last().is_none_or(|last| time_s > last[0]) {
                    said.push([
                        time_s, now[0], now[1], now[2], now[3], later[0], later[1], later[2],
                        later[3],
                    ]);
                }
            }
        }
        rows(&thinned(&said, exact_m))
    });
    format!("{{{shape}\"p\":{}}}", list(stretches))
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Point3;

    #[test]
    fn predictions_are_thinned_within_stretches_and_never_across_silence() {
        let pose = |time_s: f64, north_m: f64| Pose {
            time_s,
            centre: Point3::new(north_m, 7.0, 20.0),
            radius_m: 5.0,
            ball: true,
            depths_m: (15.0, 25.0),
        };
        let said = |k: i32| {
            let time_s = f64::from(if k < 50 { k } else { k + 100 });
            Prediction {
                time_s,
                now: pose(time_s, 2.0 * time_s),
                later: pose(time_s + 300.0, 2.0 * time_s + 600.0),
                last_s: time_s,
            }
        };
        let series: Vec<_> = (0..100).map(said).collect();
        assert_eq!(
            predictions(&series, 1.0, |_| true),
            "{\"p\":[[[0,7,0,20,5,7,600,20,5],[49,7,98,20,5,7,698,20,5]],\
             [[150,7,300,20,5,7,900,20,5],[199,7,398,20,5,7,998,20,5]]]}"
        );
    }
}
