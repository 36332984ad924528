//! Reading a case file: all mistakes in one go.
//!
//! The text becomes a spanned document, the document is walked along the tables of keys ([`CASE`]), and every value that
//! passes lands in base units in a plain tree with all defaults. Contradictions between keys are looked for in that tree
//! (`check.rs`); a tree without mistakes is what [`Case`] is deserialised from.
use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::ops::Range as Span;
use std::path::Path;

use serde_json::{Map, Value, json};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::CASE;
use super::Case;
use super::draft::{Draft, closest, with_point};
use super::error::{CaseErrors, MOST_SHOWN, quote};
use super::polar;
use super::quantity::{Dimension, PURE};
use super::schema::{Absent, Field, Kind, List, Range, Table, Variant, one_of};
use super::text::open_regular;

/// Reads the text of a case file; `name` is what messages call it.
pub fn read(text: &str, name: &str) -> Result<Case, CaseErrors> {
    read_with(text, name, None)
}

/// The same of a case whose files lie in `folder`: those that cannot be opened are mistakes of the case as well.
pub fn read_in(text: &str, name: &str, folder: &Path) -> Result<Case, CaseErrors> {
    read_with(text, name, Some(folder))
}

fn read_with(text: &str, name: &str, folder: Option<&Path>) -> Result<Case, CaseErrors> {
    let (document, syntax) = DeTable::parse_recoverable(text);
    let mut reader = Reader { draft: Draft::new(text), complete: syntax.is_empty(), folder };
    let root = reader.table(&CASE, document.get_ref(), "");
    let mut draft = reader.draft;
    draft.tree = Value::Object(root);
    draft.title(name);
    if syntax.is_empty() {
        super::check::contradictions(&mut draft);
    } else {
        draft.add_syntax_errors(&syntax);
    }
    if draft.errors.is_empty() {
        polar::take_out(&mut draft.tree);
        match serde_json::from_value(draft.tree.take()) {
            Ok(case) => return Ok(case),
            Err(error) => draft.fail("", format!("the case does not fit together: {error}")),
        };
    }
    draft.name_bodies();
    Err(CaseErrors::new(name, text, draft.errors))
}

struct Reader<'t> {
    draft: Draft<'t>,
    /// The text is TOML throughout: what is not there is really missing.
    complete: bool,
    /// Folder of the files that the case names, where they are looked for.
    folder: Option<&'t Path>,
}

type Item<'i> = Spanned<DeValue<'i>>;
type Entry<'d, 'i> = (&'d Spanned<DeString<'i>>, &'d Item<'i>);

impl Reader<'_> {
    /// The keys of one table with their defaults; `path` is empty for the document.
    fn table(&mut self, table: &'static Table, document: &DeTable<'_>, path: &str) -> Map<String, Value> {
        let mut tree = Map::new();
        let mut seen = BTreeSet::new();
        for (key, item) in document.iter().flat_map(|entry| entries(table, entry)) {
            let Some(field) = table.field(key.get_ref()) else {
                if let Some(meant) = self.unknown(table, key.get_ref(), key.span(), path)
                    && !document.contains_key(meant)
                {
                    // What the misspelt key was to say is not missing as well.
                    self.draft.place(&join(path, meant), key.span(), item.span());
                }
                continue;
            };
            let here = join(path, field.key);
            if !seen.insert(field.key) {
                let other = match (field.alias, table.within) {
                    (None, Some(within)) => format!("in `{}`", join(path, within)),
                    (alias, _) => format!("as `{}`", alias.unwrap_or(field.key)),
                };
                let message = format!("`{here}` is given twice, also {other}");
                self.draft.fail_at(&here, key.span(), message).hint(format!("keep only `{}`", field.key));
                continue;
            }
            self.draft.place(&here, key.span(), item.span());
            // messages about one value call it as it is written
            let written = if field.alias == Some(key.get_ref()) { join(path, key.get_ref()) } else { here };
            if let Some(value) = self.value(&field.kind, item, &written) {
                tree.insert(field.key.to_owned(), value);
            }
        }
        for field in table.fields().filter(|f| !seen.contains(f.key)) {
            match field.default_value() {
                Some(value) => {
                    tree.insert(field.key.to_owned(), value);
                }
                None => self.missing(field, path),
            }
        }
        tree
    }

    fn value(&mut self, kind: &'static Kind, item: &Item<'_>, path: &str) -> Option<Value> {
        match (kind, item.get_ref()) {
            (Kind::Number(range), value) if number(value).is_some() => self.number(number(value)?, range, item, path),
            (Kind::Quantity(dimension, range), _) => self.quantity(kind, (dimension, range), item, path),
            (Kind::Values(one), _) => self.values(one, item, path),
            (Kind::Integer(min, max), value) => self.whole(kind, (*min, *max), number(value), item, path),
            (Kind::IntegerOr(_, _, word), DeValue::String(text)) if text.as_ref() == *word => Some(json!(word)),
            (Kind::IntegerOr(min, max, _), value) => self.whole(kind, (*min, *max), number(value), item, path),
            (Kind::Flag, DeValue::Boolean(flag)) => Some(json!(flag)),
            (Kind::Text | Kind::Matching(_), DeValue::String(text)) if text.contains(char::is_control) => {
                self.control(text, item, path)
            }
            (Kind::Text | Kind::Matching(_), DeValue::String(text)) if !text.trim().is_empty() => Some(json!(text)),
            (Kind::File, DeValue::String(text)) if !text.trim().is_empty() => {
                self.file(text, item, path);
                Some(json!(text))
            }
            (Kind::Formula, DeValue::String(text)) if !text.trim().is_empty() => Some(json!(text)),
            (Kind::Formula, value) if number(value).is_some() => {
                let x = self.number(number(value)?, &Range::ANY, item, path)?.as_f64()?;
                Some(json!(format!("{x:?}")))
            }
            (Kind::TableOr(_, word), DeValue::String(text)) => {
                self.word(&[word], text, item, path).map(|_| json!(word))
            }
            (Kind::TableOr(table, _), DeValue::Table(document)) => Some(json!(self.table(table, document, path))),
            (Kind::Words(words), DeValue::String(text)) => {
                let names: Vec<_> = words.iter().map(|w| w.0).collect();
                self.word(&names, text, item, path).map(|i| json!(names[i]))
            }
            (Kind::List(list), DeValue::Array(items)) => self.list(kind, list, items, item, path),
            (Kind::List(list), _) if list.single => {
                self.place_item(list, item, &format!("{path}[0]"));
                Some(json!([self.value(&list.item, item, path)?]))
            }
            (Kind::Table(table), DeValue::Table(document)) => Some(json!(self.table(table, document, path))),
            (Kind::Table(table), _) if table.shorthand.is_some() => self.shorthand(table, item, path),
            (Kind::Tables(table), DeValue::Array(items)) => Some(self.tables(table, items, path)),
            (Kind::Tables(table), DeValue::Table(document)) => Some(self.only(table, document, item.span(), path)),
            (Kind::Tables(table), _) if table.shorthand.is_some() => {
                let here = format!("{path}[0]");
                self.draft.place(&here, item.span(), item.span());
                Some(json!([self.shorthand(table, item, &here)?]))
            }
            (Kind::Choice(variants), DeValue::String(text)) => self.choose(variants, text, item, path),
            (Kind::Choice(variants), DeValue::Table(document)) => self.choose_table(variants, document, item, path),
            _ => self.wrong(kind, item, path),
        }
    }

    /// A number with a unit, or one in the usual unit.
    fn quantity(
        &mut self,
        kind: &'static Kind,
        (dimension, range): (&Dimension, &Range),
        item: &Item<'_>,
        path: &str,
    ) -> Option<Value> {
        let parsed = match item.get_ref() {
            DeValue::String(text) => dimension.parse(text),
            other => match number(other) {
                Some(x) => dimension.plain(x),
                None => return self.wrong(kind, item, path),
            },
        };
        match parsed {
            Ok(x) => self.number(x, range, item, path),
            Err(error) => self.bad_quantity(kind, &error.to_string(), item, path),
        }
    }

    /// Complains of a text with line breaks, escapes and their like, which terminals obey and pictures cannot hold.
    fn control(&mut self, text: &str, item: &Item<'_>, path: &str) -> Option<Value> {
        let found = text.chars().find(|c| c.is_control()).unwrap_or_default();
        let message = format!("`{path}` has the control character U+{:04X} in it", u32::from(found));
        self.draft.fail_at(path, item.span(), message).allowed("one line of characters that can be seen");
        None
    }

    /// Complains of a file that cannot be opened.
    fn file(&mut self, name: &str, item: &Item<'_>, path: &str) {
        let Some(folder) = self.folder else { return };
        let Err(problem) = open_regular(&folder.join(name)) else { return };
        let message = match problem.kind() {
            ErrorKind::NotFound => format!("`{path}`: there is no file `{}`", quote(name)),
            _ => format!("`{path}`: cannot read the file `{}`: {problem}", quote(name)),
        };
        let hint = similar(&folder.join(name)).map_or_else(
            || "names of files are relative to the folder of the case file".to_owned(),
            |other| format!("did you mean `{other}`?"),
        );
        self.draft.fail_at(path, item.span(), message).hint(hint);
    }

    /// One value, or several.
    fn values(&mut self, one: &'static Kind, item: &Item<'_>, path: &str) -> Option<Value> {
        let read = match item.get_ref() {
            DeValue::Array(items) => self.listed(one, items, item, path)?,
            DeValue::String(text) if text.contains([':', ',']) => self.series(one, text, item, path)?,
            _ => return self.value(one, item, path),
        };
        Some(if read.len() == 1 { read[0].clone() } else { Value::Array(read) })
    }

    /// The values of a list; the unit of the last one serves those without, and where none has one the usual unit serves all.
    fn listed(&mut self, one: &'static Kind, items: &[Item<'_>], whole: &Item<'_>, path: &str) -> Option<Vec<Value>> {
        let Some(last) = items.last() else {
            let message = format!("`{path}` has no values");
            self.draft.fail_at(path, whole.span(), message).allowed("one value or more");
            return None;
        };
        let plain = items.iter().all(|item| number(item.get_ref()).is_some());
        let last = last.get_ref().as_str().map_or("", |text| polar::split(text).1);
        let unit = if plain { one.usual_unit() } else { last }.to_owned();
        let read = items.iter().enumerate().map(|(i, item)| {
            let here = format!("{path}[{i}]");
            match number(item.get_ref()).filter(|_| !unit.is_empty()) {
                Some(x) => self.text_value(one, &format!("{x} {unit}"), item, &here),
                None => self.value(one, item, &here),
            }
        });
        read.collect::<Vec<_>>().into_iter().collect()
    }

    /// The values of a series in one text.
    fn series(&mut self, one: &'static Kind, text: &str, item: &Item<'_>, path: &str) -> Option<Vec<Value>> {
        let texts = match polar::values_of(text) {
            Ok(texts) => texts,
            Err(problem) => {
                let allowed = "`\"first:last:step\"` with a step that leads from the first to the last";
                self.draft.fail_at(path, item.span(), format!("`{path}`: {problem}")).allowed(allowed);
                return None;
            }
        };
        let unit = if texts.iter().all(|t| t.parse::<f64>().is_ok()) { one.usual_unit() } else { "" };
        let whole = |text: &String| format!("{text} {unit}").trim().to_owned();
        let read = texts.iter().map(whole).enumerate();
        let read = read.map(|(i, t)| self.text_value(one, &t, item, &format!("{path}[{i}]")));
        read.collect::<Vec<_>>().into_iter().collect()
    }

    /// A number or a quantity that is given as text.
    fn text_value(&mut self, one: &'static Kind, text: &str, item: &Item<'_>, path: &str) -> Option<Value> {
        let (parsed, range) = match one {
            Kind::Quantity(dimension, range) => (dimension.parse(text), range),
            Kind::Number(range) => (PURE.parse(text), range),
            other => return self.wrong(other, item, path),
        };
        match parsed {
            Ok(x) => self.number(x, range, item, path),
            Err(error) => self.bad_quantity(one, &error.to_string(), item, path),
        }
    }

    fn number(&mut self, value: f64, range: &Range, item: &Item<'_>, path: &str) -> Option<Value> {
        if range.contains(value) {
            return Some(json!(value));
        }
        let written = self.draft.source(item.span());
        let allowed = range.words().unwrap_or_else(|| "a finite number".to_owned());
        let message = format!("`{path}` is {written}, but must be {allowed}");
        let error = self.draft.fail_at(path, item.span(), message).allowed(allowed);
        if range.is_dwarfed_by(value) {
            error.hint("check its unit and its exponent");
        }
        None
    }

    fn bad_quantity(&mut self, kind: &Kind, error: &str, item: &Item<'_>, path: &str) -> Option<Value> {
        let written = self.draft.source(item.span());
        let point = with_point(written.trim_matches(['"', '\'']));
        let message = match point {
            Some(_) => format!("`{path}`: {written} has a decimal comma"),
            None => format!("`{path}`: {error}"),
        };
        let error = self.draft.fail_at(path, item.span(), message).allowed(kind.words());
        if let Some(point) = point {
            error.hint(format!("write decimals with a point, `\"{point}\"`"));
        } else if let (Kind::Quantity(dimension, _), Some(x)) = (kind, number(item.get_ref())) {
            error.hint(format!("write `\"{x} {}\"` with one of the units {}", dimension.usual(), dimension.symbols()));
        }
        None
    }

    fn whole(
        &mut self,
        kind: &Kind,
        (min, max): (u64, u64),
        value: Option<f64>,
        item: &Item<'_>,
        path: &str,
    ) -> Option<Value> {
        let Some(x) = value.filter(|x| x.fract() == 0.0) else { return self.wrong(kind, item, path) };
        if min as f64 <= x && x <= max as f64 {
            return Some(json!(x as u64));
        }
        // where no end matters to whoever reads of the key, it does to whoever went beyond it
        let allowed = if x > max as f64 { format!("a whole number from {min} to {max}") } else { kind.words() };
        let message = format!("`{path}` is {}, but must be {allowed}", self.draft.source(item.span()));
        self.draft.fail_at(path, item.span(), message).allowed(allowed);
        None
    }

    fn list(
        &mut self,
        kind: &Kind,
        list: &'static List,
        items: &[Item<'_>],
        whole: &Item<'_>,
        path: &str,
    ) -> Option<Value> {
        let read = items.iter().enumerate().map(|(i, item)| {
            let here = format!("{path}[{i}]");
            self.place_item(list, item, &here);
            self.value(&list.item, item, &here)
        });
        let read: Vec<_> = read.collect();
        if (list.min..=list.max).contains(&items.len()) {
            return read.into_iter().collect::<Option<Vec<_>>>().map(Value::Array);
        }
        let message = format!("`{path}` has {} values, but must be {}", items.len(), kind.words());
        self.draft.fail_at(path, whole.span(), message).allowed(kind.words());
        None
    }

    /// Remembers where a formula or a quantity in a list was written: its own places are pointed at, and its unit is looked at.
    fn place_item(&mut self, list: &List, item: &Item<'_>, path: &str) {
        if matches!(list.item, Kind::Formula | Kind::Quantity(..)) {
            self.draft.place(path, item.span(), item.span());
        }
    }

    fn tables(&mut self, table: &'static Table, items: &[Item<'_>], path: &str) -> Value {
        let mut list = Vec::new();
        for (i, item) in items.iter().enumerate() {
            let here = format!("{path}[{i}]");
            self.draft.place(&here, item.span(), item.span());
            match item.get_ref() {
                DeValue::Table(document) => list.push(json!(self.table(table, document, &here))),
                _ if table.shorthand.is_some() => {
                    list.push(self.shorthand(table, item, &here).unwrap_or(Value::Null));
                }
                _ => {
                    let message = format!("`{here}` must be a table, not {}", type_of(item.get_ref()));
                    self.draft.fail_at(&here, item.span(), message).allowed("a table");
                    list.push(Value::Null);
                }
            }
        }
        Value::Array(list)
    }

    /// A plain table in place of an array of one.
    fn only(&mut self, table: &'static Table, document: &DeTable<'_>, span: Span<usize>, path: &str) -> Value {
        let here = format!("{path}[0]");
        self.draft.place(&here, span.clone(), span);
        json!([self.table(table, document, &here)])
    }

    fn shorthand(&mut self, table: &'static Table, item: &Item<'_>, path: &str) -> Option<Value> {
        let field = table.shorthand.and_then(|key| table.field(key))?;
        let mut tree = table.defaults();
        tree.insert(field.key.to_owned(), self.value(&field.kind, item, path)?);
        Some(Value::Object(tree))
    }

    fn choose(&mut self, variants: &'static [Variant], text: &str, item: &Item<'_>, path: &str) -> Option<Value> {
        let names: Vec<_> = variants.iter().map(|v| v.name).collect();
        let variant = &variants[self.word(&names, text, item, path)?];
        if variant.is_word() {
            return Some(variant.bare());
        }
        let keys = variant.table.into_iter().flat_map(Table::fields);
        let keys = keys.filter(|f| matches!(f.default, Absent::Required)).map(|f| format!("{} = …", f.key));
        let hint = format!("write `{path} = {{ {text} = {{ {} }} }}`", keys.collect::<Vec<_>>().join(", "));
        self.draft.fail_at(path, item.span(), format!("`{text}` needs a table of its own")).hint(hint);
        None
    }

    fn choose_table(
        &mut self,
        variants: &'static [Variant],
        document: &DeTable<'_>,
        whole: &Item<'_>,
        path: &str,
    ) -> Option<Value> {
        let names: Vec<_> = variants.iter().map(|v| v.name).collect();
        let mut chosen = Vec::new();
        for (key, item) in document.iter() {
            let here = join(path, key.get_ref());
            let Some(variant) = variants.iter().find(|v| v.name == key.get_ref().as_ref()) else {
                let message = format!("unknown key `{}` {}", quote(key.get_ref()), inside(path));
                let hint = closest(key.get_ref(), names.iter().copied()).map(|n| format!("did you mean `{n}`?"));
                self.draft.fail_at(&here, key.span(), message).allowed(one_of(names.iter().copied())).hint = hint;
                continue;
            };
            self.draft.place(&here, key.span(), item.span());
            chosen.push((variant, key.span(), self.variant(variant, item, &here)));
        }
        if let Some(k) = chosen.iter().position(|c| c.0.rules) {
            chosen.swap(0, k);
            chosen.truncate(1);
        }
        if let [_, (second, span, _), ..] = &chosen[..] {
            let message = format!("`{path}` has two alternatives: `{}` and `{}`", chosen[0].0.name, second.name);
            self.draft.fail_at(path, span.clone(), message).allowed(format!("one of {}", one_of(names.into_iter())));
        } else if document.is_empty() {
            let message = format!("`{path}` is an empty table");
            self.draft.fail_at(path, whole.span(), message).allowed(one_of(names.into_iter()));
        }
        chosen.into_iter().next()?.2
    }

    fn variant(&mut self, variant: &'static Variant, item: &Item<'_>, path: &str) -> Option<Value> {
        match (variant.table, item.get_ref()) {
            (Some(table), DeValue::Table(document)) => Some(json!({ variant.name: self.table(table, document, path) })),
            (None, DeValue::Table(document)) if document.is_empty() => Some(variant.bare()),
            (None, DeValue::Boolean(true)) => Some(variant.bare()),
            (Some(table), _) if table.shorthand.is_some() => {
                Some(json!({ variant.name: self.shorthand(table, item, path)? }))
            }
            (found, value) => {
                let allowed = if found.is_some() { "a table" } else { "an empty table" };
                let message = format!("`{path}` must be {allowed}, not {}", type_of(value));
                self.draft.fail_at(path, item.span(), message).allowed(allowed);
                None
            }
        }
    }

    /// Index of `text` in `names`.
    fn word(&mut self, names: &[&str], text: &str, item: &Item<'_>, path: &str) -> Option<usize> {
        let found = names.iter().position(|n| *n == text);
        if found.is_none() {
            let message = format!("`{path}` cannot be `{}`", quote(text));
            let hint = closest(text, names.iter().copied()).map(|n| format!("did you mean `\"{n}\"`?"));
            self.draft.fail_at(path, item.span(), message).allowed(one_of(names.iter().copied())).hint = hint;
        }
        found
    }

    fn wrong(&mut self, kind: &Kind, item: &Item<'_>, path: &str) -> Option<Value> {
        let allowed = kind.words();
        let message = format!("`{path}` must be {allowed}, not {}", type_of(item.get_ref()));
        self.draft.fail_at(path, item.span(), message).allowed(allowed);
        None
    }

    /// Tells an unknown key; returns the one that was probably meant.
    fn unknown(&mut self, table: &'static Table, key: &str, span: Span<usize>, path: &str) -> Option<&'static str> {
        let names = || table.fields().flat_map(|f| [Some(f.key), f.alias]).flatten();
        // nobody reads the hints of thousands of mistakes
        let searched = self.draft.errors.len() < MOST_SHOWN;
        let meant = if searched { table.meant_by(key).or_else(|| closest(key, names())) } else { None };
        let hint = match meant {
            Some(name) => Some(format!("did you mean `{name}`?")),
            None if !searched => None,
            None => home_of(key, &CASE, "").map(|home| format!("`{key}` belongs in `[{home}]`")),
        };
        let message = format!("unknown key `{}` {}", quote(key), inside(path));
        let allowed = one_of(table.fields().map(|f| f.key));
        self.draft.fail_at(&join(path, key), span, message).allowed(allowed).hint = hint;
        table.field(meant?).map(|f| f.key)
    }

    fn missing(&mut self, field: &Field, path: &str) {
        let place = join(path, field.key);
        if !self.complete || !matches!(field.default, Absent::Required) || self.draft.given(&place) {
            return;
        }
        let what = if matches!(field.kind, Kind::Table(_)) { "table" } else { "key" };
        let message = format!("missing {what} `{}` {}", field.key, inside(path));
        let hint = format!("add `{}` ({}): {}", field.key, field.kind.words(), lower(field.doc));
        self.draft.fail(&place, message).hint(hint);
    }
}

/// The name of a file beside `file` whose name is much like it.
fn similar(file: &Path) -> Option<String> {
    let wanted = file.file_name()?.to_string_lossy().into_owned();
    let folder = file.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let beside = std::fs::read_dir(folder).ok()?.flatten().filter(|entry| entry.path().is_file());
    let names: Vec<String> = beside.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    let extension = |name: &str| Path::new(name).extension().map(|e| e.to_ascii_lowercase());
    let alike = names.iter().filter(|n| extension(n) == extension(&wanted)).map(String::as_str);
    closest(&wanted, alike).map(str::to_owned)
}

/// An entry of `table`, or those of the table within it that has the same keys.
fn entries<'d, 'i>(table: &Table, (key, item): Entry<'d, 'i>) -> Vec<Entry<'d, 'i>> {
    match item.get_ref() {
        DeValue::Table(within) if table.within == Some(key.get_ref()) => within.iter().collect(),
        _ => vec![(key, item)],
    }
}

/// The number that `value` is, if it is one; infinities and NaN count, so that their range error is told.
fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(x) => x.as_str().parse().ok(),
        DeValue::Integer(n) => i128::from_str_radix(n.as_str(), n.radix()).ok().map(|n| n as f64),
        _ => None,
    }
}

fn type_of(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(text) if text.trim().is_empty() => "an empty text",
        DeValue::String(_) => "a text",
        DeValue::Integer(_) | DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "a truth value",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}

fn join(path: &str, key: &str) -> String {
    if path.is_empty() { key.to_owned() } else { format!("{path}.{key}") }
}

/// "in `[cloud]`", "in `body[0]`" or "in the file".
fn inside(path: &str) -> String {
    match path {
        "" => "in the file".to_owned(),
        path if path.ends_with(']') => format!("in `{path}`"),
        path => format!("in `[{path}]`"),
    }
}

fn lower(doc: &str) -> String {
    let doc = doc.trim_end_matches('.');
    let mut chars = doc.chars();
    chars.next().map_or_else(String::new, |c| c.to_lowercase().chain(chars).collect())
}

/// Path of the table that has a key called `key`; of several the one the fewest levels down, and of those the first.
fn home_of(key: &str, table: &'static Table, path: &str) -> Option<String> {
    if !path.is_empty() && table.field(key).is_some() {
        return Some(path.to_owned());
    }
    let homes = table.fields().filter_map(|field| {
        let here = join(path, field.key);
        match &field.kind {
            Kind::Table(inner) | Kind::Tables(inner) | Kind::TableOr(inner, _) => home_of(key, inner, &here),
            Kind::Choice(variants) => {
                variants.iter().find_map(|v| v.table.and_then(|inner| home_of(key, inner, &join(&here, v.name))))
            }
            _ => None,
        }
    });
    homes.min_by_key(|home| home.matches('.').count())
}
