//! The cloud: where particles are, which ones each of them sees, and the operators that follow from it.
//!
//! Particles come in four kinds, stored one after the other: *fluid* particles in Hilbert order, *interface* particles on
//! the surfaces, *outer* particles on the sides of the domain, and *ghosts*, images of particles across planes of symmetry and
//! periodic sides. Only fluid particles evolve; the state of the others follows from theirs.
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

/// A particle on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Interface<const D: usize> {
    /// Unit normal into the fluid.
    pub normal: Vector<D>,
    /// Area times normal: these sum to zero over a closed body.
    pub area: Vector<D>,
    /// ∂n/∂x along the surface, zero across it: the curvature tensor, positive for a convex body.
    pub curvature: [Vector<D>; D],
    /// Index of the body.
    pub body: u16,
    /// Index of the tag (part of a body).
    pub tag: u16,
    /// Number of the smooth piece of surface it belongs to: pieces meet at sharp edges.
    pub piece: u32,
    /// Distance along the outline in 2-D, zero in 3-D.
    pub arc: f64,
}

impl<const D: usize> Interface<D> {
    /// Turns its vectors by the rotation with these rows.
    pub fn turn(&mut self, rotation: &[Vector<D>; D]) {
        let turned = |v: &Vector<D>| Vector::from_fn(|i| rotation[i].dot(v));
        self.normal = turned(&self.normal);
        self.area = turned(&self.area);
        // R K Rᵀ
        let half: [Vector<D>; D] = std::array::from_fn(|j| Vector::from_fn(|i| rotation[j].dot(&self.curvature[i])));
        self.curvature = std::array::from_fn(|i| Vector::from_fn(|j| rotation[i].dot(&half[j])));
    }
}

/// A particle on a side of the domain.
#[derive(Clone, Copy, Debug)]
pub struct Outer {
    /// Condition of the side.
    pub side: Side,
    /// The nearest fluid particle inward, from which waves come; itself where there is none.
    pub source: u32,
    /// The next one behind it; the same where there is none.
    pub behind: u32,
    /// Axis of the outward normal, and whether it points towards larger coordinates.
    pub outward: (u8, bool),
}

impl Outer {
    /// Outward unit normal of the side.
    pub fn normal<const D: usize>(&self) -> Vector<D> {
        let (axis, up) = self.outward;
        Vector::axis(usize::from(axis)) * if up { 1.0 } else { -1.0 }
    }
}

/// A reflection and a shift of space: x' = sign·x + offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<const D: usize> {
    /// −1 along mirrored axes, else 1.
    pub sign: Vector<D>,
    /// Shift after the reflection.
    pub offset: Vector<D>,
}

impl<const D: usize> Transform<D> {
    /// Image of a point.
    pub fn point(&self, x: &Vector<D>) -> Vector<D> {
        Vector::from_fn(|d| self.sign[d] * x[d] + self.offset[d])
    }

    /// Image of a direction.
    #[inline]
    pub fn direction<S: Scalar>(&self, v: &Vector<D, S>) -> Vector<D, S> {
        Vector::from_fn(|d| v[d] * self.sign[d])
    }

    /// True when this transform undoes another, up to round-off.
    pub fn undoes(&self, other: &Self) -> bool {
        let back = other.inverse();
        self.sign == back.sign && (self.offset - back.offset).max_abs() <= 1e-9 * back.offset.max_abs()
    }

    /// The transform that undoes this one.
    pub fn inverse(&self) -> Self {
        Self { sign: self.sign, offset: Vector::from_fn(|d| -self.sign[d] * self.offset[d]) }
    }
}

/// A ghost: the image of a particle.
#[derive(Clone, Copy, Debug)]
pub struct Ghost {
    /// Particle it is the image of.
    pub source: u32,
    /// Index of the transform.
    pub transform: u8,
}

/// Distances to the surface of the particles near it; those of all others are infinite.
#[derive(Clone, Debug, Default)]
pub struct WallDistance {
    /// Particles, in ascending order.
    near: Vec<u32>,
    distance: Vec<f64>,
}

impl WallDistance {
    /// Keeps the finite ones of `all`.
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

/// Particles and what they see.
#[derive(Clone, Debug)]
pub struct Cloud<const D: usize> {
    /// Positions.
    pub x: Vec<Vector<D>>,
    /// Local spacings.
    pub spacing: Vec<f64>,
    /// Volume (area in 2-D) that a particle stands for.
    pub volume: Vec<f64>,
    /// Number of fluid particles: the first ones.
    pub n_fluid: usize,
    /// Interface particles, in the order of their indices.
    pub interface: Vec<Interface<D>>,
    /// Outer particles, in the order of their indices.
    pub outer: Vec<Outer>,
    /// Ghost particles, images of others, in the order of their indices.
    pub ghosts: Vec<Ghost>,
    /// Transforms that ghosts refer to.
    pub transforms: Vec<Transform<D>>,
    /// Distance to the surface, for fluid particles near it; infinite elsewhere.
    pub wall_distance: WallDistance,
    /// Clouds of fluid and interface particles.
    pub neighbours: Neighbours,
    /// Fluid particles from which the state of each interface particle is fitted.
    pub wall_stencils: Neighbours,
    /// Layers along the walls: a column an interface particle.
    pub layers: layers::Layers<D>,
    /// Which particles sit in which leaf of the background.
    pub leaves: particles::LeafIndex,
    /// Particles, in ascending order, whose reconstruction stays first order: too few neighbours around them.
    pub first_order: Vec<u32>,
    /// The background.
    pub tree: std::sync::Arc<tree::Tree<D>>,
    /// What had to be repaired, in words.
    pub notes: Vec<String>,
}

impl<const D: usize> Cloud<D> {
    /// Number of particles, ghosts included.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// True when there is no particle.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Indices of the interface particles.
    pub fn interface_range(&self) -> Range<usize> {
        self.n_fluid..self.n_fluid + self.interface.len()
    }

    /// Outer particle number `k`, its source and what is behind that.
    pub fn beside(&self, k: usize) -> [usize; 3] {
        [self.n_rows() + k, self.outer[k].source as usize, self.outer[k].behind as usize]
    }

    /// Indices of the outer particles.
    pub fn outer_range(&self) -> Range<usize> {
        let start = self.n_rows();
        start..start + self.outer.len()
    }

    /// Indices of the ghosts.
    pub fn ghost_range(&self) -> Range<usize> {
        self.n_real()..self.len()
    }

    /// Number of particles that have a cloud of their own: fluid and interface.
    pub fn n_rows(&self) -> usize {
        self.n_fluid + self.interface.len()
    }

    /// The particle that `j` is, or is the image of.
    pub fn source(&self, j: usize) -> layers::Source {
        match j.checked_sub(self.n_real()).and_then(|k| self.ghosts.get(k)) {
            Some(image) => layers::Source { index: image.source as usize, image: true },
            None => layers::Source { index: j, image: false },
        }
    }

    /// Offset from particle `i` to `j` in the coordinates in which the row of `i` is fitted: steps along and across the wall
    /// inside layers, x_j − x_i elsewhere.
    pub fn offset(&self, i: usize, j: usize) -> Vector<D> {
        match self.layers.in_steps(i) {
            Some(_) => self.judged_offset(i, j),
            None => self.x[j] - self.x[i],
        }
    }

    /// The same as distances are judged, where layers end as well: stretched across the wall like the layers.
    pub fn judged_offset(&self, i: usize, j: usize) -> Vector<D> {
        self.layers.offset(i, self.spacing[i], self.source(j), &(self.x[j] - self.x[i]))
    }

    /// Number of particles without ghosts.
    pub fn n_real(&self) -> usize {
        self.n_rows() + self.outer.len()
    }
}

/// Why a cloud could not be built.
#[derive(Debug, thiserror::Error)]
pub enum CloudError {
    /// The domain does not suit the spacing.
    #[error("{0}")]
    Layout(String),
    /// More particles than memory holds.
    #[error("the cloud would have {particles} particles, but only {most} fit into memory\nhint: {hint}")]
    TooLarge {
        /// About how many, in words.
        particles: String,
        /// Greatest number.
        most: usize,
        /// What asks for them.
        hint: String,
    },
    /// The doctor found particles that cannot be repaired.
    #[error("{} particles have clouds that cannot be repaired; first ones:\n{}\nhint: lower `cloud.spacing` or raise `cloud.radius`", .0.len(), .0.iter().take(5).cloned().collect::<Vec<_>>().join("\n"))]
    Quality(Vec<String>),
    /// Nothing is left for the fluid.
    #[error("no fluid particle is left: the bodies fill the domain\nhint: check `scale` and `cloud.far_field`")]
    Empty,
}
