//! The language in which the case format is described.
//!
//! A table of the file is declared once ([`keys`], [`words`]): its type, and which keys exist, what they hold, their range, default and meaning. The reader, the
//! writer, the JSON schema for editors and the reference page all walk this table, so they cannot disagree.
use serde::de::DeserializeOwned;
use serde_json::{Map, Value, json};

use super::quantity::Dimension;

/// A table of the case file.
#[derive(Clone, Copy)]
pub(super) struct Table {
    /// Its own keys in the order in which they are written and documented.
    own: &'static [Field],
    /// Keys that it shares with another table; they follow its own.
    shared: &'static [Field],
    /// Key that a bare value stands for: `naca = "0012"` is `naca = { digits = "0012" }`.
    pub(super) shorthand: Option<&'static str>,
    /// Keys of which exactly one must be given.
    pub(super) one_of: &'static [&'static str],
    /// Name of a table within, in which its keys may stand as well.
    pub(super) within: Option<&'static str>,
}

/// One key of a table.
#[derive(Clone, Copy)]
pub(super) struct Field {
    /// The key.
    pub(super) key: &'static str,
    /// A second spelling.
    pub(super) alias: Option<&'static str>,
    /// What other programs call it: no keys, but words that are answered with this one.
    pub(super) synonyms: &'static [&'static str],
    /// Meaning, one or two sentences.
    pub(super) doc: &'static str,
    /// What the key holds.
    pub(super) kind: Kind,
    /// What holds when the key is absent.
    pub(super) default: Absent,
}

/// What a key holds.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// A plain number.
    Number(Range),
    /// A number with a unit.
    Quantity(&'static Dimension, Range),
    /// One number or quantity, or several: a list, `first:last:step`, or values with commas between.
    Values(&'static Kind),
    /// A whole number from .. to, ends included.
    Integer(u64, u64),
    /// A whole number from .. to, ends included, or this word.
    IntegerOr(u64, u64, &'static str),
    /// `true` or `false`.
    Flag,
    /// Any text but the empty one.
    Text,
    /// Name of a file, relative to the folder of the case file.
    File,
    /// A text that editors know to be wrong where it does not match this regular expression.
    Matching(&'static str),
    /// One of several words.
    Words(&'static [(&'static str, &'static str)]),
    /// A list of `min` to `max` items.
    List(&'static List),
    /// A text that is a formula, or a number.
    Formula,
    /// A table, or this word.
    TableOr(&'static Table, &'static str),
    /// A table.
    Table(&'static Table),
    /// An array of tables; a single one may be written as a plain table.
    Tables(&'static Table),
    /// One of several words or one-key tables.
    Choice(&'static [Variant]),
}

/// A list of values of one kind.
#[derive(Clone, Copy)]
pub(super) struct List {
    /// Kind of the items.
    pub(super) item: Kind,
    /// Least number of items.
    pub(super) min: usize,
    /// Greatest number of items.
    pub(super) max: usize,
    /// A bare item stands for a list of one.
    pub(super) single: bool,
}

/// One alternative of a [`Kind::Choice`].
#[derive(Clone, Copy)]
pub(super) struct Variant {
    /// The word or key.
    pub(super) name: &'static str,
    /// Meaning.
    pub(super) doc: &'static str,
    /// Keys of its table; none for a bare word.
    pub(super) table: Option<&'static Table>,
    /// Rules where others are given as well.
    pub(super) rules: bool,
}

/// What holds when a key is absent.
#[derive(Clone, Copy)]
pub(super) enum Absent {
    /// The key must be given.
    Required,
    /// Nothing; the text says what that means.
    Nothing(&'static str),
    /// A number.
    Number(f64),
    /// A whole number.
    Integer(u64),
    /// A truth value.
    Flag(bool),
    /// A word or a text.
    Word(&'static str),
    /// A list of words.
    Words(&'static [&'static str]),
    /// The empty table, filled with the defaults of its keys.
    Filled,
}

/// An interval of numbers; an infinite end is no end.
#[derive(Clone, Copy)]
pub(super) struct Range {
    /// Lower end.
    pub(super) min: f64,
    /// Upper end.
    pub(super) max: f64,
    /// The lower end itself is allowed.
    pub(super) closed: bool,
}

/// Times the largest number of an interval beyond which one is hardly a matter of degree.
const DWARFED: f64 = 10.0;

/// A number as it is read best: with an exponent where that spares many zeros.
fn short(x: f64) -> String {
    /// Characters that an exponent must spare.
    const SPARED: usize = 3;
    let (plain, scientific) = (format!("{x}"), format!("{x:e}"));
    if scientific.len() + SPARED < plain.len() { scientific } else { plain }
}

impl Range {
    /// Every finite number.
    pub(super) const ANY: Self = Self { min: f64::NEG_INFINITY, max: f64::INFINITY, closed: true };
    /// Numbers greater than 0.
    pub(super) const POSITIVE: Self = Self::above(0.0);

    /// Numbers greater than `min`.
    pub(super) const fn above(min: f64) -> Self {
        Self { min, max: f64::INFINITY, closed: false }
    }

    /// Numbers from `min` to `max`, ends included.
    pub(super) const fn between(min: f64, max: f64) -> Self {
        Self { min, max, closed: true }
    }

    /// True when `value` lies inside.
    pub(super) fn contains(&self, value: f64) -> bool {
        let above = if self.closed { self.min <= value } else { self.min < value };
        value.is_finite() && above && value <= self.max
    }

    /// True for a number that is many times larger than all of an interval: of another unit, or with a slip of its exponent.
    pub(super) fn is_dwarfed_by(&self, value: f64) -> bool {
        let largest = self.min.abs().max(self.max.abs());
        value.abs() > DWARFED * largest
    }

    /// The interval in words, none when every number is allowed.
    pub(super) fn words(&self) -> Option<String> {
        let lower = if self.closed { "at least" } else { "greater than" };
        let [min, max] = [self.min, self.max].map(short);
        match (self.min.is_finite(), self.max.is_finite()) {
            (false, false) => None,
            (true, false) => Some(format!("{lower} {min}")),
            (false, true) => Some(format!("at most {max}")),
            (true, true) if self.closed => Some(format!("from {min} to {max}")),
            (true, true) => Some(format!("{lower} {min} and at most {max}")),
        }
    }
}

impl Table {
    /// A table whose keys are `own`.
    pub(super) const fn of(own: &'static [Field]) -> Self {
        Self { own, shared: &[], shorthand: None, one_of: &[], within: None }
    }

    /// The same, which a bare value of `key` stands for.
    pub(super) const fn short(mut self, key: &'static str) -> Self {
        self.shorthand = Some(key);
        self
    }

    /// The same with the keys of `other` behind its own.
    pub(super) const fn with_keys_of(mut self, other: &Self) -> Self {
        self.shared = other.own;
        self
    }

    /// All keys in the order in which they are written and documented.
    pub(super) fn fields(&self) -> impl Iterator<Item = &'static Field> + use<> {
        self.own.iter().chain(self.shared)
    }

    /// The same with exactly one of `keys`.
    pub(super) const fn with_one_of(mut self, keys: &'static [&'static str]) -> Self {
        self.one_of = keys;
        self
    }

    /// The same, whose keys may stand in a table `name` within it as well.
    pub(super) const fn or_within(mut self, name: &'static str) -> Self {
        self.within = Some(name);
        self
    }

    /// The field called `key`, by either of its names.
    pub(super) fn field(&self, key: &str) -> Option<&'static Field> {
        self.fields().find(|f| f.key == key || f.alias == Some(key))
    }

    /// The name of the field that other programs call `word`.
    pub(super) fn meant_by(&self, word: &str) -> Option<&'static str> {
        let word = word.to_lowercase().replace('-', "_");
        self.fields().find(|f| f.synonyms.contains(&word.as_str())).map(|f| f.alias.unwrap_or(f.key))
    }

    /// What an empty table is read into, where no key must be given.
    pub(super) fn value<T: DeserializeOwned>(&self) -> T {
        serde_json::from_value(Value::Object(self.defaults())).expect("keys without a default may be absent")
    }

    /// The table of an empty document: all defaults.
    pub(super) fn defaults(&self) -> Map<String, Value> {
        self.fields().filter_map(|f| Some((f.key.to_owned(), f.default_value()?))).collect()
    }
}

impl Field {
    /// The row of a key that must be given.
    pub(super) const fn required(key: &'static str, kind: Kind, doc: &'static str) -> Self {
        required(kind).named(key, doc)
    }

    /// The row of a key that may be absent; `meaning` says what happens then.
    pub(super) const fn optional(key: &'static str, kind: Kind, meaning: &'static str, doc: &'static str) -> Self {
        optional(kind, meaning).named(key, doc)
    }

    /// The row of a key with a default.
    pub(super) const fn defaulted(key: &'static str, kind: Kind, default: Absent, doc: &'static str) -> Self {
        defaulted(kind, default).named(key, doc)
    }

    /// The same row of a key with this name and meaning.
    pub(super) const fn named(mut self, key: &'static str, doc: &'static str) -> Self {
        (self.key, self.doc) = (key, doc.trim_ascii());
        self
    }

    /// The same key with a second spelling.
    pub(super) const fn alias(mut self, alias: &'static str) -> Self {
        self.alias = Some(alias);
        self
    }

    /// The same key, which other programs call by these names.
    pub(super) const fn known_as(mut self, synonyms: &'static [&'static str]) -> Self {
        self.synonyms = synonyms;
        self
    }

    /// The value when the key is absent, in the form the case is deserialised from.
    pub(super) fn default_value(&self) -> Option<Value> {
        Some(match &self.default {
            Absent::Required | Absent::Nothing(_) => return None,
            Absent::Number(x) => json!(x),
            Absent::Integer(n) => json!(n),
            Absent::Flag(flag) => json!(flag),
            Absent::Words(words) => json!(words),
            Absent::Word(word) => match &self.kind {
                Kind::Choice(variants) => variants.iter().find(|v| v.name == *word)?.bare(),
                _ => json!(word),
            },
            Absent::Filled => match &self.kind {
                Kind::Table(table) => Value::Object(table.defaults()),
                _ => json!([]),
            },
        })
    }

    /// The default in words, none when the key must be given.
    pub(super) fn default_words(&self) -> Option<String> {
        match &self.default {
            Absent::Required => None,
            Absent::Nothing(meaning) => Some((*meaning).to_owned()),
            Absent::Number(x) => Some(format!("`{x}`")),
            Absent::Integer(n) => Some(format!("`{n}`")),
            Absent::Flag(flag) => Some(format!("`{flag}`")),
            Absent::Word(word) => Some(format!("`\"{word}\"`")),
            Absent::Words(words) => Some(format!("`{words:?}`")),
            Absent::Filled if matches!(self.kind, Kind::Table(_)) => Some("see its keys".to_owned()),
            Absent::Filled => Some("none".to_owned()),
        }
    }
}

/// A key that must be given.
pub(super) const fn required(kind: Kind) -> Field {
    Field { key: "", alias: None, synonyms: &[], doc: "", kind, default: Absent::Required }
}

/// A key that may be absent; `meaning` says what happens then.
pub(super) const fn optional(kind: Kind, meaning: &'static str) -> Field {
    Field { default: Absent::Nothing(meaning), ..required(kind) }
}

/// A key with a default.
pub(super) const fn defaulted(kind: Kind, default: Absent) -> Field {
    Field { default, ..required(kind) }
}

/// Tables of the case file, each as the type that it is read into and the static [`Table`] of its keys.
///
/// An entry is `name: Type = row`, or `name as "key": Type = row` where the key is no name of Rust; its documentation is the
/// meaning that users read. Fields behind `and` have no key.
macro_rules! keys {
    ($($(#[$meta:meta])* pub struct $name:ident, $table:ident $(.$with:ident($($value:expr),*))* {$(
        $(#[doc = $doc:literal])+
        $(#[serde($($serde:tt)*)])?
        $field:ident $(as $key:literal)?: $type:ty = $row:expr,
    )+} $(and {$($(#[doc = $more_doc:literal])+ $(#[serde($($more_serde:tt)*)])? $more:ident: $more_type:ty,)+})?)+) => {$(
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        pub struct $name {
            $($(#[doc = $doc])+ $(#[serde($($serde)*)])? $(#[serde(rename = $key)])? pub $field: $type,)+
            $($($(#[doc = $more_doc])+ $(#[serde($($more_serde)*)])? pub $more: $more_type,)+)?
        }

        pub(in crate::case) static $table: $crate::case::schema::Table =
            $crate::case::schema::Table::of(&[$($row.named(keys!(@key $field $($key)?), concat!($($doc),+))),+])$(.$with($($value),*))*;
    )+};
    (@key $field:ident) => { stringify!($field) };
    (@key $field:ident $key:literal) => { $key };
}

/// Words that keys of the case file hold, each as an enumeration and the list of words with their meanings.
///
/// An entry is `Variant = "word"`; its documentation is the meaning that users read. Variants behind `and` have no word. A variant
/// behind the name of the list is the default.
macro_rules! words {
    ($($(#[$meta:meta])* pub enum $name:ident, $words:ident $(= $default:ident)? {$(
        $(#[doc = $doc:literal])+
        $variant:ident = $word:literal,
    )+} $(and {$($(#[doc = $more_doc:literal])+ $more:ident,)+})?)+) => {$(
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        pub enum $name {
            $($(#[doc = $doc])+ #[serde(rename = $word)] $variant,)+
            $($($(#[doc = $more_doc])+ $more,)+)?
        }

        impl $name {
            /// All that have a word in the case file.
            pub const ALL: [Self; [$($word),+].len()] = [$(Self::$variant),+];

            /// The word in the case file; empty where there is none.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                    $($(Self::$more => "",)+)?
                }
            }
        }

        $(impl Default for $name {
            fn default() -> Self {
                Self::$default
            }
        })?

        pub(in crate::case) const $words: &[(&str, &str)] = &[$(($word, concat!($($doc),+).trim_ascii())),+];
    )+};
}
pub(super) use {keys, words};

impl Variant {
    /// An alternative without keys.
    pub(super) const fn word(name: &'static str, doc: &'static str) -> Self {
        Self { name, doc, table: None, rules: false }
    }

    /// An alternative with a table of keys.
    pub(super) const fn table(name: &'static str, table: &'static Table, doc: &'static str) -> Self {
        Self { name, doc, table: Some(table), rules: false }
    }

    /// The same; where others are given beside it they are left aside.
    pub(super) const fn ruling(mut self) -> Self {
        self.rules = true;
        self
    }

    /// The value of the bare word.
    pub(super) fn bare(&self) -> Value {
        match self.table {
            Some(table) => json!({ self.name: table.defaults() }),
            None => json!(self.name),
        }
    }

    /// The bare word is enough: every key of the table has a default.
    pub(super) fn is_word(&self) -> bool {
        self.table.is_none_or(|t| t.fields().all(|f| !matches!(f.default, Absent::Required)))
    }
}

impl Kind {
    /// The unit that serves several values of which none has one.
    pub(super) fn usual_unit(&self) -> &'static str {
        if let Self::Quantity(dimension, _) = self { dimension.usual() } else { "" }
    }

    /// What may be written, in words.
    pub(super) fn words(&self) -> String {
        let with = |what: String, range: &Range| match range.words() {
            Some(words) => format!("{what} {words}"),
            None => what,
        };
        match self {
            Self::Number(range) => with("a number".to_owned(), range),
            Self::Quantity(dimension, range) => {
                with(format!("{} like `\"{}\"`", dimension.name, dimension.example), range)
            }
            Self::Values(one) => format!("{}, a list of them, or `\"first:last:step\"`", one.words()),
            Self::Integer(min, max) if *max >= u64::from(u32::MAX) => format!("a whole number, at least {min}"),
            Self::Integer(min, max) => format!("a whole number from {min} to {max}"),
            Self::IntegerOr(min, max, word) => format!("a whole number from {min} to {max} or `\"{word}\"`"),
            Self::Flag => "`true` or `false`".to_owned(),
            Self::Text | Self::File | Self::Matching(_) => "a text in quotes".to_owned(),
            Self::Words(words) => one_of(words.iter().map(|w| w.0)),
            Self::Formula => "a formula in quotes or a number".to_owned(),
            Self::TableOr(_, word) => format!("a table or `\"{word}\"`"),
            Self::List(list) => list.words(),
            Self::Table(table) => match table.shorthand.and_then(|key| table.field(key)) {
                Some(field) => format!("{} or a table", field.kind.words()),
                None => "a table".to_owned(),
            },
            Self::Tables(_) => "a table or an array of tables".to_owned(),
            Self::Choice(variants) => one_of(variants.iter().map(|v| v.name)),
        }
    }
}

impl List {
    fn words(&self) -> String {
        let words = self.item.words();
        let item = words.as_str();
        let item = item.strip_prefix("a ").or_else(|| item.strip_prefix("an ")).unwrap_or(item);
        let count = match (self.min, self.max) {
            (min, max) if min == max => format!("{min} values"),
            (min, usize::MAX) => format!("{min} or more values"),
            (min, max) => format!("{min} to {max} values"),
        };
        let list = format!("a list of {count} ({item})");
        if self.single { format!("{words} or {list}") } else { list }
    }
}

/// `\`a\`, \`b\` or \`c\``.
pub(super) fn one_of<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = names.map(|n| format!("`{n}`")).collect();
    match quoted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => quoted.concat(),
    }
}
