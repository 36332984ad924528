//! Generalised aerodynamic forces in folders.
use std::path::{Path, PathBuf};

use num_complex::Complex64;
use serde_json::json;

use super::folder::{self, Places};
use super::refusals;
use crate::case::{Case, GafMethod};
use crate::geometry::dimension;
use crate::observe::columns::{Scale, describe_tables};
use crate::observe::table::{Entry, write_csv, write_json};
use crate::problem::{Problem, RunError};
use crate::study::Monitor;
pub use crate::study::gaf::{CONVENTION, Column, Conditions, Errors, Matrices, Solved};
use crate::study::gaf::{blank, found, planned};

/// Computes the matrices of the table `[gaf]` into a fresh folder, or one where those of the same case were not all found; `None` when the
/// monitor says stop.
pub fn gaf(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    sought(case, places, monitor).map_err(|problem| refusals::with_other_files(case, &places.input, problem))
}

fn sought(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    let plan = planned(case)?;
    let _held = folder::create_once(case, &places.input, &places.out)?;
    let problem = Problem::of_case(case, &places.input)?;
    let mut matrices = blank(&problem, &plan);
    let scale = Scale { dimensional: case.flow.is_dimensional(), dimension: dimension(case).into() };
    let mut keep = |matrices: &Matrices| matrices.write(&plan.reduced_frequencies, scale, &places.out);
    if !found((&problem, &plan), &mut matrices, &mut keep, monitor)? {
        return Ok(None);
    }
    folder::finish(&places.out)?;
    Ok(Some(matrices))
}

/// Makes room for matrices that can be computed: earlier results in their folder are renamed; the new name, if there were any.
pub fn set_aside(case: &Case, places: &Places) -> Result<Option<PathBuf>, RunError> {
    folder::make_room(&places.out, || rehearse(case, &places.input))
}

/// The same without a folder.
pub fn in_memory(case: &Case, input: &Path, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    let plan = planned(case)?;
    let problem = Problem::of_case(case, input)?;
    let mut matrices = blank(&problem, &plan);
    let whole = found((&problem, &plan), &mut matrices, &mut |_| Ok(()), monitor)?;
    Ok(whole.then_some(matrices))
}

/// Refuses matrices of which it is known before any flow that they cannot be computed.
pub(super) fn rehearse(case: &Case, input: &Path) -> Result<(), RunError> {
    let plan = planned(case)?;
    let problem = Problem::of_case(case, input)?;
    if plan.method == GafMethod::Linear {
        return refusals::rehearse(&problem.about_steady_flow_of_gaf(&plan)?, true);
    }
    // the fastest motion asks most of a cloud
    let fastest = plan.reduced_frequencies.iter().copied().fold(0.0, f64::max);
    let rehearsed = |mode| refusals::rehearse(&problem.in_motion_of_gaf(&plan, mode, fastest, 1.0)?, true);
    plan.all_modes().try_for_each(rehearsed)
}

impl Matrices {
    /// Writes `gaf.csv`, a row for each column of the matrices, and `gaf.json`.
    fn write(&self, frequencies: &[f64], scale: Scale, out: &Path) -> Result<(), RunError> {
        let bounded = self.columns.iter().any(|c| c.errors.is_some());
        let rows = self.columns.iter().map(|c| {
            let mut row = vec![Entry::from(c.k), Entry::from(c.mode.as_str())];
            for [re, im] in [c.cl, c.cm] {
                let value = Complex64::new(re, im);
                row.extend([re, im, value.norm(), value.arg().to_degrees()].map(Entry::from));
            }
            row.extend(c.q.iter().flatten().map(|v| Entry::from(*v)));
            row.extend(c.nonlinearity.map(Entry::from));
            row.extend(c.solved.iter().flat_map(|s| [Entry::from(s.iterations as f64), Entry::from(s.left)]));
            if bounded {
                row.extend(c.bars().into_iter().map(Entry::from));
            }
            row
        });
        let parts = |load: &str| ["re", "im", "abs", "phase_deg"].map(|part| format!("{load}_{part}"));
        let mut names: Vec<String> = ["k".into(), "mode".into()].into();
        names.extend(["cl", "cm"].iter().flat_map(|load| parts(load)));
        names.extend(self.modes.iter().flat_map(|m| [format!("q_{m}_re"), format!("q_{m}_im")]));
        let linear = self.columns.iter().any(|c| c.solved.is_some());
        let last: &[&str] = if linear { &["iterations", "left"] } else { &["nonlinearity"] };
        names.extend(last.iter().map(|name| (*name).to_owned()));
        if bounded {
            names.extend(["cl_error".to_owned(), "cm_error".to_owned()]);
            names.extend(self.modes.iter().map(|m| format!("q_{m}_error")));
        }
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        write_csv(&out.join(super::folder::MATRICES), &names, rows)?;
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
