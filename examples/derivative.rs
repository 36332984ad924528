//! A derivative on a cloud of particles without any order: ∇f by least squares, its error on finer and finer clouds.
//!
//! `cargo run --example derivative`
#![allow(clippy::print_stdout, reason = "an example prints")]
use alula::cloud::{Cloud, CloudError, CloudSpec, Operators};
use alula::math::{Bounds, Vector};

/// Root mean square errors of ∇ sin(3x)cos(2y) on shaken clouds in the unit square, each of half the spacing of the one before.
pub(crate) fn run() -> Result<Vec<f64>, CloudError> {
    let square = Bounds { min: Vector([0.0, 0.0]), max: Vector([1.0, 1.0]) };
    let f = |x: &Vector<2>| (3.0 * x[0]).sin() * (2.0 * x[1]).cos();
    let slope = |x: &Vector<2>| {
        Vector([3.0 * (3.0 * x[0]).cos() * (2.0 * x[1]).cos(), -2.0 * (3.0 * x[0]).sin() * (2.0 * x[1]).sin()])
    };
    let mut errors = Vec::new();
    for spacing in [0.0625, 0.03125, 0.015625] {
        let spec = CloudSpec { domain: Some(square), jitter: 0.3, ..CloudSpec::new(spacing) };
        let cloud = Cloud::build(&spec, None, &[])?;
        let values: Vec<f64> = cloud.x.iter().map(f).collect();
        let found = Operators::new(&cloud).gradient(&cloud, &values);
        let squares = found.iter().zip(&cloud.x).map(|(g, x)| (*g - slope(x)).norm_squared());
        let error = (squares.sum::<f64>() / found.len() as f64).sqrt();
        println!("{:6} particles {spacing} apart: error {error:.2e}", cloud.n_fluid);
        errors.push(error);
    }
    Ok(errors)
}

fn main() -> Result<(), CloudError> {
    run().map(drop)
}
