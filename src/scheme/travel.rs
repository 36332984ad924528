//! Particles that travel with the fluid.
//!
//! In a step every particle goes straight, with w_i = v_i + δ_i chosen from the state at its start. Positions and state then
//! follow the same formula, so that whatever w is, uniform flow and linear fields at rest are kept to round-off; how closely
//! w follows the gas decides nothing but how little is advected past the particles.
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
//! *Shocks.* The flux past a particle is taken with its own velocity, which makes linear fields exact; where w and U jump
//! together, what one particle loses another does not gain: Σ (w_ij − w_i)·s_ij (U_i − U_ij) is left over, and a shock
//! runs at a wrong speed (3 % in Sod's tube). Particles therefore keep the velocity of their last step, and are not shifted,
//! while the gas around them is compressed at a rate −h ∇·v > 0.1 c, or has been three neighbours away: w jumps behind
//! the shock, where U no longer does, and the shock stays within a fraction of a spacing.
//!
//! *Re-clouding.* The lists of neighbours serve until two particles that see one another have moved apart or together by a
//! quarter of their spacing, or a row of the cloud gets sick. Then the cloud is built anew where the particles are
//! ([`crate::cloud::travel`]), and `transfer` takes the state over.
use std::sync::Arc;

use super::boundary::WallFits;
use super::boundary::WallMotion;
use super::discretisation::{CloudMotion, Discretisation, Frame, LagrangianStep, rotation_rate};
use super::fluid::{Fluid, Work};
use super::transfer::{RemapLedger, Transfer};
use crate::cloud::repair::WORST_CONDITION;
use crate::cloud::travel::BackgroundDomain;
use crate::cloud::{Cloud, CloudError, Operators};
use crate::math::Vector;
use crate::math::sweep::{first, maximum, sweep, sweep_each, sweep_parts};
use crate::motion::{BodyMotion, RigidPose};
use crate::physics::{Gas, Primitive};
use crate::system::{Instant, Rate, Term};

/// Strength A of the shift.
const STRENGTH: f64 = 0.1;
/// Greatest shift velocity over the sound speed.
const FASTEST: f64 = 0.2;
/// Greatest shift in a step, in spacings.
const FARTHEST: f64 = 0.1;
/// Strength R of the term that keeps pairs apart.
const APART: f64 = 0.2;
/// Share of an interface particle in the concentration: the gas reaches around it on one side only.
const WALL_SHARE: f64 = 0.5;
/// Rate −h ∇·v/c of compression above which there is a shock.
const COMPRESSED: f64 = 0.1;
/// Neighbours of neighbours, that many times, that are near a shock as well.
const HOPS: usize = 3;
/// Part of the distance between two particles by which they may move relative to one another in a step.
const REACH: f64 = 0.5;
/// Distance, in mean spacings, by which neighbours may move relative to one another before lists are made anew.
const SLACK: f64 = 0.25;
/// How particles travel with the fluid.
#[derive(Clone)]
pub struct Travel<const D: usize> {
    /// What the cloud keeps.
    pub domain: Arc<BackgroundDomain<D>>,
    /// Motion of each body.
    pub laws: Vec<BodyMotion<D>>,
    /// Where particles are when this system takes over.
    pub kinematics: Arc<ParticleKinematics<D>>,
    /// Time at which the cloud was built.
    pub since: f64,
}

/// Where particles that travel are, and how they came there.
#[derive(Clone, Debug, Default)]
pub struct ParticleKinematics<const D: usize> {
    /// Time.
    pub now: f64,
    /// Places of fluid and interface particles.
    pub places: Vec<Vector<D>>,
    /// Their velocities, by the formula that serves the state; empty at the start.
    pub velocity: Vec<Vector<D>>,
    /// The straight course of fluid particles in the step before; empty at the start.
    pub course: Vec<Vector<D>>,
}

/// A fluid on its renewed cloud, with its state.
pub struct Reclouded<const D: usize> {
    /// Equations.
    pub fluid: Fluid<D>,
    /// State.
    pub u: Vec<f64>,
    /// States one and two steps ago, as far as they were known.
    pub past: [Vec<f64>; 2],
}

impl<const D: usize> Travel<D> {
    /// Poses of the bodies at time `t`.
    fn poses(&self, t: f64) -> Vec<RigidPose<D>> {
        self.laws.iter().map(|l| l.pose(t)).collect()
    }

    /// Brings `frame` to a moment. Fluid particles go from where the step began with the velocities they then chose.
    pub(super) fn place(&self, origin: &Arc<Discretisation<D>>, at: &Instant<'_>, frame: &mut Frame<D>) {
        let cloud = &origin.cloud;
        let (n, kinematics) = (cloud.n_fluid, &self.kinematics);
        if frame.lagrangian_step.base.len() != n {
            // to the bit what the system before, or a checkpoint, left
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
            // as if the step had never begun
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

    /// Interface particles stay on their bodies.
    fn place_walls(&self, at: &Instant<'_>, cloud: &mut Cloud<D>, velocity: &mut [Vector<D>]) {
        let (before, interface) = self.domain.walls();
        if self.laws.iter().all(BodyMotion::is_fixed) {
            return;
        }
        let (from, to, step, fraction) = match at.rate {
            Rate::Within { start, step, fraction } => (start, start + step, step, fraction),
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

    /// Surface vectors, spin and acceleration of the walls at time `t`.
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

impl<const D: usize> Fluid<D> {
    /// Chooses where particles go in the step that begins and is meant to last `step`; the longest step they can take.
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

    /// True when the cloud should be built anew: lists no longer hold what is near, or a row is sick.
    pub fn is_worn(&self, frame: &Frame<D>) -> bool {
        if !matches!(self.cloud_motion, CloudMotion::Travel(_)) {
            return false;
        }
        let (then, now) = (&self.discretisation.cloud, &frame.discretisation.cloud);
        let sick = |i: usize| {
            let well = frame.discretisation.operators.condition[i] < WORST_CONDITION;
            !well && then.first_order.binary_search(&(i as u32)).is_err()
        };
        let operators = &self.discretisation.operators;
        // a cloud just built is as good as it gets
        let moved = |i: usize| f64::from(u8::from(now.x[i] != then.x[i]));
        let mut apart = vec![false; operators.fluid_parts().len()];
        sweep_each(&mut apart, |k| {
            operators.edges(k).iter().any(|e| {
                let (i, j) = (e.i(), e.j());
                let d = (now.x[j] - now.x[i]) - (then.x[j] - then.x[i]);
                let slack = 0.5 * SLACK * (then.spacing[i] + then.spacing[j]);
                // positions that are no numbers count as apart
                !(d.norm_squared() <= slack * slack)
            })
        });
        apart.contains(&true) || first(then.n_fluid, sick).is_some() && maximum(then.n_fluid, moved) > 0.0
    }

    /// The same equations on a cloud built anew where particles are in `frame`, and the state `u` on it.
    pub fn reclouded(
        &self,
        frame: &Frame<D>,
        (u, past): (&[f64], [&[f64]; 2]),
        work: &mut Work<D>,
        ledger: &mut RemapLedger,
    ) -> Result<Option<Reclouded<D>>, CloudError> {
        let CloudMotion::Travel(travel) = &self.cloud_motion else { return Ok(None) };
        self.fill_states(frame, u, work);
        let old = &frame.discretisation.cloud;
        let recloud = travel.domain.recloud(&travel.poses(frame.time), old)?;
        let transfer = Transfer { fluid: self, old, work, recloud: &recloud, before: u };
        let state = transfer.state(ledger)?;
        let lines = transfer.lines();
        let past = past.map(|p| transfer.past(p, &state, &lines));
        let walls = old.interface_range().map(|w| frame.velocity_of(w));
        let velocity = transfer.directions(&frame.velocity, &lines).into_iter().chain(walls).collect();
        let course = transfer.directions(&frame.lagrangian_step.course, &lines);
        let places = recloud.cloud.x[..recloud.cloud.n_rows()].to_vec();
        let kinematics = ParticleKinematics { now: frame.time, places, velocity, course };
        let fluid = self.on(recloud.cloud, frame.time, kinematics);
        Ok(Some(Reclouded { fluid, u: state, past }))
    }

    /// The same equations on a cloud whose lists are those of the fluid particles at `lists` at time `since`, or on this cloud
    /// without them, while fluid and interface particles are at certain places now and went there with certain velocities:
    /// what a checkpoint keeps.
    pub fn resumed(
        &self,
        lists: Option<(&[Vector<D>], f64)>,
        kinematics: ParticleKinematics<D>,
    ) -> Result<Option<Self>, CloudError> {
        let CloudMotion::Travel(travel) = &self.cloud_motion else { return Ok(None) };
        let Some((lists, since)) = lists else { return Ok(Some(self.moved(kinematics))) };
        let (cloud, _) = travel.domain.cloud(&travel.poses(since), lists)?;
        Ok(Some(self.on(cloud, since, kinematics)))
    }

    /// Time at which this system takes over from the one before.
    pub fn stood(&self) -> f64 {
        match &self.cloud_motion {
            CloudMotion::Travel(travel) => travel.kinematics.now,
            _ => 0.0,
        }
    }

    /// Interface particles before any motion.
    pub fn walls_before(&self) -> &[Vector<D>] {
        match &self.cloud_motion {
            CloudMotion::Travel(travel) => travel.domain.walls().0,
            _ => {
                let cloud = &self.discretisation.cloud;
                &cloud.x[cloud.interface_range()]
            }
        }
    }

    /// Volumes for totals and means: where particles travel, the part of the domain that is nearest to each.
    pub fn volumes(&self) -> Vec<f64> {
        self.volumes_of(&self.discretisation.cloud)
    }

    /// The same of particles that stand as in `cloud`.
    pub(super) fn volumes_of(&self, cloud: &Cloud<D>) -> Vec<f64> {
        match &self.cloud_motion {
            CloudMotion::Travel(travel) => travel.domain.volumes(&travel.poses(travel.since), cloud),
            _ => cloud.volume[..cloud.n_fluid].to_vec(),
        }
    }

    /// Writes these volumes into the cloud, for those who look at it when the march is over.
    pub fn measure(&mut self) {
        let volumes = self.volumes();
        let n = volumes.len();
        Arc::make_mut(&mut self.discretisation).cloud.volume[..n].copy_from_slice(&volumes);
    }

    fn on(&self, cloud: Cloud<D>, since: f64, kinematics: ParticleKinematics<D>) -> Self {
        let operators = Operators::new(&cloud);
        let fields = Self::unknowns(&cloud);
        let discretisation = Arc::new(Discretisation::new(cloud, operators));
        let mut other = Self { fields, discretisation, ..self.moved(kinematics) };
        if let CloudMotion::Travel(travel) = &mut other.cloud_motion {
            travel.since = since;
        }
        other
    }

    /// The same equations on the same cloud, with the particles elsewhere.
    fn moved(&self, kinematics: ParticleKinematics<D>) -> Self {
        let CloudMotion::Travel(travel) = &self.cloud_motion else { return self.copy() };
        Self {
            cloud_motion: CloudMotion::Travel(Travel { kinematics: Arc::new(kinematics), ..travel.clone() }),
            ..self.copy()
        }
    }

    fn copy(&self) -> Self {
        Self {
            discretisation: Arc::clone(&self.discretisation),
            cloud_motion: self.cloud_motion.clone(),
            viscous_model: self.viscous_model.clone(),
            far_field: Arc::clone(&self.far_field),
            held: Arc::clone(&self.held),
            ..*self
        }
    }
}

/// Velocities of a difference formula for particles that went straight, in this step and in the one before.
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

/// Brings images to the velocities of their sources.
fn set_ghost_velocities<const D: usize>(cloud: &Cloud<D>, velocity: &mut [Vector<D>]) {
    let (own, ghosts) = velocity.split_at_mut(cloud.n_real());
    sweep(ghosts, |k| {
        let image = &cloud.ghosts[k];
        cloud.transforms[image.transform as usize].direction(&own[image.source as usize])
    });
}

/// The time in which no two particles that see one another move relative to one another by more than the part [`REACH`] of
/// their distance.
fn reach<const D: usize>(discretisation: &Discretisation<D>, velocity: &[Vector<D>]) -> f64 {
    let (x, op) = (&discretisation.cloud.x, &discretisation.operators);
    let mut fastest = vec![0.0; op.fluid_parts().len()];
    sweep_each(&mut fastest, |k| {
        let rate = |i: usize, j: usize| (velocity[i] - velocity[j]).norm() / (x[i] - x[j]).norm();
        op.edges(k).iter().map(|e| rate(e.i(), e.j())).fold(0.0, f64::max)
    });
    REACH / fastest.iter().fold(f64::MIN_POSITIVE, |m: f64, r| m.max(*r))
}

/// Sums over the neighbours of a particle.
#[derive(Clone, Copy)]
struct Around<const D: usize> {
    /// −Σ_j ω_j f(q_ij) d_ij/|d_ij|: away from where particles are dense.
    shift: Vector<D>,
    /// Σ_j (v_i − v_j)·d_ij/|d_ij|².
    approach: f64,
}

/// What particles find around them; the two ends of an edge find the same, or its opposite.
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

/// f(q) of the shift.
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

    /// f at a distance of `r` mean spacings.
    #[inline(always)]
    fn at(&self, r: f64) -> f64 {
        let q = (r / self.radius).min(1.0);
        let apart = 1.0 + APART * (Self::kernel(q) * self.kernel_scale).powi(4);
        apart * Self::slope(q) * self.slope_scale
    }
}

/// True for particles near a shock: where the gas is compressed hard, and a few neighbours around; empty when there is none.
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
