//! A command line declared as data.

use std::fmt::Write;

/// What a command is called, does and takes.
#[derive(Clone, Copy, Debug)]
pub struct CommandLine {
    /// The example's name.
    pub name: &'static str,
    /// What it does, in a sentence or two.
    pub about: &'static str,
    /// Its operands (arguments without `--`), in order.
    pub operands: &'static [Operand],
    /// Its own options; the common ones are added.
    pub options: &'static [Opt],
    /// Printed after the options: examples of use, output, files. May be empty.
    pub notes: &'static str,
}

/// A word on the command line without `--`.
#[derive(Clone, Copy, Debug)]
pub struct Operand {
    /// Its name in the help, in capitals.
    pub name: &'static str,
    /// Whether it may be left out.
    pub optional: bool,
    /// What it is.
    pub help: &'static str,
}

/// An option, `--name` or `--name VALUE`.
#[derive(Clone, Copy, Debug)]
pub struct Opt {
    /// Its name without `--`.
    pub name: &'static str,
    /// What the help calls its value; empty for a flag.
    pub value: &'static str,
    /// The only values allowed; empty: any.
    pub choices: &'static [&'static str],
    /// The value taken when it is not given; empty: none.
    pub default: &'static str,
    /// What it does, with the unit.
    pub help: &'static str,
}

impl Operand {
    /// A word that must be given.
    #[must_use]
    pub const fn required(name: &'static str, help: &'static str) -> Self {
        Self {
            name,
            optional: false,
            help,
        }
    }

    /// A word that may be left out.
    #[must_use]
    pub const fn optional(name: &'static str, help: &'static str) -> Self {
        Self {
            name,
            optional: true,
            help,
        }
    }
}

impl Opt {
    /// An option without a value.
    #[must_use]
    pub const fn flag(name: &'static str, help: &'static str) -> Self {
        Self::value(name, "", "", help)
    }

    /// An option with a value; with an empty default say in the help what happens without it.
    #[must_use]
    pub const fn value(
        name: &'static str,
        value: &'static str,
        default: &'static str,
        help: &'static str,
    ) -> Self {
        Self {
            name,
            value,
            choices: &[],
            default,
            help,
        }
    }

    /// An option whose value is one of a few words.
    #[must_use]
    pub const fn choice(
        name: &'static str,
        choices: &'static [&'static str],
        default: &'static str,
        help: &'static str,
    ) -> Self {
        Self {
            name,
            value: "NAME",
            choices,
            default,
            help,
        }
    }
}

/// What every command takes.
pub(crate) const COMMON: [Opt; 4] = [
    Opt::value("seed", "N", "0", "seed of everything random, 0 to 2^64 - 1"),
    Opt::value(
        "threads",
        "N",
        "",
        "threads to compute on (default: all cores)",
    ),
    Opt::flag("json", "print exactly one JSON object instead of text"),
    Opt::flag("help", "print this and exit"),
];

impl CommandLine {
    /// The command's own options, then the common ones.
    pub fn all_options(&self) -> impl Iterator<Item = &Opt> {
        self.options.iter().chain(&COMMON)
    }

    /// The text of `--help`.
    #[must_use]
    pub fn help(&self) -> String {
        let mut text = format!("{}\n\nUsage: {}", self.about, self.name);
        for operand in self.operands {
            let (open, close) = if operand.optional {
                ("[", "]")
            } else {
                ("", "")
            };
            let _ = write!(text, " {open}{}{close}", operand.name);
        }
        text.push_str(" [OPTIONS]\n");
        let operands: Vec<_> = self
            .operands
            .iter()
            .map(|operand| (operand.name.to_owned(), operand.help.to_owned()))
            .collect();
        let options: Vec<_> = self
            .all_options()
            .map(|option| {
                (
                    format!("--{} {}", option.name, option.value),
                    option.explained(),
                )
            })
            .collect();
        let width = operands
            .iter()
            .chain(&options)
            .map(|(left, _)| left.trim_end().len());
        let width = width.max().unwrap_or(0);
        for (heading, lines) in [("", operands), ("Options:\n", options)] {
            if lines.is_empty() {
                continue;
            }
            let _ = write!(text, "\n{heading}");
            for (left, right) in lines {
                let _ = writeln!(text, "  {:width$}  {right}", left.trim_end());
            }
        }
        text.push_str("\nExit codes: 0 an answer was printed, 2 bad input, 1 internal error.\n");
        if !self.notes.is_empty() {
            let _ = writeln!(text, "\n{}", self.notes.trim_end());
        }
        text
    }
}

impl Opt {
    /// The help with choices and default.
    fn explained(&self) -> String {
        let mut text = self.help.to_owned();
        if !self.choices.is_empty() {
            let _ = write!(text, ": {}", self.choices.join(", "));
        }
        if !self.default.is_empty() {
            let _ = write!(text, " (default: {})", self.default);
        }
        text
    }
}
