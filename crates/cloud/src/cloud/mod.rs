//! The cloud: the positions of the particles, their neighbour lists, and the derivative operators that follow from
//! both.
//!
//! There are four kinds of particles, stored one kind after the other: *fluid* particles in Hilbert order, *interface*
//! particles on the surfaces, *outer* particles on the sides of the domain, and *ghosts*, which are images of other
//! particles across planes of symmetry and periodic sides. Only the fluid particles carry unknowns. The states of the
//! other kinds follow from the boundary conditions.
pub mod build;
mod clouds;
mod coefficient_unknowns;
mod columns;
pub mod conservative;
mod estimate;
pub mod fill;
pub mod grid;
pub mod interface;
mod layer_interface;
mod layer_termination;
pub mod layers;
pub mod layout;
mod metric_update;
mod multipliers;
mod near_wall_smoothing;
pub mod neighbours;
pub mod operators;
pub mod particles;
pub mod quality;
pub mod repair;
mod samples;
pub mod sources;
pub mod spec;
pub mod strain;
#[cfg(test)]
mod tests;
pub mod travel;
pub mod tree;
mod wall_stars;

use std::ops::{Index, Range};

use crate::case::Side;
use crate::math::Vector;
use crate::math::jet::Scalar;
use crate::math::parallel::sweep;

pub use layout::Layout;
pub use neighbours::Neighbours;
pub use operators::{Edge, Operators, Weights};
pub use quality::Diagnosis;
pub use spec::CloudSpec;
pub use strain::Strain;

/// A particle on a surface: its normal, its area and its curvature.
#[derive(Clone, Copy, Debug)]
pub struct Interface<const D: usize> {
    /// Unit normal into the fluid.
    pub normal: Vector<D>,
    /// Area vector: area (length in 2-D) times `normal`. The area vectors of a closed body sum to zero.
    pub area: Vector<D>,
    /// Curvature tensor ∂n/∂x along the surface [1/length]; it has no component across the surface and is positive for
    /// a convex body.
    pub curvature: [Vector<D>; D],
    /// Index of the body that the particle lies on.
    pub body: u16,
    /// Index of the tag, which names a part of a body.
    pub tag: u16,
    /// Number of the smooth piece of surface that the particle lies on; pieces are separated by sharp edges.
    pub piece: u32,
    /// Arc length along the outline in 2-D; zero in 3-D.
    pub arc: f64,
}

impl<const D: usize> Interface<D> {
    /// Rotates the normal, the area vector and the curvature tensor by the matrix with these rows.
    pub fn turn(&mut self, rotation: &[Vector<D>; D]) {
        let turned = |v: &Vector<D>| Vector::from_fn(|i| rotation[i].dot(v));
        self.normal = turned(&self.normal);
        self.area = turned(&self.area);
        // R K Rᵀ
        let half: [Vector<D>; D] = std::array::from_fn(|j| Vector::from_fn(|i| rotation[j].dot(&self.curvature[i])));
        self.curvature = std::array::from_fn(|i| Vector::from_fn(|j| rotation[i].dot(&half[j])));
    }
}

/// A particle on a side of the domain: its boundary condition and the fluid particles inward of it.
#[derive(Clone, Copy, Debug)]
pub struct Outer {
    /// Boundary condition of the side.
    pub side: Side,
    /// Index of the nearest fluid particle inward, from which waves arrive; the particle's own index where there is
    /// none.
    pub source: u32,
    /// Index of the next fluid particle inward behind `source`; equal to `source` where there is none.
    pub behind: u32,
    /// Axis of the outward normal, and true when the normal points towards larger coordinates.
    pub outward: (u8, bool),
}

impl Outer {
    /// Outward unit normal of the side of the domain.
    pub fn normal<const D: usize>(&self) -> Vector<D> {
        let (axis, up) = self.outward;
        Vector::axis(usize::from(axis)) * if up { 1.0 } else { -1.0 }
    }
}

/// A reflection of space followed by a translation: x' = sign·x + offset, component by component.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<const D: usize> {
    /// −1 along the mirrored axes and 1 along the others.
    pub sign: Vector<D>,
    /// Translation after the reflection.
    pub offset: Vector<D>,
}

impl<const D: usize> Transform<D> {
    /// Image of the point `x`.
    pub fn point(&self, x: &Vector<D>) -> Vector<D> {
        Vector::from_fn(|d| self.sign[d] * x[d] + self.offset[d])
    }

    /// Image of the direction `v`, which is reflected but not translated.
    #[inline]
    pub fn direction<S: Scalar>(&self, v: &Vector<D, S>) -> Vector<D, S> {
        Vector::from_fn(|d| v[d] * self.sign[d])
    }

    /// True when this transform is the inverse of `other` up to round-off.
    pub fn undoes(&self, other: &Self) -> bool {
        let back = other.inverse();
        self.sign == back.sign && (self.offset - back.offset).max_abs() <= 1e-9 * back.offset.max_abs()
    }

    /// The inverse transform.
    pub fn inverse(&self) -> Self {
        Self { sign: self.sign, offset: Vector::from_fn(|d| -self.sign[d] * self.offset[d]) }
    }
}

/// A ghost particle: the image of another particle under a transform.
#[derive(Clone, Copy, Debug)]
pub struct Ghost {
    /// Index of the particle of which this is the image.
    pub source: u32,
    /// Index of the transform in [`Cloud::transforms`].
    pub transform: u8,
}

/// Distances to the surface, stored only for the particles near it; the distance of every other particle is infinite.
#[derive(Clone, Debug, Default)]
pub struct WallDistance {
    /// Indices of the particles near the surface, in ascending order.
    near: Vec<u32>,
    distance: Vec<f64>,
}

impl WallDistance {
    /// Stores the finite values of `all`, which holds one distance for each particle.
    pub fn new(all: &[f64]) -> Self {
        let near: Vec<u32> = (0..all.len()).filter(|i| all[*i].is_finite()).map(|i| i as u32).collect();
        let mut distance = vec![0.0; near.len()];
        sweep(&mut distance, |k| all[near[k] as usize]);
        Self { near, distance }
    }
}

impl Index<usize> for WallDistance {
    type Output = f64;

    fn index(&self, i: usize) -> &f64 {
        self.near.binary_search(&(i as u32)).map_or(&f64::INFINITY, |k| &self.distance[k])
    }
}

/// The particles with their neighbour lists, boundary data and wall layers. Lengths are in the unit of the geometry.
#[derive(Clone, Debug)]
pub struct Cloud<const D: usize> {
    /// Positions of all particles, ghosts included.
    pub x: Vec<Vector<D>>,
    /// Local spacing of each particle.
    pub spacing: Vec<f64>,
    /// Volume (area in 2-D) that each particle represents.
    pub volume: Vec<f64>,
    /// Number of fluid particles; they have the indices `0..n_fluid`.
    pub n_fluid: usize,
    /// Data of the interface particles, in the order of their indices.
    pub interface: Vec<Interface<D>>,
    /// Data of the outer particles, in the order of their indices.
    pub outer: Vec<Outer>,
    /// Source and transform of the ghost particles, in the order of their indices.
    pub ghosts: Vec<Ghost>,
    /// Transforms that the ghosts refer to.
    pub transforms: Vec<Transform<D>>,
    /// Distance to the surface, for the fluid particles near it; infinite for all others.
    pub wall_distance: WallDistance,
    /// Neighbour lists of the fluid and interface particles.
    pub neighbours: Neighbours,
    /// For each interface particle, the fluid particles from which its state is fitted.
    pub wall_stencils: Neighbours,
    /// Layers of particles along the walls, with one column for each interface particle.
    pub layers: layers::Layers<D>,
    /// The particles in each leaf of the background tree.
    pub leaves: particles::LeafIndex,
    /// Indices, in ascending order, of the particles whose reconstruction stays first order because they have too few
    /// neighbours.
    pub first_order: Vec<u32>,
    /// The background tree, which defines the local spacing.
    pub tree: std::sync::Arc<tree::Tree<D>>,
    /// Messages about particles that had to be repaired.
    pub notes: Vec<String>,
}

impl<const D: usize> Cloud<D> {
    /// Number of particles, ghosts included.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// True when the cloud has no particle.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Indices of the interface particles.
    pub fn interface_range(&self) -> Range<usize> {
        self.n_fluid..self.n_fluid + self.interface.len()
    }

    /// Indices of the `k`-th outer particle, of its source, and of the fluid particle behind the source.
    pub fn beside(&self, k: usize) -> [usize; 3] {
        [self.n_rows() + k, self.outer[k].source as usize, self.outer[k].behind as usize]
    }

    /// Indices of the outer particles.
    pub fn outer_range(&self) -> Range<usize> {
        let start = self.n_rows();
        start..start + self.outer.len()
    }

    /// Number of particles that have a neighbour list: fluid and interface particles.
    pub fn n_rows(&self) -> usize {
        self.n_fluid + self.interface.len()
    }

    /// The particle with index `j`, or, for a ghost, the particle of which `j` is the image.
    pub fn source(&self, j: usize) -> layers::Source {
        match j.checked_sub(self.n_real()).and_then(|k| self.ghosts.get(k)) {
            Some(image) => layers::Source { index: image.source as usize, image: true },
            None => layers::Source { index: j, image: false },
        }
    }

    /// Offset from particle `i` to particle `j` in the coordinates of the least-squares fit of row `i`: numbers of
    /// steps along and across the wall inside wall layers, x_j − x_i elsewhere.
    pub fn offset(&self, i: usize, j: usize) -> Vector<D> {
        match self.layers.in_steps(i) {
            Some(_) => self.judged_offset(i, j),
            None => self.x[j] - self.x[i],
        }
    }

    /// Offset from particle `i` to particle `j` in the coordinates in which the quality of a neighbour list is judged.
    /// Inside wall layers, and at their ends too, it is stretched across the wall by the aspect ratio of the layers.
    pub fn judged_offset(&self, i: usize, j: usize) -> Vector<D> {
        self.layers.offset(i, self.spacing[i], self.source(j), &(self.x[j] - self.x[i]))
    }

    /// Number of particles without the ghosts.
    pub fn n_real(&self) -> usize {
        self.n_rows() + self.outer.len()
    }
}

/// Reason why a cloud could not be built.
#[derive(Debug, thiserror::Error)]
pub enum CloudError {
    /// The domain does not match the spacing, or a body does not fit into the domain.
    #[error("{0}")]
    Layout(String),
    /// The cloud would have more particles than the memory can hold.
    #[error("the cloud would have {particles} particles, but only {most} fit into memory\nhint: {hint}")]
    TooLarge {
        /// Approximate number of particles, as text.
        particles: String,
        /// Greatest number of particles that is allowed.
        most: usize,
        /// The key of the case that asks for most of the particles, and what to change.
        hint: String,
    },
    /// The quality check found particles that cannot be repaired; one message for each.
    #[error("{} particles have clouds that cannot be repaired; first ones:\n{}\nhint: lower `cloud.spacing` or raise `cloud.radius`", .0.len(), .0.iter().take(5).cloned().collect::<Vec<_>>().join("\n"))]
    Quality(Vec<String>),
    /// The bodies fill the domain, so that no fluid particle is left.
    #[error("no fluid particle is left: the bodies fill the domain\nhint: check `scale` and `cloud.far_field`")]
    Empty,
}
