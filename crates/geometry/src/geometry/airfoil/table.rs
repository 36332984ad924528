//! What of an airfoil file is coordinates, and what is title, counts, header or remark.
//!
//! Public files begin with titles of any kind, with counts of points or with the limits of a grid, and end with remarks of those who
//! drew or changed the section. A line is a row of coordinates when it holds numbers and nothing else, or numbers before a remark next to
//! such rows. Lines of text are left out and told; a row that is damaged is refused, since the shape without it would be another one.
use super::super::GeometryError;
use super::super::marks::Mark;
use crate::case::decimal_comma;
use crate::math::{Bounds, Vector};

/// Part of the extent of a section that two points next to one another are apart at most, where no order is known yet.
const NEXT: f64 = 0.25;
/// Height over the greatest one up to which an end of a side lies on the axis.
const AXIS: f64 = 0.05;
/// Distance of both sides from one another over the greatest one up to which they come together.
const ENDS: f64 = 0.5;
/// Letters of a line that a note repeats.
const TOLD: usize = 60;

/// One row of coordinates.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) mark: Mark,
    /// The point of the lower side, where a row has one of each.
    pub(super) lower: Option<Mark>,
    /// What the column `surface` says, in small letters.
    pub(super) surface: String,
}

/// A file as read: its rows, and what is said of their order.
pub(super) struct Table {
    pub(super) rows: Vec<Row>,
    /// Numbers of points of both sides, and their line.
    pub(super) counts: Option<([usize; 2], usize)>,
    /// A header says that there are more columns than are read.
    pub(super) has_more: bool,
    /// Rows have the column `surface`.
    pub(super) has_surface: bool,
}

/// A line without its comment.
struct Line<'t> {
    number: usize,
    text: &'t str,
    words: Vec<&'t str>,
}

/// Where the coordinates stand in a row.
#[derive(Clone)]
struct Columns {
    /// Words before the names of the columns, none of a file without a header.
    ahead: usize,
    point: [usize; 2],
    lower: Option<[usize; 2]>,
    surface: Option<usize>,
    section: Option<usize>,
    scale: [f64; 2],
    has_more: bool,
    /// What stands between the columns of a table; otherwise blanks, commas and semicolons do.
    between: Option<char>,
}

/// What a line of a file without a header is.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Numbers alone, at least two.
    Row,
    /// Two numbers or more, then a remark.
    Remarked,
    /// A number or two of which one cannot be read.
    Damaged,
    Text,
}

/// Reads `text`; `file` names it in messages, `notes` says what was left out.
pub(super) fn read(file: &str, text: &str, notes: &mut Vec<String>) -> Result<Table, GeometryError> {
    let lines: Vec<Line<'_>> = text.lines().enumerate().filter_map(|(i, line)| Line::of(i + 1, line)).collect();
    let begins = lines.iter().position(|l| kind(&l.words) == Kind::Row).unwrap_or(lines.len());
    let header = lines[..begins].iter().enumerate().find_map(|(k, l)| Some((k, Columns::of(l, lines.get(begins))?)));
    match header {
        Some((k, columns)) => {
            let columns = columns.in_space(&lines[k], &lines[k + 1..]);
            with_header(file, &lines[k], &columns, &lines[k + 1..], notes)
        }
        None => without_header(file, &lines, notes),
    }
}

/// The name of a column in small letters, without signs of a comment and words before it.
fn name(word: &str) -> String {
    shown(word).trim_start_matches(['%', '*', '/']).to_lowercase()
}

/// The name of a column as it stands in a header.
fn shown(word: &str) -> &str {
    word.rsplit('=').next().unwrap_or(word).trim_matches(['"', ' '])
}

fn is_x(name: &str) -> bool {
    ["x", "xu", "xl"].contains(&name) || name.starts_with("x_") || name.starts_with("x/")
}

fn is_upper(name: &str) -> bool {
    name.contains("up") || ["yu", "zu"].contains(&name) || name.ends_with("_u")
}

fn is_lower(name: &str) -> bool {
    name.contains("low") || ["yl", "zl"].contains(&name) || name.ends_with("_l")
}

/// A finite number below 1e100 in magnitude, so that squares stay finite. Exponents of Fortran and minus signs of typesetters are read.
fn number(word: &str) -> Option<f64> {
    let plain = || word.parse::<f64>().ok();
    let foreign = || word.replace(['d', 'D'], "e").replace(['\u{2212}', '\u{2013}'], "-").parse::<f64>().ok();
    let begins = |c: char| c.is_ascii_digit() || "+-.\u{2212}\u{2013}".contains(c);
    let value = if word.starts_with(begins) { plain().or_else(foreign) } else { plain() };
    value.filter(|v| v.abs() < 1e100)
}

/// True for words that were meant as numbers: `1.00.3`, `O.5`, `nan`, `****`.
fn was_number(word: &str) -> bool {
    let small = word.to_lowercase();
    let count = |which: fn(char) -> bool| small.chars().filter(|c| which(*c)).count();
    let (letters, digits) = (count(char::is_alphabetic), count(|c| c.is_ascii_digit()));
    let named = ["nan", "inf", "-nan", "-inf"].iter().any(|n| small.starts_with(n));
    named || (small.contains('.') && digits > 0 && digits >= letters) || small.chars().all(|c| "*.-?".contains(c))
}

/// True for a row of numbers that are not there, `nan nan` or `******** 0.04`; rows of dashes are rules.
fn is_lost(words: &[&str]) -> bool {
    let lost = |w: &&str| {
        let small = w.trim_start_matches(['-', '+']).to_lowercase();
        ["nan", "inf", "infinity"].contains(&small.as_str()) || w.chars().all(|c| "*?".contains(c))
    };
    words.len() > 1 && words.iter().all(|w| was_number(w) || number(w).is_some()) && words.iter().any(lost)
}

fn kind(words: &[&str]) -> Kind {
    let leading = words.iter().take_while(|w| number(w).is_some()).count();
    let damaged = |k: usize| words.get(k).is_some_and(|w| was_number(w));
    match leading {
        n if n == words.len() && n >= 2 => Kind::Row,
        n if n >= 2 => Kind::Remarked,
        1 if words.len() <= 2 || damaged(1) => Kind::Damaged,
        0 if is_lost(words) => Kind::Damaged,
        0 if words.len() == 2 && damaged(0) && number(words[1]).is_some() => Kind::Damaged,
        _ => Kind::Text,
    }
}

impl<'t> Line<'t> {
    /// A line that is not empty.
    fn of(number: usize, line: &'t str) -> Option<Self> {
        let text = line.split(['#', '!']).next().unwrap_or("").trim().trim_start_matches('\u{feff}');
        let words = text.split(|c: char| c == ',' || c == ';' || c.is_whitespace());
        let words: Vec<&str> = words.map(|w| w.trim_matches('"')).filter(|w| !w.is_empty()).collect();
        (!words.is_empty()).then_some(Self { number, text, words })
    }

    /// The cells of a row of a table whose empty cells count.
    fn cells(&self, between: Option<char>) -> Vec<&'t str> {
        match between.filter(|c| self.text.contains(*c)) {
            Some(c) => self.text.split(c).map(|w| w.trim().trim_matches('"').trim()).collect(),
            None => self.words.clone(),
        }
    }

    fn refused(&self, file: &str, what: impl Into<String>, hint: &str) -> GeometryError {
        GeometryError::refused(format!("{file}, line {}", self.number), what, hint)
    }

    /// Why a row is not read.
    fn damaged(&self, file: &str) -> GeometryError {
        let bad = self.words.iter().find(|w| number(w).is_none());
        match bad {
            Some(word) => self.refused(file, format!("`{word}` is not a finite number"), "write rows as `x y`"),
            None => self.refused(file, "has 1 value", "every row needs two coordinates, `x y`"),
        }
    }

    /// Refuses a row whose numbers have decimal commas: two values would be read as four.
    fn no_decimal_commas(&self, file: &str) -> Result<(), GeometryError> {
        let Some(word) = decimal_comma(self.text) else { return Ok(()) };
        Err(self.refused(file, format!("`{word}` has a decimal comma"), "write decimals with a point, `0.5`"))
    }

    fn shortened(&self) -> String {
        let begin: String = self.text.chars().take(TOLD).collect();
        if begin.len() < self.text.len() { format!("{begin} ...") } else { begin }
    }
}

impl Columns {
    /// Columns without a header.
    fn plain(point: [usize; 2]) -> Self {
        Self {
            ahead: 0,
            point,
            lower: None,
            surface: None,
            section: None,
            scale: [1.0; 2],
            has_more: false,
            between: None,
        }
    }

    /// Columns of a header, none when the line is a title; `row` is the first row of numbers after it. Where a header has more words than that
    /// row has numbers, the first ones are no names: `VARIABLES = "X" "Y"`, `% x y`.
    fn of(line: &Line<'_>, row: Option<&Line<'_>>) -> Option<Self> {
        let between = [';', '\t', ','].into_iter().find(|c| line.text.contains(*c));
        let mut names: Vec<String> = line.cells(between).iter().map(|w| name(w)).collect();
        let first = names.iter().position(|n| is_x(n))?;
        let width = row.map_or(usize::MAX, |row| row.cells(between).len());
        let more = names.len().saturating_sub(width);
        // `no. x y remark` may have rows without a remark
        let no_names = names.iter().take(more).all(|n| n.is_empty() || n == "variables");
        let ahead = if more <= first && (no_names || first + 1 >= width) { more } else { 0 };
        names.drain(..ahead);
        let x = first - ahead;
        let y = x + 1;
        let of = |side: fn(&str) -> bool| (y..names.len()).find(|k| side(&names[*k]) && !names[*k].starts_with('x'));
        let own = |k: usize| if k > y && names[k - 1].starts_with('x') { k - 1 } else { x };
        let sides = of(is_upper).zip(of(is_lower)).filter(|(u, l)| *u.min(l) == y);
        // `x` may be a word of a title as well
        let both = sides.is_some_and(|(u, l)| u.max(l) < width);
        names.get(y).filter(|n| both || n.starts_with(['y', 'z']) || n.contains("thick"))?;
        let point = sides.map_or([x, y], |(upper, _)| [own(upper), upper]);
        let find = |what: &str| names.iter().position(|n| n == what);
        let scale = |n: &str| if n.contains("pct") || n.contains('%') { 0.01 } else { 1.0 };
        Some(Self {
            ahead,
            point,
            lower: sides.map(|(_, lower)| [own(lower), lower]),
            surface: find("surface"),
            section: find("section"),
            scale: point.map(|k| scale(&names[k])),
            has_more: names[y].contains("thick") || names.len() > y + 1,
            between,
        })
    }

    /// The columns of a section in a plane of space, `x y z` of which one does not change in the rows among `lines`.
    fn in_space(mut self, header: &Line<'_>, lines: &[Line<'_>]) -> Self {
        let names: Vec<String> = header.cells(self.between)[self.ahead..].iter().map(|w| name(w)).collect();
        let [x, y] = self.point;
        let begins = |k: usize, letter: char| names.get(k).is_some_and(|n| n.starts_with(letter));
        if self.lower.is_some() || y != x + 1 || !begins(y, 'y') || !begins(y + 1, 'z') {
            return self;
        }
        let constant = |k: &usize| {
            let values = lines.iter().filter_map(|l| number(l.cells(self.between).get(*k)?));
            let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
            low == high
        };
        let changing: Vec<usize> = (x..=y + 1).filter(|k| !constant(k)).collect();
        if let [first, second] = changing[..]
            && [first, second] != [x, y]
        {
            (self.point, self.scale) = ([first, second], [self.scale[0]; 2]);
        }
        self
    }

    /// The point of a row in two of its columns.
    fn mark(&self, [x, y]: [usize; 2], value: impl Fn(usize) -> Option<f64>, line: usize) -> Option<Mark> {
        Some(Mark { point: Vector([value(x)? * self.scale[0], value(y)? * self.scale[1]]), line })
    }
}

/// The rows of a table with a header.
fn with_header(
    file: &str,
    header: &Line<'_>,
    columns: &Columns,
    lines: &[Line<'_>],
    notes: &mut Vec<String>,
) -> Result<Table, GeometryError> {
    let [x, y] = columns.point;
    let names = &header.cells(columns.between)[columns.ahead..];
    let names: Vec<&str> = names.iter().map(|w| shown(w)).collect();
    let mut table =
        Table { rows: Vec::new(), counts: None, has_more: columns.has_more, has_surface: columns.surface.is_some() };
    let mut of = format!("`{}` and `{}`", names[x], names[y]);
    if let Some([_, k]) = columns.lower {
        of += &format!(", `{}` for the lower side", names[k]);
    }
    notes.push(format!("{file}: coordinates from columns {of}"));
    let (mut remarks, mut section) = (Vec::new(), None);
    for line in lines {
        let cells = line.cells(columns.between);
        let read = [x, y].map(|k| cells.get(k).and_then(|w| number(w)));
        if read == [None, None] && kind(&line.words) == Kind::Text && !was_number(line.words[0]) {
            remarks.push(line);
            continue;
        }
        line.no_decimal_commas(file)?;
        let told = [x, y].into_iter().chain(columns.lower.into_iter().flatten());
        let last = told.clone().chain(columns.surface).chain(columns.section).max().unwrap_or(y);
        if cells.len() <= last {
            let what = format!("has {} values where the header has {}", cells.len(), names.len());
            return Err(line.refused(file, what, "every row needs a value in each column"));
        }
        if let Some(bad) = told.map(|k| cells[k]).find(|w| number(w).is_none()) {
            return Err(line.refused(file, format!("`{bad}` is not a finite number"), "write rows as `x y`"));
        }
        if let Some(k) = columns.section
            && *section.get_or_insert(cells[k]) != cells[k]
        {
            let what = format!("a second section `{}` begins", cells[k]);
            return Err(line.refused(file, what, "give one section per file"));
        }
        let value = |k: usize| cells.get(k).and_then(|w| number(w));
        let surface = columns.surface.map_or(String::new(), |k| cells[k].to_lowercase());
        let lower = columns.lower.and_then(|pair| columns.mark(pair, value, line.number));
        table.rows.extend(columns.mark(columns.point, value, line.number).map(|mark| Row { mark, lower, surface }));
    }
    tell(file, &remarks, notes);
    Ok(table)
}

/// The rows of a file without a header.
fn without_header(file: &str, lines: &[Line<'_>], notes: &mut Vec<String>) -> Result<Table, GeometryError> {
    let mut table = Table { rows: Vec::new(), counts: None, has_more: false, has_surface: false };
    let kinds: Vec<Kind> = lines.iter().map(|l| kind(&l.words)).collect();
    let Body { rows: mut body, remarks } = body(file, lines, &kinds)?;
    tell(file, &remarks, notes);
    let width = usual_width(&body);
    while let Some(first) = body.first().filter(|l| l.numbers().len() != width && body.len() > 3) {
        let what = if first.words.len() == 4 { "limits of a grid" } else { "no point" };
        notes.push(format!("{file}: line {}, `{}`, is left out: {what}", first.number, first.shortened()));
        body.remove(0);
    }
    if let Some(odd) = body.iter().find(|l| l.numbers().len() != width) {
        odd.no_decimal_commas(file)?;
        let what = format!("has {} numbers where the other rows have {width}", odd.numbers().len());
        return Err(odd.refused(file, what, "write one point a line, `x y`"));
    }
    for line in &body {
        line.no_decimal_commas(file)?;
    }
    let rows: Vec<(usize, Vec<f64>)> = body.iter().map(|l| (l.number, l.numbers())).collect();
    let columns = columns_of(file, &rows, width, notes);
    for (line, values) in &rows {
        let value = |k: usize| values.get(k).copied();
        let lower = columns.lower.and_then(|pair| columns.mark(pair, value, *line));
        let mark = columns.mark(columns.point, value, *line);
        table.rows.extend(mark.map(|mark| Row { mark, lower, surface: String::new() }));
    }
    if let (2, Some(first)) = (width, lines.first()) {
        leading(file, first.number, &mut table, notes)?;
        refuse_second(file, &table.rows)?;
    }
    Ok(table)
}

impl Line<'_> {
    /// The numbers that the line begins with.
    fn numbers(&self) -> Vec<f64> {
        self.words.iter().map_while(|w| number(w)).collect()
    }
}

/// Lines of a file without a header.
#[derive(Default)]
struct Body<'l, 't> {
    /// Those with coordinates.
    rows: Vec<&'l Line<'t>>,
    /// Those of text among and after them.
    remarks: Vec<&'l Line<'t>>,
}

/// The lines with coordinates, from the first row to the last, and remarks among and after them.
fn body<'l, 't>(file: &str, lines: &'l [Line<'t>], kinds: &[Kind]) -> Result<Body<'l, 't>, GeometryError> {
    let rows = || (0..lines.len()).filter(|k| kinds[*k] == Kind::Row);
    let (Some(mut first), Some(mut last)) = (rows().next(), rows().next_back()) else {
        return match (0..lines.len()).skip(1).find(|k| kinds[*k] == Kind::Damaged) {
            Some(k) => Err(lines[k].damaged(file)),
            None => Ok(Body::default()),
        };
    };
    let follows = |k: usize| lines[k].number == lines[k - 1].number + 1;
    // rows with a remark belong to the rows next to them; the first line is a title
    while first > 1 && kinds[first - 1] == Kind::Remarked && follows(first) {
        first -= 1;
    }
    while last + 1 < lines.len() && kinds[last + 1] == Kind::Remarked && follows(last + 1) {
        last += 1;
    }
    let damaged = |k: &usize| kinds[*k] == Kind::Damaged;
    let within = (first.saturating_sub(1).max(1)..=last).find(damaged);
    let after = Some(last + 1).filter(|k| *k < lines.len() && follows(*k) && damaged(k));
    // a first line with a decimal point is no title
    let before =
        Some(0).filter(|k| first == 1 && damaged(k) && lines[0].words.len() == 2 && lines[0].words[0].contains('.'));
    if let Some(k) = before.or(within).or(after) {
        return Err(lines[k].damaged(file));
    }
    let is_row = |k: &usize| (first..=last).contains(k) && matches!(kinds[*k], Kind::Row | Kind::Remarked);
    let (body, remarks): (Vec<usize>, Vec<usize>) = (first..lines.len()).partition(is_row);
    let of = |all: Vec<usize>| all.into_iter().map(|k| &lines[k]).collect();
    Ok(Body { rows: of(body), remarks: of(remarks) })
}

/// Tells which lines were left out as remarks.
fn tell(file: &str, remarks: &[&Line<'_>], notes: &mut Vec<String>) {
    let Some(first) = remarks.first() else { return };
    let (line, text) = (first.number, first.shortened());
    notes.push(match remarks.len() {
        1 => format!("{file}: line {line} is text and is left out: `{text}`"),
        n => format!("{file}: {n} lines are text and are left out, the first is line {line}: `{text}`"),
    });
}

/// The number of numbers that most rows have.
fn usual_width(rows: &[&Line<'_>]) -> usize {
    let mut times = std::collections::BTreeMap::new();
    rows.iter().for_each(|l| *times.entry(l.numbers().len()).or_insert(0_usize) += 1);
    times.into_iter().max_by_key(|(_, n)| *n).map_or(2, |(width, _)| width)
}

/// Rows of numbers, each with its line.
type Numbers = [(usize, Vec<f64>)];

/// One of the columns of rows.
fn column(rows: &Numbers, k: usize) -> impl Iterator<Item = f64> {
    rows.iter().map(move |(_, values)| values[k])
}

/// True when all differences of a column from row to row are `is`.
fn steps(rows: &Numbers, k: usize, is: impl Fn(f64) -> bool) -> bool {
    column(rows, k).zip(column(rows, k).skip(1)).all(|(a, b)| is(b - a))
}

/// True when a column rises or falls throughout.
fn runs(rows: &Numbers, k: usize) -> bool {
    steps(rows, k, |d| d > 0.0) || steps(rows, k, |d| d < 0.0)
}

/// Columns of rows without a header: a column of running numbers and one that does not change are left out; further columns are the
/// lower side where they are points of it.
fn columns_of(file: &str, rows: &Numbers, width: usize, notes: &mut Vec<String>) -> Columns {
    if width < 3 {
        return Columns::plain([0, 1]);
    }
    let mut used: Vec<usize> = (0..width).collect();
    if counts_rows(rows) || numbers_points(rows) {
        used.remove(0);
    }
    if used.len() > 2 {
        used.retain(|k| !steps(rows, *k, |d| d == 0.0));
    }
    let mut columns = match used[..] {
        [x, y, ..] => Columns::plain([x, y]),
        _ => Columns::plain([0, 1]),
    };
    let below = |a: usize, b: usize| column(rows, a).zip(column(rows, b)).all(|(a, b)| b <= a);
    let negative = |k: usize| column(rows, k).any(|v| v < 0.0);
    match used[..] {
        [x, y, z] if runs(rows, x) && below(y, z) => columns.lower = Some([x, z]),
        [x, y, z] if runs(rows, x) && below(z, y) && negative(y) && has_two_ends(rows, [y, z]) => {
            (columns.point, columns.lower) = ([x, z], Some([x, y]));
        }
        [x, _, u, v] if runs(rows, x) && runs(rows, u) => columns.lower = Some([u, v]),
        _ => {}
    }
    let [x, y] = columns.point.map(|k| k + 1);
    notes.push(match columns.lower.map(|pair| pair.map(|k| k + 1)) {
        Some([u, v]) => format!("{file}: columns {x} and {y} are the upper side, {u} and {v} the lower one"),
        None => format!("{file}: coordinates from columns {x} and {y} of {width}; the others are not used"),
    });
    columns
}

/// True when the first column counts the rows from 0 or 1 on.
fn counts_rows(rows: &Numbers) -> bool {
    steps(rows, 0, |d| d == 1.0) && column(rows, 0).next().is_some_and(|v| v == 0.0 || v == 1.0)
}

/// True when the first column has the numbers of the points in the next two: whole numbers in equal steps, which are no coordinates of a section
/// while those are.
fn numbers_points(rows: &Numbers) -> bool {
    let mut values = column(rows, 0);
    let (Some(first), Some(second), Some(last)) = (values.next(), values.next(), column(rows, 0).last()) else {
        return false;
    };
    let step = second - first;
    if step == 0.0 || column(rows, 0).any(|v| v.fract() != 0.0) || !steps(rows, 0, |d| d == step) {
        return false;
    }
    // percent of the chord, with a half thickness from the nose on or with both sides
    let (low, high) = column(rows, 1).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
    let ends = [column(rows, 1).next(), column(rows, 1).last()];
    let from_axis = low >= 0.0 && ends.iter().flatten().any(|v| *v <= AXIS * high);
    let is_half = (first == 0.0 || last == 0.0) && from_axis;
    let ordered = |a: usize, b: usize| column(rows, a).zip(column(rows, b)).all(|(a, b)| b <= a);
    let are_sides = (ordered(1, 2) || ordered(2, 1)) && has_two_ends(rows, [1, 2]);
    let points: Vec<Mark> = rows.iter().map(|(line, v)| Mark { point: Vector([v[1], v[2]]), line: *line }).collect();
    !is_half && !are_sides && super::is_outline(&points)
}

/// True when two columns come together at the first and at the last row, as both sides of a section do.
fn has_two_ends(rows: &Numbers, [a, b]: [usize; 2]) -> bool {
    let gap = |(_, values): &(usize, Vec<f64>)| (values[a] - values[b]).abs();
    let widest = rows.iter().map(gap).fold(0.0, f64::max);
    rows.first().is_some_and(|r| gap(r) <= ENDS * widest) && rows.last().is_some_and(|r| gap(r) <= ENDS * widest)
}

/// Takes counts of points and a title of two numbers off the beginning of the rows; `line` is the first line of the file.
fn leading(file: &str, line: usize, table: &mut Table, notes: &mut Vec<String>) -> Result<(), GeometryError> {
    while let [first, rest @ ..] = &table.rows[..] {
        let (point, at) = (first.mark.point, first.mark.line);
        let counts = counts(&point);
        if let Some([a, b]) = counts.filter(|[a, b]| a + b == rest.len()) {
            table.counts = Some(([a, b], at));
            table.rows.remove(0);
            return Ok(());
        }
        if rest.len() < 3 || is_point(&point, rest, counts.is_some()) {
            return Ok(());
        }
        if at == line {
            notes.push(format!("{file}: line {at}, two numbers far from all points, is taken as the title"));
        } else if let Some([a, b]) = counts {
            table.counts = Some(([a, b], at));
            table.rows.remove(0);
            return Ok(());
        } else {
            return Ok(());
        }
        table.rows.remove(0);
    }
    Ok(())
}

/// The two counts of a Lednicer file: whole numbers that cannot be coordinates of a unit chord.
fn counts(point: &Vector<2>) -> Option<[usize; 2]> {
    let whole = |v: f64| (2.0..=1e6).contains(&v) && v.fract() == 0.0;
    let [a, b] = point.0;
    (whole(a) && whole(b)).then_some([a as usize, b as usize])
}

/// True when the first row may be a point of the section that the `rest` are points of. Two `whole` numbers are one where they lie next to
/// the first or last of them, other numbers where they are not far from all.
fn is_point(point: &Vector<2>, rest: &[Row], whole: bool) -> bool {
    let bounds = Bounds::around(rest.iter().map(|r| &r.mark.point));
    let size = bounds.extent().max_abs();
    let near = |row: Option<&Row>| row.is_some_and(|r| (r.mark.point - *point).norm() <= NEXT * size);
    if whole { near(rest.first()) || near(rest.last()) } else { bounds.padded(size).contains(point) }
}

/// Refuses what stands in place of a point between two elements.
fn refuse_second(file: &str, rows: &[Row]) -> Result<(), GeometryError> {
    /// The number that separates elements in files of multi-element sections (XFOIL, MSES).
    const SEPARATOR: f64 = 999.0;
    let between = |row: &&Row| row.mark.point[0] == SEPARATOR;
    let Some(row) = rows.iter().skip(1).find(between) else { return Ok(()) };
    let place = format!("{file}, line {}", row.mark.line);
    let hint = "give one element per file, and a `[[body]]` for each";
    Err(GeometryError::refused(place, "another element begins after 999", hint))
}
