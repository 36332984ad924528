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
//! clouds and is never faster than 0.2 c.
//!
//! *Shocks.* The flux past a particle is taken with its own velocity, which makes linear fields exact; where w and U jump
//! together, what one particle loses another does not gain: Σ (w_ij − w_i)·s_ij (U_i − U_ij) is left over, and a shock
//! runs at a wrong speed (3 % in Sod's tube). Particles therefore keep the velocity of their last step, and are not shifted,
//! while the gas around them is compressed at a rate −h ∇·v > 0.1 c, or has been three neighbours away: w jumps behind
//! the shock, where U no longer does, and the shock stays within a fraction of a spacing.
//!
//! *Re-clouding.* The lists of neighbours serve until two particles that see one another have moved apart or together by a
//! quarter of their spacing, or a row of the cloud gets sick. Then the cloud is built anew where the particles are
//! ([`crate::cloud::travel`]). Particles that stay keep their state; one that is inserted gets it by a least-squares fit of
//! second degree through those around it, of the conserved quantities, held within the values it is fitted to. Linear fields are
//! transferred exactly. A particle that is inserted takes its volume from those around it in the proportions of its fit, one
//! that is removed leaves its volume to them: what is lost is V (fit − U) of each removed particle, which is added up.
use std::sync::Arc;

use super::boundary::WallFits;
use super::boundary::WallMotion;
use super::fluid::{Fluid, Work};
use super::shape::{Carriage, Frame, Shape, rotation_rate};
use crate::cloud::repair::WORST_CONDITION;
use crate::cloud::travel::{Habitat, NEW, Renewal};
use crate::cloud::{Cloud, CloudError, Operators};
use crate::math::Vector;
use crate::math::least_squares::Fit;
use crate::math::sweep::{first, maximum, sweep, sweep_each, sweep_parts, sweep_slots};
use crate::motion::{Law, RigidPose};
use crate::physics::{Conserved, Gas, Primitive};
use crate::system::{Moment, System};

/// Strength A of the shift.
const STRENGTH: f64 = 0.1;
/// Greatest shift velocity over the sound speed.
const FASTEST: f64 = 0.2;
/// Strength R of the term that keeps pairs apart.
const APART: f64 = 0.2;
/// Share of an interface particle in the concentration: the gas reaches around it on one side only.
const WALL_SHARE: f64 = 0.5;
/// Rate −h ∇·v/c of compression above which there is a shock.
const COMPRESSED: f64 = 0.1;
/// Neighbours of neighbours, that many times, that are near a shock as well.
const HOPS: usize = 3;
/// Greatest distance, in spacings, that a particle goes in a step.
const REACH: f64 = 0.5;
/// Distance, in mean spacings, by which neighbours may move relative to one another before lists are made anew.
const SLACK: f64 = 0.25;
/// Sum of absolute weights above which a fit of a state is replaced by one of lower degree.
const LARGEST_AMPLIFICATION: f64 = 3.0;
/// Rows that a fit of second degree must have beyond its coefficients.
const SPARE_ROWS: usize = 2;
/// Part of the range of the values a state is fitted to by which it may lie outside of it: beside a smooth extremum, a
/// parabola passes the nearest values by an eighth of the range over three spacings.
const MARGIN: f64 = 0.3;

/// How particles travel with the fluid.
#[derive(Clone)]
pub struct Travel<const D: usize> {
    /// What the cloud keeps.
    pub habitat: Arc<Habitat<D>>,
    /// Motion of each body.
    pub laws: Vec<Law<D>>,
    /// Time at which this system takes over.
    pub now: f64,
    /// Where fluid and interface particles are then.
    pub places: Arc<Vec<Vector<D>>>,
    /// Their velocities in the step before; empty at the start.
    pub ways: Arc<Vec<Vector<D>>>,
    /// Time at which the cloud was built.
    pub since: f64,
}

/// What re-clouding has done so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Turnover {
    /// Times the cloud was built anew.
    pub renewals: u32,
    /// Particles inserted.
    pub inserted: u64,
    /// Particles removed.
    pub removed: u64,
    /// What that took from the totals of the conserved quantities.
    pub lost: Vec<f64>,
    /// The same without regard to sign.
    pub exchanged: Vec<f64>,
    /// Largest number of rows of first order in a cloud.
    pub first_order: u32,
}

/// A fluid on its renewed cloud, with its state.
pub struct Renewed<const D: usize> {
    /// Equations.
    pub fluid: Fluid<D>,
    /// State.
    pub u: Vec<f64>,
}

impl<const D: usize> Travel<D> {
    /// Poses of the bodies at time `t`.
    fn poses(&self, t: f64) -> Vec<RigidPose<D>> {
        self.laws.iter().map(|l| l.pose(t)).collect()
    }

    /// Brings `frame` to a moment. Fluid particles go from where the step began with the velocities they then chose.
    pub(super) fn place(&self, origin: &Arc<Shape<D>>, moment: &Moment<'_>, frame: &mut Frame<D>) {
        let cloud = &origin.cloud;
        let n = cloud.n_fluid;
        let fresh = frame.base.len() != n;
        let velocity = Arc::make_mut(&mut frame.velocity);
        velocity.resize(cloud.len(), Vector::ZERO);
        if fresh {
            // to the bit what the system before, or a checkpoint, left
            frame.base = Arc::new(self.places[..n].to_vec());
            frame.time = self.now;
            velocity[..self.ways.len()].copy_from_slice(&self.ways);
        }
        let shape = Arc::make_mut(&mut frame.shape);
        let passed = match moment {
            Moment::Within { step, fraction, .. } if !fresh => fraction * step,
            _ => 0.0,
        };
        let (base, w) = (&frame.base, &*velocity);
        let fixed = self.laws.iter().all(Law::is_fixed);
        let away = maximum(n, |i| (base[i] + w[i] * passed - shape.cloud.x[i]).max_abs());
        if fixed && away == 0.0 && frame.walls.len() == cloud.interface.len() {
            return;
        }
        sweep(&mut shape.cloud.x[..n], |i| base[i] + w[i] * passed);
        match fresh {
            true => shape.cloud.x[n..self.places.len()].copy_from_slice(&self.places[n..]),
            false => self.place_walls(moment, &mut shape.cloud, velocity),
        }
        let first = cloud.n_real();
        let image = |k: usize| (&cloud.transforms[cloud.images[k].transform as usize], cloud.images[k].source as usize);
        let (x, x_images) = shape.cloud.x.split_at_mut(first);
        sweep(x_images, |k| image(k).0.point(&x[image(k).1]));
        let (w, w_images) = velocity.split_at_mut(first);
        sweep(w_images, |k| image(k).0.direction(&w[image(k).1]));
        self.turn_walls(frame.time, frame);
        let shape = Arc::make_mut(&mut frame.shape);
        shape.operators.refit(&shape.cloud);
        shape.walls = WallFits::new(&shape.cloud);
    }

    /// Interface particles stay on their bodies.
    fn place_walls(&self, moment: &Moment<'_>, cloud: &mut Cloud<D>, velocity: &mut [Vector<D>]) {
        let (before, interface) = self.habitat.walls();
        if self.laws.iter().all(Law::is_fixed) {
            return;
        }
        let (from, to, step, fraction) = match moment {
            Moment::Within { start, step, fraction } => (*start, start + step, *step, *fraction),
            Moment::At { time } | Moment::By { time, .. } => (*time, *time, 1.0, 0.0),
        };
        let (from, to) = (self.poses(from), self.poses(to));
        for (k, (x, wall)) in before.iter().zip(interface).enumerate() {
            let (i, body) = (cloud.n_fluid + k, usize::from(wall.body));
            let Some((from, to)) = from.get(body).zip(to.get(body)) else { continue };
            velocity[i] = (to.point(x) - from.point(x)) * (1.0 / step);
            cloud.x[i] = from.point(x) + velocity[i] * (fraction * step);
        }
    }

    /// Surface vectors, spin and acceleration of the walls at time `t`.
    fn turn_walls(&self, t: f64, frame: &mut Frame<D>) {
        let (before, interface) = self.habitat.walls();
        let walls = Arc::make_mut(&mut frame.walls);
        walls.resize(interface.len(), WallMotion::AT_REST);
        if self.laws.iter().all(Law::is_fixed) {
            return;
        }
        let cloud = &mut Arc::make_mut(&mut frame.shape).cloud;
        let rates: Vec<[Vector<D>; D]> = self.laws.iter().map(|l| rotation_rate(l, t)).collect();
        let poses = self.poses(t);
        for (k, (x, wall)) in before.iter().zip(interface).enumerate() {
            let body = usize::from(wall.body);
            let Some(law) = self.laws.get(body) else { continue };
            cloud.interface[k] = *wall;
            cloud.interface[k].turn(&poses[body].rotation);
            walls[k] = WallMotion { spin: rates[body], acceleration: law.kinematics(t, x).acceleration };
        }
    }
}

impl<const D: usize> Fluid<D> {
    /// Chooses where particles go in the step that begins; the longest step they can take.
    pub(super) fn choose_ways(&self, u: &[f64], work: &mut Work<D>, frame: &mut Frame<D>) -> f64 {
        self.fill_states(frame, u, work);
        let cloud = &frame.shape.cloud;
        let n = cloud.n_fluid;
        let radius = match &self.carriage {
            Carriage::Travel(travel) => travel.habitat.radius(),
            _ => return f64::INFINITY,
        };
        frame.base = Arc::new(cloud.x[..n].to_vec());
        let known = frame.moves();
        let velocity = Arc::make_mut(&mut frame.velocity);
        velocity.resize(cloud.len(), Vector::ZERO);
        let state = &work.state;
        let around = around(&frame.shape, state, radius);
        let near = shocked(cloud, &self.gas, (state, &around));
        sweep_slots(&mut velocity[..n], |i, w| {
            if known && near.get(i).is_some_and(|near| *near) {
                return;
            }
            let c = self.gas.sound_speed(&state[i]);
            let shift = around[i].shift * STRENGTH;
            let size = shift.norm();
            *w = state[i].velocity + shift * (c * if size > FASTEST { FASTEST / size } else { 1.0 });
        });
        let fastest = maximum(n, |i| velocity[i].norm() / cloud.spacing[i]);
        REACH / fastest.max(f64::MIN_POSITIVE)
    }

    /// True when the cloud should be built anew: lists no longer hold what is near, or a row is sick.
    pub fn is_worn(&self, frame: &Frame<D>) -> bool {
        if !matches!(self.carriage, Carriage::Travel(_)) {
            return false;
        }
        let (then, now) = (&self.shape.cloud, &frame.shape.cloud);
        let sick = |i: usize| {
            let well = frame.shape.operators.condition[i] < WORST_CONDITION;
            !well && then.first_order.binary_search(&(i as u32)).is_err()
        };
        let operators = &self.shape.operators;
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
    pub fn renewed(
        &self,
        frame: &Frame<D>,
        u: &[f64],
        work: &mut Work<D>,
        turnover: &mut Turnover,
    ) -> Result<Option<Renewed<D>>, CloudError> {
        let Carriage::Travel(travel) = &self.carriage else { return Ok(None) };
        self.fill_states(frame, u, work);
        let old = &frame.shape.cloud;
        let renewal = travel.habitat.renew(&travel.poses(frame.time), old)?;
        let u = Transfer { fluid: self, old, work, renewal: &renewal, before: u }.state(turnover)?;
        let gas = |i: usize| self.gas.primitive(&Conserved::load(&u[i * (D + 2)..])).velocity;
        let way = |(i, k): (usize, &u32)| frame.velocity.get(*k as usize).copied().unwrap_or_else(|| gas(i));
        let walls = old.interface_range().map(|w| frame.velocity_of(w));
        let ways = renewal.from.iter().enumerate().map(way).chain(walls).collect();
        let places = renewal.cloud.x[..renewal.cloud.n_rows()].to_vec();
        let fluid = self.on(renewal.cloud, frame.time, (frame.time, places, ways));
        Ok(Some(Renewed { fluid, u }))
    }

    /// The same equations on a cloud whose lists are those of the fluid particles at `lists` at time `since`, or on this cloud
    /// without them, while fluid and interface particles are at certain places now and went there with certain velocities:
    /// what a checkpoint keeps.
    pub fn resumed(
        &self,
        lists: Option<(&[Vector<D>], f64)>,
        now: (f64, Vec<Vector<D>>, Vec<Vector<D>>),
    ) -> Result<Option<Self>, CloudError> {
        let Carriage::Travel(travel) = &self.carriage else { return Ok(None) };
        let Some((lists, since)) = lists else { return Ok(Some(self.moved(now))) };
        let (cloud, _) = travel.habitat.cloud(&travel.poses(since), lists)?;
        Ok(Some(self.on(cloud, since, now)))
    }

    /// The frame at the end of a step that led to `time`.
    pub fn frame_after(&self, time: f64, step: f64, u: &[f64]) -> Frame<D> {
        let moment = match step > 0.0 {
            true => Moment::Within { start: time - step, step, fraction: 1.0 },
            false => Moment::At { time },
        };
        self.frame(&moment, u)
    }

    /// Interface particles before any motion.
    pub fn walls_before(&self) -> &[Vector<D>] {
        match &self.carriage {
            Carriage::Travel(travel) => travel.habitat.walls().0,
            _ => {
                let cloud = &self.reference().cloud;
                &cloud.x[cloud.interface_range()]
            }
        }
    }

    /// Volumes for totals and means: where particles travel, the part of the domain that is nearest to each.
    pub fn volumes(&self) -> Vec<f64> {
        let cloud = &self.shape.cloud;
        match &self.carriage {
            Carriage::Travel(travel) => travel.habitat.volumes(&travel.poses(travel.since), cloud),
            _ => cloud.volume[..cloud.n_fluid].to_vec(),
        }
    }

    /// Writes these volumes into the cloud, for those who look at it when the march is over.
    pub fn measure(&mut self) {
        let volumes = self.volumes();
        let n = volumes.len();
        Arc::make_mut(&mut self.shape).cloud.volume[..n].copy_from_slice(&volumes);
    }

    fn on(&self, cloud: Cloud<D>, since: f64, now: (f64, Vec<Vector<D>>, Vec<Vector<D>>)) -> Self {
        let operators = Operators::new(&cloud);
        let mut other = Self { shape: Arc::new(Shape::new(cloud, operators)), ..self.moved(now) };
        if let Carriage::Travel(travel) = &mut other.carriage {
            travel.since = since;
        }
        other
    }

    /// The same equations on the same cloud, with the particles elsewhere.
    fn moved(&self, (now, places, ways): (f64, Vec<Vector<D>>, Vec<Vector<D>>)) -> Self {
        let Carriage::Travel(travel) = &self.carriage else { return self.copy() };
        let (places, ways) = (Arc::new(places), Arc::new(ways));
        Self { carriage: Carriage::Travel(Travel { now, places, ways, ..travel.clone() }), ..self.copy() }
    }

    fn copy(&self) -> Self {
        Self {
            shape: Arc::clone(&self.shape),
            carriage: self.carriage.clone(),
            before: self.before.clone(),
            friction: self.friction.clone(),
            far_field: Arc::clone(&self.far_field),
            held: Arc::clone(&self.held),
            ..*self
        }
    }
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
fn around<const D: usize>(shape: &Shape<D>, state: &[Primitive<D>], radius: f64) -> Vec<Around<D>> {
    let (cloud, op) = (&shape.cloud, &shape.operators);
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

/// The state on a renewed cloud.
struct Transfer<'a, const D: usize> {
    fluid: &'a Fluid<D>,
    old: &'a Cloud<D>,
    work: &'a Work<D>,
    renewal: &'a Renewal<D>,
    before: &'a [f64],
}

/// A place and a state nearby.
type Sample<const D: usize> = (Vector<D>, Conserved<D>);

impl<const D: usize> Transfer<'_, D> {
    fn state(&self, turnover: &mut Turnover) -> Result<Vec<f64>, CloudError> {
        let cloud = &self.renewal.cloud;
        let n = D + 2;
        let mut u = vec![0.0; n * cloud.n_fluid];
        let from = &self.renewal.from;
        crate::math::sweep::sweep_rows(&mut u, n, |i, row| match from[i] {
            NEW => row.fill(f64::NAN),
            k => row.copy_from_slice(&self.before[k as usize * n..(k as usize + 1) * n]),
        });
        let mut inserted = 0;
        for i in (0..cloud.n_fluid).filter(|i| from[*i] == NEW) {
            let value = self.fitted(&self.around_new(i), cloud.spacing[i]).ok_or_else(|| {
                let problem = format!("nothing is near particle {i} at {:?}, which fills a hole", cloud.x[i].0);
                CloudError::Quality(vec![problem])
            })?;
            value.store(&mut u[i * n..(i + 1) * n]);
            inserted += 1;
        }
        self.count(inserted, turnover);
        Ok(u)
    }

    /// Adds to the account of what was done.
    fn count(&self, inserted: u64, turnover: &mut Turnover) {
        let n = D + 2;
        turnover.renewals += 1;
        turnover.inserted += inserted;
        turnover.removed += self.renewal.removed.len() as u64;
        turnover.lost.resize(n, 0.0);
        turnover.exchanged.resize(n, 0.0);
        turnover.first_order = turnover.first_order.max(self.renewal.cloud.first_order.len() as u32);
        for i in &self.renewal.removed {
            let i = *i as usize;
            let Some(fit) = self.fitted(&self.around_removed(i), self.old.spacing[i]) else { continue };
            let volume = self.old.spacing[i].powi(D as i32);
            let mut row = vec![0.0; n];
            fit.plus(-1.0, &Conserved::load(&self.before[i * n..])).store(&mut row);
            for (c, r) in row.iter().enumerate() {
                turnover.lost[c] += volume * r;
                turnover.exchanged[c] += (volume * r).abs();
            }
        }
    }

    /// Neighbours of a new particle, and theirs, that were there before.
    fn around_new(&self, i: usize) -> Vec<Sample<D>> {
        let cloud = &self.renewal.cloud;
        let own = cloud.neighbours.of(i);
        let rows = own.iter().filter(|j| (**j as usize) < cloud.n_rows());
        let mut list: Vec<u32> = rows.flat_map(|j| cloud.neighbours.of(*j as usize)).chain(own).copied().collect();
        list.sort_unstable();
        list.dedup();
        list.into_iter().filter_map(|j| Some((cloud.x[j as usize] - cloud.x[i], self.known(j as usize)?))).collect()
    }

    /// State of particle `j` of the new cloud, if it was there before.
    fn known(&self, j: usize) -> Option<Conserved<D>> {
        let (cloud, old) = (&self.renewal.cloud, self.old);
        let source = cloud.source(j).index;
        let before = match self.renewal.from.get(source) {
            Some(&NEW) => return None,
            Some(k) => *k as usize,
            None => source - cloud.n_fluid + old.n_fluid,
        };
        let mut q = self.work.state[before];
        if let Some(image) = j.checked_sub(cloud.n_real()).map(|k| cloud.images[k]) {
            q.velocity = cloud.transforms[image.transform as usize].direction(&q.velocity);
        }
        Some(self.fluid.gas.conserved(&q))
    }

    /// Neighbours of a removed particle that stay.
    fn around_removed(&self, i: usize) -> Vec<Sample<D>> {
        let stays =
            |j: &&u32| self.renewal.removed.binary_search(&(self.old.source(**j as usize).index as u32)).is_err();
        let row = self.old.neighbours.of(i).iter().filter(stays);
        row.map(|j| {
            let j = *j as usize;
            (self.old.x[j] - self.old.x[i], self.fluid.gas.conserved(&self.work.state[j]))
        })
        .collect()
    }

    /// Value at the middle of the samples; `None` without any.
    fn fitted(&self, samples: &[Sample<D>], h: f64) -> Option<Conserved<D>> {
        let quadratic = 1 + D + D * (D + 1) / 2;
        let mut weights = Vec::new();
        for (degree, least) in [(quadratic, quadratic + SPARE_ROWS), (1 + D, D + 2), (1, 1)] {
            if samples.len() < least {
                continue;
            }
            weigh(samples, h, degree, &mut weights);
            let sum: f64 = weights.iter().sum();
            let size: f64 = weights.iter().map(|w| w.abs()).sum();
            let sound = (sum - 1.0).abs() < 1e-9 && size <= LARGEST_AMPLIFICATION;
            if !sound && degree > 1 {
                continue;
            }
            // differences from the nearest sample keep a uniform state to the last bit
            let nearest = samples.iter().min_by(|a, b| a.0.norm_squared().total_cmp(&b.0.norm_squared()))?.1;
            let fit = samples.iter().zip(&weights).fold(nearest, |s, ((_, u), w)| s.plus(*w, &u.plus(-1.0, &nearest)));
            if degree == 1 || self.is_within(&fit, samples) {
                return Some(fit);
            }
        }
        None
    }

    /// True when density and pressure lie within those of the samples, or nearly so.
    fn is_within(&self, u: &Conserved<D>, samples: &[Sample<D>]) -> bool {
        let gas = &self.fluid.gas;
        let of = |u: &Conserved<D>| {
            let q = gas.primitive(u);
            [q.density, q.pressure]
        };
        let all: Vec<[f64; 2]> = samples.iter().map(|s| of(&s.1)).collect();
        let found = of(u);
        (0..2).all(|k| {
            let (low, high) = all.iter().fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(v[k]), h.max(v[k])));
            let slack = MARGIN * (high - low);
            // round-off of a uniform state
            let slack = slack.max(1e-12 * high);
            found[k] > 0.0 && low - slack <= found[k] && found[k] <= high + slack
        })
    }
}

/// Weights of the value at the middle of the samples, by a fit with `degree` coefficients.
fn weigh<const D: usize>(samples: &[Sample<D>], h: f64, degree: usize, weights: &mut Vec<f64>) {
    let mut fit = Fit::default();
    fit.reset(degree);
    for (d, _) in samples {
        let x = *d * (1.0 / h);
        let mut basis = vec![1.0];
        basis.extend(x.0);
        basis.extend((0..D).flat_map(|r| (r..D).map(move |c| (r, c))).map(|(r, c)| x[r] * x[c]));
        fit.push(&basis[..degree], 1.0 / x.norm_squared().max(f64::MIN_POSITIVE));
    }
    fit.row_of_inverse(0, weights);
}
