//! A mission as one page that plays offline.

mod data;
mod json;
mod obstacles;

use crate::record::MissionPicture;
use data::data;

const PAGE: &str = include_str!("replay/page.html");
const STYLE: &str = include_str!("replay/style.css");

/// The parts of the page's program, in the order in which they need each other.
const SCRIPTS: [&str; 7] = [
    include_str!("replay/mission.js"),
    include_str!("replay/drawing.js"),
    include_str!("replay/camera.js"),
    include_str!("replay/terrain.js"),
    include_str!("replay/scene.js"),
    include_str!("replay/charts.js"),
    include_str!("replay/player.js"),
];

/// A mission as one self-contained HTML page that needs no network: plan and 3-D view, depth,
/// budget, clearance, time line and each decision with its reason, with play, pause, speed and scrubbing
/// (also by keyboard: space and arrows; `#t=600` opens it at 600 s, `#t=600&view=3d` in three
/// dimensions).
///
/// Equal missions give equal text. A picture of a mission that was not recorded gives an empty page.
#[must_use]
pub fn replay_html(picture: &MissionPicture) -> String {
    PAGE.replacen("__STYLE__", STYLE, 1)
        .replacen("__SCRIPT__", &SCRIPTS.concat(), 1)
        .replacen("__DATA__", &data(picture), 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_mission::driver::Stepped;
    use auv_planning::baseline::{GreedyRoute, StraightPath};
    use auv_sim::{Campaign, simulate};
    use auv_types::Seed;
    use serde_json::Value;
    use std::collections::BTreeSet;

    fn flown() -> MissionPicture {
        let scenario = Campaign::table2(Seed(4)).unwrap().scenario(0).unwrap();
        let mut picture = MissionPicture::new();
        simulate(
            &scenario,
            &Stepped::new(&GreedyRoute, &StraightPath),
            &mut picture,
        )
        .unwrap();
        picture
    }

    fn parsed(picture: &MissionPicture) -> Value {
        serde_json::from_str(&data(picture)).unwrap()
    }

    #[test]
    fn a_three_hour_mission_fits_into_two_megabytes_and_calls_nobody() {
        let mut picture = flown();
        picture.note("</script><b>");
        let page = replay_html(&picture);
        assert!(page.len() < 2_000_000, "{} bytes", page.len());
        for absent in [
            "http",
            "__DATA__",
            "__SCRIPT__",
            "__STYLE__",
            "import ",
            "fetch(",
        ] {
            assert!(!page.contains(absent), "{absent}");
        }
        assert_eq!(page.matches("</script>").count(), 2);
    }

    #[test]
    fn whatever_the_page_reads_was_written() {
        let scripts = SCRIPTS.concat();
        let is_word = |c: char| c.is_ascii_alphanumeric();
        let read: BTreeSet<&str> = scripts
            .split("MISSION.")
            .skip(1)
            .filter_map(|rest| rest.split(|c| !is_word(c)).next())
            .collect();
        assert!(read.len() > 10, "{read:?}");
        for picture in [flown(), MissionPicture::new()] {
            let written = parsed(&picture);
            for field in &read {
                let optional = ["bed", "floor", "current", "fences"].contains(field);
                assert!(optional || written.get(field).is_some(), "{field}");
            }
        }
        let page = PAGE.to_owned() + &scripts;
        for rest in scripts.split("byId(\"").skip(1) {
            let id = rest.split('"').next().unwrap();
            assert!(page.contains(&format!("id=\"{id}\"")), "{id}");
        }
    }

    #[test]
    fn everything_in_space_has_its_depth() {
        let picture = flown();
        let written = parsed(&picture);
        let lengths = |rows: &Value| -> BTreeSet<usize> {
            let rows = rows.as_array().unwrap().iter();
            rows.map(|row| row.as_array().unwrap().len()).collect()
        };
        assert_eq!(lengths(&written["nodes"]), BTreeSet::from([4]));
        assert_eq!(lengths(&written["track"]), BTreeSet::from([4]));
        for path in written["follows"].as_array().unwrap() {
            assert_eq!(lengths(&path["p"]), BTreeSet::from([3]));
        }
        let obstacles = written["obstacles"].as_array().unwrap();
        assert_eq!(obstacles.len(), picture.obstacles.len());
        for (obstacle, seen) in obstacles.iter().zip(picture.obstacles.values()) {
            assert_eq!(lengths(&obstacle["p"]), BTreeSet::from([5]));
            assert_eq!(obstacle.get("span").is_none(), seen.poses[0].ball);
        }
        for region in written["predicted"].as_array().unwrap() {
            for stretch in region["p"].as_array().unwrap() {
                assert_eq!(lengths(stretch), BTreeSet::from([9]));
            }
        }
    }
}
