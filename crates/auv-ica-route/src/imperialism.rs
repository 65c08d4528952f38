//! The seven steps of the algorithm, on priority vectors.

use crate::empires::{Country, Empire, SPAN, compete, exchange, form_empires, unite};
use crate::settings::IcaSettings;
use auv_planning::{Deadline, StopReason};
use auv_population::{Members, Progress, Search};
use auv_route_encoding::{Decoder, DecoderScratch, KnownRoute, ScoredRoute, UsableArcs};
use auv_types::{ChaCha8Rng, Seed, rand::RngExt};

/// The state of the algorithm.
pub(crate) struct Imperialism<'a> {
    settings: &'a IcaSettings,
    decoder: Decoder<'a>,
    seed: Seed,
    deadline: Deadline<'a>,
    best: ScoredRoute,
    countries: Vec<Country>,
    /// The trial move of each country, by index.
    trials: Members<Country>,
    empires: Vec<Empire>,
    iteration: u64,
    costs: Vec<f64>,
    violations: Vec<f64>,
}

impl<'a> Imperialism<'a> {
    /// A state without countries; `known` is the first best route.
    pub(crate) fn new(
        settings: &'a IcaSettings,
        arcs: &'a UsableArcs<'a>,
        known: &'a KnownRoute,
        (seed, deadline): (Seed, Deadline<'a>),
    ) -> Self {
        Self {
            settings,
            decoder: Decoder::new(arcs, &known.home),
            seed,
            deadline,
            best: known.best.clone(),
            countries: Vec::new(),
            trials: Members::new(settings.countries, || Country {
                priorities: Vec::new(),
                route: ScoredRoute::none(),
            }),
            empires: Vec::new(),
            iteration: 0,
            costs: Vec::new(),
            violations: Vec::new(),
        }
    }

    /// The best route so far.
    pub(crate) fn best(&self) -> &ScoredRoute {
        &self.best
    }

    /// Steps 2 and 3: colonies move towards their imperialists and undergo a revolution with some
    /// probability; imperialists try a revolution.
    fn move_countries(&mut self) {
        let seed = self.seed.split(self.iteration);
        for empire in &self.empires {
            if self.deadline.passed() {
                return;
            }
            let imperialist = &self.countries[empire.imperialist].priorities;
            for &colony in &empire.colonies {
                let random = &mut seed.stream(colony as u64);
                let trial = &mut self.trials.lock(colony).priorities;
                trial.clone_from(&self.countries[colony].priorities);
                for (x, target) in trial.iter_mut().zip(imperialist) {
                    let step = self.settings.assimilation * random.random_range(0.0..1.0);
                    *x = clip(*x + step * (target - *x));
                }
                if random.random_range(0.0..1.0) < self.settings.revolution {
                    apply_revolution(self.settings, trial, random);
                }
            }
            let trial = &mut self.trials.lock(empire.imperialist).priorities;
            trial.clone_from(imperialist);
            apply_revolution(
                self.settings,
                trial,
                &mut seed.stream(empire.imperialist as u64),
            );
        }
    }

    fn update_best(&mut self) {
        for country in &self.countries {
            let (route, best) = (&country.route, &self.best);
            if !route.nodes.is_empty() && route.score < best.score {
                self.best.clone_from(route);
            }
        }
    }
}

impl Search for Imperialism<'_> {
    type Scratch = DecoderScratch;

    fn scratch(&self) -> DecoderScratch {
        DecoderScratch::default()
    }

    fn propose(&mut self) -> u64 {
        if !self.empires.is_empty() {
            self.iteration += 1;
            self.move_countries();
        }
        self.trials.len() as u64
    }

    fn begin(&mut self, granted: u64) -> usize {
        self.trials.len().min(granted as usize)
    }

    fn work(&self, task: usize, scratch: &mut DecoderScratch) {
        let trial = &mut *self.trials.lock(task);
        if self.deadline.passed() {
            trial.route = ScoredRoute::none();
            return;
        }
        let (decoder, priorities) = (&self.decoder, &mut trial.priorities);
        if self.empires.is_empty() {
            decoder.draw(self.seed, 0, task as u64, priorities);
        }
        decoder.decode(
            priorities,
            self.settings.decoding,
            scratch,
            &mut trial.route,
        );
    }

    fn select(&mut self, granted: u64) -> Option<StopReason> {
        let granted = granted as usize;
        let random = &mut self.seed.split(self.iteration).stream(u64::MAX);
        if self.empires.is_empty() {
            let trials = self.trials.iter_mut().take(granted);
            self.countries = trials.map(|trial| trial.clone()).collect();
            self.trials.truncate(granted);
            self.empires = form_empires(self.settings, &self.countries, random);
        } else {
            let imperialists: Vec<usize> = self
                .empires
                .iter()
                .map(|empire| empire.imperialist)
                .collect();
            for (i, trial) in self.trials.iter_mut().take(granted).enumerate() {
                let country = &mut self.countries[i];
                let is_better = self
                    .settings
                    .ranking
                    .order(&trial.route, &country.route)
                    .is_lt();
                if is_better || !imperialists.contains(&i) {
                    std::mem::swap(country, trial);
                }
            }
            exchange(self.settings, &self.countries, &mut self.empires);
            compete(self.settings, &self.countries, &mut self.empires, random);
            if let Some(distance) = self.settings.uniting_distance {
                unite(self.settings, distance, &self.countries, &mut self.empires);
            }
        }
        self.update_best();
        self.costs.clear();
        self.costs.extend(
            self.countries
                .iter()
                .map(|country| country.route.score.cost),
        );
        self.violations.clear();
        self.violations.extend(
            self.countries
                .iter()
                .map(|country| country.route.score.violation),
        );
        (self.iteration >= self.settings.iterations).then_some(StopReason::Finished)
    }

    fn progress(&mut self, _is_observed: bool) -> Progress<'_> {
        Progress {
            best: self.best.score,
            costs: &self.costs,
            violations: &self.violations,
        }
    }
}

/// Adds normal deviates to a share of the coordinates, at least to one.
fn apply_revolution(settings: &IcaSettings, priorities: &mut [f64], random: &mut ChaCha8Rng) {
    let count = (settings.revolution_share * priorities.len() as f64).ceil() as usize;
    for _ in 0..count.max(1).min(priorities.len()) {
        let at = random.random_range(0..priorities.len() as u32) as usize;
        // The sum of twelve uniform numbers less six: nearly normal, and the same bits on any platform.
        let normal = (0..12).map(|_| random.random_range(0.0..1.0)).sum::<f64>() - 6.0;
        priorities[at] = clip(priorities[at] + settings.revolution_spread * SPAN * normal);
    }
}

fn clip(priority: f64) -> f64 {
    priority.clamp(*Decoder::PRIORITIES.start(), *Decoder::PRIORITIES.end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_revolution_changes_its_share_of_the_coordinates_within_the_range() {
        let settings = IcaSettings {
            revolution_share: 0.25,
            revolution_spread: 10.0,
            ..IcaSettings::paper()
        };
        let mut is_at_an_end = false;
        for stream in 0..50 {
            let mut priorities = vec![1.0; 40];
            apply_revolution(&settings, &mut priorities, &mut Seed(1).stream(stream));
            // The same coordinate may be drawn again.
            let changed = priorities.iter().filter(|&&x| x != 1.0).count();
            assert!((5..=10).contains(&changed), "{changed}");
            assert!(priorities.iter().all(|x| Decoder::PRIORITIES.contains(x)));
            is_at_an_end |= priorities.contains(&100.0);
        }
        assert!(is_at_an_end);
        let mut one = vec![1.0; 3];
        apply_revolution(&IcaSettings::paper(), &mut one, &mut Seed(1).stream(0));
        assert_eq!(one.iter().filter(|&&x| x != 1.0).count(), 1);
    }

    #[test]
    fn the_span_is_the_width_of_the_range() {
        assert_eq!(
            SPAN,
            Decoder::PRIORITIES.end() - Decoder::PRIORITIES.start()
        );
    }
}
