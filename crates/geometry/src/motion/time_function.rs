//! Scalar functions of time, of which a motion is a sum.
//!
//! Every function is coded once, generic in [`Scalar`]; velocity and acceleration follow by automatic differentiation.
use std::f64::consts::TAU;

use super::spline::Spline;
use crate::case::formula::{Formula, Function, Operation};
use crate::math::jet::{Jet, Scalar};

/// Relative difference of a formula after one period below which it is periodic: far above round-off and far below any
/// real motion.
const REPEATS: f64 = 1e-9;
/// Number of times at which a formula is compared with itself one period later.
const SAMPLES: usize = 29;

/// Greatest number of periods of one part of a motion in the common period.
pub const MOST_PERIODS: u32 = 64;

/// A scalar function of time.
#[derive(Clone, Debug)]
pub enum TimeFunction {
    /// The sine amplitude·sin(ωt + phase).
    Sine {
        /// Amplitude.
        amplitude: f64,
        /// Angular frequency ω.
        omega: f64,
        /// Phase [rad].
        phase: f64,
    },
    /// The linear function rate·t.
    Steady(f64),
    /// A cubic spline through a table.
    Spline(Spline),
    /// A formula of a case file, in the time of the case.
    Formula {
        /// The formula in t and ω.
        formula: Formula,
        /// Angular frequency ω in the formula, in the units of its time.
        omega: f64,
        /// Length of the solver's unit of time in units of the formula's time.
        time: f64,
    },
    /// The parabola value + rate (t − about) + acceleration (t − about)²/2, which represents an unknown coordinate near
    /// one time.
    Momentary {
        /// The time `about`.
        about: f64,
        /// Value, rate and acceleration at that time.
        jet: Jet,
    },
}

/// Periodicity of a function of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Repeat {
    /// The function is constant.
    Constant,
    /// The function is periodic with this period.
    Every(f64),
    /// The function is not periodic.
    Never,
}

impl TimeFunction {
    /// Value at time `t`.
    pub fn at<S: Scalar>(&self, t: S) -> S {
        match self {
            Self::Sine { amplitude, omega, phase } => {
                S::constant(*amplitude) * (t * S::constant(*omega) + S::constant(*phase)).sin()
            }
            Self::Steady(rate) => t * S::constant(*rate),
            Self::Spline(spline) => spline.at(t),
            Self::Formula { formula, omega, time } => evaluate(formula, t * S::constant(*time), *omega),
            Self::Momentary { about, jet } => {
                let passed = t - S::constant(*about);
                let half = S::constant(0.5 * jet.second) * passed * passed;
                S::constant(jet.value) + S::constant(jet.first) * passed + half
            }
        }
    }

    /// Periodicity of the function as a displacement.
    pub fn repeat(&self) -> Repeat {
        match self {
            Self::Sine { amplitude: 0.0, .. } | Self::Steady(0.0) => Repeat::Constant,
            Self::Sine { omega, .. } => Repeat::Every(TAU / omega),
            Self::Steady(_) => Repeat::Never,
            Self::Spline(spline) => spline.period().map_or(Repeat::Never, Repeat::Every),
            Self::Formula { formula, .. } if !formula.contains(&Formula::Time) => Repeat::Constant,
            Self::Formula { omega, time, .. } if *omega > 0.0 && self.repeats_after(TAU / (omega * time)) => {
                Repeat::Every(TAU / (omega * time))
            }
            Self::Formula { .. } | Self::Momentary { .. } => Repeat::Never,
        }
    }

    /// Compares the function with itself one period later, at times that no harmonic has in common.
    fn repeats_after(&self, period: f64) -> bool {
        let golden = 0.618_033_988_749_894_9;
        let times = (0..SAMPLES).map(|k| period * (golden * k as f64).fract() * 3.0);
        let pairs: Vec<(f64, f64)> = times.map(|t| (self.at(t), self.at(t + period))).collect();
        let size = pairs.iter().fold(0.0f64, |m, (a, _)| m.max(a.abs()));
        pairs.iter().all(|(a, b)| (a - b).abs() <= REPEATS * size)
    }
}

/// Value of a formula at time `t`.
fn evaluate<S: Scalar>(formula: &Formula, t: S, omega: f64) -> S {
    match formula {
        Formula::Number(x) => S::constant(*x),
        Formula::Time => t,
        Formula::Omega => S::constant(omega),
        // formulas of time do not contain coordinates
        Formula::Coordinate(_) => S::constant(0.0),
        Formula::Negative(a) => -evaluate(a, t, omega),
        Formula::Call(function, a) => call(*function, evaluate(a, t, omega)),
        Formula::Pair(operation, a, b) => {
            let (x, y) = (evaluate(a, t, omega), evaluate(b, t, omega));
            match operation {
                Operation::Add => x + y,
                Operation::Subtract => x - y,
                Operation::Multiply => x * y,
                Operation::Divide => x / y,
                Operation::Min => {
                    if y.value() < x.value() {
                        y
                    } else {
                        x
                    }
                }
                Operation::Max => {
                    if y.value() > x.value() {
                        y
                    } else {
                        x
                    }
                }
                Operation::Power if b.contains(&Formula::Time) => call(Function::Exp, y * call(Function::Ln, x)),
                Operation::Power => power(x, y.value()),
            }
        }
    }
}

/// xⁿ for a constant n; the chain of derivatives ends when a factor n or n − 1 is zero.
fn power<S: Scalar>(x: S, n: f64) -> S {
    x.map(|x| {
        let term = |factor: f64, m: f64| if factor == 0.0 { 0.0 } else { factor * x.powf(m) };
        [x.powf(n), term(n, n - 1.0), term(n * (n - 1.0), n - 2.0)]
    })
}

fn call<S: Scalar>(function: Function, x: S) -> S {
    match function {
        Function::Sin => x.sin(),
        Function::Cos => x.cos(),
        _ => x.map(|x| derivatives(function, x)),
    }
}

/// Value, first and second derivative of a function.
fn derivatives(function: Function, x: f64) -> [f64; 3] {
    match function {
        Function::Sin => [x.sin(), x.cos(), -x.sin()],
        Function::Cos => [x.cos(), -x.sin(), -x.cos()],
        Function::Tan => {
            let slope = 1.0 + x.tan().powi(2);
            [x.tan(), slope, 2.0 * x.tan() * slope]
        }
        Function::Asin | Function::Acos => {
            let slope = 1.0 / (1.0 - x * x).sqrt();
            let (value, sign) = if function == Function::Asin { (x.asin(), 1.0) } else { (x.acos(), -1.0) };
            [value, sign * slope, sign * x * slope.powi(3)]
        }
        Function::Atan => {
            let slope = 1.0 / (1.0 + x * x);
            [x.atan(), slope, -2.0 * x * slope * slope]
        }
        Function::Sinh => [x.sinh(), x.cosh(), x.sinh()],
        Function::Cosh => [x.cosh(), x.sinh(), x.cosh()],
        Function::Tanh => {
            let slope = 1.0 - x.tanh().powi(2);
            [x.tanh(), slope, -2.0 * x.tanh() * slope]
        }
        Function::Exp => [x.exp(); 3],
        Function::Ln => [x.ln(), 1.0 / x, -1.0 / (x * x)],
        Function::Sqrt => {
            let root = x.sqrt();
            [root, 0.5 / root, -0.25 / (root * x)]
        }
        Function::Abs => [x.abs(), if x < 0.0 { -1.0 } else { 1.0 }, 0.0],
    }
}

/// The common periodicity of all functions: the shortest time after which each of them repeats.
pub(super) fn common(repeats: impl IntoIterator<Item = Repeat>) -> Repeat {
    repeats.into_iter().fold(Repeat::Constant, |a, b| match (a, b) {
        (Repeat::Never, _) | (_, Repeat::Never) => Repeat::Never,
        (Repeat::Constant, other) | (other, Repeat::Constant) => other,
        (Repeat::Every(a), Repeat::Every(b)) => least_multiple(a, b).map_or(Repeat::Never, Repeat::Every),
    })
}

/// Least common multiple of two periods: n·a = m·b with small integers n and m.
fn least_multiple(a: f64, b: f64) -> Option<f64> {
    let matches = |n: u32| {
        let m = f64::from(n) * a / b;
        m.round() >= 1.0 && m.round() <= f64::from(MOST_PERIODS) && (m - m.round()).abs() <= REPEATS * m
    };
    (1..=MOST_PERIODS).find(|n| matches(*n)).map(|n| f64::from(n) * a)
}

/// Value of a sum of functions, with derivatives as `S` carries them.
pub(super) fn total<S: Scalar>(functions: &[TimeFunction], t: S) -> S {
    functions.iter().fold(S::constant(0.0), |sum, function| sum + function.at(t))
}

/// Value, rate and acceleration of a sum of functions.
pub(super) fn total_with_rates(functions: &[TimeFunction], t: f64) -> Jet {
    total(functions, Jet::variable(t))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula(text: &str, omega: f64) -> TimeFunction {
        TimeFunction::Formula { formula: Formula::parse(text).unwrap(), omega, time: 1.0 }
    }

    #[test]
    fn formulas_have_the_values_and_derivatives_of_mathematics() {
        let cases: [(&str, f64, [f64; 3]); 8] = [
            ("-t^2", 0.5, [-0.25, -1.0, -2.0]),
            ("2^t", 1.0, [2.0, 2.0 * 2f64.ln(), 2.0 * 2f64.ln().powi(2)]),
            ("t^0 + t^1", 0.0, [1.0, 1.0, 0.0]),
            ("sqrt(4*t)", 1.0, [2.0, 1.0, -0.5]),
            ("abs(-3*t)", 2.0, [6.0, 3.0, 0.0]),
            ("max(t, 1) + min(t^2, 1)", 3.0, [4.0, 1.0, 0.0]),
            ("omega * sin(pi * t) / deg", 1.0, [0.0, -360.0, 0.0]),
            ("sqrt(0) + ln(e) * t", 1.0, [1.0, 1.0, 0.0]),
        ];
        for (text, t, expected) in cases {
            let jet = formula(text, 2.0).at(Jet::variable(t));
            for (x, y) in [jet.value, jet.first, jet.second].into_iter().zip(expected) {
                assert!((x - y).abs() <= 1e-12 * (1.0 + y.abs()), "{text}: {jet:?}, not {expected:?}");
            }
            assert_eq!(formula(text, 2.0).at(t), jet.value, "{text}");
        }
    }

    #[test]
    fn all_functions_agree_with_differences() {
        let h = 1e-4;
        for name in Formula::vocabulary().skip(5) {
            let text = if ["min", "max"].contains(&name) { format!("{name}(t, 0.3)") } else { format!("{name}(t)") };
            let function = formula(&text, 1.0);
            for t in [0.21, 0.47, 0.8] {
                let (a, b, c) = (function.at(t - h), function.at(t), function.at(t + h));
                let jet = function.at(Jet::variable(t));
                assert!((jet.first - (c - a) / (2.0 * h)).abs() < 1e-6, "{text} {t} {jet:?}");
                assert!((jet.second - (c - 2.0 * b + a) / (h * h)).abs() < 1e-5, "{text} {t} {jet:?}");
            }
        }
    }

    #[test]
    fn periods_are_found() {
        let every = |c: &TimeFunction| c.repeat();
        assert_eq!(every(&TimeFunction::Sine { amplitude: 1.0, omega: TAU, phase: 0.3 }), Repeat::Every(1.0));
        assert_eq!(every(&TimeFunction::Steady(1.0)), Repeat::Never);
        assert_eq!(every(&formula("sin(omega*t) + cos(3*omega*t)^2", TAU)), Repeat::Every(1.0));
        assert_eq!(every(&formula("sin(omega*t/2)", TAU)), Repeat::Never);
        assert_eq!(every(&formula("t", TAU)), Repeat::Never);
        assert_eq!(every(&formula("sin(t)", 0.0)), Repeat::Never);
        assert_eq!(every(&formula("2 * deg", TAU)), Repeat::Constant);
        let all = |list: &[f64]| common(list.iter().map(|t| Repeat::Every(*t)));
        assert_eq!(all(&[0.5, 0.75]), Repeat::Every(1.5));
        assert_eq!(all(&[1.0, 2f64.sqrt()]), Repeat::Never);
        assert_eq!(common([Repeat::Constant, Repeat::Every(2.0)]), Repeat::Every(2.0));
        assert_eq!(common([]), Repeat::Constant);
    }
}
