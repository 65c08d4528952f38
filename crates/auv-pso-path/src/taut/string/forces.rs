//! The contact forces of a string: a small linear complementarity problem.

/// Finds forces `f >= 0` with `gap + A f >= 0` such that one of the two is zero for every contact.
/// Keeps its buffers from call to call.
#[derive(Debug, Default)]
pub(crate) struct ContactForces {
    active: Vec<bool>,
    chosen: Vec<usize>,
    factor: Vec<f64>,
    solution: Vec<f64>,
    force: Vec<f64>,
    gap: Vec<f64>,
    work: u64,
}

/// Most pivoting rounds; then the forces are taken as they are.
const ROUNDS: usize = 12;
/// Rounds without a fall in their number in which all wrong contacts still change sides together.
const PATIENCE: i32 = 3;
/// Rounding of a force, in units of the string's tension, and of a gap, metres.
const FORCE_ROUNDING: f64 = 1e-12;
const GAP_ROUNDING_M: f64 = 1e-7;
/// A contact depends on those before it if its pivot is below this share of its diagonal entry.
const DEPENDENT: f64 = 1e-9;
/// Multiplications of the factorisation that are one unit of work.
const MULTIPLICATIONS_PER_UNIT: usize = 100;

impl ContactForces {
    /// Work done since last asked, in the units of [`crate::taut::work`].
    pub(crate) fn take_work(&mut self) -> u64 {
        std::mem::take(&mut self.work)
    }

    /// Block principal pivoting that starts from the contacts for which `touching` holds.
    /// `matrix(c, d)` is `A`, symmetric and positive semi-definite; `free_gap[c]` is the gap without
    /// any force. Of contacts that repeat each other only one gets a force. Returns the forces.
    pub(crate) fn solve(
        &mut self,
        free_gap: &[f64],
        touching: impl Fn(usize) -> bool,
        matrix: impl Fn(usize, usize) -> f64,
    ) -> &[f64] {
        let count = free_gap.len();
        self.active.clear();
        self.active.extend((0..count).map(touching));
        let mut fewest = usize::MAX;
        let mut patience = PATIENCE;
        for _ in 0..ROUNDS {
            self.solve_active(free_gap, &matrix);
            let wrong = |c: usize| {
                if self.active[c] {
                    self.force[c] < -FORCE_ROUNDING
                } else {
                    self.gap[c] < -GAP_ROUNDING_M
                }
            };
            let found = (0..count).filter(|&c| wrong(c)).count();
            if found == 0 {
                break;
            }
            // All at once while that helps, else one at a time, which ends (Murty's rule).
            let all = if found < fewest {
                (fewest, patience) = (found, PATIENCE);
                true
            } else {
                patience -= i32::from(patience > 0);
                patience > 0
            };
            let last = (0..count).rev().find(|&c| wrong(c)).unwrap_or(0);
            let flips: Vec<usize> = (0..count)
                .filter(|&c| wrong(c) && (all || c == last))
                .collect();
            for c in flips {
                self.active[c] = !self.active[c];
            }
        }
        for force in &mut self.force {
            *force = force.max(0.0);
        }
        &self.force
    }

    /// Cholesky on the active contacts, then the gaps of all others.
    fn solve_active(&mut self, free_gap: &[f64], matrix: &impl Fn(usize, usize) -> f64) {
        self.chosen.clear();
        self.chosen
            .extend((0..free_gap.len()).filter(|&c| self.active[c]));
        let n = self.chosen.len();
        // Multiplications of the factor, and entries of the matrix.
        self.work += (n * n * n / MULTIPLICATIONS_PER_UNIT + (n / 2 + free_gap.len()) * n) as u64;
        self.factor.clear();
        self.factor.resize(n * n, 0.0);
        self.solution.clear();
        for i in 0..n {
            let (above, own_row) = self.factor.split_at_mut(i * n);
            let own_row = &mut own_row[..n];
            for j in 0..i {
                let row = &above[j * n..][..n];
                let known: f64 = own_row[..j].iter().zip(row).map(|(a, b)| a * b).sum();
                own_row[j] = (matrix(self.chosen[i], self.chosen[j]) - known) / row[j];
            }
            let own = matrix(self.chosen[i], self.chosen[i]);
            let left = own - own_row[..i].iter().map(|a| a * a).sum::<f64>();
            // A contact that depends on the ones before gets no force of its own.
            own_row[i] = if left > DEPENDENT * own && own > 0.0 {
                left.sqrt()
            } else {
                f64::INFINITY
            };
            let known: f64 = own_row.iter().zip(&self.solution).map(|(a, x)| a * x).sum();
            self.solution
                .push((-free_gap[self.chosen[i]] - known) / own_row[i]);
        }
        for i in (0..n).rev() {
            let x = self.solution[i] / self.factor[i * n + i];
            self.solution[i] = x;
            let row = &self.factor[i * n..][..i];
            for (earlier, a) in self.solution.iter_mut().zip(row) {
                *earlier -= a * x;
            }
        }
        self.force.clear();
        self.force.resize(free_gap.len(), 0.0);
        for (&c, &x) in self.chosen.iter().zip(&self.solution) {
            self.force[c] = x;
        }
        self.gap.clear();
        for (c, free) in free_gap.iter().enumerate() {
            let pushes = self.chosen.iter().zip(&self.solution);
            let pushed: f64 = pushes.map(|(&d, x)| matrix(c, d) * x).sum();
            self.gap.push(free + pushed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::nalgebra::{DMatrix, DVector};
    use auv_types::{Seed, rand::RngExt};

    #[test]
    fn forces_and_gaps_are_complementary() {
        let mut random = Seed(2).stream(0);
        for _ in 0..200 {
            let n = random.random_range(1..15);
            let stations: Vec<f64> = (0..n).map(|_| random.random_range(0.05..0.95)).collect();
            let matrix = |c: usize, d: usize| {
                let (a, b) = (stations[c].min(stations[d]), stations[c].max(stations[d]));
                a * (1.0 - b)
            };
            let gaps: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..0.5)).collect();
            let mut forces = ContactForces::default();
            let force = forces.solve(&gaps, |c| gaps[c] < 0.0, matrix).to_vec();
            for c in 0..n {
                let gap = gaps[c] + (0..n).map(|d| matrix(c, d) * force[d]).sum::<f64>();
                assert!(gap > -1e-6 && force[c] >= 0.0 && gap.min(force[c]) < 1e-6);
            }
        }
    }

    /// The only forces that leave every contact complementary, by trying every active set.
    fn by_enumeration(gaps: &[f64], matrix: &impl Fn(usize, usize) -> f64) -> Vec<f64> {
        let count = gaps.len();
        (0..1_u32 << count)
            .find_map(|set| {
                let active: Vec<usize> = (0..count).filter(|&c| set >> c & 1 == 1).collect();
                let n = active.len();
                let a = DMatrix::from_fn(n, n, |i, j| matrix(active[i], active[j]));
                let b = DVector::from_fn(n, |i, _| -gaps[active[i]]);
                let solved = if n == 0 { b } else { a.lu().solve(&b)? };
                let mut force = vec![0.0; count];
                for (&c, &f) in active.iter().zip(solved.iter()) {
                    force[c] = f;
                }
                let left =
                    |c: usize| gaps[c] + (0..count).map(|d| matrix(c, d) * force[d]).sum::<f64>();
                let holds =
                    force.iter().all(|&f| f >= -1e-12) && (0..count).all(|c| left(c) > -1e-9);
                holds.then_some(force)
            })
            .unwrap()
    }

    #[test]
    fn forces_are_those_of_the_one_active_set_that_holds() {
        let mut random = Seed(12).stream(0);
        for _ in 0..100 {
            let n = random.random_range(1..8);
            let stations: Vec<f64> = (0..n).map(|_| random.random_range(0.05..0.95)).collect();
            let signs: Vec<f64> = (0..n)
                .map(|_| {
                    if random.random_range(0..2) == 0 {
                        -1.0
                    } else {
                        1.0
                    }
                })
                .collect();
            let matrix = |c: usize, d: usize| {
                let (a, b) = (stations[c].min(stations[d]), stations[c].max(stations[d]));
                signs[c] * signs[d] * a * (1.0 - b)
            };
            let gaps: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..0.5)).collect();
            let expected = by_enumeration(&gaps, &matrix);
            let mut forces = ContactForces::default();
            let force = forces.solve(&gaps, |_| false, matrix);
            for (found, expected) in force.iter().zip(&expected) {
                assert!(
                    (found - expected).abs() < 1e-6 * (1.0 + expected),
                    "{found} {expected}"
                );
            }
        }
    }

    #[test]
    fn a_contact_given_twice_is_pushed_once() {
        let matrix = |_: usize, _: usize| 0.25;
        let mut forces = ContactForces::default();
        let force = forces.solve(&[-1.0, -1.0], |_| true, matrix).to_vec();
        assert!((force.iter().sum::<f64>() - 4.0).abs() < 1e-12, "{force:?}");
        assert!(forces.take_work() > 0);
        assert_eq!(forces.take_work(), 0);
    }
}
