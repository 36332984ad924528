//! Small fixed-size vectors and boxes; abbreviations of coordinates are allowed only here.
use std::array::from_fn;
use std::fmt;
use std::ops::{Add, AddAssign, Index, IndexMut, Mul, Neg, Sub, SubAssign};

use super::digits::short;
use super::jet::Scalar;

/// A point or a direction in `D` dimensions, of real numbers or of numbers with derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Vector<const D: usize, S = f64>(pub [S; D]);

impl<const D: usize> Vector<D> {
    /// The zero vector.
    pub const ZERO: Self = Self([0.0; D]);

    /// The unit vector along axis `axis`.
    #[inline(always)]
    pub fn axis(axis: usize) -> Self {
        Self::from_fn(|d| if d == axis { 1.0 } else { 0.0 })
    }

    /// The unit vector in this direction; the zero vector stays zero.
    #[inline]
    pub fn unit(&self) -> Self {
        let n = self.norm();
        if n > 0.0 { *self * (1.0 / n) } else { *self }
    }

    /// Component-wise minimum of two vectors.
    #[inline]
    pub fn min(&self, other: &Self) -> Self {
        Self::from_fn(|d| self.0[d].min(other.0[d]))
    }

    /// Component-wise maximum of two vectors.
    #[inline]
    pub fn max(&self, other: &Self) -> Self {
        Self::from_fn(|d| self.0[d].max(other.0[d]))
    }

    /// Largest absolute component.
    #[inline]
    pub fn max_abs(&self) -> f64 {
        self.0.iter().fold(0.0, |m, c| m.max(c.abs()))
    }

    /// True if no component is infinite or NaN.
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|c| c.is_finite())
    }

    /// The point in three dimensions; missing coordinates are zero.
    pub fn to_3d(&self) -> [f64; 3] {
        from_fn(|d| if d < D { self.0[d] } else { 0.0 })
    }
}

impl<const D: usize> fmt::Display for Vector<D> {
    /// Writes the coordinates for messages, such as `(0.512, 0.031)`, with six digits.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "({})", self.0.map(short).join(", "))
    }
}

impl<const D: usize, S: Scalar> Vector<D, S> {
    /// The vector whose component `d` is `f(d)`.
    #[inline(always)]
    pub fn from_fn(mut f: impl FnMut(usize) -> S) -> Self {
        // a plain loop: the compiler does not always inline array::from_fn in large kernels
        let mut v = [S::constant(0.0); D];
        let mut d = 0;
        while d < D {
            v[d] = f(d);
            d += 1;
        }
        Self(v)
    }

    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(S::constant(0.0))
    }

    /// The vector with every component equal to `value`.
    #[inline(always)]
    pub fn splat(value: S) -> Self {
        Self([value; D])
    }

    /// Inner product with another vector.
    #[inline(always)]
    pub fn dot(&self, other: &Self) -> S {
        let mut sum = self.0[0] * other.0[0];
        for d in 1..D {
            sum = sum + self.0[d] * other.0[d];
        }
        sum
    }

    /// Inner product with a vector of real numbers.
    #[inline(always)]
    pub fn along(&self, other: &Vector<D>) -> S {
        let mut sum = self.0[0] * other.0[0];
        for d in 1..D {
            sum = sum + self.0[d] * other.0[d];
        }
        sum
    }

    /// A vector of constants, with zero derivatives.
    #[inline(always)]
    pub fn constant(v: &Vector<D>) -> Self {
        Self::from_fn(|d| S::constant(v.0[d]))
    }

    /// The values without derivatives.
    #[inline(always)]
    pub fn value(&self) -> Vector<D> {
        Vector::from_fn(|d| self.0[d].value())
    }

    /// Euclidean length of the vector.
    #[inline(always)]
    pub fn norm(&self) -> S {
        self.norm_squared().sqrt()
    }

    /// Square of the Euclidean length.
    #[inline(always)]
    pub fn norm_squared(&self) -> S {
        self.dot(self)
    }

    /// The product with a real number.
    #[inline(always)]
    pub fn times(&self, factor: f64) -> Self {
        Self::from_fn(|d| self.0[d] * factor)
    }
}

impl<const D: usize, S> Index<usize> for Vector<D, S> {
    type Output = S;
    #[inline(always)]
    fn index(&self, d: usize) -> &S {
        &self.0[d]
    }
}
impl<const D: usize, S> IndexMut<usize> for Vector<D, S> {
    #[inline(always)]
    fn index_mut(&mut self, d: usize) -> &mut S {
        &mut self.0[d]
    }
}
impl<const D: usize, S: Scalar> Add for Vector<D, S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::from_fn(|d| self.0[d] + o.0[d])
    }
}
impl<const D: usize, S: Scalar> Sub for Vector<D, S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::from_fn(|d| self.0[d] - o.0[d])
    }
}
impl<const D: usize, S: Scalar> Mul<S> for Vector<D, S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: S) -> Self {
        Self::from_fn(|d| self.0[d] * s)
    }
}
impl<const D: usize, S: Scalar> Neg for Vector<D, S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.times(-1.0)
    }
}
impl<const D: usize, S: Scalar> AddAssign for Vector<D, S> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        for d in 0..D {
            self.0[d] = self.0[d] + o.0[d];
        }
    }
}
impl<const D: usize, S: Scalar> SubAssign for Vector<D, S> {
    #[inline(always)]
    fn sub_assign(&mut self, o: Self) {
        for d in 0..D {
            self.0[d] = self.0[d] - o.0[d];
        }
    }
}

/// An axis-aligned box, corners included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds<const D: usize> {
    /// Corner with the smallest coordinates.
    pub min: Vector<D>,
    /// Corner with the largest coordinates.
    pub max: Vector<D>,
}

impl<const D: usize> Bounds<D> {
    /// The empty box: growing it by a point gives that point.
    pub const EMPTY: Self = Self { min: Vector([f64::INFINITY; D]), max: Vector([f64::NEG_INFINITY; D]) };

    /// The smallest box around `points`.
    pub fn around<'a>(points: impl IntoIterator<Item = &'a Vector<D>>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| b.grown(p))
    }

    /// This box grown to contain `x`.
    pub fn grown(&self, x: &Vector<D>) -> Self {
        Self { min: self.min.min(x), max: self.max.max(x) }
    }

    /// The smallest box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(&other.min), max: self.max.max(&other.max) }
    }

    /// This box moved outward by `margin` on every side.
    pub fn padded(&self, margin: f64) -> Self {
        Self { min: self.min - Vector::splat(margin), max: self.max + Vector::splat(margin) }
    }

    /// True if `x` lies inside or on the boundary.
    pub fn contains(&self, x: &Vector<D>) -> bool {
        (0..D).all(|d| self.min[d] <= x[d] && x[d] <= self.max[d])
    }

    /// True if the boxes intersect, or are no more than `margin` apart along any axis.
    pub fn meets(&self, other: &Self, margin: f64) -> bool {
        (0..D).all(|d| self.min[d] - margin <= other.max[d] && other.min[d] - margin <= self.max[d])
    }

    /// Square of the distance from `x` to the box, zero inside.
    #[inline]
    pub fn distance_squared(&self, x: &Vector<D>) -> f64 {
        let mut sum = 0.0;
        for d in 0..D {
            let gap = (self.min[d] - x[d]).max(x[d] - self.max[d]).max(0.0);
            sum += gap * gap;
        }
        sum
    }

    /// Middle of the box.
    pub fn centre(&self) -> Vector<D> {
        (self.min + self.max) * 0.5
    }

    /// Edge lengths of the box.
    pub fn extent(&self) -> Vector<D> {
        self.max - self.min
    }
}
