//! Generalised aerodynamic forces: a harmonic balance for each mode and reduced frequency, at two amplitudes.
use std::path::Path;

use num_complex::Complex64;
use serde::Serialize;
use serde_json::json;

use super::error::RunError;
use super::folder::{self, Places};
use super::look::reference;
use super::monitor::Monitor;
use super::record::summary::Summary;
use super::session::{Outcome, Session};
use super::setup;
use crate::case::{AnyMode, Case, Gaf, Mode};
use crate::geometry::dimension;
use crate::observe::columns::{Scale, describe_tables};
use crate::observe::table::{Entry, write_csv, write_json};

/// What files say about signs and units.
const CONVENTION: &str = "f(t) = Re f exp(+i omega t); Cl = lift/(q c), up positive; Cm = moment/(q c^2) about the pivot, nose up \
                          positive; columns per plunge over the length L (up positive), per radian of pitch (nose up positive), \
                          per unit of the coordinate of a flexible mode; Q_ij = work of the gas per unit of coordinate i, due to \
                          coordinate j, over q S c (2-D: S = c), with the coordinates of the columns: the row of pitch is Cm, that \
                          of plunge the upward force over q S times L/c; k = omega L/U with L as given; phase positive when the \
                          load leads the motion";

/// Part of the amplitude of `[gaf]` that a column is computed with once more.
const HALF: f64 = 0.5;

/// One column of the matrix at one frequency.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// Reduced frequency.
    pub k: f64,
    /// Mode that moves.
    pub mode: String,
    /// Lift over motion: real and imaginary part.
    pub cl: [f64; 2],
    /// Moment over motion.
    pub cm: [f64; 2],
    /// Generalised force on every mode over motion, see [`super::GeneralisedForce`].
    pub q: Vec<[f64; 2]>,
    /// Greatest change of lift, moment or generalised force, over the largest of them, when the amplitude is halved.
    pub nonlinearity: f64,
    /// Processor seconds of both solutions.
    pub cpu_seconds: f64,
    /// True when both solutions converged.
    pub converged: bool,
}

/// Matrices of all frequencies.
#[derive(Clone, Debug)]
pub struct Matrices {
    /// Names of the modes, in the order of rows and columns.
    pub modes: Vec<String>,
    /// Columns, frequency by frequency in the order of the case.
    pub columns: Vec<Column>,
    /// Change above which a column is told to be nonlinear.
    pub linearity: f64,
    /// Where forces hold.
    pub conditions: Conditions,
}

/// The flow and the lengths that forces hold for.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Conditions {
    /// Mach number.
    pub mach: f64,
    /// Angle of attack.
    pub alpha_deg: f64,
    /// Reference chord c and area S (2-D: c).
    pub chord: f64,
    /// S.
    pub area: f64,
    /// Length L of the reduced frequencies.
    pub reduced_length: f64,
    /// Point about which the body pitches.
    pub pivot: Option<Vec<f64>>,
}

/// Computes the matrices of the table `[gaf]` into a fresh folder, or one where those of the same case were not all found; `None` when the
/// monitor says stop.
pub fn gaf(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    let Some(plan) = case.gaf.clone() else {
        return Err(RunError::Unsupported {
            what: "the case has no table `[gaf]`".into(),
            hint: "add one with `reduced_frequencies`",
        });
    };
    setup::supported(case)?;
    let _held = folder::create_once(case, &places.input, &places.out)?;
    let modes = plan.all_modes().map(|m| m.name().to_owned()).collect();
    let conditions = Conditions::of(case, &plan, &places.input)?;
    let mut matrices = Matrices { modes, columns: Vec::new(), linearity: plan.linearity, conditions };
    for &k in &plan.reduced_frequencies {
        for mode in plan.all_modes() {
            let swing = Swing { plan: &plan, mode, k };
            let Some(column) = column(case, &swing, &places.input, monitor)? else { return Ok(None) };
            monitor.note(&format!(
                "k = {k}, {}: Cl {:+.4} {:+.4}i, Cm {:+.4} {:+.4}i, halved amplitude changes {:.2} %",
                column.mode,
                column.cl[0],
                column.cl[1],
                column.cm[0],
                column.cm[1],
                100.0 * column.nonlinearity
            ));
            matrices.columns.push(column);
            let scale = Scale { dimensional: case.flow.is_dimensional(), dimension: dimension(case).into() };
            matrices.write(&plan.reduced_frequencies, scale, &places.out)?;
        }
    }
    folder::finish(&places.out)?;
    Ok(Some(matrices))
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
        nonlinearity: change / size,
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
            AnyMode::Rigid(Mode::Pitch) => ("angle", 1.0, plan.pitch.0),
            AnyMode::Rigid(Mode::Plunge) => ("shift", length, plan.plunge.0 / length),
            AnyMode::Flexible(mode) => ("mode", 1.0, mode.amplitude),
        };
        let found = summary.first_harmonics.iter().find(|h| h.motion.starts_with(part));
        let found = found.ok_or_else(|| RunError::NothingMoved { mode: mode.name().to_owned() })?;
        let loads = [found.cl, found.cm].map(|[re, im]| Complex64::new(re, im) * scale);
        let forces = summary.generalised_forces.iter().map(|f| f.per(factor * amplitude));
        Ok(loads.into_iter().chain(forces).collect())
    }
}

impl Conditions {
    fn of(case: &Case, plan: &Gaf, input: &Path) -> Result<Self, RunError> {
        let (chord, area) = match dimension(case) {
            2 => {
                let chord =
                    setup::surface::<2>(case, input)?.0.as_ref().map_or(1.0, |s| reference::chord(case, Some(s)));
                (chord, chord)
            }
            _ => {
                let seen = setup::surface::<3>(case, input)?.0.as_ref().map(|s| reference::planform(case, s));
                seen.map_or((1.0, 1.0), |seen| (seen.chord, seen.area))
            }
        };
        Ok(Self {
            mach: case.flow.reference().mach,
            alpha_deg: case.flow.alpha.0.to_degrees(),
            chord,
            area,
            reduced_length: plan.reduced_length.map_or(0.5 * chord, |l| l.0),
            pivot: plan.pivot.as_ref().map(|p| p.iter().map(|x| x.0).collect()),
        })
    }
}

impl Matrices {
    /// Writes `gaf.csv`, a row for each column of the matrices, and `gaf.json`.
    fn write(&self, frequencies: &[f64], scale: Scale, out: &Path) -> Result<(), RunError> {
        let rows = self.columns.iter().map(|c| {
            let mut row = vec![Entry::from(c.k), Entry::from(c.mode.as_str())];
            for [re, im] in [c.cl, c.cm] {
                let value = Complex64::new(re, im);
                row.extend([re, im, value.norm(), value.arg().to_degrees()].map(Entry::from));
            }
            row.extend(c.q.iter().flatten().map(|v| Entry::from(*v)));
            row.push(Entry::from(c.nonlinearity));
            row
        });
        let parts = |load: &str| ["re", "im", "abs", "phase_deg"].map(|part| format!("{load}_{part}"));
        let mut names: Vec<String> = ["k".into(), "mode".into()].into();
        names.extend(["cl", "cm"].iter().flat_map(|load| parts(load)));
        names.extend(self.modes.iter().flat_map(|m| [format!("q_{m}_re"), format!("q_{m}_im")]));
        names.push("nonlinearity".into());
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        write_csv(&out.join(folder::MATRICES), &names, rows)?;
        describe_tables(out, scale, &[])?;
        let c = &self.conditions;
        let whole = json!({
            "convention": CONVENTION,
            "mach": c.mach,
            "alpha_deg": c.alpha_deg,
            "chord": c.chord,
            "area": c.area,
            "reduced_length": c.reduced_length,
            "pivot": c.pivot,
            "rows": ["cl", "cm"],
            "modes": self.modes,
            "matrices": frequencies.iter().map(|k| self.matrix(*k)).collect::<Vec<_>>(),
            "columns": self.columns,
        });
        Ok(write_json(&out.join("gaf.json"), &whole)?)
    }

    /// Rows `cl` and `cm`, and the square matrix `q`: `q[i][j]` is the force on mode i that mode j makes.
    fn matrix(&self, k: f64) -> serde_json::Value {
        let columns: Vec<&Column> = self.columns.iter().filter(|c| c.k == k).collect();
        let row = |i: usize| columns.iter().map(|c| c.q[i]).collect::<Vec<_>>();
        json!({
            "k": k,
            "cl": columns.iter().map(|c| c.cl).collect::<Vec<_>>(),
            "cm": columns.iter().map(|c| c.cm).collect::<Vec<_>>(),
            "q": (0..self.modes.len()).map(row).collect::<Vec<_>>(),
        })
    }
}
