//! The partial routes that are open, in the order of time.

use super::extension::Extension;
use super::label::{Label, Place};
use super::priced::Priced;
use super::reach::Reach;
use super::rivals::Rivals;
use crate::Run;
use crate::timed::timed_network::{Step, TimedNetwork};
use crate::timed::tour::TimedTour;
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

/// Most nodes of a network.
const MOST_NODES: usize = 128;
/// Evaluations between two looks at the clock.
const BATCH: u64 = 16;
/// Partial routes extended in one evaluation: together with the judgement of all steps that may follow, about as
/// much work as one whole route.
const EXTENDED: u64 = 4;

/// How far the partial routes were extended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extended {
    /// None is open: no route weighs more than the best.
    All,
    /// As many as allowed.
    Some,
    /// The run stopped it.
    Stopped,
}

/// The partial routes of a problem in time.
#[derive(Debug)]
pub struct PartialRoutes<'a> {
    extension: Extension<'a>,
    reach: Reach,
    priced: Priced,
    labels: Vec<Label>,
    /// The number of each place, and the partial routes extended there.
    places: BTreeMap<Place, u32>,
    rivals: Vec<Rivals>,
    /// By time when ready; times are not negative, so their bits are in the same order as they are.
    open: BinaryHeap<Reverse<(u64, u32)>>,
    best: Option<Vec<Step>>,
    most_found: f64,
    /// The most that a route weighs of which it is not known whether it meets its places in time.
    most_unsure: f64,
    /// By node: those near it. A partial route there beats another one if it has visited no more of them.
    near: Vec<u128>,
    /// What no route weighs more than.
    most_of_start: f64,
    /// How many are near each node.
    nears: usize,
    /// Whether what is ready earlier can do all that is ready later.
    early_is_good: bool,
}

impl<'a> PartialRoutes<'a> {
    /// `None` if the network has more than 128 nodes, more than 64 tasks with rules, or more than 16 tasks at one
    /// place. Routes that weigh no more than `tour`, if there is one, are not sought.
    #[must_use]
    pub fn new(
        run: &mut Run<'_>,
        tables: &'a TimedNetwork<'a>,
        tour: Option<&TimedTour>,
    ) -> Option<Self> {
        if tables.nodes() > MOST_NODES {
            return None;
        }
        let whole = tour.filter(|tour| tour.missing(tables) == 0);
        let most_found = whole.map_or(f64::NEG_INFINITY, TimedTour::weight);
        let mut partial = Self {
            extension: Extension::new(tables)?,
            reach: Reach::new(tables),
            priced: Priced::new(run, tables, most_found.max(0.0)),
            labels: Vec::new(),
            places: BTreeMap::new(),
            rivals: Vec::new(),
            open: BinaryHeap::new(),
            best: None,
            most_found,
            most_unsure: f64::NEG_INFINITY,
            near: Vec::new(),
            most_of_start: f64::INFINITY,
            nears: 0,
            early_is_good: tables.model.may_wait || !tables.opens_late(),
        };
        let mut root = partial.extension.root();
        partial.look_ahead(&mut root);
        partial.most_of_start = root.most;
        partial.begin(0);
        Some(partial)
    }

    /// Begins again with more nodes near: a partial route beats another one at its node if it has visited no more
    /// of them. With few the search is quick and may miss the best route; with all it is exact.
    fn begin(&mut self, near: usize) {
        let tables = self.extension.tables;
        self.near = nodes_near(tables, near);
        self.nears = near;
        self.labels.clear();
        self.places.clear();
        self.rivals.clear();
        self.open.clear();
        self.most_unsure = f64::NEG_INFINITY;
        let root = self.extension.root();
        self.keep(root);
    }

    fn is_exact(&self) -> bool {
        self.nears >= self.near.len()
    }

    /// Routes that weigh no more than this tour are not sought from now on.
    pub fn offer(&mut self, tour: &TimedTour) {
        if tour.missing(self.extension.tables) == 0 {
            self.most_found = self.most_found.max(tour.weight());
        }
    }

    /// Extends partial routes for at most `most` evaluations and while no more than `most_kept` are kept (about 250
    /// bytes each). One evaluation is four extensions.
    pub fn extend(&mut self, run: &mut Run<'_>, most: u64, most_kept: usize) -> Extended {
        let (mut granted, mut left) = (0, most);
        loop {
            let Some(Reverse((bits, id))) = self.open.pop() else {
                if self.is_exact() {
                    let is_sure = self.most_unsure <= self.least_sought();
                    return if is_sure {
                        Extended::All
                    } else {
                        Extended::Some
                    };
                }
                let (next, nodes) = (2 * self.nears.max(1), self.near.len());
                self.begin(if 2 * next < nodes { next } else { nodes });
                continue;
            };
            let label = &self.labels[id as usize];
            if label.most <= self.least_sought() || self.is_beaten(label) {
                continue;
            }
            let is_full = self.labels.len() >= most_kept;
            if granted == 0 && left > 0 && !is_full {
                let evaluations = run.grant(BATCH.min(left));
                left -= evaluations;
                granted = EXTENDED * evaluations;
            }
            if granted == 0 || is_full {
                self.open.push(Reverse((bits, id)));
                let stopped = left > 0 && !is_full;
                return if stopped {
                    Extended::Stopped
                } else {
                    Extended::Some
                };
            }
            granted -= 1;
            let label = label.clone();
            self.rivals[label.rivals as usize].add(&label);
            let out_and_back = |node| self.is_out_and_back(&label, node);
            for new in self.extension.of(&label, id, out_and_back) {
                self.keep(new);
            }
        }
    }

    /// Whether a route has gone from the start to a node and nowhere else.
    fn is_out_and_back(&self, label: &Label, node: u32) -> bool {
        let start = self.extension.tables.problem.start.0;
        label.visited == 1_u128 << start | 1_u128 << node
    }

    /// Fills in what a new one can still do: the most that any continuation weighs, and the nodes it can visit no
    /// more.
    fn look_ahead(&self, label: &mut Label) {
        let (tables, place) = (self.extension.tables, &label.place);
        let (more, open) = if place.is_closed {
            let here = tables.at_node[place.node as usize].iter();
            let here = here.map(|&task| tables.works[task as usize].weight);
            (here.sum(), 0)
        } else {
            let open = self.reach.within(place.node, label.ready_s) & !label.visited;
            let done = self.extension.done(place);
            (self.priced.of(label, done, open), open)
        };
        let start = tables.problem.start.0;
        label.earns_less_back = self.extension.closes(label)
            && self.is_out_and_back(label, place.node)
            && place.node != start
            && tables.own_weight(place.node, start) > 0.0;
        label.most = label.weight + self.extension.edge_weight(place) + more;
        label.shut = !open;
    }

    /// Routes that weigh no more are not sought.
    fn least_sought(&self) -> f64 {
        self.most_found + 1e-9 * self.most_found.max(0.0)
    }

    fn keep(&mut self, mut new: Label) {
        let tables = self.extension.tables;
        let last_s = tables.problem.time_available_s + auv_graph::TIME_TOLERANCE_S;
        let home_s = if new.place.is_closed {
            0.0
        } else {
            self.reach.home_s[new.place.node as usize]
        };
        if new.ready_s + home_s > last_s {
            return;
        }
        self.look_ahead(&mut new);
        if new.most <= self.least_sought() {
            return;
        }
        new.rivals = self.number(new.place);
        if self.is_beaten(&new) {
            return;
        }
        let id = self.labels.len() as u32;
        self.open.push(Reverse((new.ready_s.to_bits(), id)));
        let is_best = self.extension.ends(&new) && new.weight > self.most_found;
        self.labels.push(new);
        if is_best {
            self.take(id);
        }
    }

    /// Takes the best route. The time between places to be met again is only bounded here: the tour tells.
    fn take(&mut self, id: u32) {
        let (steps, weight) = (self.steps(id), self.labels[id as usize].weight);
        let has_visits = self.extension.tables.model.visits.is_some();
        if has_visits && TimedTour::new(self.extension.tables, steps.clone()).is_none() {
            self.most_unsure = self.most_unsure.max(weight);
        } else {
            self.most_found = weight;
            self.best = Some(steps);
        }
    }

    /// Whether one of those extended is at least as good.
    fn is_beaten(&self, label: &Label) -> bool {
        let near = self.near[label.place.node as usize];
        self.rivals[label.rivals as usize].beat(label, near, self.early_is_good)
    }

    /// The number of a place among the rivals.
    fn number(&mut self, place: Place) -> u32 {
        let next = self.rivals.len() as u32;
        let number = *self.places.entry(place).or_insert(next);
        if number == next {
            self.rivals.push(Rivals::default());
        }
        number
    }

    /// The best route found, if one weighs more than the tours offered.
    #[must_use]
    pub fn best(&self) -> Option<TimedTour> {
        TimedTour::new(self.extension.tables, self.best.clone()?)
    }

    fn steps(&self, id: u32) -> Vec<Step> {
        let mut steps = Vec::new();
        let mut label = self.labels.get(id as usize);
        while let Some(found) = label {
            steps.push(found.step);
            label = self.labels.get(found.parent as usize);
        }
        let mut kept: Vec<Step> = Vec::new();
        for &step in steps.iter().rev() {
            // A step that only arrives is part of the first work there.
            kept.pop_if(|last| !last.works() && last.node == step.node);
            kept.push(step);
        }
        kept
    }

    /// No route weighs more than this or the tours offered.
    #[must_use]
    pub fn bound(&self) -> f64 {
        if !self.is_exact() {
            return self.most_found.max(self.most_of_start);
        }
        let open = self
            .open
            .iter()
            .map(|Reverse((_, id))| &self.labels[*id as usize]);
        let open = open.map(|label| label.most);
        open.fold(self.most_found.max(self.most_unsure), f64::max)
    }
}

/// By node: the nodes to which the way is shortest, `count` of them.
fn nodes_near(tables: &TimedNetwork<'_>, count: usize) -> Vec<u128> {
    let nodes = tables.nodes() as u32;
    let near = |from: u32| {
        let mut order: Vec<u32> = (0..nodes).filter(|&to| to != from).collect();
        let least_s = |to: u32| tables.least_s(from, to);
        order.sort_by(|&a, &b| least_s(a).total_cmp(&least_s(b)).then(a.cmp(&b)));
        order.iter().take(count).fold(0, |near, to| near | 1 << to)
    };
    (0..nodes).map(near).collect()
}
