//! A mission in one picture: plan view and depth over distance.

mod obstacles;
mod plan;
mod profile;

use crate::draw::Figure;
use crate::record::MissionPicture;
use crate::tasks::assignments;
use plan::plan_view;
use profile::profile;

/// One picture of a mission: the plan view (waypoints, tasks, flown track by leg, true obstacles at
/// their closest approach, current, sea bed, sonar range) and depth over the distance flown.
///
/// Equal missions give equal text. A picture of a mission that was not recorded says so.
#[must_use]
pub fn mission_svg(picture: &MissionPicture) -> String {
    let Some(setting) = &picture.setting else {
        return Figure::new("No mission", "The mission was not recorded.").to_svg();
    };
    let mut figure = Figure::new(&title(picture), &subtitle(picture));
    figure.charts = vec![
        plan_view(picture, &setting.mission),
        profile(picture, &setting.mission),
    ];
    figure.notes = notes(picture);
    figure.to_svg()
}

pub(crate) fn title(picture: &MissionPicture) -> String {
    let name = picture.setting.as_ref().map_or("", |s| s.name.as_str());
    match &picture.ending {
        Some(ending) if ending.reason.is_empty() => format!("{name}: {}", ending.outcome),
        Some(ending) => format!("{name}: {} ({})", ending.outcome, ending.reason),
        None => name.into(),
    }
}

pub(crate) fn subtitle(picture: &MissionPicture) -> String {
    let (Some(setting), Some(ending)) = (&picture.setting, &picture.ending) else {
        return String::new();
    };
    let mission = &setting.mission;
    // The summary counts flown edges, with or without a task.
    let tasks = assignments(mission, picture);
    let tasks = tasks.iter().filter(|task| task.done_s.is_some()).count();
    let mut text = format!(
        "{:.0} s of {:.0} s used, {:.0} s left (reserve {:.0} s); {} tasks, weight {:.1}; {} route calls, {} legs",
        ending.time_s,
        mission.budget_s,
        ending.remaining_s,
        mission.reserve_s,
        tasks,
        ending.mission_weight,
        picture.routes.len(),
        picture.legs.len(),
    );
    let Some(judged) = &ending.judged else {
        return text + ".";
    };
    let judgement = &judged.judgement;
    if judgement.min_clearance_m.is_finite() {
        text += &format!(
            "; least true clearance {:.1} m at {:.0} s",
            judgement.min_clearance_m, judgement.min_clearance_at_s
        );
    }
    if judgement.min_altitude_m.is_finite() {
        text += &format!("; least altitude {:.1} m", judgement.min_altitude_m);
    }
    for broken in &judgement.limits_broken {
        text += &format!("; limit broken: {broken}");
    }
    text + "."
}

fn notes(picture: &MissionPicture) -> Vec<String> {
    let mut notes = Vec::new();
    if picture
        .setting
        .as_ref()
        .is_some_and(|s| s.simulated.is_some())
    {
        notes.push(
        "Obstacles are drawn where they truly were when the vehicle came closest; faint ones never came within \
         sonar range. Dotted rings and arrows: where they were at the start of the mission, and where they went since; of ships, \
         ten minutes before and after."
            .into(),
        );
    }
    notes.extend(picture.notes.iter().cloned());
    notes
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_mission::driver::Stepped;
    use auv_planning::baseline::{GreedyRoute, StraightPath};
    use auv_sim::{Campaign, Fence, simulate};
    use auv_types::Seed;

    fn flown() -> MissionPicture {
        let campaign = Campaign::table2(Seed(3)).unwrap();
        let mut picture = MissionPicture::new();
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        simulate(&campaign.scenario(0).unwrap(), &driver, &mut picture).unwrap();
        picture
    }

    #[test]
    fn the_picture_names_every_visited_waypoint_and_is_the_same_again() {
        let picture = flown();
        let svg = mission_svg(&picture);
        assert_eq!(svg, mission_svg(&flown()));
        let visited = &picture.ending.as_ref().unwrap().visited;
        assert!(visited.len() > 2);
        assert!(
            visited
                .iter()
                .all(|node| svg.contains(&format!(">{}</text>", node.0)))
        );
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn areas_are_told_with_depths_and_times() {
        let campaign = Campaign::table2(Seed(3)).unwrap();
        let mut scenario = campaign.scenario(0).unwrap();
        let square = vec![[0.0, 0.0], [900.0, 0.0], [900.0, 900.0]];
        scenario.fences.keep_out.push(Fence {
            depth_m: [f64::NEG_INFINITY, -5.0],
            holds_s: [60.0, f64::INFINITY],
            ..Fence::always("kites", square.clone())
        });
        scenario
            .fences
            .keep_in
            .push(Fence::always("everywhere", square));
        let mut picture = MissionPicture::new();
        picture.launched_at(0.0);
        let driver = Stepped::new(&GreedyRoute, &StraightPath);
        simulate(&scenario, &driver, &mut picture).unwrap();
        let svg = mission_svg(&picture);
        assert!(svg.contains("kites: 0 to -5 m deep, from 1970-01-01T00:01:00"));
        assert!(!svg.contains("everywhere:"));
    }

    #[test]
    fn what_was_not_recorded_is_said() {
        assert!(mission_svg(&MissionPicture::new()).contains("not recorded"));
    }

    #[test]
    fn poses_thinned_stay_on_the_true_way() {
        let picture = flown();
        for seen in picture.obstacles.values() {
            let closest = seen.closest.unwrap().pose;
            let next = seen
                .poses
                .partition_point(|p| p.time_s < closest.time_s)
                .clamp(1, seen.poses.len() - 1);
            let (a, b) = (seen.poses[next - 1], seen.poses[next]);
            let share = (closest.time_s - a.time_s) / (b.time_s - a.time_s);
            let between = a.centre + (b.centre - a.centre) * share;
            assert!((between - closest.centre).norm() < 25.0, "{:?}", seen.kind);
        }
    }
}
