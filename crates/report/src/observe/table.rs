//! Tables and JSON on disk, written so that a reader never meets half a file.
//!
//! [`write_atomic`] writes beside the target and renames: POSIX and Windows both replace a file in one step, so whoever
//! opens the path sees the old content or the new one. Numbers are printed in the shortest form that reads back to the
//! same bits. [`History`] is the exception: it grows by appended lines, one per iteration, and is cut back to an
//! iteration when a run is resumed from an older checkpoint, which says with a [`TableMark`] what the table held.
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::sums;
use crate::case::read_regular;

/// How the name of a file begins and ends while it is being written.
pub const UNFINISHED: (&str, &str) = (".alula-", ".tmp");

/// What is finished of a flutter boundary that is not: it goes away at the end, so that no page points at it.
pub const KEPT: &str = "flutter-kept.json";

/// What can go wrong with a table.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The operating system refused.
    #[error("cannot {action} `{}`: {source}\nhint: check that the folder exists, is writable and has space left", path.display())]
    Io {
        /// What was tried.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// Why not.
        source: io::Error,
    },
    /// A value that JSON cannot carry.
    #[error("cannot write `{}` as JSON: {source}\nhint: JSON has no key that is not text", path.display())]
    Json {
        /// The file.
        path: PathBuf,
        /// Why not.
        source: serde_json::Error,
    },
    /// A row of the wrong width.
    #[error("a row for `{}` has {found} values, the table has {expected} columns", path.display())]
    Width {
        /// The file.
        path: PathBuf,
        /// Values in the row.
        found: usize,
        /// Columns of the table.
        expected: usize,
    },
    /// A history that belongs to another set of columns.
    #[error("`{}` starts with `{found}`, not with `{expected}`\nhint: it was written by another version; start the run in a new folder", path.display())]
    Header {
        /// The file.
        path: PathBuf,
        /// First line of the file.
        found: String,
        /// First line that was asked for.
        expected: String,
    },
    /// A file that is not what a run wrote.
    #[error("`{}` was changed since the run wrote it: its checksum is not the one in `{}`\nhint: put it back as it was, or begin the run again in another folder", path.display(), sums::FILE)]
    Sum {
        /// The file.
        path: PathBuf,
    },
    /// A table that is not what a run wrote.
    #[error("`{}` was changed or removed since the run wrote it: it does not begin with what the checkpoint says of it\nhint: put it back as it was, or begin the run again in another folder", path.display())]
    Changed {
        /// The file.
        path: PathBuf,
    },
}

impl FileError {
    /// What turns an error of the system into this one: what was done (`write`) to which file.
    pub fn io(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::Io { action, path, source }
    }
}

/// Writes a file in one step: `fill` writes to a temporary file in the same folder, which then takes the name `path`.
pub fn write_atomic(path: &Path, fill: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FileError> {
    let file = write_beside(path, fill)?;
    sums::announce(path, Some(file.path()))?;
    file.persist(path).map_err(|e| FileError::io("write", path)(e.error))?;
    Ok(())
}

/// The same for what is in no list of checksums.
pub(super) fn write_plain(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let file = write_beside(path, |w| w.write_all(bytes))?;
    file.persist(path).map_err(|e| FileError::io("write", path)(e.error))?;
    Ok(())
}

/// The first half of [`write_atomic`]: a complete file beside `path`, not yet under its name.
pub fn write_beside(
    path: &Path,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<tempfile::NamedTempFile, FileError> {
    let temporary = temporary_beside(path).map_err(FileError::io("write", path))?;
    let mut writer = BufWriter::new(temporary);
    fill(&mut writer).map_err(FileError::io("write", path))?;
    writer.into_inner().map_err(|e| FileError::io("write", path)(e.into_error()))
}

fn temporary_beside(path: &Path) -> io::Result<tempfile::NamedTempFile> {
    let folder = folder_of(path);
    let mut builder = tempfile::Builder::new();
    builder.prefix(UNFINISHED.0).suffix(UNFINISHED.1);
    // Temporary files are private by default; results are ordinary files under the user's umask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

/// The folder that holds `path`, `.` for a bare file name.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes `value` as indented JSON; NaN and infinities become `null`.
pub fn write_json<T: Serialize>(path: &Path, value: &T) -> Result<(), FileError> {
    let text =
        serde_json::to_vec_pretty(value).map_err(|source| FileError::Json { path: path.to_path_buf(), source })?;
    write_atomic(path, |w| {
        w.write_all(&text)?;
        w.write_all(b"\n")
    })
}

/// One entry of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// Text, quoted when it holds a comma, a quote or a line break.
    Text(String),
    /// A number, in the shortest form that reads back to the same bits.
    Number(f64),
}

impl From<f64> for Entry {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}
impl From<&str> for Entry {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

/// Writes a table of comma-separated values with one line of column names.
pub fn write_csv(path: &Path, columns: &[&str], rows: impl IntoIterator<Item = Vec<Entry>>) -> Result<(), FileError> {
    let mut width_error = None;
    let result = write_atomic(path, |w| {
        let mut table = csv::WriterBuilder::new().terminator(csv::Terminator::Any(b'\n')).from_writer(w);
        table.write_record(columns)?;
        for row in rows {
            if row.len() != columns.len() {
                width_error = Some(row.len());
                return Err(io::ErrorKind::InvalidInput.into());
            }
            table.write_record(row.iter().map(print_entry))?;
        }
        table.flush()
    });
    match width_error {
        Some(found) => Err(FileError::Width { path: path.to_path_buf(), found, expected: columns.len() }),
        None => result,
    }
}

fn print_entry(entry: &Entry) -> String {
    match entry {
        Entry::Text(text) => text.clone(),
        Entry::Number(value) => print_number(*value),
    }
}

/// The shortest decimal form that reads back to the same bits; with an exponent when that is shorter to read.
pub fn print_number(value: f64) -> String {
    // Between these bounds a plain decimal has at most 21 characters.
    let plain = value == 0.0 || !value.is_finite() || (1e-4..1e15).contains(&value.abs());
    if plain { format!("{value}") } else { format!("{value:e}") }
}

/// What a table held when a checkpoint was written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TableMark {
    /// Name of its file.
    pub file: String,
    /// Length in bytes.
    pub length: u64,
    /// CRC-32 of these bytes.
    pub crc32: u32,
}

impl TableMark {
    /// True for the bytes of a file that begins with what the table held.
    fn begins(&self, bytes: &[u8]) -> bool {
        let length = usize::try_from(self.length).unwrap_or(usize::MAX);
        bytes.get(..length).is_some_and(|part| crc32fast::hash(part) == self.crc32)
    }
}

/// A table that grows by one line per iteration and survives an interrupted run.
#[derive(Debug)]
pub struct History {
    path: PathBuf,
    columns: usize,
    file: File,
    /// Length and checksum of all that it holds.
    length: u64,
    sum: crc32fast::Hasher,
}

impl History {
    /// Starts an empty history, replacing a file that may be there.
    pub fn create(path: &Path, columns: &[&str]) -> Result<Self, FileError> {
        Self::begin(path, columns.len(), &format!("{}\n", columns.join(",")))
    }

    /// Continues a history after `iteration`: rows from the first larger `iteration` on are removed, and so is a line
    /// that an interruption left incomplete. Refuses one that does not begin with what `mark` says; without a mark the file is created when
    /// it does not exist.
    pub fn resume(path: &Path, columns: &[&str], iteration: u64, mark: Option<&TableMark>) -> Result<Self, FileError> {
        if let Some(mark) = mark {
            let bytes =
                if path.exists() { read_regular(path).map_err(FileError::io("read", path))? } else { Vec::new() };
            if !mark.begins(&bytes) {
                return Err(FileError::Changed { path: path.to_path_buf() });
            }
        }
        match columns.iter().position(|name| *name == "iteration") {
            Some(at) => Self::resume_while(path, columns, |row| row[at] <= iteration as f64),
            None => Self::resume_while(path, columns, |_| true),
        }
    }

    /// Continues a history after the last of its leading rows for which `keep` holds.
    pub fn resume_while(path: &Path, columns: &[&str], keep: impl Fn(&[f64]) -> bool) -> Result<Self, FileError> {
        if !path.exists() {
            return Self::create(path, columns);
        }
        let bytes = read_regular(path).map_err(FileError::io("read", path))?;
        let text = String::from_utf8_lossy(&bytes);
        let header = columns.join(",");
        let mut lines = text.split_inclusive('\n');
        let found = lines.next().unwrap_or("").trim_end();
        if found != header {
            let found = found.chars().take(80).collect();
            return Err(FileError::Header { path: path.to_path_buf(), found, expected: header });
        }
        let kept = lines.take_while(|line| complete_row(line, columns.len()).is_some_and(|row| keep(&row)));
        let rows: String = kept.flat_map(|line| [line.trim_end(), "\n"]).collect();
        Self::begin(path, columns.len(), &format!("{header}\n{rows}"))
    }

    /// What the table holds now, on the disk as well.
    pub fn mark(&self) -> Result<TableMark, FileError> {
        self.file.sync_data().map_err(FileError::io("write", &self.path))?;
        let file = self.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        Ok(TableMark { file, length: self.length, crc32: self.sum.clone().finalize() })
    }

    /// Adds one row, visible to readers at once.
    pub fn append(&mut self, row: &[f64]) -> Result<(), FileError> {
        if row.len() != self.columns {
            return Err(FileError::Width { path: self.path.clone(), found: row.len(), expected: self.columns });
        }
        let mut line = row.iter().map(|value| print_number(*value)).collect::<Vec<_>>().join(",");
        line.push('\n');
        // One call: a line is there as a whole or, after a crash, cut short and dropped by `resume`.
        self.file.write_all(line.as_bytes()).map_err(FileError::io("append to", &self.path))?;
        self.length += line.len() as u64;
        self.sum.update(line.as_bytes());
        Ok(())
    }

    /// A table that holds `text` so far.
    fn begin(path: &Path, columns: usize, text: &str) -> Result<Self, FileError> {
        sums::announce(path, None)?;
        write_plain(path, text.as_bytes())?;
        let file = OpenOptions::new().append(true).open(path).map_err(FileError::io("append to", path))?;
        let mut sum = crc32fast::Hasher::new();
        sum.update(text.as_bytes());
        Ok(Self { path: path.to_path_buf(), columns, file, length: text.len() as u64, sum })
    }
}

/// The numbers of a line that ends in a line break and has the right width.
pub(super) fn complete_row(line: &str, columns: usize) -> Option<Vec<f64>> {
    let row: Option<Vec<f64>> =
        line.strip_suffix('\n')?.trim_end().split(',').map(|entry| entry.parse().ok()).collect();
    row.filter(|row| row.len() == columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_atomic(&path, |w| w.write_all(b"old")).unwrap();
        let refused = write_atomic(&path, |w| {
            w.write_all(b"half of the new")?;
            Err(io::ErrorKind::StorageFull.into())
        });
        assert!(refused.unwrap_err().to_string().starts_with("cannot write `"));
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "the temporary file is gone");
    }

    #[test]
    fn tables_quote_text_and_refuse_ragged_rows() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        write_csv(&path, &["name", "v"], [vec!["a,b".into(), 1e-9.into()], vec!["c".into(), 2.5.into()]]).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "name,v\n\"a,b\",1e-9\nc,2.5\n");
        let error = write_csv(&path, &["name", "v"], [vec!["a".into()]]).unwrap_err();
        assert!(matches!(error, FileError::Width { found: 1, expected: 2, .. }));
    }

    #[test]
    fn a_resumed_history_forgets_what_came_after() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let columns = ["cycle", "iteration", "residual"];
        let mut history = History::create(&path, &columns).unwrap();
        (0..10).for_each(|k| history.append(&[0.0, k as f64, 1.0 / (1.0 + k as f64)]).unwrap());
        drop(history);
        OpenOptions::new().append(true).open(&path).unwrap().write_all(b"0,10,0.0").unwrap();
        let mut history = History::resume(&path, &columns, 4, None).unwrap();
        history.append(&[0.0, 5.0, f64::NAN]).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text.lines().count(), 7);
        assert!(text.ends_with("0,4,0.2\n0,5,NaN\n"));
        assert!(history.append(&[1.0]).is_err());
        assert!(matches!(History::resume(&path, &["other"], 4, None), Err(FileError::Header { .. })));
    }

    #[test]
    fn a_history_that_was_changed_since_the_checkpoint_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let columns = ["iteration", "cl"];
        let mut history = History::create(&path, &columns).unwrap();
        history.append(&[1.0, 0.5]).unwrap();
        history.append(&[2.0, 0.25]).unwrap();
        let mark = history.mark().unwrap();
        history.append(&[3.0, 0.125]).unwrap();
        let again = |iteration| History::resume(&path, &columns, iteration, Some(&mark));
        assert_eq!(again(2).unwrap().mark().unwrap(), mark);
        let text = std::fs::read_to_string(&path).unwrap();
        for forged in [text.replace("0.25", "9.25"), text.replace("2,", "1,"), "iteration,cl\n".to_owned()] {
            std::fs::write(&path, &forged).unwrap();
            let refused = again(2).unwrap_err().to_string();
            assert!(refused.contains("history.csv` was changed") && refused.contains("hint: put it back"), "{refused}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), forged, "what is refused stays as it is");
        }
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(again(2), Err(FileError::Changed { .. })));
    }

    #[test]
    fn resuming_without_a_cut_drops_only_the_incomplete_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        std::fs::write(&path, "iteration,cl\n1,0.5\n2,0.6\n3,0.").unwrap();
        History::resume(&path, &["iteration", "cl"], u64::MAX, None).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "iteration,cl\n1,0.5\n2,0.6\n");
    }

    proptest! {
        #[test]
        fn printed_numbers_read_back_to_the_same_bits(bits in any::<u64>()) {
            let value = f64::from_bits(bits);
            let back: f64 = print_number(value).parse().unwrap();
            prop_assert!(back.to_bits() == bits || value.is_nan() && back.is_nan());
        }
    }
}
