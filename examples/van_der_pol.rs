//! Harmonic balance of an oscillator with the integrator that serves the gas, and a march of the same system.
//!
//! Van der Pol's oscillator follows a force whose frequency ω is near its own: x'' = μ(1 − x²)x' − x + F cos ωt has a periodic
//! solution, found as instances of one period that are relaxed together.
//!
//! `cargo run --example van_der_pol`
#![allow(clippy::print_stdout, reason = "an example prints")]
use std::f64::consts::TAU;

use alula::math::fourier::{Instances, Series};
use alula::time::control::Control;
use alula::time::explicit::{Explicit, Method, Plan};
use alula::time::harmonic::HarmonicBalance;
use alula::time::ordinary::Ordinary;
use alula::time::relax::Relax;
use alula::time::{Integrator, Past, TimeError};

/// x at the beginning of a period, by harmonic balance and by a march of many periods.
pub(crate) fn run() -> Result<[f64; 2], TimeError> {
    let (mu, force, omega) = (0.5, 1.0, 1.1);
    let system = Ordinary::new(2, 2.0, move |t, u, du| {
        let [x, v] = [u[0], u[1]];
        (du[0], du[1]) = (v, mu * (1.0 - x * x) * v - x + force * (omega * t).cos());
    });
    let balance = HarmonicBalance::new(&system, Instances::of_harmonics(12), omega, 1.0);
    let u = balance.copies(&[2.0, 0.0]);
    let mut relax = Relax::new(&balance, Control::newton(2), u.clone(), &u, None);
    while relax.drop() > 1e-12 {
        relax.advance()?;
    }
    let x: Vec<f64> = relax.u.chunks_exact(2).map(|u| u[0]).collect();
    println!("harmonic balance: x = {:.9} after {} iterations", x[0], relax.iteration);
    let amplitude = Series::of_values(&x).map_or(0.0, |s| s.coefficients()[1].hypot(s.coefficients()[13]));
    println!("first harmonic: {amplitude:.9}");
    let end = 40.0 * TAU / omega;
    let mut march =
        Explicit::new(&system, Plan { method: Method::Rk4, cfl: 0.04, until: end }, Past::default(), vec![2.0, 0.0]);
    while !march.finished() {
        march.advance()?;
    }
    println!("march:            x = {:.9} after 40 periods", march.standing().state[0]);
    Ok([x[0], march.standing().state[0]])
}

fn main() -> Result<(), TimeError> {
    run().map(drop)
}
