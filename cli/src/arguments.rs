//! What can be typed.
use std::num::NonZeroUsize;
use std::path::PathBuf;

use alula::case::TEMPLATES;
use alula::observe::usage::MOST_THREADS;
use clap::builder::{PossibleValue, PossibleValuesParser};
use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

const EXIT_CODES: &str = "\
Exit codes:
    0  done
    1  the run failed, diverged or did not converge
    2  wrong arguments, case or files
  130  interrupted; the last checkpoint is kept

Signals during a run:
  Ctrl-C, SIGTERM  finish the iteration, write a checkpoint, stop; a second one stops at once
  SIGHUP           the same, unless it is ignored (`nohup`)
  SIGUSR1          write a checkpoint and go on";

const VERIFY_CODES: &str = "\
Exit codes:
    0  every claim holds
    1  a claim fails
    2  wrong arguments or folders
  130  interrupted; what was computed is kept, and the same command goes on";

/// Aeroelastic loads from a surface file, without a mesh.
#[derive(Debug, Parser)]
#[command(name = "alula", version, about, after_help = EXIT_CODES, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Compute a case and write fields, loads and a report.
    #[command(after_help = EXIT_CODES)]
    Run(Run),
    /// Write a commented case file to start from.
    New(New),
    /// Read a case file and tell all its mistakes at once.
    Check(Check),
    /// Fill the domain with particles and judge the cloud, without computing a flow.
    Cloud(Cloud),
    /// Write the bodies of a case, repaired and closed, as one file: STL or OBJ in space, coordinates in the plane.
    Geometry(Geometry),
    /// Go on with a run from its last checkpoint.
    #[command(after_help = EXIT_CODES)]
    Resume(Resume),
    /// Write the report of a run again.
    Report(Report),
    /// Compute generalised aerodynamic forces: lift and moment of plunge and pitch at a list of reduced frequencies.
    Gaf(Gaf),
    /// Seek the speeds at which a structure begins to flutter or diverges, at a list of Mach numbers.
    Flutter(Flutter),
    /// Set two runs of a periodic flow side by side: loads, harmonics, walls, cost.
    Compare(Compare),
    /// Compare the solver with theory and experiment.
    #[command(after_help = VERIFY_CODES)]
    Verify(Verify),
    /// Print the JSON schema of the case file, for editors.
    Schema(Schema),
    /// Print completions for a shell.
    Completions(Completions),
}

#[derive(Debug, Args)]
pub(crate) struct Run {
    /// Case file.
    pub(crate) case: PathBuf,
    /// Folder for the results; default: `runs/` and the name of the case without its extension, with a number where that is taken.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) threads: Threads,
    #[command(flatten)]
    pub(crate) verbosity: Verbosity,
    /// Compute into the folder of earlier results, which are renamed; without `--out` the first one of the case.
    #[arg(long)]
    pub(crate) force: bool,
    /// Start from the last state of another run on the same cloud: steady, marched, or periodic with any number of harmonics.
    #[arg(long, value_name = "RUN")]
    pub(crate) from: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct New {
    /// What the case is about.
    #[arg(value_parser = templates())]
    pub(crate) template: String,
    /// File to write; `-` prints it. Default: the name of the template with `.toml`.
    pub(crate) path: Option<PathBuf>,
    /// Write the JSON schema beside it too, and the first line by which editors with Taplo or Even Better TOML complete and check the case.
    #[arg(long)]
    pub(crate) schema: bool,
    /// Replace existing files.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Check {
    /// Case file.
    pub(crate) case: PathBuf,
    /// Print the case with all defaults filled in.
    #[arg(long)]
    pub(crate) resolved: bool,
    /// Print what is known as one JSON object, or each mistake as one.
    #[arg(long, conflicts_with = "resolved")]
    pub(crate) json: bool,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[derive(Debug, Args)]
pub(crate) struct Cloud {
    /// Case file.
    pub(crate) case: PathBuf,
    /// Folder for the particle file; default: `runs/` and the name of the case with `-cloud`, with a number where that is taken.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Compute into the folder of earlier results, which are renamed; without `--out` the first one of the case.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[derive(Debug, Args)]
pub(crate) struct Geometry {
    /// Case file.
    pub(crate) case: PathBuf,
    /// File to write, `.stl` or `.obj`, in the plane `.dat`; default: the name of the case with `.stl` or `.dat`.
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Replace an existing file.
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Resume {
    /// Folder of the run.
    pub(crate) run: PathBuf,
    #[command(flatten)]
    pub(crate) threads: Threads,
    #[command(flatten)]
    pub(crate) verbosity: Verbosity,
}

#[derive(Debug, Args)]
pub(crate) struct Report {
    /// Folder of the run.
    pub(crate) run: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct Gaf {
    /// Case file with a table `[gaf]`.
    pub(crate) case: PathBuf,
    /// Folder for the matrices; default: `runs/` and the name of the case with `-gaf`, with a number where that is taken.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Compute into the folder of earlier results, which are renamed; without `--out` the first one of the case.
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) threads: Threads,
    #[command(flatten)]
    pub(crate) verbosity: Verbosity,
}

#[derive(Debug, Args)]
pub(crate) struct Flutter {
    /// Case file with a `[structure]` and a table `[flutter]`.
    pub(crate) case: PathBuf,
    /// Folder for the tables; default: `runs/` and the name of the case with `-flutter`, with a number where that is taken.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Compute into the folder of earlier results, which are renamed; without `--out` the first one of the case.
    #[arg(long)]
    pub(crate) force: bool,
    /// Take the forces from `flutter.json` or `gaf.json` of a former run: the structure alone, without a flow.
    #[arg(long, value_name = "FILE")]
    pub(crate) forces: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) threads: Threads,
    #[command(flatten)]
    pub(crate) verbosity: Verbosity,
}

#[derive(Debug, Args)]
pub(crate) struct Compare {
    /// Folder of a run.
    pub(crate) a: PathBuf,
    /// Folder of the run it is measured against.
    pub(crate) b: PathBuf,
    /// Folder for the page and the table; default: `comparison`.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct Verify {
    /// Only cases whose names contain one of these texts.
    pub(crate) filters: Vec<String>,
    /// Print one JSON object a line.
    #[arg(long)]
    pub(crate) json: bool,
    /// Only the shortest cases, which take ten minutes of processor time together.
    #[arg(long)]
    pub(crate) fast: bool,
    /// Print the cases with the time that each took last and what it claims; compute nothing.
    #[arg(long)]
    pub(crate) list: bool,
    /// Compute everything again, also what an earlier verification by this program has kept.
    #[arg(long, conflicts_with = "list")]
    pub(crate) again: bool,
    /// Folder that keeps what is computed, by build of the program and case: after a stop the same command goes on.
    #[arg(long, value_name = "DIR", default_value = "runs/verification")]
    pub(crate) keep: PathBuf,
    /// Folder of the cases; default: `verification` here or above.
    #[arg(long, value_name = "DIR")]
    pub(crate) folder: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) threads: Threads,
}

#[derive(Debug, Args)]
pub(crate) struct Schema {
    /// Print the reference page in Markdown instead.
    #[arg(long)]
    pub(crate) markdown: bool,
}

#[derive(Debug, Args)]
pub(crate) struct Completions {
    /// Shell to complete in.
    pub(crate) shell: Shell,
}

/// A number of threads.
fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let number = text.parse::<NonZeroUsize>().ok().filter(|n| n.get() <= MOST_THREADS);
    number.ok_or_else(|| format!("a whole number from 1 to {MOST_THREADS}"))
}

#[derive(Clone, Copy, Debug, Default, Args)]
pub(crate) struct Threads {
    /// Number of threads; default: one for each core. Results do not depend on it.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<NonZeroUsize>,
}

#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Verbosity {
    /// Print one JSON object a line instead of text.
    #[arg(long)]
    pub(crate) json: bool,
    /// Print errors only.
    #[arg(long, short, conflicts_with = "json")]
    pub(crate) quiet: bool,
}

fn templates() -> PossibleValuesParser {
    PossibleValuesParser::new(TEMPLATES.map(|(name, about)| PossibleValue::new(name).help(about)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn arguments_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn what_is_typed_arrives() {
        let cli = Cli::try_parse_from(["alula", "run", "a.toml", "--out", "o", "--threads", "3", "--json", "--force"]);
        let Command::Run(run) = cli.unwrap().command else { panic!() };
        assert_eq!((run.threads.threads.map(NonZeroUsize::get), run.verbosity.json, run.force), (Some(3), true, true));
        assert!(Cli::try_parse_from(["alula", "run", "a.toml", "--threads", "0"]).is_err());
        assert!(Cli::try_parse_from(["alula", "run", "a.toml", "--json", "--quiet"]).is_err());
        assert!(Cli::try_parse_from(["alula", "new", "wing"]).is_err());
        let cli = Cli::try_parse_from(["alula", "verify", "naca", "bow_shock", "--fast"]);
        let Command::Verify(verify) = cli.unwrap().command else { panic!() };
        assert_eq!((verify.filters.len(), verify.fast, verify.again), (2, true, false));
        assert!(Cli::try_parse_from(["alula", "verify", "--list", "--again"]).is_err());
    }

    #[test]
    fn help_tells_the_exit_codes() {
        assert!(Cli::command().render_help().to_string().contains("130  interrupted"));
    }
}
