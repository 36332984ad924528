//! Particles that travel with the fluid, and clouds on prescribed motion.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::common::{case, largest, solver, vortex, with_threads};
use alula::case::Initial;
use alula::claims::{FieldTruth, metrics};
use alula::cloud::Cloud;
use alula::exact::vortex::IsentropicVortex;
use alula::math::Vector;
use alula::math::jet::Jet;
use alula::physics::Conserved;
use alula::scheme::discretisation::{Path, Places};
use alula::scheme::{CloudMotion, Fluid, RemapLedger};
use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::explicit::{self, Explicit, Method};
use alula::time::{Integrator, Memory, Past, Standing};

/// Round-off of some tens of steps of fluxes of order one over spacings of some hundredths.
const ROUND_OFF: f64 = 1e-12;

/// The same case with particles that travel.
fn lagrangian(case: &str) -> String {
    format!("{case}\n[motion]\nparticles = \"lagrangian\"\n")
}

/// Where a march of travelling particles ended.
struct End<const D: usize> {
    fluid: Fluid<D>,
    u: Vec<f64>,
    past: Past,
    ledger: RemapLedger,
}

/// How to march.
#[derive(Clone, Copy)]
enum How {
    /// SSPRK3 at this Courant number.
    Courant(f64),
    /// BDF2 with steps of this length.
    Step(f64),
}
use How::{Courant, Step};

/// Newton's method on every step.
const NEWTON: Control = Control { cfl: 1e3, basis: 20, ..Control::newton(2) };

fn implicit(step: f64, until: f64, orders: f64) -> Plan {
    Plan { until, step, order: 2, orders, iterations: 40, adaptive: None }
}

/// Marches, building the cloud anew when it is worn, until the time or the number of steps is reached.
fn march<const D: usize>((fluid, u): (Fluid<D>, Vec<f64>), (how, until, steps): (How, f64, u32)) -> End<D> {
    let mut end = End { fluid, u, past: Past::default(), ledger: RemapLedger::default() };
    loop {
        let (past, u) = (end.past.clone(), end.u.clone());
        let mut leg: Box<dyn Integrator<Fluid<D>>> = match how {
            Courant(cfl) => {
                Box::new(Explicit::new(&end.fluid, explicit::Plan { method: Method::Ssprk3, cfl, until }, past, u))
            }
            Step(step) => {
                let orders = if steps < u32::MAX { 13.0 } else { 4.0 };
                Box::new(Dual::new(&end.fluid, NEWTON, implicit(step, until, orders), past, u))
            }
        };
        let mut worn = false;
        while !leg.finished() && leg.mark().iteration < steps && !worn {
            leg.advance().unwrap();
            worn = end.fluid.is_worn(leg.standing().frame);
        }
        let Memory::March(past) = leg.memory() else { panic!("a march") };
        let Standing { frame, work, state: u, .. } = leg.standing();
        let known = [&past.before[..], &past.older];
        let reclouded = end.fluid.reclouded(frame, (u, known), work, &mut end.ledger).unwrap().unwrap();
        drop(leg);
        let [before, older] = reclouded.past;
        (end.fluid, end.u, end.past) = (reclouded.fluid, reclouded.u, Past { before, older, ..past });
        if end.past.time >= until || end.past.iteration >= steps {
            return end;
        }
    }
}

/// Root mean square of the error of the density of the vortex at time `until`, on a cloud that repeats every ten lengths.
fn vortex_rms(cloud: &Cloud<2>, (volume, gamma): (&[f64], f64), u: &[f64], until: f64) -> f64 {
    let exact = IsentropicVortex::new(5.0, Vector([5.0, 5.0]), Vector([1.0, 1.0]), gamma).unwrap();
    let exact = exact.periodic(Vector([10.0, 10.0]));
    let square = |i: usize| volume[i] * (u[4 * i] - exact.state(&cloud.x[i], until).density).powi(2);
    ((0..cloud.n_fluid).map(square).sum::<f64>() / volume[..cloud.n_fluid].iter().sum::<f64>()).sqrt()
}

/// Stream at Mach 0.6 through a box of travelling particles on two levels, from one open side to another.
fn stream<const D: usize>() -> (Fluid<D>, Vec<f64>) {
    let list = |first: f64, v: f64| [vec![first.to_string()], vec![v.to_string(); D - 1]].concat().join(", ");
    let h = if D == 2 { 0.0625 } else { 1.0 / 6.0 };
    solver::<D>(&lagrangian(&format!(
        "title = \"box\"\ndimension = {D}\n[flow]\nmach = 0.6\nalpha = \"7 deg\"\n[cloud]\nspacing = {h}\njitter = 0.2\n\
         [cloud.domain]\nmin = [{}]\nmax = [{}]\n[[cloud.box]]\nmin = [{}]\nmax = [{}]\nspacing = {}\n\
         [time.explicit]\nuntil = 1.0\n",
        list(0.0, 0.0),
        list(2.0, 1.0),
        list(0.5, 0.0),
        list(1.0, 1.0),
        0.5 * h
    )))
}

fn uniform_drift<const D: usize>(how: How) -> (f64, RemapLedger) {
    let (fluid, u) = stream::<D>();
    let state = u[..D + 2].to_vec();
    let end = march((fluid, u), (how, 1e3, 60));
    (largest(end.u.chunks(D + 2).flat_map(|r| r.iter().zip(&state).map(|(a, b)| a - b))), end.ledger)
}

#[test]
fn uniform_flow_stays_uniform_on_travelling_particles() {
    let implicit = [uniform_drift::<2>(Step(0.03)), uniform_drift::<3>(Step(0.06))];
    let explicit = [uniform_drift::<2>(Courant(0.5)), uniform_drift::<3>(Courant(0.5))];
    for (drift, ledger) in implicit.into_iter().chain(explicit) {
        assert!(drift <= ROUND_OFF, "{drift:e}");
        assert!(ledger.renewals > 10 && ledger.inserted > 50 && ledger.removed > 50, "{ledger:?}");
        assert!(largest(ledger.exchanged.iter().copied()) < ROUND_OFF, "{ledger:?}");
    }
}

/// Gas at rest with a density that grows along every axis.
fn layered_drift(how: How) -> (f64, RemapLedger) {
    let text = "title = \"box\"\ndimension = 2\n[flow]\nmach = 0.5\n[cloud]\nspacing = 0.0625\njitter = 0.3\n\
                [cloud.domain]\nmin = [0.0, 0.0]\nmax = [1.0, 1.0]\n[boundary]\nx_min = \"held\"\nx_max = \"held\"\n\
                y_min = \"held\"\ny_max = \"held\"\n[time.explicit]\nuntil = 1.0\n";
    let (mut fluid, mut u) = solver::<2>(&lagrangian(text));
    let layered = |x: &Vector<2>| alula::physics::Primitive {
        density: 2.0 + 0.3 * x[0] + 0.4 * x[1],
        velocity: Vector::ZERO,
        pressure: 1.0 / 1.4,
    };
    fluid.held = Arc::new(layered);
    let set = |u: &mut [f64], x: &[Vector<2>], fluid: &Fluid<2>| {
        u.chunks_mut(4).zip(x).for_each(|(row, x)| fluid.gas.conserved(&layered(x)).store(row));
    };
    set(&mut u, &fluid.discretisation.cloud.x, &fluid);
    let end = march((fluid, u), (how, 1e3, 100));
    let mut exact = vec![0.0; end.u.len()];
    set(&mut exact, &end.fluid.discretisation.cloud.x, &end.fluid);
    (largest(end.u.iter().zip(&exact).map(|(a, b)| a - b)), end.ledger)
}

#[test]
fn a_linear_density_at_rest_stays_while_particles_are_shifted() {
    for how in [Courant(0.5), Step(0.03)] {
        let (error, ledger) = layered_drift(how);
        assert!(error <= ROUND_OFF, "{error:e} {ledger:?}");
    }
}

/// Error of the vortex at time 2 on travelling particles.
fn travelling_vortex(h: f64, how: How) -> f64 {
    let end = march(solver::<2>(&lagrangian(&vortex(h, 2.0))), (how, 2.0, u32::MAX));
    let (cloud, volume) = (&end.fluid.discretisation.cloud, end.fluid.volumes());
    vortex_rms(cloud, (&volume, end.fluid.gas.gamma), &end.u, 2.0)
}

#[test] // Shu (1998), isentropic vortex
fn the_vortex_converges_at_second_order_on_travelling_particles() {
    travelling_vortices_are_of_second_order(&[0.3125, 0.15625]);
}

#[test] // Shu (1998), isentropic vortex
#[ignore = "long: `.ci/run` and `cargo test -- --ignored` run it"]
fn the_vortex_converges_at_second_order_on_many_travelling_particles() {
    travelling_vortices_are_of_second_order(&[0.3125, 0.15625, 0.078125]);
}

fn travelling_vortices_are_of_second_order(spacings: &[f64]) {
    let explicit = |h: &f64| travelling_vortex(*h, Courant(0.5));
    let implicit = |h: &f64| travelling_vortex(*h, Step(0.32 * h));
    assert_second_order(spacings, &spacings.iter().map(explicit).collect::<Vec<f64>>());
    assert_second_order(spacings, &spacings.iter().map(implicit).collect::<Vec<f64>>());
}

fn assert_second_order(spacings: &[f64], errors: &[f64]) {
    let order = metrics::observed_order(spacings, errors).unwrap();
    assert!(order >= 1.9, "order {order:.3}, errors {errors:?}");
}

#[test] // Shu (1998), isentropic vortex; on this cloud the error of the steps is many times that of the fits
fn implicit_steps_of_travelling_particles_are_of_second_order() {
    let errors = [0.2, 0.1].map(|step| travelling_vortex(0.078125, Step(step)));
    let order = (errors[0] / errors[1]).log2();
    assert!(order >= 1.9, "order {order:.3}, errors {errors:?}");
}

/// A displacement that repeats in space and swings in time, up to 0.5 of a box of length 10.
struct Swing;
impl Path<2> for Swing {
    fn at(&self, t: f64, _: &[Jet]) -> Places<'_, 2> {
        let size = 0.5 * (1.5 * t).sin();
        Box::new(move |_, x| *x + Vector([(TAU * x[1] / 10.0).sin(), (TAU * x[0] / 10.0).cos()]) * size)
    }
    fn origin(&self, x: &Vector<2>, _: f64, _: &[Jet]) -> Vector<2> {
        *x
    }
}

/// The same along straight lines at constant speed: within a step of an explicit method particles go straight, so that
/// only on such a path the equations are smooth in time and the order of the method can be seen.
struct Straight;
impl Path<2> for Straight {
    fn at(&self, t: f64, _: &[Jet]) -> Places<'_, 2> {
        Box::new(move |_, x| *x + Vector([(TAU * x[1] / 10.0).sin(), (TAU * x[0] / 10.0).cos()]) * (0.5 * t))
    }
    fn origin(&self, x: &Vector<2>, _: f64, _: &[Jet]) -> Vector<2> {
        *x
    }
}

fn along(path: impl Path<2> + 'static) -> CloudMotion<2> {
    CloudMotion::Along { path: Arc::new(path), laws: Vec::new(), deforming_surface: Arc::default() }
}

/// The vortex on a prescribed motion; conservative coefficients do not follow a cloud that deforms.
fn moving_vortex(h: f64, until: f64, path: impl Path<2> + 'static) -> (Fluid<2>, Vec<f64>) {
    let text = vortex(h, until).replace("[scheme]\n", "[scheme]\nconservative = false\n");
    let (fluid, u) = solver::<2>(&text);
    // both paths start from where the case puts the particles
    (Fluid { cloud_motion: along(path), ..fluid }, u)
}

#[test] // Shu (1998), isentropic vortex
fn the_vortex_converges_at_second_order_on_a_cloud_that_deforms() {
    let spacings = [0.3125, 0.15625, 0.078125];
    let errors = spacings.map(|h| {
        let (fluid, u) = moving_vortex(h, 1.0, Swing);
        let mut march =
            Explicit::new(&fluid, explicit::Plan { method: Method::Ssprk3, cfl: 0.5, until: 1.0 }, Past::default(), u);
        while !march.finished() {
            march.advance().unwrap();
        }
        let Standing { frame, state: u, .. } = march.standing();
        let volume = &fluid.discretisation.cloud.volume;
        vortex_rms(&frame.discretisation.cloud, (volume, fluid.gas.gamma), u, 1.0)
    });
    assert_second_order(&spacings, &errors);
}

fn explicit_state(cfl: f64) -> Vec<f64> {
    let (fluid, u) = moving_vortex(0.625, 1.0, Straight);
    let mut march =
        Explicit::new(&fluid, explicit::Plan { method: Method::Ssprk3, cfl, until: 1.0 }, Past::default(), u);
    while !march.finished() {
        march.advance().unwrap();
    }
    march.standing().state.to_vec()
}

fn implicit_state(step: f64) -> Vec<f64> {
    let (fluid, u) = moving_vortex(0.625, 1.0, Swing);
    let mut march = Dual::new(&fluid, NEWTON, implicit(step, 1.0, 9.0), Past::default(), u);
    while !march.finished() {
        march.advance().unwrap();
    }
    march.standing().state.to_vec()
}

#[test]
fn no_march_goes_on_from_a_state_that_is_not_physical() {
    for wrong in [f64::NAN, -0.5] {
        let (fluid, mut u) = moving_vortex(1.25, 1.0, Straight);
        u[40] = wrong;
        let mut march = Dual::new(&fluid, NEWTON, implicit(0.1, 1.0, 9.0), Past::default(), u.clone());
        let refused = march.check().unwrap_err().to_string();
        assert!(refused.contains("last step 0"), "{refused}");
        assert!(march.advance().is_err() && !march.finished());
        let mut march =
            Explicit::new(&fluid, explicit::Plan { method: Method::Ssprk3, cfl: 0.5, until: 1.0 }, Past::default(), u);
        assert!(march.check().is_err() && march.advance().is_err());
    }
}

/// Order seen between two steps, the second half the first, against a much shorter one.
fn order_in_time(state: impl Fn(f64) -> Vec<f64>, step: f64) -> f64 {
    let exact = state(step / 16.0);
    let error = |u: Vec<f64>| u.iter().zip(&exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    (error(state(step)) / error(state(0.5 * step))).log2()
}

#[test]
fn methods_in_time_keep_their_order_on_a_cloud_that_deforms() {
    let (third, second) = (order_in_time(explicit_state, 0.8), order_in_time(implicit_state, 0.05));
    assert!(third >= 2.8 && second >= 1.9, "SSPRK3 {third:.2}, BDF2 {second:.2}");
}

/// Sod's tube between planes of symmetry.
fn sod() -> String {
    "title = \"Sod\"\ndimension = 2\n[flow]\nmach = 1.0\n[cloud]\nspacing = 0.0078125\n\
     domain = { min = [0.0, 0.0], max = [1.0, 0.0625] }\n[boundary]\nx_min = \"symmetry\"\nx_max = \"symmetry\"\n\
     y_min = \"symmetry\"\ny_max = \"symmetry\"\n[initial.riemann]\nleft = [1.0, 0.0, 1.0]\nright = [0.125, 0.0, 0.1]\n\
     position = 0.5\naxis = 0\n[time.explicit]\nuntil = 0.2\n[scheme]\nconservative = false\n"
        .to_owned()
}

/// Distance of the shock from its exact place, in spacings.
fn shock_error(x: &[Vector<2>], u: &[f64], fluid: &Fluid<2>) -> f64 {
    let (left, right) = ([1.0, 0.0, 1.0], [0.125, 0.0, 0.1]);
    let start = Initial::Riemann { left, right, position: 0.5, axis: 0 };
    let (place, levels) = FieldTruth::new(&start, 1.4, None).unwrap().unwrap().shock(0.2).unwrap();
    let pressure = |row: &[f64]| fluid.gas.primitive(&Conserved::<2>::load(row)).pressure;
    let (x, p): (Vec<f64>, Vec<f64>) = x.iter().zip(u.chunks(4)).map(|(x, row)| (x[0], pressure(row))).unzip();
    (metrics::front_position(&x, &p, levels, (0.0, 1.0)).unwrap() - place) / 0.0078125
}

/// Particles that swing along the tube, thirty times as fast as the gas crosses a tenth of it.
struct Shaken;
impl Path<2> for Shaken {
    fn at(&self, t: f64, _: &[Jet]) -> Places<'_, 2> {
        let size = 0.04 * (30.0 * t).sin();
        Box::new(move |_, x| Vector([x[0] + size * (0.5 * TAU * x[0]).sin(), x[1]]))
    }
    fn origin(&self, x: &Vector<2>, _: f64, _: &[Jet]) -> Vector<2> {
        *x
    }
}

fn sod_along(cloud_motion: CloudMotion<2>) -> f64 {
    let (fluid, u) = solver::<2>(&sod());
    let fluid = Fluid { cloud_motion, ..fluid };
    let mut march =
        Explicit::new(&fluid, explicit::Plan { method: Method::Ssprk3, cfl: 0.5, until: 0.2 }, Past::default(), u);
    while !march.finished() {
        march.advance().unwrap();
    }
    let Standing { frame, state: u, .. } = march.standing();
    shock_error(&frame.discretisation.cloud.x, u, &fluid)
}

#[test] // Sod (1978), exact Riemann solution
fn the_shock_of_sod_stands_where_it_stands_on_a_cloud_at_rest() {
    let still = sod_along(CloudMotion::Still);
    let shaken = sod_along(along(Shaken));
    let end = march(solver::<2>(&lagrangian(&sod())), (Courant(0.5), 0.2, u32::MAX));
    let travels = shock_error(&end.fluid.discretisation.cloud.x, &end.u, &end.fluid);
    let differences = [shaken - still, travels - still];
    assert!(differences.iter().all(|d| d.abs() <= 0.5), "{still:.3} {shaken:.3} {travels:.3} {:?}", end.ledger);
}

/// A cylinder in a stream that starts at once.
fn cylinder() -> String {
    lagrangian(
        "title = \"cylinder\"\n[flow]\nmach = 0.3\n[[body]]\ncircle = { radius = 0.5 }\n[cloud]\nspacing = 0.0625\n\
         far_field = 4.0\n[time.explicit]\nuntil = 2.0\n",
    )
}

#[test]
fn particles_go_around_a_body_and_leave_no_holes() {
    let end = march(solver::<2>(&cylinder()), (Courant(0.5), 2.0, u32::MAX));
    let cloud = &end.fluid.discretisation.cloud;
    let h = 0.0625;
    let fluid = &cloud.x[..cloud.n_fluid];
    assert!(fluid.iter().all(|x| x.norm() > 0.5 + 0.39 * h), "a particle stands in the wall");
    // places around the body, a few spacings deep
    for k in 0..400 {
        let (angle, radius) = (TAU * f64::from(k) / 100.0, 0.5 + h * (0.8 + f64::from(k % 4)));
        let x = Vector([radius * angle.cos(), radius * angle.sin()]);
        let nearest = cloud.x.iter().map(|y| (*y - x).norm()).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1.3 * h, "a hole of {:.2} spacings at {x:?}", nearest / h);
    }
    assert!(end.ledger.inserted > 20 && end.ledger.removed > 20, "{:?}", end.ledger);
}

#[test]
fn bits_do_not_depend_on_threads() {
    let run = || march(solver::<2>(&cylinder()), (Courant(0.5), 0.5, u32::MAX)).u;
    let (one, three) = (with_threads(1, run), with_threads(3, run));
    assert!(one.len() == three.len() && one.iter().zip(&three).all(|(a, b)| a.to_bits() == b.to_bits()));
}

#[test]
fn a_case_of_travelling_particles_reads_back() {
    let text = case(&cylinder());
    assert!(text.moves());
}
