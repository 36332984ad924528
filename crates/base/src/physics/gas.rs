//! The ideal gas and the compressible Euler equations.
//!
//! ∂ρ/∂t + ∇·(ρv) = 0, ∂(ρv)/∂t + ∇·(ρvv + pI) = 0, ∂(ρE)/∂t + ∇·((ρE + p)v) = 0 with p = (γ−1)ρe, E = e + v²/2:
//! equations (1)-(3) and (6) in conservative form, which gives shocks the correct speed.
use crate::math::Vector;
use crate::math::jet::Scalar;

/// Conserved state: density, momentum and total energy per volume; Q of eq. (17).
#[doc(alias = "eq17")]
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Conserved<const D: usize, S = f64> {
    /// Density ρ (mass per volume).
    pub density: S,
    /// Momentum per volume ρv.
    pub momentum: Vector<D, S>,
    /// Total energy per volume ρE.
    pub energy: S,
}

/// Primitive state: density, velocity and pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Primitive<const D: usize, S = f64> {
    /// Density ρ (mass per volume).
    pub density: S,
    /// Velocity v of the gas.
    pub velocity: Vector<D, S>,
    /// Static pressure p of the gas.
    pub pressure: S,
}

/// An ideal gas with constant specific heats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gas {
    /// Ratio of specific heats.
    pub gamma: f64,
}

impl<const D: usize> Conserved<D> {
    /// The zero state.
    pub const ZERO: Self = Self { density: 0.0, momentum: Vector::ZERO, energy: 0.0 };

    /// Reads the state of one particle from a slice of `D` + 2 numbers.
    #[inline(always)]
    pub fn load(row: &[f64]) -> Self {
        Self { density: row[0], momentum: Vector::from_fn(|d| row[1 + d]), energy: row[D + 1] }
    }

    /// Reads the state of particle `i` from the state vector of all particles.
    #[inline(always)]
    pub fn of_row(rows: &[f64], i: usize) -> Self {
        Self::load(&rows[i * super::n_variables(D)..])
    }

    /// Writes the state to a slice of `D` + 2 numbers.
    #[inline(always)]
    pub fn store(&self, row: &mut [f64]) {
        row[0] = self.density;
        (0..D).for_each(|d| row[1 + d] = self.momentum[d]);
        row[D + 1] = self.energy;
    }

    /// Adds the state to a slice of `D` + 2 numbers.
    #[inline(always)]
    pub fn add_to(&self, row: &mut [f64]) {
        row[0] += self.density;
        for d in 0..D {
            row[1 + d] += self.momentum[d];
        }
        row[D + 1] += self.energy;
    }
}

impl<const D: usize, S: Scalar> Conserved<D, S> {
    /// The zero state.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = S::constant(0.0);
        Self { density: zero, momentum: Vector::zero(), energy: zero }
    }

    /// Converts a state to the scalar type `S`, with zero derivatives.
    #[inline(always)]
    pub fn constant(c: &Conserved<D>) -> Self {
        Self { density: S::constant(c.density), momentum: Vector::constant(&c.momentum), energy: S::constant(c.energy) }
    }

    /// The sum self + s·other.
    #[inline(always)]
    pub fn plus(&self, s: S, o: &Self) -> Self {
        Self {
            density: self.density + s * o.density,
            momentum: self.momentum + o.momentum * s,
            energy: self.energy + s * o.energy,
        }
    }

    /// The difference self − other.
    #[inline(always)]
    pub fn minus(&self, o: &Self) -> Self {
        self.plus(S::constant(-1.0), o)
    }

    /// The product s·self.
    #[inline(always)]
    pub fn times(&self, s: S) -> Self {
        Self { density: self.density * s, momentum: self.momentum * s, energy: self.energy * s }
    }
}

impl<const D: usize, S: Scalar> Primitive<D, S> {
    /// Applies f to each component of two states.
    #[inline(always)]
    pub fn zip(a: &Self, b: &Self, f: impl Fn(S, S) -> S) -> Self {
        Self {
            density: f(a.density, b.density),
            velocity: Vector::from_fn(|d| f(a.velocity[d], b.velocity[d])),
            pressure: f(a.pressure, b.pressure),
        }
    }

    /// The product s·self.
    #[inline(always)]
    pub fn times(&self, s: S) -> Self {
        Self { density: self.density * s, velocity: self.velocity * s, pressure: self.pressure * s }
    }

    /// The difference self − other.
    #[inline(always)]
    pub fn minus(&self, o: &Self) -> Self {
        Self {
            density: self.density - o.density,
            velocity: self.velocity - o.velocity,
            pressure: self.pressure - o.pressure,
        }
    }

    /// The sum self + s·other.
    #[inline(always)]
    pub fn plus(&self, s: S, o: &Self) -> Self {
        Self {
            density: self.density + s * o.density,
            velocity: self.velocity + o.velocity * s,
            pressure: self.pressure + s * o.pressure,
        }
    }

    /// Converts a state to the scalar type `S`, with zero derivatives.
    #[inline(always)]
    pub fn constant(q: &Primitive<D>) -> Self {
        Self {
            density: S::constant(q.density),
            velocity: Vector::constant(&q.velocity),
            pressure: S::constant(q.pressure),
        }
    }

    /// The state in a frame that moves with the velocity `w`.
    #[inline(always)]
    pub fn seen_from(&self, w: &Vector<D, S>) -> Self {
        Self { velocity: self.velocity - *w, ..*self }
    }
}

impl<const D: usize, S: Scalar> Primitive<D, S> {
    /// True when density and pressure are positive and all numbers are finite.
    pub fn is_physical(&self) -> bool {
        let (density, pressure) = (self.density.value(), self.pressure.value());
        density > 0.0 && pressure > 0.0 && self.velocity.value().is_finite() && (density + pressure).is_finite()
    }
}

impl Gas {
    /// Primitive state of a conserved state; p = (γ−1)ρe, eq. (6).
    #[doc(alias = "eq6")]
    #[inline(always)]
    pub fn primitive<const D: usize, S: Scalar>(&self, u: &Conserved<D, S>) -> Primitive<D, S> {
        let velocity = u.momentum * u.density.inverse();
        let pressure = (u.energy - u.momentum.dot(&velocity) * 0.5) * (self.gamma - 1.0);
        Primitive { density: u.density, velocity, pressure }
    }

    /// Conserved state of a primitive state.
    #[inline(always)]
    pub fn conserved<const D: usize, S: Scalar>(&self, q: &Primitive<D, S>) -> Conserved<D, S> {
        Conserved { density: q.density, momentum: q.velocity * q.density, energy: self.energy(q) }
    }

    /// Total energy per volume ρE.
    #[inline(always)]
    pub fn energy<const D: usize, S: Scalar>(&self, q: &Primitive<D, S>) -> S {
        q.pressure * (1.0 / (self.gamma - 1.0)) + q.density * 0.5 * q.velocity.norm_squared()
    }

    /// Speed of sound c = √(γp/ρ).
    #[inline(always)]
    pub fn sound_speed<const D: usize, S: Scalar>(&self, q: &Primitive<D, S>) -> S {
        (q.pressure * self.gamma / q.density).sqrt()
    }

    /// Flux F(q)·n of mass, momentum and energy across the area vector n; eqs (1)-(3) without viscous stress and heat
    /// flux.
    #[doc(alias = "eq1")]
    #[doc(alias = "eq2")]
    #[doc(alias = "eq3")]
    #[inline(always)]
    pub fn flux<const D: usize, S: Scalar>(&self, q: &Primitive<D, S>, n: &Vector<D, S>) -> Conserved<D, S> {
        let mass = q.density * q.velocity.dot(n);
        Conserved {
            density: mass,
            momentum: q.velocity * mass + *n * q.pressure,
            energy: (self.energy(q) + q.pressure) * q.velocity.dot(n),
        }
    }

    /// Maximum signal speed |v·n| + c|n| across the area vector n.
    #[inline(always)]
    pub fn signal_speed<const D: usize, S: Scalar>(&self, q: &Primitive<D, S>, n: &Vector<D, S>) -> S {
        q.velocity.dot(n).abs() + self.sound_speed(q) * n.norm()
    }

    /// Total enthalpy per mass H = γ/(γ−1) p/ρ + v²/2.
    #[inline(always)]
    pub fn total_enthalpy<const D: usize, S: Scalar>(&self, q: &Primitive<D, S>) -> S {
        q.pressure * (self.gamma / (self.gamma - 1.0)) / q.density + q.velocity.norm_squared() * 0.5
    }

    /// Total pressure p (1 + (γ−1)/2 M²)^(γ/(γ−1)), which results from isentropic deceleration to rest.
    pub fn total_pressure<const D: usize>(&self, q: &Primitive<D>) -> f64 {
        let mach_squared = q.velocity.norm_squared() / self.sound_speed(q).powi(2);
        q.pressure * (1.0 + 0.5 * (self.gamma - 1.0) * mach_squared).powf(self.gamma / (self.gamma - 1.0))
    }

    /// Entropy function p/ρ^γ.
    #[inline(always)]
    pub fn entropy<const D: usize, S: Scalar>(&self, q: &Primitive<D, S>) -> S {
        q.pressure / q.density.powf(self.gamma)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIR: Gas = Gas { gamma: 1.4 };

    #[test] // Anderson, Modern Compressible Flow, table A.1: p₀/p at Mach 2
    fn total_pressure_is_that_of_the_tables() {
        let q = Primitive { density: 1.4, velocity: Vector([0.0, 2.0]), pressure: 1.0 };
        assert!((AIR.total_pressure(&q) - 7.824).abs() < 5e-4);
    }

    #[test] // eq6, eq17
    fn conserved_and_primitive_are_inverse() {
        let q = Primitive { density: 1.3, velocity: Vector([0.2, -0.7, 1.1]), pressure: 0.9 };
        let back = AIR.primitive(&AIR.conserved(&q));
        assert!((back.pressure - q.pressure).abs() < 1e-15 && (back.velocity - q.velocity).norm() < 1e-15);
    }

    #[test]
    fn flux_is_linear_in_the_area_vector() {
        let q = Primitive { density: 1.3, velocity: Vector([0.2, -0.7]), pressure: 0.9 };
        let (a, b) = (Vector([0.3, 0.4]), Vector([-1.0, 0.2]));
        let sum = AIR.flux(&q, &a).plus(1.0, &AIR.flux(&q, &b));
        let whole = AIR.flux(&q, &(a + b));
        assert!((sum.energy - whole.energy).abs() < 1e-15 && (sum.momentum - whole.momentum).norm() < 1e-15);
    }
}
