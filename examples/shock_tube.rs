//! Sod's shock tube on a cloud of particles, against the exact solution.
//!
//! `cargo run --example shock_tube`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::error::Error;
use std::sync::Arc;

use alula::case::{Scheme, Side};
use alula::cloud::{Cloud, CloudSpec};
use alula::exact::riemann::{RiemannProblem, State};
use alula::math::{Bounds, Vector};
use alula::physics::{Conserved, Primitive};
use alula::scheme::Fluid;
use alula::scheme::start::FreeStream;
use alula::time::explicit::{Explicit, Method, Plan};
use alula::time::{Integrator, Past};

/// Mean error of the density at time 0.2.
pub(crate) fn run() -> Result<f64, Box<dyn Error>> {
    let exact = RiemannProblem::new(State::new(1.0, 0.0, 1.0), State::new(0.125, 0.0, 0.1), 1.4)?;
    let at = move |x: &Vector<2>, t: f64| exact.state(x[0], t, 0.5);
    let tube = Bounds { min: Vector([0.0, 0.0]), max: Vector([1.0, 0.08]) };
    let sides = [[Side::Held; 2], [Side::Periodic; 2]];
    let cloud = Cloud::build(&CloudSpec { domain: Some(tube), sides, ..CloudSpec::new(0.01) }, None, &[])?;
    let held = Arc::new(move |x: &Vector<2>| {
        let s = at(x, 0.0);
        Primitive { density: s.density, velocity: Vector([s.velocity, 0.0]), pressure: s.pressure }
    });
    let fluid = Fluid { held, ..Fluid::new(cloud, &FreeStream::new(0.0), &Scheme::default()) };
    let mut march =
        Explicit::new(&fluid, Plan { method: Method::Ssprk3, cfl: 0.8, until: 0.2 }, Past::default(), fluid.start());
    while !march.finished() {
        march.advance()?;
    }
    let rows = march.standing().state.chunks_exact(4).zip(&fluid.discretisation.cloud.x);
    let errors = rows.map(|(row, x)| (Conserved::<2>::load(row).density - at(x, 0.2).density).abs());
    let error = errors.sum::<f64>() / fluid.discretisation.cloud.n_fluid as f64;
    println!("{} particles, mean error of the density {error:.4}", fluid.discretisation.cloud.n_fluid);
    Ok(error)
}

fn main() -> Result<(), Box<dyn Error>> {
    run().map(drop)
}
