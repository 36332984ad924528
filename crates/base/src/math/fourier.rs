//! Fourier series at equally spaced instances of one period, and their time derivative: ∂/∂t is the matrix ω D.
//!
//! A periodic function with N harmonics is determined by its N_T = 2N + 1 values at t_n = n T/N_T. Coefficients have
//! the order of eq. (24): mean, cosines 1..N, sines 1..N. E⁻¹ maps coefficients to values (27), E maps values to
//! coefficients (28). With the derivative A of the coefficients, D = E⁻¹ A E is the derivative of the values (29), with
//! ω as a factor as in (23). D has the closed form D_nj = (−1)^(n−j) / (2 sin(π(n−j)/N_T)), D_nn = 0 (Hall, Thomas and
//! Clark, AIAA J. 40, 2002; Gopinath and Jameson, AIAA 2005-1220); it is circulant and antisymmetric, with the
//! eigenvalues im, |m| ≤ N. Signs are missing in the printed eq. (25); here d/dt cos mωt = −mω sin mωt. An even number
//! of instances is not allowed, because D would then map the sawtooth of alternating signs to zero.
use std::f64::consts::PI;

/// Equally spaced instances of a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Instances {
    harmonics: usize,
}

/// Error for an even number of instances.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{count} instances of a period do not correspond to a whole number of harmonics\nhint: use an odd number, 2 N + 1"
)]
pub struct EvenCount {
    /// The number of instances given.
    pub count: usize,
}

/// Coefficients of a series in the order mean, cosines 1..N, sines 1..N, eq. (24).
#[doc(alias = "eq24")]
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    coefficients: Vec<f64>,
}

/// A dense matrix, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    columns: usize,
    entries: Vec<f64>,
}

impl Instances {
    /// `count` equally spaced instances of a period; an error if `count` is even or zero.
    pub fn new(count: usize) -> Result<Self, EvenCount> {
        if count % 2 == 1 { Ok(Self { harmonics: count / 2 }) } else { Err(EvenCount { count }) }
    }

    /// The 2N + 1 instances for N = `harmonics`.
    pub fn of_harmonics(harmonics: usize) -> Self {
        Self { harmonics }
    }

    /// Number of instances N_T.
    pub fn count(&self) -> usize {
        2 * self.harmonics + 1
    }

    /// Number of harmonics N.
    pub fn harmonics(&self) -> usize {
        self.harmonics
    }

    /// The times t_n = n T/N_T, n = 0..2N, of the values in eq. (26).
    #[doc(alias = "eq26")]
    pub fn times(&self, omega: f64) -> Vec<f64> {
        (0..self.count()).map(|n| self.phase(n) / omega).collect()
    }

    /// Phase ωt_n (rad).
    fn phase(&self, n: usize) -> f64 {
        2.0 * PI * n as f64 / self.count() as f64
    }

    /// cos mωt_n and sin mωt_n; the phase is reduced to one period first.
    fn wave(&self, m: usize, n: usize) -> (f64, f64) {
        let (sine, cosine) = self.phase(m * n % self.count()).sin_cos();
        (cosine, sine)
    }

    /// E⁻¹, the matrix from coefficients to values, eq. (30).
    #[doc(alias = "eq30")]
    pub fn to_values(&self) -> Matrix {
        let h = self.harmonics;
        Matrix::from_fn(self.count(), self.count(), |n, k| match k {
            0 => 1.0,
            k if k <= h => self.wave(k, n).0,
            k => self.wave(k - h, n).1,
        })
    }

    /// E, the matrix from values to coefficients, eq. (31): (2/N_T) (E⁻¹)ᵀ with the first row halved.
    #[doc(alias = "eq31")]
    pub fn to_coefficients(&self) -> Matrix {
        let h = self.harmonics;
        let scale = 1.0 / self.count() as f64;
        Matrix::from_fn(self.count(), self.count(), |k, n| match k {
            0 => scale,
            k if k <= h => 2.0 * scale * self.wave(k, n).0,
            k => 2.0 * scale * self.wave(k - h, n).1,
        })
    }

    /// A, the derivative of coefficients with respect to ωt, eq. (25): c_m' = m s_m, s_m' = −m c_m.
    #[doc(alias = "eq25")]
    pub fn coefficient_derivative(&self) -> Matrix {
        let h = self.harmonics;
        Matrix::from_fn(self.count(), self.count(), |i, j| match (i, j) {
            (i, j) if 0 < i && i <= h && j == i + h => i as f64,
            (i, j) if h < i && j + h == i => -(j as f64),
            _ => 0.0,
        })
    }

    /// ω D, the time derivative of values, eq. (29), in closed form.
    #[doc(alias = "eq29")]
    pub fn derivative(&self, omega: f64) -> Matrix {
        let n = self.count();
        Matrix::from_fn(n, n, |i, j| omega * self.circulant((i + n - j) % n))
    }

    /// Entry of D on the diagonal `d` = n − j, from 0 to 2N; the matrix is circulant.
    pub fn circulant(&self, d: usize) -> f64 {
        // the shorter distance around the circle, so that opposite entries are exactly opposite
        let (steps, sign) = if d <= self.harmonics { (d, 0.5) } else { (self.count() - d, -0.5) };
        let alternating = if steps % 2 == 0 { sign } else { -sign };
        if d == 0 { 0.0 } else { alternating / (PI * steps as f64 / self.count() as f64).sin() }
    }

    /// Matrix that interpolates values at these instances to those of `target`: exact for more instances; for fewer,
    /// the series is truncated without aliasing.
    pub fn resample(&self, target: &Self) -> Matrix {
        if self == target {
            return Matrix::from_fn(self.count(), self.count(), |n, j| if n == j { 1.0 } else { 0.0 });
        }
        let shared = self.harmonics.min(target.harmonics);
        let scale = 1.0 / self.count() as f64;
        Matrix::from_fn(target.count(), self.count(), |n, j| {
            let (a, b) = (n as f64 / target.count() as f64, j as f64 / self.count() as f64);
            scale * kernel(shared, 2.0 * PI * (a - b))
        })
    }

    /// Weights of the values in the derivative of the interpolant with respect to ωt, at the phase ωt (rad). At an
    /// instance they equal those of [`Self::derivative`], which costs less.
    pub fn derivative_weights(&self, phase: f64) -> Vec<f64> {
        let slope = |x: f64| -2.0 * (1..=self.harmonics).map(|m| m as f64 * (m as f64 * x).sin()).sum::<f64>();
        (0..self.count()).map(|j| slope(phase - self.phase(j)) / self.count() as f64).collect()
    }

    /// Weights of the values in the interpolant at the phase ωt (rad).
    pub fn weights(&self, phase: f64) -> Vec<f64> {
        (0..self.count()).map(|j| kernel(self.harmonics, phase - self.phase(j)) / self.count() as f64).collect()
    }
}

/// The sum 1 + 2 Σ cos mx for m = 1..n.
fn kernel(n: usize, x: f64) -> f64 {
    1.0 + 2.0 * (1..=n).map(|m| (m as f64 * x).cos()).sum::<f64>()
}

impl Series {
    /// A series from its coefficients: mean, cosines, sines; an error if their number is even.
    pub fn new(coefficients: Vec<f64>) -> Result<Self, EvenCount> {
        Instances::new(coefficients.len()).map(|_| Self { coefficients })
    }

    /// The series through the given values at the instances, eq. (28).
    #[doc(alias = "eq28")]
    pub fn of_values(values: &[f64]) -> Result<Self, EvenCount> {
        let instances = Instances::new(values.len())?;
        Ok(Self { coefficients: instances.to_coefficients().apply(values) })
    }

    /// Values at the instances, eq. (27).
    #[doc(alias = "eq27")]
    pub fn values(&self) -> Vec<f64> {
        self.instances().to_values().apply(&self.coefficients)
    }

    /// Value at the phase ωt (rad), eq. (19).
    #[doc(alias = "eq19")]
    pub fn at(&self, phase: f64) -> f64 {
        let h = self.instances().harmonics;
        let waves = (1..=h).map(|m| {
            let (sine, cosine) = (m as f64 * phase).sin_cos();
            self.coefficients[m] * cosine + self.coefficients[h + m] * sine
        });
        self.coefficients[0] + waves.sum::<f64>()
    }

    /// Coefficients: mean, cosines 1..N, sines 1..N.
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }

    /// The instances that determine the series.
    pub fn instances(&self) -> Instances {
        Instances { harmonics: self.coefficients.len() / 2 }
    }
}

impl Matrix {
    fn from_fn(rows: usize, columns: usize, f: impl Fn(usize, usize) -> f64) -> Self {
        let entries = (0..rows * columns).map(|k| f(k / columns, k % columns)).collect();
        Self { columns, entries }
    }

    /// Values of row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        &self.entries[i * self.columns..(i + 1) * self.columns]
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.entries.len() / self.columns
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Product of the matrix with a vector.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let dot = |row: &[f64]| row.iter().zip(x).map(|(a, b)| a * b).sum();
        self.entries.chunks_exact(self.columns).map(dot).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-12;

    fn product(a: &Matrix, b: &Matrix) -> Matrix {
        Matrix::from_fn(a.rows(), b.columns(), |i, j| (0..b.rows()).map(|k| a.row(i)[k] * b.row(k)[j]).sum())
    }

    fn assert_near(a: &[f64], b: &[f64], tolerance: f64) {
        assert_eq!(a.len(), b.len());
        let worst = a.iter().zip(b).fold(0.0f64, |m, (x, y)| m.max((x - y).abs()));
        assert!(worst <= tolerance, "{worst:e}");
    }

    /// A series with all harmonics non-zero.
    fn series(harmonics: usize) -> Series {
        Series::new((0..2 * harmonics + 1).map(|k| ((k * k) as f64 * 0.7 + 1.0).sin()).collect()).unwrap()
    }

    #[test] // eq24, eq26: even counts are refused
    fn only_odd_numbers_of_instances_exist() {
        for count in [0, 2, 4, 16] {
            assert_eq!(Instances::new(count), Err(EvenCount { count }));
            assert!(Series::new(vec![0.0; count]).is_err() && Series::of_values(&vec![0.0; count]).is_err());
        }
        let three = Instances::new(3).unwrap();
        assert_eq!((three.harmonics(), three.count()), (1, 3));
        assert_near(&three.times(2.0), &[0.0, PI / 3.0, 2.0 * PI / 3.0], 1e-15);
        assert_eq!(Instances::of_harmonics(4).count(), 9);
    }

    #[test] // eq27, eq28, eq30, eq31, eq19
    fn transforms_are_inverse_and_meet_the_series() {
        for h in 0..=16 {
            let s = series(h);
            let i = s.instances();
            let unity = product(&i.to_coefficients(), &i.to_values());
            let identity = Matrix::from_fn(i.count(), i.count(), |a, b| f64::from(u8::from(a == b)));
            assert_near(&unity.entries, &identity.entries, TOLERANCE);
            let values = s.values();
            let direct: Vec<f64> = i.times(1.0).iter().map(|t| s.at(*t)).collect();
            assert_near(&values, &direct, TOLERANCE);
            assert_near(Series::of_values(&values).unwrap().coefficients(), s.coefficients(), TOLERANCE);
        }
    }

    #[test] // eq25, eq29: D = E⁻¹ A E with ω in front
    fn the_closed_form_is_the_transformed_derivative() {
        let omega = 2.7;
        for h in 1..=16 {
            let i = Instances::of_harmonics(h);
            let spectral = product(&product(&i.to_values(), &i.coefficient_derivative()), &i.to_coefficients());
            let spectral: Vec<f64> = spectral.entries.iter().map(|x| omega * x).collect();
            let closed = i.derivative(omega);
            assert_near(&closed.entries, &spectral, TOLERANCE * omega * h as f64);
            for a in 0..i.count() {
                assert!(closed.row(a).iter().sum::<f64>().abs() <= TOLERANCE);
                (0..i.count()).for_each(|b| assert_eq!(closed.row(a)[b], -closed.row(b)[a]));
            }
        }
        let one = Instances::of_harmonics(1).derivative(1.0);
        assert_near(one.row(0), &[0.0, 1.0 / 3f64.sqrt(), -1.0 / 3f64.sqrt()], 1e-15);
    }

    #[test] // eq29: exact for every series, with eigenvectors e^{imωt} to the eigenvalues imω
    fn the_derivative_is_exact_and_has_the_spectrum_of_time() {
        let omega = 0.8;
        for h in 1..=16 {
            let i = Instances::of_harmonics(h);
            let d = i.derivative(omega);
            for m in 0..=h {
                let (rate, times) = (m as f64 * omega, i.times(omega));
                let wave = |f: fn(f64) -> f64| times.iter().map(|t| f(rate * t)).collect::<Vec<f64>>();
                let (cosine, sine) = (wave(f64::cos), wave(f64::sin));
                let scaled = |list: &[f64], s: f64| list.iter().map(|x| s * x).collect::<Vec<f64>>();
                assert_near(&d.apply(&cosine), &scaled(&sine, -rate), TOLERANCE * 10.0);
                assert_near(&d.apply(&sine), &scaled(&cosine, rate), TOLERANCE * 10.0);
            }
        }
    }

    #[test]
    fn restarts_on_more_and_on_fewer_harmonics_keep_what_both_hold() {
        for (from, to) in [(1, 5), (3, 16), (16, 3), (5, 1), (4, 4), (2, 0)] {
            let s = series(from);
            let (a, b) = (s.instances(), Instances::of_harmonics(to));
            let moved = Series::of_values(&a.resample(&b).apply(&s.values())).unwrap();
            let (x, y) = (s.coefficients(), moved.coefficients());
            for m in 0..=from.max(to) {
                let pick = |c: &[f64], h: usize| match m {
                    0 => (c[0], 0.0),
                    m if m <= h => (c[m], c[h + m]),
                    _ => (0.0, 0.0),
                };
                let kept = if m <= to { pick(x, from) } else { (0.0, 0.0) };
                let got = pick(y, to);
                assert!((kept.0 - got.0).abs() < TOLERANCE && (kept.1 - got.1).abs() < TOLERANCE, "{from} {to} {m}");
            }
            let phase = 0.37;
            let interpolated: f64 = a.weights(phase).iter().zip(s.values()).map(|(w, v)| w * v).sum();
            assert!((interpolated - s.at(phase)).abs() < TOLERANCE);
        }
    }
}
