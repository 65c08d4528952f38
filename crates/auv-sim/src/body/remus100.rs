//! The REMUS 100 in six degrees of freedom.
//!
//! The model is that of Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control, 2nd ed. (2021), section 8.4.2: a
//! spheroid with added mass, linear damping, lift and drag, cross-flow drag, two pairs of fins and a propeller (propeller data:
//! Allen, Vorus and Prestero 2000). It is stepped by Euler's method every [`Remus100::STEP_S`].

use auv_types::nalgebra::{Matrix3, Matrix6, Vector6};
use auv_types::{Point3, Vector3, libm};
use std::f64::consts::PI;

const LENGTH_M: f64 = 1.6;
const DIAMETER_M: f64 = 0.19;
const DENSITY: f64 = 1026.0;
const GRAVITY: f64 = 9.81;
/// The centre of gravity below the centre of buoyancy, metres.
const RIGHTING_M: f64 = 0.02;
/// Time constants of the linear damping in surge, sway, heave and yaw, seconds.
const DAMPING_S: [f64; 4] = [20.0, 20.0, 20.0, 1.0];
const ROLL_DAMPING: f64 = 0.3;
const PITCH_DAMPING: f64 = 0.8;
/// Drag coefficient of a strip across the flow (Hoerner, breadth equal to draught).
const CROSS_FLOW_DRAG: f64 = 1.1977;
const STRIPS: u32 = 20;
/// Both fins of a pair, square metres, and their lift per radian.
const FIN_AREA_M2: f64 = 2.0 * 0.00665;
const RUDDER_LIFT: f64 = 0.5;
const STERN_LIFT: f64 = 0.7;
const FIN_LIMIT_RAD: f64 = 15.0 * PI / 180.0;
const FIN_LAG_S: f64 = 0.1;
const PROPELLER_M: f64 = 0.14;
const PROPELLER_LIMIT_RPM: f64 = 1525.0;
const PROPELLER_LAG_S: f64 = 1.0;
const THRUST_DEDUCTION: f64 = 0.1;
const WAKE: f64 = 0.944;
/// Thrust and torque coefficients at rest, at the greatest advance ratio, and that ratio.
const THRUST: [f64; 2] = [0.4566, 0.1798];
const TORQUE: [f64; 2] = [0.0700, 0.0312];
const ADVANCE: f64 = 0.6632;

/// What the autopilot asks of the actuators.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Actuators {
    /// Positive turns to starboard, radians.
    pub(crate) rudder_rad: f64,
    /// Positive pitches the nose down, radians.
    pub(crate) stern_rad: f64,
    /// Revolutions of the propeller a minute.
    pub(crate) rpm: f64,
}

/// Masses, which never change.
#[derive(Clone, Debug)]
struct Masses {
    rigid: Matrix6<f64>,
    added: Matrix6<f64>,
    inverse: Matrix6<f64>,
    damping: Vector6<f64>,
    weight_n: f64,
}

/// The vehicle's state.
#[derive(Clone, Debug)]
pub(crate) struct Remus100 {
    masses: Masses,
    pub(crate) position: Point3<f64>,
    /// Roll, pitch (nose up positive) and yaw (clockwise from north), radians.
    pub(crate) attitude: Vector3<f64>,
    /// Velocity over ground in body axes, m/s, and body rates, rad/s.
    nu: Vector6<f64>,
    actuators: Actuators,
}

fn cross(v: &Vector3<f64>) -> Matrix3<f64> {
    v.cross_matrix()
}

impl Masses {
    fn new() -> Self {
        let (a, b) = (LENGTH_M / 2.0, DIAMETER_M / 2.0);
        let mass = 4.0 / 3.0 * PI * DENSITY * a * b * b;
        let inertia = [2.0 / 5.0 * mass * b * b, mass * (a * a + b * b) / 5.0];
        // About the centre of buoyancy, where the body axes begin.
        let mut shift = Matrix6::identity();
        let to_gravity = Vector3::new(0.0, 0.0, RIGHTING_M);
        shift
            .fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&cross(&to_gravity).transpose());
        let central = [mass, mass, mass, inertia[0], inertia[1], inertia[1]];
        let central = Matrix6::from_diagonal(&Vector6::from(central));
        let rigid = shift.transpose() * central * shift;
        let added = Matrix6::from_diagonal(&added_mass(mass, inertia, a, b));
        let whole = rigid + added;
        let weight_n = mass * GRAVITY;
        let righting = |k: usize| libm::sqrt(weight_n * RIGHTING_M / whole[(k, k)]);
        let damping = Vector6::new(
            whole[(0, 0)] / DAMPING_S[0],
            whole[(1, 1)] / DAMPING_S[1],
            whole[(2, 2)] / DAMPING_S[2],
            whole[(3, 3)] * 2.0 * ROLL_DAMPING * righting(3),
            whole[(4, 4)] * 2.0 * PITCH_DAMPING * righting(4),
            whole[(5, 5)] / DAMPING_S[3],
        );
        Self {
            rigid,
            added,
            // A mass matrix is positive definite.
            inverse: whole.try_inverse().unwrap_or_else(Matrix6::identity),
            damping,
            weight_n,
        }
    }
}

/// Lamb's factors of a spheroid; roll takes a share of its inertia.
fn added_mass(mass: f64, inertia: [f64; 2], a: f64, b: f64) -> Vector6<f64> {
    let ratio = b / a;
    let e2 = 1.0 - ratio * ratio;
    let e = libm::sqrt(e2);
    let log = libm::log((1.0 + e) / (1.0 - e));
    let alpha = 2.0 * (1.0 - e2) / (e2 * e) * (0.5 * log - e);
    let beta = 1.0 / e2 - (1.0 - e2) / (2.0 * e2 * e) * log;
    let (k1, k2) = (alpha / (2.0 - alpha), beta / (2.0 - beta));
    let turned = e2 * e2 * (beta - alpha) / ((2.0 - e2) * (2.0 * e2 - (2.0 - e2) * (beta - alpha)));
    let (across, turning) = (mass * k2, turned * inertia[1]);
    Vector6::new(
        mass * k1,
        across,
        across,
        0.3 * inertia[0],
        turning,
        turning,
    )
}

/// Coriolis and centripetal forces of a mass matrix.
fn coriolis(mass: &Matrix6<f64>, nu: &Vector6<f64>) -> Matrix6<f64> {
    let momentum = mass * nu;
    let linear = cross(&momentum.fixed_rows::<3>(0).into_owned());
    let angular = cross(&momentum.fixed_rows::<3>(3).into_owned());
    let mut matrix = Matrix6::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&-linear);
    matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&-linear);
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&-angular);
    matrix
}

impl Remus100 {
    /// Length of a step, seconds.
    pub(crate) const STEP_S: f64 = 0.05;

    /// At rest over ground.
    pub(crate) fn at(position: Point3<f64>, yaw_rad: f64) -> Self {
        Self {
            masses: Masses::new(),
            position,
            attitude: Vector3::new(0.0, 0.0, yaw_rad),
            nu: Vector6::zeros(),
            actuators: Actuators::default(),
        }
    }

    /// Body to local axes.
    fn rotation(&self) -> Matrix3<f64> {
        let [roll, pitch, yaw] = [self.attitude.x, self.attitude.y, self.attitude.z];
        let (sr, cr) = libm::sincos(roll);
        let (sp, cp) = libm::sincos(pitch);
        let (sy, cy) = libm::sincos(yaw);
        Matrix3::new(
            cy * cp,
            cy * sp * sr - sy * cr,
            sy * sr + cy * cr * sp,
            sy * cp,
            cy * cr + sr * sp * sy,
            sp * sy * cr - cy * sr,
            -sp,
            cp * sr,
            cp * cr,
        )
    }

    /// Velocity over ground, m/s.
    pub(crate) fn velocity(&self) -> Vector3<f64> {
        self.rotation() * self.nu.fixed_rows::<3>(0)
    }

    /// Body rates, rad/s.
    pub(crate) fn rates(&self) -> Vector3<f64> {
        self.nu.fixed_rows::<3>(3).into_owned()
    }

    /// One step of [`Remus100::STEP_S`] in a horizontal current, m/s over ground.
    pub(crate) fn step(&mut self, asked: Actuators, current: &Vector3<f64>) {
        let (sy, cy) = libm::sincos(self.attitude.z);
        let along = current.x * cy + current.y * sy;
        let across = current.y * cy - current.x * sy;
        let mut water = Vector6::zeros();
        (water[0], water[1]) = (along, across);
        let mut turning = Vector6::zeros();
        (turning[0], turning[1]) = (self.nu[5] * across, -self.nu[5] * along);
        let relative = self.nu - water;
        let rate = turning + self.masses.inverse * self.forces(&relative);
        let h = Self::STEP_S;
        self.nu += rate * h;
        self.move_actuators(asked);
        self.position += self.velocity() * h;
        let [roll, pitch] = [self.attitude.x, self.attitude.y];
        let (sr, cr) = libm::sincos(roll);
        let cp = libm::cos(pitch);
        let tp = libm::tan(pitch);
        let [p, q, r] = [self.nu[3], self.nu[4], self.nu[5]];
        self.attitude += Vector3::new(
            p + (sr * q + cr * r) * tp,
            cr * q - sr * r,
            (sr * q + cr * r) / cp,
        ) * h;
    }

    fn move_actuators(&mut self, asked: Actuators) {
        let h = Self::STEP_S;
        let fin = |now: f64, asked: f64| {
            let wanted = asked.clamp(-FIN_LIMIT_RAD, FIN_LIMIT_RAD);
            (now + h / FIN_LAG_S * (wanted - now)).clamp(-FIN_LIMIT_RAD, FIN_LIMIT_RAD)
        };
        let rpm = asked.rpm.clamp(-PROPELLER_LIMIT_RPM, PROPELLER_LIMIT_RPM);
        self.actuators = Actuators {
            rudder_rad: fin(self.actuators.rudder_rad, asked.rudder_rad),
            stern_rad: fin(self.actuators.stern_rad, asked.stern_rad),
            rpm: self.actuators.rpm + h / PROPELLER_LAG_S * (rpm - self.actuators.rpm),
        };
    }

    /// All forces and moments for a velocity through the water.
    fn forces(&self, relative: &Vector6<f64>) -> Vector6<f64> {
        let masses = &self.masses;
        let speed = relative.fixed_rows::<3>(0).norm();
        let mut added = coriolis(&masses.added, relative);
        // As the reference does: these terms of the added mass would destabilise the body.
        for (i, j) in [(4, 0), (4, 2), (5, 0), (5, 1)] {
            (added[(i, j)], added[(j, i)]) = (0.0, 0.0);
        }
        let mut damping = masses.damping;
        let fading = libm::exp(-3.0 * speed);
        (damping[0], damping[1]) = (damping[0] * fading, damping[1] * fading);
        let whole = coriolis(&masses.rigid, relative) + added + Matrix6::from_diagonal(&damping);
        self.controls(relative) + lift_and_drag(relative, speed) + cross_flow(relative)
            - whole * relative
            - self.righting()
    }

    /// Propeller and fins.
    fn controls(&self, relative: &Vector6<f64>) -> Vector6<f64> {
        let ground = self.nu.fixed_rows::<3>(0).norm();
        let n = self.actuators.rpm / 60.0;
        let advance = WAKE * ground / PROPELLER_M;
        let turned = |k: [f64; 2]| k[0] * n.abs() * n + (k[1] - k[0]) / ADVANCE * advance * n.abs();
        let d2 = PROPELLER_M * PROPELLER_M;
        let thrust = DENSITY * d2 * d2 * turned(THRUST);
        let torque = DENSITY * d2 * d2 * PROPELLER_M * turned(TORQUE);
        let fin = |speed2: f64, lift: f64, angle: f64| {
            -0.5 * DENSITY * speed2 * FIN_AREA_M2 * lift * angle
        };
        let [u, v, w] = [relative[0], relative[1], relative[2]];
        let Actuators {
            rudder_rad,
            stern_rad,
            ..
        } = self.actuators;
        let rudder = fin(u * u + v * v, RUDDER_LIFT, rudder_rad);
        let stern = fin(u * u + w * w, STERN_LIFT, stern_rad);
        let at_m = -LENGTH_M / 2.0;
        Vector6::new(
            (1.0 - THRUST_DEDUCTION) * thrust + rudder * rudder_rad + stern * stern_rad,
            rudder,
            stern,
            torque / 10.0,
            -at_m * stern,
            at_m * rudder,
        )
    }

    fn righting(&self) -> Vector6<f64> {
        let moment = RIGHTING_M * self.masses.weight_n;
        let (sp, cp) = libm::sincos(self.attitude.y);
        let roll = moment * cp * libm::sin(self.attitude.x);
        Vector6::new(0.0, 0.0, 0.0, roll, moment * sp, 0.0)
    }
}

fn lift_and_drag(relative: &Vector6<f64>, speed: f64) -> Vector6<f64> {
    let attack = libm::atan2(relative[2], relative[0]);
    let area = 0.7 * LENGTH_M * DIAMETER_M;
    let aspect = DIAMETER_M * DIAMETER_M / area;
    let lift_slope = PI * aspect / (1.0 + libm::sqrt(1.0 + aspect * aspect / 4.0));
    let b = DIAMETER_M / 2.0;
    let lift = lift_slope * attack;
    let drag = 0.42 * PI * b * b / area + lift * lift / (PI * 0.7 * aspect);
    let pressure = 0.5 * DENSITY * area * speed * speed;
    let (lift, drag) = (pressure * lift, pressure * drag);
    let (s, c) = libm::sincos(attack);
    Vector6::new(
        -c * drag + s * lift,
        0.0,
        -s * drag - c * lift,
        0.0,
        0.0,
        0.0,
    )
}

fn cross_flow(relative: &Vector6<f64>) -> Vector6<f64> {
    let strip_m = LENGTH_M / f64::from(STRIPS);
    let (mut force, mut moment) = (0.0, 0.0);
    for k in 0..=STRIPS {
        let x = strip_m * f64::from(k) - LENGTH_M / 2.0;
        let across = relative[1] + x * relative[5];
        let strip = 0.5 * DENSITY * DIAMETER_M * CROSS_FLOW_DRAG * across.abs() * across * strip_m;
        force -= strip;
        moment -= x * strip;
    }
    Vector6::new(0.0, force, 0.0, 0.0, 0.0, moment)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The commands between two rows, a second apart. A slow change is linear. A jump is made at once after the
    /// first row, unless the fins of the second row show that it comes after them.
    fn asked(from: &[f64], to: &[f64], share: f64) -> Actuators {
        let at = |command: usize, actual: usize| {
            let change = to[command] - from[command];
            if change.abs() < 0.02 {
                from[command] + share * change
            } else if share > 0.0 && (to[actual] - to[command]).abs() < 1e-3 {
                to[command]
            } else {
                from[command]
            }
        };
        Actuators {
            rudder_rad: at(1, 16),
            stern_rad: at(2, 17),
            rpm: from[3],
        }
    }

    /// Runs of the reference program: commands and position once a second.
    fn compare(name: &str, current: Vector3<f64>) -> Option<(f64, f64)> {
        let folder = std::env::var_os("AUV_DATA_DIR")?;
        let file = std::path::Path::new(&folder).join("remus100").join(name);
        let text = std::fs::read_to_string(file).ok()?;
        let rows: Vec<Vec<f64>> = text
            .lines()
            .skip(1)
            .map(|line| {
                line.split(',')
                    .map(|x| x.parse().expect("a number"))
                    .collect()
            })
            .collect();
        let place = |row: &[f64]| Point3::new(row[4], row[5], row[6]);
        let mut body = Remus100::at(place(&rows[0]), rows[0][9]);
        let mut way_m = 0.0;
        for pair in rows.windows(2) {
            let steps = libm::round((pair[1][0] - pair[0][0]) / Remus100::STEP_S) as u32;
            for k in 0..steps {
                let share = f64::from(k) / f64::from(steps);
                body.step(asked(&pair[0], &pair[1], share), &current);
            }
            way_m += (place(&pair[1]) - place(&pair[0])).norm();
        }
        let last = rows.last().expect("has rows");
        Some(((body.position - place(last)).norm(), way_m))
    }

    #[test]
    #[allow(clippy::print_stderr, reason = "a skipped test says so")]
    fn it_moves_as_the_published_model() {
        let towards = 60.0 * PI / 180.0;
        let set = Vector3::new(libm::cos(towards), libm::sin(towards), 0.0) * 0.5;
        for (name, current) in [
            ("surge_1525rpm.csv", Vector3::zeros()),
            ("turn_5deg_1200rpm.csv", Vector3::zeros()),
            ("turn_15deg_900rpm.csv", Vector3::zeros()),
            ("dive_5deg_1200rpm.csv", Vector3::zeros()),
            ("current_0p5_turns.csv", set),
        ] {
            let Some((off_m, way_m)) = compare(name, current) else {
                eprintln!("skipped: set AUV_DATA_DIR");
                return;
            };
            assert!(
                off_m <= 0.001 * way_m,
                "{name}: {off_m} m off after {way_m} m"
            );
        }
    }
}
