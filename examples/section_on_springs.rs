//! A section on springs in a stream: where lift and springs are in balance, gas and section solved for as one system.
//!
//! `cargo run --release --example section_on_springs`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::error::Error;
use std::path::Path;

use alula::case::{Body, Scheme};
use alula::cloud::{Cloud, CloudSpec};
use alula::coupling::{Attached, Coupled, body_motion};
use alula::geometry::load_surface;
use alula::scheme::start::FreeStream;
use alula::scheme::{CloudMotion, Fluid, HasGas};
use alula::structure::{Coordinate, InertiaLaw, Model, PlanarBody, Spring, Structure};
use alula::system::{Name, System};
use alula::time::Integrator;
use alula::time::control::Control;
use alula::time::relax::Relax;

/// Stiffness of the spring of the plunge over ρc².
const STIFFNESS: f64 = 0.4;

/// Force of the spring and lift of the gas in equilibrium, both upward.
pub(crate) fn run() -> Result<[f64; 2], Box<dyn Error>> {
    let (surface, _) = load_surface::<2>(&[Body::naca("0012")], Path::new(""))?;
    let spec = CloudSpec { far_field: Some(10.0), edge_levels: 1, ..CloudSpec::new(0.04) };
    let cloud = Cloud::build(&spec, Some(&surface), &[])?;
    let spring =
        |name: &str, k: f64| Coordinate { name: name.into(), spring: Spring::linear(k), ..Coordinate::default() };
    let (pivot, static_moment, gravity, law) = ([0.4, 0.0], [0.0; 2], [0.0; 2], InertiaLaw::Exact);
    let body = PlanarBody { pivot, mass: 10.0, static_moment, inertia: 1.0, flap: None, gravity, law };
    let structure = Structure::new(Model::Planar(body), vec![spring("plunge", STIFFNESS), spring("pitch", 0.1)])?;
    let stream = FreeStream { alpha: 0.03, ..FreeStream::new(0.3) };
    let cloud_motion = CloudMotion::deforming(&cloud, vec![body_motion(&structure, 0, &[])], 0.0);
    let fluid = Fluid { cloud_motion, ..Fluid::new(cloud, &stream, &Scheme::default()) };
    let system = Coupled::new(fluid, vec![Attached::new(structure, 0, 1.0, 0, Vec::new())]);
    let u = system.start();
    let mut relax = Relax::new(&system, Control::newton(2), u.clone(), &u, None);
    while relax.drop() > 1e-6 {
        relax.advance()?;
    }
    let at = relax.standing();
    let [plunge, _, pitch, _] = at.state[system.unknowns_of(Name::Structure)] else {
        return Err("two coordinates with their rates".into());
    };
    let lift = system.gas().pressure_force(system.gas_frame(at.frame), system.gas_work(at.work))[1];
    println!(
        "plunge {plunge:.5}, pitch {:.3} degrees: spring {:.6}, lift {lift:.6}",
        pitch.to_degrees(),
        STIFFNESS * plunge
    );
    Ok([STIFFNESS * plunge, lift])
}

fn main() -> Result<(), Box<dyn Error>> {
    run().map(drop)
}
