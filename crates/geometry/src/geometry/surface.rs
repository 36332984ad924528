//! The discretised surface of all bodies, around which the cloud of particles is built.
//!
//! A surface consists of segments (2-D) or triangles (3-D) with outward unit normals at their corners. It answers four
//! queries: the nearest point, whether a segment crosses the surface, whether a point lies inside a body, and the exact
//! position, normal and curvature at a point.
//!
//! Inside means that the generalised winding number exceeds one half (Jacobson, Kavan, Sorkine-Hornung 2013), which also
//! holds for surfaces with gaps. Area and volume follow from the area vectors: V = Σ x·A / D.
use super::reference::Measured;
use super::shell::{Edge, Exact, Shell};
use super::tree::Tree;
use super::{TOUCHING, simplex};
use crate::math::{Bounds, Vector};

/// A segment (2-D) or triangle (3-D) of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element<const D: usize> {
    /// Vertex indices, counter-clockwise when viewed from the fluid (2-D: along a counter-clockwise outline).
    pub vertices: [u32; D],
    /// Outward unit normals at the corners: continuous across smooth facets, different on both sides of a crease.
    pub normals: [Vector<D>; D],
    /// Index into [`Surface::bodies`].
    pub body: u16,
    /// Index into [`Surface::tags`].
    pub tag: u16,
}

/// The point of the surface nearest to a query point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest<const D: usize> {
    /// Nearest point of the element.
    pub point: Vector<D>,
    /// Interpolated outward unit normal.
    pub normal: Vector<D>,
    /// Distance from the query point.
    pub distance: f64,
    /// Index of the element.
    pub element: u32,
    /// Barycentric weights of `point` in the element.
    pub weights: [f64; D],
}

/// A point of the shape that the elements approximate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection<const D: usize> {
    /// Position.
    pub point: Vector<D>,
    /// Outward unit normal.
    pub normal: Vector<D>,
    /// Normal curvature of largest magnitude [1/length], positive where the body is convex; zero on a flat wall.
    pub curvature: f64,
}

/// The outer surface of one body, or of several that intersect.
#[derive(Clone, Debug)]
pub struct Skin<const D: usize> {
    /// Vertices and elements.
    pub shell: Shell<D>,
    /// Body to which each element belongs; a single entry when all belong to the same body.
    pub owner: Vec<u16>,
}

/// The surface of all bodies of a case.
#[derive(Clone, Debug)]
pub struct Surface<const D: usize> {
    /// Vertices.
    pub vertices: Vec<Vector<D>>,
    /// Elements, grouped by body.
    pub elements: Vec<Element<D>>,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Names of tagged parts; a body without parts has its own name as the tag.
    pub tags: Vec<String>,
    /// Smallest radius of curvature at every element; infinite where it is flat.
    pub radius: Vec<f64>,
    /// Signed curvature of largest magnitude of every element, positive where the body is convex.
    pub curvature: Vec<f64>,
    /// Sharp edges: corners in 2-D, crease segments in 3-D.
    pub sharp: Vec<Edge<D>>,
    /// Exact shape of every body, where it is known.
    pub exact: Vec<Exact<D>>,
    /// Leading and trailing edge of every body of a case (2-D).
    pub chord_lines: Vec<Option<[Vector<D>; 2]>>,
    tree: Tree<D>,
    bounds: Bounds<D>,
    /// Bounding box of each body.
    boxes: Vec<Bounds<D>>,
    /// Elements before clipping, of bodies that are clipped by others; empty for the other bodies.
    whole: Vec<Vec<[Vector<D>; D]>>,
    pub(super) measured: Measured,
}

impl<const D: usize> Surface<D> {
    /// Combines the named shells of all bodies.
    pub fn new(shells: &[(String, Shell<D>)]) -> Self {
        let names: Vec<String> = shells.iter().map(|(name, _)| name.clone()).collect();
        let skin = |(k, (_, shell)): (usize, &(String, Shell<D>))| Skin { shell: shell.clone(), owner: vec![k as u16] };
        Self::of(&names, &shells.iter().enumerate().map(skin).collect::<Vec<_>>())
    }

    /// Combines the outer surfaces of all bodies, which have these names.
    pub fn of(bodies: &[String], skins: &[Skin<D>]) -> Self {
        let mut surface = Self {
            vertices: Vec::new(),
            elements: Vec::new(),
            bodies: bodies.to_vec(),
            tags: Vec::new(),
            radius: Vec::new(),
            curvature: Vec::new(),
            sharp: Vec::new(),
            exact: vec![Exact::None; bodies.len()],
            chord_lines: vec![None; bodies.len()],
            tree: Tree::new(&[]),
            bounds: Bounds::EMPTY,
            boxes: Vec::new(),
            whole: vec![Vec::new(); bodies.len()],
            measured: Measured::default(),
        };
        for skin in skins {
            surface.add(skin);
        }
        let corners: Vec<_> = (0..surface.elements.len()).map(|e| surface.corners(e as u32)).collect();
        surface.tree = Tree::new(&corners);
        surface.enclose(&corners);
        surface.radius = surface.curvature.iter().map(|k| 1.0 / k.abs()).collect();
        surface
    }

    /// Stores the elements of body number `body` before it was clipped by others.
    pub(super) fn keep_whole(&mut self, body: usize, shell: &Shell<D>) {
        self.measured = Measured::default();
        self.whole[body] = (0..shell.elements.len()).map(|e| shell.corners(e)).collect();
    }

    /// Corners of the elements of body number `body`, including the parts inside other bodies; without a number, those
    /// of all walls.
    pub(super) fn corners_of(&self, body: Option<usize>) -> Vec<[Vector<D>; D]> {
        match body {
            Some(k) if !self.whole[k].is_empty() => self.whole[k].clone(),
            _ => {
                let own = |e: &usize| body.is_none_or(|k| usize::from(self.elements[*e].body) == k);
                (0..self.elements.len()).filter(own).map(|e| self.corners(e as u32)).collect()
            }
        }
    }

    /// The surface with every body moved rigidly; `point` and `direction` receive the number of the body. Exact shapes
    /// are lost; only their elements remain.
    pub fn moved(
        &self,
        point: impl Fn(u16, &Vector<D>) -> Vector<D>,
        direction: impl Fn(u16, &Vector<D>) -> Vector<D>,
    ) -> Self {
        let mut moved = self.clone();
        for (before, after) in self.elements.iter().zip(&mut moved.elements) {
            for v in before.vertices {
                moved.vertices[v as usize] = point(before.body, &self.vertices[v as usize]);
            }
            after.normals = before.normals.map(|n| direction(before.body, &n));
        }
        let corners: Vec<_> = (0..moved.elements.len()).map(|e| moved.corners(e as u32)).collect();
        moved.tree = Tree::new(&corners);
        moved.enclose(&corners);
        moved.measured = Measured::default();
        moved.exact = vec![Exact::None; self.exact.len()];
        moved
    }

    fn add(&mut self, skin: &Skin<D>) {
        let Skin { shell, owner } = skin;
        let (vertex, element) = (self.vertices.len() as u32, self.elements.len() as u32);
        let features = shell.features();
        let body = |e: usize| owner[e.min(owner.len() - 1)];
        self.vertices.extend(&shell.vertices);
        for (e, vertices) in shell.elements.iter().enumerate() {
            let own =
                shell.tags.get(e).and_then(|t| shell.tag_names.get(usize::from(*t))).filter(|name| !name.is_empty());
            let name = own.unwrap_or(&self.bodies[usize::from(body(e))]).clone();
            let tag = self.tag(&name);
            let (vertices, normals) = (vertices.map(|v| v + vertex), features.normals[e]);
            self.elements.push(Element { vertices, normals, body: body(e), tag });
        }
        self.sharp.extend(features.edges.iter().map(|edge| Edge {
            body: body(edge.elements[0] as usize),
            elements: edge.elements.map(|e| e + element),
            ..*edge
        }));
        self.curvature.extend(&features.curvature);
        if let [only] = owner[..] {
            self.exact[usize::from(only)] = shell.exact;
        }
    }

    fn tag(&mut self, name: &str) -> u16 {
        // elements of the same tag follow one another: it is usually the last one
        let found = self.tags.iter().rposition(|t| t == name).unwrap_or_else(|| {
            self.tags.push(name.to_string());
            self.tags.len() - 1
        });
        found.min(usize::from(u16::MAX)) as u16
    }

    /// Corner points of an element.
    pub fn corners(&self, element: u32) -> [Vector<D>; D] {
        self.elements[element as usize].vertices.map(|v| self.vertices[v as usize])
    }

    /// The point of the surface nearest to `x`, if its distance is less than `within`.
    pub fn nearest(&self, x: &Vector<D>, within: f64) -> Option<Nearest<D>> {
        let hit = self.tree.nearest(x, within)?;
        let (point, normal) = self.element_point(hit.element, &hit.weights);
        let distance = hit.distance_squared.sqrt();
        Some(Nearest { point, normal, distance, element: hit.element, weights: hit.weights })
    }

    /// True when the open segment from `a` to `b` crosses an element. End points on the surface (within 1e-9 of the
    /// length of the segment) do not count: a chord through a body between two points of its wall crosses nothing.
    pub fn crosses(&self, a: &Vector<D>, b: &Vector<D>) -> bool {
        self.tree.crosses(a, b)
    }

    /// Greatest height n·y of the elements within `bounds` along the unit vector `direction`; −∞ when there are none.
    pub fn highest(&self, direction: &Vector<D>, bounds: &Bounds<D>) -> f64 {
        self.tree.highest(direction, bounds)
    }

    /// True when the surface is closed: every side of an element is shared with a second one in the opposite direction.
    pub fn is_closed(&self) -> bool {
        let mut sides = Vec::with_capacity(self.elements.len() * D);
        for e in &self.elements {
            let v = &e.vertices;
            for c in 0..D {
                let next = v[(c + 1) % D];
                // in 2-D a side is a vertex, at which one segment starts and one ends
                sides.push(if D == 2 { (v[c], 0, c == 0) } else { (v[c].min(next), v[c].max(next), v[c] < next) });
            }
        }
        sides.sort_unstable();
        sides.chunks(2).all(|s| s.len() == 2 && (s[0].0, s[0].1) == (s[1].0, s[1].1) && s[0].2 != s[1].2)
    }

    /// True when `x` lies inside a body; reliable for surfaces with small gaps too.
    pub fn inside(&self, x: &Vector<D>) -> bool {
        self.bounds.contains(x) && self.winding(x) > 0.5
    }

    /// Generalised winding number: near 1 inside, near 0 outside.
    pub fn winding(&self, x: &Vector<D>) -> f64 {
        self.tree.winding(x)
    }

    /// Bounding box of all elements.
    pub fn bounds(&self) -> Bounds<D> {
        self.bounds
    }

    /// Bounding box of body number `body`.
    pub fn bounds_of(&self, body: usize) -> Bounds<D> {
        self.boxes.get(body).copied().unwrap_or(Bounds::EMPTY)
    }

    /// Computes the bounding boxes of all elements and of each body from their corners.
    fn enclose(&mut self, corners: &[[Vector<D>; D]]) {
        self.boxes = vec![Bounds::EMPTY; self.bodies.len()];
        for (element, corners) in self.elements.iter().zip(corners) {
            let own = &mut self.boxes[usize::from(element.body)];
            *own = own.union(&simplex::bounds(corners));
        }
        self.bounds = self.boxes.iter().fold(Bounds::EMPTY, |all, own| all.union(own));
    }

    /// Total area (2-D: length of the outlines).
    pub fn area(&self) -> f64 {
        (0..self.elements.len()).map(|e| self.element_area_vector(e as u32).norm()).sum()
    }

    /// Enclosed volume (2-D: area).
    pub fn volume(&self) -> f64 {
        let centre = self.bounds.centre();
        let flux = |e: u32| (simplex::centroid(&self.corners(e)) - centre).dot(&self.element_area_vector(e));
        (0..self.elements.len()).map(|e| flux(e as u32)).sum::<f64>() / D as f64
    }

    /// Area vector of an element: outward normal times area (2-D: length).
    pub fn element_area_vector(&self, element: u32) -> Vector<D> {
        simplex::area_vector(&self.corners(element))
    }

    /// Point of an element with these barycentric weights, and the interpolated outward unit normal there.
    pub fn element_point(&self, element: u32, weights: &[f64; D]) -> (Vector<D>, Vector<D>) {
        let normal = simplex::blend(&self.elements[element as usize].normals, weights).unit();
        (simplex::blend(&self.corners(element), weights), normal)
    }

    /// Position, normal and curvature of the shape that the elements approximate: exact on circles and spheres,
    /// elsewhere on the cubic patch through the corners of the element with their normals (in 2-D fourth-order accurate
    /// along the outline).
    pub fn project(&self, nearest: &Nearest<D>) -> Projection<D> {
        let element = &self.elements[nearest.element as usize];
        if let Exact::Ball { centre, radius } = self.exact[usize::from(element.body)] {
            let normal = (nearest.point - centre).unit();
            return Projection { point: centre + normal * radius, normal, curvature: 1.0 / radius };
        }
        Projection {
            point: simplex::CurvedPatch::new(&self.corners(nearest.element), &element.normals).at(&nearest.weights),
            normal: nearest.normal,
            curvature: self.curvature[nearest.element as usize],
        }
    }

    /// First position where elements without a common vertex intersect, with both elements: a self-intersection of a
    /// body, or an overlap of two.
    pub fn intersection(&self) -> Option<(Vector<D>, [u32; 2])> {
        (0..self.elements.len() as u32).find_map(|e| {
            let corners = self.corners(e);
            let mut found = None;
            self.tree.meeting(e + 1, &corners, |f, other| {
                if f > e && !self.neighbours(e, f) {
                    found = simplex::intersection(&corners, other).map(|x| (x, [e, f]));
                }
                found.is_some()
            });
            found
        })
    }

    /// First position where two straight sides of an outline overlap along more than `slack`, with both sides (2-D
    /// only). `counted` decides from the product of their directions which pairs are considered.
    pub(super) fn overlap(&self, slack: f64, counted: impl Fn(f64) -> bool) -> Option<(Vector<D>, [u32; 2])> {
        (0..self.elements.len() as u32).find_map(|e| {
            let corners = self.corners(e);
            let mut found = None;
            self.tree.overlapping(&simplex::bounds(&corners).padded(slack), |f, other| {
                if f > e && counted((corners[1] - corners[0]).dot(&(other[1] - other[0]))) {
                    found = simplex::overlap(&corners, other, slack).map(|x| (x, [e, f]));
                }
                found.is_some()
            });
            found
        })
    }

    /// First position where this surface intersects another one; elements that share a corner are excluded.
    pub(super) fn crossing(&self, other: &Self) -> Option<Vector<D>> {
        (0..self.elements.len() as u32).find_map(|e| {
            let corners = self.corners(e);
            let mut found = None;
            other.tree.meeting(0, &corners, |_, theirs| {
                if !corners.iter().any(|x| theirs.contains(x)) {
                    found = simplex::intersection(&corners, theirs);
                }
                found.is_some()
            });
            found
        })
    }

    /// True when this closed surface overlaps or touches another one.
    pub(super) fn meets(&self, other: &Self) -> bool {
        let touching = |s: &Self| TOUCHING * s.bounds().extent().max_abs();
        let within = |a: &Self, b: &Self| {
            a.vertices.first().is_some_and(|x| b.inside(x))
                || a.vertices.iter().any(|x| b.nearest(x, touching(b)).is_some())
        };
        self.bounds().meets(&other.bounds(), touching(self))
            && (within(self, other) || within(other, self) || self.crossing(other).is_some())
    }

    fn neighbours(&self, e: u32, f: u32) -> bool {
        let other = &self.elements[f as usize].vertices;
        self.elements[e as usize].vertices.iter().any(|v| other.contains(v))
    }
}
