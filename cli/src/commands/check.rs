//! `alula check`.
use alula::case::write;

use crate::arguments;
use crate::outcome::Outcome;
use crate::output;

/// Reads a case and tells its mistakes, or that there are none.
pub(crate) fn check(args: &arguments::Check) -> Outcome {
    match super::load(&args.case) {
        Ok(case) if args.resolved => output::data(&write(&case)),
        Ok(case) => output::data(&format!("{}: no mistakes in `{}`\n", args.case.display(), case.title)),
        Err(outcome) => outcome,
    }
}
