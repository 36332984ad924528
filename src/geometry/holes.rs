//! Holes of a surface: small ones are closed, large ones are listed.
use std::collections::BTreeMap;

use super::shell::{Facet, Shell, at, facets, root, runs, unite};
use crate::math::{Bounds, Vector};

/// Greatest extent of a hole that is closed, over the diagonal of the body.
const SMALL: f64 = 0.05;
/// Most edges of such a hole.
const FEW: usize = 32;
/// Holes that are listed by place.
const LISTED: usize = 20;

/// Closes small holes: one of three edges by a triangle, others by a fan around their centre. The shell is oriented.
pub(super) fn fill(file: &str, shell: &mut Shell<3>, notes: &mut Vec<String>) {
    let size = Bounds::around(&shell.vertices).extent().norm();
    let all = facets(&shell.elements);
    let open: Vec<Facet> = runs(&all).filter(|run| run.len() == 1).map(|run| run[0]).collect();
    let (mut count, mut widest) = (0, (0.0, Vector::ZERO));
    for ring in rings(shell, &open) {
        let bounds = Bounds::around(ring.iter().map(|(v, _)| &shell.vertices[*v as usize]));
        let extent = bounds.extent().norm();
        if ring.len() > FEW || extent > SMALL * size {
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

/// Closed rings of open edges, against the sense of the elements beside them; none where two holes share a vertex.
fn rings(shell: &Shell<3>, open: &[Facet]) -> Vec<Vec<(u32, u32)>> {
    let mut next: BTreeMap<u32, Vec<(u32, u32)>> = BTreeMap::new();
    for f in open {
        let corners = shell.elements[f.element as usize];
        let (from, to) = (corners[(f.opposite + 2) % 3], corners[(f.opposite + 1) % 3]);
        next.entry(from).or_default().push((to, f.element));
    }
    let mut rings = Vec::new();
    while let Some((&start, _)) = next.iter().next() {
        let (mut ring, mut v, mut simple) = (Vec::new(), start, true);
        while let Some(ways) = next.remove(&v) {
            let (to, element) = ways[0];
            simple &= ways.len() == 1;
            ring.push((v, element));
            v = to;
        }
        if simple && v == start && ring.len() > 2 {
            rings.push(ring);
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
