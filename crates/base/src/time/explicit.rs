//! Explicit Runge-Kutta methods for marching in time.
use super::{CROWDED, Cost, Integrator, Mark, Memory, Past, Standing, Step, TimeError};
use crate::math::parallel::sweep;
use crate::math::reduce::maximum;
use crate::system::{Instant, System, rows};

/// Coefficients of a stage u_s = Σ_r α_r u_r + β Δt R(u_{s−1}), where α is non-zero for the start and for the last
/// stage only.
#[derive(Clone, Copy, Debug)]
pub struct Stage {
    /// Coefficient α of the state at the start of the step.
    pub start: f64,
    /// Coefficient α of the previous stage.
    pub last: f64,
    /// Coefficient β of Δt R.
    pub step: f64,
    /// Elapsed fraction of the step at which R is evaluated.
    pub time: f64,
}

/// Strong-stability-preserving method of third order with three stages (Shu and Osher 1988).
pub const SSPRK3: [Stage; 3] = [
    Stage { start: 0.0, last: 1.0, step: 1.0, time: 0.0 },
    Stage { start: 0.75, last: 0.25, step: 0.25, time: 1.0 },
    Stage { start: 1.0 / 3.0, last: 2.0 / 3.0, step: 2.0 / 3.0, time: 0.5 },
];

/// Method of an explicit march.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Strong-stability-preserving method of third order with three stages.
    Ssprk3,
    /// Classical method of fourth order with four stages.
    Rk4,
}

/// Parameters of an explicit march.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Runge-Kutta method of the march.
    pub method: Method,
    /// Courant number, from which the step length follows.
    pub cfl: f64,
    /// Time at which the march ends.
    pub until: f64,
}

/// An explicit march whose step length follows from the Courant number.
pub struct Explicit<'a, S: System> {
    system: &'a S,
    method: Method,
    cfl: f64,
    until: f64,
    past: Past,
    u: Vec<f64>,
    frame: S::Frame,
    work: S::Work,
    start: Vec<f64>,
    du: Vec<f64>,
    sum: Vec<f64>,
    rate: Vec<f64>,
    evaluations: u64,
}

impl<'a, S: System> Explicit<'a, S> {
    /// Prepares a march from the state `u` at time `time`.
    pub fn new(system: &'a S, plan: Plan, past: Past, u: Vec<f64>) -> Self {
        let Plan { method, cfl, until } = plan;
        let n = u.len();
        let (end, step) = (past.time, past.last);
        let at = match step > 0.0 {
            true => Instant::within(end - step, step, 1.0),
            false => Instant::still(end),
        };
        let frame = system.frame(&at.with(&system.placing().values(&u)), &u);
        Self {
            system,
            method,
            cfl,
            until,
            past,
            frame,
            work: system.work(),
            start: vec![0.0; n],
            du: vec![0.0; n],
            sum: vec![0.0; if method == Method::Rk4 { n } else { 0 }],
            rate: vec![0.0; rows(system.fields())],
            evaluations: 0,
            u,
        }
    }

    /// Maximum stable step for the current velocities of particles.
    fn step_length(&mut self) -> f64 {
        self.system.rates(&self.frame, &self.u, &mut self.work, &mut self.rate);
        self.cfl / maximum(self.rate.len(), |i| self.rate[i])
    }

    fn evaluate(&mut self, dt: f64, fraction: f64) {
        self.place(dt, fraction);
        self.system.rhs(&self.frame, &self.u, &mut self.work, &mut self.du);
        self.evaluations += 1;
    }

    /// Moves the frame to the fraction `fraction` of the step of length `dt` that begins now.
    fn place(&mut self, dt: f64, fraction: f64) {
        let coordinates = self.system.placing().values(&self.u);
        let at = Instant::within(self.past.time, dt, fraction).with(&coordinates);
        self.system.place(&at, &mut self.frame);
    }

    fn stage(&mut self, s: &Stage, dt: f64) {
        self.evaluate(dt, s.time);
        let (start, du, u) = (&self.start, &self.du, &mut self.u);
        combine(u, |k, last| s.start * start[k] + s.last * last + s.step * dt * du[k]);
    }

    fn classical(&mut self, dt: f64) {
        self.sum.fill(0.0);
        for (weight, at, ahead) in [(1.0, 0.0, 0.5), (2.0, 0.5, 0.5), (2.0, 0.5, 1.0), (1.0, 1.0, 0.0)] {
            self.evaluate(dt, at);
            let (start, du) = (&self.start, &self.du);
            combine(&mut self.sum, |k, s| s + weight * du[k]);
            combine(&mut self.u, |k, _| start[k] + ahead * dt * du[k]);
        }
        let (start, sum) = (&self.start, &self.sum);
        sweep(&mut self.u, |k| start[k] + dt / 6.0 * sum[k]);
    }
}

impl<S: System> Integrator<S> for Explicit<'_, S> {
    fn finished(&self) -> bool {
        self.past.time >= self.until
    }

    fn mark(&self) -> Mark {
        self.past.mark()
    }

    fn standing(&mut self) -> Standing<'_, S> {
        Standing { system: self.system, frame: &self.frame, work: &mut self.work, state: &self.u }
    }

    fn memory(&self) -> Memory {
        Memory::March(self.past.clone())
    }

    fn cost(&self) -> Cost {
        let bytes = 8 * (3 * self.u.len() + self.sum.len() + self.rate.len());
        Cost { evaluations: self.evaluations, bytes, ..Cost::default() }
    }

    fn advance(&mut self) -> Result<Step, TimeError> {
        let reach = self.system.plan_lagrangian_step(0.0, &self.u, &mut self.work, &mut self.frame);
        let mut longest = self.step_length().min(reach);
        if self.past.last == 0.0 {
            // later steps estimate the velocities of particles by those of the previous step
            self.place(longest, 0.0);
            longest = longest.min(self.step_length());
        }
        let left = self.until - self.past.time;
        let mut dt = longest.min(left);
        if dt < left && 2.0 * dt > left {
            dt = 0.5 * left;
        }
        self.start.copy_from_slice(&self.u);
        match self.method {
            Method::Ssprk3 => SSPRK3.iter().for_each(|s| self.stage(s, dt)),
            Method::Rk4 => self.classical(dt),
        }
        let start = self.past.time;
        self.place(dt, 1.0);
        self.past.time = if dt == left { self.until } else { self.past.time + dt };
        self.past.last = dt;
        self.past.iteration += 1;
        let crowded = self.system.check_frame(&self.frame).err();
        let hint = match crowded {
            Some(_) => CROWDED,
            None => "lower `time.explicit.cfl`, or use a stronger limiter",
        };
        if let Some(fault) = crowded.or_else(|| self.system.check(&self.frame, &self.u).err()) {
            self.u.copy_from_slice(&self.start);
            self.past.iteration -= 1;
            self.past.time = start;
            self.place(dt, 0.0);
            return Err(TimeError::Fault { fault, iteration: self.past.iteration + 1, hint });
        }
        Ok(Step { iteration: self.past.iteration, time: self.past.time, cfl: self.cfl, residual: 1.0, linear: 0 })
    }
}

/// Sets x[k] = f(k, x[k]) for all k.
fn combine(x: &mut [f64], f: impl Fn(usize, f64) -> f64 + Sync) {
    crate::math::parallel::sweep_rows(x, 1, |k, row| row[0] = f(k, row[0]));
}
