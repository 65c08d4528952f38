//! Reports as text: the figures, then what is wrong. `{}` gives one line, `{:#}` a line for each violation.

use crate::{PathReport, RouteReport, WayOnReport};
use std::fmt::{self, Display, Formatter};

impl Display for RouteReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (weight, time_s, length_m) = (self.weight, self.time_s, self.distance_m);
        write!(
            f,
            "weight {weight:.2}, {} tasks, {length_m:.0} m in {time_s:.0} s",
            self.tasks
        )?;
        verdict(f, &self.violations)
    }
}

impl Display for PathReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} m in {:.1} s", self.length_m, self.duration_s)?;
        if let Some(closest) = self.closest {
            write!(f, ", clearance {:.1} m", closest.clearance_m)?;
        }
        if self.min_altitude_m.is_finite() {
            write!(f, ", altitude {:.1} m", self.min_altitude_m)?;
        }
        verdict(f, &self.violations)
    }
}

impl Display for WayOnReport {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "way on of {:.0} s", self.lasts_s)?;
        verdict(f, &self.violations)
    }
}

fn verdict(f: &mut Formatter<'_>, violations: &[impl Display]) -> fmt::Result {
    if violations.is_empty() {
        return f.write_str(": valid");
    }
    f.write_str(": not valid")?;
    let between = if f.alternate() { "\n- " } else { "; " };
    for violation in violations {
        write!(f, "{between}{violation}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::{EndState, RouteReport, RouteViolation, WayOn, verify_trajectory, verify_way_on};
    use auv_graph::NodeId;
    use auv_obstacles::Region;
    use auv_ocean::FlatBed;
    use auv_planning::{PathProblem, Vehicle};
    use auv_types::Point3;

    #[test]
    fn a_report_says_its_figures_and_each_violation() {
        let mut report = RouteReport {
            weight: 3.0,
            time_s: 61.2,
            distance_m: 90.0,
            tasks: 2,
            violations: vec![],
        };
        assert_eq!(
            report.to_string(),
            "weight 3.00, 2 tasks, 90 m in 61 s: valid"
        );
        let node = NodeId(4);
        report.violations = vec![RouteViolation::UnknownNode { node }, RouteViolation::Empty];
        let text = format!("{report:#}");
        assert_eq!(text.lines().count(), 3, "{text}");
        assert!(
            text.ends_with("- node 4 is not in the network\n- the route is empty"),
            "{text}"
        );
    }

    #[test]
    fn a_path_says_its_clearance_and_altitude_where_it_has_them() {
        let vehicle = Vehicle::paper();
        let (start, target) = (Point3::origin(), Point3::new(300.0, 0.0, 0.0));
        let open = PathProblem::new(start, target, &vehicle);
        let path = open.timed(&[start, target]).unwrap();
        let said = |problem: &PathProblem<'_>| verify_trajectory(problem, &path).to_string();
        assert_eq!(said(&open), "300.0 m in 100.0 s: valid");
        let regions = [Region::ball(Point3::new(150.0, 30.0, 0.0), 10.0)];
        let bed = FlatBed::new(50.0);
        let among = PathProblem {
            regions: &regions,
            sea_bed: Some(&bed),
            ..open
        };
        let figures = "300.0 m in 100.0 s, clearance 20.0 m, altitude 50.0 m: valid";
        assert_eq!(said(&among), figures);
        let away = PathProblem {
            target: Point3::new(310.0, 0.0, 0.0),
            ..open
        };
        assert!(said(&away).starts_with("300.0 m in 100.0 s: not valid; "));
    }

    #[test]
    fn a_way_on_says_how_long_it_lasts() {
        let vehicle = Vehicle::paper();
        let (start, target) = (Point3::origin(), Point3::new(300.0, 0.0, 0.0));
        let problem = PathProblem::new(start, target, &vehicle);
        let path = problem.timed(&[start, target]).unwrap();
        let asked = WayOn {
            ends_s: path.end().time_s,
            lasts_s: 12.4,
            end: EndState::UnderWay,
        };
        let report = verify_way_on(&problem, &path, &asked);
        assert_eq!(report.to_string(), "way on of 12 s: valid");
    }
}
