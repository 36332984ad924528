//! Errors in a case file, collected, each with its position.
use std::fmt;
use std::ops::Range;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use serde::Serialize;

use super::text::abridged;

/// Greatest length of a quotation from the file in a message.
const LONGEST_QUOTE: usize = 48;
/// Greatest length of a list of permitted values that is shown beside a hint.
const LONGEST_LABEL: usize = 72;

/// Greatest number of errors that are shown; the others are counted.
pub(super) const MOST_SHOWN: usize = 50;

/// One error in a case file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaseError {
    /// Path of the key, for example `cloud.box[0].spacing`; empty for the whole file.
    #[serde(rename = "key")]
    pub path: String,
    /// Range of bytes of the file that the message refers to; within one line.
    #[serde(skip)]
    pub span: Range<usize>,
    /// Line number, counted from 1.
    pub line: usize,
    /// Column of the first character, counted from 1.
    pub column: usize,
    /// Column after the last character.
    pub end_column: usize,
    /// Description of the error.
    pub message: String,
    /// The value in the file.
    pub value: Option<String>,
    /// Permitted values.
    pub allowed: Option<String>,
    /// How to correct the error.
    pub hint: Option<String>,
}

/// All errors in a case file, in the order of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseErrors {
    /// Name of the file.
    pub name: String,
    /// The errors, at least one.
    pub errors: Vec<CaseError>,
    lines: Vec<String>,
}

impl CaseError {
    pub(super) fn new(path: &str, span: Range<usize>, message: impl Into<String>) -> Self {
        Self {
            path: path.to_owned(),
            span,
            line: 1,
            column: 1,
            end_column: 1,
            message: message.into(),
            value: None,
            allowed: None,
            hint: None,
        }
    }

    pub(super) fn allowed(&mut self, allowed: impl Into<String>) -> &mut Self {
        self.allowed = Some(allowed.into());
        self
    }

    pub(super) fn hint(&mut self, hint: impl Into<String>) -> &mut Self {
        self.hint = Some(hint.into());
        self
    }

    /// Tells long numbers in powers of ten.
    fn abridge(&mut self) {
        self.message = abridged(&self.message);
        [&mut self.allowed, &mut self.hint].into_iter().flatten().for_each(|told| *told = abridged(told));
    }

    /// Restricts the span to one line of `text`, whose lines start at `starts`, and computes line and columns from it.
    fn locate(&mut self, text: &str, starts: &[usize]) {
        let start = boundary(text, self.span.start);
        self.line = starts.partition_point(|first| *first <= start);
        let first = starts[self.line - 1];
        let last = starts.get(self.line).map_or(text.len(), |next| next - 1);
        let last = first + text[first..last].trim_end_matches('\r').len();
        let start = start.min(last);
        let end = boundary(text, self.span.end).clamp(start, last);
        self.span = start..end;
        self.column = text[first..start].chars().count() + 1;
        self.end_column = self.column + text[start..end].chars().count();
        self.value = (start < end).then(|| quote(&text[start..end]));
    }
}

impl CaseErrors {
    pub(super) fn new(name: &str, text: &str, mut errors: Vec<CaseError>) -> Self {
        let starts: Vec<usize> = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i + 1)).collect();
        errors.iter_mut().for_each(|e| {
            e.locate(text, &starts);
            e.abridge();
        });
        errors.sort_by_key(|e| e.span.start);
        errors.dedup();
        let lines = errors.iter().take(MOST_SHOWN).map(|e| line_of(&text[starts[e.line - 1]..])).collect();
        Self { name: name.to_owned(), errors, lines }
    }

    /// The first errors with the lines that they refer to, and the number of further ones; with terminal colours if
    /// `color`.
    pub fn render(&self, color: bool) -> String {
        let renderer = if color { Renderer::styled() } else { Renderer::plain() };
        let mut blocks: Vec<String> =
            self.errors.iter().zip(&self.lines).map(|(e, line)| self.block(e, line, &renderer)).collect();
        let more = self.errors.len().saturating_sub(MOST_SHOWN);
        blocks.push(match self.errors.len() {
            1 => format!("1 mistake in `{}`", self.name),
            n if more > 0 => format!("and {more} more: {n} mistakes in `{}`", self.name),
            n => format!("{n} mistakes in `{}`", self.name),
        });
        blocks.join("\n\n")
    }

    fn block(&self, error: &CaseError, line: &str, renderer: &Renderer) -> String {
        let place = byte_of(line, error.column)..byte_of(line, error.end_column);
        let label = error.allowed.as_ref().map(|a| format!("allowed: {a}"));
        let label = label.filter(|l| error.hint.is_none() || l.chars().count() <= LONGEST_LABEL);
        let snippet = Snippet::source(line)
            .line_start(error.line)
            .path(self.name.as_str())
            .annotation(AnnotationKind::Primary.span(place).label(label));
        let group = Level::ERROR.primary_title(error.message.as_str()).element(snippet);
        match &error.hint {
            Some(hint) => renderer.render(&[group.element(Level::HELP.with_name("hint").message(hint.as_str()))]),
            None => renderer.render(&[group]),
        }
    }
}

impl fmt::Display for CaseErrors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for CaseErrors {}

/// `text` on one line, without control characters, cut after [`LONGEST_QUOTE`] characters.
pub(super) fn quote(text: &str) -> String {
    let mut short: String =
        text.chars().take(LONGEST_QUOTE).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
    if text.chars().nth(LONGEST_QUOTE).is_some() {
        short.push('…');
    }
    short
}

/// The nearest character boundary at or before byte `index`.
fn boundary(text: &str, index: usize) -> usize {
    (0..=index.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}

/// The first line of `text`, in which every control character is replaced by one visible character.
fn line_of(text: &str) -> String {
    let line = text.split('\n').next().unwrap_or_default().trim_end_matches('\r');
    line.chars().map(|c| if c.is_control() && c != '\t' { '\u{fffd}' } else { c }).collect()
}

/// Byte index of the character in `column`, counted from 1.
fn byte_of(line: &str, column: usize) -> usize {
    line.char_indices().nth(column - 1).map_or(line.len(), |(i, _)| i)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_counted_in_characters_and_kept_on_one_line() {
        let text = "title = \"κ\" \r\nblank = 9\nrest";
        let mut error = CaseError::new("cloud.blank", 23..26, "wrong");
        error.allowed("from 0.3 to 0.6").hint("use 0.4");
        let errors = CaseErrors::new("case.toml", text, vec![error]);
        let e = &errors.errors[0];
        assert_eq!((e.line, e.column, e.end_column, e.value.as_deref()), (2, 9, 10, Some("9")));
        let shown = errors.render(false);
        assert!(shown.contains("case.toml:2:9"), "{shown}");
        assert!(shown.contains("^ allowed: from 0.3 to 0.6"), "{shown}");
        assert!(shown.contains("= hint: use 0.4"), "{shown}");
        assert!(shown.ends_with("1 mistake in `case.toml`"), "{shown}");
    }

    #[test]
    fn many_mistakes_are_counted_and_the_first_are_shown() {
        let text: String = (0..20_000).map(|i| format!("k{i} = 1\n")).collect();
        let errors = super::super::read(&text, "case.toml").unwrap_err();
        let shown = errors.render(false);
        assert!(errors.errors.len() >= 20_000);
        assert_eq!(shown.matches("error: ").count(), MOST_SHOWN);
        let more = errors.errors.len() - MOST_SHOWN;
        assert!(shown.contains(&format!("and {more} more: ")), "{shown}");
    }

    #[test]
    fn any_span_can_be_shown() {
        let text = "a\u{7}é\n\n";
        for start in 0..8 {
            for end in 0..8 {
                let error = CaseError::new("", start..end, "wrong");
                assert!(!CaseErrors::new("x", text, vec![error]).render(true).is_empty());
            }
        }
    }
}
