//! A mission as a mission file.

use crate::CoastalMission;
use crate::waters::Waters;
use auv_planning::Vehicle;
use auv_sim::Body;
use std::fmt::Write;

impl CoastalMission {
    /// The mission as a file of version 1, of version 2 with a drawn bed or a body. Numbers are written so that they are read back exactly.
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut text = String::new();
        head(self, &mut text);
        waypoints(self, &mut text);
        bed(self, &mut text);
        waters(self, &mut text);
        vehicle(&self.vehicle, self.body, &mut text);
        text
    }
}

fn head(mission: &CoastalMission, text: &mut String) {
    let traits = &mission.traits;
    let [least_m, sigmas] = mission.altitude;
    let _ = write!(
        text,
        "version = {version}\n\
         name = \"coast {number}, seed {seed}\"\n\
         description = \"{landscape}, {sea} sea; waypoints at the lowest legal depth: {at_limit}; steepest slope within two turn radii of one: {slope:.0} degrees\"\n\
         preset = \"default\"\n\
         budget_s = {budget_s:?}\n\
         start = \"W0\"\n\
         destination = \"W{last}\"\n\
         altitude = {{ least_m = {least_m:?}, sigmas = {sigmas:?} }}\n",
        version = if mission.drawn_bed || mission.body != Body::Point {
            2
        } else {
            1
        },
        number = mission.number,
        seed = mission.seed.0,
        landscape = traits.landscape.as_str(),
        sea = if traits.empty { "empty, still" } else { "busy" },
        at_limit = traits.at_limit,
        slope = traits.slope_at_limit_deg,
        budget_s = mission.budget_s,
        last = mission.places.len() - 1,
    );
}

fn waypoints(mission: &CoastalMission, text: &mut String) {
    let mut tasks = String::new();
    text.push_str("waypoints = [\n");
    for (i, place) in mission.places.iter().enumerate() {
        let task = match place.task_s {
            Some(time_s) => {
                let _ = writeln!(
                    tasks,
                    "T{i} = {{ priority = {}, risk = 1, time_s = {time_s:?} }}",
                    1 + i % 4
                );
                format!(", task = \"T{i}\"")
            }
            None => String::new(),
        };
        let _ = writeln!(
            text,
            "    {{ name = \"W{i}\", at = {:?}{task} }},",
            place.at
        );
    }
    text.push_str("]\n");
    if mission.chain {
        text.push_str("edges = [\n");
        for (i, with_task) in mission.edge_tasks.iter().enumerate() {
            let task = if *with_task { ", task = \"line\"" } else { "" };
            let _ = writeln!(
                text,
                "    {{ from = \"W{i}\", to = \"W{}\"{task} }},",
                i + 1
            );
        }
        text.push_str("]\n");
    }
    let side = [-mission.box_m, mission.box_m];
    let _ = write!(
        text,
        "\n[tasks]\n{tasks}line = {{ priority = 3, risk = 1, time_s = 0 }}\n\
         \n[connect]\nnearest = {}\n\
         \n[box]\nnorth_m = {side:?}\neast_m = {side:?}\ndepth_m = {:?}\n",
        mission.nearest, mission.depth_m
    );
}

fn bed(mission: &CoastalMission, text: &mut String) {
    let bed = &mission.bed;
    if mission.drawn_bed {
        text.push_str("\n[sea_bed]\ntruth = \"drawn\"\n");
    }
    let _ = write!(
        text,
        "\n[sea_bed.analytic]\nbase_depth_m = {:?}\nsigma = {{ least_m = {:?}, relative = {:?} }}\n",
        bed.base_depth_m, bed.sigma.least_m, bed.sigma.relative
    );
    if let Some(wave) = bed.undulations.first() {
        let _ = writeln!(
            text,
            "undulations = [{{ amplitude_m = {:?}, wavelength = {:?} }}]",
            wave.amplitude_m, wave.wavelength
        );
    }
    text.push_str("features = [\n");
    for feature in &bed.features {
        // A feature holds finite numbers and texts, which every TOML value can.
        if let Ok(value) = toml::Value::try_from(feature) {
            let _ = writeln!(text, "    {value},");
        }
    }
    text.push_str("]\n");
}

fn waters(mission: &CoastalMission, text: &mut String) {
    let Waters {
        current,
        truth: [gain, delay_s],
        movers,
        rocks,
        pots,
    } = &mission.waters;
    match current {
        None => text.push_str("\n[current]\nstill = true\n"),
        Some(current) => {
            let tide = &current.tide[0];
            let _ = write!(
                text,
                "\n[current]\ntruth = {{ gain = {gain:?}, delay_s = {delay_s:?} }}\n\
                 \n[current.analytic]\nmean_mps = {:?}\n\
                 tide = [{{ major_mps = {:?}, period_s = {:?}, strongest_s = {:?} }}]\n",
                current.mean_mps, tide.major_mps, tide.period_s, tide.strongest_s
            );
        }
    }
    for (k, mover) in movers.iter().enumerate() {
        let class = if mover.drifts { "drifting" } else { "moving" };
        let growth = if mover.drifts {
            "uncertainty_m = 0.1\n"
        } else {
            ""
        };
        let _ = write!(
            text,
            "\n[[obstacles]]\nname = \"mover {k}\"\nclass = \"{class}\"\nat = {:?}\nradius_m = {:?}\nvelocity_mps = {:?}\n{growth}",
            mover.at, mover.radius_m, mover.velocity_mps
        );
    }
    for (k, (at, radius_m)) in rocks.iter().enumerate() {
        let _ = write!(
            text,
            "\n[[obstacles]]\nname = \"rock {k}\"\nclass = \"static\"\nat = {at:?}\nradius_m = {radius_m:?}\n"
        );
    }
    if *pots > 0 {
        let side = [-mission.box_m, mission.box_m];
        let _ = write!(
            text,
            "\n[[obstacle_groups]]\nname = \"pots\"\nclass = \"uncertain\"\ncount = {pots}\n\
             north_m = {side:?}\neast_m = {side:?}\ndepth_m = 0\nradius_m = [2.0, 5.0]\n\
             top_m = -2.0\nbottom_m = 200.0\nclear_of_waypoints_m = 80.0\n"
        );
    }
}

/// The vehicle's keys that differ from the preset's.
fn vehicle(vehicle: &Vehicle, body: Body, text: &mut String) {
    if *vehicle == Vehicle::default() && body == Body::Point {
        return;
    }
    text.push_str("\n[vehicle]\n");
    if body != Body::Point {
        let _ = writeln!(text, "body = \"{}\"", body.as_str());
    }
    let _ = write!(
        text,
        "speed_mps = {:?}\nmin_speed_mps = {:?}\nmax_speed_mps = {:?}\nturn_radius_m = {:?}\nmax_pitch_rad = {:?}\n",
        vehicle.speed_mps,
        vehicle.min_speed_mps,
        vehicle.max_speed_mps,
        vehicle.turn_radius_m,
        vehicle.max_pitch_rad
    );
}
