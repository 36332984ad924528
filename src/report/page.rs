//! What a page is made of, and the template that sets it.
//!
//! Chapters are plain data: headings, tables, facts, charts. Their words are escaped where `templates/page.html` sets them, so
//! that no other file writes a tag. A page asks nothing from any network: style, script and pictures stand in it.
use askama::Template;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

use super::ReportError;
use super::chart::Chart;

/// More points than this are thinned out in charts: a screen has fewer pixels.
const MAX_POINTS: usize = 6000;
const STYLE: &str = include_str!("../../templates/page.css");
const SCRIPT: &str = include_str!("../../templates/chart.js");

/// A whole page.
#[derive(Default, Template)]
#[template(path = "page.html")]
pub(super) struct Page {
    pub(super) title: String,
    /// A line below the title that begins with a verdict.
    pub(super) status: Option<Status>,
    /// A line below the title; names in back quotes are code.
    pub(super) lead: Option<String>,
    pub(super) cards: Vec<Card>,
    pub(super) sections: Vec<Section>,
}

/// A verdict and what else is to be said in one line.
pub(super) struct Status {
    /// How it is coloured: `good`, `bad` or `unknown`.
    pub(super) class: &'static str,
    pub(super) verdict: String,
    pub(super) facts: String,
}

/// A number in large type with facts below it.
pub(super) struct Card {
    pub(super) name: &'static str,
    pub(super) value: String,
    pub(super) facts: Vec<Fact>,
}

/// A name and its value.
pub(super) struct Fact {
    pub(super) name: String,
    pub(super) value: String,
}

/// A chapter.
pub(super) struct Section {
    /// What links point at; empty for a section that none points at.
    pub(super) id: &'static str,
    pub(super) title: String,
    pub(super) blocks: Vec<Block>,
}

/// A piece of a chapter.
pub(super) enum Block {
    /// A heading below that of the chapter.
    Heading(String),
    /// A paragraph; names in back quotes are code.
    Text(String),
    /// A paragraph that says why something is missing; names in back quotes are code.
    LeftOut(String),
    Facts(Vec<Fact>),
    Table(Table),
    /// Lines; names in back quotes are code.
    List(Vec<String>),
    /// A chart as wide as the page.
    Chart(Figure),
    /// Small charts, one beside the other.
    Charts(Vec<Figure>),
    Pictures(Vec<Picture>),
    /// Text as it is.
    Code(String),
}

/// Rows below the names of their columns, which may be absent.
#[derive(Default)]
pub(super) struct Table {
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Vec<Cell>>,
}

/// An entry of a table.
pub(super) struct Cell {
    pub(super) text: String,
    /// How it is set: `n` as a number, `good` and `bad` as a verdict.
    pub(super) class: &'static str,
    /// Where it leads, if anywhere.
    pub(super) link: Option<String>,
}

/// A picture in a file, with words below it.
pub(super) struct Picture {
    pub(super) caption: String,
    /// The file as an address that holds all of it.
    pub(super) data: String,
}

/// A chart that answers to the pointer.
pub(super) struct Figure {
    title: String,
    /// The chart as an address that holds its picture, for readers without scripts.
    picture: String,
    /// What the script of the page draws.
    data: String,
}

/// A part of a line.
struct Span<'a> {
    code: bool,
    text: &'a str,
}

impl Page {
    /// The page as a document.
    pub(super) fn html(&self) -> Result<String, ReportError> {
        Ok(self.render()?)
    }
}

impl Section {
    /// A chapter, or the word why there is none.
    pub(super) fn new(id: &'static str, title: &str, content: Result<Vec<Block>, String>) -> Self {
        let blocks = content.unwrap_or_else(|reason| vec![Block::LeftOut(reason)]);
        Self { id, title: title.to_owned(), blocks }
    }
}

impl Block {
    /// A chart as wide as the page.
    pub(super) fn chart(chart: Chart) -> Self {
        Self::Chart(Figure::new(chart))
    }

    /// Small charts, one beside the other.
    pub(super) fn charts(charts: impl Iterator<Item = Chart>) -> Self {
        Self::Charts(charts.map(Figure::new).collect())
    }
}

impl Figure {
    fn new(mut chart: Chart) -> Self {
        chart.thin(MAX_POINTS);
        // `<` cannot stand in a script element: it might end it.
        let data = serde_json::to_string(&chart).unwrap_or_default().replace('<', "\\u003c");
        let picture = address("svg+xml", chart.svg().unwrap_or_default().as_bytes());
        Self { title: chart.title, picture, data }
    }
}

impl Fact {
    pub(super) fn new(name: &str, value: String) -> Self {
        Self { name: name.to_owned(), value }
    }
}

impl Table {
    /// A table of text; entries that look like numbers are set as such.
    pub(super) fn new(columns: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        let row = |row: Vec<String>| row.into_iter().map(Cell::from).collect();
        Self { columns: columns.iter().map(|c| (*c).to_owned()).collect(), rows: rows.into_iter().map(row).collect() }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        let number = text.starts_with(|c: char| c.is_ascii_digit() || "\u{2212}-+–±".contains(c));
        Self { text, class: if number { "n" } else { "" }, link: None }
    }
}

impl Picture {
    /// The picture file `name`, PNG or SVG.
    pub(super) fn new(name: &str, bytes: &[u8]) -> Self {
        let kind = if name.ends_with(".svg") { "svg+xml" } else { "png" };
        let caption = name.rsplit_once('.').map_or(name, |(stem, _)| stem).replace(['-', '_'], " ");
        Self { caption, data: address(kind, bytes) }
    }
}

/// A picture as an address that holds all of it.
fn address(kind: &str, bytes: &[u8]) -> String {
    format!("data:image/{kind};base64,{}", STANDARD.encode(bytes))
}

/// Text with `names` in back quotes as code; without a partner a back quote is one.
fn spans(text: &str) -> Vec<Span<'_>> {
    let pieces: Vec<&str> = text.split('`').collect();
    match pieces.len() % 2 {
        1 => pieces.into_iter().enumerate().map(|(k, text)| Span { code: k % 2 == 1, text }).collect(),
        _ => vec![Span { code: false, text }],
    }
}
