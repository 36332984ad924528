//! Files of mode shapes: points of a body and their displacements.
//!
//! A header names the columns, in any order: `x`, `y` and in 3-D `z`, the position of a point of the body before any
//! motion; `dx`, `dy` and in 3-D `dz`, its displacement for a modal coordinate of one. Upper case is accepted, and
//! further columns are ignored. Values are separated by commas; `#` starts a comment. All errors are reported at once.
use std::collections::BTreeMap;
use std::ops::Range;

use super::error::{CaseError, CaseErrors};
use super::schema::one_of;
use super::text::separator;

/// Greatest number of points of a mode; the construction of the shape then takes half a gigabyte.
const MOST_POINTS: usize = 1_000_000;
/// Greatest number of errors that are reported; more are repetitions of the same error.
const MOST_MISTAKES: usize = 20;
/// Names of the columns: positions, then displacements.
const COLUMNS: [&str; 6] = ["x", "y", "z", "dx", "dy", "dz"];

/// Points with their displacements; in 2-D the third component is zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModeTable {
    /// Positions before any motion.
    pub points: Vec<[f64; 3]>,
    /// Displacements for a modal coordinate of one.
    pub displacements: Vec<[f64; 3]>,
}

/// The table of a mode file, with the line of each row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ModeFile {
    /// Points and displacements.
    pub table: ModeTable,
    /// Line number of each point.
    pub lines: Vec<usize>,
    /// Messages about ignored columns.
    pub notes: Vec<String>,
}

/// A cell of the table with its position in the text.
type Cell<'t> = (&'t str, Range<usize>);

/// Reads the text of a mode file for a case of two or three dimensions; `name` identifies the file in messages. Fails
/// with all errors.
pub fn read_mode(text: &str, name: &str, dimension: usize) -> Result<ModeFile, CaseErrors> {
    let mut reader = Reader { dimension, places: Vec::new(), errors: Vec::new() };
    let mut file = ModeFile::default();
    let mut lines = lines(text);
    if let Some((_, cells, header)) = lines.next() {
        reader.header(&cells, &header, &mut file.notes);
        // without the columns no row can be interpreted
        if reader.errors.is_empty() {
            let mut seen = BTreeMap::new();
            lines.for_each(|(number, cells, whole)| reader.row((number, &cells, &whole), &mut seen, &mut file));
            reader.whole(&header, &file.table);
        }
    } else {
        reader.fail(0..0, "the file is empty").hint(header_hint(dimension));
    }
    if reader.errors.is_empty() {
        file.notes.iter_mut().for_each(|note| *note = format!("{name}: {note}"));
        return Ok(file);
    }
    reader.errors.truncate(MOST_MISTAKES);
    Err(CaseErrors::new(name, text, reader.errors))
}

/// Hint with the format of the header.
fn header_hint(dimension: usize) -> String {
    format!("begin with the line `{}`", expected(dimension).collect::<Vec<_>>().join(","))
}

/// Names of the columns in a case of `dimension` dimensions.
fn expected(dimension: usize) -> impl Iterator<Item = &'static str> {
    COLUMNS.into_iter().filter(move |c| dimension == 3 || !c.ends_with('z'))
}

/// Lines that are neither empty nor comments: number, cells, extent in bytes.
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

/// A piece of text that starts at byte `at`, without surrounding spaces.
fn trimmed(text: &str, at: usize) -> Cell<'_> {
    let inner = text.trim();
    let start = at + (text.len() - text.trim_start().len());
    (inner, start..start + inner.len())
}

struct Reader {
    dimension: usize,
    /// For each cell of a row, its index in [`COLUMNS`]; `None` for ignored columns.
    places: Vec<Option<usize>>,
    errors: Vec<CaseError>,
}

impl Reader {
    fn fail(&mut self, span: Range<usize>, message: impl Into<String>) -> &mut CaseError {
        let at = self.errors.len();
        self.errors.push(CaseError::new("", span, message));
        &mut self.errors[at]
    }

    /// Reads the names of the columns: each necessary one must appear once; others are ignored.
    fn header(&mut self, cells: &[Cell<'_>], whole: &Range<usize>, notes: &mut Vec<String>) {
        let allowed: Vec<&str> = expected(self.dimension).collect();
        let mut unread = Vec::new();
        for (cell, span) in cells {
            let name = cell.trim_matches('"').trim().to_ascii_lowercase();
            let place = COLUMNS.iter().position(|c| *c == name).filter(|p| allowed.contains(&COLUMNS[*p]));
            if place.is_none() {
                unread.push(format!("`{cell}`"));
            } else if self.places.contains(&place) {
                self.fail(span.clone(), format!("column `{cell}` stands here twice")).hint("keep one of them");
            }
            self.places.push(place);
        }
        let given = |name: &&str| self.places.iter().flatten().any(|p| COLUMNS[*p] == *name);
        let missing: Vec<&str> = allowed.into_iter().filter(|c| !given(c)).collect();
        if !missing.is_empty() {
            let hint = header_hint(self.dimension);
            let verb = if missing.len() > 1 { "are" } else { "is" };
            let message = format!("{} {verb} missing", one_of(missing.into_iter()).replace(" or ", " and "));
            self.fail(whole.clone(), message).hint(hint);
        } else if !unread.is_empty() {
            let (which, verb) = (unread.join(", "), if unread.len() > 1 { "columns are" } else { "column is" });
            notes.push(format!("{which}: {verb} not read"));
        }
    }

    /// Reads a point with its displacement.
    fn row(
        &mut self,
        (number, cells, whole): (usize, &[Cell<'_>], &Range<usize>),
        seen: &mut BTreeMap<[u64; 3], usize>,
        file: &mut ModeFile,
    ) {
        if cells.len() != self.places.len() {
            let allowed = format!("{} values", self.places.len());
            let message = format!("the row has {} values", cells.len());
            self.fail(whole.clone(), message).allowed(allowed).hint("give one value for each column of the header");
            return;
        }
        let (mut values, before) = ([0.0; 6], self.errors.len());
        for (k, (cell, span)) in cells.iter().enumerate() {
            let Some(place) = self.places[k] else { continue };
            match cell.parse::<f64>().ok().filter(|v| v.is_finite()) {
                Some(value) => values[place] = value,
                None => {
                    let column = COLUMNS[place];
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
        let (point, displacement) = ([values[0], values[1], values[2]], [values[3], values[4], values[5]]);
        // +0 and −0 are the same position
        let key = point.map(|v| (v + 0.0).to_bits());
        if let Some(&first) = seen.get(&key) {
            let before = file.lines.binary_search(&first).ok();
            if before.is_some_and(|k| file.table.displacements[k] == displacement) {
                file.notes.push(format!("line {number} repeats line {first} and is left out"));
                return;
            }
            let message = format!("the point of line {first} stands here again, with another displacement");
            self.fail(whole.clone(), message).allowed("every point once").hint("remove one of the two rows");
        }
        seen.insert(key, number);
        file.lines.push(number);
        file.table.points.push(point);
        file.table.displacements.push(displacement);
    }

    /// Checks that concern the whole table; errors refer to its header.
    fn whole(&mut self, header: &Range<usize>, table: &ModeTable) {
        let n = table.points.len();
        if n > MOST_POINTS {
            let message = format!("the mode has {n} points");
            let hint = "keep every second point, or fewer: the shape is a smooth surface through some thousand of them";
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
        let table = read_mode(text, "bend.csv", 2).unwrap().table;
        assert_eq!(table.points, [[0.0, 0.5, 0.0], [1.0, 0.0, 0.0]]);
        assert_eq!(table.displacements, [[0.0, 0.1, 0.0], [0.25, -2.0, 0.0]]);
        assert_eq!(read_mode(&text.replace(',', ";"), "bend.csv", 2).unwrap().table, table);
        let capitals = "Node,X,Y,Z,DX,DY,DZ,part\n17,1,2,3,4,5,6,skin of wing\n";
        let file = read_mode(capitals, "b", 3).unwrap();
        assert_eq!((file.table.points, file.table.displacements), (vec![[1.0, 2.0, 3.0]], vec![[4.0, 5.0, 6.0]]));
        assert_eq!((file.lines, file.notes), (vec![2], vec!["b: `Node`, `part`: columns are not read".to_owned()]));
        let file = read_mode("x,y,z,dx,dy,dz\n1,2,3,0,1,0\n2,2,3,0,1,0\n1,2,3,0,1,0\n", "b", 2).unwrap();
        assert_eq!(file.lines, [2, 3]);
        assert!(file.notes[0].contains("`z`, `dz`: columns") && file.notes[1].contains("line 4 repeats line 2"));
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
        assert!(shown.contains("`dx` stands here twice"), "{shown}");
        assert!(shown.contains("`dy` is missing") && !shown.contains("oops"), "{shown}");
        assert!(told("x,y,dx,dy\n", 3).contains("`z` and `dz`"));
        assert!(told("x,y,dx,dy\n", 2).contains("no points"));
        assert!(told("x,y,dx,dy\n1,1,0,-0\n", 2).contains("nothing moves"));
        let many: String = (0..5000).map(|k| format!("{k},0,0,1\n")).collect();
        assert_eq!(read_mode(&format!("x,y,dx,dy\n{many}"), "b", 2).unwrap().lines.len(), 5000);
    }
}
