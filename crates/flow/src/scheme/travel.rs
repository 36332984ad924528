//! Lagrangian particles, which travel with the fluid.
//!
//! During a time step, every particle moves along a straight line with the velocity w_i = v_i + δ_i, chosen from the
//! state at the start of the step. Positions and state are advanced by the same formula. Uniform flow and linear fields
//! at rest are therefore preserved to round-off for any w; the closer w is to the gas velocity, the less is advected
//! relative to the particles.
//!
//! The velocities are chosen in `lagrangian_step`; the cloud is rebuilt in `reclouding`.
use std::sync::Arc;

use super::frame::{Discretisation, Frame, LagrangianStep};
use super::wall_fits::WallFits;
use super::wall_motion::{WallMotion, rotation_rate};
use crate::cloud::Cloud;
use crate::cloud::travel::BackgroundDomain;
use crate::math::Vector;
use crate::math::parallel::sweep;
use crate::math::reduce::maximum;
use crate::motion::{BodyMotion, RigidPose};
use crate::system::{Instant, Rate, Term};

/// Data of Lagrangian particles.
#[derive(Clone)]
pub struct Travel<const D: usize> {
    /// Background, sides and bodies, which do not change.
    pub domain: Arc<BackgroundDomain<D>>,
    /// Motion of each body.
    pub laws: Vec<BodyMotion<D>>,
    /// Positions and velocities of the particles at the start of this system.
    pub kinematics: Arc<ParticleKinematics<D>>,
    /// Time at which the cloud was built.
    pub since: f64,
}

/// Positions and velocities of Lagrangian particles at one time.
#[derive(Clone, Debug, Default)]
pub struct ParticleKinematics<const D: usize> {
    /// Time of the positions.
    pub now: f64,
    /// Positions of fluid and interface particles.
    pub places: Vec<Vector<D>>,
    /// Their velocities by the same difference formula as for the state; empty at the start.
    pub velocity: Vec<Vector<D>>,
    /// Straight-line velocities of the fluid particles in the previous step; empty at the start.
    pub course: Vec<Vector<D>>,
}

impl<const D: usize> Travel<D> {
    /// Poses of the bodies at time `t`.
    pub(super) fn poses(&self, t: f64) -> Vec<RigidPose<D>> {
        self.laws.iter().map(|l| l.pose(t)).collect()
    }

    /// Sets `frame` to a time: the fluid particles move from their positions at the start of the step with the chosen
    /// velocities.
    pub(super) fn place(&self, origin: &Arc<Discretisation<D>>, at: &Instant<'_>, frame: &mut Frame<D>) {
        let cloud = &origin.cloud;
        let (n, kinematics) = (cloud.n_fluid, &self.kinematics);
        if frame.lagrangian_step.base.len() != n {
            // the same bits as in the previous system or in a checkpoint
            let (base, course) = (Arc::new(kinematics.places[..n].to_vec()), Arc::new(kinematics.course.clone()));
            frame.lagrangian_step = LagrangianStep { since: kinematics.now, base, course, ..LagrangianStep::default() };
            frame.time = kinematics.now;
        }
        let velocity = Arc::make_mut(&mut frame.velocity);
        velocity.resize(cloud.len(), Vector::ZERO);
        let lagrangian_step = &frame.lagrangian_step;
        let passed = match at.rate {
            Rate::Within { step, fraction, .. } if lagrangian_step.off => fraction * step,
            Rate::Formula(_) if lagrangian_step.off => at.time - lagrangian_step.since,
            _ => 0.0,
        };
        let (off, back) =
            (lagrangian_step.off, lagrangian_step.off && passed == 0.0 && matches!(at.rate, Rate::Formula(_)));
        match at.rate {
            _ if !off => velocity[..kinematics.velocity.len()].copy_from_slice(&kinematics.velocity),
            Rate::Formula(rate) if !back => differentiate(lagrangian_step, rate, &mut velocity[..n]),
            _ => {}
        }
        let discretisation = Arc::make_mut(&mut frame.discretisation);
        let (base, course) = (&frame.lagrangian_step.base, &frame.lagrangian_step.course);
        let ahead = |i: usize| if passed > 0.0 { base[i] + course[i] * passed } else { base[i] };
        let fixed = self.laws.iter().all(BodyMotion::is_fixed);
        let away = maximum(n, |i| (ahead(i) - discretisation.cloud.x[i]).max_abs());
        sweep(&mut discretisation.cloud.x[..n], ahead);
        match off {
            true => self.place_walls(at, &mut discretisation.cloud, velocity),
            false => discretisation.cloud.x[n..kinematics.places.len()].copy_from_slice(&kinematics.places[n..]),
        }
        if back {
            // as before the start of the step
            *velocity = (*frame.lagrangian_step.velocity).clone();
            (frame.lagrangian_step.off, frame.lagrangian_step.course) =
                (false, Arc::clone(&frame.lagrangian_step.before));
        }
        set_ghost_velocities(cloud, velocity);
        if fixed && away == 0.0 && frame.walls.len() == cloud.interface.len() {
            return;
        }
        let (x, ghosts) = discretisation.cloud.x.split_at_mut(cloud.n_real());
        sweep(ghosts, |k| {
            let image = &cloud.ghosts[k];
            cloud.transforms[image.transform as usize].point(&x[image.source as usize])
        });
        self.turn_walls(frame.time, frame);
        let discretisation = Arc::make_mut(&mut frame.discretisation);
        discretisation.operators.refit(&discretisation.cloud);
        discretisation.walls = WallFits::new(&discretisation.cloud);
    }

    /// Moves the interface particles with their bodies.
    fn place_walls(&self, at: &Instant<'_>, cloud: &mut Cloud<D>, velocity: &mut [Vector<D>]) {
        let (before, interface) = self.domain.walls();
        if self.laws.iter().all(BodyMotion::is_fixed) {
            return;
        }
        let (from, to, step, fraction) = match at.rate {
            Rate::Within { start, step, fraction, .. } => (start, start + step, step, fraction),
            Rate::Still | Rate::Formula(_) => (at.time, at.time, 1.0, 0.0),
        };
        let (from, to) = (self.poses(from), self.poses(to));
        let terms: Vec<(f64, Vec<RigidPose<D>>)> = match at.rate {
            Rate::Formula(rate) => rate.iter().map(|r| (r.coefficient, self.poses(r.time))).collect(),
            _ => vec![(1.0 / step, to), (-1.0 / step, from.clone())],
        };
        for (k, (x, wall)) in before.iter().zip(interface).enumerate() {
            let (i, body) = (cloud.n_fluid + k, usize::from(wall.body));
            let Some(from) = from.get(body) else { continue };
            let place = |(c, poses): &(f64, Vec<RigidPose<D>>)| poses[body].point(x) * *c;
            velocity[i] = terms.iter().map(place).fold(Vector::ZERO, |s, v| s + v);
            cloud.x[i] = from.point(x) + velocity[i] * (fraction * step);
        }
    }

    /// Sets area vectors, rotation and acceleration of the walls at time `t`.
    fn turn_walls(&self, t: f64, frame: &mut Frame<D>) {
        let (before, interface) = self.domain.walls();
        let walls = Arc::make_mut(&mut frame.walls);
        walls.resize(interface.len(), WallMotion::AT_REST);
        if self.laws.iter().all(BodyMotion::is_fixed) {
            return;
        }
        let cloud = &mut Arc::make_mut(&mut frame.discretisation).cloud;
        let rates: Vec<[Vector<D>; D]> = self.laws.iter().map(|l| rotation_rate(l, t)).collect();
        let poses = self.poses(t);
        for (k, (x, wall)) in before.iter().zip(interface).enumerate() {
            let body = usize::from(wall.body);
            let Some(law) = self.laws.get(body) else { continue };
            cloud.interface[k] = *wall;
            cloud.interface[k].turn(&poses[body].rotation);
            walls[k] =
                WallMotion { wall_velocity_gradient: rates[body], acceleration: law.kinematics(t, x).acceleration };
        }
    }
}

/// Velocities by a difference formula for particles on straight lines in this step and in the previous one.
fn differentiate<const D: usize>(lagrangian_step: &LagrangianStep<D>, rate: &[Term<'_>], velocity: &mut [Vector<D>]) {
    let passed = |k: usize| rate[k - 1].time - rate[k].time;
    let now = rate[0].coefficient * passed(1);
    match rate.get(2) {
        // c₀ x(t₀) + c₁ x(t₁) + c₂ x(t₂) with Σ c = 0
        Some(last) => {
            let then = -last.coefficient * passed(2);
            sweep(velocity, |i| lagrangian_step.course[i] * now + lagrangian_step.before[i] * then);
        }
        None => sweep(velocity, |i| lagrangian_step.course[i] * now),
    }
}

/// Sets the velocities of ghosts from those of their sources.
pub(super) fn set_ghost_velocities<const D: usize>(cloud: &Cloud<D>, velocity: &mut [Vector<D>]) {
    let (own, ghosts) = velocity.split_at_mut(cloud.n_real());
    sweep(ghosts, |k| {
        let image = &cloud.ghosts[k];
        cloud.transforms[image.transform as usize].direction(&own[image.source as usize])
    });
}
