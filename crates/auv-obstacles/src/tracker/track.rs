//! One track: the Kalman filter of a contact's motion, and the track's confirmation.

use super::fast::{Fast, Speed};
use super::motion::{Motion, log_likelihood};
use super::part::{Seen, at_radius, outwards};
use super::score::Score;
use super::settings::TrackerSettings;
use super::size::{SETTLED, Size};
use crate::{Detection, ObstacleId, Scan};
use auv_types::{Point3, Vector3};

/// A contact tracked over scans.
///
/// Errors are isotropic and the axes independent, so one 2x2 covariance of (position, velocity) holds for
/// all three axes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Track {
    pub(super) id: ObstacleId,
    /// Time of the state.
    pub(super) time_s: f64,
    pub(super) seen_s: f64,
    #[cfg_attr(feature = "serde", serde(flatten))]
    pub(super) motion: Motion,
    /// How it moves if it is fast; `None` once its echoes have decided.
    #[cfg_attr(feature = "serde", serde(default))]
    fast: Option<Fast>,
    /// Position under the alternative hypothesis that the contact is at rest.
    rest: Point3<f64>,
    rest_pp: f64,
    /// Time since when it would be at rest.
    rest_since_s: f64,
    /// Log odds that the contact moves.
    moves: f64,
    /// Exponential mean of the normalised innovation squared per degree of freedom: about 1 while the model
    /// holds.
    innovation: f64,
    pub(super) size: Size,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) seen: Seen,
    history: u32,
    pub(super) scans: u32,
    pub(super) standing: Standing,
    /// Whether its echoes are of one thing, if it is slow.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) score: Score,
    /// Log odds of existence lost by misses.
    pub(super) missed: f64,
}

/// Whether a track counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) enum Standing {
    /// Too few echoes yet: it may be a false one.
    Tentative,
    /// As tentative, but it closes in, and waiting for more echoes would be too late.
    ClosingIn,
    /// Enough echoes to be true, but its velocity is hardly known, and there is time to see it better.
    Young,
    /// Enough echoes.
    Confirmed,
}

/// What the echoes so far tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motility {
    Rests,
    Moves,
}

/// Mean normalised innovation squared above which a contact counts as manoeuvring.
const MANOEUVRE: f64 = 2.5;
/// The size of an echo of a contact that is not confirmed differs by no more than as many standard deviations, and
/// by this share: the sonar sees more of a large contact as it comes nearer.
const SIZE_SIGMAS: f64 = 7.0;
const SIZE_SHARE: f64 = 0.2;
/// Sizes of echoes of one contact that shows the same part of itself differ by no more standard deviations.
const NOISE_SIGMAS: f64 = 4.0;
/// Log odds that a contact moves are kept within.
const MOST_ODDS: f64 = 12.0;
/// Standard deviation per axis of the drift of a contact at rest, m/s.
const DRIFT_MPS: f64 = 0.1;
/// A contact at rest without an echo for longer is expected where it was, seconds.
const OUT_OF_VIEW_S: f64 = 5.0;

impl Track {
    pub(super) fn new(
        id: ObstacleId,
        time_s: f64,
        (echo, seen): (&Detection, Seen),
        settings: &TrackerSettings,
    ) -> Self {
        let motion = Motion::new(echo, settings.first_speed_mps);
        Self {
            id,
            time_s,
            seen_s: time_s,
            rest: echo.position,
            rest_pp: motion.pp,
            motion,
            fast: Fast::new(echo, settings),
            rest_since_s: time_s,
            moves: 0.0,
            innovation: 1.0,
            size: Size::new(echo.radius_m, echo.radius_sigma_m, settings),
            seen,
            history: 1,
            scans: 1,
            standing: if settings.confirm_hits <= 1 {
                Standing::Confirmed
            } else {
                Standing::Tentative
            },
            score: Score::default(),
            missed: 0.0,
        }
    }

    /// The track's id.
    #[must_use]
    pub fn id(&self) -> ObstacleId {
        self.id
    }

    /// Mission time of the state, seconds.
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Mission time of its last echo, seconds.
    #[must_use]
    pub fn seen_s(&self) -> f64 {
        self.seen_s
    }

    /// Whether enough echoes have confirmed it.
    #[must_use]
    pub fn is_confirmed(&self) -> bool {
        matches!(self.standing, Standing::Young | Standing::Confirmed)
    }

    /// Whether it is predicted for a short time only though it is confirmed: its velocity is hardly known, and the
    /// vehicle has time to see it better first.
    #[must_use]
    pub fn is_young(&self) -> bool {
        self.standing == Standing::Young
    }

    /// Whether it gives regions though it is not confirmed: it closes in, and the vehicle has no time to wait.
    #[must_use]
    pub fn closes_in(&self) -> bool {
        self.standing == Standing::ClosingIn
    }

    /// Echoes within the last scans, 1 to 32.
    pub(super) fn hits(&self, scans: u32) -> u32 {
        let window = u32::MAX >> (32 - scans.clamp(1, 32));
        (self.history & window).count_ones()
    }

    /// Whether it is classified as at rest.
    #[must_use]
    pub fn is_at_rest(&self, settings: &TrackerSettings) -> bool {
        settings.rest_hypothesis && self.moves < -SETTLED
    }

    /// Whether it rests or moves; `None` while that is open.
    pub(super) fn decided(&self, settings: &TrackerSettings) -> Option<Motility> {
        if self.is_at_rest(settings) {
            Some(Motility::Rests)
        } else {
            (self.moves > SETTLED).then_some(Motility::Moves)
        }
    }

    /// The same contact, decided as what it rather is: at rest or moving.
    pub(super) fn likelier(&self) -> Self {
        Self {
            moves: MOST_ODDS.copysign(self.moves),
            ..self.clone()
        }
    }

    /// Estimated position, metres.
    #[must_use]
    pub fn position(&self) -> Point3<f64> {
        self.motion.position
    }

    /// Estimated velocity, m/s.
    #[must_use]
    pub fn velocity(&self) -> Vector3<f64> {
        self.motion.velocity
    }

    /// Variances of position and velocity and their covariance, equal on all axes.
    #[must_use]
    pub fn covariance(&self) -> [f64; 3] {
        [self.motion.pp, self.motion.pv, self.motion.vv]
    }

    /// Estimated mean radius, metres.
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        self.size.mean_m()
    }

    /// Position, velocity and covariance (pp, pv, vv) of the more likely hypothesis.
    pub(super) fn state(
        &self,
        settings: &TrackerSettings,
    ) -> (Point3<f64>, Vector3<f64>, [f64; 3]) {
        if self.is_at_rest(settings) {
            (self.rest, Vector3::zeros(), self.rest_covariance(settings))
        } else {
            (self.position(), self.velocity(), self.covariance())
        }
    }

    /// Covariance of a contact at rest, which may drift too slowly to be noticed: that of a straight line fitted to
    /// its echoes, where slow drift is likelier. It grows for at most one horizon after the last echo.
    fn rest_covariance(&self, settings: &TrackerSettings) -> [f64; 3] {
        let span_s = (self.seen_s - self.rest_since_s).max(1.0);
        let vv = 1.0 / (1.0 / (DRIFT_MPS * DRIFT_MPS) + span_s * span_s / (12.0 * self.rest_pp));
        // The mean of the echoes is where it was in the middle of them.
        let since_s = 0.5 * span_s + (self.time_s - self.seen_s).min(settings.horizon_s);
        [self.rest_pp + vv * since_s * since_s, vv * since_s, vv]
    }

    /// Predicts the state at a later time.
    pub(super) fn predict(&mut self, time_s: f64, settings: &TrackerSettings) {
        let dt_s = time_s - self.time_s;
        self.motion.predict(dt_s, settings);
        if let Some(fast) = &mut self.fast {
            fast.motion.predict(dt_s, settings);
        }
        self.rest_pp += settings.jitter_m2ps * dt_s;
        self.size.predict(dt_s, self.is_at_rest(settings), settings);
        self.time_s = time_s;
    }

    /// The normalised innovation squared of an echo at the track's time, and its degrees of freedom.
    #[must_use]
    pub fn distance_squared(&self, echo: &Detection) -> (f64, usize) {
        self.motion.distance_squared(echo)
    }

    /// As [`Track::distance_squared`], by what the track is known to be: a contact at rest that was out of view
    /// is where it was. Its uncertainty as a moving one has grown so far that it would take any echo.
    pub(super) fn gate_squared(
        &self,
        echo: &Detection,
        settings: &TrackerSettings,
    ) -> (f64, usize) {
        if self.time_s - self.seen_s <= OUT_OF_VIEW_S || !self.is_at_rest(settings) {
            let (square, dimensions) = self.distance_squared(echo);
            let fast = self
                .fast
                .iter()
                .map(|fast| fast.motion.distance_squared(echo).0);
            return (fast.fold(square, f64::min), dimensions);
        }
        let [pp, ..] = self.rest_covariance(settings);
        let s = pp + echo.position_sigma_m * echo.position_sigma_m;
        ((echo.position - self.rest).norm_squared() / s, 3)
    }

    /// As [`Track::distance_squared`], if it is fast, while that is open.
    pub(super) fn distance_squared_if_fast(&self, echo: &Detection) -> Option<f64> {
        let fast = self.fast.as_ref().filter(|_| self.is_of_one_size(echo))?;
        Some(fast.motion.distance_squared(echo).0)
    }

    /// The probability that a scan holds an echo of it.
    pub(super) fn detected(&self, scan: &Scan, settings: &TrackerSettings) -> f64 {
        let (place, _, _) = self.state(settings);
        let (from, radius_m) = (&scan.from, self.radius_m());
        let sonar = &settings.sonar;
        sonar.detection_probability(from, scan.heading_rad, &place, radius_m)
    }

    /// Weighs an echo of a scan against false echoes, before [`Track::update`].
    pub(super) fn weigh(&mut self, echo: &Detection, scan: &Scan, settings: &TrackerSettings) {
        if self.is_confirmed() {
            return;
        }
        let probability = self.detected(scan, settings);
        let expected = (&self.motion, self.radius_m());
        let sonar = &settings.sonar;
        self.score.hit(echo, expected, probability, scan, sonar);
    }

    /// Whether its echoes are of one thing rather than false ones.
    pub(super) fn is_true(&self, settings: &TrackerSettings) -> bool {
        self.score.is_true(0.0, settings)
    }

    /// The same if it is fast.
    pub(super) fn is_true_if_fast(&self, settings: &TrackerSettings) -> bool {
        self.score.is_true(self.odds_if_fast(), settings)
    }

    /// How it moves if it is fast: `None` once that is decided, or while its echoes speak against it.
    pub(super) fn if_fast(&self) -> Option<&Motion> {
        let fast = self.fast.as_ref().filter(|fast| fast.may_be())?;
        Some(&fast.motion)
    }

    /// Whether its echoes are rather those of one thing than false.
    pub(super) fn is_likely(&self) -> bool {
        self.score.is_likely(self.odds_if_fast().max(0.0))
    }

    fn odds_if_fast(&self) -> f64 {
        self.fast.as_ref().map_or(0.0, |fast| fast.odds)
    }

    /// Whether an echo has the size of this contact but for noise. A contact of which the sonar sees more and more
    /// seems to move.
    fn is_of_one_size(&self, echo: &Detection) -> bool {
        (echo.radius_m - self.radius_m()).abs() <= NOISE_SIGMAS * echo.radius_sigma_m
    }

    /// Updates the track with an echo.
    pub(super) fn update(&mut self, echo: &Detection, settings: &TrackerSettings) {
        let (square, dimensions) = self.distance_squared(echo);
        self.innovation = 0.7 * self.innovation + 0.3 * square / dimensions as f64;
        if self.innovation > MANOEUVRE {
            self.motion.vv += settings.manoeuvre_mps * settings.manoeuvre_mps;
            self.innovation = 1.0;
        }
        self.weigh_rest(echo);
        self.fast = self.fast.take().filter(|_| self.is_of_one_size(echo));
        if let Some(fast) = &mut self.fast {
            fast.update(echo, &self.motion);
        }
        self.motion.update(echo);
        self.decide_speed();
        let since_s = self.time_s - self.seen_s;
        self.size
            .update(echo.radius_m, echo.radius_sigma_m, since_s, settings);
        self.seen_s = self.time_s;
        self.missed = 0.0;
    }

    /// Takes the fast motion, or gives it up, where the echoes so far say so.
    fn decide_speed(&mut self) {
        let Some(fast) = &self.fast else { return };
        match fast.decided(self.scans) {
            Speed::Open => return,
            Speed::Fast => {
                self.motion = fast.motion.clone();
                self.score.add(fast.odds);
            }
            Speed::Slow => {}
        }
        self.fast = None;
    }

    /// How it moves if it is fast, while that is open; else as it does.
    pub(super) fn at_fastest(&self) -> &Motion {
        self.fast.as_ref().map_or(&self.motion, |fast| &fast.motion)
    }

    /// The same contact with another motion.
    pub(super) fn moving(&self, motion: Motion) -> Self {
        Self {
            motion,
            ..self.clone()
        }
    }

    /// Whether an echo has the size of this contact. What is as good as known may show another part of itself.
    pub(super) fn is_as_large_as(&self, echo: &Detection, seen: Seen) -> bool {
        let radius_m = self.radius_m();
        let may_differ_m = SIZE_SIGMAS * echo.radius_sigma_m + SIZE_SHARE * radius_m;
        let more_m = echo.radius_m - radius_m;
        let is_part = self.seen.with(seen) == Seen::Part;
        self.is_confirmed() || more_m.abs() <= may_differ_m || is_part && more_m > 0.0
    }

    /// An echo as it would be if it showed as much of the contact as is known of it.
    pub(super) fn as_known(&self, echo: &Detection, seen: Seen, from: &Point3<f64>) -> Detection {
        match self.seen.with(seen) {
            Seen::Whole => *echo,
            Seen::Part => at_radius(echo, self.radius_m(), from),
        }
    }

    /// Takes in how much of the contact an echo of it shows.
    pub(super) fn show(
        &mut self,
        echo: &Detection,
        seen: Seen,
        from: &Point3<f64>,
        settings: &TrackerSettings,
    ) {
        let more_m = echo.radius_m - self.radius_m();
        if self.seen.with(seen) == Seen::Part && more_m > 0.0 {
            self.shift(&(outwards(echo, from) * more_m));
            self.size.show(echo.radius_m, echo.radius_sigma_m, settings);
        }
        self.seen = seen;
    }

    /// Moves it by as much as the vehicle's own place was put right, or as its centre is farther away than it was known.
    pub(super) fn shift(&mut self, by: &Vector3<f64>) {
        self.motion.position += by;
        self.rest += by;
        if let Some(fast) = &mut self.fast {
            fast.motion.position += by;
        }
    }

    /// Compares the echo's likelihoods under motion and at rest, then updates the rest position.
    fn weigh_rest(&mut self, echo: &Detection) {
        let r = echo.position_sigma_m * echo.position_sigma_m;
        let gain = log_likelihood(echo, &self.motion.position, self.motion.pp)
            - log_likelihood(echo, &self.rest, self.rest_pp);
        self.moves = (self.moves + gain).clamp(-MOST_ODDS, MOST_ODDS);
        if self.moves >= MOST_ODDS {
            (self.rest, self.rest_pp, self.rest_since_s) = (echo.position, r, self.time_s);
            return;
        }
        let k = self.rest_pp / (self.rest_pp + r);
        self.rest += (echo.position - self.rest) * k;
        self.rest_pp -= k * self.rest_pp;
    }

    /// Records whether a scan held an echo of the contact. Returns whether the track is kept: a tentative
    /// one until its confirmation window ends.
    pub(super) fn note(&mut self, hit: bool, settings: &TrackerSettings) -> bool {
        self.history = (self.history << 1) | u32::from(hit);
        self.scans = self.scans.saturating_add(1);
        if !self.is_confirmed() && self.hits(settings.confirm_window) >= settings.confirm_hits {
            self.standing = Standing::Confirmed;
        }
        let is_open = self.scans < settings.confirm_window;
        let is_seen = self.hits(settings.confirm_hits) > 0 || self.closes_in();
        self.is_confirmed() || is_open || is_seen && self.is_likely()
    }
}
