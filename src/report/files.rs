//! Reading the folder of a run without ever failing: what is missing or broken is a word of explanation.
use std::path::{Path, PathBuf};

use serde_json::Value;

/// A run folder. Every reader gives what is there or says, for the page, why it is not.
pub(super) struct RunFolder {
    pub(super) path: PathBuf,
}

/// A table of comma-separated values; lines that begin with `#` are comments.
pub(super) struct Table {
    pub(super) columns: Vec<String>,
    pub(super) rows: Vec<Vec<String>>,
}

/// A reference curve of Cp against x/c.
pub(super) struct Reference {
    pub(super) label: String,
    pub(super) x: Vec<f64>,
    pub(super) cp: Vec<f64>,
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

    pub(super) fn table(&self, name: &str) -> Result<Table, String> {
        Table::parse(&self.text(name)?).map_err(|e| format!("`{name}` is not a table: {e}"))
    }

    /// Pictures as (file name, bytes), by name.
    pub(super) fn pictures(&self) -> Vec<(String, Vec<u8>)> {
        let folder = self.path.join("pictures");
        let names = list(&folder).into_iter().map(|(name, _)| name);
        names
            .filter(|name| name.ends_with(".png") || name.ends_with(".svg"))
            .filter_map(|name| std::fs::read(folder.join(&name)).ok().map(|bytes| (name, bytes)))
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

    /// Reference curves named under `[[compare]]` in the case, and words about those that cannot be read. A file is
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
        let table = Table::parse(&read_text(&path, file)?).map_err(|e| format!("`{file}` is not a table: {e}"))?;
        match (table.numbers("x_c"), table.numbers("cp")) {
            (Some(x), Some(cp)) => Ok(Reference { label: label.to_owned(), x, cp }),
            _ => Err(format!("the reference `{file}` has no columns `x_c` and `Cp`")),
        }
    }
}

impl Table {
    pub(super) fn parse(text: &str) -> Result<Self, csv::Error> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let columns = reader.headers()?.iter().map(str::to_owned).collect();
        let rows =
            reader.records().map(|r| r.map(|r| r.iter().map(str::to_owned).collect())).collect::<Result<_, _>>()?;
        Ok(Self { columns, rows })
    }

    /// The entries of a column, by its name in any case.
    pub(super) fn column(&self, name: &str) -> Option<Vec<&str>> {
        let at = self.columns.iter().position(|c| c.eq_ignore_ascii_case(name))?;
        Some(self.rows.iter().map(|row| row.get(at).map_or("", String::as_str)).collect())
    }

    /// A column as numbers; what is not one is NaN.
    pub(super) fn numbers(&self, name: &str) -> Option<Vec<f64>> {
        Some(self.column(name)?.iter().map(|entry| entry.parse().unwrap_or(f64::NAN)).collect())
    }
}

fn read_text(path: &Path, name: &str) -> Result<String, String> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Err(format!("`{name}` is not in the folder")),
        Err(error) => Err(format!("`{name}` cannot be read: {error}")),
    }
}

fn list(folder: &Path) -> Vec<(String, u64)> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<(String, u64)> = entries
        .filter_map(|entry| entry.metadata().ok().filter(|m| m.is_file()).map(|m| (entry, m.len())))
        .map(|(entry, size)| (entry.file_name().to_string_lossy().into_owned(), size))
        .filter(|(name, _)| !name.starts_with('.'))
        .collect();
    files.sort();
    files
}
