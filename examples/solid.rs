//! Natural frequencies of a clamped bar made of particles.
//!
//! `cargo run --release --example solid`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::error::Error;

use alula::problem::Problem;
use alula::study::{self, SolidSolution};

const CASE: &str = "
[[body]]
name = \"bar\"
box = { size = [0.5, 0.05] }
[body.solid]
spacing = 0.0125
material = { density = 1000, young = 1e7, poisson = 0.0 }
support = { where = { x_max = -0.2499 } }
[time.modes]
number = 2
";

/// The modes.
pub(crate) fn run() -> Result<SolidSolution, Box<dyn Error>> {
    let problem = Problem::of_case(&alula::case::read(CASE, "bar")?, "")?;
    let solution = study::solid(&problem)?;
    for mode in &solution.summary.modes {
        println!("{:.3} Hz", mode.frequency);
    }
    Ok(solution)
}

fn main() -> Result<(), Box<dyn Error>> {
    run().map(drop)
}
