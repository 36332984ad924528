//! The table of the points of a polar.
use std::path::Path;

use super::PolarPoint;
use crate::observe::loads::Coefficients;
use crate::observe::table::{Entry, FileError, write_csv};

/// Name of the table in the run folder.
const FILE: &str = "polar.csv";
/// Its columns; angles in degrees, time in seconds of the processor.
const COLUMNS: [&str; 21] = [
    "point",
    "mach",
    "alpha_deg",
    "cl",
    "cd",
    "cm",
    "cl_momentum",
    "cd_momentum",
    "cm_momentum",
    "cl_error",
    "cd_error",
    "cm_error",
    "within_accuracy",
    "particles",
    "orders",
    "iterations",
    "from_rest",
    "cpu_seconds",
    "converged",
    "reason",
    "long_bars",
];

/// Writes the table of these points into the folder `out`.
pub fn write_polar(points: &[PolarPoint], out: &Path) -> Result<(), FileError> {
    let rows = points.iter().enumerate().map(|(k, point)| row(k + 1, point));
    write_csv(&out.join(FILE), &COLUMNS, rows)
}

/// Row of the point `number`, counted from 1.
fn row(number: usize, point: &PolarPoint) -> Vec<Entry> {
    let three = |c: Option<Coefficients>| {
        let told = |v: fn(&Coefficients) -> f64| c.as_ref().map_or_else(|| "".into(), |c| Entry::from(v(c)));
        [told(|c| c.cl), told(|c| c.cd), told(|c| c.cm)]
    };
    let flag = |flag: bool| Entry::from(if flag { "true" } else { "false" });
    let mut row: Vec<Entry> = [number as f64, point.mach, point.alpha_deg].map(Entry::from).to_vec();
    row.extend(three(point.loads));
    row.extend(three(point.loads_momentum_balance));
    row.extend(three(point.loads_error));
    row.push(point.within_accuracy.map_or_else(|| "".into(), flag));
    row.extend([point.particles as f64, point.residual_drop, point.iterations as f64].map(Entry::from));
    row.push(flag(point.from_rest));
    row.push(point.cpu_seconds.into());
    row.push(flag(point.converged));
    row.push(point.reason.as_str().into());
    row.push(point.long_bars.join(", ").as_str().into());
    row
}
