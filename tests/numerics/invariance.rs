//! What must not change anything: uniform flow on any cloud, the number of threads.

use std::sync::Arc;

use crate::common::{Uniform, largest, round_body, solver, two_levels, vortex, with_threads};
use alula::math::Vector;
use alula::physics::Primitive;
use alula::scheme::Fluid;
use alula::system::{Instant, System};
use alula::time::control::Control;
use alula::time::explicit::{Explicit, Method, Plan};
use alula::time::relax::Relax;
use alula::time::{Integrator, Past};

/// Round-off of fluxes of order one over a spacing of some hundredths.
const ROUND_OFF: f64 = 1e-12;

fn uniform_residual<const D: usize>() -> f64 {
    let (fluid, u) = solver::<D>(&two_levels(D));
    let (mut work, mut du) = (fluid.work(), vec![0.0; u.len()]);
    fluid.rhs(&fluid.frame(&Instant::still(0.0), &u), &u, &mut work, &mut du);
    largest(du)
}

#[test] // eq1, eq2, eq3, eq16
fn uniform_flow_stays_uniform_on_a_random_cloud_with_two_levels() {
    let (plane, solid) = (uniform_residual::<2>(), uniform_residual::<3>());
    assert!(plane <= ROUND_OFF && solid <= ROUND_OFF, "2-D {plane:.2e}, 3-D {solid:.2e}");
}

/// Residual of gas at rest around a body: the only uniform flow that a wall allows.
fn rest_residual<const D: usize>() -> f64 {
    let (fluid, mut u) = solver::<D>(&round_body(D));
    let rest = Primitive { density: 1.0, velocity: Vector::ZERO, pressure: 1.0 / fluid.gas.gamma };
    u.chunks_exact_mut(D + 2).for_each(|row| fluid.gas.conserved(&rest).store(row));
    let fluid = Fluid { far_field: Arc::new(Uniform(rest)), ..fluid };
    let frame = fluid.frame(&Instant::still(0.0), &u);
    let (mut work, mut du) = (fluid.work(), vec![0.0; u.len()]);
    fluid.rhs(&frame, &u, &mut work, &mut du);
    largest(du)
}

#[test] // eq12
fn gas_at_rest_stays_at_rest_around_a_circle_and_a_sphere() {
    let (circle, sphere) = (rest_residual::<2>(), rest_residual::<3>());
    assert!(circle <= ROUND_OFF && sphere <= ROUND_OFF, "circle {circle:.2e}, sphere {sphere:.2e}");
}

fn bits(u: &[f64]) -> Vec<u64> {
    u.iter().map(|v| v.to_bits()).collect()
}

/// State after `steps` explicit steps of the vortex.
fn marched(steps: usize) -> Vec<u64> {
    let (fluid, u) = solver::<2>(&vortex(0.15625, 5.0));
    let mut march = Explicit::new(&fluid, Plan { method: Method::Ssprk3, cfl: 0.5, until: 5.0 }, Past::default(), u);
    for _ in 0..steps {
        march.advance().unwrap();
    }
    bits(march.standing().state)
}

#[test]
fn one_and_two_threads_march_to_the_same_bits() {
    let one = with_threads(1, || marched(6));
    assert!(one == with_threads(2, || marched(6)), "the state depends on the number of threads");
}

/// State after `steps` implicit steps around a body, with Newton's method from the first step on.
fn relaxed<const D: usize>(steps: usize) -> Vec<u64> {
    let (fluid, u) = solver::<D>(&round_body(D));
    let control = Control { cfl: 5.0, ..Control::newton(D) };
    let origin = u.clone();
    let mut relax = Relax::new(&fluid, control, u, &origin, None);
    let mut resume = relax.resume();
    resume.phase.newton = true;
    let (state, mut newton) = (relax.u.clone(), 0);
    relax = Relax::new(&fluid, control, state, &origin, Some(resume));
    for _ in 0..steps {
        newton = relax.advance().unwrap().linear;
    }
    assert!(newton as usize > steps, "GMRES did not iterate");
    bits(&relax.u)
}

#[test]
fn one_and_two_threads_relax_to_the_same_bits() {
    let one = with_threads(1, || (relaxed::<2>(6), relaxed::<3>(3)));
    let two = with_threads(2, || (relaxed::<2>(6), relaxed::<3>(3)));
    assert!(one == two, "the state depends on the number of threads");
}
