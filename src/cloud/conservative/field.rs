//! Multipliers as fields.
//!
//! The multipliers of a particle are those of an affine field, φ_i(x) = λ_i + M_i (x − x_i), and a pair moves its area vector by
//! what the fields of its ends differ by at the middle m between them, w_ij (φ_i(m) − φ_j(m)). So groups of particles may share a
//! field, and what couples two groups is again a sum of products of affine functions, their [`Moments`]. The closure alone has
//! constant fields.
use crate::cloud::multipliers::{Factors, Row};
use crate::math::Vector;
use crate::math::conjugate;

/// Factor on what couples groups, level by level; the number of iterations hardly depends on it between 0.25 and 0.5.
pub(super) const STIFFNESS: f64 = 0.35;

/// Σ w (1, m) ⊗ (1, m) over pairs with weights w and middles m from some origin.
#[derive(Clone, Copy)]
pub(super) struct Moments<const D: usize> {
    pub(super) weight: f64,
    pub(super) first: Vector<D>,
    pub(super) second: [Vector<D>; D],
}

impl<const D: usize> Moments<D> {
    pub(super) const ZERO: Self = Self { weight: 0.0, first: Vector::ZERO, second: [Vector::ZERO; D] };

    /// Of one pair.
    pub(super) fn of(weight: f64, middle: Vector<D>) -> Self {
        let first = middle * weight;
        Self { weight, first, second: std::array::from_fn(|r| middle * first[r]) }
    }

    /// self + s · other.
    pub(super) fn plus(&self, s: f64, other: &Self) -> Self {
        Self {
            weight: self.weight + s * other.weight,
            first: self.first + other.first * s,
            second: std::array::from_fn(|r| self.second[r] + other.second[r] * s),
        }
    }

    /// The same from another origin, `to` away from this one.
    pub(super) fn about_origin(&self, to: &Vector<D>) -> Self {
        let first = self.first - *to * self.weight;
        let second = std::array::from_fn(|r| self.second[r] - *to * self.first[r] - first * to[r]);
        Self { weight: self.weight, first, second }
    }
}

/// Multipliers of the particles, or of groups of them.
pub(super) trait Field<const D: usize>: conjugate::Row {
    /// Part of what a group finds that its members take. Fields with steps between groups are stiffer than smooth ones, by
    /// [`STIFFNESS`] for affine fields; constant ones by half.
    const STEP: f64;

    /// The field from a point `d` farther on.
    fn at(&self, d: &Vector<D>) -> Self;

    /// A condition on the field from there, as one on this field: the transpose of `at`.
    fn gathered(&self, d: &Vector<D>) -> Self;

    /// The field in a mirror, or shifted: components change their signs.
    fn mirrored(&self, sign: &Vector<D>) -> Self;

    /// What pairs with these moments make of the field.
    fn weighed(&self, moments: &Moments<D>) -> Self;

    /// What a group makes of its own field: all its pairs with others, its softness and the freedom of its volume.
    fn own(&self, pairs: &Moments<D>, soft: [f64; 2]) -> Self;

    /// The field of group `i` of which it makes this.
    fn solved(&self, pairs: &Moments<D>, factors: &Factors<D>, i: usize) -> Self;
}

impl<const D: usize> Field<D> for Row<D> {
    const STEP: f64 = 1.0;

    #[inline(always)]
    fn at(&self, d: &Vector<D>) -> Self {
        Self { closure: Vector::from_fn(|r| self.closure[r] + self.moment[r].dot(d)), moment: self.moment }
    }

    #[inline(always)]
    fn gathered(&self, d: &Vector<D>) -> Self {
        Self { closure: self.closure, moment: std::array::from_fn(|r| self.moment[r] + *d * self.closure[r]) }
    }

    fn mirrored(&self, sign: &Vector<D>) -> Self {
        Self {
            closure: Vector::from_fn(|r| sign[r] * self.closure[r]),
            moment: std::array::from_fn(|r| Vector::from_fn(|c| sign[r] * sign[c] * self.moment[r][c])),
        }
    }

    #[inline(always)]
    fn weighed(&self, m: &Moments<D>) -> Self {
        Self {
            closure: Vector::from_fn(|r| m.weight * self.closure[r] + m.first.dot(&self.moment[r])),
            moment: std::array::from_fn(|r| {
                Vector::from_fn(|c| m.first[c] * self.closure[r] + m.second[c].dot(&self.moment[r]))
            }),
        }
    }

    #[inline(always)]
    fn own(&self, pairs: &Moments<D>, [softness, freedom]: [f64; 2]) -> Self {
        let mut row = self.weighed(pairs);
        let volume = freedom * self.trace();
        for r in 0..D {
            row.moment[r] += self.moment[r] * softness;
            row.moment[r][r] += volume;
        }
        row
    }

    #[inline(always)]
    fn solved(&self, _: &Moments<D>, factors: &Factors<D>, i: usize) -> Self {
        factors.solve(i, self)
    }
}

impl<const D: usize> Field<D> for Vector<D> {
    const STEP: f64 = STIFFNESS / 0.5;

    #[inline(always)]
    fn at(&self, _: &Vector<D>) -> Self {
        *self
    }

    #[inline(always)]
    fn gathered(&self, _: &Vector<D>) -> Self {
        *self
    }

    fn mirrored(&self, sign: &Vector<D>) -> Self {
        Vector::from_fn(|r| sign[r] * self[r])
    }

    #[inline(always)]
    fn weighed(&self, m: &Moments<D>) -> Self {
        *self * m.weight
    }

    #[inline(always)]
    fn own(&self, pairs: &Moments<D>, _: [f64; 2]) -> Self {
        self.weighed(pairs)
    }

    #[inline(always)]
    fn solved(&self, pairs: &Moments<D>, _: &Factors<D>, _: usize) -> Self {
        *self * (1.0 / pairs.weight.max(f64::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::conjugate::Row as _;

    fn field() -> Row<3> {
        Row::load(&std::array::from_fn(|k| (k as f64 * 1.7).sin()))
    }

    #[test]
    fn moments_do_not_depend_on_their_origin() {
        let (to, middle) = (Vector([0.3, -0.2, 0.5]), Vector([0.7, 0.1, -0.4]));
        let (here, there) = (Moments::of(2.0, middle), Moments::of(2.0, middle - to));
        let moved = here.about_origin(&to);
        assert!((moved.first - there.first).norm() < 1e-15);
        assert!((0..3).all(|r| (moved.second[r] - there.second[r]).norm() < 1e-15));
        // what a pair makes of a field is the same from either origin
        let energy = field().dot(&field().weighed(&here));
        let seen = field().at(&to);
        assert!((energy - seen.dot(&seen.weighed(&there))).abs() < 1e-14);
    }

    #[test]
    fn gathering_is_the_transpose_of_moving() {
        let d = Vector([0.3, -0.2, 0.5]);
        let other = Row::load(&std::array::from_fn(|k| (k as f64 * 0.9 + 0.3).cos()));
        assert!((field().at(&d).dot(&other) - field().dot(&other.gathered(&d))).abs() < 1e-14);
    }
}
