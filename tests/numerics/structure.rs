//! Structures alone, marched and by harmonic balance, with the integrators that the gas has.

use alula::math::fourier::{Instances, Series};
use alula::math::multilevel::Cycle;
use alula::structure::{Coordinate, ForceHistory, InertiaLaw, Model, PlanarBody, Spring, Structure};
use alula::system::{Instant, System};
use alula::time::control::Control;
use alula::time::dual::{Dual, Plan};
use alula::time::harmonic::HarmonicBalance;
use alula::time::ordinary::Ordinary;
use alula::time::relax::Relax;
use alula::time::{Integrator, Past};

/// The equations of a structure without surroundings, u = [q, q'].
fn alone(structure: &Structure<2>) -> Ordinary<impl Fn(f64, &[f64], &mut [f64]) + Sync> {
    let still = vec![0.0; structure.len()];
    Ordinary::new(2 * structure.len(), 2.0, move |t, u, du| du.copy_from_slice(&structure.rates(t, u, &still)))
}

fn oscillator(spring: Spring, damping: f64, force: ForceHistory) -> Structure<2> {
    let coordinate = Coordinate { name: "x".into(), spring, damping, force, ..Coordinate::default() };
    Structure::new(Model::Modal(vec![("x".into(), 1.0)]), vec![coordinate]).unwrap()
}

/// A section with unbalance, springs and dampers; `play` on its pitch.
fn section(play: f64, law: InertiaLaw) -> Structure<2> {
    let body = PlanarBody {
        pivot: [0.0; 2],
        mass: 1.0,
        static_moment: [0.25, 0.0],
        inertia: 0.4,
        flap: None,
        gravity: [0.0; 2],
        law,
    };
    let named =
        |name: &str, spring: Spring| Coordinate { name: name.into(), spring, damping: 0.02, ..Coordinate::default() };
    let pitch = Spring { stiffness: 0.5, cubic: 1.0, play, rest: 0.0 };
    let all = vec![named("plunge", Spring::linear(0.3)), named("pitch", pitch)];
    Structure::new(Model::Planar(body), all).unwrap()
}

const CONTROL: Control = Control {
    cfl: 1e6,
    cfl_max: 1e9,
    tolerance: 1e-4,
    basis: 12,
    cycle: Cycle { sweeps: 2, visits: 1, levels: 1 },
    ..Control::newton(2)
};

/// The state at time `until` after steps of one length by the formula of second order.
fn march(structure: &Structure<2>, start: &[f64], until: f64, steps: u32) -> Vec<f64> {
    let plan = Plan { until, step: until / f64::from(steps), order: 2, orders: 9.0, iterations: 40, adaptive: None };
    let system = alone(structure);
    let mut march = Dual::new(&system, CONTROL, plan, Past::default(), start.to_vec());
    while !march.finished() {
        march.advance().unwrap();
    }
    assert_eq!(march.mark().iteration, steps);
    march.standing().state.to_vec()
}

/// Classical Runge-Kutta.
fn reference(structure: &Structure<2>, start: &[f64], until: f64, steps: usize) -> Vec<f64> {
    let (dt, none, mut u) = (until / steps as f64, vec![0.0; structure.len()], start.to_vec());
    let along = |u: &[f64], k: &[f64], f: f64| u.iter().zip(k).map(|(u, k)| u + f * k).collect::<Vec<f64>>();
    for n in 0..steps {
        let t = n as f64 * dt;
        let a = structure.rates(t, &u, &none);
        let b = structure.rates(t + 0.5 * dt, &along(&u, &a, 0.5 * dt), &none);
        let c = structure.rates(t + 0.5 * dt, &along(&u, &b, 0.5 * dt), &none);
        let d = structure.rates(t + dt, &along(&u, &c, dt), &none);
        (0..u.len()).for_each(|k| u[k] += dt / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]));
    }
    u
}

fn miss(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()))
}

/// Error at three steps: of second order, and its Richardson extrapolate far below.
fn assert_second_order(
    structure: &Structure<2>,
    start: &[f64],
    (until, steps): (f64, u32),
    exact: &[f64],
    extrapolated: f64,
) {
    let found: Vec<Vec<f64>> = [1, 2, 4].iter().map(|f| march(structure, start, until, f * steps)).collect();
    let errors: Vec<f64> = found.iter().map(|u| miss(u, exact)).collect();
    let order = (errors[1] / errors[2]).log2();
    assert!((1.9..2.1).contains(&order), "order {order}, errors {errors:?}");
    let best: Vec<f64> = found[2].iter().zip(&found[1]).map(|(fine, coarse)| (4.0 * fine - coarse) / 3.0).collect();
    assert!(miss(&best, exact) < extrapolated, "{:e}", miss(&best, exact));
}

#[test]
fn free_and_forced_oscillations_are_marched_at_second_order() {
    let (k, c, f, w): (f64, f64, f64, f64) = (4.0, 0.2, 0.7, 1.3);
    let free = oscillator(Spring::linear(k), c, ForceHistory::Zero);
    let (decay, t) = (0.5 * c, 5.0);
    let wd = (k - decay * decay).sqrt();
    let (s, co) = (wd * t).sin_cos();
    let shrunk = (-decay * t).exp();
    let exact = [shrunk * (co + decay / wd * s), -shrunk * s * (decay * decay / wd + wd)];
    assert_second_order(&free, &[1.0, 0.0], (t, 500), &exact, 1e-5);
    let force = ForceHistory::Cosine { amplitude: f, omega: w, phase: 0.0 };
    let forced = oscillator(Spring::linear(k), c, force);
    let (a, b) = (k - w * w, c * w);
    let (gain, lag) = (f / a.hypot(b), b.atan2(a));
    let at = |t: f64| [gain * (w * t - lag).cos(), -w * gain * (w * t - lag).sin()];
    assert_second_order(&forced, &at(0.0), (t, 500), &at(t), 1e-5);
}

#[test]
fn play_cubic_springs_and_large_angles_are_marched_at_second_order() {
    let start = [0.1, 0.3, 0.0, -0.2];
    for (structure, best) in [
        (section(0.0, InertiaLaw::Linear), 1e-5),
        (section(0.0, InertiaLaw::Exact), 1e-5),
        (section(0.05, InertiaLaw::Exact), 1e-4),
    ] {
        let exact = reference(&structure, &start, 8.0, 64_000);
        assert_second_order(&structure, &start, (8.0, 800), &exact, best);
    }
}

/// States of all instances of a period, from those at each phase.
fn sampled(harmonics: usize, start: impl Fn(f64) -> Vec<f64>) -> Vec<f64> {
    let count = 2 * harmonics + 1;
    (0..count).flat_map(|n| start(std::f64::consts::TAU * n as f64 / count as f64)).collect()
}

/// First harmonic |h₁| of the first coordinate of a state of all instances.
fn first_harmonic(structure: &Structure<2>, u: &[f64], harmonics: usize) -> f64 {
    let x: Vec<f64> = u.chunks_exact(2 * structure.len()).map(|u| u[0]).collect();
    let series = Series::of_values(&x).unwrap();
    series.coefficients()[1].hypot(series.coefficients()[1 + harmonics])
}

/// The periodic solution that relaxation finds from `start`.
fn relaxed(structure: &Structure<2>, omega: f64, harmonics: usize, start: Vec<f64>) -> Vec<f64> {
    let system = alone(structure);
    let balance = HarmonicBalance::new(&system, Instances::of_harmonics(harmonics), omega, 2.0);
    let mut relax = Relax::new(&balance, CONTROL, start, &vec![0.1; balance.len()], None);
    while relax.drop() > 1e-11 {
        assert!(relax.iteration < 500, "{:e}", relax.drop());
        relax.advance().unwrap();
    }
    relax.u.clone()
}

/// The periodic solution next to `start`, stable or not: Newton's method with differences.
fn nearest(structure: &Structure<2>, omega: f64, harmonics: usize, start: Vec<f64>) -> Vec<f64> {
    let system = alone(structure);
    let balance = HarmonicBalance::new(&system, Instances::of_harmonics(harmonics), omega, 2.0);
    let equations = |u: &[f64]| {
        let mut du = vec![0.0; u.len()];
        balance.rhs(&balance.frame(&Instant::still(0.0), u), u, &mut balance.work(), &mut du);
        du
    };
    let (n, h, mut u) = (start.len(), 1e-6, start);
    let size = |r: &[f64]| r.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    for _ in 0..20 {
        if size(&equations(&u)) < 1e-12 {
            break;
        }
        let mut matrix = vec![0.0; n * n];
        for j in 0..n {
            let moved = |h: f64| {
                let mut u = u.clone();
                u[j] += h;
                equations(&u)
            };
            let (up, down) = (moved(h), moved(-h));
            (0..n).for_each(|i| matrix[i * n + j] = (up[i] - down[i]) / (2.0 * h));
        }
        let mut right: Vec<[f64; 1]> = equations(&u).iter().map(|r| [-r]).collect();
        assert!(alula::math::dense::solve(&mut matrix, &mut right));
        u.iter_mut().zip(&right).for_each(|(u, [step])| *u += step);
    }
    let left = size(&equations(&u));
    assert!(left < 1e-11, "{left:e}");
    u
}

#[test] // reference/harmonics/duffing_forced.csv: all periodic solutions of period one
fn harmonic_balance_finds_the_solutions_of_duffing() {
    let spring = Spring { stiffness: 1.0, cubic: 1.0, ..Spring::default() };
    // frequency, x = a cos(ωt − φ) near the branch by one harmonic, |h₁|; relaxation leaves the unstable one
    let branches = [
        (0.8, [0.5227, 0.14], 0.5227476574, true),
        (1.4, [0.339, 2.983], 0.339071509, true),
        (1.4, [0.9407, 2.687], 0.940731201, false),
        (1.4, [1.2268, 0.692], 1.2267777161, true),
    ];
    let harmonics = 15;
    for (omega, [a, lag], exact, stable) in branches {
        let force = ForceHistory::Cosine { amplitude: 0.3, omega, phase: 0.0 };
        let structure = oscillator(spring, 0.1, force);
        let start = sampled(harmonics, |phase| vec![a * (phase - lag).cos(), -a * omega * (phase - lag).sin()]);
        let mut found = vec![nearest(&structure, omega, harmonics, start.clone())];
        if stable {
            found.push(relaxed(&structure, omega, harmonics, start));
        }
        for u in found {
            let first = first_harmonic(&structure, &u, harmonics);
            assert!((first - exact).abs() < 1e-8, "{omega}: {first} {exact}");
            // a period later it is where it was
            let period = std::f64::consts::TAU / omega;
            assert!(miss(&reference(&structure, &u[..2], period, 4000), &u[..2]) < 1e-8, "{omega} {a}");
        }
    }
}

#[test]
fn harmonic_balance_of_a_section_is_its_linear_response() {
    let mut linear = section(0.0, InertiaLaw::Linear);
    let omega = 0.8;
    let coordinates: Vec<Coordinate> = linear
        .coordinates()
        .iter()
        .map(|c| Coordinate {
            spring: Spring::linear(c.spring.stiffness),
            force: ForceHistory::Cosine { amplitude: 0.1, omega, phase: 0.2 },
            ..c.clone()
        })
        .collect();
    linear = Structure::new(linear.model().clone(), coordinates).unwrap();
    let u = relaxed(&linear, omega, 1, sampled(1, |_| vec![0.0; 4]));
    let first = first_harmonic(&linear, &u, 1);
    // (K − ω²M + iωC) q = f, the first harmonic of plunge by Cramer's rule
    let m = linear.matrices(&[0.0; 2], &[0.0; 2]);
    let entry = |k: usize| num(m.stiffness[k] - omega * omega * m.mass[k], omega * m.damping[k]);
    let [a, b, c, d] = [entry(0), entry(1), entry(2), entry(3)];
    let determinant = minus(times(a, d), times(b, c));
    let plunge = times(minus(d, b), over(num(0.1 * 0.2f64.cos(), 0.1 * 0.2f64.sin()), determinant));
    assert!((first - plunge.0.hypot(plunge.1)).abs() < 1e-10, "{first}");
    assert!((u[0] - plunge.0).abs() < 1e-10, "{u:?}");
}

type Complex = (f64, f64);
fn num(re: f64, im: f64) -> Complex {
    (re, im)
}
fn times(a: Complex, b: Complex) -> Complex {
    (a.0 * b.0 - a.1 * b.1, a.0 * b.1 + a.1 * b.0)
}
fn minus(a: Complex, b: Complex) -> Complex {
    (a.0 - b.0, a.1 - b.1)
}
fn over(a: Complex, b: Complex) -> Complex {
    let size = b.0 * b.0 + b.1 * b.1;
    times(a, (b.0 / size, -b.1 / size))
}
