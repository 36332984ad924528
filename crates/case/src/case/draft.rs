//! A case under construction: values that passed, where they were written, and the mistakes so far.
use std::collections::BTreeMap;
use std::ops::Range;

use serde_json::{Value, json};

use super::error::{CaseError, quote};

/// Values in base units with defaults, places by key path, mistakes.
pub(super) struct Draft<'t> {
    text: &'t str,
    /// Spans of key and value of everything that was written.
    places: BTreeMap<String, (Range<usize>, Range<usize>)>,
    /// Values that passed, in the form the case is deserialised from.
    pub(super) tree: Value,
    /// Mistakes so far.
    pub(super) errors: Vec<CaseError>,
}

impl<'t> Draft<'t> {
    /// An empty draft of the case written in `text`.
    pub(super) fn new(text: &'t str) -> Self {
        Self { text, places: BTreeMap::new(), tree: Value::Null, errors: Vec::new() }
    }

    /// Remembers where `path` was written.
    pub(super) fn place(&mut self, path: &str, key: Range<usize>, value: Range<usize>) {
        self.places.insert(path.to_owned(), (key, value));
    }

    /// What is written at `span`, shortened.
    pub(super) fn source(&self, span: Range<usize>) -> String {
        quote(self.text.get(span).unwrap_or_default())
    }

    /// Names a case without title after its file.
    pub(super) fn title(&mut self, name: &str) {
        if !self.given("title")
            && let Some(tree) = self.tree.as_object_mut()
        {
            let file = name.rsplit(['/', '\\']).next().unwrap_or(name);
            let stem = file.strip_suffix(".toml").unwrap_or(file);
            tree.insert("title".to_owned(), json!(if stem.trim().is_empty() { "untitled" } else { stem }));
        }
    }

    /// Adds mistakes of syntax, and drops those that a broken line only causes.
    pub(super) fn add_syntax_errors(&mut self, syntax: &[toml::de::Error]) {
        let line = |at: usize| self.text.bytes().take(at).filter(|b| *b == b'\n').count();
        let broken: Vec<_> = syntax.iter().map(|e| line(e.span().map_or(0, |s| s.start))).collect();
        let mut errors = std::mem::take(&mut self.errors);
        errors.retain(|e| !broken.contains(&line(e.span.start)));
        self.errors = errors;
        for error in syntax {
            let span = error.span().unwrap_or(0..0);
            match self.decimal_comma(span.start) {
                Some(point) => self
                    .fail_at("", span, "a number has a decimal comma")
                    .hint(format!("write decimals with a point, `{point}`")),
                None => self.fail_at("", span, format!("this is not TOML: {}", error.message())),
            };
        }
    }

    /// The value with a point in place of the decimal comma that is at, or just before, byte `at`.
    fn decimal_comma(&self, at: usize) -> Option<String> {
        let line_start = self.text.get(..at)?.rfind('\n').map_or(0, |i| i + 1);
        let line = self.text.get(line_start..)?.lines().next()?;
        let value = line.split_once('=')?.1.split('#').next()?.trim();
        with_point(value).filter(|_| value.chars().all(|c| c.is_ascii_digit() || "+-,eE".contains(c)))
    }

    /// True when `path` was written in the file.
    pub(super) fn given(&self, path: &str) -> bool {
        self.places.contains_key(path)
    }

    /// True when the key at `path` was written as `name`, one of its spellings.
    pub(super) fn is_written(&self, path: &str, name: &str) -> bool {
        let key = self.places.get(path).and_then(|(key, _)| self.text.get(key.clone()));
        key.is_some_and(|key| key.trim_matches(['"', '\'']) == name)
    }

    /// True when the value at `path` was written with a unit.
    pub(super) fn has_unit(&self, path: &str) -> bool {
        let written = self.places.get(path).and_then(|(_, value)| self.text.get(value.clone())).unwrap_or_default();
        written.contains(['"', '\'']) && written.contains(|c: char| c.is_alphabetic() && !matches!(c, 'e' | 'E'))
    }

    /// The unit that is written behind the number at `path`; empty when there is none.
    pub(super) fn unit(&self, path: &str) -> &str {
        let written = self.places.get(path).and_then(|(_, value)| self.text.get(value.clone())).unwrap_or_default();
        let inner = written.trim_matches(['"', '\'']).trim();
        let digits = |c: char| c.is_ascii_digit() || "+-.eE ".contains(c);
        if self.has_unit(path) { inner.trim_start_matches(digits) } else { "" }
    }

    /// The value at `path`, none when it is absent or wrong.
    pub(super) fn get(&self, path: &str) -> Option<&Value> {
        self.tree.pointer(&pointer(path))
    }

    /// The same, to be changed.
    pub(super) fn get_mut(&mut self, path: &str) -> Option<&mut Value> {
        self.tree.pointer_mut(&pointer(path))
    }

    /// The number at `path`.
    pub(super) fn number(&self, path: &str) -> Option<f64> {
        self.get(path)?.as_f64()
    }

    /// The number at `path`, or those in the list there.
    pub(super) fn values(&self, path: &str) -> Vec<f64> {
        self.numbers(path).unwrap_or_else(|| self.number(path).into_iter().collect())
    }

    /// The numbers in the list at `path`.
    pub(super) fn numbers(&self, path: &str) -> Option<Vec<f64>> {
        self.get(path)?.as_array()?.iter().map(Value::as_f64).collect()
    }

    /// Number of items in the list at `path`.
    pub(super) fn count(&self, path: &str) -> usize {
        self.get(path).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// Calls bodies in messages by their names, as every other message does: `body-1.chord` is `chord` of the first `[[body]]`.
    pub(super) fn name_bodies(&mut self) {
        for i in 0..self.count("body") {
            let given = self.get(&format!("body[{i}].name")).and_then(Value::as_str);
            let name = given.map_or_else(|| default_name(i), str::to_owned);
            let (path, name) = (format!("`body[{i}]"), format!("`{name}"));
            for error in &mut self.errors {
                error.message = error.message.replace(&path, &name);
                error.hint = error.hint.take().map(|h| h.replace(&path, &name));
            }
        }
    }

    /// Adds a mistake about the value at `path`, or about the table that lacks it.
    pub(super) fn fail(&mut self, path: &str, message: impl Into<String>) -> &mut CaseError {
        let span = match self.places.get(path) {
            Some((_, value)) => value.clone(),
            None => self.ancestor(path),
        };
        self.fail_at(path, span, message)
    }

    /// Adds a mistake about the bytes `part` of the text that is the value at `path`.
    pub(super) fn fail_within(&mut self, path: &str, part: Range<usize>, message: impl Into<String>) -> &mut CaseError {
        let whole = self.places.get(path).map_or(0..0, |(_, value)| value.clone());
        let inner = self.get(path).and_then(Value::as_str).unwrap_or_default();
        // a text with escapes is not written as it reads: then the whole value is pointed at
        let written = self.text.get(whole.clone()).unwrap_or_default();
        let span = match written.find(inner) {
            Some(start) if !inner.is_empty() => {
                let start = whole.start + start;
                // nothing can be shown behind the end: the last character stands for it
                let end = (start + part.end).max(start + 1);
                (start + part.start).min(end - 1)..end
            }
            _ => whole,
        };
        self.fail_at(path, span, message)
    }

    /// Adds a mistake about the key at `path`.
    pub(super) fn fail_key(&mut self, path: &str, message: impl Into<String>) -> &mut CaseError {
        let span = self.places.get(path).map_or_else(|| self.ancestor(path), |(key, _)| key.clone());
        self.fail_at(path, span, message)
    }

    /// Adds a mistake at a place in the file.
    pub(super) fn fail_at(&mut self, path: &str, span: Range<usize>, message: impl Into<String>) -> &mut CaseError {
        let at = self.errors.len();
        self.errors.push(CaseError::new(path, span, message));
        &mut self.errors[at]
    }

    /// Place of the nearest table around `path` that was written, else the start of the file.
    fn ancestor(&self, path: &str) -> Range<usize> {
        let mut path = path;
        while let Some(end) = path.rfind(['.', '[']) {
            path = &path[..end];
            if let Some((key, _)) = self.places.get(path) {
                return key.clone();
            }
        }
        0..0
    }
}

/// Where the value at the key path `path` is in the tree.
pub(super) fn pointer(path: &str) -> String {
    format!("/{}", path.replace(['.', '['], "/").replace(']', ""))
}

/// Name of a body that has none.
pub(super) fn default_name(body: usize) -> String {
    format!("body-{}", body + 1)
}

/// The candidate that `word` was probably meant to be.
pub(super) fn closest<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    /// Jaro-Winkler similarity of names that still look alike.
    const ALIKE: f64 = 0.8;
    let word: String = word.chars().take(64).collect::<String>().to_lowercase().replace('-', "_");
    let scored = candidates.map(|c| (strsim::jaro_winkler(&word, c), c)).filter(|(score, _)| ALIKE <= *score);
    scored.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, c)| c)
}

/// `text` with a point in place of its decimal comma, if it begins with a number that has one.
pub(super) fn with_point(text: &str) -> Option<String> {
    let (whole, rest) = text.trim().split_once(',')?;
    let digits = |part: &str| part.starts_with(|c: char| c.is_ascii_digit());
    let number = whole.trim_start_matches(['+', '-']);
    let is_number = digits(number) && number.chars().all(|c| c.is_ascii_digit());
    (is_number && digits(rest) && !rest.contains(',')).then(|| format!("{whole}.{rest}"))
}
