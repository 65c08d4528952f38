//! The particle swarm (Eq. 13, Fig. 10): blocks of eight particles, one random stream each.

use crate::swarm::cost::{Costing, CurveScratch};
use crate::swarm::lanes::{Kernel, LANES, Lanes, dispatch};
use crate::swarm::settings::{Factors, SwarmSettings};
use auv_planning::{Score, StopReason};
use auv_population::{Members, Progress, Search};
use auv_types::rand::Rng;
use auv_types::{Bounds, ChaCha8Rng, Point3, Seed};
use wide::f32x8;

/// A swarm over the free control points of one leg's curve.
#[derive(Debug)]
pub(crate) struct Swarm<'a> {
    costing: &'a Costing<'a>,
    settings: &'a SwarmSettings,
    space: Space,
    seed: Seed,
    /// Each is drawn in the first generation, by the thread that will mostly work on it.
    blocks: Members<Option<Block>>,
    generation: u64,
    /// What moves the particles in this generation.
    factors: Factors,
    /// Particles costed in this generation.
    granted: usize,
    costs: Vec<f64>,
    violations: Vec<f64>,
    global: BestPosition,
    /// Every global best in the order found: the answer is the last one that is exactly clear.
    pub(crate) history: Vec<BestPosition>,
}

/// The best position of the swarm.
#[derive(Clone, Debug)]
pub(crate) struct BestPosition {
    score: Score,
    /// Coordinate `3 i + axis` of free control point `i`, relative to the start, metres.
    pub(crate) position: Vec<f32>,
}

/// The windows relative to the start, and the greatest step, per coordinate, metres.
#[derive(Debug)]
struct Space {
    low: Vec<f32>,
    high: Vec<f32>,
    step: Vec<f32>,
}

/// Eight particles side by side.
#[derive(Debug)]
struct Block {
    leader: Leader,
    random: Vec<ChaCha8Rng>,
    position: Vec<f32x8>,
    velocity: Vec<f32x8>,
    best: Vec<f32x8>,
    cost: [f64; LANES],
    violation: [f64; LANES],
    best_score: [Score; LANES],
}

/// The best of a block's bests. The swarm reads nothing else of a block in each generation.
#[derive(Debug)]
struct Leader {
    lane: usize,
    score: Score,
}

impl<'a> Swarm<'a> {
    /// A swarm whose particles are drawn from the windows (Eq. 15).
    pub(crate) fn new(
        costing: &'a Costing<'a>,
        settings: &'a SwarmSettings,
        windows: &[Bounds],
        start: &Point3<f64>,
        seed: Seed,
    ) -> Self {
        let space = Space::new(windows, start, settings.velocity_share);
        let dimensions = space.low.len();
        Self {
            costing,
            settings,
            space,
            seed,
            blocks: Members::new(settings.particles.div_ceil(LANES), || None),
            generation: 0,
            factors: settings.acceleration.at(0.0),
            granted: 0,
            costs: vec![f64::INFINITY; settings.particles],
            violations: vec![f64::INFINITY; settings.particles],
            global: BestPosition {
                score: Score::WORST,
                position: vec![0.0; dimensions],
            },
            history: Vec::new(),
        }
    }
}

impl Search for Swarm<'_> {
    type Scratch = CurveScratch;

    fn scratch(&self) -> CurveScratch {
        self.costing.scratch()
    }

    fn propose(&mut self) -> u64 {
        self.settings.particles as u64
    }

    fn begin(&mut self, granted: u64) -> usize {
        let last = self.settings.iterations.saturating_sub(1).max(1);
        let share = (self.generation as f64 / last as f64).min(1.0);
        self.factors = self.settings.acceleration.at(share);
        self.granted = usize::try_from(granted).unwrap_or(usize::MAX);
        self.granted.div_ceil(LANES).min(self.blocks.len())
    }

    /// Draws (in the first generation) or moves the particles of a block, and costs them; each
    /// keeps its own best.
    fn work(&self, task: usize, scratch: &mut CurveScratch) {
        let mut block = self.blocks.lock(task);
        let block = block.get_or_insert_with(|| Block::new(&self.space, self.seed, task));
        let towards = (&self.space, &self.factors, &self.global.position[..]);
        dispatch(Step {
            block,
            scratch,
            towards: (self.generation > 0).then_some(towards),
            costing: self.costing,
            settings: self.settings,
            granted: self.granted - task * LANES,
        });
    }

    fn select(&mut self, _granted: u64) -> Option<StopReason> {
        let ranking = self.settings.ranking;
        let mut best = self.global.score;
        let mut leader = None;
        for block in self.blocks.iter_mut().flatten() {
            if ranking.order(&block.leader.score, &best).is_lt() {
                best = block.leader.score;
                leader = Some(block);
            }
        }
        if let Some(block) = leader {
            self.global.score = best;
            for (to, from) in self.global.position.iter_mut().zip(&block.best) {
                *to = from.to_array()[block.leader.lane];
            }
            self.history.push(self.global.clone());
        }
        self.generation += 1;
        (self.generation >= self.settings.iterations).then_some(StopReason::Finished)
    }

    fn progress(&mut self, is_observed: bool) -> Progress<'_> {
        if is_observed {
            let each = self.costs.iter_mut().zip(&mut self.violations);
            let blocks = self.blocks.iter_mut().flatten();
            let costed = blocks.flat_map(|block| block.cost.into_iter().zip(block.violation));
            for ((cost, violation), costed) in each.zip(costed).take(self.granted) {
                (*cost, *violation) = costed;
            }
        }
        Progress {
            best: self.global.score,
            costs: &self.costs,
            violations: &self.violations,
        }
    }
}

/// One generation of a block.
struct Step<'a> {
    block: &'a mut Block,
    scratch: &'a mut CurveScratch,
    /// The windows, the factors and the global best; `None` in the first generation.
    towards: Option<(&'a Space, &'a Factors, &'a [f32])>,
    costing: &'a Costing<'a>,
    settings: &'a SwarmSettings,
    granted: usize,
}

impl Kernel for Step<'_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Lanes>(self, proof: V::Proof) {
        let Self { block, scratch, .. } = self;
        if let Some((space, factors, global)) = self.towards {
            block.fly::<V>(proof, space, factors, global);
        }
        let costed = self.costing.cost::<V>(proof, &block.position, scratch);
        block.keep(
            &costed.length_m,
            &costed.violation,
            self.settings,
            self.granted,
        );
    }
}

impl Space {
    fn new(windows: &[Bounds], start: &Point3<f64>, velocity_share: f64) -> Self {
        let coordinates = |corner: fn(&Bounds) -> Point3<f64>| {
            let each = windows.iter().flat_map(|window| {
                let offset = corner(window) - start;
                [offset.x as f32, offset.y as f32, offset.z as f32]
            });
            each.collect::<Vec<f32>>()
        };
        let (low, high) = (coordinates(|w| w.low), coordinates(|w| w.high));
        let widths = low.iter().zip(&high).map(|(low, high)| high - low);
        let step = widths.map(|w| w * velocity_share as f32).collect();
        Self { low, high, step }
    }
}

impl Block {
    fn new(space: &Space, seed: Seed, index: usize) -> Self {
        let mut random: Vec<_> = (0..LANES)
            .map(|lane| seed.stream((index * LANES + lane) as u64))
            .collect();
        let mut draw = |low: f32, high: f32| {
            let mut lanes = [0.0; LANES];
            for (value, random) in lanes.iter_mut().zip(&mut random) {
                let share = f64::from(random.next_u32()) / f64::from(u32::MAX);
                *value = (f64::from(low) + f64::from(high - low) * share) as f32;
            }
            f32x8::new(lanes)
        };
        let bounds = space.low.iter().zip(&space.high);
        let position: Vec<_> = bounds.map(|(&low, &high)| draw(low, high)).collect();
        let velocity = space.step.iter().map(|&step| draw(-step, step)).collect();
        Self {
            leader: Leader {
                lane: 0,
                score: Score::WORST,
            },
            random,
            best: position.clone(),
            position,
            velocity,
            cost: [f64::INFINITY; LANES],
            violation: [f64::INFINITY; LANES],
            best_score: [Score::WORST; LANES],
        }
    }

    /// One step (Eq. 13). The velocity is clamped, then the position to its window; a velocity that
    /// leaves the window is mirrored.
    #[inline(always)]
    fn fly<V: Lanes>(&mut self, proof: V::Proof, space: &Space, factors: &Factors, global: &[f32]) {
        let splat = |value| V::splat(proof, value);
        let load = |lanes: &f32x8| V::load(proof, lanes);
        let inertia = splat(factors.inertia);
        let (cognitive, social) = (splat(factors.cognitive), splat(factors.social));
        for (k, (&low, &high)) in space.low.iter().zip(&space.high).enumerate() {
            let (r1, r2) = uniform_pair(&mut self.random);
            let at = load(&self.position[k]);
            let attraction = cognitive * load(&r1) * (load(&self.best[k]) - at)
                + social * load(&r2) * (splat(global[k]) - at);
            let step = splat(space.step[k]);
            let speed = (inertia * load(&self.velocity[k]) + attraction)
                .max(-step)
                .min(step);
            let (low, high) = (splat(low), splat(high));
            let moved = at + speed;
            let left = moved.lt(low) | moved.gt(high);
            self.velocity[k] = left.select(-speed, speed).store();
            self.position[k] = moved.max(low).min(high).store();
        }
    }

    /// Takes the results of the first `granted` lanes and updates each particle's best.
    fn keep(
        &mut self,
        length_m: &[f32; LANES],
        violation: &[f32; LANES],
        settings: &SwarmSettings,
        granted: usize,
    ) {
        for lane in 0..LANES.min(granted) {
            let violation = f64::from(violation[lane]);
            let cost = f64::from(length_m[lane]) / settings.reference_length_m
                * (1.0 + settings.penalty * violation);
            (self.cost[lane], self.violation[lane]) = (cost, violation);
            let (ranking, score) = (settings.ranking, Score::new(violation, cost));
            if ranking.order(&score, &self.best_score[lane]).is_lt() {
                self.best_score[lane] = score;
                for (best, at) in self.best.iter_mut().zip(&self.position) {
                    set_lane(best, lane, at.to_array()[lane]);
                }
                if ranking.order(&score, &self.leader.score).is_lt() {
                    self.leader = Leader { lane, score };
                }
            }
        }
    }
}

/// r1 and r2 of eight particles for one coordinate: the two halves of one word of each stream.
#[inline(always)]
fn uniform_pair(random: &mut [ChaCha8Rng]) -> (f32x8, f32x8) {
    let mut words = [0; LANES];
    for (word, random) in words.iter_mut().zip(random) {
        *word = random.next_u32();
    }
    let half = |shift: u32| {
        f32x8::new(words.map(|word| (word >> shift & 0xffff) as f32 * (1.0 / 65_535.0)))
    };
    (half(0), half(16))
}

fn set_lane(vector: &mut f32x8, lane: usize, value: f32) {
    vector.as_mut_array()[lane] = value;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::swarm::settings::PathRanking;
    use crate::swarm::windows::windows;
    use auv_obstacles::Region;
    use auv_planning::{PathProblem, Vehicle};
    use auv_types::{Vector3, rand::RngExt};

    /// Regions of all kinds round a leg of 2 km along x.
    fn regions() -> Vec<Region> {
        let mut random = Seed(3).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        (0..30)
            .map(|i| {
                let centre =
                    Point3::new(draw(100.0, 1900.0), draw(-200.0, 200.0), draw(0.0, 100.0));
                let mut region = if i % 5 == 0 {
                    Region::cylinder(centre, draw(10.0, 80.0), 0.0, draw(20.0, 90.0))
                } else {
                    Region::ball(centre, draw(10.0, 90.0))
                };
                if i % 2 == 0 {
                    region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
                    region.growth_mps = draw(-0.02, 0.05);
                }
                if i % 3 == 0 {
                    region.from_s = draw(0.0, 300.0);
                }
                region
            })
            .collect()
    }

    #[test]
    fn the_widest_vectors_give_the_bits_of_the_plain_ones() {
        let (vehicle, regions) = (Vehicle::paper(), regions());
        let problem = PathProblem {
            regions: &regions,
            ..PathProblem::new(Point3::origin(), Point3::new(2_000.0, 0.0, 60.0), &vehicle)
        };
        for order in 2..=6 {
            let settings = SwarmSettings {
                order,
                ..SwarmSettings::paper()
            };
            let costing = Costing::new(&problem, &settings).unwrap();
            let boxes = windows(settings.windows, &problem, settings.control_points - 2);
            let space = Space::new(&boxes, &problem.start, settings.velocity_share);
            let factors = settings.acceleration.at(0.5);
            let global: Vec<f32> = space.low.iter().map(|low| low + 40.0).collect();
            let [widest, plain] = [true, false].map(|widest| {
                let mut block = Block::new(&space, Seed(9), 0);
                let mut scratch = costing.scratch();
                let (mut costs, mut worst) = (Vec::new(), 0.0_f64);
                for generation in 0..20 {
                    let step = Step {
                        block: &mut block,
                        scratch: &mut scratch,
                        towards: (generation > 0).then_some((&space, &factors, &global)),
                        costing: &costing,
                        settings: &settings,
                        granted: LANES,
                    };
                    if widest {
                        dispatch(step);
                    } else {
                        step.run::<f32x8>(());
                    }
                    costs.extend(block.cost.iter().chain(&block.violation).copied());
                    let places = block.position.iter().flat_map(|p| p.to_array());
                    costs.extend(places.map(f64::from));
                    worst = block.violation.iter().copied().fold(worst, f64::max);
                }
                assert!(worst > 0.0 && worst.is_finite());
                costs.into_iter().map(f64::to_bits).collect::<Vec<_>>()
            });
            assert!(widest == plain, "order {order}");
        }
    }

    #[test]
    fn a_step_follows_equation_13_and_is_mirrored_at_the_window() {
        let space = Space {
            low: vec![0.0],
            high: vec![10.0],
            step: vec![2.0],
        };
        let factors = Factors {
            inertia: 0.5,
            cognitive: 1.0,
            social: 0.5,
        };
        let mut block = Block::new(&space, Seed(4), 0);
        for _ in 0..40 {
            let (mut random, before) = (block.random.clone(), block.position[0].to_array());
            let (velocity, best) = (block.velocity[0].to_array(), block.best[0].to_array());
            block.fly::<f32x8>((), &space, &factors, &[9.5]);
            let (r1, r2) = uniform_pair(&mut random);
            for lane in 0..LANES {
                let (r1, r2) = (r1.to_array()[lane], r2.to_array()[lane]);
                assert!((0.0..=1.0).contains(&r1) && (0.0..=1.0).contains(&r2));
                let at = before[lane];
                let attraction = r1 * (best[lane] - at) + 0.5 * r2 * (9.5 - at);
                let speed = (0.5 * velocity[lane] + attraction).clamp(-2.0, 2.0);
                let moved = at + speed;
                let inside = (0.0..=10.0).contains(&moved);
                let kept = if inside { speed } else { -speed };
                assert!((block.position[0].to_array()[lane] - moved.clamp(0.0, 10.0)).abs() < 1e-5);
                assert!((block.velocity[0].to_array()[lane] - kept).abs() < 1e-5);
            }
        }
    }

    #[test]
    fn the_rankings_differ_where_a_small_violation_pays() {
        let (clear, short) = (Score::feasible(2.0), Score::new(0.001, 1.0));
        let order = |ranking: PathRanking| ranking.order(&clear, &short);
        assert!(order(PathRanking::Deb).is_lt());
        assert!(order(PathRanking::Penalised).is_gt());
    }
}
