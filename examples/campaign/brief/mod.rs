//! The brief of a mission: one page for the decision to launch.

mod answer;
mod flights;
mod page;

use crate::fleet::Fleet;
use answer::Brief;
use auv_examples::{Arguments, Failure, note, print, print_json, write_file};
use flights::{Flights, Variation};
use std::path::Path;

/// Launches tried around the planned one, minutes.
const LAUNCHES_MIN: [f64; 6] = [-60.0, -40.0, -20.0, 20.0, 40.0, 60.0];
/// Least missions flown for each other launch, where so many are flown at all.
const LEAST_FOR_A_LAUNCH: u64 = 20;

/// Flies the missions as planned, with less time, in a stronger current and at other launches, writes the page
/// and prints its numbers.
pub(crate) fn run(
    arguments: &Arguments,
    fleet: &Fleet,
    (first, missions): (u64, u64),
    path: &str,
) -> Result<(), Failure> {
    let Fleet::File { input, .. } = fleet else {
        return Err(Failure::option(
            "brief",
            "is about a mission file: give --mission FILE",
        ));
    };
    if missions == 0 {
        return Err(Failure::option("missions", "give at least 1 for a brief"));
    }
    // A page that cannot be written is reported before the flights.
    write_file(Path::new(path), b"")?;
    let workers = arguments.workers()?;
    let for_a_launch = (missions / 5).max(LEAST_FOR_A_LAUNCH).min(missions);
    let mut asked = vec![
        (Variation::AsPlanned, missions),
        (Variation::HourLess, missions),
        (Variation::StrongerCurrent, missions),
    ];
    asked.extend(LAUNCHES_MIN.map(|minutes| (Variation::Launched(60.0 * minutes), for_a_launch)));
    let flights: u64 = asked.iter().map(|(_, count)| count).sum();
    note(&format!(
        "{flights} flights: {missions} as planned, and as many each with one hour less and in a stronger current; {for_a_launch} at each other launch"
    ));
    let flights = Flights::fly(fleet, input, &workers, &asked, first)?;
    let brief = Brief::of(&flights, &fleet.origin(), input.file.name());
    write_file(Path::new(path), page::html(&brief).as_bytes())?;
    match arguments.json() {
        true => print_json(&brief.json())?,
        false => print(&brief.text())?,
    }
    note(&format!("open {path}"));
    Ok(())
}
