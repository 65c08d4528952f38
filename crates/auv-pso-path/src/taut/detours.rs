//! The search for better sides: detours of the best string, drawn at random and tightened side by
//! side; those that gain are merged.

use crate::taut::candidate::Candidate;
use crate::taut::detour::Detour;
use crate::taut::search_context::SearchContext;
use crate::taut::string::{StringSolver, Tightening};
use auv_planning::StopReason;
use auv_population::{Members, Progress, Search};
use auv_types::{Point3, Seed};

/// Evaluations that a detour is charged beforehand: its stretch is a quarter of the string or less.
/// What it takes beyond them is charged with the next.
const EVALUATIONS: u64 = 4;
/// Most rounds and evaluations of a merged string, and the farthest first move of a vertex: less than
/// the band in which regions are seen, so that the string keeps its sides.
const MERGED_ROUNDS: u64 = 20;
const MERGED_EVALUATIONS: u64 = 150;
const MERGED_TRUST_M: f64 = 20.0;
/// Gain of a round below which a merged string is taut, as a share of the straight line.
const MERGED_TOLERANCE: f64 = 1e-6;
/// Tries without a gain after which the search gives up, for each contact of the string and one more.
const TRIES_PER_CONTACT: u64 = 8;

/// The search round the best candidate.
#[derive(Debug)]
pub(crate) struct DetourSearch<'a> {
    context: SearchContext<'a>,
    seed: Seed,
    best: Candidate,
    detours: Members<Detour>,
    solver: StringSolver<'a>,
    generation: u64,
    /// Generations since the last gain.
    idle: u64,
    patience: u64,
    /// Evaluations that past steps took beyond what was granted for them.
    debt: u64,
    /// Detours tried in this generation.
    tried: u64,
}

impl<'a> DetourSearch<'a> {
    /// A search that tries `size` detours at a time. `patience` multiplies the tries without a gain
    /// after which it gives up.
    pub(crate) fn new(
        context: SearchContext<'a>,
        seed: Seed,
        best: Candidate,
        size: usize,
        patience: u64,
    ) -> Self {
        Self {
            context,
            seed,
            best,
            detours: Members::new(size, Detour::default),
            solver: StringSolver::new(context.problem, context.regions),
            generation: 0,
            idle: 0,
            patience,
            debt: 0,
            tried: 0,
        }
    }

    pub(crate) fn into_best(self) -> Candidate {
        self.best
    }

    /// The best string with the gaining detours in it, or with only the one that gains most.
    fn merged(&mut self, only_first: bool) -> Vec<Point3<f64>> {
        let detours = self.detours.iter_mut().map(|detour| &*detour);
        let mut order: Vec<&Detour> = detours.filter(|d| d.gain_s > 0.0).collect();
        order.sort_by(|a, b| b.gain_s.total_cmp(&a.gain_s));
        let mut taken: Vec<&Detour> = Vec::new();
        for detour in order {
            let disjoint = taken.iter().all(|other| detour.is_disjoint_from(other));
            if disjoint && (taken.is_empty() || !only_first) {
                taken.push(detour);
            }
        }
        taken.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
        let all = &self.best.string.points;
        let mut points = Vec::new();
        let mut from_s = f64::NEG_INFINITY;
        for detour in taken {
            let between = |time_s: f64| time_s > from_s && time_s < detour.from_s;
            points.extend(all.iter().filter(|p| between(p.time_s)).map(|p| p.position));
            points.extend(&detour.points);
            from_s = detour.until_s;
        }
        points.extend(all.iter().filter(|p| p.time_s > from_s).map(|p| p.position));
        points
    }

    /// Tightens the merged string. Returns whether it is the new best.
    fn adopt(&mut self, only_first: bool) -> bool {
        let points = self.merged(only_first);
        let SearchContext {
            problem,
            departure,
            rate,
            deadline,
            ..
        } = self.context;
        let limits = Tightening {
            rounds: MERGED_ROUNDS,
            trust_m: MERGED_TRUST_M,
            tolerance: MERGED_TOLERANCE,
            limit_s: f64::INFINITY,
            work: rate.units(MERGED_EVALUATIONS),
            deadline,
        };
        let tightened = self.solver.tighten(&points, departure.end_s, &limits);
        let candidate = Candidate::new(problem, departure, self.solver.taut_string());
        let examined = candidate.as_ref().map_or(0, |c| c.work(problem));
        self.debt += rate.evaluations(tightened.work + examined);
        let better = candidate.filter(|c| c.is_better(&self.best));
        let adopted = better.is_some();
        if let Some(better) = better {
            self.best = better;
        }
        adopted
    }
}

impl<'a> Search for DetourSearch<'a> {
    type Scratch = StringSolver<'a>;

    fn scratch(&self) -> StringSolver<'a> {
        StringSolver::new(self.context.problem, self.context.regions)
    }

    fn propose(&mut self) -> u64 {
        self.debt + self.detours.len() as u64 * EVALUATIONS
    }

    fn begin(&mut self, granted: u64) -> usize {
        let size = self.detours.len();
        let granted = granted.saturating_sub(std::mem::take(&mut self.debt));
        let count = usize::try_from(granted / EVALUATIONS)
            .unwrap_or(size)
            .min(size);
        for detour in self.detours.iter_mut().skip(count) {
            detour.reset();
        }
        self.tried = count as u64;
        count
    }

    fn work(&self, task: usize, solver: &mut StringSolver<'a>) {
        let number = self.generation * self.detours.len() as u64 + task as u64;
        let random = &mut self.seed.stream(number);
        let mut detour = self.detours.lock(task);
        detour.try_out(&self.best, solver, &self.context, random);
    }

    fn select(&mut self, _granted: u64) -> Option<StopReason> {
        let work = self.detours.iter_mut().map(|detour| detour.work).sum();
        let taken = self.context.rate.evaluations(work);
        self.debt = taken.saturating_sub(self.tried * EVALUATIONS);
        self.generation += 1;
        self.idle += 1;
        let gained = self.detours.iter_mut().any(|detour| detour.gain_s > 0.0);
        if gained && (self.adopt(false) || self.adopt(true)) {
            self.idle = 0;
        }
        let contacts = self.best.string.contacts.len() as u64;
        let tries = self.idle * self.detours.len() as u64;
        let patience = self.patience * TRIES_PER_CONTACT * (1 + contacts);
        (tries > patience).then_some(StopReason::Stalled)
    }

    fn progress(&mut self, _is_observed: bool) -> Progress<'_> {
        Progress {
            best: self.best.score(),
            costs: &[],
            violations: &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taut::regions::GrownRegions;
    use crate::taut::sources::{CandidateMaker, CandidateSource};
    use crate::taut::work::WorkRate;
    use auv_obstacles::TimedPoint;
    use auv_planning::departure::DepartureManoeuvre;
    use auv_planning::{Budget, PathProblem, Run, Vehicle};

    fn detour(from_s: f64, until_s: f64, gain_s: f64) -> Detour {
        Detour {
            from_s,
            until_s,
            points: vec![Point3::new(3.0 * from_s, gain_s, 0.0)],
            gain_s,
            work: 0,
        }
    }

    #[test]
    fn detours_that_gain_most_are_merged_unless_they_overlap() {
        let vehicle = Vehicle::paper();
        let problem = PathProblem::new(Point3::origin(), Point3::new(300.0, 0.0, 0.0), &vehicle);
        let regions = GrownRegions::new(&problem, 0.0, false);
        let departure = DepartureManoeuvre::none(&problem);
        let mut run = Run::new(Seed(1), Budget::to_the_cap());
        let best = CandidateMaker::new(&problem, &regions, &departure)
            .make(&mut run, CandidateSource::StraightLine)
            .unwrap();
        let context = SearchContext {
            problem: &problem,
            regions: &regions,
            departure: &departure,
            rate: WorkRate::new(&problem),
            deadline: run.deadline(),
        };
        let mut search = DetourSearch::new(context, Seed(1), best, 4, 1);
        // Two vertices more, the second on a stretch that a detour replaces.
        let vertices = [30.0, 45.0].map(|s| TimedPoint::new(Point3::new(3.0 * s, 0.0, 0.0), s));
        search.best.string.points.splice(1..1, vertices);
        // The second overlaps the third, which gains more; the fourth gains nothing.
        let drawn = [
            detour(10.0, 20.0, 1.0),
            detour(35.0, 50.0, 2.0),
            detour(40.0, 60.0, 3.0),
            detour(70.0, 80.0, 0.0),
        ];
        for (kept, drawn) in search.detours.iter_mut().zip(drawn) {
            *kept = drawn;
        }
        let places = |points: Vec<Point3<f64>>| points.iter().map(|p| p.x).collect::<Vec<_>>();
        assert_eq!(
            places(search.merged(false)),
            [0.0, 30.0, 90.0, 120.0, 300.0]
        );
        assert_eq!(places(search.merged(true)), [0.0, 90.0, 120.0, 300.0]);
    }
}
