//! A column of the matrix by harmonic balance, with the amplitude of `[gaf]` and half of it, and on a cloud with twice the spacing.

use num_complex::Complex64;

use super::super::flow;
use super::super::monitor::{Monitor, Quiet};
use super::super::solution::Solution;
use super::cloud_error::{self, OnCoarser};
use super::{Column, Matrices};
use crate::case::{AnyMode, Cloud, Gaf, Mode};
use crate::problem::coarser::{COARSER, refinement};
use crate::problem::{Problem, RunError};
use crate::record::summary::Summary;

/// Part of the amplitude of `[gaf]` that a column is computed with once more.
const HALF: f64 = 0.5;

/// Finds the columns of all modes and frequencies of `plan` with their error bars, and calls `keep` after each; false when the monitor
/// says stop.
pub(super) fn columns(
    (problem, plan): (&Problem, &Gaf),
    matrices: &mut Matrices,
    keep: &mut dyn FnMut(&Matrices) -> Result<(), RunError>,
    monitor: &mut dyn Monitor,
) -> Result<bool, RunError> {
    let (mut coarse, mut ratio) = (Vec::new(), COARSER);
    for &k in &plan.reduced_frequencies {
        for mode in plan.all_modes() {
            let swing = Swing { plan, mode, k };
            let own = |factor: f64| problem.in_motion_of_gaf(plan, mode, k, factor);
            let Some((whole, cloud)) = swing.solved(own(1.0)?, 1.0, monitor)? else { return Ok(false) };
            let Some((half, _)) = swing.solved(own(HALF)?, HALF, monitor)? else { return Ok(false) };
            let column = swing.column(&whole, Some(&half));
            monitor.note(&format!(
                "k = {k}, {}: Cl {:+.4} {:+.4}i, Cm {:+.4} {:+.4}i, halved amplitude changes {:.2} %",
                column.mode,
                column.cl[0],
                column.cl[1],
                column.cm[0],
                column.cm[1],
                100.0 * column.nonlinearity.unwrap_or_default()
            ));
            if let Some(change) = column.nonlinearity.filter(|change| *change > matrices.linearity) {
                monitor.warn(&format!(
                    "k = {k}, {}: halving the amplitude changes the forces by {:.2} %, more than `gaf.linearity` = {} %",
                    column.mode,
                    100.0 * change,
                    100.0 * matrices.linearity
                ));
            }
            matrices.columns.push(column);
            keep(matrices)?;
            let one = own(1.0)?.on_cloud(cloud)?;
            ratio = refinement(&one.given().cloud, COARSER);
            match swing.on_coarser(&one, monitor)? {
                Asked::Stopped => return Ok(false),
                Asked::Told(column) => coarse.push(*column),
                Asked::Silent => {}
            }
        }
    }
    cloud_error::tell(&mut matrices.columns, &[OnCoarser { ratio, columns: coarse }]);
    keep(matrices)?;
    Ok(true)
}

/// One mode at one frequency.
struct Swing<'a> {
    plan: &'a Gaf,
    mode: AnyMode<'a>,
    k: f64,
}

/// Loads over a motion.
struct Swung {
    /// Lift, moment and generalised forces per unit of the coordinate.
    loads: Vec<Complex64>,
    cpu_seconds: f64,
    converged: bool,
}

/// What a coarser cloud says.
enum Asked {
    /// The monitor said stop.
    Stopped,
    /// A column.
    Told(Box<Column>),
    /// Nothing: it is not asked for, does not fit into the domain, or cannot be computed on.
    Silent,
}

impl Swing<'_> {
    /// Loads with `factor` times the amplitude of `[gaf]` and the cloud that they were found on; `None` when the monitor says stop.
    fn solved(&self, own: Problem, factor: f64, monitor: &mut dyn Monitor) -> Result<Option<(Swung, Cloud)>, RunError> {
        let Some(Solution { summary, .. }) = flow::in_memory(&own, monitor)? else { return Ok(None) };
        let (cpu_seconds, converged) = (summary.cost.cpu_seconds, summary.succeeded());
        let swung = Swung { loads: self.loads(&summary, factor)?, cpu_seconds, converged };
        Ok(Some((swung, summary.conditions.cloud)))
    }

    /// A column of the matrix, with what it changes by when the amplitude is halved.
    fn column(&self, whole: &Swung, half: Option<&Swung>) -> Column {
        let size = whole.loads.iter().map(|c| c.norm()).fold(f64::MIN_POSITIVE, f64::max);
        let change =
            |half: &Swung| whole.loads.iter().zip(&half.loads).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / size;
        let parts: Vec<[f64; 2]> = whole.loads.iter().map(|c| [c.re, c.im]).collect();
        Column {
            k: self.k,
            mode: self.mode.name().to_owned(),
            cl: parts[0],
            cm: parts[1],
            q: parts[2..].to_vec(),
            nonlinearity: half.map(change),
            errors: None,
            solved: None,
            cpu_seconds: whole.cpu_seconds + half.map_or(0.0, |h| h.cpu_seconds),
            converged: whole.converged && half.is_none_or(|h| h.converged),
        }
    }

    /// The column of the case `own` on a cloud with twice the spacing.
    fn on_coarser(&self, own: &Problem, monitor: &mut dyn Monitor) -> Result<Asked, RunError> {
        if !self.plan.cloud_error {
            return Ok(Asked::Silent);
        }
        let solved = match own.on_spacing(COARSER) {
            Ok(None) => return Ok(Asked::Silent),
            Ok(Some(coarse)) => self.solved(coarse, 1.0, &mut Quiet { monitor }),
            Err(problem) => Err(problem),
        };
        Ok(match solved {
            Ok(Some((swung, _))) => Asked::Told(Box::new(self.column(&swung, None))),
            Ok(None) => Asked::Stopped,
            Err(problem) => {
                monitor.note(&format!("the coarser cloud tells nothing: {problem}"));
                Asked::Silent
            }
        })
    }

    /// Lift, moment and generalised forces over the motion, which has `factor` times the amplitude of `[gaf]`.
    fn loads(&self, summary: &Summary, factor: f64) -> Result<Vec<Complex64>, RunError> {
        let Self { plan, mode, .. } = *self;
        let length = plan.reduced_length.map_or(0.5 * summary.conditions.chord, |l| l.0);
        // the part of the motion, the coordinate per unit of it, the amplitude of the coordinate
        let (part, scale, amplitude) = match mode {
            AnyMode::Rigid(Mode::Pitch) => ("angle", 1.0, plan.pitch.unwrap_or(Gaf::PITCH).0),
            AnyMode::Rigid(Mode::Plunge) => ("shift", length, plan.plunge.unwrap_or(Gaf::PLUNGE).0 / length),
            AnyMode::Flexible(mode) => ("mode", 1.0, mode.amplitude.unwrap_or_default()),
        };
        let found = summary.periodic.first_harmonics.iter().find(|h| h.motion.starts_with(part));
        let found = found.ok_or_else(|| RunError::NothingMoved { mode: mode.name().to_owned() })?;
        let loads = [found.cl, found.cm].map(|[re, im]| Complex64::new(re, im) * scale);
        let forces = summary.periodic.generalised_forces.iter().map(|f| f.per(factor * amplitude));
        Ok(loads.into_iter().chain(forces).collect())
    }
}
