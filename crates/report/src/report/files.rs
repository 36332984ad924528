//! Reading the folder of a run without ever failing: what is missing or broken is a word of explanation.
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::chart::{Marks, Series};
use crate::case::{numbers_of, read_regular, separator};
use crate::observe::table::KEPT;

/// What the pictures of the film strip begin with.
pub(super) const FILM: &str = "film";

/// A run folder. Every reader gives what is there or says, for the page, why it is not.
pub(super) struct RunFolder {
    pub(super) path: PathBuf,
}

/// A load of a run: its column in files, its name on pages.
#[derive(Clone, Copy, Debug)]
pub(super) struct Load {
    pub(super) column: &'static str,
    pub(super) name: &'static str,
}

/// The loads of all bodies together.
pub(super) const LOADS: [Load; 3] =
    [Load { column: "cl", name: "CL" }, Load { column: "cd", name: "CD" }, Load { column: "cm", name: "CM" }];

/// A curve of Cp to compare with.
pub(super) struct Reference {
    /// Cp against x/c.
    pub(super) curve: Series,
    /// Part of the half span of each value; empty in the plane.
    pub(super) stations: Vec<f64>,
}

/// A table of comma-separated values; lines that begin with `#` are comments.
pub(super) struct Csv {
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
}

impl RunFolder {
    pub(super) fn new(path: &Path) -> Self {
        Self { path: path.to_path_buf() }
    }

    pub(super) fn text(&self, name: &str) -> Result<String, String> {
        read_text(&self.path.join(name), name)
    }

    pub(super) fn json(&self, name: &str) -> Result<Value, String> {
        serde_json::from_str(&self.text(name)?).map_err(|e| format!("`{name}` is not valid JSON: {e}"))
    }

    pub(super) fn table(&self, name: &str) -> Result<Csv, String> {
        Csv::parse(&self.text(name)?).map_err(|e| format!("`{name}` is not a table: {e}"))
    }

    /// Pictures as (file name, bytes), by name.
    pub(super) fn pictures(&self) -> Vec<(String, Vec<u8>)> {
        let folder = self.path.join("pictures");
        let names = list(&folder).into_iter().map(|(name, _)| name);
        names
            .filter(|name| name.ends_with(".png") || name.ends_with(".svg"))
            .filter_map(|name| read_regular(&folder.join(&name)).ok().map(|bytes| (name, bytes)))
            .collect()
    }

    /// Files of the folder and of `pictures/` as (relative name, bytes), by name.
    pub(super) fn files(&self) -> Vec<(String, u64)> {
        let mut files = list(&self.path);
        files.extend(
            list(&self.path.join("pictures")).into_iter().map(|(name, size)| (format!("pictures/{name}"), size)),
        );
        files
    }

    /// Reference curves of Cp named under `[[compare]]` in the case, and words about those that cannot be read. A file is
    /// looked for beside the run and beside the case file.
    pub(super) fn references(&self) -> (Vec<Reference>, Vec<String>) {
        let case = self.text("case.toml").ok().and_then(|text| text.parse::<toml::Table>().ok()).unwrap_or_default();
        let entries = case.get("compare").and_then(|c| c.as_array()).cloned().unwrap_or_default();
        let (mut found, mut missing) = (Vec::new(), Vec::new());
        for entry in entries {
            let Some(file) = entry.get("file").and_then(|f| f.as_str()) else { continue };
            let label = entry.get("label").and_then(|l| l.as_str()).unwrap_or(file);
            match self.reference(file, label) {
                Ok(reference) => found.push(reference),
                Err(word) => missing.push(word),
            }
        }
        (found, missing)
    }

    fn reference(&self, file: &str, label: &str) -> Result<Reference, String> {
        let origin = self.text("origin.txt").map(|text| PathBuf::from(text.trim())).ok();
        let beside = [Some(self.path.as_path()), self.path.parent(), origin.as_deref()];
        let path = beside.into_iter().flatten().map(|folder| folder.join(file)).find(|path| path.is_file());
        let path = path.ok_or_else(|| format!("the reference `{file}` was not found"))?;
        let table = reference(&path, file)?;
        let numbers = |name: &str| table.numbers(name).unwrap_or_default();
        Ok(Reference {
            curve: Series::new(label, Marks::Rings, numbers("x_c"), numbers("cp")),
            stations: numbers("eta"),
        })
    }
}

/// The table at `path`, which is called `file`, as a reference curve: it has the columns of one.
fn reference(path: &Path, file: &str) -> Result<Csv, String> {
    let table = Csv::parse(&read_text(path, file)?).map_err(|e| format!("`{file}` is not a table: {e}"))?;
    has(&table, file, &["x_c", "Cp"]).map(|()| table)
}

/// Says what is wrong with a table that is to be the reference curve `file` of Cp, in space at stations.
pub fn check_reference(path: &Path, file: &str, in_space: bool) -> Result<(), String> {
    let table = reference(path, file)?;
    if in_space { has(&table, file, &["eta"]) } else { Ok(()) }
}

/// The table has these columns, with a number in each.
fn has(table: &Csv, file: &str, columns: &[&str]) -> Result<(), String> {
    let quoted = |names: &mut dyn Iterator<Item = &str>| names.map(|n| format!("`{n}`")).collect::<Vec<_>>().join(", ");
    let absent = |name: &&&str| table.position(name).is_none();
    let missing = quoted(&mut columns.iter().filter(absent).copied());
    if !missing.is_empty() {
        let found = quoted(&mut table.columns.iter().map(String::as_str));
        return Err(format!("`{file}` has no column {missing}, but {found}"));
    }
    let bare = |name: &&&str| !table.numbers(name).unwrap_or_default().iter().any(|x| x.is_finite());
    match columns.iter().find(bare) {
        Some(name) => Err(format!("`{file}` has no number in its column `{name}`")),
        None => Ok(()),
    }
}

impl Csv {
    pub(super) fn parse(text: &str) -> Result<Self, csv::Error> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .delimiter(separator(text) as u8)
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let columns = reader.headers()?.iter().map(str::to_owned).collect();
        let rows =
            reader.records().map(|r| r.map(|r| r.iter().map(str::to_owned).collect())).collect::<Result<_, _>>()?;
        Ok(Self { columns, rows })
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|c| c.eq_ignore_ascii_case(name))
    }

    /// The entries of a column, by its name in any case.
    pub(super) fn column(&self, name: &str) -> Option<Vec<&str>> {
        let at = self.position(name)?;
        Some(self.rows.iter().map(|row| row.get(at).map_or("", String::as_str)).collect())
    }

    /// A column as numbers; what is not one is NaN.
    pub(super) fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        Some(self.column(name)?.iter().map(|entry| entry.parse().unwrap_or(f64::NAN)).collect())
    }

    /// Column `y` against column `x` as a line; `None` when one of them is missing or holds no number.
    pub(super) fn curve(&self, x: &str, y: &str, name: &str) -> Option<Series> {
        let known = |values: &Vec<f64>| values.iter().any(|v| v.is_finite());
        Some(Series::new(name, Marks::Line, self.numbers(x).filter(known)?, self.numbers(y).filter(known)?))
    }

    /// One curve for each load that is there.
    pub(super) fn loads(&self, x: &str) -> Vec<Series> {
        LOADS.iter().filter_map(|load| self.curve(x, load.column, load.name)).collect()
    }

    /// Counts the rows in the column `name`, from 1, in place of what it held.
    pub(super) fn number_rows(&mut self, name: &str) {
        let at = self.position(name).unwrap_or(self.columns.len());
        self.columns.resize(self.columns.len().max(at + 1), name.to_owned());
        for (k, row) in self.rows.iter_mut().enumerate() {
            row.resize(row.len().max(at + 1), String::new());
            row[at] = (k + 1).to_string();
        }
    }
}

fn read_text(path: &Path, name: &str) -> Result<String, String> {
    match read_regular(path) {
        Ok(bytes) => numbers_of(&bytes).map_err(|e| format!("`{name}` cannot be read: {e}")),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Err(format!("`{name}` is not in the folder")),
        Err(error) => Err(format!("`{name}` cannot be read: {error}")),
    }
}

/// The files of a folder that stay there.
fn list(folder: &Path) -> Vec<(String, u64)> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<(String, u64)> = entries
        .filter_map(|entry| entry.metadata().ok().filter(|m| m.is_file()).map(|m| (entry, m.len())))
        .map(|(entry, size)| (entry.file_name().to_string_lossy().into_owned(), size))
        .filter(|(name, _)| !name.starts_with('.') && name != KEPT)
        .collect();
    files.sort();
    files
}
