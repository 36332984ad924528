//! Uniform flow, rotation, shear and the linearisation.
use super::*;
use crate::motion::{BodyMotion, TimeFunction};
use crate::physics::{Gas, Newtonian};
use crate::scheme::{CloudMotion, View, built};
use crate::system::{Instant, System, Term};

/// Gas in a box with a constant viscosity that a free stream of this Reynolds number has.
fn boxed(conservative: bool) -> Fluid<2> {
    built::fluid(&format!(
        "[flow]\nmach = 0.5\nreynolds = 20\nreynolds_length = 1.0\nviscosity_law = \"constant\"\n[cloud]\n\
         spacing = 0.0625\njitter = 0.15\n[cloud.domain]\nmin = [0.0, 0.0]\nmax = [1.0, 1.0]\n[scheme]\n\
         conservative = {conservative}\n[boundary]\nx_min = \"held\"\nx_max = \"held\"\ny_min = \"held\"\n\
         y_max = \"held\"\n[time.explicit]\nuntil = 1.0\n"
    ))
}

/// What viscosity adds to the fluxes of every fluid particle for the field `q` in all particles.
fn terms(fluid: &mut Fluid<2>, q: impl Fn(&Vector<2>) -> Primitive<2>) -> Vec<f64> {
    let u = vec![1.0; fluid.len()];
    let frame = fluid.frame(&Instant::still(0.0), &u);
    let mut work = fluid.work();
    work.state.iter_mut().zip(&fluid.discretisation.cloud.x).for_each(|(s, x)| *s = q(x));
    fluid.fill_gradients(&frame, &mut work);
    // beyond the sides the slopes go on
    let first = fluid.discretisation.cloud.n_rows();
    let inner = work.gradient[0];
    work.gradient[first..].fill(inner);
    let fluxes = |fluid: &Fluid<2>| {
        let mut du = vec![0.0; u.len()];
        fluid.fluxes((&frame, &work), &mut du);
        du
    };
    let all = fluxes(fluid);
    let viscous_model = fluid.viscous_model.take();
    let without = fluxes(fluid);
    fluid.viscous_model = viscous_model;
    all.iter().zip(without).map(|(a, b)| a - b).collect()
}

fn largest(du: &[f64]) -> f64 {
    du.iter().fold(0.0, |m, v| m.max(v.abs()))
}

#[test]
fn uniform_flow_and_rigid_rotation_feel_no_stress() {
    for conservative in [false, true] {
        let mut fluid = boxed(conservative);
        let uniform = Primitive { density: 1.0, velocity: Vector([0.3, -0.2]), pressure: 0.8 };
        assert_eq!(largest(&terms(&mut fluid, |_| uniform)), 0.0);
        let spin = |x: &Vector<2>| Primitive { velocity: Vector([-x[1], x[0]]), ..uniform };
        assert!(largest(&terms(&mut fluid, spin)) < 1e-12, "{}", largest(&terms(&mut fluid, spin)));
    }
}

#[test]
fn uniform_shear_moves_nothing_and_heats_by_dissipation() {
    let rate = 0.7;
    let shear = |x: &Vector<2>| Primitive { density: 1.0, velocity: Vector([rate * x[1], 0.0]), pressure: 0.8 };
    for conservative in [false, true] {
        let mut fluid = boxed(conservative);
        let mu = fluid.viscous_model.as_ref().unwrap().medium.viscosity;
        let du = terms(&mut fluid, shear);
        let (mut momentum, mut total, mut volume) = (0.0f64, 0.0, 0.0);
        for (row, v) in du.chunks(4).zip(&fluid.discretisation.cloud.volume) {
            momentum = momentum.max(row[1].abs()).max(row[2].abs());
            (total, volume) = (total + v * row[3], volume + v);
        }
        assert!(momentum < 1e-12, "{momentum}");
        // ∂(u τ)/∂y = μ (∂u/∂y)²
        let heating = total / volume / (mu * rate * rate);
        assert!((heating - 1.0).abs() < 0.02, "{heating}");
    }
}

#[test]
fn the_blocks_are_the_derivative_across_a_face() {
    let gas = Gas { gamma: 1.4 };
    let medium = Newtonian { viscosity: 1.0, sutherland: None, prandtl: 0.72 };
    let q = Primitive { density: 1.2, velocity: Vector([0.3, -0.5, 0.2]), pressure: 0.8 };
    let m = Vector([0.6, 0.0, 0.8]);
    let exchanged = |s: &Primitive<3>| {
        let v = s.velocity + m * (s.velocity.dot(&m) / 3.0);
        let inner = s.pressure / (gas.gamma - 1.0) / s.density;
        [0.0, v[0], v[1], v[2], q.velocity.dot(&v) + gas.gamma / medium.prandtl * inner]
    };
    let mut block = [[0.0; 5]; 5];
    thin_layer(&gas, &medium, &q, &m, &mut block);
    let mut row = [0.0; 5];
    gas.conserved(&q).store(&mut row);
    for k in 0..5 {
        let at = |h: f64| {
            let mut u = row;
            u[k] += h;
            exchanged(&gas.primitive(&Conserved::load(&u)))
        };
        let (a, b) = (at(1e-6), at(-1e-6));
        (0..5).for_each(|r| assert!((block[r][k] - (a[r] - b[r]) / 2e-6).abs() < 1e-8, "{r} {k}"));
    }
}

/// A circle off the axis it turns about; layers when asked for. `particles` is how they move.
fn turning(layers: &str, particles: &str) -> Fluid<2> {
    let fluid = built::fluid(&format!(
        "[flow]\nmach = 0.1\nreynolds = 100\nviscosity_law = \"constant\"\n[[body]]\ncircle = {{ radius = 0.5 }}\n\
         [cloud]\n{layers}\nspacing = 0.05\ndomain = {{ min = [-3.2, -3.2], max = [3.2, 3.2] }}\n\
         [scheme]\nconservative = {}\n",
        layers.is_empty()
    ));
    let law = BodyMotion::about(Vector([0.2, 0.3]), None).with_angle(TimeFunction::Steady(0.4));
    let cloud_motion = match particles {
        "rigid" => CloudMotion::Rigid(law),
        _ => CloudMotion::deforming(&fluid.discretisation.cloud, vec![law], 1.0),
    };
    Fluid { cloud_motion, ..fluid }
}

#[test]
fn gas_that_turns_with_a_wall_does_not_rub_on_it() {
    for layers in ["", "wall_layers = { first = 0.005 }"] {
        for particles in ["rigid", "deforming"] {
            let fluid = turning(layers, particles);
            let (h, t) = (1e-4, 0.7);
            let rate = [Term::of_time(0.5 / h, t + h), Term::of_time(-0.5 / h, t - h)];
            let frame = fluid.frame(&Instant::formula(t, &rate), &vec![1.0; fluid.len()]);
            let mut work = fluid.work();
            let cloud = &frame.discretisation.cloud;
            for (i, q) in work.state.iter_mut().enumerate() {
                let d = frame.place(i) - Vector([0.2, 0.3]);
                let velocity = frame.to_body_axes(&(Vector([d[1], -d[0]]) * 0.4));
                *q = Primitive { density: 1.0, velocity, pressure: 1.0 / 1.4 };
            }
            fluid.fill_gradients(&frame, &mut work);
            let mu = fluid.viscous_model.as_ref().unwrap().medium.viscosity;
            let view = View::new(&fluid, &frame, &work);
            let stress = |w: usize| view.wall_slopes(w).unwrap().stress.norm();
            let worst = (0..cloud.interface.len()).map(stress).fold(0.0, f64::max) / (mu * 0.4);
            assert!(worst < 1e-6, "{layers} {particles}: {worst}");
        }
    }
}
