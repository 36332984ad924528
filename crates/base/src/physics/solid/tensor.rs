//! Second-order tensors in three dimensions, as arrays of rows.
//!
//! All operations are generic in [`Scalar`], so that derivatives propagate. Components are `a[i][j]`: row i, column j.
//! Symmetric tensors are stored as six numbers in the order 11, 22, 33, 12, 23, 31.
use crate::math::jet::Scalar;

/// Nine components, row by row: a deformation gradient F or a stress P.
pub type Tensor<S = f64> = [[S; 3]; 3];

/// Relative change of the rotation below which one more iteration reaches round-off.
const NEARLY_A_ROTATION: f64 = 1e-9;
/// Greatest number of iterations for a rotation; the iteration does not converge for det ≤ 0 or NaN.
const MOST_ITERATIONS: usize = 60;

/// The tensor with components `f(i, j)`.
#[inline(always)]
pub fn of<S: Scalar>(mut f: impl FnMut(usize, usize) -> S) -> Tensor<S> {
    let mut t = [[S::constant(0.0); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            t[i][j] = f(i, j);
        }
    }
    t
}

/// The tensor converted to another scalar type by `f`.
#[inline(always)]
pub fn convert<S: Scalar, T: Scalar>(a: &Tensor<S>, f: impl Fn(S) -> T) -> Tensor<T> {
    of(|i, j| f(a[i][j]))
}

/// The identity I.
#[inline(always)]
pub fn identity<S: Scalar>() -> Tensor<S> {
    of(|i, j| S::constant(if i == j { 1.0 } else { 0.0 }))
}

/// The sum a + b.
#[inline(always)]
pub fn sum<S: Scalar>(a: &Tensor<S>, b: &Tensor<S>) -> Tensor<S> {
    of(|i, j| a[i][j] + b[i][j])
}

/// The difference a − b.
#[inline(always)]
pub fn difference<S: Scalar>(a: &Tensor<S>, b: &Tensor<S>) -> Tensor<S> {
    of(|i, j| a[i][j] - b[i][j])
}

/// The product s·a with a scalar.
#[inline(always)]
pub fn times<S: Scalar>(a: &Tensor<S>, s: S) -> Tensor<S> {
    of(|i, j| a[i][j] * s)
}

/// The sum a + s·b.
#[inline(always)]
pub fn plus<S: Scalar>(a: &Tensor<S>, s: S, b: &Tensor<S>) -> Tensor<S> {
    of(|i, j| a[i][j] + s * b[i][j])
}

/// The sum a + s·I.
#[inline(always)]
pub fn plus_identity<S: Scalar>(a: &Tensor<S>, s: S) -> Tensor<S> {
    of(|i, j| if i == j { a[i][j] + s } else { a[i][j] })
}

/// The product a b.
#[inline(always)]
pub fn product<S: Scalar>(a: &Tensor<S>, b: &Tensor<S>) -> Tensor<S> {
    of(|i, j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
}

/// The product aᵀ b.
#[inline(always)]
pub fn transposed_product<S: Scalar>(a: &Tensor<S>, b: &Tensor<S>) -> Tensor<S> {
    of(|i, j| a[0][i] * b[0][j] + a[1][i] * b[1][j] + a[2][i] * b[2][j])
}

/// The product a bᵀ.
#[inline(always)]
pub fn product_transposed<S: Scalar>(a: &Tensor<S>, b: &Tensor<S>) -> Tensor<S> {
    of(|i, j| a[i][0] * b[j][0] + a[i][1] * b[j][1] + a[i][2] * b[j][2])
}

/// The transpose aᵀ.
#[inline(always)]
pub fn transpose<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    of(|i, j| a[j][i])
}

/// The cofactor tensor det(a) a⁻ᵀ, defined for singular tensors too.
#[inline(always)]
pub fn cofactor<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    of(|i, j| {
        let (p, q) = ((i + 1) % 3, (i + 2) % 3);
        let (r, s) = ((j + 1) % 3, (j + 2) % 3);
        a[p][r] * a[q][s] - a[p][s] * a[q][r]
    })
}

/// Determinant of a tensor.
#[inline(always)]
pub fn determinant<S: Scalar>(a: &Tensor<S>) -> S {
    a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1])
        + a[0][1] * (a[1][2] * a[2][0] - a[1][0] * a[2][2])
        + a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0])
}

/// The inverse a⁻¹; not finite where the determinant is zero.
#[inline(always)]
pub fn inverse<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    let cofactor = cofactor(a);
    let over = determinant(a).inverse();
    of(|i, j| cofactor[j][i] * over)
}

/// Trace of a tensor.
#[inline(always)]
pub fn trace<S: Scalar>(a: &Tensor<S>) -> S {
    a[0][0] + a[1][1] + a[2][2]
}

/// Double contraction a : b = Σ a_ij b_ij.
#[inline(always)]
pub fn contraction<S: Scalar>(a: &Tensor<S>, b: &Tensor<S>) -> S {
    let row = |i: usize| a[i][0] * b[i][0] + a[i][1] * b[i][1] + a[i][2] * b[i][2];
    row(0) + row(1) + row(2)
}

/// Frobenius norm √(a : a); it has no derivative at zero.
#[inline(always)]
pub fn norm<S: Scalar>(a: &Tensor<S>) -> S {
    contraction(a, a).sqrt()
}

/// The deviator a − ⅓ tr(a) I.
#[inline(always)]
pub fn deviator<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    plus_identity(a, trace(a) * (-1.0 / 3.0))
}

/// The symmetric part (a + aᵀ)/2; for a velocity gradient, the rate of deformation.
#[inline(always)]
pub fn symmetric<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    of(|i, j| (a[i][j] + a[j][i]) * 0.5)
}

/// Rotation r of the polar decomposition a = r u with u symmetric positive definite; NaN where det a ≤ 0.
///
/// Newton's iteration r ← (r + r⁻ᵀ)/2 (Higham 1986), through which derivatives propagate.
#[inline]
pub fn rotation<S: Scalar>(a: &Tensor<S>) -> Tensor<S> {
    if !(determinant(a).value() > 0.0) {
        return of(|_, _| S::constant(f64::NAN));
    }
    let mut r = *a;
    for _ in 0..MOST_ITERATIONS {
        let half = determinant(&r).inverse() * 0.5;
        let cofactor = cofactor(&r);
        let next = of(|i, j| r[i][j] * 0.5 + cofactor[i][j] * half);
        let change = (0..9).fold(0.0, |m: f64, k| m.max((next[k / 3][k % 3].value() - r[k / 3][k % 3].value()).abs()));
        r = next;
        // the error is the square of the change: round-off, in the derivative too
        if change < NEARLY_A_ROTATION {
            break;
        }
    }
    r
}

/// The six components of a symmetric tensor.
#[inline(always)]
pub fn pack<S: Scalar>(a: &Tensor<S>) -> [S; 6] {
    [a[0][0], a[1][1], a[2][2], a[0][1], a[1][2], a[2][0]]
}

/// The symmetric tensor of the first six of `c`.
#[inline(always)]
pub fn unpack<S: Scalar>(c: &[S]) -> Tensor<S> {
    [[c[0], c[3], c[5]], [c[3], c[1], c[4]], [c[5], c[4], c[2]]]
}

/// The symmetric tensor of six constants, with zero derivatives.
#[inline(always)]
pub fn constant<S: Scalar>(c: &[f64]) -> Tensor<S> {
    convert(&unpack(c), S::constant)
}

#[cfg(test)]
mod tests {
    use super::super::samples::{close, random_tensor};
    use super::*;
    use crate::math::dual::Dual;

    #[test]
    fn inverse_cofactor_and_determinant_belong_together() {
        for seed in 0..20 {
            let a = plus_identity(&random_tensor(seed, 0.4), 1.0);
            close(&product(&a, &inverse(&a)), &identity(), 1e-13);
            close(&product_transposed(&a, &cofactor(&a)), &times(&identity(), determinant(&a)), 1e-13);
            close(&transposed_product(&a, &a), &product(&transpose(&a), &a), 1e-15);
            close(&unpack(&pack(&symmetric(&a))), &symmetric(&a), 0.0);
            assert!(trace(&deviator(&a)).abs() < 1e-15);
        }
    }

    #[test]
    fn the_rotation_is_one_and_what_is_left_is_symmetric() {
        for seed in 0..20 {
            let a = plus_identity(&random_tensor(seed, 0.5), 1.0);
            let r = rotation(&a);
            close(&transposed_product(&r, &r), &identity(), 1e-14);
            let u = transposed_product(&r, &a);
            close(&u, &transpose(&u), 1e-14);
            assert!((determinant(&r) - 1.0).abs() < 1e-14);
        }
        assert!(rotation(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]])[0][0].is_nan());
    }

    #[test]
    fn the_rotation_has_its_derivative() {
        let (a, d) = (plus_identity(&random_tensor(3, 0.4), 1.0), random_tensor(4, 1.0));
        let dual = rotation(&of(|i, j| Dual { value: a[i][j], derivative: d[i][j] }));
        let h = 1e-5;
        let [up, down] = [h, -h].map(|h| rotation(&plus(&a, h, &d)));
        close(&convert(&dual, |x| x.derivative), &times(&difference(&up, &down), 0.5 / h), 1e-9);
    }
}
