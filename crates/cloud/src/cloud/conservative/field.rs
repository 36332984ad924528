//! Multipliers as fields.
//!
//! The multipliers of a particle form an affine field, φ_i(x) = λ_i + M_i (x − x_i). The area vector of a pair changes
//! by the difference of the fields of both ends at the midpoint m, w_ij (φ_i(m) − φ_j(m)). Groups of particles can
//! therefore share a field, and the coupling of two groups is again a sum of products of affine functions, given by
//! their [`Moments`]. The closure alone has constant fields.
use crate::cloud::multipliers::{Factors, Row, add_to};
use crate::math::Vector;
use crate::math::conjugate::{self, Row as _};

/// Factor on the coupling of groups at each level; the number of iterations hardly depends on it between 0.25 and 0.5.
pub(super) const STIFFNESS: f64 = 0.35;

/// Moments Σ w (1, m) ⊗ (1, m) over pairs with weights w and midpoints m relative to an origin, in single precision,
/// because they serve in the preconditioner only.
#[derive(Clone, Copy)]
pub(super) struct Moments<const D: usize> {
    weight: f32,
    first: [f32; D],
    second: [[f32; D]; D],
}

impl<const D: usize> Moments<D> {
    pub(super) const ZERO: Self = Self { weight: 0.0, first: [0.0; D], second: [[0.0; D]; D] };

    /// Moments of one pair.
    #[inline(always)]
    pub(super) fn of(weight: f64, middle: &[f32; D]) -> Self {
        Self { weight: weight as f32, ..Self::ZERO }.seen_from(middle)
    }

    /// Sum of the weights Σ w.
    #[inline(always)]
    pub(super) fn weight(&self) -> f64 {
        f64::from(self.weight)
    }

    /// The sum self + s · other.
    #[inline(always)]
    pub(super) fn plus(&self, s: f64, other: &Self) -> Self {
        let (mut sum, s) = (*self, s as f32);
        sum.weight += s * other.weight;
        for r in 0..D {
            sum.first[r] += s * other.first[r];
            for c in 0..D {
                sum.second[r][c] += s * other.second[r][c];
            }
        }
        sum
    }

    /// The moments about an origin at the offset −`here` from this one.
    #[inline(always)]
    pub(super) fn seen_from(&self, here: &[f32; D]) -> Self {
        let mut all = *self;
        for r in 0..D {
            all.first[r] += here[r] * self.weight;
            for c in 0..D {
                all.second[r][c] += here[r] * self.first[c] + all.first[r] * here[c];
            }
        }
        all
    }
}

/// Multipliers of the particles, or of groups of them.
pub(super) trait Field<const D: usize>: conjugate::Row {
    /// Fraction of the correction of a group that its members take. Fields with steps between groups are stiffer than
    /// smooth ones, by [`STIFFNESS`] for affine fields and by one half for constant ones.
    const STEP: f64;
    /// Relative asymmetry up to which a right-hand side counts as symmetric. It allows for round-off at the end of the
    /// iteration, where only the tolerance is left of the initial right-hand side. Neighbour lists may be asymmetric
    /// where two candidates are equally distant, and the asymmetry that they cause must still be resolved.
    const SYMMETRIC: f64;

    /// The field relative to an origin moved by `d`.
    fn at(&self, d: &[f32; D]) -> Self;

    /// A condition on the field relative to the moved origin, as a condition on this field: the transpose of `at`.
    fn gathered(&self, d: &[f32; D]) -> Self;

    /// The mirrored or translated field: components change their signs.
    fn mirrored(&self, sign: &Vector<D>) -> Self;

    /// Product of the moments with the field.
    fn weighed(&self, moments: &Moments<D>) -> Self;

    /// Product of the diagonal block of a group with its field: all pairs with other groups, softness and mobility of
    /// the volume.
    fn own(&self, pairs: &Moments<D>, soft: [f64; 2]) -> Self;

    /// The field of group `i` whose product with the diagonal block is this one.
    fn solved(&self, pairs: &Moments<D>, factors: &Factors<D>, i: usize) -> Self;
}

impl<const D: usize> Field<D> for Row<D> {
    const STEP: f64 = 1.0;
    const SYMMETRIC: f64 = 1e-2;

    #[inline(always)]
    fn at(&self, d: &[f32; D]) -> Self {
        Self { value: Row::at(self, d), ..*self }
    }

    #[inline(always)]
    fn gathered(&self, d: &[f32; D]) -> Self {
        let mut field = *self;
        for k in 0..D {
            add_to(&mut field.slope[k], d[k], &self.value);
        }
        field
    }

    #[inline(always)]
    fn mirrored(&self, sign: &Vector<D>) -> Self {
        Row::mirrored(self, sign)
    }

    #[inline(always)]
    fn weighed(&self, m: &Moments<D>) -> Self {
        let mut row = Self::ZERO;
        add_to(&mut row.value, m.weight, &self.value);
        for k in 0..D {
            add_to(&mut row.value, m.first[k], &self.slope[k]);
            add_to(&mut row.slope[k], m.first[k], &self.value);
            for l in 0..D {
                add_to(&mut row.slope[k], m.second[k][l], &self.slope[l]);
            }
        }
        row
    }

    #[inline(always)]
    fn own(&self, pairs: &Moments<D>, [softness, freedom]: [f64; 2]) -> Self {
        let mut row = self.weighed(pairs).plus(1.0, &self.slopes(softness));
        row.add_to_trace(freedom * self.trace());
        row
    }

    #[inline(always)]
    fn solved(&self, _: &Moments<D>, factors: &Factors<D>, i: usize) -> Self {
        factors.solve(i, self)
    }
}

impl<const D: usize> Field<D> for Vector<D> {
    const STEP: f64 = STIFFNESS / 0.5;
    const SYMMETRIC: f64 = 1e-5;

    #[inline(always)]
    fn at(&self, _: &[f32; D]) -> Self {
        *self
    }

    #[inline(always)]
    fn gathered(&self, _: &[f32; D]) -> Self {
        *self
    }

    fn mirrored(&self, sign: &Vector<D>) -> Self {
        Vector::from_fn(|r| sign[r] * self[r])
    }

    #[inline(always)]
    fn weighed(&self, moments: &Moments<D>) -> Self {
        *self * moments.weight()
    }

    #[inline(always)]
    fn own(&self, pairs: &Moments<D>, _: [f64; 2]) -> Self {
        self.weighed(pairs)
    }

    #[inline(always)]
    fn solved(&self, pairs: &Moments<D>, _: &Factors<D>, _: usize) -> Self {
        *self * (1.0 / pairs.weight().max(f64::MIN_POSITIVE))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cloud::multipliers::opposite;

    fn field(seed: f32) -> Row<3> {
        let lanes = |k: usize| {
            let at = |r: usize| if r < 3 { (seed * (3 * k + r + 1) as f32).sin() } else { 0.0 };
            std::array::from_fn(at)
        };
        Row { value: lanes(0), slope: std::array::from_fn(|k| lanes(k + 1)) }
    }

    #[test]
    fn moments_do_not_depend_on_their_origin() {
        let (to, middle) = ([0.3, -0.2, 0.5], [0.7, 0.1, -0.4]);
        let [here, there] = [middle, std::array::from_fn(|d| middle[d] - to[d])].map(|m| Moments::of(2.0, &m));
        let miss = here.seen_from(&opposite(&to)).plus(-1.0, &there);
        let largest = miss.first.iter().chain(miss.second.as_flattened()).fold(0.0f32, |m, x| m.max(x.abs()));
        assert!(largest < 1e-6, "{largest}");
        // what a pair makes of a field is the same from either origin
        let energy = field(1.7).dot(&field(1.7).weighed(&here));
        let seen = Field::at(&field(1.7), &to);
        assert!((energy - seen.dot(&seen.weighed(&there))).abs() < 1e-6 * energy.abs());
    }

    #[test]
    fn gathering_is_the_transpose_of_moving() {
        let (field, other, d) = (field(1.7), field(0.9), [0.3, -0.2, 0.5]);
        assert!((Field::at(&field, &d).dot(&other) - field.dot(&other.gathered(&d))).abs() < 1e-6);
    }
}
