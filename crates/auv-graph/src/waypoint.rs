//! What a network is made of: waypoints, and edges with their tasks.

use auv_types::Point3;

/// A place that the vehicle may visit.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Waypoint {
    /// Position in metres (NED).
    pub position: Point3<f64>,
    /// A name for tables and pictures; may be empty.
    pub name: String,
}

impl Waypoint {
    /// A waypoint with a name.
    #[must_use]
    pub fn named(name: impl Into<String>, position: Point3<f64>) -> Self {
        Self {
            position,
            name: name.into(),
        }
    }

    /// A waypoint without a name.
    #[must_use]
    pub const fn at(position: Point3<f64>) -> Self {
        Self {
            position,
            name: String::new(),
        }
    }
}

/// The task on an edge (Eq. 1).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Task {
    /// Priority rho, above 0; 0 for a transit.
    pub priority: f64,
    /// Risk xi in percent points, above 0.
    pub risk: f64,
    /// Completion time delta in seconds, spent at the leg's target.
    pub completion_time_s: f64,
}

impl Task {
    /// No task: no weight and no time.
    pub const TRANSIT: Self = Self {
        priority: 0.0,
        risk: 1.0,
        completion_time_s: 0.0,
    };

    /// The weight of the task, `w = rho / xi` (Eq. 9).
    #[must_use]
    pub fn weight(&self) -> f64 {
        self.priority / self.risk
    }
}

/// A connection between two waypoints with its task.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Edge {
    /// Index of the first waypoint.
    pub from: u32,
    /// Index of the second waypoint.
    pub to: u32,
    /// Whether it can be passed from `from` to `to` only.
    pub directed: bool,
    /// The task done when it is passed, in either direction.
    pub task: Task,
    /// Length in metres, if it is not that of the straight line (Eq. 6): for instance around an island.
    pub distance_m: Option<f64>,
}

impl Edge {
    /// An edge that can be passed from `from` to `to` only.
    #[must_use]
    pub const fn directed(from: u32, to: u32, task: Task) -> Self {
        Self {
            from,
            to,
            directed: true,
            task,
            distance_m: None,
        }
    }

    /// An edge that can be passed both ways; its task is done once.
    #[must_use]
    pub const fn undirected(from: u32, to: u32, task: Task) -> Self {
        Self {
            from,
            to,
            directed: false,
            task,
            distance_m: None,
        }
    }
}
