//! Clouds with mirror symmetry.
//!
//! A preconditioner whose groups and sweeps depend on the numbering of the particles yields coefficients that violate
//! the symmetry of a symmetric cloud by as much as the iteration tolerance. Its result is therefore averaged with its
//! mirror image. For a symmetric right-hand side, which conjugate gradients preserve, this is the preconditioner (M + R
//! M R)/2.
use std::collections::HashMap;

use super::field::Field;
use crate::cloud::Cloud;
use crate::math::Vector;
use crate::math::parallel::sweep;
use crate::math::reduce::sum;

/// Fraction of the smallest spacing within which two positions coincide.
const SAME: f64 = 1e-6;
/// Relative difference within which two spacings are equal.
const ALIKE: f64 = 1e-9;

/// A plane normal to one axis about which the cloud is symmetric.
pub(super) struct Mirror {
    axis: usize,
    /// Index of the mirror image of each particle.
    partner: Vec<u32>,
}

/// All planes through the centre of the domain about which the fluid particles are symmetric.
pub(super) fn mirrors<const D: usize>(cloud: &Cloud<D>) -> Vec<Mirror> {
    let n = cloud.n_fluid;
    let spacing = cloud.spacing[..n].iter().copied().fold(f64::INFINITY, f64::min);
    let (centre, step) = (cloud.tree.bounds().centre(), SAME * spacing);
    // rounding is an odd function, so that mirror images have mirrored keys
    let key = |x: &Vector<D>| -> [i64; D] { std::array::from_fn(|d| ((x[d] - centre[d]) / step).round() as i64) };
    let places: HashMap<[i64; D], u32> = (0..n).map(|i| (key(&cloud.x[i]), i as u32)).collect();
    let partners = |axis: usize| {
        let one = |i: usize| {
            let mut there = key(&cloud.x[i]);
            there[axis] = -there[axis];
            let j = *places.get(&there)?;
            let [a, b] = [i, j as usize].map(|k| (cloud.spacing[k], cloud.neighbours.of(k).len()));
            ((a.0 - b.0).abs() <= ALIKE * a.0 && a.1 == b.1).then_some(j)
        };
        (0..n).map(one).collect::<Option<Vec<u32>>>()
    };
    (0..D).filter_map(|axis| Some(Mirror { axis, partner: partners(axis)? })).collect()
}

impl Mirror {
    /// Value of the mirrored field at particle `i`.
    fn image<const D: usize, V: Field<D>>(&self, field: &[V], i: usize) -> V {
        let sign = Vector::from_fn(|d| if d == self.axis { -1.0 } else { 1.0 });
        field[self.partner[i] as usize].mirrored(&sign)
    }

    /// True when a field is symmetric.
    pub(super) fn keeps<const D: usize, V: Field<D>>(&self, field: &[V]) -> bool {
        let square = |v: V| v.dot(&v);
        let miss = sum(field.len(), |i| square(field[i].plus(-1.0, &self.image(field, i))));
        miss <= V::SYMMETRIC * V::SYMMETRIC * sum(field.len(), |i| square(field[i]))
    }

    /// Replaces a field by the mean of itself and its mirror image; `other` is work space.
    pub(super) fn average<const D: usize, V: Field<D>>(&self, field: &mut [V], other: &mut [V]) {
        sweep(other, |i| {
            let twice = field[i].plus(1.0, &self.image(field, i));
            twice.plus(-0.5, &twice)
        });
        field.copy_from_slice(other);
    }
}
