//! Operators reproduce the fields that they are made for, on clouds without any order.

use crate::common::{largest, round_body, solver, two_levels};
use alula::math::Vector;
use alula::math::least_squares::{Fit, Method};
use alula::physics::Primitive;
use alula::scheme::Fluid;
use alula::system::{Instant, System};

/// Round-off of a derivative over a spacing of some hundredths.
const ROUND_OFF: f64 = 1e-12;

/// Slopes of density, velocity components and pressure.
fn slope<const D: usize>(k: usize) -> Vector<D> {
    Vector::from_fn(|d| [0.31, -0.73, 0.57, 0.19, -0.41][(k + 2 * d) % 5])
}

fn linear<const D: usize>(x: &Vector<D>) -> Primitive<D> {
    Primitive {
        density: 3.0 + slope(0).dot(x),
        velocity: Vector::from_fn(|d| slope(1 + d).dot(x)),
        pressure: 5.0 + slope(4).dot(x),
    }
}

/// Largest error of the gradient of a linear field over all particles with a cloud.
fn gradient_error<const D: usize>(fluid: &Fluid<D>) -> f64 {
    let mut work = fluid.work();
    let still = fluid.frame(&Instant::still(0.0), &vec![1.0; fluid.len()]);
    work.state = fluid.discretisation.cloud.x.iter().map(linear).collect();
    fluid.fill_gradients(&still, &mut work);
    largest(work.gradient[..fluid.discretisation.cloud.n_fluid].iter().flat_map(|g| {
        let velocity = (0..D).map(|d| (g.velocity[d] - slope(1 + d)).max_abs());
        velocity.chain([(g.density - slope(0)).max_abs(), (g.pressure - slope(4)).max_abs()]).collect::<Vec<_>>()
    }))
}

#[test] // eq10
fn the_gradient_of_a_linear_field_is_exact_on_a_random_cloud() {
    let plane = gradient_error(&solver::<2>(&two_levels(2)).0);
    let solid = gradient_error(&solver::<3>(&two_levels(3)).0);
    assert!(plane <= ROUND_OFF && solid <= ROUND_OFF, "2-D {plane:.2e}, 3-D {solid:.2e}");
}

#[test] // eq10
fn the_gradient_of_a_linear_field_is_exact_beside_a_wall() {
    let circle = gradient_error(&solver::<2>(&round_body(2)).0);
    let sphere = gradient_error(&solver::<3>(&round_body(3)).0);
    assert!(circle <= ROUND_OFF && sphere <= ROUND_OFF, "circle {circle:.2e}, sphere {sphere:.2e}");
}

/// Points in the unit cube from a linear congruential generator.
fn points(n: usize) -> Vec<Vector<3>> {
    let mut seed = 12_345u64;
    let mut next = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    (0..n).map(|_| Vector::from_fn(|_| next())).collect()
}

#[test] // eq11, eq13, eq14, eq15
fn a_fit_with_neumann_rows_reproduces_the_linear_field_that_obeys_them() {
    let truth = [0.7, -0.2, 0.4, 1.1];
    let all = points(12);
    let (values, normals) = all.split_at(8);
    let mut fit = Fit::default();
    fit.reset(4);
    let mut data = Vec::new();
    for x in values {
        fit.push(&[1.0, x[0], x[1], x[2]], 1.0);
        data.push(truth[0] + truth[1] * x[0] + truth[2] * x[1] + truth[3] * x[2]);
    }
    for n in normals.iter().map(Vector::unit) {
        fit.push(&[0.0, n[0], n[1], n[2]], 1.0);
        data.push(truth[1] * n[0] + truth[2] * n[1] + truth[3] * n[2]);
    }
    let mut row = Vec::new();
    for (m, c) in truth.iter().enumerate() {
        assert_eq!(fit.row_of_inverse(m, &mut row), Method::Cholesky);
        let found: f64 = row.iter().zip(&data).map(|(r, f)| r * f).sum();
        assert!((found - c).abs() < 1e-12, "coefficient {m}: {found} for {c}");
    }
}

#[test] // eq12
fn wall_states_obey_the_neumann_condition() {
    let text = "title = \"box\"\n[flow]\nmach = 0.3\n[[body]]\nbox = { size = [1.0, 1.0] }\n[cloud]\nspacing = 0.0625\n\
                far_field = 4.0\n[scheme]\nlimiter = \"none\"\n";
    let (fluid, _) = solver::<2>(text);
    // gas at rest whose pressure varies along the upper face only: ∂p/∂n = 0 there
    let field = |x: &Vector<2>| Primitive::<2> { density: 1.0, velocity: Vector::ZERO, pressure: 1.0 + 0.1 * x[0] };
    let cloud = &fluid.discretisation.cloud;
    let mut u = vec![0.0; fluid.len()];
    for (x, row) in cloud.x.iter().zip(u.chunks_exact_mut(4)) {
        fluid.gas.conserved(&field(x)).store(row);
    }
    let mut work = fluid.work();
    fluid.fill_states(&fluid.frame(&Instant::still(0.0), &u), &u, &mut work);
    let on_face = |x: &Vector<2>| x[1] > 0.499 && x[0].abs() < 0.2;
    let face: Vec<usize> = cloud.interface_range().filter(|i| on_face(&cloud.x[*i])).collect();
    let error = largest(face.iter().map(|i| work.state[*i].pressure - field(&cloud.x[*i]).pressure));
    assert!(face.len() > 3 && error < 1e-12, "{} particles, {error:.2e}", face.len());
}
