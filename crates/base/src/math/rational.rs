//! Rational functions through a few values on the imaginary axis.
//!
//! Functions with f(s̄) = f̄(s) are known at s = iω_m and are approximated with a common denominator,
//!
//! r(s) = Σ_j w_j f_j/(s − z_j) / Σ_j w_j/(s − z_j),
//!
//! which has the value f_j at each support point z_j for any weights. The AAA algorithm (Nakatsukasa, Sète and
//! Trefethen, SIAM J. Sci. Comput. 40, 2018; for sets of functions Lietaert, Meerbergen, Pérez and Vandereycken, IMA J.
//! Numer. Anal. 42, 2022, doi:10.1093/imanum/drab098) selects the samples with the largest error as support points, one
//! after another. The weights, of unit norm, minimise Σ_m |Σ_j w_j (f(iω_m) − f_j)/(iω_m − z_j)|² over the other
//! samples and all functions, each divided by its largest modulus. Here support points are pairs ±iω with weights w and
//! w̄, so that the unknowns are real and r(s̄) = r̄(s) holds exactly. The sample at zero is fitted, and becomes a
//! support point only if necessary.
//!
//! Limits: if samples contain more noise than `tolerance` allows, poles may lie in the right half plane or on the axis;
//! see [`Rational::poles`]. Far above the highest sample, r tends to a constant, or grows like s² if the sum of the
//! weights is zero, as for inertia forces.
use num_complex::Complex64;

use super::eigenvalues::eigenvalues;
use super::singular::Singular;

/// Error at round-off level: more support points would only fit rounding errors.
const ROUND_OFF: f64 = 1e-13;
/// Ratio of a singular value to the largest one below which its vector of weights is regarded as an exact solution.
const NULL: f64 = 1e-13;
const ZERO: Complex64 = Complex64::new(0.0, 0.0);

/// A pair of support points iω and −iω, or the one at zero.
#[derive(Clone, Debug)]
struct Support {
    omega: f64,
    /// Weight of iω; that of −iω is its conjugate.
    weight: Complex64,
    /// Values at iω.
    values: Vec<Complex64>,
}

/// Rational functions with a common denominator, real on the real axis.
#[derive(Clone, Debug)]
pub struct Rational {
    support: Vec<Support>,
    misfit: f64,
    /// True for a single sample: the functions have its values above the real axis and their conjugates below.
    constant: bool,
}

/// Samples of all functions.
struct Samples {
    omegas: Vec<f64>,
    values: Vec<Vec<Complex64>>,
    /// Largest modulus of each function; 1 for a function that is zero.
    scales: Vec<f64>,
}

impl Rational {
    /// Fits functions to `samples`: frequencies ω ≥ 0, each only once and in any order, with the values of all
    /// functions at iω; at ω = 0 only real parts are used. Support points are added until the maximum error at a
    /// sample, divided by the largest modulus of the function, is at most `tolerance`, or until the other samples are
    /// too few for more weights; the result is the best of these fits. If no function of first order fits two samples,
    /// the result is one without poles on the axis. One sample gives a constant above the real axis and its conjugate
    /// below. Returns `None` if there are no samples, or if values are missing or not finite.
    pub fn of(samples: &[(f64, Vec<Complex64>)], tolerance: f64) -> Option<Self> {
        let samples = Samples::new(samples)?;
        let count = samples.omegas.len();
        if count == 1 {
            return Some(Self { support: vec![samples.support(0, Complex64::from(1.0))], misfit: 0.0, constant: true });
        }
        let enough = tolerance.max(ROUND_OFF);
        let (mut chosen, mut misfits, mut best) = (Vec::new(), samples.deviations(), None::<Self>);
        while let Some(next) = samples.next(&chosen, &misfits) {
            chosen.push(next);
            let found = samples.fit(&chosen, &samples.weights(&chosen));
            misfits = samples.misfits(&found);
            let misfit = found.misfit;
            if best.as_ref().is_none_or(|old| misfit < old.misfit) {
                best = Some(found);
            }
            if misfit <= enough {
                break;
            }
        }
        if count == 2 && !best.as_ref().is_some_and(|found| found.misfit <= enough) {
            let all = [0, 1];
            return Some(samples.fit(&all, &samples.alternating(&all)));
        }
        best
    }

    /// Values of all functions at `s`; not finite at a pole.
    pub fn at(&self, s: Complex64) -> Vec<Complex64> {
        let width = self.support.first().map_or(0, |point| point.values.len());
        let (mut above, mut below) = (vec![ZERO; width], ZERO);
        for point in &self.support {
            if self.constant || (s.re == 0.0 && s.im.abs() == point.omega) {
                return point.values.iter().map(|value| of_half(*value, s.im)).collect();
            }
            let ahead = point.weight / (s - Complex64::new(0.0, point.omega));
            // the support point at zero has no conjugate partner
            let partner =
                if point.omega == 0.0 { ZERO } else { point.weight.conj() / (s + Complex64::new(0.0, point.omega)) };
            below += ahead + partner;
            above.iter_mut().zip(&point.values).for_each(|(sum, f)| *sum += ahead * f + partner * f.conj());
        }
        above.into_iter().map(|sum| sum / below).collect()
    }

    /// Maximum error at a sample, divided by the largest modulus of the function.
    pub fn misfit(&self) -> f64 {
        self.misfit
    }

    /// Poles: zeros of Σ w_j/(s − z_j). With W = Σ w_j they are the eigenvalues, except one that is zero, of z − e
    /// (wᵀz)/W, here written for the real and imaginary parts of the pairs. Empty if W = 0 or the eigenvalues do not
    /// converge.
    pub fn poles(&self) -> Vec<Complex64> {
        if self.constant {
            return Vec::new();
        }
        // rows of each support point: real part and, except at zero, imaginary part
        let parts = |point: &Support| if point.omega == 0.0 { 1 } else { 2 };
        let n: usize = self.support.iter().map(parts).sum();
        let (mut matrix, mut row, mut ones) = (vec![0.0; n * n], vec![0.0; n], vec![0.0; n]);
        let (mut total, mut k) = (0.0, 0);
        for point in &self.support {
            let (omega, w) = (point.omega, point.weight);
            ones[k] = 1.0;
            if omega == 0.0 {
                total += w.re;
            } else {
                total += 2.0 * w.re;
                (matrix[k * n + k + 1], matrix[(k + 1) * n + k]) = (-omega, omega);
                (row[k], row[k + 1]) = (-2.0 * w.im * omega, -2.0 * w.re * omega);
            }
            k += parts(point);
        }
        (0..n * n).for_each(|e| matrix[e] -= ones[e / n] * row[e % n] / total);
        let mut found = eigenvalues(&matrix, n).unwrap_or_default();
        found.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        found.into_iter().skip(1).collect()
    }
}

/// Value above, below or on the real axis that corresponds to `value` above it.
fn of_half(value: Complex64, height: f64) -> Complex64 {
    if height > 0.0 {
        value
    } else if height < 0.0 {
        value.conj()
    } else {
        value.re.into()
    }
}

impl Samples {
    fn new(samples: &[(f64, Vec<Complex64>)]) -> Option<Self> {
        let width = samples.first()?.1.len();
        let mut sorted: Vec<_> = samples.iter().collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let whole = |(omega, values): &(f64, Vec<Complex64>)| {
            let known = values.len() == width && values.iter().all(|v| v.is_finite());
            0.0 <= *omega && omega.is_finite() && known
        };
        if !samples.iter().all(whole) || sorted.windows(2).any(|pair| pair[0].0 == pair[1].0) {
            return None;
        }
        let real = |(omega, values): &(f64, Vec<Complex64>)| {
            values.iter().map(|v| if *omega == 0.0 { v.re.into() } else { *v }).collect::<Vec<_>>()
        };
        let values: Vec<Vec<Complex64>> = sorted.iter().map(|s| real(s)).collect();
        let largest = |c: usize| values.iter().fold(0.0f64, |most, v| most.max(v[c].norm()));
        let scales = (0..width).map(|c| if largest(c) > 0.0 { largest(c) } else { 1.0 }).collect();
        // −0 is 0
        Some(Self { omegas: sorted.iter().map(|s| s.0.abs()).collect(), values, scales })
    }

    fn support(&self, m: usize, weight: Complex64) -> Support {
        Support { omega: self.omegas[m], weight, values: self.values[m].clone() }
    }

    fn distance(&self, a: &[Complex64], b: &[Complex64]) -> f64 {
        let far = |d: f64| if d.is_nan() { f64::INFINITY } else { d };
        a.iter().zip(b).zip(&self.scales).fold(0.0, |most, ((a, b), scale)| far((a - b).norm() / scale).max(most))
    }

    /// Distance of each sample from the mean over both halves of the axis, which is real.
    fn deviations(&self) -> Vec<f64> {
        let mean = |c: usize| self.values.iter().map(|v| v[c].re).sum::<f64>() / self.values.len() as f64;
        let means: Vec<Complex64> = (0..self.scales.len()).map(|c| mean(c).into()).collect();
        self.values.iter().map(|v| self.distance(v, &means)).collect()
    }

    /// Next support point: the sample with the largest error, as long as the others still determine the weights, and
    /// the one at zero last. It is better fitted before: Theodorsen's function has a logarithmic singularity at zero,
    /// which few samples resolve.
    fn next(&self, chosen: &[usize], misfits: &[f64]) -> Option<usize> {
        let left: Vec<usize> = (0..misfits.len()).filter(|m| !chosen.contains(m)).collect();
        let pairs = left.iter().filter(|m| self.omegas[**m] > 0.0).copied();
        let worst = pairs.max_by(|a, b| misfits[*a].total_cmp(&misfits[*b]));
        let first = chosen.is_empty();
        let zero = left.iter().find(|m| self.omegas[**m] == 0.0).copied().filter(|_| !first);
        worst.filter(|m| first || self.determine(chosen, *m)).or(zero.filter(|m| self.determine(chosen, *m)))
    }

    /// True if the samples other than `chosen` and `next` give enough equations for the weights up to a common factor.
    fn determine(&self, chosen: &[usize], next: usize) -> bool {
        let numbers = |m: usize| if self.omegas[m] == 0.0 { 1 } else { 2 };
        let all: usize = (0..self.omegas.len()).map(numbers).sum();
        let weights: usize = chosen.iter().map(|m| numbers(*m)).sum::<usize>() + numbers(next);
        weights <= 1 + self.scales.len() * (all - weights)
    }

    fn misfits(&self, found: &Rational) -> Vec<f64> {
        let at = |m: usize| self.distance(&self.values[m], &found.at(Complex64::new(0.0, self.omegas[m])));
        (0..self.omegas.len()).map(at).collect()
    }

    fn fit(&self, chosen: &[usize], weights: &[Complex64]) -> Rational {
        let support = chosen.iter().zip(weights).map(|(m, w)| self.support(*m, *w)).collect();
        let mut found = Rational { support, misfit: 0.0, constant: false };
        found.misfit = self.misfits(&found).into_iter().fold(0.0, f64::max);
        found
    }

    /// Column of the errors at the other samples for the weight `w` of support point `j`, multiplied by the
    /// denominator.
    fn column(&self, chosen: &[usize], j: usize, w: Complex64) -> Vec<f64> {
        let (omega, values) = (self.omegas[j], &self.values[j]);
        let mut column = Vec::new();
        for m in (0..self.omegas.len()).filter(|m| !chosen.contains(m)) {
            let at = self.omegas[m];
            let ahead = w / Complex64::new(0.0, at - omega);
            let partner = if omega == 0.0 { ZERO } else { w.conj() / Complex64::new(0.0, at + omega) };
            for ((f, known), scale) in self.values[m].iter().zip(values).zip(&self.scales) {
                let entry = (ahead * (f - known) + partner * (f - known.conj())) / scale;
                column.extend([entry.re, entry.im]);
            }
        }
        column
    }

    /// Weights of the support points `chosen` that minimise the errors at the other samples.
    fn weights(&self, chosen: &[usize]) -> Vec<Complex64> {
        let parts: Vec<(usize, Complex64)> = chosen.iter().flat_map(|j| self.parts(*j)).collect();
        let found = Singular::of(parts.iter().map(|(j, w)| self.column(chosen, *j, *w)).collect());
        let sizes: Vec<f64> = found.squares().into_iter().map(f64::sqrt).collect();
        let (least, most) = sizes.iter().fold((f64::INFINITY, 0.0f64), |(l, m), s| (l.min(*s), m.max(*s)));
        let null: Vec<&Vec<f64>> =
            found.right.iter().zip(&sizes).filter(|(_, s)| **s <= least.max(NULL * most)).map(|(v, _)| v).collect();
        // if several do, those nearest to weights without poles on the axis
        let wanted = self.alternating(chosen);
        let share = |v: &[f64]| -> f64 { self.split(chosen, &wanted).iter().zip(v).map(|(a, b)| a * b).sum() };
        let shares: Vec<f64> = if null.len() == 1 { vec![1.0] } else { null.iter().map(|v| share(v)).collect() };
        let mix = |k: usize| null.iter().zip(&shares).map(|(v, s)| v[k] * s).sum::<f64>();
        let mut weights = vec![ZERO; chosen.len()];
        for (k, (j, part)) in parts.iter().enumerate() {
            chosen.iter().zip(&mut weights).filter(|(c, _)| *c == j).for_each(|(_, w)| *w += part * mix(k));
        }
        weights
    }

    /// Unit weights of one support point: real and imaginary; only real at zero.
    fn parts(&self, j: usize) -> Vec<(usize, Complex64)> {
        let real = (j, Complex64::from(1.0));
        if self.omegas[j] == 0.0 { vec![real] } else { vec![real, (j, Complex64::i())] }
    }

    /// Real parameters of the given weights, in the order of [`Self::parts`].
    fn split(&self, chosen: &[usize], weights: &[Complex64]) -> Vec<f64> {
        let of = |(j, w): (&usize, &Complex64)| if self.omegas[*j] == 0.0 { vec![w.re] } else { vec![w.re, w.im] };
        chosen.iter().zip(weights).flat_map(of).collect()
    }

    /// Weights of alternating sign ±1 along the axis, which give no poles on it (Berrut, Comput. Math. Appl. 15, 1988);
    /// without the point at zero, the signs alternate separately on both halves of the axis.
    fn alternating(&self, chosen: &[usize]) -> Vec<Complex64> {
        let unit = if chosen.iter().any(|j| self.omegas[*j] == 0.0) { Complex64::from(1.0) } else { Complex64::i() };
        let rank = |j: usize| chosen.iter().filter(|c| **c < j).count();
        chosen.iter().map(|j| if rank(*j) % 2 == 0 { unit } else { -unit }).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log_spaced(from: f64, to: f64, count: usize) -> Vec<f64> {
        (0..count).map(|k| from * (to / from).powf(k as f64 / (count - 1) as f64)).collect()
    }

    fn sample(f: &dyn Fn(Complex64) -> Vec<Complex64>, omegas: &[f64]) -> Vec<(f64, Vec<Complex64>)> {
        omegas.iter().map(|w| (*w, f(Complex64::new(0.0, *w)))).collect()
    }

    fn worst(a: &[Complex64], b: &[Complex64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
    }

    /// Poles −0.1 ± 2i, −1 and a constant.
    fn resonance(s: Complex64) -> Vec<Complex64> {
        let pair = (s * s + 0.2 * s + 4.01).inv();
        vec![pair, 3.0 + s * pair, 2e3 * (s + 1.0).inv() - 1e3 * pair, ZERO, Complex64::from(7.0)]
    }

    #[test]
    fn rational_functions_come_back() {
        for omegas in [vec![0.0, 0.3, 0.7, 1.5, 1.9, 2.2, 4.0], log_spaced(0.1, 6.0, 8)] {
            let found = Rational::of(&sample(&resonance, &omegas), 1e-13).unwrap();
            assert!(found.misfit() < 1e-12, "{:e}", found.misfit());
            for s in [(0.0, 0.05), (0.0, 2.0), (0.0, -2.5), (0.4, 1.0), (0.0, 40.0), (2.0, 0.0)] {
                let s = Complex64::new(s.0, s.1);
                let exact = resonance(s);
                let error = |(a, b): (&Complex64, &Complex64)| (a - b).norm() / (1.0 + b.norm());
                assert!(found.at(s).iter().zip(&exact).map(error).fold(0.0, f64::max) < 1e-10, "{s}");
            }
            let poles = found.poles();
            for pole in [(-0.1, 2.0), (-0.1, -2.0), (-1.0, 0.0)] {
                let pole = Complex64::new(pole.0, pole.1);
                assert!(poles.iter().any(|p| (p - pole).norm() < 1e-8), "{poles:?}");
            }
        }
    }

    #[test]
    fn functions_with_cuts_are_close_between_their_samples() {
        // branch cut along the negative real axis, as Theodorsen's function has it
        let cut =
            |s: Complex64| vec![(1.0 + s.sqrt()).inv(), 1.0 + s * (1.0 + s.inv()).ln(), s * s + s / (1.0 + s.sqrt())];
        let found = Rational::of(&sample(&cut, &log_spaced(0.02, 2.0, 8)), 0.0).unwrap();
        for omega in log_spaced(0.02, 2.0, 60) {
            let s = Complex64::new(0.0, omega);
            let error = worst(&found.at(s), &cut(s));
            assert!(error < 1e-4 * (1.0 + omega * omega), "{omega}: {error:e}");
        }
    }

    #[test]
    fn conjugates_have_conjugate_values() {
        let cut = |s: Complex64| vec![(1.0 + s.sqrt()).inv(), s / (1.0 + s.sqrt())];
        let omegas = [0.0, 0.1, 0.3, 1.0, 2.0];
        for count in 1..=omegas.len() {
            let found = Rational::of(&sample(&cut, &omegas[..count]), 1e-9).unwrap();
            for s in [(0.0, 0.2), (0.5, 0.3), (-1.0, 0.1), (0.0, 0.3)] {
                let s = Complex64::new(s.0, s.1);
                let mirrored: Vec<Complex64> = found.at(s.conj()).iter().map(Complex64::conj).collect();
                assert_eq!(found.at(s), mirrored);
            }
            assert!(found.at(Complex64::from(0.7)).iter().all(|v| v.im == 0.0));
        }
    }

    #[test]
    fn few_samples_are_met() {
        let i = Complex64::i();
        let value = Complex64::new(2.0, 1.0);
        let one = Rational::of(&[(0.5, vec![value])], 0.0).unwrap();
        assert!(one.at(3.0 * i) == [value] && one.at(-i) == [value.conj()] && one.misfit() == 0.0);
        // two samples determine a single lag; two functions that are not such a lag are reproduced as well
        let lag = |s: Complex64| vec![1.0 + s / (s + 0.3), 2.0 / (s + 0.3)];
        let two = Rational::of(&sample(&lag, &[0.0, 0.4]), 1e-12).unwrap();
        assert!(worst(&two.at(0.1 * i), &lag(0.1 * i)) < 1e-12 && (two.poles()[0] + 0.3).norm() < 1e-12);
        let other = |s: Complex64| vec![(1.0 + s.sqrt()).inv(), s * s - 2.0 * s];
        let two = Rational::of(&sample(&other, &[0.0, 0.4]), 1e-12).unwrap();
        assert!(worst(&two.at(ZERO), &other(ZERO)) < 1e-15 && worst(&two.at(0.4 * i), &other(0.4 * i)) < 1e-15);
        assert!((two.at(0.2 * i)[1] - other(0.2 * i)[1]).norm() < 0.5 && two.at(1e6 * i)[0].norm() < 1.0);
        let three = Rational::of(&sample(&other, &[0.0, 0.1, 0.4]), 1e-12).unwrap();
        assert!(three.misfit() < 0.1 && worst(&three.at(0.2 * i), &other(0.2 * i)) < 0.1, "{three:?}");
        let single = |s: Complex64| vec![(1.0 + s.sqrt()).inv()];
        for (omegas, most) in [([0.1, 0.2, 0.4, 0.8], 3e-3), ([0.0, 0.2, 0.4, 0.8], 1e-12)] {
            let four = Rational::of(&sample(&single, &omegas), 1e-12).unwrap();
            assert!(four.misfit() < most && worst(&four.at(0.3 * i), &single(0.3 * i)) < 0.01, "{four:?}");
        }
    }

    #[test]
    fn what_is_no_set_of_samples_is_refused() {
        let value = |x: f64| vec![Complex64::from(x)];
        assert!(Rational::of(&[], 0.0).is_none());
        assert!(Rational::of(&[(-1.0, value(1.0))], 0.0).is_none());
        assert!(Rational::of(&[(1.0, value(1.0)), (1.0, value(2.0))], 0.0).is_none());
        assert!(Rational::of(&[(1.0, value(1.0)), (2.0, value(f64::NAN))], 0.0).is_none());
        assert!(Rational::of(&[(1.0, value(1.0)), (2.0, Vec::new())], 0.0).is_none());
    }
}
