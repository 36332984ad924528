//! What a page is made of, and the template that sets it.
//!
//! Chapters are plain data: headings, tables, facts, charts. Their words are escaped where `templates/page.html` sets them, so
//! that no other file writes a tag. A page asks nothing from any network: style, script and pictures stand in it.
use askama::Template;

use super::chart::{Chart, Size};
use super::{ReportError, data_address};

/// Letters of an entry of a table that are set in one line.
const ONE_LINE: usize = 28;
/// More points than this are thinned out in charts: a screen has fewer pixels.
const MAX_POINTS: usize = 6000;
const STYLE: &str = include_str!("../../templates/page.css");
const SCRIPT: &str = include_str!("../../templates/chart.js");
const VIEWER: &str = include_str!("../../templates/viewer.js");
const SURFACE: &str = include_str!("../../templates/surface.js");
const MODES: &str = include_str!("../../templates/modes.js");

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
    pub(super) name: String,
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
    /// A field that answers to the pointer: what the script of the page needs, as JSON.
    Viewer(String),
    /// Walls that turn with the pointer: what the script of the page needs, as JSON.
    Surface(String),
    /// A surface that moves in modes: what the script of the page needs, as JSON.
    Modes(String),
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
    /// How it is set: `n` as a number, `t` as text of several lines, `good` and `bad` as a verdict.
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
    /// The chart as drawn.
    svg: String,
    /// Its numbers, for the script of the page.
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

    fn has_viewer(&self) -> bool {
        self.sections.iter().flat_map(|s| &s.blocks).any(|block| matches!(block, Block::Viewer(_)))
    }

    fn has_surface(&self) -> bool {
        self.sections.iter().flat_map(|s| &s.blocks).any(|block| matches!(block, Block::Surface(_)))
    }

    fn has_modes(&self) -> bool {
        self.sections.iter().flat_map(|s| &s.blocks).any(|block| matches!(block, Block::Modes(_)))
    }

    /// What a terminal shows of the page: its lines and tables.
    pub(super) fn text(&self) -> String {
        let plain = |text: &String| format!("{}\n", text.replace('`', ""));
        let mut text: String = self.lead.iter().map(plain).collect();
        for section in &self.sections {
            text.push_str(&format!("\n{}\n", section.title));
            for block in &section.blocks {
                match block {
                    Block::Text(line) | Block::LeftOut(line) | Block::Heading(line) => text.push_str(&plain(line)),
                    Block::List(lines) => text.extend(lines.iter().map(plain)),
                    Block::Table(table) => text.push_str(&table.text()),
                    _ => {}
                }
            }
        }
        text
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
        Self::Chart(Figure::new(chart, Size::PAGE))
    }

    /// A chart of its own size.
    pub(super) fn sized_chart(chart: Chart, size: Size) -> Self {
        Self::Chart(Figure::new(chart, size))
    }

    /// Small charts, one beside the other.
    pub(super) fn charts(charts: impl Iterator<Item = Chart>) -> Self {
        Self::Charts(charts.map(|chart| Figure::new(chart, Size::SMALL)).collect())
    }
}

impl Figure {
    fn new(mut chart: Chart, size: Size) -> Self {
        chart.thin(MAX_POINTS);
        // `<` cannot stand in a script element: it might end it.
        let data = serde_json::to_string(&chart.data(size)).unwrap_or_default().replace('<', "\\u003c");
        Self { svg: chart.draw(size).svg().unwrap_or_default(), title: chart.title, data }
    }
}

impl Fact {
    pub(super) fn new(name: &str, value: String) -> Self {
        Self { name: name.to_owned(), value }
    }
}

impl Table {
    /// A table of text; entries that look like numbers are set as such, and columns in which nothing is told are left out.
    pub(super) fn new(columns: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        let rows: Vec<Vec<String>> = rows.into_iter().collect();
        let known =
            |k: &usize| rows.iter().any(|row| row.get(*k).is_some_and(|text| !["", "–"].contains(&text.as_str())));
        let kept: Vec<usize> = (0..columns.len()).filter(|k| rows.is_empty() || known(k)).collect();
        let row = |row: &Vec<String>| kept.iter().filter_map(|k| row.get(*k).cloned()).map(Cell::from).collect();
        Self { columns: kept.iter().map(|k| columns[*k].to_owned()).collect(), rows: rows.iter().map(row).collect() }
    }

    /// Columns below one another, numbers and what stands above them to the right.
    fn text(&self) -> String {
        let head = self.columns.iter().map(|name| Cell { text: name.clone(), class: "", link: None });
        let head: Vec<Cell> = head.collect();
        let lines = || std::iter::once(&head).chain(&self.rows);
        let at = |row: &Vec<Cell>, k: usize| row.get(k).map_or(0, |cell| cell.text.chars().count());
        let widths: Vec<usize> =
            (0..self.columns.len()).map(|k| lines().map(|row| at(row, k)).max().unwrap_or(0)).collect();
        let number = |k: usize| self.rows.iter().any(|row| row.get(k).is_some_and(|cell| cell.class == "n"));
        let entry = |(k, cell): (usize, &Cell)| {
            let (text, width) = (&cell.text, widths.get(k).copied().unwrap_or(0));
            if number(k) { format!("{text:>width$}") } else { format!("{text:<width$}") }
        };
        let line = |row: &Vec<Cell>| row.iter().enumerate().map(entry).collect::<Vec<_>>().join("  ");
        lines().map(|row| format!("{}\n", line(row).trim_end())).collect()
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        let number = text.starts_with(|c: char| c.is_ascii_digit() || "\u{2212}-+–±".contains(c));
        let class = match number {
            true => "n",
            false if text.chars().count() > ONE_LINE => "t",
            false => "",
        };
        Self { text, class, link: None }
    }
}

impl Picture {
    /// The picture file `name`, PNG or SVG.
    pub(super) fn new(name: &str, bytes: &[u8]) -> Self {
        let kind = if name.ends_with(".svg") { "svg+xml" } else { "png" };
        let caption = name.rsplit_once('.').map_or(name, |(stem, _)| stem).replace(['-', '_'], " ");
        Self { caption, data: data_address(kind, bytes) }
    }
}

/// Text with `names` in back quotes as code; without a partner a back quote is one.
fn spans(text: &str) -> Vec<Span<'_>> {
    let pieces: Vec<&str> = text.split('`').collect();
    match pieces.len() % 2 {
        1 => pieces.into_iter().enumerate().map(|(k, text)| Span { code: k % 2 == 1, text }).collect(),
        _ => vec![Span { code: false, text }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::overview::tests::assert_balanced;
    use crate::report::{Axis, Marks, Series};

    #[test]
    fn words_of_a_page_are_escaped_wherever_they_stand() {
        let word = || "<b>α & \"β\"".to_owned();
        let link = Cell { text: word(), class: "good", link: Some("./a?b=\"c\"&d".to_owned()) };
        let line = Series::new(&word(), Marks::Line, vec![0.0, 1.0], vec![1.0, f64::NAN]);
        let bars = Series::new("</script>", Marks::Bars, vec![0.0, 1.0, 2.0], vec![1.0, 2.0]);
        let axis = || Axis::linear(&word());
        let chart = || Chart { title: word(), x: axis(), y: axis(), series: vec![line.clone(), bars.clone()] };
        let blocks = vec![
            Block::Heading(word()),
            Block::Text(word()),
            Block::LeftOut(format!("`{}` is not there", word())),
            Block::Facts(vec![Fact::new(&word(), word())]),
            Block::Table(Table { columns: vec![word()], rows: vec![vec![link]] }),
            Block::List(vec![word()]),
            Block::chart(chart()),
            Block::charts([chart(), chart()].into_iter()),
            Block::Pictures(vec![Picture::new(&word(), b"")]),
            Block::Code(word()),
        ];
        let page = Page {
            title: word(),
            status: Some(Status { class: "good", verdict: word(), facts: word() }),
            lead: Some(word()),
            cards: vec![Card { name: "<b>".to_owned(), value: word(), facts: vec![Fact::new(&word(), word())] }],
            sections: vec![Section { id: "all", title: word(), blocks }],
        };
        let html = page.html().unwrap();
        assert_balanced(&html);
        assert!(!html.contains("<b>") && !html.contains("& \"") && !html.contains("?b=\""));
        assert_eq!(html.matches("</script>").count(), 4, "three charts and the script of the page");
        assert!(html.contains("<code>&#60;b&#62;α"));
    }

    #[test]
    fn tables_have_no_empty_columns_and_long_text_has_room() {
        let row = |all: [&str; 4]| all.map(str::to_owned).to_vec();
        let long = "error bar of CD longer than asked for";
        let table = Table::new(&["", "a", "b", "c"], [row(["x", "–", "", "1"]), row(["", "–", "", long])]);
        assert_eq!(table.columns, ["", "c"]);
        let classes: Vec<Vec<&str>> = table.rows.iter().map(|row| row.iter().map(|c| c.class).collect()).collect();
        assert_eq!(classes, [["", "n"], ["", "t"]]);
        assert_eq!(Table::new(&["a", "b"], []).columns, ["a", "b"]);
    }

    #[test]
    fn a_back_quote_without_a_partner_is_one() {
        let told = |text: &'static str| spans(text).iter().map(|s| (s.code, s.text)).collect::<Vec<_>>();
        assert_eq!(told("no `case.toml` here"), [(false, "no "), (true, "case.toml"), (false, " here")]);
        assert_eq!(told("a ` b"), [(false, "a ` b")]);
    }
}
