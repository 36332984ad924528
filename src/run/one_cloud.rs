//! The cloud of small motions where the case leaves it to the program.
use std::path::Path;

use super::error::RunError;
use super::{accuracy, setup};
use crate::case::Case;
use crate::geometry::dimension;

/// The case, whose files lie in `input`, on one cloud, see [`accuracy::on_one_cloud`].
pub(super) fn on_one_cloud(case: Case, input: &Path) -> Result<Case, RunError> {
    Ok(match dimension(&case) {
        2 => {
            let surface = setup::surface::<2>(&case, input)?.0;
            accuracy::on_one_cloud(case, surface.as_ref())
        }
        _ => {
            let surface = setup::surface::<3>(&case, input)?.0;
            accuracy::on_one_cloud(case, surface.as_ref())
        }
    })
}
