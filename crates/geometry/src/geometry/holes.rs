//! Holes of a surface: holes of unambiguous shape are closed, others are reported.
//!
//! Small holes are closed by a fan, flat ones (an open root at a plane of symmetry, a tip, a base) by triangles in
//! their plane, and narrow ones (the gap of an open trailing edge) by the triangles of least area between the vertices
//! of their rim ([`super::polygon`]).
use std::collections::BTreeMap;

use super::shell::{Facet, Shell, at, facets, root, runs, unite};
use super::{polygon, simplex};
use crate::math::{Bounds, Vector};

/// Greatest extent of a small hole relative to the diagonal of the body.
const SMALL: f64 = 0.05;
/// Greatest number of edges of a small hole.
const FEW: usize = 32;
/// Greatest area of a narrow hole relative to the squared length of its rim; a disc has 0.08.
const NARROW: f64 = 0.01;
/// Greatest area of a narrow hole relative to that of the surrounding part.
const SLIT: f64 = 0.05;
/// Greatest area of a flat hole relative to that of the surrounding part: a sheet closed by itself encloses no volume.
const FACE: f64 = 0.9;
/// Greatest number of holes that are listed in a message.
const LISTED: usize = 20;

/// Closes holes of unambiguous shape. The shell must be oriented.
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

/// Closes a flat or narrow hole in a part of this `surface` and returns which kind it is; `None` when the hole stays
/// open.
fn close_large(shell: &mut Shell<3>, ring: &[(u32, u32)], surface: f64) -> Option<&'static str> {
    let rim: Vec<Vector<3>> = ring.iter().map(|(v, _)| shell.vertices[*v as usize]).collect();
    let area = |triangles: &Vec<[usize; 3]>| {
        triangles.iter().map(|t| simplex::area_vector(&t.map(|k| rim[k])).norm()).sum::<f64>()
    };
    let length: f64 = (0..rim.len()).map(|k| (rim[k] - rim[(k + 1) % rim.len()]).norm()).sum();
    let is_narrow = |t: &Vec<[usize; 3]>| area(t) <= NARROW * length * length && area(t) <= SLIT * surface;
    let flat = polygon::flat(&rim).filter(|t| area(t) <= FACE * surface).map(|t| (t, "flat"));
    let narrow = || polygon::least_area(&rim).filter(is_narrow).map(|t| (t, "narrow"));
    let (triangles, kind) = flat.or_else(narrow)?;
    for [a, b, c] in triangles {
        shell.elements.push([a, b, c].map(|k| ring[k].0));
        shell.tags.extend(shell.tags.get(ring[a].1 as usize).copied());
    }
    Some(kind)
}

/// Adds triangles that close a ring of vertices, each with the element at the edge that starts there.
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

/// Closed rings of open edges without repeated vertices, opposite to the orientation of the adjacent elements.
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
            // where holes touch at a vertex, each forms a ring of its own
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

/// A list of all holes with position, extent and number of edges, largest first.
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
