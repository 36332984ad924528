//! Checksums of the files of a run folder: what a run wrote there itself, and nobody changed since.
//!
//! `checksums.txt` has a line `sum name` for each file of records: tables, JSON, checkpoints and the cloud. A line is added *before* the file takes its name,
//! so that a run may be killed at any moment: what a file holds is what its last line says, or the one before. A table that grows row
//! by row has the sum `-` while it does: the checkpoint says what it held. The sum is the CRC-32 of the file; of a checkpoint that of its header, which
//! has those of its fields, and each that a run wrote counts, since a machine that stops may leave the one before the last.
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::Path;

use super::checkpoint::header_sum;
use super::table::{FileError, folder_of, write_plain};
use crate::case::{open_regular, read_regular};

/// Name of the list.
pub const FILE: &str = "checksums.txt";
/// Endings of the names of files that are listed, beside the cloud.
const LISTED: [&str; 3] = ["csv", "json", "alula"];
const CLOUD: &str = "cloud.toml";
/// The sum of a table that grows.
const GROWING: &str = "-";
/// The sum of a checkpoint that ends within its header.
const BROKEN: &str = "broken";

/// Begins the list of a folder, in which there is nothing yet that counts.
pub fn begin(folder: &Path) -> Result<(), FileError> {
    write_plain(&folder.join(FILE), b"")
}

/// Adds what the file that is called `target` soon, and lies in `file` until then, holds; `None` for a table that grows. Does nothing where
/// the folder has no list.
pub(super) fn announce(target: &Path, file: Option<&Path>) -> Result<(), FileError> {
    let list = folder_of(target).join(FILE);
    let Some(name) = target.file_name().and_then(|n| n.to_str()).filter(|n| is_listed(n)) else { return Ok(()) };
    if !list.is_file() {
        return Ok(());
    }
    let sum = match file {
        Some(file) => sum_of(name, file)?,
        None => GROWING.to_owned(),
    };
    // a line that a full disk cut short is ended first
    let add = |mut list: File| list.write_all(format!("\n{sum} {name}\n").as_bytes());
    OpenOptions::new().append(true).open(&list).and_then(add).map_err(FileError::io("append to", &list))
}

/// Refuses a folder of which a listed file is not what a run wrote. Files that are not there pass: whoever needs them says so; and so does a
/// checkpoint beside the one before, of which that is read which is whole.
pub fn check(folder: &Path) -> Result<(), FileError> {
    let read_elsewhere = |name: &String| is_checkpoint(name) && folder.join(format!("{name}.previous")).exists();
    let names = names(&list_of(folder)?);
    names.iter().filter(|name| !read_elsewhere(name)).try_for_each(|name| check_file(&folder.join(name)))
}

/// The same of one file; passes one whose folder has no list, or that is not in it.
pub fn check_file(path: &Path) -> Result<(), FileError> {
    check_as(path, path)
}

/// The same of a `file` that is, was or will be called `path`.
pub(super) fn check_as(path: &Path, file: &Path) -> Result<(), FileError> {
    let (folder, name) = (folder_of(path), path.file_name().unwrap_or_default().to_string_lossy());
    let Ok(list) = list_of(folder) else { return Ok(()) };
    let told: Vec<&str> = lines(&list).filter(|line| line.1 == name).map(|line| line.0).collect();
    let last = if is_checkpoint(&name) { &told[..] } else { &told[told.len().saturating_sub(2)..] };
    if last.is_empty() || last.contains(&GROWING) || !file.exists() {
        return Ok(());
    }
    if last.contains(&sum_of(&name, file)?.as_str()) {
        return Ok(());
    }
    Err(FileError::Sum { path: file.to_path_buf() })
}

/// Makes the list that of the files as they are now, of those that grew as well where the run is `over`.
pub fn renew(folder: &Path, over: bool) -> Result<(), FileError> {
    let list = list_of(folder)?;
    let mut text = String::new();
    for name in names(&list) {
        let path = folder.join(&name);
        let told: Vec<&str> = lines(&list).filter(|line| line.1 == name).map(|line| line.0).collect();
        let grows = !over && told.last() == Some(&GROWING);
        let sums = match () {
            () if !over && is_checkpoint(&name) => told.iter().map(ToString::to_string).collect(),
            () if !path.is_file() => Vec::new(),
            () if grows => vec![GROWING.to_owned()],
            () => vec![sum_of(&name, &path)?],
        };
        sums.iter().for_each(|sum| text.push_str(&format!("{sum} {name}\n")));
    }
    write_plain(&folder.join(FILE), text.as_bytes())
}

fn list_of(folder: &Path) -> Result<String, FileError> {
    let path = folder.join(FILE);
    let bytes = read_regular(&path).map_err(FileError::io("read", &path))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Sum and name of each line that is whole, first to last.
fn lines(list: &str) -> impl DoubleEndedIterator<Item = (&str, &str)> {
    list.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n')?.split_once(' '))
}

/// Names in the list, each once.
fn names(list: &str) -> Vec<String> {
    let mut names: Vec<String> = lines(list).map(|line| line.1.to_owned()).filter(|name| is_listed(name)).collect();
    names.sort_unstable();
    names.dedup();
    names
}

fn is_listed(name: &str) -> bool {
    let ending = Path::new(name).extension().and_then(|e| e.to_str()).unwrap_or_default();
    !name.contains(['/', '\\']) && (LISTED.contains(&ending) || name == CLOUD)
}

fn is_checkpoint(name: &str) -> bool {
    name.ends_with(".alula")
}

/// Sum of a file that is, or will be, called `name`.
fn sum_of(name: &str, file: &Path) -> Result<String, FileError> {
    let failed = |e| FileError::io("read", file)(e);
    if !is_checkpoint(name) {
        return Ok(format!("{:08x}", crc32fast::hash(&read_regular(file).map_err(failed)?)));
    }
    let sum = open_regular(file).and_then(header_sum).map_err(failed)?;
    Ok(sum.map_or_else(|| BROKEN.to_owned(), |sum| format!("{sum:08x}")))
}

#[cfg(test)]
mod tests {
    use super::super::table::{History, write_json};
    use super::*;
    use std::fs;

    #[test]
    fn a_file_is_what_its_last_line_says_or_the_one_before() {
        let folder = tempfile::tempdir().unwrap();
        let (at, path) = (folder.path(), folder.path().join("a.json"));
        assert!(check(at).is_err(), "there is no list");
        assert!(check_file(&path).is_ok());
        begin(at).unwrap();
        write_json(&path, &1.5).unwrap();
        check(at).unwrap();
        let before = fs::read(&path).unwrap();
        // a full disk cut a line short
        fs::write(at.join(FILE), fs::read_to_string(at.join(FILE)).unwrap() + "0123 a.js").unwrap();
        write_json(&path, &2.5).unwrap();
        check(at).unwrap();
        // killed between the line and the name
        fs::write(&path, &before).unwrap();
        check(at).unwrap();
        renew(at, false).unwrap();
        fs::write(&path, "2.5\n").unwrap();
        let refused = check(at).unwrap_err().to_string();
        assert!(refused.contains("a.json` was changed") && refused.contains("hint"), "{refused}");
        fs::remove_file(&path).unwrap();
        check(at).unwrap();
    }

    #[test]
    fn a_table_that_grows_is_listed_when_it_does_no_more() {
        let folder = tempfile::tempdir().unwrap();
        let (at, path) = (folder.path(), folder.path().join("history.csv"));
        begin(at).unwrap();
        let mut history = History::create(&path, &["iteration"]).unwrap();
        history.append(&[1.0]).unwrap();
        check(at).unwrap();
        renew(at, false).unwrap();
        history.append(&[2.0]).unwrap();
        check(at).unwrap();
        renew(at, true).unwrap();
        check(at).unwrap();
        fs::write(&path, "iteration\n1\n3\n").unwrap();
        assert!(check(at).is_err());
        // it goes on
        let _history = History::create(&path, &["iteration"]).unwrap();
        check(at).unwrap();
    }
}
