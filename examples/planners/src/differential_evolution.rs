//! Paths by differential evolution (Storn and Price 1997, DE/rand/1/bin).

use auv_bspline::BSpline;
use auv_planning::obstacles::ObstacleId;
use auv_planning::types::rand::{Rng, RngExt};
use auv_planning::types::{Point3, Vector3};
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, Run, Score, StopReason, Trajectory,
};
use auv_verify::{PathViolation, verify_trajectory};

/// Evolves the inner control points of a cubic B-spline from start to target. The independent verifier
/// measures what a curve breaks, so a curve called feasible is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DifferentialEvolution {
    /// Curves in the population, at least 4.
    pub members: usize,
    /// Inner control points of a curve.
    pub knees: usize,
    /// Weight `F` of the difference of two members.
    pub difference: f64,
    /// Probability `CR` that a gene is taken from the mutant.
    pub crossover: f64,
    /// Generations in a run without limits.
    pub generations: u64,
}

impl Default for DifferentialEvolution {
    fn default() -> Self {
        Self {
            members: 16,
            knees: 3,
            difference: 0.7,
            crossover: 0.9,
            generations: 60,
        }
    }
}

/// A curve: offsets of its knees from the straight line, as shares of its length.
type Genes = Vec<Vector3<f64>>;

/// A curve and what it is worth.
#[derive(Clone)]
struct Member {
    genes: Genes,
    score: Score,
    trajectory: Trajectory,
    blocked_by: Option<ObstacleId>,
}

impl PathPlanner for DifferentialEvolution {
    fn name(&self) -> &str {
        "differential evolution"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        problem.validate().into_result()?;
        let mut random = run.seed().stream(0);
        let mut best = self.member(problem, vec![Vector3::zeros(); self.knees])?;
        if let Some(warm) = problem.warm_start {
            best = better(best, judged(problem, warm.clone(), Genes::new()));
        }
        let mut population: Vec<Member> = Vec::new();
        for _ in 0..self.generations {
            let granted = run.grant(self.members as u64) as usize;
            for i in 0..granted {
                let genes = match population.len() {
                    all if all == self.members => self.trial(&population, i, &mut random),
                    _ => (0..self.knees).map(|_| drawn(&mut random) * 0.4).collect(),
                };
                let trial = self.member(problem, genes)?;
                best = better(best, trial.clone());
                match population.get_mut(i) {
                    Some(member) if trial.score <= member.score => *member = trial,
                    Some(_) => {}
                    None => population.push(trial),
                }
            }
            if granted < self.members {
                break;
            }
            run.end_generation(best.score, &[], &[]);
        }
        let Score { violation, cost } = best.score;
        let stats = run.stats(StopReason::Finished);
        let mut planned = Planned::new(best.trajectory, cost, violation, stats);
        planned.blocked_by = best.blocked_by;
        Ok(planned)
    }
}

fn better(a: Member, b: Member) -> Member {
    if b.score < a.score { b } else { a }
}

/// A random vector, each component within 1.
fn drawn(random: &mut impl Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.random_range(-1.0..=1.0))
}

impl DifferentialEvolution {
    /// A child of member `i`: a third member plus the weighted difference of two others.
    fn trial(&self, population: &[Member], i: usize, random: &mut impl Rng) -> Genes {
        let mut other = || &population[random.random_range(0..population.len())].genes;
        let (a, b, c) = (other(), other(), other());
        (0..self.knees)
            .map(|knee| {
                let mutant = a[knee] + (b[knee] - c[knee]) * self.difference;
                let own = population[i].genes[knee];
                own.zip_map(&mutant, |own, mutant| {
                    if random.random_bool(self.crossover) {
                        mutant
                    } else {
                        own
                    }
                })
            })
            .collect()
    }

    /// The curve of genes, as the vehicle flies it.
    fn member(&self, problem: &PathProblem<'_>, genes: Genes) -> Result<Member, PlanError> {
        let way = problem.target - problem.start;
        // Ships and vehicles move mostly across: offsets in depth are a tenth of those on the map.
        let scale = Vector3::new(way.norm(), way.norm(), 0.1 * way.norm());
        let mut control = vec![problem.start];
        control.extend((0_u32..).zip(&genes).map(|(knee, offset)| {
            let share = f64::from(knee + 1) / (self.knees + 1) as f64;
            problem.start + way * share + offset.component_mul(&scale)
        }));
        control.push(problem.target);
        let curve = BSpline::new(4.min(control.len()), control)?;
        let points = curve.polyline(Trajectory::CHORD_ERROR_M)?;
        Ok(judged(
            problem,
            flown(self.name(), problem, &points)?,
            genes,
        ))
    }
}

/// The timed polyline; where the current is too strong for it, that in still water, which the verifier
/// finds too fast.
fn flown(
    planner: &str,
    problem: &PathProblem<'_>,
    points: &[Point3<f64>],
) -> Result<Trajectory, PlanError> {
    let still = PathProblem {
        current: None,
        ..*problem
    };
    let timed = problem.timed(points).or_else(|_| still.timed(points));
    timed.map_err(|error| PlanError::Failed {
        planner: planner.into(),
        reason: error.to_string(),
    })
}

/// What a trajectory breaks, added up in metres (angles and speeds by scales of ten), and its duration.
fn judged(problem: &PathProblem<'_>, trajectory: Trajectory, genes: Genes) -> Member {
    use PathViolation as Broken;
    let report = verify_trajectory(problem, &trajectory);
    let violation: f64 = report
        .violations
        .iter()
        .map(|broken| match *broken {
            Broken::TooClose {
                approach,
                required_m,
            } => required_m - approach.clearance_m,
            Broken::TooLow {
                altitude_m,
                required_m,
                ..
            } => required_m - altitude_m,
            Broken::OutsideBox { excess_m, .. } => excess_m,
            Broken::TurnsTooTight {
                radius_m, limit_m, ..
            } => limit_m - radius_m,
            Broken::TooSteep {
                pitch_rad,
                limit_rad,
                ..
            } => 10.0 * (pitch_rad - limit_rad),
            Broken::TooFast {
                speed_mps,
                limit_mps,
                ..
            } => 10.0 * (speed_mps - limit_mps),
            Broken::TooSlow {
                speed_mps,
                limit_mps,
                ..
            } => 10.0 * (limit_mps - speed_mps),
            _ => 1e6,
        })
        .map(|excess| excess.max(1e-6))
        .sum();
    let closest = report.closest.filter(|_| violation > 0.0);
    Member {
        genes,
        score: Score::new(violation, trajectory.duration_s()),
        trajectory,
        blocked_by: closest.map(|closest| closest.obstacle),
    }
}
