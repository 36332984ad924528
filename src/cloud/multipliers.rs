//! Multipliers of the conditions on conservative coefficients, particle by particle.
use crate::math::Vector;
use crate::math::conjugate;

/// Smallest pivot of a block relative to its diagonal.
const FLAT: f64 = 1e-12;
/// Most conditions of a particle: three dimensions.
pub(super) const MOST: usize = 12;

/// Multipliers, or defects, of the conditions of one particle.
#[derive(Clone, Copy)]
pub(super) struct Row<const D: usize> {
    /// Of the closure; for an interface particle the first component belongs to the sum of its shares.
    pub(super) closure: Vector<D>,
    /// Of linear consistency.
    pub(super) moment: [Vector<D>; D],
}

impl<const D: usize> conjugate::Row for Row<D> {
    const ZERO: Self = Self { closure: Vector::ZERO, moment: [Vector::ZERO; D] };

    #[inline(always)]
    fn dot(&self, o: &Self) -> f64 {
        self.closure.dot(&o.closure) + (0..D).map(|r| self.moment[r].dot(&o.moment[r])).sum::<f64>()
    }

    #[inline(always)]
    fn plus(&self, s: f64, o: &Self) -> Self {
        Self {
            closure: self.closure + o.closure * s,
            moment: std::array::from_fn(|r| self.moment[r] + o.moment[r] * s),
        }
    }
}

impl<const D: usize> Row<D> {
    /// Adds what an area vector contributes, `reach` × offset from the particle.
    #[inline(always)]
    pub(super) fn add(&mut self, s: &Vector<D>, offset: &Vector<D>, reach: f64) {
        self.closure += *s;
        for r in 0..D {
            self.moment[r] += *offset * (reach * s[r]);
        }
    }

    pub(super) fn trace(&self) -> f64 {
        (0..D).map(|r| self.moment[r][r]).sum()
    }

    #[inline(always)]
    pub(super) fn load(x: &[f64; MOST]) -> Self {
        let moment = std::array::from_fn(|r| Vector::from_fn(|c| x[D + r * D + c]));
        Self { closure: Vector::from_fn(|c| x[c]), moment }
    }

    #[inline(always)]
    pub(super) fn store(&self, x: &mut [f64; MOST]) {
        x[..D].copy_from_slice(&self.closure.0);
        (0..D).for_each(|r| x[D + r * D..D + (r + 1) * D].copy_from_slice(&self.moment[r].0));
    }
}

/// Cholesky factor in the lower triangle, the diagonal inverted; directions without
/// stiffness are left alone.
pub(super) fn cholesky(a: &mut [f64], n: usize) {
    for c in 0..n {
        let s: f64 = (0..c).map(|k| a[c * n + k] * a[c * n + k]).sum();
        let pivot = (a[c * n + c] - s).max(FLAT * a[c * n + c]).max(f64::MIN_POSITIVE);
        a[c * n + c] = 1.0 / pivot.sqrt();
        for r in c + 1..n {
            let s: f64 = (0..c).map(|k| a[r * n + k] * a[c * n + k]).sum();
            a[r * n + c] = (a[r * n + c] - s) * a[c * n + c];
        }
    }
}
