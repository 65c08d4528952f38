//! The tasks of a route in time: when, where, in which order and which of them; kept and broken.

use crate::in_time::{BEYOND_S, NEARLY_S, along, at, checked, found, model, work};
use auv_graph::{Chain, EdgeId, NodeId, Passing, TaskPlace, TimeModel, TimedTask};
use auv_verify::TimeViolation as V;

#[test]
fn waiting_is_found_where_it_is_not_allowed() {
    let patient = model([work(at(0)), work(at(2))]);
    let hasty = TimeModel {
        may_wait: false,
        ..patient.clone()
    };
    let waits = |node| V::Waits { node: NodeId(node) };
    let ready = ([30.0, 180.0, 330.0], [(0, 0.0), (1, 300.0)]);
    // A microsecond is rounding.
    for (late_s, is_wait) in [
        (0.0, false),
        (NEARLY_S, false),
        (1e-6, false),
        (BEYOND_S, true),
        (20.0, true),
    ] {
        let mut off = [(30.0, 0.0), (180.0, 0.0), (330.0, 300.0)];
        off.iter_mut().skip(1).for_each(|leg| leg.0 += late_s);
        off[2].1 += late_s;
        let departures_s = off.map(|leg| leg.0);
        let late = [(0, 0.0), (1, off[2].1)];
        assert_eq!(found(&patient, &[0, 1, 2, 3], &departures_s, &late), []);
        let expected = if is_wait { vec![waits(1)] } else { vec![] };
        assert_eq!(found(&hasty, &[0, 1, 2, 3], &departures_s, &late), expected);
        // Before a task.
        let (departures_s, mut done) = ready;
        done[0].1 = late_s;
        let departures_s = departures_s.map(|s| s + late_s);
        done[1].1 += late_s;
        assert_eq!(found(&patient, &[0, 1, 2, 3], &departures_s, &done), []);
        let expected = if is_wait { vec![waits(0)] } else { vec![] };
        assert_eq!(found(&hasty, &[0, 1, 2, 3], &departures_s, &done), expected);
    }
    // Before the first departure.
    let idle = [1e-6, 150.0 + 1e-6, 270.0 + 1e-6];
    assert_eq!(found(&hasty, &[0, 1, 2, 3], &idle, &[]), []);
}

#[test]
fn work_begins_when_the_vehicle_is_there_within_a_window_and_once() {
    let open = TimedTask {
        windows: vec![[10.0, 20.0], [160.0, 170.0]],
        ..work(at(1))
    };
    let (free, open) = (model([work(at(1))]), model([open]));
    let begun = |model: &TimeModel, start_s: f64| {
        let ready_s = start_s.max(150.0) + 30.0;
        let departures_s = [0.0, ready_s, ready_s + 120.0];
        found(model, &[0, 1, 2, 3], &departures_s, &[(0, start_s)])
    };
    let wrong = |found: &[V], reasons: &[&str]| {
        let why = found.iter().map(|v| match v {
            V::WrongStart { task: 0, why, .. } => *why,
            other => panic!("{other}"),
        });
        assert_eq!(why.collect::<Vec<_>>(), reasons);
    };
    let (absent, closed) = ("before the vehicle is there", "outside its windows");
    wrong(&begun(&free, 150.0 - NEARLY_S), &[]);
    wrong(&begun(&free, 150.0 - BEYOND_S), &[absent]);
    wrong(&begun(&open, 160.0), &[]);
    wrong(&begun(&open, 160.0 - NEARLY_S), &[]);
    wrong(&begun(&open, 160.0 - BEYOND_S), &[closed]);
    wrong(&begun(&open, 170.0 + NEARLY_S), &[]);
    wrong(&begun(&open, 170.0 + BEYOND_S), &[closed]);
    wrong(&begun(&open, 15.0), &[absent]);
    wrong(&begun(&open, 40.0), &[absent, closed]);
    // A NaN is no time.
    let departures_s = [0.0, 180.0, 300.0];
    let unknown = found(&open, &[0, 1, 2, 3], &departures_s, &[(0, f64::NAN)]);
    wrong(&unknown, &[absent, closed]);
    wrong(&along(&free, &[(0, 150.0), (0, 180.0)]), &["again"]);
}

#[test]
fn work_where_the_route_does_not_pass_is_found() {
    let elsewhere = |task| V::NotOnTheWay { task };
    let two = model([work(at(1)), work(at(3)), work(TaskPlace::Edge(EdgeId(3)))]);
    // What comes after a task in the wrong place waits for it in vain: the first is named.
    let departures_s = [0.0, 150.0, 270.0];
    let line = &[0, 1, 2, 3];
    assert_eq!(
        found(&two, line, &departures_s, &[(2, 0.0), (0, 150.0)]),
        [elsewhere(2)]
    );
    assert_eq!(
        found(&two, line, &departures_s, &[(1, 370.0), (0, 400.0)]),
        [elsewhere(0)]
    );
    assert_eq!(found(&two, line, &departures_s, &[(1, 370.0)]), []);
    // An edge task is done at the far end.
    let done = [(2, 300.0), (1, 330.0)];
    let (report, none) = checked(&two, &[0, 3], &[0.0], &done);
    assert_eq!((report.time_s, none), (360.0, vec![]));
}

#[test]
fn order_and_what_must_be_done_are_kept() {
    let second = TimedTask {
        after: vec![1, 2],
        ..work(at(1))
    };
    let ordered = model([second, work(at(1)), work(at(1))]);
    let order = |before| V::WrongOrder { task: 0, before };
    let (a, b, c) = (150.0, 180.0, 210.0);
    assert_eq!(along(&ordered, &[(1, a), (2, b), (0, c)]), []);
    assert_eq!(along(&ordered, &[(1, a), (0, b), (2, c)]), [order(2)]);
    assert_eq!(along(&ordered, &[(0, a)]), [order(1), order(2)]);

    let mandatory = TimedTask {
        mandatory: true,
        ..work(at(1))
    };
    let must = model([work(at(1)), mandatory]);
    assert_eq!(along(&must, &[(1, a)]), []);
    assert_eq!(along(&must, &[(0, a)]), [V::NotDone { task: 1 }]);

    // Passing does the tasks at nodes; those of edges, and of nodes not passed, are left.
    let places = [at(1), at(2), TaskPlace::Edge(EdgeId(1))];
    let passing = TimeModel {
        passing: Passing::DoesTasks,
        ..model(places.map(work))
    };
    assert_eq!(along(&passing, &[(0, a)]), [V::NotDone { task: 1 }]);
    assert_eq!(found(&passing, &[0, 3], &[0.0], &[]), []);
    assert_eq!(along(&model(places.map(work)), &[]), []);
}

#[test]
fn chains_are_done_in_a_run_forwards_or_backwards() {
    // Task 0 is free, 1 to 3 and then 5 are a chain; 4 is of another chain.
    let chained = |may_split| {
        let chain = [None, Some(0), Some(0), Some(0), Some(1), Some(0)];
        let tasks = chain.map(|chain| TimedTask {
            chain,
            ..work(at(1))
        });
        let chains = ["box", "other"].map(|name| Chain {
            name: name.into(),
            may_split,
        });
        TimeModel {
            chains: chains.into(),
            ..model(tasks)
        }
    };
    let kept = |may_split, order: &[usize]| {
        let begun = |(k, &task): (usize, &usize)| (task, 150.0 + 30.0 * k as f64);
        let done: Vec<_> = order.iter().enumerate().map(begun).collect();
        let found = along(&chained(may_split), &done);
        assert!(
            found.is_empty() || found == [V::BrokenChain { chain: 0 }],
            "{found:?}"
        );
        found.is_empty()
    };
    for (order, whole, split) in [
        (&[][..], true, true),
        (&[0, 4], true, true),
        (&[1, 2, 3, 5], true, true),
        (&[0, 1, 2, 3, 5, 4], true, true),
        (&[4, 0, 5, 3, 2, 1], true, true),
        (&[0, 4, 2, 3], false, true),
        (&[0, 3, 2], false, true),
        (&[5, 3], false, true),
        (&[2], false, true),
        (&[1, 3], false, false),
        (&[1, 2, 5], false, false),
        (&[2, 1, 3, 5], false, false),
        (&[1, 2, 0, 3, 5], false, false),
        (&[1, 4, 2], false, false),
    ] {
        assert_eq!(
            (kept(false, order), kept(true, order)),
            (whole, split),
            "{order:?}"
        );
    }
}
