//! Mach numbers that are finished: what a boundary that was interrupted goes on with.
//!
//! They are independent of one another, so that those that follow have the bits that they would have had. What is kept serves the same
//! case, with the same files and the same version, alone; a checksum tells a file that was changed since.
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::super::folder::{self, KEPT};
use crate::case::Case;
use crate::observe::table::write_json;
use crate::problem::RunError;
use crate::problem::files;
use crate::record::flutter::{FlutterAt, LimitCycle, MotionRow, StateSpaceAt};

/// All that is finished of one case.
#[derive(Clone, Serialize, Deserialize)]
pub(super) struct Kept {
    /// Checksum of version, case and its files.
    key: String,
    /// CRC-32 of what is finished.
    #[serde(default)]
    crc32: u32,
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
    /// What `out` has of `case`, whose files lie in `input`; nothing where it has none, or that of another case or version. Refuses what
    /// was changed since a run wrote it.
    pub(super) fn of(case: &Case, input: &Path, out: &Path) -> Result<Self, RunError> {
        let key = folder::identity(case, input);
        let none = |key| Self { key, crc32: 0, finished: Vec::new() };
        let Ok(text) = files::text(out, KEPT) else { return Ok(none(key)) };
        let tree = serde_json::from_str::<serde_json::Value>(&text).unwrap_or_default();
        if tree.get("key").and_then(serde_json::Value::as_str).is_some_and(|other| other != key) {
            return Ok(none(key));
        }
        let kept = serde_json::from_value::<Self>(tree).ok();
        let whole = |kept: &Self| kept.crc32 == kept.checksum() && kept.finished.iter().all(Finished::is_possible);
        match kept.filter(whole) {
            Some(kept) => Ok(kept),
            None => Err(RunError::Folder {
                what: format!(
                    "`{}` was changed since a run wrote it: its checksum is not that of its numbers",
                    out.join(KEPT).display()
                ),
                hint:
                    "put it back as it was, or remove it: the Mach numbers that were finished are then computed again"
                        .into(),
            }),
        }
    }

    /// Checksum of all that is finished, as it is written.
    fn checksum(&self) -> u32 {
        crc32fast::hash(&serde_json::to_vec(&self.finished).unwrap_or_default())
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

    /// Writes all of it into `out`.
    pub(super) fn write(&self, out: &Path) -> Result<(), RunError> {
        Ok(write_json(&out.join(KEPT), &Self { crc32: self.checksum(), ..self.clone() })?)
    }
}

impl Finished {
    /// True where no number is one that a boundary cannot have: lengths and counts are positive, no speed and no frequency is negative.
    fn is_possible(&self) -> bool {
        let at = &self.at;
        let positive = [at.mach, at.chord, at.semichord].iter().all(|x| x.is_finite() && *x >= 0.0) && at.mach > 0.0;
        let rising = at.reduced_frequencies.windows(2).all(|k| k[0] <= k[1]);
        let crossings =
            at.crossings.iter().flat_map(|c| [c.speed_ratio, c.speed, c.density, c.dynamic_pressure, c.frequency]);
        let cycles = self.cycles.iter().flat_map(|c| [c.amplitude, c.speed_ratio, c.speed, c.density, c.frequency]);
        let forces = at.forces.iter().flatten().flatten();
        positive
            && rising
            && crossings.chain(cycles).all(|x| x.is_finite() && x >= 0.0)
            && forces.chain(self.still.iter()).chain(self.borne.iter()).all(|x| x.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::flutter::marched::tests::cycle;

    #[test]
    fn what_is_kept_is_the_same_again_and_of_the_same_case_alone() {
        let folder = tempfile::tempdir().unwrap();
        let case = |mach: f64| {
            let text = format!("[flow]\nmach = {mach}\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n");
            crate::case::read(&text, "case.toml").unwrap()
        };
        let (input, out) = (Path::new(""), folder.path());
        let at = FlutterAt {
            mach: 0.7,
            still: vec![0.1 + 0.2, 1.0 / 3.0],
            cycles: vec![LimitCycle { error: f64::INFINITY, ..cycle() }],
            forces: vec![vec![[1e-300, -2.0 / 7.0]]],
            ..FlutterAt::default()
        };
        let mut kept = Kept::of(&case(0.5), input, out).unwrap();
        assert!(kept.at(0.7).is_none());
        kept.add(&at);
        kept.write(out).unwrap();
        let again = Kept::of(&case(0.5), input, out).unwrap().at(0.7).unwrap();
        assert_eq!(format!("{again:?}"), format!("{at:?}"));
        assert!(Kept::of(&case(0.6), input, out).unwrap().at(0.7).is_none());
        // by hand: another number, an older version without a checksum, half a file
        let path = folder.path().join(KEPT);
        let text = std::fs::read_to_string(&path).unwrap();
        let unsummed: String = text.lines().filter(|line| !line.contains("crc32")).collect();
        for forged in
            [text.replace("0.7", "0.9"), text.replace("1e-300", "1e-3"), unsummed, text[..text.len() / 2].to_owned()]
        {
            assert_ne!(forged, text);
            std::fs::write(&path, &forged).unwrap();
            let refused = Kept::of(&case(0.5), input, out).err().unwrap().to_string();
            assert!(
                refused.contains("flutter-kept.json` was changed") && refused.contains("or remove it"),
                "{refused}"
            );
        }
        folder::forget_kept(folder.path());
        assert!(Kept::of(&case(0.5), input, out).unwrap().at(0.7).is_none());
    }
}
