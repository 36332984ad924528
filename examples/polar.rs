//! Lift of an airfoil against its angle of attack: one cloud, a steady flow for each angle, each begun from the one before.
//!
//! `cargo run --release --example polar`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::error::Error;

use alula::problem::Problem;
use alula::study::{self, PolarPoint};

const CASE: &str = "
[flow]
mach = 0.3
alpha = [\"-2 deg\", \"0 deg\", \"2 deg\", \"4 deg\"]
[[body]]
naca = \"0012\"
[cloud]
spacing = 0.03
far_field = 20
";

/// The points of the polar.
pub(crate) fn run() -> Result<Vec<PolarPoint>, Box<dyn Error>> {
    let problem = Problem::of_case(&alula::case::read(CASE, "polar")?, "")?;
    let points = study::polar(&problem)?;
    for point in &points {
        println!("{}", point.told());
    }
    Ok(points)
}

fn main() -> Result<(), Box<dyn Error>> {
    run().map(drop)
}
