//! Error bars held against loads that are known exactly.
//!
//! A table `case,load,exact` names case files and what one of their loads is. Loads that are zero because flow and body are
//! symmetric do not belong in it: any bar holds them.
use super::curve::{Table, TableError};

/// Names of the loads.
const LOADS: [&str; 3] = ["cl", "cd", "cm"];

/// A load that is known exactly.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownLoad {
    /// Case file, beside the table.
    pub case: String,
    /// Name of the load: `cl`, `cd` or `cm`.
    pub load: String,
    /// Its exact value.
    pub exact: f64,
}

/// Such a load as a run found it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarredLoad {
    /// Absolute difference from the exact value.
    pub error: f64,
    /// Half width of its error bar.
    pub half_width: f64,
}

impl KnownLoad {
    /// The rows of a table.
    pub fn all(table: &Table) -> Result<Vec<Self>, TableError> {
        let (cases, loads, exact) = (table.text("case")?, table.text("load")?, table.column("exact")?);
        let rows = cases.iter().zip(&loads).zip(exact);
        Ok(rows.map(|((case, load), exact)| Self { case: case.clone(), load: load.clone(), exact }).collect())
    }

    /// The load among the three (lift, drag, moment) of a run and their half widths; `None` for a name that is none.
    pub fn found(&self, loads: [f64; 3], half_widths: [f64; 3]) -> Option<BarredLoad> {
        let k = LOADS.iter().position(|name| *name == self.load)?;
        Some(BarredLoad { error: (loads[k] - self.exact).abs(), half_width: half_widths[k] })
    }
}

/// Part of the loads whose error lies within its bar; `None` without loads.
pub fn holding(loads: &[BarredLoad]) -> Option<f64> {
    let inside = loads.iter().filter(|l| l.error <= l.half_width).count();
    (!loads.is_empty()).then(|| inside as f64 / loads.len() as f64)
}

/// Median of bar over error; `None` without loads.
pub fn median_ratio(loads: &[BarredLoad]) -> Option<f64> {
    let mut ratios: Vec<f64> = loads.iter().map(|l| l.half_width / l.error).collect();
    ratios.sort_by(f64::total_cmp);
    let n = ratios.len();
    let middle = *ratios.get(n / 2)?;
    Some(if n.is_multiple_of(2) { 0.5 * (ratios[n / 2 - 1] + middle) } else { middle })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_read_and_judged() {
        let table = Table::parse("# source\ncase,load,exact\na.toml,cl,0.3\na.toml,cd,0\nb.toml,lift,1\n").unwrap();
        let rows = KnownLoad::all(&table).unwrap();
        let found: Vec<_> = rows.iter().map(|r| r.found([0.31, 1e-4, 0.0], [0.005, 3e-4, 0.0])).collect();
        assert!(found[2].is_none());
        let found: Vec<_> = found.into_iter().flatten().collect();
        assert_eq!(holding(&found), Some(0.5));
        assert!((median_ratio(&found).unwrap() - 1.75).abs() < 1e-9, "{found:?}");
        assert_eq!((holding(&[]), median_ratio(&[])), (None, None));
    }
}
