//! Gas and structures as one system: a piston on a spring, sections that are released, an oscillation that is forced.

use std::sync::Arc;

use crate::common::{direction, product_errors, solver};
use alula::coupling::led::Led;
use alula::coupling::{Attached, Coupled, body_motion};
use alula::math::fourier::{Instances, Series};
use alula::math::multilevel::Cycle;
use alula::scheme::motion_blending::MotionBlending;
use alula::scheme::{CloudMotion, DeformingSurface, Fluid, HasGas};
use alula::structure::limit_cycle::Periodic;
use alula::structure::{Coordinate, ForceHistory, InertiaLaw, Model, PlanarBody, Spring, Structure};
use alula::system::{Instant, Name, System, Term};
use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::harmonic::HarmonicBalance;
use alula::time::relax::Relax;
use alula::time::{Integrator, Memory, Past, Standing};
use num_complex::Complex64;

const CONTROL: Control =
    Control { cfl: 1e3, tolerance: 1e-2, cycle: Cycle { sweeps: 2, visits: 1, levels: 10 }, ..Control::newton(2) };

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
    let system = Coupled::new(fluid, vec![Attached::new(structure, 0, 1.0, 0, Vec::new())]);
    let u = system.start_with(&start);
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
    let mut march = Dual::new(&system, CONTROL, plan, Past::default(), u);
    let damped = omega * f64::sqrt(1.0 - zeta * zeta);
    let (mut worst, mut inner) = (0.0f64, 0);
    while !march.finished() {
        let t = march.advance().unwrap().time;
        inner += march.cost().inner;
        let Standing { frame, work, state: u, .. } = march.standing();
        let x = u[system.unknowns_of(Name::Structure).start];
        let ratio = zeta / f64::sqrt(1.0 - zeta * zeta);
        let exact = x0 * (-zeta * omega * t).exp() * ((damped * t).cos() + ratio * (damped * t).sin());
        worst = worst.max((x - exact).abs() / x0);
        let passed = system.exchange(frame, u, work).unwrap();
        // a piston moves as a whole: what its walls take is what it gets
        assert!((passed.wall_power - passed.power).abs() < 1e-12 * AREA * x0 * omega, "{passed:?}");
    }
    println!("worst {worst}, inner {inner}, linear {}, evaluations {}", march.cost().linear, march.cost().evaluations);
    assert!(worst < 0.02, "{worst}");
}

/// A stream in a box without a body, on a cloud that plunge and pitch of a structure carry along.
fn carried_stream() -> (Coupled<2>, Vec<f64>) {
    let case = "title = \"box\"\ndimension = 2\n[flow]\nmach = 0.6\nalpha = \"7 deg\"\n[cloud]\nspacing = 0.125\njitter = 0.2\n\
        [cloud.domain]\nmin = [0.0, 0.0]\nmax = [1.0, 1.0]\n[scheme]\nconservative = false\n[boundary]\nx_min = \"held\"\n\
        x_max = \"held\"\ny_min = \"held\"\ny_max = \"held\"\n";
    let spring = |name: &str, initial: f64| coordinate(name, 9.0, initial);
    let structure =
        Structure::new(planar(1.0, 0.1, 0.3, [0.3, 0.4]), vec![spring("plunge", 0.1), spring("pitch", 0.2)]);
    coupled(case, structure.unwrap(), true)
}

/// Largest difference of the gas from a uniform stream.
fn strayed(system: &Coupled<2>, u: &[f64], uniform: &[f64]) -> f64 {
    crate::common::largest(system.gas_unknowns().map(|k| u[k] - uniform[k]))
}

#[test]
fn a_stream_stays_uniform_on_a_cloud_that_unknown_coordinates_move() {
    let (system, u) = carried_stream();
    let plan = Plan { until: 1.0, step: 0.05, order: 2, orders: 8.0, iterations: 30, adaptive: None };
    let mut march = Dual::new(&system, CONTROL, plan, Past::default(), u.clone());
    while !march.finished() {
        march.advance().unwrap();
        let now = march.standing().state;
        assert!(strayed(&system, now, &u) < 1e-12);
    }
    // the structure has gone its way: M q'' + K q = 0
    let first = system.unknowns_of(Name::Structure).start;
    assert!((march.standing().state[first] - u[first]).abs() > 0.1);

    // at the instances of a period, whatever the coordinates are
    let balance = HarmonicBalance::new(&system, Instances::of_harmonics(2), 3.0, 1.0);
    let mut all = balance.copies(&u);
    for (k, q) in all[balance.unknowns_of(Name::Structure)].iter_mut().enumerate() {
        *q += 0.1 * (k as f64).sin();
    }
    let (frame, mut work, mut du) =
        (balance.frame(&Instant::still(0.0).with(&balance.placing().values(&all)), &all), balance.work(), all.clone());
    balance.rhs(&frame, &all, &mut work, &mut du);
    let gas = balance.unknowns_of(Name::Gas);
    // fluxes of order one over spacings of a tenth
    assert!(crate::common::largest(du[gas].iter().copied()) < 1e-11);
}

#[test]
fn a_coupled_march_goes_on_to_the_same_bits() {
    let (system, u) = carried_stream();
    let plan = Plan { until: 0.5, step: 0.05, order: 2, orders: 4.0, iterations: 30, adaptive: None };
    let march = |steps: u32, from: (Past, Vec<f64>)| {
        let mut march = Dual::new(&system, CONTROL, plan, from.0, from.1);
        (0..steps).for_each(|_| _ = march.advance().unwrap());
        let Memory::March(past) = march.memory() else { panic!("a march remembers its past") };
        (past, march.standing().state.to_vec())
    };
    let (_, whole) = march(10, (Past::default(), u.clone()));
    for k in 1..10 {
        let part = march(k, (Past::default(), u.clone()));
        assert_eq!(march(10 - k, part).1, whole, "stopped after {k} steps");
    }
}

#[test] // (k − m ω² + A ρ c ω cot(ωL/c)) x̂ = F: a closed tube of length L
fn a_forced_piston_in_a_closed_tube_swings_as_acoustics_have_it() {
    const AREA: f64 = 0.06;
    let (omega, length, mass, spring, force) = (6.0, 1.4, 0.05, 3.0, 1e-4);
    let cosine = ForceHistory::Cosine { amplitude: force, omega, phase: 0.0 };
    let forced = Coordinate { force: cosine, ..coordinate("surge", spring, 0.0) };
    let structure = Structure::new(planar(mass, 0.0, 1.0, [0.0, 0.0]), vec![forced]).unwrap();
    let (system, u) = coupled(TUBE, structure, false);
    let balance = HarmonicBalance::new(&system, Instances::of_harmonics(1), omega, 1.0);
    let all = balance.copies(&u);
    let mut relax = Relax::new(&balance, CONTROL, all.clone(), &all, None);
    while relax.drop() > 1e-6 && relax.iteration < 60 {
        relax.advance().unwrap();
    }
    let q: Vec<f64> = relax.u[balance.unknowns_of(Name::Structure)].chunks_exact(2).map(|pair| pair[0]).collect();
    let series = Series::of_values(&q).unwrap();
    let exact = force / (spring - mass * omega * omega + AREA * omega / (omega * length).tan());
    println!("{:?} of {exact}, {} iterations, {} linear", series.coefficients(), relax.iteration, relax.linear);
    assert!((series.coefficients()[1] / exact - 1.0).abs() < 0.01, "{:?} of {exact}", series.coefficients());
    assert!(series.coefficients()[2].abs() < 0.01 * exact.abs());
}

/// A section on springs, in plunge and pitch, in an uneven flow.
fn sprung_section(keys: &str, rigid: bool) -> (Coupled<2>, Vec<f64>) {
    let case = format!(
        "[flow]\nmach = 0.6\nalpha = \"2 deg\"\n{keys}\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n\
         domain = {{ min = [-3.2, -3.2], max = [3.2, 3.2] }}\n[scheme]\nlimiter = \"none\"\nflux = \"rusanov\"\n"
    );
    let coordinates = vec![coordinate("plunge", 0.3, 0.05), coordinate("pitch", 0.2, 0.1)];
    let structure = Structure::new(planar(2.0, 0.3, 0.5, [0.3, 0.0]), coordinates).unwrap();
    let (system, mut u) = coupled(&case, structure, rigid);
    let gas = system.unknowns_of(Name::Gas);
    for (row, x) in u[gas].chunks_mut(4).zip(&system.fluid().discretisation.cloud.x) {
        let wave = 0.1 * (3.0 * x[0]).sin() * (2.0 * x[1]).cos();
        row.iter_mut().zip([1.0, -1.0, 1.0, 0.5]).for_each(|(u, part)| *u *= 1.0 + part * wave);
    }
    for (k, q) in u[system.unknowns_of(Name::Structure)].iter_mut().enumerate() {
        *q += 0.03 * (k as f64 + 1.0);
    }
    (system, u)
}

/// Largest errors of products with dR/dU in a step of a march, in gas and structure, where coordinates change and where they stay.
fn errors_of_step(keys: &str, rigid: bool) -> [[f64; 2]; 2] {
    let (system, u) = sprung_section(keys, rigid);
    let old = [0.02, 0.0, 0.07, 0.0];
    let place = |q: &[f64], frame: &mut _| {
        let terms = [(5.0, 0.2, q), (-5.0, 0.0, &old)];
        let terms = terms.map(|(coefficient, time, coordinates)| Term { coefficient, time, coordinates });
        system.place(&Instant::formula(0.2, &terms).with(q), frame);
    };
    [true, false].map(|moves| {
        let mut v = direction(&u);
        if !moves {
            v[system.unknowns_of(Name::Structure)].fill(0.0);
        }
        let all = product_errors(&system, [&u, &v], &place);
        [all[0].1, all[1].1]
    })
}

#[test]
fn products_with_a_section_on_springs_are_those_of_the_residual() {
    for keys in ["", "reynolds = 1e3"] {
        for rigid in [true, false] {
            for found in errors_of_step(keys, rigid).as_flattened() {
                assert!(*found < 1e-6, "{keys} {rigid} {found:.1e}");
            }
        }
    }
    // on the way to rest
    let (system, u) = sprung_section("", true);
    let place = |q: &[f64], frame: &mut _| system.place(&Instant::still(0.0).with(q), frame);
    for (name, found) in product_errors(&system, [&u, &direction(&u)], &place) {
        assert!(found < 1e-6, "{name:?} {found:.1e}");
    }
}

#[test]
fn products_of_a_period_are_those_of_the_residual() {
    let (system, u) = sprung_section("", true);
    let motion = Periodic { mean: vec![0.0; 2], harmonics: vec![vec![Complex64::new(0.05, 0.02); 2]] };
    let led = Led::new(&system, &u, &motion, 0.4);
    errors_of_period(&HarmonicBalance::new(&system, Instances::of_harmonics(1), 0.4, 2.0), &u);
    errors_of_period(&HarmonicBalance::new(&led, Instances::of_harmonics(1), 0.4, 1.0), &u);
}

fn errors_of_period<S: System>(balance: &HarmonicBalance<'_, S>, u: &[f64]) {
    let mut all = balance.copies(u);
    all.iter_mut().enumerate().for_each(|(k, u)| *u *= 1.0 + 1e-3 * (0.3 * k as f64).sin());
    let place = |q: &[f64], frame: &mut _| balance.place(&Instant::still(0.0).with(q), frame);
    for (name, found) in product_errors(balance, [&all, &direction(&all)], &place) {
        assert!(found < 1e-6, "{name:?} {found:.1e}");
    }
}
