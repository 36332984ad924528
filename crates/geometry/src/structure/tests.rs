//! Structures alone: exact solutions, conservation, tangents.
use std::f64::consts::{PI, TAU};

use super::*;

/// Classical Runge-Kutta from `u` at time 0 to `end`, forces of the surroundings left out.
fn march<const D: usize>(s: &Structure<D>, u: &[f64], end: f64, steps: usize) -> Vec<f64> {
    let (mut u, dt, none) = (u.to_vec(), end / steps as f64, vec![0.0; s.len()]);
    let along = |u: &[f64], k: &[f64], f: f64| u.iter().zip(k).map(|(u, k)| u + f * k).collect::<Vec<f64>>();
    for n in 0..steps {
        let t = n as f64 * dt;
        let a = s.rates(t, &u, &none);
        let b = s.rates(t + 0.5 * dt, &along(&u, &a, 0.5 * dt), &none);
        let c = s.rates(t + 0.5 * dt, &along(&u, &b, 0.5 * dt), &none);
        let d = s.rates(t + dt, &along(&u, &c, dt), &none);
        (0..u.len()).for_each(|k| u[k] += dt / 6.0 * (a[k] + 2.0 * b[k] + 2.0 * c[k] + d[k]));
    }
    u
}

fn coordinate(name: &str, spring: Spring, damping: f64) -> Coordinate {
    Coordinate { name: name.to_owned(), spring, damping, ..Coordinate::default() }
}

/// One mass on one spring.
fn oscillator(mass: f64, spring: Spring, damping: f64, force: ForceHistory) -> Structure<2> {
    let coordinate = Coordinate { force, ..coordinate("bend", spring, damping) };
    Structure::new(Model::Modal(vec![("bend".to_owned(), mass)]), vec![coordinate]).unwrap()
}

/// A section by the numbers of flutter: lengths in semichords, time in 1/ω_α, mass 1.
fn section([x_alpha, r_alpha2, frequency_ratio]: [f64; 3], law: InertiaLaw) -> Structure<2> {
    let body = PlanarBody {
        pivot: [0.3, 0.1],
        mass: 1.0,
        static_moment: [x_alpha, 0.0],
        inertia: r_alpha2,
        flap: None,
        gravity: [0.0; 2],
        law,
    };
    let springs = [("plunge", frequency_ratio * frequency_ratio), ("pitch", r_alpha2)];
    let coordinates = springs.map(|(name, k)| coordinate(name, Spring::linear(k), 0.0));
    Structure::new(Model::Planar(body), coordinates.to_vec()).unwrap()
}

fn flapped(law: InertiaLaw) -> Structure<2> {
    let flap = Flap { hinge: [0.75, 0.02], static_moment: [0.04, 0.003], inertia: 0.01, blend: 0.1 };
    let body = PlanarBody {
        pivot: [0.3, 0.1],
        mass: 1.3,
        static_moment: [0.25, -0.03],
        inertia: 0.4,
        flap: Some(flap),
        gravity: [0.2, -0.9],
        law,
    };
    let spring = |k: f64| Spring { stiffness: k, cubic: 3.0 * k, play: 0.0, rest: 0.1 };
    let all = [("surge", 2.0), ("plunge", 1.0), ("pitch", 0.5), ("flap", 0.05)];
    let coordinates = all.map(|(name, k)| coordinate(name, spring(k), 0.0));
    Structure::new(Model::Planar(body), coordinates.to_vec()).unwrap()
}

fn top(moments: [f64; 3], static_moment: [f64; 3], names: &[&str]) -> Structure<3> {
    let inertia =
        std::array::from_fn(|i| std::array::from_fn(|j| if i == j { moments[i] } else { 0.02 * static_moment[0] }));
    let body = RigidBody { pivot: [0.1, 0.2, -0.3], mass: 1.7, static_moment, inertia, gravity: [0.0, 0.1, -0.6] };
    let coordinates = names.iter().map(|n| coordinate(n, Spring::default(), 0.0)).collect();
    Structure::new(Model::Spatial(body), coordinates).unwrap()
}

#[test] // isogai_typical_section/parameters.toml: coupled wind-off frequencies
fn isogai_section_has_its_frequencies() {
    let found = section([1.8, 3.48, 1.0], InertiaLaw::Linear).natural_frequencies(&[0.0; 2]);
    assert!((found[0] - 0.713).abs() < 5e-4 && (found[1] - 5.34).abs() < 5e-3, "{found:?}");
    // (1 − x²/r²) λ² − (1 + ω̄²) λ + ω̄² = 0
    for lambda in found.iter().map(|w| w * w) {
        let c = 1.0 - 1.8 * 1.8 / 3.48;
        assert!((c * lambda * lambda - 2.0 * lambda + 1.0).abs() < 1e-12);
    }
}

#[test]
fn free_and_forced_oscillations_are_exact() {
    let (m, k, c, f, w) = (2.0, 8.0, 0.4, 0.7, 1.3);
    let s = oscillator(m, Spring::linear(k), c, ForceHistory::default());
    let (w0, zeta) = ((k / m).sqrt(), c / (2.0 * (k * m).sqrt()));
    let wd = w0 * (1.0 - zeta * zeta).sqrt();
    let t = 7.3;
    let exact = (-zeta * w0 * t).exp() * (0.1 * (wd * t).cos() + (0.2 + zeta * w0 * 0.1) / wd * (wd * t).sin());
    let u = march(&s, &[0.1, 0.2], t, 4000);
    assert!((u[0] - exact).abs() < 1e-11, "{} {exact}", u[0]);
    // the steady response from its own start
    let force = ForceHistory::Cosine { amplitude: f, omega: w, phase: 0.4 };
    let s = oscillator(m, Spring::linear(k), c, force);
    let (a, b) = (k - m * w * w, c * w);
    let (gain, lag) = (f / a.hypot(b), b.atan2(a));
    let exact = |t: f64| [gain * (w * t + 0.4 - lag).cos(), -w * gain * (w * t + 0.4 - lag).sin()];
    let u = march(&s, &exact(0.0), 3.0 * TAU / w, 6000);
    assert!((u[0] - exact(0.0)[0]).abs() < 1e-11 && (u[1] - exact(0.0)[1]).abs() < 1e-11);
}

#[test] // in the gap it drifts, beyond it is harmonic: period 2π/ω + 4 g/v
fn free_play_has_its_period_and_amplitude() {
    let (k, g, v) = (9.0, 0.05, 0.6);
    let spring = Spring { stiffness: k, play: g, ..Spring::default() };
    let s = oscillator(1.0, spring, 0.0, ForceHistory::Zero);
    let period = TAU / 3.0 + 4.0 * g / v;
    let u = march(&s, &[0.0, v], period, 40_000);
    assert!(u[0].abs() < 1e-8 && (u[1] - v).abs() < 1e-8, "{u:?}");
    let quarter = march(&s, &[0.0, v], 0.25 * period, 10_000);
    assert!((quarter[0] - (g + v / 3.0)).abs() < 1e-8 && quarter[1].abs() < 1e-8, "{quarter:?}");
    // a point in the drift and one in the arc
    assert!((march(&s, &[0.0, v], 0.05, 100)[0] - 0.03).abs() < 1e-14);
    let t = g / v + 0.3;
    assert!((march(&s, &[0.0, v], t, 20_000)[0] - g - v / 3.0 * (0.9f64).sin()).abs() < 1e-8);
}

#[test] // x'' + x + x³ = 0: period 4 K(m)/√(1 + A²), K by the arithmetic-geometric mean
fn a_cubic_spring_has_the_period_of_elliptic_functions() {
    let spring = Spring { stiffness: 1.0, cubic: 1.0, ..Spring::default() };
    let s = oscillator(1.0, spring, 0.0, ForceHistory::Zero);
    let a: f64 = 1.2;
    let m = a * a / (2.0 * (1.0 + a * a));
    let (mut x, mut y): (f64, f64) = (1.0, (1.0 - m).sqrt());
    for _ in 0..8 {
        (x, y) = (0.5 * (x + y), (x * y).sqrt());
    }
    let period = 4.0 * (0.5 * PI / x) / (1.0 + a * a).sqrt();
    let u = march(&s, &[a, 0.0], period, 4000);
    assert!((u[0] - a).abs() < 1e-10 && u[1].abs() < 1e-9, "{u:?}");
}

#[test]
fn a_pendulum_in_the_plane_and_in_space_is_one() {
    // pitch alone, centre of mass aft of the pivot: falls nose up... its tail goes down
    let body = PlanarBody {
        pivot: [0.0; 2],
        mass: 2.0,
        static_moment: [1.0, 0.0],
        inertia: 0.8,
        flap: None,
        gravity: [0.0, -1.5],
        law: InertiaLaw::Exact,
    };
    let plane: Structure<2> =
        Structure::new(Model::Planar(body), vec![coordinate("pitch", Spring::default(), 0.0)]).unwrap();
    let body = RigidBody {
        pivot: [0.0; 3],
        mass: 2.0,
        static_moment: [1.0, 0.0, 0.0],
        inertia: [[0.5, 0.0, 0.0], [0.0, 0.8, 0.0], [0.0, 0.0, 0.7]],
        gravity: [0.0, 0.0, -1.5],
    };
    let space: Structure<3> =
        Structure::new(Model::Spatial(body), vec![coordinate("pitch", Spring::default(), 0.0)]).unwrap();
    for (q, v) in [(0.0, 0.3), (1.1, -0.4), (-2.0, 0.9)] {
        let (a, b) = (plane.rates(0.0, &[q, v], &[0.1]), space.rates(0.0, &[q, v], &[0.1]));
        assert!((a[1] - (1.5 * f64::cos(q) + 0.1) / 0.8).abs() < 1e-13, "{a:?}");
        assert!((a[1] - b[1]).abs() < 1e-13);
        let (a, b) = (plane.energy(&[q], &[v]), space.energy(&[q], &[v]));
        assert!((a.potential + 1.5 * f64::sin(q)).abs() < 1e-14 && (b.potential - a.potential).abs() < 1e-14);
        assert!((a.kinetic - 0.4 * v * v).abs() < 1e-14 && (a.kinetic - b.kinetic).abs() < 1e-14);
    }
}

#[test]
fn linear_sections_are_small_motions_of_exact_ones() {
    let (linear, exact) = (flapped(InertiaLaw::Linear), flapped(InertiaLaw::Exact));
    let zero = [0.0; 4];
    let (a, b) = (linear.matrices(&zero, &zero), exact.matrices(&zero, &zero));
    let far = |x: &[f64], y: &[f64]| x.iter().zip(y).fold(0.0f64, |m, (x, y)| m.max((x - y).abs()));
    assert!(far(&a.mass, &b.mass) < 1e-15);
    assert!((0..16).all(|k| (a.mass[k] - a.mass[k % 4 * 4 + k / 4]).abs() < 1e-15));
    // the matrix of the literature, up instead of down: −S, −S_β off the diagonal, I_β + (c − a) b S_β
    assert!((a.mass[6] + 0.25).abs() < 1e-15 && (a.mass[7] + 0.04).abs() < 1e-15);
    assert!((a.mass[11] - (0.01 + 0.45 * 0.04 - 0.08 * 0.003)).abs() < 1e-15 && a.mass[15] == 0.01);
    let accelerations = |s: &Structure<2>| s.accelerations(0.0, [&zero, &zero], &[0.1, 0.2, 0.3, 0.4]);
    assert!(far(&accelerations(&linear), &accelerations(&exact)) < 1e-13);
}

#[test]
fn energy_is_kept_by_every_model() {
    fn check<const D: usize>(s: &Structure<D>, u: &[f64], end: f64) {
        let n = s.len();
        let energy = |u: &[f64]| {
            let e = s.energy(&u[..n], &u[n..]);
            e.kinetic + e.potential
        };
        let later = march(s, u, end, 2000);
        assert!(
            (energy(&later) - energy(u)).abs() < 1e-10 * (1.0 + energy(u).abs()),
            "{} {}",
            energy(&later),
            energy(u)
        );
        assert!(later.iter().zip(u).any(|(a, b)| (a - b).abs() > 0.1));
    }
    check(&flapped(InertiaLaw::Exact), &[0.1, -0.2, 0.5, 0.3, 0.1, 0.3, -0.4, 0.8], 5.0);
    check(&flapped(InertiaLaw::Linear), &[0.1, -0.2, 0.5, 0.3, 0.1, 0.3, -0.4, 0.8], 5.0);
    let u = [0.0, 0.1, 0.0, 0.2, 0.3, -0.1, 0.1, 0.0, 0.2, 0.6, -0.9, 0.7];
    check(&top([0.5, 0.7, 0.9], [0.3, -0.1, 0.2], &spatial::NAMES), &u, 2.5);
    let two = [0.2, 0.3, 0.6, -0.9];
    check(&top([0.5, 0.7, 0.9], [0.3, -0.1, 0.2], &["roll", "yaw"]), &two, 2.5);
}

#[test] // q'ᵀ (Q + f) = d(T + V)/dt + power of the dampers
fn work_of_forces_goes_into_energy() {
    fn check<const D: usize>(s: &Structure<D>, u: &[f64]) {
        let n = s.len();
        let load: Vec<f64> = (0..n).map(|k| 0.3 - 0.2 * k as f64).collect();
        let rate = s.rates(0.7, u, &load);
        let at = |h: f64| {
            let moved: Vec<f64> = u.iter().zip(&rate).map(|(u, r)| u + h * r).collect();
            let e = s.energy(&moved[..n], &moved[n..]);
            e.kinetic + e.potential
        };
        let h = 1e-5;
        let gained = (at(h) - at(-h)) / (2.0 * h) + s.energy(&u[..n], &u[n..]).dissipation;
        let outer = s.forces(0.7);
        let work: f64 = (0..n).map(|k| u[n + k] * (load[k] + outer[k])).sum();
        assert!((gained - work).abs() < 1e-8, "{gained} {work}");
    }
    let mut s = flapped(InertiaLaw::Exact);
    s.coordinates.iter_mut().for_each(|c| c.damping = 0.3);
    s.coordinates[1].force = ForceHistory::Cosine { amplitude: 0.4, omega: 2.0, phase: 0.1 };
    check(&s, &[0.1, -0.2, 0.5, 0.3, 0.1, 0.3, -0.4, 0.8]);
    let mut s = top([0.5, 0.7, 0.9], [0.3, -0.1, 0.2], &spatial::NAMES);
    s.coordinates.iter_mut().for_each(|c| c.damping = 0.2);
    check(&s, &[0.0, 0.1, 0.0, 0.2, 0.3, -0.1, 0.1, 0.0, 0.2, 0.6, -0.9, 0.7]);
}

#[test] // R(t) = exp(t L/I₁) R(0) exp(t ω₃ (1 − I₃/I₁)) for I₁ = I₂
fn a_symmetric_top_turns_as_it_must() {
    let (i1, i3) = (0.8, 0.5);
    let s = {
        let mut s = top([i1, i1, i3], [0.0; 3], &["roll", "pitch", "yaw"]);
        if let Model::Spatial(body) = &mut s.model {
            body.gravity = [0.0; 3];
        }
        s
    };
    let (start, rate) = ([0.2, -0.1, 0.4], [0.5, 0.3, -0.9]);
    let omega = rotation::body_rate(&start, &rate);
    let momentum = rotation::rotate(&start, &[i1 * omega[0], i1 * omega[1], i3 * omega[2]]);
    let end = 4.0;
    let u = march(&s, &[start, rate].concat(), end, 2000);
    let theta = [u[0], u[1], u[2]];
    assert!(rotation::dot(&theta, &theta).sqrt() > 1.5);
    for x in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, -0.4, 0.8]] {
        let spin = [0.0, 0.0, end * omega[2] * (1.0 - i3 / i1)];
        let exact = rotation::rotate(&start, &rotation::rotate(&spin, &x));
        let exact = rotation::rotate(&momentum.map(|l| l * end / i1), &exact);
        let found = rotation::rotate(&theta, &x);
        assert!((0..3).all(|i| (exact[i] - found[i]).abs() < 1e-10), "{exact:?} {found:?}");
    }
    // and by half a turn and more without a change of heart
    let half = march(&s, &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0], 6.0, 1000);
    assert!((half[2] - 6.0).abs() < 1e-10 && s.fault(&half[..3]).is_none());
    assert!(s.fault(&[0.0, 0.0, TAU]).unwrap().contains("360.0 degrees"));
    assert!(s.fault(&[0.0, f64::NAN, 0.0]).unwrap().contains("`pitch` is NaN"));
}

#[test]
fn tangents_of_the_equations_agree_with_differences() {
    fn check<const D: usize>(s: &Structure<D>, u: &[f64]) {
        let (n, h) = (s.len(), 1e-6);
        let load: Vec<f64> = (0..n).map(|k| 0.5 - 0.3 * k as f64).collect();
        let at = |q: &[f64], v: &[f64], load: &[f64]| s.accelerations(0.3, [q, v], load);
        let (q, v) = u.split_at(n);
        let found = s.linearise(0.3, [q, v], &load);
        let close = |a: f64, b: f64| (a - b).abs() < 2e-7 * (1.0 + b.abs());
        assert!(found.acceleration.iter().zip(at(q, v, &load)).all(|(a, b)| *a == b));
        for j in 0..n {
            let shifted = |x: &[f64], h: f64| {
                let mut x = x.to_vec();
                x[j] += h;
                x
            };
            let pairs = [
                (at(&shifted(q, h), v, &load), at(&shifted(q, -h), v, &load), &found.by_coordinate),
                (at(q, &shifted(v, h), &load), at(q, &shifted(v, -h), &load), &found.by_rate),
                (at(q, v, &shifted(&load, h)), at(q, v, &shifted(&load, -h)), &found.by_load),
            ];
            for (up, down, matrix) in pairs {
                for i in 0..n {
                    let slope = (up[i] - down[i]) / (2.0 * h);
                    assert!(close(matrix[i * n + j], slope), "{i} {j}: {} {slope}", matrix[i * n + j]);
                }
            }
        }
    }
    let u = [0.1, -0.2, 0.5, 0.3, 0.1, 0.3, -0.4, 0.8];
    check(&flapped(InertiaLaw::Exact), &u);
    check(&flapped(InertiaLaw::Linear), &u);
    let u = [0.0, 0.1, 0.0, 1.2, 0.9, -1.1, 0.1, 0.0, 0.2, 0.6, -0.9, 0.7];
    check(&top([0.5, 0.7, 0.9], [0.3, -0.1, 0.2], &spatial::NAMES), &u);
    let zero = [0.0; 12];
    check(&top([0.5, 0.7, 0.9], [0.3, -0.1, 0.2], &spatial::NAMES), &zero);
    check(
        &oscillator(2.0, Spring { stiffness: 1.0, cubic: 2.0, play: 0.1, rest: 0.0 }, 0.3, ForceHistory::Zero),
        &[0.4, 1.0],
    );
    check(&section([1.8, 3.48, 1.0], InertiaLaw::Exact), &[0.1, 0.7, 0.3, -0.2]);
}

#[test]
fn residuals_vanish_with_their_accelerations() {
    let s = top([0.5, 0.7, 0.9], [0.3, -0.1, 0.2], &["plunge", "pitch", "yaw"]);
    let (q, v, load) = ([0.1, 0.4, -0.3], [0.2, 1.0, 0.6], [0.3, 0.2, 0.1]);
    let a = s.accelerations(0.0, [&q, &v], &load);
    assert!(s.residual(0.0, [&q, &v, &a], &load).iter().all(|r| r.abs() < 1e-14));
}

#[test]
fn places_and_their_tangents_belong_together() {
    fn check<const D: usize>(s: &Structure<D>, q: &[f64], bends: &[Vector<D>]) {
        let h = 1e-6;
        let placed = s.placement(&vec![0.0; s.len()]);
        let here = s.placement(q);
        for k in 0..20 {
            let x = Vector::from_fn(|d| 1.2 * ((k * (d + 2)) as f64).sin());
            assert!((placed.point(&x, bends) - x).norm() < 1e-15);
            let mut load = vec![0.0; s.len()];
            let force = Vector::from_fn(|d| 1.0 - 0.7 * d as f64);
            here.add_work(&x, bends, &force, &mut load);
            for (j, tangent) in here.tangents(&x, bends).enumerate() {
                let moved = |h: f64| {
                    let mut q = q.to_vec();
                    q[j] += h;
                    s.placement(&q).point(&x, bends)
                };
                let slope = (moved(h) - moved(-h)) * (0.5 / h);
                assert!((tangent - slope).norm() < 1e-9, "{j}: {tangent:?} {slope:?}");
                assert!((load[j] - force.dot(&tangent)).abs() < 1e-15);
                let mut unit = vec![0.0; s.len()];
                unit[j] = 2.0;
                assert!((here.velocity(&x, bends, &unit) - tangent * 2.0).norm() < 1e-15);
            }
            if !here.bends() {
                let pose = here.pose();
                let whole = Vector::from_fn(|d| pose.rotation[d].dot(&x)) + pose.shift;
                assert!((whole - here.point(&x, bends)).norm() < 1e-14);
            }
        }
    }
    check(&section([1.8, 3.48, 1.0], InertiaLaw::Linear), &[0.2, 0.5], &[]);
    check(&flapped(InertiaLaw::Exact), &[0.1, -0.2, 0.4, -0.3], &[]);
    check(&top([0.5, 0.7, 0.9], [0.3, -0.1, 0.2], &spatial::NAMES), &[0.1, 0.2, 0.3, 0.7, -1.4, 2.0], &[]);
    let bends = [Vector([0.0, 0.3]), Vector([0.1, -0.2])];
    let modes = Model::Modal(vec![("first".to_owned(), 1.0), ("second".to_owned(), 2.0)]);
    let second: Structure<2> = Structure::new(modes, vec![coordinate("second", Spring::linear(1.0), 0.0)]).unwrap();
    check(&second, &[0.4], &bends);
    assert_eq!(second.placement(&[0.4]).amplitudes(), [0.0, 0.4]);
}

#[test]
fn signs_are_those_of_the_page() {
    let s = section([1.8, 3.48, 1.0], InertiaLaw::Linear);
    // nose up: the nose rises, the tail falls
    let placement = s.placement(&[0.0, 0.1]);
    assert!(placement.point(&Vector([0.0, 0.1]), &[])[1] > 0.1 && placement.point(&Vector([1.0, 0.1]), &[])[1] < 0.1);
    // lift ahead of the axis turns the nose up
    let mut load = [0.0; 2];
    s.placement(&[0.0; 2]).add_work(&Vector([0.1, 0.1]), &[], &Vector([0.0, 2.0]), &mut load);
    assert!((load[0] - 2.0).abs() < 1e-15 && (load[1] - 0.4).abs() < 1e-15);
    // a flap that goes down takes the points behind its hinge down
    let flap = flapped(InertiaLaw::Exact).placement(&[0.0, 0.0, 0.0, 0.2]);
    assert!(flap.point(&Vector([1.0, 0.02]), &[])[1] < -0.02);
    assert_eq!(flap.point(&Vector([0.5, 0.02]), &[]), Vector([0.5, 0.02]));
    // in space pitch is nose up for lift along z
    let solid = top([0.5, 0.7, 0.9], [0.3, -0.1, 0.2], &["pitch"]).placement(&[0.1]);
    assert!(solid.point(&Vector([-1.0, 0.0, -0.3]), &[])[2] > -0.3);
}

#[test]
fn structures_that_are_none_are_refused() {
    let body = |s: f64| PlanarBody {
        pivot: [0.0; 2],
        mass: 1.0,
        static_moment: [s, 0.0],
        inertia: 1.0,
        flap: None,
        gravity: [0.0; 2],
        law: InertiaLaw::Linear,
    };
    let named = |names: &[&str]| names.iter().map(|n| coordinate(n, Spring::default(), 0.0)).collect::<Vec<_>>();
    let told =
        |s: f64, names: &[&str]| Structure::<2>::new(Model::Planar(body(s)), named(names)).unwrap_err().to_string();
    assert!(told(0.1, &[]).contains("no coordinates"));
    assert!(told(0.1, &["plunge", "plunge"]).contains("`plunge`"));
    assert!(told(0.1, &["flap"]).contains("surge, plunge, pitch, each once"));
    assert!(told(1.0, &["plunge", "pitch"]).contains("m I > S²"));
    assert!(Structure::<2>::new(Model::Planar(body(1.0)), named(&["pitch"])).is_ok());
    let solid = Structure::<3>::new(Model::Planar(body(0.1)), named(&["pitch"])).unwrap_err();
    assert_eq!(solid, StructureError::Dimension { wanted: 2, dimension: 3 });
}
