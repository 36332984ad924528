//! Clouds that are their own mirror image.
//!
//! A preconditioner whose groups and sweeps go by the numbers of the particles finds coefficients that are not symmetric where the
//! cloud is, by as much as the iteration leaves. Its result is therefore averaged with its mirror image: for a symmetric right-hand
//! side, which conjugate gradients keep, that is the preconditioner (M + R M R)/2.
use std::collections::HashMap;

use crate::cloud::Cloud;
use crate::math::Vector;
use crate::math::sweep::{sum, sweep};

/// Part of the smallest spacing within which two places are the same.
const SAME: f64 = 1e-6;
/// Part of a right-hand side that its mirror image may miss where it counts as symmetric: lists of neighbours need not be, where two
/// are as far away, and what they leave must still be found.
const SYMMETRIC: f64 = 1e-5;
/// Relative difference of spacings that are the same.
const ALIKE: f64 = 1e-9;

/// A plane across one axis that turns the cloud into itself.
pub(super) struct Mirror {
    axis: usize,
    /// The particle that each one is turned into.
    partner: Vec<u32>,
}

/// All planes through the middle of the domain that turn the fluid particles of a cloud into themselves.
pub(super) fn mirrors<const D: usize>(cloud: &Cloud<D>) -> Vec<Mirror> {
    let n = cloud.n_fluid;
    let spacing = cloud.spacing[..n].iter().copied().fold(f64::INFINITY, f64::min);
    let (centre, step) = (cloud.tree.bounds().centre(), SAME * spacing);
    // rounding is odd, so that mirror images have mirrored keys
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
    /// The mirror image of a field of vectors at particle `i`.
    fn image<const D: usize>(&self, field: &[Vector<D>], i: usize) -> Vector<D> {
        let mut image = field[self.partner[i] as usize];
        image[self.axis] = -image[self.axis];
        image
    }

    /// True where a field of vectors is its own mirror image.
    pub(super) fn keeps<const D: usize>(&self, field: &[Vector<D>]) -> bool {
        let miss = sum(field.len(), |i| (field[i] - self.image(field, i)).norm_squared());
        miss <= SYMMETRIC * SYMMETRIC * sum(field.len(), |i| field[i].norm_squared())
    }

    /// The mean of a field of vectors and its mirror image.
    pub(super) fn average<const D: usize>(&self, field: &mut [Vector<D>], other: &mut Vec<Vector<D>>) {
        other.resize(field.len(), Vector::ZERO);
        sweep(other, |i| (field[i] + self.image(field, i)) * 0.5);
        field.copy_from_slice(other);
    }
}
