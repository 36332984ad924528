//! Holes of a surface: those whose shape leaves no doubt are closed, others are listed.
//!
//! Small holes are closed by a fan, flat ones (a root that is open at a plane of symmetry, a tip, a base) and narrow ones (the gap of an
//! open trailing edge) by the triangles of least area between the vertices of their rim: dynamic programming over the polygon, G. Barequet and M. Sharir, *Filling
//! gaps in the boundary of a polyhedron*, Computer Aided Geometric Design 12 (1995). A small part of the squares of sides prefers short ones
//! where areas are the same.
use std::collections::BTreeMap;

use super::shell::{Facet, Shell, at, facets, root, runs, unite};
use super::simplex;
use crate::math::{Bounds, Vector};

/// Greatest extent of a hole that is closed, over the diagonal of the body.
const SMALL: f64 = 0.05;
/// Most edges of such a hole.
const FEW: usize = 32;
/// Most edges of a hole that is closed by triangles of least area: the work grows with their cube.
const MANY: usize = 1000;
/// Greatest distance of the rim of a flat hole from a plane, over its extent.
const FLAT: f64 = 0.01;
/// Greatest area of a narrow hole, over the square of the length of its rim: that of a disc has 0.08.
const NARROW: f64 = 0.01;
/// Greatest area of a narrow hole, over that of the part around it.
const SLIT: f64 = 0.05;
/// Greatest area of a flat hole, over that of the part around it: closing a sheet on itself bounds no volume.
const FACE: f64 = 0.9;
/// Weight of the squares of sides beside areas.
const SHORT: f64 = 1e-3;
/// Holes that are listed by place.
const LISTED: usize = 20;

/// Closes holes whose shape leaves no doubt. The shell is oriented.
pub(super) fn fill(file: &str, shell: &mut Shell<3>, notes: &mut Vec<String>) {
    let size = Bounds::around(&shell.vertices).extent().norm();
    let all = facets(&shell.elements);
    let open: Vec<Facet> = runs(&all).filter(|run| run.len() == 1).map(|run| run[0]).collect();
    let part = shell.edge_connected(&all);
    let mut area = vec![0.0; shell.elements.len()];
    (0..shell.elements.len()).for_each(|e| area[part[e] as usize] += simplex::area_vector(&shell.corners(e)).norm());
    let (mut count, mut widest) = (0, (0.0, Vector::ZERO));
    for ring in rings(shell, &open, &part) {
        let bounds = Bounds::around(ring.iter().map(|(v, _)| &shell.vertices[*v as usize]));
        let extent = bounds.extent().norm();
        if ring.len() > FEW || extent > SMALL * size {
            notes.extend(close_large(shell, &ring, area[part[ring[0].1 as usize] as usize]).map(|kind| {
                let (edges, place) = (ring.len(), at(&bounds.centre()));
                format!("{file}: a {kind} opening of {edges} edges, {extent:.2e} across around {place}, is closed")
            }));
            continue;
        }
        close(shell, &ring);
        count += 1;
        if extent >= widest.0 {
            widest = (extent, bounds.centre());
        }
    }
    if count > 0 {
        let what =
            if count == 1 { "1 small hole is closed".to_owned() } else { format!("{count} small holes are closed") };
        notes.push(format!("{file}: {what}, the largest {:.2e} across near {}", widest.0, at(&widest.1)));
    }
}

/// Closes a flat or a narrow hole in a part of this `surface`, and tells which it is; others stay open.
fn close_large(shell: &mut Shell<3>, ring: &[(u32, u32)], surface: f64) -> Option<&'static str> {
    if ring.len() > MANY {
        return None;
    }
    let rim: Vec<Vector<3>> = ring.iter().map(|(v, _)| shell.vertices[*v as usize]).collect();
    let triangles = least_area(&rim);
    let corners = |t: &[usize; 3]| t.map(|k| rim[k]);
    let area: f64 = triangles.iter().map(|t| simplex::area_vector(&corners(t)).norm()).sum();
    let sum = triangles.iter().fold(Vector::ZERO, |sum, t| sum + simplex::area_vector(&corners(t)));
    let bounds = Bounds::around(&rim);
    let normal = sum.unit();
    let centre = rim.iter().fold(Vector::ZERO, |sum, x| sum + *x) * (1.0 / rim.len() as f64);
    let depth = rim.iter().map(|x| (*x - centre).dot(&normal).abs()).fold(0.0, f64::max);
    let flat = depth <= FLAT * bounds.extent().norm() && sum.norm() >= (1.0 - FLAT) * area;
    let length: f64 = (0..rim.len()).map(|k| (rim[k] - rim[(k + 1) % rim.len()]).norm()).sum();
    let narrow = area <= NARROW * length * length && area <= SLIT * surface;
    if !(narrow || flat && area <= FACE * surface) {
        return None;
    }
    for [a, b, c] in triangles {
        shell.elements.push([a, b, c].map(|k| ring[k].0));
        shell.tags.extend(shell.tags.get(ring[a].1 as usize).copied());
    }
    Some(if flat { "flat" } else { "narrow" })
}

/// The triangles of least area between the vertices of a closed polygon, in its sense.
fn least_area(rim: &[Vector<3>]) -> Vec<[usize; 3]> {
    let n = rim.len();
    let side = |i: usize, j: usize| (rim[i] - rim[j]).norm_squared();
    let weight = |i: usize, m: usize, j: usize| {
        let area = simplex::area_vector(&[rim[i], rim[m], rim[j]]).norm();
        area + SHORT * (side(i, m) + side(m, j) + side(i, j))
    };
    // least weight between the vertices i and j, and the third vertex on their side
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
    triangles
}

/// Adds the triangles that close a ring of vertices, each with the element beside the edge that leaves it.
fn close(shell: &mut Shell<3>, ring: &[(u32, u32)]) {
    let n = ring.len();
    let tag = |shell: &Shell<3>, e: u32| shell.tags.get(e as usize).copied();
    let add = |shell: &mut Shell<3>, element: [u32; 3], beside: u32| {
        shell.tags.extend(tag(shell, beside));
        shell.elements.push(element);
    };
    if let [(a, e), (b, _), (c, _)] = *ring {
        return add(shell, [a, b, c], e);
    }
    let centre = ring.iter().fold(Vector::ZERO, |sum, (v, _)| sum + shell.vertices[*v as usize]) * (1.0 / n as f64);
    let middle = shell.vertices.len() as u32;
    shell.vertices.push(centre);
    for (k, (v, e)) in ring.iter().enumerate() {
        add(shell, [*v, ring[(k + 1) % n].0, middle], *e);
    }
}

/// Closed rings of open edges without a vertex twice, against the sense of the elements beside them.
fn rings(shell: &Shell<3>, open: &[Facet], part: &[u32]) -> Vec<Vec<(u32, u32)>> {
    let mut next: BTreeMap<(u32, u32), Vec<(u32, u32)>> = BTreeMap::new();
    for f in open {
        let corners = shell.elements[f.element as usize];
        let (from, to) = (corners[(f.opposite + 2) % 3], corners[(f.opposite + 1) % 3]);
        next.entry((part[f.element as usize], from)).or_default().push((to, f.element));
    }
    let mut rings = Vec::new();
    while let Some((&(own, start), _)) = next.iter().next() {
        let (mut path, mut place, mut v) = (Vec::new(), BTreeMap::new(), start);
        while let Some(ways) = next.get_mut(&(own, v)) {
            let Some((to, element)) = ways.pop() else { break };
            if ways.is_empty() {
                next.remove(&(own, v));
            }
            place.insert(v, path.len());
            path.push((v, element));
            // where holes meet at a vertex, each is a ring of its own
            if let Some(&k) = place.get(&to) {
                let ring = path.split_off(k);
                ring.iter().for_each(|(w, _)| {
                    place.remove(w);
                });
                rings.extend(Some(ring).filter(|ring| ring.len() > 2));
            }
            v = to;
        }
    }
    rings
}

/// All holes with place, extent and number of edges, largest first.
pub(super) fn told(shell: &Shell<3>, open: &[Facet]) -> String {
    let mut group: Vec<u32> = (0..shell.vertices.len() as u32).collect();
    open.iter().for_each(|f| unite(&mut group, f.vertices[0], f.vertices[1]));
    let mut holes: BTreeMap<u32, (Bounds<3>, usize)> = BTreeMap::new();
    for f in open {
        let hole = holes.entry(root(&mut group, f.vertices[0])).or_insert((Bounds::EMPTY, 0));
        let ends = f.vertices.map(|v| shell.vertices[v as usize]);
        *hole = (hole.0.grown(&ends[0]).grown(&ends[1]), hole.1 + 1);
    }
    let mut holes: Vec<(Bounds<3>, usize)> = holes.into_values().collect();
    holes.sort_by(|a, b| b.0.extent().norm().total_cmp(&a.0.extent().norm()));
    let one = |(bounds, edges): &(Bounds<3>, usize)| {
        format!("{edges} edges, {:.2e} across near {}", bounds.extent().norm(), at(&bounds.centre()))
    };
    let mut list: Vec<String> = holes.iter().take(LISTED).map(one).collect();
    if holes.len() > LISTED {
        list.push(format!("and {} smaller ones", holes.len() - LISTED));
    }
    format!("{} open edges in {} holes: {}", open.len(), holes.len(), list.join("; "))
}
