//! `alula gaf`.
use std::path::{Path, PathBuf};

use alula::run::gaf::{Column, Matrices};
use alula::run::{self, Places};
use serde_json::{Value, json};

use super::run::{Shortfall, results};
use crate::arguments;
use crate::outcome::Outcome;
use crate::output;
use crate::watch::Watch;

/// Computes generalised aerodynamic forces.
pub(crate) fn gaf(args: &arguments::Gaf) -> Outcome {
    let case = match super::load(&args.case) {
        Ok(case) => case,
        Err(outcome) => return outcome,
    };
    let name = args.case.file_stem().map_or_else(|| "gaf".to_owned(), |n| n.to_string_lossy().into_owned());
    let out = args.out.clone().unwrap_or_else(|| super::default_folder(&format!("{name}-gaf"), args.force));
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let places = Places { input, out: out.clone() };
    if args.force
        && let Err(outcome) = super::tell_kept(run::gaf::set_aside(&case, &places), &out, args.verbosity.quiet)
    {
        return outcome;
    }
    let folder = out.clone();
    let mut watch = Watch::new(args.verbosity).with_farewell(move || interrupted(&folder));
    let found = run::gaf::gaf(&case, &places, &mut watch);
    watch.progress().finish();
    let matrices = match found {
        Ok(Some(matrices)) => matrices,
        Ok(None) => {
            interrupted(&out);
            return Outcome::Interrupted;
        }
        Err(problem) => return super::refuse(&problem),
    };
    let found = match args.verbosity.json {
        true => output::event_line("gaf", event(&matrices, &out)) + "\n",
        false => table(&matrices) + &format!("matrices: {}\n", out.join("gaf.csv").display()),
    };
    results(&found, shortfall(&matrices), args.verbosity)
}

/// Says what is kept in the folder `out` of matrices that were not all found.
fn interrupted(out: &Path) {
    let kept = out.join("gaf.csv");
    let what = match kept.exists() {
        true => format!("interrupted; the columns found so far are in `{}`", kept.display()),
        false => "interrupted before the first column was found".to_owned(),
    };
    let again = format!("begin it again with the same case, in the same folder with `--out {}`", out.display());
    output::note(&format!("{what}: `alula gaf` is not resumed; {again}"));
}

/// All columns, for programs.
fn event(matrices: &Matrices, out: &Path) -> Value {
    let (modes, linearity) = (&matrices.modes, matrices.linearity);
    json!({ "run": out, "modes": modes, "linearity": linearity, "columns": matrices.columns })
}

/// The first column that is nonlinear, or else not converged.
fn shortfall(matrices: &Matrices) -> Option<Shortfall> {
    let nonlinear = |c: &&Column| c.nonlinearity.is_some_and(|change| change > matrices.linearity);
    if let Some(c) = matrices.columns.iter().find(nonlinear) {
        let change = 100.0 * c.nonlinearity.unwrap_or_default();
        return Some(Shortfall {
            what: format!("k = {}, {}: halving the amplitude changes the forces by {change:.2} %", c.k, c.mode),
            hint: "lower `gaf.pitch` or `gaf.plunge`".into(),
        });
    }
    matrices.columns.iter().find(|c| !c.converged).map(|c| Shortfall {
        what: format!("k = {}, {}: not converged", c.k, c.mode),
        hint: match c.solved {
            Some(_) => "refine the cloud where the steady flow has shocks or separates".into(),
            None => "lower the frequency or the amplitude, or refine the cloud".into(),
        },
    })
}

/// Columns and square matrices, for people.
fn table(matrices: &Matrices) -> String {
    let linear = matrices.columns.iter().any(|c| c.solved.is_some());
    let last = if linear { "iterations, residual" } else { "halved amplitude changes" };
    let mut text =
        format!("       k  mode              Cl                  error           Cm                  error  {last}\n");
    for c in &matrices.columns {
        let how = match (c.solved, c.nonlinearity) {
            (Some(solved), _) => format!("{:>7}  {:.0e}", solved.iterations, solved.left),
            (None, change) => format!("{:>7.2} %", 100.0 * change.unwrap_or_default()),
        };
        let (cl, cm) =
            (entry(c.cl, c.errors.as_ref().map(|e| e.cl_error)), entry(c.cm, c.errors.as_ref().map(|e| e.cm_error)));
        text.push_str(&format!("{:>8}  {:<8}{cl}{cm}  {how}\n", c.k, c.mode));
    }
    text + &squares(matrices)
}

/// A complex number with its error bar, 31 characters wide.
fn entry([re, im]: [f64; 2], error: Option<f64>) -> String {
    let error = error.map_or_else(|| "-".to_owned(), |e| format!("±{e:.4}"));
    format!("{re:>10.4} {im:>+9.4}i {error:>9}")
}

/// The square matrix of generalised forces at each frequency.
fn squares(matrices: &Matrices) -> String {
    let mut text = String::new();
    for columns in matrices.columns.chunks(matrices.modes.len()) {
        let Some(first) = columns.first() else { continue };
        text.push_str(&format!("\ngeneralised forces at k = {}, on (rows) and by (columns)\n{:<12}", first.k, ""));
        columns.iter().for_each(|c| text.push_str(&format!("{:>31}", c.mode)));
        text.push('\n');
        for (i, row) in matrices.modes.iter().enumerate() {
            text.push_str(&format!("{row:<12}"));
            let error = |c: &Column| c.errors.as_ref().map(|e| e.q_error[i]);
            columns.iter().for_each(|c| text.push_str(&entry(c.q[i], error(c))));
            text.push('\n');
        }
    }
    text
}
