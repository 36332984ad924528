//! `alula completions`.
use clap::CommandFactory;

use crate::arguments::{self, Cli};
use crate::outcome::Outcome;
use crate::output;

/// Prints the completion script of a shell.
pub(crate) fn completions(args: &arguments::Completions) -> Outcome {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut Cli::command(), "alula", &mut script);
    output::data(&String::from_utf8_lossy(&script))
}
