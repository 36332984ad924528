//! Circles, ellipses, spheres and boxes, and writers of surface files.
//!
//! A circle is a regular polygon, and a sphere a subdivided icosahedron (each triangle is divided into four, and new
//! vertices are moved onto the sphere). Both have their exact shape attached, so that positions and normals on them are
//! exact. Boxes have flat sides and creases.
use super::shell::{Exact, Shell};
use super::surface::Surface;
use crate::math::Vector;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::io::{self, Write};

/// Number of segments of a circle; chords deviate from it by at most 7e-8 radii.
const SEGMENTS: u32 = 8192;
/// Number of subdivisions of the icosahedron; 81 920 triangles deviate from the sphere by at most 5e-5 radii.
const SUBDIVISIONS: u32 = 6;
/// Greatest number of subdivisions of [`icosphere`], which gives 21 million triangles.
const MOST_SUBDIVISIONS: u32 = 10;
/// Crease angle of primitives (rad) (40°).
const CREASE: f64 = 40.0 * PI / 180.0;

/// A circle about the origin.
pub(super) fn circle(radius: f64) -> Shell<2> {
    let direction = |i: u32| {
        let angle = 2.0 * PI * f64::from(i % SEGMENTS) / f64::from(SEGMENTS);
        Vector([angle.cos(), angle.sin()])
    };
    Shell {
        vertices: (0..SEGMENTS).map(|i| direction(i) * radius).collect(),
        elements: (0..SEGMENTS).map(|i| [i, (i + 1) % SEGMENTS]).collect(),
        normals: Some((0..SEGMENTS).map(|i| [direction(i), direction(i + 1)]).collect()),
        curvature: None,
        tags: Vec::new(),
        tag_names: Vec::new(),
        exact: Exact::Ball { centre: Vector::ZERO, radius },
        crease: CREASE,
    }
}

/// An ellipse about the origin with the semi-axes `half`. Points are at equal steps of the eccentric angle, and hence
/// dense at the ends, with exact normals.
pub(super) fn ellipse(half: [f64; 2]) -> Shell<2> {
    let (circle, [a, b]) = (circle(1.0), half);
    Shell {
        vertices: circle.vertices.iter().map(|x| Vector([a * x[0], b * x[1]])).collect(),
        normals: circle.normals.map(|all| all.iter().map(|n| n.map(|n| Vector([b * n[0], a * n[1]]).unit())).collect()),
        exact: Exact::None,
        ..circle
    }
}

/// A sphere about the origin.
pub(super) fn sphere(radius: f64) -> Shell<3> {
    icosphere(radius, SUBDIVISIONS)
}

/// A sphere about the origin from an icosahedron subdivided `subdivisions` times (at most 10), with 20·4ⁿ triangles.
pub fn icosphere(radius: f64, subdivisions: u32) -> Shell<3> {
    let (mut vertices, mut elements) = icosahedron();
    for _ in 0..subdivisions.min(MOST_SUBDIVISIONS) {
        elements = subdivide(&mut vertices, &elements);
    }
    Shell {
        normals: Some(elements.iter().map(|e| e.map(|v| vertices[v as usize])).collect()),
        vertices: vertices.iter().map(|v| *v * radius).collect(),
        elements,
        curvature: None,
        tags: Vec::new(),
        tag_names: Vec::new(),
        exact: Exact::Ball { centre: Vector::ZERO, radius },
        crease: CREASE,
    }
}

/// The unit icosahedron, from the corners of three golden rectangles.
fn icosahedron() -> (Vec<Vector<3>>, Vec<[u32; 3]>) {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut vertices = Vec::new();
    for axis in 0..3 {
        for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
            let mut v = Vector::ZERO;
            v[axis] = a;
            v[(axis + 1) % 3] = b;
            vertices.push(v.unit());
        }
    }
    let edge = 2.0 / (1.0 + golden * golden).sqrt();
    let adjacent = |a: usize, b: usize| ((vertices[a] - vertices[b]).norm() - edge).abs() < 0.1;
    let mut elements = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in (b + 1..12).filter(|&c| adjacent(a, b) && adjacent(b, c) && adjacent(c, a)) {
                let n = super::simplex::area_vector(&[vertices[a], vertices[b], vertices[c]]);
                let (b, c) = if n.dot(&vertices[a]) > 0.0 { (b, c) } else { (c, b) };
                elements.push([a as u32, b as u32, c as u32]);
            }
        }
    }
    (vertices, elements)
}

/// Divides each triangle into four; new vertices lie on the unit sphere.
fn subdivide(vertices: &mut Vec<Vector<3>>, elements: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            vertices.push((vertices[a as usize] + vertices[b as usize]).unit());
            vertices.len() as u32 - 1
        })
    };
    let mut finer = Vec::with_capacity(4 * elements.len());
    for &[a, b, c] in elements {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    finer
}

/// Corners of a rectangle centred on the origin, counter-clockwise.
pub(super) fn rectangle(size: [f64; 2]) -> Vec<Vector<2>> {
    let (a, b) = (0.5 * size[0], 0.5 * size[1]);
    vec![Vector([-a, -b]), Vector([a, -b]), Vector([a, b]), Vector([-a, b])]
}

/// A box centred on the origin; corner k lies on the side of greater coordinates of axis d where bit d of k is set.
pub fn cuboid(size: [f64; 3]) -> Shell<3> {
    let corner = |i: u32| Vector::from_fn(|d| size[d] * if i >> d & 1 == 1 { 0.5 } else { -0.5 });
    let side = |axis: u32| {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let high = 1 << axis;
        [[0, u + v, u], [0, v, u + v], [high, high + u, high + u + v], [high, high + u + v, high + v]]
    };
    Shell {
        vertices: (0..8).map(corner).collect(),
        elements: (0..3).flat_map(side).collect(),
        normals: None,
        curvature: None,
        tags: Vec::new(),
        tag_names: Vec::new(),
        exact: Exact::None,
        crease: CREASE,
    }
}

/// Writes a surface as a binary STL file, in single precision as the format prescribes.
pub fn write_stl(out: &mut impl Write, surface: &Surface<3>) -> io::Result<()> {
    out.write_all(&[0; 80])?;
    out.write_all(&(surface.elements.len() as u32).to_le_bytes())?;
    for e in 0..surface.elements.len() as u32 {
        let normal = surface.element_area_vector(e).unit();
        for x in std::iter::once(&normal).chain(&surface.corners(e)) {
            x.0.iter().try_for_each(|c| out.write_all(&(*c as f32).to_le_bytes()))?;
        }
        out.write_all(&[0; 2])?;
    }
    Ok(())
}

/// Writes a surface as an OBJ file with all digits and one group for each tag.
pub fn write_obj(out: &mut impl Write, surface: &Surface<3>) -> io::Result<()> {
    for x in &surface.vertices {
        writeln!(out, "v {} {} {}", x[0], x[1], x[2])?;
    }
    let mut group = None;
    for e in &surface.elements {
        if group != Some(e.tag) {
            group = Some(e.tag);
            writeln!(out, "g {}", surface.tags[usize::from(e.tag)])?;
        }
        let [a, b, c] = e.vertices.map(|v| v + 1);
        writeln!(out, "f {a} {b} {c}")?;
    }
    Ok(())
}

/// Writes the outlines of 2-D bodies as coordinates `x y` with all digits, once around each body; the name of the body
/// precedes its points.
pub fn write_outlines(out: &mut impl Write, surface: &Surface<2>) -> io::Result<()> {
    for (body, name) in surface.bodies.iter().enumerate() {
        writeln!(out, "{name}")?;
        let own: Vec<_> = surface.elements.iter().filter(|e| usize::from(e.body) == body).collect();
        let closed = own.iter().chain(own.first()).map(|e| &surface.vertices[e.vertices[0] as usize]);
        for x in closed {
            writeln!(out, "{} {}", x[0], x[1])?;
        }
    }
    Ok(())
}
