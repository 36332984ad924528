//! Implicit marching: backward differences, each step relaxed in a pseudo time (Jameson, AIAA 91-1596).
//!
//! R(U) − ∂U/∂t = 0 with ∂U/∂t = Σ c_k U(t_k): the first-order formula in the first step, then the second-order one of three
//! times, written for steps of unequal length. Positions of particles are differenced with the same formula as the state.
use super::control::{Control, Method};
use super::formula::Formula;
use super::relax::{Relax, TimeTerm};
use super::{CROWDED, Cost, Integrator, Mark, Memory, Past, Standing, Step, TimeError};
use crate::math::multilevel::Cycle;
use crate::math::parallel::sweep;
use crate::math::reduce::sum;
use crate::system::{Implicit, Instant, Name, Reach};

/// Greatest ratio of successive steps.
const GROWTH: f64 = 1.5;
/// Smallest ratio of successive steps.
const SHRINK: f64 = 0.3;
/// Fraction of the step that the error estimate asks for that is taken.
const SAFETY: f64 = 0.9;
/// Residual over its start above which a step that ran out of iterations, or stalled, is refused.
const HOPELESS: f64 = 0.3;
/// Relative change of density or pressure of a particle above which such a step is refused as well: a state that runs away at one
/// particle hardly shows in the residual of all of them.
const RUNAWAY: f64 = 0.5;
/// Bend of the last three states over their slope above which the next one is not guessed from a parabola: after a jerk.
const STRAIGHT: f64 = 0.5;
/// Orders that the residual of such a guess falls at least: one that counts as solved for itself would be guessed from again and again.
const GUESS: f64 = -0.5;
/// Greatest ratio of successive steps of a march with fixed ones, where some were cut: BDF2 takes 2.4.
const LENGTHEN: f64 = 2.0;
/// Part of a fixed step down to which it is halved where Newton's method stalls.
const SHORTEST: f64 = 0.02;
/// Part of a step by which a time may fall short of the end of one.
const NEARLY: f64 = 1e-6;
/// Steps after which linear systems that needed the levels are tried without them again.
const TRY_AGAIN: u32 = 16;
/// Steps that one preconditioner serves; the states from which it can be made again are kept for as many.
const SERVES: u32 = 3;

/// How to march.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Time at which the march ends.
    pub until: f64,
    /// Length of the (first) step.
    pub step: f64,
    /// Order of the difference formula, 1 or 2.
    pub order: u8,
    /// Orders of magnitude the residual must fall within a step.
    pub orders: f64,
    /// Greatest number of iterations within a step.
    pub iterations: u32,
    /// Relative error of a step that its length is fitted to; `None`: fixed steps.
    pub adaptive: Option<f64>,
}

/// An implicit march.
pub struct Dual<'a, S: Implicit> {
    system: &'a S,
    relax: Relax<'a, S>,
    plan: Plan,
    past: Past,
    start: Vec<f64>,
    /// The line through the states of the last two steps at the end of this one.
    line: Vec<f64>,
    inner: u32,
    /// Longest step of particles that follow the state; infinite where none do.
    reach: f64,
}

impl<'a, S: Implicit> Dual<'a, S> {
    /// Prepares a march from the state `u`.
    pub fn new(system: &'a S, control: Control, plan: Plan, past: Past, u: Vec<f64>) -> Self {
        let start = u.clone();
        // the term of time makes the matrix easy: one sweep each way does
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
        // steps of fixed length add up without gathering round-off
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
    /// Keeps what the next steps go on from; `even` if the last two steps were of one length.
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

    /// Makes the preconditioner of the step of length `dt` and those after it from where this one starts.
    fn prepare(&mut self, formula: &Formula, end: f64, dt: f64) {
        // where particles were some steps ago, a run that is resumed no longer knows
        let known = self.is_even(dt) && !self.past.older.is_empty() && self.reach == f64::INFINITY;
        if !known {
            self.past.served = 0;
            self.relax.drop_preconditioner();
        } else if self.past.served == 0 || self.past.served >= SERVES {
            (self.past.served, self.past.made) = (0, end);
            make_ahead(self.system, &mut self.relax, formula, (&self.start, end, dt));
        }
    }

    /// Makes the preconditioner that served when the march was interrupted.
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

    /// Brings the frame to where the last step ended.
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

    /// Length of the next step if all goes well; steps of fixed length that were cut lead on to where they would have ended.
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

    /// The step `dt`, or an equal part of it where particles do not go as far or the step before was cut.
    fn within_reach(&self, dt: f64) -> f64 {
        let (last, steps) = (self.past.last, self.plan.adaptive.is_none());
        let longest = if steps && last > 0.0 { self.reach.min(LENGTHEN * last) } else { self.reach };
        dt / (dt / longest - NEARLY).ceil().max(1.0)
    }

    /// ∂/∂t at `end`, after steps of length `last` and `dt`.
    fn formula_at(&self, end: f64, last: f64, dt: f64) -> Formula {
        match self.second_order() {
            true => Formula::second_order(end, dt, last),
            false => Formula::first_order(end, dt),
        }
    }

    /// Solves one step and returns its relative error estimate, zero where there is none.
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
        // of a guess through three states the residual is 9/2 times the truncation error of the difference formula
        let guessed = if smooth { 10f64.powf((1.0 - orders).min(GUESS)) * self.relax.drop() } else { 0.0 };
        self.relax.goal = 10f64.powf(-orders).max(guessed);
        if let Err(fault) = self.relax.check_frame() {
            self.go_back();
            return Err(TimeError::Fault { fault, iteration: self.past.iteration + 1, hint: CROWDED });
        }
        self.solve()?;
        // the predictor is of the same order with another constant: 1/3 of the difference for equal steps
        let (u, line) = (&self.relax.u, &self.line);
        let error = || {
            let (change, size) = (sum(u.len(), |k| (u[k] - line[k]).powi(2)), sum(u.len(), |k| u[k] * u[k]));
            (change / size).sqrt() / 3.0
        };
        let error = if guesses { error() } else { 0.0 };
        self.relax.settle();
        Ok(error)
    }

    /// Within a step what is remembered stays as it was at its start: ∂/∂t of it is nothing.
    fn keep_what_is_remembered(&mut self, formula: &Formula, rest: &mut [f64]) {
        let own = self.system.unknowns_of(Name::History);
        let start = &self.start[own.clone()];
        self.relax.u[own.clone()].copy_from_slice(start);
        if let Some(line) = self.line.get_mut(own.clone()) {
            line.copy_from_slice(start);
        }
        rest[own].iter_mut().zip(start).for_each(|(rest, h)| *rest = -formula.coefficient(0) * h);
    }

    /// Starts from the parabola through the last three states where it serves, or from the line through two, or from where
    /// the state is; true for the parabola.
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

    /// Puts state and particles where the step began.
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
                // a limiter that flips keeps the residual from falling further: the step is as good as it gets
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

/// Makes a preconditioner from the state `state` for the step that ends at `end`: a function of these alone. Bodies that have
/// coordinates of their own stand where that state puts them.
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
