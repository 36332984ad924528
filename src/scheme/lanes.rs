//! Numbers of many edges side by side: kernels loop over them without branches, and the compiler makes vectors of that.
use crate::math::Vector;
use crate::physics::{Conserved, Primitive};

/// Edges that are computed together: enough to fill vectors, few enough that all of it stays in the first cache.
pub(super) const LANES: usize = 16;

/// A number of every edge.
pub(super) type Lanes = [f64; LANES];

/// The `D` + 2 numbers of a state or a flux of every edge: density, velocity or momentum, pressure or energy.
pub(super) struct StateLanes<const D: usize> {
    pub(super) density: Lanes,
    pub(super) vector: [Lanes; D],
    pub(super) energy: Lanes,
}

impl<const D: usize> StateLanes<D> {
    /// All zero.
    pub(super) const ZERO: Self = Self { density: [0.0; LANES], vector: [[0.0; LANES]; D], energy: [0.0; LANES] };

    #[inline(always)]
    pub(super) fn primitive(&self, k: usize) -> Primitive<D> {
        Primitive { density: self.density[k], velocity: take(&self.vector, k), pressure: self.energy[k] }
    }

    #[inline(always)]
    pub(super) fn conserved(&self, k: usize) -> Conserved<D> {
        Conserved { density: self.density[k], momentum: take(&self.vector, k), energy: self.energy[k] }
    }

    #[inline(always)]
    pub(super) fn put_primitive(&mut self, k: usize, q: &Primitive<D>) {
        self.density[k] = q.density;
        put(&mut self.vector, k, &q.velocity);
        self.energy[k] = q.pressure;
    }

    #[inline(always)]
    pub(super) fn put_conserved(&mut self, k: usize, c: &Conserved<D>) {
        self.density[k] = c.density;
        put(&mut self.vector, k, &c.momentum);
        self.energy[k] = c.energy;
    }
}

#[inline(always)]
pub(super) fn take<const D: usize>(lanes: &[Lanes; D], k: usize) -> Vector<D> {
    Vector::from_fn(|d| lanes[d][k])
}

#[inline(always)]
pub(super) fn pair<const D: usize>(lanes: &[[Lanes; D]; 2], k: usize) -> [Vector<D>; 2] {
    [take(&lanes[0], k), take(&lanes[1], k)]
}

#[inline(always)]
pub(super) fn put<const D: usize>(lanes: &mut [Lanes; D], k: usize, v: &Vector<D>) {
    for d in 0..D {
        lanes[d][k] = v[d];
    }
}
