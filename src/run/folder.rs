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
    let input = fs::canonicalize(&places.input).unwrap_or_else(|_| places.input.clone());
    write_atomic(&out.join(ORIGIN), |w| writeln!(w, "{}", input.display()))?;
    Ok(())
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

/// Text of a file that a case or a run refers to.
pub(super) fn text(folder: &Path, name: &str) -> std::io::Result<String> {
    fs::read_to_string(folder.join(name))
}
