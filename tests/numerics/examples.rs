//! The programs in `examples/` do what they say.

#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/derivative.rs"]
mod derivative;
#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/flutter.rs"]
mod flutter;
#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/own_structure.rs"]
mod own_structure;
#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/polar.rs"]
mod polar;
#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/section_on_springs.rs"]
mod section_on_springs;
#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/shock_tube.rs"]
mod shock_tube;
#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/solid.rs"]
mod solid;
#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/steady.rs"]
mod steady;
#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/van_der_pol.rs"]
mod van_der_pol;

#[test]
fn derivatives_converge() {
    let errors = derivative::run().unwrap();
    assert!(errors.windows(2).all(|e| e[1] < 0.6 * e[0]), "{errors:?}");
}

#[test]
fn the_shock_tube_agrees_with_the_exact_solution() {
    let error = shock_tube::run().unwrap();
    assert!(error < 0.01, "{error}");
}

#[test]
fn lift_grows_as_that_of_a_thin_airfoil() {
    let polar: Vec<f64> = polar::run().unwrap().iter().map(|point| point.loads.unwrap().cl).collect();
    let slope = (polar[3] - polar[1]) / f64::to_radians(4.0);
    // 2π (1 + 0.77 · 12 %)/√(1 − M²): thin airfoil with thickness, Prandtl-Glauert
    let exact = std::f64::consts::TAU * 1.0924 / (1.0 - 0.09f64).sqrt();
    assert!((slope / exact - 1.0).abs() < 0.05 && polar[1].abs() < 1e-3, "{slope} {exact} {polar:?}");
    assert!((polar[0] + polar[2]).abs() < 1e-2 * polar[2], "{polar:?}");
}

#[test]
fn balance_and_march_of_an_oscillator_agree() {
    let [balance, march] = van_der_pol::run().unwrap();
    assert!((balance - march).abs() < 1e-6, "{balance} {march}");
}

#[test]
fn the_spring_carries_the_lift() {
    let [spring, lift] = section_on_springs::run().unwrap();
    assert!(lift > 0.005 && (spring / lift - 1.0).abs() < 1e-4, "{spring} {lift}");
}

#[test]
fn a_steady_flow_has_loads_and_their_convergence() {
    let flow = steady::run().unwrap();
    let (loads, family) = (flow.loads(), flow.grid_convergence().unwrap());
    // 2π (1 + 0.77 · 12 %)/√(1 − M²) times the angle
    let exact = std::f64::consts::TAU * 1.0924 / 0.75f64.sqrt() * f64::to_radians(2.0);
    assert!((loads.cl / exact - 1.0).abs() < 0.08 && flow.convergence().converged, "{loads:?} {exact}");
    assert!(family.half_widths().cl > 0.0 && !flow.field().points.is_empty());
    // a summary is read by the types that write it
    let text = serde_json::to_string(flow.summary()).unwrap();
    let again: alula::record::summary::Summary = serde_json::from_str(&text).unwrap();
    assert_eq!(serde_json::to_string(&again).unwrap(), text);
}

#[test]
fn the_section_flutters_near_the_speed_of_thin_ones() {
    let boundary = flutter::run().unwrap();
    let first = boundary.flutter[0].crossings.iter().find(|c| c.kind == "flutter").unwrap();
    // thin sections begin at 6.15 with compressibility at Mach 0.3, thick ones in a faster stream earlier
    assert!(first.reduced_speed.is_some_and(|speed| (4.5..6.5).contains(&speed)), "{first:?}");
}

/// f = (βL)² √(EI/ρA)/(2π L²) with βL = 1.8751, for plane stress without Poisson's ratio; a bar ten times as long as it is thick is softer in
/// shear by a part in a hundred.
#[test]
fn the_bar_has_the_frequencies_of_a_cantilever() {
    let modes = solid::run().unwrap().summary.modes;
    let exact = 1.8751f64.powi(2) * (1e7 * 0.05f64.powi(2) / 12.0 / 1000.0).sqrt() / (std::f64::consts::TAU * 0.25);
    assert!((modes[0].frequency / exact - 1.0).abs() < 0.05, "{} {exact}", modes[0].frequency);
}

#[test]
fn unbalance_makes_a_section_flutter_earlier() {
    let found = own_structure::run().unwrap();
    assert!(found.windows(2).all(|pair| pair[1].1 < pair[0].1), "{found:?}");
}
