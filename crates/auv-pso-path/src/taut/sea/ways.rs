//! Candidates through the sea: the ways of fronts, and other polylines, pulled tight by travel time.

use crate::taut::candidate::Candidate;
use crate::taut::contact::Contact;
use crate::taut::regions::GrownRegions;
use crate::taut::sea::chart::{Chart, Extent};
use crate::taut::sea::tide::tide;
use crate::taut::sea::tube::{Pull, Tube};
use crate::taut::sea::water::{FloorCheck, Water};
use crate::taut::string::TautString;
use crate::taut::work::{LOOK_UP, WorkRate};
use auv_obstacles::TimedPoint;
use auv_planning::departure::DepartureManoeuvre;
use auv_planning::front::{Front, STEP_WORK, Spread, Stencil};
use auv_planning::{PathProblem, Run};
use auv_types::Point3;

/// A current that differs by less between depths is the same at all depths, m/s.
const SAME_MPS: f64 = 0.02;
/// A front looks for ways that take at most this much longer than the best one, as a share: pulled tight,
/// they are quicker.
const ROUGH: f64 = 5e-3;
/// Shortest distance between vertices, metres, and for a vehicle that turns in turn radii: there is room to
/// round a corner.
const LEAST_SPACING_M: f64 = 2.0;
const TURN_RADII: f64 = 2.5;
/// A way that is not clear by less is pulled again, metres, and so many times at most.
const MOST_MISSED_M: f64 = 1.0;
const MOST_REPAIRS: usize = 3;
/// Vertices move in depth past regions where the box is thicker, metres.
const LEAST_ROOM_M: f64 = 4.0;
/// The farthest first move of a vertex in depth, metres.
const MOST_DEPTH_M: f64 = 10.0;
/// The finest move of a vertex where the sea is searched in full, metres.
const FINEST_M: f64 = 0.1;
/// The most a vertex bends without getting neighbours, radians.
const MOST_BEND: [f64; 2] = [0.15, 0.04];

/// Cells, reach, vertices and finest move of the stages of a search: see [`Stage`].
const STAGES: [(usize, isize, usize, f64); 4] = [
    (20, 3, 32, 1e-3),
    (44, 4, 60, 2e-4),
    (90, 5, 100, 5e-5),
    (140, 5, 160, 2e-5),
];

/// How finely the sea is searched.
#[derive(Clone, Copy, Debug)]
struct Stage {
    /// Cells of a front's lattice from start to target.
    cells: usize,
    /// Cells that a step of the front spans.
    reach: isize,
    /// Vertices of the polyline that is pulled tight.
    vertices: usize,
    /// The last move of a vertex, as a share of the leg.
    finest: f64,
}

impl Stage {
    fn of(stage: usize) -> Self {
        let (cells, reach, vertices, finest) = STAGES[stage.min(STAGES.len() - 1)];
        Self {
            cells,
            reach,
            vertices,
            finest,
        }
    }
}

/// Where a way through the sea comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SeaSource {
    /// The trajectory in force, if the problem has one.
    InForce,
    /// The straight line to the target.
    StraightLine,
    /// The best candidate so far, pulled tighter: with the fineness of a stage.
    Best(usize),
    /// A front beside and ahead: with the fineness of a stage.
    Level(usize),
    /// A front ahead and in depth.
    Upright(usize),
    /// A front in all directions.
    Space(usize),
}

impl SeaSource {
    /// In the order in which they are tried; the last of those only that are worth their time with a
    /// deadline.
    pub(crate) const ALL: [Self; 16] = [
        Self::InForce,
        Self::StraightLine,
        Self::Best(0),
        Self::Upright(0),
        Self::Level(0),
        Self::Best(1),
        Self::Upright(1),
        Self::Level(1),
        Self::Space(0),
        Self::Best(2),
        Self::Upright(2),
        Self::Level(2),
        Self::Space(1),
        Self::Best(3),
        Self::Level(3),
        Self::Best(3),
    ];
    /// Those tried without a deadline.
    pub(crate) const FEW: usize = 9;

    /// Whether it keeps the sides of the best candidate so far.
    pub(crate) fn is_like_best(self) -> bool {
        matches!(self, Self::Best(_))
    }

    fn stage(self) -> usize {
        match self {
            Self::InForce | Self::StraightLine => 0,
            Self::Best(stage) | Self::Level(stage) | Self::Upright(stage) | Self::Space(stage) => {
                stage
            }
        }
    }
}

/// Makes candidates of one departure through the sea.
#[derive(Debug)]
pub(crate) struct SeaWays<'a> {
    problem: &'a PathProblem<'a>,
    regions: &'a GrownRegions,
    departure: &'a DepartureManoeuvre,
    rate: WorkRate,
    slack_m: f64,
    leg_m: f64,
    /// Whether the current differs between depths, and whether vertices move in depth.
    layered: bool,
    deep: bool,
}

impl<'a> SeaWays<'a> {
    /// Ways that keep `slack_m` more than the clearance and the altitude asked for.
    pub(crate) fn new(
        problem: &'a PathProblem<'a>,
        regions: &'a GrownRegions,
        departure: &'a DepartureManoeuvre,
        slack_m: f64,
    ) -> Self {
        let layered = differs_by_depth(problem);
        let room_m = problem.bounds.map_or(f64::INFINITY, |b| b.high.z - b.low.z);
        Self {
            problem,
            regions,
            departure,
            rate: WorkRate::new(problem),
            slack_m,
            leg_m: (problem.target - departure.end).norm(),
            layered,
            deep: layered || room_m > LEAST_ROOM_M && !problem.regions.is_empty(),
        }
    }

    /// The candidate of a source. `None` if the source has no way, or if the budget does not allow it.
    pub(crate) fn make(
        &self,
        run: &mut Run<'_>,
        source: SeaSource,
        best: Option<&Candidate>,
    ) -> Option<Candidate> {
        let stage = Stage::of(source.stage());
        let cell_m = self.leg_m / stage.cells as f64;
        let (way, widest_m) = match source {
            SeaSource::InForce | SeaSource::StraightLine if best.is_some() => return None,
            SeaSource::InForce => (self.in_force()?, 0.5 * cell_m),
            SeaSource::StraightLine => (self.straight_line()?, cell_m),
            SeaSource::Best(_) => {
                let way = best?.string.points.iter().map(|p| p.position);
                (way.collect(), 20.0 * self.finest_m(&stage))
            }
            SeaSource::Level(_) => {
                let way = self.way_of_front(run, &stage, Extent::Level, best)?;
                (way, 0.5 * cell_m)
            }
            SeaSource::Upright(_) if self.layered => {
                let way = self.way_of_front(run, &stage, Extent::Upright, best)?;
                (way, 0.5 * cell_m)
            }
            SeaSource::Space(_) if self.layered => {
                let way = self.way_of_front(run, &stage, Extent::Space, best)?;
                (way, 0.5 * cell_m)
            }
            SeaSource::Upright(_) | SeaSource::Space(_) => return None,
        };
        self.pulled(run, &stage, &way, widest_m)
    }

    /// The straight line to the target, if nothing blocks it.
    fn straight_line(&self) -> Option<Vec<Point3<f64>>> {
        let water = Water::new(
            self.problem,
            self.regions,
            (self.slack_m, FloorCheck::Sampled),
            50.0,
        );
        let start = TimedPoint::new(self.departure.end, self.departure.end_s);
        let open = water.fly(&start, &self.problem.target).short_m <= 0.0;
        open.then(|| vec![start.position, self.problem.target])
    }

    /// The trajectory in force, from the end of the departure to the target.
    fn in_force(&self) -> Option<Vec<Point3<f64>>> {
        let points = self.problem.warm_start?.points();
        let inner = points.get(1..points.len().saturating_sub(1))?;
        let mut way = vec![self.departure.end];
        way.extend(inner.iter().map(|p| p.position));
        way.push(self.problem.target);
        Some(way)
    }

    fn way_of_front(
        &self,
        run: &mut Run<'_>,
        stage: &Stage,
        extent: Extent,
        best: Option<&Candidate>,
    ) -> Option<Vec<Point3<f64>>> {
        let (problem, departure) = (self.problem, self.departure);
        let chart = Chart::new(problem, departure.end, stage.cells, extent, run.deadline())?;
        let lattice = &chart.lattice;
        let stencil = Stencil::new(lattice, stage.reach);
        let each = STEP_WORK * stencil.steps().len() as u64 + 2 * LOOK_UP;
        let left = run.evaluations_left().unwrap_or(u64::MAX);
        if self.rate.evaluations(lattice.nodes() as u64 * each) > left || run.should_stop() {
            return None;
        }
        let tide = tide(problem, lattice, departure.end_s, run.deadline())?;
        let clear = best.filter(|best| best.is_clear());
        let latest_s = clear.map_or(f64::INFINITY, |best| {
            problem.departure_s + best.duration_s() * (1.0 + ROUGH)
        });
        let mut front = Front::new(problem.vehicle, lattice, &tide);
        let spread = Spread {
            from: chart.start_node,
            goals: &[chart.target_node],
            departure_s: departure.end_s,
            latest_s,
            deadline: run.deadline(),
        };
        let mut contacts_work = 0;
        let (reached, work) = front.spread(&stencil, &spread, |from, to| {
            let mut clear = true;
            if !problem.regions.is_empty() {
                let gap = |_, contact: Contact| clear &= contact.gap_m >= 0.0;
                contacts_work += self.regions.contacts(from, to, gap);
            }
            clear
        });
        let look_ups = LOOK_UP * (tide.entries() + lattice.nodes()) as u64;
        run.grant(self.rate.evaluations(work + contacts_work + look_ups));
        reached.then(|| {
            let nodes = front.way_to(chart.target_node);
            nodes
                .iter()
                .filter_map(|&node| lattice.place(node))
                .collect()
        })
    }

    /// The last move of a vertex, metres.
    fn finest_m(&self, stage: &Stage) -> f64 {
        (stage.finest * self.leg_m).max(FINEST_M)
    }

    /// A polyline pulled tight and made flyable. A vertex moves by `widest_m` at first. Where the samples of
    /// the floor missed a little, it is pulled again.
    ///
    /// With a deadline its vertices stay and are held to the floor everywhere. That takes more look-ups; with
    /// few evaluations it is pulled as before, with as much more above the floor as it missed.
    fn pulled(
        &self,
        run: &mut Run<'_>,
        stage: &Stage,
        polyline: &[Point3<f64>],
        widest_m: f64,
    ) -> Option<Candidate> {
        let mut slack_m = self.slack_m;
        let mut tube = self.tube(stage, polyline, (slack_m, FloorCheck::Sampled));
        self.pull_tight(run, stage, &mut tube, widest_m);
        let mut candidate = self.candidate(run, &tube)?;
        for _ in 0..MOST_REPAIRS {
            let short_m = candidate.examined.shortfall.metres;
            let missed = candidate.examined.shortfall.region.is_none() && short_m < MOST_MISSED_M;
            if candidate.is_clear() || !missed || run.should_stop() {
                break;
            }
            let way: Vec<_> = candidate.string.points.iter().map(|p| p.position).collect();
            let widest_m = 4.0 * self.finest_m(stage);
            if run.has_deadline() {
                tube = self.tube(stage, &way, (slack_m, FloorCheck::Proven));
                tube.settle(&self.pull(run, stage, widest_m));
                slack_m += 1.5 * short_m;
            } else {
                slack_m += 1.5 * short_m;
                tube = self.tube(stage, &way, (slack_m, FloorCheck::Sampled));
                self.pull_tight(run, stage, &mut tube, widest_m);
            }
            let repaired = self.candidate(run, &tube)?;
            if repaired.is_better(&candidate) {
                candidate = repaired;
            }
        }
        Some(candidate)
    }

    /// Pulls a tube tight from moves of `widest_m` on, with more vertices where it bends.
    fn pull_tight(&self, run: &Run<'_>, stage: &Stage, tube: &mut Tube<'_>, widest_m: f64) {
        let mut pull = self.pull(run, stage, widest_m);
        let mut goes_on = tube.tighten(&pull);
        pull.spacing_m = self.least_spacing_m().max(0.05 * pull.spacing_m);
        pull.widths_m = self.widths_m(4.0 * pull.least_m);
        for most_bend in MOST_BEND {
            goes_on = goes_on
                && self.problem.vehicle.turn_radius_m <= 0.0
                && tube.refine(most_bend, &pull);
        }
    }

    /// A tube round a polyline that keeps so many metres above the floor.
    fn tube(&self, stage: &Stage, polyline: &[Point3<f64>], kept: (f64, FloorCheck)) -> Tube<'_> {
        let current_step_m = (0.5 * self.spacing_m(stage)).max(LEAST_SPACING_M);
        let water = Water::new(self.problem, self.regions, kept, current_step_m);
        Tube::new(water, polyline, self.departure.end_s)
    }

    /// How a polyline is pulled tight from moves of `widest_m` on, with what is left of the budget.
    fn pull<'r>(&self, run: &Run<'r>, stage: &Stage, widest_m: f64) -> Pull<'r> {
        let left = run.evaluations_left().unwrap_or(u64::MAX);
        Pull {
            spacing_m: self.spacing_m(stage),
            widths_m: self.widths_m(widest_m),
            least_m: self.finest_m(stage),
            work: self.rate.units(left),
            deadline: run.deadline(),
        }
    }

    fn widths_m(&self, widest_m: f64) -> [f64; 2] {
        let depth_m = if self.deep {
            widest_m.min(MOST_DEPTH_M)
        } else {
            0.0
        };
        [widest_m, depth_m]
    }

    fn spacing_m(&self, stage: &Stage) -> f64 {
        (self.leg_m / stage.vertices as f64).max(self.least_spacing_m())
    }

    fn least_spacing_m(&self) -> f64 {
        LEAST_SPACING_M.max(TURN_RADII * self.problem.vehicle.turn_radius_m)
    }

    /// The candidate of a polyline that is pulled tight. Charges the work of both.
    fn candidate(&self, run: &mut Run<'_>, tube: &Tube<'_>) -> Option<Candidate> {
        let candidate = Candidate::new(self.problem, self.departure, string(tube.points()));
        let examined = candidate.as_ref().map_or(0, |c| c.work(self.problem));
        run.grant(self.rate.evaluations(tube.work + examined));
        candidate
    }
}

/// A polyline as a string without contacts. Its times do not count.
fn string(points: &[Point3<f64>]) -> TautString {
    let timed = points.iter().enumerate();
    TautString {
        points: timed.map(|(i, &p)| TimedPoint::new(p, i as f64)).collect(),
        contacts: Vec::new(),
    }
}

/// Whether the current differs between the depths of the box, at some places along the leg.
fn differs_by_depth(problem: &PathProblem<'_>) -> bool {
    let (Some(field), Some(bounds)) = (problem.current, problem.bounds) else {
        return false;
    };
    let line = problem.target - problem.start;
    [0.1, 0.5, 0.9].iter().any(|share| {
        let place = problem.start + line * *share;
        let at = |z: f64| field.velocity_at(&Point3::new(place.x, place.y, z), problem.departure_s);
        let high_m = bounds.high.z.min(place.z + line.norm());
        let depths = (0..=6).map(|k| bounds.low.z + (high_m - bounds.low.z) * f64::from(k) / 6.0);
        let here = at(place.z);
        depths.into_iter().any(|z| (at(z) - here).norm() > SAME_MPS)
    })
}
