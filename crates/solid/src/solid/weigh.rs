//! Volumes and area vectors of particles from a triangulation.
//!
//! The simplices between the particles are used once and not stored. A simplex T inside the body assigns a share of its
//! volume to each of its corners. Faces that belong to one simplex only form the surface, whose area is shared among
//! their corners. Hence Σ A = 0 and Σ x ⊗ A = V I to round-off, as the divergence theorem of [`super::particles`]
//! requires.
use std::collections::HashMap;

use super::particles::{Facet, Fill};
use crate::math::Vector;
use crate::math::rotation::cross;
use crate::math::tetrahedra::delaunay;
use crate::math::triangulation::triangulate;

/// Height, in spacings, below which a tetrahedron between surface particles is flat, so that its centre does not tell
/// whether it lies inside. Between particles of a sphere with a diameter of four spacings it is 0.03.
const FLAT: f64 = 0.12;

/// Twice the area, in squared spacings, below which a triangle is a product of round-off.
const NOTHING: f64 = 1e-9;

/// Volumes and areas of particles in 2-D from the triangles between them, which are constrained by `outline` and whose
/// centre satisfies
/// `inside`. The shares are Voronoi areas where no angle is obtuse (Meyer, Desbrun, Schröder and Barr 2003).
pub(super) fn weigh_in_plane(
    x: Vec<Vector<2>>,
    outline: &[[u32; 2]],
    spacing: f64,
    inside: impl Fn(&Vector<2>) -> bool,
) -> Fill<2> {
    let (mut volume, mut moment, mut sides) = (vec![0.0; x.len()], vec![Vector::ZERO; x.len()], Sides::default());
    for triangle in triangulate(&x, outline) {
        let corners = triangle.map(|i| x[i as usize]);
        let [b, c] = [corners[1] - corners[0], corners[2] - corners[0]];
        // three particles on a straight side: the triangle would remove the middle one from the surface
        if (b[0] * c[1] - b[1] * c[0]).abs() < NOTHING * spacing * spacing {
            continue;
        }
        if !inside(&((corners[0] + corners[1] + corners[2]) * (1.0 / 3.0))) {
            continue;
        }
        let shares = shares(&corners);
        let left = moment_left(&corners, &shares);
        for k in 0..3 {
            volume[triangle[k] as usize] += shares[k];
            moment[triangle[k] as usize] += left;
            sides.add([triangle[k], triangle[(k + 1) % 3]]);
        }
    }
    let facet = |side: [u32; 2]| {
        let along = x[side[1] as usize] - x[side[0] as usize];
        Facet::new(&side, Vector([along[1], -along[0]]))
    };
    let facets = sides.single().into_iter().map(facet).collect();
    Fill { x, volume, facets, spacing, moment, ..Fill::default() }
}

/// First moment of a triangle that its shares miss, divided by three: one part for each corner.
fn moment_left(corners: &[Vector<2>; 3], shares: &[f64; 3]) -> Vector<2> {
    let third = shares.iter().sum::<f64>() / 3.0;
    corners.iter().zip(shares).fold(Vector::ZERO, |sum, (x, share)| sum + *x * ((third - share) / 3.0))
}

/// Faces of simplices, with the number of simplices that have each.
struct Sides<const D: usize>(HashMap<[u32; D], ([u32; D], u32)>);

impl<const D: usize> Default for Sides<D> {
    fn default() -> Self {
        Self(HashMap::new())
    }
}

impl<const D: usize> Sides<D> {
    fn add(&mut self, side: [u32; D]) {
        let mut key = side;
        key.sort_unstable();
        self.0.entry(key).or_insert((side, 0)).1 += 1;
    }

    /// Faces that belong to one simplex only, sorted by their corners.
    fn single(self) -> Vec<[u32; D]> {
        let mut once: Vec<_> = self.0.into_iter().filter(|(_, (_, count))| *count == 1).collect();
        once.sort_unstable();
        once.into_iter().map(|(_, (side, _))| side).collect()
    }
}

/// Fractions of the area of a triangle that belong to its corners.
fn shares(corners: &[Vector<2>; 3]) -> [f64; 3] {
    let side = |k: usize| corners[(k + 2) % 3] - corners[(k + 1) % 3];
    let along = |k: usize| side((k + 1) % 3) * -1.0;
    let turn = |a: Vector<2>, b: Vector<2>| a[0] * b[1] - a[1] * b[0];
    let area = 0.5 * turn(side(0), side(1)).abs();
    // at each corner, its cosine times the lengths of both sides
    let cosine = [0, 1, 2].map(|k| along(k).dot(&side((k + 2) % 3)));
    if let Some(obtuse) = (0..3).find(|k| cosine[*k] < 0.0) {
        return [0, 1, 2].map(|k| if k == obtuse { 0.5 * area } else { 0.25 * area });
    }
    let part = |k: usize| side(k).norm_squared() * cosine[k] / (2.0 * area);
    [0, 1, 2].map(|k| (part((k + 1) % 3) + part((k + 2) % 3)) / 8.0)
}

/// Volumes and areas of particles in 3-D: each tetrahedron assigns a quarter to each corner. The first `skin` particles
/// lie on the surface.
pub(super) fn weigh_in_space(
    x: Vec<Vector<3>>,
    skin: usize,
    spacing: f64,
    inside: impl Fn(&Vector<3>) -> bool,
) -> Fill<3> {
    let turn = |[a, b, c]: [Vector<3>; 3]| Vector(cross(&(b - a).0, &(c - a).0)) * 0.5;
    let at = |t: &[u32; 4]| t.map(|i| x[i as usize]);
    let size = |t: &[u32; 4]| {
        let c = at(t);
        turn([c[0], c[1], c[2]]).dot(&(c[3] - c[0])) / 3.0
    };
    let middle = |t: &[u32; 4]| at(t).iter().fold(Vector::ZERO, |sum, c| sum + *c * 0.25);
    let widest = |t: &[u32; 4]| faces(t).map(|f| turn(f.map(|i| x[i as usize])).norm()).into_iter().fold(0.0, f64::max);
    let flat = |t: &[u32; 4]| t.iter().all(|i| (*i as usize) < skin) && !(3.0 * size(t) > FLAT * spacing * widest(t));
    let mut all = delaunay(&x, &vec![spacing; x.len()]);
    all.retain(|t| flat(t) || inside(&middle(t)));
    let (mut volume, mut sides) = (vec![0.0; x.len()], Sides::default());
    let kept = without_flat_skin(all, flat);
    for t in &kept {
        t.iter().for_each(|i| volume[*i as usize] += 0.25 * size(t));
        faces(t).into_iter().for_each(|face| sides.add(face));
    }
    let facet = |side: [u32; 3]| Facet::new(&side, turn(side.map(|i| x[i as usize])));
    let facets = sides.single().into_iter().map(facet).collect();
    let ties = ties(&kept, x.len());
    Fill { x, volume, facets, spacing, ties, ..Fill::default() }
}

/// For each of `count` particles, the others with which it shares a simplex, in ascending order.
fn ties(all: &[[u32; 4]], count: usize) -> Vec<Vec<u32>> {
    let mut ties = vec![Vec::new(); count];
    for t in all {
        for i in t {
            ties[*i as usize].extend(t.iter().filter(|j| *j != i));
        }
    }
    for row in &mut ties {
        row.sort_unstable();
        row.dedup();
    }
    ties
}

/// Faces of a tetrahedron, oriented outward.
fn faces(t: &[u32; 4]) -> [[u32; 3]; 4] {
    [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]].map(|face: [usize; 3]| face.map(|k| t[k]))
}

/// Removes flat tetrahedra on the surface of the others, layer by layer; inside the body they connect the others.
fn without_flat_skin(all: Vec<[u32; 4]>, flat: impl Fn(&[u32; 4]) -> bool) -> Vec<[u32; 4]> {
    let key = |mut face: [u32; 3]| {
        face.sort_unstable();
        face
    };
    let mut of: HashMap<[u32; 3], Vec<usize>> = HashMap::new();
    for (k, t) in all.iter().enumerate() {
        faces(t).into_iter().for_each(|face| of.entry(key(face)).or_default().push(k));
    }
    let mut kept = vec![true; all.len()];
    let mut to_see: Vec<usize> = (0..all.len()).filter(|k| flat(&all[*k])).collect();
    while let Some(k) = to_see.pop() {
        let single = |face: [u32; 3]| of[&key(face)].iter().filter(|o| kept[**o]).count() < 2;
        if !kept[k] || !faces(&all[k]).into_iter().any(single) {
            continue;
        }
        kept[k] = false;
        let beside = faces(&all[k]).into_iter().flat_map(|face| of[&key(face)].iter().copied());
        to_see.extend(beside.filter(|o| kept[*o] && flat(&all[*o])));
    }
    all.into_iter().zip(kept).filter(|(_, kept)| *kept).map(|(t, _)| t).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identities<const D: usize>(fill: &Fill<D>, whole: f64) {
        let volume: f64 = fill.volume.iter().sum();
        assert!((volume / whole - 1.0).abs() < 1e-12, "{volume}");
        assert!(fill.volume.iter().all(|v| *v > 0.0));
        let area = fill.areas();
        let total = area.iter().fold(Vector::ZERO, |sum, a| sum + *a);
        assert!(total.max_abs() < 1e-12);
        for (r, c) in (0..D).flat_map(|r| (0..D).map(move |c| (r, c))) {
            let moment: f64 = fill.x.iter().zip(&area).map(|(x, a)| x[r] * a[c]).sum();
            assert!((moment - if r == c { whole } else { 0.0 }).abs() < 1e-12, "{moment}");
        }
    }

    fn noise(k: usize) -> f64 {
        let x = (k as f64 * 12.9898).sin() * 43758.5453;
        x - x.floor() - 0.5
    }

    #[test]
    fn a_square_and_a_cube_are_shared_out() {
        let n = 7;
        let mut points = Vec::new();
        for k in 0..n * n {
            let (i, j) = (k % n, k / n);
            let inner = |i: usize| 0 < i && i < n - 1;
            let shift = |k: usize, free: bool| if free { 0.05 * noise(k) } else { 0.0 };
            let free = inner(i) && inner(j);
            points.push(Vector([i as f64 / 6.0 + shift(2 * k, free), j as f64 / 6.0 + shift(2 * k + 1, free)]));
        }
        identities(&weigh_in_plane(points, &[], 1.0 / 6.0, |_| true), 1.0);
        let mut points = Vec::new();
        for k in 0..n * n * n {
            let place = [k % n, k / n % n, k / n / n];
            let free = place.iter().all(|i| 0 < *i && *i < n - 1);
            let shift = |k: usize| if free { 0.05 * noise(k) } else { 0.0 };
            points.push(Vector::from_fn(|d| place[d] as f64 / 6.0 + shift(3 * k + d)));
        }
        identities(&weigh_in_space(points, n * n * n, 1.0 / 6.0, |_| true), 1.0);
    }
}
