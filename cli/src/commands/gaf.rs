//! `alula gaf`.
use std::path::{Path, PathBuf};

use alula::run::{self, Places};

use crate::arguments;
use crate::interrupt::Interrupt;
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
    let out = args.out.clone().unwrap_or_else(|| run::fresh_folder(Path::new("runs"), &format!("{name}-gaf")));
    let input = args.case.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let mut watch = Watch::new(args.verbosity);
    let found = run::gaf::gaf(&case, &Places { input, out: out.clone() }, &mut watch);
    watch.progress().finish();
    let matrices = match found {
        Ok(Some(matrices)) => matrices,
        Ok(None) => {
            output::message(&format!("{}\n", Interrupt::farewell(&out, 0)));
            return Outcome::Interrupted;
        }
        Err(problem) => return super::refuse(&problem),
    };
    let mut text =
        String::from("       k  mode              Cl                    Cm          halved amplitude changes\n");
    for c in &matrices.columns {
        text.push_str(&format!(
            "{:>8}  {:<8} {:>9.4} {:>+9.4}i  {:>9.4} {:>+9.4}i  {:>7.2} %\n",
            c.k,
            c.mode,
            c.cl[0],
            c.cl[1],
            c.cm[0],
            c.cm[1],
            100.0 * c.nonlinearity
        ));
    }
    text.push_str(&squares(&matrices));
    text.push_str(&format!("matrices: {}\n", out.join("gaf.csv").display()));
    let told = output::data(&text);
    let bad = |c: &&run::gaf::Column| c.nonlinearity > matrices.linearity;
    if let Some(c) = matrices.columns.iter().find(bad) {
        let what = format!(
            "k = {}, {}: halving the amplitude changes the forces by {:.2} %",
            c.k,
            c.mode,
            100.0 * c.nonlinearity
        );
        output::error(&what, "lower `gaf.pitch` or `gaf.plunge`");
        return Outcome::Failed;
    }
    if let Some(c) = matrices.columns.iter().find(|c| !c.converged) {
        output::error(&format!("k = {}, {}: not converged", c.k, c.mode), "look at its folder");
        return Outcome::Failed;
    }
    told
}

/// The square matrix of generalised forces at each frequency.
fn squares(matrices: &run::gaf::Matrices) -> String {
    let mut text = String::new();
    for columns in matrices.columns.chunks(matrices.modes.len()) {
        let Some(first) = columns.first() else { continue };
        text.push_str(&format!("\ngeneralised forces at k = {}, on (rows) and by (columns)\n{:<12}", first.k, ""));
        columns.iter().for_each(|c| text.push_str(&format!("{:>20}", c.mode)));
        text.push('\n');
        for (i, row) in matrices.modes.iter().enumerate() {
            text.push_str(&format!("{row:<12}"));
            columns.iter().for_each(|c| text.push_str(&format!("{:>10.4}{:>+9.4}i", c.q[i][0], c.q[i][1])));
            text.push('\n');
        }
    }
    text
}
