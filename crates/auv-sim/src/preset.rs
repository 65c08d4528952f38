//! Presets: consistent values for a whole mission.

use crate::Body;
use auv_mission::SyncSettings;
use auv_obstacles::truth::{Birth, FieldSettings};
use auv_obstacles::{ClearancePolicy, Sonar, TrackerSettings};
use auv_ocean::{AnalyticCurrent, TidalConstituent};
use auv_planning::Vehicle;
#[cfg(feature = "mission-file")]
use {auv_ocean::SeaBed, auv_planning::motion::Floor};

/// A consistent set of values for vehicle, sonar, tracker, clearance, current, obstacles, synchroniser
/// and reserve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum Preset {
    /// The paper's vehicle: 3 m/s, able to hover, a sonar that sees 1000 m all round, not moved by the
    /// current.
    Paper,
    /// A survey vehicle of 2 m length: 1.5 m/s, unable to stop, a sonar that sees 100 m ahead, moved by
    /// the tide.
    Default,
    /// The paper's mission at half the speeds and twice the budget: 1.5 m/s.
    PaperAtSea,
}

/// The values of a preset.
#[derive(Clone, Debug, PartialEq)]
pub struct PresetValues {
    /// The vehicle.
    pub vehicle: Vehicle,
    /// Its body.
    pub body: Body,
    /// The sonar.
    pub sonar: Sonar,
    /// The tracker.
    pub tracker: TrackerSettings,
    /// Margins around predicted regions, by their source.
    pub clearance: ClearancePolicy,
    /// The synchroniser.
    pub synchroniser: SyncSettings,
    /// The motion of true obstacles.
    pub obstacle_motion: FieldSettings,
    /// Sizes and velocities of random obstacles.
    pub birth: Birth,
    /// Radius around start and destination that random obstacles keep out of, and least initial distance of
    /// their surfaces from every waypoint, metres.
    pub keep_out_m: f64,
    /// The current of a mission that states none.
    pub current: PresetCurrent,
    /// Time available, seconds.
    pub budget_s: f64,
    /// Share of the budget kept in reserve.
    pub reserve_share: f64,
    /// Time between two ticks of the synchroniser and between two scans, seconds.
    pub tick_s: f64,
    /// Greatest guidance error, metres.
    pub guidance_error_m: f64,
    /// Clearance to every predicted region, in addition to `clearance`, metres.
    pub clearance_m: f64,
    /// Least altitude over the sea bed, metres, without the depth's uncertainty.
    pub min_altitude_m: f64,
    /// Standard deviations of the depth added to the least altitude.
    pub altitude_sigmas: f64,
}

/// The current of a preset.
#[derive(Clone, Debug, PartialEq)]
pub enum PresetCurrent {
    /// The paper's: uniform and constant, drawn for each mission. It moves drifting obstacles only.
    Drawn {
        /// Standard deviation of the speed, which is |N(0, sigma)|, m/s.
        speed_sigma_mps: f64,
    },
    /// A tide that moves the vehicle too. The true current differs from this forecast by an
    /// [error drawn for each mission](auv_ocean::ForecastError::draw).
    Tidal(AnalyticCurrent),
}

impl Preset {
    /// All presets.
    pub const ALL: [Self; 3] = [Self::Paper, Self::Default, Self::PaperAtSea];

    /// Its name in files and tables.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Default => "default",
            Self::PaperAtSea => "paper_at_sea",
        }
    }

    /// Its values.
    #[must_use]
    pub fn values(self) -> PresetValues {
        match self {
            Self::Paper => PresetValues::paper(),
            Self::Default => PresetValues::survey(),
            Self::PaperAtSea => PresetValues::paper_at_sea(),
        }
    }
}

impl PresetValues {
    fn paper() -> Self {
        Self {
            vehicle: Vehicle::paper(),
            body: Body::Point,
            sonar: Sonar::paper(),
            tracker: TrackerSettings::paper(),
            clearance: ClearancePolicy::paper(),
            synchroniser: SyncSettings::paper(),
            obstacle_motion: FieldSettings::paper(),
            birth: Birth::paper(),
            keep_out_m: 300.0,
            current: PresetCurrent::Drawn {
                speed_sigma_mps: 0.3,
            },
            budget_s: 10_800.0,
            reserve_share: 0.0,
            tick_s: 10.0,
            guidance_error_m: 0.0,
            clearance_m: 0.0,
            min_altitude_m: 0.0,
            altitude_sigmas: 0.0,
        }
    }

    /// The floor over a bed.
    #[cfg(feature = "mission-file")]
    pub(crate) fn floor<'a>(&self, bed: Option<&'a dyn SeaBed>) -> Option<Floor<'a>> {
        bed.map(|bed| Floor {
            bed,
            min_altitude_m: self.min_altitude_m,
            altitude_sigmas: self.altitude_sigmas,
        })
    }

    /// The tracker's speeds for a vehicle that is slower and sees less far than the survey vehicle, as in a
    /// pool: what moves there is slower by as much. A slow vehicle that sees as far as the survey vehicle, or
    /// a fast one that sees less far, keeps the tracker's own.
    #[cfg(feature = "mission-file")]
    pub(crate) fn scaled_tracker(&self) -> TrackerSettings {
        let (vehicle, sonar) = (Vehicle::default(), Sonar::default());
        let slower = self.vehicle.speed_mps / vehicle.speed_mps;
        let nearer = self.sonar.range_m / sonar.range_m;
        let scale = slower.max(nearer);
        let mut tracker = self.tracker.clone();
        if scale < 1.0 {
            let scale = scale * scale;
            tracker.first_speed_mps *= scale;
            tracker.manoeuvre_mps *= scale;
            tracker.acceleration_mps2 *= scale;
            tracker.growth_sigma_mps *= scale;
            tracker.growth_noise_m2ps3 *= scale * scale;
        }
        tracker
    }

    fn paper_at_sea() -> Self {
        let mut values = Self::paper();
        values.vehicle.speed_mps *= 0.5;
        values.vehicle.max_speed_mps *= 0.5;
        values.obstacle_motion.jitter_mps *= 0.5;
        values.budget_s *= 2.0;
        values.current = PresetCurrent::Drawn {
            speed_sigma_mps: 0.15,
        };
        values
    }

    fn survey() -> Self {
        Self {
            vehicle: Vehicle::default(),
            body: Body::Point,
            sonar: Sonar::default(),
            // Every second scan is used.
            tracker: TrackerSettings::default(),
            clearance: ClearancePolicy::default(),
            synchroniser: SyncSettings::default(),
            obstacle_motion: FieldSettings::default(),
            birth: Birth::default(),
            keep_out_m: 100.0,
            current: PresetCurrent::Tidal(AnalyticCurrent {
                mean_mps: [0.25, 0.0],
                tide: vec![TidalConstituent::turning_at(10_800.0, [0.4, 0.0])],
                ..AnalyticCurrent::default()
            }),
            budget_s: 21_600.0,
            reserve_share: 0.15,
            tick_s: 1.0,
            guidance_error_m: 2.0,
            clearance_m: 0.0,
            min_altitude_m: 5.0,
            altitude_sigmas: 2.0,
        }
    }
}
