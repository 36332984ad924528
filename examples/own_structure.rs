//! Flutter of a structure of one's own: mass, damping and stiffness matrices, with the forces of the gas about a steady flow.
//!
//! The coordinates that the forces act on are those of the case; the matrices may come from anywhere, here from a loop over the position of the
//! centre of gravity. The flow is solved once.
//!
//! `cargo run --release --example own_structure`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::error::Error;

use alula::problem::Problem;
use alula::structure::flutter::Kind;
use alula::study;

/// A section that plunges and pitches about its quarter chord; numbers of its structure serve the equilibrium alone.
const CASE: &str = "
[flow]
mach = 0.5
[[body]]
naca = \"0012\"
[cloud]
spacing = 0.05
far_field = 15
[structure]
elastic_axis = -0.5
mass_ratio = 100
x_alpha = 0.2
r_alpha2 = 0.25
frequency_ratio = 0.4
reduced_speed = 4.0
[flutter]
";

/// Static unbalance over the half chord with the speed of flutter over that of the stream.
pub(crate) fn run() -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
    let problem = Problem::of_case(&alula::case::read(CASE, "own structure")?, "")?;
    let forces = study::forces(&study::steady(&problem)?, &[0.0, 0.05, 0.1, 0.2, 0.4])?;
    let mut found = Vec::new();
    for x_alpha in [0.1, 0.2, 0.3] {
        let mut structure = forces.structure.clone();
        // plunge and pitch are coupled by the static moment, which goes with the unbalance
        let moment = structure.mass[1] * x_alpha / 0.2;
        (structure.mass[1], structure.mass[2]) = (moment, moment);
        let crossings = forces.crossings(&structure, 5.0);
        let flutter = crossings.iter().find(|c| c.kind == Kind::Flutter).ok_or("no flutter")?;
        println!(
            "x_alpha {x_alpha}: flutter at {:.3} of the speed, k = {:.3}",
            flutter.speed,
            forces.reduced_frequency(flutter)
        );
        found.push((x_alpha, flutter.speed));
    }
    Ok(found)
}

fn main() -> Result<(), Box<dyn Error>> {
    run().map(drop)
}
