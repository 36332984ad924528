//! What is measured of a flutter boundary.
use serde::{Deserialize, Serialize};

use super::Value;
use crate::record::flutter::Boundary;
use crate::verify::Claim;
use crate::verify::metric::FlutterMetric;

/// Part by which Mach numbers may differ.
const SAME: f64 = 1e-9;

/// The numbers of a flutter boundary that claims are about.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(in super::super) struct Numbers {
    /// Mach numbers.
    mach: Vec<f64>,
    /// Where flutter begins, in the order of the boundary.
    onsets: Vec<Onset>,
    /// Limit cycles.
    cycles: Vec<Cycle>,
    /// Particles of the first Mach number.
    pub(in super::super) particles: usize,
}

/// A flutter point.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Onset {
    mach: f64,
    speed: f64,
    speed_index: Option<f64>,
    frequency: f64,
    frequency_ratio: Option<f64>,
    error: f64,
}

/// A limit cycle.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Cycle {
    amplitude: f64,
    speed_index: Option<f64>,
    error: f64,
    /// Amplitude of a march from it over its own, less one.
    marched: Option<f64>,
}

impl From<&Boundary> for Numbers {
    fn from(boundary: &Boundary) -> Self {
        let mut numbers = Self {
            mach: boundary.flutter.iter().map(|at| at.mach).collect(),
            particles: boundary.flutter.first().map_or(0, |at| at.particles),
            ..Self::default()
        };
        for at in &boundary.flutter {
            numbers.onsets.extend(at.crossings.iter().filter(|c| c.kind == "flutter").map(|c| Onset {
                mach: at.mach,
                speed: c.speed,
                speed_index: c.speed_index,
                frequency: c.frequency,
                frequency_ratio: c.frequency_ratio,
                error: c.error,
            }));
        }
        numbers.cycles.extend(boundary.lco.iter().map(|c| Cycle {
            amplitude: c.amplitude,
            speed_index: c.speed_index,
            error: c.error,
            marched: c.march.as_ref().map(|m| m.difference),
        }));
        numbers
    }
}

/// A metric of a boundary, and of another one where the `claim` compares them.
pub(in super::super) fn value(
    boundary: &Numbers,
    other: Option<&Numbers>,
    (metric, claim): (FlutterMetric, &Claim),
) -> Value {
    let first = || flutter(boundary, claim);
    let largest = || {
        let found = boundary.cycles.iter().max_by(|a, b| a.amplitude.total_cmp(&b.amplitude));
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
            let marched = boundary.cycles.iter().find_map(|c| c.marched);
            marched.map(f64::abs).ok_or_else(|| "no limit cycle was marched".to_owned())
        }
    }
}

/// The first flutter at the Mach number of the claim.
fn flutter<'a>(boundary: &'a Numbers, claim: &Claim) -> Result<&'a Onset, String> {
    let chosen = |mach: &&f64| claim.mach.is_none_or(|m| (m - **mach).abs() <= SAME);
    let mach = boundary.mach.iter().find(chosen).ok_or("the boundary has no such Mach number")?;
    boundary.onsets.iter().find(|c| c.mach == *mach).ok_or_else(|| format!("nothing flutters at Mach {mach}"))
}
