//! Merging of coincident vertices of a triangle soup.
//!
//! The smallest tolerance that closes the surface is used, from round-off over single precision to the noise of scans,
//! as long as no triangle is lost: details thinner than the tolerance are preserved.
use super::GeometryError;
use super::mesh::Soup;
use super::shell::{Exact, Shell, facets, runs};
use crate::math::{Bounds, Vector};
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;

/// Tolerances as fractions of the diagonal of the body; those above single-precision round-off are tried only where
/// smaller ones leave open edges.
const WELD: [f64; 5] = [1e-9, 1e-6, 1e-5, 4e-5, 1e-4];
/// Smallest size of a surface; squares of areas of smaller ones would underflow.
const SMALLEST: f64 = 1e-50;
/// Turning angle above which an edge is sharp [rad] (40°).
const CREASE: f64 = 40.0 * PI / 180.0;

/// Merges vertices nearer than `within`; `None`: the smallest tolerance that closes the surface.
pub(super) fn weld(
    file: &str,
    soup: &Soup,
    within: Option<f64>,
    notes: &mut Vec<String>,
) -> Result<Shell<3>, GeometryError> {
    let size = Bounds::around(soup.triangles.iter().flatten()).extent().norm();
    if size < SMALLEST || !size.is_finite() || soup.triangles.len() > u32::MAX as usize / 3 {
        let what = format!("{} triangles of extent {size} are no surface", soup.triangles.len());
        return Err(GeometryError::refused(file, what, "check the export"));
    }
    let mut mended = Vec::new();
    let mut best = welded(soup, within.unwrap_or(WELD[0] * size), file, &mut mended);
    let (mut least, gaps) = (best.edges(), best.edges().open);
    for tolerance in WELD[1..].iter().map(|t| t * size).filter(|_| within.is_none()) {
        if least.open == 0 {
            break;
        }
        let mut wider = Vec::new();
        let next = welded(soup, tolerance, file, &mut wider);
        // a larger tolerance must close edges and must not flatten thin details
        let edges = next.edges();
        if edges.open < least.open && edges.crowded <= least.crowded && next.collapsed == best.collapsed {
            wider.push(format!("{file}: vertices up to {tolerance:.1e} apart are joined to close {gaps} open edges"));
            (best, least, mended) = (next, edges, wider);
        }
    }
    let best = best.shell;
    notes.append(&mut mended);
    if best.elements.is_empty() {
        return Err(GeometryError::refused(file, "all triangles are degenerate", "check the export"));
    }
    Ok(best)
}

/// The shell with vertices nearer than `tolerance` merged, without degenerate and repeated triangles.
fn welded(soup: &Soup, tolerance: f64, file: &str, notes: &mut Vec<String>) -> Welded {
    let mut welder = Welder { cell: 4.0 * tolerance, tolerance, cells: HashMap::new(), vertices: Vec::new() };
    let (mut elements, mut tags) = (Vec::new(), Vec::new());
    let mut seen: HashMap<[u32; 3], usize> = HashMap::with_capacity(soup.triangles.len());
    let mut between: Vec<usize> = Vec::new();
    let (mut degenerate, mut repeated) = (0, 0);
    for (triangle, &tag) in soup.triangles.iter().zip(&soup.tags) {
        let element = triangle.map(|x| welder.vertex(&x));
        let mut key = element;
        key.sort_unstable();
        if key[0] == key[1] || key[1] == key[2] {
            degenerate += 1;
        } else if let Some(first) = seen.get(&key) {
            repeated += 1;
            between.extend(Some(*first).filter(|e| !same_sense(&elements[*e], &element)));
        } else {
            seen.insert(key, elements.len());
            elements.push(element);
            tags.push(tag);
        }
    }
    let walls = drop_between(&mut elements, &mut tags, &between);
    if walls > 0 {
        notes.push(format!("{file}: {walls} pairs of triangles between parts that share a wall are left out"));
        repeated -= walls;
    }
    for (count, kind) in [(degenerate, "degenerate"), (repeated, "repeated")] {
        if count > 0 {
            notes.push(format!("{file}: {count} {kind} triangles are left out"));
        }
    }
    let (vertices, tag_names) = (welder.vertices, soup.names.clone());
    let shell = Shell {
        vertices,
        elements,
        normals: None,
        curvature: None,
        tags,
        tag_names,
        exact: Exact::None,
        crease: CREASE,
    };
    Welded { shell, collapsed: degenerate + repeated + walls }
}

/// True when two triangles of the same vertices have the same orientation.
fn same_sense(a: &[u32; 3], b: &[u32; 3]) -> bool {
    b.iter().position(|v| *v == a[0]).is_some_and(|k| b[(k + 1) % 3] == a[1])
}

/// Removes triangles `between` two parts, which occur once for each part, if this reduces the number of edges with an
/// odd number of triangles; they are then walls that both parts share and not copies of outer ones. Returns the number
/// removed.
fn drop_between(elements: &mut Vec<[u32; 3]>, tags: &mut Vec<u16>, between: &[usize]) -> usize {
    if between.is_empty() {
        return 0;
    }
    let odd = |elements: &[[u32; 3]]| runs(&facets(elements)).filter(|run| run.len() % 2 == 1).count();
    let inner: HashSet<usize> = between.iter().copied().collect();
    // the rim of a fin of zero thickness, both sides of which are present, has no other triangle
    if runs(&facets(elements)).any(|run| run.len() == 1 && inner.contains(&(run[0].element as usize))) {
        return 0;
    }
    let outer = |e: &usize| !inner.contains(e);
    let rest: Vec<[u32; 3]> = (0..elements.len()).filter(outer).map(|e| elements[e]).collect();
    if odd(&rest) >= odd(elements) {
        return 0;
    }
    *tags = (0..tags.len()).filter(outer).map(|e| tags[e]).collect();
    *elements = rest;
    inner.len()
}

/// A shell, and the number of triangles lost by merging.
struct Welded {
    shell: Shell<3>,
    collapsed: usize,
}

/// Numbers of edges with one triangle and with more than two.
#[derive(Clone, Copy)]
struct Edges {
    open: usize,
    crowded: usize,
}

impl Welded {
    fn edges(&self) -> Edges {
        let all = facets(&self.shell.elements);
        let count = |which: fn(usize) -> bool| runs(&all).filter(|run| which(run.len())).count();
        Edges { open: count(|n| n == 1), crowded: count(|n| n > 2) }
    }
}

/// Merges near points with a hash grid of cells four tolerances wide: a ball of the radius of one tolerance overlaps
/// few cells.
struct Welder {
    cell: f64,
    tolerance: f64,
    cells: HashMap<[i64; 3], Vec<u32>>,
    vertices: Vec<Vector<3>>,
}

impl Welder {
    fn key(&self, x: &Vector<3>, shift: &Vector<3>) -> [i64; 3] {
        std::array::from_fn(|d| ((x[d] + shift[d]) / self.cell).floor() as i64)
    }

    fn vertex(&mut self, x: &Vector<3>) -> u32 {
        let home = self.key(x, &Vector::ZERO);
        for corner in 0..8_u32 {
            let shift = Vector::from_fn(|d| if corner >> d & 1 == 1 { self.tolerance } else { -self.tolerance });
            let key = self.key(x, &shift);
            let near = |v: &&u32| (self.vertices[**v as usize] - *x).norm() <= self.tolerance;
            if let Some(&v) = self.cells.get(&key).and_then(|cell| cell.iter().find(near)) {
                return v;
            }
            if corner == 0 && key == home && self.key(x, &Vector::splat(self.tolerance)) == home {
                break;
            }
        }
        let v = self.vertices.len() as u32;
        self.vertices.push(*x);
        self.cells.entry(home).or_default().push(v);
        v
    }
}
