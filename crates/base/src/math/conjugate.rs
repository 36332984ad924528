//! Flexible conjugate gradients: the preconditioner may be nonlinear. Each direction is made conjugate to the previous
//! one by explicit inner products, not by the formula that holds in exact arithmetic (Notay, *Flexible conjugate
//! gradients*, SIAM J. Sci. Comput. 22, 2000).
use super::parallel::sweep_slots;
use super::reduce::sum;
use super::types::Vector;

/// The value of one row of a vector.
pub trait Row: Copy + Send + Sync {
    /// The zero value.
    const ZERO: Self;
    /// Inner product with `other`.
    fn dot(&self, other: &Self) -> f64;
    /// The sum self + s · other.
    fn plus(&self, s: f64, other: &Self) -> Self;
}

impl<const D: usize> Row for Vector<D> {
    const ZERO: Self = Vector::ZERO;

    #[inline(always)]
    fn dot(&self, other: &Self) -> f64 {
        Vector::dot(self, other)
    }

    #[inline(always)]
    fn plus(&self, s: f64, other: &Self) -> Self {
        *self + *other * s
    }
}

/// A symmetric positive definite linear system, given by its products with vectors.
pub struct Symmetric<E, A, P> {
    /// `enough(r)` is true if the residual r is small enough.
    pub enough: E,
    /// `product(v, out)`: out = A v.
    pub product: A,
    /// `precondition(r, out)`: out ≈ A⁻¹ r.
    pub precondition: P,
}

/// Adds to `y` the solution of A δy = r after at most `most` iterations and returns the number of iterations; `r`
/// becomes the residual.
pub fn conjugate_gradients<R: Row>(
    y: &mut [R],
    r: &mut [R],
    most: usize,
    system: Symmetric<impl Fn(&[R]) -> bool, impl FnMut(&[R], &mut [R]), impl FnMut(&[R], &mut [R])>,
) -> usize {
    let Symmetric { enough, mut product, mut precondition } = system;
    let n = y.len();
    let (mut z, mut p, mut q) = (vec![R::ZERO; n], vec![R::ZERO; n], vec![R::ZERO; n]);
    let mut curvature = f64::INFINITY;
    for iteration in 0..most {
        if enough(r) {
            return iteration;
        }
        precondition(r, &mut z);
        let turn = sum(n, |i| z[i].dot(&q[i])) / curvature;
        sweep_slots(&mut p, |i, p| *p = z[i].plus(-turn, p));
        product(&p, &mut q);
        curvature = sum(n, |i| p[i].dot(&q[i]));
        // the residual is zero, or a value is NaN
        if curvature.is_nan() || curvature <= 0.0 {
            return iteration;
        }
        let step = sum(n, |i| p[i].dot(&r[i])) / curvature;
        sweep_slots(y, |i, y| *y = y.plus(step, &p[i]));
        sweep_slots(r, |i, r| *r = r.plus(-step, &q[i]));
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::parallel::sweep;

    #[test]
    fn strings_under_load_are_found_in_as_many_steps_as_they_have_knots() {
        const N: usize = 40;
        let load = Vector([1.0, -2.0]);
        let at = |v: &[Vector<2>], k: isize| if (0..N as isize).contains(&k) { v[k as usize] } else { Vector::ZERO };
        let product = |v: &[Vector<2>], out: &mut [Vector<2>]| {
            sweep(out, |k| v[k] * 2.0 - at(v, k as isize - 1) - at(v, k as isize + 1));
        };
        let precondition = |r: &[Vector<2>], z: &mut [Vector<2>]| sweep(z, |k| r[k] * 0.5);
        let enough = |r: &[Vector<2>]| r.iter().map(Vector::norm_squared).sum::<f64>() < 1e-24;
        let (mut y, mut r) = (vec![Vector::ZERO; N], vec![load; N]);
        let iterations = conjugate_gradients(&mut y, &mut r, 2 * N, Symmetric { enough, product, precondition });
        let exact = |k: usize| load * (0.5 * (k + 1) as f64 * (N - k) as f64);
        assert!(iterations <= N && (0..N).all(|k| (y[k] - exact(k)).norm() < 1e-9), "{iterations}");
    }
}
