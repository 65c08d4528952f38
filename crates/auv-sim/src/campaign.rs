//! Campaigns: many missions of the paper's Table 2 set-up.

use crate::drawn_current::drawn_current;
use crate::{Body, Fences, Scenario};
use auv_graph::{NoInstance, Terrain};
use auv_mission::{MarginSettings, Mission, PlanningSettings, SyncSettings, WatchdogSettings};
use auv_obstacles::truth::MissionObstacles;
use auv_obstacles::{ClearancePolicy, Sonar, TrackerSettings};
use auv_planning::{Budget, Vehicle};
use auv_types::{Bounds, Point3, Seed};
use std::sync::Arc;

/// Missions of the paper's Table 2 set-up: 50 waypoints, 1470 directed edges, a budget of 10,800 s, all
/// four obstacle classes, a noisy sonar.
///
/// # Determinism
/// Mission `k` depends on the campaign and on `k` only.
#[derive(Clone, Debug, PartialEq)]
pub struct Campaign {
    /// Seed of the campaign.
    pub seed: Seed,
    /// The network of each mission.
    pub terrain: Terrain,
    /// Number of obstacles. By default 4.5 obstacles on average have their surface within 500 m of a leg.
    pub obstacles: usize,
    /// Settings of the synchroniser.
    pub settings: SyncSettings,
    /// Clearance to every predicted region, metres.
    pub clearance_m: f64,
    /// Part of the budget kept in reserve, seconds.
    pub reserve_s: f64,
    /// Whether all missions share one network (the paper's "same initial condition").
    pub same_network: bool,
}

impl Campaign {
    /// Depth of the paper's box, metres.
    const TERRAIN_DEPTH_M: f64 = 1000.0;
    /// Depth of the waypoints' layer, metres.
    const LAYER_M: f64 = 100.0;
    /// Standard deviation of the current's speed, m/s.
    const CURRENT_SIGMA_MPS: f64 = 0.3;
    /// Mean number of obstacles near a leg: the middle of the paper's 3 to 6.
    const NEAR_A_LEG: f64 = 4.5;

    /// The campaign of Table 2's set-up.
    ///
    /// # Errors
    /// [`NoInstance`] if no network can be drawn.
    pub fn table2(seed: Seed) -> Result<Self, NoInstance> {
        let mut campaign = Self {
            seed,
            terrain: Terrain::table2(),
            obstacles: 0,
            settings: SyncSettings {
                planning: PlanningSettings {
                    // More evaluations do not pay: the route is improved at every waypoint.
                    launch_budget: Budget::evaluations(3_000),
                    ..PlanningSettings::default()
                },
                // Less than the default: the paper's vehicle keeps its trajectory exactly.
                margins: MarginSettings {
                    detour_margin: 0.003,
                    detour_margin_s: 1.0,
                    off_track_m: 5.0,
                    ..MarginSettings::default()
                },
                watchdogs: WatchdogSettings {
                    // Two ticks of ten seconds each.
                    clock_stalls: 2,
                    // A sonar that sees 1000 m all round may be silent for longer.
                    sonar_silence_s: 120.0,
                    ..WatchdogSettings::default()
                },
                ..SyncSettings::default()
            },
            clearance_m: 5.0,
            reserve_s: 60.0,
            same_network: false,
        };
        // The number of obstacles is the same for every seed: it belongs to the set-up.
        let reference = campaign.terrain.draw(Seed(0))?;
        let position =
            |node: auv_graph::NodeId| reference.network.waypoints()[node.index()].position;
        let legs: Vec<_> = reference
            .network
            .arcs()
            .iter()
            .map(|arc| (position(arc.tail), position(arc.head)))
            .collect();
        let field = campaign.obstacles_of(&reference);
        campaign.obstacles = field.count_for_density(&legs, Self::NEAR_A_LEG, 500.0, Seed(0));
        Ok(campaign)
    }

    fn obstacles_of(&self, instance: &auv_graph::RouteInstance) -> MissionObstacles {
        let waypoints: Vec<_> = instance
            .network
            .waypoints()
            .iter()
            .map(|w| w.position)
            .collect();
        let (start, dock) = (
            waypoints[instance.start.index()],
            waypoints[instance.destination.index()],
        );
        let extent_m = self.terrain.extent_m;
        let layer = Bounds::new(
            Point3::origin(),
            Point3::new(extent_m, extent_m, Self::LAYER_M),
        );
        MissionObstacles::campaign(self.obstacles, layer, waypoints, start, dock)
    }

    /// The seed of mission `k`.
    #[must_use]
    pub fn mission_seed(&self, k: u64) -> Seed {
        self.seed.split(k)
    }

    /// Mission `k`.
    ///
    /// # Errors
    /// [`NoInstance`] if its network cannot be drawn.
    pub fn scenario(&self, k: u64) -> Result<Scenario, NoInstance> {
        let seed = self.mission_seed(k);
        let network_seed = if self.same_network {
            self.seed.split(u64::MAX)
        } else {
            seed.split(0)
        };
        let instance = self.terrain.draw(network_seed)?;
        let field = self.obstacles_of(&instance).build(seed.split(1))?;
        let extent_m = self.terrain.extent_m;
        let mission = Mission {
            bounds: Some(Bounds::new(
                Point3::origin(),
                Point3::new(extent_m, extent_m, Self::TERRAIN_DEPTH_M),
            )),
            clearance_m: self.clearance_m,
            reserve_s: self.reserve_s,
            ..Mission::new(
                Arc::new(instance.network),
                instance.start,
                instance.destination,
                instance.budget_s,
                Vehicle::paper(),
            )
        };
        Ok(Scenario {
            name: format!("campaign-{}-{k}", self.seed.0),
            preset: "paper".into(),
            mission: Arc::new(mission),
            settings: self.settings.clone(),
            field,
            true_current: Some(drawn_current(Self::CURRENT_SIGMA_MPS, seed.split(2))),
            current_moves_vehicle: false,
            true_bed: None,
            water_level: None,
            fences: Fences::default(),
            altimeter: None,
            sonar: Sonar::paper(),
            tracker: TrackerSettings::campaign(),
            clearance: ClearancePolicy::paper(),
            tick_s: 10.0,
            body: Body::Point,
            guidance_error_m: 0.0,
            seed: seed.split(3),
            warnings: Vec::new(),
        })
    }
}
