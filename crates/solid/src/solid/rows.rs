//! Vectors and matrices of hot loops over particles of a structure.
//!
//! Vectors are padded to four numbers and matrices stand by columns, so that a loop over neighbours is vector code: no gathering of
//! components, no sums across a vector.

/// The components of a vector, and zeros.
pub(super) type Row = [f64; 4];
/// A matrix: a row for each of its columns.
pub(super) type Columns<const D: usize> = [Row; D];

/// Nothing.
pub(super) const ZERO: Row = [0.0; 4];

/// A vector as a row.
#[inline(always)]
pub(super) fn row<const D: usize>(v: &[f64; D]) -> Row {
    let mut row = ZERO;
    row[..D].copy_from_slice(v);
    row
}

/// A matrix, given by rows, by its columns.
#[inline(always)]
pub(super) fn columns<const D: usize>(m: &[[f64; D]; D]) -> Columns<D> {
    std::array::from_fn(|b| row::<D>(&std::array::from_fn(|a| m[a][b])))
}

/// a − b.
#[inline(always)]
pub(super) fn less(a: &Row, b: &Row) -> Row {
    std::array::from_fn(|k| a[k] - b[k])
}

/// s a.
#[inline(always)]
pub(super) fn times(a: &Row, s: f64) -> Row {
    std::array::from_fn(|k| a[k] * s)
}

/// `sum` + s a.
#[inline(always)]
pub(super) fn add(sum: &mut Row, a: &Row, s: f64) {
    sum.iter_mut().zip(a).for_each(|(sum, a)| *sum += a * s);
}
