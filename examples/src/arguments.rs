//! What the user gave on the command line.

use crate::{CommandLine, Failure, Opt};
use auv_planning::Budget;
use auv_population::Workers;
use auv_types::Seed;
use lexopt::Arg;
use std::ffi::OsString;
use std::str::FromStr;
use std::time::Duration;

/// What the user gave, checked against the command's declaration.
#[derive(Clone, Debug)]
pub struct Arguments {
    command: CommandLine,
    operands: Vec<String>,
    options: Vec<(&'static str, String)>,
}

impl Arguments {
    /// Parses the words after the program's name.
    ///
    /// # Errors
    /// Unknown or repeated options, missing or superfluous values and operands, text that is not
    /// UTF-8.
    pub fn parse(
        command: &CommandLine,
        words: impl IntoIterator<Item = OsString>,
    ) -> Result<Self, Failure> {
        let mut parsed = Self {
            command: *command,
            operands: Vec::new(),
            options: Vec::new(),
        };
        parsed
            .read(lexopt::Parser::from_args(words))
            .map_err(|error| Failure::BadInput(format!("{error}; see --help")))?;
        if parsed.flag("help") {
            return Ok(parsed);
        }
        match command.operands.get(parsed.operands.len()) {
            Some(missing) if !missing.optional => Err(Failure::BadInput(format!(
                "{} is missing: give {}; see --help",
                missing.name, missing.help
            ))),
            _ => Ok(parsed),
        }
    }

    fn read(&mut self, mut parser: lexopt::Parser) -> Result<(), lexopt::Error> {
        while let Some(argument) = parser.next()? {
            let name = match argument {
                Arg::Value(word) => {
                    if self.operands.len() == self.command.operands.len() {
                        return Err(Arg::Value(word).unexpected());
                    }
                    self.operands.push(text_of(word)?);
                    continue;
                }
                Arg::Short('h') => "help",
                Arg::Short(_) => return Err(argument.unexpected()),
                Arg::Long(name) => name,
            };
            let Some(option) = self
                .command
                .all_options()
                .find(|option| option.name == name)
            else {
                return Err(Arg::Long(name).unexpected());
            };
            let option = *option;
            let value = if option.value.is_empty() {
                String::new()
            } else {
                text_of(parser.value()?)?
            };
            self.check(&option, &value)?;
            self.options.push((option.name, value));
        }
        Ok(())
    }

    fn check(&self, option: &Opt, value: &str) -> Result<(), lexopt::Error> {
        let name = option.name;
        if self.options.iter().any(|(given, _)| *given == name) && !option.value.is_empty() {
            return Err(format!("--{name} is given twice").into());
        }
        if !option.choices.is_empty() && !option.choices.contains(&value) {
            let choices = option.choices.join(", ");
            return Err(format!("--{name} is `{value}`: give one of {choices}").into());
        }
        Ok(())
    }

    /// An operand by its name in the declaration.
    #[must_use]
    pub fn operand(&self, name: &str) -> Option<&str> {
        let at = self
            .command
            .operands
            .iter()
            .position(|operand| operand.name == name);
        debug_assert!(at.is_some(), "operand {name} is not declared");
        self.operands.get(at?).map(String::as_str)
    }

    /// Whether an option was given.
    #[must_use]
    pub fn flag(&self, name: &str) -> bool {
        debug_assert!(self.declared(name).is_some(), "--{name} is not declared");
        self.options.iter().any(|(given, _)| *given == name)
    }

    /// An option's value: as given, else its default, if it has one.
    #[must_use]
    pub fn text(&self, name: &str) -> Option<&str> {
        debug_assert!(self.declared(name).is_some(), "--{name} is not declared");
        let given = self.options.iter().find(|(given, _)| *given == name);
        given.map(|(_, value)| value.as_str()).or_else(|| {
            self.declared(name)
                .map(|option| option.default)
                .filter(|default| !default.is_empty())
        })
    }

    /// An option's value as a number (or anything that parses); floats must be finite.
    ///
    /// # Errors
    /// A value that does not parse, or is not finite.
    pub fn number<T: FromStr>(&self, name: &str) -> Result<Option<T>, Failure> {
        let Some(text) = self.text(name) else {
            return Ok(None);
        };
        let finite = text.parse::<f64>().is_ok_and(f64::is_finite);
        match text.parse() {
            Ok(number) if finite => Ok(Some(number)),
            _ => {
                let kind = match std::any::type_name::<T>() {
                    "f64" | "f32" => "finite number",
                    "u64" => "whole number from 0 to 2^64 - 1",
                    _ => "whole number of at least 0",
                };
                Err(Failure::option(
                    name,
                    format!("`{text}` is not a {kind}; see --help"),
                ))
            }
        }
    }

    /// `--seed`.
    ///
    /// # Errors
    /// A value that is not a whole number below 2^64.
    pub fn seed(&self) -> Result<Seed, Failure> {
        Ok(Seed(self.number("seed")?.unwrap_or(0)))
    }

    /// `--evaluations` and `--budget-ms`; 100 ms where neither is given and the call should end soon.
    ///
    /// # Errors
    /// Values that are not numbers of evaluations or milliseconds.
    pub fn budget(&self, ends_soon: bool) -> Result<Budget, Failure> {
        let evaluations = self.number("evaluations")?;
        let wall_time = match self.milliseconds("budget-ms")? {
            Some(time) => Some(time),
            None => (ends_soon && evaluations.is_none()).then(|| Duration::from_millis(100)),
        };
        Ok(Budget {
            evaluations,
            wall_time,
            target_cost: None,
        })
    }

    /// `--bound-ms`, if given.
    ///
    /// # Errors
    /// A value that is not a number of milliseconds.
    pub fn bound_time(&self) -> Result<Option<Duration>, Failure> {
        self.milliseconds("bound-ms")
    }

    fn milliseconds(&self, option: &'static str) -> Result<Option<Duration>, Failure> {
        let Some(ms) = self.number::<f64>(option)? else {
            return Ok(None);
        };
        Duration::try_from_secs_f64(ms / 1e3)
            .map(Some)
            .map_err(|_| {
                let what = format!("is {ms:?}; give milliseconds, at least 0 and at most 1e20");
                Failure::option(option, what)
            })
    }

    /// `--threads`, all cores by default.
    ///
    /// # Errors
    /// A value that is not from 1 to 1024.
    pub fn threads(&self) -> Result<usize, Failure> {
        match self.number("threads")? {
            Some(threads) if (1..=1024).contains(&threads) => Ok(threads),
            Some(threads) => Err(Failure::option(
                "threads",
                format!("is {threads}; give 1 to 1024"),
            )),
            None => Ok(std::thread::available_parallelism().map_or(1, usize::from)),
        }
    }

    /// The thread pool for [`Arguments::threads`].
    ///
    /// # Errors
    /// As [`Arguments::threads`], or the system gives no threads.
    pub fn workers(&self) -> Result<Workers, Failure> {
        Workers::new(self.threads()?).map_err(|error| Failure::option("threads", error))
    }

    /// Whether `--json` was given.
    #[must_use]
    pub fn json(&self) -> bool {
        self.flag("json")
    }

    fn declared(&self, name: &str) -> Option<&Opt> {
        self.command
            .all_options()
            .find(|option| option.name == name)
    }
}

fn text_of(word: OsString) -> Result<String, lexopt::Error> {
    word.into_string()
        .map_err(|word| lexopt::Error::Custom(format!("{word:?} is not UTF-8").into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Operand;

    const COMMAND: CommandLine = CommandLine {
        name: "test",
        about: "Tests.",
        operands: &[
            Operand::required("FILE", "a file"),
            Operand::optional("MORE", "another"),
        ],
        options: &[
            Opt::value("speed", "M/S", "3", "speed, m/s"),
            Opt::choice("planner", &["ga", "ica"], "ga", "which planner"),
        ],
        notes: "",
    };

    fn parse(line: &str) -> Result<Arguments, Failure> {
        Arguments::parse(&COMMAND, line.split_whitespace().map(OsString::from))
    }

    fn refusal(line: &str) -> String {
        let failure = parse(line).unwrap_err();
        assert_eq!(failure.exit_code(), 2);
        failure.to_string()
    }

    #[test]
    fn gives_values_and_defaults() {
        let arguments = parse("a.json --planner=ica --seed 7 b.json --json").unwrap();
        assert_eq!(arguments.operand("FILE"), Some("a.json"));
        assert_eq!(arguments.operand("MORE"), Some("b.json"));
        assert_eq!(arguments.text("planner"), Some("ica"));
        assert_eq!(arguments.number("speed").unwrap(), Some(3.0));
        assert!(arguments.json() && arguments.seed().unwrap() == Seed(7));
        assert!(arguments.threads().unwrap() >= 1);
        assert!(parse("a").unwrap().operand("MORE").is_none());
    }

    #[test]
    fn names_what_is_wrong() {
        assert!(refusal("").contains("FILE"));
        assert!(refusal("a b c").contains('c'));
        assert!(refusal("a --warp 9").contains("--warp"));
        assert!(refusal("a --planner dijkstra").contains("ga, ica"));
        assert!(refusal("a --speed 1 --speed 2").contains("twice"));
        assert!(refusal("a --speed").contains("speed"));
        assert!(refusal("a --json=1").contains("json"));
        let number = |line: &str, name| parse(line).unwrap().number::<f64>(name).unwrap_err();
        assert!(number("a --speed NaN", "speed").to_string().contains("NaN"));
        assert!(parse("a --seed -1").unwrap().seed().is_err());
        assert!(parse("a --threads 0").unwrap().threads().is_err());
    }

    #[test]
    fn help_explains_every_option_and_needs_no_operand() {
        assert!(parse("--help").unwrap().flag("help"));
        let help = COMMAND.help();
        for option in COMMAND.all_options() {
            assert!(help.contains(&format!("--{}", option.name)) && help.contains(option.help));
        }
        assert!(help.contains("(default: 3)") && help.contains("test FILE [MORE] [OPTIONS]"));
    }
}
