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
    use crate::{RouteReport, RouteViolation};
    use auv_graph::NodeId;

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
}
