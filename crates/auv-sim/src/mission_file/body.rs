//! The body of the vehicle, and the margin of its turns: `body` and `turn_margin` of `[vehicle]`.

use super::document::MissionFile;
use crate::Body;
use auv_types::Violations;

/// Factor on the planned turn radius, by body. At full rudder a REMUS 100 turns with 21 m, which leaves nothing of 20 m.
const fn turn_margin(body: Body) -> f64 {
    match body {
        Body::Point => 1.0,
        Body::Remus100 => 1.25,
    }
}

impl MissionFile {
    /// The same mission with another body than the file says.
    #[must_use]
    pub fn with_body(mut self, body: Body) -> Self {
        self.body = Some(body);
        // The turns between lines are those of the body.
        self.expand();
        self
    }

    /// The body and the margin, and what is left of `[vehicle]`.
    pub(super) fn body_of(&self, violations: &mut Violations) -> (Body, f64, toml::Table) {
        let mut table = self.vehicle.clone();
        let told = table.remove("body");
        let named = told.as_ref().and_then(toml::Value::as_str);
        let known = named.and_then(Body::named);
        violations.require(told.is_none() || known.is_some(), "vehicle.body", || {
            let names = Body::ALL
                .map(|body| format!("`{}`", body.as_str()))
                .join(" or ");
            format!("is {}; give {names}", told.unwrap_or_else(|| "".into()))
        });
        let body = self.body.or(known).unwrap_or_default();
        let told = table.remove("turn_margin");
        let margin = told.as_ref().and_then(|value| {
            let whole = value.as_integer().map(|whole| whole as f64);
            value.as_float().or(whole)
        });
        let sound = margin.is_some_and(|margin| (1.0..=10.0).contains(&margin));
        violations.require(told.is_none() || sound, "vehicle.turn_margin", || {
            format!(
                "is {}; give a factor from 1 to 10",
                told.unwrap_or_else(|| "".into())
            )
        });
        (body, margin.unwrap_or_else(|| turn_margin(body)), table)
    }
}
