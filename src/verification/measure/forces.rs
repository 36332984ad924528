//! What is measured of forces of small motions: how far they are from a table.
use std::path::Path;

use num_complex::Complex64;

use super::{Value, at_no_thickness, designed_thickness};
use crate::case::Case;
use crate::claims::metric::ForceMetric;
use crate::claims::{Claim, Table};
use crate::problem::files::plain;
use crate::record::gaf::Column;

/// Part by which reduced frequencies may differ.
const SAME: f64 = 1e-9;

/// A metric of the forces on a section, extrapolated to none of its thickness where there are several; `folder` has the table,
/// with the columns `mode`, `k`, `coefficient` (`cl` or `cm`), `re` and `im`.
pub(in super::super) fn value(
    sections: &[(&Case, &[Column])],
    (metric, claim): (ForceMetric, &Claim),
    folder: &Path,
) -> Value {
    let name = claim.file.as_deref().ok_or("the claim names no `file` of forces")?;
    let wrong = |e: &dyn std::fmt::Display| format!("`{name}`: {e}");
    let text = plain(&folder.join(name)).map_err(|e| wrong(&e))?;
    let table = Table::parse(&text).map_err(|e| wrong(&e))?;
    let words = |column: &str| table.text(column).map_err(|e| wrong(&e));
    let numbers = |column: &str| table.column(column).map_err(|e| wrong(&e));
    let (modes, coefficients) = (words("mode")?, words("coefficient")?);
    let (k, re, im) = (numbers("k")?, numbers("re")?, numbers("im")?);
    let weights = match sections {
        [_] => vec![1.0],
        _ => {
            let thickness = sections.iter().map(|(case, _)| designed_thickness(case).ok_or("a section is no NACA one"));
            at_no_thickness(&thickness.collect::<Result<Vec<_>, _>>()?)?
        }
    };
    let mut worst: f64 = 0.0;
    for row in 0..table.len() {
        let mut found = Complex64::ZERO;
        for ((_, forces), weight) in sections.iter().zip(&weights) {
            let column = forces.iter().find(|c| c.mode == modes[row] && (c.k - k[row]).abs() <= SAME);
            let column = column.ok_or_else(|| format!("there are no forces of {} at k = {}", modes[row], k[row]))?;
            found += weight * coefficient(column, &coefficients[row])?;
        }
        let over = found / Complex64::new(re[row], im[row]);
        let apart = match metric {
            ForceMetric::ForcePhaseError => over.arg().to_degrees(),
            ForceMetric::ForceAmplitudeError => over.norm() - 1.0,
        };
        worst = worst.max(apart.abs());
    }
    if table.is_empty() { Err(wrong(&"no forces")) } else { Ok(worst) }
}

fn coefficient(column: &Column, name: &str) -> Result<Complex64, String> {
    let [re, im] = match name {
        "cl" => column.cl,
        "cm" => column.cm,
        other => return Err(format!("`{other}` is no coefficient: `cl` or `cm`")),
    };
    Ok(Complex64::new(re, im))
}
