//! What stays the same while detours are searched.

use crate::taut::regions::GrownRegions;
use crate::taut::work::WorkRate;
use auv_planning::departure::DepartureManoeuvre;
use auv_planning::{Deadline, PathProblem};

/// Everything that a search for detours is given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SearchContext<'a> {
    pub(crate) problem: &'a PathProblem<'a>,
    pub(crate) regions: &'a GrownRegions,
    pub(crate) departure: &'a DepartureManoeuvre,
    pub(crate) rate: WorkRate,
    pub(crate) deadline: Deadline<'a>,
}
