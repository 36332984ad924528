//! Series in M² of the potential flow past a sphere (Janzen 1913, Rayleigh 1916).
//!
//! φ = φ0 + M² φ1 + M⁴ φ2 + … in ∇²φ = M² [½ ∇φ·∇q² − (γ−1)/2 (1 − q²) ∇²φ], q² = |∇φ|² = Q0 + M² Q1 + …, gives for n ≥ 1
//!
//! ∇²φn = ½ Σ ∇φi·∇Qj − (γ−1)/2 Σ (δj0 − Qj) ∇²φi, i + j = n − 1,
//!
//! which is a sequence of Poisson equations. Every φn is a sum of terms a r^p cosᶜθ lnᵏr. Each power of r on the
//! right-hand side is split into Legendre modes. The mode r^p Pl has the solution r^(p+2) Pl/((p+2)(p+3) − l(l+1)), or
//! r^(p+2) ln r Pl/(2p+5) if that divisor is zero; the harmonic function r^(−l−1) Pl cancels the flow through r = 1.
//! The first logarithm appears in φ3, as a factor of r⁻⁸ P7.
use std::collections::BTreeMap;

/// Number of terms in M² after the incompressible one: up to the first that contains a logarithm, because right-hand
/// sides with logarithms are not implemented.
const TERMS: usize = 3;
/// Magnitude below which a coefficient is regarded as round-off.
const ROUND_OFF: f64 = 1e-13;

/// Series Σ a r^p cosᶜθ lnᵏr: coefficients a by (p, c, k).
pub(super) type Series = BTreeMap<(i32, u32, u32), f64>;

/// Potentials φ0, …, φ3 with lengths divided by the radius and speeds by that of the free stream, which flows along θ =
/// 0.
pub(super) fn sphere_potentials(gamma: f64) -> Vec<Series> {
    let mut potential = vec![Series::from([((1, 1, 0), 1.0), ((-2, 1, 0), 0.5)])];
    let mut laplacian = vec![Series::new()];
    // the terms Q0 − 1, Q1, …
    let mut speed: Vec<Series> = Vec::new();
    for n in 1..=TERMS {
        let mut square = Series::new();
        (0..n).for_each(|i| add(&mut square, 1.0, &gradients(&potential[i], &potential[n - 1 - i])));
        if n == 1 {
            add(&mut square, -1.0, &Series::from([((0, 0, 0), 1.0)]));
        }
        speed.push(square);
        let mut source = Series::new();
        for (i, j) in (0..n).map(|i| (i, n - 1 - i)) {
            add(&mut source, 0.5, &gradients(&potential[i], &speed[j]));
            add(&mut source, 0.5 * (gamma - 1.0), &product(&laplacian[i], &speed[j]));
        }
        potential.push(solve(&source));
        laplacian.push(source);
    }
    potential
}

/// Value, ∂/∂r and ∂/∂cos θ of a series.
pub(super) fn evaluate(series: &Series, r: f64, cosine: f64) -> [f64; 3] {
    let at = |s: &Series| {
        let terms = s.iter().map(|(&(p, c, k), a)| a * r.powi(p) * cosine.powi(c as i32) * r.ln().powi(k as i32));
        terms.sum::<f64>()
    };
    [at(series), at(&along(series)), at(&across(series))]
}

/// Derivative ∂/∂r of a series.
fn along(series: &Series) -> Series {
    let mut out = Series::new();
    for (&(p, c, k), a) in series {
        *out.entry((p - 1, c, k)).or_default() += f64::from(p) * a;
        if k > 0 {
            *out.entry((p - 1, c, k - 1)).or_default() += f64::from(k) * a;
        }
    }
    out
}

/// Derivative ∂/∂cos θ of a series.
fn across(series: &Series) -> Series {
    let varying = series.iter().filter(|t| t.0.1 > 0);
    varying.map(|(&(p, c, k), a)| ((p, c - 1, k), f64::from(c) * a)).collect()
}

fn add(sum: &mut Series, factor: f64, other: &Series) {
    other.iter().for_each(|(key, a)| *sum.entry(*key).or_default() += factor * a);
    sum.retain(|_, a| a.abs() > ROUND_OFF);
}

fn product(a: &Series, b: &Series) -> Series {
    let mut out = Series::new();
    for (&(p, c, k), x) in a {
        b.iter().for_each(|(&(q, d, l), y)| *out.entry((p + q, c + d, k + l)).or_default() += x * y);
    }
    out
}

/// Product ∇a·∇b = a_r b_r + (1 − cos²θ)/r² a_c b_c, where the subscript c means ∂/∂cos θ.
fn gradients(a: &Series, b: &Series) -> Series {
    let metric = Series::from([((-2, 0, 0), 1.0), ((-2, 2, 0), -1.0)]);
    let mut out = product(&along(a), &along(b));
    add(&mut out, 1.0, &product(&metric, &product(&across(a), &across(b))));
    out
}

/// Solution φ of ∇²φ = `source` for a source without logarithms, with no flow through r = 1 and at infinity.
fn solve(source: &Series) -> Series {
    let mut rest = source.clone();
    let mut potential = Series::new();
    for l in (0..=source.keys().map(|k| k.1).max().unwrap_or(0)).rev() {
        let (mode, order) = (legendre(l), l as i32);
        let highest = rest.iter().filter(|t| t.0.1 == l).map(|(k, a)| (k.0, a / mode[&(0, l, 0)]));
        let parts: Vec<(i32, f64)> = highest.collect();
        let mut radial = Series::new();
        for (p, a) in parts {
            add(&mut rest, -a, &product(&Series::from([((p, 0, 0), 1.0)]), &mode));
            match (p + 2) * (p + 3) - order * (order + 1) {
                0 => radial.insert((p + 2, 0, 1), a / f64::from(2 * p + 5)),
                divisor => radial.insert((p + 2, 0, 0), a / f64::from(divisor)),
            };
        }
        let slope = evaluate(&radial, 1.0, 0.0)[1] / f64::from(order + 1);
        *radial.entry((-order - 1, 0, 0)).or_default() += slope;
        add(&mut potential, 1.0, &product(&radial, &mode));
    }
    potential
}

/// The Legendre polynomial of this degree in cos θ.
fn legendre(degree: u32) -> Series {
    let (mut last, mut own) = (Series::new(), Series::from([((0, 0, 0), 1.0)]));
    for l in 0..degree {
        let n = f64::from(l);
        let mut next = product(&Series::from([((0, 1, 0), (2.0 * n + 1.0) / (n + 1.0))]), &own);
        add(&mut next, -n / (n + 1.0), &last);
        (last, own) = (own, next);
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // modes of the first term, in powers of cos θ
    fn first_term_is_that_of_rayleigh() {
        let first = &sphere_potentials(1.4)[1];
        let modes = [
            (1, [(-2, 1.0 / 3.0), (-5, -0.2), (-8, 1.0 / 24.0), (-4, 0.0)]),
            (3, [(-2, -0.3), (-5, -0.3), (-8, 3.0 / 176.0), (-4, 27.0 / 55.0)]),
        ];
        let mut expected = Series::new();
        for (l, powers) in modes {
            powers
                .iter()
                .for_each(|(p, a)| add(&mut expected, 1.0, &product(&[((*p, 0, 0), *a)].into(), &legendre(l))));
        }
        add(&mut expected, -1.0, first);
        assert!(expected.values().all(|a| a.abs() < 1e-12), "{expected:?}");
    }

    #[test] // computed by hand in rational arithmetic: 324/55 r^-10 P7 is on the right-hand side
    fn third_term_has_one_logarithm() {
        let third = &sphere_potentials(1.4)[3];
        let logarithms: Vec<_> = third.iter().filter(|t| t.0.2 > 0).collect();
        assert!(logarithms.iter().all(|t| t.0.0 == -8), "{logarithms:?}");
        assert!((third[&(-8, 7, 1)] + 324.0 / 55.0 / 15.0 * 429.0 / 16.0).abs() < 1e-9);
    }

    #[test] // rational arithmetic of the same recursion
    fn second_term_on_the_surface() {
        let second = &sphere_potentials(1.4)[2];
        let slope = |c: f64| evaluate(second, 1.0, c)[2];
        let exact = |c2: f64| {
            40_408_434_991.0 / 113_809_696_000.0 - 65_226_969.0 / 41_385_344.0 * c2 + 831_087.0 / 695_552.0 * c2 * c2
        };
        for c in [0.0, 0.3, -0.7, 1.0] {
            assert!((slope(c) - exact(c * c)).abs() < 1e-11);
            assert!(evaluate(second, 1.0, c)[1].abs() < 1e-11, "no flow through the wall");
        }
    }
}
