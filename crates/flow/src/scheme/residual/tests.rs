//! Balance, uniform flow and moving walls of the discrete equations.
use std::sync::Arc;

use super::*;
use crate::case::Flux;
use crate::cloud::conservative::conservative;
use crate::cloud::{Cloud, CloudSpec, Operators};
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::math::jet::Scalar;
use crate::physics::{Gas, Primitive};
use crate::scheme::fluid::{FarField, Field};
use crate::scheme::reconstruct::Reconstruction;
use crate::scheme::{CloudMotion, Discretisation};
use crate::system::{Instant, System};

struct Still;
impl<const D: usize> FarField<D> for Still {
    fn state(&self, _: &Vector<D>, _: &Vector<D>) -> Primitive<D> {
        Primitive { density: 1.0, velocity: Vector::ZERO, pressure: 1.0 }
    }
    fn changing(&self, _: &Vector<D>, _: &Vector<D, Dual>) -> Primitive<D, Dual> {
        Primitive { density: Dual::constant(1.0), velocity: Vector::zero(), pressure: Dual::constant(1.0) }
    }
    fn pressure(&self) -> f64 {
        1.0
    }
}

/// Conservative scheme on a shaken cloud of two levels inside closed sides, with a circle in it when asked for.
fn closed(body: &str) -> Fluid<2> {
    with_cloud(body, "")
}

/// The same with more keys of the cloud.
fn with_cloud(body: &str, keys: &str) -> Fluid<2> {
    let text = format!(
        "title = \"x\"\ndimension = 2\n[flow]\nmach = 0.5\n{body}\n[cloud]\n{keys}\nspacing = 0.125\njitter = 0.2\n\
         domain = {{ min = [-1.0, -1.0], max = [1.0, 1.0] }}\n\
         [[cloud.box]]\nmin = [0.0, -1.0]\nmax = [1.0, 1.0]\nspacing = 0.0625\n\
         [boundary]\nx_min = \"symmetry\"\nx_max = \"symmetry\"\ny_min = \"periodic\"\ny_max = \"periodic\"\n"
    );
    let case = crate::case::read(&text, "test").unwrap();
    let surface = crate::geometry::load_surface::<2>(&case.bodies, std::path::Path::new(".")).unwrap().0;
    let mut cloud = Cloud::build(&CloudSpec::of_case(&case), (!body.is_empty()).then_some(&surface), &[]).unwrap();
    let mut operators = Operators::new(&cloud);
    conservative(&mut cloud, &mut operators);
    let discretisation = Arc::new(Discretisation::new(cloud, operators));
    let reconstruction = Reconstruction { second_order: true, kappa: 0.0, threshold: 0.02, low_mach: false };
    let held: Field<2> = Arc::new(|x| Still.state(x, &Vector::ZERO));
    let cloud_motion = CloudMotion::Still;
    let (gas, isentropic, flux, limiter) = (Gas { gamma: 1.4 }, false, Flux::Hllc, Limiter::VanAlbada);
    let far_field = Arc::new(Still);
    let conservative = true;
    let viscous_model = None;
    Fluid {
        fields: Fluid::unknowns(&discretisation.cloud),
        discretisation,
        cloud_motion,
        gas,
        isentropic,
        flux,
        limiter,
        reconstruction,
        conservative,
        viscous_model,
        far_field,
        held,
    }
}

/// The state of an uneven flow.
fn uneven(fluid: &Fluid<2>) -> Vec<f64> {
    let mut u = vec![0.0; fluid.len()];
    for (row, x) in u.chunks_mut(4).zip(&fluid.discretisation.cloud.x) {
        let wave = (3.0 * x[0]).sin() * (std::f64::consts::PI * x[1]).cos();
        let velocity = Vector([0.4 * wave, 0.3 - 0.2 * wave]);
        let q = Primitive { density: 1.0 + 0.3 * wave, velocity, pressure: 1.0 - 0.4 * wave };
        fluid.gas.conserved(&q).store(row);
    }
    u
}

/// Σ V R and Σ |V R| of every variable for an uneven flow, and the force on the bodies.
fn balance(fluid: &Fluid<2>) -> ([f64; 4], [f64; 4], Vector<2>) {
    let u = uneven(fluid);
    let (frame, mut work, mut du) = (fluid.frame(&Instant::still(0.0), &u), fluid.work(), vec![0.0; u.len()]);
    fluid.rhs(&frame, &u, &mut work, &mut du);
    let mut total = ([0.0; 4], [0.0; 4]);
    for (row, v) in du.chunks(4).zip(&fluid.discretisation.cloud.volume) {
        for (k, r) in row.iter().enumerate() {
            total.0[k] += v * r;
            total.1[k] += (v * r).abs();
        }
    }
    (total.0, total.1, fluid.pressure_force(&frame, &work))
}

#[test]
fn finding_rates_leaves_no_trace() {
    for second_order in [true, false] {
        let mut fluid = closed(CIRCLE);
        fluid.reconstruction.second_order = second_order;
        let u = uneven(&fluid);
        let (frame, mut work) = (fluid.frame(&Instant::still(0.0), &u), fluid.work());
        let [mut before, mut after] = [vec![0.0; u.len()], vec![0.0; u.len()]];
        fluid.rhs(&frame, &u, &mut work, &mut before);
        fluid.rates(&frame, &u, &mut work, &mut vec![0.0; fluid.discretisation.cloud.n_fluid]);
        fluid.rhs(&frame, &u, &mut work, &mut after);
        assert!(before == after);
    }
}

#[test]
fn a_frozen_limiter_changes_other_states_alone() {
    let fluid = closed(CIRCLE);
    let u = uneven(&fluid);
    let moved: Vec<f64> = u.iter().enumerate().map(|(k, u)| u * (1.0 + 1e-3 * (k as f64).sin())).collect();
    let frame = fluid.frame(&Instant::still(0.0), &u);
    let [mut free, mut frozen] = [fluid.work(), fluid.work()];
    fluid.freeze_limiter(&frame, &u, &mut frozen);
    // finding rates puts other numbers in the place of the steepness
    fluid.rates(&frame, &u, &mut frozen, &mut vec![0.0; fluid.discretisation.cloud.n_fluid]);
    let mut both = |u: &[f64]| {
        [&mut free, &mut frozen].map(|work| {
            let mut du = vec![0.0; u.len()];
            fluid.rhs(&frame, u, work, &mut du);
            du
        })
    };
    let [a, b] = both(&u);
    assert!(a == b);
    let [a, b] = both(&moved);
    let apart = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let size = a.iter().fold(0.0f64, |m, a| m.max(a.abs()));
    assert!(apart > 0.0 && apart < 1e-2 * size, "{apart} {size}");
}

#[test]
fn what_one_particle_loses_another_gains() {
    let (sum, size, _) = balance(&closed(""));
    // momentum along x leaves through the planes of symmetry
    assert!([0, 2, 3].iter().all(|k| sum[*k].abs() < 1e-13 * size[*k]), "{sum:?} {size:?}");
}

const CIRCLE: &str = "[[body]]\ncircle = { radius = 0.5 }";
const LAYERS: &str = "wall_layers = { first = 0.002 }";

#[test]
fn the_force_on_a_body_is_what_the_fluid_loses() {
    for keys in ["", LAYERS] {
        let (sum, size, force) = balance(&with_cloud(CIRCLE, keys));
        assert!(sum[0].abs() < 1e-13 * size[0] && sum[3].abs() < 1e-13 * size[3], "{sum:?}");
        assert!(force[1].abs() > 1e-4 && (sum[2] + force[1]).abs() < 1e-12, "{sum:?} {force:?}");
    }
}

#[test]
fn in_layers_it_does_not_matter_who_moves() {
    let fluid = with_cloud(CIRCLE, LAYERS);
    assert!(fluid.passes_by_faces());
    let cloud = &fluid.discretisation.cloud;
    let density = |w: Vector<2>| {
        let mut frame = fluid.frame(&Instant::still(0.0), &vec![1.0; fluid.len()]);
        frame.velocity = Arc::new(vec![w; cloud.len()]);
        let mut work = fluid.work();
        for (q, x) in work.state.iter_mut().zip(&cloud.x) {
            let height = 1.0 - (-20.0 * (x.norm() - 0.5).max(0.0)).exp();
            let velocity = Vector([0.4 * height, 0.1 * height * x[0]]) + w;
            *q = Primitive { density: 1.2 - 0.2 * height, velocity, pressure: 0.9 };
        }
        fluid.fill_gradients(&frame, &mut work);
        let mut du = vec![0.0; fluid.len()];
        fluid.fluxes((&frame, &work), &mut du);
        du.chunks(4).map(|r| r[0]).collect::<Vec<f64>>()
    };
    let (still, moved) = (density(Vector::ZERO), density(Vector([0.3, -0.2])));
    let size = still.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    let inside = |i: usize| cloud.x[i].max_abs() < 0.8;
    let apart = (0..cloud.n_fluid).filter(|i| inside(*i)).map(|i| (still[i] - moved[i]).abs()).fold(0.0, f64::max);
    assert!(size > 1.0 && apart < 1e-10 * size, "{apart:e} of {size:e}");
}

#[test]
fn uniform_flow_stays_uniform_in_layers() {
    let mut fluid = with_cloud(CIRCLE, LAYERS);
    assert!(!fluid.discretisation.cloud.layers.is_empty());
    let mut worst = |conservative: bool, velocity: Vector<2>| {
        fluid.conservative = conservative;
        let mut work = fluid.work();
        work.state.fill(Primitive { density: 1.2, velocity, pressure: 0.9 });
        let mut du = vec![0.0; fluid.len()];
        let still = fluid.frame(&Instant::still(0.0), &vec![1.0; fluid.len()]);
        fluid.fluxes((&still, &work), &mut du);
        // in units of pressure times surface over volume: cells are a hundred times thinner than long
        let unit = |i: usize| fluid.discretisation.cloud.volume[i] / fluid.discretisation.cloud.spacing[i];
        du.iter().enumerate().map(|(k, r): (usize, &f64)| (r * unit(k / 4)).abs()).fold(0.0, f64::max)
    };
    assert!(worst(false, Vector([0.3, -0.2])) < 1e-14);
    // through walls no mass passes, so that gas which moves through them piles up: only rest is uniform
    assert!(worst(true, Vector::ZERO) < 1e-13);
}
