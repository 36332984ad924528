//! Sums over the pairs of particles of a solid: the loops that take most of the time of a computation.
use multiversion::multiversion;

use super::body::Solid;
use super::rows::{Columns, Row, ZERO, add, less, row, times};
use crate::math::Vector;

/// Stresses and stabilisation coefficients of a particle, from which its forces are summed.
#[derive(Clone, Copy, Debug)]
pub struct ParticleStress<const D: usize> {
    /// First Piola-Kirchhoff stress, by columns.
    pub(super) stress: Columns<D>,
    /// Σ c A of the uncorrected fits A of displacement and velocity, by columns.
    pub(super) smooth: Columns<D>,
    /// Stabilising stiffness c of the displacement residuals.
    pub(super) stiff: f64,
    /// Coefficient c of the velocity residuals.
    pub(super) viscous: f64,
    /// Volume ratio J.
    pub(super) volume: f64,
}

impl<const D: usize> ParticleStress<D> {
    /// A stress-free, undeformed particle.
    pub(super) const ZERO: Self = Self { stress: [ZERO; D], smooth: [ZERO; D], stiff: 0.0, viscous: 0.0, volume: 1.0 };
}

/// Two gradients of a field at particle `i`: the variationally consistent one and the uncorrected fit. Column b is the
/// derivative along axis b.
#[inline(always)]
pub(super) fn gradients<const D: usize>(
    solid: &Solid<D>,
    i: usize,
    field: impl Fn(usize) -> Row,
) -> (Columns<D>, Columns<D>) {
    let (x, own) = (&solid.places, field(i));
    let (mut full, mut moments) = ([ZERO; D], [ZERO; D]);
    for e in solid.particles.of(i) {
        let j = e.other as usize;
        let (d, change) = (less(&x[j], &x[i]), less(&field(j), &own));
        let weighted = times(&change, e.weight);
        for b in 0..D {
            add(&mut full[b], &change, e.own[b]);
            add(&mut moments[b], &weighted, d[b]);
        }
    }
    let (volume, plain) = (solid.particles.volume[i], solved(solid, i, &moments));
    (full.map(|column| times(&column, 1.0 / volume)), plain)
}

/// Gradient by the uncorrected fit alone.
#[inline(always)]
pub(super) fn plain_gradient<const D: usize>(solid: &Solid<D>, i: usize, field: impl Fn(usize) -> Row) -> Columns<D> {
    let (x, own) = (&solid.places, field(i));
    let mut moments = [ZERO; D];
    for e in solid.particles.of(i) {
        let j = e.other as usize;
        let (d, change) = (less(&x[j], &x[i]), times(&less(&field(j), &own), e.weight));
        (0..D).for_each(|b| add(&mut moments[b], &change, d[b]));
    }
    solved(solid, i, &moments)
}

/// Moments of an uncorrected fit multiplied by its inverse normal matrix.
#[inline(always)]
fn solved<const D: usize>(solid: &Solid<D>, i: usize, moments: &Columns<D>) -> Columns<D> {
    let inverse = solid.particles.inverse(i);
    std::array::from_fn(|b| {
        let mut column = ZERO;
        (0..D).for_each(|c| add(&mut column, &moments[c], inverse[c][b]));
        column
    })
}

/// Fields whose residuals act as stabilising forces: the displacement, and the velocity where it is damped.
#[derive(Clone, Copy)]
pub(super) struct StabilisedFields<'a, const D: usize> {
    pub displacement: &'a [[f64; D]],
    pub velocity: Option<&'a [[f64; D]]>,
}

/// Forces of the neighbours on the particles from `first` on.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
pub(super) fn internal<const D: usize>(
    solid: &Solid<D>,
    first: usize,
    pulling: StabilisedFields<'_, D>,
    stressed: &[ParticleStress<D>],
    force: &mut [[f64; D]],
) {
    for (k, force) in force.iter_mut().enumerate() {
        let sum = on(solid, first + k, pulling, stressed);
        (0..D).for_each(|a| force[a] = sum[a]);
    }
}

/// Force of the neighbours on one particle. The contribution of its own stress to all pairs is summed first.
#[inline(always)]
fn on<const D: usize>(
    solid: &Solid<D>,
    i: usize,
    pulling: StabilisedFields<'_, D>,
    stressed: &[ParticleStress<D>],
) -> Row {
    let (x, own, u) = (&solid.places, &stressed[i], pulling.displacement);
    let (mut force, mut weights, mut offsets) = (ZERO, Vector::<D>::ZERO, ZERO);
    let here = row(&u[i]);
    for e in solid.particles.of(i) {
        let j = e.other as usize;
        let (d, other) = (times(&less(&x[j], &x[i]), e.weight), &stressed[j]);
        add(&mut force, &less(&row(&u[j]), &here), e.weight * (own.stiff + other.stiff));
        if let Some(v) = pulling.velocity {
            let viscous = e.weight * (own.viscous + other.viscous);
            add(&mut force, &less(&row(&v[j]), &row(&v[i])), viscous);
        }
        weights += e.own;
        add(&mut offsets, &d, 1.0);
        for b in 0..D {
            add(&mut force, &other.stress[b], -e.counter[b]);
            add(&mut force, &other.smooth[b], -d[b]);
        }
    }
    for b in 0..D {
        add(&mut force, &own.stress[b], weights[b]);
        add(&mut force, &own.smooth[b], -offsets[b]);
    }
    force
}
