//! Explicit marching of structures: Verlet's method.
//!
//! v′ = v + ½Δt a, u ← u + Δt v′, a ← M⁻¹ f(u, v′), v = v′ + ½Δt a. The method is of second order; it conserves
//! momentum, and energy up to a bounded oscillation (Hairer, Lubich and Wanner 2003, doi:10.1017/S0962492902000144).
//! The work of loads and damping is integrated with the mean of the forces at both ends of a step.
use super::{Cost, Integrator, Mark, Memory, Past, Standing, Step, TimeError};
use crate::math::parallel::sweep_rows;
use crate::system::{Instant, Mechanical, Moment};

/// Parameters of an explicit march.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Fraction of the longest stable step.
    pub cfl: f64,
    /// Time at the end.
    pub until: f64,
}

/// Number of steps between two computations of the longest stable step.
const LOOK: u32 = 20;

/// An explicit march of a structure by Verlet's method.
pub struct Symplectic<'a, S: Mechanical> {
    system: &'a S,
    plan: Plan,
    past: Past,
    frame: S::Frame,
    work: S::Work,
    u: Vec<f64>,
    force: Vec<f64>,
    after: Vec<f64>,
    last_good: Vec<f64>,
    stable: f64,
    evaluations: u64,
}

impl<'a, S: Mechanical> Symplectic<'a, S> {
    /// Prepares a march from the state `u`.
    pub fn new(system: &'a S, plan: Plan, past: Past, u: Vec<f64>) -> Self {
        let n = system.displacements();
        let mut march = Self {
            frame: system.frame(&Instant::still(past.time), &u),
            work: system.work(),
            force: vec![0.0; n],
            after: vec![0.0; u.len() - 2 * n],
            last_good: u.clone(),
            stable: past.next,
            evaluations: 0,
            system,
            plan,
            past,
            u,
        };
        match march.past.before.len() == n {
            true => march.force.copy_from_slice(&march.past.before),
            false => march.evaluate(0.0),
        }
        march.past.before = Vec::new();
        march
    }

    /// Evaluates forces and accelerations of the current state.
    fn evaluate(&mut self, step: f64) {
        let n = self.force.len();
        let (u, rest) = self.u.split_at(n);
        let (v, history) = rest.split_at(n);
        let at = Moment { time: self.past.time, step, displacement: u, velocity: v, history };
        self.system.forces(&at, &mut self.work, &mut self.force, &mut self.after);
        self.evaluations += 1;
    }

    /// Computes v += Δt a for the free degrees of freedom.
    fn kick(&mut self, step: f64) {
        let n = self.force.len();
        let (system, force) = (self.system, &self.force);
        sweep_rows(&mut self.u[n..2 * n], 1, |k, v| {
            v[0] = if system.is_held(k) { v[0] } else { v[0] + step * force[k] / system.mass(k) };
        });
    }

    /// Computes u += Δt v and imposes the displacements of the supports.
    fn drift(&mut self, step: f64, end: f64) {
        let n = self.force.len();
        let (u, rest) = self.u.split_at_mut(n);
        let (start, v) = (&self.last_good[..n], &mut rest[..n]);
        sweep_rows(u, 1, |k, u| u[0] += step * v[k]);
        self.system.hold(end, u);
        for k in (0..n).filter(|k| self.system.is_held(*k)) {
            v[k] = (u[k] - start[k]) / step;
        }
    }
}

impl<S: Mechanical> Integrator<S> for Symplectic<'_, S> {
    fn finished(&self) -> bool {
        self.past.time >= self.plan.until
    }

    fn mark(&self) -> Mark {
        self.past.mark()
    }

    fn standing(&mut self) -> Standing<'_, S> {
        Standing { system: self.system, frame: &self.frame, work: &mut self.work, state: &self.u }
    }

    fn memory(&self) -> Memory {
        Memory::March(Past { before: self.force.clone(), next: self.stable, ..self.past.clone() })
    }

    fn cost(&self) -> Cost {
        let bytes = 8 * (2 * self.u.len() + self.force.len() + self.after.len());
        Cost { evaluations: self.evaluations, bytes, ..Cost::default() }
    }

    fn advance(&mut self) -> Result<Step, TimeError> {
        let n = self.force.len();
        if self.past.iteration.is_multiple_of(LOOK) {
            self.stable = self.system.stable_step(&self.u[..n]);
        }
        let left = self.plan.until - self.past.time;
        let mut step = (self.plan.cfl * self.stable).min(left);
        if step < left && 2.0 * step > left {
            step = 0.5 * left;
        }
        let start = self.past.time;
        let end = if step == left { self.plan.until } else { start + step };
        self.last_good.copy_from_slice(&self.u);
        self.kick(0.5 * step);
        self.drift(step, end);
        self.past.time = end;
        self.evaluate(step);
        self.kick(0.5 * step);
        self.u[2 * n..].copy_from_slice(&self.after);
        (self.past.last, self.past.iteration) = (step, self.past.iteration + 1);
        self.system.place(&Instant::still(end), &mut self.frame);
        if let Err(fault) = self.system.check_forces(&self.work, &self.u[..n]) {
            self.u.copy_from_slice(&self.last_good);
            (self.past.time, self.past.iteration) = (start, self.past.iteration - 1);
            // a later march starts from the forces of the stored state
            self.evaluate(0.0);
            let hint = "lower `time.explicit.cfl`, or check the loads and their units";
            return Err(TimeError::Fault { fault, iteration: self.past.iteration + 1, hint });
        }
        Ok(Step { iteration: self.past.iteration, time: end, cfl: self.plan.cfl, residual: 1.0, linear: 0 })
    }
}
