//! Damped and forced vibration of structures of particles against modes, invariants and the work of loads.
use std::f64::consts::TAU;

use super::super::body::{Action, Load, Parts, Solid};
use super::super::modes::{Mode, ModeRequest, modes};
use super::super::tests::{cantilever, lattice, parts, rubber};
use super::Structure;
use crate::math::Vector;
use crate::math::fourier::Instances;
use crate::physics::solid::{Law, Material, Moduli};
use crate::system::{Mechanical, Moment, System};
use crate::time::forced::{Forced, Place, Stop};
use crate::time::structural::{self, GeneralisedAlpha, Newton};
use crate::time::symplectic::{self, Symplectic};
use crate::time::vibration::{Periodic, Vibration};
use crate::time::{Integrator, Past};

const STOP: Stop = Stop { orders: 6.0, tolerance: 1e-6, iterations: 200 };

/// The plate of [`cantilever`], five particles through the thickness.
fn plate(law: Law, held: impl Fn(&Vector<2>) -> bool) -> Parts<2> {
    let moduli = Moduli::of_young(3.0 * 3.25e6 * (1.0 - 2.0 * 0.3975), 0.3975);
    parts(&lattice([0.2, 0.02], [41, 5], 0.0), Material::new(1000.0, moduli, law), held)
}

fn first_mode(structure: &Structure<2>) -> Mode {
    let rest = structure.start(|_| [0.0; 2]);
    modes(structure, &rest, &ModeRequest { count: 1, above: 0.0 }).unwrap().remove(0)
}

#[test]
fn damping_in_proportion_to_stiffness_is_so_about_the_body_at_rest() {
    let mut body = parts(&lattice([1.0, 0.5], [9, 5], 0.2), rubber(), |x| x[0] < 1e-9);
    body.damping.stiffness = 0.3;
    let structure = Structure::new(Solid::new(body));
    let n = structure.displacements();
    let still = vec![0.0; n];
    let at = Moment { time: 0.0, step: 0.0, displacement: &still, velocity: &still, history: &[] };
    let w: Vec<f64> = (0..n).map(|k| (k * 37 % 101) as f64 / 101.0 - 0.5).collect();
    let mut work = structure.work();
    let (mut elastic, mut damped, mut force) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    structure.stiffness(&structure.linearise(&at, [1.0, 0.0]), &w, &mut work, &mut elastic);
    structure.stiffness(&structure.linearise(&at, [0.0, 1.0]), &w, &mut work, &mut damped);
    structure.forces(&Moment { velocity: &w, ..at }, &mut work, &mut force, &mut []);
    let size = elastic.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    for k in 0..n {
        assert!((damped[k] - 0.3 * elastic[k]).abs() < 1e-12 * size, "{k}: {} {}", damped[k], elastic[k]);
        assert!((damped[k] + force[k]).abs() < 1e-12 * size, "{k}: {} {}", damped[k], force[k]);
    }
}

// the first mode decays with the damping ratio βω/2
#[test]
fn a_cantilever_decays_as_its_stiffness_damping_says() {
    const RATIO: f64 = 0.004;
    let mode = first_mode(&cantilever(5, 0.0));
    let mut body = plate(Law::NeoHookean, |x| x[0] < 1e-9);
    body.damping.stiffness = 2.0 * RATIO / mode.omega;
    let structure = Structure::new(Solid::new(body));
    let n = structure.displacements();
    let mut u = structure.start(|_| [0.0; 2]);
    (0..n).for_each(|k| u[n + k] = 0.0005 * mode.omega * mode.shape[k]);
    let period = TAU / (mode.omega * (1.0 - RATIO * RATIO).sqrt());
    let until = 0.5 * period;
    let newton = Newton { tolerance: 1e-9, iterations: 20 };
    let implicit = structural::Plan { step: period / 200.0, until, radius: 1.0, newton };
    let explicit = symplectic::Plan { cfl: 0.8, until };
    let marches: [Box<dyn Integrator<Structure<2>>>; 2] = [
        Box::new(Symplectic::new(&structure, explicit, Past::default(), u.clone())),
        Box::new(GeneralisedAlpha::new(&structure, implicit, Past::default(), u)),
    ];
    for mut march in marches {
        let energy = |march: &mut dyn Integrator<Structure<2>>| {
            let e = structure.solid.energy(&structure.state(0.0, march.standing().state));
            e.kinetic + e.strain + e.stabilisation
        };
        let begin = energy(march.as_mut());
        let mut taken = 0.0;
        while !march.finished() {
            let before = structure.solid.damped(&structure.state(0.0, march.standing().state));
            march.advance().unwrap();
            let after = structure.solid.damped(&structure.state(0.0, march.standing().state));
            taken += 0.5 * march.mark().last * (before + after);
        }
        let end = energy(march.as_mut());
        let ratio = (begin / end).ln() / (2.0 * mode.omega * until);
        assert!((ratio / RATIO - 1.0).abs() < 0.01, "{ratio} after {} steps", march.mark().iteration);
        assert!(((end + taken) / begin - 1.0).abs() < 2e-3, "{begin} {end} {taken}");
    }
}

// what stabilisation holds is damped as it changes in axes that do not turn, which brakes zigzag displacements that turn
#[test]
fn a_damped_plate_that_spins_keeps_its_momenta() {
    let material = Material::new(1.0, Moduli { shear: 1.0, bulk: 2.0 }, Law::NeoHookean);
    for (stabilisation, bar) in [(0.0, 1e-12), (0.3, 2e-4)] {
        let mut body = parts(&lattice([1.0, 0.2], [11, 3], 0.2), material, |_| false);
        (body.damping.stiffness, body.damping.stabilisation) = (0.2, stabilisation);
        let structure = Structure::new(Solid::new(body));
        let (spin, x) = (0.4, structure.solid.particles.x.clone());
        let u = structure.start(|i| [0.1 - spin * (x[i][1] - 0.1), spin * (x[i][0] - 0.5)]);
        let plan = symplectic::Plan { cfl: 0.8, until: TAU / spin };
        let mut march = Symplectic::new(&structure, plan, Past::default(), u);
        let n = structure.displacements();
        let momenta = |u: &[f64]| {
            (0..x.len()).fold([0.0; 3], |[a, b, c], i| {
                let (m, v) = (structure.solid.mass()[i], [u[n + 2 * i], u[n + 2 * i + 1]]);
                let at = [x[i][0] + u[2 * i], x[i][1] + u[2 * i + 1]];
                [a + m * v[0], b + m * v[1], c + m * (at[0] * v[1] - at[1] * v[0])]
            })
        };
        let before = momenta(march.standing().state);
        while !march.finished() {
            march.advance().unwrap();
        }
        let after = momenta(march.standing().state);
        assert!((0..2).all(|k| (after[k] - before[k]).abs() < 1e-12), "{before:?} {after:?}");
        assert!((after[2] / before[2] - 1.0).abs() < bar, "{stabilisation}: {before:?} {after:?}");
    }
}

/// The upward load amplitude·cos ωt on some particles.
fn load(amplitude: f64, omega: f64, particles: Vec<u32>) -> Load<2> {
    let area = Vector([0.0, 1.0 / particles.len() as f64]);
    let history = Box::new(move |t: f64| (omega * t).cos());
    let areas = particles.into_iter().map(|i| (i, area)).collect();
    Load { areas, action: Action::Traction(Vector([0.0, amplitude])), history }
}

fn sought(structure: &Structure<2>, omega: f64, harmonics: usize) -> Vibration<'_, Structure<2>> {
    let held = Instances::of_harmonics(harmonics);
    let seen = Instances::of_harmonics(2 * harmonics);
    Vibration::new(structure, Periodic { omega, held, seen }, structure.solid.virgin())
}

fn found(vibration: &mut Vibration<'_, Structure<2>>, u: Vec<f64>) -> Place {
    let mut search = Forced::new(vibration, STOP, u).unwrap();
    while !search.finished() {
        search.step().unwrap();
    }
    search.place
}

// against the sum over the first modes of φ φ·F/(m (ω_k² − ω² + iω(α + βω_k²)))
#[test]
fn a_cantilever_answers_a_load_as_its_modes_do() {
    let undamped = cantilever(5, 0.0);
    let rest = undamped.start(|_| [0.0; 2]);
    let all = modes(&undamped, &rest, &ModeRequest { count: 12, above: 0.0 }).unwrap();
    let x = undamped.solid.particles.x.clone();
    let tip = x.iter().position(|x| (*x - Vector([0.2, 0.01])).norm() < 1e-9).unwrap();
    let first = all[0].omega;
    for (part, alpha, beta) in [(0.6, 0.0, 0.1 / first), (0.99, 0.0, 0.1 / first), (1.4, 0.2 * first, 0.0)] {
        let omega = part * first;
        let mut body = plate(Law::NeoHookean, |x| x[0] < 1e-9);
        (body.damping.mass, body.damping.stiffness) = (alpha, beta);
        body.loads.push(load(1e-6, omega, vec![tip as u32]));
        let structure = Structure::new(Solid::new(body));
        let mut vibration = sought(&structure, omega, 1);
        let start = vec![0.0; vibration.len()];
        let place = found(&mut vibration, start);
        let values: Vec<f64> = (0..3).map(|n| place.u[n * structure.displacements() + 2 * tip + 1]).collect();
        let series = Instances::of_harmonics(1).to_coefficients().apply(&values);
        let mut exact = [0.0; 2];
        for mode in &all {
            let shape = mode.shape[2 * tip + 1];
            let (a, b) = (mode.omega.powi(2) - omega * omega, omega * (alpha + beta * mode.omega.powi(2)));
            let size = 1e-6 * shape * shape / mode.generalised_mass / (a * a + b * b);
            // cosine and sine
            exact = [exact[0] + size * a, exact[1] + size * b];
        }
        let whole = exact[0].hypot(exact[1]);
        let error = (series[1] - exact[0]).hypot(series[2] - exact[1]) / whole;
        assert!(error < 0.01, "{part}: {error}, {series:?} {exact:?}");
        assert!(place.iterations < 8, "{}", place.iterations);
    }
}

/// A plate that is clamped at both ends, pushed in its middle at a part of its first frequency.
fn clamped(part: f64, amplitude: f64) -> (Structure<2>, f64) {
    let ends = |x: &Vector<2>| x[0] < 1e-9 || x[0] > 0.2 - 1e-9;
    let mut body = plate(Law::SaintVenantKirchhoff, ends);
    let middle = body.particles.x.iter().position(|x| (*x - Vector([0.1, 0.02])).norm() < 1e-9).unwrap();
    let first = first_mode(&Structure::new(Solid::new(plate(Law::SaintVenantKirchhoff, ends)))).omega;
    body.damping.mass = 0.1 * first;
    body.loads.push(load(amplitude, part * first, vec![middle as u32]));
    (Structure::new(Solid::new(body)), part * first)
}

#[test]
fn a_clamped_plate_stiffens_and_its_loads_do_the_work_that_damping_takes() {
    let (structure, omega) = clamped(0.95, 20.0);
    let near = |x: &Vector<2>| (*x - Vector([0.1, 0.02])).norm() < 1e-9;
    let at = structure.solid.particles.x.iter().position(near).unwrap();
    let middle = |u: &[f64], n: usize| u[n * structure.displacements() + 2 * at + 1];
    let mut amplitudes = Vec::new();
    for harmonics in [3, 5] {
        let mut vibration = sought(&structure, omega, harmonics);
        let start = vec![0.0; vibration.len()];
        let place = found(&mut vibration, start);
        let held = Instances::of_harmonics(harmonics);
        let values: Vec<f64> = (0..held.count()).map(|n| middle(&place.u, n)).collect();
        let series = held.to_coefficients().apply(&values);
        amplitudes.push(series[1].hypot(series[1 + harmonics]));
        let (mut worked, mut taken) = (0.0, 0.0);
        const MOMENTS: usize = 64;
        for n in 0..MOMENTS {
            let motion = vibration.at_phase(&place.u, TAU * n as f64 / MOMENTS as f64);
            let state = [&motion.displacement[..], &motion.velocity].concat();
            let at = structure.state(TAU * n as f64 / MOMENTS as f64 / omega, &state);
            let mut force = vec![[0.0; 2]; structure.solid.len()];
            structure.solid.outside(&at, &mut force);
            worked += force.as_flattened().iter().zip(&motion.velocity).map(|(f, v)| f * v).sum::<f64>();
            taken += structure.solid.damped(&at);
        }
        assert!((worked / taken - 1.0).abs() < 1e-4, "{harmonics}: {worked} {taken}");
    }
    assert!((amplitudes[0] / amplitudes[1] - 1.0).abs() < 1e-3 && amplitudes[1] > 0.002, "{amplitudes:?}");
}

#[test]
fn a_search_that_is_resumed_goes_on_to_the_same_bits() {
    let (structure, omega) = clamped(0.95, 20.0);
    let mut vibration = sought(&structure, omega, 3);
    let start = vec![0.0; vibration.len()];
    let mut whole = Forced::new(&mut vibration, STOP, start).unwrap();
    whole.step().unwrap();
    whole.step().unwrap();
    let kept = whole.place.clone();
    while !whole.finished() {
        whole.step().unwrap();
    }
    let mut again = sought(&structure, omega, 3);
    let mut resumed = Forced::at(&mut again, STOP, kept);
    while !resumed.finished() {
        resumed.step().unwrap();
    }
    assert_eq!(whole.place, resumed.place);
}
