//! The surface of one body: vertices and elements, and the derived creases, smooth normals and curvature.
//!
//! Two elements meet at a facet: a vertex in 2-D, an edge in 3-D. A facet is a crease where the angle between the
//! normals of its elements exceeds the crease angle. The smooth normal at a corner is a weighted mean over the elements
//! around the vertex that are reached without crossing a crease. The weights, area over the squared lengths of the two
//! sides at the corner, are exact for vertices on a sphere with any connectivity (N. Max, J. Graphics Tools 4(2),
//! 1999).
use super::simplex::{self, Corners};
use crate::math::{Bounds, Vector};

/// Exactly known shape of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exact<const D: usize> {
    /// Only the elements and corner normals are known.
    None,
    /// A circle or a sphere.
    Ball {
        /// Centre.
        centre: Vector<D>,
        /// Radius.
        radius: f64,
    },
}

/// The surface of one body: input to [`super::Surface::new`].
#[derive(Clone, Debug)]
pub struct Shell<const D: usize> {
    /// Vertices.
    pub vertices: Vec<Vector<D>>,
    /// Vertex indices of the elements, counter-clockwise when viewed from the fluid (2-D: along a counter-clockwise
    /// outline).
    pub elements: Vec<[u32; D]>,
    /// Outward unit normals at the corners, if they are known; otherwise they are averaged from the elements.
    pub normals: Option<Vec<[Vector<D>; D]>>,
    /// Signed curvature of largest magnitude of the elements, if it is known; otherwise it is computed from the
    /// normals.
    pub curvature: Option<Vec<f64>>,
    /// Index into `tag_names` for every element; empty when the body has a single tag.
    pub tags: Vec<u16>,
    /// Names of parts (STL solids, OBJ groups); empty when there are none.
    pub tag_names: Vec<String>,
    /// Exact shape, if it is known.
    pub exact: Exact<D>,
    /// Angle between normals above which a facet is a sharp edge (rad).
    pub crease: f64,
}

/// A sharp edge, at which elements meet at more than the crease angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge<const D: usize> {
    /// Ends of the edge; a corner of a 2-D outline is given twice.
    pub ends: [Vector<D>; 2],
    /// Angle between the normals of both sides (rad): positive where the body is convex, near π at a sharp trailing
    /// edge.
    pub turn: f64,
    /// Elements on both sides.
    pub elements: [u32; 2],
    /// Body that the edge belongs to.
    pub body: u16,
}

/// Two elements that share a facet.
pub(super) struct Joint {
    pub(super) facet: [u32; 2],
    elements: [u32; 2],
    /// Angle between the normals (rad), positive where the body is convex.
    pub(super) turn: f64,
}

/// Geometric features derived from the elements of a shell.
pub(super) struct Features<const D: usize> {
    pub(super) normals: Vec<[Vector<D>; D]>,
    pub(super) curvature: Vec<f64>,
    pub(super) edges: Vec<Edge<D>>,
}

impl<const D: usize> Shell<D> {
    /// Corner points of element `e`.
    pub(super) fn corners(&self, e: usize) -> Corners<D> {
        self.elements[e].map(|v| self.vertices[v as usize])
    }

    /// Corner points of all elements.
    #[cfg(test)]
    pub(super) fn all_corners(&self) -> Vec<Corners<D>> {
        (0..self.elements.len()).map(|e| self.corners(e)).collect()
    }

    /// For each element, the first element of its connected component across facets with two elements; `all` are the
    /// facets.
    pub(super) fn edge_connected(&self, all: &[Facet]) -> Vec<u32> {
        let mut group: Vec<u32> = (0..self.elements.len() as u32).collect();
        runs(all).filter(|run| run.len() == 2).for_each(|run| unite(&mut group, run[0].element, run[1].element));
        (0..self.elements.len() as u32).map(|e| root(&mut group, e)).collect()
    }

    /// Creases, corner normals and curvature. Edges have body number 0 and local element numbers.
    pub(super) fn features(&self) -> Features<D> {
        let joints = self.joints();
        let noise = self.noise(&joints);
        let crease = noise.map_or(self.crease, |noise| noise.crease(self.crease));
        let creased = |j: &Joint| j.turn.abs() > crease;
        let groups = || self.corner_groups(joints.iter().filter(|j| !creased(j)));
        let normals = self.normals.clone().unwrap_or_else(|| self.normals_of(&groups()));
        let curvature = match noise {
            Some(noise) => self.curvature_over_noise(&noise, &groups()),
            None => self.curvature.clone().unwrap_or_else(|| self.curvature_of(&normals)),
        };
        let edges = joints.iter().filter(|j| creased(j)).map(|j| Edge {
            ends: j.facet.map(|v| self.vertices[v as usize]),
            turn: j.turn,
            elements: j.elements,
            body: 0,
        });
        Features { edges: edges.collect(), normals, curvature }
    }

    /// Permits different normals on both sides of the facets whose ends are all `apart`, where the shape has a kink
    /// below the crease angle. A smooth patch with a single normal would not reproduce the flat sides there.
    pub(super) fn kinked(mut self, apart: impl Fn(&Vector<D>) -> bool) -> Self {
        let joints = self.joints();
        let kink = |j: &Joint| j.facet.iter().all(|v| apart(&self.vertices[*v as usize]));
        let smooth = joints.iter().filter(|j| j.turn.abs() <= self.crease && !kink(j));
        let normals = self.normals_of(&self.corner_groups(smooth));
        self.curvature = Some(self.curvature_of(&normals));
        self.normals = Some(normals);
        self
    }

    /// Facets that exactly two elements share.
    pub(super) fn joints(&self) -> Vec<Joint> {
        let facets = facets(&self.elements);
        let pairs = facets.chunk_by(|a, b| a.vertices == b.vertices).filter(|run| run.len() == 2);
        pairs.map(|run| self.joint(&run[0], &run[1])).collect()
    }

    fn joint(&self, p: &Facet, q: &Facet) -> Joint {
        let (cp, cq) = (self.corners(p.element as usize), self.corners(q.element as usize));
        let (np, nq) = (simplex::area_vector(&cp).unit(), simplex::area_vector(&cq).unit());
        let concave = np.dot(&(cq[q.opposite] - cp[(p.opposite + 1) % D])) > 0.0;
        let turn = simplex::angle_between(&np, &nq);
        Joint { facet: p.vertices, elements: [p.element, q.element], turn: if concave { -turn } else { turn } }
    }

    /// Number of the group of every corner of the elements; corners that `smooth` facets connect belong together.
    pub(super) fn corner_groups<'a>(&self, smooth: impl Iterator<Item = &'a Joint>) -> Vec<u32> {
        let mut group: Vec<u32> = (0..(self.elements.len() * D) as u32).collect();
        for joint in smooth {
            let [e, f] = joint.elements;
            for v in joint.facet {
                let at = |element: u32| self.elements[element as usize].iter().position(|&w| w == v);
                if let (Some(k), Some(l)) = (at(e), at(f)) {
                    unite(&mut group, e * D as u32 + k as u32, f * D as u32 + l as u32);
                }
            }
        }
        (0..group.len() as u32).map(|corner| root(&mut group, corner)).collect()
    }

    /// Unit normals at the corners, averaged over groups of corners.
    pub(super) fn normals_of(&self, group: &[u32]) -> Vec<[Vector<D>; D]> {
        let mut sum = vec![Vector::ZERO; group.len()];
        for e in 0..self.elements.len() {
            let c = self.corners(e);
            let area = simplex::area_vector(&c);
            for k in 0..D {
                sum[group[e * D + k] as usize] += area * simplex::corner_weight(&c, k);
            }
        }
        let normal = |e: usize, k: usize| sum[group[e * D + k] as usize].unit();
        (0..self.elements.len()).map(|e| std::array::from_fn(|k| normal(e, k))).collect()
    }

    /// Signed curvature of largest magnitude of every element; zero where it is flat within the noise of the vertices.
    fn curvature_of(&self, normals: &[[Vector<D>; D]]) -> Vec<f64> {
        // single-precision files round coordinates to 6e-8 of their size: a smaller sagitta is noise
        const NOISE: f64 = 6e-8;
        let noise = NOISE * Bounds::around(&self.vertices).extent().norm();
        let flat = |kappa: f64, size: f64| kappa.abs() * size * size <= noise || kappa.abs() * size <= 1e-6;
        let each: Vec<f64> = (0..self.elements.len())
            .map(|e| {
                let c = self.corners(e);
                let kappa = simplex::curvature(&c, &normals[e]);
                let size = (0..D).fold(0.0_f64, |s, k| s.max((c[(k + 1) % D] - c[k]).norm()));
                if self.normals.is_none() && flat(kappa, size) { 0.0 } else { kappa }
            })
            .collect();
        if self.normals.is_some() || D == 2 { each } else { self.averaged(&each) }
    }

    /// Average over the elements around the vertices, which reduces the scatter of an irregular triangulation.
    pub(super) fn averaged(&self, values: &[f64]) -> Vec<f64> {
        let mut sum = vec![(0.0, 0.0); self.vertices.len()];
        for (e, value) in values.iter().enumerate() {
            let area = simplex::area_vector(&self.corners(e)).norm();
            for &v in &self.elements[e] {
                let entry = &mut sum[v as usize];
                *entry = (entry.0 + area * value, entry.1 + area);
            }
        }
        let mean = |v: u32| sum[v as usize].0 / sum[v as usize].1.max(f64::MIN_POSITIVE);
        let smooth = |(e, value): (usize, &f64)| {
            let around = self.elements[e].iter().map(|&v| mean(v)).sum::<f64>() / D as f64;
            if *value == 0.0 { 0.0 } else { around }
        };
        values.iter().enumerate().map(smooth).collect()
    }
}

/// One side of a facet: its vertices in ascending order, the element, and the opposite corner.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Facet {
    pub(super) vertices: [u32; 2],
    pub(super) element: u32,
    pub(super) opposite: usize,
}

/// All sides of all facets; equal facets are adjacent in the list.
pub(super) fn facets<const D: usize>(elements: &[[u32; D]]) -> Vec<Facet> {
    let mut facets = Vec::with_capacity(elements.len() * D);
    for (e, vertices) in elements.iter().enumerate() {
        for opposite in 0..D {
            let (v, w) = (vertices[(opposite + 1) % D], vertices[(opposite + D - 1) % D]);
            facets.push(Facet { vertices: [v.min(w), v.max(w)], element: e as u32, opposite });
        }
    }
    facets.sort_unstable();
    facets
}

/// Groups of facets with the same vertices.
pub(super) fn runs(facets: &[Facet]) -> impl Iterator<Item = &[Facet]> {
    facets.chunk_by(|a, b| a.vertices == b.vertices)
}

/// A position as text for a message.
pub(super) fn at(x: &Vector<3>) -> String {
    format!("({:.6}, {:.6}, {:.6})", x[0], x[1], x[2])
}

/// Representative of `i` in a union-find forest, with path halving.
pub(super) fn root(group: &mut [u32], mut i: u32) -> u32 {
    while group[i as usize] != i {
        group[i as usize] = group[group[i as usize] as usize];
        i = group[i as usize];
    }
    i
}

/// Unites the groups of `i` and `j`; the smaller index becomes the representative.
pub(super) fn unite(group: &mut [u32], i: u32, j: u32) {
    let (i, j) = (root(group, i), root(group, j));
    group[i.max(j) as usize] = i.min(j);
}

impl<const D: usize> Shell<D> {
    /// The same shell when `E` equals `D`, for code that is generic in the dimension.
    pub(super) fn cast<const E: usize>(self) -> Option<Shell<E>> {
        if D != E {
            return None;
        }
        let vector = |x: &Vector<D>| Vector::<E>::from_fn(|d| x[d]);
        let exact = match self.exact {
            Exact::None => Exact::None,
            Exact::Ball { centre, radius } => Exact::Ball { centre: vector(&centre), radius },
        };
        let normals = self.normals.map(|all| all.iter().map(|n| std::array::from_fn(|k| vector(&n[k]))).collect());
        Some(Shell {
            vertices: self.vertices.iter().map(vector).collect(),
            elements: self.elements.iter().map(|e| std::array::from_fn(|k| e[k])).collect(),
            normals,
            curvature: self.curvature,
            tags: self.tags,
            tag_names: self.tag_names,
            exact,
            crease: self.crease,
        })
    }
}
