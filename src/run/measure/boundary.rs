//! What is measured of a flutter boundary.
use super::super::flutter::{Boundary, FlutterRow};
use super::Value;
use crate::verify::{Claim, Metric};

/// Part by which Mach numbers may differ.
const SAME: f64 = 1e-9;

/// The metric of `claim` of a boundary, and of another one where the claim compares them.
pub(in super::super) fn value(boundary: &Boundary, other: Option<&Boundary>, claim: &Claim) -> Value {
    if claim.metric == Metric::LimitCycleMarch {
        let march = boundary.lco.iter().find_map(|c| c.march.as_ref()).ok_or("no limit cycle was marched")?;
        return Ok(march.difference.abs());
    }
    if matches!(claim.metric, Metric::LimitCycleIndex | Metric::LimitCycleError) {
        let largest = boundary.lco.iter().max_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
        let cycle = largest.ok_or("there are no limit cycles")?;
        return match claim.metric {
            Metric::LimitCycleError => Ok(cycle.error),
            _ => cycle.speed_index.ok_or_else(|| "the structure has no speed index".into()),
        };
    }
    let first = flutter(boundary, claim)?;
    match claim.metric {
        Metric::FlutterSpeed => Ok(first.speed),
        Metric::FlutterIndex => first.speed_index.ok_or_else(|| "the structure has no speed index".into()),
        Metric::FlutterFrequency => Ok(first.frequency_ratio.unwrap_or(first.frequency)),
        Metric::FlutterError => Ok(first.error),
        Metric::FlutterDifference => {
            let other = flutter(other.ok_or("the claim names no `other` case")?, claim)?;
            Ok((first.speed / other.speed - 1.0).abs())
        }
        other => Err(format!("`{}` is not measured of a flutter boundary", other.name())),
    }
}

/// The first flutter at the Mach number of the claim.
fn flutter<'a>(boundary: &'a Boundary, claim: &Claim) -> Result<&'a FlutterRow, String> {
    let chosen = |mach: f64| claim.mach.is_none_or(|m| (m - mach).abs() <= SAME);
    let at = boundary.flutter.iter().find(|at| chosen(at.mach)).ok_or("the boundary has no such Mach number")?;
    at.crossings.iter().find(|c| c.kind == "flutter").ok_or_else(|| format!("nothing flutters at Mach {}", at.mach))
}
