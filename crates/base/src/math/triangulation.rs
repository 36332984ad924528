//! Triangulation of points in the plane.
//!
//! A constrained Delaunay triangulation: no point lies inside the circumcircle of a triangle unless a given edge
//! separates them (Chew 1989, doi:10.1007/BF01553881). It covers the convex hull of the points. The predicates are
//! exact, so that points in rows and columns are no problem.
use spade::{ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation};

use super::Vector;

/// Magnitude below which a coordinate is set to zero, because the exact predicates cannot multiply it.
const NEXT_TO_NOTHING: f64 = 1e-40;

/// A point with its index.
struct Numbered {
    position: Point2<f64>,
    number: u32,
}

impl HasPosition for Numbered {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.position
    }
}

/// Counterclockwise triangles between `points`; every one of `edges` is an edge of triangles unless it crosses another
/// one.
///
/// Of several points at the same position, only one becomes a corner. The result is empty if a coordinate is not
/// finite.
pub fn triangulate(points: &[Vector<2>], edges: &[[u32; 2]]) -> Vec<[u32; 3]> {
    let coordinate = |x: f64| if x.abs() < NEXT_TO_NOTHING { 0.0 } else { x };
    let numbered = points
        .iter()
        .enumerate()
        .map(|(i, x)| Numbered { position: Point2::new(coordinate(x[0]), coordinate(x[1])), number: i as u32 });
    let edges = edges.iter().filter(|[a, b]| a != b).map(|edge| edge.map(|i| i as usize)).collect();
    let built = ConstrainedDelaunayTriangulation::try_bulk_load_cdt(numbered.collect(), edges, |_| ());
    let corners = |mesh: ConstrainedDelaunayTriangulation<Numbered>| {
        mesh.inner_faces().map(|face| face.vertices().map(|vertex| vertex.data().number)).collect()
    };
    built.map_or_else(|_| Vec::new(), corners)
}

/// Triangles as by [`triangulate`], without those outside the boundary `edges`: `normal` is the normal of a boundary
/// point, pointing inwards, and `None` for all other points.
pub fn triangulate_within(
    points: &[Vector<2>],
    edges: &[[u32; 2]],
    normal: impl Fn(u32) -> Option<Vector<2>>,
) -> Vec<[u32; 3]> {
    let mut all = triangulate(points, edges);
    all.retain(|corners| match corners.map(&normal) {
        [Some(a), Some(b), Some(c)] => {
            let at = corners.map(|i| points[i as usize]);
            let middle = at.iter().fold(Vector::ZERO, |sum, x| sum + *x) * (1.0 / 3.0);
            at.iter().zip([a, b, c]).map(|(x, n)| (middle - *x).unit().dot(&n)).sum::<f64>() >= 0.0
        }
        _ => true,
    });
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[Vector<2>], triangle: &[u32; 3]) -> f64 {
        let [a, b, c] = triangle.map(|i| points[i as usize]);
        0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    }

    #[test]
    fn a_lattice_is_covered_once() {
        let points: Vec<Vector<2>> =
            (0..400).map(|k| Vector([f64::from(k % 20) / 19.0, f64::from(k / 20) / 19.0])).collect();
        let triangles = triangulate(&points, &[]);
        assert_eq!(triangles.len(), 2 * 19 * 19);
        assert!(triangles.iter().all(|t| area(&points, t) > 0.0));
        assert!((triangles.iter().map(|t| area(&points, t)).sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_edges_bound_is_covered_and_no_more() {
        // an L-shape of three squares; the notch at the upper right is outside
        let at = [[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2], [0, 1]];
        let points = at.map(|[x, y]| Vector([f64::from(x), f64::from(y)]));
        let edges: Vec<[u32; 2]> = (0..8).map(|k| [k, (k + 1) % 8]).collect();
        let inwards = [[1, 1], [0, 1], [-1, 1], [-1, -1], [-1, -1], [-1, -1], [1, -1], [1, 0]];
        let normal = |i: u32| Some(Vector(inwards[i as usize].map(f64::from)).unit());
        let found = triangulate_within(&points, &edges, normal);
        assert!((found.iter().map(|t| area(&points, t)).sum::<f64>() - 3.0).abs() < 1e-12, "{found:?}");
        assert_eq!(triangulate_within(&points, &edges, |_| None).len(), triangulate(&points, &edges).len());
    }

    #[test]
    fn a_given_edge_is_a_side_and_a_crossing_one_is_left_out() {
        // without the edge, the short vertical diagonal would be chosen
        let points = [[-1.0, 0.0], [1.0, 0.0], [0.0, 0.1], [0.0, -0.1]].map(Vector);
        let side = |triangles: &[[u32; 3]], a, b| triangles.iter().filter(|t| t.contains(&a) && t.contains(&b)).count();
        assert_eq!(side(&triangulate(&points, &[]), 2, 3), 2);
        assert_eq!(side(&triangulate(&points, &[[0, 1]]), 0, 1), 2);
        assert_eq!(triangulate(&points, &[[0, 1], [2, 3]]).len(), 2);
    }

    #[test]
    fn points_in_one_place_and_broken_ones_do_no_harm() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 1e-60]].map(Vector);
        assert_eq!(triangulate(&points, &[[0, 3], [1, 1]]).len(), 1);
        assert!(triangulate(&[Vector([f64::NAN, 0.0]), Vector([1.0, 0.0])], &[]).is_empty());
        assert!(triangulate(&[], &[]).is_empty());
    }
}
