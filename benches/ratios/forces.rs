//! One column of generalised forces three ways: a small motion about a steady flow, a harmonic balance, an implicit march.
use std::path::Path;

use alula::case::Case;
use alula::run::gaf::{Column, gaf};
use alula::run::{Places, Session, Silent};

use super::{parsed, tell};

/// NACA 0012 in a subsonic stream.
const SECTION: &str = "title = \"bench\"\n[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.015625\n";
/// Pitch at one frequency.
const FORCES: &str = "[gaf]\nreduced_frequencies = 0.2\npivot = [0.25, 0.0]\nmodes = \"pitch\"\n";
/// The same as a march.
const MARCH: &str = "[motion]\nparticles = \"rigid\"\npivot = [0.25, 0.0]\nreduced_frequency = 0.2\npitch = \"0.25 deg\"\n\
    [time.dual]\nsteps_per_period = 64\nperiods = 3\n[output]\nreport = false\n";

/// Processor seconds of a balance and of a march of three periods over those of a linear system.
pub(super) fn forces() {
    let linear = column(&parsed(&format!("{SECTION}{FORCES}")));
    let balance = column(&parsed(&format!("{SECTION}{FORCES}pitch = \"0.25 deg\"\n")));
    let mut session = Session::open(&parsed(&format!("{SECTION}{MARCH}")), "").unwrap();
    session.solve(&mut Silent).unwrap();
    let march = session.summary().map_or(0.0, |s| s.cost.cpu_seconds);
    // a column by balance is solved for two amplitudes
    tell(
        "harmonic balance over a column of forces by a linear system",
        0.5 * balance.cpu_seconds / linear.cpu_seconds,
        "",
    );
    tell("march of 3 periods over the same", march / linear.cpu_seconds, "");
    let iterations = linear.solved.map_or(0, |s| s.iterations);
    println!("  a column takes {:.2} s, {iterations} linear iterations", linear.cpu_seconds);
    let apart = |part: usize| (linear.cl[part] - balance.cl[part]).abs();
    println!("  lift of both differs by {:.1e}", apart(0).hypot(apart(1)) / linear.cl[0].hypot(linear.cl[1]));
}

/// The only column of a case.
fn column(case: &Case) -> Column {
    let folder = tempfile::tempdir().unwrap();
    let places = Places { input: Path::new("").into(), out: folder.path().join("forces") };
    let matrices = gaf(case, &places, &mut Silent).unwrap().unwrap();
    matrices.columns.into_iter().next().unwrap()
}
