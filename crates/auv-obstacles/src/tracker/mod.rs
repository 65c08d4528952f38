//! The tracker: from scans through tracks to predicted regions.

mod chi_square;
mod settings;
mod size;
mod spans;
#[cfg(test)]
mod tests;
mod track;

pub use settings::{TrackerSettings, sigmas_in_space};
pub use track::Track;

use crate::{Detection, ObstacleId, ObstaclePredictor, Region, RegionShape, Scan, Sonar};
use auv_types::{Point3, Violations};
use chi_square::{Dimensions, quantile};

/// Counts of the data a tracker refused.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Rejected {
    /// Scans that are not later than the previous one, or whose time, position or heading is not finite.
    pub stale_scans: u64,
    /// Scans with the same background as the previous one, or with the same noisy echoes bit for bit.
    pub stuck_scans: u64,
    /// Scans with echoes but without a usable one.
    pub blind_scans: u64,
    /// Echoes without a valid position or size.
    pub malformed: u64,
    /// Echoes used with the sonar's errors in place of invalid ones, or without their invalid velocity.
    pub mended: u64,
    /// Echoes beyond the sonar's range.
    pub implausible: u64,
    /// Echoes and tracks dropped beyond capacity, the farthest ones.
    pub beyond_capacity: u64,
}

/// A multi-target tracker: gated nearest-neighbour association, a constant-velocity Kalman filter and a
/// radius filter per track, confirmation and deletion of tracks, and regions that bound the future
/// positions of each contact.
///
/// Clone and (with feature `serde`) serialise it to checkpoint a mission.
///
/// # Determinism
/// Equal scans in equal order give equal tracks and regions, bit for bit.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Tracker {
    settings: TrackerSettings,
    /// Gates for three and six degrees of freedom.
    gates: [f64; 2],
    tracks: Vec<Track>,
    charted: Vec<Region>,
    next_id: u32,
    last: Option<Scan>,
    rejected: Rejected,
}

impl Tracker {
    /// The first id of a track; charted obstacles have lower ids.
    pub const FIRST_TRACK: ObstacleId = ObstacleId(1 << 16);

    /// A tracker without tracks.
    ///
    /// # Errors
    /// Every invalid value of the settings.
    pub fn new(settings: TrackerSettings) -> Result<Self, Violations> {
        settings.validate().into_result()?;
        let gate = |dimensions| quantile(dimensions, settings.gate_probability);
        Ok(Self {
            gates: [gate(Dimensions::Three), gate(Dimensions::Six)],
            settings,
            tracks: Vec::new(),
            charted: Vec::new(),
            next_id: Self::FIRST_TRACK.0,
            last: None,
            rejected: Rejected::default(),
        })
    }

    /// Sets the charted obstacles. They are part of every prediction, unchanged, and their echoes start no
    /// tracks.
    pub fn charted(&mut self, regions: Vec<Region>) {
        self.charted = regions;
    }

    /// The charted obstacles.
    #[must_use]
    pub fn charted_regions(&self) -> &[Region] {
        &self.charted
    }

    /// Whether an id belongs to a track rather than a charted obstacle.
    #[must_use]
    pub fn is_track(id: ObstacleId) -> bool {
        id >= Self::FIRST_TRACK
    }

    /// All tracks, tentative ones included, in the order of their ids.
    #[must_use]
    pub fn tracks(&self) -> &[Track] {
        &self.tracks
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &TrackerSettings {
        &self.settings
    }

    /// The counts of refused data so far.
    #[must_use]
    pub fn rejected(&self) -> Rejected {
        self.rejected
    }

    /// Mission time of the last accepted scan, seconds.
    #[must_use]
    pub fn fresh_s(&self) -> Option<f64> {
        self.last.as_ref().map(|scan| scan.time_s)
    }

    /// Adds the regions of the confirmed tracks from `time_s` on, without the charted obstacles.
    pub fn tracked_into(&self, time_s: f64, regions: &mut Vec<Region>) {
        for track in self.tracks.iter().filter(|track| track.confirmed) {
            spans::regions_into(track, time_s, &self.settings, regions);
        }
    }

    /// Whether a scan is accepted; a refused one is counted.
    fn admits(&mut self, scan: &Scan) -> bool {
        let finite = scan.time_s.is_finite()
            && scan.heading_rad.is_finite()
            && scan.from.iter().all(|x| x.is_finite());
        let Some(last) = &self.last else {
            self.rejected.stale_scans += u64::from(!finite);
            return finite;
        };
        if !finite || scan.time_s <= last.time_s {
            self.rejected.stale_scans += 1;
            return false;
        }
        let noisy = scan
            .detections
            .iter()
            .any(|echo| echo.position_sigma_m > 0.0);
        let repeated = scan.background.is_some() && scan.background == last.background;
        if repeated || noisy && scan.detections == last.detections {
            self.rejected.stuck_scans += 1;
            return false;
        }
        true
    }

    /// The usable echoes of a scan; if there are too many, the nearest ones.
    fn usable(&mut self, scan: &Scan) -> Vec<Detection> {
        let reach_m = 1.1 * self.settings.sonar.range_m;
        let mut echoes = Vec::with_capacity(scan.detections.len());
        for given in &scan.detections {
            let Some(echo) = mended(given, &self.settings.sonar) else {
                self.rejected.malformed += 1;
                continue;
            };
            self.rejected.mended += u64::from(echo != *given);
            let noise_m = echo.position_sigma_m + echo.radius_sigma_m;
            if (echo.position - scan.from).norm() > reach_m + echo.radius_m + 10.0 * noise_m {
                self.rejected.implausible += 1;
            } else {
                echoes.push(echo);
            }
        }
        let most = self.settings.max_detections;
        if echoes.len() > most {
            self.rejected.beyond_capacity += (echoes.len() - most) as u64;
            let distance = |echo: &Detection| (echo.position - scan.from).norm() - echo.radius_m;
            echoes.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            echoes.truncate(most);
        }
        echoes
    }

    /// Pairs echoes with tracks, the closest pair first. Returns the track of each echo.
    fn associate(&self, echoes: &[Detection]) -> Vec<Option<usize>> {
        let mut pairs = Vec::new();
        for (t, track) in self.tracks.iter().enumerate() {
            for (e, echo) in echoes.iter().enumerate() {
                let (square, dimensions) = track.distance_squared(echo);
                let gate = self.gates[usize::from(dimensions == 6)];
                if square <= gate {
                    pairs.push((square / gate, t, e));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        let mut track_of = vec![None; echoes.len()];
        let mut taken = vec![false; self.tracks.len()];
        for (_, t, e) in pairs {
            if !taken[t] && track_of[e].is_none() {
                taken[t] = true;
                track_of[e] = Some(t);
            }
        }
        track_of
    }

    /// Whether an echo comes from a charted obstacle.
    fn is_charted(&self, echo: &Detection, time_s: f64) -> bool {
        self.charted.iter().any(|region| {
            if !region.exists_at(time_s) {
                return false;
            }
            let offset = echo.position - region.centre_at(time_s);
            let distance_m = match region.shape {
                RegionShape::Ball => offset.norm(),
                RegionShape::Cylinder { .. } => offset.xy().norm(),
            };
            let radius_m = region.radius_at(time_s);
            let same = distance_m <= 5.0 * echo.position_sigma_m
                && (echo.radius_m - radius_m).abs() <= 5.0 * echo.radius_sigma_m;
            let sigma_m = echo.position_sigma_m + echo.radius_sigma_m;
            let part = self.settings.sonar.near_face
                && distance_m + echo.radius_m <= radius_m + 3.0 * sigma_m;
            same || part
        })
    }

    /// Counts a miss if the track should have been detected. Returns whether the track is kept.
    fn is_kept_unseen(
        track: &mut Track,
        scan: &Scan,
        empty: bool,
        settings: &TrackerSettings,
    ) -> bool {
        if !track.note(false, settings) {
            return false;
        }
        let at_rest = track.is_at_rest(settings);
        let (place, _, _) = track.state(settings);
        let seen = settings.sonar.detection_probability(
            &scan.from,
            scan.heading_rad,
            &place,
            track.radius_m(),
        );
        let unseen_s = scan.time_s - track.seen_s;
        // An empty scan may come from a dead sonar: it counts as no miss.
        if seen > 0.0 && !empty {
            track.missed -= auv_types::libm::log(1.0 - seen.min(0.99));
            let lost = track.missed > -auv_types::libm::log(settings.lost_odds);
            return !(lost && unseen_s >= settings.lost_after_s);
        }
        at_rest || unseen_s <= settings.forget_after_s
    }

    /// Keeps the tracks nearest the sonar.
    fn limit(&mut self, from: &Point3<f64>) {
        let most = self.settings.max_tracks;
        if self.tracks.len() <= most {
            return;
        }
        self.rejected.beyond_capacity += (self.tracks.len() - most) as u64;
        let distance = |track: &Track| (track.position - from).norm() - track.radius_m();
        self.tracks
            .sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        self.tracks.truncate(most);
        self.tracks.sort_by_key(Track::id);
    }
}

impl ObstaclePredictor for Tracker {
    fn observe(&mut self, scan: &Scan) {
        if !self.admits(scan) {
            return;
        }
        let echoes = self.usable(scan);
        if echoes.is_empty() && !scan.detections.is_empty() {
            // Something was there, but it is unknown what: the scan counts as no miss for any track.
            self.rejected.blind_scans += 1;
            return;
        }
        for track in &mut self.tracks {
            track.predict(scan.time_s, &self.settings);
        }
        let track_of = self.associate(&echoes);
        for (echo, track) in echoes.iter().zip(&track_of) {
            if let Some(t) = *track {
                self.tracks[t].update(echo, &self.settings);
            }
        }
        let settings = &self.settings;
        let empty = echoes.is_empty();
        self.tracks.retain_mut(|track| {
            if track.seen_s >= scan.time_s {
                track.note(true, settings)
            } else {
                Self::is_kept_unseen(track, scan, empty, settings)
            }
        });
        for (echo, track) in echoes.iter().zip(&track_of) {
            if track.is_none() && !self.is_charted(echo, scan.time_s) {
                let id = ObstacleId(self.next_id);
                self.next_id = self.next_id.saturating_add(1);
                self.tracks
                    .push(Track::new(id, scan.time_s, echo, &self.settings));
            }
        }
        self.limit(&scan.from);
        self.last = Some(scan.clone());
    }

    fn at(&self, time_s: f64) -> Vec<Region> {
        let spans = self.settings.max_spans;
        let mut regions = Vec::with_capacity(self.charted.len() + spans * self.tracks.len());
        regions.extend_from_slice(&self.charted);
        self.tracked_into(time_s, &mut regions);
        regions
    }
}

/// The echo with invalid errors replaced and an invalid velocity dropped; `None` if its position or size
/// is invalid.
fn mended(echo: &Detection, sonar: &Sonar) -> Option<Detection> {
    let size = |x: f64| (0.0..=1e7).contains(&x);
    let place = |x: &f64| x.is_finite() && x.abs() <= 1e7;
    if !echo.position.iter().all(place) || !size(echo.radius_m) {
        return None;
    }
    let or = |valid: bool, given: f64, own: f64| if valid && size(given) { given } else { own };
    let widest_m = sonar.position_sigma_m + sonar.angle_sigma_rad * sonar.range_m;
    let velocity = echo
        .velocity
        .filter(|velocity| velocity.iter().all(place) && size(echo.velocity_sigma_mps));
    Some(Detection {
        velocity,
        position_sigma_m: or(
            echo.position_sigma_m > 0.0,
            echo.position_sigma_m,
            widest_m.max(1.0),
        ),
        radius_sigma_m: or(true, echo.radius_sigma_m, sonar.radius_sigma_m),
        ..*echo
    })
}
