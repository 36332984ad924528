//! Explicit marching of a gas with bodies made of particles: the gas in long steps, the solids in as many short ones as they need.
//!
//! A step of the gas begins with the pressure p_f on the walls, which move with the velocity w. Each short step of the solids (Verlet)
//! solves with the pressure that a wall meets when it moves otherwise,
//!
//! p* = p_f + Z (v − w)·n, Z = ρ_f a_f,
//!
//! implicitly in v: an interface that neither stiff metal nor a light panel makes unstable (Banks and Henshaw 2011,
//! doi:10.1016/j.jcp.2010.12.015). The equations couple the particles of the surface alone, and conjugate gradients solve them in a few
//! iterations; what is left of them is no error of the exchange, as the forces are those of the velocity found. The gas then goes
//! through its step with walls on the way that the solids went, and takes the mean of their forces and of their power: impulse
//! and energy pass to round-off.
use std::sync::Arc;

use super::solids::{OnCloud, Work as SolidWork};
use super::{Coupled, Frame, Work};
use crate::math::Vector;
use crate::math::conjugate::{Symmetric, conjugate_gradients};
use crate::math::parallel::sweep_rows;
use crate::math::reduce::{first, maximum, sum};
use crate::scheme::{Taken, View};
use crate::system::{Instant, Mechanical, Name, System, rows};
use crate::time::explicit::{Plan, SSPRK3, Stage};
use crate::time::{CROWDED, Cost, Integrator, Mark, Memory, Past, Standing, Step, TimeError};

/// Part of their longest stable step that solids take.
const SOLID_CFL: f64 = 0.8;
/// Time before the start from which walls come, in that of sound across the bodies.
const BEFORE: f64 = 1e-2;
/// What conjugate gradients leave of the right-hand side, and their most iterations.
const SOLVED: f64 = 1e-12;
const ITERATIONS: usize = 200;

/// What happens on one interface particle in a step of the gas.
#[derive(Clone, Copy, Debug)]
struct Meeting<const D: usize> {
    /// Force at the start.
    force: Vector<D>,
    normal: Vector<D>,
    /// Z times area.
    impedance: f64,
    /// w·n.
    speed: f64,
    impulse: Vector<D>,
    work: f64,
}

/// A march from one time to another.
pub struct March<'a, const D: usize> {
    system: &'a Coupled<D>,
    on: &'a OnCloud<D>,
    plan: Plan,
    past: Past,
    u: Vec<f64>,
    start: Vec<f64>,
    frame: Frame<D>,
    work: Work<D>,
    du: Vec<f64>,
    rate: Vec<f64>,
    meetings: Vec<Meeting<D>>,
    /// Velocities of solid particles, in units of the gas.
    velocity: Vec<Vector<D>>,
    /// Work of the gas on the particles in the step.
    taken: f64,
    evaluations: u64,
}

impl<'a, const D: usize> March<'a, D> {
    /// Prepares a march of `system` with its bodies made of particles from the state `u`.
    pub fn new(system: &'a Coupled<D>, on: &'a OnCloud<D>, plan: Plan, past: Past, u: Vec<f64>) -> Self {
        let frame = frame_after(system, on, &past, &u);
        let n = on.solids.len();
        let blank = Meeting {
            force: Vector::ZERO,
            normal: Vector::ZERO,
            impedance: 0.0,
            speed: 0.0,
            impulse: Vector::ZERO,
            work: 0.0,
        };
        Self {
            on,
            plan,
            past,
            frame,
            work: system.work(),
            start: u.clone(),
            du: vec![0.0; system.unknowns_of(Name::Gas).len()],
            rate: vec![0.0; rows(system.fields())],
            meetings: vec![blank; on.walls.len()],
            velocity: vec![Vector::ZERO; n],
            taken: 0.0,
            evaluations: 0,
            system,
            u,
        }
    }

    /// The longest stable step of the gas, given how fast particles move now.
    fn step_length(&mut self) -> f64 {
        let gas = &self.u[self.system.unknowns_of(Name::Gas)];
        let rate = &mut self.rate[self.system.rows_of(Name::Gas)];
        self.system.fluid().rates(&self.frame.gas, gas, &mut self.work.gas, rate);
        self.plan.cfl / maximum(rate.len(), |i| rate[i])
    }

    /// What the gas does to the walls at the start of a step.
    fn meet(&mut self) {
        let fluid = self.system.fluid();
        self.frame.gas.taken = Arc::default();
        fluid.fill_states(&self.frame.gas, &self.u[self.system.unknowns_of(Name::Gas)], &mut self.work.gas);
        if fluid.viscous_model.is_some() {
            fluid.fill_gradients(&self.frame.gas, &mut self.work.gas);
        }
        let view = View::new(fluid, &self.frame.gas, &self.work.gas);
        let cloud = view.cloud();
        for (meeting, wall) in self.meetings.iter_mut().zip(&self.on.walls) {
            let (i, state) = (cloud.n_fluid + wall.wall, view.state(cloud.n_fluid + wall.wall));
            let area = view.area(wall.wall);
            let normal = area.unit();
            *meeting = Meeting {
                force: view.wall_force(wall.wall),
                normal,
                impedance: state.density * fluid.gas.sound_speed(&state) * area.norm(),
                speed: view.velocity(i).dot(&normal),
                impulse: Vector::ZERO,
                work: 0.0,
            };
        }
    }

    /// Takes the solids through a step of the gas of length `dt`.
    fn solids(&mut self, dt: f64) {
        let solids = &self.on.solids;
        let (own, storage) = (self.system.unknowns_of(Name::Solid), self.work.solids.as_mut());
        let Some(work) = storage else { return };
        solids.split(&self.u[own.clone()], work);
        let remembered = self.system.unknowns_of(Name::History);
        if !remembered.is_empty() {
            work.history.copy_from_slice(&self.u[remembered.clone()]);
        }
        let speed = solids.scales.speed;
        for (v, pair) in self.velocity.iter_mut().zip(self.u[own.clone()].chunks_exact(2 * D)) {
            *v = Vector::from_fn(|a| pair[2 * a + 1]);
        }
        let stable = solids.structure.stable_step(work.displacement.as_flattened()) * speed;
        let count = (dt / (SOLID_CFL * stable)).ceil().max(1.0);
        let tau = dt / count;
        let time = self.past.time;
        solids.forces(time, 0.0, work);
        self.taken = 0.0;
        for k in 0..count as usize {
            let end = if k + 1 == count as usize { time + dt } else { time + (k + 1) as f64 * tau };
            self.taken += kick(self.on, work, &mut self.velocity, &mut self.meetings, 0.5 * tau);
            drift(self.on, work, &mut self.velocity, (tau, end));
            solids.forces(end, tau, work);
            self.taken += kick(self.on, work, &mut self.velocity, &mut self.meetings, 0.5 * tau);
            std::mem::swap(&mut work.history, &mut work.after);
        }
        for (i, row) in self.u[own].chunks_exact_mut(2 * D).enumerate() {
            for a in 0..D {
                (row[2 * a], row[2 * a + 1]) = (work.displacement[i][a], self.velocity[i][a]);
            }
        }
        if !remembered.is_empty() {
            self.u[remembered].copy_from_slice(&work.history);
        }
    }

    /// Brings the cloud to part of the way through the step of length `dt` that begins now.
    fn place(&mut self, dt: f64, fraction: f64) {
        let placing = self.system.placing();
        let ends = [placing.values(&self.start), placing.values(&self.u)];
        let at = Instant::between(self.past.time, dt, fraction, [&ends[0], &ends[1]]);
        self.system.fluid().place(&at, &mut self.frame.gas);
        self.frame.steady = false;
    }

    /// Says what each wall takes in the step of length `dt`.
    fn hand_over(&mut self, dt: f64) {
        let areas = self.frame.gas.wall_areas();
        let mut taken = vec![Taken::BY_STATE; areas.len()];
        for (meeting, wall) in self.meetings.iter().zip(&self.on.walls) {
            let (force, power) = (meeting.impulse * (1.0 / dt), meeting.work / dt);
            taken[wall.wall] = Taken { force, power, area: areas[wall.wall] };
        }
        self.frame.gas.taken = Arc::new(taken);
        self.frame.taken = Some(self.taken / dt);
    }

    fn stage(&mut self, s: &Stage, dt: f64) {
        self.place(dt, s.time);
        self.hand_over(dt);
        let range = self.system.unknowns_of(Name::Gas);
        let gas = &mut self.u[range.clone()];
        self.system.fluid().rhs(&self.frame.gas, gas, &mut self.work.gas, &mut self.du);
        let (start, du) = (&self.start[range], &self.du);
        sweep_rows(gas, 1, |k, row| row[0] = s.start * start[k] + s.last * row[0] + s.step * dt * du[k]);
        self.evaluations += 1;
    }
}

/// The frame at the end of the last step; at the start, walls come with the velocity of the bodies.
fn frame_after<const D: usize>(system: &Coupled<D>, on: &OnCloud<D>, past: &Past, u: &[f64]) -> Frame<D> {
    let (end, step, now) = (past.time, past.last, system.placing().values(u));
    if step > 0.0 && !past.before.is_empty() {
        let before = system.placing().values(&past.before);
        return system.frame(&Instant::between(end - step, step, 1.0, [&before, &now]), u);
    }
    let step = BEFORE / on.solids.omega;
    let before: Vec<f64> = now.chunks_exact(2).flat_map(|pair| [pair[0] - step * pair[1], pair[1]]).collect();
    system.frame(&Instant::between(end - step, step, 1.0, [&before, &now]), u)
}

/// Velocities by the forces of neighbours in `work` and those of the gas at the end of `tau`; the work of the latter on the particles.
fn kick<const D: usize>(
    on: &OnCloud<D>,
    work: &mut SolidWork<D>,
    velocity: &mut [Vector<D>],
    meetings: &mut [Meeting<D>],
    tau: f64,
) -> f64 {
    let solids = &on.solids;
    let (solid, pressure) = (&solids.structure.solid, solids.scales.pressure);
    let free = |i: usize, v: Vector<D>| Vector::from_fn(|a| if solid.is_held(i, a) { 0.0 } else { v[a] });
    let mass = |i: usize| solids.mass(i);
    let force = &work.force;
    implicit(on, (force, velocity), meetings, (tau, &mut work.load, &mut work.change));
    let change = &work.change;
    // the forces are those of the velocity found; what they do is exact
    work.load.fill(Vector::ZERO);
    let mut met = vec![Vector::ZERO; meetings.len()];
    for ((meeting, wall), met) in meetings.iter().zip(&on.walls).zip(&mut met) {
        let moved = wall.of(|i| (velocity[i] + change[i]).0).dot(&meeting.normal) - meeting.speed;
        *met = meeting.force - meeting.normal * (meeting.impedance * moved);
        wall.push(met, &mut work.load);
    }
    let load = &work.load;
    work.before.copy_from_slice(velocity);
    let before = &work.before;
    sweep_rows(velocity, 1, |i, v| {
        v[0] += free(i, (Vector(force[i]) * (1.0 / pressure) + load[i]) * (tau / mass(i)));
    });
    for ((meeting, wall), met) in meetings.iter_mut().zip(&on.walls).zip(met) {
        meeting.impulse += met * tau;
        meeting.work += met.dot(&wall.of(|i| ((before[i] + velocity[i]) * 0.5).0)) * tau;
    }
    let speed = solids.scales.speed;
    for (case, v) in work.velocity.iter_mut().zip(&*velocity) {
        *case = v.0.map(|v| v * speed);
    }
    sum(velocity.len(), |i| work.load[i].dot(&((before[i] + velocity[i]) * (0.5 * tau))))
}

/// Adds to `change` the change δ of the velocity of the surface in `tau`, with the pressure that it meets at its end:
/// (M/τ + C) δ = f + Wᵀ (F − n Z A n·(W v − w)), C = Wᵀ n Z A nᵀ W. `load` is storage.
fn implicit<const D: usize>(
    on: &OnCloud<D>,
    (force, velocity): (&[[f64; D]], &[Vector<D>]),
    meetings: &[Meeting<D>],
    (tau, load, change): (f64, &mut [Vector<D>], &mut [Vector<D>]),
) {
    let (solids, surface) = (&on.solids, &on.surface);
    let solid = &solids.structure.solid;
    let free = |i: usize, v: Vector<D>| Vector::from_fn(|a| if solid.is_held(i, a) { 0.0 } else { v[a] });
    let mass = |k: usize| solids.mass(surface[k] as usize);
    load.fill(Vector::ZERO);
    for (meeting, wall) in meetings.iter().zip(&on.walls) {
        let moved = wall.of(|i| velocity[i].0).dot(&meeting.normal) - meeting.speed;
        wall.push(&(meeting.force - meeting.normal * (meeting.impedance * moved)), load);
    }
    let per = 1.0 / solids.scales.pressure;
    let at = |i: &u32| free(*i as usize, load[*i as usize] + Vector(force[*i as usize]) * per);
    let mut right: Vec<Vector<D>> = surface.iter().map(at).collect();
    let mut found = vec![Vector::ZERO; surface.len()];
    let size = maximum(right.len(), |k| right[k].max_abs()).max(f64::MIN_POSITIVE);
    let (spread, pushed) = (change, load);
    conjugate_gradients(
        &mut found,
        &mut right,
        ITERATIONS,
        Symmetric {
            enough: |r: &[Vector<D>]| first(r.len(), |k| !(r[k].max_abs() <= SOLVED * size)).is_none(),
            product: |q: &[Vector<D>], out: &mut [Vector<D>]| {
                for (q, i) in q.iter().zip(surface) {
                    (spread[*i as usize], pushed[*i as usize]) = (free(*i as usize, *q), Vector::ZERO);
                }
                for (meeting, wall) in meetings.iter().zip(&on.walls) {
                    let moved = wall.of(|i| spread[i].0).dot(&meeting.normal);
                    wall.push(&(meeting.normal * (meeting.impedance * moved)), pushed);
                }
                for (k, out) in out.iter_mut().enumerate() {
                    let i = surface[k] as usize;
                    *out = free(i, pushed[i]) + q[k] * (mass(k) / tau);
                }
            },
            precondition: |r: &[Vector<D>], z: &mut [Vector<D>]| {
                z.iter_mut().enumerate().for_each(|(k, z)| *z = r[k] * (tau / mass(k)));
            },
        },
    );
    surface.iter().zip(found).for_each(|(i, found)| spread[*i as usize] = found);
}

/// Displacements by the velocities over `tau`, with what is held where it is to be at `end`.
fn drift<const D: usize>(on: &OnCloud<D>, work: &mut SolidWork<D>, velocity: &mut [Vector<D>], (tau, end): (f64, f64)) {
    let solid = &on.solids.structure.solid;
    work.led.copy_from_slice(&work.displacement);
    on.solids.hold(end, &mut work.led);
    for (i, u) in work.displacement.iter_mut().enumerate() {
        for a in 0..D {
            if solid.is_held(i, a) {
                velocity[i][a] = (work.led[i][a] - u[a]) / tau;
                u[a] = work.led[i][a];
            } else {
                u[a] += tau * velocity[i][a];
            }
        }
    }
}

impl<const D: usize> Integrator<Coupled<D>> for March<'_, D> {
    fn finished(&self) -> bool {
        self.past.time >= self.plan.until
    }

    fn mark(&self) -> Mark {
        self.past.mark()
    }

    fn standing(&mut self) -> Standing<'_, Coupled<D>> {
        Standing { system: self.system, frame: &self.frame, work: &mut self.work, state: &self.u }
    }

    fn memory(&self) -> Memory {
        Memory::March(self.past.clone())
    }

    fn cost(&self) -> Cost {
        let bytes = 8 * (2 * self.u.len() + self.du.len() + self.rate.len() + self.past.before.len());
        Cost { evaluations: self.evaluations, bytes, ..Cost::default() }
    }

    fn advance(&mut self) -> Result<Step, TimeError> {
        let left = self.plan.until - self.past.time;
        let longest = self.step_length();
        let mut dt = longest.min(left);
        if dt < left && 2.0 * dt > left {
            dt = 0.5 * left;
        }
        self.start.copy_from_slice(&self.u);
        self.meet();
        self.solids(dt);
        SSPRK3.iter().for_each(|s| self.stage(s, dt));
        self.place(dt, 1.0);
        self.hand_over(dt);
        let crowded = self.system.check_frame(&self.frame).err();
        let hint = match crowded {
            Some(_) => CROWDED,
            None => {
                "lower `time.explicit.cfl`, use a stronger limiter, or look whether the structure is as stiff as it should be"
            }
        };
        if let Some(fault) = crowded.or_else(|| self.system.check(&self.frame, &self.u).err()) {
            self.u.copy_from_slice(&self.start);
            self.frame = frame_after(self.system, self.on, &self.past, &self.u);
            return Err(TimeError::Fault { fault, iteration: self.past.iteration + 1, hint });
        }
        self.past.time = if dt == left { self.plan.until } else { self.past.time + dt };
        (self.past.last, self.past.iteration) = (dt, self.past.iteration + 1);
        self.past.before.clear();
        self.past.before.extend_from_slice(&self.start);
        let (iteration, time) = (self.past.iteration, self.past.time);
        Ok(Step { iteration, time, cfl: self.plan.cfl, residual: 1.0, linear: 0 })
    }
}
