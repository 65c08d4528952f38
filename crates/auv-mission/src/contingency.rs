//! What the vehicle does when the mission is aborted away from its destination.
//!
//! A vehicle that goes home by the quickest way and docks flies no contingency. The ladder is used when
//! the mission is aborted: see [`crate::AbortReason`].

use std::fmt;

/// One manoeuvre of the ladder. It is flown only along a trajectory that the vehicle can fly and that
/// is clear of all predicted regions over the look-ahead time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
#[non_exhaustive]
pub enum Contingency {
    /// Up to the surface, wherever the box begins: straight up, or on a helix. Under ice there is none: declare
    /// another, or a closed zone.
    Surface,
    /// Back to the start through the waypoints already reached: water known to be free.
    ReturnAlongTrack,
    /// Stay here, hovering or on a circle.
    Loiter {
        /// For how long, seconds: at most [`Contingency::LONGEST_S`].
        for_s: f64,
    },
}

impl Contingency {
    /// The default ladder: surface; where that is not clear, loiter for an hour.
    pub const LADDER: [Self; 2] = [Self::Surface, Self::Loiter { for_s: 3600.0 }];
    /// The longest loiter, seconds: all circles are held in memory.
    pub const LONGEST_S: f64 = 604_800.0;

    /// The stable code for logs and programs. `Display` gives a text for people, which may change.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Surface => "surface",
            Self::ReturnAlongTrack => "return_along_track",
            Self::Loiter { .. } => "loiter",
        }
    }
}

impl fmt::Display for Contingency {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Surface => "surfaced",
            Self::ReturnAlongTrack => "returned along the track",
            Self::Loiter { .. } => "loitered",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_is_the_word_that_files_use() {
        let all = [
            (Contingency::Surface, "surfaced"),
            (Contingency::ReturnAlongTrack, "returned along the track"),
            (Contingency::Loiter { for_s: 60.0 }, "loitered"),
        ];
        for (contingency, text) in all {
            assert_eq!(contingency.to_string(), text);
            #[cfg(feature = "serde")]
            {
                let file = serde_json::to_string(&contingency).unwrap();
                assert!(
                    file.contains(&format!("\"{}\"", contingency.code())),
                    "{file}"
                );
            }
        }
    }
}
