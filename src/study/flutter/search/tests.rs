//! Boundaries with forces that are known: flutter from the start, and soft suspensions.
use super::super::clearance;
use super::super::held::problem_of;
use super::*;

/// A section in air with little mass of air around it: its plunge mode grows at every density at the speed of Mach 0.3.
const GROWS: &str = "[flow]\nmach = 0.3\npressure = \"1 atm\"\ntemperature = \"15 degC\"\n[[body]]\nnaca = \"0012\"\nchord = \"0.3 m\"\n[cloud]\n\
                     spacing = 0.012\n[structure]\nelastic_axis = -0.2\nmass = \"10 kg/m\"\nx_alpha = 0.2\ninertia = \"0.09 kg m\"\n\
                     frequency = { plunge = \"3 Hz\", pitch = \"5 Hz\" }\n";
/// Its forces at k: rows of plunge and pitch, column by column, in units of the solver.
const FORCES: [(f64, [[f64; 2]; 4]); 5] = [
    (0.0, [[-8.504660e-8, 0.0], [9.811097e-2, 0.0], [-2.647380e-8, 0.0], [4.064757e-3, 0.0]]),
    (
        0.02,
        [
            [-1.333899e-3, -1.259144e-2],
            [9.455464e-2, -8.676521e-3],
            [-6.096149e-5, -5.217885e-4],
            [3.920081e-3, -4.680344e-4],
        ],
    ),
    (
        0.08,
        [
            [-8.812848e-3, -4.325377e-2],
            [8.216308e-2, -1.197719e-2],
            [-4.639827e-4, -1.803859e-3],
            [3.432537e-3, -9.445946e-4],
        ],
    ),
    (
        0.2,
        [
            [-1.829953e-2, -8.553901e-2],
            [6.701737e-2, -4.785710e-3],
            [-1.442815e-3, -3.639672e-3],
            [2.886558e-3, -1.362829e-3],
        ],
    ),
    (
        0.5,
        [
            [1.090679e-2, -1.702388e-1],
            [5.572863e-2, 2.074302e-2],
            [-4.349283e-3, -7.510661e-3],
            [2.725270e-3, -2.192050e-3],
        ],
    ),
];
/// A section without units.
const PLAIN: &str = "[flow]\nmach = 0.3\n[[body]]\nnaca = \"0012\"\n[cloud]\nspacing = 0.04\n[structure]\nelastic_axis = -0.2\nmass_ratio = 20\n\
                     x_alpha = 0.2\nr_alpha2 = 0.25\n";
/// Its forces; those of plunge at rest are what computation leaves of none.
const PLAIN_FORCES: [(f64, [[f64; 2]; 4]); 5] = [
    (0.0, [[-6.849091e-8, 0.0], [3.272240e-1, 0.0], [-8.728841e-8, 0.0], [4.514862e-2, 0.0]]),
    (
        0.02,
        [
            [-1.345492e-3, -1.259456e-2],
            [3.152855e-1, -2.920496e-2],
            [-2.024072e-4, -1.738635e-3],
            [4.353802e-2, -5.181479e-3],
        ],
    ),
    (
        0.08,
        [
            [-8.922880e-3, -4.320057e-2],
            [2.736076e-1, -4.061088e-2],
            [-1.531271e-3, -6.011431e-3],
            [3.812339e-2, -1.040407e-2],
        ],
    ),
    (
        0.2,
        [
            [-1.860996e-2, -8.518817e-2],
            [2.226537e-1, -1.680796e-2],
            [-4.722353e-3, -1.215561e-2],
            [3.210002e-2, -1.492719e-2],
        ],
    ),
    (
        0.5,
        [
            [1.022317e-2, -1.688362e-1],
            [1.846445e-1, 6.806866e-2],
            [-1.414189e-2, -2.528510e-2],
            [3.040795e-2, -2.394245e-2],
        ],
    ),
];

/// The boundary of a case with forces that are known, and the margin to the design speed where that is given.
fn boundary(text: &str, forces: &[(f64, [[f64; 2]; 4])]) -> FlutterAt {
    let problem = problem_of(text);
    let (own, plan) = (problem.about_steady_flow(0.3).unwrap(), problem.case().flutter.clone().unwrap());
    let held = Held::of(&own);
    let scales = Scales::of(own.case(), held.chord, plan.matching);
    let sample = |(k, f): &(f64, [[f64; 2]; 4])| {
        (scales.angular_frequency(*k), f.iter().map(|z| Complex64::new(z[0], z[1])).collect())
    };
    let search = Search::new(&held, &scales, &plan, forces.iter().map(sample).collect(), 1e-5);
    let mut at = search.again();
    if let Some(design) = plan.design_speed {
        clearance::tell(&mut at, design.0, (&scales, scales.upto(plan.most)));
    }
    at
}

#[test]
fn flutter_at_every_density_is_a_row_near_zero_and_does_not_pass() {
    for (matching, altitude) in [("density", false), ("altitude", true)] {
        let text = format!("{GROWS}[flutter]\nmatch = \"{matching}\"\ndesign_speed = \"20 m/s\"\n");
        let at = boundary(&text, &FORCES);
        let first = &at.crossings[0];
        assert!(first.kind == "flutter" && first.branch == "mode 1", "{:?}", at.crossings);
        // its growth is of the second order in the density: in doubt at still smaller ones
        assert!(first.density < 2e-4 && first.equivalent_airspeed.is_some_and(|v| v < 1.0), "{first:?}");
        assert!(first.altitude.is_some() == altitude && (first.frequency - 2.9249).abs() < 1e-3, "{first:?}");
        assert!(first.speed > 80.0 && first.reduced_frequency.is_finite());
        let clearance = at.clearance.clone().unwrap();
        assert!(!clearance.passes && clearance.margin.is_some_and(|m| m < -0.95), "{clearance:?}");
        // what files have no word for is told as unknown, and read so
        let file = serde_json::to_string(&at).unwrap();
        let again: FlutterAt = serde_json::from_str(&file).unwrap();
        assert_eq!(again.crossings[0].branch, "mode 1");
    }
}

#[test]
fn at_constant_density_the_same_section_flutters_at_its_speed() {
    let at = boundary(&format!("{GROWS}[flutter]\ndesign_speed = \"25 m/s\"\n"), &FORCES);
    let first = &at.crossings[0];
    assert!(first.kind == "flutter" && (first.equivalent_airspeed.unwrap() / 20.3 - 1.0).abs() < 0.01, "{first:?}");
    assert!(at.growing_from_start.is_empty() && !at.clearance.unwrap().passes, "{:?}", at.warnings);
}

#[test]
fn structural_damping_moves_flutter_to_a_density_above_zero() {
    let damped = GROWS.replace("frequency =", "damping_ratio = { plunge = 0.01, pitch = 0.01 }\nfrequency =");
    let at = boundary(&format!("{damped}[flutter]\nmatch = \"density\"\ndesign_speed = \"20 m/s\"\n"), &FORCES);
    let first = &at.crossings[0];
    assert!(first.kind == "flutter" && first.dynamic_pressure > 25.0 && first.g_method.is_some(), "{first:?}");
    assert!(!at.warnings.iter().any(|w| w.contains("thin")), "{:?}", at.warnings);
}

#[test] // a steady displacement in plunge has no force: K_α = q Q_αα whatever holds plunge
fn divergence_does_not_go_with_the_stiffness_of_a_soft_plunge() {
    let of = |plunge: f64| {
        let text = format!("{PLAIN}stiffness = {{ plunge = {plunge:e}, pitch = 0.3 }}\n[flutter]\n");
        let at = boundary(&text, &PLAIN_FORCES);
        let row = at.crossings.iter().find(|c| c.kind == "divergence").cloned();
        (row.unwrap_or_else(|| panic!("{plunge}: {:?}", at.crossings)).speed_ratio, at.notes.join("\n"))
    };
    let (held, _) = of(0.05);
    assert!((held / 2.578 - 1.0).abs() < 1e-3, "{held}");
    for plunge in [1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8] {
        let (found, notes) = of(plunge);
        assert!((found / held - 1.0).abs() < 1e-5, "{plunge}: {found} {held}");
        assert!(!notes.contains("inertia relief"), "{notes}");
    }
    let (free, notes) = of(0.0);
    assert!((free / 1.963 - 1.0).abs() < 1e-3, "{free}");
    let told = format!(
        "is that of a body that is free in `plunge` and accelerates under its load (inertia relief): with a spring of `plunge`, however soft, it begins at {held:.4}"
    );
    assert!(notes.contains(&told), "{notes}");
}
