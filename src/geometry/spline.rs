//! Parametric cubic splines through points of an outline.
//!
//! The curve x(t) is cubic between knots and twice continuously differentiable (de Boor, A Practical Guide to Splines,
//! 1978, ch. 4). Knots are spaced by chord length, so t is close to arc length and a curve that turns around a leading
//! edge stays one smooth function. The second derivatives M solve a tridiagonal system,
//! h_{i-1} M_{i-1} + 2 (h_{i-1} + h_i) M_i + h_i M_{i+1} = 6 (Δ_i − Δ_{i-1}), Δ_i = (x_{i+1} − x_i) / h_i.
use crate::math::Vector;

/// How the curve ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// No curvature.
    Natural,
    /// Along a unit direction.
    Along(Vector<2>),
}

/// A cubic spline in the plane.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    knots: Vec<f64>,
    points: Vec<Vector<2>>,
    bend: Vec<Vector<2>>,
}

impl Spline {
    /// The spline through `points`, which are at least two and differ from their neighbours.
    pub(super) fn new(points: Vec<Vector<2>>, start: End, finish: End) -> Self {
        let mut knots = vec![0.0; points.len()];
        for i in 1..points.len() {
            knots[i] = knots[i - 1] + (points[i] - points[i - 1]).norm();
        }
        Self::over(knots, points, start, finish)
    }

    /// The spline through `points` at parameters of one's own, which rise.
    pub(super) fn over(knots: Vec<f64>, points: Vec<Vector<2>>, start: End, finish: End) -> Self {
        let bend = second_derivatives(&knots, &points, start, finish);
        Self { knots, points, bend }
    }

    /// Number of intervals between knots.
    pub(super) fn intervals(&self) -> usize {
        self.points.len() - 1
    }

    /// Point and derivative at fraction `s` of interval `i`.
    pub(super) fn at(&self, i: usize, s: f64) -> (Vector<2>, Vector<2>) {
        let h = self.knots[i + 1] - self.knots[i];
        let (a, b) = (1.0 - s, s);
        let lift = |c: f64| h * h / 6.0 * (c * c * c - c);
        let slope = |c: f64| h / 6.0 * (3.0 * c * c - 1.0);
        let (p, q, m, n) = (self.points[i], self.points[i + 1], self.bend[i], self.bend[i + 1]);
        let point = p * a + q * b + m * lift(a) + n * lift(b);
        (point, (q - p) * (1.0 / h) - m * slope(a) + n * slope(b))
    }

    /// The interval that the parameter `x` lies in, and what part of it before; held at the ends.
    pub(super) fn interval(&self, x: f64) -> (usize, f64) {
        let i = self.knots.partition_point(|k| *k <= x).saturating_sub(1).min(self.knots.len() - 2);
        (i, ((x - self.knots[i]) / self.chord(i)).clamp(0.0, 1.0))
    }

    /// Largest sagitta of interval `i` over its chord when it is one piece: h² max |M| / 8.
    pub(super) fn sagitta(&self, i: usize) -> f64 {
        let h = self.knots[i + 1] - self.knots[i];
        self.bend[i].norm().max(self.bend[i + 1].norm()) * h * h / 8.0
    }

    /// Length of the chord of interval `i`.
    pub(super) fn chord(&self, i: usize) -> f64 {
        self.knots[i + 1] - self.knots[i]
    }
}

/// Solves the tridiagonal system by elimination; it is diagonally dominant, so no pivoting is needed.
fn second_derivatives(knots: &[f64], points: &[Vector<2>], start: End, finish: End) -> Vec<Vector<2>> {
    let n = points.len();
    let h = |i: usize| knots[i + 1] - knots[i];
    let slope = |i: usize| (points[i + 1] - points[i]) * (1.0 / h(i));
    let (mut upper, mut right) = (vec![0.0; n], vec![Vector::ZERO; n]);
    let row = |i: usize| -> (f64, f64, f64, Vector<2>) {
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
    fn parameters_fall_into_their_intervals() {
        let points = vec![Vector([1.0, 0.0]), Vector([2.0, -1.0]), Vector([0.0, 4.0])];
        let s = Spline::over(vec![0.0, 1.0, 3.0], points.clone(), End::Natural, End::Natural);
        assert_eq!(
            [-1.0, 0.25, 2.0, 3.0, 9.0].map(|x| s.interval(x)),
            [(0, 0.0), (0, 0.25), (1, 0.5), (1, 1.0), (1, 1.0)]
        );
        let (i, part) = s.interval(1.0);
        assert!((s.at(i, part).0 - points[1]).norm() < 1e-15);
    }
}
