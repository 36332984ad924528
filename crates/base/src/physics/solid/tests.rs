//! Properties that hold for several laws: tangents, rotations, energy, plane stress.
use super::samples::{close, distance, random_rotation, random_tensor};
use super::*;
use crate::math::jet::Jet;

const MODULI: Moduli = Moduli { shear: 1.0, bulk: 2.2 };
const SOFTENING: Softening = Softening { reference: 290.0, melting: 800.0, exponent: 0.9 };
const YIELD: f64 = 0.01;

/// A material for each law, and for each kind of plasticity.
fn all() -> Vec<Material> {
    let voce = Hardening::Voce { start: YIELD, linear: 0.02, saturation: 0.01, exponent: 8.0 };
    let power = Hardening::Power { start: YIELD, modulus: 0.02, exponent: 0.3 };
    let plastic =
        |hardening, kinematic, rate, softening| Law::Plastic(Plasticity { hardening, kinematic, rate, softening });
    let logarithmic = Rate::Logarithmic { factor: 0.03, reference: 0.01 };
    let overstress = Rate::Overstress { viscosity: 0.3, exponent: 2.5 };
    let laws = [
        Law::Linear,
        Law::SaintVenantKirchhoff,
        Law::NeoHookean,
        Law::Hypoelastic,
        Law::Viscoelastic(Prony::new(&[(0.4, 0.3), (0.2, 2.0), (0.1, 10.0)])),
        Law::Plastic(Plasticity::linear(YIELD, 0.0)),
        plastic(voce, 0.0, Rate::Independent, None),
        plastic(voce, 0.05, Rate::Independent, None),
        plastic(power, 0.0, logarithmic, Some(SOFTENING)),
        plastic(voce, 0.0, overstress, None),
        plastic(power, 0.05, overstress, Some(SOFTENING)),
    ];
    // plastic work of the order of the yield stress heats by tens of degrees
    let thermal = Thermal { heat_capacity: 4e-4, heated_fraction: 0.9, start: 300.0 };
    laws.map(|law| Material { thermal, ..Material::new(1.0, MODULI, law) }).to_vec()
}

fn is_plastic(material: &Material) -> bool {
    matches!(material.law, Law::Plastic(_))
}

/// F along a smooth path of finite strain and rotation, which is closed after t = 1 if `turn` is an integer.
fn path(t: f64, size: f64) -> Tensor {
    let (a, b) = (random_tensor(11, size), random_tensor(12, size));
    let phase = std::f64::consts::TAU * t;
    let strain = tensor::plus(&tensor::times(&a, phase.sin()), 1.0 - phase.cos(), &b);
    tensor::plus_identity(&strain, 1.0)
}

/// History after `n` steps along the path from the initial state up to `end`.
fn history_along(material: &Material, n: usize, end: f64, size: f64) -> Vec<f64> {
    let mut old = vec![0.0; material.history_len()];
    material.begin(&mut old);
    for k in 1..=n {
        let mut new = old.clone();
        material.respond(&path(end * k as f64 / n as f64, size), &old, end / n as f64, &mut new);
        old = new;
    }
    old
}

#[test]
fn the_tangent_of_every_law_is_the_derivative_of_its_stress() {
    let dt = 0.05;
    for (k, material) in all().iter().enumerate() {
        for seed in 0..6 {
            let old = history_along(material, 4, 0.2, 0.1);
            let f = tensor::sum(&path(0.2, 0.1), &random_tensor(seed, 0.08));
            let df = random_tensor(seed + 50, 1.0);
            let mut new = old.clone();
            let stress =
                |h: f64| material.respond(&tensor::plus(&f, h, &df), &old, dt, &mut vec![0.0; old.len()]).stress;
            material.respond(&f, &old, dt, &mut new);
            if is_plastic(material) {
                assert!(material.plastic_strain(&new) > material.plastic_strain(&old) + 1e-3);
            }
            // fourth order
            let h = 1e-5;
            let slope = tensor::of(|i, j| {
                let d = |h: f64| (stress(h)[i][j] - stress(-h)[i][j]) / (2.0 * h);
                (4.0 * d(h) - d(2.0 * h)) / 3.0
            });
            let tangent = tangent_product(material, &f, &df, &old, dt);
            let bar = 2e-9 * tensor::norm(&tangent);
            assert!(distance(&tangent, &slope) < bar, "law {k}, seed {seed}: {:.1e}", distance(&tangent, &slope));
        }
    }
}

#[test]
fn jets_and_duals_give_the_same_first_derivative() {
    for material in all() {
        let old = history_along(&material, 4, 0.2, 0.1);
        let (f, df) = (path(0.25, 0.1), random_tensor(3, 1.0));
        let jets = tensor::of(|i, j| Jet { value: f[i][j], first: df[i][j], second: 0.0 });
        let mut new = vec![Jet::constant(0.0); old.len()];
        let stress = material.respond(&jets, &old, 0.05, &mut new).stress;
        let tangent = tangent_product(&material, &f, &df, &old, 0.05);
        close(&tensor::convert(&stress, |x| x.first), &tangent, 1e-12);
    }
}

#[test]
fn tangents_and_stresses_of_elastic_laws_follow_from_their_energy() {
    for material in &all()[1..3] {
        for seed in 0..10 {
            let f = tensor::plus_identity(&random_tensor(seed, 0.4), 1.0);
            let df = random_tensor(seed + 20, 1.0);
            let jets = tensor::of(|i, j| Jet { value: f[i][j], first: df[i][j], second: 0.0 });
            let Some(energy) = material.energy(&jets) else { panic!("an elastic law has an energy") };
            let answer = material.respond(&f, &[], 0.0, &mut []);
            assert_eq!(answer.stored, energy.value);
            assert!((tensor::contraction(&answer.stress, &df) - energy.first).abs() < 1e-13);
            let tangent = tangent_product(material, &f, &df, &[], 0.0);
            assert!((tensor::contraction(&tangent, &df) - energy.second).abs() < 1e-12 * energy.second.abs().max(1.0));
        }
    }
}

#[test]
fn a_rotated_observer_sees_the_rotated_stress_and_the_same_energy() {
    for (k, material) in all().iter().enumerate().skip(1) {
        for seed in 0..6 {
            let old = history_along(material, 4, 0.2, 0.1);
            let (f, q) = (tensor::sum(&path(0.2, 0.1), &random_tensor(seed, 0.08)), random_rotation(seed));
            let mut histories = [old.clone(), old.clone()];
            let answer = material.respond(&f, &old, 0.05, &mut histories[0]);
            let rotated = material.respond(&tensor::product(&q, &f), &old, 0.05, &mut histories[1]);
            close(&rotated.stress, &tensor::product(&q, &answer.stress), 3e-14);
            assert!((rotated.stored - answer.stored).abs() < 1e-14, "law {k}");
            if is_plastic(material) || matches!(material.law, Law::Viscoelastic(_)) {
                assert!((rotated.dissipated - answer.dissipated).abs() < 1e-13, "law {k}");
                let same =
                    histories[0].iter().zip(&histories[1]).all(|(a, b)| (a - b).abs() < 1e-13 * a.abs().max(1.0));
                assert!(same, "law {k}: {histories:?}");
            }
        }
    }
}

#[test]
fn twenty_turns_leave_no_stress() {
    let (turns, steps) = (20, 400);
    for material in &all()[1..] {
        let mut old = vec![0.0; material.history_len()];
        material.begin(&mut old);
        let mut greatest = 0.0f64;
        for k in 1..=turns * steps {
            let (s, c) = (std::f64::consts::TAU * k as f64 / steps as f64).sin_cos();
            let f = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
            let mut new = old.clone();
            greatest = greatest.max(tensor::norm(&material.respond(&f, &old, 0.01, &mut new).stress));
            old = new;
        }
        // rounding of 8000 relative gradients, which accumulates in the hypoelastic law: 3e-12; other laws reach 1e-15
        let bar = if matches!(material.law, Law::Hypoelastic) { 1e-11 } else { 1e-14 };
        assert!(greatest < bar, "{greatest:.1e}");
    }
}

/// Work of the stress along the path up to `end` by the trapezoidal rule, minus the change of stored energy and the
/// dissipated energy.
fn left_over(material: &Material, n: usize, end: f64, size: f64) -> (f64, f64, f64) {
    let mut old = vec![0.0; material.history_len()];
    material.begin(&mut old);
    let virgin = material.respond(&path(0.0, size), &old.clone(), 0.0, &mut old);
    let (mut before, mut work, mut lost) = (virgin, 0.0, 0.0);
    for k in 1..=n {
        let (f0, f1) = (path(end * (k - 1) as f64 / n as f64, size), path(end * k as f64 / n as f64, size));
        let mut new = old.clone();
        let now = material.respond(&f1, &old, end / n as f64, &mut new);
        let mean = tensor::sum(&now.stress, &before.stress);
        work += 0.5 * tensor::contraction(&mean, &tensor::difference(&f1, &f0));
        lost += now.dissipated;
        (before, old) = (now, new);
    }
    (work - (before.stored - virgin.stored) - lost, work, lost)
}

#[test]
fn work_along_a_path_is_what_is_stored_and_lost() {
    for (k, material) in all().iter().enumerate() {
        // along a part of the path, and around the closed path
        for end in [0.35, 1.0] {
            let size = if is_plastic(material) { 0.05 } else { 0.15 };
            let [(coarse, ..), (fine, _, lost)] = [500, 1000].map(|n| left_over(material, n, end, size));
            // second order in the step: 5e-7 of the dissipated energy for relaxation, up to 2e-5 for plastic flow
            assert!(fine.abs() < 3e-5 * lost.abs() + 4e-8, "law {k}: {fine:.1e} of {lost:.1e}");
            // hardening and overstress with infinite initial slope make the observed order at the start irregular
            let order = (coarse / fine).abs().log2();
            let smooth = !matches!(material.law, Law::Plastic(Plasticity { softening: Some(_), .. }))
                && !matches!(material.law, Law::Plastic(Plasticity { rate: Rate::Overstress { .. }, .. }));
            assert!(!smooth || fine.abs() < 1e-14 || order > 1.9, "law {k}: order {order:.2}");
        }
    }
}

#[test]
fn linear_and_hypoelastic_laws_agree_at_small_strain() {
    let f = tensor::plus_identity(&random_tensor(9, 1e-7), 1.0);
    let material = Material::new(1.0, MODULI, Law::Hypoelastic);
    let mut old = vec![0.0; material.history_len()];
    material.begin(&mut old);
    let answer = material.respond(&f, &old.clone(), 1.0, &mut old);
    close(&answer.stress, &linear(&MODULI, &f), 1e-13);
    assert!((answer.stored - linear_energy(&MODULI, &f)).abs() < 1e-20);
}

#[test]
fn thin_sheets_have_the_thickness_of_closed_forms() {
    let (e, nu) = (0.01, MODULI.poisson());
    let mut f: Tensor = tensor::identity();
    (f[0][0], f[1][1], f[2][2]) = (1.0 + e, 1.0 - nu * e, f64::NAN);
    let material = Material::new(1.0, MODULI, Law::Linear);
    let (answer, thickness) = plane_stress(&material, &f, 1.0, &[], 0.0, &mut []);
    assert!((thickness - (1.0 - nu * e)).abs() < 1e-15);
    assert!((answer.stress[0][0] - MODULI.young() * e).abs() < 1e-15 && answer.stress[1][1].abs() < 1e-15);
    (f[0][0], f[0][1], f[1][0], f[1][1]) = (1.3, 0.2, -0.4, 0.8);
    let (answer, thickness) = plane_stress(&material.with_law(Law::SaintVenantKirchhoff), &f, 1.0, &[], 0.0, &mut []);
    let green = |a: usize| 0.5 * (f[0][a] * f[0][a] + f[1][a] * f[1][a] - 1.0);
    let through = -MODULI.lame() / (MODULI.lame() + 2.0 * MODULI.shear) * (green(0) + green(1));
    assert!((thickness - (1.0 + 2.0 * through).sqrt()).abs() < 1e-14 && answer.stress[2][2].abs() < 1e-14);
}

#[test]
fn the_sheet_of_incompressible_rubber_keeps_its_volume() {
    let material = Material::new(1.0, Moduli::of_young(1.0, 0.4999), Law::NeoHookean);
    let stretch = 2.0f64;
    let mut f: Tensor = tensor::identity();
    (f[0][0], f[1][1]) = (stretch, stretch.powf(-0.5));
    let (answer, thickness) = plane_stress(&material, &f, 1.0, &[], 0.0, &mut []);
    assert!((thickness * stretch.sqrt() - 1.0).abs() < 3e-4);
    // Treloar: P = μ (λ − 1/λ²), up to the remaining compressibility
    let exact = material.moduli.shear * (stretch - stretch.powi(-2));
    assert!((answer.stress[0][0] / exact - 1.0).abs() < 3e-4 && answer.stress[2][2].abs() < 1e-12);
}

#[test]
fn the_tangent_of_a_thin_sheet_is_the_derivative_of_its_stress() {
    for (k, material) in all().iter().enumerate() {
        let old = history_along(material, 4, 0.2, 0.05);
        let flat = |t: &Tensor| tensor::of(|i, j| if i == 2 || j == 2 { f64::from(u8::from(i == j)) } else { t[i][j] });
        let f = flat(&tensor::sum(&path(0.2, 0.05), &random_tensor(4, 0.06)));
        let df = tensor::of(|i, j| if i == 2 || j == 2 { 0.0 } else { random_tensor(5, 1.0)[i][j] });
        let answer = |h: f64| {
            let mut new = vec![0.0; old.len()];
            let (r, t) = plane_stress(material, &tensor::plus(&f, h, &df), 1.0, &old, 0.05, &mut new);
            assert!(r.stress[2][2].abs() < 1e-14);
            (r.stress, t)
        };
        let dual = tensor::of(|i, j| Dual { value: f[i][j], derivative: df[i][j] });
        let mut new = vec![Dual::constant(0.0); old.len()];
        let (tangent, thickness) = plane_stress(material, &dual, 1.0, &old, 0.05, &mut new);
        let h = 1e-5;
        let slope = |get: &dyn Fn(f64) -> f64| (8.0 * (get(h) - get(-h)) - (get(2.0 * h) - get(-2.0 * h))) / (12.0 * h);
        close(
            &tensor::convert(&tangent.stress, |x| x.derivative),
            &tensor::of(|i, j| slope(&|h| answer(h).0[i][j])),
            2e-8,
        );
        assert!((thickness.derivative - slope(&|h| answer(h).1)).abs() < 2e-8, "law {k}");
    }
}

#[test]
fn waves_and_histories_are_those_of_the_law() {
    let material = Material::new(2.0, MODULI, Law::NeoHookean);
    assert!((material.pressure_wave_speed().powi(2) - (2.2 + 4.0 / 3.0) / 2.0).abs() < 1e-15);
    assert!((material.shear_wave_speed().powi(2) - 0.5).abs() < 1e-15);
    assert_eq!(material.plastic_strain(&[]), 0.0);
    assert_eq!(material.temperature(&[]), ROOM_TEMPERATURE);
    let longest = all().iter().map(Material::history_len).max();
    assert!(longest <= Some(MOST_HISTORY));
}
