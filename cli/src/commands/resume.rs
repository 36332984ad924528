//! `alula resume`.
use crate::arguments;
use crate::outcome::Outcome;

pub(crate) fn resume(_args: &arguments::Resume) -> Outcome {
    super::unavailable("resume")
}
