//! Mathematics of one surface element: a segment in the plane, a triangle in space.
//!
//! An element has `D` corners in `D` dimensions, so most formulas need only inner products and hold for both; the others
//! branch on the constant `D`, which the compiler removes. That keeps every user of a surface free of trait bounds.
//!
//! Conventions: outlines run counter-clockwise and triangles are counter-clockwise seen from the fluid, so that the area
//! vector points outward, into the fluid.
use crate::math::{Bounds, Vector};
use std::f64::consts::PI;

/// Corner points of an element.
pub(super) type Corners<const D: usize> = [Vector<D>; D];

/// An end point nearer to an element than this fraction of the segment's length lies on the element. Points placed on a
/// surface carry rounding errors of about 1e-16 of the coordinates, spacings are at least 1e-6 of them.
const ON_SURFACE: f64 = 1e-9;

/// Cross product, three dimensions only.
#[inline(always)]
pub(super) fn cross<const D: usize>(u: &Vector<D>, v: &Vector<D>) -> Vector<D> {
    Vector::from_fn(|d| u[(d + 1) % 3] * v[(d + 2) % 3] - u[(d + 2) % 3] * v[(d + 1) % 3])
}

/// Outward normal times length (2-D) or area (3-D).
#[inline]
pub(super) fn area_vector<const D: usize>(c: &Corners<D>) -> Vector<D> {
    let u = c[1] - c[0];
    if D == 2 {
        return Vector::from_fn(|d| if d == 0 { u[1] } else { -u[0] });
    }
    cross(&u, &(c[D - 1] - c[0])) * 0.5
}

/// Mean of the corners.
#[inline]
pub(super) fn centroid<const D: usize>(c: &Corners<D>) -> Vector<D> {
    c.iter().fold(Vector::ZERO, |sum, p| sum + *p) * (1.0 / D as f64)
}

/// Smallest box around the corners.
pub(super) fn bounds<const D: usize>(c: &Corners<D>) -> Bounds<D> {
    Bounds::around(c)
}

/// Sum of `values` weighted by `weights`.
#[inline]
pub(super) fn blend<const D: usize>(values: &[Vector<D>; D], weights: &[f64; D]) -> Vector<D> {
    let mut sum = Vector::ZERO;
    for k in 0..D {
        sum += values[k] * weights[k];
    }
    sum
}

/// Barycentric weights of the point of the element nearest to `x`.
#[inline]
pub(super) fn closest<const D: usize>(x: &Vector<D>, c: &Corners<D>) -> [f64; D] {
    let mut weights = [0.0; D];
    if D == 2 {
        let u = c[1] - c[0];
        let length2 = u.norm_squared();
        let t = if length2 > 0.0 { ((*x - c[0]).dot(&u) / length2).clamp(0.0, 1.0) } else { 0.0 };
        weights[0] = 1.0 - t;
        weights[1] = t;
        return weights;
    }
    let [a, b, g] = closest_on_triangle(x, &c[0], &c[1], &c[D - 1]);
    weights[0] = a;
    weights[1] = b;
    weights[D - 1] = g;
    weights
}

/// Voronoi regions of a triangle (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
#[inline]
fn closest_on_triangle<const D: usize>(x: &Vector<D>, a: &Vector<D>, b: &Vector<D>, c: &Vector<D>) -> [f64; 3] {
    let (ab, ac, ax) = (*b - *a, *c - *a, *x - *a);
    let (d1, d2) = (ab.dot(&ax), ac.dot(&ax));
    if d1 <= 0.0 && d2 <= 0.0 {
        return [1.0, 0.0, 0.0];
    }
    let bx = *x - *b;
    let (d3, d4) = (ab.dot(&bx), ac.dot(&bx));
    if d3 >= 0.0 && d4 <= d3 {
        return [0.0, 1.0, 0.0];
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = ratio(d1, d1 - d3);
        return [1.0 - t, t, 0.0];
    }
    let cx = *x - *c;
    let (d5, d6) = (ab.dot(&cx), ac.dot(&cx));
    if d6 >= 0.0 && d5 <= d6 {
        return [0.0, 0.0, 1.0];
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = ratio(d2, d2 - d6);
        return [1.0 - t, 0.0, t];
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let t = ratio(d4 - d3, (d4 - d3) + (d5 - d6));
        return [0.0, 1.0 - t, t];
    }
    let sum = va + vb + vc;
    let (v, w) = (ratio(vb, sum), ratio(vc, sum));
    [1.0 - v - w, v, w]
}

/// `a / b`, zero where a degenerate element makes both vanish.
#[inline]
fn ratio(a: f64, b: f64) -> f64 {
    if b != 0.0 { a / b } else { 0.0 }
}

/// True when the open segment from `a` to `b` passes through the element. An end point on the element's plane does not
/// count, so that segments between points of a wall, or from a wall into the fluid, are free.
pub(super) fn crosses<const D: usize>(a: &Vector<D>, b: &Vector<D>, c: &Corners<D>) -> bool {
    let n = area_vector(c);
    let (above, below) = (n.dot(&(*a - c[0])), n.dot(&(*b - c[0])));
    if above * below >= 0.0 {
        return false;
    }
    let tolerance = ON_SURFACE * (*b - *a).norm() * n.norm();
    above.abs() > tolerance && below.abs() > tolerance && line_pierces(a, b, c)
}

/// True when the line through `a` and `b` meets the element, border included. The test of a border shared by two
/// elements gives exactly opposite numbers for both, so no line slips between them.
fn line_pierces<const D: usize>(a: &Vector<D>, b: &Vector<D>, c: &Corners<D>) -> bool {
    let r = *b - *a;
    let side = |k: usize| {
        let u = c[k] - *a;
        if D == 2 {
            return r[0] * u[1] - r[1] * u[0];
        }
        r.dot(&cross(&u, &(c[(k + 1) % D] - *a)))
    };
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for k in 0..D {
        let s = side(k);
        low = low.min(s);
        high = high.max(s);
    }
    if D == 2 { low <= 0.0 && high >= 0.0 } else { low >= 0.0 || high <= 0.0 }
}

/// True when two elements without a common vertex intersect; also gives a point of the intersection.
pub(super) fn intersection<const D: usize>(e: &Corners<D>, f: &Corners<D>) -> Option<Vector<D>> {
    let edges = if D == 2 { 1 } else { 3 };
    if is_beside(e, f) || is_beside(f, e) {
        return None;
    }
    for (p, q) in [(e, f), (f, e)] {
        for k in 0..edges {
            let (a, b) = (p[k], p[(k + 1) % D]);
            if crosses(&a, &b, q) {
                let n = area_vector(q);
                let (above, below) = (n.dot(&(a - q[0])), n.dot(&(b - q[0])));
                return Some(a + (b - a) * (above / (above - below)));
            }
        }
    }
    None
}

/// True when `e` lies on one side of the plane of `f`, farther away than what rounding may hide.
fn is_beside<const D: usize>(e: &Corners<D>, f: &Corners<D>) -> bool {
    let n = area_vector(f);
    let heights = e.map(|x| n.dot(&(x - f[0])));
    let (low, high) = heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
    let clear = low.max(-high);
    clear > 0.0 && e.iter().all(|x| clear > ON_SURFACE * n.norm() * (*x - f[0]).norm())
}

/// True when `is_beside` holds of every element in a box, about a plane with this normal through `origin`. A box is a cheap substitute for all
/// slivers in it, which the plane of a sliver across them separates at once.
pub(super) fn is_box_beside<const D: usize>(bounds: &Bounds<D>, normal: &Vector<D>, origin: &Vector<D>) -> bool {
    // twice, for the rounding of both
    const CLEAR: f64 = 2.0 * ON_SURFACE;
    let (mut low, mut high, mut reach2) = (0.0, 0.0, 0.0);
    for d in 0..D {
        let (from, to) = (bounds.min[d] - origin[d], bounds.max[d] - origin[d]);
        let (a, b) = (normal[d] * from, normal[d] * to);
        low += a.min(b);
        high += a.max(b);
        reach2 += (from * from).max(to * to);
    }
    let clear = f64::max(low, -high);
    clear > 0.0 && clear * clear > CLEAR * CLEAR * normal.norm_squared() * reach2
}

/// The middle of the stretch, longer than `slack`, along which two segments lie on one another. In 2-D alone.
pub(super) fn overlap<const D: usize>(e: &Corners<D>, f: &Corners<D>, slack: f64) -> Option<Vector<D>> {
    let (length, along) = ((e[1] - e[0]).norm(), (e[1] - e[0]).unit());
    let place = |x: &Vector<D>| (*x - e[0]).dot(&along);
    let off = |x: &Vector<D>| (*x - e[0] - along * place(x)).norm();
    if D != 2 || off(&f[0]) > slack || off(&f[1]) > slack {
        return None;
    }
    let (a, b) = (place(&f[0]), place(&f[1]));
    let (low, high) = (a.min(b).max(0.0), a.max(b).min(length));
    (high - low > slack).then(|| e[0] + along * (0.5 * (low + high)))
}

/// Fraction of the full angle (2-D) or solid angle (3-D; Van Oosterom and Strackee 1983) that the element fills seen
/// from `x`; positive where the element shows its inner side. The sum over a closed surface is 1 inside and 0 outside.
pub(super) fn winding<const D: usize>(x: &Vector<D>, c: &Corners<D>) -> f64 {
    let (p, q) = (c[0] - *x, c[1] - *x);
    if D == 2 {
        return (p[0] * q[1] - p[1] * q[0]).atan2(p.dot(&q)) / (2.0 * PI);
    }
    let r = c[D - 1] - *x;
    let (lp, lq, lr) = (p.norm(), q.norm(), r.norm());
    let volume = p.dot(&cross(&q, &r));
    let scale = lp * lq * lr + p.dot(&q) * lr + q.dot(&r) * lp + r.dot(&p) * lq;
    volume.atan2(scale) / (2.0 * PI)
}

/// [`winding`] of a distant group of elements with area vector sum `area` about `centre` (Barill et al. 2018, eq. 11).
pub(super) fn winding_far<const D: usize>(offset: &Vector<D>, distance: f64, area: &Vector<D>) -> f64 {
    let full = if D == 2 { 2.0 * PI } else { 4.0 * PI };
    area.dot(offset) / (full * distance.powi(D as i32))
}

/// Normal curvature of largest magnitude from the change of the corner normals across the element, positive where the
/// body is convex. In 3-D the second fundamental form is fitted to the three edges (Rusinkiewicz 2004).
pub(super) fn curvature<const D: usize>(c: &Corners<D>, normals: &[Vector<D>; D]) -> f64 {
    let u = c[1] - c[0];
    if D == 2 {
        return ratio((normals[1] - normals[0]).dot(&u), u.norm_squared());
    }
    let n = area_vector(c).unit();
    let first = u.unit();
    let second = cross(&n, &first);
    let (mut w, mut m) = ([0.0; 3], [0.0; 3]);
    for k in 0..D {
        let edge = c[(k + 1) % D] - c[k];
        let turn = normals[(k + 1) % D] - normals[k];
        let (x, y, a, b) = (edge.dot(&first), edge.dot(&second), turn.dot(&first), turn.dot(&second));
        w = [w[0] + x * x, w[1] + x * y, w[2] + y * y];
        m = [m[0] + a * x, m[1] + a * y + b * x, m[2] + b * y];
    }
    largest_eigenvalue(solve_form(&w, &m))
}

/// Solves the normal equations of the second fundamental form (e, f, g): [xx xy 0; xy xx+yy xy; 0 xy yy].
fn solve_form(w: &[f64; 3], m: &[f64; 3]) -> [f64; 3] {
    let [xx, xy, yy] = *w;
    let trace = xx + yy;
    let det = trace * (xx * yy - xy * xy);
    // A needle has no curvature that could be told from rounding across it: below this its determinant is noise.
    if det <= 1e-14 * trace.powi(3) {
        return [0.0; 3];
    }
    let f = (xx * yy * m[1] - xy * yy * m[0] - xx * xy * m[2]) / det;
    [(m[0] - xy * f) / xx, f, (m[2] - xy * f) / yy]
}

/// Eigenvalue of largest magnitude of [e f; f g].
fn largest_eigenvalue([e, f, g]: [f64; 3]) -> f64 {
    let mean = 0.5 * (e + g);
    let spread = (0.25 * (e - g) * (e - g) + f * f).sqrt();
    if mean >= 0.0 { mean + spread } else { mean - spread }
}

/// Weight of the area vector in the mean normal at corner `k` (Max 1999); in 2-D the inverse square of the length, which
/// is exact for points on a circle.
pub(super) fn corner_weight<const D: usize>(c: &Corners<D>, k: usize) -> f64 {
    let side = |j: usize| (c[(k + j) % D] - c[k]).norm_squared();
    ratio(1.0, if D == 2 { side(1) } else { side(1) * side(2) })
}

/// Angle between unit vectors, accurate near 0 and π.
pub(super) fn angle_between<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> f64 {
    2.0 * (*a - *b).norm().atan2((*a + *b).norm())
}

/// The cubic patch through the corners of an element with given normals there: a curved point-normal triangle (Vlachos et
/// al. 2001), in 2-D the cubic arc between two points with given normals.
pub(super) struct CurvedPatch<const D: usize> {
    corners: Corners<D>,
    /// Control points: of the edge from corner i to corner j, the one beside i.
    controls: [[Vector<D>; D]; D],
    /// Control point in the middle (3-D).
    middle: Vector<D>,
}

impl<const D: usize> CurvedPatch<D> {
    pub(super) fn new(c: &Corners<D>, normals: &[Vector<D>; D]) -> Self {
        let (mut controls, mut sum) = ([[Vector::ZERO; D]; D], Vector::ZERO);
        for i in 0..D {
            for j in (0..D).filter(|&j| j != i) {
                let edge = c[j] - c[i];
                controls[i][j] = c[i] + (edge - normals[i] * edge.dot(&normals[i])) * (1.0 / 3.0);
                sum += controls[i][j];
            }
        }
        let mean = sum * (1.0 / 6.0);
        Self { corners: *c, controls, middle: mean + (mean - centroid(c)) * 0.5 }
    }

    /// Point with these barycentric weights.
    #[inline]
    pub(super) fn at(&self, weights: &[f64; D]) -> Vector<D> {
        let mut sum = Vector::ZERO;
        for i in 0..D {
            sum += self.corners[i] * weights[i].powi(3);
            for j in (0..D).filter(|&j| j != i) {
                sum += self.controls[i][j] * (3.0 * weights[i] * weights[i] * weights[j]);
            }
        }
        if D == 3 {
            sum += self.middle * (6.0 * weights.iter().product::<f64>());
        }
        sum
    }
}
