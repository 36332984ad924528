//! The hull: the walls of bodies in space as triangles that show the flow, with values at their corners.
//!
//! The triangles are those of the surface itself, so that edges are sharp and no gaps are left. What lies beyond a side of the
//! domain is cut away. A side longer than the particles there are apart is halved, by its own length alone, so that
//! neighbours halve it alike and no cracks open. Corners are shared where places and normals are the same, and are two where a
//! surface has an edge.
use std::collections::BTreeMap;

use super::wall_weights::WallWeights;
use super::{Snapshot, WallSnapshot};
use crate::geometry::Surface;
use crate::math::parallel::sweep_each;
use crate::math::{Bounds, Vector};
use crate::scheme::View;

/// Longest side of a triangle over the distance between particles there.
const LENGTH: f64 = 0.75;
/// Triangles over wall particles at that length, and how many triangles there are at most before sides grow longer.
const PER_PARTICLE: f64 = 6.0;
const MOST: f64 = 600_000.0;
/// Times that sides are halved, at most.
const HALVINGS: usize = 12;

/// Triangles of the walls.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hull {
    /// Corners, as they are now.
    pub(crate) points: Vec<[f64; 3]>,
    /// Normals into the gas, three components a corner.
    pub(crate) normals: Vec<f64>,
    /// Counterclockwise as seen from the gas.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Body of each corner.
    pub(crate) body: Vec<f64>,
    /// Columns of the walls at the corners: name, components, values.
    pub(crate) columns: Vec<(&'static str, usize, Vec<f64>)>,
}

/// A corner of a triangle: place and normal before any motion.
#[derive(Clone, Copy, PartialEq)]
struct Corner<const D: usize> {
    x: Vector<D>,
    normal: Vector<D>,
}

/// A triangle and the body that it is of.
type Facet<const D: usize> = ([Corner<D>; 3], u16);

impl Hull {
    /// The walls of `surface` with what the particles on them know; `all` are the columns of all particles.
    pub(crate) fn of<const D: usize>(
        view: &View<'_, D>,
        surface: &Surface<D>,
        (all, walls): (&Snapshot, &WallSnapshot),
    ) -> Self {
        let cloud = view.reference();
        let domain = cloud.tree.bounds();
        let facets = (0..surface.elements.len()).flat_map(|e| cut(facet(surface, e as u32), &domain)).collect();
        let coarser = (PER_PARTICLE * cloud.interface.len() as f64 / MOST).sqrt().max(1.0);
        let facets = refined(facets, |x| LENGTH * coarser * cloud.tree.leaf_at(x).size);
        let (corners, body, triangles) = welded(&facets);
        let weights = WallWeights::of(cloud);
        let mut found: Vec<Vec<(u32, f64)>> = vec![Vec::new(); corners.len()];
        sweep_each(&mut found, |k| weights.at(&corners[k].x, &corners[k].normal));
        let carried = |k: usize| view.carried(usize::from(body[k]), &corners[k].x).to_3d();
        let turned = |k: usize| view.carried_direction(usize::from(body[k]), &corners[k].normal).to_3d();
        let range = cloud.interface_range();
        let of_field = ["total_pressure_loss", "entropy", "temperature"]
            .into_iter()
            .filter_map(|name| Some((name, 1, all.column(name)?.get(range.clone())?.to_vec())));
        let left_out = ["normal", "area", "arc", "x_c", "area_vector"];
        let own = walls.on.columns.iter().filter(|(name, ..)| !left_out.contains(name)).cloned();
        Self {
            points: (0..corners.len()).map(carried).collect(),
            normals: (0..corners.len()).flat_map(turned).collect(),
            triangles,
            columns: own.chain(of_field).map(|(name, n, values)| (name, n, spread(&found, n, &values))).collect(),
            body: body.into_iter().map(f64::from).collect(),
        }
    }
}

/// Values of wall particles, `n` each, at corners; no farther out than those they are made of.
fn spread(found: &[Vec<(u32, f64)>], n: usize, values: &[f64]) -> Vec<f64> {
    let at = |weights: &Vec<(u32, f64)>, c: usize| {
        let own = |w: u32| values[w as usize * n + c];
        let [low, high] =
            weights.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], (w, _)| [a.min(own(*w)), b.max(own(*w))]);
        let value: f64 = weights.iter().map(|(w, weight)| weight * own(*w)).sum();
        if low <= high { value.clamp(low, high) } else { f64::NAN }
    };
    found.iter().flat_map(|weights| (0..n).map(move |c| at(weights, c))).collect()
}

fn facet<const D: usize>(surface: &Surface<D>, element: u32) -> Facet<D> {
    let (own, x) = (surface.element(element), surface.corners(element));
    (std::array::from_fn(|c| Corner { x: x[c.min(D - 1)], normal: own.normals[c.min(D - 1)] }), own.body)
}

/// The corner at the part `s` of the way from `a` to `b`, the same bits for either order of the two.
fn between<const D: usize>(a: &Corner<D>, b: &Corner<D>, part: impl Fn(&Corner<D>, &Corner<D>) -> f64) -> Corner<D> {
    let swapped = a.x.0.iter().zip(&b.x.0).find(|(p, q)| p != q).is_some_and(|(p, q)| p > q);
    let (a, b) = if swapped { (b, a) } else { (a, b) };
    let s = part(a, b);
    let normal = a.normal * (1.0 - s) + b.normal * s;
    Corner { x: a.x * (1.0 - s) + b.x * s, normal: if normal.norm() > 0.0 { normal.unit() } else { a.normal } }
}

/// What of a triangle lies in the domain, as triangles.
fn cut<const D: usize>((corners, body): Facet<D>, domain: &Bounds<D>) -> Vec<Facet<D>> {
    let mut polygon = corners.to_vec();
    for d in 0..D {
        for (at, sign) in [(domain.min[d], 1.0), (domain.max[d], -1.0)] {
            let height = |c: &Corner<D>| sign * (c.x[d] - at);
            if polygon.iter().all(|c| height(c) >= 0.0) {
                continue;
            }
            let mut left = Vec::new();
            for (k, a) in polygon.iter().enumerate() {
                let b = &polygon[(k + 1) % polygon.len()];
                if height(a) >= 0.0 {
                    left.push(*a);
                }
                if (height(a) >= 0.0) != (height(b) >= 0.0) {
                    let mut at_side = between(a, b, |p, q| height(p) / (height(p) - height(q)));
                    at_side.x[d] = at;
                    left.push(at_side);
                }
            }
            polygon = left;
        }
    }
    (2..polygon.len()).map(|k| ([polygon[0], polygon[k - 1], polygon[k]], body)).collect()
}

/// Triangles whose sides are no longer than `length` at their middles.
fn refined<const D: usize>(mut facets: Vec<Facet<D>>, length: impl Fn(&Vector<D>) -> f64) -> Vec<Facet<D>> {
    let (mut done, half) = (Vec::new(), |_: &Corner<D>, _: &Corner<D>| 0.5);
    for _ in 0..HALVINGS {
        let mut next = Vec::new();
        for (corners, body) in facets {
            let middle = |k: usize| between(&corners[k], &corners[(k + 1) % 3], half);
            let long = |k: usize| (corners[k].x - corners[(k + 1) % 3].x).norm() > length(&middle(k).x);
            // begin with the side that the pieces share a corner of
            let long = [0, 1, 2].map(long);
            let first = (0..3).find(|k| long[*k] && !long[(k + 2) % 3]).unwrap_or(0);
            let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
            let [p, q, r] = [0, 1, 2].map(|k| middle((first + k) % 3));
            let pieces = match [0, 1, 2].map(|k| long[(first + k) % 3]) {
                [false, ..] => {
                    done.push((corners, body));
                    continue;
                }
                [true, false, _] => vec![[a, p, c], [p, b, c]],
                [true, true, false] if (p.x - c.x).norm() <= (a.x - q.x).norm() => {
                    vec![[p, b, q], [p, q, c], [a, p, c]]
                }
                [true, true, false] => vec![[p, b, q], [a, p, q], [a, q, c]],
                [true, true, true] => vec![[a, p, r], [p, b, q], [r, q, c], [p, q, r]],
            };
            next.extend(pieces.into_iter().map(|piece| (piece, body)));
        }
        facets = next;
    }
    done.extend(facets);
    done
}

/// Corners, the body of each, and triangles of them.
fn welded<const D: usize>(facets: &[Facet<D>]) -> (Vec<Corner<D>>, Vec<u16>, Vec<[u32; 3]>) {
    /// Normals that differ by less than one part in so many are the same.
    const SAME: f64 = 64.0;
    let (mut corners, mut body) = (Vec::new(), Vec::new());
    let mut known: BTreeMap<(Vec<u64>, Vec<i64>, u16), u32> = BTreeMap::new();
    let mut triangles = Vec::with_capacity(facets.len());
    for (own, of) in facets {
        let mut number = |c: &Corner<D>| {
            // 0.0 and -0.0 are one place
            let place = c.x.0.iter().map(|v| (v + 0.0).to_bits()).collect();
            let normal = c.normal.0.iter().map(|v| (SAME * v).round() as i64).collect();
            *known.entry((place, normal, *of)).or_insert_with(|| {
                corners.push(*c);
                body.push(*of);
                corners.len() as u32 - 1
            })
        };
        let t = own.each_ref().map(&mut number);
        if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
            triangles.push(t);
        }
    }
    (corners, body, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::icosphere;

    fn sphere() -> Vec<Facet<3>> {
        let shell = icosphere(1.0, 1);
        let surface = Surface::new(&[("ball".to_owned(), shell)]);
        (0..surface.elements.len()).map(|e| facet(&surface, e as u32)).collect()
    }

    fn area(facets: &[Facet<3>]) -> f64 {
        let of = |([a, b, c], _): &Facet<3>| {
            let (p, q) = (b.x - a.x, c.x - a.x);
            0.5 * (p.norm_squared() * q.norm_squared() - p.dot(&q).powi(2)).max(0.0).sqrt()
        };
        facets.iter().map(of).sum()
    }

    /// Sides that one triangle has alone.
    fn alone(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
        let sides = |t: &[u32; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let all: Vec<[u32; 2]> = triangles.iter().flat_map(sides).collect();
        all.iter().filter(|[a, b]| !all.contains(&[*b, *a])).copied().collect()
    }

    #[test]
    fn halved_sides_leave_no_cracks() {
        let facets = sphere();
        // finer towards one side
        let fine = refined(facets.clone(), |x| 0.12 + 0.2 * (1.0 + x[0]));
        assert!(fine.len() > 2 * facets.len(), "{}", fine.len());
        assert!((area(&fine) / area(&facets) - 1.0).abs() < 1e-12);
        let (corners, body, triangles) = welded(&fine);
        assert_eq!((corners.len(), triangles.len()), (body.len(), fine.len()));
        assert!(alone(&triangles).is_empty());
        let longest = |([a, b, c], _): &Facet<3>| [(a, b), (b, c), (c, a)].map(|(p, q)| (p.x - q.x).norm());
        assert!(fine.iter().flat_map(longest).all(|l| l < 0.52));
    }

    #[test]
    fn what_lies_beyond_a_side_is_cut_away() {
        let domain = Bounds { min: Vector([-2.0, 0.1, -2.0]), max: Vector::splat(2.0) };
        let half: Vec<Facet<3>> = sphere().into_iter().flat_map(|f| cut(f, &domain)).collect();
        let (corners, _, triangles) = welded(&refined(half, |_| 0.2));
        assert!(corners.iter().all(|c| c.x[1] >= 0.1));
        let rim = alone(&triangles);
        assert!(
            rim.len() > 8 && rim.iter().flatten().all(|i| corners[*i as usize].x[1] == 0.1),
            "the rim is on the side"
        );
    }
}
