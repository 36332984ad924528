//! What must hold on particles that move, whatever their motion.

use std::sync::Arc;

use crate::common::{largest, solver};
use alula::math::Vector;
use alula::math::jet::Jet;
use alula::motion::{BodyMotion, TimeFunction};
use alula::physics::{Conserved, Primitive};
use alula::scheme::discretisation::{Path, Places};
use alula::scheme::{CloudMotion, Fluid};
use alula::system::{Instant, System};
use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::explicit::{self, Explicit, Method};
use alula::time::{Integrator, Past, Standing};

/// Round-off of some tens of steps of fluxes of order one over spacings of some hundredths.
const ROUND_OFF: f64 = 1e-12;
/// Length of a step in time.
const STEP: f64 = 0.0125;
/// Steps of an implicit march.
const STEPS: u32 = 40;

/// Spacing of the clouds.
fn spacing(dimension: usize) -> f64 {
    if dimension == 2 { 0.125 } else { 1.0 / 6.0 }
}

/// A random cloud of two levels in a box whose sides hold the field at the start.
fn boxed<const D: usize>() -> (Fluid<D>, Vec<f64>) {
    let list = |v: f64| vec![v.to_string(); D].join(", ");
    let sides: String =
        ["x", "y", "z"][..D].iter().map(|a| format!("{a}_min = \"held\"\n{a}_max = \"held\"\n")).collect();
    let spacing = spacing(D);
    let half = if D == 2 { "0.5, 0.0" } else { "0.5, 0.0, 0.0" };
    let case = format!(
        "title = \"box\"\ndimension = {D}\n[flow]\nmach = 0.6\nalpha = \"7 deg\"\n[cloud]\nspacing = {spacing}\n\
         jitter = 0.2\n[cloud.domain]\nmin = [{}]\nmax = [{}]\n[[cloud.box]]\nmin = [{half}]\nmax = [{}]\n\
         spacing = {}\n[scheme]\nconservative = false\n[boundary]\n{sides}",
        list(0.0),
        list(1.0),
        list(1.0),
        0.5 * spacing
    );
    solver::<D>(&case)
}

/// Gas at rest with a density that grows along every axis.
fn layered<const D: usize>(x: &Vector<D>) -> Primitive<D> {
    let density = 2.0 + (0..D).map(|d| (0.3 + 0.1 * d as f64) * x[d]).sum::<f64>();
    Primitive { density, velocity: Vector::ZERO, pressure: 1.0 / 1.4 }
}

/// Displacement by a wave, up to 10 % of the box.
struct Wave;
impl<const D: usize> Path<D> for Wave {
    fn at(&self, t: f64, _: &[Jet]) -> Places<'_, D> {
        Box::new(move |_, x| {
            *x + Vector::from_fn(|d| 0.1 * (3.0 * x[(d + 1) % D] + d as f64).sin() * (4.0 * t + d as f64).sin())
        })
    }
    fn origin(&self, x: &Vector<D>, _: f64, _: &[Jet]) -> Vector<D> {
        *x
    }
}

/// Every particle on a walk of its own, a few per cent of the spacing a step, there and back.
struct Walk;
impl Walk {
    fn offset<const D: usize>(i: usize, step: i64) -> Vector<D> {
        let hash = |d: usize| {
            let mut z = (i as u64) << 20 ^ (step.rem_euclid(7) as u64) << 3 ^ d as u64;
            for _ in 0..3 {
                z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
                z ^= z >> 27;
            }
            (z >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        Vector::from_fn(|d| 0.1 * spacing(D) * hash(d))
    }
}
impl<const D: usize> Path<D> for Walk {
    fn at(&self, t: f64, _: &[Jet]) -> Places<'_, D> {
        let (step, part) = ((t / STEP).floor(), (t / STEP).rem_euclid(1.0));
        Box::new(move |i, x| {
            let (a, b) = (Self::offset::<D>(i, step as i64), Self::offset::<D>(i, step as i64 + 1));
            *x + a * (1.0 - part) + b * part
        })
    }
    fn origin(&self, x: &Vector<D>, _: f64, _: &[Jet]) -> Vector<D> {
        *x
    }
}

fn pitching<const D: usize>() -> CloudMotion<D> {
    let sine = TimeFunction::Sine { amplitude: 0.5, omega: 9.0, phase: 0.3 };
    CloudMotion::Rigid(BodyMotion::about(Vector::splat(0.4), None).with_angle(sine))
}

fn along<const D: usize>(path: impl Path<D> + 'static) -> CloudMotion<D> {
    CloudMotion::Along { path: Arc::new(path), laws: Vec::new(), deforming_surface: Arc::default() }
}

/// Marches the field and returns the largest difference from it, where particles are then.
fn drift<const D: usize>(
    cloud_motion: CloudMotion<D>,
    field: &dyn Fn(&Vector<D>) -> Primitive<D>,
    (fluid, held): (Fluid<D>, alula::scheme::start::Field<D>),
    implicit: bool,
) -> f64 {
    let fluid = Fluid { cloud_motion, held, ..fluid };
    let frame = fluid.frame(&Instant::still(0.0), &vec![1.0; fluid.len()]);
    let mut u = vec![0.0; fluid.len()];
    for (i, row) in u.chunks_exact_mut(D + 2).enumerate() {
        fluid.gas.conserved(&field(&frame.place(i))).store(row);
    }
    let until = STEP * f64::from(STEPS);
    if implicit {
        let control = Control { cfl: 1e3, basis: 10, ..Control::newton(2) };
        let plan = Plan { until, step: STEP, order: 2, orders: 13.0, iterations: 30, adaptive: None };
        worst(&fluid, Dual::new(&fluid, control, plan, Past::default(), u), field)
    } else {
        worst(
            &fluid,
            Explicit::new(&fluid, explicit::Plan { method: Method::Ssprk3, cfl: 0.5, until }, Past::default(), u),
            field,
        )
    }
}

fn worst<const D: usize>(
    fluid: &Fluid<D>,
    mut march: impl Integrator<Fluid<D>>,
    field: &dyn Fn(&Vector<D>) -> Primitive<D>,
) -> f64 {
    while !march.finished() {
        march.advance().unwrap();
    }
    let Standing { frame, state: u, .. } = march.standing();
    largest((0..fluid.discretisation.cloud.n_fluid).map(|i| {
        let found = fluid.gas.primitive(&Conserved::<D>::load(&u[i * (D + 2)..]));
        let error = found.minus(&field(&frame.place(i)));
        error.density.abs().max(error.velocity.max_abs()).max(error.pressure.abs())
    }))
}

fn uniform_drift<const D: usize>(cloud_motion: CloudMotion<D>, implicit: bool) -> f64 {
    let (fluid, _) = boxed::<D>();
    let held = Arc::clone(&fluid.held);
    let field = Arc::clone(&held);
    drift(cloud_motion, &*field, (fluid, held), implicit)
}

fn layered_drift<const D: usize>(cloud_motion: CloudMotion<D>, implicit: bool) -> f64 {
    let (fluid, _) = boxed::<D>();
    drift(cloud_motion, &layered::<D>, (fluid, Arc::new(layered::<D>)), implicit)
}

#[test]
fn uniform_flow_stays_uniform_on_particles_that_move() {
    for implicit in [false, true] {
        let plane = [uniform_drift::<2>(along(Wave), implicit), uniform_drift::<2>(along(Walk), implicit)];
        let solid = [uniform_drift::<3>(along(Wave), implicit), uniform_drift::<3>(along(Walk), implicit)];
        let pitch = [uniform_drift::<2>(pitching(), implicit), uniform_drift::<3>(pitching(), implicit)];
        let all = [plane, solid, pitch];
        assert!(all.as_flattened().iter().all(|e| *e <= ROUND_OFF), "implicit {implicit}: {all:?}");
    }
}

#[test]
fn a_linear_density_at_rest_stays_on_particles_that_move() {
    for implicit in [false, true] {
        let plane = [layered_drift::<2>(along(Wave), implicit), layered_drift::<2>(along(Walk), implicit)];
        let solid = [layered_drift::<3>(along(Wave), implicit), layered_drift::<3>(along(Walk), implicit)];
        let all = [plane, solid];
        assert!(all.as_flattened().iter().all(|e| *e <= ROUND_OFF), "implicit {implicit}: {all:?}");
    }
    // poses are differenced with the formula of the state only where steps are implicit
    let pitch = [layered_drift::<2>(pitching(), true), layered_drift::<3>(pitching(), true)];
    assert!(pitch.iter().all(|e| *e <= ROUND_OFF), "{pitch:?}");
}
