//! Which runs a campaign consists of, in order.

use auv_examples::Failure;
use auv_sim::faults::{Fault, Intensity};

/// The runs of a campaign: every mission once, or once for each kind of fault.
pub(crate) struct RunList {
    first: u64,
    missions: u64,
    /// Empty without faults.
    kinds: Vec<FaultKind>,
}

/// The faults injected into a run.
#[derive(Clone)]
pub(crate) struct FaultKind {
    /// One fault, or two with `--pairs`.
    pub(crate) faults: Vec<Fault>,
    pub(crate) intensity: Intensity,
}

/// One run of the list.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(crate) mission: u64,
    /// `None` without faults.
    pub(crate) kind: Option<&'a FaultKind>,
}

impl FaultKind {
    pub(crate) fn names(&self) -> Vec<&'static str> {
        self.faults.iter().map(|fault| fault.name()).collect()
    }
}

impl RunList {
    /// The missions `first` to `first + missions - 1`; with `faults` each of them at each intensity.
    ///
    /// # Errors
    /// Unknown faults or intensities, pairs of fewer than two faults, numbers above 2^64.
    pub(crate) fn new(
        (first, missions): (u64, u64),
        faults: Option<&str>,
        intensity: &str,
        pairs: bool,
    ) -> Result<Self, Failure> {
        let mut kinds = Vec::new();
        if let Some(faults) = faults {
            let intensities = intensities(intensity)?;
            for faults in plans(faults, pairs)? {
                kinds.extend(intensities.iter().map(|&intensity| FaultKind {
                    faults: faults.clone(),
                    intensity,
                }));
            }
        }
        let fits = first.checked_add(missions).is_some()
            && missions.checked_mul(kinds.len().max(1) as u64).is_some();
        if !fits {
            let text = format!("is {missions}, after mission {first}: give fewer, below 2^64 runs");
            return Err(Failure::option("missions", text));
        }
        Ok(Self {
            first,
            missions,
            kinds,
        })
    }

    /// The number of runs.
    pub(crate) fn total(&self) -> u64 {
        self.missions * self.kinds.len().max(1) as u64
    }

    /// Run `i`: all missions with the first kind of faults, then all with the second.
    pub(crate) fn run(&self, i: u64) -> Run<'_> {
        let missions = self.missions.max(1);
        Run {
            mission: self.first + i % missions,
            kind: self.kinds.get((i / missions) as usize),
        }
    }

    pub(crate) const fn first(&self) -> u64 {
        self.first
    }

    pub(crate) const fn missions(&self) -> u64 {
        self.missions
    }

    pub(crate) fn has_faults(&self) -> bool {
        !self.kinds.is_empty()
    }
}

/// The faults of each kind of run: one each, or two each with `pairs`.
fn plans(list: &str, pairs: bool) -> Result<Vec<Vec<Fault>>, Failure> {
    let mut faults = Vec::new();
    for name in list.split(',') {
        match name {
            "all" => faults.extend_from_slice(Fault::all()),
            name => faults.push(Fault::named(name).ok_or_else(|| {
                let known: Vec<&str> = Fault::all().iter().map(|fault| fault.name()).collect();
                let known = known.join(", ");
                Failure::option("faults", format!("names `{name}`; there are all, {known}"))
            })?),
        }
    }
    if !pairs {
        return Ok(faults.into_iter().map(|fault| vec![fault]).collect());
    }
    let pairs = Fault::pairs().into_iter();
    let chosen = pairs.filter(|pair| pair.iter().all(|fault| faults.contains(fault)));
    let plans: Vec<Vec<Fault>> = chosen.map(Vec::from).collect();
    if plans.is_empty() {
        return Err(Failure::option(
            "pairs",
            "give at least two faults in flight (8 to 24)",
        ));
    }
    Ok(plans)
}

fn intensities(list: &str) -> Result<Vec<Intensity>, Failure> {
    list.split(',')
        .map(|word| {
            let degree = word.trim().parse().ok().and_then(Intensity::new);
            degree.ok_or_else(|| Failure::option("intensity", format!("is `{word}`; give 1 to 4")))
        })
        .collect()
}
