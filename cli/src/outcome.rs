//! How a command ends.
use std::process::ExitCode;

/// How a command ends; the numbers are documented in `alula --help`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(dead_code, reason = "the list of exit codes is complete on purpose")]
pub(crate) enum Outcome {
    /// Everything asked for was done.
    Done = 0,
    /// The run failed, diverged or did not converge.
    Failed = 1,
    /// Arguments, case or files are wrong.
    BadInput = 2,
    /// Stopped by SIGINT, SIGTERM or SIGHUP, after a checkpoint.
    Interrupted = 130,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        Self::from(outcome as u8)
    }
}
