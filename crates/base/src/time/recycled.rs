//! Recycled solutions of (iω − A) x = b, which give the initial guess of the next solve.
//!
//! When a solution is known, its product with A is known as well. At another frequency or for another right-hand side,
//! the best combination of known solutions, min over c of |b − Σ_k c_k (iω − A) x_k|, therefore needs inner products
//! but no product with A. This is a reduced basis with a least-squares projection (Parks, de Sturler, Mackey, Johnson
//! and Maiti 2006, doi:10.1137/040607277, recycle Krylov subspaces in the same way).
use std::ops::Range;

use crate::math::dense::Factors;
use crate::math::parallel::sweep_chunks;
use crate::math::reduce::sum_each;

/// Minimum and maximum number of stored solutions.
const KEPT: [usize; 2] = [8, 24];
/// Relative regularisation of the squared norms, so that linearly dependent solutions do no harm.
const RIDGE: f64 = 1e-12;

/// A solution and its product with A, real parts before imaginary parts, in the norm of residuals.
#[derive(Debug)]
struct Known {
    x: Vec<f32>,
    image: Vec<f32>,
}

/// Stored solutions; the oldest are removed first.
#[derive(Debug, Default)]
pub(super) struct Recycled {
    all: Vec<Known>,
    /// Number of right-hand sides of a frequency.
    sides: usize,
}

impl Recycled {
    /// Sets the number of right-hand sides of each frequency: the solutions of one frequency give the initial guesses
    /// of the next.
    pub(super) fn expect(&mut self, sides: usize) {
        self.sides = sides;
    }

    /// Stores the solution `x` and its product with A, `image`, multiplied by local times.
    pub(super) fn keep(&mut self, x: &[f64], image: impl Fn(usize) -> f64) {
        let [least, most] = KEPT;
        if self.all.len() >= self.sides.clamp(least, most) {
            self.all.remove(0);
        }
        let single = |x: f64| x as f32;
        let image = (0..x.len()).map(|i| single(image(i))).collect();
        self.all.push(Known { x: x.iter().map(|x| single(*x)).collect(), image });
    }

    /// Sets `x` to the best combination of stored solutions and subtracts its product with the system from the
    /// right-hand side `r`; `scale` are local times.
    pub(super) fn begin(&self, omega: f64, scale: &[f64], (x, r): (&mut [f64], &mut [f64])) {
        let (m, n) = (self.all.len(), scale.len());
        let Some(c) = self.coefficients(omega, scale, r).filter(|_| m > 0) else { return };
        let (of_x, of_r) = (x.split_at_mut(n), r.split_at_mut(n));
        for (which, out) in [(false, of_x.0), (true, of_x.1)] {
            sweep_chunks(out, |range, out| {
                for (known, [re, im]) in self.all.iter().zip(&c) {
                    let (a, b) = (&known.x[..n][range.clone()], &known.x[n..][range.clone()]);
                    let (a, b, sign) = if which { (b, a, 1.0) } else { (a, b, -1.0) };
                    out.iter_mut().zip(a.iter().zip(b)).for_each(|(o, (a, b))| {
                        *o += re * f64::from(*a) + sign * im * f64::from(*b);
                    });
                }
            });
        }
        for (which, out) in [(false, of_r.0), (true, of_r.1)] {
            sweep_chunks(out, |range, out| {
                for (known, [re, im]) in self.all.iter().zip(&c) {
                    for (o, i) in out.iter_mut().zip(range.clone()) {
                        let [a, b] = known.shifted(omega, scale, i);
                        *o -= if which { re * b + im * a } else { re * a - im * b };
                    }
                }
            });
        }
    }

    /// Coefficients c of the best combination; `None` if the solutions are linearly dependent.
    fn coefficients(&self, omega: f64, scale: &[f64], b: &[f64]) -> Option<Vec<[f64; 2]>> {
        let (m, n) = (self.all.len(), scale.len());
        let width = m + 1;
        // ⟨w_k, w_l⟩ and ⟨w_k, b⟩ for k ≤ l: real and imaginary parts
        let mut sums = vec![0.0; 2 * width * width];
        let add = |range: Range<usize>, out: &mut [f64]| {
            out.fill(0.0);
            let mut at = vec![[0.0; 2]; width];
            for i in range {
                at.iter_mut().zip(&self.all).for_each(|(at, known)| *at = known.shifted(omega, scale, i));
                at[m] = [b[i], b[n + i]];
                for k in 0..m {
                    for l in k..width {
                        let ([a, b], [c, d]) = (at[k], at[l]);
                        let slot = 2 * (k * width + l);
                        out[slot] += a * c + b * d;
                        out[slot + 1] += a * d - b * c;
                    }
                }
            }
        };
        sum_each(n, &mut sums, &mut Vec::new(), add);
        let entry = |k: usize, l: usize| match k <= l {
            true => [sums[2 * (k * width + l)], sums[2 * (k * width + l) + 1]],
            false => [sums[2 * (l * width + k)], -sums[2 * (l * width + k) + 1]],
        };
        // with normalised solutions and the real parts of c before the imaginary parts, |Σ_k c_k w_k − b|² is minimal
        // for G c = g
        let size: Vec<f64> = (0..m).map(|k| entry(k, k)[0].sqrt().max(f64::MIN_POSITIVE)).collect();
        let mut matrix = vec![0.0; 4 * m * m];
        let mut right = vec![0.0; 2 * m];
        for k in 0..m {
            for l in 0..m {
                let [re, im] = entry(k, l).map(|x| x / (size[k] * size[l]));
                matrix[k * 2 * m + l] = re;
                matrix[k * 2 * m + m + l] = -im;
                matrix[(m + k) * 2 * m + l] = im;
                matrix[(m + k) * 2 * m + m + l] = re;
            }
            let [re, im] = entry(k, m);
            (right[k], right[m + k]) = (re / size[k], im / size[k]);
        }
        (0..2 * m).for_each(|k| matrix[k * 2 * m + k] += RIDGE);
        let mut c = vec![0.0; 2 * m];
        Factors::new(2 * m, matrix)?.solve(&right, &mut c);
        Some((0..m).map(|k| [c[k] / size[k], c[m + k] / size[k]]).collect())
    }
}

impl Known {
    /// Real and imaginary part of (iω − A) x for the unknown `i`.
    #[inline(always)]
    fn shifted(&self, omega: f64, scale: &[f64], i: usize) -> [f64; 2] {
        let (n, s) = (scale.len(), omega * scale[i]);
        let [x, y] = [self.x[i], self.x[n + i]].map(f64::from);
        let [a, b] = [self.image[i], self.image[n + i]].map(f64::from);
        [-s * y - a, s * x - b]
    }
}
