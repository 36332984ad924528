//! What is measured of a flutter boundary.
use super::Value;
use crate::claims::Claim;
use crate::claims::metric::FlutterMetric;
use crate::record::flutter::{Boundary, FlutterRow};

/// Part by which Mach numbers may differ.
const SAME: f64 = 1e-9;

/// A metric of a boundary, and of another one where the `claim` compares them.
pub(in super::super) fn value(
    boundary: &Boundary,
    other: Option<&Boundary>,
    (metric, claim): (FlutterMetric, &Claim),
) -> Value {
    let first = || flutter(boundary, claim);
    let largest = || {
        let found = boundary.lco.iter().max_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
        found.ok_or_else(|| "there are no limit cycles".to_owned())
    };
    let index = |found: Option<f64>| found.ok_or_else(|| "the structure has no speed index".to_owned());
    match metric {
        FlutterMetric::FlutterSpeed => Ok(first()?.speed),
        FlutterMetric::FlutterIndex => index(first()?.speed_index),
        FlutterMetric::FlutterFrequency => first().map(|f| f.frequency_ratio.unwrap_or(f.frequency)),
        FlutterMetric::FlutterError => Ok(first()?.error),
        FlutterMetric::FlutterDifference => {
            let other = flutter(other.ok_or("the claim names no `other` case")?, claim)?;
            Ok((first()?.speed / other.speed - 1.0).abs())
        }
        FlutterMetric::LimitCycleIndex => index(largest()?.speed_index),
        FlutterMetric::LimitCycleError => Ok(largest()?.error),
        FlutterMetric::LimitCycleMarch => {
            let marched = boundary.lco.iter().find_map(|c| c.march.as_ref());
            marched.map(|m| m.difference.abs()).ok_or_else(|| "no limit cycle was marched".to_owned())
        }
    }
}

/// The first flutter at the Mach number of the claim.
fn flutter<'a>(boundary: &'a Boundary, claim: &Claim) -> Result<&'a FlutterRow, String> {
    let chosen = |mach: f64| claim.mach.is_none_or(|m| (m - mach).abs() <= SAME);
    let at = boundary.flutter.iter().find(|at| chosen(at.mach)).ok_or("the boundary has no such Mach number")?;
    let first = at.crossings.iter().find(|c| c.kind == "flutter");
    first.ok_or_else(|| format!("nothing flutters at Mach {}", at.mach))
}
