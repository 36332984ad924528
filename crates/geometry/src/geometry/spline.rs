//! Parametric cubic splines through points of an outline.
//!
//! The curve x(t) is piecewise cubic and twice continuously differentiable (de Boor, A Practical Guide to Splines,
//! 1978, ch. 4). The knots are spaced by chord length, so that t is close to arc length and a curve around a leading
//! edge is a single smooth function. The second derivatives M solve the tridiagonal system h_{i-1} M_{i-1} + 2
//! (h_{i-1} + h_i) M_i + h_i M_{i+1} = 6 (Δ_i − Δ_{i-1}), Δ_i = (x_{i+1} − x_i) / h_i.
//!
//! A monotone spline is the same curve where this stays between its points: each coordinate increases or decreases with
//! the points and never overshoots. Its slopes m solve m_{i-1}/h_{i-1} + 2 (1/h_{i-1} + 1/h_i) m_i + m_{i+1}/h_i = 3
//! (Δ_{i-1}/h_{i-1} + Δ_i/h_i). Slopes that exceed the limits 0 ≤ m/Δ ≤ 3 of both sides (Fritsch and Carlson, SIAM J.
//! Numer. Anal. 17, 1980; Hyman, SIAM J. Sci. Stat. Comput. 4, 1983) are set to them, and the others are solved for
//! again. The curve has one continuous derivative at these points. Points on a straight line are connected by it.
use crate::math::Vector;

/// End condition of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End<const D: usize> {
    /// Zero curvature.
    Natural,
    /// Tangent along a unit vector.
    Along(Vector<D>),
}

/// A cubic spline.
#[derive(Clone, Debug)]
pub(super) struct Spline<const D: usize> {
    knots: Vec<f64>,
    points: Vec<Vector<D>>,
    /// Second derivatives at both ends of every interval.
    bend: Vec<[Vector<D>; 2]>,
}

impl<const D: usize> Spline<D> {
    /// The spline through `points`, which are at least two and differ from their neighbours, with knots spaced by chord
    /// length.
    pub(super) fn new(points: Vec<Vector<D>>, start: End<D>, finish: End<D>) -> Self {
        Self::over(chord_lengths(&points), points, start, finish)
    }

    /// The spline through `points` at given ascending parameters.
    pub(super) fn over(knots: Vec<f64>, points: Vec<Vector<D>>, start: End<D>, finish: End<D>) -> Self {
        let all = second_derivatives(&knots, &points, start, finish);
        let bend = all.windows(2).map(|m| [m[0], m[1]]).collect();
        Self { knots, points, bend }
    }

    /// The monotone spline through `points`, with knots spaced by chord length.
    pub(super) fn monotone(points: Vec<Vector<D>>, start: End<D>, finish: End<D>) -> Self {
        Self::monotone_over(chord_lengths(&points), points, start, finish)
    }

    /// The monotone spline through `points` at given ascending parameters.
    pub(super) fn monotone_over(knots: Vec<f64>, points: Vec<Vector<D>>, start: End<D>, finish: End<D>) -> Self {
        let end = |end: End<D>, d: usize| match end {
            End::Natural => None,
            End::Along(direction) => Some(direction[d]),
        };
        let steps: Vec<f64> = knots.windows(2).map(|k| k[1] - k[0]).collect();
        let secants: Vec<Vector<D>> = points.windows(2).zip(&steps).map(|(p, h)| (p[1] - p[0]) * (1.0 / h)).collect();
        let straight = straight_knots(&secants);
        let along = |d: usize| secants.iter().map(|s| s[d]).collect::<Vec<f64>>();
        let slopes: [Vec<f64>; D] =
            std::array::from_fn(|d| monotone_slopes(&steps, &along(d), &straight, [end(start, d), end(finish, d)]));
        let bend = |i: usize| {
            let [m, n] = [i, i + 1].map(|k| Vector::<D>::from_fn(|d| slopes[d][k]));
            [secants[i] * 6.0 - m * 4.0 - n * 2.0, m * 2.0 + n * 4.0 - secants[i] * 6.0].map(|b| b * (1.0 / steps[i]))
        };
        let bend = (0..steps.len()).map(bend).collect();
        Self { knots, points, bend }
    }

    /// Number of intervals between knots.
    pub(super) fn intervals(&self) -> usize {
        self.points.len() - 1
    }

    /// Point and derivative at the fraction `s` of interval `i`.
    pub(super) fn at(&self, i: usize, s: f64) -> (Vector<D>, Vector<D>) {
        let h = self.knots[i + 1] - self.knots[i];
        let (a, b) = (1.0 - s, s);
        let lift = |c: f64| h * h / 6.0 * (c * c * c - c);
        let slope = |c: f64| h / 6.0 * (3.0 * c * c - 1.0);
        let (p, q, [m, n]) = (self.points[i], self.points[i + 1], self.bend[i]);
        let point = p * a + q * b + m * lift(a) + n * lift(b);
        (point, (q - p) * (1.0 / h) - m * slope(a) + n * slope(b))
    }

    /// Upper bound of the sagitta of interval `i` over its chord, h² max |M| / 8.
    pub(super) fn sagitta(&self, i: usize) -> f64 {
        let h = self.knots[i + 1] - self.knots[i];
        self.bend[i][0].norm().max(self.bend[i][1].norm()) * h * h / 8.0
    }

    /// Length of the chord of interval `i`.
    pub(super) fn chord(&self, i: usize) -> f64 {
        self.knots[i + 1] - self.knots[i]
    }
}

/// Parameters of the points: accumulated chord lengths.
fn chord_lengths<const D: usize>(points: &[Vector<D>]) -> Vec<f64> {
    let mut knots = vec![0.0; points.len()];
    for i in 1..points.len() {
        knots[i] = knots[i - 1] + (points[i] - points[i - 1]).norm();
    }
    knots
}

/// For every knot, whether it lies on a straight line with its neighbours.
fn straight_knots<const D: usize>(secants: &[Vector<D>]) -> Vec<bool> {
    /// Relative difference of slopes due to the finite number of digits in a file.
    const SAME: f64 = 1e-6;
    let inner = secants.windows(2).map(|s| (s[1] - s[0]).norm() <= SAME * s[0].norm().max(s[1].norm()));
    std::iter::once(false).chain(inner).chain([false]).collect()
}

/// Slopes at the knots of a monotone cubic with these step lengths and chord slopes; given values in `ends` are kept.
fn monotone_slopes(steps: &[f64], secants: &[f64], straight: &[bool], ends: [Option<f64>; 2]) -> Vec<f64> {
    /// Greatest ratio of slope and chord slope for which a cubic is monotone.
    const STEEPEST: f64 = 3.0;
    let n = secants.len();
    let mut fixed: Vec<Option<f64>> = (0..=n).map(|i| straight[i].then(|| secants[i])).collect();
    (fixed[0], fixed[n]) = (ends[0], ends[1]);
    // an end with zero curvature, limited to the monotone range
    let limited = |i: usize, slope: f64| {
        let (a, b) = (secants[i - 1], secants[i]);
        let most = if a * b > 0.0 { STEEPEST * a.abs().min(b.abs()) } else { 0.0 };
        let within = if a > 0.0 { slope.clamp(0.0, most) } else { slope.clamp(-most, 0.0) };
        (within != slope).then_some(within)
    };
    loop {
        let slopes = slopes_between(steps, secants, &fixed);
        let beyond: Vec<(usize, f64)> =
            (1..n).filter(|i| fixed[*i].is_none()).filter_map(|i| Some((i, limited(i, slopes[i])?))).collect();
        if beyond.is_empty() {
            return slopes;
        }
        beyond.into_iter().for_each(|(i, slope)| fixed[i] = Some(slope));
    }
}

/// Slopes of the cubic with two continuous derivatives at all knots except the `fixed` ones, with zero curvature at
/// free ends.
fn slopes_between(steps: &[f64], secants: &[f64], fixed: &[Option<f64>]) -> Vec<f64> {
    let n = secants.len();
    let row = |i: usize| match fixed[i] {
        Some(slope) => (0.0, 1.0, 0.0, slope),
        None if i == 0 => (0.0, 2.0, 1.0, 3.0 * secants[0]),
        None if i == n => (1.0, 2.0, 0.0, 3.0 * secants[n - 1]),
        None => {
            let (a, c) = (1.0 / steps[i - 1], 1.0 / steps[i]);
            (a, 2.0 * (a + c), c, 3.0 * (a * secants[i - 1] + c * secants[i]))
        }
    };
    let (mut upper, mut right) = (vec![0.0; n + 1], vec![0.0; n + 1]);
    for i in 0..=n {
        let (a, b, c, r) = row(i);
        let (before, carried) = if i > 0 { (upper[i - 1], right[i - 1]) } else { (0.0, 0.0) };
        let pivot = b - a * before;
        (upper[i], right[i]) = (c / pivot, (r - a * carried) / pivot);
    }
    for i in (0..n).rev() {
        right[i] -= upper[i] * right[i + 1];
    }
    right
}

/// Solves the tridiagonal system by elimination; it is diagonally dominant, so that no pivoting is needed.
fn second_derivatives<const D: usize>(
    knots: &[f64],
    points: &[Vector<D>],
    start: End<D>,
    finish: End<D>,
) -> Vec<Vector<D>> {
    let n = points.len();
    let h = |i: usize| knots[i + 1] - knots[i];
    let slope = |i: usize| (points[i + 1] - points[i]) * (1.0 / h(i));
    let (mut upper, mut right) = (vec![0.0; n], vec![Vector::ZERO; n]);
    let row = |i: usize| -> (f64, f64, f64, Vector<D>) {
        if i == 0 {
            match start {
                End::Natural => (0.0, 1.0, 0.0, Vector::ZERO),
                End::Along(d) => (0.0, 2.0 * h(0), h(0), (slope(0) - d) * 6.0),
            }
        } else if i == n - 1 {
            match finish {
                End::Natural => (0.0, 1.0, 0.0, Vector::ZERO),
                End::Along(d) => (h(n - 2), 2.0 * h(n - 2), 0.0, (d - slope(n - 2)) * 6.0),
            }
        } else {
            (h(i - 1), 2.0 * (h(i - 1) + h(i)), h(i), (slope(i) - slope(i - 1)) * 6.0)
        }
    };
    for i in 0..n {
        let (a, b, c, r) = row(i);
        let (before, carried) = if i > 0 { (upper[i - 1], right[i - 1]) } else { (0.0, Vector::ZERO) };
        let pivot = b - a * before;
        upper[i] = c / pivot;
        right[i] = (r - carried * a) * (1.0 / pivot);
    }
    for i in (0..n - 1).rev() {
        let next = right[i + 1];
        right[i] -= next * upper[i];
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clamped_spline_reproduces_a_circle_to_fourth_order() {
        let error = |n: usize| {
            let at = |i: usize| std::f64::consts::PI * i as f64 / n as f64;
            let points = (0..=n).map(|i| Vector([at(i).cos(), at(i).sin()])).collect();
            let up = Vector([0.0, 1.0]);
            let spline = Spline::new(points, End::Along(up), End::Along(-up));
            (0..n).map(|i| (spline.at(i, 0.5).0.norm() - 1.0).abs()).fold(0.0, f64::max)
        };
        let order = (error(20) / error(40)).log2();
        assert!(error(40) < 1e-6 && order > 3.8, "{} {order}", error(40));
    }

    #[test]
    fn two_points_give_a_straight_line() {
        let s = Spline::new(vec![Vector([0.0, 0.0]), Vector([3.0, 4.0])], End::Natural, End::Natural);
        let (x, dx) = s.at(0, 0.25);
        assert!((x - Vector([0.75, 1.0])).norm() < 1e-15 && (dx - Vector([0.6, 0.8])).norm() < 1e-15);
        assert!(s.sagitta(0) == 0.0 && s.chord(0) == 5.0 && s.intervals() == 1);
    }

    #[test]
    fn a_monotone_spline_stays_between_its_points() {
        let natural = |points: &[[f64; 2]]| {
            Spline::monotone(points.iter().map(|p| Vector(*p)).collect(), End::Natural, End::Natural)
        };
        let all: [&[[f64; 2]]; 4] = [
            &[[0.0, 0.0], [1.0, 0.5], [9.0, 0.5], [10.0, 0.0]],
            &[[0.0, 0.0], [1.0, 0.0], [1.1, 1.0], [5.0, 1.01], [5.1, 0.2]],
            &[[0.0, 0.3], [0.1, 0.31], [4.0, 0.9], [4.1, 0.2], [9.0, 0.25]],
            &[[0.0, 1.0], [3.0, 1.0]],
        ];
        for points in all {
            let s = natural(points);
            for i in 0..s.intervals() {
                let [low, high] =
                    [0, 1].map(|d| [points[i][d].min(points[i + 1][d]), points[i][d].max(points[i + 1][d])]);
                for k in 0..=50 {
                    let x = s.at(i, f64::from(k) / 50.0).0;
                    assert!(low[0] - 1e-12 <= x[0] && x[0] <= low[1] + 1e-12, "{points:?}: {x:?}");
                    assert!(high[0] - 1e-12 <= x[1] && x[1] <= high[1] + 1e-12, "{points:?}: {x:?}");
                }
            }
        }
    }

    #[test]
    fn a_monotone_spline_is_straight_and_smooth_where_its_points_are() {
        let line = vec![[0.0, 0.0], [0.5, 0.1], [0.7, 0.14], [1.0, 0.2], [2.0, 0.2], [3.0, 0.2]];
        let s = Spline::monotone(line.into_iter().map(Vector).collect(), End::Natural, End::Natural);
        for i in [0, 1, 3, 4] {
            let [a, b, x] = [0.0, 1.0, 0.3].map(|part| s.at(i, part).0);
            assert!(((b - a)[0] * (x - a)[1] - (b - a)[1] * (x - a)[0]).abs() < 1e-12, "{i}: {x:?}");
        }
        let up = Vector([0.0, 1.0]);
        let error = |n: usize| {
            let at = |i: usize| std::f64::consts::PI * i as f64 / n as f64;
            let points = (0..=n).map(|i| Vector([-2.0 * at(i).cos(), at(i).sin()])).collect();
            let spline = Spline::monotone(points, End::Along(up), End::Along(-up));
            let off = |x: Vector<2>| ((0.5 * x[0]).hypot(x[1]) - 1.0).abs();
            (0..n).map(|i| off(spline.at(i, 0.5).0)).fold(0.0, f64::max)
        };
        assert!(error(10) < 2e-3 && error(40) < 1e-5, "{} {}", error(10), error(40));
    }
}
