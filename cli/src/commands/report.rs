//! `alula report`.
use crate::arguments;
use crate::outcome::Outcome;

pub(crate) fn report(_args: &arguments::Report) -> Outcome {
    super::unavailable("report")
}
