//! Observed order on an exact solution.

use crate::common::{solver, vortex};
use alula::exact::vortex::IsentropicVortex;
use alula::math::Vector;
use alula::physics::Conserved;
use alula::time::explicit::{Explicit, Method, Plan};
use alula::time::{Integrator, Past};

/// Volume-weighted error of the density at time `until`, as a root mean square.
fn vortex_error(spacing: f64, until: f64, low_mach: bool) -> f64 {
    let text = vortex(spacing, until).replace("[time", &format!("low_mach = {low_mach}\n[time"));
    let (fluid, u) = solver::<2>(&text);
    let mut march = Explicit::new(&fluid, Plan { method: Method::Ssprk3, cfl: 0.5, until }, Past::default(), u);
    while !march.finished() {
        march.advance().unwrap();
    }
    let exact = IsentropicVortex::new(5.0, Vector([5.0, 5.0]), Vector([1.0, 1.0]), fluid.gas.gamma).unwrap();
    let exact = exact.periodic(Vector([10.0, 10.0]));
    let (cloud, u) = (&fluid.discretisation.cloud, march.standing().state);
    let square = |i: usize| {
        let found = fluid.gas.primitive(&Conserved::<2>::load(&u[4 * i..])).density;
        cloud.volume[i] * (found - exact.state(&cloud.x[i], until).density).powi(2)
    };
    let volume: f64 = cloud.volume[..cloud.n_fluid].iter().sum();
    ((0..cloud.n_fluid).map(square).sum::<f64>() / volume).sqrt()
}

#[test] // eq1, eq2, eq3, eq16: Shu (1998), isentropic vortex
fn the_isentropic_vortex_converges_at_second_order() {
    for low_mach in [false, true] {
        let errors = [0.3125, 0.15625, 0.078125].map(|h| vortex_error(h, 1.0, low_mach));
        let order = (errors[1] / errors[2]).log2();
        assert!(order >= 1.9, "order {order:.3}, errors {errors:?}, low_mach = {low_mach}");
    }
}

/// Part of its kinetic energy that a vortex at rest of Mach number 0.01 loses until sound has crossed its box five times.
fn slow_vortex_loss(low_mach: bool) -> f64 {
    let text = vortex(0.3125, 40.0).replace("[time", &format!("low_mach = {low_mach}\n[time"));
    let text =
        text.replace("strength = 5.0", "strength = 0.05").replace("[1.0, 1.0]\n[scheme]", "[0.0, 0.0]\n[scheme]");
    let (fluid, u) = solver::<2>(&text);
    let energy = |u: &[f64]| -> f64 {
        u.chunks_exact(4)
            .zip(&fluid.discretisation.cloud.volume)
            .map(|(u, v)| v * (u[1] * u[1] + u[2] * u[2]) / u[0])
            .sum()
    };
    let before = energy(&u);
    let mut march = Explicit::new(&fluid, Plan { method: Method::Ssprk3, cfl: 0.5, until: 40.0 }, Past::default(), u);
    while !march.finished() {
        march.advance().unwrap();
    }
    1.0 - energy(march.standing().state) / before
}

#[test] // Thornber et al. (2008): the loss of kinetic energy of slow flow must not grow as 1/M
fn slow_vortices_keep_their_energy() {
    let (plain, scaled) = (slow_vortex_loss(false), slow_vortex_loss(true));
    assert!(scaled < 0.2 * plain && scaled > -1e-3, "{plain:.4} {scaled:.4}");
}
