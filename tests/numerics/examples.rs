//! The programs in `examples/` do what they say.

#[allow(dead_code, reason = "the program itself")]
#[path = "../../examples/derivative.rs"]
mod derivative;
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
    let polar = polar::run().unwrap();
    let slope = (polar[3].1 - polar[1].1) / f64::to_radians(4.0);
    // 2π (1 + 0.77 · 12 %)/√(1 − M²): thin airfoil with thickness, Prandtl-Glauert
    let exact = std::f64::consts::TAU * 1.0924 / (1.0 - 0.09f64).sqrt();
    assert!((slope / exact - 1.0).abs() < 0.05 && polar[1].1.abs() < 1e-3, "{slope} {exact} {polar:?}");
    assert!((polar[0].1 + polar[2].1).abs() < 1e-2 * polar[2].1, "{polar:?}");
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
