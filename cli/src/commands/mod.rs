//! One file for each command.
use std::path::{Path, PathBuf};

use alula::case::{Case, read_in, read_written, text_of};
use alula::observe::usage::threads_of_environment;
use alula::run::{Blame, RunError, fresh_folder};

use crate::arguments::{Cli, Command, Threads};
use crate::outcome::Outcome;
use crate::output;

mod check;
mod cloud;
mod compare;
mod completions;
mod flutter;
mod gaf;
mod geometry;
mod new;
mod report;
mod resume;
mod run;
mod schema;
mod verify;

/// Folder for results that name none.
const RUNS: &str = "runs";

/// Does what was typed.
pub(crate) fn dispatch(cli: Cli) -> Outcome {
    output::speak_json(match &cli.command {
        Command::Run(args) => args.verbosity.json,
        Command::Resume(args) => args.verbosity.json,
        Command::Gaf(args) => args.verbosity.json,
        Command::Flutter(args) => args.verbosity.json,
        Command::Check(args) => args.json,
        Command::Verify(args) => args.json,
        _ => false,
    });
    match cli.command {
        Command::Run(args) => threaded(args.threads, || run::run(&args)),
        Command::New(args) => new::new(&args),
        Command::Check(args) => threaded(args.threads, || check::check(&args)),
        Command::Cloud(args) => threaded(args.threads, || cloud::cloud(&args)),
        Command::Resume(args) => threaded(args.threads, || resume::resume(&args)),
        Command::Gaf(args) => threaded(args.threads, || gaf::gaf(&args)),
        Command::Flutter(args) => threaded(args.threads, || flutter::flutter(&args)),
        Command::Geometry(args) => threaded(Threads::default(), || geometry::geometry(&args)),
        Command::Report(args) => threaded(Threads::default(), || report::report(&args)),
        Command::Compare(args) => threaded(Threads::default(), || compare::compare(&args)),
        Command::Verify(args) => threaded(args.threads, || verify::verify(&args)),
        Command::Schema(args) => schema::schema(&args),
        Command::Completions(args) => completions::completions(&args),
    }
}

/// Runs `command` in a pool of threads sized as asked. This thread is one of them: loops do not wait for another to wake up.
fn threaded(threads: Threads, command: impl FnOnce() -> Outcome) -> Outcome {
    let n = threads.threads.map_or_else(threads_of_environment, std::num::NonZero::get);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(n).use_current_thread();
    if let Err(problem) = pool.build_global() {
        output::error(&format!("cannot start {n} threads: {problem}"), "use a smaller number with `--threads`");
        return Outcome::BadInput;
    }
    command()
}

/// The case in the file at `path`; its mistakes are told.
fn load(path: &Path) -> Result<Case, Outcome> {
    let name = path.display().to_string();
    let text = match read_written(path) {
        Ok(bytes) => text_of(&bytes).map_err(|problem| {
            let hint = "a case file is TOML, saved as UTF-8; start from `alula new airfoil`";
            output::error_in(Some(&name), &format!("cannot read `{name}`: {problem}"), hint);
            Outcome::BadInput
        })?,
        Err(problem) => {
            let hint = "`alula new airfoil` writes a case to start from";
            output::error_in(Some(&name), &format!("cannot read `{name}`: {problem}"), hint);
            return Err(Outcome::BadInput);
        }
    };
    read_in(&text, &name, path.parent().unwrap_or(Path::new(""))).map_err(|mistakes| {
        output::mistakes(&mistakes);
        Outcome::BadInput
    })
}

/// Folder of results that name none: the first one of this name if it shall be replaced, or else one that does not exist yet.
fn default_folder(name: &str, replaced: bool) -> PathBuf {
    let runs = Path::new(RUNS);
    if replaced { runs.join(name) } else { fresh_folder(runs, name) }
}

/// Says where the results that were in the folder `out` are kept now, if there were any, and gives the place.
fn tell_kept(kept: Result<Option<PathBuf>, RunError>, out: &Path, quiet: bool) -> Result<Option<PathBuf>, Outcome> {
    let kept = kept.map_err(|problem| refuse(&problem))?;
    if let Some(kept) = kept.as_ref().filter(|_| !quiet) {
        output::note(&format!("the earlier results in `{}` are kept in `{}`", out.display(), kept.display()));
    }
    Ok(kept)
}

/// Tells why a case cannot be computed: all reasons, one by one.
fn refuse(problem: &RunError) -> Outcome {
    for text in problem.messages() {
        let (what, hint) = text.split_once("\nhint: ").unwrap_or((&text, ""));
        output::error(what, hint);
    }
    match problem.blame() {
        Blame::Computation => Outcome::Failed,
        Blame::Case | Blame::Files => Outcome::BadInput,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_that_are_no_cases_are_bad_input() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case.toml");
        assert_eq!(load(&path).unwrap_err(), Outcome::BadInput);
        std::fs::write(&path, [0xff, 0xfe]).unwrap();
        assert_eq!(load(&path).unwrap_err(), Outcome::BadInput);
        std::fs::write(&path, "mach = 1").unwrap();
        assert_eq!(load(&path).unwrap_err(), Outcome::BadInput);
        std::fs::write(&path, alula::case::template("sphere").unwrap()).unwrap();
        assert!(load(&path).is_ok());
    }
}
