//! Multipliers of the conditions on conservative coefficients, particle by particle.
use crate::math::Vector;
use crate::math::conjugate;
use crate::math::rounded::{of_upper_half, upper_half};
use crate::math::sweep::sweep_rows;

/// Smallest pivot of a block relative to its diagonal.
const FLAT: f64 = 1e-12;
/// Most conditions of a particle: three dimensions.
const MOST: usize = 12;

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

    /// The same with this multiplier, or defect, of the sum of shares.
    pub(super) fn with_share(mut self, share: f64) -> Self {
        self.closure[0] = share;
        self
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

/// Blocks of conditions, one a row, factorised (Cholesky): the lower triangles row after row, diagonals inverted. They only
/// precondition, which any factor does whose product with its transpose is near the block: each number is the upper half of one in single
/// precision, for a triangle of every particle is the largest array of all.
#[derive(Default)]
pub(super) struct Factors<const D: usize> {
    values: Vec<u16>,
}

impl<const D: usize> Factors<D> {
    /// Number of conditions of a particle.
    const WIDTH: usize = D + D * D;
    /// Elements of a lower triangle of that order.
    const TRIANGLE: usize = Self::WIDTH * (Self::WIDTH + 1) / 2;

    /// Of the `n` blocks of which the i-th makes `product(i)(y)` of y.
    pub(super) fn new<P: Fn(&Row<D>) -> Row<D>>(n: usize, product: impl Fn(usize) -> P + Sync) -> Self {
        let m = Self::WIDTH;
        let mut values = vec![0; n * Self::TRIANGLE];
        sweep_rows(&mut values, Self::TRIANGLE, |i, triangle| {
            let mut block = [0.0; MOST * MOST];
            let product = product(i);
            for c in 0..m {
                let mut column = [0.0; MOST];
                column[c] = 1.0;
                product(&Row::load(&column)).store(&mut column);
                (0..m).for_each(|r| block[r * m + c] = column[r]);
            }
            cholesky(&mut block, m);
            let entries = (0..m).flat_map(|r| (0..=r).map(move |c| (r, c)));
            triangle.iter_mut().zip(entries).for_each(|(t, (r, c))| *t = upper_half(block[r * m + c] as f32));
        });
        Self { values }
    }

    /// What block `i` makes `r` of.
    #[inline(always)]
    pub(super) fn solve(&self, i: usize, r: &Row<D>) -> Row<D> {
        let m = Self::WIDTH;
        let l = &self.values[i * Self::TRIANGLE..(i + 1) * Self::TRIANGLE];
        let at = |r: usize, c: usize| f64::from(of_upper_half(l[r * (r + 1) / 2 + c]));
        let mut x = [0.0; MOST];
        r.store(&mut x);
        for a in 0..m {
            let s: f64 = (0..a).map(|b| at(a, b) * x[b]).sum();
            x[a] = (x[a] - s) * at(a, a);
        }
        for a in (0..m).rev() {
            x[a] *= at(a, a);
            for b in 0..a {
                x[b] -= at(a, b) * x[a];
            }
        }
        Row::load(&x)
    }
}

/// Cholesky factor in the lower triangle, the diagonal inverted; directions without
/// stiffness are left alone.
fn cholesky(a: &mut [f64], n: usize) {
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
