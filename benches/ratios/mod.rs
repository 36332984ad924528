//! Ratios of times within one run, and bytes: what does a step cost in units of one residual of the same case?
//!
//!     cargo bench -p alula -- ratios
//!     cargo bench -p alula -- ratios::dual
//!
//! Both sides of a ratio are timed in turns on one thread and the smallest times are divided, so that a busy machine disturbs
//! little.
#![allow(clippy::print_stdout, reason = "a benchmark prints")]
mod balance;
mod coupled;
mod forces;
mod march;
mod solids;
mod travel;

use std::path::Path;
use std::time;

use alula::case::{Case, read};
use alula::motion::Motions;
use alula::scheme::Fluid;
use alula::system::{Instant, System};

/// Times each side is measured.
const TURNS: usize = 7;

/// Runs those whose names hold one of `filters`, all when there are none.
pub(crate) fn run(filters: &[String]) {
    let all: [(&str, fn()); 9] = [
        ("ratios::dual_step", march::dual_step),
        ("ratios::coupled_step", coupled::coupled_step),
        ("ratios::solid_setup", solids::solid_setup),
        ("ratios::solid_in_gas", solids::solid_in_gas),
        ("ratios::travelling", travel::travelling),
        ("ratios::deforming", travel::deforming),
        ("ratios::balance", balance::balance),
        ("ratios::forces", forces::forces),
        ("ratios::threads", balance::threads),
    ];
    let wanted = |name: &str| filters.is_empty() || filters.iter().any(|f| name.contains(f.as_str()));
    for (name, measure) in all.into_iter().filter(|(name, _)| wanted(name)) {
        println!("{name}");
        super::pool(1).install(measure);
    }
}

/// Prints one ratio and the bar it is held against.
fn tell(what: &str, ratio: f64, bar: &str) {
    println!("  {what:<66} {ratio:>8.2}  {bar}");
}

/// Smallest time of one call of `f`, in seconds.
fn seconds(mut f: impl FnMut()) -> f64 {
    (0..TURNS).map(|_| once(&mut f)).fold(f64::INFINITY, f64::min)
}

/// Time of one call of `f`, in seconds.
fn once(f: impl FnOnce()) -> f64 {
    let clock = time::Instant::now();
    f();
    clock.elapsed().as_secs_f64()
}

/// Smallest time of one residual at the start of a march.
fn residual<const D: usize>(fluid: &Fluid<D>, moment: &Instant<'_>, u: &[f64]) -> f64 {
    let (frame, mut work, mut du) = (fluid.frame(moment, u), fluid.work(), vec![0.0; u.len()]);
    seconds(|| fluid.rhs(&frame, u, &mut work, &mut du))
}

/// The case `text`, whose files lie in `folder`.
fn parsed(text: &str) -> Case {
    read(text, "bench.toml").unwrap_or_else(|e| panic!("{e}"))
}

/// Equations and start of a case, and the period of its motion where it has one.
fn built(case: &Case, folder: &Path) -> (Fluid<2>, Vec<f64>, f64) {
    let (fluid, u) = alula::run::build_solver::<2>(case, folder).unwrap();
    let motions = Motions::<2>::of_case(case, 1.0, &|_| unreachable!("no files of motion")).unwrap();
    (fluid, u, motions.period().unwrap_or_default())
}
