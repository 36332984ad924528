//! What is measured of structures alone.
use serde::{Deserialize, Serialize};

use super::Value;
use crate::claims::metric::{EndMetric, SolidMetric};
use crate::claims::{Claim, Metric};
use crate::study::{ModeRow, ProbeRow, SolidSummary};

/// The numbers of a structure alone that claims are about.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(in crate::verification) struct Numbers {
    /// Solid particles.
    pub(in crate::verification) particles: usize,
    /// True where it came to its end.
    converged: bool,
    /// Natural modes.
    modes: Vec<ModeRow>,
    /// Probes.
    probes: Vec<ProbeRow>,
    /// What is missing in the energies, over the largest of them.
    open: Option<f64>,
}

impl From<&SolidSummary> for Numbers {
    fn from(s: &SolidSummary) -> Self {
        Self {
            particles: s.particles,
            converged: s.converged,
            modes: s.modes.clone(),
            probes: s.probes.clone(),
            open: s.ledger.map(|l| l.open),
        }
    }
}

/// The metric of `claim`.
pub(in crate::verification) fn value(s: &Numbers, claim: &Claim) -> Value {
    let named = claim.coordinate.as_deref().ok_or("the claim names no `coordinate`");
    match claim.metric {
        Metric::Solid(SolidMetric::ModeOmega) => {
            let number = named?.parse::<usize>().ok().and_then(|k| k.checked_sub(1));
            let mode = number.and_then(|k| s.modes.get(k)).ok_or("there is no mode with that number")?;
            Ok(mode.omega)
        }
        Metric::Solid(SolidMetric::ProbeDisplacement) => {
            let (name, axis) = named?.rsplit_once('.').ok_or("`coordinate` is a probe and an axis, `tip.y`")?;
            let probe = s.probes.iter().find(|p| p.name == name).ok_or("there is no probe of that name")?;
            let axis = ["x", "y", "z"].iter().position(|a| *a == axis).ok_or("axes are x, y and z")?;
            probe.displacement.get(axis).copied().ok_or_else(|| "the probe has no such axis".into())
        }
        Metric::Solid(SolidMetric::ProbeAmplitude) => wave(s, named?).map(|w| w[0]),
        Metric::Solid(SolidMetric::ProbePhase) => wave(s, named?).map(|w| w[1]),
        Metric::Solid(SolidMetric::LedgerOpen) => s.open.map(f64::abs).ok_or_else(|| "the run kept no ledger".into()),
        Metric::End(EndMetric::Converged) => Ok(f64::from(u8::from(s.converged))),
        Metric::End(EndMetric::Particles) => Ok(s.particles as f64),
        // no rest, so that every metric of structures has its arm
        Metric::End(_)
        | Metric::Periodic(_)
        | Metric::Thin(_)
        | Metric::Comparison(_)
        | Metric::Field(_)
        | Metric::Structure(_)
        | Metric::Flutter(_)
        | Metric::Force(_)
        | Metric::Study(_)
        | Metric::Bar(_) => Err(format!("`{}` is not measured of structures alone", claim.metric.name())),
    }
}

/// Amplitude and phase of a harmonic of a probe along an axis.
fn wave(s: &Numbers, named: &str) -> Result<[f64; 2], String> {
    let mut parts: Vec<&str> = named.split('.').collect();
    let number = match parts.last().and_then(|last| last.parse::<usize>().ok()) {
        Some(number) => {
            parts.pop();
            number
        }
        None => 1,
    };
    let axis = parts.pop().and_then(|axis| ["x", "y", "z"].iter().position(|a| *a == axis));
    let axis = axis.ok_or("`coordinate` is a probe, an axis and a harmonic, `tip.y.3`")?;
    let name = parts.join(".");
    let probe = s.probes.iter().find(|p| p.name == name).ok_or("there is no probe of that name")?;
    let wave = probe.harmonics.iter().find(|h| h.harmonic == number).ok_or("the probe has no such harmonic")?;
    match (wave.amplitude.get(axis), wave.phase_deg.get(axis)) {
        (Some(amplitude), Some(phase)) => Ok([*amplitude, *phase]),
        _ => Err("the probe has no such axis".into()),
    }
}
