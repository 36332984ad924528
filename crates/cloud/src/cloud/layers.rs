//! Wall layers: layers of particles along the walls that are thin across them.
//!
//! Every interface particle may carry a *column*: fluid particles on its normal at the heights η_k = Δ(1 + g + … +
//! g^(k−1)), which are the same for all columns, so that the particles of equal number k form a *layer* along the wall.
//! Inside the layers, the neighbours of particle (i, k) form a cross, (i ± 1, k) and (i, k ± 1), and derivatives are
//! fitted in the space of these numbers: the slopes f_ξ, f_η by least squares over the offsets (±1, 0), (0, ±1), the
//! metric terms x_ξ, x_η with the same weights, and then ∇f = J⁻¹ (f_ξ, f_η), where x_ξ and x_η are the rows of J. This
//! is exact for linear fields at any aspect ratio of the layers and any curvature of the wall, and |det J| is the
//! volume.
//!
//! In 3-D, several columns surround each column (module `wall_stars`). The offsets ±1 are then replaced by the
//! directions to the feet of these columns along the wall, divided by their mean distance, and the layers consist of
//! prisms.
//!
//! Where the layers end, the neighbour lists include background particles, and derivatives are fitted in physical space
//! as everywhere else. Behind a sharp edge, a neighbour that is many layers lower would otherwise contribute to the
//! slope across the wall only. The slope along the wall would be lost, and gas that flows back around the edge would
//! accumulate there.
//!
//! References: Visbal and Gaitonde, J. Comput. Phys. 181 (2002), for metric terms that must be computed with the
//! weights of the scheme; Pirzadeh, AIAA J. 34 (1996), for layers that advance together and end where fronts meet.
use super::{Cloud, Interface};
use crate::math::Vector;
use crate::math::square::determinant;

const NONE: u32 = u32::MAX;
/// Lower bound of the area factor of a piece of surface that is moved along converging normals.
const FOLDED: f64 = 0.05;

/// Reason why a column ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum End {
    /// The column has the requested number of layers, or its layers have become isotropic.
    #[default]
    Planned,
    /// A convex bend spreads the columns too far.
    Fan,
    /// A concave bend brings the columns too near to one another.
    Fold,
    /// Another part of a wall, or its layers, is too near.
    Meeting,
    /// The side of the domain is too near.
    Side,
}

/// A column that is adjacent to another one along the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// Index of the adjacent column.
    pub column: u32,
    /// Transform under which the column is adjacent as an image; `None` when it is the column itself.
    pub image: Option<u8>,
    /// Offset to its foot along the wall, in the axes of the first column and divided by the mean distance: −1 or 1
    /// along an outline.
    pub step: [f64; 2],
}

/// Axes of every column (directions along the wall, then the normal), its adjacent columns, and whether a neighbour is
/// missing on one side.
pub(super) type Around<const D: usize> = (Vec<[Vector<D>; D]>, Vec<(Vec<Beside>, bool)>);

/// The layers over one interface particle; without particles where there are no layers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Indices of the fluid particles, from the wall outward.
    pub particles: Vec<u32>,
    /// Distances of these particles from the wall along the normal.
    pub heights: Vec<f64>,
    /// Adjacent columns: the previous and the next one along an outline, the surrounding ones in 3-D.
    pub beside: Vec<Beside>,
    /// True when there is no adjacent column on one side, which is the case at a sharp edge.
    pub open: bool,
    /// Reason why the column ends; for a column that an adjacent one limits, the reason of the adjacent one.
    pub end: End,
}

/// All columns of wall layers, and the position of each particle in them.
#[derive(Clone, Debug, Default)]
pub struct Layers<const D: usize> {
    /// One column for each interface particle, in the same order; empty when the case requests no layers.
    pub columns: Vec<Column>,
    axes: Vec<[Vector<D>; D]>,
    slots: Vec<(u32, u32)>,
    /// True for particles in layers that have a neighbour outside their own and the adjacent columns.
    mixed: Vec<bool>,
}

/// A particle, given by itself or by one of its images.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// Index of the particle.
    pub index: usize,
    /// True when the neighbour is an image of the particle.
    pub image: bool,
}

impl<const D: usize> Layers<D> {
    /// Combines the columns. `axes` are the directions along the wall and the normal of each column; `n_fluid` is the
    /// number of fluid particles.
    pub(super) fn new(columns: Vec<Column>, axes: Vec<[Vector<D>; D]>, n_fluid: usize) -> Self {
        if columns.iter().all(|c| c.particles.is_empty()) {
            return Self { columns, ..Self::default() };
        }
        let mut slots = vec![(NONE, 0); n_fluid + columns.len()];
        for (w, column) in columns.iter().enumerate().filter(|(_, c)| !c.particles.is_empty()) {
            slots[n_fluid + w] = (w as u32, 0);
            for (i, k) in column.particles.iter().zip(1..) {
                slots[*i as usize] = (w as u32, k);
            }
        }
        Self { columns, axes, slots, mixed: Vec::new() }
    }

    /// True when no particle lies in a layer.
    pub fn is_empty(&self) -> bool {
        self.slots.is_empty()
    }

    /// Column and layer of particle `i`. Layer 0 is the interface particle of a column that has layers; `None` outside
    /// the layers.
    #[inline]
    pub fn slot(&self, i: usize) -> Option<(usize, usize)> {
        let (column, layer) = *self.slots.get(i)?;
        (column != NONE).then_some((column as usize, layer as usize))
    }

    /// Unit vectors along the wall, followed by the normal, of a column.
    pub fn axes(&self, column: usize) -> &[Vector<D>; D] {
        &self.axes[column]
    }

    /// Unit normal of a column, into the fluid.
    pub fn normal(&self, column: usize) -> &Vector<D> {
        &self.axes[column][D - 1]
    }

    /// Distance of layer `k` of a column from the wall.
    pub fn height(&self, column: usize, k: usize) -> f64 {
        if k == 0 { 0.0 } else { self.columns[column].heights[k - 1] }
    }

    /// Distance between adjacent layers at layer `k` of a column that has layers.
    pub fn thickness(&self, column: usize, k: usize) -> f64 {
        let top = self.columns[column].heights.len();
        let (low, high) = (k.saturating_sub(1), (k + 1).min(top));
        (self.height(column, high) - self.height(column, low)) / (high - low).max(1) as f64
    }

    /// Number of layers of a column.
    pub fn count(&self, column: usize) -> usize {
        self.columns[column].particles.len()
    }

    /// Offset from particle `i` to a neighbour at the physical offset `d`, as steps along the wall and number of layers
    /// outward; `None` when the neighbour is not in the same or an adjacent column.
    pub fn steps(&self, i: usize, other: Source, d: &Vector<D>) -> Option<([f64; 2], i32)> {
        let ((c, k), (c2, k2)) = (self.slot(i)?, self.slot(other.index)?);
        let up = k2 as i32 - k as i32;
        if c2 == c && !other.image {
            return Some(([0.0; 2], up));
        }
        let towards = |b: &Beside| (0..D - 1).map(|a| b.step[a] * d.dot(&self.axes[c][a])).sum::<f64>();
        // if a column has several images, the one in the direction of the neighbour
        let is = |b: &&Beside| b.column as usize == c2 && b.image.is_some() == other.image;
        let there = self.columns[c].beside.iter().filter(is).max_by(|a, b| towards(a).total_cmp(&towards(b)))?;
        Some((there.step, up))
    }

    /// Marks the particles in layers for which `beyond(i)` is true: those with neighbours outside their own and the
    /// adjacent columns.
    pub(super) fn note_mixed(&mut self, beyond: impl Fn(&Self, usize) -> bool) {
        let mixed = (0..self.slots.len()).map(|i| self.slot(i).is_some() && beyond(self, i)).collect();
        self.mixed = mixed;
    }

    /// Column and layer of particle `i` if its derivatives are fitted in the space of these numbers.
    #[inline]
    pub fn in_steps(&self, i: usize) -> Option<(usize, usize)> {
        self.slot(i).filter(|_| self.mixed.get(i) != Some(&true))
    }

    /// Offset `d` from particle `i` of spacing `h` to a neighbour in the coordinates in which distances are judged:
    /// along and across the wall, both scaled to `h`, inside the layers; `d` itself outside them.
    pub fn offset(&self, i: usize, h: f64, other: Source, d: &Vector<D>) -> Vector<D> {
        let Some((c, k)) = self.slot(i) else { return *d };
        let axes = &self.axes[c];
        match self.steps(i, other, d) {
            Some((along, up)) => Vector::from_fn(|a| if a + 1 < D { along[a] * h } else { f64::from(up) * h }),
            None => Vector::from_fn(|a| d.dot(&axes[a]) * if a + 1 < D { 1.0 } else { h / self.thickness(c, k) }),
        }
    }

    /// Volume of particle `i` in a layer: area of its part of the layer times the height. An interface particle
    /// represents half a layer; a particle of the last layer also represents the gap to the background. `None` outside
    /// the layers.
    pub(super) fn volume(&self, i: usize, interface: &[Interface<D>], x: &[Vector<D>]) -> Option<f64> {
        let (c, k) = self.slot(i)?;
        let column = &self.columns[c];
        let area = match D {
            2 => self.length(c, k, &x[self.slots.len() - self.columns.len()..]),
            _ => interface[c].area.norm() * swelling(&interface[c].curvature, self.height(c, k)),
        };
        let along = if D == 2 { area } else { area.sqrt() };
        let top = column.heights.len();
        let below = if k == 0 { 0.0 } else { self.height(c, k) - self.height(c, k - 1) };
        let above = if k == top { along.max(below) } else { self.height(c, k + 1) - self.height(c, k) };
        Some(area * 0.5 * (below + above))
    }

    /// Mean distance along the wall between layer `k` of a column and the adjacent columns; `feet` are the interface
    /// particles.
    fn length(&self, c: usize, k: usize, feet: &[Vector<D>]) -> f64 {
        let place = |b: usize| feet[b] + *self.normal(b) * self.height(c, k);
        let beside = self.columns[c].beside.iter().filter(|b| b.column as usize != c);
        let steps = beside.map(|b| (place(b.column as usize) - place(c)).dot(&self.axes[c][0]).abs());
        let (sum, sides) = steps.fold((0.0, 0.0), |s, d| (s.0 + d, s.1 + 1.0));
        sum / f64::max(sides, 1.0)
    }

    /// True for the last two layers of a column, and for all layers of a column at a sharp edge.
    pub(super) fn is_rim(&self, c: usize, k: usize) -> bool {
        let column = &self.columns[c];
        let broken = column.open || column.beside.iter().any(|b| self.columns[b.column as usize].particles.is_empty());
        let top = column.particles.len();
        broken || k + 2 > top && k > 0
    }
}

/// Factor by which the area of a piece of surface with this curvature tensor grows when all its points move by `height`
/// along the normal.
fn swelling<const D: usize>(curvature: &[Vector<D>; D], height: f64) -> f64 {
    let moved: [Vector<D>; D] = std::array::from_fn(|r| Vector::axis(r) + curvature[r] * height);
    determinant(&moved).max(FOLDED)
}

/// Volume that belongs to the face between two particles: the mean spacing to the power D; in layers the harmonic mean
/// of both volumes, which the thinner layer determines.
pub(super) fn face_volume<const D: usize>(cloud: &Cloud<D>, i: usize, j: usize) -> f64 {
    if cloud.layers.slot(i).or(cloud.layers.slot(j)).is_none() {
        return (0.5 * (cloud.spacing[i] + cloud.spacing[j])).powi(D as i32);
    }
    2.0 / (1.0 / cloud.volume[i] + 1.0 / cloud.volume[j])
}

/// Volume between the first layer and the wall, where particle `i` lies in the first layer. The volume of the first
/// layer extends down to the wall; elsewhere this half layer belongs to the interface particle.
pub(super) fn below_first<const D: usize>(cloud: &Cloud<D>, i: usize) -> Option<f64> {
    cloud.layers.slot(i).filter(|s| s.1 == 1).map(|s| cloud.volume[cloud.n_fluid + s.0])
}

/// Factor by which the face between two particles of the first layer grows because their volumes extend down to the
/// wall.
pub(super) fn grown_face<const D: usize>(cloud: &Cloud<D>, i: usize, j: usize) -> f64 {
    let j = cloud.source(j).index;
    match (below_first(cloud, i), below_first(cloud, j)) {
        (Some(half), Some(other)) => 1.0 + 0.5 * (half / cloud.volume[i] + other / cloud.volume[j]),
        _ => 1.0,
    }
}
