//! Whether there is room for what a run writes.
use std::path::Path;

use crate::case::Case;
use crate::observe::usage::free_disk_bytes;
use crate::problem::RunError;
use crate::study::disk::bytes;

/// Refuses a run whose folder `out` has no room for what it writes.
pub(crate) fn check(
    case: &Case,
    out: &Path,
    particles: usize,
    dimension: usize,
    period: Option<f64>,
) -> Result<(), RunError> {
    let needed = bytes(case, particles as f64, dimension, period);
    match free_disk_bytes(out) {
        Some(free) if needed > free as f64 => Err(full(out, needed, free as f64)),
        _ => Ok(()),
    }
}

fn full(out: &Path, needed: f64, free: f64) -> RunError {
    RunError::Folder {
        what: format!(
            "the run would write about {:.3} GB, and there are {:.3} GB free for `{}`",
            1e-9 * needed,
            1e-9 * free,
            out.display()
        ),
        hint: "make room, choose another disk with `--out`, or write less: a longer `output.field_interval`, fewer `output.field_particles`"
            .into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disk_without_room_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let case = crate::case::read("[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n", "t").unwrap();
        assert!(check(&case, folder.path(), 1000, 2, None).is_ok());
        let text = check(&case, folder.path(), 1 << 60, 2, None).unwrap_err().to_string();
        assert!(text.contains("GB free for") && text.contains("hint: "), "{text}");
    }
}
