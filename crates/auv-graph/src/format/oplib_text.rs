//! The text of an OPLib file by keywords and sections, before any value is read.

use super::text::shortened;
use auv_types::Violations;

/// A line of the file, or the value after a keyword.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TextLine<'a> {
    /// Number of the line, from 1.
    pub(super) number: usize,
    pub(super) content: &'a str,
}

impl TextLine<'_> {
    /// The line as the place of an error.
    pub(super) fn place(&self) -> String {
        format!("line {}", self.number)
    }
}

/// The headers and sections of an OPLib file; `None` where the file has none of that name.
#[derive(Debug, Default)]
pub(super) struct OplibText<'a> {
    pub(super) name: Option<TextLine<'a>>,
    pub(super) kind: Option<TextLine<'a>>,
    pub(super) dimension: Option<TextLine<'a>>,
    pub(super) cost_limit: Option<TextLine<'a>>,
    pub(super) weight_type: Option<TextLine<'a>>,
    pub(super) weight_format: Option<TextLine<'a>>,
    pub(super) weights: Option<Vec<TextLine<'a>>>,
    pub(super) coordinates: Option<Vec<TextLine<'a>>>,
    pub(super) display: Option<Vec<TextLine<'a>>>,
    pub(super) scores: Option<Vec<TextLine<'a>>>,
    pub(super) depot: Option<Vec<TextLine<'a>>>,
}

/// Where a line without a keyword belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum FileSection {
    /// To no section: between the headers.
    Header,
    Weights,
    Coordinates,
    Display,
    Scores,
    Depot,
    /// To a section that is not read.
    Ignored,
}

impl<'a> OplibText<'a> {
    /// Splits the text at its keywords, up to `EOF`. Each unknown keyword is one violation, and the
    /// lines below it are skipped.
    pub(super) fn split(text: &'a str, violations: &mut Violations) -> Self {
        let mut file = Self::default();
        let mut section = FileSection::Header;
        for (number, content) in (1..).zip(text.lines()) {
            let content = content.trim();
            let line = TextLine { number, content };
            if content == "EOF" {
                break;
            }
            if content.is_empty() {
                continue;
            }
            if is_keyword(section, content) {
                section = file.keyword(line, violations);
            } else {
                file.entry(section, line, violations);
            }
        }
        file
    }

    /// Stores `KEYWORD : value` or opens a section; returns where the next lines belong.
    fn keyword(&mut self, line: TextLine<'a>, violations: &mut Violations) -> FileSection {
        let (key, value) = line.content.split_once(':').unwrap_or((line.content, ""));
        let (key, content) = (key.trim(), value.trim());
        let (section, opened) = match key {
            "EDGE_WEIGHT_SECTION" => (FileSection::Weights, &mut self.weights),
            "NODE_COORD_SECTION" => (FileSection::Coordinates, &mut self.coordinates),
            "DISPLAY_DATA_SECTION" => (FileSection::Display, &mut self.display),
            "NODE_SCORE_SECTION" => (FileSection::Scores, &mut self.scores),
            "DEPOT_SECTION" => (FileSection::Depot, &mut self.depot),
            _ => return self.header(key, TextLine { content, ..line }, violations),
        };
        opened.get_or_insert_default();
        section
    }

    fn header(
        &mut self,
        key: &str,
        value: TextLine<'a>,
        violations: &mut Violations,
    ) -> FileSection {
        let header = match key {
            "NAME" => &mut self.name,
            "TYPE" => &mut self.kind,
            "DIMENSION" => &mut self.dimension,
            "COST_LIMIT" => &mut self.cost_limit,
            "EDGE_WEIGHT_TYPE" => &mut self.weight_type,
            "EDGE_WEIGHT_FORMAT" => &mut self.weight_format,
            "COMMENT" | "DISPLAY_DATA_TYPE" | "NODE_COORD_TYPE" => return FileSection::Header,
            "TSPSOL" | "TSPSOL_SECTION" => return FileSection::Ignored,
            _ => {
                let key = shortened(key);
                let message = format!("has the unknown keyword `{key}`; remove it");
                violations.push(value.place(), message);
                return FileSection::Ignored;
            }
        };
        *header = Some(value);
        FileSection::Header
    }

    fn entry(&mut self, section: FileSection, line: TextLine<'a>, violations: &mut Violations) {
        let lines = match section {
            FileSection::Weights => &mut self.weights,
            FileSection::Coordinates => &mut self.coordinates,
            FileSection::Display => &mut self.display,
            FileSection::Scores => &mut self.scores,
            FileSection::Depot => &mut self.depot,
            FileSection::Ignored => return,
            FileSection::Header => {
                violations.push(line.place(), "belongs to no section; remove it");
                return;
            }
        };
        lines.get_or_insert_default().push(line);
    }
}

/// Whether a line starts with a keyword. Within a section that is read, a letter is not enough: `NaN`
/// and `x` in place of a number belong to the section.
fn is_keyword(section: FileSection, content: &str) -> bool {
    if !content.starts_with(|c: char| c.is_ascii_alphabetic()) {
        return false;
    }
    let ends = |c: char| c == ':' || c.is_whitespace();
    let word = content.split(ends).next().unwrap_or_default();
    let capital = |c: char| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_';
    matches!(section, FileSection::Header | FileSection::Ignored)
        || (word.len() > 2 && word.chars().all(capital) && word.parse::<f64>().is_err())
}
