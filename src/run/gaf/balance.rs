//! A column of the matrix by harmonic balance, with the amplitude of `[gaf]` and half of it.
use std::path::Path;

use num_complex::Complex64;

use super::super::error::RunError;
use super::super::folder::Places;
use super::super::monitor::Monitor;
use super::super::record::summary::Summary;
use super::super::session::{Outcome, Session};
use super::record::{Column, Matrices};
use crate::case::{AnyMode, Case, Gaf, Mode};

/// Part of the amplitude of `[gaf]` that a column is computed with once more.
const HALF: f64 = 0.5;

/// Finds the columns of all modes and frequencies of `plan`, and calls `keep` after each; false when the monitor says stop.
pub(super) fn columns(
    (case, plan): (&Case, &Gaf),
    places: &Places,
    matrices: &mut Matrices,
    keep: &mut dyn FnMut(&Matrices) -> Result<(), RunError>,
    monitor: &mut dyn Monitor,
) -> Result<bool, RunError> {
    for &k in &plan.reduced_frequencies {
        for mode in plan.all_modes() {
            let Some(column) = column(case, &Swing { plan, mode, k }, &places.input, monitor)? else {
                return Ok(false);
            };
            monitor.note(&format!(
                "k = {k}, {}: Cl {:+.4} {:+.4}i, Cm {:+.4} {:+.4}i, halved amplitude changes {:.2} %",
                column.mode,
                column.cl[0],
                column.cl[1],
                column.cm[0],
                column.cm[1],
                100.0 * column.nonlinearity.unwrap_or_default()
            ));
            matrices.columns.push(column);
            keep(matrices)?;
        }
    }
    Ok(true)
}

/// One mode at one frequency.
struct Swing<'a> {
    plan: &'a Gaf,
    mode: AnyMode<'a>,
    k: f64,
}

/// A column of the matrix; `None` when the monitor says stop.
fn column(case: &Case, swing: &Swing<'_>, input: &Path, monitor: &mut dyn Monitor) -> Result<Option<Column>, RunError> {
    let Swing { plan, mode, k } = *swing;
    let mut found = Vec::new();
    let (mut cpu_seconds, mut converged) = (0.0, true);
    for factor in [1.0, HALF] {
        let mut session = Session::open(&case.gaf_case(plan, mode, k, factor), input)?;
        let Outcome::Finished(summary) = session.solve(monitor)? else { return Ok(None) };
        cpu_seconds += summary.cpu_seconds;
        converged &= summary.succeeded();
        found.push(swing.loads(&summary, factor)?);
    }
    let (whole, half) = (&found[0], &found[1]);
    let size = whole.iter().map(|c| c.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let change = whole.iter().zip(half).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    let parts: Vec<[f64; 2]> = whole.iter().map(|c| [c.re, c.im]).collect();
    Ok(Some(Column {
        k,
        mode: mode.name().to_owned(),
        cl: parts[0],
        cm: parts[1],
        q: parts[2..].to_vec(),
        nonlinearity: Some(change / size),
        solved: None,
        cpu_seconds,
        converged,
    }))
}

impl Swing<'_> {
    /// Lift, moment and generalised forces over the motion, which has `factor` times the amplitude of `[gaf]`.
    fn loads(&self, summary: &Summary, factor: f64) -> Result<Vec<Complex64>, RunError> {
        let Self { plan, mode, .. } = *self;
        let length = plan.reduced_length.map_or(0.5 * summary.chord, |l| l.0);
        // the part of the motion, the coordinate per unit of it, the amplitude of the coordinate
        let (part, scale, amplitude) = match mode {
            AnyMode::Rigid(Mode::Pitch) => ("angle", 1.0, plan.pitch.unwrap_or(Gaf::PITCH).0),
            AnyMode::Rigid(Mode::Plunge) => ("shift", length, plan.plunge.unwrap_or(Gaf::PLUNGE).0 / length),
            AnyMode::Flexible(mode) => ("mode", 1.0, mode.amplitude.unwrap_or_default()),
        };
        let found = summary.first_harmonics.iter().find(|h| h.motion.starts_with(part));
        let found = found.ok_or_else(|| RunError::NothingMoved { mode: mode.name().to_owned() })?;
        let loads = [found.cl, found.cm].map(|[re, im]| Complex64::new(re, im) * scale);
        let forces = summary.generalised_forces.iter().map(|f| f.per(factor * amplitude));
        Ok(loads.into_iter().chain(forces).collect())
    }
}
