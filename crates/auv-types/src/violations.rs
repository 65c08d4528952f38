//! The list of everything wrong with an input.
//!
//! These are errors of an input. The `violation` of a plan is something else: a number that says how
//! far the plan is from feasible (for paths in metres, for routes a share of the time available).

use std::fmt;

/// One error in an input: where it is, what is wrong, and what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Violation {
    /// The field, edge, node or line: `edges[17].risk`, `population`.
    pub place: String,
    /// What is wrong, with the offending value, and what to do: `is 0; give a value above 0`.
    pub message: String,
}

/// All errors found in one input. The first [`Violations::CAPACITY`] are kept with their texts, the
/// rest are counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Violations {
    list: Vec<Violation>,
    total: usize,
}

impl Violations {
    /// How many violations are kept with their texts.
    pub const CAPACITY: usize = 100;

    /// An empty list.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one violation.
    pub fn push(&mut self, place: impl Into<String>, message: impl Into<String>) {
        self.total += 1;
        if self.list.len() < Self::CAPACITY {
            self.list.push(Violation {
                place: place.into(),
                message: shortened(message.into()),
            });
        }
    }

    /// Adds a violation unless `ok`. The message is built only when needed.
    pub fn require(&mut self, ok: bool, place: &str, message: impl FnOnce() -> String) {
        if !ok {
            self.push(place, message());
        }
    }

    /// Adds a violation unless `value` is finite and above zero.
    pub fn require_positive(&mut self, value: f64, place: &str) {
        self.require(value.is_finite() && value > 0.0, place, || {
            format!("is {value}; give a finite value above 0")
        });
    }

    /// Adds a violation unless `value` is finite and not negative.
    pub fn require_not_negative(&mut self, value: f64, place: &str) {
        self.require(value.is_finite() && value >= 0.0, place, || {
            format!("is {value}; give a finite value of at least 0")
        });
    }

    /// Adds all violations of a part, with `prefix` before their places.
    pub fn absorb(&mut self, prefix: &str, part: Self) {
        self.total += part.total - part.list.len();
        for violation in part.list {
            self.push(format!("{prefix}{}", violation.place), violation.message);
        }
    }

    /// The same violations with their places renamed.
    #[must_use]
    pub fn renamed(mut self, name: impl Fn(&str) -> String) -> Self {
        for violation in &mut self.list {
            violation.place = name(&violation.place);
        }
        self
    }

    /// The kept violations, in the order found.
    #[must_use]
    pub fn list(&self) -> &[Violation] {
        &self.list
    }

    /// How many violations were found, kept or not.
    #[must_use]
    pub fn total(&self) -> usize {
        self.total
    }

    /// Whether nothing is wrong.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.total == 0
    }

    /// `Ok` when nothing is wrong, else the whole list as the error.
    ///
    /// # Errors
    /// The list itself, when it is not empty.
    pub fn into_result(self) -> Result<(), Self> {
        if self.is_empty() { Ok(()) } else { Err(self) }
    }
}

/// Numbers with more digits are written with an exponent.
const MOST_DIGITS: usize = 20;

/// The text with numbers of hundreds of digits, as 1e300 is written in full, with an exponent instead.
fn shortened(text: String) -> String {
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let is_long = |run: &str| run.len() > MOST_DIGITS && run.parse::<f64>().is_ok();
    if !text.split(|c| !is_part(c)).any(is_long) {
        return text;
    }
    let mut short = String::new();
    let mut rest = text.as_str();
    while let Some(from) = rest.find(is_part) {
        let run = &rest[from..];
        let run = &run[..run.find(|c| !is_part(c)).unwrap_or(run.len())];
        short.push_str(&rest[..from]);
        // A full stop may follow the number.
        let number = run.trim_end_matches('.');
        match number.parse::<f64>() {
            Ok(value) if number.len() > MOST_DIGITS => short.push_str(&format!("{value:e}")),
            _ => short.push_str(number),
        }
        short.push_str(&run[number.len()..]);
        rest = &rest[from + run.len()..];
    }
    short + rest
}

/// `{}` gives one line, `{:#}` a line for each violation.
impl fmt::Display for Violations {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let between = if f.alternate() { "\n" } else { "; " };
        for (i, violation) in self.list.iter().enumerate() {
            let separator = if i == 0 { "" } else { between };
            write!(f, "{separator}{} {}", violation.place, violation.message)?;
        }
        match self.total - self.list.len() {
            0 => Ok(()),
            more => write!(f, "{between}and {more} more"),
        }
    }
}

impl std::error::Error for Violations {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_hundreds_of_digits_are_written_with_an_exponent() {
        let mut wrong = Violations::new();
        wrong.require_positive(-1e300, "budget_s");
        wrong.push("top_m", format!("is {}, not {}.", 2.5e-200, 1e6));
        assert_eq!(
            wrong.to_string(),
            "budget_s is -1e300; give a finite value above 0; top_m is 2.5e-200, not 1000000."
        );
    }

    #[test]
    fn keeps_a_hundred_and_counts_the_rest() {
        let mut all = Violations::new();
        for i in 0..250 {
            all.push(format!("edges[{i}]"), "is a self-loop; remove it");
        }
        assert_eq!((all.list().len(), all.total()), (100, 250));
        assert!(all.to_string().ends_with("; and 150 more"));
        assert_eq!(format!("{all:#}").lines().count(), 101, "one a line");
        let mut whole = Violations::new();
        whole.absorb("network.", all);
        assert_eq!(whole.total(), 250);
        assert!(whole.list()[0].place.starts_with("network.edges[0]"));
    }
}
