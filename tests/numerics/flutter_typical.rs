//! Flutter of typical sections by the p-k method, whose crossings are exact, with Theodorsen's forces and with what rational functions make
//! of a few of them.
use alula::exact::theodorsen::plate;
use alula::math::rational::Rational;
use alula::structure::Matrices;
use alula::structure::flutter::{Crossing, Flutter, Kind};
use num_complex::Complex64;

/// μ, a, x_α, r_α², ω_h/ω_α.
type Section = [f64; 5];

/// Of plunge (up) and pitch over the mass, in the time 1/ω_α, as `alula::exact::flutter` has them.
fn matrices([_, _, x_alpha, r_alpha2, ratio]: Section) -> Matrices {
    Matrices {
        mass: vec![1.0, -x_alpha, -x_alpha, r_alpha2],
        damping: vec![0.0; 4],
        stiffness: vec![ratio * ratio, 0.0, 0.0, r_alpha2],
    }
}

/// Q(ik) with U_ref = b ω_α.
fn forces([mu, a, ..]: Section, k: f64) -> Vec<Complex64> {
    let unit = [[0.0, 1.0], [1.0, 0.0]];
    let [plunge, pitch] = unit.map(|[pitch, plunge]| plate(k, a, pitch.into(), plunge.into()).unwrap());
    let scale = 1.0 / (std::f64::consts::PI * mu);
    [plunge.lift, pitch.lift, 2.0 * plunge.moment, 2.0 * pitch.moment].map(|f| f * scale).to_vec()
}

fn first(section: Section, upto: f64, forces: &dyn Fn(f64) -> Vec<Complex64>) -> Crossing {
    let structure = matrices(section);
    let flutter = Flutter::new(&structure, forces);
    let found = flutter.crossings(&flutter.branches(upto), upto);
    found.into_iter().find(|c| c.kind == Kind::Flutter).unwrap()
}

// reference/harmonics/typical_section_flutter_linear.csv, rows of Mach 0: section, V*, ω/ω_α
const SECTIONS: [(Section, f64, f64); 3] = [
    ([100.0, -0.5, 0.25, 0.25, 0.2], 6.2566244, 0.52325563),
    ([40.0, -0.3, 0.2, 0.25, 0.4], 2.9937178, 0.63658778),
    ([60.0, -2.0, 1.8, 3.48, 1.0], 18.378811, 2.5348469),
];

#[test]
fn sections_flutter_where_theodorsen_says() {
    for (section, v, omega) in SECTIONS {
        let found = first(section, 1.5 * v, &|k| forces(section, k));
        assert!((found.x - v).abs() < 1e-7 * v && (found.frequency - omega).abs() < 1e-7 * omega, "{found:?}");
    }
    // V*² = μ r_α²/(1 + 2a)
    let (section, ..) = SECTIONS[1];
    let (structure, loads) = (matrices(section), |k: f64| forces(section, k));
    let found = Flutter::new(&structure, &loads).crossings(&[], 10.0);
    assert!(found.len() == 1 && found[0].kind == Kind::Divergence && (found[0].x - 5.0).abs() < 1e-12, "{found:?}");
}

#[test]
fn six_reduced_frequencies_are_enough() {
    for (section, v, omega) in SECTIONS {
        let samples = [0.0, 0.05, 0.1, 0.15, 0.25, 0.5].map(|k| (k, forces(section, k)));
        let rational = Rational::of(&samples, 1e-9).unwrap();
        let found = first(section, 1.5 * v, &|k| rational.at(Complex64::new(0.0, k)));
        let errors = [found.x / v - 1.0, found.frequency / omega - 1.0];
        assert!(rational.misfit() < 1e-9 && errors.iter().all(|e| e.abs() < 1e-4), "{section:?}: {errors:?}");
    }
}
