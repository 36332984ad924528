//! What must hold in harmonic balance: exact fields on moving clouds, exact solutions of ordinary equations.

use std::sync::Arc;

use crate::common::{largest, oscillator, solver};
use alula::math::Vector;
use alula::math::fourier::{Instances, Series};
use alula::math::jet::Jet;
use alula::math::multilevel::Cycle;
use alula::motion::{BodyMotion, TimeFunction};
use alula::physics::Primitive;
use alula::scheme::discretisation::{Path, Places};
use alula::scheme::{CloudMotion, Fluid};
use alula::system::{Instant, System};
use alula::time::control::{Control, Method};
use alula::time::harmonic::HarmonicBalance;
use alula::time::relax::Relax;

/// Round-off of fluxes of order one, in changes of the state within one local time.
const ROUND_OFF: f64 = 1e-12;

fn boxed<const D: usize>() -> Fluid<D> {
    let list = |v: f64| vec![v.to_string(); D].join(", ");
    let sides: String =
        ["x", "y", "z"][..D].iter().map(|a| format!("{a}_min = \"held\"\n{a}_max = \"held\"\n")).collect();
    let case = format!(
        "title = \"box\"\ndimension = {D}\n[flow]\nmach = 0.6\nalpha = \"7 deg\"\n[cloud]\nspacing = 0.125\n\
         jitter = 0.2\n[cloud.domain]\nmin = [{}]\nmax = [{}]\n[scheme]\nconservative = false\n[boundary]\n{sides}",
        list(0.0),
        list(1.0),
    );
    solver::<D>(&case).0
}

/// Displacement by a wave, up to 10 % of the box, of frequency 4.
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

fn pitching<const D: usize>() -> CloudMotion<D> {
    let sine = TimeFunction::Sine { amplitude: 0.5, omega: 4.0, phase: 0.3 };
    CloudMotion::Rigid(BodyMotion::about(Vector::splat(0.4), None).with_angle(sine))
}

/// Largest residual of a field that does not change in time, scaled by local times.
fn residual<const D: usize>(
    cloud_motion: CloudMotion<D>,
    field: Arc<dyn Fn(&Vector<D>) -> Primitive<D> + Send + Sync>,
    (harmonics, oversample): (usize, f64),
) -> f64 {
    let held = Arc::clone(&field) as alula::scheme::start::Field<D>;
    let fluid = Fluid { cloud_motion, held, ..boxed::<D>() };
    let balance = HarmonicBalance::new(&fluid, Instances::of_harmonics(harmonics), 4.0, oversample);
    let (b, count) = (D + 2, 2 * harmonics + 1);
    let mut u = vec![1.0; balance.len()];
    let exact = HarmonicBalance::new(&fluid, Instances::of_harmonics(harmonics), 4.0, 1.0);
    let frames = exact.frame(&Instant::still(0.0), &u);
    for (i, row) in u.chunks_exact_mut(b * count).enumerate() {
        for (frame, row) in frames.iter().zip(row.chunks_exact_mut(b)) {
            fluid.gas.conserved(&field(&frame.place(i))).store(row);
        }
    }
    let frame = balance.frame(&Instant::still(0.0), &u);
    let (mut work, mut du, mut rate) =
        (balance.work(), vec![0.0; u.len()], vec![0.0; fluid.discretisation.cloud.n_fluid]);
    balance.rhs(&frame, &u, &mut work, &mut du);
    balance.rates(&frame, &u, &mut work, &mut rate);
    largest(du.iter().enumerate().map(|(k, r)| r / rate[k / (b * count)]))
}

fn uniform<const D: usize>(cloud_motion: CloudMotion<D>, how: (usize, f64)) -> f64 {
    residual(cloud_motion, boxed::<D>().held, how)
}

fn layered<const D: usize>(cloud_motion: CloudMotion<D>, how: (usize, f64)) -> f64 {
    let field = |x: &Vector<D>| {
        let density = 2.0 + (0..D).map(|d| (0.3 + 0.1 * d as f64) * x[d]).sum::<f64>();
        Primitive { density, velocity: Vector::ZERO, pressure: 1.0 / 1.4 }
    };
    residual(cloud_motion, Arc::new(field), how)
}

fn wave<const D: usize>() -> CloudMotion<D> {
    CloudMotion::Along { path: Arc::new(Wave), laws: Vec::new(), deforming_surface: Arc::default() }
}

#[test] // eq32
fn uniform_and_linear_fields_stay_on_moving_clouds() {
    for n in [1, 2, 5] {
        let all = [
            [uniform(wave::<2>(), (n, 1.0)), uniform(pitching::<2>(), (n, 1.0))],
            [uniform(wave::<3>(), (n, 1.0)), uniform(pitching::<3>(), (n, 1.0))],
            [layered(wave::<2>(), (n, 1.0)), layered(pitching::<2>(), (n, 1.0))],
            [layered(wave::<3>(), (n, 1.0)), layered(pitching::<3>(), (n, 1.0))],
            // oversampling keeps a linear field where positions have no more harmonics than the state
            [uniform(wave::<2>(), (n, 1.5)), uniform(pitching::<2>(), (n, 2.0))],
            [layered(wave::<2>(), (n, 1.5)), layered(wave::<2>(), (n, 2.0))],
        ];
        assert!(all.as_flattened().iter().all(|e| *e <= ROUND_OFF), "{n} harmonics: {all:?}");
    }
}

/// Solves F(x) = 0 by Newton's method with differences; `None` unless it converges.
fn newton(mut x: Vec<f64>, f: impl Fn(&[f64]) -> Vec<f64>) -> Option<Vec<f64>> {
    let n = x.len();
    for _ in 0..60 {
        let r = f(&x);
        if largest(r.iter().copied()) < 1e-13 {
            return Some(x);
        }
        let mut a: Vec<Vec<f64>> = vec![vec![0.0; n + 1]; n];
        for k in 0..n {
            let (mut up, mut down) = (x.clone(), x.clone());
            (up[k], down[k]) = (x[k] + 1e-6, x[k] - 1e-6);
            let (up, down) = (f(&up), f(&down));
            (0..n).for_each(|i| a[i][k] = (up[i] - down[i]) / 2e-6);
        }
        (0..n).for_each(|i| a[i][n] = -r[i]);
        for p in 0..n {
            let pivot = (p..n).max_by(|i, j| a[*i][p].abs().total_cmp(&a[*j][p].abs()))?;
            a.swap(p, pivot);
            for i in 0..n {
                if i != p {
                    let factor = a[i][p] / a[p][p];
                    let row = a[p].clone();
                    a[i].iter_mut().zip(&row).for_each(|(v, w)| *v -= factor * w);
                }
            }
        }
        let step: Vec<f64> = (0..n).map(|p| a[p][n] / a[p][p]).collect();
        let size = largest(step.iter().copied());
        let shorter = if size > 1.0 { 1.0 / size } else { 1.0 };
        x.iter_mut().zip(&step).for_each(|(x, s)| *x += shorter * s);
        if !size.is_finite() || largest(x.iter().copied()) > 50.0 {
            return None;
        }
    }
    (largest(f(&x)) < 1e-11).then_some(x)
}

fn equations<S: System>(balance: &HarmonicBalance<'_, S>, u: &[f64]) -> Vec<f64> {
    let frame = balance.frame(&Instant::still(0.0), u);
    let mut du = vec![0.0; u.len()];
    balance.rhs(&frame, u, &mut balance.work(), &mut du);
    du
}

#[test]
fn limit_cycle_of_van_der_pol() {
    // `reference/harmonics/vanderpol_lco.csv`: 8th-order Runge-Kutta, tolerance 1e-13
    for (mu, omega, greatest, harmonics) in
        [(0.1, 0.999_375_553_424, 2.000_103_979_872, 11), (1.0, 0.942_955_847_442, 2.008_619_860_875, 31)]
    {
        let system = oscillator(move |x: f64, v: f64, _: f64| mu * (1.0 - x * x) * v - x);
        let instances = Instances::of_harmonics(harmonics);
        let count = instances.count();
        // unknowns: state, and the frequency in place of the velocity at the first instance, which fixes the phase
        let split = |y: &[f64]| {
            let mut u = y.to_vec();
            u[0] = 0.0;
            (u, y[0])
        };
        let mut start: Vec<f64> = (0..count)
            .flat_map(|n| {
                let phase = std::f64::consts::TAU * n as f64 / count as f64;
                [-2.0 * phase.sin(), 2.0 * phase.cos()]
            })
            .collect();
        start[0] = 1.0;
        let found = newton(start, |y| {
            let (u, omega) = split(y);
            equations(&HarmonicBalance::new(&system, instances, omega, 1.0), &u)
        });
        let (u, found) = split(&found.unwrap());
        assert!((found - omega).abs() < 1e-10, "mu {mu}: {found} {omega}");
        let x = Series::of_values(&u.chunks_exact(2).map(|u| u[1]).collect::<Vec<f64>>()).unwrap();
        let highest = (0..20_000).map(|k| x.at(f64::from(k) * std::f64::consts::TAU / 2e4)).fold(0.0, f64::max);
        assert!((highest - greatest).abs() < 1e-6, "mu {mu}: {highest}");
    }
}

/// Distinct first harmonics |h1| that Newton's method finds from many starts.
fn roots(omega: f64, harmonics: usize, oversample: f64) -> Vec<f64> {
    let system = oscillator(move |x: f64, v: f64, t: f64| -0.1 * v - x - x.powi(3) + 0.3 * (omega * t).cos());
    let balance = HarmonicBalance::new(&system, Instances::of_harmonics(harmonics), omega, oversample);
    let mut found: Vec<f64> = Vec::new();
    let mut seed = 1u64;
    let mut random = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    for _ in 0..120 {
        let (cosine, sine) = (3.0 * random(), 3.0 * random());
        let instance = |n: usize| {
            let (s, c) = (std::f64::consts::TAU * n as f64 / (2 * harmonics + 1) as f64).sin_cos();
            [omega * (sine * c - cosine * s), cosine * c + sine * s]
        };
        let smooth = (0..=2 * harmonics).flat_map(instance);
        let start: Vec<f64> = smooth.map(|v| v + random()).collect();
        let Some(u) = newton(start, |u| equations(&balance, u)) else { continue };
        let x = Series::of_values(&u.chunks_exact(2).map(|u| u[1]).collect::<Vec<f64>>()).unwrap();
        let first = x.coefficients()[1].hypot(x.coefficients()[1 + harmonics]);
        if !found.iter().any(|f| (f - first).abs() < 1e-5) {
            found.push(first);
        }
    }
    found.sort_by(f64::total_cmp);
    found
}

#[test]
fn oversampling_leaves_the_roots_of_duffing_that_exist() {
    // `reference/harmonics/duffing_forced.csv`: one solution at 0.8, three at 1.4
    let one = roots(0.8, 3, 2.0);
    assert!(one.len() == 1 && (one[0] - 0.522_747_657_4).abs() < 1e-4, "{one:?}");
    let three = roots(1.4, 3, 2.0);
    let exact = [0.339_071_509, 0.940_731_201, 1.226_777_716];
    assert!(three.len() == 3 && three.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-3), "{three:?}");
    assert!(roots(0.8, 2, 1.0).len() > 1, "without it products of harmonics are mistaken for others");
}

#[test]
fn relaxation_finds_the_forced_oscillation() {
    let system = oscillator(|x: f64, v: f64, t: f64| -1.5 * v - x - x.powi(3) + 0.3 * (0.8 * t).cos());
    for (method, harmonics) in [(Method::NewtonKrylov, 1), (Method::NewtonKrylov, 5), (Method::RungeKutta, 3)] {
        let balance = HarmonicBalance::new(&system, Instances::of_harmonics(harmonics), 0.8, 2.0);
        let cycle = Cycle { sweeps: 2, visits: 1, levels: 1 };
        let control = Control { method, tolerance: 0.01, basis: 20, cycle, ..Control::newton(2) };
        let start = vec![0.0; balance.len()];
        let mut relax = Relax::new(&balance, control, start.clone(), &vec![0.1; balance.len()], None);
        while relax.drop() > 1e-8 {
            assert!(relax.iteration < 20_000, "{method:?} {harmonics}: {:e}", relax.drop());
            relax.advance().unwrap();
        }
        let exact = newton(start, |u| equations(&balance, u)).unwrap();
        let miss = largest(relax.u.iter().zip(&exact).map(|(a, b)| a - b));
        assert!(miss < 1e-6, "{method:?} {harmonics}: {miss:e}");
    }
}

#[test]
fn states_move_between_numbers_of_harmonics() {
    let system = oscillator(|_: f64, _: f64, _: f64| 0.0);
    let build = |n: usize| HarmonicBalance::new(&system, Instances::of_harmonics(n), 1.0, 1.0);
    let few: Vec<f64> = (0..10).map(|k| f64::from(k * k).sin()).collect();
    let many = build(5).resampled(&few, Instances::of_harmonics(2));
    let back = build(2).resampled(&many, Instances::of_harmonics(5));
    assert!(few.iter().zip(&back).all(|(a, b)| (a - b).abs() < 1e-14));
    let mut middle = [[0.0; 2]; 2];
    build(5).at_phase(&many, 1.234, &mut middle[0]);
    build(2).at_phase(&few, 1.234, &mut middle[1]);
    assert!((0..2).all(|k| (middle[0][k] - middle[1][k]).abs() < 1e-14), "{middle:?}");
    assert_eq!(build(3).copies(&[1.0, 2.0]), [1.0, 2.0].repeat(7));
}

/// A small section that pitches, by harmonic balance.
fn section(harmonics: &str) -> alula::case::Case {
    crate::common::case(&format!(
        "title = \"section\"\n[flow]\nmach = 0.4\n[[body]]\nnaca = \"0012\"\n[motion]\nparticles = \"rigid\"\n\
         pivot = [0.25, 0.0]\npitch = \"1 deg\"\nreduced_frequency = 0.3\n[cloud]\nspacing = 0.06\nfar_field = 8.0\n\
         edge_levels = 1\n[time]\nharmonics = {harmonics}\n[output]\nreport = false\n"
    ))
}

/// Stops after a number of iterations.
struct After(u64, std::cell::Cell<u64>);
impl alula::run::Monitor for After {
    fn tick(&mut self, _: &alula::run::Tick) {
        self.1.set(self.1.get() + 1);
    }
    fn note(&mut self, _: &str) {}
    fn stop(&self) -> bool {
        self.1.get() >= self.0
    }
}

fn places(root: &std::path::Path, name: &str) -> alula::run::Places {
    alula::run::Places { input: root.to_path_buf(), out: root.join(name) }
}

#[test]
fn a_balance_goes_on_from_an_interruption_from_another_one_and_from_a_march() {
    let root = tempfile::tempdir().unwrap();
    let whole = summary(&section("2"), &places(root.path(), "whole"));
    assert!(whole.succeeded() && whole.periodic.first_harmonics[0].cl[0] > 3.0, "{whole:?}");
    goes_on_to_the_same_bits(root.path(), &whole);
    goes_on_with_other_harmonics(root.path(), &whole);
    begins_with_a_march(root.path(), &whole);
}

/// An interrupted balance against one that was not.
fn goes_on_to_the_same_bits(root: &std::path::Path, whole: &alula::run::Summary) {
    let stopped = &mut After(whole.convergence.iterations - 2, std::cell::Cell::new(0));
    alula::run::run(&section("2"), &places(root, "cut"), stopped).unwrap();
    alula::run::resume(&root.join("cut"), &mut alula::run::Silent).unwrap();
    let read = |name: &str, file: &str| std::fs::read(root.join(name).join(file)).unwrap();
    for file in ["harmonics.json", "surface_harmonics.csv", "instances.csv", "field_harmonics.vtu"] {
        assert_eq!(read("whole", file), read("cut", file), "{file}");
    }
}

fn goes_on_with_other_harmonics(root: &std::path::Path, whole: &alula::run::Summary) {
    let from = root.join("whole");
    let more = alula::run::run_from(&section("3"), &places(root, "more"), &from, &mut alula::run::Silent).unwrap();
    let alula::run::Outcome::Finished(more) = more else { panic!("interrupted") };
    let change = more.periodic.first_harmonics[0].cl[0] - whole.periodic.first_harmonics[0].cl[0];
    assert!(more.succeeded() && change.abs() < 0.01, "{change}");
    let mut other = section("1");
    other.cloud.spacing = Some(alula::case::Length(0.05));
    let refused = alula::run::run_from(&other, &places(root, "x"), &from, &mut alula::run::Silent).unwrap_err();
    assert!(refused.to_string().contains("`[cloud]` differ"), "{refused}");
}

/// The summary of a finished run.
fn summary(case: &alula::case::Case, at: &alula::run::Places) -> alula::run::Summary {
    match alula::run::run(case, at, &mut alula::run::Silent).unwrap() {
        alula::run::Outcome::Finished(summary) => *summary,
        other => panic!("{other:?}"),
    }
}

/// Stops at the first note of a march.
struct AtMarch(std::cell::Cell<bool>);
impl alula::run::Monitor for AtMarch {
    fn tick(&mut self, _: &alula::run::Tick) {}
    fn note(&mut self, note: &str) {
        self.0.set(self.0.get() || note.contains("marched first"));
    }
    fn stop(&self) -> bool {
        self.0.get()
    }
}

/// A balance that begins with a march, interrupted or not, against one that does not.
fn begins_with_a_march(root: &std::path::Path, direct: &alula::run::Summary) {
    let case = section("{ number = 2, march = 1 }");
    let marched = summary(&case, &places(root, "marched"));
    let lift = |s: &alula::run::Summary| s.periodic.first_harmonics[0].cl;
    let change = (0..2).map(|k| (lift(&marched)[k] - lift(direct)[k]).abs()).fold(0.0, f64::max);
    assert!(marched.succeeded() && change < 2e-3, "{change}");
    alula::run::run(&case, &places(root, "march cut"), &mut AtMarch(false.into())).unwrap();
    alula::run::resume(&root.join("march cut"), &mut alula::run::Silent).unwrap();
    let read = |name: &str| std::fs::read(root.join(name).join("instances.csv")).unwrap();
    assert!(read("marched") == read("march cut"), "a march that was interrupted ends elsewhere");
}

#[test]
fn a_march_from_the_balance_stays_with_it() {
    let root = tempfile::tempdir().unwrap();
    let found = summary(&section("{ number = 2, check = 1 }"), &places(root.path(), "out"));
    let after = found.periodic.harmonic_balance.and_then(|b| b.march).unwrap();
    let lift = after.cl.unwrap();
    assert_eq!((after.periods, after.unconverged), (1, 0));
    assert!(lift.first_harmonic < 3e-3 && lift.mean.abs() < 1e-3, "{lift:?}");
    // the drag of a section without mean lift has twice the frequency of the motion
    assert!(after.cd.is_none() && after.cm.is_some());
}

#[test]
fn a_wave_leaves_through_the_end_of_a_tube() {
    let text = "title = \"piston\"\ndimension = 2\n[flow]\nmach = 1.0\nisentropic = true\n[[body]]\nbox = { size = [0.5, 1.0] }\n\
                translate = [-0.25, 0.0]\n[motion]\nperiod = 1.0\nformula = { x = \"0.1/omega*(1-cos(omega*t))\" }\n[reference]\n\
                chord = 0.12\n[cloud]\nspacing = 0.02\ndomain = { min = [-0.4, -0.06], max = [0.5, 0.06] }\n[[cloud.box]]\n\
                min = [-0.4, -0.06]\nmax = [0.5, 0.06]\nspacing = 0.02\n[boundary]\nx_min = \"symmetry\"\nx_max = \"held\"\n\
                y_min = \"symmetry\"\ny_max = \"symmetry\"\n[initial.riemann]\nleft = [1.0, 0.0, 0.7142857142857143]\n\
                right = [1.0, 0.0, 0.7142857142857143]\nposition = 10.0\n[scheme]\nlimiter = \"none\"\nkappa = 0.3333\n\
                [time.harmonics]\nnumber = 3\noversample = 1.5\n[output]\nreport = false\n";
    let root = tempfile::tempdir().unwrap();
    let found = summary(&crate::common::case(text), &places(root.path(), "tube"));
    // the exact simple wave: 2 · 0.1402100/γ over the displacement 0.1/2π, behind it by 90°
    let [re, im] = found.periodic.first_harmonics[0].cd;
    assert!(found.succeeded() && (im / -12.58523 - 1.0).abs() < 0.005 && re.abs() < 0.1, "{re} {im}");
    let hot = text.replace("right = [1.0, 0.0, 0.7142857142857143]", "right = [0.9, 0.0, 0.7142857142857143]");
    let hot = hot.replace("position = 10.0", "position = 0.3");
    let told = crate::common::refused(&crate::common::case(&hot));
    assert!(told.contains("the entropy"), "{told}");
}

#[test]
fn what_is_not_periodic_is_refused() {
    let told = |text: &str, expected: &str| {
        let problem = alula::case::read(text, "case.toml").unwrap_err().to_string();
        assert!(problem.contains(expected), "{problem}");
    };
    let head =
        "[flow]\nmach = 0.4\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[time]\nharmonics = 2\n[motion]\n";
    told(&format!("{head}translation = [1, 0]\n"), "needs a periodic motion");
    told(&format!("{head}plunge = 0.1\nperiod = 3\nparticles = \"lagrangian\"\n"), "never come back");
    told(&format!("{head}plunge = 0.1\nperiod = 3\nreduced_frequency = 0.1\n"), "given twice");
    told(
        "[flow]\nmach = 0.4\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.1\n[time]\nharmonics = 0\n",
        "from 1 to 16",
    );
    let fading =
        crate::common::case(&format!("{head}period = 3\nformula = {{ y = \"0.1*sin(omega*t)*exp(-t/9)\" }}\n"));
    let problem = crate::common::refused(&fading);
    assert!(problem.contains("does not repeat"), "{problem}");
}
