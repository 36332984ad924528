//! Generalised aerodynamic forces: a harmonic balance for each mode and reduced frequency, at two amplitudes.
use std::path::Path;

use num_complex::Complex64;
use serde::Serialize;
use serde_json::json;

use super::{Monitor, Outcome, Places, RunError, Summary, setup};
use crate::case::{Case, Gaf, Mode};
use crate::observe::table::{Entry, write_csv, write_json};

/// What files say about signs and units.
const CONVENTION: &str = "f(t) = Re f exp(+i omega t); Cl = lift/(q c), up positive; Cm = moment/(q c^2) about the pivot, nose up \
                          positive; columns per plunge over the length L (up positive) and per radian of pitch (nose up positive); \
                          k = omega L/U with L as given; phase positive when the load leads the motion";

/// One column of the matrix at one frequency.
#[derive(Clone, Debug, Serialize)]
pub struct Column {
    /// Reduced frequency.
    pub k: f64,
    /// Mode that moves.
    pub mode: &'static str,
    /// Lift over motion: real and imaginary part.
    pub cl: [f64; 2],
    /// Moment over motion.
    pub cm: [f64; 2],
    /// Greatest change of lift or moment, over the larger of both, when the amplitude is halved.
    pub nonlinearity: f64,
    /// Processor seconds of both solutions.
    pub cpu_seconds: f64,
    /// True when both solutions converged.
    pub converged: bool,
}

/// Matrices of all frequencies.
#[derive(Clone, Debug)]
pub struct Matrices {
    /// Columns, frequency by frequency in the order of the case.
    pub columns: Vec<Column>,
    /// Change above which a column is told to be nonlinear.
    pub linearity: f64,
}

/// Computes the matrices of the table `[gaf]` into a fresh folder; `None` when the monitor says stop.
pub fn gaf(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    let Some(plan) = case.gaf.clone() else {
        return Err(RunError::Unsupported(
            "the case has no table `[gaf]`\nhint: add one with `reduced_frequencies`".into(),
        ));
    };
    setup::supported(case)?;
    super::folder::create(case, places)?;
    let mut matrices = Matrices { columns: Vec::new(), linearity: plan.linearity };
    for &k in &plan.reduced_frequencies {
        for &mode in &plan.modes {
            let Some(column) = column(case, &plan, (mode, k), places, monitor)? else { return Ok(None) };
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
            matrices.write(&plan, &places.out)?;
        }
    }
    Ok(Some(matrices))
}

/// One mode at one frequency.
fn column(
    case: &Case,
    plan: &Gaf,
    (mode, k): (Mode, f64),
    places: &Places,
    monitor: &mut dyn Monitor,
) -> Result<Option<Column>, RunError> {
    let mut found = Vec::new();
    let (mut cpu_seconds, mut converged) = (0.0, true);
    for (factor, suffix) in [(1.0, ""), (0.5, "-half")] {
        let out = places.out.join(format!("k{k}-{}{suffix}", mode.name()));
        let here = Places { input: places.input.clone(), out };
        let Outcome::Finished(summary) = super::run(&case.gaf_case(plan, mode, k, factor), &here, monitor)? else {
            return Ok(None);
        };
        cpu_seconds += summary.cpu_seconds;
        converged &= summary.converged;
        found.push(loads(&summary, plan, mode)?);
    }
    let (whole, half) = (found[0], found[1]);
    let size = whole.iter().map(|c| c.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let change = whole.iter().zip(&half).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    let [cl, cm] = whole.map(|c| [c.re, c.im]);
    Ok(Some(Column { k, mode: mode.name(), cl, cm, nonlinearity: change / size, cpu_seconds, converged }))
}

/// Lift and moment over the motion.
fn loads(summary: &Summary, plan: &Gaf, mode: Mode) -> Result<[Complex64; 2], RunError> {
    let part = |name: &str| match mode {
        Mode::Pitch => name == "angle",
        Mode::Plunge => name.starts_with("shift"),
    };
    let found = summary.first_harmonics.iter().find(|h| part(h.motion));
    let found = found.ok_or_else(|| RunError::Folder(format!("the run of {} shows no motion", mode.name())))?;
    // per length L rather than per unit length
    let scale = match mode {
        Mode::Pitch => 1.0,
        Mode::Plunge => plan.reduced_length.map_or(0.5 * summary.chord, |l| l.0),
    };
    Ok([found.cl, found.cm].map(|[re, im]| Complex64::new(re, im) * scale))
}

impl Matrices {
    fn write(&self, plan: &Gaf, out: &Path) -> Result<(), RunError> {
        let rows = self.columns.iter().map(|c| {
            let mut row = vec![Entry::from(c.k), Entry::from(c.mode)];
            for [re, im] in [c.cl, c.cm] {
                let value = Complex64::new(re, im);
                row.extend([re, im, value.norm(), value.arg().to_degrees()].map(Entry::from));
            }
            row.push(Entry::from(c.nonlinearity));
            row
        });
        let names = [
            "k",
            "mode",
            "cl_re",
            "cl_im",
            "cl_abs",
            "cl_phase_deg",
            "cm_re",
            "cm_im",
            "cm_abs",
            "cm_phase_deg",
            "nonlinearity",
        ];
        write_csv(&out.join("gaf.csv"), &names, rows)?;
        let matrix = |k: f64| {
            let of =
                |load: fn(&Column) -> [f64; 2]| self.columns.iter().filter(|c| c.k == k).map(load).collect::<Vec<_>>();
            json!({ "k": k, "cl": of(|c| c.cl), "cm": of(|c| c.cm) })
        };
        let whole = json!({
            "convention": CONVENTION,
            "rows": ["cl", "cm"],
            "modes": plan.modes,
            "matrices": plan.reduced_frequencies.iter().map(|k| matrix(*k)).collect::<Vec<_>>(),
            "columns": self.columns,
        });
        Ok(write_json(&out.join("gaf.json"), &whole)?)
    }
}
