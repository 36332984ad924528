//! The state of the gas on a wall.
//!
//! *Slip walls.* The state of an interface particle is f_w = Σ_k W_k f_k − g Σ_k W_k n_k, with the fluid particles in
//! front of it (`wall_fits`) and a slope g across the wall. The conditions are
//!
//! - ∂(p/ρ^γ)/∂n = 0: the entropy does not vary across the wall;
//! - ∂u_t/∂n = −κ u_t: the flow at the wall is irrotational (Crocco), with the curvature κ of the wall (a tensor in
//!   3-D);
//! - ∂p/∂n = ρ κ u_t²: centrifugal equilibrium; moving walls add their rate of rotation and acceleration.
//!
//! *No-slip walls* impose their velocity, and their temperature or ∂θ/∂n = 0; ∂p/∂n = −ρ n·a_w.
//!
//! Both are functions of plain values: the wall, and the weights W_k and states of the particles in front of it.
//! [`WallCondition`] is the boundary condition of a body: all that depends on which of them it is stands here.
use super::wall_motion::WallMotion;
use crate::math::Vector;
use crate::math::jet::Scalar;
use crate::physics::{Gas, Primitive};

/// Smallest fraction of the lowest pressure and entropy in front of a wall that the wall state may have.
const FLOOR: f64 = 0.2;
/// Number of iterations for the pressure on a slip wall, on which the density depends at constant entropy.
const ROUNDS: usize = 3;
/// Number of terms of the Neumann series of (I − B K)⁻¹: B K is small (spacing over radius of curvature) and at most
/// one half ([`tempered`]).
const TERMS: usize = 6;
/// Parameter k of [`tempered`] for the slope of the velocity and for that of the pressure.
const OF_SPEED: f64 = 2.0;
const OF_PRESSURE: f64 = 2.9;
/// Greatest fraction of its pressure by which the acceleration of a wall may change the pressure on it.
const MAX_INERTIA: f64 = 0.5;

/// Boundary condition of the gas at the surface of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WallCondition {
    /// Slip.
    Slip,
    /// No slip, adiabatic.
    Adiabatic,
    /// No slip, with this wall temperature divided by that of the free stream.
    Temperature(f64),
}

impl WallCondition {
    /// True where the gas slides along the wall: no stress and no heat.
    #[inline]
    pub fn slips(self) -> bool {
        self == Self::Slip
    }

    /// The temperature that the wall has; `None` where it follows from the gas.
    pub fn temperature<S: Scalar>(self) -> Option<S> {
        match self {
            Self::Temperature(t) => Some(S::constant(t)),
            Self::Slip | Self::Adiabatic => None,
        }
    }

    /// What of `heat`, a quantity in proportion to the heat flux that the slope of the temperature would give, passes the wall.
    pub fn heat<S: Scalar>(self, heat: S) -> S {
        if self == Self::Adiabatic { S::constant(0.0) } else { heat }
    }
}

/// Geometry and motion of the wall at an interface particle.
#[derive(Clone, Copy, Debug)]
pub struct Wall<const D: usize, S = f64> {
    /// Unit normal into the gas.
    pub normal: Vector<D, S>,
    /// Rows of the curvature tensor K = ∂n/∂x along the wall; positive for a convex body.
    pub curvature: [Vector<D, S>; D],
    /// Offset B = Σ W n: effect of a unit slope across the wall on the weighted mean.
    pub offset: S,
    /// Velocity w of the wall.
    pub velocity: Vector<D, S>,
    /// Rotation, stretching and acceleration of the wall; `None` for a wall at rest.
    pub motion: Option<WallMotion<D, S>>,
}

/// State on a slip wall from the particles in front of it, given as pairs of weight W and state.
///
/// With the velocity r = v − w along the wall, G = ∂w/∂x, the curvature K and the acceleration a_w of the wall:
///
/// - the flow at the wall is irrotational: ∂v_t/∂n = Gᵀn − K r, tangential part;
/// - momentum across the wall: ∂p/∂n = ρ [r·K r − 2 n·G r − n·a_w].
///
/// The extrapolation cannot reduce pressure or entropy below a fraction of the lowest value in front of the wall.
pub fn slip_wall<const D: usize, S: Scalar>(
    gas: &Gas,
    wall: &Wall<D, S>,
    front: impl Iterator<Item = (S, Primitive<D, S>)>,
) -> Primitive<D, S> {
    let zero = S::constant(0.0);
    let (mut p, mut s, mut v) = (zero, zero, Vector::<D, S>::zero());
    let mut lowest = [S::constant(f64::INFINITY); 2];
    for (weight, state) in front {
        let entropy = gas.entropy(&state);
        p = p + weight * state.pressure;
        s = s + weight * entropy;
        v += state.velocity * weight;
        lowest = [lowest[0].min(state.pressure), lowest[1].min(entropy)];
    }
    let relative = sliding(wall, &v);
    let inertia = wall.motion.as_ref().map_or(zero, |m| {
        let turned = Vector::from_fn(|i| m.wall_velocity_gradient[i].dot(&relative));
        wall.normal.dot(&turned) * 2.0 + wall.normal.dot(&m.acceleration)
    });
    let pull = wall.offset * (bending(wall, &relative) * tempered(wall, OF_PRESSURE) - inertia);
    let (s, floor) = (s.max(lowest[1] * FLOOR), lowest[0] * FLOOR);
    let density = |p: S| (p / s).powf(1.0 / gas.gamma);
    let mut pressure = p.max(floor);
    for _ in 0..ROUNDS {
        pressure = (p - pull * density(pressure)).max(floor);
    }
    let across = wall.normal * wall.velocity.dot(&wall.normal);
    let velocity = relative + along_wall(&wall.velocity, &wall.normal) + across;
    Primitive { density: density(pressure), velocity, pressure }
}

/// State on a no-slip wall with ∂p/∂n = −ρ n·a_w and ∂θ/∂n = 0, or with a given temperature, from the particles in
/// front of it, given as pairs of weight W and state.
pub fn no_slip_wall<const D: usize, S: Scalar>(
    gas: &Gas,
    wall: &Wall<D, S>,
    temperature: Option<S>,
    front: impl Iterator<Item = (S, Primitive<D, S>)>,
) -> Primitive<D, S> {
    let zero = S::constant(0.0);
    let (mut sum, mut lowest) = ([zero; 2], [S::constant(f64::INFINITY); 2]);
    for (weight, state) in front {
        let own = [state.pressure, gas.temperature(&state)];
        sum = [sum[0] + weight * own[0], sum[1] + weight * own[1]];
        lowest = [lowest[0].min(own[0]), lowest[1].min(own[1])];
    }
    let theta = temperature.unwrap_or(sum[1].max(lowest[1] * FLOOR));
    let inertia = wall.motion.as_ref().map_or(zero, |m| wall.normal.dot(&m.acceleration));
    // p_w = p + B ρ_w n·a_w with ρ_w = γ p_w/θ
    let pushed = (wall.offset * inertia * gas.gamma / theta).min(S::constant(MAX_INERTIA));
    let pressure = (sum[0] / (S::constant(1.0) - pushed)).max(lowest[0] * FLOOR);
    Primitive { density: pressure * gas.gamma / theta, velocity: wall.velocity, pressure }
}

fn along_wall<const D: usize, S: Scalar>(v: &Vector<D, S>, normal: &Vector<D, S>) -> Vector<D, S> {
    *v - *normal * v.dot(normal)
}

/// Velocity along the wall, relative to it, of gas with the weighted mean velocity `v`: solves (I − B K) r = v − w − B
/// Gᵀn.
fn sliding<const D: usize, S: Scalar>(wall: &Wall<D, S>, v: &Vector<D, S>) -> Vector<D, S> {
    let turning = |m: &WallMotion<D, S>| {
        let rows = m.wall_velocity_gradient.iter().enumerate();
        rows.fold(Vector::zero(), |sum, (i, row)| sum + *row * wall.normal[i])
    };
    let slope = wall.motion.as_ref().map_or(Vector::zero(), turning);
    let along = along_wall(&(*v - wall.velocity - slope * wall.offset), &wall.normal);
    let reach = wall.offset * tempered(wall, OF_SPEED);
    let bent = |u: &Vector<D, S>| Vector::from_fn(|r| reach * wall.curvature[r].dot(u));
    (0..TERMS).fold(along, |u, _| along_wall(&(along + bent(&u)), &wall.normal))
}

/// Factor on the curvature where the radius of curvature is not large compared with the spacing; 1 on flat walls.
///
/// The slope κ u holds only on the wall itself: around a cylinder u = u_w (1 + 1/(1 + κn)²)/2, which decreases to one
/// half and no further. A fit through particles at h/2 and 3h/2 yields u_w of that flow within 2 % for any radius, and
/// p_w within 8 %, when the slope is multiplied by (1 + (k x)^(3/2))^(−2/3), x = B κ; without this factor, the error is
/// unbounded as x approaches 1.
fn tempered<const D: usize, S: Scalar>(wall: &Wall<D, S>, k: f64) -> S {
    let one = S::constant(1.0);
    let square = wall.curvature.iter().fold(S::constant(0.0), |sum, row| sum + row.dot(row));
    let x2 = square * wall.offset * wall.offset * (k * k);
    // the root has no derivative on a flat wall
    if x2.value() > 0.0 { (x2.powf(0.75) + one).powf(-2.0 / 3.0) } else { one }
}

/// The product r·K r.
fn bending<const D: usize, S: Scalar>(wall: &Wall<D, S>, r: &Vector<D, S>) -> S {
    Vector::from_fn(|d| wall.curvature[d].dot(r)).dot(r)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::jet::Jet;

    const AIR: Gas = Gas { gamma: 1.4 };

    /// A hollow wall of radius 2 that turns at the rate 0.3 and is pushed; particles in front of it.
    fn wall<S: Scalar>(speed: S) -> (Wall<2, S>, [(S, Primitive<2, S>); 3]) {
        let fixed = |v: [f64; 2]| Vector(v.map(S::constant));
        let motion = WallMotion {
            wall_velocity_gradient: [fixed([0.0, -0.3]), fixed([0.3, 0.0])],
            acceleration: fixed([0.05, 0.1]),
        };
        let wall = Wall {
            normal: fixed([0.0, 1.0]),
            curvature: [fixed([-0.5, 0.0]), fixed([0.0, 0.0])],
            offset: S::constant(0.06),
            velocity: fixed([0.02, 0.01]),
            motion: Some(motion),
        };
        let state = |density: f64, factor: f64, pressure: f64| Primitive {
            density: S::constant(density),
            velocity: Vector([speed * factor, S::constant(0.03)]),
            pressure: S::constant(pressure),
        };
        let front = [(1.2, state(1.0, 1.0, 0.7)), (0.3, state(1.1, 0.9, 0.75)), (-0.5, state(0.9, 1.2, 0.65))];
        (wall, front.map(|(weight, q)| (S::constant(weight), q)))
    }

    /// Wall state of the flow round a cylinder of radius `r` spacings at the height of its greatest speed, from the two
    /// particles above it.
    fn on_cylinder(r: f64) -> Primitive<2> {
        let front = [0.5, 1.5].map(|n: f64| {
            let u = 0.01 * (1.0 + (r / (r + n)).powi(2)) / 2.0;
            Primitive { density: 1.0, velocity: Vector([u, 0.0]), pressure: 1.0 / 1.4 - u * u / 2.0 }
        });
        let wall = Wall {
            normal: Vector([0.0, 1.0]),
            curvature: [Vector([1.0 / r, 0.0]), Vector::ZERO],
            offset: 0.375,
            velocity: Vector::ZERO,
            motion: None,
        };
        slip_wall(&AIR, &wall, [1.125, -0.125].into_iter().zip(front))
    }

    #[test]
    fn walls_of_any_radius_have_the_speed_and_pressure_of_the_flow_round_a_cylinder() {
        for r in [1e-3, 0.03, 0.3, 0.6, 1.0, 2.0, 5.0, 20.0, 1e3] {
            let q = on_cylinder(r);
            let (u, p) = (q.velocity[0] / 0.01, (q.pressure - 1.0 / 1.4) / 0.5e-4);
            assert!((u - 1.0).abs() < 0.02 && (p + 1.0).abs() < 0.08, "{r}: {u} {p}");
        }
        assert!((on_cylinder(40.0).velocity[0] / 0.01 - 1.0).abs() < 2e-5);
    }

    fn states<S: Scalar>(speed: S) -> [[S; 4]; 3] {
        let (wall, front) = wall(speed);
        let all = |q: Primitive<2, S>| [q.density, q.velocity[0], q.velocity[1], q.pressure];
        let sticks = |t: Option<S>| all(no_slip_wall(&AIR, &wall, t, front.into_iter()));
        [all(slip_wall(&AIR, &wall, front.into_iter())), sticks(None), sticks(Some(S::constant(1.1)))]
    }

    #[test]
    fn nothing_passes_a_slip_wall_and_the_velocity_of_a_no_slip_wall_is_its_own() {
        let [slides, sticks, warm] = states(0.4);
        assert!((slides[2] - 0.01).abs() < 1e-15);
        assert_eq!([&sticks[1..3], &warm[1..3]], [&[0.02, 0.01]; 2]);
        assert!((1.4 * warm[3] / warm[0] - 1.1).abs() < 1e-15);
    }

    #[test]
    fn numbers_with_derivatives_give_the_derivative_of_the_state() {
        const STEP: f64 = 1e-5;
        let (jets, less, more) = (states(Jet::variable(0.4)), states(0.4 - STEP), states(0.4 + STEP));
        for (jet, (a, b)) in jets.iter().flatten().zip(less.iter().flatten().zip(more.iter().flatten())) {
            assert!((jet.first - (b - a) / (2.0 * STEP)).abs() < 1e-9, "{jet:?}");
        }
        assert_eq!(jets.map(|q| q.map(|v| v.value)), states(0.4));
    }
}
