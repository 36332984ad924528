//! Cubic B-splines along one axis.
//!
//! The cells may have different lengths. At a *break* the field may have a kink: the knot there has a multiplicity
//! equal to the degree, so that only one spline differs from zero (de Boor 1978, *A Practical Guide to Splines*,
//! chapter IX; Piegl and Tiller 1997, algorithms A2.2 and A2.3).

/// Polynomial degree.
pub(super) const DEGREE: usize = 3;
/// Number of splines that differ from zero in a cell.
pub(super) const LIVE: usize = DEGREE + 1;

/// The B-splines along an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axis {
    knots: Vec<f64>,
    /// End points of the cells.
    pub(super) ends: Vec<f64>,
    /// Index of the first spline that differs from zero in each cell.
    pub(super) first: Vec<usize>,
}

impl Axis {
    /// Cells of about the length `size` from `low` to `high`, with kinks at `breaks`.
    pub(super) fn new([low, high]: [f64; 2], size: f64, breaks: &[f64]) -> Self {
        let mut pieces: Vec<f64> = breaks.iter().copied().filter(|b| low < *b && *b < high).collect();
        pieces.sort_by(f64::total_cmp);
        pieces.dedup();
        pieces.push(high);
        let (mut knots, mut ends, mut first) = (vec![low; LIVE], vec![low], Vec::new());
        let mut start = low;
        for end in pieces {
            let n = ((end - start) / size).round().max(1.0);
            for k in 1..=n as usize {
                let at = if k as f64 == n { end } else { start + (end - start) * k as f64 / n };
                first.push(knots.len() - LIVE);
                let often = if end == high && k as f64 == n {
                    LIVE
                } else if k as f64 == n {
                    DEGREE
                } else {
                    1
                };
                knots.extend(std::iter::repeat_n(at, often));
                ends.push(at);
            }
            start = end;
        }
        Self { knots, ends, first }
    }

    /// Number of splines.
    pub(super) fn len(&self) -> usize {
        self.knots.len() - LIVE
    }

    /// Number of cells.
    pub(super) fn cells(&self) -> usize {
        self.first.len()
    }

    /// The cell that contains `x`; the outermost cell for points beyond the ends.
    pub(super) fn cell(&self, x: f64) -> usize {
        self.ends[1..self.ends.len() - 1].partition_point(|end| *end <= x)
    }

    /// Values and derivatives at `x` of the splines that differ from zero in `cell`.
    pub(super) fn at(&self, cell: usize, x: f64) -> [[f64; 2]; LIVE] {
        let span = self.first[cell] + DEGREE;
        let (t, mut values, mut lower) = (&self.knots, [0.0; LIVE], [0.0; LIVE]);
        let (mut left, mut right) = ([0.0; LIVE], [0.0; LIVE]);
        values[0] = 1.0;
        for j in 1..=DEGREE {
            (left[j], right[j]) = (x - t[span + 1 - j], t[span + j] - x);
            if j == DEGREE {
                lower = values;
            }
            let mut saved = 0.0;
            for r in 0..j {
                let part = values[r] / (right[r + 1] + left[j - r]);
                values[r] = saved + right[r + 1] * part;
                saved = left[j - r] * part;
            }
            values[j] = saved;
        }
        let p = DEGREE as f64;
        std::array::from_fn(|k| {
            let i = span - DEGREE + k;
            let over = |value: f64, from: f64, to: f64| if to > from { value / (to - from) } else { 0.0 };
            let rising = if k > 0 { over(lower[k - 1], t[i], t[i + DEGREE]) } else { 0.0 };
            let falling = if k < DEGREE { over(lower[k], t[i + 1], t[i + LIVE]) } else { 0.0 };
            [values[k], p * (rising - falling)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn splines_sum_to_one_and_slopes_are_derivatives() {
        let axis = Axis::new([-1.0, 2.0], 0.4, &[0.5, 5.0]);
        assert_eq!((axis.cells(), axis.len()), (8, 8 + 3 + 2));
        for k in 0..50 {
            let x = -1.0 + 3.0 * (f64::from(k) + 0.3) / 50.0;
            let (cell, h) = (axis.cell(x), 1e-6);
            assert!(axis.ends[cell] <= x && x <= axis.ends[cell + 1]);
            let (at, after) = (axis.at(cell, x), axis.at(cell, x + h));
            let sum = at.iter().fold([0.0; 2], |s, v| [s[0] + v[0], s[1] + v[1]]);
            assert!((sum[0] - 1.0).abs() < 1e-14 && sum[1].abs() < 1e-12, "{sum:?}");
            for (a, b) in at.iter().zip(after) {
                assert!((a[1] - (b[0] - a[0]) / h).abs() < 1e-4 * (1.0 + a[1].abs()));
            }
        }
    }

    #[test]
    fn a_break_is_where_one_spline_is_alone() {
        let axis = Axis::new([0.0, 1.0], 0.25, &[0.5]);
        let at = axis.at(axis.cell(0.5), 0.5);
        assert_eq!(at.iter().filter(|v| v[0].abs() > 1e-14).count(), 1);
    }
}
