//! Numbers of many edges side by side: kernels loop over them without branches, and the compiler makes vectors of that.
use crate::math::Vector;
use crate::math::dual::Dual;
use crate::math::jet::Scalar;
use crate::math::reduce;
use crate::physics::{Conserved, Primitive};

/// Edges that are computed together: enough to fill vectors, few enough that all of it stays in the first cache.
pub(super) const LANES: usize = 16;

/// A number of every edge.
pub(super) type Lanes = [f64; LANES];

/// What the scheme is evaluated with: plain numbers, or numbers that carry the change with the state along a direction.
pub trait Number: Scalar + Send + Sync + 'static {
    /// One of every edge.
    type Many: Copy;
    /// All zero.
    const NONE: Self::Many;
    /// That of edge `k`.
    fn take(many: &Self::Many, k: usize) -> Self;
    /// Sets that of edge `k`.
    fn put(self, many: &mut Self::Many, k: usize);
    /// What a residual tells of it: the value, or the change.
    fn told(self) -> f64;
    /// Sum of `f(i)` over `0..n`.
    fn sum(n: usize, f: impl Fn(usize) -> Self + Sync) -> Self;
}

impl Number for f64 {
    type Many = Lanes;
    const NONE: Lanes = [0.0; LANES];

    #[inline(always)]
    fn take(many: &Lanes, k: usize) -> Self {
        many[k]
    }

    #[inline(always)]
    fn put(self, many: &mut Lanes, k: usize) {
        many[k] = self;
    }

    #[inline(always)]
    fn told(self) -> f64 {
        self
    }

    fn sum(n: usize, f: impl Fn(usize) -> Self + Sync) -> Self {
        reduce::sum(n, f)
    }
}

impl Number for Dual {
    /// Values and changes.
    type Many = [Lanes; 2];
    const NONE: [Lanes; 2] = [[0.0; LANES]; 2];

    #[inline(always)]
    fn take([value, change]: &[Lanes; 2], k: usize) -> Self {
        Self { value: value[k], derivative: change[k] }
    }

    #[inline(always)]
    fn put(self, [value, change]: &mut [Lanes; 2], k: usize) {
        (value[k], change[k]) = (self.value, self.derivative);
    }

    #[inline(always)]
    fn told(self) -> f64 {
        self.derivative
    }

    fn sum(n: usize, f: impl Fn(usize) -> Self + Sync) -> Self {
        // the value is the same bits as that of plain numbers
        let value = reduce::sum(n, |i| f(i).value);
        Self { value, derivative: reduce::sum(n, |i| f(i).derivative) }
    }
}

/// What a residual tells of the rate of change of a particle.
#[inline(always)]
pub(super) fn told<const D: usize, S: Number>(c: &Conserved<D, S>) -> Conserved<D> {
    Conserved {
        density: c.density.told(),
        momentum: Vector::from_fn(|d| c.momentum[d].told()),
        energy: c.energy.told(),
    }
}

/// The `D` + 2 numbers of a state or a flux of every edge: density, velocity or momentum, pressure or energy.
pub(super) struct StateLanes<const D: usize, S: Number = f64> {
    pub(super) density: S::Many,
    pub(super) vector: [S::Many; D],
    pub(super) energy: S::Many,
}

impl<const D: usize, S: Number> StateLanes<D, S> {
    /// All zero.
    pub(super) const ZERO: Self = Self { density: S::NONE, vector: [S::NONE; D], energy: S::NONE };

    #[inline(always)]
    pub(super) fn primitive(&self, k: usize) -> Primitive<D, S> {
        Primitive {
            density: S::take(&self.density, k),
            velocity: take_all(&self.vector, k),
            pressure: S::take(&self.energy, k),
        }
    }

    #[inline(always)]
    pub(super) fn conserved(&self, k: usize) -> Conserved<D, S> {
        Conserved {
            density: S::take(&self.density, k),
            momentum: take_all(&self.vector, k),
            energy: S::take(&self.energy, k),
        }
    }

    #[inline(always)]
    pub(super) fn put_primitive(&mut self, k: usize, q: &Primitive<D, S>) {
        q.density.put(&mut self.density, k);
        put_all(&mut self.vector, k, &q.velocity);
        q.pressure.put(&mut self.energy, k);
    }

    #[inline(always)]
    pub(super) fn put_conserved(&mut self, k: usize, c: &Conserved<D, S>) {
        c.density.put(&mut self.density, k);
        put_all(&mut self.vector, k, &c.momentum);
        c.energy.put(&mut self.energy, k);
    }
}

#[inline(always)]
pub(super) fn take_all<const D: usize, S: Number>(many: &[S::Many; D], k: usize) -> Vector<D, S> {
    Vector::from_fn(|d| S::take(&many[d], k))
}

#[inline(always)]
pub(super) fn put_all<const D: usize, S: Number>(many: &mut [S::Many; D], k: usize, v: &Vector<D, S>) {
    for d in 0..D {
        v[d].put(&mut many[d], k);
    }
}

/// Plain numbers, which no state changes.
#[inline(always)]
pub(super) fn take<const D: usize, S: Scalar>(lanes: &[Lanes; D], k: usize) -> Vector<D, S> {
    Vector::from_fn(|d| S::constant(lanes[d][k]))
}

#[inline(always)]
pub(super) fn pair<const D: usize, S: Scalar>(lanes: &[[Lanes; D]; 2], k: usize) -> [Vector<D, S>; 2] {
    [take(&lanes[0], k), take(&lanes[1], k)]
}

#[inline(always)]
pub(super) fn put<const D: usize>(lanes: &mut [Lanes; D], k: usize, v: &Vector<D>) {
    for d in 0..D {
        lanes[d][k] = v[d];
    }
}
