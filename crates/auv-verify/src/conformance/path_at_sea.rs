//! Currents, sea beds and the limits of a vehicle's motion.

use super::checks::{CheckResult, FailedCheck, ensure, run_all};
use super::path_call::{START, TARGET, is_as_claimed, keeps, plan, run};
use crate::PathViolation;
use auv_ocean::{
    AnalyticBed, AnalyticCurrent, BedFeature, DepthSigma, Effect, FlatBed, Footprint, LambVortex,
    SeaBed, TidalConstituent, UniformCurrent,
};
use auv_planning::{PathPlanner, PathProblem, PlanError, Vehicle};
use auv_types::{Bounds, Point3, Vector3};

/// All checks of this file.
pub(super) fn checks_at_sea(
    planner: &dyn PathPlanner,
    began: &dyn Fn(&'static str),
) -> Vec<FailedCheck> {
    run_all(
        began,
        &[
            ("the speed through the water is kept", &|| {
                speed_is_kept(planner)
            }),
            ("a current that turns is flown as it turns", &|| {
                turning_current_is_flown(planner)
            }),
            ("a current is flown as it is in each place", &|| {
                local_current_is_flown(planner)
            }),
            ("a current too strong is not made good", &|| {
                strong_current_is_not_made_good(planner)
            }),
            ("the turn radius is kept", &|| turn_radius_is_kept(planner)),
            ("the pitch limit is kept", &|| pitch_is_kept(planner)),
            ("the box is kept", &|| box_is_kept(planner)),
            ("a flat bed is kept clear of", &|| {
                flat_bed_is_kept_clear(planner)
            }),
            ("a bed that slopes is kept clear of", &|| {
                sloping_bed_is_kept_clear(planner)
            }),
            ("an uncertain bed is kept clear of", &|| {
                uncertain_bed_is_kept_clear(planner)
            }),
            ("a place below the bed is not called feasible", &|| {
                place_below_the_bed_is_told(planner)
            }),
        ],
    )
}

fn is_wrong_speed(violation: &PathViolation) -> bool {
    use PathViolation::{TimeStands, TooFast, TooSlow};
    matches!(
        violation,
        TooFast { .. } | TooSlow { .. } | TimeStands { .. }
    )
}

fn is_too_low(violation: &PathViolation) -> bool {
    matches!(violation, PathViolation::TooLow { .. })
}

fn speed_is_kept(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::default();
    let current = UniformCurrent::new(Vector3::new(-0.3, 0.2, 0.0));
    let still = PathProblem::new(START, TARGET, &vehicle);
    let moving = PathProblem {
        current: Some(&current),
        ..still
    };
    keeps(planner, &still, is_wrong_speed)?;
    keeps(planner, &moving, is_wrong_speed)
}

/// A tide across the way turns round on the way.
fn turning_current_is_flown(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::default();
    for major_mps in [[-0.2, 0.7], [0.6, 0.2]] {
        let tide = AnalyticCurrent {
            tide: vec![TidalConstituent {
                major_mps,
                minor_mps: [0.0; 2],
                period_s: 1_300.0,
                strongest_s: 500.0,
            }],
            ..AnalyticCurrent::default()
        };
        let problem = PathProblem {
            current: Some(&tide),
            departure_s: 500.0,
            ..PathProblem::new(START, TARGET, &vehicle)
        };
        keeps(planner, &problem, is_wrong_speed)?;
    }
    Ok(())
}

/// A vortex beside the way.
fn local_current_is_flown(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::default();
    let vortex = AnalyticCurrent {
        vortices: vec![LambVortex {
            centre: [450.0, 260.0],
            circulation_m2ps: 1_200.0,
            core_radius_m: 80.0,
        }],
        ..AnalyticCurrent::default()
    };
    let problem = PathProblem {
        current: Some(&vortex),
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    keeps(planner, &problem, is_wrong_speed)
}

/// The vehicle leaves in the direction opposite to a near target, and across it.
fn turn_radius_is_kept(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::default();
    for velocity in [Vector3::new(-1.5, 0.0, 0.0), Vector3::new(0.0, 1.5, 0.0)] {
        let near = START + Vector3::new(30.0, 10.0, 0.0);
        let problem = PathProblem {
            start_velocity: Some(velocity),
            ..PathProblem::new(START, near, &vehicle)
        };
        keeps(planner, &problem, |violation| {
            matches!(violation, PathViolation::TurnsTooTight { .. })
        })?;
    }
    Ok(())
}

/// The target lies steeply below the start.
fn pitch_is_kept(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::default();
    let problem = PathProblem {
        target: START + Vector3::new(100.0, 50.0, 70.0),
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    keeps(planner, &problem, |violation| {
        matches!(violation, PathViolation::TooSteep { .. })
    })
}

/// The target lies outside of the box.
fn box_is_kept(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let problem = PathProblem {
        bounds: Some(Bounds::new(
            Point3::new(-200.0, -300.0, 3.0),
            Point3::new(800.0, 700.0, 100.0),
        )),
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    keeps(planner, &problem, |violation| {
        matches!(violation, PathViolation::OutsideBox { .. })
    })
}

/// Over a bed, 5 m of altitude and `altitude_sigmas` deviations asked.
fn keeps_clear_of(
    planner: &dyn PathPlanner,
    bed: &dyn SeaBed,
    altitude_sigmas: f64,
) -> CheckResult {
    for vehicle in [Vehicle::paper(), Vehicle::default()] {
        let problem = PathProblem {
            sea_bed: Some(bed),
            min_altitude_m: 5.0,
            altitude_sigmas,
            ..PathProblem::new(START, TARGET, &vehicle)
        };
        keeps(planner, &problem, is_too_low)?;
    }
    Ok(())
}

/// Too shallow for the target.
fn flat_bed_is_kept_clear(planner: &dyn PathPlanner) -> CheckResult {
    keeps_clear_of(planner, &FlatBed::new(42.0), 0.0)
}

/// Deep enough at both ends, a ridge between them; then a shore that rises towards one side.
fn sloping_bed_is_kept_clear(planner: &dyn PathPlanner) -> CheckResult {
    let line = |points| Footprint::Line {
        points,
        half_width_m: 30.0,
    };
    let ridge = line(vec![[450.0, -2_000.0], [450.0, 2_000.0]]);
    let shore = line(vec![[-500.0, 330.0], [1_500.0, 330.0]]);
    let over = |name: &str, shape, depth_m, skirt_m| {
        AnalyticBed::new(80.0)
            .with(BedFeature::new(name, shape, depth_m, skirt_m).effect(Effect::Raise))
    };
    keeps_clear_of(planner, &over("ridge", ridge, 25.0, 200.0), 0.0)?;
    keeps_clear_of(planner, &over("shore", shore, 5.0, 300.0), 0.0)
}

/// Deep enough by the chart, not by the chart less two deviations.
fn uncertain_bed_is_kept_clear(planner: &dyn PathPlanner) -> CheckResult {
    let bed = AnalyticBed {
        sigma: DepthSigma {
            least_m: 4.0,
            relative: 0.0,
        },
        ..AnalyticBed::new(50.0)
    };
    keeps_clear_of(planner, &bed, 2.0)
}

/// Start and target are one place, 2 m above the bed where 5 m are asked.
fn place_below_the_bed_is_told(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let bed = FlatBed::new(22.0);
    let problem = PathProblem {
        sea_bed: Some(&bed),
        min_altitude_m: 5.0,
        ..PathProblem::new(START, START, &vehicle)
    };
    is_as_claimed(&problem, &plan(planner, 60, &problem)?)
}

fn strong_current_is_not_made_good(planner: &dyn PathPlanner) -> CheckResult {
    let vehicle = Vehicle::paper();
    let current = UniformCurrent::new(Vector3::new(-4.0, 0.0, 0.0));
    let problem = PathProblem {
        current: Some(&current),
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    match planner.plan_path(&mut run(100), &problem) {
        Ok(plan) => ensure(plan.violation > 0.0, || "calls it feasible".into()),
        Err(PlanError::Invalid(error)) => Err(format!("calls a sound problem malformed: {error}")),
        Err(_) => Ok(()),
    }
}
