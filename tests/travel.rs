//! Particles that travel with the fluid.
#![allow(clippy::unwrap_used, reason = "a test may stop anywhere")]

mod common;

use alula::exact::vortex::IsentropicVortex;
use alula::math::Vector;
use alula::physics::Conserved;
use alula::scheme::{Fluid, Turnover};
use alula::time::explicit::{Explicit, Method};
use alula::time::{March, Past};
use common::{largest, solver, vortex};

/// The same case with particles that travel.
fn lagrangian(case: &str) -> String {
    format!("{case}\n[motion]\nparticles = \"lagrangian\"\n")
}

/// Where a march of travelling particles ended.
struct End<const D: usize> {
    fluid: Fluid<D>,
    u: Vec<f64>,
    past: Past,
    turnover: Turnover,
}

/// Marches, building the cloud anew when it is worn, until the time or the number of steps is reached.
fn march<const D: usize>((fluid, u): (Fluid<D>, Vec<f64>), (cfl, until, steps): (f64, f64, u32)) -> End<D> {
    let mut end = End { fluid, u, past: Past::default(), turnover: Turnover::default() };
    loop {
        let begin = (end.past.clone(), end.u.clone());
        let mut leg = Explicit::new(&end.fluid, Method::Ssprk3, (cfl, until), begin);
        let mut worn = false;
        while !leg.finished() && leg.past().iteration < steps && !worn {
            leg.advance().unwrap();
            worn = end.fluid.is_worn(leg.parts().0);
        }
        let past = leg.past().clone();
        let (frame, work, u) = leg.parts();
        let renewed = end.fluid.renewed(frame, u, work, &mut end.turnover).unwrap().unwrap();
        (end.fluid, end.u, end.past) = (renewed.fluid, renewed.u, past);
        if end.past.time >= until || end.past.iteration >= steps {
            return end;
        }
    }
}

/// Volume-weighted error of the density at time `until`, as a root mean square.
fn vortex_error(spacing: f64, until: f64) -> f64 {
    let start = std::time::Instant::now();
    let end = march(solver::<2>(&lagrangian(&vortex(spacing, until))), (0.5, until, u32::MAX));
    let exact = IsentropicVortex::new(5.0, Vector([5.0, 5.0]), Vector([1.0, 1.0]), 1.4).unwrap();
    let exact = exact.periodic(Vector([10.0, 10.0]));
    let cloud = &end.fluid.shape.cloud;
    let square = |i: usize| {
        let found = end.fluid.gas.primitive(&Conserved::<2>::load(&end.u[4 * i..])).density;
        cloud.volume[i] * (found - exact.state(&cloud.x[i], until).density).powi(2)
    };
    let volume: f64 = cloud.volume[..cloud.n_fluid].iter().sum();
    let error = ((0..cloud.n_fluid).map(square).sum::<f64>() / volume).sqrt();
    println!("{spacing} {error:.4e} n {} volume {volume} steps {} {:?} {:?}", cloud.n_fluid, end.past.iteration, end.turnover, start.elapsed());
    error
}

#[test] // Shu (1998), isentropic vortex
fn the_isentropic_vortex_converges_at_second_order_on_travelling_particles() {
    let errors = [0.3125, 0.15625, 0.078125].map(|h| vortex_error(h, 1.0));
    let order = (errors[1] / errors[2]).log2();
    assert!(order >= 1.9, "order {order:.3}, errors {errors:?}");
}

#[test]
fn uniform_flow_stays_uniform_on_travelling_particles() {
    let case = "title = \"box\"\ndimension = 2\n[flow]\nmach = 0.6\nalpha = \"7 deg\"\n[cloud]\nspacing = 0.125\n\
         jitter = 0.2\n[cloud.domain]\nmin = [0.0, 0.0]\nmax = [2.0, 1.0]\n[[cloud.box]]\nmin = [0.5, 0.0]\nmax = [1.0, 1.0]\n\
         spacing = 0.0625\n[scheme]\nconservative = false\n[time.explicit]\nuntil = 1.0\n";
    let (fluid, u) = solver::<2>(&lagrangian(case));
    let state: Vec<f64> = u[..4].to_vec();
    let end = march((fluid, u), (0.5, 1e9, 100));
    let worst = largest(end.u.chunks(4).flat_map(|r| (0..4).map(|k| r[k] - state[k]).collect::<Vec<_>>()));
    println!("{worst:e} {} {:?} t {}", end.fluid.shape.cloud.n_fluid, end.turnover, end.past.time);
    assert!(worst < 1e-12);
}
