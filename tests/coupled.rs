//! Gas and structures as one system: a piston on a spring, sections that are released, an oscillation that is forced.
#![allow(clippy::unwrap_used, reason = "a test may stop anywhere")]

mod common;

use std::sync::Arc;

use alula::coupling::{Attached, Coupled, body_motion};
use alula::math::multilevel::Cycle;
use alula::scheme::motion_blending::MotionBlending;
use alula::scheme::{CloudMotion, DeformingSurface, Fluid};
use alula::structure::{Coordinate, InertiaLaw, Model, PlanarBody, Spring, Structure};
use alula::system::System;
use alula::time::control::{Control, Method};
use alula::time::dual::{Dual, Plan};
use alula::time::{March, Past};
use common::solver;

const CONTROL: Control = Control {
    method: Method::NewtonKrylov,
    cfl: 1e3,
    cfl_max: 1e6,
    growth: 2.0,
    tolerance: 1e-2,
    basis: 30,
    group: 4,
    cycle: Cycle { sweeps: 2, visits: 1, levels: 10 },
};

fn coordinate(name: &str, spring: f64, initial: f64) -> Coordinate {
    Coordinate { name: name.into(), spring: Spring::linear(spring), initial, ..Coordinate::default() }
}

/// A rigid body in the plane.
fn planar(mass: f64, static_moment: f64, inertia: f64, pivot: [f64; 2]) -> Model {
    let static_moment = [static_moment, 0.0];
    Model::Planar(PlanarBody {
        pivot,
        mass,
        static_moment,
        inertia,
        flap: None,
        gravity: [0.0; 2],
        law: InertiaLaw::Exact,
    })
}

/// The gas of a case around its first body, which `structure` carries; the cloud follows rigidly, or deforms.
fn coupled(case: &str, structure: Structure<2>, rigid: bool) -> (Coupled<2>, Vec<f64>) {
    let (fluid, start) = solver::<2>(case);
    let law = body_motion(&structure, 0, &[]);
    let cloud = &fluid.discretisation.cloud;
    let cloud_motion = match rigid {
        true => CloudMotion::Rigid(law),
        false => {
            let laws = vec![law];
            let deforming_surface = Arc::new(DeformingSurface::new(cloud, &laws));
            CloudMotion::Along { path: Arc::new(MotionBlending::new(cloud, &laws, 0.0)), laws, deforming_surface }
        }
    };
    let fluid = Fluid { cloud_motion, ..fluid };
    let system = Coupled::new(fluid, vec![Attached::new(structure, (0, 1.0), 0, Vec::new())]);
    let u = system.start(&start);
    (system, u)
}

/// Piston in the left end of a tube of gas at rest, ρ = c = 1.
const TUBE: &str = "title = \"piston\"\ndimension = 2\n[flow]\nmach = 1.0\n[[body]]\nname = \"piston\"\n\
    box = { size = [0.5, 1.0] }\ntranslate = [-0.25, 0.0]\n[reference]\nchord = 0.06\n[cloud]\nspacing = 0.01\n\
    domain = { min = [-0.4, -0.03], max = [1.4, 0.03] }\n[[cloud.box]]\nmin = [-0.4, -0.03]\nmax = [1.4, 0.03]\n\
    spacing = 0.01\n[boundary]\nx_min = \"symmetry\"\nx_max = \"symmetry\"\ny_min = \"symmetry\"\ny_max = \"symmetry\"\n\
    [initial.riemann]\nleft = [1.0, 0.0, 0.7142857142857143]\nright = [1.0, 0.0, 0.7142857142857143]\nposition = 10.0\n";

#[test] // `reference/piston`: m x'' + ρ c A x' + k x = 0
fn a_piston_on_a_spring_radiates_sound() {
    const AREA: f64 = 0.06;
    let (omega, zeta, x0) = (20.0, 0.029_580_4, 1e-4);
    let mass = AREA / (2.0 * omega * zeta);
    let structure =
        Structure::new(planar(mass, 0.0, 1.0, [0.0, 0.0]), vec![coordinate("surge", mass * omega * omega, x0)])
            .unwrap();
    let (system, u) = coupled(TUBE, structure, false);
    let period = std::f64::consts::TAU / omega;
    let plan =
        Plan { until: 4.0 * period, step: period / 128.0, order: 2, orders: 4.0, iterations: 20, adaptive: None };
    let mut march = Dual::new(&system, CONTROL, plan, (Past::default(), u));
    let damped = omega * f64::sqrt(1.0 - zeta * zeta);
    let (mut worst, mut inner) = (0.0f64, 0);
    while !march.finished() {
        let t = march.advance().unwrap().time;
        inner += march.inner();
        let (frame, work, u) = march.parts();
        let x = u[system.placing().start];
        let ratio = zeta / f64::sqrt(1.0 - zeta * zeta);
        let exact = x0 * (-zeta * omega * t).exp() * ((damped * t).cos() + ratio * (damped * t).sin());
        worst = worst.max((x - exact).abs() / x0);
        let passed = system.exchange(frame, u, work);
        assert!((passed.wall_power - passed.power).abs() < 1e-3 * (x0 * omega).powi(2), "{passed:?}");
    }
    println!("worst {worst}, inner {inner}, linear {}, evaluations {}", march.linear(), march.evaluations());
    assert!(worst < 0.02, "{worst}");
}
