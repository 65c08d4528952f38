//! Changes of depth along a level polyline, within turn radius and pitch.

use auv_types::{Point3, Vector3, libm};

/// The share of the turn radius that a vertex keeps where the vehicle turns and pitches.
const RADIUS_SHARE: f64 = 0.994;
/// Steps of the search for a slope, and how exact the change of depth must be, metres.
const STEPS: usize = 60;
const EXACT_M: f64 = 1e-8;

/// What a level polyline allows: how fast the slope may change at each of its vertices. A slope is depth
/// gained per metre seen from above.
#[derive(Clone, Debug)]
pub(crate) struct Descent {
    steepest: f64,
    /// Length of each piece, metres.
    lengths_m: Vec<f64>,
    /// At the start of each piece: squares of the greatest angle between two pieces and of the one that
    /// the polyline already turns there, radians.
    turns: Vec<(f64, f64)>,
}

/// The slopes in which a change of depth begins and ends; `None`: any.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct EndSlopes {
    pub(crate) start: Option<f64>,
    pub(crate) end: Option<f64>,
}

impl Descent {
    /// For a polyline that is left along a direction. A vehicle with no turn radius pitches at once.
    pub(crate) fn new(
        points: &[Point3<f64>],
        direction: Option<Vector3<f64>>,
        radius_m: f64,
        steepest: f64,
    ) -> Self {
        let flat = |a: &Point3<f64>, b: &Point3<f64>| Vector3::new(b.x - a.x, b.y - a.y, 0.0);
        let pieces: Vec<_> = points.windows(2).map(|p| flat(&p[0], &p[1])).collect();
        let lengths_m: Vec<f64> = pieces.iter().map(|piece| piece.norm()).collect();
        let turn = |i: usize| {
            // The piece before the first is as long as can be, and ends half a turn early.
            let (before, shorter_m) = match (i, direction) {
                (0, None) => return (f64::INFINITY, 0.0),
                (0, Some(direction)) => (direction, 0.5 * lengths_m[0]),
                _ => (pieces[i - 1], lengths_m[i - 1].min(lengths_m[i])),
            };
            if radius_m <= 0.0 {
                return (f64::INFINITY, 0.0);
            }
            let after = pieces[i];
            let across = before.x * after.y - before.y * after.x;
            let along = before.x * after.x + before.y * after.y;
            let turned = libm::atan2(across, along);
            let most = 2.0 * libm::atan(0.5 * shorter_m / (RADIUS_SHARE * radius_m));
            (most * most, turned * turned)
        };
        let turns = (0..pieces.len()).map(turn).collect();
        Self {
            steepest,
            lengths_m,
            turns,
        }
    }

    /// The slope after a vertex, nearest to one that is wanted.
    fn next_slope(&self, vertex: usize, slope: f64, wanted: f64) -> f64 {
        let (most, turned) = self.turns[vertex];
        if most.is_infinite() {
            return wanted;
        }
        // An angle seen from above counts less the steeper the path is.
        let flattest = if slope * wanted <= 0.0 {
            0.0
        } else {
            slope.abs().min(wanted.abs())
        };
        let square = 1.0 / (1.0 + flattest * flattest);
        let pitch = (most - turned * square).max(0.0).sqrt() / square;
        slope + (wanted - slope).clamp(-pitch, pitch)
    }

    /// The slopes of all pieces: from that of the start to `middle`, and to that of the end. `None` where
    /// both changes do not fit.
    fn slopes(&self, ends: EndSlopes, middle: f64) -> Option<Vec<f64>> {
        let count = self.lengths_m.len();
        let mut slopes = vec![middle; count];
        let mut begun = 0;
        if let Some(mut slope) = ends.start {
            while begun < count && (slope - middle).abs() > 0.0 {
                slope = self.next_slope(begun, slope, middle);
                slopes[begun] = slope;
                begun += 1;
            }
        }
        if let Some(mut slope) = ends.end {
            // The last piece arrives in the direction asked for; from there backwards.
            let mut vertex = count;
            while vertex > 0 && (slope - middle).abs() > 0.0 {
                if vertex <= begun {
                    return None;
                }
                vertex -= 1;
                slopes[vertex] = slope;
                slope = self.next_slope(vertex, slope, middle);
            }
        }
        Some(slopes)
    }

    /// The change of depth that slopes give, metres.
    fn dive_m(&self, slopes: &[f64]) -> f64 {
        let gains = slopes.iter().zip(&self.lengths_m);
        gains.map(|(slope, length_m)| slope * length_m).sum()
    }

    /// The most that the depth can change towards a side (1 down, -1 up), metres; negative where the
    /// vehicle cannot even keep its depth.
    pub(crate) fn most_m(&self, ends: EndSlopes, side: f64) -> Option<f64> {
        let slopes = self.slopes(ends, side * self.steepest)?;
        Some(side * self.dive_m(&slopes))
    }

    /// The slopes of a change of depth: one steady slope after the start has been left and before the end
    /// is reached. `None` where the polyline is too short for it.
    pub(crate) fn steady(&self, ends: EndSlopes, dive_m: f64) -> Option<Vec<f64>> {
        let gained = |middle: f64| {
            let slopes = self.slopes(ends, middle)?;
            Some(self.dive_m(&slopes) - dive_m)
        };
        let whole_m: f64 = self.lengths_m.iter().sum();
        // The steady slope without ends is a good first guess; the gain grows with the slope.
        let (mut low, mut high) = (-self.steepest, self.steepest);
        let mut at = (dive_m / whole_m.max(EXACT_M)).clamp(low, high);
        for step in 0..STEPS {
            // Where the ends do not fit, the slope is too far from theirs.
            let off_m = gained(at).unwrap_or(f64::NAN);
            if off_m.abs() <= EXACT_M {
                return self.slopes(ends, at);
            }
            let too_steep = if off_m.is_nan() {
                at > 0.0
            } else {
                off_m > 0.0
            };
            if too_steep {
                high = at;
            } else {
                low = at;
            }
            let guess = at - off_m / whole_m.max(EXACT_M);
            at = if step % 3 < 2 && guess > low && guess < high {
                guess
            } else {
                0.5 * (low + high)
            };
        }
        let found = self.slopes(ends, at)?;
        ((self.dive_m(&found) - dive_m).abs() <= 1e-6 * (1.0 + dive_m.abs())).then_some(found)
    }

    /// Sets the depths of the points of the polyline from the first one on.
    pub(crate) fn apply(&self, slopes: &[f64], points: &mut [Point3<f64>]) {
        for (i, (slope, length_m)) in slopes.iter().zip(&self.lengths_m).enumerate() {
            points[i + 1].z = points[i].z + slope * length_m;
        }
    }
}
