//! Checks of a mission before the launch.

use crate::tide::{Stretch, Tide};
use crate::{Contingency, Mission, times};
use auv_graph::{ArcId, EdgeSet};
use auv_ocean::Footprint;
use auv_types::Violations;

impl Mission {
    /// The values that no mission may have, whatever its network and its sea.
    #[must_use]
    pub fn malformed(&self) -> Violations {
        let mut violations = Violations::new();
        violations.absorb("vehicle.", self.vehicle.validate());
        if let Some(battery) = &self.battery {
            violations.absorb("battery.", battery.validate());
        }
        violations.require_positive(self.budget_s, "budget_s");
        violations.require(self.launch_s.is_finite(), "launch_s", || {
            format!("is {}; give seconds", self.launch_s)
        });
        violations.require_not_negative(self.reserve_s, "reserve_s");
        violations.require_not_negative(self.min_altitude_m, "min_altitude_m");
        violations.require_not_negative(self.altitude_sigmas, "altitude_sigmas");
        violations.require_not_negative(self.clearance_m, "clearance_m");
        if let Some(bounds) = &self.bounds {
            violations.require(bounds.is_valid() && bounds.low.z >= 0.0, "bounds", || {
                "are not ordered or reach above the surface; begin at depth 0 or below".into()
            });
        }
        self.check_ladders(&mut violations);
        violations.absorb("docking.", self.docking.validate());
        if let Some(surfacing) = &self.surfacing {
            violations.absorb("surface.", surfacing.validate());
        }
        if let Some(navigation) = &self.navigation {
            violations.absorb("navigation.", navigation.validate());
        }
        violations
    }

    /// Everything that keeps the mission from starting: malformed values; waypoints out of bounds or
    /// below the sea bed; a destination that cannot be reached within the budget, or not against the
    /// current as forecast for the launch.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = self.malformed();
        let in_time = self.docks.is_empty() || self.time_model.is_some();
        violations.require(in_time, "docks", || {
            "are several without a time model; give one, so that routes may end at any of them"
                .into()
        });
        if let Some(model) = &self.time_model {
            violations.absorb("", model.validate(&self.network));
        }
        let docks = self.docks.iter().map(|&dock| (dock, "docks"));
        let ends = [(self.start, "start"), (self.destination, "destination")];
        for (node, place) in ends.into_iter().chain(docks) {
            violations.require(self.network.has_node(node), place, || {
                format!(
                    "is node {}; nodes are 0 to {}",
                    node.0,
                    self.network.num_nodes() - 1
                )
            });
        }
        if !violations.is_empty() {
            return violations;
        }
        violations.absorb("", self.misplaced());
        self.check_navigation(&mut violations);
        self.check_time(&mut violations);
        violations
    }

    /// The waypoints out of bounds, on land or below the deepest depth allowed.
    #[must_use]
    pub fn misplaced(&self) -> Violations {
        let mut violations = Violations::new();
        for (node, why) in self.misplacements() {
            let place = format!("waypoints[{}] ({})", node.index(), self.name_of(node));
            violations.push(place, format!("{why}; {}", why.remedy()));
        }
        violations
    }

    /// Checks all ladders.
    pub(crate) fn check_ladders(&self, violations: &mut Violations) {
        check_ladder(&self.contingencies, "contingencies", violations);
        for (i, emergency) in self.emergencies.iter().enumerate() {
            let place = format!("emergencies[{i}]");
            check_ladder(&emergency.ladder, &format!("{place}.ladder"), violations);
            if let Some(outline) = &emergency.within {
                let area = Footprint::Area {
                    outline: outline.clone(),
                };
                area.validate_into(&format!("{place}.within"), violations);
            }
        }
    }

    /// Whether the destination is reached within the budget by the quickest way: along arcs with their
    /// tasks, turns as few as may be, depths changed as fast as the pitch allows.
    fn check_time(&self, violations: &mut Violations) {
        let home_s = |travel_s: Option<&[f64]>| {
            let homes = self.all_docks().map(|dock| {
                let home = self.network.quickest_to(dock, &EdgeSet::empty(), travel_s);
                home.time_from_s(self.start)
            });
            homes.fold(f64::INFINITY, f64::min)
        };
        let arcs = 0..self.network.arcs().len() as u32;
        let shut_s = |arc| {
            if self.is_closed(ArcId(arc)) {
                f64::INFINITY
            } else {
                1.0
            }
        };
        let reached = home_s(Some(&arcs.map(shut_s).collect::<Vec<_>>())).is_finite();
        violations.require(reached, "destination", || {
            format!(
                "{} cannot be reached from {}; add edges",
                self.name_of(self.destination),
                self.name_of(self.start)
            )
        });
        if !reached {
            return;
        }
        let tide = Tide::of(self, Stretch::default());
        let tidal_s = tide.map(|tide| tide.home_s(self.start, self.launch_s));
        let forecast_s = tidal_s.unwrap_or_else(|| {
            let travel_s = times::travel_times_s(self, &self.network, self.launch_s);
            home_s(Some(&travel_s.collect::<Vec<f64>>()))
        });
        violations.require(forecast_s.is_finite(), "current", || {
            format!(
                "as forecast for the launch keeps a vehicle of {} m/s from getting from {} to {}; launch at another time, or with a faster vehicle",
                self.vehicle.speed_mps,
                self.name_of(self.start),
                self.name_of(self.destination)
            )
        });
        // The current may be fairer later: what it takes in still water must fit. Where it changes so much that
        // it matters, that is known.
        let quickest_s = tidal_s.unwrap_or_else(|| home_s(Some(&times::still_times_s(self))));
        let available_s = self.plannable_s(self.available_s(self.budget_s, 0.0));
        let fixes = if self.docking_fix_s() + self.fixes_share() > 0.0 {
            " and the fixes at the surface"
        } else {
            ""
        };
        let is_battery = self.available_s(self.budget_s, 0.0) < self.budget_s;
        let place = if is_battery { "battery" } else { "budget_s" };
        violations.require(quickest_s <= available_s, place, || {
            format!(
                "leaves {available_s:.1} s after the reserve{fixes}, {:.1} s less than the quickest way home; give more",
                quickest_s - available_s
            )
        });
    }
}

fn check_ladder(ladder: &[Contingency], name: &str, violations: &mut Violations) {
    for (i, contingency) in ladder.iter().enumerate() {
        if let Contingency::Loiter { for_s } = contingency {
            let place = format!("{name}[{i}].loiter.for_s");
            let longest_s = Contingency::LONGEST_S;
            violations.require_positive(*for_s, &place);
            violations.require(*for_s <= longest_s, &place, || {
                format!("is {for_s}; give at most {longest_s} s, a week")
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_graph::NodeId;
    use auv_types::Bounds;
    use std::sync::Arc;

    #[test]
    fn whatever_keeps_a_mission_from_starting_is_told_with_its_remedy() {
        type Change = fn(&mut Mission);
        let cases: [(Change, &str); 10] = [
            (|m| m.budget_s = 0.0, "budget_s"),
            (|m| m.launch_s = f64::NAN, "launch_s is NaN; give seconds"),
            (|m| m.reserve_s = -1.0, "reserve_s"),
            (
                |m| m.bounds = Some(Bounds::new([-9e3, -9e3, -1.0].into(), [9e3; 3].into())),
                "bounds are not ordered or reach above the surface; begin at depth 0 or below",
            ),
            (
                |m| m.docks = vec![NodeId(1)],
                "docks are several without a time model; give one",
            ),
            (
                |m| m.destination = NodeId(7),
                "destination is node 7; nodes are 0 to 2",
            ),
            (|m| m.start = NodeId(3), "start is node 3; nodes are 0 to 2"),
            (
                |m| m.closed = (0..6).map(ArcId).collect(),
                "destination 2 cannot be reached from 0; add edges",
            ),
            (
                |m| m.budget_s = 500.0,
                "budget_s leaves 500.0 s after the reserve, 100.0 s less than the quickest way home; give more",
            ),
            (
                |m| m.contingencies = vec![Contingency::Loiter { for_s: 1e6 }],
                "contingencies[0].loiter.for_s is 1000000; give at most 604800 s, a week",
            ),
        ];
        assert!(Fixture::new().mission.validate().is_empty());
        for (change, told) in cases {
            let mut mission = Fixture::new().mission;
            change(&mut mission);
            let text = mission.validate().to_string();
            assert!(text.contains(told), "{text}, not {told}");
            assert_eq!(mission.validate().total(), 1, "{text}");
        }
    }

    #[test]
    fn no_route_home_leads_on_from_a_dock() {
        // 0 - 1 - 2: past the dock 1 no route leads to the destination 2, but the mission may end there.
        let mut mission = Fixture::new().mission;
        mission.time_model = Some(Arc::default());
        let open = mission.network.arc_between(NodeId(0), NodeId(2)).unwrap();
        mission.closed.insert(open);
        mission.docks = vec![NodeId(1)];
        assert!(mission.validate().is_empty(), "{}", mission.validate());
        let onwards = mission.network.arc_between(NodeId(1), NodeId(2)).unwrap();
        assert!(mission.is_closed(onwards));
        mission.docks = vec![NodeId(0)];
        // From the start, a dock too, routes lead everywhere.
        let first = mission.network.arc_between(NodeId(0), NodeId(1)).unwrap();
        assert!(!mission.is_closed(first) && mission.validate().is_empty());
    }
}
