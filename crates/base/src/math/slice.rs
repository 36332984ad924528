//! Intersection of triangles with a plane normal to an axis, as chains of points on triangle edges.
//!
//! A corner on the plane counts as above it. Each intersected triangle gives a segment between two of its edges, with
//! the part above the plane on its left. Segments meet at shared edges and are joined to chains.
use std::collections::BTreeMap;

use super::Vector;

/// A point on the edge between two corners, at the fraction `part` from the first to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnSide {
    /// Indices of the corners, the smaller one first.
    pub corners: [u32; 2],
    /// Fraction of the edge: 0 at the first corner, 1 at the second.
    pub part: f64,
}

impl OnSide {
    /// Linear interpolation between the values `of` at the corners.
    pub fn value(&self, of: impl Fn(u32) -> f64) -> f64 {
        let [a, b] = self.corners;
        of(a) * (1.0 - self.part) + of(b) * self.part
    }

    /// Position of the point.
    pub fn point<const D: usize>(&self, points: &[Vector<D>]) -> Vector<D> {
        Vector::from_fn(|d| self.value(|i| points[i as usize][d]))
    }
}

/// Chains of points in which the plane x_axis = `at` intersects the triangles; the last point of a closed chain equals
/// the first.
pub fn slice<const D: usize>(points: &[Vector<D>], triangles: &[[u32; 3]], axis: usize, at: f64) -> Vec<Vec<OnSide>> {
    let height = |i: u32| points[i as usize][axis] - at;
    let on = |a: u32, b: u32| {
        let corners = [a.min(b), a.max(b)];
        let [p, q] = corners.map(height);
        OnSide { corners, part: p / (p - q) }
    };
    let mut pieces: Vec<[OnSide; 2]> = Vec::new();
    for t in triangles {
        let sides = [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let rising = sides.iter().find(|[a, b]| height(*a) < 0.0 && height(*b) >= 0.0);
        let falling = sides.iter().find(|[a, b]| height(*a) >= 0.0 && height(*b) < 0.0);
        if let (Some([a, b]), Some([c, d])) = (rising, falling) {
            pieces.push([on(*c, *d), on(*a, *b)]);
        }
    }
    chained(&pieces)
}

/// Joins segments that follow one another.
fn chained(pieces: &[[OnSide; 2]]) -> Vec<Vec<OnSide>> {
    let from: BTreeMap<[u32; 2], usize> = pieces.iter().enumerate().map(|(k, [a, _])| (a.corners, k)).collect();
    let follower = |k: usize| from.get(&pieces[k][1].corners).copied();
    let mut led = vec![false; pieces.len()];
    (0..pieces.len()).filter_map(follower).for_each(|k| led[k] = true);
    let mut used = vec![false; pieces.len()];
    let mut chains = Vec::new();
    // open chains start with a segment without predecessor; the remaining segments form closed chains
    for start in (0..pieces.len()).filter(|k| !led[*k]).chain(0..pieces.len()) {
        let (mut chain, mut at) = (Vec::new(), Some(start).filter(|k| !used[*k]));
        while let Some(k) = at.filter(|k| !used[*k]) {
            used[k] = true;
            if chain.is_empty() {
                chain.push(pieces[k][0]);
            }
            chain.push(pieces[k][1]);
            at = follower(k);
        }
        chains.extend(Some(chain).filter(|chain| chain.len() > 1));
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_cuts_an_octahedron_in_one_closed_chain() {
        let points: Vec<Vector<3>> =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
                .map(Vector)
                .to_vec();
        let triangles: Vec<[u32; 3]> = (0..4).flat_map(|k| [[k, (k + 1) % 4, 4], [(k + 1) % 4, k, 5]]).collect();
        let chains = slice(&points, &triangles, 2, 0.5);
        assert_eq!(chains.len(), 1);
        assert_eq!((chains[0].len(), chains[0][0]), (5, chains[0][4]));
        let around: f64 = chains[0].windows(2).map(|w| (w[1].point(&points) - w[0].point(&points)).norm()).sum();
        assert!((around - 2.0 * 2.0_f64.sqrt()).abs() < 1e-12, "{around}");
        // a plane through corners: these count as above
        let belt = slice(&points, &triangles, 2, 0.0);
        assert_eq!((belt.len(), belt[0].len()), (1, 5));
        assert!(slice(&points, &triangles, 2, 1.5).is_empty());
        // without one triangle, the chain is open
        assert_eq!(slice(&points, &triangles[2..], 2, 0.5)[0].len(), 4);
    }
}
