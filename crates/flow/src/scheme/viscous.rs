//! Viscous stress and heat conduction between particles and at walls.
//!
//! At the midpoint of the edge d = x_j − x_i, with the mean ḡ of the gradients at both ends and the direction
//! m = s_ij/|s_ij| of its face, the gradient of velocity and temperature is
//!
//! g = ḡ + m (Δf − ḡ·d)/(m·d),
//!
//! the mean, corrected so that the difference between the particles themselves determines the derivative across the
//! face. A correction along the edge instead of m is inaccurate on thin layers with diagonal neighbours. The
//! contribution of the viscous flux F_v(g) is +F_v·s_ij/V_i with conservative coefficients, otherwise 2
//! a_ij·[F_v − F_v(g_i)]. Both vanish in uniform flow and for uniform stress.
//!
//! *No-slip walls.* The velocity of an interface particle is that of the wall, its pressure follows from ∂p/∂n = −ρ
//! n·a_w, and its temperature from ∂θ/∂n = 0 or is given (`wall_state`). The stress on the wall is that of the slope
//! ∂v/∂n = (Δv₁ η₂/η₁ − Δv₂ η₁/η₂)/(η₂ − η₁), a parabola through the wall and two layers at the heights η; without
//! layers, it is that of the normal part of the gradient of the interface particle. Along the wall, the gas rotates
//! with it: ∇v = n ∂v/∂n + G (I − nn) with the rate of rotation G of the wall, so that rotation together with the wall
//! causes no stress.
//!
//! The linearisation contains the differences across the face only (thin-layer approximation).
use super::block::Block;
use super::reconstruct::Gradient;
use super::wall_state::WallCondition;
use crate::math::Vector;
use crate::math::blocks::array;
use crate::math::jet::Scalar;
use crate::physics::viscous::Slopes;
use crate::physics::{Gas, Newtonian, Primitive, n_variables};

/// Smallest fraction of the length of an edge that counts as its extent across the face. It keeps the correction
/// bounded and damping where a face is nearly parallel to its edge.
const SHORTEST: f64 = 0.3;

/// Viscosity of the gas and the conditions at its walls.
#[derive(Clone, Debug, PartialEq)]
pub struct ViscousModel {
    /// Viscosity and heat conduction.
    pub medium: Newtonian,
    /// Condition at each body.
    pub wall_conditions: Vec<WallCondition>,
}

impl ViscousModel {
    /// Condition at the body with this number.
    #[inline]
    pub fn wall_condition(&self, body: u16) -> WallCondition {
        self.wall_conditions.get(usize::from(body)).copied().unwrap_or(WallCondition::Slip)
    }
}

/// Stress and heat flux at a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSlopes<const D: usize, S = f64> {
    /// Viscous stress of the gas on the wall, force per area.
    pub stress: Vector<D, S>,
    /// Heat flux from the gas into the wall, per area and time.
    pub heat: S,
}

/// Weights of the slope at the wall of a parabola that is zero there and has given values at two heights.
pub(super) fn slope_weights([low, high]: [f64; 2]) -> [f64; 2] {
    [high / low / (high - low), -low / high / (high - low)]
}

/// Gradient of the temperature θ = γp/ρ.
#[inline(always)]
pub(super) fn temperature_gradient<const D: usize, S: Scalar>(
    gas: &Gas,
    q: &Primitive<D, S>,
    g: &Gradient<D, S>,
) -> Vector<D, S> {
    (g.pressure - g.density * (q.pressure / q.density)) * (S::constant(gas.gamma) / q.density)
}

/// Extent of the edge `d` across the face with the normal `m`.
#[inline(always)]
pub(super) fn reach<const D: usize, S: Scalar>(d: &Vector<D, S>, m: &Vector<D, S>) -> S {
    m.dot(d).max(d.norm() * SHORTEST)
}

/// Unit normal of the face `s` of the edge `d`.
#[inline(always)]
pub(super) fn direction<const D: usize, S: Scalar>(s: &Vector<D, S>, d: &Vector<D, S>) -> Vector<D, S> {
    let face = if s.norm_squared().value() > 0.0 { s } else { d };
    *face * face.norm().inverse()
}

/// Velocity, temperature and their gradients at a particle with the state `q` and the gradient `g`.
#[inline(always)]
pub(super) fn slopes<const D: usize, S: Scalar>(gas: &Gas, q: &Primitive<D, S>, g: &Gradient<D, S>) -> Slopes<D, S> {
    Slopes {
        velocity: q.velocity,
        temperature: gas.temperature(q),
        velocity_gradient: g.velocity,
        temperature_gradient: temperature_gradient(gas, q, g),
    }
}

/// Values and gradients at the midpoint of the edge `d`, whose face has the normal `m`.
#[inline(always)]
pub(super) fn middle<const D: usize, S: Scalar>(
    (a, b): (&Slopes<D, S>, &Slopes<D, S>),
    d: &Vector<D, S>,
    m: &Vector<D, S>,
) -> Slopes<D, S> {
    let across = reach(d, m).inverse();
    let corrected = |ga: &Vector<D, S>, gb: &Vector<D, S>, change: S| {
        let mean = (*ga + *gb).times(0.5);
        mean + *m * ((change - mean.dot(d)) * across)
    };
    let (va, vb) = (&a.velocity_gradient, &b.velocity_gradient);
    let dv = b.velocity - a.velocity;
    let dt = b.temperature - a.temperature;
    Slopes {
        velocity: (a.velocity + b.velocity).times(0.5),
        temperature: (a.temperature + b.temperature) * 0.5,
        velocity_gradient: array(|c| corrected(&va[c], &vb[c], dv[c])),
        temperature_gradient: corrected(&a.temperature_gradient, &b.temperature_gradient, dt),
    }
}

/// Derivative ∂/∂U of (0, v + m (m·v)/3, v̄·(v + m (m·v)/3) + γ/Pr e) at the state `q` with constant v̄: exchange by
/// differences across a face of normal `m`, divided by the viscosity.
#[inline(always)]
pub(super) fn thin_layer<const D: usize>(
    gas: &Gas,
    medium: &Newtonian,
    q: &Primitive<D>,
    m: &Vector<D>,
    block: &mut Block,
) {
    motion(q, m, block);
    let heat = energy(q, gas);
    let e = D + 1;
    for c in 0..n_variables(D) {
        let work: f64 = (0..D).map(|d| q.velocity[d] * block[1 + d][c]).sum();
        block[e][c] = work + gas.gamma / medium.prandtl * heat[c];
    }
}

/// This derivative at a wall of given velocity and condition.
pub(super) fn at_contact<const D: usize>(
    gas: &Gas,
    medium: &Newtonian,
    (q, wall): (&Primitive<D>, &Vector<D>),
    (wall_condition, n): (WallCondition, &Vector<D>),
) -> Block {
    let mut block = [[0.0; 5]; 5];
    motion(q, n, &mut block);
    let heat = energy(q, gas);
    let conducts = wall_condition.heat(gas.gamma / medium.prandtl);
    for c in 0..n_variables(D) {
        let work: f64 = (0..D).map(|d| wall[d] * block[1 + d][c]).sum();
        block[D + 1][c] = work + conducts * heat[c];
    }
    block
}

/// Derivative ∂/∂U of v + m (m·v)/3, in the momentum rows of a zero block.
#[inline(always)]
fn motion<const D: usize>(q: &Primitive<D>, m: &Vector<D>, block: &mut Block) {
    let across = q.velocity.dot(m);
    for d in 0..D {
        block[1 + d][0] = -(q.velocity[d] + m[d] * across / 3.0) / q.density;
        for c in 0..D {
            block[1 + d][1 + c] = m[d] * m[c] / (3.0 * q.density);
        }
        block[1 + d][1 + d] += 1.0 / q.density;
    }
}

/// Derivative ∂e/∂U of the internal energy per mass.
#[inline(always)]
fn energy<const D: usize>(q: &Primitive<D>, gas: &Gas) -> [f64; 5] {
    let mut row = [0.0; 5];
    row[0] = (q.velocity.norm_squared() - gas.energy(q) / q.density) / q.density;
    (0..D).for_each(|d| row[1 + d] = -q.velocity[d] / q.density);
    row[D + 1] = 1.0 / q.density;
    row
}
