//! A leg before its path is planned.

use auv_types::{Point3, Vector3};

/// A leg before its path is planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegOutline<'a> {
    /// The polyline the vehicle follows, ends included.
    pub guide: &'a [Point3<f64>],
    /// Its length, metres.
    pub length_m: f64,
    /// When the vehicle departs, mission time in seconds.
    pub departure_s: f64,
    /// How long the work at the end takes, seconds. A vehicle that cannot hover circles for it.
    pub stay_s: f64,
    /// Where the vehicle is and which way it goes when the leg begins; `None`: at the guide's first point,
    /// free to leave in any direction.
    pub from: Option<UnderWay>,
    /// How it must arrive (`None`: in any direction).
    pub arrives: Option<Arrival>,
    /// Speed through the water on the way, m/s (`None`: cruising speed).
    pub speed_mps: Option<f64>,
}

/// A direction in which a leg must arrive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// A level unit vector.
    pub direction: Vector3<f64>,
    /// How much of its end leads straight in this direction at least, metres.
    pub lead_m: f64,
}

/// Place and velocity of a vehicle that is under way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnderWay {
    /// Where it is, metres.
    pub place: Point3<f64>,
    /// Its velocity, m/s.
    pub velocity: Vector3<f64>,
}

impl<'a> LegOutline<'a> {
    /// Along a polyline without a stay.
    #[must_use]
    pub fn straight(guide: &'a [Point3<f64>], departure_s: f64) -> Self {
        let lengths = guide.windows(2).map(|pair| (pair[1] - pair[0]).norm());
        Self {
            guide,
            length_m: lengths.fold(0.0, |sum, length_m| sum + length_m),
            departure_s,
            stay_s: 0.0,
            from: None,
            arrives: None,
            speed_mps: None,
        }
    }
}
