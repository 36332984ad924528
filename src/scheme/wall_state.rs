//! The state on a wall.
//!
//! *Slip walls.* The state of an interface particle is f_w = Σ_k W_k f_k − g Σ_k W_k n_k of the fluid particles in front of it
//! (`wall_fits`) with a slope g across the wall. Imposed are
//!
//! - ∂(p/ρ^γ)/∂n = 0: entropy does not vary across the wall;
//! - ∂u_t/∂n = −κ u_t: the flow at the wall is irrotational (Crocco), κ the curvature of the wall (tensor in 3-D);
//! - ∂p/∂n = ρ κ u_t²: the centrifugal balance; walls that move add the rate of rotation and the acceleration.
//!
//! *Walls that the gas sticks to* give it their velocity and temperature or ∂θ/∂n = 0; ∂p/∂n = −ρ n·a_w.
use super::wall_fits::{WallFits, lowest_two};
use super::wall_motion::WallMotion;
use crate::cloud::Cloud;
use crate::math::Vector;
use crate::physics::{Gas, Primitive};

/// Smallest fraction of the lowest pressure and entropy in front of a wall that its state may have.
const FLOOR: f64 = 0.2;

/// State of interface particle `w` on a slip wall that moves with `velocity` and `motion`.
///
/// With r = v − w the velocity along the wall, G = ∂w/∂x, K the curvature and a_w the acceleration of the wall:
///
/// - the flow at the wall is irrotational: ∂v_t/∂n = Gᵀn − K r, tangential part;
/// - momentum across the wall: ∂p/∂n = ρ [r·K r − 2 n·G r − n·a_w].
///
/// Extrapolation may not bring pressure or entropy below a fraction of the lowest value in front of the wall.
pub fn slip_wall<const D: usize>(
    shape: (&Cloud<D>, &WallFits),
    gas: &Gas,
    w: usize,
    (velocity, motion): (Vector<D>, Option<&WallMotion<D>>),
    q: impl Fn(usize) -> Primitive<D>,
) -> Primitive<D> {
    let (cloud, fits) = shape;
    let (mut p, mut s, mut v) = (0.0, 0.0, Vector::<D>::ZERO);
    let mut lowest = (f64::INFINITY, f64::INFINITY);
    for (k, weight) in cloud.wall_stencils.of(w).iter().zip(&fits.weight[cloud.wall_stencils.range(w)]) {
        let state = q(*k as usize);
        let entropy = gas.entropy(&state);
        p += weight * state.pressure;
        s += weight * entropy;
        v += state.velocity * *weight;
        lowest = (lowest.0.min(state.pressure), lowest.1.min(entropy));
    }
    let (wall, normal_offset) = (&cloud.interface[w], fits.normal_offset[w]);
    let gradient_times =
        |v: &Vector<D>| motion.map_or(Vector::ZERO, |m| Vector::from_fn(|i| m.wall_velocity_gradient[i].dot(v)));
    let normal = &wall.normal;
    let slope = motion
        .map_or(Vector::ZERO, |m| (0..D).fold(Vector::ZERO, |sum, i| sum + m.wall_velocity_gradient[i] * normal[i]));
    let along = along_wall(&(v - velocity - slope * normal_offset), normal);
    let relative = irrotational(&along, wall, normal_offset);
    let s = s.max(FLOOR * lowest.1);
    let density = |p: f64| (p / s).powf(1.0 / gas.gamma);
    let inertia = motion.map_or(0.0, |m| 2.0 * normal.dot(&gradient_times(&relative)) + normal.dot(&m.acceleration));
    let pull = normal_offset * (bending(wall, &relative) - inertia);
    // the density follows the pressure at constant entropy, three rounds settle it
    let mut pressure = p.max(FLOOR * lowest.0);
    for _ in 0..3 {
        pressure = (p - pull * density(pressure)).max(FLOOR * lowest.0);
    }
    let across = *normal * velocity.dot(normal);
    Primitive { density: density(pressure), velocity: relative + along_wall(&velocity, normal) + across, pressure }
}

/// State of interface particle `w` on a wall that the gas sticks to, with ∂p/∂n = −ρ n·a_w and ∂θ/∂n = 0, or at the given
/// temperature: parabolas through the first two layers, or the fit without layers.
pub(super) fn no_slip_wall<const D: usize>(
    (cloud, fits): (&Cloud<D>, &WallFits),
    gas: &Gas,
    w: usize,
    ((velocity, motion), temperature): ((Vector<D>, Option<&WallMotion<D>>), Option<f64>),
    q: impl Fn(usize) -> Primitive<D>,
) -> Primitive<D> {
    let mut sum = (0.0, 0.0);
    let mut lowest = (f64::INFINITY, f64::INFINITY);
    let mut take = |k: usize, weight: f64| {
        let state = q(k);
        let own = (state.pressure, gas.temperature(&state));
        sum = (sum.0 + weight * own.0, sum.1 + weight * own.1);
        lowest = (lowest.0.min(own.0), lowest.1.min(own.1));
    };
    let normal_offset = match lowest_two(cloud, w) {
        Some(([a, b], [low, high])) => {
            let part = low * low / (high * high - low * low);
            take(a, 1.0 + part);
            take(b, -part);
            low * high / (low + high)
        }
        None => {
            let weights = &fits.weight[cloud.wall_stencils.range(w)];
            cloud.wall_stencils.of(w).iter().zip(weights).for_each(|(k, weight)| take(*k as usize, *weight));
            fits.normal_offset[w]
        }
    };
    let (p, floor) = (sum.0, FLOOR * lowest.0);
    let theta = temperature.unwrap_or(sum.1.max(FLOOR * lowest.1));
    let inertia = motion.map_or(0.0, |m| cloud.interface[w].normal.dot(&m.acceleration));
    // p_w = p + normal_offset ρ_w n·a_w with ρ_w = γ p_w/θ
    let pressure = (p / (1.0 - (normal_offset * inertia * gas.gamma / theta).min(0.5))).max(floor);
    Primitive { density: gas.gamma * pressure / theta, velocity, pressure }
}

fn along_wall<const D: usize>(v: &Vector<D>, normal: &Vector<D>) -> Vector<D> {
    *v - *normal * v.dot(normal)
}

/// Solves (I − B K) r = `along`: the tangential velocity with slope −K r across the wall.
fn irrotational<const D: usize>(along: &Vector<D>, wall: &crate::cloud::Interface<D>, normal_offset: f64) -> Vector<D> {
    // B K is small (spacing over radius of curvature): six terms of the Neumann series are plenty
    let apply = |u: &Vector<D>| Vector::from_fn(|r| normal_offset * wall.curvature[r].dot(u));
    let mut u = *along;
    for _ in 0..6 {
        u = along_wall(&(*along + apply(&u)), &wall.normal);
    }
    u
}

/// r·K r.
fn bending<const D: usize>(wall: &crate::cloud::Interface<D>, r: &Vector<D>) -> f64 {
    (0..D).map(|d| r[d] * wall.curvature[d].dot(r)).sum()
}
