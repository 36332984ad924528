//! `alula verify`.
use crate::arguments;
use crate::outcome::Outcome;

pub(crate) fn verify(_args: &arguments::Verify) -> Outcome {
    super::unavailable("verify")
}
