//! How much of a step is taken, and the Courant number of the next one.
use super::super::control::Method;
use super::newton::{put, shift, sweep_fields};
use super::{Relax, START_CFL_MAX};
use crate::math::parallel::{sweep, sweep_rows};
use crate::system::{Implicit, Reach};

/// Error of what the linear system foretold of the residual, over the residual before the step, below which the Courant number
/// grows, and how much at least: a residual that rises as the pseudo time has it, near a flow that is steady but unstable, is
/// no reason for smaller steps, with which it would only be followed in time.
const TRUSTED: f64 = 0.5;
const TRUSTED_GROWTH: f64 = 1.5;
/// Largest ratio of residuals of successive steps while shocks travel.
const START_JUMP: f64 = 4.0;
/// Largest ratio of residuals of successive Newton steps within a step in time.
const NEWTON_JUMP: f64 = 1.1;
/// The same on the way to a steady flow. A shock that enters the next row of particles makes the residual several times as large before it
/// falls: steps that may not pass over that are cut short at every row.
const SHOCK_JUMP: f64 = 10.0;
/// The same around strong shocks: a bow shock at Mach 10 does not come back from larger ones.
const STRONG_SHOCK_JUMP: f64 = 2.0;
/// Least growth of the Courant number after a whole step towards a steady flow while the residual is above its smallest, and around strong
/// shocks: where it waits for the residual to fall, shocks travel as slowly as in time.
const LEAST_GROWTH: f64 = 3.0;
const STRONG_SHOCK_GROWTH: f64 = 1.0;
/// Largest over smallest pressure above which shocks may be strong: 3 to 6 around transonic sections, above 100 behind a bow shock at Mach 3.
const STRONG_SHOCKS: f64 = 10.0;
/// Growth of the Courant number after a whole Newton step within a step in time, at least.
const LEAST_GROWTH_IN_TIME: f64 = 0.5;
/// Step lengths that are tried before the Courant number is lowered: 1, 1/2, 1/4.
const SHORTER_STEPS: i32 = 3;
/// Largest relative change of density and pressure in one step that is shortened as a whole.
const LARGEST_CHANGE: f64 = 0.3;
/// Largest relative change of a particle in a step that is shortened row by row, and the greatest change before, beyond which the step is
/// shortened as a whole: what a strong shock leaves of such steps fits no flow.
const LARGEST_ROW_CHANGE: f64 = 0.5;
const MILD_CHANGE: f64 = 1.0;
/// Fall of the residual in an iteration of a step in time with which the preconditioner goes on to serve.
const GOOD_FALL: f64 = 2.0;

/// How daring a line search is.
#[derive(Clone, Copy)]
struct Search {
    /// Largest ratio of the residual after a step to that before.
    jump: f64,
    /// Least growth of the Courant number after a whole Newton step.
    growth: f64,
}

impl<S: Implicit> Relax<'_, S> {
    /// Part of the step that changes no density and no pressure by too much. On the way to a steady flow mild steps are shortened row by row
    /// instead.
    pub(super) fn fraction(&mut self) -> f64 {
        let change = self.system.largest_change(&self.u, &self.step);
        if self.time.is_some() || !(change <= MILD_CHANGE) {
            return (LARGEST_CHANGE / change).min(1.0);
        }
        if change > LARGEST_ROW_CHANGE {
            self.system.shorten(&self.u, &mut self.step, LARGEST_ROW_CHANGE);
        }
        1.0
    }

    /// Takes the step times `fraction`, or a shorter one when Newton's method overshoots.
    pub(super) fn search(&mut self, fraction: f64) -> bool {
        if !self.phase.newton {
            return self.accept(fraction, Search { jump: START_JUMP, growth: 1.0 });
        }
        let search = if self.time.is_some() {
            Search { jump: NEWTON_JUMP, growth: LEAST_GROWTH_IN_TIME }
        } else if self.system.pressure_ratio(&self.u) > STRONG_SHOCKS {
            Search { jump: STRONG_SHOCK_JUMP, growth: STRONG_SHOCK_GROWTH }
        } else {
            Search { jump: SHOCK_JUMP, growth: LEAST_GROWTH }
        };
        (0..SHORTER_STEPS).any(|k| self.accept(fraction * 0.5f64.powi(k), search))
    }

    /// Takes the step times `fraction` if the new residual is at most `search.jump` times the old one; sets the next Courant number.
    fn accept(&mut self, fraction: f64, search: Search) -> bool {
        let (u, step) = (&self.u, &self.step);
        sweep(&mut self.trial, |k| u[k] + fraction * step[k]);
        if self.system.check(&self.frame, &self.trial).is_err() {
            return false;
        }
        let beside = self.frame_of_trial();
        let frame = beside.as_ref().unwrap_or(&self.frame);
        self.system.rhs(frame, &self.trial, &mut self.work, &mut self.trial_residual);
        self.evaluations += 1;
        if let Some(term) = &self.time {
            let (trial, rate) = (&self.trial, term.rate());
            let change = |k: usize| rate * trial[k] + term.rest[k];
            sweep_rows(&mut self.trial_residual, 1, |k, r| r[0] -= change(k));
        }
        let norm = self.norm_of(&self.trial_residual);
        if !norm.is_finite() || norm > search.jump * self.norm {
            self.beside = beside.or(self.beside.take());
            return false;
        }
        if let Some(frame) = beside {
            self.beside = Some(std::mem::replace(&mut self.frame, frame));
        }
        std::mem::swap(&mut self.u, &mut self.trial);
        std::mem::swap(&mut self.residual, &mut self.trial_residual);
        let steady_newton = self.phase.newton && self.time.is_none();
        let trusted = steady_newton && fraction == 1.0 && self.model_error() < TRUSTED * self.norm;
        let wanders = steady_newton && norm > self.phase.best;
        let growth = if wanders { search.growth } else { search.growth.min(1.0) };
        let least = if trusted { growth.max(TRUSTED_GROWTH) } else { growth };
        self.cfl = self.next_cfl(fraction, self.norm / norm.max(f64::MIN_POSITIVE), least);
        if !(self.norm > GOOD_FALL * norm) {
            self.give_up_preconditioner();
        }
        self.norm = norm;
        true
    }

    /// The frame of the state in `trial`, where frames depend on the state.
    fn frame_of_trial(&mut self) -> Option<S::Frame> {
        if !self.moves() {
            return None;
        }
        let mut frame = self.beside.take().unwrap_or_else(|| self.frame.clone());
        put(self.system, self.time.as_ref(), &self.trial, &mut frame);
        Some(frame)
    }

    /// Size of what the residual after a whole step differs by from what the linear system left of it, δu/Δτ.
    fn model_error(&mut self) -> f64 {
        let shift = shift((&self.rate, self.cfl), None, Reach::Far);
        let (residual, step) = (&self.residual, &self.step);
        sweep_fields(self.system, &mut self.trial, |i, at, out| {
            for (k, out) in (at..).zip(out) {
                *out = residual[k] - shift.of(i) * step[k];
            }
        });
        self.norm_of(&self.trial)
    }

    /// The Courant number after an accepted step that divided the residual by `ratio`; it grows at least by `least` after a whole step of
    /// Newton's method.
    fn next_cfl(&self, fraction: f64, ratio: f64, least: f64) -> f64 {
        let growth = self.control.growth;
        let factor = match (self.phase.newton, fraction == 1.0) {
            (true, true) => ratio.clamp(least, growth.max(least)),
            (true, false) => ratio.clamp(0.5, 1.0),
            (false, true) => {
                if ratio < 1.0 {
                    ratio.max(0.8)
                } else {
                    ratio.clamp(1.0 + 0.5 * (growth - 1.0), growth)
                }
            }
            (false, false) => ratio.clamp(0.8, 1.0),
        };
        (self.cfl * factor).min(self.largest_cfl())
    }

    pub(super) fn largest_cfl(&self) -> f64 {
        let start = self.control.method == Method::NewtonKrylov && !self.phase.newton;
        if start { self.control.cfl_max.min(START_CFL_MAX) } else { self.control.cfl_max }
    }
}
