//! Number types of sparse matrices, real and complex, packed in strips for vector instructions.
use std::ops::{Add, AddAssign, Mul, Sub, SubAssign};

use num_complex::Complex64;

/// Number of columns of a tile.
pub(super) const WIDE: usize = 4;
/// Maximum number of values in a tile.
pub(super) const TILE: usize = 32;

/// A real or complex number.
pub(super) trait Number:
    Copy + Send + Sync + Add<Output = Self> + AddAssign + Sub<Output = Self> + SubAssign + Mul<Output = Self> + 'static
{
    /// The number zero.
    const ZERO: Self;
    /// Number of rows of a strip, a multiple of [`WIDE`].
    const ROWS: usize;
    /// Number of real components of a value.
    const PARTS: usize;

    /// The real number `x` in this type.
    fn real(x: f64) -> Self;
    /// Square root of a pivot; `None` if elimination cannot continue. A pivot below `floor`, a positive number, may be
    /// increased to it.
    fn root(self, floor: f64) -> Option<Self>;
    /// Reciprocal 1/x.
    fn inverse(self) -> Self;
    /// Writes the value into lane `lane` of one column of a strip.
    fn put(self, strip: &mut [f64], lane: usize);
    /// Products of all rows of strip `a` with rows `from..from + WIDE` of strip `b`, summed over their columns and
    /// stored column by column in `tile`; `FUSED` selects fused multiply-add instructions.
    fn tile<const FUSED: bool>(a: &[f64], b: &[f64], from: usize, tile: &mut [Self; TILE]);
}

#[inline(always)]
fn add_product<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

impl Number for f64 {
    const ZERO: Self = 0.0;
    const ROWS: usize = 8;
    const PARTS: usize = 1;

    #[inline(always)]
    fn real(x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn root(self, _: f64) -> Option<Self> {
        (self > 0.0 && self.is_finite()).then(|| self.sqrt())
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn put(self, strip: &mut [f64], lane: usize) {
        strip[lane] = self;
    }

    #[inline(always)]
    fn tile<const FUSED: bool>(a: &[f64], b: &[f64], from: usize, tile: &mut [Self; TILE]) {
        let mut sums = [[0.0; 8]; WIDE];
        for (a, b) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
            let b = &b[from..from + WIDE];
            for (j, sums) in sums.iter_mut().enumerate() {
                (0..8).for_each(|i| sums[i] = add_product::<FUSED>(a[i], b[j], sums[i]));
            }
        }
        tile.copy_from_slice(sums.as_flattened());
    }
}

impl Number for Complex64 {
    const ZERO: Self = Complex64::ZERO;
    const ROWS: usize = 4;
    const PARTS: usize = 2;

    #[inline(always)]
    fn real(x: f64) -> Self {
        Complex64::new(x, 0.0)
    }

    #[inline(always)]
    fn root(self, floor: f64) -> Option<Self> {
        let size = self.norm();
        let pivot = match size {
            _ if size >= floor => self,
            _ if size > 0.0 => self * (floor / size),
            _ => Complex64::new(floor, 0.0),
        };
        (self.is_finite() && floor > 0.0).then(|| pivot.sqrt())
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        self.inv()
    }

    #[inline(always)]
    fn put(self, strip: &mut [f64], lane: usize) {
        (strip[lane], strip[4 + lane]) = (self.re, self.im);
    }

    #[inline(always)]
    fn tile<const FUSED: bool>(a: &[f64], b: &[f64], _: usize, tile: &mut [Self; TILE]) {
        let (mut re, mut im) = ([[0.0; 4]; WIDE], [[0.0; 4]; WIDE]);
        for (a, b) in a.chunks_exact(8).zip(b.chunks_exact(8)) {
            for j in 0..WIDE {
                for i in 0..4 {
                    re[j][i] = add_product::<FUSED>(a[i], b[j], re[j][i]);
                    im[j][i] = add_product::<FUSED>(a[i], b[4 + j], im[j][i]);
                }
                for i in 0..4 {
                    re[j][i] = add_product::<FUSED>(-a[4 + i], b[4 + j], re[j][i]);
                    im[j][i] = add_product::<FUSED>(a[4 + i], b[j], im[j][i]);
                }
            }
        }
        for j in 0..WIDE {
            (0..4).for_each(|i| tile[4 * j + i] = Complex64::new(re[j][i], im[j][i]));
        }
    }
}
