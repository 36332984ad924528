//! The steady flow around an airfoil: loads, how far the residual fell, and how the loads converge as the cloud becomes finer.
//!
//! `cargo run --release --example steady`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::error::Error;

use alula::problem::Problem;
use alula::study::{self, SteadyFlow};

const CASE: &str = "
[flow]
mach = 0.5
alpha = \"2 deg\"
[[body]]
naca = \"0012\"
[accuracy]
particles = 4000
";

/// The flow.
pub(crate) fn run() -> Result<SteadyFlow<'static>, Box<dyn Error>> {
    let problem = Problem::of_case(&alula::case::read(CASE, "steady")?, "")?;
    let flow = study::steady(&problem)?;
    let (loads, convergence) = (flow.loads(), flow.convergence());
    println!("CL {:.4}, CD {:.4}, CM {:.4}", loads.cl, loads.cd, loads.cm);
    println!("{} iterations, converged: {}", convergence.iterations, convergence.converged);
    if let Some(family) = flow.grid_convergence() {
        println!("CL ± {:.4} on {} clouds", family.half_widths().cl, family.clouds.len());
    }
    Ok(flow)
}

fn main() -> Result<(), Box<dyn Error>> {
    run().map(drop)
}
