//! Parts of the routes: those that keep some decisions.

/// What the routes of a part have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Decision {
    Visit(usize),
    Skip(usize),
    Use(u32),
    Avoid(u32),
}

/// What is neither in a fractional route nor out of it, and how much it is in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Fractional {
    Node(usize, f64),
    Link(u32, f64),
}

impl Fractional {
    /// Both decisions: the one that is nearer to the fractional route first.
    pub(crate) fn decisions(self) -> [Decision; 2] {
        match self {
            Self::Node(v, value) if value > 0.5 => [Decision::Visit(v), Decision::Skip(v)],
            Self::Node(v, _) => [Decision::Skip(v), Decision::Visit(v)],
            Self::Link(link, _) => [Decision::Use(link), Decision::Avoid(link)],
        }
    }
}
