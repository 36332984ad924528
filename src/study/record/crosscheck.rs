//! Loads of a period, evaluated twice: on the walls, and from the momentum of the gas around the bodies.
use crate::observe::loads::Coefficients;
use crate::record::summary::{LoadCrosscheck, LoadsApart};

/// Name of the table in the run folder.
pub(crate) const FILE: &str = "momentum.csv";
/// Its columns.
pub(crate) const COLUMNS: [&str; 8] =
    ["iteration", "time", "cl", "cd", "cm", "cl_momentum", "cd_momentum", "cm_momentum"];
/// Moments of a period of a march at which both are evaluated.
pub(crate) const MOMENTS: u32 = 12;

/// Both evaluations at every moment of a run so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Twofold {
    rows: Vec<[f64; 8]>,
}

/// Loads at one moment, evaluated twice.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// Iteration of the run.
    pub(crate) iteration: u64,
    /// Time, in the units of the case.
    pub(crate) time: f64,
    /// Loads on the walls.
    pub(crate) wall: Coefficients,
    /// Loads from the momentum of the gas.
    pub(crate) around: Coefficients,
}

impl Twofold {
    /// What a table holds.
    pub(crate) fn parse(text: &str) -> Self {
        let row = |line: &str| {
            let values: Vec<f64> = line.split(',').filter_map(|v| v.parse().ok()).collect();
            <[f64; 8]>::try_from(values).ok()
        };
        Self { rows: text.lines().skip(1).filter_map(row).collect() }
    }

    /// Adds a moment; its row.
    pub(crate) fn push(&mut self, moment: &Moment) -> [f64; 8] {
        let Moment { iteration, time, wall, around } = moment;
        let row = [*iteration as f64, *time, wall.cl, wall.cd, wall.cm, around.cl, around.cd, around.cm];
        self.rows.push(row);
        row
    }

    /// The moments of the last period; `None` without any.
    pub(crate) fn last(&self, period: f64) -> Option<LoadCrosscheck> {
        let end = self.rows.last()?[1];
        let rows: Vec<&[f64; 8]> =
            self.rows.iter().filter(|r| r[1] > end - period * (1.0 - super::interval::NEARLY)).collect();
        let n = rows.len() as f64;
        let apart = |c: usize| {
            let difference = |r: &&[f64; 8]| r[c + 3] - r[c];
            let [low, high] =
                rows.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], r| [l.min(r[c]), h.max(r[c])]);
            LoadsApart {
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
    fn the_last_period_counts() {
        let load = |cl: f64| Coefficients { cl, cd: 1.0, cm: 0.0 };
        let mut all = Twofold::default();
        let mut text = COLUMNS.join(",");
        for k in 1..=8_u32 {
            let far = if k <= 4 { 5.0 } else { 0.1 };
            let (wall, around) = (load(f64::from(k)), load(f64::from(k) + far));
            let row = all.push(&Moment { iteration: u64::from(k), time: 0.25 * f64::from(k), wall, around });
            text += &format!("\n{}", row.map(|v| v.to_string()).join(","));
        }
        let found = all.last(1.0).unwrap();
        assert_eq!(found.moments, 4);
        assert!((found.cl.mean - 0.1).abs() < 1e-12 && (found.cl.rms - 0.1).abs() < 1e-12, "{found:?}");
        assert!(found.cl.range == 3.0 && found.cd.rms == 0.0, "{found:?}");
        assert_eq!(Twofold::parse(&text).rows, all.rows);
        assert!(Twofold::default().last(1.0).is_none());
    }
}
