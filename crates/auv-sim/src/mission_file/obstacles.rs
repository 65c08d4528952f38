//! The true obstacles of a mission file.

use super::document::{DrawnNumber, GroupEntry, MissionFile, ObstacleEntry};
use super::places;
use auv_obstacles::RegionShape;
use auv_obstacles::truth::{
    FieldSettings, MissionObstacles, Obstacle, ObstacleClass, ObstacleField,
};
use auv_ocean::{LocalFrame, SeaBed};
use auv_types::rand::RngExt;
use auv_types::{Bounds, ChaCha8Rng, Point3, Seed, Vector3, Violations, libm};

/// Most obstacles a mission may have.
const MOST: usize = 10_000;

/// The message for a velocity of an obstacle that rests.
const RESTS: &str =
    "is given for a class that rests; leave it out or give class moving or drifting";

/// The area of the obstacles and what they keep clear of.
pub(super) struct Surroundings<'a> {
    pub(super) frame: Option<&'a LocalFrame>,
    pub(super) bounds: Option<&'a Bounds>,
    pub(super) sea_bed: Option<&'a dyn SeaBed>,
    pub(super) waypoints: &'a [Point3<f64>],
    pub(super) start: usize,
    pub(super) dock: usize,
    pub(super) sonar_range_m: f64,
}

/// All obstacles: the listed ones, then the groups, then the random ones. `None` if anything is invalid;
/// the reasons are added to `violations`.
pub(super) fn field(
    file: &MissionFile,
    settings: FieldSettings,
    around: &Surroundings<'_>,
    seed: Seed,
    violations: &mut Violations,
) -> Option<ObstacleField> {
    let groups = file
        .obstacle_groups
        .iter()
        .fold(0_usize, |sum, group| sum.saturating_add(group.count));
    let count = groups.saturating_add(file.obstacles.len() + file.random_obstacles.min(MOST));
    violations.require(
        count <= MOST && file.random_obstacles <= MOST,
        "obstacles",
        || format!("are {count} including groups and random ones; give at most {MOST}"),
    );
    if count > MOST {
        return None;
    }
    let mut obstacles = Vec::with_capacity(count);
    for (i, entry) in file.obstacles.iter().enumerate() {
        let place = format!("obstacles[{i}] ({})", entry.name);
        let mut random = seed.split(0).stream(i as u64);
        obstacles.push(listed(entry, around, &place, &mut random, violations));
    }
    for (i, group) in file.obstacle_groups.iter().enumerate() {
        let place = format!("obstacle_groups[{i}] ({})", group.name);
        let mut random = seed.split(1).stream(i as u64);
        scattered(
            group,
            around,
            &place,
            &mut random,
            violations,
            &mut obstacles,
        );
    }
    if file.random_obstacles > 0 {
        match at_random(file, &settings, around, seed.split(2)) {
            Some(random) => obstacles.extend(random),
            None => violations.push("random_obstacles", "needs a [box]; give one"),
        }
    }
    if !violations.is_empty() {
        return None;
    }
    match ObstacleField::new(obstacles, settings, seed.split(3)) {
        Ok(field) => Some(field),
        Err(wrong) => {
            violations.absorb("", wrong);
            None
        }
    }
}

fn shape(
    top_m: Option<f64>,
    bottom_m: Option<f64>,
    place: &str,
    violations: &mut Violations,
) -> RegionShape {
    match (top_m, bottom_m) {
        (None, None) => RegionShape::Ball,
        (Some(top_m), Some(bottom_m)) => {
            let finite = top_m.is_finite() && bottom_m.is_finite();
            violations.require(finite, place, || {
                format!("has top_m {top_m} and bottom_m {bottom_m}; give metres")
            });
            RegionShape::Cylinder { top_m, bottom_m }
        }
        _ => {
            violations.push(
                place,
                "has one of top_m and bottom_m; give both for a cylinder, neither for a ball",
            );
            RegionShape::Ball
        }
    }
}

/// The obstacle of an entry, moved by a random offset of at most `scatter_m`.
fn listed(
    entry: &ObstacleEntry,
    around: &Surroundings<'_>,
    place: &str,
    random: &mut ChaCha8Rng,
    violations: &mut Violations,
) -> Obstacle {
    let mut centre = places::point(&entry.at, around.frame, place, violations);
    let key = |name: &str| format!("{place}.{name}");
    violations.require_not_negative(entry.scatter_m, &key("scatter_m"));
    violations.require_not_negative(
        entry.uncertainty_m.unwrap_or_default(),
        &key("uncertainty_m"),
    );
    violations.require(entry.appears_s.is_finite(), &key("appears_s"), || {
        format!("is {}; give seconds", entry.appears_s)
    });
    let reach_m = entry.scatter_m * libm::sqrt(random.random::<f64>());
    let (sin, cos) = libm::sincos(std::f64::consts::TAU * random.random::<f64>());
    centre += Vector3::new(cos, sin, 0.0) * reach_m;
    let still = entry.velocity_mps.iter().all(|&v| v == 0.0);
    violations.require(moves(entry.class) || still, &key("velocity_mps"), || {
        RESTS.into()
    });
    let finite = entry.velocity_mps.iter().all(|v| v.is_finite());
    violations.require(finite, &key("velocity_mps"), || {
        format!("is {:?}; give m/s north, east and down", entry.velocity_mps)
    });
    let radius_m = entry.radius_m.draw(&key("radius_m"), random, violations);
    let mut obstacle = Obstacle::new(entry.class, centre, radius_m)
        .with_velocity(Vector3::from(entry.velocity_mps));
    obstacle.shape = shape(entry.top_m, entry.bottom_m, place, violations);
    obstacle.appears_s = entry.appears_s;
    if let Some(uncertainty_m) = entry.uncertainty_m {
        obstacle.uncertainty_m = uncertainty_m;
    }
    // A value refused above is not reported twice.
    if violations.is_empty() {
        obstacle.validate_into(place, violations);
    }
    obstacle
}

/// Adds a group's obstacles, placed in the water, clear of waypoints and of each other.
fn scattered(
    group: &GroupEntry,
    around: &Surroundings<'_>,
    place: &str,
    random: &mut ChaCha8Rng,
    violations: &mut Violations,
    obstacles: &mut Vec<Obstacle>,
) {
    let shape = shape(group.top_m, group.bottom_m, place, violations);
    check_group(group, place, violations);
    let before = obstacles.len();
    let wrong_before = violations.total();
    for _ in 0..group.count.saturating_mul(100) {
        if obstacles.len() - before == group.count || violations.total() > wrong_before {
            break;
        }
        let mut obstacle = drawn(group, place, random, violations);
        obstacle.shape = shape;
        if is_free(&obstacle, group, around, &obstacles[before..]) {
            obstacle.validate_into(place, violations);
            obstacles.push(obstacle);
        }
    }
    let found = obstacles.len() - before;
    violations.require(
        found == group.count || violations.total() > wrong_before,
        place,
        || {
            format!(
                "has room for {found} of its {}; give fewer, smaller ones or a larger area",
                group.count
            )
        },
    );
}

fn check_group(group: &GroupEntry, place: &str, violations: &mut Violations) {
    violations.require_not_negative(
        group.clear_of_waypoints_m,
        &format!("{place}.clear_of_waypoints_m"),
    );
    violations.require_not_negative(
        group.uncertainty_m.unwrap_or_default(),
        &format!("{place}.uncertainty_m"),
    );
    violations.require(
        moves(group.class) || group.speed_mps.is_none(),
        &format!("{place}.speed_mps"),
        || RESTS.into(),
    );
}

/// One obstacle of a group, anywhere in the group's area.
fn drawn(
    group: &GroupEntry,
    place: &str,
    random: &mut ChaCha8Rng,
    violations: &mut Violations,
) -> Obstacle {
    let mut draw =
        |range: DrawnNumber, key: &str| range.draw(&format!("{place}.{key}"), random, violations);
    let north_m = draw(DrawnNumber::Between(group.north_m), "north_m");
    let east_m = draw(DrawnNumber::Between(group.east_m), "east_m");
    let centre = Point3::new(north_m, east_m, draw(group.depth_m, "depth_m"));
    let radius_m = draw(group.radius_m, "radius_m");
    let speed_mps = group
        .speed_mps
        .map_or(0.0, |speed| draw(speed, "speed_mps"));
    let any_heading = DrawnNumber::Between([0.0, std::f64::consts::TAU]);
    let heading_rad = draw(any_heading, "heading");
    violations.require_not_negative(speed_mps, &format!("{place}.speed_mps"));
    violations.require_positive(radius_m, &format!("{place}.radius_m"));
    let mut obstacle = Obstacle::new(group.class, centre, radius_m);
    if moves(group.class) {
        let (sin, cos) = libm::sincos(heading_rad);
        obstacle.velocity_mps = Vector3::new(cos, sin, 0.0) * speed_mps;
    }
    if let Some(uncertainty_m) = group.uncertainty_m {
        obstacle.uncertainty_m = uncertainty_m;
    }
    obstacle
}

/// Whether an obstacle lies in water, clear of waypoints and of the group's other obstacles.
fn is_free(
    obstacle: &Obstacle,
    group: &GroupEntry,
    around: &Surroundings<'_>,
    others: &[Obstacle],
) -> bool {
    let (centre, radius_m) = (obstacle.centre, obstacle.radius_m);
    let separate =
        |other: &Obstacle| (other.centre.xy() - centre.xy()).norm() > other.radius_m + radius_m;
    let clear = |waypoint: &Point3<f64>| {
        (waypoint.xy() - centre.xy()).norm() > radius_m + group.clear_of_waypoints_m
    };
    let wet = around
        .sea_bed
        .is_none_or(|bed| bed.depth_at(centre.x, centre.y) > 0.0);
    wet && around.waypoints.iter().all(clear) && others.iter().all(separate)
}

/// Whether obstacles of a class have a velocity of their own.
fn moves(class: ObstacleClass) -> bool {
    matches!(class, ObstacleClass::Moving | ObstacleClass::Drifting)
}

/// Random obstacles of all four classes within the waypoints' layer, with the preset's sizes. `None`
/// without a box.
fn at_random(
    file: &MissionFile,
    settings: &FieldSettings,
    around: &Surroundings<'_>,
    seed: Seed,
) -> Option<Vec<Obstacle>> {
    let bounds = around.bounds?;
    let deepest_m = around
        .waypoints
        .iter()
        .map(|p| p.z)
        .fold(bounds.low.z, f64::max);
    let mut high = bounds.high;
    high.z = deepest_m.max(bounds.low.z + 1.0);
    let mut spread = MissionObstacles::campaign(
        file.random_obstacles,
        Bounds::new(bounds.low, high),
        around.waypoints.to_vec(),
        around.waypoints[around.start],
        around.waypoints[around.dock],
    );
    let values = file.preset.values();
    spread.field = settings.clone();
    spread.sonar_range_m = around.sonar_range_m;
    (spread.keep_out_m, spread.birth) = (values.keep_out_m, values.birth);
    Some(spread.generate(seed))
}
