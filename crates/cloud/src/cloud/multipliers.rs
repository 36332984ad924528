//! Lagrange multipliers of the conditions on conservative coefficients.
//!
//! They are computed to a relative accuracy of one hundredth and stored in single precision. The multipliers of a
//! particle form an affine field: a value and a slope along each axis, each with one number per component, padded to
//! four numbers. The kernels are therefore plain arithmetic on four numbers at a time.
use crate::math::Vector;
use crate::math::conjugate;
use crate::math::parallel::sweep_rows;
use crate::math::rounded::{of_upper_half, upper_half};

/// Smallest pivot of a block relative to its diagonal.
const FLAT: f64 = 1e-12;
/// Greatest number of conditions of a particle, reached in three dimensions.
const MAX_CONDITIONS: usize = 12;
/// Number of elements of a lower triangle of that order.
const MAX_ELEMENTS: usize = MAX_CONDITIONS * (MAX_CONDITIONS + 1) / 2;

/// One number for each component, followed by zeros.
pub(super) type Lanes = [f32; 4];

/// Computes a ← a + s b.
#[inline(always)]
pub(super) fn add_to(a: &mut Lanes, s: f32, b: &Lanes) {
    for k in 0..4 {
        a[k] += s * b[k];
    }
}

/// The offset `d` times `part`, in single precision.
#[inline(always)]
pub(super) fn part_of<const D: usize>(d: &Vector<D>, part: f64) -> [f32; D] {
    let mut narrow = [0.0; D];
    for k in 0..D {
        narrow[k] = (part * d[k]) as f32;
    }
    narrow
}

/// The opposite offset −d.
#[inline(always)]
pub(super) fn opposite<const D: usize>(d: &[f32; D]) -> [f32; D] {
    let mut back = [0.0; D];
    for k in 0..D {
        back[k] = -d[k];
    }
    back
}

/// The components of a vector, followed by zeros.
#[inline(always)]
pub(super) fn lanes<const D: usize>(v: &Vector<D>) -> Lanes {
    let mut all = [0.0; 4];
    for r in 0..D {
        all[r] = v[r] as f32;
    }
    all
}

/// Componentwise product.
#[inline(always)]
fn product(a: &Lanes, b: &Lanes) -> Lanes {
    let mut q = [0.0; 4];
    for k in 0..4 {
        q[k] = a[k] * b[k];
    }
    q
}

/// Multipliers, or defects, of the conditions of one particle.
#[derive(Clone, Copy)]
pub(super) struct Row<const D: usize> {
    /// For the closure condition. For an interface particle, the first component belongs to the condition on the sum of
    /// its shares.
    pub(super) value: Lanes,
    /// For the condition of linear consistency, along each axis.
    pub(super) slope: [Lanes; D],
}

impl<const D: usize> conjugate::Row for Row<D> {
    const ZERO: Self = Self { value: [0.0; 4], slope: [[0.0; 4]; D] };

    #[inline(always)]
    fn dot(&self, o: &Self) -> f64 {
        let mut sum = product(&self.value, &o.value);
        for (a, b) in self.slope.iter().zip(&o.slope) {
            for k in 0..4 {
                sum[k] += a[k] * b[k];
            }
        }
        f64::from((sum[0] + sum[2]) + (sum[1] + sum[3]))
    }

    #[inline(always)]
    fn plus(&self, s: f64, o: &Self) -> Self {
        let (mut sum, s) = (*self, s as f32);
        add_to(&mut sum.value, s, &o.value);
        for k in 0..D {
            add_to(&mut sum.slope[k], s, &o.slope[k]);
        }
        sum
    }
}

impl<const D: usize> Row<D> {
    /// Value of the affine field at the offset `d`.
    #[inline(always)]
    pub(super) fn at(&self, d: &[f32; D]) -> Lanes {
        let mut sum = self.value;
        for k in 0..D {
            add_to(&mut sum, d[k], &self.slope[k]);
        }
        sum
    }

    /// Adds `weight` times the contribution of an area vector located at the offset `d`.
    #[inline(always)]
    pub(super) fn add(&mut self, weight: f32, s: &Lanes, d: &[f32; D]) {
        add_to(&mut self.value, weight, s);
        for k in 0..D {
            add_to(&mut self.slope[k], weight * d[k], s);
        }
    }

    /// Multiplier, or defect, of the condition on the sum of shares.
    pub(super) fn share(&self) -> f64 {
        f64::from(self.value[0])
    }

    /// This row with another multiplier of the condition on the sum of shares.
    pub(super) fn with_share(mut self, share: f64) -> Self {
        self.value[0] = share as f32;
        self
    }

    /// Trace of the slopes.
    pub(super) fn trace(&self) -> f64 {
        (0..D).map(|r| f64::from(self.slope[r][r])).sum()
    }

    /// Adds `each` to the diagonal of the slopes.
    pub(super) fn add_to_trace(&mut self, each: f64) {
        for r in 0..D {
            self.slope[r][r] += each as f32;
        }
    }

    /// The slopes multiplied by `s`, with the value zero.
    #[inline(always)]
    pub(super) fn slopes(&self, s: f64) -> Self {
        let mut row = <Self as conjugate::Row>::ZERO;
        for k in 0..D {
            add_to(&mut row.slope[k], s as f32, &self.slope[k]);
        }
        row
    }

    /// The mirrored field: components and slopes change their signs.
    #[inline(always)]
    pub(super) fn mirrored(&self, sign: &Vector<D>) -> Self {
        let seen = lanes(sign);
        let mut row = Self { value: product(&self.value, &seen), ..<Self as conjugate::Row>::ZERO };
        for k in 0..D {
            add_to(&mut row.slope[k], seen[k], &product(&self.slope[k], &seen));
        }
        row
    }

    #[inline(always)]
    fn load(x: &[f32; MAX_CONDITIONS]) -> Self {
        let mut row = <Self as conjugate::Row>::ZERO;
        row.value[..D].copy_from_slice(&x[..D]);
        for k in 0..D {
            row.slope[k][..D].copy_from_slice(&x[(k + 1) * D..(k + 2) * D]);
        }
        row
    }

    #[inline(always)]
    fn store(&self, x: &mut [f32; MAX_CONDITIONS]) {
        x[..D].copy_from_slice(&self.value[..D]);
        for k in 0..D {
            x[(k + 1) * D..(k + 2) * D].copy_from_slice(&self.slope[k][..D]);
        }
    }
}

/// Inverses of the Cholesky factors of the diagonal blocks, as lower triangles stored row by row. They serve as a
/// preconditioner only. Any triangle L with Lᵀ L near the inverse is suitable, so that only the upper half of the bits
/// of single precision is stored; the triangles of all particles are the largest array of the computation.
#[derive(Default)]
pub(super) struct Factors<const D: usize> {
    values: Vec<u16>,
}

impl<const D: usize> Factors<D> {
    /// Number of conditions of a particle.
    const WIDTH: usize = D + D * D;
    /// Number of elements of a lower triangle of that order.
    const TRIANGLE: usize = Self::WIDTH * (Self::WIDTH + 1) / 2;

    /// Factors of `n` blocks, of which `product(i)(y)` is the product of the i-th with y.
    pub(super) fn new<P: Fn(&Row<D>) -> Row<D>>(n: usize, product: impl Fn(usize) -> P + Sync) -> Self {
        let m = Self::WIDTH;
        let mut values = vec![0; n * Self::TRIANGLE];
        sweep_rows(&mut values, Self::TRIANGLE, |i, triangle| {
            let mut block = [0.0; MAX_CONDITIONS * MAX_CONDITIONS];
            let product = product(i);
            for c in 0..m {
                let mut column = [0.0; MAX_CONDITIONS];
                column[c] = 1.0;
                product(&Row::load(&column)).store(&mut column);
                (0..m).for_each(|r| block[r * m + c] = f64::from(column[r]));
            }
            inverse_cholesky(&mut block, m);
            let entries = (0..m).flat_map(|r| (0..=r).map(move |c| (r, c)));
            triangle.iter_mut().zip(entries).for_each(|(t, (r, c))| *t = upper_half(block[r * m + c] as f32));
        });
        Self { values }
    }

    /// Solution of block `i` for the right-hand side `r`.
    #[inline(always)]
    pub(super) fn solve(&self, i: usize, r: &Row<D>) -> Row<D> {
        let m = Self::WIDTH;
        let mut l = [0.0; MAX_ELEMENTS];
        let packed = &self.values[i * Self::TRIANGLE..(i + 1) * Self::TRIANGLE];
        l[..Self::TRIANGLE].iter_mut().zip(packed).for_each(|(l, packed)| *l = of_upper_half(*packed));
        let (mut x, mut z) = ([0.0; MAX_CONDITIONS], [0.0; MAX_CONDITIONS]);
        r.store(&mut x);
        for a in 0..m {
            let row = &l[a * (a + 1) / 2..][..=a];
            let y: f32 = row.iter().zip(&x).map(|(l, x)| l * x).sum();
            z.iter_mut().zip(row).for_each(|(z, l)| *z += y * l);
        }
        Row::load(&z)
    }
}

/// Overwrites the lower triangle with the inverse of its Cholesky factor; directions without stiffness are left
/// unchanged.
fn inverse_cholesky(a: &mut [f64], n: usize) {
    for c in 0..n {
        let s: f64 = (0..c).map(|k| a[c * n + k] * a[c * n + k]).sum();
        let pivot = (a[c * n + c] - s).max(FLAT * a[c * n + c]).max(f64::MIN_POSITIVE);
        a[c * n + c] = 1.0 / pivot.sqrt();
        for r in c + 1..n {
            let s: f64 = (0..c).map(|k| a[r * n + k] * a[c * n + k]).sum();
            a[r * n + c] = (a[r * n + c] - s) * a[c * n + c];
        }
    }
    // column by column: the columns to the right are already inverted in this row
    for c in (0..n).rev() {
        for r in (c + 1..n).rev() {
            let s: f64 = (c + 1..=r).map(|k| a[r * n + k] * a[k * n + c]).sum();
            a[r * n + c] = -s * a[c * n + c];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::conjugate::Row as _;

    #[test]
    fn blocks_are_inverted_by_their_factors() {
        let vector = |seed: f32| Row::<3>::load(&std::array::from_fn(|k| (seed * (k + 1) as f32).sin()));
        let [a, b, y] = [0.7, 1.9, 0.3].map(vector);
        // a symmetric positive block
        let product = |y: &Row<3>| y.plus(a.dot(y), &a).plus(0.5 * b.dot(y), &b);
        let found = Factors::new(1, |_| product).solve(0, &product(&y));
        assert!(found.plus(-1.0, &y).dot(&found.plus(-1.0, &y)) < 1e-3 * y.dot(&y));
    }
}
