//! Cubic splines of time.
//!
//! Piecewise cubic and twice continuously differentiable (de Boor, A Practical Guide to Splines, 1978, ch. 4). The
//! second derivatives M solve h_{i−1}M_{i−1} + 2(h_{i−1} + h_i)M_i + h_i M_{i+1} = 6(Δ_i − Δ_{i−1}), Δ_i = (y_{i+1} −
//! y_i)/h_i. For a periodic table the system is cyclic; its corner elements are handled by a rank-one correction
//! (Sherman and Morrison 1950). Any other spline has zero slope at both ends and is continued by constants, so that the
//! motion starts from rest.
use crate::math::jet::Scalar;

/// A cubic spline through values at ascending times.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    times: Vec<f64>,
    values: Vec<f64>,
    bend: Vec<f64>,
    periodic: bool,
}

impl Spline {
    /// The spline through `values` at `times`, which are ascending and at least two. The last value of a periodic table
    /// must equal the first.
    pub fn new(times: &[f64], values: &[f64], periodic: bool) -> Self {
        let bend = if periodic { closed(times, values) } else { clamped(times, values) };
        Self { times: times.to_vec(), values: values.to_vec(), bend, periodic }
    }

    /// Value at time `t`.
    pub fn at<S: Scalar>(&self, t: S) -> S {
        let (start, end) = self.range();
        let mut x = t.value();
        if self.periodic {
            x = start + (x - start).rem_euclid(end - start);
        }
        if !self.periodic && (x <= start || end <= x) {
            let held = if x <= start { self.values.first() } else { self.values.last() };
            return S::constant(held.copied().unwrap_or_default());
        }
        t.map(|_| self.piece(x))
    }

    /// Period of a periodic spline.
    pub fn period(&self) -> Option<f64> {
        let (start, end) = self.range();
        self.periodic.then_some(end - start)
    }

    fn range(&self) -> (f64, f64) {
        (self.times[0], self.times[self.times.len() - 1])
    }

    /// Value, slope and second derivative at `x` between the ends.
    fn piece(&self, x: f64) -> [f64; 3] {
        let i = self.times.partition_point(|t| *t <= x).clamp(1, self.times.len() - 1) - 1;
        let h = self.times[i + 1] - self.times[i];
        let (a, b) = ((self.times[i + 1] - x) / h, (x - self.times[i]) / h);
        let (p, q, m, n) = (self.values[i], self.values[i + 1], self.bend[i], self.bend[i + 1]);
        let cubic = |c: f64| h * h / 6.0 * (c * c * c - c);
        let slope = |c: f64| h / 6.0 * (3.0 * c * c - 1.0);
        [a * p + b * q + m * cubic(a) + n * cubic(b), (q - p) / h - m * slope(a) + n * slope(b), a * m + b * n]
    }
}

/// Second derivatives for zero slope at both ends.
fn clamped(times: &[f64], values: &[f64]) -> Vec<f64> {
    let n = times.len();
    let h = |i: usize| times[i + 1] - times[i];
    let slope = |i: usize| (values[i + 1] - values[i]) / h(i);
    let row = |i: usize| {
        if i == 0 {
            [0.0, 2.0 * h(0), h(0), 6.0 * slope(0)]
        } else if i == n - 1 {
            [h(n - 2), 2.0 * h(n - 2), 0.0, -6.0 * slope(n - 2)]
        } else {
            [h(i - 1), 2.0 * (h(i - 1) + h(i)), h(i), 6.0 * (slope(i) - slope(i - 1))]
        }
    };
    eliminate(&(0..n).map(row).collect::<Vec<_>>())
}

/// Second derivatives of a periodic spline; the last equals the first.
fn closed(times: &[f64], values: &[f64]) -> Vec<f64> {
    let n = times.len() - 1;
    if n < 3 {
        // fewer than three distinct points: the table moves out and back and is at rest at both
        return clamped(times, values);
    }
    let h = |i: usize| times[i % n + 1] - times[i % n];
    let slope = |i: usize| (values[i % n + 1] - values[i % n]) / h(i);
    let row = |i: usize| {
        let before = (i + n - 1) % n;
        [h(before), 2.0 * (h(before) + h(i)), h(i), 6.0 * (slope(i) - slope(before))]
    };
    let mut rows: Vec<[f64; 4]> = (0..n).map(row).collect();
    // corner elements c at (0, n − 1) and (n − 1, 0): A = T + u vᵀ with u = (g, 0, …, c), v = (1, 0, …, c/g)
    let corner = rows[0][0];
    let gamma = -rows[0][1];
    rows[0][1] -= gamma;
    rows[n - 1][1] -= corner * corner / gamma;
    let plain = eliminate(&rows);
    let mut unit = rows;
    unit.iter_mut().for_each(|r| r[3] = 0.0);
    unit[0][3] = gamma;
    unit[n - 1][3] = corner;
    let response = eliminate(&unit);
    let project = |y: &[f64]| y[0] + corner / gamma * y[n - 1];
    let factor = project(&plain) / (1.0 + project(&response));
    let mut bend: Vec<f64> = plain.iter().zip(&response).map(|(y, z)| y - factor * z).collect();
    bend.push(bend[0]);
    bend
}

/// Solves a tridiagonal system with rows (lower, diagonal, upper, right-hand side); diagonally dominant, hence without
/// pivoting.
fn eliminate(rows: &[[f64; 4]]) -> Vec<f64> {
    let mut upper = vec![0.0; rows.len()];
    let mut x = vec![0.0; rows.len()];
    let (mut before, mut carried) = (0.0, 0.0);
    for (i, [low, diagonal, high, right]) in rows.iter().enumerate() {
        let pivot = diagonal - low * before;
        (before, carried) = (high / pivot, (right - low * carried) / pivot);
        (upper[i], x[i]) = (before, carried);
    }
    for i in (0..rows.len() - 1).rev() {
        x[i] -= upper[i] * x[i + 1];
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::jet::Jet;
    use std::f64::consts::TAU;

    fn sine(n: usize, uneven: f64) -> Spline {
        let times: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).map(|s| s + uneven * (TAU * s).sin()).collect();
        let mut values: Vec<f64> = times.iter().map(|t| (TAU * t).sin()).collect();
        values[n] = values[0];
        Spline::new(&times, &values, true)
    }

    #[test]
    fn a_periodic_table_is_fourth_order_accurate_and_smooth_across_its_seam() {
        let error = |n: usize| {
            let s = sine(n, 0.05);
            (0..997).map(|k| k as f64 * 0.0037 - 1.3).map(|t| (s.at(t) - (TAU * t).sin()).abs()).fold(0.0, f64::max)
        };
        let order = (error(20) / error(40)).log2();
        assert!(error(40) < 2e-5 && order > 3.7, "{} {order}", error(40));
        let s = sine(12, 0.05);
        for knot in [0.0, 1.0, 5.0] {
            let (a, b) = (s.at(Jet::variable(knot - 1e-9)), s.at(Jet::variable(knot + 1e-9)));
            assert!((a.value - b.value).abs() < 1e-7 && (a.first - b.first).abs() < 1e-6, "{a:?} {b:?}");
            assert!((a.second - b.second).abs() < 1e-5, "{a:?} {b:?}");
        }
        assert_eq!(s.period(), Some(1.0));
    }

    #[test]
    fn any_other_table_starts_and_ends_at_rest() {
        let s = Spline::new(&[1.0, 2.0, 2.5, 4.0], &[0.0, 1.0, 0.5, 2.0], false);
        assert_eq!((s.at(0.0), s.at(9.0), s.period()), (0.0, 2.0, None));
        for (t, y) in [(1.0, 0.0), (2.0, 1.0), (2.5, 0.5), (4.0, 2.0)] {
            assert!((s.at(t) - y).abs() < 1e-14);
        }
        for t in [1.0 + 1e-12, 4.0 - 1e-12] {
            assert!(s.at(Jet::variable(t)).first.abs() < 1e-10);
        }
        let (a, b) = (s.at(Jet::variable(2.0 - 1e-9)), s.at(Jet::variable(2.0 + 1e-9)));
        assert!((a.second - b.second).abs() < 1e-6 && (a.first - b.first).abs() < 1e-7);
    }

    #[test]
    fn short_tables_work() {
        let line = Spline::new(&[0.0, 1.0], &[0.0, 1.0], false);
        assert!((line.at(0.5) - 0.5).abs() < 1e-15);
        let back = Spline::new(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0], true);
        assert!((back.at(3.0) - 1.0).abs() < 1e-14 && (back.at(0.5) - back.at(1.5)).abs() < 1e-14);
    }
}
