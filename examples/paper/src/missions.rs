//! E7 to E9: Fig. 17 to 19, whole missions.

use crate::output::{Output, Section, internal, spread};
use crate::published::leg_times_s;
use auv_examples::{Clock, Failure};
use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::Route;
use auv_mission::driver::Stepped;
use auv_mission::{PathCall, SyncSettings};
use auv_planning::{Budget, Objective, PlanError, Planned, RoutePlanner, RouteProblem, Run};
use auv_pso_path::{PathSearch, PsoPath};
use auv_report::{
    Axis, Chart, Colour, Figure, Mark, MissionPicture, PointShape, Style, Table, palette,
};
use auv_sim::statistics::{BoxStats, mean, median};
use auv_sim::{Campaign, MissionOutcome, Scenario, Summary, simulate};

/// What is measured in a mission.
type PerMission = fn(&Summary) -> Vec<f64>;

/// Missions of Fig. 17 to 19.
const MISSIONS: usize = 10;
/// Replans per mission as the text of Fig. 18 counts them.
const PUBLISHED_REPLANS: [u32; MISSIONS] = [6, 0, 2, 0, 0, 6, 1, 3, 4, 2];

pub(crate) const CONFIGURATION: &str = "50 waypoints, 1470 directed edges, 10800 s, 3 m/s, obstacles of all four classes (3 to 6 near a leg on average), current |N(0, 0.3)| m/s on \
     the obstacles, sonar of 1000 m; the paper's GA and PSO presets with their full iterations, replanning when a leg is late (kappa = 0.02), no reserve, 5 m \
     of clearance; one network for all missions, obstacles and noise drawn for each";

/// The paper's genetic algorithm with the paper's cost, whatever the synchroniser asks for.
struct PaperRoutes(GaRoute);

impl RoutePlanner for PaperRoutes {
    fn name(&self) -> &str {
        self.0.name()
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        let problem = RouteProblem {
            objective: Objective::paper(),
            ..*problem
        };
        self.0.plan_route(run, &problem)
    }
}

pub(crate) fn campaign(output: &Output) -> Result<Campaign, Failure> {
    let mut campaign = Campaign::table2(output.seed).map_err(internal)?;
    campaign.same_network = true;
    campaign.reserve_s = 0.0;
    campaign.settings = SyncSettings::paper();
    campaign.settings.planning.route_budget = Budget::to_the_cap();
    campaign.settings.planning.path_budget = Budget::to_the_cap();
    Ok(campaign)
}

pub(crate) fn fly(scenario: &Scenario, picture: &mut MissionPicture) -> Result<Summary, Failure> {
    let (routes, paths) = (
        PaperRoutes(GaRoute::new(GaSettings::paper())),
        PsoPath::new(PathSearch::paper()),
    );
    let clock = Clock::start();
    let seconds = || clock.elapsed_ms() / 1e3;
    let driver = Stepped::new(&routes, &paths).with_stopwatch(&seconds);
    simulate(scenario, &driver, picture).map_err(internal)
}

pub(crate) fn figures17_to_19(output: &Output) -> Result<Vec<Section>, Failure> {
    let campaign = campaign(output)?;
    let count = output.runs.max(MISSIONS);
    let summaries = output.each(count, |k| {
        let scenario = campaign.scenario(k as u64).map_err(internal)?;
        fly(&scenario, &mut MissionPicture::new())
    })?;
    let ten = &summaries[..MISSIONS];
    Ok(vec![
        figure17(output, ten, &summaries)?,
        figure18(output, ten, &summaries)?,
        figure19(output, ten)?,
    ])
}

fn mission_axis() -> Axis {
    Axis::new("mission").names((1..=MISSIONS).map(|k| k.to_string()))
}

fn figure17(output: &Output, ten: &[Summary], all: &[Summary]) -> Result<Section, Failure> {
    output.draw("fig17.svg", &figure17_picture(ten))?;
    let mut section = Section::new("Fig. 17: mission time and remaining time");
    section.show(
        "fig17.svg",
        "Mission time and remaining time of ten missions",
    );
    section.say(format!("Configuration: {CONFIGURATION}."));
    section.table(&figure17_table(ten));
    let on_time = |list: &[Summary]| list.iter().filter(|s| s.remaining_s >= 0.0).count();
    let remaining: Vec<f64> = all.iter().map(|s| s.remaining_s).collect();
    let close = all
        .iter()
        .filter(|s| s.remaining_s >= 0.0 && s.remaining_s < 540.0)
        .count();
    let hit = all.iter().filter(|s| s.judgement.collisions > 0).count();
    section.claim(
        "every mission ends within the time available",
        on_time(all) == all.len(),
        format!(
            "{} of the ten and {} of {} missions do",
            on_time(ten),
            on_time(all),
            all.len()
        ),
    );
    section.claim(
        "the missions use nearly all of their time, without the remaining time being zero",
        10 * close >= 9 * all.len(),
        format!("{close} of {} missions end in time with less than 5 % left; median remaining time {:.1} s", all.len(), median(&remaining)),
    );
    section.claim(
        "the vehicle's safety is satisfied on every mission",
        hit == 0,
        format!(
            "{hit} of {} missions truly touch an obstacle; least true clearance of all {:.1} m",
            all.len(),
            all.iter()
                .map(|s| s.judgement.min_clearance_m)
                .fold(f64::INFINITY, f64::min)
        ),
    );
    Ok(section)
}

fn figure17_picture(ten: &[Summary]) -> Figure {
    let mut time = Chart::new(
        "mission time",
        mission_axis(),
        Axis::new("time (s)").from_zero().range(0.0, 12_400.0),
        190.0,
    );
    let mut left = Chart::new(
        "remaining time",
        mission_axis(),
        Axis::new("time (s)").from_zero(),
        160.0,
    );
    for (k, summary) in ten.iter().enumerate() {
        let good = summary.outcome == MissionOutcome::Docked;
        let colour = if good {
            palette::BLUE
        } else {
            palette::VERMILLION
        };
        let style = Style::line(colour, 1.0).filled(colour, 0.45);
        let legend = if good {
            "docked in time".to_owned()
        } else {
            summary.outcome.to_string()
        };
        let at = k as f64;
        time.add(Mark::Bar {
            at,
            half_width: 0.3,
            value: summary.time_s,
            style,
            legend: legend.clone(),
        });
        left.add(Mark::Bar {
            at,
            half_width: 0.3,
            value: summary.remaining_s,
            style,
            legend,
        });
    }
    time.add(Mark::Level {
        value: 10_800.0,
        style: Style::line("#b00020", 1.6),
        label: "10800 s available".into(),
    });
    time.add(Mark::published(
        vec![(0.0, 10_788.3)],
        "published, the mission of Table 2",
    ));
    left.add(Mark::published(
        vec![(0.0, 11.7)],
        "published, the mission of Table 2",
    ));
    let mut figure = Figure::new(
        "Fig. 17: ten missions use their time",
        "One network, other obstacles for each; the paper prints values for the mission of Table 2 only.",
    );
    figure.charts = vec![time, left];
    figure
}

fn figure17_table(ten: &[Summary]) -> Table {
    let mut table = Table::new([
        "mission",
        "outcome",
        "time (s)",
        "remaining (s)",
        "tasks",
        "weight",
        "least true clearance (m)",
        "collisions",
    ]);
    for (k, s) in ten.iter().enumerate() {
        table.row([
            (k + 1).to_string(),
            s.outcome.to_string(),
            format!("{:.1}", s.time_s),
            format!("{:.1}", s.remaining_s),
            s.tasks.to_string(),
            format!("{:.1}", s.mission_weight),
            format!("{:.1}", s.judgement.min_clearance_m),
            s.judgement.collisions.to_string(),
        ]);
    }
    table.row([
        "published (Table 2)",
        "success",
        "10788.3",
        "11.7",
        "13",
        "38",
        "-",
        "-",
    ]);
    table
}

fn dots(points: Vec<(f64, f64)>, colour: Colour, shape: PointShape, legend: &str) -> Mark {
    Mark::Points {
        points,
        shape,
        size: 3.2,
        style: Style::fill(colour, 1.0),
        legend: legend.into(),
    }
}

/// Times of legs against the times expected: `(flown, expected)` in seconds by mission.
fn times(title: &str, missions: Vec<Vec<(f64, f64)>>) -> Chart {
    let legs: usize = missions.iter().map(Vec::len).sum();
    let mut chart = Chart::new(
        title,
        Axis::new("leg").range(0.0, legs as f64 + 1.0),
        Axis::new("time (s)").from_zero(),
        190.0,
    );
    let all = missions.iter().flatten();
    let highest = all.map(|leg| leg.0.max(leg.1)).fold(0.0, f64::max);
    let mut at = 1.0;
    let (mut expected, mut early, mut late) = (Vec::new(), Vec::new(), Vec::new());
    for (k, mission) in missions.iter().enumerate() {
        let first = at;
        for &(leg_s, expected_s) in mission {
            expected.push((at, expected_s));
            let list = if leg_s > expected_s {
                &mut late
            } else {
                &mut early
            };
            list.push((at, leg_s));
            at += 1.0;
        }
        expected.push((f64::NAN, f64::NAN));
        if missions.len() == 1 {
            continue;
        }
        chart.add(Mark::Label {
            at: (0.5 * (first + at), 1.14 * highest),
            text: format!("{}", k + 1),
            colour: palette::GREY,
            size: 11.0,
            always: true,
        });
        chart.add(Mark::line(
            vec![(at - 0.5, 0.0), (at - 0.5, 1e5)],
            Style::line("#cccccc", 0.8),
            "",
        ));
    }
    chart.y = chart.y.range(0.0, 1.2 * highest);
    chart.add(Mark::line(
        expected,
        Style::line(palette::BLACK, 1.2),
        "expected",
    ));
    chart.add(dots(
        early,
        palette::BLUE,
        PointShape::Disc,
        "flown, in time",
    ));
    chart.add(dots(
        late,
        palette::VERMILLION,
        PointShape::Triangle,
        "flown, late",
    ));
    chart
}

/// How often a mission asked for a new route.
fn replans(summary: &Summary) -> f64 {
    let legs = summary.path_calls.iter();
    legs.filter(|leg| leg.replan).count() as f64
}

fn figure18(output: &Output, ten: &[Summary], all: &[Summary]) -> Result<Section, Failure> {
    output.draw("fig18.svg", &figure18_picture(ten))?;

    let mut section = Section::new("Fig. 18: flight time against expected time, and replans");
    section.show("fig18.svg", "Times of legs and replans of ten missions");
    section.table(&figure18_table(ten));
    figure18_claims(&mut section, ten, all);
    Ok(section)
}

fn figure18_picture(ten: &[Summary]) -> Figure {
    let mut figure = Figure::new(
        "Fig. 18: time of each leg against the time expected",
        "A leg later than expected (triangle) makes the synchroniser ask for a new route; numbers: the missions.",
    );
    let missions = ten.iter().map(|s| {
        let legs = s.path_calls.iter();
        legs.map(|leg| (leg.leg_s, leg.expected_s)).collect()
    });
    let ours = times(
        "ours: legs of the ten missions in order",
        missions.collect(),
    );
    let published = times(
        "published: legs of the mission of Table 2",
        vec![leg_times_s().collect()],
    );
    let mut counts = Chart::new(
        "new routes asked for",
        mission_axis(),
        Axis::new("replans").from_zero(),
        130.0,
    );
    for (k, summary) in ten.iter().enumerate() {
        counts.add(Mark::Bar {
            at: k as f64,
            half_width: 0.28,
            value: replans(summary),
            style: Style::line(palette::BLUE, 1.0).filled(palette::BLUE, 0.45),
            legend: "ours".into(),
        });
    }
    counts.add(Mark::published(
        PUBLISHED_REPLANS
            .iter()
            .enumerate()
            .map(|(k, n)| (k as f64, f64::from(*n)))
            .collect(),
        "published",
    ));
    figure.charts = vec![ours, published, counts];
    figure
}

fn figure18_table(ten: &[Summary]) -> Table {
    let mut table = Table::new([
        "mission",
        "legs",
        "replans, published",
        "replans, ours",
        "median T_leg / T_expected (flown to their end)",
    ]);
    for (k, s) in ten.iter().enumerate() {
        let ratio: Vec<f64> = s
            .path_calls
            .iter()
            .filter(|leg| leg.completed)
            .map(|leg| leg.leg_s / leg.expected_s)
            .collect();
        table.row([
            (k + 1).to_string(),
            s.path_calls.len().to_string(),
            PUBLISHED_REPLANS[k].to_string(),
            format!("{:.0}", replans(s)),
            format!("{:.3}", median(&ratio)),
        ]);
    }
    table
}

fn figure18_claims(section: &mut Section, ten: &[Summary], all: &[Summary]) {
    let ours: f64 = ten.iter().map(replans).sum();
    let per_mission: Vec<f64> = all.iter().map(replans).collect();
    let legs = || all.iter().flat_map(|s| &s.path_calls);
    let ratio = |leg: &PathCall| leg.leg_s / leg.expected_s;
    let flown: Vec<f64> = legs().filter(|leg| leg.completed).map(ratio).collect();
    let begun: Vec<f64> = legs().map(ratio).collect();
    let late: Vec<f64> = legs()
        .filter(|leg| leg.completed && leg.replan)
        .map(ratio)
        .collect();
    let given_up = begun.len() - flown.len();
    let many = all.iter().filter(|s| replans(s) > 6.0);
    let there = many.clone().flat_map(|s| &s.path_calls);
    section.claim(
        "a mission replans 0 to 6 times (24 in ten missions)",
        per_mission.iter().all(|n| *n <= 6.0),
        format!(
            "{ours:.0} in our ten missions; {:.2} a mission over {} missions, at most {:.0}. {} of the replans follow a late leg, half of them one late \
             by less than {:.1} %; {given_up} follow a leg given up on the way, because an obstacle covers its waypoint or no path leads there, a case the paper \
             does not treat. Missions of more than 6: {}, in which {} legs are given up",
            mean(&per_mission),
            all.len(),
            per_mission.iter().copied().fold(0.0, f64::max),
            late.len(),
            100.0 * (median(&late) - 1.0),
            many.count(),
            there.filter(|leg| !leg.completed).count()
        ),
    );
    section.claim(
        "there is no great difference between T_path-flight and T_expected",
        BoxStats::of(&flown).is_some_and(|s| s.low > 0.8 && s.high < 1.25),
        match (BoxStats::of(&flown), BoxStats::of(&begun)) {
            (Some(s), Some(all)) => format!(
                "the middle 90 % of {} legs flown to their end take {:.3} to {:.3} of the time expected (published, Table 2: 0.66 to 2.16); with the \
                 {given_up} given up on the way, whose time ends there, {:.3} to {:.3}",
                flown.len(),
                s.low,
                s.high,
                all.low,
                all.high
            ),
            _ => String::new(),
        },
    );
}

fn figure19(output: &Output, ten: &[Summary]) -> Result<Section, Failure> {
    let mut figure = Figure::new(
        "Fig. 19: computing time of path and route calls",
        "Wall time of single-threaded calls on this machine; boxes: quartiles, whiskers 5 to 95 %, cross: mean.",
    );
    let mut table = Table::new(["mission", "path calls of a leg (s)", "route call (s)"]);
    let kinds: [(&str, PerMission, Colour); 2] = [
        (
            "path calls of a leg (LPP)",
            |s| s.path_calls.iter().map(|c| c.compute_s).collect(),
            palette::GREEN,
        ),
        (
            "a route call (GRP)",
            |s| s.route_calls.iter().map(|c| c.compute_s).collect(),
            palette::PURPLE,
        ),
    ];
    let mut greatest = Vec::new();
    for (name, what, colour) in kinds {
        figure.charts.push(computing_times(name, what, colour, ten));
        greatest.push(ten.iter().flat_map(what).fold(0.0, f64::max));
    }
    figure.notes = vec!["Published for the mission of Table 2 (MATLAB R2014a): 37.4 to 47.3 s a path call, 17.3 to 23.9 s a route call; far off these scales.".into()];
    output.draw("fig19.svg", &figure)?;
    for (k, s) in ten.iter().enumerate() {
        table.row([
            (k + 1).to_string(),
            spread(&kinds[0].1(s), 4),
            spread(&kinds[1].1(s), 4),
        ]);
    }
    let mut section = Section::new("Fig. 19: computing time");
    section.show(
        "fig19.svg",
        "Computing time of path and route calls in ten missions",
    );
    section.table(&table);
    section.say("Published (Table 2, MATLAB R2014a, Intel i7 3.40 GHz): route calls 17.3 to 23.9 s, path calls 37.4 to 47.3 s; its text calls them \"in range of second\".");
    section.claim(
        "computing times lie in a narrow bound, in the range of seconds",
        greatest.iter().all(|s| *s < 10.0),
        format!(
            "at most {:.3} s for all path calls of a leg and {:.3} s for a route call",
            greatest[0], greatest[1]
        ),
    );
    Ok(section)
}

fn computing_times(name: &str, what: PerMission, colour: Colour, ten: &[Summary]) -> Chart {
    let mut chart = Chart::new(
        name,
        mission_axis(),
        Axis::new("time (s)").from_zero(),
        170.0,
    );
    for (k, summary) in ten.iter().enumerate() {
        if let Some(stats) = BoxStats::of(&what(summary)) {
            chart.add(Mark::Box {
                at: k as f64,
                half_width: 0.26,
                stats,
                colour,
                legend: String::new(),
            });
        }
    }
    chart
}
