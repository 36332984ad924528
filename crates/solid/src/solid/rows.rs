//! Vectors and matrices for the inner loops over the particles of a solid.
//!
//! Vectors are padded to four numbers and matrices are stored by columns, so that the loop over neighbours compiles to
//! vector instructions without gathers and without sums across a register.

/// The components of a vector, followed by zeros.
pub(super) type Row = [f64; 4];
/// A matrix, stored by columns.
pub(super) type Columns<const D: usize> = [Row; D];

/// The zero vector.
pub(super) const ZERO: Row = [0.0; 4];

/// A vector padded to four numbers.
#[inline(always)]
pub(super) fn row<const D: usize>(v: &[f64; D]) -> Row {
    let mut row = ZERO;
    row[..D].copy_from_slice(v);
    row
}

/// A matrix given by rows, converted to columns.
#[inline(always)]
pub(super) fn columns<const D: usize>(m: &[[f64; D]; D]) -> Columns<D> {
    std::array::from_fn(|b| row::<D>(&std::array::from_fn(|a| m[a][b])))
}

/// The difference a − b.
#[inline(always)]
pub(super) fn less(a: &Row, b: &Row) -> Row {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The product s a.
#[inline(always)]
pub(super) fn times(a: &Row, s: f64) -> Row {
    std::array::from_fn(|k| a[k] * s)
}

/// Adds s a to `sum`.
#[inline(always)]
pub(super) fn add(sum: &mut Row, a: &Row, s: f64) {
    sum.iter_mut().zip(a).for_each(|(sum, a)| *sum += a * s);
}
