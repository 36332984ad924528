//! Limit cycles of a typical section whose pitch spring is cubic, with the forces of Wagner's function in Jones's approximation.
use alula::exact::theodorsen::plate_loads;
use alula::structure::flutter::{Kind, Varied};
use alula::structure::limit_cycle::{Borne, Cycle, Oscillator};
use alula::structure::{Matrices, Spring};
use num_complex::Complex64;

const MU: f64 = 100.0;
const A: f64 = -0.5;
const CUBIC: f64 = 40.0;
/// Greatest speed that is looked at.
const UPTO: f64 = 12.0;

/// C(ik) of Jones: 1 − 0.165 ik/(ik + 0.0455) − 0.335 ik/(ik + 0.3).
fn jones(p: Complex64) -> Complex64 {
    1.0 - 0.165 * p / (p + 0.0455) - 0.335 * p / (p + 0.3)
}

/// Plunge (up) and pitch over the mass, in the time 1/ω_α: U_ref = b ω_α.
fn forces(k: f64) -> Vec<Complex64> {
    let p = Complex64::new(0.0, k);
    let unit = [[0.0, 1.0], [1.0, 0.0]];
    let [plunge, pitch] = unit.map(|amplitudes| plate_loads(p, jones(p), A, amplitudes.map(Complex64::from)));
    let scale = 1.0 / (std::f64::consts::PI * MU);
    [plunge.lift, pitch.lift, 2.0 * plunge.moment, 2.0 * pitch.moment].map(|f| f * scale).to_vec()
}

fn section() -> (Matrices, [Spring; 2]) {
    let (x_alpha, r2, ratio) = (0.25, 0.25, 0.2f64);
    let matrices = Matrices {
        mass: vec![1.0, -x_alpha, -x_alpha, r2],
        damping: vec![0.0; 4],
        stiffness: vec![ratio * ratio, 0.0, 0.0, r2],
    };
    (matrices, [Spring::linear(ratio * ratio), Spring { stiffness: r2, cubic: CUBIC * r2, ..Spring::default() }])
}

fn cycle(degrees: f64, harmonics: usize) -> Cycle {
    let (matrices, springs) = section();
    let own = Oscillator {
        matrices: &matrices,
        springs: &springs,
        forces: &forces,
        varied: Varied::Speed,
        coordinate: 1,
        borne: None,
    };
    let amplitude = degrees.to_radians();
    let begins = own.begin(amplitude, UPTO);
    let (_, first) = begins.into_iter().find(|(kind, _)| *kind == Kind::Flutter).unwrap();
    let mut found = own.solve(&first, amplitude, 1, None).unwrap();
    for n in 2..=harmonics {
        found = own.solve(&found, amplitude, n, None).unwrap();
    }
    found
}

// reference/harmonics/typical_section_lco_cubic.csv, rows without aliases: harmonics, degrees, U*, k
const ROWS: [(usize, f64, f64, f64); 9] = [
    (1, 0.1, 6.285421463200604, 0.08404311442499726),
    (1, 4.0, 6.793036413309587, 0.08256571401203176),
    (1, 8.0, 8.13598386575007, 0.07977980172757275),
    (2, 4.0, 6.793036413309586, 0.08256571401203176),
    (2, 8.0, 8.13598386575007, 0.07977980172757275),
    (3, 1.0, 6.318033757883138, 0.08393811407357739),
    (3, 4.0, 6.809929070205989, 0.08234275254976707),
    (3, 6.0, 7.4616111297668395, 0.08020228848643117),
    (3, 8.0, 8.366745674725735, 0.07727255459932078),
];

#[test]
fn limit_cycles_of_a_cubic_spring_are_those_of_the_table() {
    for (harmonics, degrees, speed, k) in ROWS {
        let found = cycle(degrees, harmonics);
        // κ b/U_ref = k
        assert!((found.x / speed - 1.0).abs() < 1e-6, "{harmonics} {degrees}: {found:?}");
        assert!((found.kappa() / k - 1.0).abs() < 1e-6, "{harmonics} {degrees}: {found:?}");
    }
}

#[test]
fn a_free_play_begins_to_swing_below_the_linear_flutter_speed() {
    let (matrices, springs) = section();
    let (mut loose, play) = (springs, 0.5f64.to_radians());
    loose[1] = Spring { play, ..Spring::linear(springs[1].stiffness) };
    let soft = Matrices { stiffness: vec![0.04, 0.0, 0.0, 0.0], ..matrices };
    let own = Oscillator {
        matrices: &soft,
        springs: &loose,
        forces: &forces,
        varied: Varied::Speed,
        coordinate: 1,
        borne: None,
    };
    let mut speeds = Vec::new();
    for part in [3.0, 6.0, 20.0] {
        let amplitude = part * play;
        let begins = own.begin(amplitude, UPTO);
        let (_, first) = begins.into_iter().find(|(kind, _)| *kind == Kind::Flutter).unwrap();
        let one = own.solve(&first, amplitude, 1, None).unwrap();
        let with = |upto: usize| (2..=upto).fold(one.clone(), |c, n| own.solve(&c, amplitude, n, None).unwrap()).x;
        let [five, nine] = [with(5), with(9)];
        assert!((nine / five - 1.0).abs() < 0.01, "{part}: {} {five} {nine}", one.x);
        speeds.push(nine);
    }
    // the larger the swing the less the gap counts: towards 6.2851 of the spring without one
    assert!(speeds[0] < speeds[1] && speeds[1] < speeds[2] && speeds[2] < 6.2851, "{speeds:?}");
}

#[test]
fn limit_cycles_of_a_denser_stream_are_those_of_a_lighter_structure() {
    let (matrices, springs) = section();
    let (speed, amplitude) = (|_: f64| 5.0, 4f64.to_radians());
    let varied = Varied::Pressure(&speed);
    let own =
        Oscillator { matrices: &matrices, springs: &springs, forces: &forces, varied, coordinate: 1, borne: None };
    let begins = own.begin(amplitude, UPTO * UPTO);
    let (_, first) = begins.into_iter().find(|(kind, _)| *kind == Kind::Flutter).unwrap();
    let found = own.solve(&first, amplitude, 3, None).unwrap();
    // so much denser than at the same speed with nothing varied
    let denser = found.x / 25.0;
    let over = |all: &[f64]| all.iter().map(|x| x / denser).collect::<Vec<f64>>();
    let light = Matrices { mass: over(&matrices.mass), stiffness: over(&matrices.stiffness), ..matrices.clone() };
    let soft = springs.map(|s| Spring { stiffness: s.stiffness / denser, cubic: s.cubic / denser, ..s });
    let lighter = Oscillator { matrices: &light, springs: &soft, varied: Varied::Speed, ..own };
    let same = lighter.solve(&Cycle { x: 4.9, speed: 4.9, ..found.clone() }, amplitude, 3, None).unwrap();
    assert!(denser > 1.2 && (same.x / 5.0 - 1.0).abs() < 1e-9, "{found:?} {same:?}");
    assert!((same.omega / found.omega - 1.0).abs() < 1e-9 && found.speed == 5.0);
}

#[test]
fn what_is_borne_at_rest_shifts_the_mean_alone_where_springs_are_linear() {
    let (matrices, mut springs) = section();
    springs[1].cubic = 0.0;
    let amplitude = 1f64.to_radians();
    let free = Oscillator {
        matrices: &matrices,
        springs: &springs,
        forces: &forces,
        varied: Varied::Speed,
        coordinate: 1,
        borne: None,
    };
    let (_, first) = free.begin(amplitude, UPTO).into_iter().find(|(kind, _)| *kind == Kind::Flutter).unwrap();
    let alone = free.solve(&first, amplitude, 2, None).unwrap();
    let (lift, x) = ([2e-4, 1e-4], 5.0);
    let borne = Borne { forces: lift.to_vec(), pressure: x * x };
    let bearing = Oscillator { borne: Some(&borne), ..free };
    let found = bearing.solve(&first, amplitude, 2, None).unwrap();
    assert!((found.x / alone.x - 1.0).abs() < 1e-9 && (found.omega / alone.omega - 1.0).abs() < 1e-9);
    let (mean, still, square) = (&found.motion.mean, forces(0.0), found.x * found.x);
    for i in 0..2 {
        let springs: f64 =
            (0..2).map(|j| (matrices.stiffness[2 * i + j] - square * still[2 * i + j].re) * mean[j]).sum();
        let gas = (square - x * x) * lift[i];
        assert!((springs - gas).abs() < 1e-9 * lift[0], "{i}: {springs} {gas}");
    }
}
