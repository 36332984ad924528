//! The run folder: made before anything else, never overwritten.
use std::fs;
use std::path::{Path, PathBuf};

use super::error::RunError;
use crate::case::{Case, read, write};
use crate::observe::write_atomic;

/// Where the folder of the case file is noted.
const ORIGIN: &str = "origin.txt";

/// Where a run reads and writes.
#[derive(Clone, Debug)]
pub struct Places {
    /// Folder that file names in the case refer to.
    pub input: PathBuf,
    /// Run folder.
    pub out: PathBuf,
}

/// A folder name under `parent` that does not exist yet: `name`, `name-2`, `name-3`, …
pub fn fresh_folder(parent: &Path, name: &str) -> PathBuf {
    let numbered = (2..).map(|k| parent.join(format!("{name}-{k}")));
    std::iter::once(parent.join(name)).chain(numbered).find(|p| !p.exists()).unwrap_or_else(|| parent.join(name))
}

/// Makes the run folder and puts the resolved case into it.
pub(crate) fn create(case: &Case, input: &Path, out: &Path) -> Result<(), RunError> {
    let named = out.display();
    if out.join("case.toml").exists() || out.join("summary.json").exists() {
        return Err(RunError::Folder {
            what: format!("`{named}` holds an earlier run"),
            hint: format!(
                "choose another folder with `--out`, go on with `alula resume {named}`, or replace it with `--force`"
            ),
        });
    }
    fs::create_dir_all(out.join("pictures")).map_err(|e| RunError::Folder {
        what: format!("cannot make the run folder `{named}`: {e}"),
        hint: "choose a writable place with `--out`".into(),
    })?;
    write_atomic(&out.join("case.toml"), |w| w.write_all(write(case).as_bytes()))?;
    let lost = |source| RunError::LostInput { folder: input.display().to_string(), source };
    let origin = absolute(input).map_err(lost)?;
    write_atomic(&out.join(ORIGIN), |w| writeln!(w, "{}", origin.display()))?;
    Ok(())
}

/// The same place from any working folder; no name stands for the working folder itself.
fn absolute(folder: &Path) -> std::io::Result<PathBuf> {
    fs::canonicalize(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
}

/// The case of a run folder, and the folder its file names refer to.
pub(crate) fn read_case(out: &Path) -> Result<(Case, PathBuf), RunError> {
    let path = out.join("case.toml");
    let text =
        fs::read_to_string(&path).map_err(|source| RunError::NoRun { folder: out.display().to_string(), source })?;
    let case = read(&text, &path.display().to_string())?;
    let origin = fs::read_to_string(out.join(ORIGIN)).unwrap_or_default();
    Ok((case, PathBuf::from(origin.trim())))
}

/// Refuses to go on with a case whose files are no longer where they were.
pub(crate) fn check_input(case: &Case, input: &Path, out: &Path) -> Result<(), RunError> {
    let missing: Vec<String> = case.files().filter(|f| !input.join(f).is_file()).map(|f| format!("`{f}`")).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let (missing, input) = (missing.join(", "), input.display());
    Err(RunError::Folder {
        what: format!("the case of this run names the files {missing}, which are not in `{input}`"),
        hint: format!("put them back, or write the folder they are in now into `{}`", out.join(ORIGIN).display()),
    })
}

/// Text of a file that a case or a run refers to.
pub(crate) fn text(folder: &Path, name: &str) -> std::io::Result<String> {
    fs::read_to_string(folder.join(name))
}
