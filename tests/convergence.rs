//! Observed order on an exact solution.
#![allow(clippy::unwrap_used, reason = "a test may stop anywhere")]

mod common;

use alula::exact::vortex::IsentropicVortex;
use alula::math::Vector;
use alula::physics::Conserved;
use alula::time::explicit::{Explicit, Method};
use alula::time::{March, Past};
use common::{solver, vortex};

/// Volume-weighted error of the density at time `until`, as a root mean square.
fn vortex_error(spacing: f64, until: f64) -> f64 {
    let (fluid, u) = solver::<2>(&vortex(spacing, until));
    let mut march = Explicit::new(&fluid, Method::Ssprk3, (0.5, until), (Past::default(), u));
    while !march.finished() {
        march.advance().unwrap();
    }
    let exact = IsentropicVortex::new(5.0, Vector([5.0, 5.0]), Vector([1.0, 1.0]), fluid.gas.gamma).unwrap();
    let exact = exact.periodic(Vector([10.0, 10.0]));
    let (cloud, u) = (&fluid.shape.cloud, march.parts().2);
    let square = |i: usize| {
        let found = fluid.gas.primitive(&Conserved::<2>::load(&u[4 * i..])).density;
        cloud.volume[i] * (found - exact.state(&cloud.x[i], until).density).powi(2)
    };
    let volume: f64 = cloud.volume[..cloud.n_fluid].iter().sum();
    ((0..cloud.n_fluid).map(square).sum::<f64>() / volume).sqrt()
}

#[test] // eq1, eq2, eq3, eq16: Shu (1998), isentropic vortex
fn the_isentropic_vortex_converges_at_second_order() {
    let errors = [0.3125, 0.15625, 0.078125].map(|h| vortex_error(h, 1.0));
    let order = (errors[1] / errors[2]).log2();
    assert!(order >= 1.9, "order {order:.3}, errors {errors:?}");
}
