//! Implicit marching: backward differences, where each step is relaxed in pseudo time (Jameson, AIAA 91-1596).
//!
//! R(U) − ∂U/∂t = 0 with ∂U/∂t = Σ c_k U(t_k): the first step uses the first-order formula, all later steps the
//! second-order formula of three times for unequal step lengths. Particle velocities follow from positions by the same
//! formula as the state.
use super::control::{Control, Method};
use super::formula::Formula;
use super::relax::{Relax, TimeTerm};
use super::{CROWDED, Cost, Integrator, Mark, Memory, Past, Standing, Step, TimeError};
use crate::math::multilevel::Cycle;
use crate::math::parallel::sweep;
use crate::math::reduce::sum;
use crate::system::{Implicit, Instant, Name, Reach};

/// Maximum ratio of successive step lengths.
const GROWTH: f64 = 1.5;
/// Minimum ratio of successive step lengths.
const SHRINK: f64 = 0.3;
/// Safety factor on the step length that follows from the error estimate.
const SAFETY: f64 = 0.9;
/// Ratio of the residual to its initial value above which a step is rejected if it ran out of iterations or stalled.
const HOPELESS: f64 = 0.3;
/// Relative change of density or pressure of a particle above which such a step is rejected as well: the divergence of
/// a single particle is hardly visible in the norm of the residual.
const RUNAWAY: f64 = 0.5;
/// Ratio of the curvature of the last three states to their slope above which the next state is not extrapolated by a
/// parabola, as after a sudden change of motion.
const STRAIGHT: f64 = 0.5;
/// Minimum reduction (log10) of the residual of such an extrapolated guess. Without it, a guess could meet the
/// tolerance by itself, and the solution would be extrapolated again and again without iterations.
const GUESS: f64 = -0.5;
/// Maximum ratio of successive step lengths in a march with fixed steps of which some were halved: BDF2 is stable up to
/// 2.4.
const LENGTHEN: f64 = 2.0;
/// Minimum fraction of a fixed step to which it is halved if Newton's method stalls.
const SHORTEST: f64 = 0.02;
/// Fraction of a step below which the remaining time to its end counts as zero.
const NEARLY: f64 = 1e-6;
/// Number of steps after which linear systems that needed the multilevel cycle are tried without it again.
const TRY_AGAIN: u32 = 16;
/// Number of steps for which one preconditioner is used; the states from which it can be rebuilt are stored for the
/// same number of steps.
const SERVES: u32 = 3;

/// Parameters of an implicit march.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Time at which the march ends.
    pub until: f64,
    /// Length of the steps, or of the first step if the length is adaptive.
    pub step: f64,
    /// Order of the difference formula, 1 or 2.
    pub order: u8,
    /// Orders of magnitude by which the residual must fall within a step.
    pub orders: f64,
    /// Maximum number of iterations within a step.
    pub iterations: u32,
    /// Relative error of a step from which the step length follows; `None` for fixed steps.
    pub adaptive: Option<f64>,
}

/// An implicit march in time.
pub struct Dual<'a, S: Implicit> {
    system: &'a S,
    relax: Relax<'a, S>,
    plan: Plan,
    past: Past,
    start: Vec<f64>,
    /// State at the end of the current step, extrapolated linearly from the last two steps.
    line: Vec<f64>,
    inner: u32,
    /// Maximum step length for Lagrangian particles; infinite if there are none.
    reach: f64,
}

impl<'a, S: Implicit> Dual<'a, S> {
    /// Prepares a march from the state `u`; `past` is empty at the start or holds the data of an interrupted march.
    pub fn new(system: &'a S, control: Control, plan: Plan, past: Past, u: Vec<f64>) -> Self {
        let start = u.clone();
        // the time derivative makes the matrix diagonally dominant, so that one symmetric sweep suffices
        let newton = control.method == Method::NewtonKrylov;
        let sweeps = if newton { 1 } else { control.cycle.sweeps };
        let control = Control { cycle: Cycle { sweeps, ..control.cycle }, ..control };
        let relax = Relax::new(system, control, u, &start, None);
        let past = Past { next: if past.next > 0.0 { past.next } else { plan.step }, ..past };
        let mut all = Self { system, relax, plan, past, start, line: Vec::new(), inner: 0, reach: f64::INFINITY };
        if all.past.last > 0.0 {
            all.set_frame_after_step();
            all.make_again();
        } else {
            all.relax.set_frame(&Instant::still(all.past.time).with(&system.placing().values(&all.start)));
        }
        all
    }
}

impl<S: Implicit> Integrator<S> for Dual<'_, S> {
    fn finished(&self) -> bool {
        self.past.time >= self.plan.until
    }

    fn mark(&self) -> Mark {
        Mark { residual: self.relax.drop(), ..self.past.mark() }
    }

    fn standing(&mut self) -> Standing<'_, S> {
        self.relax.standing()
    }

    fn memory(&self) -> Memory {
        Memory::March(self.past.clone())
    }

    fn cost(&self) -> Cost {
        let kept = 2 * self.start.len() + self.line.len() + self.past.before.len() + self.past.older.len();
        Cost {
            inner: self.inner,
            bytes: self.relax.bytes() + 8 * kept,
            unconverged: self.past.unconverged,
            halved: self.past.halved,
            ..self.relax.cost()
        }
    }

    fn advance(&mut self) -> Result<Step, TimeError> {
        self.start.copy_from_slice(&self.relax.u);
        let planned = self.planned();
        self.reach = self.relax.plan_lagrangian_step(planned);
        let mut dt = self.within_reach(planned);
        loop {
            let error = match self.step(dt) {
                Err(TimeError::Stalled { .. }) if dt > SHORTEST * self.plan.step => {
                    self.past.halved += 1;
                    self.reach = self.relax.plan_lagrangian_step(0.5 * dt);
                    dt = self.within_reach(0.5 * dt);
                    continue;
                }
                tried => tried?,
            };
            let Some(tolerance) = self.plan.adaptive else { break };
            let wanted = SAFETY * (tolerance / error.max(f64::MIN_POSITIVE)).powf(1.0 / 3.0);
            let again = wanted < SHRINK.max(0.7) && dt > 1e-3 * self.plan.step && self.second_order();
            self.past.next = dt * wanted.clamp(SHRINK, GROWTH);
            if !again {
                break;
            }
            dt = self.past.next;
            self.relax.u.copy_from_slice(&self.start);
        }
        let end = self.past.time + dt;
        // the end of fixed steps is a multiple of their length, so that round-off does not accumulate
        let near = (end - self.plan.until).abs() < 1e-9 * dt;
        self.past.time = if near { self.plan.until } else { end };
        let even = self.is_even(dt);
        self.past.last = dt;
        self.past.iteration += 1;
        self.remember(even);
        Ok(Step {
            iteration: self.past.iteration,
            time: self.past.time,
            cfl: self.relax.cfl,
            residual: self.relax.drop(),
            linear: self.relax.linear,
        })
    }
}

impl<S: Implicit> Dual<'_, S> {
    /// Stores the data for the next steps; `even` is true if the last two steps had the same length.
    fn remember(&mut self, even: bool) {
        let past = &mut self.past;
        past.served = if self.relax.still_serves() { past.served + 1 } else { 0 };
        let far = self.relax.reach() == Reach::Far && !past.iteration.is_multiple_of(TRY_AGAIN);
        past.reach = if far { Reach::Far } else { Reach::Near };
        if self.plan.adaptive.is_none() {
            std::mem::swap(&mut past.older, &mut past.before);
        }
        if !even {
            past.older.clear();
        }
        std::mem::swap(&mut past.before, &mut self.start);
        self.start.resize(self.relax.u.len(), 0.0);
    }

    /// Builds the preconditioner for the step of length `dt` and the following ones from the state at its start.
    fn prepare(&mut self, formula: &Formula, end: f64, dt: f64) {
        // a resumed run does not know the positions of Lagrangian particles some steps ago
        let known = self.is_even(dt) && !self.past.older.is_empty() && self.reach == f64::INFINITY;
        if !known {
            self.past.served = 0;
            self.relax.drop_preconditioner();
        } else if self.past.served == 0 || self.past.served >= SERVES {
            (self.past.served, self.past.made) = (0, end);
            make_ahead(self.system, &mut self.relax, formula, (&self.start, end, dt));
        }
    }

    /// Rebuilds the preconditioner that was in use when the march was interrupted.
    fn make_again(&mut self) {
        let (step, made) = (self.past.last, self.past.made);
        let state = match self.past.served {
            1 => &self.past.before,
            2 => &self.past.older,
            _ => return,
        };
        let formula = self.formula_at(made, step, step);
        make_ahead(self.system, &mut self.relax, &formula, (state, made, step));
        self.set_frame_after_step();
    }

    /// Moves the frame to the end of the last step.
    fn set_frame_after_step(&mut self) {
        let placing = self.system.placing();
        let (time, last) = (self.past.time, self.past.last.max(f64::MIN_POSITIVE));
        let before = placing.values(&self.past.before);
        let older = if self.past.older.is_empty() { before.clone() } else { placing.values(&self.past.older) };
        let formula = self.formula_at(time, last, last).with_past(&[&before, &older]);
        let now = placing.values(&self.relax.u).into_owned();
        formula.at(&now, |at| self.relax.set_frame(at));
    }

    fn is_even(&self, dt: f64) -> bool {
        self.plan.adaptive.is_none() && (dt - self.past.last).abs() < 1e-9 * dt
    }

    fn second_order(&self) -> bool {
        self.plan.order == 2 && !self.past.before.is_empty()
    }

    /// Length of the next step if it succeeds; after fixed steps that were halved, it leads to the end of the original
    /// step.
    fn planned(&self) -> f64 {
        let (time, step, left) = (self.past.time, self.plan.step, self.plan.until - self.past.time);
        if self.plan.adaptive.is_some() {
            let dt = self.past.next.min(left);
            return if dt < left && 2.0 * dt > left { 0.5 * left } else { dt };
        }
        let passed = time - (time / step + NEARLY).floor() * step;
        let dt = if passed < NEARLY * step { step } else { step - passed };
        dt.min(left)
    }

    /// The step length `dt`, or an equal fraction of it if Lagrangian particles do not allow it or the last step was
    /// halved.
    fn within_reach(&self, dt: f64) -> f64 {
        let (last, steps) = (self.past.last, self.plan.adaptive.is_none());
        let longest = if steps && last > 0.0 { self.reach.min(LENGTHEN * last) } else { self.reach };
        dt / (dt / longest - NEARLY).ceil().max(1.0)
    }

    /// Difference formula of ∂/∂t at `end`, after steps of length `last` and `dt`.
    fn formula_at(&self, end: f64, last: f64, dt: f64) -> Formula {
        match self.second_order() {
            true => Formula::second_order(end, dt, last),
            false => Formula::first_order(end, dt),
        }
    }

    /// Solves one step of length `dt` and returns its relative error estimate; 0 if there is none.
    fn step(&mut self, dt: f64) -> Result<f64, TimeError> {
        let end = self.past.time + dt;
        let (start, before, placing) = (&self.start, &self.past.before, self.system.placing());
        let past = [placing.values(start), placing.values(before)];
        let formula = self.formula_at(end, self.past.last, dt).with_past(&[&past[0], &past[1]]);
        let mut rest = self.relax.spare_rest();
        let [last, older] = [formula.coefficient(1), formula.coefficient(2)];
        let old = |k: usize| if older != 0.0 { older * before[k] } else { 0.0 };
        sweep(&mut rest, |k| last * start[k] + old(k));
        let guesses = self.second_order();
        let smooth = guesses && self.begin_on_line(dt);
        self.keep_what_is_remembered(&formula, &mut rest);
        self.relax.set_reach(self.past.reach);
        self.prepare(&formula, end, dt);
        self.relax.begin_step(TimeTerm { formula, rest });
        let orders = self.plan.orders;
        // the residual of a guess through three states is 9/2 times the truncation error of the difference formula
        let guessed = if smooth { 10f64.powf((1.0 - orders).min(GUESS)) * self.relax.drop() } else { 0.0 };
        self.relax.goal = 10f64.powf(-orders).max(guessed);
        if let Err(fault) = self.relax.check_frame() {
            self.go_back();
            return Err(TimeError::Fault { fault, iteration: self.past.iteration + 1, hint: CROWDED });
        }
        self.solve()?;
        // the predictor has the same order with a different constant: the error is 1/3 of the difference for equal
        // steps
        let (u, line) = (&self.relax.u, &self.line);
        let error = || {
            let (change, size) = (sum(u.len(), |k| (u[k] - line[k]).powi(2)), sum(u.len(), |k| u[k] * u[k]));
            (change / size).sqrt() / 3.0
        };
        let error = if guesses { error() } else { 0.0 };
        self.relax.settle();
        Ok(error)
    }

    /// Keeps the internal variables of materials constant within a step: their ∂/∂t is zero.
    fn keep_what_is_remembered(&mut self, formula: &Formula, rest: &mut [f64]) {
        let own = self.system.unknowns_of(Name::History);
        let start = &self.start[own.clone()];
        self.relax.u[own.clone()].copy_from_slice(start);
        if let Some(line) = self.line.get_mut(own.clone()) {
            line.copy_from_slice(start);
        }
        rest[own].iter_mut().zip(start).for_each(|(rest, h)| *rest = -formula.coefficient(0) * h);
    }

    /// Sets the initial guess of a step: the parabola through the last three states if it is smooth enough, else the
    /// line through the last two states, else the current state. Returns true for the parabola.
    fn begin_on_line(&mut self, dt: f64) -> bool {
        let (start, before, older) = (&self.start, &self.past.before, &self.past.older);
        let ratio = dt / self.past.last;
        self.line.resize(start.len(), 0.0);
        sweep(&mut self.line, |k| start[k] + ratio * (start[k] - before[k]));
        let line = &self.line;
        if self.is_even(dt) && older.len() == start.len() {
            let bend = |k: usize| start[k] - 2.0 * before[k] + older[k];
            let [slopes, bends] =
                [sum(start.len(), |k| (start[k] - before[k]).powi(2)), sum(start.len(), |k| bend(k).powi(2))];
            if bends < STRAIGHT * STRAIGHT * slopes {
                sweep(&mut self.relax.u, |k| line[k] + bend(k));
                if self.relax.is_sound(&self.relax.u) {
                    return true;
                }
                self.relax.u.copy_from_slice(start);
            }
        }
        if self.relax.is_sound(line) {
            self.relax.u.copy_from_slice(line);
        }
        false
    }

    /// Restores state and particles to the start of the step.
    fn go_back(&mut self) {
        self.relax.u.copy_from_slice(&self.start);
        if self.reach < f64::INFINITY {
            self.set_frame_after_step();
        }
    }

    fn solve(&mut self) -> Result<(), TimeError> {
        self.inner = 0;
        while !(self.relax.drop() <= self.relax.goal || self.relax.settled()) {
            let over = self.inner >= self.plan.iterations;
            let tried = if over { Err(self.relax.stalled()) } else { self.relax.advance() };
            match tried {
                Ok(_) => self.inner += 1,
                // a limiter that switches between values keeps the residual from falling further: the step is accepted
                // as converged
                Err(TimeError::Stalled { .. })
                    if self.relax.drop() < HOPELESS && self.relax.changed_since(&self.start) < RUNAWAY =>
                {
                    self.past.unconverged += 1;
                    break;
                }
                Err(e) => {
                    self.go_back();
                    return Err(e);
                }
            }
        }
        Ok(())
    }
}

/// Builds a preconditioner from the state `state` for the step that ends at `end`. It depends on these alone. Bodies
/// with coordinates are placed according to that state.
fn make_ahead<S: Implicit>(
    system: &S,
    relax: &mut Relax<'_, S>,
    formula: &Formula,
    (state, end, dt): (&[f64], f64, f64),
) {
    let (placing, rate) = (system.placing(), formula.coefficient(0));
    match placing.is_empty() {
        true => formula.at(&[], |at| relax.prepare_at(at, state, rate)),
        false => relax.prepare_at(&Instant::within(end, dt, 0.0).with(&placing.values(state)), state, rate),
    }
}
