//! Two thousand files made from sound ones: meaning kept, lost and contradicted.
#![cfg(feature = "netcdf")]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests may"
)]
#![allow(clippy::print_stdout, reason = "the table is printed")]

mod kept;
mod refused;
mod same;
#[path = "../written/mod.rs"]
mod written;

use auv_ocean::netcdf::{read_bathymetry, read_currents};
use auv_ocean::{LocalFrame, SeaBed};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng as Random, Seed};
use kept::{CHART_KEPT, CURRENTS_KEPT, Kept, go_together};
use refused::{CHART_AGAINST, CHART_LOST, CURRENTS_AGAINST, CURRENTS_LOST, Refused};
use same::{close, same_chart, same_currents};
use std::collections::{BTreeMap, BTreeSet};
use written::{File, chart, currents};

/// Files made from a sound one, no two alike.
struct Made<'a> {
    kind: &'static str,
    sound: fn() -> File,
    kept: &'a [Kept],
    random: Random,
    seen: BTreeSet<Vec<u8>>,
    counts: &'a mut BTreeMap<String, usize>,
}

impl<'a> Made<'a> {
    fn new(
        kind: &'static str,
        (sound, kept): (fn() -> File, &'a [Kept]),
        counts: &'a mut BTreeMap<String, usize>,
    ) -> Self {
        Self {
            kind,
            sound,
            kept,
            random: Seed(21).stream(kind.len() as u64),
            seen: BTreeSet::from([sound().bytes()]),
            counts,
        }
    }

    /// One to four changes that keep the meaning, each at most once.
    fn kept(&mut self) -> (Vec<u8>, String) {
        loop {
            let mut file = (self.sound)();
            let most = self.random.random_range(1..=4);
            let told = self.change(&mut file, most, |_| true);
            let bytes = file.bytes();
            if self.seen.insert(bytes.clone()) {
                for name in &told {
                    *self
                        .counts
                        .entry(format!("kept, {}: {name}", self.kind))
                        .or_default() += 1;
                }
                return (bytes, told.join(", "));
            }
        }
    }

    /// A change that does not keep it, after up to three of the arrangement alone.
    fn refused(&mut self, group: &str, (name, change, words): Refused) -> (Vec<u8>, String) {
        loop {
            let mut file = (self.sound)();
            let most = self.random.random_range(0..=3);
            let told = self.change(&mut file, most, |kept| kept.2);
            change(&mut file, &mut self.random);
            let bytes = file.bytes();
            if self.seen.insert(bytes.clone()) {
                *self
                    .counts
                    .entry(format!("{group}, {}: {name}", self.kind))
                    .or_default() += 1;
                return (bytes, format!("{name} ({words:?}) after {told:?}"));
            }
        }
    }

    fn change(
        &mut self,
        file: &mut File,
        most: usize,
        may: impl Fn(&Kept) -> bool,
    ) -> Vec<&'static str> {
        let mut told = Vec::new();
        for _ in 0..most {
            let kept = &self.kept[self.random.random_range(0..self.kept.len())];
            if may(kept) && go_together(&told, kept.0) {
                (kept.1)(file, &mut self.random);
                told.push(kept.0);
            }
        }
        told
    }
}

type Read<T> = fn(&[u8]) -> Result<T, String>;

/// Every change of a list in turn, `count` files in all: each is refused with its words.
fn all_refused<T>(
    made: &mut Made<'_>,
    (group, changes): (&str, &[Refused]),
    read: Read<T>,
    count: usize,
) {
    for case in 0..count {
        let (_, _, words) = changes[case % changes.len()];
        let (bytes, told) = made.refused(group, changes[case % changes.len()]);
        let Err(message) = read(&bytes) else {
            panic!("{told}: read")
        };
        for word in words {
            assert!(message.contains(word), "{told}: {message}");
        }
    }
}

#[test]
fn meaning_kept_is_read_and_meaning_lost_or_contradicted_is_refused() {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let read_chart: Read<_> = |bytes| read_bathymetry(bytes).map_err(|e| e.to_string());
    let read_model: Read<_> = |bytes| read_currents(bytes).map_err(|e| e.to_string());

    let mut charts = Made::new("chart", (chart, CHART_KEPT), &mut counts);
    let sound = read_chart(&chart().bytes()).unwrap().0;
    let frame = LocalFrame::new(sound.centre().unwrap()).unwrap();
    let bed = sound.to_bed(&frame, 150.0).unwrap();
    for case in 0..650 {
        let (bytes, told) = charts.kept();
        let (found, _) = read_chart(&bytes).unwrap_or_else(|e| panic!("{told}: {e}"));
        same_chart(&sound, &found, &told);
        // Falling two-dimensional positions keep their order, and shoals their side of a cell.
        if case % 10 == 0 && !told.contains("two-dimensional") {
            let again = found.to_bed(&frame, 150.0).unwrap();
            for (n, e) in [
                (0.0, 0.0),
                (333.0, -777.0),
                (-1500.0, 900.0),
                (-60.0, -390.0),
            ] {
                assert!(close(bed.depth_at(n, e), again.depth_at(n, e)), "{told}");
            }
        }
    }
    all_refused(&mut charts, ("lost", CHART_LOST), read_chart, 210);
    all_refused(
        &mut charts,
        ("contradicted", CHART_AGAINST),
        read_chart,
        165,
    );

    let mut models = Made::new("current", (currents, CURRENTS_KEPT), &mut counts);
    let sound = read_model(&currents().bytes()).unwrap().0;
    for _ in 0..600 {
        let (bytes, told) = models.kept();
        let (found, _) = read_model(&bytes).unwrap_or_else(|e| panic!("{told}: {e}"));
        same_currents(&sound, &found, &told);
    }
    all_refused(&mut models, ("lost", CURRENTS_LOST), read_model, 210);
    all_refused(
        &mut models,
        ("contradicted", CURRENTS_AGAINST),
        read_model,
        165,
    );

    println!(
        "650 + 600 files kept their meaning: all read. 420 lost it, 330 contradict themselves: all refused. \
         No two are alike."
    );
    println!("| change | files |\n|---|---|");
    for (name, count) in &counts {
        println!("| {name} | {count} |");
    }
}
