//! Velocities of Lagrangian particles for a time step.
//!
//! *Regularisation.* δ is the Fickian shift of Lind, Xu, Stansby and Rogers (2012, J. Comput. Phys. 231, eqs 21-26), down
//! the gradient of the concentration of particles, as a velocity (Sun, Colagrossi, Marrone and Zhang 2017, CMAME 315):
//!
//! δ_i = −A c_i Σ_j ω_j f(q_ij) d_ij/|d_ij|, q = |d_ij|/(ρ h̄_ij), f(q) = [1 + R (W(q)/W(q₀))⁴] q (1 − q)³/(q₀ (1 − q₀)³),
//!
//! with the kernel W = (1 − q)⁴ (1 + 4q) of Wendland, whose slope is −20 q (1 − q)³, on the neighbours of the particle;
//! q₀ = 1/ρ is the place of a neighbour one spacing away, R = 0.2 keeps pairs apart (Monaghan 2000). It vanishes on even
//! clouds and is never faster than 0.2 c, nor, where the length of the step is known beforehand, farther than 0.1 h in a step.
//!
//! *Shocks.* The flux relative to a particle uses its own velocity, which makes linear fields exact. Where w and U jump
//! together, the scheme is then not conservative: the sum Σ (w_ij − w_i)·s_ij (U_i − U_ij) remains, and shocks have a
//! wrong speed (3 % in Sod's tube). Particles therefore keep the velocity of their last step, without a shift, while
//! the gas around them, up to three neighbours away, is or was compressed at a rate −h ∇·v > 0.1 c. w then jumps behind
//! the shock, where U no longer does, and the position of the shock is accurate to a fraction of a spacing.
use std::sync::Arc;

use super::discretisation::CloudMotion;
use super::fluid::{Fluid, Work};
use super::frame::{Discretisation, Frame, LagrangianStep};
use super::travel::set_ghost_velocities;
use crate::cloud::Cloud;
use crate::math::Vector;
use crate::math::parallel::{sweep, sweep_each, sweep_parts};
use crate::math::reduce::{first, maximum};
use crate::physics::{Gas, Primitive};

/// Coefficient A of the shift.
const STRENGTH: f64 = 0.1;
/// Greatest shift velocity divided by the sound speed.
const FASTEST: f64 = 0.2;
/// Greatest shift in a step, in spacings.
const FARTHEST: f64 = 0.1;
/// Coefficient R of the term that prevents pairing of particles.
const APART: f64 = 0.2;
/// Weight of an interface particle in the concentration; the gas surrounds it on one side only.
const WALL_SHARE: f64 = 0.5;
/// Compression rate −h ∇·v/c above which there is a shock.
const COMPRESSED: f64 = 0.1;
/// Number of times that the region near a shock is extended to neighbours.
const HOPS: usize = 3;
/// Fraction of the distance between two particles by which they may move relative to each other in a step.
const REACH: f64 = 0.5;

impl<const D: usize> Fluid<D> {
    /// Chooses the particle velocities for the step that starts, whose intended length is `step`; returns the greatest
    /// permitted step.
    pub(super) fn choose_ways(&self, step: f64, u: &[f64], work: &mut Work<D>, frame: &mut Frame<D>) -> f64 {
        self.fill_states(frame, u, work);
        let cloud = &frame.discretisation.cloud;
        let n = cloud.n_fluid;
        let radius = match &self.cloud_motion {
            CloudMotion::Travel(travel) => travel.domain.radius(),
            _ => return f64::INFINITY,
        };
        let state = &work.state;
        let around = around(&frame.discretisation, state, radius);
        let near = shocked(cloud, &self.gas, (state, &around));
        let before = Arc::clone(&frame.lagrangian_step.course);
        let mut course = vec![Vector::ZERO; n];
        sweep(&mut course, |i| {
            if let Some(before) = before.get(i).filter(|_| near.get(i).is_some_and(|near| *near)) {
                return *before;
            }
            let (c, shift) = (self.gas.sound_speed(&state[i]), around[i].shift * STRENGTH);
            let greatest = (FASTEST * c).min(FARTHEST * cloud.spacing[i] / step);
            state[i].velocity + shift * c.min(greatest / shift.norm())
        });
        let (base, course) = (Arc::new(cloud.x[..n].to_vec()), Arc::new(course));
        let velocity = Arc::make_mut(&mut frame.velocity);
        velocity.resize(cloud.len(), Vector::ZERO);
        let now = Arc::new(velocity.clone());
        velocity[..n].copy_from_slice(&course);
        set_ghost_velocities(cloud, velocity);
        let reach = reach(&frame.discretisation, velocity);
        frame.lagrangian_step = LagrangianStep { off: true, since: frame.time, base, course, before, velocity: now };
        reach
    }
}

/// Time after which the first pair of neighbours has moved relative to each other by the fraction [`REACH`] of their
/// distance.
fn reach<const D: usize>(discretisation: &Discretisation<D>, velocity: &[Vector<D>]) -> f64 {
    let (x, op) = (&discretisation.cloud.x, &discretisation.operators);
    let mut fastest = vec![0.0; op.fluid_parts().len()];
    sweep_each(&mut fastest, |k| {
        let rate = |i: usize, j: usize| (velocity[i] - velocity[j]).norm() / (x[i] - x[j]).norm();
        op.edges(k).iter().map(|e| rate(e.i(), e.j())).fold(0.0, f64::max)
    });
    REACH / maximum(fastest.len(), |k| fastest[k]).max(f64::MIN_POSITIVE)
}

/// Sums over the neighbours of a particle.
#[derive(Clone, Copy)]
struct Around<const D: usize> {
    /// −Σ_j ω_j f(q_ij) d_ij/|d_ij|, which points away from high concentrations of particles.
    shift: Vector<D>,
    /// Σ_j (v_i − v_j)·d_ij/|d_ij|², a measure of compression.
    approach: f64,
}

/// These sums for all particles; the contributions to the two ends of an edge are equal or opposite.
fn around<const D: usize>(discretisation: &Discretisation<D>, state: &[Primitive<D>], radius: f64) -> Vec<Around<D>> {
    let (cloud, op) = (&discretisation.cloud, &discretisation.operators);
    let blank = Around { shift: Vector::ZERO, approach: 0.0 };
    let mut all = vec![blank; cloud.n_fluid];
    let (walls, crowding) = (cloud.interface_range(), Crowding::new(radius));
    sweep_parts(op.fluid_parts(), 1, &mut all, &|k, out| {
        let start = op.parts[k].start;
        for e in op.edges(k) {
            let (i, j) = (e.i(), e.j());
            let d = cloud.x[j] - cloud.x[i];
            let (h_i, h_j, r) = (cloud.spacing[i], cloud.spacing[j], d.norm());
            let inverse = 2.0 / (h_i + h_j);
            let push = d * (crowding.at(r * inverse) / r);
            let approach = (state[i].velocity - state[j].velocity).dot(&d) / (r * r);
            let is_wall = j >= cloud.n_fluid && walls.contains(&cloud.source(j).index);
            let share = if is_wall { WALL_SHARE } else { 1.0 };
            let own = &mut out[i - start];
            own.shift -= push * (share * (h_j * inverse).powi(D as i32));
            own.approach += approach;
            if e.both() {
                let other = &mut out[j - start];
                other.shift += push * (h_i * inverse).powi(D as i32);
                other.approach += approach;
            }
        }
    });
    all
}

/// The function f(q) of the shift.
struct Crowding {
    radius: f64,
    kernel_scale: f64,
    slope_scale: f64,
}

impl Crowding {
    fn new(radius: f64) -> Self {
        let unit = 1.0 / radius;
        Self { radius, kernel_scale: 1.0 / Self::kernel(unit), slope_scale: 1.0 / Self::slope(unit) }
    }

    fn kernel(q: f64) -> f64 {
        (1.0 - q).powi(4) * (1.0 + 4.0 * q)
    }

    fn slope(q: f64) -> f64 {
        q * (1.0 - q).powi(3)
    }

    /// Value of f at the distance of `r` mean spacings.
    #[inline(always)]
    fn at(&self, r: f64) -> f64 {
        let q = (r / self.radius).min(1.0);
        let apart = 1.0 + APART * (Self::kernel(q) * self.kernel_scale).powi(4);
        apart * Self::slope(q) * self.slope_scale
    }
}

/// True for particles near a shock: where the gas is strongly compressed, and around it; empty when there is no shock.
fn shocked<const D: usize>(cloud: &Cloud<D>, gas: &Gas, (state, around): (&[Primitive<D>], &[Around<D>])) -> Vec<bool> {
    let n = cloud.n_fluid;
    let compressed = |i: usize| {
        let count = cloud.neighbours.range(i).len().max(1);
        let divergence = -around[i].approach * D as f64 / count as f64;
        -divergence * cloud.spacing[i] > COMPRESSED * gas.sound_speed(&state[i])
    };
    if first(n, compressed).is_none() {
        return Vec::new();
    }
    let mut near = vec![false; n];
    sweep(&mut near, compressed);
    for _ in 0..HOPS {
        let before = near.clone();
        let beside = |j: &u32| before.get(cloud.source(*j as usize).index).copied().unwrap_or(false);
        sweep(&mut near, |i| before[i] || cloud.neighbours.of(i).iter().any(beside));
    }
    near
}
