//! The run folder: made before anything else, never overwritten.
use std::fs::{self, File, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::case::{Case, Cloud, Compare, open_regular, read, read_regular, write, write_cloud};
use crate::geometry::dimension;
use crate::observe::checkpoint;
use crate::observe::sums;
use crate::observe::table::UNFINISHED;
use crate::observe::write_atomic;
use crate::problem::RunError;
use crate::problem::files::plain;
use crate::record::gaf::TABLE as MATRICES;
use crate::report::check_reference;
use crate::study::record::saved;

/// Where the folder of the case file is noted.
const ORIGIN: &str = "origin.txt";
/// Written last: checksums of the case that the results belong to, and of the last line of the run.
const FINISHED: &str = "finished.txt";
/// The last line of a run.
const SUMMARY: &str = "summary.json";
/// The last cloud, where the program chose it.
const CLOUD: &str = "cloud.toml";

pub(crate) use crate::observe::table::KEPT;

/// What a flutter boundary found.
pub(crate) const BOUNDARY: &str = "flutter.json";

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

/// A run folder that is this run's as long as this lives; file systems without locks let it pass.
pub(crate) struct Hold {
    _lock: Option<File>,
}

/// Takes a run folder; refuses one in which another run is going on.
pub(crate) fn hold(out: &Path) -> Result<Hold, RunError> {
    let Ok(file) = open_regular(&out.join(ORIGIN)) else { return Ok(Hold { _lock: None }) };
    match file.try_lock() {
        Ok(()) => Ok(Hold { _lock: Some(file) }),
        Err(TryLockError::Error(_)) => Ok(Hold { _lock: None }),
        Err(TryLockError::WouldBlock) => Err(RunError::Folder {
            what: format!("a run is going on in `{}`", out.display()),
            hint: "wait for its end, stop it, or choose another folder with `--out`".into(),
        }),
    }
}

/// Renames a run folder, so that nothing is lost; its new name.
pub(crate) fn set_aside(out: &Path) -> Result<PathBuf, RunError> {
    let _held = hold(out)?;
    let name = out.file_name().map_or_else(|| "run".into(), |n| n.to_string_lossy().into_owned());
    let kept = fresh_folder(out.parent().unwrap_or(Path::new("")), &format!("{name}.replaced"));
    fs::rename(out, &kept).map(|()| kept).map_err(|e| RunError::Folder {
        what: format!("cannot set `{}` aside: {e}", out.display()),
        hint: "choose another folder with `--out`".into(),
    })
}

/// Makes room for results that can be computed, as `rehearse` says: earlier results in their folder are renamed; the new name, if there were any.
pub(crate) fn make_room(
    out: &Path,
    rehearse: impl FnOnce() -> Result<(), RunError>,
) -> Result<Option<PathBuf>, RunError> {
    if !out.exists() {
        return Ok(None);
    }
    rehearse()?;
    set_aside(out).map(Some)
}

/// Makes the run folder and puts the resolved case into it; true where a run was begun there before that kept nothing.
pub(crate) fn create(case: &Case, input: &Path, out: &Path) -> Result<(bool, Hold), RunError> {
    let named = out.display();
    if out.is_file() {
        return Err(RunError::Folder {
            what: format!("`{named}` is a file, but a folder is to be made"),
            hint: "choose another name with `--out`".into(),
        });
    }
    let _before = hold(out)?;
    let used = out.join("case.toml").exists() || out.join(SUMMARY).exists();
    if used && !is_barely_begun(out) {
        return Err(occupied(out));
    }
    unfinished_files(out).iter().for_each(|file| fs::remove_file(file).unwrap_or_default());
    fs::create_dir_all(out.join("pictures")).map_err(|e| RunError::Folder {
        what: format!("cannot make the run folder `{named}`: {e}"),
        hint: "choose a writable place with `--out`".into(),
    })?;
    let lost = |source| RunError::LostInput { folder: input.display().to_string(), source };
    let origin = absolute(input).map_err(lost)?;
    if out.join(KEPT).exists() {
        check_files(out)?;
        sums::renew(out, false)?;
    } else {
        sums::begin(out)?;
    }
    // before the case, so that a case without it is one that no run has put there
    write_atomic(&out.join(ORIGIN), |w| writeln!(w, "{}", origin.display()))?;
    let held = hold(out)?;
    write_atomic(&out.join("case.toml"), |w| w.write_all(write(case).as_bytes()))?;
    Ok((used, held))
}

/// The same for what is no run and has no checkpoints: a cloud, matrices or a flutter boundary.
pub(crate) fn create_once(case: &Case, input: &Path, out: &Path) -> Result<Hold, RunError> {
    // matrices are found in the same order again: those of this case that were not all found make room
    let same = || is_of(case, out);
    if out.join(MATRICES).exists() && !out.join(FINISHED).exists() && same() {
        fs::remove_file(out.join(MATRICES)).unwrap_or_default();
    }
    let other = out.join(KEPT).exists() && !same();
    if out.join("case.toml").exists() && (other || !is_barely_begun(out)) {
        return Err(RunError::Folder {
            what: format!("`{}` holds earlier results", out.display()),
            hint: "choose another folder with `--out`, or replace it with `--force`".into(),
        });
    }
    create(case, input, out).map(|(_, held)| held)
}

/// True where `out` is the folder of a run of this very case.
pub(crate) fn is_of(case: &Case, out: &Path) -> bool {
    plain(&out.join("case.toml")).is_ok_and(|known| known == write(case))
}

/// True where `out` is the folder of a run that has a checkpoint.
pub fn has_begun(out: &Path) -> bool {
    checkpoint::is_there(&out.join(saved::FILE))
}

/// Makes a folder in that of a run.
pub(crate) fn make_within(out: &Path, name: &str) -> Result<(), RunError> {
    let folder = out.join(name);
    fs::create_dir_all(&folder).map_err(|e| RunError::Folder {
        what: format!("cannot make `{}`: {e}", folder.display()),
        hint: "check that the folder of the run is writable".into(),
    })
}

/// Puts a cloud that the program chose into the run folder, as the section of a case file; `refined`: the run made it finer besides.
pub(crate) fn put_cloud(cloud: &Cloud, refined: bool, out: &Path) -> Result<(), RunError> {
    let more = "# What the run found (`[adapt]`, detached shocks) refined it further.\n";
    let text = format!(
        "# The last cloud of this run, as the program chose it. In place of `[cloud]` in a case file, without `[accuracy]`, it gives\n\
         # the same particles again.\n{}\n{}",
        if refined { more } else { "" },
        write_cloud(cloud)
    );
    Ok(write_atomic(&out.join(CLOUD), |w| w.write_all(text.as_bytes()))?)
}

/// True where a run was stopped before it kept anything but its case.
fn is_barely_begun(out: &Path) -> bool {
    let kept = [SUMMARY, FINISHED, "doctor.json", MATRICES];
    let begun = has_begun(out);
    out.join(ORIGIN).is_file() && !begun && kept.iter().all(|name| !out.join(name).exists())
}

/// Why a folder with an earlier run is no place for another one.
fn occupied(out: &Path) -> RunError {
    let named = out.display();
    if finished(out).is_some() {
        return RunError::Folder {
            what: format!("`{named}` holds a finished run of `{named}/case.toml`"),
            hint: "choose another folder with `--out`, or replace it with `--force`".into(),
        };
    }
    RunError::Folder {
        what: format!("`{named}` holds an earlier run"),
        hint: format!(
            "choose another folder with `--out`, go on with `alula resume {named}`, or replace it with `--force`"
        ),
    }
}

/// Marks a run or matrices as finished: all files are written.
pub(crate) fn finish(out: &Path) -> Result<(), RunError> {
    sums::renew(out, true)?;
    let sums: String = ["case.toml", SUMMARY].iter().filter_map(|file| checksum(out, file)).collect();
    Ok(write_atomic(&out.join(FINISHED), |w| w.write_all(sums.as_bytes()))?)
}

/// Takes what is kept of a boundary out of a folder in which all is finished.
pub(crate) fn forget_kept(out: &Path) {
    // a file that stays is not read where all is finished
    let _ = fs::remove_file(out.join(KEPT));
}

/// Checksum of version, case and its files, which lie in `input`.
pub(crate) fn identity(case: &Case, input: &Path) -> String {
    let mut sum = crc32fast::Hasher::new();
    sum.update(env!("CARGO_PKG_VERSION").as_bytes());
    sum.update(write(case).as_bytes());
    case.files().for_each(|file| sum.update(&read_regular(&input.join(file)).unwrap_or_default()));
    format!("{:08x}", sum.finalize())
}

/// Takes the mark from a run that goes on, and the files that it was writing when it was killed.
pub(crate) fn reopen(out: &Path) -> Result<(), RunError> {
    for unfinished in unfinished_files(out) {
        // whoever may not remove it is told so with the mark below
        let _ = fs::remove_file(unfinished);
    }
    match fs::remove_file(out.join(FINISHED)) {
        Err(e) if e.kind() != ErrorKind::NotFound => Err(RunError::Folder {
            what: format!("cannot go on in the run folder `{}`: {e}", out.display()),
            hint: "make it writable".into(),
        }),
        _ => Ok(sums::renew(out, false)?),
    }
}

/// Files of a run folder that were not renamed to their names.
fn unfinished_files(out: &Path) -> Vec<PathBuf> {
    let listed = |folder: PathBuf| fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let unfinished = |path: &PathBuf| {
        let name = path.file_name().map_or_else(Default::default, |n| n.to_string_lossy());
        name.starts_with(UNFINISHED.0) && name.ends_with(UNFINISHED.1)
    };
    [out.to_path_buf(), out.join("pictures")].into_iter().flat_map(listed).filter(unfinished).collect()
}

/// The summary of a run that is finished; `None` where it is not, or its case was changed since.
pub(crate) fn finished(out: &Path) -> Option<serde_json::Value> {
    let mark = plain(&out.join(FINISHED)).ok()?;
    let summary = plain(&out.join(SUMMARY)).ok()?;
    checksum(out, "case.toml").filter(|sum| mark.starts_with(sum))?;
    serde_json::from_str(&summary).ok()
}

/// Refuses a folder with a file of records that was changed since the run wrote it: tables, summaries, checkpoints, what is kept of a boundary.
pub(crate) fn check_files(out: &Path) -> Result<(), RunError> {
    let mark = plain(&out.join(FINISHED)).unwrap_or_default();
    let list = out.join(sums::FILE);
    if !list.is_file() {
        return Err(RunError::Folder {
            what: format!("`{}` is not there: it says which numbers the run wrote itself", list.display()),
            hint: "put it back, or begin the run again in another folder".into(),
        });
    }
    sums::check(out)?;
    let told = mark.lines().find(|line| line.starts_with(SUMMARY));
    if told.is_none_or(|told| checksum(out, SUMMARY).is_some_and(|sum| sum.trim_end() == told)) {
        return Ok(());
    }
    Err(RunError::Folder {
        what: format!("`{}` was changed since the run wrote it", out.join(SUMMARY).display()),
        hint: "put it back as it was, or begin the run again in another folder".into(),
    })
}

/// What the mark of a finished run says of one of its files.
fn checksum(out: &Path, file: &str) -> Option<String> {
    let bytes = read_regular(&out.join(file)).ok()?;
    Some(format!("{file} {:08x}\n", crc32fast::hash(&bytes)))
}

/// Refuses to go on where no checkpoint was written.
pub(crate) fn check_begun(out: &Path) -> Result<(), RunError> {
    if has_begun(out) {
        return check_files(out);
    }
    if [MATRICES, BOUNDARY, sums::FILE].iter().any(|name| out.join(name).is_file()) {
        check_files(out)?;
    }
    let (named, file) = (out.display(), saved::FILE);
    if out.join(MATRICES).exists() {
        return Err(RunError::Folder {
            what: format!("`{named}` holds matrices of `alula gaf`, which is not resumed"),
            hint: "begin it again with its case file: in the same folder where it was not finished, else in another or with `--force`"
                .into(),
        });
    }
    if out.join(BOUNDARY).exists() {
        return Err(RunError::Folder {
            what: format!("`{named}` holds a flutter boundary that is finished"),
            hint: "begin another one: `alula flutter` with its case file, and another folder or `--force`".into(),
        });
    }
    let force = if is_barely_begun(out) { "" } else { " --force" };
    Err(RunError::Folder {
        what: format!("there is no `{file}` in `{named}`: the run was stopped before it wrote one"),
        hint: format!("begin it again: `alula {}` with its case file and `--out {named}{force}`", command_of(out)),
    })
}

/// The command that the case of a run folder is for.
fn command_of(out: &Path) -> &'static str {
    let case = plain(&out.join("case.toml")).ok().and_then(|text| read(&text, "case.toml").ok());
    match case {
        Some(case) if case.gaf.is_some() => "gaf",
        Some(case) if case.flutter.is_some() => "flutter",
        _ => "run",
    }
}

/// The same place from any working folder; no name stands for the working folder itself.
fn absolute(folder: &Path) -> std::io::Result<PathBuf> {
    fs::canonicalize(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
}

/// The case of a run folder, and the folder its file names refer to.
pub(crate) fn read_case(out: &Path) -> Result<(Case, PathBuf), RunError> {
    let path = out.join("case.toml");
    let text = plain(&path).map_err(|source| RunError::NoRun { folder: out.display().to_string(), source })?;
    let case = read(&text, &path.display().to_string())?;
    let origin = plain(&out.join(ORIGIN)).unwrap_or_default();
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

/// Refuses a case that compares itself with files that are not there, or are no reference curves.
pub(crate) fn check_compared(case: &Case, input: &Path) -> Result<(), RunError> {
    let gone = |c: &&Compare| !input.join(&c.file).is_file();
    let missing: Vec<String> = case.compare.iter().filter(gone).map(|c| format!("`{}`", c.file)).collect();
    if !missing.is_empty() {
        return Err(RunError::Folder {
            what: format!("`[[compare]]` names files that are not there: {}", missing.join(", ")),
            hint: format!(
                "paths are relative to the case file, in `{}`",
                absolute(input).unwrap_or_default().display()
            ),
        });
    }
    let in_space = dimension(case) == 3;
    let wrong = |c: &Compare| check_reference(&input.join(&c.file), &c.file, in_space).err();
    let wrong: Vec<String> = case.compare.iter().filter_map(wrong).collect();
    if wrong.is_empty() {
        return Ok(());
    }
    let columns = if in_space { "`eta`, `x_c` and `Cp`" } else { "`x_c` and `Cp`" };
    Err(RunError::Folder {
        what: format!("`[[compare]]` names no reference curve: {}", wrong.join("; ")),
        hint: format!(
            "a reference is a table with the columns {columns} in its first line, of pressure along the chord"
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matrices_that_were_not_all_found_are_begun_again_with_their_case_alone() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let case = |mach: f64| read(&format!("[flow]\nmach = {mach}\n[[body]]\nnaca = \"0012\"\n"), "t").unwrap();
        let begin =
            |mach: f64| create_once(&case(mach), folder.path(), &out).map(|_| fs::write(out.join(MATRICES), "k\n"));
        begin(0.3).unwrap().unwrap();
        begin(0.3).unwrap().unwrap();
        assert!(begin(0.4).is_err_and(|e| e.to_string().contains("holds earlier results")));
        finish(&out).unwrap();
        assert!(begin(0.3).is_err());
    }

    #[test]
    fn a_run_killed_between_two_renames_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let case = read("[flow]\nmach = 0.3\n[[body]]\nnaca = \"0012\"\n", "t").unwrap();
        let _held = create_once(&case, folder.path(), &out).unwrap();
        assert!(is_barely_begun(&out) && check_begun(&out).is_err());
        fs::write(out.join("checkpoint.alula.previous"), "x").unwrap();
        assert!(!is_barely_begun(&out) && check_begun(&out).is_ok());
    }
}
