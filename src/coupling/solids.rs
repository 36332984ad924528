//! Bodies made of particles in a gas.
//!
//! Their unknowns are displacements u and velocities v of all particles, in pairs, so that they place the cloud as any other coordinates
//! do. Of the gas they know pressure and friction on interface particles, which a fit through the nearest solid particles
//! carries (`motion::surface_net`): x = X + Σ W u, and by virtual work f = Wᵀ F, so that what the gas loses the solid gains, in
//! force and in power, to round-off.
//!
//! In time u' = v and M v' = f_int(u, v) + Wᵀ F. In a steady flow there is no time for inertia: u goes to where both are at rest,
//! u' = ω K₀⁻¹ (f_int + Wᵀ F), with the stiffness K₀ at rest and the rate ω of sound across the body. Particles that supports hold, or lead
//! on a prescribed motion h(t), are there at any time: they are put there where a solve begins, and R = ∂u/∂t + ω (h − u) with ∂/∂t by the
//! formula that serves the state keeps them.
//!
//! The structure keeps the units of its case; forces and times are brought to those of the gas here.
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use crate::math::Vector;
use crate::math::jet::Jet;
use crate::math::parallel::sweep_slots;
use crate::math::reduce::sum;
use crate::math::sparse::Factors;
use crate::motion::{BodyMotion, RigidPose, SurfaceNet};
use crate::scheme::Fluid;
use crate::solid::Structure;
use crate::solid::forces::{Energy, State, Work as SolidWork};
use crate::system::{Fault, Mechanical, Moment};

/// Part of the time in which sound crosses a body over which motions of supports are differenced.
const INSTANT: f64 = 1e-6;

/// Units of a case in those of the gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// a∞: a velocity of the case over that of the gas.
    pub speed: f64,
    /// ρ∞ a∞²: a pressure, or a force over an area, likewise.
    pub pressure: f64,
}

/// A body made of particles among those of the case.
#[derive(Clone, Debug)]
pub struct SolidBody<const D: usize> {
    /// Number of the body.
    pub body: usize,
    /// Its particles.
    pub particles: Range<usize>,
    /// Its surface, whose nodes are the first of them.
    pub net: Arc<SurfaceNet<D>>,
    /// What leads particles that are held; `None` where they stay.
    pub lead: Option<BodyMotion<D>>,
    /// Particles whose displacements are told.
    pub probes: Vec<usize>,
}

/// All bodies made of particles, whatever the cloud.
pub struct Solids<const D: usize> {
    /// Their particles.
    pub structure: Structure<D>,
    /// The bodies.
    pub bodies: Vec<SolidBody<D>>,
    /// Units.
    pub scales: Scales,
    /// Rate of what goes to rest, in units of the gas: that of sound across the bodies.
    pub omega: f64,
    /// Rate of what moves in time: between that and the highest frequency of the particles, so that the first iterations for a
    /// periodic motion leave the bodies about where they are, and later ones do not.
    pub brisk: f64,
    /// Greatest displacement in one iteration.
    pub length: f64,
    /// Velocities at the start, in units of the gas.
    pub velocity: Vec<[f64; D]>,
    /// Number of coordinates of other structures, which come before.
    pub first: usize,
    reference: OnceLock<Option<Factors>>,
}

/// How an interface particle goes with particles of a solid.
pub struct OnWall<const D: usize> {
    /// Number of the interface particle.
    pub wall: usize,
    /// Particles of the solid and their part.
    pub parts: Vec<(u32, [[f64; D]; D])>,
}

/// Bodies made of particles on a cloud.
pub struct OnCloud<const D: usize> {
    /// The bodies.
    pub solids: Arc<Solids<D>>,
    /// Their interface particles.
    pub walls: Vec<OnWall<D>>,
    /// Particles that carry these, rising.
    pub surface: Vec<u32>,
}

/// Storage of an evaluation.
pub struct Work<const D: usize> {
    pub(super) solid: SolidWork<D>,
    pub(super) displacement: Vec<[f64; D]>,
    pub(super) velocity: Vec<[f64; D]>,
    pub(super) force: Vec<[f64; D]>,
    pub(super) led: Vec<[f64; D]>,
    pub(super) led_velocity: Vec<[f64; D]>,
    pub(super) history: Vec<f64>,
    pub(super) after: Vec<f64>,
    /// Change of the velocity of each particle in part of a step, and velocity before.
    pub(super) change: Vec<Vector<D>>,
    pub(super) before: Vec<Vector<D>>,
    /// Force of the gas on each particle, in its units.
    pub(super) load: Vec<Vector<D>>,
}

/// What the rates of the unknowns are sought for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// Held where they begin.
    Held,
    /// On the way to rest.
    Steady,
    /// In time.
    Marching,
}

/// The moment that rates are sought for.
#[derive(Clone, Copy)]
pub(super) struct Moving<'a> {
    /// Time of the gas.
    pub(super) time: f64,
    /// Length of the step that ends there, and that materials take in; 0 where there is none.
    pub(super) step: f64,
    /// The coordinates by the formula that serves the state.
    pub(super) jets: &'a [Jet],
    /// What for.
    pub(super) pace: Pace,
}

impl<const D: usize> SolidBody<D> {
    /// What leads it from time 0 to the time `t`.
    pub(super) fn led(&self, t: f64) -> RigidPose<D> {
        self.lead.as_ref().map_or_else(RigidPose::identity, |lead| lead.pose(t).relative_to(&lead.pose(0.0)))
    }
}

impl<const D: usize> Solids<D> {
    /// The bodies `bodies` of `structure`; `first` is the number of coordinates of other structures.
    pub fn new(structure: Structure<D>, bodies: Vec<SolidBody<D>>, scales: Scales, first: usize) -> Self {
        let extent = |b: &SolidBody<D>| crate::math::Bounds::around(b.net.places()).extent().max_abs();
        let length = bodies.iter().map(extent).fold(f64::MIN_POSITIVE, f64::max);
        let velocity = vec![[0.0; D]; structure.solid.len()];
        let omega = 1.0 / length;
        let still = vec![[0.0; D]; structure.solid.len()];
        let brisk = omega.max((omega / (structure.solid.undamped_step(&still) * scales.speed)).sqrt());
        Self { structure, bodies, scales, omega, brisk, length, velocity, first, reference: OnceLock::new() }
    }

    /// The same with velocities at the start, in units of the case.
    pub fn with_velocity(mut self, velocity: &[[f64; D]]) -> Self {
        self.velocity = velocity.iter().map(|v| v.map(|v| v / self.scales.speed)).collect();
        // what is held has the velocity of what holds it
        let mut led = vec![[0.0; D]; self.len()];
        self.hold_velocity(0.0, &mut led);
        let solid = &self.structure.solid;
        for body in &self.bodies {
            for i in body.particles.clone() {
                for a in 0..D {
                    match solid.is_held(i, a) {
                        true => self.velocity[i][a] = led[i][a],
                        // what is not held goes with what leads the body, and has its own velocity besides
                        false if body.lead.is_some() => self.velocity[i][a] += led[i][a],
                        false => {}
                    }
                }
            }
        }
        self
    }

    /// Velocities of what is held at the time `t` of the gas.
    pub(super) fn hold_velocity(&self, t: f64, velocity: &mut [[f64; D]]) {
        let solid = &self.structure.solid;
        if solid.is_moved() {
            let at = |part: f64| {
                let mut at = vec![[0.0; D]; self.len()];
                solid.hold((t + part / self.omega) / self.scales.speed, &mut at);
                at
            };
            let [before, after] = [at(-INSTANT), at(INSTANT)];
            for (v, (before, after)) in velocity.iter_mut().zip(before.iter().zip(&after)) {
                *v = std::array::from_fn(|a| (after[a] - before[a]) * self.omega / (2.0 * INSTANT));
            }
        } else {
            velocity.fill([0.0; D]);
        }
        for body in &self.bodies {
            let Some(lead) = &body.lead else { continue };
            for i in body.particles.clone() {
                velocity[i] = lead.velocity(t, &solid.particles.x[i]).0;
            }
        }
    }

    /// Puts what is held where it is to be at the time `t`.
    pub(super) fn prescribe(&self, t: f64, u: &mut [f64]) {
        let solid = &self.structure.solid;
        let [mut place, mut speed] = [(); 2].map(|()| vec![[0.0; D]; self.len()]);
        self.hold(t, &mut place);
        self.hold_velocity(t, &mut speed);
        for (i, row) in u.chunks_exact_mut(2 * D).enumerate() {
            for a in (0..D).filter(|a| solid.is_held(i, *a)) {
                (row[2 * a], row[2 * a + 1]) = (place[i][a], speed[i][a]);
            }
        }
    }

    /// Brings unknowns from one time to another: whole bodies go with what leads them, as deformed and as fast against it as they are.
    pub(super) fn lead(&self, from: f64, to: f64, u: &mut [f64]) {
        for body in &self.bodies {
            let Some(lead) = &body.lead else { continue };
            let (before, after) = (lead.pose(from), lead.pose(to));
            for i in body.particles.clone() {
                let x = &self.structure.solid.particles.x[i];
                let row = &mut u[2 * D * i..2 * D * (i + 1)];
                let now = after.point(&before.inverse_point(&(*x + Vector::from_fn(|a| row[2 * a]))));
                let past = Vector::from_fn(|a| row[2 * a + 1]) - lead.velocity(from, x);
                let speed = lead.velocity(to, x) + after.direction(&before.inverse_direction(&past));
                for a in 0..D {
                    (row[2 * a], row[2 * a + 1]) = (now[a] - x[a], speed[a]);
                }
            }
        }
        self.prescribe(to, u);
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.structure.solid.len()
    }

    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Mass of particle `i` in what a force of the gas over an acceleration in its units is.
    pub(super) fn mass(&self, i: usize) -> f64 {
        self.structure.solid.mass()[i] * self.scales.speed * self.scales.speed / self.scales.pressure
    }

    /// Unknowns at the start.
    pub(super) fn initial(&self) -> Vec<f64> {
        let mut u = vec![[0.0; D]; self.len()];
        for body in &self.bodies {
            let Some(lead) = &body.lead else { continue };
            for i in body.particles.clone() {
                let x = &self.structure.solid.particles.x[i];
                u[i] = (lead.kinematics(0.0, x).position - *x).0;
            }
        }
        self.hold(0.0, &mut u);
        let pair = |(i, a): (usize, usize)| [u[i][a], self.velocity[i][a]];
        (0..self.len()).flat_map(|i| (0..D).map(move |a| (i, a))).flat_map(pair).collect()
    }

    /// Puts what is held where it is to be at the time `t` of the gas.
    pub(super) fn hold(&self, t: f64, displacement: &mut [[f64; D]]) {
        let solid = &self.structure.solid;
        solid.hold(t / self.scales.speed, displacement);
        for body in &self.bodies {
            let Some(lead) = &body.lead else { continue };
            for i in body.particles.clone() {
                let x = &solid.particles.x[i];
                let moved = lead.kinematics(t, x).position - *x;
                for a in (0..D).filter(|a| solid.is_held(i, *a)) {
                    displacement[i][a] = moved[a];
                }
            }
        }
    }

    /// Fresh storage.
    pub(super) fn work(&self) -> Work<D> {
        let n = self.len();
        let zero = vec![[0.0; D]; n];
        let history = self.structure.solid.virgin();
        Work {
            solid: self.structure.solid.work(),
            displacement: zero.clone(),
            velocity: zero.clone(),
            force: zero.clone(),
            led: zero.clone(),
            led_velocity: zero,
            after: history.clone(),
            history,
            change: vec![Vector::ZERO; n],
            before: vec![Vector::ZERO; n],
            load: vec![Vector::ZERO; n],
        }
    }

    /// Displacements and velocities, in units of the case, of the unknowns `u`.
    pub(super) fn split(&self, u: &[f64], work: &mut Work<D>) {
        let speed = self.scales.speed;
        for (i, row) in u.chunks_exact(2 * D).enumerate() {
            for a in 0..D {
                work.displacement[i][a] = row[2 * a];
                work.velocity[i][a] = row[2 * a + 1] * speed;
            }
        }
    }

    /// Velocities, in units of the case, by the formula that serves the state.
    pub(super) fn by_formula(&self, jets: &[Jet], work: &mut Work<D>) {
        for (i, v) in work.velocity.iter_mut().enumerate() {
            for (a, v) in v.iter_mut().enumerate() {
                if let Some(jet) = jets.get(self.first + i * D + a) {
                    *v = jet.first * self.scales.speed;
                }
            }
        }
    }

    /// The state in `work` at the time `t` of the gas.
    pub(super) fn state<'a>(&self, t: f64, work: &'a Work<D>) -> State<'a, D> {
        State {
            time: t / self.scales.speed,
            step: 0.0,
            displacement: &work.displacement,
            velocity: &work.velocity,
            history: &work.history,
        }
    }

    /// Forces of neighbours, supports' loads and the gas on all particles at the state in `work`, in units of the case.
    pub(super) fn forces(&self, t: f64, step: f64, work: &mut Work<D>) {
        let solid = &self.structure.solid;
        let state = State {
            time: t / self.scales.speed,
            step: step / self.scales.speed,
            displacement: &work.displacement,
            velocity: &work.velocity,
            history: &work.history,
        };
        solid.stress(&state, &mut work.solid, &mut work.after);
        solid.forces(&state, &work.solid, &mut work.force);
    }

    /// d/dt of the unknowns `u` under the loads in `work`, where materials remember what stands there.
    pub(super) fn rates(&self, at: &Moving<'_>, u: &[f64], work: &mut Work<D>, change: &mut [f64]) {
        let Moving { time: t, step, jets, pace } = *at;
        self.split(u, work);
        self.hold(t, &mut work.led);
        self.hold_velocity(t, &mut work.led_velocity);
        let solid = &self.structure.solid;
        let omega = self.omega;
        if pace == Pace::Held {
            let start = self.initial();
            for (i, (row, change)) in u.chunks_exact(2 * D).zip(change.chunks_exact_mut(2 * D)).enumerate() {
                for a in 0..D {
                    let at = 2 * (i * D + a);
                    change[2 * a] = omega * (start[at] - row[2 * a]);
                    change[2 * a + 1] = omega * (start[at + 1] - row[2 * a + 1]);
                }
            }
            return;
        }
        if pace == Pace::Steady {
            work.velocity.fill([0.0; D]);
        }
        self.forces(t, step, work);
        let pressure = self.scales.pressure;
        for (force, load) in work.force.iter_mut().zip(&work.load) {
            (0..D).for_each(|a| force[a] += pressure * load[a]);
        }
        if pace == Pace::Steady {
            self.towards_rest(u, work, change);
            return;
        }
        let first = self.first;
        let (force, led, led_velocity) = (&work.force, &work.led, &work.led_velocity);
        let per_mass = |i: usize| 1.0 / (pressure * self.mass(i));
        let jet = |k: usize| jets.get(first + k).copied().unwrap_or(Jet { value: 0.0, first: 0.0, second: 0.0 });
        for (i, (row, change)) in u.chunks_exact(2 * D).zip(change.chunks_exact_mut(2 * D)).enumerate() {
            for a in 0..D {
                if solid.is_held(i, a) {
                    let jet = jet(i * D + a);
                    change[2 * a] = jet.first + omega * (led[i][a] - row[2 * a]);
                    change[2 * a + 1] = jet.second + omega * (led_velocity[i][a] - row[2 * a + 1]);
                } else {
                    change[2 * a] = row[2 * a + 1];
                    change[2 * a + 1] = force[i][a] * per_mass(i);
                }
            }
        }
    }

    /// u' = ω K₀⁻¹ f, v' = −ω v.
    fn towards_rest(&self, u: &[f64], work: &Work<D>, change: &mut [f64]) {
        let solid = &self.structure.solid;
        let free = |(i, a): (usize, usize)| if solid.is_held(i, a) { 0.0 } else { work.force[i][a] };
        let mut step: Vec<f64> = (0..self.len()).flat_map(|i| (0..D).map(move |a| (i, a))).map(free).collect();
        match self.reference() {
            Some(factors) => factors.solve(&mut step),
            None => step.fill(f64::NAN),
        }
        let omega = self.omega;
        for (i, (row, change)) in u.chunks_exact(2 * D).zip(change.chunks_exact_mut(2 * D)).enumerate() {
            for a in 0..D {
                let held = solid.is_held(i, a);
                let by = if held { work.led[i][a] - row[2 * a] } else { step[i * D + a] };
                change[2 * a] = omega * by;
                change[2 * a + 1] = -omega * row[2 * a + 1];
            }
        }
    }

    /// Factors of the stiffness at rest; `None` where supports do not hold the bodies.
    fn reference(&self) -> Option<&Factors> {
        self.reference.get_or_init(|| self.stiffness(&self.work(), (0.0, 0.0), (1.0, 0.0)).factor()).as_ref()
    }

    /// True when supports hold the bodies.
    pub fn are_held(&self) -> bool {
        self.reference().is_some()
    }

    /// `scale` K + `shift` M at the state in `work`, at a time and after a step of the gas, in units of the case.
    pub(super) fn stiffness(
        &self,
        work: &Work<D>,
        (time, step): (f64, f64),
        (scale, shift): (f64, f64),
    ) -> crate::math::sparse::Symmetric {
        let at = Moment {
            time: time / self.scales.speed,
            step: step / self.scales.speed,
            displacement: work.displacement.as_flattened(),
            velocity: work.velocity.as_flattened(),
            history: &work.history,
        };
        self.structure.matrix(&self.structure.linearise(&at, [1.0, 0.0]), scale, shift)
    }

    /// Energies of the state in `work`, in units of the gas.
    pub(super) fn energy(&self, t: f64, work: &Work<D>) -> (Energy, f64) {
        let state = self.state(t, work);
        let solid = &self.structure.solid;
        let (e, p) = (solid.energy(&state), self.scales.pressure);
        let energy = Energy {
            kinetic: e.kinetic / p,
            strain: e.strain / p,
            stabilisation: e.stabilisation / p,
            contact: e.contact / p,
            dissipated: e.dissipated / p,
        };
        (energy, solid.damped(&state) / (p * self.scales.speed))
    }

    /// Refuses unknowns that are none; `row` is the first row of the solids.
    pub(super) fn check(&self, u: &[f64], row: usize) -> Result<(), Fault> {
        let displacement: Vec<[f64; D]> =
            u.chunks_exact(2 * D).map(|row| std::array::from_fn(|a| row[2 * a])).collect();
        let moved = |fault: Fault| Fault { particle: row + fault.particle, ..fault };
        self.structure.solid.check(&displacement).map_err(moved)
    }

    /// Coordinates that are told: the mean displacement of each body, and those of its probes; with the rates, and the forces
    /// of the gas that do work on them.
    pub(super) fn told(&self, work: &Work<D>) -> Vec<[f64; 3]> {
        let mass = self.structure.solid.mass();
        let mut all = Vec::new();
        for body in &self.bodies {
            let sum = |f: &(dyn Fn(usize) -> f64 + Sync)| sum(body.particles.len(), |k| f(body.particles.start + k));
            let whole = sum(&|i| mass[i]);
            for a in 0..D {
                let mean = |q: &[[f64; D]]| sum(&|i| mass[i] * q[i][a]) / whole;
                let load = sum(&|i| work.load[i][a]);
                all.push([mean(&work.displacement), mean(&work.velocity) / self.scales.speed, load]);
            }
            for i in &body.probes {
                let of = |a| [work.displacement[*i][a], work.velocity[*i][a] / self.scales.speed, work.load[*i][a]];
                all.extend((0..D).map(of));
            }
        }
        all
    }

    /// The body that a body of the case is.
    fn of_case(&self, body: usize) -> Option<&SolidBody<D>> {
        self.bodies.iter().find(|b| b.body == body)
    }
}

impl<const D: usize> OnCloud<D> {
    /// The bodies on the cloud of `fluid`.
    pub fn new(solids: Arc<Solids<D>>, fluid: &Fluid<D>) -> Self {
        let cloud = &fluid.discretisation.cloud;
        let mut parts = vec![None; cloud.interface.len()];
        sweep_slots(&mut parts, |w, slot| {
            let wall = &cloud.interface[w];
            *slot = solids.of_case(usize::from(wall.body)).map(|body| {
                let carried = body.net.on_surface(&cloud.x[cloud.n_fluid + w], &wall.normal);
                let base = body.particles.start as u32;
                carried.parts.into_iter().map(|(k, part)| (base + k, part)).collect::<Vec<_>>()
            });
        });
        let on = |(wall, parts): (usize, Option<_>)| parts.map(|parts| OnWall { wall, parts });
        let walls: Vec<OnWall<D>> = parts.into_iter().enumerate().filter_map(on).collect();
        let mut surface: Vec<u32> = walls.iter().flat_map(|w| w.parts.iter().map(|(i, _)| *i)).collect();
        surface.sort_unstable();
        surface.dedup();
        Self { solids, walls, surface }
    }

    /// Sets `load` to the forces on the particles where the gas exerts the forces `force` on interface particles.
    pub(super) fn load(&self, force: &dyn Fn(usize) -> Vector<D>, load: &mut [Vector<D>]) {
        load.fill(Vector::ZERO);
        for wall in &self.walls {
            wall.push(&force(wall.wall), load);
        }
    }

    /// Σ f·w of the gas on the particles, with velocities of these by the formula that serves the state.
    pub(super) fn power(&self, jets: &[Jet], work: &Work<D>) -> f64 {
        let jet = |k: usize| jets.get(self.solids.first + k).map_or(0.0, |j| j.first);
        sum(work.load.len(), |i| (0..D).map(|a| work.load[i][a] * jet(i * D + a)).sum())
    }
}

impl<const D: usize> OnWall<D> {
    /// Adds Wᵀ F to the forces on particles.
    pub(super) fn push(&self, force: &Vector<D>, load: &mut [Vector<D>]) {
        for (i, part) in &self.parts {
            let f = &mut load[*i as usize];
            for r in 0..D {
                (0..D).for_each(|c| f[c] += part[r][c] * force[r]);
            }
        }
    }

    /// Σ W q of a quantity of the particles.
    pub(super) fn of(&self, q: impl Fn(usize) -> [f64; D]) -> Vector<D> {
        let mut sum = Vector::ZERO;
        for (i, part) in &self.parts {
            let q = q(*i as usize);
            for r in 0..D {
                (0..D).for_each(|c| sum[r] += part[r][c] * q[c]);
            }
        }
        sum
    }
}
