//! The run folder: made before anything else, never overwritten.
use std::fs;
use std::path::{Path, PathBuf};

use super::{Places, RunError};
use crate::case::{Case, read, write};
use crate::observe::write_atomic;

/// Where the folder of the case file is noted.
const ORIGIN: &str = "origin.txt";

/// A folder name under `parent` that does not exist yet: `name`, `name-2`, `name-3`, …
pub fn fresh_folder(parent: &Path, name: &str) -> PathBuf {
    let numbered = (2..).map(|k| parent.join(format!("{name}-{k}")));
    std::iter::once(parent.join(name)).chain(numbered).find(|p| !p.exists()).unwrap_or_else(|| parent.join(name))
}

/// Makes the run folder and puts the resolved case into it.
pub(super) fn create(case: &Case, places: &Places) -> Result<(), RunError> {
    let out = &places.out;
    let named = out.display();
    if out.join("case.toml").exists() || out.join("summary.json").exists() {
        return Err(RunError::Folder(format!(
            "`{named}` holds an earlier run\nhint: choose another folder with `--out`, go on with `alula resume {named}`, or replace it with `--force`"
        )));
    }
    fs::create_dir_all(out.join("pictures")).map_err(|e| {
        RunError::Folder(format!(
            "cannot make the run folder `{named}`: {e}\nhint: choose a writable place with `--out`"
        ))
    })?;
    write_atomic(&out.join("case.toml"), |w| w.write_all(write(case).as_bytes()))?;
    let input = absolute(&places.input).map_err(|e| {
        RunError::Folder(format!("the folder `{}` of the case file cannot be found again: {e}", places.input.display()))
    })?;
    write_atomic(&out.join(ORIGIN), |w| writeln!(w, "{}", input.display()))?;
    Ok(())
}

/// The same place from any working folder; no name stands for the working folder itself.
fn absolute(folder: &Path) -> std::io::Result<PathBuf> {
    fs::canonicalize(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
}

/// The case of a run folder, and the folder its file names refer to.
pub(super) fn read_case(out: &Path) -> Result<(Case, PathBuf), RunError> {
    let path = out.join("case.toml");
    let text = fs::read_to_string(&path).map_err(|e| {
        RunError::Folder(format!("`{}` is not a run folder: cannot read `case.toml`: {e}", out.display()))
    })?;
    let case = read(&text, &path.display().to_string()).map_err(|e| RunError::Folder(e.to_string()))?;
    let origin = fs::read_to_string(out.join(ORIGIN)).unwrap_or_default();
    Ok((case, PathBuf::from(origin.trim())))
}

/// Refuses to go on with a case whose files are no longer where they were.
pub(super) fn check_input(case: &Case, (input, out): (&Path, &Path)) -> Result<(), RunError> {
    let missing: Vec<String> = case.files().filter(|f| !input.join(f).is_file()).map(|f| format!("`{f}`")).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let note = out.join(ORIGIN);
    Err(RunError::Folder(format!(
        "the case of this run names the files {}, which are not in `{}`\nhint: put them back, or write the folder they are in now \
         into `{}`",
        missing.join(", "),
        input.display(),
        note.display()
    )))
}

/// Text of a file that a case or a run refers to.
pub(super) fn text(folder: &Path, name: &str) -> std::io::Result<String> {
    fs::read_to_string(folder.join(name))
}
