//! Mode shapes in files: points of a body and how far each goes.
//!
//! A header names the columns, in any order: `x`, `y` and in space `z`, the place of a point of the body as it stands before
//! any motion; `dx`, `dy` and in space `dz`, its displacement when the coordinate of the mode is one. Values are separated by
//! commas; `#` begins a comment. All mistakes are told at once.
use std::collections::BTreeMap;
use std::ops::Range;

use super::error::{CaseError, CaseErrors};
use super::schema::one_of;
use super::text::separator;

/// Most points of a mode: the interpolation solves a full system with as many unknowns.
const MOST_POINTS: usize = 2000;
/// Mistakes that are told; whoever has more has made one of them many times.
const MOST_MISTAKES: usize = 20;
/// Columns: places, then displacements.
const COLUMNS: [&str; 6] = ["x", "y", "z", "dx", "dy", "dz"];

/// Points and their displacements; what lies outside the plane is zero in 2-D.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModeTable {
    /// Places before any motion.
    pub points: Vec<[f64; 3]>,
    /// Displacements when the coordinate of the mode is one.
    pub displacements: Vec<[f64; 3]>,
}

/// A piece of the text with its place.
type Cell<'t> = (&'t str, Range<usize>);

/// Reads the text of a mode file for a case of two or three dimensions; `name` is what messages call it.
pub fn read_mode(text: &str, name: &str, dimension: usize) -> Result<ModeTable, CaseErrors> {
    let mut reader = Reader { dimension, places: Vec::new(), errors: Vec::new() };
    let mut table = ModeTable::default();
    let mut lines = lines(text);
    if let Some((_, cells, header)) = lines.next() {
        reader.header(&cells, &header);
        // without its columns no row can be understood
        if reader.errors.is_empty() {
            let mut seen = BTreeMap::new();
            lines.for_each(|(number, cells, whole)| reader.row((number, &cells, &whole), &mut seen, &mut table));
            reader.whole(&header, &table);
        }
    } else {
        reader.fail(0..0, "the file is empty").hint(header_hint(dimension));
    }
    if reader.errors.is_empty() {
        return Ok(table);
    }
    reader.errors.truncate(MOST_MISTAKES);
    Err(CaseErrors::new(name, text, reader.errors))
}

/// What a header must look like.
fn header_hint(dimension: usize) -> String {
    format!("begin with the line `{}`", expected(dimension).collect::<Vec<_>>().join(","))
}

/// Columns of a case of `dimension` dimensions.
fn expected(dimension: usize) -> impl Iterator<Item = &'static str> {
    COLUMNS.into_iter().filter(move |c| dimension == 3 || !c.ends_with('z'))
}

/// Lines that say something: number, cells, extent.
fn lines(text: &str) -> impl Iterator<Item = (usize, Vec<Cell<'_>>, Range<usize>)> {
    let mut start = 0;
    let between = separator(text);
    let lines = text.split_inclusive('\n').enumerate().map(move |(i, line)| {
        let at = start;
        start += line.len();
        let said = line.split('#').next().unwrap_or_default();
        (i + 1, at, said)
    });
    lines.filter(|(_, _, said)| !said.trim().is_empty()).map(move |(number, at, said)| {
        let mut from = at;
        let cells = said.split(between).map(|cell| {
            let here = trimmed(cell, from);
            from += cell.len() + 1;
            here
        });
        let cells: Vec<Cell<'_>> = cells.collect();
        let whole = trimmed(said, at).1;
        (number, cells, whole)
    })
}

/// A piece of text that begins at byte `at`, without blanks around it.
fn trimmed(text: &str, at: usize) -> Cell<'_> {
    let inner = text.trim();
    let start = at + (text.len() - text.trim_start().len());
    (inner, start..start + inner.len())
}

struct Reader {
    dimension: usize,
    /// For each cell of a row, where it goes: an index into [`COLUMNS`].
    places: Vec<usize>,
    errors: Vec<CaseError>,
}

impl Reader {
    fn fail(&mut self, span: Range<usize>, message: impl Into<String>) -> &mut CaseError {
        let at = self.errors.len();
        self.errors.push(CaseError::new("", span, message));
        &mut self.errors[at]
    }

    /// Names of the columns: all that are needed, each once.
    fn header(&mut self, cells: &[Cell<'_>], whole: &Range<usize>) {
        let allowed: Vec<&str> = expected(self.dimension).collect();
        for (cell, span) in cells {
            let place = COLUMNS.iter().position(|c| c == cell).filter(|p| allowed.contains(&COLUMNS[*p]));
            let Some(place) = place else {
                let what = if COLUMNS.contains(cell) { "is of no use in a 2-D case" } else { "has no meaning here" };
                let hint = header_hint(self.dimension);
                let message = format!("column `{cell}` {what}");
                self.fail(span.clone(), message).allowed(one_of(allowed.iter().copied())).hint(hint);
                continue;
            };
            if self.places.contains(&place) {
                self.fail(span.clone(), format!("column `{cell}` stands here twice")).hint("keep one of them");
            }
            self.places.push(place);
        }
        let given: Vec<usize> = self.places.clone();
        let missing: Vec<&str> = allowed.into_iter().filter(|c| !given.iter().any(|p| COLUMNS[*p] == *c)).collect();
        if !missing.is_empty() {
            let hint = header_hint(self.dimension);
            let verb = if missing.len() > 1 { "are" } else { "is" };
            let message = format!("{} {verb} missing", one_of(missing.into_iter()).replace(" or ", " and "));
            self.fail(whole.clone(), message).hint(hint);
        }
    }

    /// One point with its displacement.
    fn row(
        &mut self,
        (number, cells, whole): (usize, &[Cell<'_>], &Range<usize>),
        seen: &mut BTreeMap<[u64; 3], usize>,
        table: &mut ModeTable,
    ) {
        if cells.len() != self.places.len() {
            let allowed = format!("{} values", self.places.len());
            let message = format!("the row has {} values", cells.len());
            self.fail(whole.clone(), message).allowed(allowed).hint("give one value for each column of the header");
            return;
        }
        let (mut values, before) = ([0.0; 6], self.errors.len());
        for (k, (cell, span)) in cells.iter().enumerate() {
            let column = COLUMNS[self.places[k]];
            match cell.parse::<f64>().ok().filter(|v| v.is_finite()) {
                Some(value) => values[self.places[k]] = value,
                None => {
                    let message = format!("`{column}` is `{cell}`, which is no finite number");
                    self.fail(span.clone(), message)
                        .allowed("a finite number, 0.25 or -1e-3")
                        .hint("repair the value or remove the row");
                }
            }
        }
        if self.errors.len() > before {
            return;
        }
        let point = [values[0], values[1], values[2]];
        // zeros of either sign are one place
        let key = point.map(|v| (v + 0.0).to_bits());
        if let Some(first) = seen.insert(key, number) {
            let message = format!("the point of line {first} stands here again");
            self.fail(whole.clone(), message).allowed("every point once").hint("remove one of the two rows");
        }
        table.points.push(point);
        table.displacements.push([values[3], values[4], values[5]]);
    }

    /// What only the whole table shows; told at its header.
    fn whole(&mut self, header: &Range<usize>, table: &ModeTable) {
        let n = table.points.len();
        if n > MOST_POINTS {
            let message = format!("the mode has {n} points");
            let hint = "keep every second point, or fewer: the shape between points is a smooth curve or surface";
            self.fail(header.clone(), message).allowed(format!("at most {MOST_POINTS} points")).hint(hint);
        }
        if n == 0 && self.errors.is_empty() {
            let hint = "give a row for each point, its place and its displacement";
            self.fail(header.clone(), "the mode has no points").allowed("at least one point").hint(hint);
        }
        let moves = table.displacements.iter().flatten().any(|v| *v != 0.0);
        if n > 0 && !moves && self.errors.is_empty() {
            let hint = "displacements are those of a coordinate of one, however large that is";
            self.fail(header.clone(), "nothing moves: all displacements are zero").hint(hint);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_their_names() {
        let text = "# bending\n dy, x,y ,dx\n\n1e-1, 0, 0.5, 0 # nose\n-2,1,0,0.25\n";
        let table = read_mode(text, "bend.csv", 2).unwrap();
        assert_eq!(table.points, [[0.0, 0.5, 0.0], [1.0, 0.0, 0.0]]);
        assert_eq!(table.displacements, [[0.0, 0.1, 0.0], [0.25, -2.0, 0.0]]);
        assert_eq!(read_mode(&text.replace(',', ";"), "bend.csv", 2).unwrap(), table);
        assert_eq!(read_mode("x,y,z,dx,dy,dz\n1,2,3,4,5,6", "b", 3).unwrap().displacements, [[4.0, 5.0, 6.0]]);
    }

    #[test]
    fn all_mistakes_are_told_at_once_with_their_places() {
        let text = "x,y,dx,dy\n0,0,0,1\n0.5,zero,0,inf\n1,0,0\n0,-0,0,2\n";
        let told = read_mode(text, "bend.csv", 2).unwrap_err();
        let found: Vec<(usize, usize, Option<&str>)> =
            told.errors.iter().map(|e| (e.line, e.column, e.value.as_deref())).collect();
        let expected = [(3, 5, Some("zero")), (3, 12, Some("inf")), (4, 1, Some("1,0,0")), (5, 1, Some("0,-0,0,2"))];
        assert_eq!(found, expected);
        assert!(told.errors.iter().all(|e| e.allowed.is_some() && e.hint.is_some()));
        let shown = told.render(false);
        assert!(shown.contains("bend.csv:3:5") && shown.contains("the point of line 2"), "{shown}");
        assert!(shown.ends_with("4 mistakes in `bend.csv`"), "{shown}");
    }

    #[test]
    fn headers_are_checked_first() {
        let told = |text: &str, d: usize| read_mode(text, "b", d).unwrap_err().render(false);
        assert!(told("", 2).contains("empty"));
        let shown = told("x,y,z,dx,dx,w\n1,2,oops", 2);
        assert!(shown.contains("`z` is of no use") && shown.contains("`dx` stands here twice"), "{shown}");
        assert!(shown.contains("`w` has no meaning") && shown.contains("`dy`") && !shown.contains("oops"), "{shown}");
        assert!(told("x,y,dx,dy\n", 3).contains("`z` and `dz`"));
        assert!(told("x,y,dx,dy\n", 2).contains("no points"));
        assert!(told("x,y,dx,dy\n1,1,0,-0\n", 2).contains("nothing moves"));
        let many: String = (0..=MOST_POINTS).map(|k| format!("{k},0,0,1\n")).collect();
        assert!(told(&format!("x,y,dx,dy\n{many}"), 2).contains("2001 points"));
    }
}
