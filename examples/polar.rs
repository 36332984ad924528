//! Lift of an airfoil against its angle of attack: one cloud, a steady flow for each angle.
//!
//! `cargo run --release --example polar`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use alula::case::{Body, Scheme};
use alula::cloud::{Cloud, CloudSpec};
use alula::geometry::load_surface;
use alula::math::Vector;
use alula::scheme::Fluid;
use alula::scheme::start::{FreeStream, Stream};
use alula::time::Integrator;
use alula::time::control::Control;
use alula::time::relax::Relax;

/// Angles of attack in degrees with the lift coefficients of a NACA 0012 at Mach 0.3.
pub(crate) fn run() -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
    let (surface, _) = load_surface::<2>(&[Body::naca("0012")], Path::new(""))?;
    let spec = CloudSpec { far_field: Some(20.0), edge_levels: 1, ..CloudSpec::new(0.03) };
    let cloud = Cloud::build(&spec, Some(&surface), &[])?;
    let mut polar = Vec::new();
    for degrees in [-2.0, 0.0, 2.0, 4.0] {
        let stream = FreeStream { alpha: f64::to_radians(degrees), ..FreeStream::new(0.3) };
        let far_field = Arc::new(Stream::new(&stream, &Vector([0.25, 0.0]), true));
        let fluid = Fluid { far_field, ..Fluid::new(cloud.clone(), &stream, &Scheme::default()) };
        let u = fluid.start();
        let mut relax = Relax::new(&fluid, Control::newton(2), u.clone(), &u, None);
        while relax.drop() > 1e-4 {
            relax.advance()?;
        }
        let at = relax.standing();
        let lift = fluid.pressure_force(at.frame, at.work).dot(&stream.axes().1) / (0.5 * 0.3 * 0.3);
        println!("{degrees:5.1} degrees: CL {lift:7.4}");
        polar.push((degrees, lift));
    }
    Ok(polar)
}

fn main() -> Result<(), Box<dyn Error>> {
    run().map(drop)
}
