//! Finite rotations by a rotation vector θ: by the angle |θ| (rad) about the direction of θ, right-handed.
//!
//! With s = |θ|² and Stumpff's functions c_k(s) = Σ_n (−s)ⁿ/(2n + k)! (c₀ = cos|θ|, c₁ = sin|θ|/|θ|), which are smooth
//! at s = 0, Rodrigues' formula is R x = x + c₁ θ×x + c₂ θ×(θ×x). The angular velocity in body axes is ω = T θ', T y =
//! y − c₂ θ×y + c₃ θ×(θ×y) (Géradin and Cardona, Flexible Multibody Dynamics, 2001, chapter 4). T is singular if |θ| is
//! a non-zero multiple of 2π: a rotation vector describes less than one turn in either direction.
use crate::math::jet::Scalar;

/// Limit of s below which the series is summed; above, the recurrence c_{k+2} = (1/k! − c_k)/s is accurate.
const SERIES: f64 = 4.0;
/// Number of terms of that series: 4^n/(2n)! is then below round-off.
const TERMS: usize = 14;

/// Three components of a vector.
pub type Triple<S> = [S; 3];

/// c_k(s) for s ≥ 0.
fn stumpff(k: usize, s: f64) -> f64 {
    if s < SERIES {
        // Horner's scheme, starting from the last term
        let factor = |n: usize| -s / ((2 * n + k) as f64 * (2 * n + k - 1) as f64);
        let sum = (1..=TERMS).rev().fold(1.0, |sum, n| 1.0 + sum * factor(n));
        return sum / factorial(k);
    }
    let root = s.sqrt();
    match k {
        0 => root.cos(),
        1 => root.sin() / root,
        _ => (1.0 / factorial(k - 2) - stumpff(k - 2, s)) / s,
    }
}

fn factorial(k: usize) -> f64 {
    (2..=k).fold(1.0, |product, i| product * i as f64)
}

/// Derivative dc_k/ds = (k c_{k+2} − c_{k+1})/2.
fn slope(k: usize, s: f64) -> f64 {
    0.5 * (k as f64 * stumpff(k + 2, s) - stumpff(k + 1, s))
}

/// c_k(s) for any scalar type.
fn coefficient<S: Scalar>(k: usize, s: S) -> S {
    s.map(|s| [stumpff(k, s), slope(k, s), 0.5 * (k as f64 * slope(k + 2, s) - slope(k + 1, s))])
}

/// A vector of constants, with zero derivatives.
pub fn constants<S: Scalar>(x: &[f64; 3]) -> Triple<S> {
    x.map(S::constant)
}

/// Cross product a × b.
pub fn cross<S: Scalar>(a: &Triple<S>, b: &Triple<S>) -> Triple<S> {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j] * b[k] - a[k] * b[j]
    })
}

/// Inner product a · b.
pub fn dot<S: Scalar>(a: &Triple<S>, b: &Triple<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Sum a + b.
pub fn sum<S: Scalar>(a: &Triple<S>, b: &Triple<S>) -> Triple<S> {
    std::array::from_fn(|i| a[i] + b[i])
}

/// The vector x + f θ×x + g θ×(θ×x).
fn turned<S: Scalar>(theta: &Triple<S>, f: S, g: S, x: &Triple<S>) -> Triple<S> {
    let once = cross(theta, x);
    let twice = cross(theta, &once);
    std::array::from_fn(|i| x[i] + f * once[i] + g * twice[i])
}

/// Rotated vector R(θ) x.
pub fn rotate<S: Scalar>(theta: &Triple<S>, x: &Triple<S>) -> Triple<S> {
    let s = dot(theta, theta);
    turned(theta, coefficient(1, s), coefficient(2, s), x)
}

/// Inverse rotation R(θ)ᵀ x.
pub fn rotate_back<S: Scalar>(theta: &Triple<S>, x: &Triple<S>) -> Triple<S> {
    rotate(&theta.map(|c| -c), x)
}

/// Angular velocity ω = T(θ) θ' in body axes for the rate θ'.
pub fn body_rate<S: Scalar>(theta: &Triple<S>, rate: &Triple<S>) -> Triple<S> {
    let s = dot(theta, theta);
    turned(theta, -coefficient(2, s), coefficient(3, s), rate)
}

/// Generalised forces T(θ)ᵀ y of θ for a moment y in body axes.
pub fn generalised_moment<S: Scalar>(theta: &Triple<S>, y: &Triple<S>) -> Triple<S> {
    let s = dot(theta, theta);
    turned(theta, coefficient(2, s), coefficient(3, s), y)
}

/// Angular acceleration dω/dt = T θ'' + T' θ' in body axes.
pub fn body_acceleration<S: Scalar>(theta: &Triple<S>, rate: &Triple<S>, second: &Triple<S>) -> Triple<S> {
    let s = dot(theta, theta);
    let s_rate = S::constant(2.0) * dot(theta, rate);
    let change = |k: usize| {
        let c = S::constant(k as f64) * coefficient(k + 2, s) - coefficient(k + 1, s);
        S::constant(0.5) * c * s_rate
    };
    let across = cross(theta, rate);
    let (twice, other) = (cross(theta, &across), cross(rate, &across));
    let (first, third, c3) = (change(2), change(3), coefficient(3, s));
    let direct = body_rate(theta, second);
    std::array::from_fn(|i| direct[i] - first * across[i] + third * twice[i] + c3 * other[i])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::jet::Jet;

    #[test]
    fn coefficients_are_those_of_trigonometry_and_their_derivatives() {
        for s in [0.0, 1e-12, 0.3, 3.9, 4.1, 20.0, 39.0] {
            let root = f64::sqrt(s);
            assert!((stumpff(0, s) - root.cos()).abs() < 1e-14, "{s}");
            if s > 0.1 {
                assert!((stumpff(2, s) - (1.0 - root.cos()) / s).abs() < 1e-14);
                assert!((stumpff(3, s) - (root - root.sin()) / (s * root)).abs() < 1e-14);
            }
            let h = 1e-4 * (1.0 + s);
            for k in 0..6 {
                let back = if s < h { s } else { s - h };
                let difference = (stumpff(k, s + h) - stumpff(k, back)) / (s + h - back);
                let middle = slope(k, 0.5 * (s + h + back));
                assert!((difference - middle).abs() < 1e-8, "{k} at {s}: {difference}, {middle}");
            }
        }
    }

    /// A curve θ(t) through many rotations.
    fn curve(t: f64) -> [f64; 3] {
        [t.sin(), 0.3 + 0.8 * t, (0.7 * t).cos() * t]
    }

    fn jets(t: f64) -> [[f64; 3]; 3] {
        let h = 1e-4;
        let (a, b, c) = (curve(t - h), curve(t), curve(t + h));
        let first = std::array::from_fn(|i| (c[i] - a[i]) / (2.0 * h));
        let second = std::array::from_fn(|i| (c[i] - 2.0 * b[i] + a[i]) / (h * h));
        [b, first, second]
    }

    #[test]
    fn rotations_keep_lengths_and_turn_right_handed() {
        let theta = [0.0, 0.0, std::f64::consts::FRAC_PI_2];
        let turned = rotate(&theta, &[1.0, 0.0, 0.0]);
        assert!((turned[1] - 1.0).abs() < 1e-15 && turned[0].abs() < 1e-15);
        for t in [0.0, 0.4, 1.9, 3.0] {
            let x = [0.3, -0.5, 0.8];
            let y = rotate(&curve(t), &x);
            assert!((dot(&x, &x) - dot(&y, &y)).abs() < 1e-14);
            let back = rotate_back(&curve(t), &y);
            assert!((0..3).all(|i| (back[i] - x[i]).abs() < 1e-14));
        }
    }

    #[test] // d(R x)/dt = R (ω × x), and dω/dt
    fn rates_are_those_of_the_rotation() {
        for t in [0.2, 1.1, 2.5] {
            let [theta, first, second] = jets(t);
            let omega = body_rate(&theta, &first);
            let x = [0.3, -0.5, 0.8];
            let expected = rotate(&theta, &cross(&omega, &x));
            // derivatives along the curve, by automatic differentiation
            let along: [Jet; 3] = std::array::from_fn(|i| Jet { value: theta[i], first: first[i], second: second[i] });
            let moved = rotate(&along, &constants(&x));
            let change =
                body_rate(&along, &std::array::from_fn(|i| Jet { value: first[i], first: second[i], second: 0.0 }));
            let acceleration = body_acceleration(&theta, &first, &second);
            for i in 0..3 {
                assert!((moved[i].first - expected[i]).abs() < 1e-12);
                assert!((change[i].first - acceleration[i]).abs() < 1e-12);
            }
            // the transpose: y · T θ' = Tᵀ y · θ'
            let y = [0.2, 0.9, -0.4];
            assert!((dot(&y, &omega) - dot(&generalised_moment(&theta, &y), &first)).abs() < 1e-14);
        }
    }
}
