//! Which keys belong to which version of the schema.

/// The keys since version 2; `*` stands for any name or any entry of a list.
const SINCE_2: [&str; 32] = [
    "tasks.*.mandatory",
    "tasks.*.after",
    "tasks.*.windows",
    "tasks.*.pattern",
    "tasks.*.speed_mps",
    "tasks.*.altitude_m",
    "tasks.*.depth_m",
    "edges.*.speed_mps",
    "edges.*.altitude_m",
    "edges.*.depth_m",
    "waypoints.*.tasks",
    "edges.*.tasks",
    "docks",
    "surveys",
    "vehicle.body",
    "vehicle.turn_margin",
    "water_level",
    "altimeter",
    "navigation",
    "docking",
    "surface",
    "launch",
    "battery",
    "emergency",
    "keep_out",
    "keep_in",
    "sea_bed.truth",
    "sea_bed.correlation_m",
    "sea_bed.chart.datum",
    "current.analytic.tide.*.strongest",
    "current.model.extrapolate",
    "ais.columns",
];

/// The first key of a file that its version does not have yet.
pub(super) fn too_new(text: &str, version: i64) -> Option<&'static str> {
    if version >= 2 {
        return None;
    }
    let table = toml::Value::Table(text.parse().ok()?);
    let mut keys = SINCE_2.into_iter();
    keys.find(|key| has(&table, &key.split('.').collect::<Vec<_>>()))
}

fn has(value: &toml::Value, path: &[&str]) -> bool {
    let Some((first, rest)) = path.split_first() else {
        return true;
    };
    match value {
        toml::Value::Table(table) if *first == "*" => table.values().any(|v| has(v, rest)),
        toml::Value::Array(list) if *first == "*" => list.iter().any(|v| has(v, rest)),
        toml::Value::Table(table) => table.get(*first).is_some_and(|v| has(v, rest)),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn newer_keys_are_found_at_any_depth() {
        let old = "name = \"x\"\n[sea_bed]\nflat_m = 20";
        assert_eq!(too_new(old, 1), None);
        let new = format!("{old}\ntruth = \"drawn\"");
        assert_eq!(too_new(&new, 1), Some("sea_bed.truth"));
        assert_eq!(too_new(&new, 2), None);
        let list: toml::Value = toml::Value::Table("a = [{ b = 1 }, { c = 2 }]".parse().unwrap());
        assert!(has(&list, &["a", "*", "c"]) && !has(&list, &["a", "*", "d"]));
    }
}
