//! The tracker: from scans through tracks to predicted regions.

mod chi_square;
mod closing;
mod echoes;
mod fast;
mod known;
mod motion;
mod part;
mod score;
mod settings;
mod size;
mod spans;
#[cfg(test)]
mod tests;
mod track;

pub use settings::{TrackerSettings, sigmas_in_space};
pub use track::Track;

use crate::{Detection, ObstacleId, ObstaclePredictor, Region, Scan};
use auv_types::{Point3, Vector3, Violations};
use chi_square::{Dimensions, quantile};
use part::Seen;

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
    /// Echoes beyond the sonar's range, or with a size or an error that no echo from within it has.
    pub implausible: u64,
    /// Echoes and tracks dropped beyond capacity, the farthest ones.
    pub beyond_capacity: u64,
}

impl Rejected {
    /// What was refused since an earlier count.
    #[must_use]
    pub fn since(&self, before: &Self) -> Self {
        Self {
            stale_scans: self.stale_scans.saturating_sub(before.stale_scans),
            stuck_scans: self.stuck_scans.saturating_sub(before.stuck_scans),
            blind_scans: self.blind_scans.saturating_sub(before.blind_scans),
            malformed: self.malformed.saturating_sub(before.malformed),
            mended: self.mended.saturating_sub(before.mended),
            implausible: self.implausible.saturating_sub(before.implausible),
            beyond_capacity: self.beyond_capacity.saturating_sub(before.beyond_capacity),
        }
    }
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
    #[cfg_attr(feature = "serde", serde(default))]
    reported: Vec<Region>,
    /// By how much the vehicle's own place may be wrong, metres.
    #[cfg_attr(feature = "serde", serde(default))]
    place_error_m: f64,
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
            reported: Vec::new(),
            place_error_m: 0.0,
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
        let sonar = &self.settings.sonar;
        let mut usable = Vec::with_capacity(scan.detections.len());
        for given in &scan.detections {
            let Some(echo) = echoes::mended(given, sonar) else {
                self.rejected.malformed += 1;
                continue;
            };
            self.rejected.mended += u64::from(echo != *given);
            if echoes::is_plausible(&echo, &scan.from, sonar) {
                usable.push(echo);
            } else {
                self.rejected.implausible += 1;
            }
        }
        let most = self.settings.max_detections;
        if usable.len() > most {
            self.rejected.beyond_capacity += (usable.len() - most) as u64;
            let distance = |echo: &Detection| (echo.position - scan.from).norm() - echo.radius_m;
            usable.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
            usable.truncate(most);
        }
        usable
    }

    /// Pairs echoes with tracks, the closest pair first; then, with what is left, new tracks if they are fast.
    /// Returns the track of each echo.
    /// Echoes of what is charted belong to tracks that are confirmed, if to any.
    fn associate(
        &self,
        echoes: &[Detection],
        (charted, seen): (&[bool], &[Seen]),
        from: &Point3<f64>,
    ) -> Vec<Option<usize>> {
        let mut pairs = Vec::new();
        for (t, track) in self.tracks.iter().enumerate() {
            for (e, echo) in echoes.iter().enumerate() {
                let is_new = !track.is_confirmed();
                if is_new && charted[e] || !track.is_as_large_as(echo, seen[e]) {
                    continue;
                }
                let echo = &track.as_known(echo, seen[e], from);
                let (square, dimensions) = track.gate_squared(echo, &self.settings);
                let gate = self.gates[usize::from(dimensions == 6)];
                let fast = || track.distance_squared_if_fast(echo);
                if square <= gate {
                    pairs.push((square / gate, t, e));
                } else if let Some(square) = fast().filter(|square| *square <= gate) {
                    pairs.push((1.0 + square / gate, t, e));
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

    /// Counts a miss if the track should have been detected. Returns whether the track is kept.
    fn is_kept_unseen(
        track: &mut Track,
        scan: &Scan,
        empty: bool,
        settings: &TrackerSettings,
    ) -> bool {
        let at_rest = track.is_at_rest(settings);
        let seen = track.detected(scan, settings);
        if !empty && !track.is_confirmed() {
            track.score.miss(seen);
        }
        if !track.note(false, settings) {
            return false;
        }
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
        let distance = |track: &Track| (track.position() - from).norm() - track.radius_m();
        self.tracks
            .sort_by(|a, b| distance(a).total_cmp(&distance(b)));
        self.tracks.truncate(most);
        self.tracks.sort_by_key(Track::id);
    }
}

impl ObstaclePredictor for Tracker {
    /// Echoes from within a ship belong to it: they start, confirm and move no track.
    fn reported(&mut self, ships: Vec<Region>) {
        self.reported = ships;
    }

    fn observe(&mut self, scan: &Scan) {
        if !self.admits(scan) {
            return;
        }
        let mut echoes = self.usable(scan);
        if echoes.is_empty() && !scan.detections.is_empty() {
            // Something was there, but it is unknown what: the scan counts as no miss for any track.
            self.rejected.blind_scans += 1;
            return;
        }
        let empty = echoes.is_empty();
        echoes.retain(|echo| {
            !known::is_within(&self.reported, echo, scan.time_s, self.place_error_m)
        });
        for track in &mut self.tracks {
            track.predict(scan.time_s, &self.settings);
        }
        let unsure = (self.settings.sonar.near_face, self.place_error_m);
        let is_charted = |echo: &Detection| known::is_of(&self.charted, echo, scan.time_s, unsure);
        let charted: Vec<bool> = echoes.iter().map(is_charted).collect();
        let settings = &self.settings;
        let seen = |echo: &Detection| Seen::of(echo, &scan.from, &settings.sonar);
        let seen: Vec<Seen> = echoes.iter().map(seen).collect();
        let track_of = self.associate(&echoes, (&charted, &seen), &scan.from);
        for ((echo, track), seen) in echoes.iter().zip(&track_of).zip(&seen) {
            if let Some(t) = *track {
                let track = &mut self.tracks[t];
                let known = track.as_known(echo, *seen, &scan.from);
                track.weigh(&known, scan, settings);
                track.update(&known, settings);
                track.show(echo, *seen, &scan.from, settings);
            }
        }
        self.tracks.retain_mut(|track| {
            if track.seen_s >= scan.time_s {
                track.note(true, settings)
            } else {
                Self::is_kept_unseen(track, scan, empty, settings)
            }
        });
        for (e, echo) in echoes.iter().enumerate() {
            if track_of[e].is_none() && !charted[e] {
                let id = ObstacleId(self.next_id);
                self.next_id = self.next_id.saturating_add(1);
                self.tracks
                    .push(Track::new(id, scan.time_s, (echo, seen[e]), settings));
            }
        }
        let own = closing::Own::of(scan, self.last.as_ref());
        for track in &mut self.tracks {
            closing::note(track, &own, &self.settings);
        }
        self.limit(&scan.from);
        self.last = Some(scan.clone());
    }

    fn charted_regions(&self) -> &[Region] {
        &self.charted
    }

    /// The regions of the confirmed tracks, and of those that close in before they are.
    fn contacts(&self, time_s: f64) -> Vec<Region> {
        let mut regions = Vec::with_capacity(self.settings.max_spans * self.tracks.len());
        for track in &self.tracks {
            if track.is_young() {
                closing::young_region_into(track, time_s, &self.settings, &mut regions);
            } else if track.is_confirmed() {
                spans::regions_into(track, time_s, &self.settings, &mut regions);
            } else if track.closes_in() {
                let short = closing::short_lived(&self.settings);
                let fastest = track.at_fastest().clone();
                let track = track.moving(fastest);
                spans::regions_into(&track, time_s, &short, &mut regions);
            }
        }
        regions
    }

    fn is_urgent(&self) -> bool {
        self.tracks.iter().any(Track::closes_in)
    }

    fn fresh_s(&self) -> Option<f64> {
        self.last.as_ref().map(|scan| scan.time_s)
    }

    fn horizon_s(&self) -> f64 {
        self.settings.horizon_s
    }

    fn unsure_of_place(&mut self, by_m: f64) {
        self.place_error_m = if by_m >= 0.0 { by_m } else { 0.0 };
    }

    /// A move farther than any echo may lie is no fix: it changes nothing.
    fn moved(&mut self, by: &Vector3<f64>) {
        if by.iter().all(|x| x.abs() <= echoes::FARTHEST_M) {
            for track in &mut self.tracks {
                track.shift(by);
            }
            if let Some(last) = &mut self.last {
                last.from += by;
            }
        }
    }
}
