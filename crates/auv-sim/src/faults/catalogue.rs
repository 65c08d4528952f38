//! The list of faults, each in four intensities with the most severe response allowed.

use std::fmt;

/// The response to a fault, from the mildest to the most severe.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultResponse {
    /// C: the mission continues unchanged; refused data are counted.
    Unchanged,
    /// R: a path or route is planned again, and the vehicle docks in time.
    Replanned,
    /// F: the vehicle falls back to a safe action: home without its tasks, evasion and waiting, a late
    /// arrival, or an abort with a reason.
    FellBack,
    /// E: a typed error before the mission starts.
    Refused,
}

impl FaultResponse {
    /// Its letter in tables.
    #[must_use]
    pub const fn letter(self) -> char {
        match self {
            Self::Unchanged => 'C',
            Self::Replanned => 'R',
            Self::FellBack => 'F',
            Self::Refused => 'E',
        }
    }
}

/// The severity of a fault, 1 to 4; [`Fault::degrees`] describes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Intensity(u8);

impl Intensity {
    /// All four intensities.
    pub const ALL: [Self; 4] = [Self(1), Self(2), Self(3), Self(4)];

    /// The intensity of a degree from 1 to 4; `None` for any other degree.
    #[must_use]
    pub const fn new(degree: u8) -> Option<Self> {
        if degree >= 1 && degree <= 4 {
            Some(Self(degree))
        } else {
            None
        }
    }

    /// The degree, 1 to 4.
    #[must_use]
    pub const fn degree(self) -> u8 {
        self.0
    }

    /// The index into a table of four, 0 to 3.
    pub(crate) const fn index(self) -> usize {
        self.0 as usize - 1
    }

    /// The value for this intensity.
    pub(crate) fn of<T: Copy>(self, values: [T; 4]) -> T {
        values[self.index()]
    }
}

impl fmt::Display for Intensity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

macro_rules! catalogue {
    ($($number:literal $fault:ident $name:literal $what:literal
        [$first:literal $second:literal $third:literal $fourth:literal]
        $a:ident $b:ident $c:ident $d:ident;)*) => {
        /// A fault that can be injected into a simulated mission.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        #[non_exhaustive]
        pub enum Fault {
            $(#[doc = $what] $fault,)*
        }

        impl Fault {
            /// All faults in order of their numbers; the last is the canary.
            const LIST: &'static [Self] = &[$(Self::$fault,)*];

            /// Its number in the list of faults; 0 for the canary.
            #[must_use]
            pub const fn number(self) -> u8 {
                match self { $(Self::$fault => $number,)* }
            }

            /// Its name on the command line.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$fault => $name,)* }
            }

            /// A description of the fault.
            #[must_use]
            pub const fn what(self) -> &'static str {
                match self { $(Self::$fault => $what,)* }
            }

            /// Descriptions of the four intensities.
            #[must_use]
            pub const fn degrees(self) -> [&'static str; 4] {
                match self { $(Self::$fault => [$first, $second, $third, $fourth],)* }
            }

            /// The most severe response allowed; milder ones are allowed too.
            #[must_use]
            pub fn expected(self, intensity: Intensity) -> FaultResponse {
                use FaultResponse::{FellBack as F, Refused as E, Replanned as R};
                intensity.of(match self { $(Self::$fault => [$a, $b, $c, $d],)* })
            }
        }
    };
}

catalogue! {
    1 EdgeValues "edge-values" "edge times or lengths that are negative or not numbers"
        ["1 edge" "3 edges" "10 edges" "50 edges"] E E E E;
    2 EdgeList "edge-list" "duplicate edges, self-loops, unknown endpoints"
        ["1 edge" "3 edges" "10 edges" "50 edges"] E E E E;
    3 Disconnected "disconnected" "no route leads to the destination"
        ["no edge to the destination" "no edge from the start" "no edges" "two halves"] E E E E;
    4 ShortBudget "short-budget" "a budget below the time of the quickest route home"
        ["by one ulp" "by 1 s" "no time" "negative or not a number"] E E E E;
    5 TinyNetwork "tiny-network" "networks that are almost empty"
        ["start is destination" "one edge, no task" "one node" "no nodes"] F F F E;
    6 DamagedFile "damaged-file" "damaged instance files"
        ["cut short" "unknown key, type or version" "not UTF-8" "nested 10,000 deep, 10^9 nodes, 17 MiB"]
        E E E E;
    7 BuriedPlace "buried-place" "positions the vehicle cannot be at"
        ["start in an obstacle" "waypoint out of the box" "waypoint below the bed" "dock on land"]
        E E E E;
    8 Enclosed "enclosed" "obstacles block or enclose the vehicle"
        ["one on the waypoint, 900 s" "a wall across the leg, 900 s" "all round, 5 min" "all round, permanently"]
        F F F F;
    9 Sudden "sudden-obstacle" "an uncharted obstacle of 10 m radius appears ahead"
        ["160 m ahead" "80 m" "40 m" "20 m"] R R R R;
    10 Ghosts "ghosts" "false echoes"
        ["1 scan ahead" "3 scans ahead" "50 per scan, 2 min" "50 per scan, 10 min"] R R R R;
    11 Dropout "sonar-dropout" "no scans"
        ["1 scan" "1 min" "10 min" "permanently"] R R F F;
    12 StaleScans "stale-scans" "stale scans for 10 min"
        ["each twice" "50 s late" "out of order" "frozen"] R R R F;
    13 BadEchoes "bad-echoes" "echoes that are not numbers, 10^9 m off or without covariance, for 10 min"
        ["1 per scan" "a quarter" "half" "all"] R R R F;
    14 Storm "sonar-storm" "too many echoes"
        ["100, 1 scan" "1,000, 1 scan" "10,000, 1 scan" "10,000 per scan, 1 min"] R R R R;
    15 Current "strong-current" "an unforecast current moves the vehicle for 10 min"
        ["0.3 V across" "0.6 V against" "1.2 V against" "1.2 V, reversing every 2 min"] R R F F;
    16 LegTime "leg-time" "the vehicle is faster or slower than planned for 10 min"
        ["twice the speed" "half the speed" "a quarter" "a tenth"] R R F F;
    17 Panic "planner-panic" "planners panic"
        ["once" "twice" "at every third call" "always"] R R F F;
    18 Overrun "planner-overrun" "planners answer late"
        ["in 5 s" "at 2x the deadline, once" "at 10x, five times" "never"] R R F F;
    19 Rubbish "planner-rubbish" "invalid plans claimed to be valid"
        ["a tenth of calls" "a third" "20 calls" "all"] R R F F;
    20 Livelock "planner-livelock" "planning without progress"
        ["alternating plans" "every second refused" "20 refused" "all refused"] R R F F;
    21 Clock "clock" "the clock is wrong"
        ["1 us back, every minute" "1 h ahead" "stopped" "1 h back"] R F F F;
    22 Navigation "navigation" "the fix is wrong"
        ["10 m off, 1 min" "50 m off, 1 min" "500 m off, 20 s" "lost permanently"] R R F F;
    23 Energy "energy-drop" "part of the remaining energy is lost"
        ["10 %" "25 %" "50 %" "75 %"] R R F F;
    24 Restart "restart" "the software crashes and restarts"
        ["immediately" "after 1 min, without tracks" "checkpoint damaged" "checkpoint of another mission"]
        R R R R;
    0 Canary "canary" "an unverified plan goes into force; must be reported as a failure"
        ["" "" "" ""] R R R R;
}

impl Fault {
    /// Faults 1 to 24; the canary is left out.
    #[must_use]
    pub fn all() -> &'static [Self] {
        &Self::LIST[..24]
    }

    /// The faults in flight, 8 to 24. Any two of them form a pair (fault 25).
    #[must_use]
    pub fn in_flight() -> &'static [Self] {
        &Self::LIST[7..24]
    }

    /// Whether the fault occurs in flight rather than when a mission is loaded.
    #[must_use]
    pub fn is_in_flight(self) -> bool {
        self.number() >= 8 || self == Self::Canary
    }

    /// All 136 pairs of faults in flight.
    #[must_use]
    pub fn pairs() -> Vec<[Self; 2]> {
        let list = Self::in_flight();
        let later = |(i, &a)| list[i + 1..].iter().map(move |&b| [a, b]);
        list.iter().enumerate().flat_map(later).collect()
    }

    /// The fault with a name or number, the canary included.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        let number = name.parse::<u8>().ok();
        Self::LIST
            .iter()
            .find(|fault| fault.name() == name || Some(fault.number()) == number)
            .copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_complete() {
        let numbers: Vec<u8> = Fault::all().iter().map(|fault| fault.number()).collect();
        assert_eq!(numbers, (1..=24).collect::<Vec<_>>());
        assert_eq!((Fault::in_flight().len(), Fault::pairs().len()), (17, 136));
        assert!(Fault::in_flight().iter().all(|fault| fault.is_in_flight()));
        for fault in Fault::LIST {
            assert_eq!(Fault::named(fault.name()), Some(*fault));
        }
    }
}
