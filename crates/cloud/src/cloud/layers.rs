//! Layers of particles along the walls, thin across them.
//!
//! Every interface particle may carry a *column*: fluid particles on its normal at the heights η_k = Δ(1 + g + … + g^(k−1)),
//! the same for all columns, so that particles of equal number k form a *layer* along the wall. In the layers the
//! neighbours are a cross, (i ± 1, k) and (i, k ± 1), and fits are made in the space of these numbers: slopes f_ξ, f_η by
//! least squares over the offsets (±1, 0), (0, ±1), the metric terms x_ξ, x_η with the same weights, and then
//! ∇f = J⁻¹ (f_ξ, f_η) with the rows x_ξ, x_η of J. That is exact for linear fields at any aspect ratio and any curvature of
//! the wall, and |det J| is the volume. In space the columns beside one stand around it (module `wall_stars`): for ±1 there are the
//! ways to their feet along the wall, in mean distances, and layers of such columns are prisms. Where the layers end the neighbours come from the background as well, and fits are made
//! in space as everywhere else: behind a sharp edge a neighbour that is many layers lower would count for the slope across the
//! wall alone, nothing would be left of what comes along it, and gas that flows back around the edge would heap up there.
//!
//! References: Visbal and Gaitonde, J. Comput. Phys. 181 (2002), for metric terms that must be taken with the weights of the
//! scheme; Pirzadeh, AIAA J. 34 (1996), for layers that advance together and stop where fronts meet.
use super::{Cloud, Interface};
use crate::math::Vector;
use crate::math::square::determinant;

const NONE: u32 = u32::MAX;
/// Least part of a piece of surface that is left where normals converge.
const FOLDED: f64 = 0.05;

/// Why a column has no more layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum End {
    /// As many as were asked for, or as far apart as those beside it.
    #[default]
    Planned,
    /// A convex bend spreads the columns too far.
    Fan,
    /// A concave bend brings the columns too near to one another.
    Fold,
    /// Another part of a wall, or its layers.
    Meeting,
    /// The side of the domain.
    Side,
}

/// A column that stands beside another on the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// Its number.
    pub column: u32,
    /// The transform whose image of it that is; itself without.
    pub image: Option<u8>,
    /// The way to it along the wall, in the axes of the other and in mean distances: −1 and 1 along an outline.
    pub step: [f64; 2],
}

/// Directions along the wall and normal of every column, what stands beside it, and whether something is missing on a side.
pub(super) type Around<const D: usize> = (Vec<[Vector<D>; D]>, Vec<(Vec<Beside>, bool)>);

/// The layers over one interface particle; empty where there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Column {
    /// Fluid particles, from the wall outward.
    pub particles: Vec<u32>,
    /// Their distances from the wall, along the normal.
    pub heights: Vec<f64>,
    /// Columns beside it: before and after it along the outline, around it in space.
    pub beside: Vec<Beside>,
    /// Whether one is missing on a side: a sharp edge.
    pub open: bool,
    /// Why there are no more; that of the column beside it where that one cuts it short.
    pub end: End,
}

/// All columns, and where each particle stands in them.
#[derive(Clone, Debug, Default)]
pub struct Layers<const D: usize> {
    /// One column an interface particle, in the same order; none at all when the case asks for no layers.
    pub columns: Vec<Column>,
    axes: Vec<[Vector<D>; D]>,
    slots: Vec<(u32, u32)>,
    /// Particles in layers whose neighbours do not all stand in the same or an adjacent column.
    mixed: Vec<bool>,
}

/// The particle that a neighbour is, or is the image of.
#[derive(Clone, Copy, Debug)]
pub struct Source {
    /// Its index.
    pub index: usize,
    /// True for the image.
    pub image: bool,
}

impl<const D: usize> Layers<D> {
    /// Gathers columns; `axes` are the directions along the wall and the normal of each, `n_fluid` the number of fluid
    /// particles.
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

    /// Column and layer of particle `i`; layer 0 is the interface particle of a column that has layers.
    #[inline]
    pub fn slot(&self, i: usize) -> Option<(usize, usize)> {
        let (column, layer) = *self.slots.get(i)?;
        (column != NONE).then_some((column as usize, layer as usize))
    }

    /// Directions along the wall and normal of a column.
    pub fn axes(&self, column: usize) -> &[Vector<D>; D] {
        &self.axes[column]
    }

    /// Normal of a column.
    pub fn normal(&self, column: usize) -> &Vector<D> {
        &self.axes[column][D - 1]
    }

    /// Distance from the wall of layer `k` of a column.
    pub fn height(&self, column: usize, k: usize) -> f64 {
        if k == 0 { 0.0 } else { self.columns[column].heights[k - 1] }
    }

    /// Distance between layers around layer `k` of a column that has layers.
    pub fn thickness(&self, column: usize, k: usize) -> f64 {
        let top = self.columns[column].heights.len();
        let (low, high) = (k.saturating_sub(1), (k + 1).min(top));
        (self.height(column, high) - self.height(column, low)) / (high - low).max(1) as f64
    }

    /// Number of layers of a column.
    pub fn count(&self, column: usize) -> usize {
        self.columns[column].particles.len()
    }

    /// Steps (along the wall, layers outward) from particle `i` to a neighbour at offset `d`, when that is in the
    /// same or in an adjacent column.
    pub fn steps(&self, i: usize, other: Source, d: &Vector<D>) -> Option<([f64; 2], i32)> {
        let ((c, k), (c2, k2)) = (self.slot(i)?, self.slot(other.index)?);
        let up = k2 as i32 - k as i32;
        if c2 == c && !other.image {
            return Some(([0.0; 2], up));
        }
        let towards = |b: &Beside| (0..D - 1).map(|a| b.step[a] * d.dot(&self.axes[c][a])).sum::<f64>();
        // of several images of one column the one on that side
        let is = |b: &&Beside| b.column as usize == c2 && b.image.is_some() == other.image;
        let there = self.columns[c].beside.iter().filter(is).max_by(|a, b| towards(a).total_cmp(&towards(b)))?;
        Some((there.step, up))
    }

    /// Notes which rows see more than layers; `beyond(i)` tells it of a particle that stands in a layer.
    pub(super) fn note_mixed(&mut self, beyond: impl Fn(&Self, usize) -> bool) {
        let mixed = (0..self.slots.len()).map(|i| self.slot(i).is_some() && beyond(self, i)).collect();
        self.mixed = mixed;
    }

    /// Column and layer of particle `i` if its row is fitted in the space of those numbers.
    #[inline]
    pub fn in_steps(&self, i: usize) -> Option<(usize, usize)> {
        self.slot(i).filter(|_| self.mixed.get(i) != Some(&true))
    }

    /// Offset `d` from particle `i`, with spacing `h`, to a neighbour, as distances are judged in layers: along and across the
    /// wall, both in parts of `h`; `d` itself outside the layers.
    pub fn offset(&self, i: usize, h: f64, other: Source, d: &Vector<D>) -> Vector<D> {
        let Some((c, k)) = self.slot(i) else { return *d };
        let axes = &self.axes[c];
        match self.steps(i, other, d) {
            Some((along, up)) => Vector::from_fn(|a| if a + 1 < D { along[a] * h } else { f64::from(up) * h }),
            None => Vector::from_fn(|a| d.dot(&axes[a]) * if a + 1 < D { 1.0 } else { h / self.thickness(c, k) }),
        }
    }

    /// Volume of particle `i` in a layer: its part of the layer times height. A particle at the wall stands for half of it,
    /// one in the last layer for the gap to the background as well.
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

    /// Mean distance of layer `k` of a column from those beside it, along the wall; `feet` are the interface particles.
    fn length(&self, c: usize, k: usize, feet: &[Vector<D>]) -> f64 {
        let place = |b: usize| feet[b] + *self.normal(b) * self.height(c, k);
        let beside = self.columns[c].beside.iter().filter(|b| b.column as usize != c);
        let steps = beside.map(|b| (place(b.column as usize) - place(c)).dot(&self.axes[c][0]).abs());
        let (sum, sides) = steps.fold((0.0, 0.0), |s, d| (s.0 + d, s.1 + 1.0));
        sum / f64::max(sides, 1.0)
    }

    /// True for the last two layers of a column, and for all layers of one beside a sharp edge.
    pub(super) fn is_rim(&self, c: usize, k: usize) -> bool {
        let column = &self.columns[c];
        let broken = column.open || column.beside.iter().any(|b| self.columns[b.column as usize].particles.is_empty());
        let top = column.particles.len();
        broken || k + 2 > top && k > 0
    }
}

/// Factor by which a piece of surface with this curvature tensor grows when every point of it moves by `height` along its normal.
fn swelling<const D: usize>(curvature: &[Vector<D>; D], height: f64) -> f64 {
    let moved: [Vector<D>; D] = std::array::from_fn(|r| Vector::axis(r) + curvature[r] * height);
    determinant(&moved).max(FOLDED)
}

/// Volume of a cell between two particles: that of the mean spacing; in layers the harmonic mean, which the thinner decides.
pub(super) fn face_volume<const D: usize>(cloud: &Cloud<D>, i: usize, j: usize) -> f64 {
    if cloud.layers.slot(i).or(cloud.layers.slot(j)).is_none() {
        return (0.5 * (cloud.spacing[i] + cloud.spacing[j])).powi(D as i32);
    }
    2.0 / (1.0 / cloud.volume[i] + 1.0 / cloud.volume[j])
}

/// The first layer reaches down to the wall: its volumes grow by the half layer that the interface particles stand for elsewhere.
/// That half layer, where particle `i` is in the first layer.
pub(super) fn below_first<const D: usize>(cloud: &Cloud<D>, i: usize) -> Option<f64> {
    cloud.layers.slot(i).filter(|s| s.1 == 1).map(|s| cloud.volume[cloud.n_fluid + s.0])
}

/// Factor by which the face between two particles grows with their volumes where both are in the first layer.
pub(super) fn grown_face<const D: usize>(cloud: &Cloud<D>, i: usize, j: usize) -> f64 {
    let j = cloud.source(j).index;
    match (below_first(cloud, i), below_first(cloud, j)) {
        (Some(half), Some(other)) => 1.0 + 0.5 * (half / cloud.volume[i] + other / cloud.volume[j]),
        _ => 1.0,
    }
}
