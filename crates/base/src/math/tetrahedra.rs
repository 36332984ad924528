//! Tetrahedralisation of points in space.
//!
//! A Delaunay tetrahedralisation by incremental insertion (Bowyer 1981, doi:10.1093/comjnl/24.2.162; Watson 1981,
//! doi:10.1093/comjnl/24.2.167) with exact predicates. Points of a lattice lie on common spheres, which makes exact
//! predicates slow and tetrahedra flat. Every point is therefore first moved by at most a millionth of its
//! spacing, by reproducible random numbers, and tetrahedra that are still flat are omitted.
use simple_delaunay_lib::delaunay_3d::delaunay_struct_3d::DelaunayStructure3D;
use simple_delaunay_lib::delaunay_3d::simplicial_struct_3d::Node;

use super::Vector;
use super::rotation::cross;

/// Maximum displacement of a point, relative to its spacing.
const MOVED: f64 = 1e-6;
/// Ratio of six volumes to the cube of the longest edge below which a tetrahedron is regarded as flat.
const FLAT: f64 = 1e-4;
/// Cosine of the angle between the normal at a surface point and the direction to a corner, below which the corner is
/// behind the surface.
const BEHIND: f64 = -0.5;

/// Maximum number of points that are tetrahedralised: more would need more memory than the solver.
pub const MOST: usize = 1_000_000;

/// Tetrahedra between `points` with the given `spacing`, oriented so that volumes are positive. Empty if there are
/// fewer than four points or a coordinate is not finite.
pub fn tetrahedralise(points: &[Vector<3>], spacing: &[f64]) -> Vec<[u32; 4]> {
    let mut all = delaunay(points, spacing);
    all.retain(|corners| !is_flat(points, corners));
    all
}

/// Tetrahedra as by [`tetrahedralise`], without those outside a surface or through it: `normal` is the unit normal of a
/// surface point, pointing inwards, and `None` for all other points.
pub fn tetrahedralise_within(
    points: &[Vector<3>],
    spacing: &[f64],
    normal: impl Fn(u32) -> Option<Vector<3>>,
) -> Vec<[u32; 4]> {
    let mut all = tetrahedralise(points, spacing);
    all.retain(|corners| {
        let middle = corners.iter().fold(Vector::ZERO, |sum, i| sum + points[*i as usize]) * 0.25;
        let on_surface = || corners.iter().filter_map(|i| Some((points[*i as usize], normal(*i)?)));
        let beside = |i: &u32| {
            on_surface().all(|(x, n)| {
                let way = points[*i as usize] - x;
                normal(*i).is_some() || way.dot(&n) >= BEHIND * way.norm()
            })
        };
        let front = on_surface().map(|(x, n)| (middle - x).unit().dot(&n)).sum::<f64>();
        (on_surface().count() < 4 || front > 0.0) && corners.iter().all(beside)
    });
    all
}

/// Tetrahedra as by [`tetrahedralise`], including flat ones, so that every face inside the convex hull belongs to two
/// of them.
pub fn delaunay(points: &[Vector<3>], spacing: &[f64]) -> Vec<[u32; 4]> {
    let moved = moved(points, spacing);
    if points.len() < 4 || !moved.iter().flatten().all(|x| x.is_finite()) {
        return Vec::new();
    }
    let mut built = DelaunayStructure3D::new();
    if built.insert_vertices(&moved, true).is_err() {
        return Vec::new();
    }
    let all = built.get_simplicial();
    let corners = |k: usize| -> Option<[u32; 4]> {
        let mut corners = [0; 4];
        for (corner, node) in corners.iter_mut().zip(all.get_tetrahedron(k).ok()?.nodes()) {
            match node {
                Node::Value(i) => *corner = i as u32,
                Node::Infinity => return None,
            }
        }
        Some(turned(&moved, corners))
    };
    (0..all.get_nb_tetrahedra()).filter_map(corners).collect()
}

fn moved(points: &[Vector<3>], spacing: &[f64]) -> Vec<[f64; 3]> {
    // random numbers by Marsaglia (2003, doi:10.18637/jss.v008.i14); any sequence without a pattern would do
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut part = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    points.iter().zip(spacing).map(|(x, h)| x.0.map(|x| x + MOVED * h * part())).collect()
}

fn volume_of([a, b, c, d]: [Vector<3>; 4]) -> f64 {
    Vector(cross(&(b - a).0, &(c - a).0)).dot(&(d - a))
}

/// The corners in an order that makes the volume positive.
fn turned(moved: &[[f64; 3]], [a, b, c, d]: [u32; 4]) -> [u32; 4] {
    let volume = volume_of([a, b, c, d].map(|i| Vector(moved[i as usize])));
    if volume > 0.0 { [a, b, c, d] } else { [a, c, b, d] }
}

fn is_flat(points: &[Vector<3>], corners: &[u32; 4]) -> bool {
    let [a, b, c, d] = corners.map(|i| points[i as usize]);
    let sides = [b - a, c - a, d - a, c - b, d - b, d - c];
    let longest = sides.iter().map(Vector::norm_squared).fold(0.0, f64::max).sqrt();
    !(volume_of([a, b, c, d]) > FLAT * longest.powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(points: &[Vector<3>], t: &[u32; 4]) -> f64 {
        let [a, b, c, d] = t.map(|i| points[i as usize]);
        Vector(cross(&(b - a).0, &(c - a).0)).dot(&(d - a)) / 6.0
    }

    #[test]
    fn a_lattice_is_covered_once() {
        let at = |k: u32| f64::from(k) / 9.0;
        let points: Vec<Vector<3>> = (0..1000).map(|k| Vector([at(k % 10), at(k / 10 % 10), at(k / 100)])).collect();
        let found = tetrahedralise(&points, &[1.0 / 9.0; 1000]);
        assert!(found.iter().all(|t| volume(&points, t) > 0.0));
        assert!((found.iter().map(|t| volume(&points, t)).sum::<f64>() - 1.0).abs() < 1e-6);
        assert_eq!(found, tetrahedralise(&points, &[1.0 / 9.0; 1000]));
    }

    #[test]
    fn what_is_no_body_of_points_has_none() {
        assert!(tetrahedralise(&[Vector::ZERO; 3], &[1.0; 3]).is_empty());
        assert!(tetrahedralise(&[Vector([f64::NAN; 3]); 5], &[1.0; 5]).is_empty());
        assert!(tetrahedralise(&[Vector::ZERO; 6], &[1.0; 6]).is_empty(), "all in one place");
        let flat: Vec<Vector<3>> = (0..25).map(|k| Vector([f64::from(k % 5), f64::from(k / 5), 0.0])).collect();
        assert!(tetrahedralise(&flat, &[1.0; 25]).is_empty());
    }
}
