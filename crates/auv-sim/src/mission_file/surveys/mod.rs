//! Surveys: lawnmowers over a polygon or along a corridor, as waypoints, edges and tasks of the file.

pub(super) mod entry;
mod lawnmower;
pub(super) mod line;

use super::document::{EdgeEntry, MissionFile, TaskEntry, WaypointEntry};
use super::place::Place;
use super::places;
use auv_ocean::SeaBed;
use auv_types::{Point3, Violations};
use entry::{Area, SurveyEntry};
use line::{Drawn, Line};
use std::collections::BTreeSet;

/// Waypoints that each corner of a survey is connected to where no `[connect]` says how many.
const NEAREST: usize = 3;
/// No survey has more lines.
const MOST_LINES: usize = 400;

impl MissionFile {
    /// Turns surveys into waypoints, edges and tasks; those that are wrong are left to [`MissionFile::check_surveys`].
    pub(super) fn expand(&mut self) {
        self.waypoints.retain(|entry| entry.line.is_none());
        self.edges.retain(|entry| entry.drawn.is_none());
        let told = self.waypoints.len();
        for line in std::mem::take(&mut self.lines) {
            self.tasks.remove(&line.task);
            let survey = &self.surveys[line.survey];
            self.tasks.remove(&survey.begins());
        }
        for (k, survey) in self.surveys.clone().iter().enumerate() {
            let mut wrong = Violations::new();
            self.check_survey(k, survey, &mut wrong);
            if wrong.is_empty() {
                self.add_survey(k, survey);
            }
        }
        self.connect_corners(told);
    }

    /// What is wrong with the surveys.
    fn check_surveys(&self, violations: &mut Violations) {
        for (k, survey) in self.surveys.iter().enumerate() {
            self.check_survey(k, survey, violations);
        }
    }

    fn check_survey(&self, k: usize, survey: &SurveyEntry, violations: &mut Violations) {
        let place = format!("surveys[{k}] ({})", survey.name);
        let others = self.surveys[..k].iter().map(|other| &other.name);
        let is_survey = others.clone().any(|name| *name == survey.name);
        if survey.name.is_empty() {
            violations.push(&*place, "has no name; give it one");
        } else if is_survey || self.tasks.contains_key(&survey.name) {
            let of = if is_survey {
                "another survey"
            } else {
                "a task"
            };
            violations.push(
                &*place,
                format!("has the name of {of}; give it one of its own"),
            );
        }
        let before = violations.total();
        survey.check(&place, violations);
        let is_sound = violations.total() == before;
        Self::check_windows(&survey.windows, &place, violations);
        let Some((points, area)) = self.area(k, survey, violations) else {
            return;
        };
        let lines = match area {
            Area::Polygon => {
                let across = |p: &Point3<f64>| (p - points[0]).norm();
                let size_m = points.iter().map(across).fold(0.0, f64::max);
                lawnmower::lines_across(2.0 * size_m, survey.spacing_m)
            }
            Area::Corridor { width_m } => lawnmower::lines_across(width_m, survey.spacing_m),
        };
        violations.require(!is_sound || lines <= 2 * MOST_LINES, &place, || {
            format!("has more than {MOST_LINES} lines; give a greater spacing_m")
        });
    }

    /// Corners of the polygon or of the line along the corridor, in local metres.
    fn area(
        &self,
        k: usize,
        survey: &SurveyEntry,
        violations: &mut Violations,
    ) -> Option<(Vec<Point3<f64>>, Area)> {
        let (key, given, area) = survey.given()?;
        let (before, frame) = (violations.list().len(), self.frame());
        let corner = |(i, at): (usize, &Place)| {
            let place = format!("surveys[{k}] ({}).{key}[{i}]", survey.name);
            let mut point = places::point(at, frame.as_ref(), &place, violations);
            point.z = 0.0;
            point
        };
        let mut points: Vec<Point3<f64>> = given.iter().enumerate().map(corner).collect();
        // A closed ring repeats its first corner.
        if area == Area::Polygon && points.len() > 3 && points.first() == points.last() {
            points.pop();
        }
        let place = format!("surveys[{k}] ({}).{key}", survey.name);
        entry::check_corners(&points, area, &place, violations);
        (violations.list().len() == before).then_some((points, area))
    }

    fn add_survey(&mut self, k: usize, survey: &SurveyEntry) {
        let Some((points, area)) = self.area(k, survey, &mut Violations::new()) else {
            return;
        };
        let values = self.values(&mut Vec::new(), &mut Violations::new());
        let radius_m = values.vehicle.turn_radius_m;
        let lines = match area {
            Area::Polygon => {
                let best = || lawnmower::best_course(&points, survey.spacing_m, radius_m);
                let course = survey.course().unwrap_or_else(best);
                lawnmower::over_polygon(&points, survey.spacing_m, course)
            }
            Area::Corridor { width_m } => {
                lawnmower::along_corridor(&points, width_m, survey.spacing_m)
            }
        };
        let order = lawnmower::order(&lines, radius_m, survey.is_in_sequence());
        let whole_m: f64 = lines.iter().map(|line| length_m(line)).sum();
        let mut before: Option<usize> = None;
        for (i, &line) in order.iter().enumerate() {
            let share = length_m(&lines[line]) / whole_m;
            let task = format!("{} {}", survey.name, i + 1);
            let entry = self.task_of_line(survey, share, before);
            self.tasks.insert(task.clone(), entry);
            let number = self.add_line(k, lines[line].clone(), task, before.is_none());
            for side in 0..2 {
                if let Some(before) = before {
                    let ends = [before, number].map(|line| self.lines[line].ends[side]);
                    self.draw(ends, None, Drawn::Way);
                }
            }
            before = Some(number);
        }
    }

    /// The task of a line that is so much of a survey, flown after another line. A survey with windows begins at the
    /// beginning of its first line, and keeps their order.
    fn task_of_line(
        &mut self,
        survey: &SurveyEntry,
        share: f64,
        before: Option<usize>,
    ) -> TaskEntry {
        let task = |share: f64| TaskEntry {
            priority: survey.priority * share,
            risk: survey.risk,
            mandatory: survey.mandatory,
            time_s: Some(0.0),
            ..TaskEntry::default()
        };
        if survey.windows.is_empty() {
            return task(share);
        }
        let begins = survey.begins();
        let after = before.map(|before| self.lines[before].task.clone());
        let after = after.unwrap_or_else(|| {
            let beginning = TaskEntry {
                windows: survey.windows.clone(),
                ..task(0.0)
            };
            self.tasks.insert(begins.clone(), beginning);
            begins
        });
        TaskEntry {
            after: vec![after],
            ..task(share)
        }
    }

    /// Adds a line with its waypoints and its edge; returns its number.
    fn add_line(
        &mut self,
        k: usize,
        points: Vec<Point3<f64>>,
        task: String,
        is_first: bool,
    ) -> usize {
        let survey = &self.surveys[k];
        let (depth_m, height) = (survey.depth_m.unwrap_or_default(), survey.height());
        let begins = Some(survey.begins()).filter(|_| is_first && !survey.windows.is_empty());
        let (number, first) = (self.lines.len(), self.waypoints.len());
        for (side, place, task_here) in [("a", points.first(), begins), ("b", points.last(), None)]
        {
            let [x, y] = place.map_or([0.0; 2], |p| [p.x, p.y]);
            self.waypoints.push(WaypointEntry {
                name: format!("{task}{side}"),
                at: Place::Local([x, y, depth_m]),
                task: task_here,
                tasks: None,
                line: Some(number),
            });
        }
        let ends = [first, first + 1];
        self.draw(ends, Some(vec![task.clone()]), Drawn::Line(number));
        self.lines.push(Line {
            points,
            height,
            ends,
            task,
            survey: k,
        });
        number
    }

    /// Connects the first and the last line of each survey, all lines of one that may be split, with start and docks,
    /// with the other waypoints nearest to their ends, and with the nearest end of each other survey. `told` is the
    /// number of waypoints that the file lists.
    fn connect_corners(&mut self, told: usize) {
        let frame = self.frame();
        let place = |entry: &WaypointEntry| {
            let wrong = &mut Violations::new();
            places::point(&entry.at, frame.as_ref(), "", wrong)
        };
        let spots: Vec<Point3<f64>> = self.waypoints.iter().map(place).collect();
        let outer = |line: &usize| {
            let of = |other: Option<&Line>| other.map(|line| line.survey);
            let survey = of(self.lines.get(*line));
            let splits = survey.is_some_and(|survey| self.surveys[survey].may_split());
            splits
                || *line == 0
                || of(self.lines.get(line - 1)) != survey
                || of(self.lines.get(line + 1)) != survey
        };
        let corners: Vec<(usize, usize)> = (0..self.lines.len())
            .filter(outer)
            .flat_map(|line| {
                self.lines[line]
                    .ends
                    .map(|end| (end, self.lines[line].survey))
            })
            .collect();
        let connect = self.connect.as_ref();
        let except = |i: usize| {
            connect.is_some_and(|connect| connect.except.contains(&self.waypoints[i].name))
        };
        let always = |i: usize| {
            let name = &self.waypoints[i].name;
            let docks = self.docks.iter().flatten().chain(&self.destination);
            docks.chain([&self.start]).any(|end| end == name)
        };
        let mut pairs = BTreeSet::new();
        let count = connect.map_or(NEAREST, |connect| connect.nearest);
        for &(corner, survey) in &corners {
            let away_m = |i: usize| (spots[i] - spots[corner]).norm();
            let nearer = |a: &usize, b: &usize| away_m(*a).total_cmp(&away_m(*b)).then(a.cmp(b));
            let listed = (0..told).filter(|&i| !except(i));
            let (ends, mut near): (Vec<usize>, Vec<usize>) = listed.partition(|&i| always(i));
            near.sort_by(nearer);
            near.truncate(count);
            let others = (0..self.surveys.len()).filter(|&other| other != survey);
            let nearest = others.filter_map(|other| {
                let of_it = corners.iter().filter(|(_, whose)| *whose == other);
                of_it.map(|(i, _)| *i).min_by(nearer)
            });
            let to = ends.into_iter().chain(near).chain(nearest);
            pairs.extend(to.map(|i| [i.min(corner), i.max(corner)]));
        }
        for pair in pairs {
            self.draw(pair, None, Drawn::Way);
        }
    }

    fn draw(&mut self, ends: [usize; 2], tasks: Option<Vec<String>>, drawn: Drawn) {
        let [from, to] = ends.map(|i| self.waypoints[i].name.clone());
        self.edges.push(EdgeEntry {
            from,
            to,
            directed: false,
            task: None,
            tasks,
            speed_mps: None,
            altitude_m: None,
            depth_m: None,
            drawn: Some(drawn),
        });
    }

    /// Puts the ends of lines that follow the bed over it; says what is wrong with the surveys.
    pub(super) fn place_lines(
        &self,
        points: &mut [Point3<f64>],
        bed: Option<&dyn SeaBed>,
        violations: &mut Violations,
    ) {
        self.check_surveys(violations);
        let follows = |line: &Line| line.height.over_m(0.0).is_some();
        let Some(bed) = bed else {
            violations.require(!self.lines.iter().any(follows), "sea_bed", || {
                "is missing; give one: a survey with altitude_m needs it".into()
            });
            return;
        };
        for line in &self.lines {
            for end in line.ends {
                let Some(point) = points.get_mut(end) else {
                    continue;
                };
                let bed_m = bed.depth_at(point.x, point.y);
                point.z = line.height.over_m(bed_m).unwrap_or(point.z);
            }
        }
    }

    /// The line that a task is.
    pub(super) fn line_of(&self, task: &str) -> Option<&Line> {
        self.lines.iter().find(|line| line.task == task)
    }

    /// Whether a task has a name, or is a line of the survey of that name.
    pub(super) fn is_called(&self, task: &str, name: &str) -> bool {
        let survey = |line: &Line| self.surveys[line.survey].name == name;
        task == name || self.line_of(task).is_some_and(survey)
    }
}

fn length_m(line: &[Point3<f64>]) -> f64 {
    line.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum()
}
