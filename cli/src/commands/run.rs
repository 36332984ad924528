//! `alula run`.
use crate::arguments;
use crate::outcome::Outcome;

pub(crate) fn run(args: &arguments::Run) -> Outcome {
    match super::load(&args.case) {
        Ok(_) => super::unavailable("run"),
        Err(outcome) => outcome,
    }
}
