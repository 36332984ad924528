//! The flutter boundary of a section on two springs.
//!
//! `cargo run --release --example flutter`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::error::Error;

use alula::problem::Problem;
use alula::record::flutter::Boundary;
use alula::study;

const CASE: &str = "
[flow]
mach = 0.6
[[body]]
naca = \"0012\"
[cloud]
spacing = 0.05
far_field = 15
[structure]
elastic_axis = -0.5
mass_ratio = 100
x_alpha = 0.25
r_alpha2 = 0.25
frequency_ratio = 0.2
reduced_speed = 4.0
[flutter]
cloud_error = false
reduced_frequencies = [0.05, 0.1, 0.2]
";

/// The boundary.
pub(crate) fn run() -> Result<Boundary, Box<dyn Error>> {
    let problem = Problem::of_case(&alula::case::read(CASE, "flutter")?, "")?;
    let boundary = study::flutter(&problem)?;
    for at in &boundary.flutter {
        for crossing in &at.crossings {
            let (kind, speed, k) =
                (&crossing.kind, crossing.reduced_speed.unwrap_or(f64::NAN), crossing.reduced_frequency);
            println!("Mach {}: {kind} at V/(b omega) = {speed:.3}, k = {k:.3}", at.mach);
        }
    }
    Ok(boundary)
}

fn main() -> Result<(), Box<dyn Error>> {
    run().map(drop)
}
