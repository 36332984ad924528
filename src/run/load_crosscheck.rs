//! Loads of a period, evaluated twice: on the walls, and from the momentum of the gas around the bodies.
use std::path::Path;

use serde::Serialize;

use crate::observe::History;
use crate::observe::loads::Coefficients;
use crate::observe::table::FileError;

/// Name of the table in the run folder.
const FILE: &str = "momentum.csv";
/// Its columns.
const COLUMNS: [&str; 8] = ["iteration", "time", "cl", "cd", "cm", "cl_momentum", "cd_momentum", "cm_momentum"];
/// Moments of a period of a march at which both are evaluated.
pub(super) const MOMENTS: u32 = 12;

/// How far two evaluations of a load lie apart over a period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Apart {
    /// Mean difference, momentum balance less walls.
    pub mean: f64,
    /// Root mean square of the difference.
    pub rms: f64,
    /// Greatest less smallest load on the walls at these moments.
    pub range: f64,
}

/// Loads of the last period by momentum balance, against those on the walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LoadCrosscheck {
    /// Moments at which both were evaluated: of a march, or the instances of a harmonic balance.
    pub moments: usize,
    /// Lift.
    pub cl: Apart,
    /// Drag.
    pub cd: Apart,
    /// Moment.
    pub cm: Apart,
}

/// Both evaluations at every moment of a run so far, in memory and in `momentum.csv`.
#[derive(Default)]
pub(super) struct Twofold {
    file: Option<History>,
    rows: Vec<[f64; 8]>,
}

impl Twofold {
    /// Begins, or goes on after `iteration`.
    pub(super) fn open(out: &Path, iteration: Option<u64>) -> Result<Self, FileError> {
        let path = out.join(FILE);
        let Some(iteration) = iteration else {
            return Ok(Self { file: Some(History::create(&path, &COLUMNS)?), rows: Vec::new() });
        };
        let file = Some(History::resume(&path, &COLUMNS, iteration)?);
        let text = super::folder::text(out, FILE).unwrap_or_default();
        let row = |line: &str| {
            let values: Vec<f64> = line.split(',').filter_map(|v| v.parse().ok()).collect();
            <[f64; 8]>::try_from(values).ok()
        };
        Ok(Self { file, rows: text.lines().skip(1).filter_map(row).collect() })
    }

    /// Adds a moment; nothing where no table was begun.
    pub(super) fn push(
        &mut self,
        (iteration, time): (u64, f64),
        wall: &Coefficients,
        around: &Coefficients,
    ) -> Result<(), FileError> {
        let Some(file) = &mut self.file else { return Ok(()) };
        let row = [iteration as f64, time, wall.cl, wall.cd, wall.cm, around.cl, around.cd, around.cm];
        file.append(&row)?;
        self.rows.push(row);
        Ok(())
    }

    /// True when moments are to be kept.
    pub(super) fn is_open(&self) -> bool {
        self.file.is_some()
    }

    /// The moments of the last period; `None` without any.
    pub(super) fn last(&self, period: f64) -> Option<LoadCrosscheck> {
        let end = self.rows.last()?[1];
        let rows: Vec<&[f64; 8]> =
            self.rows.iter().filter(|r| r[1] > end - period * (1.0 - super::run_recorder::NEARLY)).collect();
        let n = rows.len() as f64;
        let apart = |c: usize| {
            let difference = |r: &&[f64; 8]| r[c + 3] - r[c];
            let [low, high] =
                rows.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], r| [l.min(r[c]), h.max(r[c])]);
            Apart {
                mean: rows.iter().map(difference).sum::<f64>() / n,
                rms: (rows.iter().map(|r| difference(r).powi(2)).sum::<f64>() / n).sqrt(),
                range: high - low,
            }
        };
        Some(LoadCrosscheck { moments: rows.len(), cl: apart(2), cd: apart(3), cm: apart(4) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_period_counts_and_goes_on_where_it_was_interrupted() {
        let folder = tempfile::tempdir().unwrap();
        let load = |cl: f64| Coefficients { cl, cd: 1.0, cm: 0.0 };
        let mut all = Twofold::open(folder.path(), None).unwrap();
        for k in 1..=8_u32 {
            let far = if k <= 4 { 5.0 } else { 0.1 };
            all.push((u64::from(k), 0.25 * f64::from(k)), &load(f64::from(k)), &load(f64::from(k) + far)).unwrap();
        }
        let found = all.last(1.0).unwrap();
        assert_eq!(found.moments, 4);
        assert!((found.cl.mean - 0.1).abs() < 1e-12 && (found.cl.rms - 0.1).abs() < 1e-12, "{found:?}");
        assert!(found.cl.range == 3.0 && found.cd.rms == 0.0, "{found:?}");
        let again = Twofold::open(folder.path(), Some(6)).unwrap();
        assert_eq!(again.rows, all.rows[..6]);
        assert!(Twofold::default().last(1.0).is_none());
    }
}
