//! `alula cloud`.
use crate::arguments;
use crate::outcome::Outcome;

pub(crate) fn cloud(args: &arguments::Cloud) -> Outcome {
    match super::load(&args.case) {
        Ok(_) => super::unavailable("cloud"),
        Err(outcome) => outcome,
    }
}
