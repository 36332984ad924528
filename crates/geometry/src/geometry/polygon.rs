//! Triangulation of a polygon in 3-D.
//!
//! A convex polygon is divided into a fan about its first corner, and a plane one by constrained Delaunay triangulation
//! inside it. The rim of a narrow gap is not plane; its triangulation of least area is found by dynamic programming (G.
//! Barequet and M. Sharir, *Filling gaps in the boundary of a polyhedron*, Computer Aided Geometric Design 12, 1995). A
//! small weight of the squared sides prefers short sides among equal areas.
use super::simplex;
use crate::math::triangulation::triangulate;
use crate::math::{Bounds, Vector};

/// Greatest distance of the corners of a plane polygon from its plane, relative to their extent.
const FLAT: f64 = 0.01;
/// Weight of squared side lengths relative to areas.
const SHORT: f64 = 1e-3;
/// Greatest number of corners for the triangulation of least area, whose cost is proportional to their cube.
const MANY: usize = 1000;

/// Triangles of a polygon without holes as corner indices, with its orientation; `None` when it is neither convex nor
/// plane nor small.
pub(super) fn divided(points: &[Vector<3>]) -> Option<Vec<[usize; 3]>> {
    let fan: Vec<[usize; 3]> = (1..points.len().saturating_sub(1)).map(|k| [0, k, k + 1]).collect();
    let normal = normal(points);
    let turns = |t: &[usize; 3]| simplex::area_vector(&t.map(|k| points[k])).dot(&normal) >= 0.0;
    if fan.iter().all(turns) {
        return Some(fan);
    }
    flat(points).or_else(|| least_area(points))
}

/// Triangulation of a plane polygon; `None` when it is not plane or crosses itself.
pub(super) fn flat(points: &[Vector<3>]) -> Option<Vec<[usize; 3]>> {
    let normal = normal(points).unit();
    let bounds = Bounds::around(points);
    let centre = points.iter().fold(Vector::ZERO, |sum, x| sum + *x) * (1.0 / points.len() as f64);
    let depth = points.iter().map(|x| (*x - centre).dot(&normal).abs()).fold(0.0, f64::max);
    let size = bounds.extent().norm();
    // also true where the normal is not finite
    if !(depth <= FLAT * size && size > 0.0) {
        return None;
    }
    let least = (0..3).fold(0, |a, d| if normal[d].abs() < normal[a].abs() { d } else { a });
    let along = simplex::cross(&normal, &Vector::axis(least)).unit();
    let across = simplex::cross(&normal, &along);
    let plane: Vec<Vector<2>> =
        points.iter().map(|x| *x - centre).map(|x| Vector([x.dot(&along), x.dot(&across)]) * (1.0 / size)).collect();
    let n = points.len();
    let sides: Vec<[u32; 2]> = (0..n).map(|k| [k as u32, ((k + 1) % n) as u32]).collect();
    let inside = |t: &[u32; 3]| {
        is_inside(&plane, &(t.iter().fold(Vector::ZERO, |sum, k| sum + plane[*k as usize]) * (1.0 / 3.0)))
    };
    let triangles: Vec<[usize; 3]> =
        triangulate(&plane, &sides).into_iter().filter(inside).map(|t| t.map(|k| k as usize)).collect();
    // a self-intersecting polygon has another number of triangles
    (triangles.len() == n - 2).then_some(triangles)
}

/// Triangulation of least area between the corners of a polygon.
pub(super) fn least_area(rim: &[Vector<3>]) -> Option<Vec<[usize; 3]>> {
    let n = rim.len();
    if n > MANY {
        return None;
    }
    let side = |i: usize, j: usize| (rim[i] - rim[j]).norm_squared();
    let weight = |i: usize, m: usize, j: usize| {
        let area = simplex::area_vector(&[rim[i], rim[m], rim[j]]).norm();
        area + SHORT * (side(i, m) + side(m, j) + side(i, j))
    };
    // least weight between the vertices i and j, and the third vertex of the triangle at this side
    let mut best = vec![(0.0_f64, 0_u32); n * n];
    for gap in 2..n {
        for i in 0..n - gap {
            let j = i + gap;
            let through = |m: usize| best[i * n + m].0 + best[m * n + j].0 + weight(i, m, j);
            let least = (i + 1..j)
                .map(|m| (through(m), m as u32))
                .fold((f64::INFINITY, 0), |a, b| if b.0 < a.0 { b } else { a });
            best[i * n + j] = least;
        }
    }
    let (mut triangles, mut open) = (Vec::new(), vec![(0, n - 1)]);
    while let Some((i, j)) = open.pop() {
        if j - i < 2 {
            continue;
        }
        let m = best[i * n + j].1 as usize;
        triangles.push([i, m, j]);
        open.extend([(i, m), (m, j)]);
    }
    Some(triangles)
}

/// Area vector of a polygon (Newell), which is normal to a plane polygon.
fn normal(points: &[Vector<3>]) -> Vector<3> {
    let fan = (1..points.len().saturating_sub(1)).map(|k| simplex::area_vector(&[points[0], points[k], points[k + 1]]));
    fan.fold(Vector::ZERO, |sum, a| sum + a)
}

/// True when a ray from `x` crosses the sides of a polygon an odd number of times.
fn is_inside(polygon: &[Vector<2>], x: &Vector<2>) -> bool {
    let n = polygon.len();
    let crosses = |k: &usize| {
        let (a, b) = (polygon[*k], polygon[(*k + 1) % n]);
        (a[1] > x[1]) != (b[1] > x[1]) && x[0] < a[0] + (b[0] - a[0]) * (x[1] - a[1]) / (b[1] - a[1])
    };
    (0..n).filter(crosses).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Area vector of triangles, and the sum of their areas.
    fn areas(points: &[Vector<3>], triangles: &[[usize; 3]]) -> (Vector<3>, f64) {
        let each = || triangles.iter().map(|t| simplex::area_vector(&t.map(|k| points[k])));
        (each().fold(Vector::ZERO, |a, b| a + b), each().map(|a| a.norm()).sum())
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        // a cambered section in a tilted plane, and a star
        let line = |x: f64| 0.3 * x * (1.0 - x);
        let x = |k: usize| 0.5 + 0.5 * (std::f64::consts::PI * k as f64 / 60.0).cos();
        let half = |x: f64| 0.05 * (x * (1.0 - x)).sqrt();
        let upper = (0..60).map(|k| [x(k), line(x(k)) + half(x(k))]);
        let lower = (0..60).map(|k| 1.0 - x(k)).map(|x| [x, line(x) - half(x)]);
        let tilt = |[x, z]: [f64; 2]| Vector([x, 2.0 + 0.5 * z - 0.2 * x, z]);
        let section: Vec<Vector<3>> = upper.chain(lower).map(tilt).collect();
        let star = |k: usize| {
            let (r, a) = (if k.is_multiple_of(2) { 1.0 } else { 0.2 }, std::f64::consts::PI * k as f64 / 5.0);
            Vector([r * a.cos(), r * a.sin(), 0.0])
        };
        for points in [section, (0..10).map(star).collect()] {
            let triangles = divided(&points).unwrap();
            let (vector, area) = areas(&points, &triangles);
            assert!(triangles.len() == points.len() - 2 && (vector - normal(&points)).norm() < 1e-14);
            assert!((area - vector.norm()).abs() < 1e-14, "they overlap: {area} {}", vector.norm());
        }
    }

    #[test]
    fn convex_polygons_are_fans() {
        let square: Vec<Vector<3>> =
            [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vector([x, y, 0.0])).into();
        assert_eq!(divided(&square).unwrap(), [[0, 1, 2], [0, 2, 3]]);
        let arrow: Vec<Vector<3>> =
            [[0.0, 0.0], [1.0, -1.0], [0.2, 0.0], [1.0, 1.0]].map(|[x, y]| Vector([x, y, 0.0])).into();
        let turned: Vec<Vector<3>> = (0..4).map(|k| arrow[(k + 1) % 4]).collect();
        for points in [arrow, turned] {
            let (vector, area) = areas(&points, &divided(&points).unwrap());
            assert!((area - 0.2).abs() < 1e-15 && (vector[2] - 0.2).abs() < 1e-15);
        }
    }
}
