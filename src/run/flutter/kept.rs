//! Mach numbers that are finished: what a boundary that was interrupted goes on with.
//!
//! They are independent of one another, so that those that follow have the bits that they would have had. What is kept serves the same
//! case, with the same files and the same version, alone.
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::super::error::RunError;
use super::super::folder::{self, KEPT};
use super::record::{FlutterAt, LimitCycle};
use super::rows::MotionRow;
use super::state_space::StateSpaceAt;
use crate::case::Case;
use crate::observe::table::write_json;

/// All that is finished of one case.
#[derive(Serialize, Deserialize)]
pub(super) struct Kept {
    /// Checksum of version, case and its files.
    key: String,
    finished: Vec<Finished>,
}

/// One Mach number, with what `flutter.json` leaves to other files.
#[derive(Clone, Serialize, Deserialize)]
struct Finished {
    at: FlutterAt,
    motions: Vec<MotionRow>,
    state_space: Option<StateSpaceAt>,
    cycles: Vec<LimitCycle>,
    still: Vec<f64>,
    borne: Vec<f64>,
}

impl Kept {
    /// What `out` has of `case`, whose files lie in `input`; nothing where it has none, or another one, or is no folder.
    pub(super) fn of(case: &Case, input: &Path, out: Option<&Path>) -> Self {
        let key = folder::identity(case, input);
        let read =
            out.and_then(|out| folder::text(out, KEPT).ok()).and_then(|text| serde_json::from_str::<Self>(&text).ok());
        read.filter(|kept| kept.key == key).unwrap_or(Self { key, finished: Vec::new() })
    }

    /// A Mach number that is finished.
    pub(super) fn at(&self, mach: f64) -> Option<FlutterAt> {
        let found = self.finished.iter().find(|f| f.at.mach == mach).cloned()?;
        let Finished { at, motions, state_space, cycles, still, borne } = found;
        Some(FlutterAt { motions, state_space, cycles, still, borne, ..at })
    }

    /// Keeps a Mach number as well.
    pub(super) fn add(&mut self, at: &FlutterAt) {
        self.finished.push(Finished {
            at: at.clone(),
            motions: at.motions.clone(),
            state_space: at.state_space.clone(),
            cycles: at.cycles.clone(),
            still: at.still.clone(),
            borne: at.borne.clone(),
        });
    }

    /// Writes all of it into `out`, where there is a folder.
    pub(super) fn write(&self, out: Option<&Path>) -> Result<(), RunError> {
        out.map_or(Ok(()), |out| Ok(write_json(&out.join(KEPT), self)?))
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::tests::cycle;
    use super::*;

    #[test]
    fn what_is_kept_is_the_same_again_and_of_the_same_case_alone() {
        let folder = tempfile::tempdir().unwrap();
        let case = |mach: f64| {
            let text = format!("[flow]\nmach = {mach}\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n");
            crate::case::read(&text, "case.toml").unwrap()
        };
        let (input, out) = (Path::new(""), Some(folder.path()));
        let at = FlutterAt {
            mach: 0.7,
            still: vec![0.1 + 0.2, 1.0 / 3.0],
            cycles: vec![LimitCycle { error: f64::INFINITY, ..cycle() }],
            forces: vec![vec![[1e-300, -2.0 / 7.0]]],
            ..FlutterAt::default()
        };
        let mut kept = Kept::of(&case(0.5), input, out);
        assert!(kept.at(0.7).is_none());
        kept.add(&at);
        kept.write(out).unwrap();
        let again = Kept::of(&case(0.5), input, out).at(0.7).unwrap();
        assert_eq!(format!("{again:?}"), format!("{at:?}"));
        assert!(Kept::of(&case(0.6), input, out).at(0.7).is_none());
        folder::forget_kept(folder.path());
        assert!(Kept::of(&case(0.5), input, out).at(0.7).is_none());
    }
}
